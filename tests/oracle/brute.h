/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The distance of a segment to a whole mesh by looking at every triangle, in plain double and with
 * code of its own: it shares nothing with the library and nothing with pair.h.
 *
 * Each triangle gets a frame of its own in which it is flat, its longest edge the first axis; there
 * the nearest pair is the least of those that can be: an end against the triangle, the crossing of
 * its plane against the triangle, a corner against the segment, an edge against the segment. Each
 * of these is evaluated at points that exist, so no decision that rounding gets wrong yields too
 * small a distance.
 *
 * Within 1e-14 of the largest coordinate, slivers included (tests/nearest/test_pair.c measures it against
 * pair.h; it is stated as 1e-12 for those who compare with it). It cannot judge which triangle is
 * the right one among those that are equal within that: ask oracle_brute_triangle how far the one
 * in question is. It knows no pose and no radius: move the segment into the mesh's frame first.
 *
 * A triangle with a corner number beyond the vertices is left out, so a caller drops one by setting
 * its corners to UINT32_MAX.
 */
#ifndef DPT_TESTS_ORACLE_BRUTE_H
#define DPT_TESTS_ORACLE_BRUTE_H

#include <stddef.h>
#include <stdint.h>

typedef struct oracle_mesh oracle_mesh;

/*
 * A mesh from plain arrays, which it does not keep: x, y, z of each vertex, three corner numbers of
 * each triangle. NULL when there is no memory.
 */
oracle_mesh *oracle_brute_open(const float *vertices, uint32_t vertex_count, const uint32_t *corners,
                               uint32_t triangle_count);
void oracle_brute_close(oracle_mesh *mesh);

/*
 * The least distance of the segment ax, ay, az, bx, by, bz to the mesh: infinity if it has no
 * triangle. `triangle`, which may be NULL, gets the least number that has exactly this distance, or
 * UINT32_MAX.
 */
double oracle_brute(const oracle_mesh *mesh, const double segment[6], uint32_t *triangle);

/* The distance to one triangle; infinity if there is none of this number. */
double oracle_brute_triangle(const oracle_mesh *mesh, uint32_t triangle, const double segment[6]);

#endif
