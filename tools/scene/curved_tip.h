/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Curved tips of a tool (docs/algorithms/convex.md): the hull round one, which a proxy feels, and the wrench of them
 * where the tool has no proxy. In a build without libccd there are none.
 */
#ifndef DPT_TOOLS_CURVED_TIP_H
#define DPT_TOOLS_CURVED_TIP_H

#include <stdio.h>

#include "cli/force_options.h"
#include "dynpoint/convex.h"
#include "scene/tip_shape.h"

/* NULL if this build supports curved tips; else the reason, for the end of a message. */
const char *curved_tip_left_out(void);

/*
 * The hull that holds it: corners in the tool's frame, and a radius; there is room for DPT_HULL_CORNERS_MAX.
 *   error  m: the hull exceeds the tip by this much at most
 *
 * Returns DPT_E_UNSUPPORTED in a build without curved tips.
 */
dpt_result curved_tip_corners(const struct tip_shape *tip, double *corners, uint32_t *count, double *radius,
                              double *error);

/* All of a tool, felt without a proxy. Begin with zeros and with the bodies; it stays where it is, as long as the tool. */
struct curved_tips {
    dpt_convex_body bodies[DPT_ARM_BODIES_MAX];
    uint32_t body_ids[DPT_ARM_BODIES_MAX];
    uint32_t body_count;
    dpt_convex_shape shape[TIP_SHAPES_MAX];
    dpt_convex_shaper shaper[TIP_SHAPES_MAX];
    dpt_convex_contact contact[TIP_SHAPES_MAX]; /* of the last step */
    uint32_t count;
    double error;      /* m: of the depths that were proven so far, the largest error */
    uint64_t unproven; /* depths for which nothing proved that there is no shorter way out */
};

/* Let a rigid tool feel them from now on, by a law that has no proxy. */
dpt_result curved_tips_attach(struct curved_tips *tips, const struct tip_shapes *shapes, dpt_world *world,
                              dpt_tool tool, const struct force_options *force);

/* Call before each step. A tool whose step gives no answer then feels no force. */
void curved_tips_begin_tick(struct curved_tips *tips);

/*
 * After it: 1 if how deep one is could not be told, as more triangles than libdynpoint_convex takes are near; J, what they
 * store; and the tool's hit becomes that of the deepest one, if one is deeper.
 */
int curved_tips_have_failed(const struct curved_tips *tips);
double curved_tips_energy(const struct curved_tips *tips);
void curved_tips_deepen(const struct curved_tips *tips, dpt_hit *hit);

/*
 * A line for people: how well they are felt. Without curved tips none.
 *   hull_error  m, of the hulls that a proxy feels
 */
void curved_tips_print_error(FILE *file, const struct curved_tips *tips, double hull_error);

#endif
