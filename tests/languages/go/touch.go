// SPDX-License-Identifier: BSD-3-Clause

// The scene of ../touch.c in Go, with the same arguments and output.
package main

// #include "dynpoint.h"
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

func must[T any](value T, err error) T {
	if err != nil {
		panic(err)
	}
	return value
}

// The place k of sides on the unit circle. A conversion keeps a product from being fused with a sum.
func circle(k int) (float64, float64) {
	t := float64(k%(sides/4)) / (sides / 4)
	square := float64(t * t)
	c, s := (1-square)/(1+square), 2*t/(1+square)
	at := [4][2]float64{{c, s}, {-s, c}, {-c, -s}, {s, -c}}[k/(sides/4)%4]
	return at[0], at[1]
}

func ball() (vertices [][3]float64, corners [][3]uint32) {
	for r := range rings + 1 {
		for k := range sides {
			z, rho := circle(r)
			x, y := circle(k)
			vertices = append(vertices, [3]float64{0.05 * rho * x, 0.05 * rho * y, 0.05 * z})
			a, b := uint32(r*sides+k), uint32(r*sides+(k+1)%sides)
			if r < rings {
				corners = append(corners, [3]uint32{a, a + sides, b}, [3]uint32{b, a + sides, b + sides})
			}
		}
	}
	return vertices, corners
}

func path(tick int) (pose C.dpt_pose) {
	fold := func(n int) float64 { return math.Abs(float64(tick%(2*n) - n)) }
	u, lift := (fold(2000)-1000)*0.00005, float64(fold(500)*0.00001)
	square := float64(u * u)
	x, y := (fold(1500)-750)*0.00002, (fold(1100)-550)*0.00002
	pose.position = [3]C.double{C.double(x), C.double(y), C.double(0.05 + lift)}
	pose.orientation = [4]C.double{C.double((1 - square) / (1 + square)), 0, C.double(2 * u / (1 + square))}
	return pose
}

// Time of the ticks alone.
func feel(mesh *Mesh, poses []C.dpt_pose, wrenches []C.dpt_wrench) time.Duration {
	world := must(NewWorld(DefaultWorld()))
	body := must(world.Add(mesh, nil))
	must(0, world.Settings(body, func(settings *C.dpt_body_settings) {
		settings.static_friction, settings.kinetic_friction = 0.3, 0.3
	}))
	tool := must(world.AddTool(C.dpt_segment{a: [3]C.double{-0.025}, b: [3]C.double{0.025}, radius: 0.002}))
	runtime.LockOSThread() // how a loop keeps its thread, whose priority may be its own
	defer runtime.UnlockOSThread()
	began := time.Now()
	for tick := range poses {
		must(0, world.Tick(tool, &poses[tick], 0.001, &wrenches[tick]))
	}
	return time.Since(began)
}

func main() {
	rounds := 1
	if len(os.Args) > 1 {
		rounds = must(strconv.Atoi(os.Args[1]))
	}
	mesh := must(Compile(ball()))
	poses, wrenches := make([]C.dpt_pose, ticks), make([]C.dpt_wrench, ticks)
	for tick := range poses {
		poses[tick] = path(tick)
	}
	least := time.Hour
	for range rounds {
		least = min(least, feel(mesh, poses, wrenches))
	}
	hash := fnv.New64a()
	binary.Write(hash, binary.LittleEndian, unsafe.Slice((*float64)(unsafe.Pointer(&wrenches[0])), 6*ticks))
	fmt.Printf("%016x %d %.6f\n", hash.Sum64(), ticks, least.Seconds())
}
