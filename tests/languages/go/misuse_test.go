// SPDX-License-Identifier: BSD-3-Clause

package main

import "testing"

func TestFreedMesh(t *testing.T)     { freedMesh(t) }
func TestTwoGoroutines(t *testing.T) { twoGoroutines(t) }
func TestWrongNumbers(t *testing.T)  { wrongNumbers(t) }
func TestWrongSizes(t *testing.T)    { wrongSizes(t) }
