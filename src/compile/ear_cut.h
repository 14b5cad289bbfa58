/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Cut a polygon of a plane into triangles by its ears. A hole is a part of the polygon, joined to the rest by a bridge
 * that is run through in both directions (a keyhole). Edges may touch, and corners may repeat.
 *
 * No triangle is wound clockwise, but for rounding. The polygon is the sum of its triangles' borders, so each point is in
 * as many triangles as the polygon winds about it: once within a polygon that does not cross itself, never outside.
 */
#ifndef DPT_COMPILE_EAR_CUT_H
#define DPT_COMPILE_EAR_CUT_H

#include <stddef.h>
#include <stdint.h>

/*
 * Units of work that a polygon may take: so many a corner, and so many more. A unit is a box or a corner that a triangle
 * is compared with. Measured are 30 to 450 a corner; 10^5 corners that use all of it take 5 s.
 */
#define EAR_WORK_PER_CORNER 8192u
#define EAR_WORK_MIN        (1u << 20)

enum ear_result {
    EAR_DONE,
    EAR_CROSSING, /* the polygon crosses itself */
    EAR_TOO_LONG, /* it takes too much work */
    EAR_NO_MEMORY
};

/* Memory that is used again for the next polygon. Begin with a zeroed struct. */
struct ear_cutter {
    struct ear_corner *corners;
    struct ear_box *boxes;
    struct ear_place *places;
    uint32_t *queue;
    size_t corner_capacity, box_capacity, place_capacity, queue_capacity;
    uint64_t work; /* of the last polygon */
};

void ear_cutter_free(struct ear_cutter *cutter);

/*
 * Cut a polygon of n >= 3 corners, counterclockwise.
 *
 *   xy         its corners, which are floats' values
 *   rounding   of a coordinate: where the polygon touches itself, it may cross itself by so much
 *   triangles  receives three corners each, from 0, of n - 2 triangles; some may have no area
 */
enum ear_result ear_cut(struct ear_cutter *cutter, const double (*xy)[2], uint32_t n, double rounding,
                        uint32_t *triangles);

#endif
