/* SPDX-License-Identifier: BSD-3-Clause */
#include "tissue/tissue_friction.h"

#include <string.h>

#include "proxy/proxy_force.h"
#include "tissue/tissue_link.h"
#include "tissue/tissue_twist.h"
#include "track/tool_parts.h"

/* As a share of itself: what a rub that slips pulls with is found when it changes by less. */
#define SETTLED 5e-3

/* m: touches are at one place if they are no farther apart than the tool is thick, and so much. */
#define BESIDE 1e-4

/* m: where friction moves its touch by less, it does not drive it. */
#define DRIVEN 1e-12

void dpti_rubs_begin(struct tissue_solve *solve)
{
    for (uint32_t r = 0; r < solve->rub_count; r++) {
        struct tissue_rub *rub = &solve->rubs[r];
        rub->has_returned = 0;
        if (rub->state != RUB_SLIPS)
            rub->against = (vec3){ 0.0, 0.0, 0.0 };
    }
    dpti_twists_begin(solve);
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

/* The rub of a touch, which sticks. Returns 0 if there is no room for it. */
static int add_rub(struct tissue_solve *solve, uint32_t index)
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
    struct tissue_row *row = &solve->rows[solve->row_count];
    struct tissue_rub *rub = &solve->rubs[solve->rub_count++];
    vec3 tangents[2];
    unit_across(touch->normal, tangents);
    *rub = (struct tissue_rub){ .touch = index,
                                .row = solve->row_count,
                                .state = RUB_STICKS,
                                .hold = body->static_friction,
                                .kinetic = body->kinetic_friction };
    solve->row_count += 2;
    for (int d = 0; d < 2; d++) {
        rub->carried[d] = dot(carried, tangents[d]);
        row[d] = (struct tissue_row){ .touch = index,
                                      .along = tangents[d],
                                      .within = link->body == DPT_NONE ? tangents[d]
                                                                       : frame_turn_back(&body->frame, tangents[d]) };
        dpti_touch_lever(tool->proxy, &tool->at, tool->axes, tissue_middle(solve, index), tangents[d], row[d].lever);
    }
    return 1;
}

void dpti_rubs_set_known(struct tissue_solve *solve)
{
    const vec3 none = { 0.0, 0.0, 0.0 };
    for (uint32_t t = 0; t < solve->tool_count; t++)
        memcpy(solve->tools[t].known, solve->tools[t].away, sizeof solve->tools[t].known);
    for (uint32_t i = 0; i < solve->node_count; i++)
        solve->nodes[i].answer = none;
    for (uint32_t r = 0; r < solve->rub_count; r++)
        for (uint32_t d = 0; d < 2; d++)
            if (solve->rubs[r].state == RUB_SLIPS)
                dpti_tissue_add_known(solve, &solve->rows[solve->rubs[r].row + d], solve->rubs[r].pull[d]);
    dpti_twists_set_known(solve);
}

static int set_open(struct tissue_rub *rub)
{
    const int has_changed = rub->state != RUB_OPEN;
    rub->state = RUB_OPEN;
    rub->pull[0] = rub->pull[1] = 0.0;
    return has_changed;
}

static void set_slipping(struct tissue_solve *solve, uint32_t r, vec3 against, double push)
{
    struct tissue_rub *rub = &solve->rubs[r];
    rub->state = RUB_SLIPS;
    rub->against = against;
    for (uint32_t d = 0; d < 2; d++)
        rub->pull[d] = rub->kinetic * push * dot(against, solve->rows[solve->rubs[r].row + d].along);
}

/* A rub that sticks pulls with what its equalities need. */
static int update_sticking(struct tissue_solve *solve, uint32_t r, double push)
{
    const struct tissue_row *row = &solve->rows[solve->rubs[r].row];
    const double *pull = &solve->multiplier[solve->rubs[r].row];
    const struct tissue_rub *rub = &solve->rubs[r];
    const int is_sliding = solve->tools[solve->links[rub->touch].tool].is_sliding != 0;
    const double size = sqrt(pull[0] * pull[0] + pull[1] * pull[1]);
    if (size <= (is_sliding ? rub->kinetic : rub->hold) * push)
        return 0;
    set_slipping(solve, r, scaled(along(scaled(row[0].along, pull[0]), pull[1], row[1].along), 1.0 / size), push);
    return 1;
}

/* m/N: how far a touch moves along a row by a force along it. */
static double compliance_of(struct tissue_solve *solve, const struct tissue_row *row)
{
    const struct tissue_link *link = &solve->links[row->touch];
    const struct tissue_tool *tool = &solve->tools[link->tool];
    double square = 0.0;
    for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
        square += row->lever[k] * row->lever[k];
    return dpti_tissue_compliance(solve, link) + square / tool->stiffness;
}

/*
 * A rub that slips pulls against the way that it slips, with as much as the push allows: it turns there by so much of the
 * slip as all rubs together would undo. One that would drive its touch sticks.
 */
