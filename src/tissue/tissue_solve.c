/* SPDX-License-Identifier: BSD-3-Clause */
#include "tissue/tissue_solve.h"

#include <string.h>

#include "proxy/proxy.h"
#include "tissue/shaft_points.h"
#include "tissue/tissue_friction.h"
#include "tissue/tissue_link.h"
#include "tissue/tissue_shaft.h"
#include "tissue/tissue_twist.h"

/* m: a gap of no less than minus that counts as met. */
#define TOLERANCE 1e-10

/* The share of a missing gap that is made good in a substep. */
#define RECOVERED 0.2

/* Where the loads that are set would take the nodes of which that is not known: all of a slice at once. */
static void foresee(struct tissue_solve *solve)
{
    double moved[SPRING_ROWS], slid[SPRING_ROWS];
    for (uint32_t i = solve->node_count; i-- > 0;) {
        struct loaded_step *step = &solve->bodies[solve->nodes[i].body].step;
        uint32_t lanes = 0;
        if (solve->nodes[i].is_foreseen)
            continue;
        /* The last one that was made knows those before. */
        for (uint32_t k = i + 1; k > 0; k = solve->nodes[k - 1].next)
            lanes |= 1u << solve->nodes[k - 1].node % LANES;
        dpti_loaded_step_foresee(step, solve->nodes[i].node / LANES, lanes, moved, slid);
        for (uint32_t k = i + 1; k > 0; k = solve->nodes[k - 1].next) {
            struct tissue_node *node = &solve->nodes[k - 1];
            const uint32_t lane = node->node % LANES;
            const vec3 by = { moved[lane], moved[LANES + lane], moved[2 * LANES + lane] };
            node->slid = (vec3){ slid[lane], slid[LANES + lane], slid[2 * LANES + lane] };
            const vec3 place = solve->substep ? dpti_loaded_step_place(step, node->node) : node->begin;
            node->moved = sub(add(place, by), node->begin);
            node->is_foreseen = 1;
        }
    }
}

double dpti_tissue_yield(const struct tissue_solve *solve, uint32_t touch, uint32_t by)
{
    const struct tissue_link *link = &solve->links[touch], *other = &solve->links[by];
    const struct touch *at = &solve->touches.touch[touch], *from = &solve->touches.touch[by];
    if (!(link->yields > 0.0) || link->tool != other->tool || at->body_id != from->body_id)
        return 0.0;
    const vec3 away = sub(at->at, from->at);
    const double square = dot(away, away), spread = min_of(link->spread, other->spread);
    if (touch == by)
        return link->yields;
    if (!(square < spread * spread))
        return 0.0;
    /* Wendland's function of least degree for space: with it the matrix has no negative eigenvalue. */
    const double near = 1.0 - sqrt(square) / spread;
    return link->yields * near * near * dot(at->normal, from->normal);
}

static double lever_product(const double *lever, const double *unknowns)
{
    double sum = 0.0;
    for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
        sum += lever[k] * unknowns[k];
    return sum;
}

/* How far the point of a row moves by what is in `spread`. */
static double spread_at_row(const struct tissue_solve *solve, const struct tissue_row *row)
{
    return solve->touches.touch[row->touch].shaft ? dpti_shaft_spread_at(solve, row)
                                                  : tissue_spread_at(solve, &solve->links[row->touch]);
}

/* What a newton of a twist does to the gaps of all: it turns its tool, and its couple moves nodes along each axis. */
static void give_column_of_twist(struct tissue_solve *solve, const struct tissue_row *row, uint32_t first,
                                 double *column)
{
    const struct tissue_link *link = &solve->links[row->touch];
    struct tissue_tool *tool = &solve->tools[link->tool];
    for (uint32_t i = first; i < solve->row_count; i++)
        column[i] = solve->links[solve->rows[i].touch].tool == link->tool
                        ? lever_product(row->lever, solve->rows[i].lever) / tool->stiffness
                        : 0.0;
    for (uint32_t axis = 0; axis < 3; axis++) {
        const struct tissue_link part = dpti_twist_part(solve, &tool->twist, axis);
        dpti_tissue_spread_touch(solve, &part, 1.0);
        for (uint32_t i = first; i < solve->row_count; i++) {
            const struct tissue_row *other = &solve->rows[i];
            const struct tissue_link *its = &solve->links[other->touch];
            if (its->body != link->body)
                continue;
            const double sum = other->is_twist ? 0.0 : spread_at_row(solve, other);
            column[i] += other->is_twist ? dpti_twist_product(solve, &solve->tools[its->tool].twist, twist_axis(axis))
                                         : sum * dot(other->within, twist_axis(axis));
        }
        dpti_tissue_clear_spread(solve, &part);
    }
    work_spend(&solve->work, 3 * (solve->row_count - first));
}

