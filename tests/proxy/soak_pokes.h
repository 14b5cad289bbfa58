/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Pokes of thin things: a tool is set beside a sheet, a closed wall of 0.1 mm or a spherical shell, and its device is led
 * through, slowly, fast, by 0.5 m, or in jumps. The proxy stays on its side.
 *
 * Oracles: at what is flat the sign and the size of a coordinate. At the shell, a brute force over its triangles, and
 * crossings of rays with its outer surface alone; the cavity is a side as well.
 */
#ifndef DPT_TESTS_SOAK_POKES_H
#define DPT_TESTS_SOAK_POKES_H

#include <stdint.h>

/* So many pokes, over all targets and instruments; prints a line of what was done. */
void soak_pokes(uint64_t count, uint64_t seed);

#endif
