// SPDX-License-Identifier: BSD-3-Clause

package main

// #include "dynpoint.h"
import "C"

import (
	"math"
	"runtime"
	"sync"
	"sync/atomic"
	"testing"
	"time"
)

// cgo is not for files named _test.go: misuse_test.go calls these.
var rod = C.dpt_segment{b: [3]C.double{0, 0, 0.05}, radius: 0.002}

func at(z float64) *C.dpt_pose {
	return &C.dpt_pose{position: [3]C.double{0, 0, C.double(z)}, orientation: [4]C.double{1}}
}

// A tool that presses into the ball from above, and its force.
func press(t *testing.T, world *World, tool C.dpt_tool) float64 {
	var wrench C.dpt_wrench
	for tick := range 20 {
		if err := world.Tick(tool, at(0.06-0.0007*float64(tick)), 0.001, &wrench); err != nil {
			t.Fatal(err)
		}
	}
	return float64(wrench.force[2])
}

// A body whose mesh the world alone has, once this has returned.
//
//go:noinline
func addBall(world *World) C.dpt_body {
	return must(world.Add(must(Compile(ball())), nil))
}

// What nobody has is freed by a goroutine of its own, behind the collector.
func collect() {
	for range 10 {
		runtime.GC()
		time.Sleep(time.Millisecond)
	}
}

func freedMesh(t *testing.T) {
	world := must(NewWorld(DefaultWorld()))
	body := addBall(world)
	tool := must(world.AddTool(rod))
	collect()
	if force := press(t, world, tool); force < 0.5 {
		t.Errorf("a mesh that the world alone has: %g N", force)
	}
	must(0, world.Remove(body))
	collect()
	if force := press(t, world, tool); force != 0 {
		t.Errorf("a body that was removed: %g N", force)
	}
	if err := world.Remove(body); err != Code(C.DPT_E_HANDLE) || err.Error() != "the id is stale, null or of another kind" {
		t.Errorf("removed twice: %v", err)
	}
	must(0, world.Close())
	if err := world.Tick(tool, at(0), 0.001, &C.dpt_wrench{}); err != ErrClosed {
		t.Errorf("a closed world: %v", err)
	}
	if _, err := world.AddTool(rod); err != ErrClosed {
		t.Errorf("a tool for a closed world: %v", err)
	}
}

func twoGoroutines(t *testing.T) {
	world := must(NewWorld(DefaultWorld()))
	must(world.Add(must(Compile(ball())), nil))
	tool := must(world.AddTool(rod))
	var group sync.WaitGroup
	var done, busy atomic.Int64
	for range 4 {
		group.Add(1)
		go func() {
			defer group.Done()
			var wrench C.dpt_wrench
			for tick := range 2000 {
				switch err := world.Tick(tool, at(0.05+0.00001*float64(tick%100)), 0.001, &wrench); err {
				case nil:
					done.Add(1)
				case ErrBusy:
					busy.Add(1)
				default:
					t.Error(err)
				}
			}
		}()
	}
	group.Wait()
	if done.Load() == 0 || done.Load()+busy.Load() != 8000 {
		t.Errorf("%d done and %d refused of 8000", done.Load(), busy.Load())
	}
	inside := world.alone(func(*C.dpt_world) C.dpt_result {
		if err := world.Tick(tool, at(0), 0.001, &C.dpt_wrench{}); err != ErrBusy {
			t.Errorf("a second one inside: %v", err)
		}
		if err := world.Close(); err != ErrBusy {
			t.Errorf("closed from inside: %v", err)
		}
		return C.DPT_OK
	})
	if inside != nil {
		t.Error(inside)
	}
}

func wrongNumbers(t *testing.T) {
	world := must(NewWorld(DefaultWorld()))
	mesh := must(Compile(ball()))
	must(world.Add(mesh, nil))
	tool := must(world.AddTool(rod))
	for _, bad := range []float64{math.NaN(), math.Inf(1), 1e300} {
		wrench := C.dpt_wrench{force: [3]C.double{7}}
		if err := world.Tick(tool, at(bad), 0.001, &wrench); err != Code(C.DPT_E_FINITE) || wrench.force[0] != 0 {
			t.Errorf("a pose of %g: %v, %v", bad, err, wrench.force)
		}
		if err := world.Tick(tool, at(0), bad, &wrench); err == nil || wrench.force[2] != 0 {
			t.Errorf("a step of %g: %v, %v", bad, err, wrench.force)
		}
		hits, err := mesh.Query([][6]float64{{bad}, {0, 0, 0.1, 0, 0, 0.2}})
		if err != Code(C.DPT_E_FINITE) || hits[0].status != C.DPT_STATUS_STALE || hits[1].status != C.DPT_STATUS_EXACT {
			t.Errorf("a segment of %g: %v", bad, err)
		}
		def := DefaultWorld()
		def.margin = C.double(bad)
		if _, err := NewWorld(def); err == nil {
			t.Errorf("a margin of %g", bad)
		}
		if _, err := Compile([][3]float64{{bad}, {1}, {0, 1}}, [][3]uint32{{0, 1, 2}}); err != Code(C.DPT_E_FINITE) {
			t.Errorf("a vertex of %g: %v", bad, err)
		}
	}
}

func wrongSizes(t *testing.T) {
	if _, err := Compile(nil, nil); err == nil {
		t.Error("a mesh of nothing")
	}
	if _, err := Compile([][3]float64{{0}, {1}, {0, 1}}, [][3]uint32{{0, 1, 3}}); err != Code(C.DPT_E_INDEX) {
		t.Errorf("a corner that is not there: %v", err)
	}
	if hits, err := must(Compile(ball())).Query(nil); err != nil || len(hits) != 0 {
		t.Errorf("no segments: %v", err)
	}
	def := DefaultWorld()
	def.size = 4
	if _, err := NewWorld(def); err == nil {
		t.Error("a def of four bytes")
	}
	def = DefaultWorld()
	def.certificate_bytes = 1 << 63
	if _, err := NewWorld(def); err == nil {
		t.Error("a world of 2^63 bytes")
	}
	world := must(NewWorld(DefaultWorld()))
	if _, err := world.AddTool(); err == nil {
		t.Error("a tool of no segments")
	}
	if err := world.Settings(77, func(*C.dpt_body_settings) { t.Error("called") }); err != Code(C.DPT_E_HANDLE) {
		t.Errorf("settings of no body: %v", err)
	}
	body := must(world.Add(must(Compile(ball())), nil))
	short := func(settings *C.dpt_body_settings) { settings.size = 4 }
	if err := world.Settings(body, short); err != Code(C.DPT_E_SIZE) {
		t.Errorf("settings of four bytes: %v", err)
	}
}
