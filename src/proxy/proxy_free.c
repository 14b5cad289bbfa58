/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/proxy_free.h"

#include "base/quaternion.h"

static struct segment *segment_of(const struct dpt_world *world, const struct tool *tool)
{
    return &world->segments[tool->first_segment];
}

dpt_segment dpti_proxy_given_segment(const struct dpt_world *world, const struct tool *tool)
{
    const struct proxy *proxy = &world->proxies[tool - world->tools];
    const struct frame device = tool_device_frame(tool);
    dpt_segment given = { .radius = proxy->radius };
    vec3_store(device.origin, given.a);
    vec3_store(along(device.origin, proxy->length, device.x), given.b);
    return given;
}

void dpti_proxy_set_free(struct dpt_world *world, struct tool *tool, uint32_t is_free)
{
    if (!dpti_proxy_is_used(world, tool))
        return;
    dpti_proxy_forget(world, tool);
    if (is_free)
        return;
    const dpt_pose identity = DPT_POSE_IDENTITY;
    const dpt_segment given = dpti_proxy_given_segment(world, tool);
    struct segment *segment = segment_of(world, tool);
    segment->a = vec3_of(given.a);
    segment->b = vec3_of(given.b);
    segment->radius = given.radius;
    tool->pose = identity;
}

void dpti_proxy_set_segment(struct dpt_world *world, struct tool *tool, const dpt_segment *given)
{
    struct proxy *proxy = &world->proxies[tool - world->tools];
    struct segment *segment = segment_of(world, tool);
    const dpt_pose pose = tool->pose;
    const double length_before = proxy->length, radius_before = proxy->radius;
    struct quaternion turn = quaternion_unit(quaternion_of(tool->pose.orientation));
    const vec3 u = sub(vec3_of(given->b), vec3_of(given->a));
    const double size = length(u);
    const vec3 x = quaternion_turn(turn, (vec3){ 1.0, 0.0, 0.0 });
    if (size > 0.0)
        turn = quaternion_unit(quaternion_product(quaternion_of_turn(x, scaled(u, 1.0 / size)), turn));
    quaternion_store(turn, tool->pose.orientation);
    memcpy(tool->pose.position, given->a, sizeof tool->pose.position);
    proxy->length = size;
    proxy->radius = given->radius;
    tool->has_changed |= !pose_is_same(&pose, &tool->pose) || size != length_before || given->radius != radius_before;
    segment->a = (vec3){ 0.0, 0.0, 0.0 };
    segment->tool_slot = (uint32_t)(tool - world->tools);
    if (proxy->state >= PROXY_DOUBTED)
        return;
    segment->b = (vec3){ size, 0.0, 0.0 };
    segment->radius = given->radius;
}

void dpti_proxy_follow_size(struct dpt_world *world, const struct tool *tool, struct proxy *proxy)
{
    struct segment *segment = segment_of(world, tool);
    if (proxy->state < PROXY_DOUBTED) { /* it begins: maybe since a reset, after the size was given */
        segment->b.x = proxy->length;
        segment->radius = proxy->radius;
        return;
    }
    double spare = max_of(0.0, proxy->gap - proxy->min_gap);
    const double length_before = segment->b.x, radius_before = segment->radius;
    segment->b.x = min_of(proxy->length, length_before + spare);
    spare = max_of(0.0, spare - max_of(0.0, segment->b.x - length_before));
    segment->radius = min_of(proxy->radius, radius_before + spare);
    proxy->gap -= max_of(0.0, segment->b.x - length_before) + max_of(0.0, segment->radius - radius_before);
}

int dpti_proxy_has_size(const struct dpt_world *world, const struct tool *tool)
{
    const struct proxy *proxy = &world->proxies[tool - world->tools];
    const struct segment *segment = segment_of(world, tool);
    return !tool->is_free || (segment->b.x == proxy->length && segment->radius == proxy->radius);
}
