/* SPDX-License-Identifier: BSD-3-Clause */
#include "tissue/tissue_solve.h"

#include <string.h>

#include "proxy/proxy.h"
#include "tissue/tissue_friction.h"
#include "tissue/tissue_spread.h"
#include "track/deform_state.h"
#include "track/tool_parts.h"

/* m: a gap of no less than minus that counts as met. */
#define TOLERANCE 1e-10

/* The share of a missing gap that is made good in a substep. */
#define RECOVERED 0.2

/* The place of a node of the solve in the table, or where it would be. */
static uint32_t slot_of(const struct tissue_solve *solve, uint32_t body, uint32_t node)
{
    uint32_t slot = ((node + 977u * body) * 2654435769u) >> 20;
    for (; solve->table[slot]; slot = (slot + 1) % TISSUE_TABLE) {
        const struct tissue_node *known = &solve->nodes[solve->table[slot] - 1];
        if (known->node == node && known->body == body)
            break;
    }
    return slot;
}

/* The number of a node in the solve, which is made if there is none; DPT_NONE without room. */
static uint32_t number_of(struct tissue_solve *solve, uint32_t body, uint32_t node, uint32_t room)
{
    const uint32_t slot = slot_of(solve, body, node);
    if (solve->table[slot])
        return solve->table[slot] - 1;
    if (solve->node_count >= room)
        return DPT_NONE;
    const struct loaded_step *step = &solve->bodies[body].step;
    solve->nodes[solve->node_count] = (struct tissue_node){ .body = body,
                                                            .node = node,
                                                            .response = dpti_loaded_step_response(step, node),
                                                            .begin = dpti_loaded_step_place(step, node) };
    solve->table[slot] = ++solve->node_count;
    return solve->node_count - 1;
}

/* A touch's link, being made. */
struct linking {
    struct tissue_solve *solve;
    struct tissue_link *link;
    uint32_t touch;
    uint32_t nodes, weights; /* for how many there is room */
    int has_room;
};

static void add_node(struct linking *linking, uint32_t node, double weight)
{
    struct tissue_solve *solve = linking->solve;
    struct tissue_link *link = linking->link;
    const uint32_t number = number_of(solve, link->body, node, linking->nodes);
    if (number == DPT_NONE || solve->weight_count + link->count >= linking->weights) {
        linking->has_room = 0;
        return;
    }
    struct tissue_node *of = &solve->nodes[number];
    if (of->seen == solve->linked) {
        link->weight[of->place] += weight;
        return;
    }
    of->seen = solve->linked;
    of->place = link->count;
    link->node[link->count] = (uint16_t)number;
    link->weight[link->count++] = weight;
}

static void add_corner(struct linking *linking, uint32_t vertex, double weight)
{
    const struct spring_vertices *vertices = &linking->solve->bodies[linking->link->body].step.springs->vertices;
    if (!vertices->nodes)
        add_node(linking, vertex, weight);
    for (size_t k = 4 * (size_t)vertex; vertices->nodes && k < 4 * (size_t)vertex + 4; k++)
        if (vertices->weights[k] != 0.0f)
            add_node(linking, vertices->nodes[k], weight * (double)vertices->weights[k]);
}

/* The load is spread: over the vertices that dpt_body_get_loads tells. */
static void add_patch(struct linking *linking)
{
    struct load_patch patch;
    dpti_spread_find(linking->solve, linking->touch, &patch);
    for (uint32_t i = 0; i < patch.count; i++)
        add_corner(linking, patch.vertex[i], patch.share[i]);
}

static uint32_t body_of(const struct tissue_solve *solve, uint32_t body_id)
{
    for (uint32_t i = 0; i < solve->body_count; i++)
        if (solve->bodies[i].body->id == body_id)
            return i;
    return DPT_NONE;
}

static uint32_t tool_of(const struct tissue_solve *solve, uint32_t slot)
{
    uint32_t t = 0;
    while (solve->tools[t].slot != slot)
        t++;
    return t;
}

/* m/N: so soft a surface gives no force. */
#define YIELDS_MAX 1e30

/* What the body's own surface yields by is shared by all touches that are no farther apart than the tool is thick. */
static void set_yield(const struct tissue_solve *solve, struct tissue_link *link, const struct touch *touch)
{
    const double stiffness = world_find_body(solve->world, touch->body_id)->stiffness;
    if (!(stiffness > 0.0))
        return;
    link->yields = min_of(1.0 / stiffness, YIELDS_MAX);
    link->spread = 2.0 * part_radius(tool_part(solve->world, &solve->world->tools[touch->tool_slot], touch->part));
}

