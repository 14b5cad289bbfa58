/* SPDX-License-Identifier: BSD-3-Clause */
/* The tips of a scene's tool: those that the user says, then those of an arm's tool, which its jaws move. */
#ifndef DPT_TOOLS_SCENE_TIPS_H
#define DPT_TOOLS_SCENE_TIPS_H

#include "dynpoint/arm.h"
#include "dynpoint/tip.h"
#include "scene/jaw_motion.h"
#include "scene/tip_shape.h"

enum { SCENE_TIPS_MAX = TIP_SHAPES_MAX + DPT_ARM_TIPS_MAX };

/* Begin with zeros. */
struct scene_tips {
    struct tip_shapes shapes;
    const dpt_hull *hulls[SCENE_TIPS_MAX];
    void *blocks[SCENE_TIPS_MAX];
    dpt_pose poses[SCENE_TIPS_MAX]; /* of the hulls in the tool's frame, as last set */
    uint32_t count;
    const dpt_arm *arm; /* NULL: there are shapes alone */
    uint32_t jaws;      /* of the arm */
    struct jaw_motion motion;
    double time; /* s, on the way of the motion */
};

/* Returns 0, or 2 after a message that names `path`. `arm` may be NULL. */
int scene_tips_make(struct scene_tips *tips, const char *command, const char *path, const struct tip_shapes *shapes,
                    const dpt_arm *arm, const struct jaw_motion *motion);
void scene_tips_close(struct scene_tips *tips);

/* Give them to the tool. */
dpt_result scene_tips_add(const struct scene_tips *tips, dpt_world *world, dpt_tool tool);

/* Before a step by dt, s, with these of the device's buttons down: send the tips to where their jaws are. */
dpt_result scene_tips_move(struct scene_tips *tips, dpt_world *world, dpt_tool tool, double dt, uint32_t buttons);

/* The ends of a tip's axis, in the tool's frame. */
void scene_tips_axis(const struct scene_tips *tips, uint32_t tip, double a[3], double b[3]);

/* m: how far the tips reach below the tool's origin while it is not turned, y being up; at least `least`. */
double scene_tips_drop(const struct scene_tips *tips, double least);

#endif
