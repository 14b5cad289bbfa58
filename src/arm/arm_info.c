/* SPDX-License-Identifier: BSD-3-Clause */
/* What an open arm tells of itself. */
#include "arm/arm_format.h"

dpt_result dpt_arm_get_info(const dpt_arm *arm, dpt_arm_info *info)
{
    if (!arm || !info)
        return DPT_E_ARGUMENT;
    if (info->size < sizeof *info)
        return DPT_E_SIZE;
    info->format_version = arm->version;
    info->joints = arm->joints;
    info->links = arm->links;
    info->segments = arm->segments;
    info->bodies = arm->bodies;
    info->tool_link = arm->tool_link;
    info->reserved = 0;
    info->mass = 0.0;
    for (uint32_t i = 0; i < arm->links; i++)
        info->mass += arm_links(arm)[i].mass;
    info->tool = arm->tool;
    info->source_bytes = arm->source_bytes;
    info->source_hash = arm->source_hash;
    info->bytes = arm->bytes;
    memcpy(info->name, arm->name, sizeof info->name);
    memcpy(info->root_name, arm->root_name, sizeof info->root_name);
    memcpy(info->tool_name, arm->tool_name, sizeof info->tool_name);
    return DPT_OK;
}

dpt_result dpt_arm_get_joint(const dpt_arm *arm, uint32_t index, dpt_arm_joint *joint)
{
    if (!arm || !joint || index >= arm->joints)
        return DPT_E_ARGUMENT;
    if (joint->size < sizeof *joint)
        return DPT_E_SIZE;
    const uint32_t size = joint->size;
    *joint = arm_joints(arm)[index];
    joint->size = size;
    return DPT_OK;
}

dpt_result dpt_arm_get_link(const dpt_arm *arm, uint32_t index, dpt_arm_link *link)
{
    if (!arm || !link || index >= arm->links)
        return DPT_E_ARGUMENT;
    if (link->size < sizeof *link)
        return DPT_E_SIZE;
    const uint32_t size = link->size;
    *link = arm_links(arm)[index];
    link->size = size;
    return DPT_OK;
}

dpt_result dpt_arm_get_body(const dpt_arm *arm, uint32_t index, dpt_arm_body *body)
{
    if (!arm || !body || index >= arm->bodies)
        return DPT_E_ARGUMENT;
    if (body->size < sizeof *body)
        return DPT_E_SIZE;
    const struct arm_body *record = &arm_bodies(arm)[index];
    body->reserved = 0;
    body->pose = record->pose;
    body->mesh = (const void *)((const char *)arm + record->mesh_offset);
    body->mesh_bytes = (size_t)record->mesh_bytes;
    memcpy(body->name, record->name, sizeof body->name);
    return DPT_OK;
}

dpt_result dpt_arm_get_segment(const dpt_arm *arm, uint32_t index, dpt_segment *segment)
{
    if (!arm || !segment || index >= arm->segments)
        return DPT_E_ARGUMENT;
    *segment = arm_segments(arm)[index];
    return DPT_OK;
}
