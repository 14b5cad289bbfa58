/* SPDX-License-Identifier: BSD-3-Clause */
/* The proxy of a free tool of one segment: docs/algorithms/force.md. */
#include "world/proxy_pose.h"
#include "world/proxy_step.h"

void dpti_proxy_set_free(struct dpt_world *world, struct tool *tool, uint32_t is_free)
{
    struct segment *segment = &world->segments[tool->first_segment];
    if (!dpti_proxy_is_used(world, tool))
        return;
    const struct proxy *proxy = &world->proxies[tool - world->tools];
    dpti_proxy_forget(world, tool);
    if (is_free)
        return;
    /* What was given last is what its own frame holds from now on. */
    struct frame device;
    frame_of_pose(&tool->pose, &device);
    segment->b = add(device.origin, scaled(device.x, proxy->length));
    segment->a = device.origin;
    segment->radius = proxy->radius;
}

void dpti_proxy_set_segment(struct dpt_world *world, struct tool *tool, const dpt_segment *given)
{
    struct proxy *proxy = &world->proxies[tool - world->tools];
    struct segment *segment = &world->segments[tool->first_segment];
    const vec3 u = sub(vec3_of(given->b), vec3_of(given->a));
    const double size = length(u);
    const dpt_pose identity = DPT_POSE_IDENTITY;
    struct quaternion turn = quaternion_of((tool->is_free ? &tool->pose : &identity)->orientation);
    const vec3 x = quaternion_turn(turn, (vec3){ 1.0, 0.0, 0.0 });
    if (size > 0.0)
        turn =
            quaternion_unit(quaternion_product(quaternion_of_turn(x, scaled(u, 1.0 / size)), turn));
    quaternion_store(turn, tool->pose.orientation);
    memcpy(tool->pose.position, given->a, sizeof tool->pose.position);
    proxy->length = size;
    proxy->radius = given->radius;
    segment->a = (vec3){ 0.0, 0.0, 0.0 };
    segment->tool_slot = (uint32_t)(tool - world->tools);
    if (proxy->state >= PROXY_DOUBTED)
        return;
    segment->b = (vec3){ size, 0.0, 0.0 };
    segment->radius = given->radius;
}

void dpti_proxy_follow_size(struct dpt_world *world, const struct tool *tool, struct proxy *proxy)
{
    struct segment *segment = &world->segments[tool->first_segment];
    double spare = max_of(0.0, proxy->gap - proxy->min_gap);
    const double longer = min_of(proxy->length - segment->b.x, spare);
    segment->b.x += longer;
    spare -= max_of(0.0, longer);
    const double thicker = min_of(proxy->radius - segment->radius, spare);
    segment->radius += thicker;
    proxy->gap -= max_of(0.0, longer) + max_of(0.0, thicker);
}
