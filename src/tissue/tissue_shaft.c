/* SPDX-License-Identifier: BSD-3-Clause */
#include "tissue/tissue_shaft.h"

#include "insertion/channel_points.h"
#include "insertion/region_law.h"
#include "proxy/channel_line.h"
#include "proxy/proxy.h"
#include "tissue/shaft_points.h"
#include "tissue/tissue_link.h"

/* A touch has so many rows at most. */
enum { ROWS_OF_TOUCH = 2 };

/* How much stiffer than the tool's spring a shaft is held across, for each of its diameters. */
#define ACROSS 100.0

/* m: a gap of such a touch: no other makes it leave for want of room. */
#define FIRST (-1.0)

/* As a share: what a shaft that sticks pulls with is at its limit. */
#define LIMIT (1.0 + 1e-9)

/* The share of a missing gap that a stop makes good in a substep. */
#define RECOVERED 0.2

static struct inserted *inserted_of(const struct dpt_world *world, const struct tissue_solve *solve,
                                    const struct tissue_shaft *shaft)
{
    const struct tool *tool = &world->tools[solve->tools[shaft->tool].slot];
    return &insertion_of(world, tool)->in[shaft->number];
}

/* ---- touches ---- */

/* A touch whose force acts at a point of the world. */
static void add_touch(struct tissue_solve *solve, const struct touch_search *search, uint32_t kind, vec3 at,
                      vec3 normal)
{
    const struct tissue_shaft *shaft = &solve->shafts[solve->shaft_count];
    const struct channel_point *point = &shaft->channel->points[kind < SHAFT_MEAN ? kind : 0];
    struct tissue_tool *tool = &solve->tools[solve->tool_count];
    struct touches *touches = &solve->touches;
    if (touches->count == TOUCHES_MAX) {
        touches->is_full = 1;
        return;
    }
    struct touch *touch = &touches->touch[touches->count++];
    *touch = (struct touch){ .tool_slot = tool->slot,
                             .body_id = shaft->channel->body_id,
                             .triangle = point->hit_count ? point->hits[0].triangle : shaft->channel->triangle,
                             .shaft = 1 + SHAFT_TOUCHES * solve->shaft_count + kind,
                             .at = at,
                             .normal = normal,
                             .gap = FIRST };
    touch->feature = TOUCH_OF_SHAFT | touch->shaft;
    dpti_touch_lever(search->proxy, search->at, tool->axes, at, normal, touch->row);
}

/* The first points that the tip has reached hold it. */
static uint32_t count_points(const struct channel *channel, double place)
{
    uint32_t count = 1;
    while (count < channel->point_count && channel->points[count].place <= place)
        count++;
    return count;
}

static void add_points(struct tissue_solve *solve, const struct touch_search *search, const vec3 *at)
{
    const struct tissue_shaft *shaft = &solve->shafts[solve->shaft_count];
    vec3 across[2];
    unit_across(shaft->axis, across);
    for (uint32_t i = 0; i < shaft->channel->point_count; i++)
        add_touch(solve, search, i, frame_to_world(&shaft->body->frame, at[i]), across[0]);
}

/* N/m: of the bristles that hold it across at a point. */
static double stiffness_across(const struct tissue_shaft *shaft, double stiffness, uint32_t point)
{
    return ACROSS * stiffness / (2.0 * shaft->channel->radius) *
           dpti_channel_held_by(shaft->channel, point, shaft->shared);
}

/* Bristles that are added are not stretched: the force stays, and its share of each is less. */
static void set_across(struct tissue_shaft *shaft, double stiffness, vec3 tip, const vec3 *points)
{
    const struct body *body = shaft->body;
    for (uint32_t i = 0; i < shaft->point_count; i++) {
        const struct channel_point *point = &shaft->channel->points[i];
        const double now = stiffness_across(shaft, stiffness, i);
        const vec3 from = sub(tip, frame_to_world(&body->frame, points[i])),
                   away = along(from, -dot(from, shaft->axis), shaft->axis);
        const vec3 offset = frame_turn(&body->frame, point->offset);
        shaft->across[i] = now;
        shaft->offset[i] = offset;
        if (now > point->stiffness && point->stiffness > 0.0)
            shaft->offset[i] = sub(away, scaled(sub(away, offset), point->stiffness / now));
        else if (!(point->stiffness > 0.0))
            shaft->offset[i] = away;
    }
}