/* What a newton along one row does to the gaps of all: it moves its tool away, and its nodes. */
static void give_column(void *user, uint32_t index, uint32_t first, double *column)
{
    struct tissue_solve *solve = user;
    const struct tissue_row *row = &solve->rows[index];
    const struct tissue_link *link = &solve->links[row->touch];
    const double stiffness = solve->tools[link->tool].stiffness;
    uint32_t products = link->count;
    if (row->is_twist) {
        give_column_of_twist(solve, row, first, column);
        return;
    }
    if (solve->touches.touch[row->touch].shaft) {
        dpti_shafts_give_column(solve, index, first, column);
        return;
    }
    dpti_shafts_find_beside(solve);
    dpti_tissue_spread_touch(solve, link, 1.0);
    for (uint32_t i = first; i < solve->row_count; i++) {
        const struct tissue_row *other = &solve->rows[i];
        const struct tissue_link *its = &solve->links[other->touch];
        double sum = 0.0;
        if (other->is_twist && link->body != DPT_NONE && its->body == link->body) {
            sum = dpti_twist_product(solve, &solve->tools[its->tool].twist, row->within);
        } else if (link->body != DPT_NONE && its->body == link->body) {
            sum = solve->touches.touch[other->touch].shaft ? dpti_shaft_moved_by(solve, other, row->touch)
                                                           : tissue_spread_at(solve, its);
            products += its->count;
            sum *= dot(other->within, row->within);
        }
        if (its->tool == link->tool) {
            double product = 0.0;
            for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
                product += row->lever[k] * other->lever[k];
            sum += product / stiffness;
            products += TOUCH_DIMENSIONS;
        }
        if (index < solve->touches.count && i < solve->touches.count)
            sum += dpti_tissue_yield(solve, i, index);
        column[i] = sum;
    }
    if (index >= first)
        column[index] += row->compliance;
    work_spend(&solve->work, products / LANES + 1);
    dpti_tissue_clear_spread(solve, link);
}

/* How far the point of a touch would slide in the substep, without the pushes that are to be found; or had moved before. */
static vec3 point_moved(const struct tissue_solve *solve, const struct tissue_link *link, int slides)
{
    vec3 moved = { 0.0, 0.0, 0.0 };
    for (uint32_t k = 0; k < link->count; k++) {
        const struct tissue_node *node = &solve->nodes[link->node[k]];
        moved = along(moved, link->weight[k], slides ? add(node->slid, node->answer) : sub(node->moved, node->slid));
    }
    return moved;
}

/* With the tool at its proxy. */
static double felt_gap(const struct tissue_solve *solve, uint32_t touch)
{
    return solve->touches.touch[touch].gap + solve->links[touch].unfelt;
}

/*
 * A pair that was not seen before it met, as a surface bends between two ticks, begins with less than no gap. What is
 * missing is made good by and by: at once it would throw light nodes away.
 */
static void set_gaps_of_touches(struct tissue_solve *solve)
{
    for (uint32_t i = 0; i < solve->touches.count; i++) {
        const struct tissue_row *row = &solve->rows[i];
        const struct tissue_link *link = &solve->links[i];
        const struct tissue_tool *tool = &solve->tools[link->tool];
        solve->free_gap[i] = 0.0;
        solve->kind[i] = COMPLEMENTARITY_WATCHED;
        if (solve->touches.touch[i].shaft)
            continue;
        const double moved = felt_gap(solve, i) - dot(row->within, point_moved(solve, link, 0));
        const double now = moved + lever_product(row->lever, tool->end) + link->yielded;
        solve->free_gap[i] = moved + lever_product(row->lever, tool->known) -
                             dot(row->within, point_moved(solve, link, 1)) - (1.0 - RECOVERED) * min_of(now, 0.0);
        solve->kind[i] = COMPLEMENTARITY_CONSTRAINT;
    }
}

/* How far a tool would slide on the surface, along each tangent. */
static void set_gaps_of_rubs(struct tissue_solve *solve)
{
    const double share = 1.0 / (double)solve->bodies[0].step.info.substeps;
    for (uint32_t r = 0; r < solve->rub_count; r++)
        for (uint32_t d = 0; d < 2; d++) {
            const uint32_t i = solve->rubs[r].row + d;
            const struct tissue_row *row = &solve->rows[i];
            const struct tissue_link *link = &solve->links[row->touch];
            const struct tissue_tool *tool = &solve->tools[link->tool];
            solve->free_gap[i] = lever_product(row->lever, tool->known) - lever_product(row->lever, tool->end) -
                                 dot(row->within, point_moved(solve, link, 1)) - share * solve->rubs[r].carried[d];
            solve->kind[i] = solve->rubs[r].state == RUB_STICKS ? COMPLEMENTARITY_EQUAL : COMPLEMENTARITY_WATCHED;
        }
}

