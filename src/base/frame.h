/* SPDX-License-Identifier: BSD-3-Clause */
/* Poses as matrices: checked and normalised once. */
#ifndef DPT_FRAME_H
#define DPT_FRAME_H

#include "base/vec3.h"
#include "dynpoint/types.h"

struct frame {
    vec3 origin;
    vec3 x, y, z; /* the frame's axes in the world */
};

static const struct frame frame_identity = {
    { 0.0, 0.0, 0.0 }, { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 0.0, 0.0, 1.0 }
};

/*
 * The frame of a pose; NULL is the identity. The identity pose gives the exact identity matrix. DPT_E_FINITE for a
 * position out of range, DPT_E_POSE for a quaternion whose length is not 1 within 1e-6; `frame` is the identity then.
 */
static inline dpt_result frame_of_pose(const dpt_pose *pose, struct frame *frame)
{
    *frame = frame_identity;
    if (!pose)
        return DPT_OK;
    const double *q = pose->orientation;
    double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    if (!vec3_within(pose->position, DPT_COORDINATE_MAX))
        return DPT_E_FINITE;
    if (!(fabs(square - 1.0) <= 2e-6))
        return DPT_E_POSE;
    double norm = sqrt(square);
    double w = q[0] / norm, x = q[1] / norm, y = q[2] / norm, z = q[3] / norm;
    frame->origin = vec3_of(pose->position);
    frame->x = (vec3){ 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y) };
    frame->y = (vec3){ 2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x) };
    frame->z = (vec3){ 2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y) };
    return DPT_OK;
}

/* 1 if two poses have exactly equal numbers. */
static inline int pose_is_same(const dpt_pose *pose, const dpt_pose *other)
{
    int same = 1;
    for (int k = 0; k < 3; k++)
        same &= pose->position[k] == other->position[k];
    for (int k = 0; k < 4; k++)
        same &= pose->orientation[k] == other->orientation[k];
    return same;
}

/*
 * The middle of two valid poses: the position on a line, the orientation on the shorter arc. If the orientations are
 * opposite, no arc is shorter, and the orientation is that of `from`.
 */
static inline dpt_pose pose_middle(const dpt_pose *from, const dpt_pose *to)
{
    dpt_pose middle;
    double cosine = 0.0, square = 0.0;
    for (int k = 0; k < 3; k++)
        middle.position[k] = 0.5 * (from->position[k] + to->position[k]);
    for (int k = 0; k < 4; k++)
        cosine += from->orientation[k] * to->orientation[k];
    for (int k = 0; k < 4; k++) {
        double sum = from->orientation[k] + (cosine < 0.0 ? -1.0 : 1.0) * to->orientation[k];
        middle.orientation[k] = sum;
        square += sum * sum;
    }
    for (int k = 0; k < 4; k++)
        middle.orientation[k] = square > 0.25 ? middle.orientation[k] / sqrt(square) : from->orientation[k];
    return middle;
}

/* A vector of the frame, in the world: rotation only. */
static inline vec3 frame_turn(const struct frame *frame, vec3 v)
{
    return along(along(scaled(frame->x, v.x), v.y, frame->y), v.z, frame->z);
}

/* A vector of the world, in the frame: rotation only. */
static inline vec3 frame_turn_back(const struct frame *frame, vec3 v)
{
    return (vec3){ dot(v, frame->x), dot(v, frame->y), dot(v, frame->z) };
}

/* A point of the frame, in the world. */
static inline vec3 frame_to_world(const struct frame *frame, vec3 v)
{
    return add(frame->origin, frame_turn(frame, v));
}

/* A point of the world, in the frame. */
static inline vec3 frame_to_local(const struct frame *frame, vec3 v)
{
    return frame_turn_back(frame, sub(v, frame->origin));
}

#endif
