/* SPDX-License-Identifier: BSD-3-Clause */
/* Poses and their turns. */
#ifndef DPT_TESTS_POSE_H
#define DPT_TESTS_POSE_H

#include "dynpoint/types.h"
#include "lib/vector.h"

/* v turned by a unit quaternion. */
static inline void turn3(const double q[4], const double v[3], double out[3])
{
    const double *u = q + 1;
    double twice[3], turned[3];
    for (int k = 0; k < 3; k++)
        twice[k] = 2 * (u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
    for (int k = 0; k < 3; k++)
        turned[k] = v[k] + q[0] * twice[k] + u[(k + 1) % 3] * twice[(k + 2) % 3] - u[(k + 2) % 3] * twice[(k + 1) % 3];
    for (int k = 0; k < 3; k++)
        out[k] = turned[k];
}

/* v turned back. */
static inline void turn_back3(const double q[4], const double v[3], double out[3])
{
    const double back[4] = { q[0], -q[1], -q[2], -q[3] };
    turn3(back, v, out);
}

/* A point of the pose's frame, in the world. */
static inline void pose_point(const dpt_pose *pose, const double x[3], double out[3])
{
    turn3(pose->orientation, x, out);
    for (int k = 0; k < 3; k++)
        out[k] += pose->position[k];
}

/* A segment of the pose's frame, in the world, as its two ends. */
static inline void pose_ends(const dpt_pose *pose, const dpt_segment *segment, double ends[6])
{
    pose_point(pose, segment->a, ends);
    pose_point(pose, segment->b, ends + 3);
}

/* Turn a pose about its position by a quaternion of any length. */
static inline void pose_turn_by(dpt_pose *pose, const double t[4])
{
    const double *q = pose->orientation;
    const double made[4] = { t[0] * q[0] - t[1] * q[1] - t[2] * q[2] - t[3] * q[3],
                             t[0] * q[1] + t[1] * q[0] + t[2] * q[3] - t[3] * q[2],
                             t[0] * q[2] - t[1] * q[3] + t[2] * q[0] + t[3] * q[1],
                             t[0] * q[3] + t[1] * q[2] - t[2] * q[1] + t[3] * q[0] };
    const double size = sqrt(made[0] * made[0] + made[1] * made[1] + made[2] * made[2] + made[3] * made[3]);
    for (int k = 0; k < 4; k++)
        pose->orientation[k] = made[k] / size;
}

/* Set the orientation: `angle` rad about a unit axis. */
static inline void pose_orient(dpt_pose *pose, const double axis[3], double angle)
{
    pose->orientation[0] = cos(angle / 2);
    for (int k = 0; k < 3; k++)
        pose->orientation[1 + k] = sin(angle / 2) * axis[k];
}

#endif
