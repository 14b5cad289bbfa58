/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The text of a recording's header: lines "key=value" with what a replay needs to make the same scene again
 * (docs/format.md). A key that is not known is skipped.
 */
#ifndef DPT_SCENE_TEXT_H
#define DPT_SCENE_TEXT_H

#include "dynpoint/record.h"
#include "scene/scene.h"

enum { SCENE_TEXT_NAME = 4096, SCENE_TEXT_NO_CLUTCH = 32, SCENE_TEXT_OWN_FRICTION = -1 };

/* Names are paths and the device's, as they were given; "" if none was. */
struct scene_text {
    char scene[SCENE_TEXT_NAME], tool[SCENE_TEXT_NAME], device[SCENE_TEXT_NAME];
    char device_kind[64], law[16];
    uint64_t scene_bytes, scene_crc32, tool_bytes, tool_crc32;
    uint64_t budget;       /* units of work a step; 0: unlimited */
    uint64_t sweep_budget; /* of them, for sweeps; likewise, as of a recording that does not tell it */
    uint64_t device_flags, pose_dofs, wrench_dofs, joints;
    double origin_x, origin_y, origin_z; /* of the device, in the scene's frame, m */
    double zoom, length, radius;
    double stiffness, friction, damping;
    double rotational_stiffness; /* 0: by the tool's shape, as in a recording that does not tell it */
    double force_max;            /* that the guard lets through, N */
    double force_scale;
    uint64_t embedded;  /* 1: the recording carries the files of scene and tool, where they have some */
    uint64_t clutch;    /* button, or SCENE_TEXT_NO_CLUTCH */
    uint64_t passivity; /* 1: there was an observer, with these fields of its def */
    double passive_damping, passive_spin_damping, passive_force_max, passive_torque_max;
    double passive_force_slew, passive_torque_slew, passive_delay;
    /* 1: the setting is that of a plan, with these fields of it (docs/plan.md). */
    uint64_t planned;
    uint64_t plan_until, plan_certificate_bytes, plan_max_contacts, plan_smooth_normals;
    uint64_t plan_sweep_budget, plan_strip_capacity, plan_iterations;
    uint64_t plan_rigid_low, plan_rigid_high; /* bodies 0 to 31, and 32 to 63, as bits */
    uint64_t plan_integrator;                 /* 0: the scene's; else 1 + DPT_INTEGRATOR_... */
    double plan_margin;
    double physics;         /* Hz, of what is soft, by the loop's time; 0: in each tick */
    struct tip_shapes tips; /* of the tool; each has a line of its own */
    struct jaw_motion jaw;
    uint32_t piercing; /* DPT_PIERCING_... */
};

/* Of a scene whose world was made. The device's name, the guard's limit and the budget are left to the caller. */
void scene_text_of(struct scene_text *text, const struct scene *scene, const struct scene_def *def);

/* Write it into `out`, the tool's segments and tips at its end. */
dpt_result scene_text_write(const struct scene_text *text, const struct scene *scene, char out[DPT_RECORD_TEXT_MAX + 1],
                            dpt_host_error *error);

/* Read it. The error names the line and the file. */
dpt_result scene_text_read(struct scene_text *text, const char *path, const char *in, dpt_host_error *error);

#endif