/* The corners of the triangle alone. */
static void add_corners(struct linking *linking, const struct surface *surface, const struct touch *touch)
{
    for (uint32_t k = 0; k < 3; k++)
        if (touch->weight[k] != 0.0)
            add_corner(linking, surface_corner(surface, touch->triangle, k), touch->weight[k]);
}

/* Room that spread loads leave for those that are not: 3 corners of 4 nodes a touch, most of which others load, too. */
enum { NODES_LEFT = 384, WEIGHTS_LEFT = 12 * TOUCHES_MAX };

/* Its load is spread; with `may_be_narrow` it is not where there is no room. */
static void add_spread(struct linking *linking, const struct surface *surface, const struct touch *touch,
                       int may_be_narrow)
{
    struct tissue_link *link = linking->link;
    if (may_be_narrow) {
        linking->nodes -= NODES_LEFT;
        linking->weights -= WEIGHTS_LEFT;
    }
    add_patch(linking);
    if (linking->has_room || !may_be_narrow)
        return;
    linking->solve->linked++;
    linking->nodes += NODES_LEFT;
    linking->weights += WEIGHTS_LEFT;
    linking->has_room = 1;
    link->is_narrow = 1;
    link->count = 0;
    link->depth = link->unfelt = 0.0;
    add_corners(linking, surface, touch);
}

/* Returns 0 if there is no room for the nodes that the touch loads. */
static int link_touch(struct tissue_solve *solve, uint32_t i, int may_be_narrow)
{
    const struct touch *touch = &solve->touches.touch[i];
    struct tissue_link *link = &solve->links[i];
    struct tissue_row *row = &solve->rows[i];
    struct linking linking = { solve, link, i, TISSUE_NODES_MAX, TISSUE_WEIGHTS_MAX, 1 };
    solve->linked++;
    *link = (struct tissue_link){ .body = body_of(solve, touch->body_id),
                                  .tool = tool_of(solve, touch->tool_slot),
                                  .node = solve->weighted + solve->weight_count,
                                  .weight = solve->weight + solve->weight_count };
    set_yield(solve, link, touch);
    *row = (struct tissue_row){ .touch = i, .along = touch->normal, .within = touch->normal };
    memcpy(row->lever, touch->row, sizeof row->lever);
    solve->push[i] = (vec3){ 0.0, 0.0, 0.0 };
    if (link->body == DPT_NONE)
        return 1;
    const struct body *body = solve->bodies[link->body].body;
    row->within = frame_turn_back(&body->frame, touch->normal);
    if (deform_of(body)->def.load_radius > 0.0)
        add_spread(&linking, &body->surface, touch, may_be_narrow);
    else
        add_corners(&linking, &body->surface, touch);
    solve->weight_count += linking.has_room ? link->count : 0;
    return linking.has_room;
}

static void forget_links(struct tissue_solve *solve)
{
    solve->node_count = solve->weight_count = solve->linked = 0;
    memset(solve->table, 0, sizeof solve->table);
}

/* With the least gap first; those for which there is no room load corners alone, or are left out. */
static void link_nearest(struct tissue_solve *solve)
{
    struct touches *touches = &solve->touches;
    const uint32_t count = touches->count;
    solve->is_full = 1;
    for (uint32_t i = 1; i < count; i++)
        for (uint32_t k = i; k > 0 && touches->touch[k].gap < touches->touch[k - 1].gap; k--) {
            const struct touch nearer = touches->touch[k];
            touches->touch[k] = touches->touch[k - 1];
            touches->touch[k - 1] = nearer;
        }
    forget_links(solve);
    touches->count = 0;
    for (uint32_t i = 0; i < count; i++) {
        touches->touch[touches->count] = touches->touch[i];
        touches->count += (uint32_t)link_touch(solve, touches->count, 1);
    }
}

void dpti_tissue_link(struct tissue_solve *solve)
{
    int has_room = 1;
    solve->rub_count = solve->is_begun = 0;
    solve->problem.matrix++;
    solve->problem.matrix += !solve->problem.matrix;
    forget_links(solve);
    for (uint32_t i = 0; i < solve->touches.count && has_room; i++)
        has_room = link_touch(solve, i, 0);
    if (!has_room)
        link_nearest(solve);
}

