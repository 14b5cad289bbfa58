/* SPDX-License-Identifier: BSD-3-Clause */
#include "lib/proxy_rig.h"

void rig_open(struct rig *rig, const dpt_world_def *given, const dpt_mesh *mesh, const dpt_segment *segments,
              uint32_t count)
{
    dpt_world_def def;
    const dpt_pose identity = DPT_POSE_IDENTITY;
    dpt_world_def_init(&def);
    def.max_contacts = 32;
    if (given)
        def = *given;
    def.law = DPT_LAW_PROXY;
    def.stiffness = RIG_STIFFNESS;
    *rig = (struct rig){ .count = count, .device = identity, .proxy = identity };
    memcpy(rig->segments, segments, count * sizeof *segments);
    const size_t bytes = dpt_world_bytes(&def);
    rig->block = malloc(bytes);
    dpt_result result = dpt_world_create(rig->block, bytes, &def, &rig->world);
    CHECK(result == DPT_OK, "create: %s", dpt_result_name(result));
    if (mesh) {
        result = dpt_body_add(rig->world, mesh, NULL, &rig->body);
        CHECK(result == DPT_OK, "body: %s", dpt_result_name(result));
    }
    result = dpt_tool_add(rig->world, segments, count, &rig->tool);
    CHECK(result == DPT_OK, "tool: %s", dpt_result_name(result));
    rig->force.size = sizeof rig->force;
    rig->step.size = sizeof rig->step;
}

void rig_close(struct rig *rig)
{
    free(rig->block);
}

static void take(struct rig *rig)
{
    const dpt_result result = dpt_world_step(rig->world, RIG_DT, &rig->step);
    CHECK(result == DPT_OK, "step: %s", dpt_result_name(result));
    dpt_tool_get_force_info(rig->world, rig->tool, &rig->force);
    dpt_tool_get_proxy(rig->world, rig->tool, &rig->proxy);
}

void rig_step(struct rig *rig)
{
    const dpt_result result = dpt_tool_set_pose(rig->world, rig->tool, &rig->device);
    CHECK(result == DPT_OK, "pose: %s", dpt_result_name(result));
    take(rig);
}

void rig_place(struct rig *rig)
{
    dpt_tool_teleport(rig->world, rig->tool, &rig->device);
    take(rig);
    rig_step(rig);
}

void rig_turn(const double q[4], const double v[3], double turned[3])
{
    const double w = q[0], *u = q + 1;
    double twice[3];
    for (int k = 0; k < 3; k++)
        twice[k] = 2 * (u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
    for (int k = 0; k < 3; k++)
        turned[k] = v[k] + w * twice[k] + u[(k + 1) % 3] * twice[(k + 2) % 3] - u[(k + 2) % 3] * twice[(k + 1) % 3];
}

void rig_turn_by(dpt_pose *pose, const double t[4])
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

void rig_proxy_ends(const struct rig *rig, uint32_t segment, double ends[6])
{
    rig_turn(rig->proxy.orientation, rig->segments[segment].a, ends);
    rig_turn(rig->proxy.orientation, rig->segments[segment].b, ends + 3);
    for (int k = 0; k < 6; k++)
        ends[k] += rig->proxy.position[k % 3];
}

void rig_orient(dpt_pose *pose, const double axis[3], double angle)
{
    pose->orientation[0] = cos(angle / 2);
    for (int k = 0; k < 3; k++)
        pose->orientation[1 + k] = sin(angle / 2) * axis[k];
}

double rig_force(const struct rig *rig)
{
    return sqrt(dot3(rig->force.wrench.force, rig->force.wrench.force));
}

void rig_set_body(const struct rig *rig, dpt_body_settings settings)
{
    settings.size = sizeof settings;
    const dpt_result result = dpt_body_set_settings(rig->world, rig->body, &settings);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
}

void rig_vary(struct rig *rig, uint64_t *seed)
{
    static const double stiffness[] = { 50, 500, 3000, 1e5 };
    dpt_body_settings body = { .size = sizeof body };
    dpt_tool_settings tool = { .size = sizeof tool };
    dpt_body_get_settings(rig->world, rig->body, &body);
    dpt_tool_get_settings(rig->world, rig->tool, &tool);
    if (random_bits(seed) % 3 == 0) {
        body.static_friction = random_in(seed, 0, 1.2);
        body.kinetic_friction = body.static_friction * random_in(seed, 0.3, 1);
    }
    tool.law = DPT_LAW_PROXY;
    tool.stiffness = stiffness[random_bits(seed) % 4];
    if (random_bits(seed) % 3 == 0)
        tool.rotational_stiffness = tool.stiffness * pow(10, random_in(seed, -6, 0));
    const dpt_result of_body = dpt_body_set_settings(rig->world, rig->body, &body);
    const dpt_result of_tool = dpt_tool_set_settings(rig->world, rig->tool, &tool);
    CHECK(of_body == DPT_OK && of_tool == DPT_OK, "%s, %s", dpt_result_name(of_body), dpt_result_name(of_tool));
}
