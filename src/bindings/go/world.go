// SPDX-License-Identifier: BSD-3-Clause

// Meshes, worlds and tools for a program in Go: a file to copy beside the single files (docs/go.md). What it does not
// have is a call of C.dpt_... away.
package main

/*
#cgo CFLAGS: -O2
#cgo LDFLAGS: -lm -pthread
#include "dynpoint.h"
#include "dynpoint_compile.h"
#include <stdlib.h>
*/
import "C"

import (
	"errors"
	"math"
	"runtime"
	"sync/atomic"
	"unsafe"
)

// Code is what the library refused.
type Code C.dpt_result

func (code Code) Error() string { return C.GoString(C.dpt_result_text(C.dpt_result(code))) }

// ErrBusy is for the second of two goroutines in one world: nothing has happened.
var ErrBusy = errors.New("another goroutine is in this world")

// ErrClosed is for a world that was closed.
var ErrClosed = errors.New("the world is closed")

func check(result C.dpt_result) error {
	if result == C.DPT_OK {
		return nil
	}
	return Code(result)
}

// Mesh does not change: goroutines and worlds share it. It is freed when nobody has it, and a world has what it feels.
type Mesh struct {
	raw      *C.dpt_mesh
	compiled C.dpt_compiled
}

// Compile makes a mesh of vertices, m, and three of them a triangle.
func Compile(vertices [][3]float64, corners [][3]uint32) (*Mesh, error) {
	mesh := &Mesh{}
	err := check(C.dpt_compile_arrays((*C.double)(unsafe.Pointer(unsafe.SliceData(vertices))), C.size_t(len(vertices)),
		(*C.uint32_t)(unsafe.Pointer(unsafe.SliceData(corners))), C.size_t(len(corners)), nil, &mesh.compiled, nil))
	if err == nil {
		err = check(C.dpt_mesh_open(mesh.compiled.bytes, mesh.compiled.size, &mesh.raw))
	}
	if err != nil {
		return nil, err
	}
	runtime.SetFinalizer(mesh, func(mesh *Mesh) { C.dpt_compiled_free(&mesh.compiled) })
	return mesh, nil
}

// Query is the nearest pair of each segment, ax, ay, az, bx, by, bz, and the mesh.
func (mesh *Mesh) Query(ends [][6]float64) ([]C.dpt_hit, error) {
	hits := make([]C.dpt_hit, len(ends)+1)
	hits[0].size = C.sizeof_dpt_hit
	err := check(C.dpt_query_segments(mesh.raw, nil, (*C.double)(unsafe.Pointer(unsafe.SliceData(ends))), nil,
		C.size_t(len(ends)), &hits[0], nil))
	runtime.KeepAlive(mesh)
	return hits[:len(ends)], err
}

// World belongs to one goroutine at a time; a second one gets ErrBusy.
type World struct {
	raw    *C.dpt_world
	block  unsafe.Pointer // C's memory: C keeps pointers into it, which it may not into Go's
	busy   atomic.Bool
	meshes map[C.dpt_body]*Mesh
}

// DefaultWorld is a def to change and give to NewWorld.
func DefaultWorld() (def C.dpt_world_def) {
	C.dpt_world_def_init(&def)
	return def
}

// NewWorld makes a world in memory of its own.
func NewWorld(def C.dpt_world_def) (*World, error) {
	bytes := C.dpt_world_bytes(&def)
	if bytes == 0 {
		return nil, Code(C.DPT_E_ARGUMENT)
	}
	world := &World{meshes: map[C.dpt_body]*Mesh{}}
	if uint64(bytes) > math.MaxInt64 {
		return nil, Code(C.DPT_E_MEMORY)
	}
	// C.malloc of cgo ends the program where there is no memory; calloc says so.
	if world.block = C.calloc(1, bytes); world.block == nil {
		return nil, Code(C.DPT_E_MEMORY)
	}
	runtime.SetFinalizer(world, func(world *World) { world.Close() })
	return world, check(C.dpt_world_create(world.block, bytes, &def, &world.raw))
}

// Close frees the world; calls on it fail from now on.
func (world *World) Close() error {
	if !world.busy.CompareAndSwap(false, true) {
		return ErrBusy
	}
	C.free(world.block)
	world.block, world.raw, world.meshes = nil, nil, nil
	world.busy.Store(false)
	return nil
}

// Alone calls C on the world while no other goroutine may.
func (world *World) alone(call func(*C.dpt_world) C.dpt_result) error {
	if !world.busy.CompareAndSwap(false, true) {
		return ErrBusy
	}
	defer world.busy.Store(false)
	if world.raw == nil {
		return ErrClosed
	}
	return check(call(world.raw))
}

// Add a rigid body; nil is the identity. The world has the mesh until the body is removed.
func (world *World) Add(mesh *Mesh, pose *C.dpt_pose) (body C.dpt_body, err error) {
	err = world.alone(func(raw *C.dpt_world) C.dpt_result {
		result := C.dpt_body_add(raw, mesh.raw, pose, &body)
		if result == C.DPT_OK {
			world.meshes[body] = mesh
		}
		return result
	})
	return body, err
}

// Remove a body.
func (world *World) Remove(body C.dpt_body) error {
	return world.alone(func(raw *C.dpt_world) C.dpt_result {
		result := C.dpt_body_remove(raw, body)
		if result == C.DPT_OK {
			delete(world.meshes, body)
		}
		return result
	})
}

// Settings of a body, changed by a function.
func (world *World) Settings(body C.dpt_body, change func(*C.dpt_body_settings)) error {
	return world.alone(func(raw *C.dpt_world) C.dpt_result {
		settings := C.dpt_body_settings{size: C.sizeof_dpt_body_settings}
		if result := C.dpt_body_get_settings(raw, body, &settings); result != C.DPT_OK {
			return result
		}
		change(&settings)
		return C.dpt_body_set_settings(raw, body, &settings)
	})
}

// AddTool of segments in its own frame.
func (world *World) AddTool(segments ...C.dpt_segment) (tool C.dpt_tool, err error) {
	err = world.alone(func(raw *C.dpt_world) C.dpt_result {
		return C.dpt_tool_add(raw, unsafe.SliceData(segments), C.uint32_t(len(segments)), &tool)
	})
	return tool, err
}

// Tick moves a tool, steps the world by dt seconds, and tells what the tool feels.
func (world *World) Tick(tool C.dpt_tool, pose *C.dpt_pose, dt float64, wrench *C.dpt_wrench) error {
	if !world.busy.CompareAndSwap(false, true) {
		return ErrBusy
	}
	defer world.busy.Store(false)
	if world.raw == nil {
		return ErrClosed
	}
	result := C.dpt_tool_set_pose(world.raw, tool, pose)
	if stepped := C.dpt_world_step(world.raw, C.double(dt), nil); result == C.DPT_OK {
		result = stepped
	}
	if told := C.dpt_tool_get_wrench(world.raw, tool, wrench); result == C.DPT_OK {
		result = told
	}
	return check(result)
}