static void set_shaft(struct tissue_solve *solve, const struct touch_search *search, uint32_t number)
{
    const struct dpt_world *world = search->world;
    const struct insertion *insertion = insertion_of(world, search->tool);
    const struct inserted *in = &insertion->in[number];
    struct channel *channel = &world->channels[in->channel];
    const struct body *body = dpti_channel_body(world, channel);
    const struct pierce_law law = dpti_shaft_law(world, body, channel, in->shared);
    struct tissue_shaft *shaft = &solve->shafts[solve->shaft_count];
    const vec3 tip = frame_to_world(&search->at->frame, dpti_tip_point(world, search->tool));
    const vec3 axis = frame_turn(&search->at->frame, dpti_tip_direction(world, search->tool));
    vec3 points[CHANNEL_POINTS_MAX];
    const double bristles =
        law.shaft_stiffness > 0.0 ? law.shaft_stiffness : max_of(law.shaft_friction, 1.0) / SHAFT_STRETCH;
    *shaft = (struct tissue_shaft){ .tool = solve->tool_count,
                                    .number = number,
                                    .channel = channel,
                                    .channel_id = channel->id,
                                    .point_count = count_points(channel, in->place),
                                    .body = body,
                                    .axis = axis,
                                    .stiffness = in->inside * bristles,
                                    .limit = in->inside * law.shaft_friction,
                                    .drag = in->inside * law.shaft_viscosity,
                                    .cutting = cutting_force(dpti_cutting_law(world, body, channel), channel->radius),
                                    .place = in->place,
                                    .shared = in->shared,
                                    .rest = in->rest,
                                    .is_slipping = in->is_slipping,
                                    .is_cutting = in->is_cutting };
    shaft->stretch_max = shaft->stiffness > 0.0 ? shaft->limit / shaft->stiffness : 0.0;
    shaft->stretch_max = min_of(shaft->stretch_max, 0.5 * in->inside);
    shaft->limit = shaft->stretch_max * shaft->stiffness;
    shaft->pull = in->friction < 0.0 ? -shaft->limit : shaft->limit;
    dpti_channel_points_at(channel, &body->surface, points);
    shaft->mean = dpti_channel_mean_place(channel, points, in->shared, frame_to_local(&body->frame, tip),
                                          frame_turn_back(&body->frame, axis));
    shaft->wall = dpti_channel_stop(channel, dpti_proxy_clearance(world));
    shaft->stop = min_of(shaft->wall, in->place + in->pace);
    shaft->uncut = shaft->cutting > 0.0 ? dpti_channel_uncut(channel) : HUGE_VAL;
    for (uint32_t i = 0; i < channel->point_count; i++)
        shaft->share[i] = dpti_channel_share(channel, i, in->shared);
    set_across(shaft, search->tool->stiffness, tip, points);
    add_points(solve, search, points);
    add_touch(solve, search, SHAFT_MEAN, along(tip, -0.5 * in->inside, axis), scaled(axis, -1.0));
    add_touch(solve, search, SHAFT_TIP, tip, scaled(axis, -1.0));
    solve->shaft_count++;
}

static int is_stepped(const struct tissue_solve *solve, const struct body *body)
{
    for (uint32_t b = 0; b < solve->body_count; b++)
        if (solve->bodies[b].body == body)
            return 1;
    return 0;
}

void dpti_shafts_gather(struct tissue_solve *solve, const struct touch_search *search, int is_solved)
{
    const struct dpt_world *world = search->world;
    if (!tool_is_inserted(world, search->tool))
        return;
    const struct insertion *insertion = insertion_of(world, search->tool);
    for (uint32_t i = 0; i < insertion->count; i++) {
        const struct channel *channel = &world->channels[insertion->in[i].channel];
        if (is_stepped(solve, dpti_channel_body(world, channel)) != is_solved || !channel->point_count)
            continue;
        if (solve->shaft_count == TISSUE_SHAFTS_MAX)
            solve->is_full = 1;
        else
            set_shaft(solve, search, i);
    }
}

/* ---- rows ---- */

