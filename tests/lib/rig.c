/* SPDX-License-Identifier: BSD-3-Clause */
#include "lib/rig.h"

const dpt_segment rig_point = { { 0, 0, 0 }, { 0, 0, 0 }, 0 };

/* A part that fails, at the line that called. */
#define MUST(call) rig_must(at, call, #call)

static int rig_must(struct rig_line at, dpt_result result, const char *call)
{
    if (result != DPT_OK)
        check_fail(at.file, at.line, call, "%s", dpt_result_name(result));
    return result == DPT_OK;
}

static void *new_block(struct rig_line at, struct rig *rig, size_t bytes)
{
    void *block = rig->block_count < RIG_BLOCKS ? malloc(bytes) : NULL;
    if (block)
        rig->blocks[rig->block_count++] = block;
    else
        check_fail(at.file, at.line, "a block", "none of %zu bytes", bytes);
    return block;
}

dpt_world_def rig_def(uint32_t law)
{
    dpt_world_def def;
    dpt_world_def_init(&def);
    def.max_contacts = 32;
    def.law = law;
    return def;
}

int rig_has_kernel(uint32_t kernel)
{
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    def.kernel = kernel;
    void *block = malloc(dpt_world_bytes(&def));
    dpt_world *world;
    const dpt_result result = dpt_world_create(block, dpt_world_bytes(&def), &def, &world);
    free(block);
    return result == DPT_OK;
}

int rig_open_at(struct rig_line at, struct rig *rig, const dpt_world_def *given, const dpt_mesh *mesh,
                const dpt_segment *segments, uint32_t count)
{
    const dpt_world_def def = given ? *given : rig_def(DPT_LAW_PROXY);
    const dpt_pose identity = DPT_POSE_IDENTITY;
    const size_t bytes = dpt_world_bytes(&def);
    *rig = (struct rig){ .device = identity, .proxy = identity, .dt = RIG_DT, .world_bytes = bytes };
    rig->step.size = sizeof rig->step;
    rig->hit.size = sizeof rig->hit;
    rig->force.size = sizeof rig->force;
    void *block = new_block(at, rig, bytes);
    return MUST(dpt_world_create(block, bytes, &def, &rig->world)) && (!mesh || rig_add_body_at(at, rig, mesh, NULL)) &&
           (!count || rig_add_tool_at(at, rig, segments, count));
}

void rig_close(struct rig *rig)
{
    while (rig->block_count)
        free(rig->blocks[--rig->block_count]);
}

dpt_body rig_add_body_at(struct rig_line at, struct rig *rig, const dpt_mesh *mesh, const dpt_pose *pose)
{
    dpt_body body = 0;
    MUST(dpt_body_add(rig->world, mesh, pose, &body));
    rig->body = rig->body ? rig->body : body;
    return body;
}

dpt_body rig_add_deformable_at(struct rig_line at, struct rig *rig, const dpt_deformable_def *def)
{
    const size_t bytes = dpt_deformable_bytes(def);
    dpt_body body = 0;
    MUST(dpt_body_add_deformable(rig->world, new_block(at, rig, bytes), bytes, def, &body));
    rig->body = rig->body ? rig->body : body;
    return body;
}

dpt_springs *rig_add_springs_at(struct rig_line at, struct rig *rig, const dpt_springs_def *def)
{
    const size_t bytes = dpt_springs_bytes(def);
    dpt_springs *springs = NULL;
    MUST(dpt_springs_create(new_block(at, rig, bytes), bytes, def, &springs));
    return springs;
}

dpt_tool rig_add_tool_at(struct rig_line at, struct rig *rig, const dpt_segment *segments, uint32_t count)
{
    dpt_tool tool = 0;
    MUST(dpt_tool_add(rig->world, segments, count, &tool));
    if (rig->tool)
        return tool;
    rig->tool = tool;
    rig->count = count;
    memcpy(rig->segments, segments, (count < RIG_SEGMENTS ? count : RIG_SEGMENTS) * sizeof *segments);
    return tool;
}

