// SPDX-License-Identifier: BSD-3-Clause

// The scene of ../touch.c in Go, over the single files, with the same arguments and output.
package main

/*
#cgo LDFLAGS: -lm -pthread
#include "dynpoint.h"
#include "dynpoint_compile.h"
#include <stdlib.h>
*/
import "C"

import (
	"encoding/binary"
	"fmt"
	"hash/fnv"
	"math"
	"os"
	"runtime"
	"strconv"
	"time"
	"unsafe"
)

const rings, sides, ticks = 24, 48, 10000

func must(what string, result C.dpt_result) {
	if result != C.DPT_OK {
		panic(what + ": " + C.GoString(C.dpt_result_text(result)))
	}
}

// The place k of sides on the unit circle.
func circle(k int) (float64, float64) {
	t := float64(k%(sides/4)) / (sides / 4)
	square := float64(t * t) // a conversion keeps the product from being fused with a sum
	c, s := (1-square)/(1+square), 2*t/(1+square)
	at := [4][2]float64{{c, s}, {-s, c}, {-c, -s}, {s, -c}}[k/(sides/4)%4]
	return at[0], at[1]
}

func compileBall() C.dpt_compiled {
	var vertices [(rings + 1) * sides][3]C.double
	var corners [][3]C.uint32_t
	for r := 0; r <= rings; r++ {
		for k := 0; k < sides; k++ {
			z, rho := circle(r)
			x, y := circle(k)
			vertices[r*sides+k] = [3]C.double{C.double(0.05 * rho * x), C.double(0.05 * rho * y), C.double(0.05 * z)}
			a, b := C.uint32_t(r*sides+k), C.uint32_t(r*sides+(k+1)%sides)
			if r < rings {
				corners = append(corners, [3]C.uint32_t{a, a + sides, b}, [3]C.uint32_t{b, a + sides, b + sides})
			}
		}
	}
	var ball C.dpt_compiled
	must("compile", C.dpt_compile_arrays(&vertices[0][0], C.size_t(len(vertices)), &corners[0][0],
		C.size_t(len(corners)), nil, &ball, nil))
	return ball
}

func path(tick int) C.dpt_pose {
	fold := func(n int) float64 { return math.Abs(float64(tick%(2*n) - n)) }
	u := (fold(2000) - 1000) * 0.00005
	square := float64(u * u)
	lift := float64(fold(500) * 0.00001)
	return C.dpt_pose{
		position: [3]C.double{C.double((fold(1500) - 750) * 0.00002), C.double((fold(1100) - 550) * 0.00002), C.double(0.05 + lift)},
		orientation: [4]C.double{C.double((1 - square) / (1 + square)), 0, C.double(2 * u / (1 + square)), 0},
	}
}

// Time of the ticks alone. What C keeps is C's memory: Go's may not be kept there.
func feel(mesh *C.dpt_mesh, poses []C.dpt_pose, wrenches []C.dpt_wrench) time.Duration {
	var def C.dpt_world_def
	var world *C.dpt_world
	var body C.dpt_body
	var tool C.dpt_tool
	C.dpt_world_def_init(&def)
	bytes := C.dpt_world_bytes(&def)
	block := C.malloc(bytes)
	defer C.free(block)
	must("world", C.dpt_world_create(block, bytes, &def, &world))
	must("body", C.dpt_body_add(world, mesh, nil, &body))
	settings := C.dpt_body_settings{size: C.sizeof_dpt_body_settings}
	must("settings", C.dpt_body_get_settings(world, body, &settings))
	settings.static_friction, settings.kinetic_friction = 0.3, 0.3
	must("settings", C.dpt_body_set_settings(world, body, &settings))
	rod := C.dpt_segment{a: [3]C.double{-0.025}, b: [3]C.double{0.025}, radius: 0.002}
	must("tool", C.dpt_tool_add(world, &rod, 1, &tool))
	// Floating-point state belongs to a thread.
	runtime.LockOSThread()
	defer runtime.UnlockOSThread()
	began := time.Now()
	for tick := range poses {
		must("pose", C.dpt_tool_set_pose(world, tool, &poses[tick]))
		must("step", C.dpt_world_step(world, 0.001, nil))
		must("wrench", C.dpt_tool_get_wrench(world, tool, &wrenches[tick]))
	}
	return time.Since(began)
}

func main() {
	rounds := 1
	if len(os.Args) > 1 {
		rounds, _ = strconv.Atoi(os.Args[1])
	}
	ball := compileBall()
	defer C.dpt_compiled_free(&ball)
	var mesh *C.dpt_mesh
	must("open", C.dpt_mesh_open(ball.bytes, ball.size, &mesh))
	poses, wrenches := make([]C.dpt_pose, ticks), make([]C.dpt_wrench, ticks)
	for tick := range poses {
		poses[tick] = path(tick)
	}
	least := time.Hour
	for round := 0; round < rounds; round++ {
		least = min(least, feel(mesh, poses, wrenches))
	}
	hash := fnv.New64a()
	binary.Write(hash, binary.LittleEndian, unsafe.Slice((*float64)(unsafe.Pointer(&wrenches[0])), 6*ticks))
	fmt.Printf("%016x %d %.6f\n", hash.Sum64(), ticks, least.Seconds())
}