static uint32_t add_row(struct tissue_solve *solve, uint32_t index, vec3 direction, double compliance)
{
    const struct touch *touch = &solve->touches.touch[index];
    const struct tissue_link *link = &solve->links[index];
    const struct tissue_tool *tool = &solve->tools[link->tool];
    const struct tissue_shaft *shaft = &solve->shafts[shaft_of_touch(touch)];
    struct tissue_row *row = &solve->rows[solve->row_count];
    *row = (struct tissue_row){ .touch = index,
                                .along = direction,
                                .within = link->body == DPT_NONE ? direction
                                                                 : frame_turn_back(&shaft->body->frame, direction),
                                .compliance = compliance };
    dpti_touch_lever(tool->proxy, &tool->at, tool->axes, touch->at, direction, row->lever);
    return solve->row_count++;
}

static void add_rows_of(struct tissue_solve *solve, uint32_t index)
{
    const struct touch *touch = &solve->touches.touch[index];
    struct tissue_shaft *shaft = &solve->shafts[shaft_of_touch(touch)];
    const uint32_t kind = shaft_touch_kind(touch);
    const double substep = solve->step / (double)solve->bodies[0].step.info.substeps;
    const vec3 back = scaled(shaft->axis, -1.0);
    vec3 across[2];
    unit_across(shaft->axis, across);
    if (kind < SHAFT_MEAN && shaft->across[kind] > 0.0) {
        shaft->across_row[kind] = add_row(solve, index, across[0], 1.0 / shaft->across[kind]);
        add_row(solve, index, across[1], 1.0 / shaft->across[kind]);
    }
    if (kind == SHAFT_MEAN && shaft->limit > 0.0)
        shaft->friction_row = add_row(solve, index, back, 1.0 / shaft->stiffness);
    if (kind == SHAFT_MEAN && shaft->drag > 0.0)
        shaft->drag_row = add_row(solve, index, back, substep / shaft->drag);
    if (kind == SHAFT_TIP) {
        shaft->stop_row = add_row(solve, index, back, 0.0);
        shaft->cut_row = add_row(solve, index, back, 0.0);
    }
}

/* Rows that only push come first, as the solver begins with them: then its factor is in order. */
void dpti_shafts_add_rows(struct tissue_solve *solve)
{
    for (int is_two_sided = 0; is_two_sided < 2; is_two_sided++)
        for (uint32_t i = 0; i < solve->touches.count; i++) {
            const struct touch *touch = &solve->touches.touch[i];
            if (!touch->shaft || (shaft_touch_kind(touch) != SHAFT_TIP) != is_two_sided)
                continue;
            if (solve->row_count + ROWS_OF_TOUCH <= TISSUE_ROWS)
                add_rows_of(solve, i);
            else
                solve->is_full = 1;
        }
}

void dpti_shafts_set_known(struct tissue_solve *solve)
{
    dpti_shafts_forget_known(solve);
    for (uint32_t i = 0; i < solve->shaft_count; i++) {
        const struct tissue_shaft *shaft = &solve->shafts[i];
        if (shaft->friction_row && shaft->is_slipping)
            dpti_shaft_push(solve, &solve->rows[shaft->friction_row], shaft->pull);
        if (shaft->cut_row && shaft->is_cutting)
            dpti_shaft_push(solve, &solve->rows[shaft->cut_row], shaft->cutting);
    }
    dpti_shafts_push_nodes(solve);
}

/* How far the tool would go along a row, and its body against it, since the step began, without pushes to be found. */
static double moved_along(const struct tissue_solve *solve, const struct tissue_row *row)
{
    const struct tissue_tool *tool = &solve->tools[solve->links[row->touch].tool];
    double sum = -dot(row->within, dpti_shaft_moved(solve, row));
    for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
        sum += row->lever[k] * tool->known[k];
    return sum;
}

static void set_gap(struct tissue_solve *solve, uint32_t row, double gap, uint8_t kind)
{
    solve->free_gap[row] = gap + moved_along(solve, &solve->rows[row]);
    solve->kind[row] = kind;
}

static void set_gaps_across(struct tissue_solve *solve, const struct tissue_shaft *shaft, uint32_t point)
{
    const struct tissue_tool *tool = &solve->tools[shaft->tool];
    const uint32_t first = shaft->across_row[point];
    const vec3 tip = frame_to_world(&tool->at.frame, dpti_tip_point(solve->world, &solve->world->tools[tool->slot]));
    for (uint32_t d = 0; d < 2 && first; d++) {
        const struct tissue_row *row = &solve->rows[first + d];
        const vec3 away = sub(sub(tip, solve->touches.touch[row->touch].at), shaft->offset[point]);
        set_gap(solve, first + d, dot(row->along, away), COMPLEMENTARITY_EQUAL);
    }
}