static struct touch_name name_of(const struct touch *touch)
{
    return (struct touch_name){ touch->tool_slot, touch->part, touch->body_id,
                                touch->vertices ? touch->name : touch->triangle, touch->feature };
}

/* The touches that held in the last step, and their rubs. */
static void take_held(struct tissue_solve *solve)
{
    struct complementarity *problem = &solve->problem;
    memset(solve->multiplier, 0, solve->touches.count * sizeof *solve->multiplier);
    for (uint32_t i = 0; i < solve->touches.count; i++) {
        const struct touch_name name = name_of(&solve->touches.touch[i]);
        for (uint32_t k = 0; k < solve->held_count; k++)
            if (!memcmp(&name, &solve->held[k].name, sizeof name)) {
                problem->active[problem->active_count++] = i;
                solve->multiplier[i] = solve->held[k].push;
                if (!dpti_rubs_take(solve, i, &solve->held[k]))
                    solve->is_full = 1;
            }
    }
}

/* Begin with the touches that hold. */
static void begin_problem(struct tissue_solve *solve)
{
    struct complementarity *problem = &solve->problem;
    problem->tolerance = TOLERANCE;
    problem->free_gap = solve->free_gap;
    problem->kind = solve->kind;
    problem->column = give_column;
    problem->user = solve;
    problem->work = &solve->work;
    dpti_rubs_begin(solve);
    if (!solve->is_begun) {
        problem->active_count = 0;
        dpti_shafts_add_rows(solve);
        take_held(solve);
        dpti_twists_add(solve);
    }
    solve->is_begun = 1;
}

/* What the twist at a touch pulls with, if it slips. */
static double twist_at(const struct tissue_solve *solve, uint32_t touch)
{
    const struct tissue_twist *twist = &solve->tools[solve->links[touch].tool].twist;
    return twist->row && twist->touch == touch && twist->state == RUB_SLIPS ? twist->pull : 0.0;
}

static void note_held(struct tissue_solve *solve)
{
    solve->held_count = 0;
    for (uint32_t i = 0; i < solve->touches.count && solve->held_count < COMPLEMENTARITY_ACTIVE_MAX; i++)
        if (solve->multiplier[i] > 0.0)
            solve->held[solve->held_count++] =
                (struct held_touch){ name_of(&solve->touches.touch[i]), solve->multiplier[i],
                                     dpti_rubs_against(solve, i), twist_at(solve, i) };
}

/* One pass: pushes, and the pulls of what sticks, beside the pulls of what slips. */
static void solve_pass(struct tissue_solve *solve)
{
    struct complementarity *problem = &solve->problem;
    problem->count = solve->row_count;
    dpti_rubs_set_known(solve);
    dpti_shafts_set_known(solve);
    set_gaps_of_touches(solve);
    set_gaps_of_rubs(solve);
    dpti_twists_set_gaps(solve);
    dpti_shafts_set_gaps(solve);
    if (dpti_complementarity_solve(problem) != COMPLEMENTARITY_SOLVED)
        solve->is_full = 1;
    memset(solve->multiplier, 0, problem->count * sizeof *solve->multiplier);
    for (uint32_t a = 0; a < problem->active_count; a++)
        solve->multiplier[problem->active[a]] = problem->multiplier[a];
}

/* Pulls of what slips join the multipliers. */
static void take_pulls(struct tissue_solve *solve)
{
    dpti_shafts_take_pulls(solve);
    for (uint32_t r = 0; r < solve->rub_count; r++)
        for (uint32_t d = 0; d < 2; d++)
            if (solve->rubs[r].state == RUB_SLIPS)
                solve->multiplier[solve->rubs[r].row + d] = solve->rubs[r].pull[d];
    for (uint32_t t = 0; t < solve->tool_count; t++)
        if (solve->tools[t].twist.row && solve->tools[t].twist.state == RUB_SLIPS)
            solve->multiplier[solve->tools[t].twist.row] = solve->tools[t].twist.pull;
}

/* Each row pushes its nodes away from the tool. */
static void find_loads(struct tissue_solve *solve)
{
    for (uint32_t i = 0; i < solve->node_count; i++)
        solve->nodes[i].load = (vec3){ 0.0, 0.0, 0.0 };
    for (uint32_t i = 0; i < solve->row_count; i++) {
        const struct tissue_link *link = &solve->links[solve->rows[i].touch];
        if (solve->multiplier[i] == 0.0 || solve->touches.touch[solve->rows[i].touch].shaft)
            continue;
        for (uint32_t k = 0; k < link->count; k++) {
            vec3 *load = &solve->nodes[link->node[k]].load;
            *load = along(*load, -solve->multiplier[i] * link->weight[k], solve->rows[i].within);
        }
    }
    dpti_shafts_load_nodes(solve);
    for (uint32_t t = 0; t < solve->tool_count; t++) {
        const struct tissue_twist *twist = &solve->tools[t].twist;
        const double pull = twist->row ? solve->multiplier[twist->row] : 0.0;
        for (uint32_t k = 0; k < twist->count && pull != 0.0; k++) {
            vec3 *load = &solve->nodes[twist->node[k]].load;
            *load = along(*load, -pull, (vec3){ twist->force[0][k], twist->force[1][k], twist->force[2][k] });
        }
    }
    dpti_tissue_answer(solve);
}