static int update_slipping(struct tissue_solve *solve, uint32_t r, double push, int may_stick)
{
    struct tissue_rub *rub = &solve->rubs[r];
    const struct tissue_row *row = &solve->rows[solve->rubs[r].row];
    const double *moved = &solve->problem.gap[solve->rubs[r].row];
    const double last[2] = { rub->pull[0], rub->pull[1] };
    const double driven = last[0] * moved[0] + last[1] * moved[1];
    if (may_stick && !rub->has_returned && driven > DRIVEN * sqrt(last[0] * last[0] + last[1] * last[1])) {
        rub->state = RUB_STICKS;
        rub->has_returned = 1;
        return 1;
    }
    vec3 pull = { 0.0, 0.0, 0.0 };
    for (int d = 0; d < 2; d++)
        pull = along(pull, last[d] - moved[d] / (solve->rub_count * compliance_of(solve, &row[d])), row[d].along);
    set_slipping(solve, r, dot(pull, pull) > 0.0 ? unit_of(pull) : rub->against, push);
    const double more[2] = { rub->pull[0] - last[0], rub->pull[1] - last[1] };
    return sqrt(more[0] * more[0] + more[1] * more[1]) > SETTLED * rub->kinetic * push;
}

/*
 * The nearest rub of the same part and body that has slipped in this solve, no farther than the tool is thick there. What
 * holds a tool at one place are now these touches, and now those beside them.
 */
static const struct tissue_rub *slipping_beside(const struct tissue_solve *solve, uint32_t r)
{
    const struct touch *touch = &solve->touches.touch[solve->rubs[r].touch];
    const struct tool *tool = &solve->world->tools[touch->tool_slot];
    const struct tissue_rub *best = NULL;
    double nearest = part_radius(tool_part(solve->world, tool, touch->part)) + BESIDE;
    for (uint32_t i = 0; i < solve->rub_count; i++) {
        const struct touch *other = &solve->touches.touch[solve->rubs[i].touch];
        const double away = length(sub(other->at, touch->at));
        if (other->tool_slot == touch->tool_slot && other->part == touch->part && other->body_id == touch->body_id &&
            dot(solve->rubs[i].against, solve->rubs[i].against) > 0.0 && away <= nearest) {
            nearest = away;
            best = &solve->rubs[i];
        }
    }
    return best;
}

/* A touch that has come to push in this pass. */
static void begin_rub(struct tissue_solve *solve, uint32_t r, double push, int may_stick)
{
    const vec3 none = { 0.0, 0.0, 0.0 };
    const struct tissue_rub *beside = slipping_beside(solve, r);
    if (beside || !may_stick)
        set_slipping(solve, r, beside ? beside->against : none, push);
    else
        solve->rubs[r].state = RUB_STICKS;
}

int dpti_rubs_take(struct tissue_solve *solve, uint32_t touch, const struct held_touch *held)
{
    const uint32_t r = solve->rub_count;
    if (!add_rub(solve, touch))
        return 0;
    if (solve->rub_count == r)
        return 1;
    solve->rubs[r].twist = held->twist;
    if (dot(held->against, held->against) > 0.0)
        set_slipping(solve, r, held->against, held->push);
    return 1;
}

vec3 dpti_rubs_against(const struct tissue_solve *solve, uint32_t touch)
{
    for (uint32_t r = 0; r < solve->rub_count; r++)
        if (solve->rubs[r].touch == touch && solve->rubs[r].state == RUB_SLIPS)
            return solve->rubs[r].against;
    return (vec3){ 0.0, 0.0, 0.0 };
}

static int update(struct tissue_solve *solve, uint32_t r, int may_stick)
{
    struct tissue_rub *rub = &solve->rubs[r];
    const double push = solve->multiplier[rub->touch];
    if (!(push > 0.0))
        return set_open(rub);
    if (rub->state == RUB_STICKS)
        return update_sticking(solve, r, push);
    if (rub->state == RUB_SLIPS)
        return update_slipping(solve, r, push, may_stick);
    begin_rub(solve, r, push, may_stick);
    return 1;
}

static int has_rub(const struct tissue_solve *solve, uint32_t touch)
{
    for (uint32_t r = 0; r < solve->rub_count; r++)
        if (solve->rubs[r].touch == touch)
            return 1;
    return 0;
}

int dpti_rubs_update(struct tissue_solve *solve, int may_stick)
{
    const uint32_t known = solve->rub_count;
    int has_changed = 0;
    for (uint32_t r = 0; r < known; r++)
        has_changed |= update(solve, r, may_stick);
    for (uint32_t i = 0; i < solve->touches.count; i++)
        if (solve->multiplier[i] > 0.0 && !has_rub(solve, i) && !add_rub(solve, i))
            solve->is_full = 1;
    for (uint32_t r = known; r < solve->rub_count; r++)
        begin_rub(solve, r, solve->multiplier[solve->rubs[r].touch], may_stick);
    has_changed |= dpti_twists_update(solve, may_stick);
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