void dpti_shafts_set_gaps(struct tissue_solve *solve)
{
    dpti_shafts_find_moved(solve);
    for (uint32_t i = 0; i < solve->shaft_count; i++) {
        const struct tissue_shaft *shaft = &solve->shafts[i];
        const double stop = shaft->stop - shaft->place, uncut = shaft->uncut - shaft->place;
        for (uint32_t k = 0; k < shaft->point_count; k++)
            set_gaps_across(solve, shaft, k);
        if (shaft->friction_row)
            set_gap(solve, shaft->friction_row, shaft->rest - shaft->mean,
                    shaft->is_slipping ? COMPLEMENTARITY_WATCHED : COMPLEMENTARITY_EQUAL);
        if (shaft->drag_row)
            set_gap(solve, shaft->drag_row, shaft->gone, COMPLEMENTARITY_EQUAL);
        if (shaft->stop_row)
            set_gap(solve, shaft->stop_row, stop - (1.0 - RECOVERED) * min_of(stop, 0.0), COMPLEMENTARITY_CONSTRAINT);
        if (shaft->cut_row)
            set_gap(solve, shaft->cut_row, min_of(uncut, 1.0),
                    uncut > 0.5 || shaft->is_cutting ? COMPLEMENTARITY_WATCHED : COMPLEMENTARITY_CONSTRAINT);
    }
}

/* m: how far the bristles along would be stretched, did they not slip. */
static double stretch_of(const struct tissue_solve *solve, const struct tissue_shaft *shaft)
{
    const uint32_t row = shaft->friction_row;
    if (!row)
        return 0.0;
    return shaft->is_slipping ? -solve->problem.gap[row] : solve->multiplier[row] / shaft->stiffness;
}

/* One that slips the other way than it pulls sticks, or that is where it would be solved for next. */
static int update_friction(const struct tissue_solve *solve, struct tissue_shaft *shaft, int may_stick)
{
    const double stretch = stretch_of(solve, shaft), way = shaft->pull < 0.0 ? -stretch : stretch;
    if (!shaft->friction_row)
        return 0;
    if (shaft->is_slipping) {
        if (way >= shaft->stretch_max || !may_stick)
            return 0;
        shaft->is_slipping = 0;
        return 1;
    }
    if (fabs(stretch) <= LIMIT * shaft->stretch_max)
        return 0;
    shaft->is_slipping = 1;
    shaft->pull = stretch > 0.0 ? shaft->limit : -shaft->limit;
    return 1;
}

static int update_cutting(const struct tissue_solve *solve, struct tissue_shaft *shaft, int may_stick)
{
    const uint32_t row = shaft->cut_row;
    if (!row)
        return 0;
    if (!shaft->is_cutting && solve->multiplier[row] > LIMIT * shaft->cutting) {
        shaft->is_cutting = 1;
        return 1;
    }
    if (shaft->is_cutting && may_stick && solve->problem.gap[row] > 0.0) {
        shaft->is_cutting = 0;
        return 1;
    }
    return 0;
}

int dpti_shafts_update(struct tissue_solve *solve, int may_stick)
{
    int has_changed = 0;
    for (uint32_t i = 0; i < solve->shaft_count; i++) {
        has_changed |= update_friction(solve, &solve->shafts[i], may_stick);
        has_changed |= update_cutting(solve, &solve->shafts[i], may_stick);
    }
    return has_changed;
}

void dpti_shafts_take_pulls(struct tissue_solve *solve)
{
    for (uint32_t i = 0; i < solve->shaft_count; i++) {
        const struct tissue_shaft *shaft = &solve->shafts[i];
        if (shaft->friction_row && shaft->is_slipping)
            solve->multiplier[shaft->friction_row] = shaft->pull;
        if (shaft->cut_row && shaft->is_cutting)
            solve->multiplier[shaft->cut_row] = shaft->cutting;
    }
}

/* ---- what they are at the end ---- */