void rig_set_law_at(struct rig_line at, const struct rig *rig, dpt_tool tool, uint32_t law, double stiffness)
{
    dpt_tool_settings settings = { .size = sizeof settings };
    MUST(dpt_tool_get_settings(rig->world, tool, &settings));
    settings.law = law;
    settings.stiffness = stiffness;
    MUST(dpt_tool_set_settings(rig->world, tool, &settings));
}

void rig_set_body_at(struct rig_line at, const struct rig *rig, dpt_body_settings settings)
{
    settings.size = sizeof settings;
    MUST(dpt_body_set_settings(rig->world, rig->body, &settings));
}

void rig_tick_at(struct rig_line at, struct rig *rig)
{
    MUST(dpt_world_step(rig->world, rig->dt, &rig->step));
    if (!dpt_tool_is_valid(rig->world, rig->tool))
        return;
    MUST(dpt_tool_get_hit(rig->world, rig->tool, &rig->hit));
    MUST(dpt_tool_get_force_info(rig->world, rig->tool, &rig->force));
    MUST(dpt_tool_get_proxy(rig->world, rig->tool, &rig->proxy));
}

void rig_step_at(struct rig_line at, struct rig *rig)
{
    MUST(dpt_tool_set_pose(rig->world, rig->tool, &rig->device));
    rig_tick_at(at, rig);
}

void rig_step_to_at(struct rig_line at, struct rig *rig, const dpt_pose *pose)
{
    rig->device = *pose;
    rig_step_at(at, rig);
}

dpt_hit rig_step_ends_at(struct rig_line at, struct rig *rig, const double ends[6], double radius)
{
    dpt_segment segment = { .radius = radius };
    memcpy(segment.a, ends, sizeof segment.a);
    memcpy(segment.b, ends + 3, sizeof segment.b);
    MUST(dpt_tool_set_segments(rig->world, rig->tool, &segment, 1));
    rig_tick_at(at, rig);
    return rig->hit;
}

void rig_place_at(struct rig_line at, struct rig *rig)
{
    MUST(dpt_tool_teleport(rig->world, rig->tool, &rig->device));
    rig_tick_at(at, rig);
    rig_step_at(at, rig);
}

uint32_t rig_contacts_at(struct rig_line at, const struct rig *rig, dpt_contact *contacts)
{
    uint32_t count = 0;
    contacts[0].size = sizeof *contacts;
    MUST(dpt_tool_get_contacts(rig->world, rig->tool, contacts, RIG_CONTACTS, &count));
    if (count > RIG_CONTACTS)
        check_fail(at.file, at.line, "RIG_CONTACTS", "%u contacts", count);
    return count < RIG_CONTACTS ? count : RIG_CONTACTS;
}

double rig_force(const struct rig *rig)
{
    return length3(rig->force.wrench.force);
}

void rig_proxy_ends(const struct rig *rig, uint32_t segment, double ends[6])
{
    pose_ends(&rig->proxy, &rig->segments[segment], ends);
}

uint32_t rig_channels(const struct rig *rig, dpt_tool tool, dpt_channel *channels, uint32_t capacity)
{
    uint32_t count = 0;
    if (capacity)
        channels->size = sizeof *channels;
    CHECK(dpt_tool_get_channels(rig->world, tool, channels, capacity, &count) == DPT_OK, "no channels");
    return count;
}

dpt_channel rig_channel(const struct rig *rig, dpt_tool tool)
{
    dpt_channel channel = { .size = sizeof channel };
    const uint32_t count = rig_channels(rig, tool, &channel, 1);
    CHECK(count == 1, "%u channels", count);
    return channel;
}

void rig_vary_at(struct rig_line at, const struct rig *rig, uint64_t *seed)
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
    MUST(dpt_body_set_settings(rig->world, rig->body, &body));
    MUST(dpt_tool_set_settings(rig->world, rig->tool, &tool));
}
