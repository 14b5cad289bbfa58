/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The inner loops: lower bounds of 16 distances at once, in float. The loop is written once
 * (kernel_body.h) and compiled per instruction set; all give the same bits (tests/test_kernel.c).
 *
 * The filter's frame: coordinates are (x - centre) * scale with the mesh's filter_centre and
 * filter_scale, so that every vertex lies within -1..1.
 *
 * What makes a bound sound: for ANY direction n, min over the vertices of n.v minus max(n.A, n.B), over
 * |n|, is a lower bound of the distance from segment AB to their hull. However badly a lane guesses its
 * n, only tightness suffers. What is left is the rounding of a few dot products: KERNEL_MARGIN.
 */
#ifndef DPT_KERNEL_H
#define DPT_KERNEL_H

#include "dynpoint/types.h"

#define LANES 16

/*
 * A bound that is reported may lie above the true distance by at most
 * KERNEL_MARGIN * (1 + |A| + |B|), in the filter's frame. docs/algorithms/tree.md adds up the terms:
 * at most 34 units of 2^-24; 48 are allowed for.
 */
#define KERNEL_MARGIN (48.0f * 0x1p-24f)

/* A tool axis in the filter's frame, and a right-handed frame with x along it (unit rows). */
struct probe {
    float a[3];
    float x[3], y[3], z[3];
    float length;
    float normal[3]; /* of the plane that `planes` asks about, about unit length */
    float height;    /* the larger of normal.A and normal.B */
};

/*
 *   boxes      block: 6 rows of 16: centre x, y, z, half width x, y, z
 *   triangles  block: 9 rows of 16: corner 0 x, y, z, corner 1 ..., corner 2 ...
 *   planes     the same block; every lane tries the probe's normal instead of one of its own
 *   bound      16 lower bounds; a lane that is not finite is not decided
 */
typedef void kernel_fn(const float *block, const struct probe *probe, float *bound);

struct kernel {
    kernel_fn *boxes;
    kernel_fn *triangles;
    kernel_fn *planes;
};

/* The widest kernel that every machine of this kind has. */
#if defined(DPT_SCALAR)
#define DPT_KERNEL_ALWAYS DPT_KERNEL_SCALAR
#elif defined(__x86_64__)
#define DPT_KERNEL_ALWAYS DPT_KERNEL_SSE2
#elif defined(__aarch64__)
#define DPT_KERNEL_ALWAYS DPT_KERNEL_NEON
#else
#define DPT_KERNEL_ALWAYS DPT_KERNEL_SCALAR
#endif

/* DPT_KERNEL_AUTO gives the best one. Nonzero when this build and machine have it. */
int kernel_get(uint32_t id, struct kernel *kernel, uint32_t *chosen);

kernel_fn kernel_scalar_boxes, kernel_scalar_triangles, kernel_scalar_planes;
kernel_fn kernel_sse2_boxes, kernel_sse2_triangles, kernel_sse2_planes;
kernel_fn kernel_avx2_boxes, kernel_avx2_triangles, kernel_avx2_planes;
kernel_fn kernel_avx512_boxes, kernel_avx512_triangles, kernel_avx512_planes;
kernel_fn kernel_neon_boxes, kernel_neon_triangles, kernel_neon_planes;

#endif
