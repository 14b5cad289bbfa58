/* SPDX-License-Identifier: BSD-3-Clause */
/* The tips of a scene's tool: those that the user says, then those of an arm's tool, which its jaws move. */
#ifndef DPT_SCENE_TIPS_H
#define DPT_SCENE_TIPS_H

#include <stdint.h>

#include "dynpoint/arm.h"
#include "dynpoint/tip.h"
#include "scene/tip_shape.h"

/* How the jaws of a tool move: from one share of their range to another. */

/* A share is 0 at the lower limit, 1 at the upper one. */
struct jaw_motion {
    int is_given; /* 0: the jaws stand at 0, or at their limit nearest to 0 */
    double from, to;
    double seconds; /* of the loop's time, for the way */
    double button;  /* while it is down they go there, else back; -1: they go when the loop begins */
};

/* Read "SHARE", "FROM:TO:SECONDS" or "FROM:TO:SECONDS:BUTTON". 0: it is none. */
int jaw_motion_parse(struct jaw_motion *motion, const char *text, const char *end);

/* The same of a setting of this name (setting_words.h), and whether there is such a motion. */
dpt_result jaw_motion_read(struct jaw_motion *motion, const char *name, const char *text, dpt_host_error *error);

/* Why there is no such motion, for the end of a message; NULL: there is one. */
const char *jaw_motion_fault(const struct jaw_motion *motion);

/* So long they have been on their way after a tick of dt, s, with these of the device's buttons down. */
double jaw_motion_time(const struct jaw_motion *motion, double time, double dt, uint32_t buttons);

/* Where the jaws are after so many seconds on their way. */
double jaw_motion_share(const struct jaw_motion *motion, double time);

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
    int has_seen_jaws;  /* what the tool looks like has jaws, which are not felt */
    struct jaw_motion motion;
    double time; /* s, on the way of the motion */
};

/* After has_seen_jaws was set. The error names `path`, and the motion by `jaw` (setting_words.h). `arm` may be NULL. */
dpt_result scene_tips_make(struct scene_tips *tips, const char *path, const char *jaw, const struct tip_shapes *shapes,
                           const dpt_arm *arm, const struct jaw_motion *motion, dpt_host_error *error);
void scene_tips_close(struct scene_tips *tips);

/* Give them to the tool. */
dpt_result scene_tips_add(const struct scene_tips *tips, dpt_world *world, dpt_tool tool);

/* Before a step by dt, s, with these of the device's buttons down: send the tips to where their jaws are. */
dpt_result scene_tips_move(struct scene_tips *tips, dpt_world *world, dpt_tool tool, double dt, uint32_t buttons);

/* How far the jaws are open: 0 closed, 1 wholly; half where nothing moves them. */
double scene_tips_opening(const struct scene_tips *tips);

/* The ends of a tip's axis, in the tool's frame. */
void scene_tips_axis(const struct scene_tips *tips, uint32_t tip, double a[3], double b[3]);

/* m: how far the tips reach below the tool's origin while it is not turned, y being up; at least `min`. */
double scene_tips_drop(const struct scene_tips *tips, double min);

#endif
