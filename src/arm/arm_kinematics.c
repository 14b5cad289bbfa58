/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Forward kinematics, velocities and joint efforts of an arm (docs/algorithms/kinematics.md). Quaternions are
 * multiplied from the root outward, so that the orientation is continuous in the joints.
 */
#include "arm/arm_format.h"
#include "base/quaternion.h"
#include "base/return_if_error.h"
#include "base/sincos.h"

#define FOUR_PI 12.566370614359172

/* A frame in the root's frame, and how it moves with each joint, per rad/s or m/s of that joint. */
struct moving_frame {
    vec3 origin;
    struct quaternion orientation;
    vec3 velocity[DPT_JOINTS_MAX]; /* of the origin */
    vec3 spin[DPT_JOINTS_MAX];
};

/*
 * Shift the frame's origin by `displacement`, in the root's frame. A joint that spins the frame moves the new origin
 * too.
 */
static void shift(struct moving_frame *frame, uint32_t joint_count, vec3 displacement)
{
    frame->origin = add(frame->origin, displacement);
    for (uint32_t i = 0; i < joint_count; i++)
        frame->velocity[i] = add(frame->velocity[i], cross(frame->spin[i], displacement));
}

/* Move the frame from the parent of `link` to `link`, whose joint has the coordinate `joint`. */
static void apply_link(struct moving_frame *frame, uint32_t joint_count, const struct arm_link *link, double joint)
{
    const double motion = link->factor * joint + link->offset;
    shift(frame, joint_count, quaternion_turn(frame->orientation, vec3_of(link->pose.position)));
    frame->orientation = quaternion_product(frame->orientation, quaternion_of(link->pose.orientation));
    const vec3 axis = quaternion_turn(frame->orientation, vec3_of(link->axis));
    if (link->slides) {
        shift(frame, joint_count, scaled(axis, motion));
        frame->velocity[link->joint] = along(frame->velocity[link->joint], link->factor, axis);
    } else {
        double sine, cosine;
        turn_sincos(motion / FOUR_PI, &sine, &cosine);
        frame->orientation =
            quaternion_product(frame->orientation, (struct quaternion){ cosine, scaled(vec3_of(link->axis), sine) });
        frame->spin[link->joint] = along(frame->spin[link->joint], link->factor, axis);
    }
}

/*
 * Find the frame of link number `link`, shifted to `point` in that link's frame, and how it moves with the first
 * joint_count joints.
 */
static void find_frame(const struct dpt_arm *arm, const double *joints, uint32_t joint_count, uint32_t link,
                       const double *point, struct moving_frame *frame)
{
    uint8_t path[DPT_ARM_LINKS_MAX];
    const uint32_t count = arm_path(arm_links(arm), link, path);
    *frame = (struct moving_frame){ .orientation = { .w = 1.0 } };
    for (uint32_t i = 0; i < count; i++) {
        const struct arm_link *next = &arm_links(arm)[path[i]];
        apply_link(frame, joint_count, next, joints[next->joint]);
    }
    shift(frame, joint_count, quaternion_turn(frame->orientation, vec3_of(point)));
}

/* Find the frame at the tool's origin. It has the orientation of the tool's link. */
static void find_tool(const struct dpt_arm *arm, const double *joints, uint32_t joint_count, struct moving_frame *frame)
{
    find_frame(arm, joints, joint_count, arm->tool_link, arm->tool.position, frame);
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
    struct moving_frame frame;
    find_tool(arm, joints, 0, &frame);
    const struct quaternion orientation = quaternion_product(frame.orientation, quaternion_of(arm->tool.orientation));
    vec3_store(frame.origin, tool->position);
    tool->orientation[0] = orientation.w;
    vec3_store(orientation.v, tool->orientation + 1);
    return DPT_OK;
}

dpt_result dpt_arm_tip_pose(const dpt_arm *arm, uint32_t index, const double *jaws, dpt_pose *pose)
{
    uint8_t path[DPT_ARM_LINKS_MAX];
    struct moving_frame frame = { .orientation = { .w = 1.0 } };
    if (!arm || !pose || index >= arm_tip_count(arm) || (!jaws && arm_jaw_count(arm)))
        return DPT_E_ARGUMENT;
    DPT_TRY(check_numbers(jaws, arm_jaw_count(arm)));
    const uint32_t count = arm_path(arm_jaw_links(arm), arm_tips(arm)[index].link, path);
    for (uint32_t i = 0; i < count; i++) {
        const struct arm_link *next = &arm_jaw_links(arm)[path[i]];
        apply_link(&frame, 0, next, jaws[next->joint]);
    }
    vec3_store(frame.origin, pose->position);
    quaternion_store(quaternion_unit(frame.orientation), pose->orientation);
    return DPT_OK;
}

dpt_result dpt_arm_velocity(const dpt_arm *arm, const double *joints, const double *rates, double velocity[3],
                            double spin[3])
{
    if (!arm || !joints || !rates || !velocity || !spin)
        return DPT_E_ARGUMENT;
    DPT_TRY(check_numbers(joints, arm->joints));
    DPT_TRY(check_numbers(rates, arm->joints));
    struct moving_frame frame;
    find_tool(arm, joints, arm->joints, &frame);
    vec3 velocity_sum = { 0.0, 0.0, 0.0 }, spin_sum = { 0.0, 0.0, 0.0 };
    for (uint32_t i = 0; i < arm->joints; i++) {
        velocity_sum = along(velocity_sum, rates[i], frame.velocity[i]);
        spin_sum = along(spin_sum, rates[i], frame.spin[i]);
    }
    vec3_store(velocity_sum, velocity);
    vec3_store(spin_sum, spin);
    return DPT_OK;
}

dpt_result dpt_arm_jacobian(const dpt_arm *arm, const double *joints, double *jacobian)
{
    if (!arm || !joints || !jacobian)
        return DPT_E_ARGUMENT;
    DPT_TRY(check_numbers(joints, arm->joints));
    struct moving_frame frame;
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

dpt_result dpt_arm_efforts(const dpt_arm *arm, const double *joints, const dpt_wrench *wrench, double *efforts)
{
    if (!arm || !joints || !wrench || !efforts)
        return DPT_E_ARGUMENT;
    DPT_TRY(check_numbers(joints, arm->joints));
    DPT_TRY(check_numbers(wrench->force, 3));
    DPT_TRY(check_numbers(wrench->torque, 3));
    const vec3 force = vec3_of(wrench->force), torque = vec3_of(wrench->torque);
    struct moving_frame frame;
    find_tool(arm, joints, arm->joints, &frame);
    for (uint32_t i = 0; i < arm->joints; i++)
        efforts[i] = dot(frame.velocity[i], force) + dot(frame.spin[i], torque);
    return DPT_OK;
}

dpt_result dpt_arm_weight(const dpt_arm *arm, const double *joints, const double gravity[3], double *efforts)
{
    if (!arm || !joints || !gravity || !efforts)
        return DPT_E_ARGUMENT;
    DPT_TRY(check_numbers(joints, arm->joints));
    DPT_TRY(check_numbers(gravity, 3));
    double sum[DPT_JOINTS_MAX] = { 0.0 };
    struct moving_frame frame;
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
