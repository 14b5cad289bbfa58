/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Where an arm's links are, and how they move (docs/algorithms/kinematics.md). Quaternions are composed from the root
 * outward, so that the orientation is continuous in the joints.
 */
#include "arm/arm_format.h"
#include "base/return_if_error.h"
#include "base/sincos.h"
#include "base/vec3.h"

#define FOUR_PI 12.566370614359172

struct quaternion {
    double w;
    vec3 v;
};

/* A frame on the way, and how it moves with each joint: velocity of its origin, spin. */
struct moving {
    vec3 origin;
    struct quaternion turn;
    vec3 velocity[DPT_JOINTS_MAX];
    vec3 spin[DPT_JOINTS_MAX];
};

static struct quaternion quaternion_of(const double *q)
{
    return (struct quaternion){ q[0], vec3_of(q + 1) };
}

static struct quaternion product(struct quaternion a, struct quaternion b)
{
    return (struct quaternion){
        a.w * b.w - dot(a.v, b.v),
        add(along(scaled(b.v, a.w), b.w, a.v), cross(a.v, b.v)),
    };
}

static vec3 turned(struct quaternion q, vec3 x)
{
    vec3 twice = scaled(cross(q.v, x), 2.0);
    return add(along(x, q.w, twice), cross(q.v, twice));
}

/* The frame shifts by `step`; what spins carries its origin along. */
static void shift(struct moving *frame, uint32_t joints, vec3 step)
{
    frame->origin = add(frame->origin, step);
    for (uint32_t i = 0; i < joints; i++)
        frame->velocity[i] = add(frame->velocity[i], cross(frame->spin[i], step));
}

/* From the parent's frame to the link's. */
static void follow(struct moving *frame, uint32_t joints, const struct arm_link *link, double joint)
{
    const double motion = link->factor * joint + link->offset;
    shift(frame, joints, turned(frame->turn, vec3_of(link->pose.position)));
    frame->turn = product(frame->turn, quaternion_of(link->pose.orientation));
    const vec3 axis = turned(frame->turn, vec3_of(link->axis));
    if (link->slides) {
        shift(frame, joints, scaled(axis, motion));
        frame->velocity[link->joint] = along(frame->velocity[link->joint], link->factor, axis);
    } else {
        double sine, cosine;
        turn_sincos(motion / FOUR_PI, &sine, &cosine);
        frame->turn =
            product(frame->turn, (struct quaternion){ cosine, scaled(vec3_of(link->axis), sine) });
        frame->spin[link->joint] = along(frame->spin[link->joint], link->factor, axis);
    }
}

/* The frame of a link, shifted to a point of it; how it moves with the first `moves` joints. */
static void find_frame(const struct dpt_arm *arm, const double *joints, uint32_t moves,
                       uint32_t link, const double *point, struct moving *frame)
{
    uint8_t path[DPT_ARM_LINKS_MAX];
    const uint32_t count = arm_path(arm, link, path);
    *frame = (struct moving){ .turn = { .w = 1.0 } };
    for (uint32_t i = 0; i < count; i++) {
        const struct arm_link *next = &arm_links(arm)[path[i]];
        follow(frame, moves, next, joints[next->joint]);
    }
    shift(frame, moves, turned(frame->turn, vec3_of(point)));
}

static void find_tool(const struct dpt_arm *arm, const double *joints, uint32_t moves,
                      struct moving *frame)
{
    find_frame(arm, joints, moves, arm->tool_link, arm->tool.position, frame);
}

static dpt_result check_numbers(const double *number, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        if (!within(number[i], DPT_COORDINATE_MAX))
            return DPT_E_FINITE;
    return DPT_OK;
}

dpt_result dpt_arm_forward(const dpt_arm *arm, const double *joints, dpt_pose *tool)
{
    if (!arm || !joints || !tool)
        return DPT_E_ARGUMENT;
    DPT_TRY(check_numbers(joints, arm->joints));
    struct moving frame;
    find_tool(arm, joints, 0, &frame);
    const struct quaternion turn = product(frame.turn, quaternion_of(arm->tool.orientation));
    vec3_store(frame.origin, tool->position);
    tool->orientation[0] = turn.w;
    vec3_store(turn.v, tool->orientation + 1);
    return DPT_OK;
}

dpt_result dpt_arm_velocity(const dpt_arm *arm, const double *joints, const double *rates,
                            double velocity[3], double spin[3])
{
    if (!arm || !joints || !rates || !velocity || !spin)
        return DPT_E_ARGUMENT;
    DPT_TRY(check_numbers(joints, arm->joints));
    DPT_TRY(check_numbers(rates, arm->joints));
    struct moving frame;
    find_tool(arm, joints, arm->joints, &frame);
    vec3 moves = { 0.0, 0.0, 0.0 }, turns = { 0.0, 0.0, 0.0 };
    for (uint32_t i = 0; i < arm->joints; i++) {
        moves = along(moves, rates[i], frame.velocity[i]);
        turns = along(turns, rates[i], frame.spin[i]);
    }
    vec3_store(moves, velocity);
    vec3_store(turns, spin);
    return DPT_OK;
}

dpt_result dpt_arm_jacobian(const dpt_arm *arm, const double *joints, double *jacobian)
{
    if (!arm || !joints || !jacobian)
        return DPT_E_ARGUMENT;
    DPT_TRY(check_numbers(joints, arm->joints));
    struct moving frame;
    find_tool(arm, joints, arm->joints, &frame);
    for (uint32_t i = 0; i < arm->joints; i++) {
        double column[6];
        vec3_store(frame.velocity[i], column);
        vec3_store(frame.spin[i], column + 3);
        for (uint32_t row = 0; row < 6; row++)
            jacobian[row * arm->joints + i] = column[row];
    }
    return DPT_OK;
}

dpt_result dpt_arm_efforts(const dpt_arm *arm, const double *joints, const dpt_wrench *wrench,
                           double *efforts)
{
    if (!arm || !joints || !wrench || !efforts)
        return DPT_E_ARGUMENT;
    DPT_TRY(check_numbers(joints, arm->joints));
    DPT_TRY(check_numbers(wrench->force, 3));
    DPT_TRY(check_numbers(wrench->torque, 3));
    const vec3 force = vec3_of(wrench->force), torque = vec3_of(wrench->torque);
    struct moving frame;
    find_tool(arm, joints, arm->joints, &frame);
    for (uint32_t i = 0; i < arm->joints; i++)
        efforts[i] = dot(frame.velocity[i], force) + dot(frame.spin[i], torque);
    return DPT_OK;
}

dpt_result dpt_arm_weight(const dpt_arm *arm, const double *joints, const double gravity[3],
                          double *efforts)
{
    if (!arm || !joints || !gravity || !efforts)
        return DPT_E_ARGUMENT;
    DPT_TRY(check_numbers(joints, arm->joints));
    DPT_TRY(check_numbers(gravity, 3));
    double sum[DPT_JOINTS_MAX] = { 0.0 };
    struct moving frame;
    for (uint32_t i = 0; i < arm->links; i++) {
        const struct arm_link *link = &arm_links(arm)[i];
        if (link->mass == 0.0)
            continue;
        find_frame(arm, joints, arm->joints, i, link->centre, &frame);
        for (uint32_t k = 0; k < arm->joints; k++)
            sum[k] -= link->mass * dot(frame.velocity[k], vec3_of(gravity));
    }
    memcpy(efforts, sum, arm->joints * sizeof *efforts);
    return DPT_OK;
}
