/* SPDX-License-Identifier: BSD-3-Clause */
/* The getters of an open arm (arm.h). */
#include "arm/arm_format.h"
#include "base/return_if_error.h"
#include "base/sized.h"

dpt_result dpt_arm_get_info(const dpt_arm *arm, dpt_arm_info *info)
{
    if (!arm || !info)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(info, SIZED_FIRST(dpt_arm_info, jaws), 0));
    dpt_arm_info own = {
        .format_version = arm->version,
        .joints = arm->joints,
        .links = arm->links,
        .segments = arm->segments,
        .bodies = arm->bodies,
        .tool_link = arm->tool_link,
        .tool = arm->tool,
        .source_bytes = arm->source_bytes,
        .source_hash = arm->source_hash,
        .bytes = arm->bytes,
        .jaws = arm_jaw_count(arm),
        .jaw_links = arm_jaw_link_count(arm),
        .tips = arm_tip_count(arm),
    };
    for (uint32_t i = 0; i < arm->links; i++)
        own.mass += arm_links(arm)[i].mass;
    memcpy(own.name, arm->name, sizeof own.name);
    memcpy(own.root_name, arm->root_name, sizeof own.root_name);
    memcpy(own.tool_name, arm->tool_name, sizeof own.tool_name);
    sized_write(info, info->size, &own, sizeof own);
    return DPT_OK;
}

static dpt_result write_joint(const struct arm_joint *record, dpt_arm_joint *joint)
{
    DPT_TRY(sized_check(joint, sizeof *joint, 0));
    dpt_arm_joint own = {
        .kind = record->kind,
        .lower = record->lower,
        .upper = record->upper,
        .velocity = record->velocity,
        .effort = record->effort,
        .damping = record->damping,
        .friction = record->friction,
    };
    memcpy(own.name, record->name, sizeof own.name);
    sized_write(joint, joint->size, &own, sizeof own);
    return DPT_OK;
}

dpt_result dpt_arm_get_joint(const dpt_arm *arm, uint32_t index, dpt_arm_joint *joint)
{
    return arm && joint && index < arm->joints ? write_joint(&arm_joints(arm)[index], joint) : DPT_E_ARGUMENT;
}

dpt_result dpt_arm_get_jaw(const dpt_arm *arm, uint32_t index, dpt_arm_joint *jaw)
{
    return arm && jaw && index < arm_jaw_count(arm) ? write_joint(&arm_jaws(arm)[index], jaw) : DPT_E_ARGUMENT;
}

static dpt_result write_link(const struct arm_link *record, dpt_arm_link *link)
{
    DPT_TRY(sized_check(link, sizeof *link, 0));
    dpt_arm_link own = {
        .parent = record->parent,
        .joint = record->joint,
        .slides = record->slides,
        .pose = record->pose,
        .factor = record->factor,
        .offset = record->offset,
        .mass = record->mass,
    };
    memcpy(own.axis, record->axis, sizeof own.axis);
    memcpy(own.centre, record->centre, sizeof own.centre);
    sized_write(link, link->size, &own, sizeof own);
    return DPT_OK;
}

dpt_result dpt_arm_get_link(const dpt_arm *arm, uint32_t index, dpt_arm_link *link)
{
    return arm && link && index < arm->links ? write_link(&arm_links(arm)[index], link) : DPT_E_ARGUMENT;
}

dpt_result dpt_arm_get_jaw_link(const dpt_arm *arm, uint32_t index, dpt_arm_link *link)
{
    return arm && link && index < arm_jaw_link_count(arm) ? write_link(&arm_jaw_links(arm)[index], link)
                                                          : DPT_E_ARGUMENT;
}

dpt_result dpt_arm_get_tip(const dpt_arm *arm, uint32_t index, dpt_arm_tip *tip)
{
    if (!arm || !tip || index >= arm_tip_count(arm))
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(tip, sizeof *tip, 0));
    const struct arm_tip *record = &arm_tips(arm)[index];
    dpt_arm_tip own = { .link = record->link,
                        .corner_count = record->corner_count,
                        .corners = arm_corners(arm)[record->first_corner].at,
                        .radius = record->radius };
    memcpy(own.name, record->name, sizeof own.name);
    sized_write(tip, tip->size, &own, sizeof own);
    return DPT_OK;
}

dpt_result dpt_arm_get_body(const dpt_arm *arm, uint32_t index, dpt_arm_body *body)
{
    if (!arm || !body || index >= arm->bodies)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(body, sizeof *body, 0));
    const struct arm_body *record = &arm_bodies(arm)[index];
    dpt_arm_body own = { .pose = record->pose,
                         .mesh = (const void *)((const char *)arm + record->mesh_offset),
                         .mesh_bytes = (size_t)record->mesh_bytes };
    memcpy(own.name, record->name, sizeof own.name);
    sized_write(body, body->size, &own, sizeof own);
    return DPT_OK;
}

dpt_result dpt_arm_get_segment(const dpt_arm *arm, uint32_t index, dpt_segment *segment)
{
    if (!arm || !segment || index >= arm->segments)
        return DPT_E_ARGUMENT;
    *segment = arm_segments(arm)[index];
    return DPT_OK;
}
