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

/* A point of the world, in the pose's frame. */
static inline void pose_local(const dpt_pose *pose, const double x[3], double out[3])
{
    const double off[3] = { x[0] - pose->position[0], x[1] - pose->position[1], x[2] - pose->position[2] };
    turn_back3(pose->orientation, off, out);
}

/* A segment of the pose's frame, in the world; as its two ends too. */
static inline dpt_segment pose_segment(const dpt_pose *pose, const dpt_segment *segment)
{
    dpt_segment placed = *segment;
    pose_point(pose, segment->a, placed.a);
    pose_point(pose, segment->b, placed.b);
    return placed;
}

static inline void pose_ends(const dpt_pose *pose, const dpt_segment *segment, double ends[6])
{
    pose_point(pose, segment->a, ends);
    pose_point(pose, segment->b, ends + 3);
}

/* The turn q, then p. */
static inline void turn_times(const double p[4], const double q[4], double out[4])
{
    const double made[4] = { p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
                             p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
                             p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
                             p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0] };
    for (int k = 0; k < 4; k++)
        out[k] = made[k];
}

/* The turn from z to a unit direction. */
static inline void turn_from_z(const double to[3], double q[4])
{
    q[0] = 1 + to[2];
    q[1] = -to[1];
    q[2] = to[0];
    q[3] = 0;
    const double size = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    for (int k = 0; k < 4; k++)
        q[k] = size > 1e-9 ? q[k] / size : (double)(k == 1);
}

/* Turn a pose about its position by a quaternion of any length. */
static inline void pose_turn_by(dpt_pose *pose, const double turn[4])
{
    double made[4];
    turn_times(turn, pose->orientation, made);
    const double size = sqrt(made[0] * made[0] + made[1] * made[1] + made[2] * made[2] + made[3] * made[3]);
    for (int k = 0; k < 4; k++)
        pose->orientation[k] = made[k] / size;
}

/* Within `reach` of the origin in each coordinate, turned any way; all turns are as likely. */
static inline dpt_pose pose_random(uint64_t *seed, double reach)
{
    dpt_pose pose;
    for (int k = 0; k < 3; k++)
        pose.position[k] = random_in(seed, -reach, reach);
    unit_random(seed, pose.orientation, 4);
    return pose;
}

/* The same by random_turn. */
static inline dpt_pose pose_any(uint64_t *seed, double reach)
{
    dpt_pose pose;
    for (int k = 0; k < 3; k++)
        pose.position[k] = random_in(seed, -reach, reach);
    random_turn(seed, pose.orientation);
    return pose;
}

/* Set the orientation: `angle` rad about a unit axis. */
static inline void pose_orient(dpt_pose *pose, const double axis[3], double angle)
{
    pose->orientation[0] = cos(angle / 2);
    for (int k = 0; k < 3; k++)
        pose->orientation[1 + k] = sin(angle / 2) * axis[k];
}

/* rad: the angle of the shorter turn. */
static inline double pose_angle(const dpt_pose *from, const dpt_pose *to)
{
    const double *p = from->orientation, *q = to->orientation;
    double same = 0.0, minus = 0.0, plus = 0.0;
    for (int k = 0; k < 4; k++) {
        same += p[k] * q[k];
        minus += (p[k] - q[k]) * (p[k] - q[k]);
        plus += (p[k] + q[k]) * (p[k] + q[k]);
    }
    return same < 0.0 ? 4.0 * atan2(sqrt(plus), sqrt(minus)) : 4.0 * atan2(sqrt(minus), sqrt(plus));
}

#endif