static double farthest_of(const struct tissue_solve *solve)
{
    double farthest = dpti_shafts_farthest(solve);
    for (uint32_t i = 0; i < solve->touches.count; i++) {
        const struct tissue_link *link = &solve->links[i];
        vec3 moved = { 0.0, 0.0, 0.0 };
        if (solve->touches.touch[i].shaft)
            continue;
        for (uint32_t k = 0; k < link->count; k++) {
            const struct tissue_node *node = &solve->nodes[link->node[k]];
            moved = along(moved, link->weight[k], add(node->moved, node->answer));
        }
        /* The gap changes by both. */
        const double tool = solve->problem.gap[i] - felt_gap(solve, i) + dot(solve->rows[i].within, moved);
        farthest = max_of(farthest, length(moved) + fabs(tool));
    }
    return farthest;
}

/* How often pulls are found again. A tool that sticks, or slides as it did, needs one to four. */
enum { PASSES = 12, PASSES_STICKING = 6 };

double dpti_tissue_solve(struct tissue_solve *solve)
{
    for (uint32_t b = 0; b < solve->body_count; b++)
        dpti_loaded_step_set(&solve->bodies[b].step);
    for (uint32_t i = 0; i < solve->node_count; i++)
        solve->nodes[i].is_foreseen = 0;
    begin_problem(solve);
    for (int pass = 1, is_last = 0;; pass++) {
        foresee(solve);
        solve_pass(solve);
        if (is_last || pass == PASSES)
            break;
        is_last = work_is_spent(&solve->work);
        const int may_stick = pass < PASSES_STICKING && !is_last;
        const int have_shafts_changed = dpti_shafts_update(solve, may_stick);
        if (!dpti_rubs_update(solve, may_stick) && !have_shafts_changed)
            break;
        solve->is_full |= (uint32_t)is_last;
    }
    note_held(solve);
    take_pulls(solve);
    find_loads(solve);
    return farthest_of(solve);
}

/* How far the bodies' own surfaces have yielded. */
static void note_yields(struct tissue_solve *solve)
{
    for (uint32_t i = 0; i < solve->touches.count; i++) {
        struct tissue_link *link = &solve->links[i];
        link->yielded = 0.0;
        for (uint32_t k = 0; k < solve->touches.count && link->yields > 0.0; k++)
            if (solve->multiplier[k] > 0.0)
                link->yielded += solve->multiplier[k] * dpti_tissue_yield(solve, i, k);
    }
}

/* Where each tool is at the end of the substep, and what it feels. */
static void move_tools(struct tissue_solve *solve, double share)
{
    dpti_rubs_end(solve);
    note_yields(solve);
    for (uint32_t t = 0; t < solve->tool_count; t++)
        memcpy(solve->tools[t].end, solve->tools[t].away, sizeof solve->tools[t].end);
    for (uint32_t i = 0; i < solve->row_count; i++) {
        const struct tissue_row *row = &solve->rows[i];
        struct tissue_tool *tool = &solve->tools[solve->links[row->touch].tool];
        if (solve->multiplier[i] == 0.0)
            continue;
        solve->push[row->touch] = along(solve->push[row->touch], share * solve->multiplier[i], row->along);
        for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
            tool->end[k] += solve->multiplier[i] * row->lever[k] / tool->stiffness;
    }
    for (uint32_t t = 0; t < solve->tool_count; t++)
        if (solve->tools[t].twist.row)
            solve->tools[t].twist.mean += share * solve->multiplier[solve->tools[t].twist.row];
    for (uint32_t t = 0; t < solve->tool_count; t++)
        for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
            solve->tools[t].felt[k] += share * (solve->tools[t].end[k] - solve->tools[t].device[k]);
}

int dpti_tissue_substep(struct tissue_solve *solve)
{
    int is_done = 1;
    const double share = 1.0 / (double)solve->bodies[0].step.info.substeps;
    move_tools(solve, share);
    dpti_shafts_end_substep(solve, share);
    for (uint32_t i = 0; i < solve->node_count; i++)
        dpti_loaded_step_add(&solve->bodies[solve->nodes[i].body].step, solve->nodes[i].node, solve->nodes[i].load);
    for (uint32_t b = 0; b < solve->body_count; b++)
        is_done &= dpti_loaded_step_go(&solve->bodies[b].step);
    return is_done;
}
