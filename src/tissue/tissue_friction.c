/* SPDX-License-Identifier: BSD-3-Clause */
#include "tissue/tissue_friction.h"

#include <string.h>

#include "proxy/proxy_force.h"

/* As a share of itself: what a rub that slips pulls with is found when it changes by less. */
#define SETTLED 1e-3

/* m: where friction moves its touch by less, it does not drive it. */
#define DRIVEN 1e-12

void dpti_rubs_begin(struct tissue_solve *solve)
{
    solve->rub_count = 0;
}

/* How far others moved the point of a touch before this tick: poses, and of what is not stepped here vertices, too. */
static vec3 carried_of(const struct tissue_solve *solve, const struct touch *touch, const struct body *body)
{
    const vec3 none = { 0.0, 0.0, 0.0 };
    struct frame before;
    if (!body_has_moved(solve->world, body))
        return none;
    if (solve->links[touch - solve->touches.touch].body == DPT_NONE)
        return dpti_body_carried(solve->world, body, touch->triangle, touch->at);
    frame_of_pose(&body->previous_pose, &before);
    return sub(touch->at, frame_to_world(&before, frame_to_local(&body->frame, touch->at)));
}

int dpti_rubs_add(struct tissue_solve *solve, uint32_t index)
{
    const struct touch *touch = &solve->touches.touch[index];
    const struct tissue_link *link = &solve->links[index];
    struct tissue_tool *tool = &solve->tools[link->tool];
    const struct body *body = world_find_body(solve->world, touch->body_id);
    if (!(body->static_friction > 0.0))
        return 1;
    if (solve->rub_count == TISSUE_RUBS_MAX)
        return 0;
    const vec3 carried = carried_of(solve, touch, body);
    struct tissue_row *row = &solve->rows[tissue_row_count(solve)];
    struct tissue_rub *rub = &solve->rubs[solve->rub_count++];
    vec3 tangents[2];
    unit_across(touch->normal, tangents);
    *rub = (struct tissue_rub){ .touch = index,
                                .state = RUB_STICKS,
                                .limit = tool->is_sliding ? body->kinetic_friction : body->static_friction,
                                .kinetic = body->kinetic_friction };
    for (int d = 0; d < 2; d++) {
        rub->carried[d] = dot(carried, tangents[d]);
        row[d] = (struct tissue_row){ .touch = index,
                                      .along = tangents[d],
                                      .within = link->body == DPT_NONE ? tangents[d]
                                                                       : frame_turn_back(&body->frame, tangents[d]) };
        dpti_touch_lever(tool->proxy, &tool->at, tool->axes, touch->at, tangents[d], row[d].lever);
    }
    return 1;
}

/* What a force along a row does to its tool and nodes. */
static void add_known(struct tissue_solve *solve, const struct tissue_row *row, double force)
{
    const struct tissue_link *link = &solve->links[row->touch];
    struct tissue_tool *tool = &solve->tools[link->tool];
    for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
        tool->known[k] += force * row->lever[k] / tool->proxy->coupling.stiffness;
    for (uint32_t k = 0; k < link->count; k++) {
        struct tissue_node *node = &solve->nodes[link->node[k]];
        node->known = along(node->known, -force * link->weight[k] * node->response, row->within);
    }
}

void dpti_rubs_set_known(struct tissue_solve *solve)
{
    const vec3 none = { 0.0, 0.0, 0.0 };
    for (uint32_t t = 0; t < solve->tool_count; t++)
        memcpy(solve->tools[t].known, solve->tools[t].away, sizeof solve->tools[t].known);
    for (uint32_t i = 0; i < solve->node_count; i++)
        solve->nodes[i].known = none;
    for (uint32_t r = 0; r < solve->rub_count; r++)
        for (uint32_t d = 0; d < 2; d++)
            if (solve->rubs[r].state == RUB_SLIPS)
                add_known(solve, &solve->rows[tissue_row_of_rub(solve, r) + d], solve->rubs[r].pull[d]);
}

static int set_open(struct tissue_rub *rub)
{
    const int has_changed = rub->state != RUB_OPEN;
    rub->state = RUB_OPEN;
    rub->pull[0] = rub->pull[1] = 0.0;
    return has_changed;
}

/* A rub that sticks pulls with what its equalities need. */
static int update_sticking(struct tissue_rub *rub, const double pull[2], double push)
{
    const double size = sqrt(pull[0] * pull[0] + pull[1] * pull[1]);
    if (size <= rub->limit * push)
        return 0;
    rub->state = RUB_SLIPS;
    for (int d = 0; d < 2; d++)
        rub->pull[d] = rub->kinetic * push * pull[d] / size;
    return 1;
}

/* A rub that slips pulls as it did when it began, with as much as the push allows now. It never drives its touch. */
static int update_slipping(struct tissue_rub *rub, const double moved[2], double push)
{
    const double last = sqrt(rub->pull[0] * rub->pull[0] + rub->pull[1] * rub->pull[1]);
    const double now = rub->kinetic * push;
    if (!rub->has_returned && rub->pull[0] * moved[0] + rub->pull[1] * moved[1] > DRIVEN * last) {
        rub->state = RUB_STICKS;
        rub->has_returned = 1;
        return 1;
    }
    if (fabs(now - last) <= SETTLED * now)
        return 0;
    for (int d = 0; d < 2; d++)
        rub->pull[d] *= now / last;
    return 1;
}

static int update(struct tissue_solve *solve, uint32_t r)
{
    struct tissue_rub *rub = &solve->rubs[r];
    const uint32_t row = tissue_row_of_rub(solve, r);
    const double push = solve->multiplier[rub->touch];
    if (!(push > 0.0))
        return set_open(rub);
    if (rub->state == RUB_STICKS)
        return update_sticking(rub, &solve->multiplier[row], push);
    if (rub->state == RUB_SLIPS)
        return update_slipping(rub, &solve->problem.gap[row], push);
    rub->state = RUB_STICKS;
    return 1;
}

static int has_rub(const struct tissue_solve *solve, uint32_t touch)
{
    for (uint32_t r = 0; r < solve->rub_count; r++)
        if (solve->rubs[r].touch == touch)
            return 1;
    return 0;
}

int dpti_rubs_update(struct tissue_solve *solve)
{
    const uint32_t known = solve->rub_count;
    int has_changed = 0;
    for (uint32_t r = 0; r < known; r++)
        has_changed |= update(solve, r);
    for (uint32_t i = 0; i < solve->touches.count; i++)
        if (solve->multiplier[i] > 0.0 && !has_rub(solve, i) && !dpti_rubs_add(solve, i))
            solve->is_full = 1;
    return has_changed || solve->rub_count > known;
}

void dpti_rubs_end(struct tissue_solve *solve)
{
    for (uint32_t t = 0; t < solve->tool_count; t++)
        solve->tools[t].sticking = solve->tools[t].slipping = 0;
    for (uint32_t r = 0; r < solve->rub_count; r++) {
        struct tissue_tool *tool = &solve->tools[solve->links[solve->rubs[r].touch].tool];
        tool->sticking += solve->rubs[r].state == RUB_STICKS;
        tool->slipping += solve->rubs[r].state == RUB_SLIPS;
    }
    for (uint32_t t = 0; t < solve->tool_count; t++)
        solve->tools[t].is_sliding = solve->tools[t].slipping && !solve->tools[t].sticking;
}
