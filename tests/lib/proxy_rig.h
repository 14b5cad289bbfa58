/* SPDX-License-Identifier: BSD-3-Clause */
/* For tests of proxies: a mesh, a world with it, and a tool with a proxy. */
#ifndef DPT_TESTS_PROXY_RIG_H
#define DPT_TESTS_PROXY_RIG_H

#include "lib/solid.h"

enum { RIG_SEGMENTS = 4 };

struct rig {
    void *block;
    dpt_world *world;
    dpt_body body;
    dpt_tool tool;
    dpt_segment segments[RIG_SEGMENTS]; /* in the tool's frame */
    uint32_t count;
    dpt_pose device, proxy;
    dpt_force_info force;
    dpt_step step;
};

#define RIG_STIFFNESS 500.0
#define RIG_DT        1e-3

/* `def` may be NULL: the default one, with a proxy; its law is set in any case. */
void rig_open(struct rig *rig, const dpt_world_def *def, const dpt_mesh *mesh, const dpt_segment *segments,
              uint32_t count);
void rig_close(struct rig *rig);

/* The device's pose; the step; what it gave. */
void rig_step(struct rig *rig);

/* The device jumps to rig->device, and the world takes two steps: what begins in the open is outside then. */
void rig_place(struct rig *rig);

/* A segment of the proxy in the world, as two ends. */
void rig_proxy_ends(const struct rig *rig, uint32_t segment, double ends[6]);

/* The rotation of a pose, applied. */
void rig_turn(const double orientation[4], const double v[3], double turned[3]);

/* Turn a pose about its position by a quaternion of any length. */
void rig_turn_by(dpt_pose *pose, const double turn[4]);

/* Set the orientation: `angle` rad about a unit axis. */
void rig_orient(dpt_pose *pose, const double axis[3], double angle);

/* All settings of the body; its size is filled in. */
void rig_set_body(const struct rig *rig, dpt_body_settings settings);

/* Draw another stiffness, and in a third of all cases each friction on its body and a stiffness against turns. */
void rig_vary(struct rig *rig, uint64_t *seed);

/* |force| */
double rig_force(const struct rig *rig);

#endif
