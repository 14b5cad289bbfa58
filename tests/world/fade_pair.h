/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Two worlds with the same input: one whose pushes fade, and one with a fade of 0, whose wrench is that of the tick
 * alone. From the second follows what the first must say, tick by tick.
 */
#ifndef DPT_TESTS_FADE_PAIR_H
#define DPT_TESTS_FADE_PAIR_H

#include "lib/fixture.h"
#include "lib/rig.h"

enum { FADES = 0, TRUE_ONE = 1, BODIES = 2 };

struct pair {
    struct rig rig[2];
    dpt_body body[2][BODIES];
    double fade, dt;
    dpt_force_info reported, truth; /* of the last step */
    dpt_hit hit;
    double left;       /* of the fade, as it must be */
    unsigned begun;    /* fades that began */
    unsigned ticks;    /* that faded */
    unsigned taken_up; /* fades in which contact came to be known again */
    dpt_body sided;    /* through whose sheet the last true push went back, or 0 */
    int was_unknown, was_full;
};

int pair_open(struct pair *pair, const struct fixture *mesh, const dpt_pose *pose, const dpt_segment *segments,
              uint32_t count, const dpt_world_def *like, double dt);

static inline void pair_close(struct pair *pair)
{
    rig_close(&pair->rig[0]);
    rig_close(&pair->rig[1]);
}

static inline double number_of(const dpt_wrench *wrench, int k)
{
    return k < 3 ? wrench->force[k] : wrench->torque[k - 3];
}

static inline double size_of_force(const dpt_wrench *wrench)
{
    const double *f = wrench->force;
    return sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
}

/* A tick of both worlds. Of a tool of one segment. */
void pair_step(struct pair *pair);

static inline void pair_pose(struct pair *pair, const dpt_pose *pose)
{
    for (int w = 0; w < 2; w++)
        dpt_tool_set_pose(pair->rig[w].world, pair->rig[w].tool, pose);
}

dpt_pose pose_at(double x, double y, double z);

/* To another place in ticks of half a millimetre. */
void pair_go(struct pair *pair, const dpt_pose *from, const dpt_pose *to);

#endif
