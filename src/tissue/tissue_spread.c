/* SPDX-License-Identifier: BSD-3-Clause */
#include "tissue/tissue_spread.h"

#include "track/deform_state.h"

/* s: how soon what rose unfelt is felt: so slow that tissue which swings by itself gains nothing by it. */
#define SETTLING 0.5

/* m: what is left of it then counts as nothing. */
#define SETTLED 1e-9

/* By how much the nearest touch of the last step had risen unfelt; 0 if there is none within the radius. */
static double unfelt_before(const struct tissue_solve *solve, const struct touch *touch, vec3 at, double radius)
{
    double unfelt = 0.0, nearest = radius * radius;
    if (!world_was_last_tick(solve->world, solve->tick))
        return 0.0;
    for (uint32_t i = 0; i < solve->spread_count; i++) {
        const struct spread_touch *known = &solve->spread_touches[i];
        const vec3 away = sub(known->at, at);
        const double square = dot(away, away);
        if (known->tool_slot == touch->tool_slot && known->part == touch->part && known->body_id == touch->body_id &&
            square < nearest) {
            nearest = square;
            unfelt = known->unfelt;
        }
    }
    return unfelt;
}

/* How much more the touched point has risen than the patch in the mean, along the normal, since the last tick. */
static double risen_since(const struct tissue_solve *solve, const struct body *body, const struct touch *touch,
                          const struct load_patch *patch, vec3 normal)
{
    const struct surface *now = &body->surface;
    const struct surface before = surface_view(now, solve->world->ticks, 0.0);
    vec3 moved = { 0.0, 0.0, 0.0 };
    if (!before.view_tick)
        return 0.0;
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t vertex = surface_corner(now, touch->triangle, k);
        moved = along(moved, touch->weight[k], sub(surface_vertex(now, vertex), surface_vertex(&before, vertex)));
    }
    for (uint32_t i = 0; i < patch->count; i++) {
        const uint32_t vertex = patch->vertex[i];
        moved = along(moved, -patch->share[i], sub(surface_vertex(now, vertex), surface_vertex(&before, vertex)));
    }
    return dot(normal, moved);
}

/*
 * A point that sinks more than its patch is followed at once: that lets the tool's spring go, and no work is done on the
 * tissue. One that rises more pushes the tool with a force that the patch does not feel, so the tool gives way to it slowly.
 */
void dpti_spread_find(struct tissue_solve *solve, uint32_t index, struct load_patch *patch)
{
    const struct touch *touch = &solve->touches.touch[index];
    struct tissue_link *link = &solve->links[index];
    const struct body *body = solve->bodies[link->body].body;
    const double radius = deform_of(body)->def.load_radius;
    const struct load_point point = { .triangle = touch->triangle,
                                      .at = frame_to_local(&body->frame, touch->at),
                                      .normal = frame_turn_back(&body->frame, touch->normal) };
    vec3 middle = { 0.0, 0.0, 0.0 };
    dpti_deform_patch(&body->surface, &point, radius, patch);
    /* Six triangles a vertex. */
    work_spend(&solve->work, patch->count);
    for (uint32_t i = 0; i < patch->count; i++)
        middle = along(middle, patch->share[i], surface_vertex(&body->surface, patch->vertex[i]));
    const double unfelt =
        unfelt_before(solve, touch, point.at, radius) + risen_since(solve, body, touch, patch, point.normal);
    link->depth = dot(sub(point.at, middle), point.normal);
    link->unfelt = unfelt > SETTLED ? unfelt * SETTLING / (SETTLING + solve->dt) : 0.0;
}

void dpti_spread_note(struct tissue_solve *solve)
{
    solve->spread_count = 0;
    for (uint32_t i = 0; i < solve->touches.count; i++) {
        const struct touch *touch = &solve->touches.touch[i];
        const struct tissue_link *link = &solve->links[i];
        const struct body *body = link->body == DPT_NONE ? NULL : solve->bodies[link->body].body;
        if (body && deform_of(body)->def.load_radius > 0.0)
            solve->spread_touches[solve->spread_count++] =
                (struct spread_touch){ touch->tool_slot, touch->part, touch->body_id,
                                       frame_to_local(&body->frame, touch->at), link->unfelt };
    }
}