/* Where the loads that are set would take the touched nodes: all of a slice at once. */
static void foresee(struct tissue_solve *solve)
{
    double moved[SPRING_ROWS], slid[SPRING_ROWS];
    for (uint32_t i = 0; i < solve->node_count; i++)
        solve->nodes[i].is_foreseen = 0;
    for (uint32_t i = 0; i < solve->node_count; i++) {
        const uint32_t body = solve->nodes[i].body, slice = solve->nodes[i].node / LANES;
        struct loaded_step *step = &solve->bodies[body].step;
        if (solve->nodes[i].is_foreseen)
            continue;
        dpti_loaded_step_foresee(step, slice, moved, slid);
        for (uint32_t k = i; k < solve->node_count; k++) {
            struct tissue_node *node = &solve->nodes[k];
            const uint32_t lane = node->node % LANES;
            if (node->body != body || node->node / LANES != slice)
                continue;
            const vec3 by = { moved[lane], moved[LANES + lane], moved[2 * LANES + lane] };
            node->slid = (vec3){ slid[lane], slid[LANES + lane], slid[2 * LANES + lane] };
            node->moved = sub(add(dpti_loaded_step_place(step, node->node), by), node->begin);
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

/* A node of the solve that a load on one of them moves, too, and how far, m/N. Goes on as dpti_loaded_step_neighbour. */
static struct tissue_node *next_moved(struct tissue_solve *solve, const struct tissue_node *by, uint32_t *entry,
                                      double *response)
{
    uint32_t node;
    while (dpti_loaded_step_neighbour(&solve->bodies[by->body].step, by->node, entry, &node, response)) {
        const uint32_t number = solve->table[slot_of(solve, by->body, node)];
        if (number)
            return &solve->nodes[number - 1];
    }
    return NULL;
}

void dpti_tissue_spread_touch(struct tissue_solve *solve, const struct tissue_link *link)
{
    for (uint32_t k = 0; k < link->count; k++) {
        const struct tissue_node *node = &solve->nodes[link->node[k]], *other;
        double response;
        solve->spread[link->node[k]] += link->weight[k] * node->response;
        for (uint32_t entry = 0; (other = next_moved(solve, node, &entry, &response)) != NULL;)
            solve->spread[other - solve->nodes] += link->weight[k] * response;
    }
}

void dpti_tissue_clear_spread(struct tissue_solve *solve, const struct tissue_link *link)
{
    for (uint32_t k = 0; k < link->count; k++) {
        const struct tissue_node *node = &solve->nodes[link->node[k]], *other;
        double response;
        solve->spread[link->node[k]] = 0.0;
        for (uint32_t entry = 0; (other = next_moved(solve, node, &entry, &response)) != NULL;)
            solve->spread[other - solve->nodes] = 0.0;
    }
}

void dpti_tissue_answer(struct tissue_solve *solve)
{
    for (uint32_t i = 0; i < solve->node_count; i++)
        solve->nodes[i].answer = (vec3){ 0.0, 0.0, 0.0 };
    for (uint32_t i = 0; i < solve->node_count; i++) {
        struct tissue_node *node = &solve->nodes[i], *other;
        const vec3 load = node->load;
        double response;
        if (load.x == 0.0 && load.y == 0.0 && load.z == 0.0)
            continue;
        node->answer = along(node->answer, node->response, load);
        for (uint32_t entry = 0; (other = next_moved(solve, node, &entry, &response)) != NULL;)
            other->answer = along(other->answer, response, load);
    }
}

/* What a newton along one row does to the gaps of all: it moves its tool away, and its nodes. */
static void give_column(void *user, uint32_t index, uint32_t first, double *column)
{
    struct tissue_solve *solve = user;
    const struct tissue_row *row = &solve->rows[index];
    const struct tissue_link *link = &solve->links[row->touch];
    const double stiffness = solve->tools[link->tool].stiffness;
    uint32_t products = link->count;
    dpti_tissue_spread_touch(solve, link);
    for (uint32_t i = first; i < tissue_row_count(solve); i++) {
        const struct tissue_row *other = &solve->rows[i];
        const struct tissue_link *its = &solve->links[other->touch];
        double sum = 0.0;
        if (link->body != DPT_NONE && its->body == link->body) {
            for (uint32_t k = 0; k < its->count; k++)
                sum += its->weight[k] * solve->spread[its->node[k]];
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
    work_spend(&solve->work, products / LANES + 1);
    dpti_tissue_clear_spread(solve, link);
}

static double lever_product(const double *lever, const double *unknowns)
{
    double sum = 0.0;
    for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
        sum += lever[k] * unknowns[k];
    return sum;
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
            const uint32_t i = tissue_row_of_rub(solve, r) + d;
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
    return (struct touch_name){ touch->tool_slot, touch->part, touch->body_id, touch->triangle, touch->feature };
}

/* The touches that held in the last step, and their rubs. */
static void take_held(struct tissue_solve *solve)
{
    struct complementarity *problem = &solve->problem;
    for (uint32_t i = 0; i < solve->touches.count; i++) {
        const struct touch_name name = name_of(&solve->touches.touch[i]);
        for (uint32_t k = 0; k < solve->held_count; k++)
            if (!memcmp(&name, &solve->held[k].name, sizeof name)) {
                problem->active[problem->active_count++] = i;
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
        take_held(solve);
    }
    solve->is_begun = 1;
}

static void note_held(struct tissue_solve *solve)
{
    solve->held_count = 0;
    for (uint32_t i = 0; i < solve->touches.count && solve->held_count < COMPLEMENTARITY_ACTIVE_MAX; i++)
        if (solve->multiplier[i] > 0.0)
            solve->held[solve->held_count++] = (struct held_touch){ name_of(&solve->touches.touch[i]),
                                                                    solve->multiplier[i], dpti_rubs_against(solve, i) };
}

/* One pass: pushes, and the pulls of what sticks, beside the pulls of what slips. */
static void solve_pass(struct tissue_solve *solve)
{
    struct complementarity *problem = &solve->problem;
    problem->count = tissue_row_count(solve);
    dpti_rubs_set_known(solve);
    set_gaps_of_touches(solve);
    set_gaps_of_rubs(solve);
    if (dpti_complementarity_solve(problem) != COMPLEMENTARITY_SOLVED)
        solve->is_full = 1;
    memset(solve->multiplier, 0, problem->count * sizeof *solve->multiplier);
    for (uint32_t a = 0; a < problem->active_count; a++)
        solve->multiplier[problem->active[a]] = problem->multiplier[a];
}

/* Pulls of what slips join the multipliers. */
static void take_pulls(struct tissue_solve *solve)
{
    for (uint32_t r = 0; r < solve->rub_count; r++)
        for (uint32_t d = 0; d < 2; d++)
            if (solve->rubs[r].state == RUB_SLIPS)
                solve->multiplier[tissue_row_of_rub(solve, r) + d] = solve->rubs[r].pull[d];
}

/* Each row pushes its nodes away from the tool. */
static void find_loads(struct tissue_solve *solve)
{
    for (uint32_t i = 0; i < solve->node_count; i++)
        solve->nodes[i].load = (vec3){ 0.0, 0.0, 0.0 };
    for (uint32_t i = 0; i < tissue_row_count(solve); i++) {
        const struct tissue_link *link = &solve->links[solve->rows[i].touch];
        if (solve->multiplier[i] == 0.0)
            continue;
        for (uint32_t k = 0; k < link->count; k++) {
            vec3 *load = &solve->nodes[link->node[k]].load;
            *load = along(*load, -solve->multiplier[i] * link->weight[k], solve->rows[i].within);
        }
    }
    dpti_tissue_answer(solve);
}

static double farthest_of(const struct tissue_solve *solve)
{
    double farthest = 0.0;
    for (uint32_t i = 0; i < solve->touches.count; i++) {
        const struct tissue_link *link = &solve->links[i];
        vec3 moved = { 0.0, 0.0, 0.0 };
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
    foresee(solve);
    begin_problem(solve);
    for (int pass = 1, is_last = 0;; pass++) {
        solve_pass(solve);
        if (is_last || pass == PASSES)
            break;
        is_last = work_is_spent(&solve->work);
        if (!dpti_rubs_update(solve, pass < PASSES_STICKING && !is_last))
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
    for (uint32_t i = 0; i < tissue_row_count(solve); i++) {
        const struct tissue_row *row = &solve->rows[i];
        struct tissue_tool *tool = &solve->tools[solve->links[row->touch].tool];
        if (solve->multiplier[i] == 0.0)
            continue;
        solve->push[row->touch] = along(solve->push[row->touch], share * solve->multiplier[i], row->along);
        for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
            tool->end[k] += solve->multiplier[i] * row->lever[k] / tool->stiffness;
    }
    for (uint32_t t = 0; t < solve->tool_count; t++)
        for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
            solve->tools[t].felt[k] += share * (solve->tools[t].end[k] - solve->tools[t].device[k]);
}

int dpti_tissue_substep(struct tissue_solve *solve)
{
    int is_done = 1;
    move_tools(solve, 1.0 / (double)solve->bodies[0].step.info.substeps);
    for (uint32_t i = 0; i < solve->node_count; i++)
        dpti_loaded_step_add(&solve->bodies[solve->nodes[i].body].step, solve->nodes[i].node, solve->nodes[i].load);
    for (uint32_t b = 0; b < solve->body_count; b++)
        is_done &= dpti_loaded_step_go(&solve->bodies[b].step);
    return is_done;
}
