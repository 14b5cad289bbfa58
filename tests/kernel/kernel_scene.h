/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Random blocks of 16 triangles and random tools, for the tests of the float bounds. All coordinates are those of the
 * filter's frame: triangles lie within -1..1.
 */
#ifndef DPT_TESTS_KERNEL_SCENE_H
#define DPT_TESTS_KERNEL_SCENE_H

#include "base/angle.h"
#include "kernel/kernel_ops.h"
#include "lib/check.h"
#include "mesh/mesh_format.h"
#include "nearest/segment_triangle.h"

/* How many blocks a test of bounds asks. */
#define BLOCKS ((int)part_of(20000))

/* Kinds of triangles: of any shape, long and thin, of one point, all in one plane. */
enum shape { ORDINARY, SLIVERS, POINTS, FLAT, SHAPES };

/* Uniform in -1..1. */
float coordinate(uint64_t *random);

/* 16 triangles within -1..1 of one kind. */
void make_triangles(uint64_t *random, int shape, float block[9 * LANES]);

/* An axis in double, and the filter segment that the search makes of it. */
struct tool {
    vec3 a, u;
    vec3 x; /* the direction of u, also where u is zero */
    struct filter_segment filter;
};

/* Each coordinate within `reach` of 0. */
vec3 random_vec(uint64_t *random, double reach);

/* Set the direction in which the filter segment is wide, and how far it reaches along it. */
void put_normal(vec3 normal, struct filter_segment *segment);

/* The axis from a, of length `size` along the unit vector x, with a random limit. */
struct tool tool_at(uint64_t *random, vec3 a, vec3 x, double size);

/* Any tool; with FLAT mostly in the plane of the triangles. */
struct tool make_tool(uint64_t *random, int shape);

/* One whose ends are farther out than all triangles: each lies beside it. */
struct tool make_long_tool(uint64_t *random);

/* The same tool at another pose: 1e-6 .. 1 away, and turned by as many radians. */
struct tool move_tool(uint64_t *random, const struct tool *tool);

/* Corner k of the triangle in a lane. */
vec3 corner(const float *block, int k, int lane);

/* The kernel that a world of this machine uses. */
struct kernel best_kernel(void);

/* Move the triangles of random lanes to the axis's end A, where no plane separates them. Returns those lanes. */
uint32_t degenerate_lanes(uint64_t *random, const struct tool *tool, float block[9 * LANES]);

#endif
