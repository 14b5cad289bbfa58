/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The inner loops: lower bounds of 16 distances at once, in float. The loop is written once
 * (kernel_body.h) and compiled per instruction set; all give the same bits (tests/kernel/test_kernel_bits.c).
 *
 * The filter's frame: coordinates are (x - centre) * scale with the mesh's filter_centre and
 * filter_scale, so that every vertex lies within -1..1.
 *
 * What makes a bound sound: for ANY direction n, min over the vertices of n.v minus max(n.A, n.B), over
 * |n|, is a lower bound of the distance from segment AB to their hull. However badly a lane guesses its
 * n, only tightness suffers. What is left is the rounding of a few dot products: kernel_margin.
 */
#ifndef DPT_KERNEL_OPS_H
#define DPT_KERNEL_OPS_H

#include "base/lanes.h"
#include "dynpoint/kernel.h"
#include "dynpoint/types.h"

/*
 * A bound that is reported may lie above the true distance by at most kernel_margin(|A|, |B|), in the filter's
 * frame, and by KERNEL_STRETCH of itself, since a direction may be longer than 1. docs/algorithms/bvh.md adds
 * up the terms: at most 47 + 20 |A| + |B| units of 2^-24, and 10 of the bound.
 */
static inline double kernel_margin(double a, double b)
{
    return (56.0 + 24.0 * a + 4.0 * b) * 0x1p-24;
}
#define KERNEL_STRETCH 0x1p-20

/* 16 planes: all of a lane's vertices have x nx + y ny + z nz >= support. Zeros are no plane at all. */
struct planes {
    float x[LANES], y[LANES], z[LANES]; /* about unit length */
    float support[LANES];
};

/* A tool axis in the filter's frame, and a right-handed frame with x along it (unit rows). */
struct filter_segment {
    float a[3], b[3];
    float limit;  /* a bound beyond it decides */
    float margin; /* by which a bound may be above the truth */
    float x[3], y[3], z[3];
    float length;
    float normal[3]; /* of the plane through the best pair */
    float height;    /* the larger of normal.a and normal.b */
};

/*
 * What an axis in motion covers: the four points where its ends are at two times span a hull that holds it all
 * along. The bounds are those of that hull, as sound as others by kernel_margin, twice with its farthest end.
 */
struct swept_hull {
    float end[4][3];
    float axis[3]
              [3]; /* orthonormal, of a box around them: along the tool, its motion, across both */
    float centre[3], half[3]; /* of that box, which only tells where to look for planes */
    float limit;
};

/*
 *   held_*     the bounds that 16 kept planes give now
 *   boxes      16 new planes, and the bounds that they give; likewise triangles
 *   better     of those and of kept ones, lane by lane those with the greater bound, in place of the kept ones; a
 *              kept bound that is no number is the lesser
 *   swept_*    bounds of the distance to a hull; nothing is kept
 *   point_*    the same of a point, whose distance to a box is exact but for rounding
 *   common_*   the supports along one normal, into `low`; open are those that are not above `beyond`
 *
 * Blocks of boxes: 6 rows of 16, centre x, y, z, half width x, y, z; of triangles: 9 rows of 16, corner 0 x, y,
 * z, corner 1 ..., corner 2 ...
 *
 * Returns the lanes that are open: whose bound is not beyond the limit.
 */
typedef uint32_t kernel_cached(const float *block, const struct filter_segment *segment,
                               const struct planes *planes, float *bound);
typedef uint32_t kernel_new_planes(const float *block, const struct filter_segment *segment,
                                   struct planes *planes, float *bound);
typedef void kernel_better(const struct planes *made, const float *made_bound,
                           struct planes *planes, float *bound);
typedef uint32_t kernel_common(const float *block, const float normal[3], float beyond, float *low);

typedef uint32_t kernel_swept(const float *block, const struct swept_hull *hull, float *bound);

/* Of a tool without length: squares of the bounds, open where they are not above `limit`, a square too. */
typedef uint32_t kernel_point(const float *block, const float at[3], float limit, float *bound);

/*
 * For the winding number, docs/algorithms/winding.md. Both add what they know of 16 lanes to 16 sums, and
 * return the lanes of which they added nothing.
 *
 *   moments   16 sets of triangles, of rows that moments.h makes, as seen from `at`, in the filter's frame;
 *             adds to doubt[] what each may be wrong by; open are those that may be wrong by `most` or more
 *   angles    `lanes` of the 16 triangles of a leaf; open are those that fill so much of the view, or are so
 *             near, that float does not do
 */
typedef uint32_t kernel_moments(const float *block, const float at[3], float most, float *winding,
                                float *doubt);
typedef uint32_t kernel_angles(const float *block, const float at[3], uint32_t lanes,
                               float *winding);

/*
 * A triangle's angle in float: as much of |a| |b| |c| as its cosine's numerator must have, and the square of how far
 * its corners must be, so that it matters little that x is rounded.
 */
#define KERNEL_ANGLE_OPEN 0x1p-4f
#define KERNEL_ANGLE_NEAR 0x1p-24f

struct kernel {
    kernel_cached *cached_boxes;
    kernel_cached *cached_triangles;
    kernel_new_planes *boxes;
    kernel_new_planes *triangles;
    kernel_better *better;
    kernel_common *common_boxes;
    kernel_common *common_triangles;
    kernel_swept *swept_boxes;
    kernel_swept *swept_triangles;
    kernel_point *point_boxes;
    kernel_point *point_triangles;
    kernel_moments *moments;
    kernel_angles *angles;
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
int dpti_kernel_get(uint32_t id, struct kernel *kernel, uint32_t *chosen);

#define KERNEL_DECLARE(set)                                                                        \
    kernel_cached dpti_kernel_##set##_held_boxes, dpti_kernel_##set##_held_triangles;              \
    kernel_new_planes dpti_kernel_##set##_boxes, dpti_kernel_##set##_triangles;                    \
    kernel_better dpti_kernel_##set##_better;                                                      \
    kernel_common dpti_kernel_##set##_common_boxes, dpti_kernel_##set##_common_triangles;          \
    kernel_swept dpti_kernel_##set##_swept_boxes, dpti_kernel_##set##_swept_triangles;             \
    kernel_point dpti_kernel_##set##_point_boxes, dpti_kernel_##set##_point_triangles;             \
    kernel_moments dpti_kernel_##set##_moments;                                                    \
    kernel_angles dpti_kernel_##set##_angles;
KERNEL_DECLARE(scalar)
KERNEL_DECLARE(sse2)
KERNEL_DECLARE(avx2)
KERNEL_DECLARE(avx512)
KERNEL_DECLARE(neon)
#undef KERNEL_DECLARE

#endif