void dpti_shafts_end_substep(struct tissue_solve *solve, double share)
{
    for (uint32_t i = 0; i < solve->shaft_count; i++) {
        struct tissue_shaft *shaft = &solve->shafts[i];
        const double stretch = stretch_of(solve, shaft);
        const double held = min_of(max_of(stretch, -shaft->stretch_max), shaft->stretch_max);
        shaft->stretch = held;
        shaft->has_slipped |= (uint32_t)!shaft->friction_row;
        if (fabs(stretch - held) > SHAFT_ROUNDING) {
            shaft->rest += stretch - held;
            shaft->has_slipped = 1;
        }
        if (shaft->friction_row)
            shaft->felt_friction += share * solve->multiplier[shaft->friction_row];
        if (shaft->drag_row) {
            const double went = solve->multiplier[shaft->drag_row] * solve->rows[shaft->drag_row].compliance;
            shaft->gone += went;
            shaft->felt_friction += share * solve->multiplier[shaft->drag_row];
        }
        if (!shaft->stop_row)
            continue;
        const int is_paced = shaft->stop < shaft->wall && solve->multiplier[shaft->stop_row] > 0.0;
        shaft->is_paced = (uint32_t)is_paced;
        shaft->felt_cut += share * solve->multiplier[shaft->cut_row];
        shaft->felt_stop += share * solve->multiplier[shaft->stop_row];
    }
}

double dpti_shafts_stored(const struct tissue_solve *solve, const struct tissue_tool *tool)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < solve->shaft_count; i++) {
        const struct tissue_shaft *shaft = &solve->shafts[i];
        if (&solve->tools[shaft->tool] != tool)
            continue;
        sum += 0.5 * shaft->stiffness * shaft->stretch * shaft->stretch;
        for (uint32_t k = 0; k < shaft->point_count; k++)
            for (uint32_t d = 0; d < 2 && shaft->across_row[k]; d++) {
                const double push = solve->multiplier[shaft->across_row[k] + d];
                sum += 0.5 * push * push / shaft->across[k];
            }
    }
    return sum;
}

static void tell_shaft(struct tissue_solve *solve, const struct dpt_world *world, const struct tissue_shaft *shaft)
{
    struct inserted *in = inserted_of(world, solve, shaft);
    in->rest = shaft->rest;
    in->is_slipping = shaft->is_slipping;
    in->has_slipped = shaft->has_slipped;
    in->is_cutting = shaft->is_cutting;
    in->is_paced = shaft->is_paced;
    in->friction = shaft->felt_friction;
    in->tip = shaft->felt_cut + shaft->felt_stop;
    in->push = shaft->stop < shaft->wall ? 0.0 : in->tip;
    for (uint32_t k = 0; k < shaft->channel->point_count; k++) {
        struct channel_point *point = &shaft->channel->points[k];
        point->stiffness = k < shaft->point_count ? shaft->across[k] : 0.0;
        if (k < shaft->point_count)
            point->offset = frame_turn_back(&shaft->body->frame, shaft->offset[k]);
    }
}

void dpti_shafts_tell(struct tissue_solve *solve, struct dpt_world *world)
{
    for (uint32_t t = 0; t < solve->tool_count; t++) {
        const struct tool *tool = &world->tools[solve->tools[t].slot];
        if (!tool_is_inserted(world, tool))
            continue;
        struct insertion *insertion = insertion_of(world, tool);
        const vec3 axis = frame_turn(&solve->tools[t].at.frame, dpti_tip_direction(world, tool));
        insertion->push = 0.0;
        for (uint32_t i = 0; i < solve->touches.count; i++)
            if (!solve->touches.touch[i].shaft && solve->links[i].tool == t &&
                !dpti_is_inserted_in(world, tool, solve->touches.touch[i].body_id))
                insertion->push -= dot(solve->push[i], axis);
    }
    for (uint32_t i = 0; i < solve->shaft_count; i++)
        tell_shaft(solve, world, &solve->shafts[i]);
}

int dpti_shafts_are_there(const struct tissue_solve *solve, const struct dpt_world *world)
{
    uint32_t count = 0;
    for (uint32_t t = 0; world->channels && t < world->tool_slot_end; t++)
        count += world->tools[t].slot.used ? insertion_of(world, &world->tools[t])->count : 0;
    for (uint32_t i = 0; i < solve->shaft_count; i++)
        if (solve->shafts[i].channel->id != solve->shafts[i].channel_id)
            return 0;
    return count == solve->shaft_count;
}
