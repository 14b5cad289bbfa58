/* SPDX-License-Identifier: BSD-3-Clause */
#include "tissue/tissue_solve.h"

#include <string.h>

#include "proxy/proxy.h"

/* m: a gap of no less than minus that counts as met. */
#define TOLERANCE 1e-10

/* The number of a node in the solve, which is made if there is none; DPT_NONE without room. */
static uint32_t number_of(struct tissue_solve *solve, uint32_t body, uint32_t node)
{
    uint32_t slot = ((node + 977u * body) * 2654435769u) >> 20;
    for (; solve->table[slot]; slot = (slot + 1) % TISSUE_TABLE) {
        const struct tissue_node *known = &solve->nodes[solve->table[slot] - 1];
        if (known->node == node && known->body == body)
            return solve->table[slot] - 1;
    }
    if (solve->node_count == TISSUE_NODES_MAX)
        return DPT_NONE;
    const struct loaded_step *step = &solve->bodies[body].step;
    solve->nodes[solve->node_count] = (struct tissue_node){ .body = body,
                                                            .node = node,
                                                            .response = dpti_loaded_step_response(step, node),
                                                            .begin = dpti_loaded_step_place(step, node) };
    solve->table[slot] = ++solve->node_count;
    return solve->node_count - 1;
}

static void add_node(struct tissue_solve *solve, struct tissue_link *link, uint32_t node, double weight)
{
    const uint32_t number = number_of(solve, link->body, node);
    if (number == DPT_NONE) {
        solve->is_full = 1;
        return;
    }
    for (uint32_t k = 0; k < link->count; k++)
        if (link->node[k] == number) {
            link->weight[k] += weight;
            return;
        }
    link->node[link->count] = number;
    link->weight[link->count++] = weight;
}

static void add_corner(struct tissue_solve *solve, struct tissue_link *link, uint32_t vertex, double weight)
{
    const struct spring_vertices *vertices = &solve->bodies[link->body].step.springs->vertices;
    if (!vertices->nodes)
        add_node(solve, link, vertex, weight);
    for (size_t k = 4 * (size_t)vertex; vertices->nodes && k < 4 * (size_t)vertex + 4; k++)
        if (vertices->weights[k] != 0.0f)
            add_node(solve, link, vertices->nodes[k], weight * (double)vertices->weights[k]);
}

static uint32_t body_of(const struct tissue_solve *solve, uint32_t body_id)
{
    for (uint32_t i = 0; i < solve->body_count; i++)
        if (solve->bodies[i].body->id == body_id)
            return i;
    return DPT_NONE;
}

void dpti_tissue_link(struct tissue_solve *solve, const struct dpt_world *world)
{
    solve->node_count = 0;
    memset(solve->push, 0, sizeof solve->push);
    memset(solve->table, 0, sizeof solve->table);
    for (uint32_t i = 0; i < solve->touches.count; i++) {
        const struct touch *touch = &solve->touches.touch[i];
        const struct tool *tool = &world->tools[touch->tool_slot];
        struct tissue_link *link = &solve->links[i];
        *link = (struct tissue_link){ .body = body_of(solve, touch->body_id),
                                      .stiffness = proxy_of(world, tool)->coupling.stiffness };
        if (link->body == DPT_NONE)
            continue;
        const struct body *body = solve->bodies[link->body].body;
        link->normal = frame_turn_back(&body->frame, touch->normal);
        for (uint32_t k = 0; k < 3; k++)
            if (touch->weight[k] != 0.0)
                add_corner(solve, link, surface_corner(&body->surface, touch->triangle, k), touch->weight[k]);
    }
}

/* Where the loads that are set would take the touched nodes: all of a slice at once. */
static void foresee(struct tissue_solve *solve)
{
    double moved[SPRING_ROWS];
    for (uint32_t i = 0; i < solve->node_count; i++)
        solve->nodes[i].is_foreseen = 0;
    for (uint32_t i = 0; i < solve->node_count; i++) {
        const uint32_t body = solve->nodes[i].body, slice = solve->nodes[i].node / LANES;
        struct loaded_step *step = &solve->bodies[body].step;
        if (solve->nodes[i].is_foreseen)
            continue;
        dpti_loaded_step_foresee(step, slice, moved);
        for (uint32_t k = i; k < solve->node_count; k++) {
            struct tissue_node *node = &solve->nodes[k];
            const uint32_t lane = node->node % LANES;
            if (node->body != body || node->node / LANES != slice)
                continue;
            const vec3 by = { moved[lane], moved[LANES + lane], moved[2 * LANES + lane] };
            node->moved = sub(add(dpti_loaded_step_place(step, node->node), by), node->begin);
            node->is_foreseen = 1;
        }
    }
}

/* What a newton of one touch does to the gaps of all: it moves its tool away, and its nodes. */
static void give_column(void *user, uint32_t index, double *column)
{
    struct tissue_solve *solve = user;
    const struct touch *touch = &solve->touches.touch[index];
    const struct tissue_link *link = &solve->links[index];
    for (uint32_t k = 0; k < link->count; k++)
        solve->spread[link->node[k]] = link->weight[k] * solve->nodes[link->node[k]].response;
    for (uint32_t i = 0; i < solve->touches.count; i++) {
        const struct touch *other = &solve->touches.touch[i];
        const struct tissue_link *its = &solve->links[i];
        double sum = 0.0;
        if (link->body != DPT_NONE && its->body == link->body) {
            for (uint32_t k = 0; k < its->count; k++)
                sum += its->weight[k] * solve->spread[its->node[k]];
            sum *= dot(its->normal, link->normal);
        }
        if (other->tool_slot == touch->tool_slot) {
            double product = 0.0;
            for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
                product += touch->row[k] * other->row[k];
            sum += product / link->stiffness;
        }
        column[i] = sum;
    }
    for (uint32_t k = 0; k < link->count; k++)
        solve->spread[link->node[k]] = 0.0;
}

static void set_free_gaps(struct tissue_solve *solve)
{
    for (uint32_t i = 0; i < solve->touches.count; i++) {
        const struct tissue_link *link = &solve->links[i];
        vec3 moved = { 0.0, 0.0, 0.0 };
        for (uint32_t k = 0; k < link->count; k++)
            moved = along(moved, link->weight[k], solve->nodes[link->node[k]].moved);
        solve->free_gap[i] = solve->touches.touch[i].device_gap - dot(link->normal, moved);
    }
}

static struct touch_name name_of(const struct touch *touch)
{
    return (struct touch_name){ touch->tool_slot, touch->part, touch->body_id, touch->triangle, touch->feature };
}

/* Begin with the touches that held in the last step. */
static void begin_problem(struct tissue_solve *solve)
{
    struct complementarity *problem = &solve->problem;
    problem->count = solve->touches.count;
    problem->tolerance = TOLERANCE;
    problem->free_gap = solve->free_gap;
    problem->column = give_column;
    problem->user = solve;
    problem->active_count = 0;
    for (uint32_t i = 0; i < solve->touches.count; i++) {
        const struct touch_name name = name_of(&solve->touches.touch[i]);
        for (uint32_t k = 0; k < solve->held_count; k++)
            if (!memcmp(&name, &solve->held[k], sizeof name))
                problem->active[problem->active_count++] = i;
    }
}

static void note_held(struct tissue_solve *solve)
{
    const struct complementarity *problem = &solve->problem;
    solve->held_count = problem->active_count;
    for (uint32_t k = 0; k < problem->active_count; k++)
        solve->held[k] = name_of(&solve->touches.touch[problem->active[k]]);
}

/* Each touch that holds pushes its nodes away from the tool. */
static void find_loads(struct tissue_solve *solve)
{
    const struct complementarity *problem = &solve->problem;
    for (uint32_t i = 0; i < solve->node_count; i++)
        solve->nodes[i].load = (vec3){ 0.0, 0.0, 0.0 };
    for (uint32_t a = 0; a < problem->active_count; a++) {
        const struct tissue_link *link = &solve->links[problem->active[a]];
        for (uint32_t k = 0; k < link->count; k++) {
            vec3 *load = &solve->nodes[link->node[k]].load;
            *load = along(*load, -problem->multiplier[a] * link->weight[k], link->normal);
        }
    }
}

static double farthest_of(const struct tissue_solve *solve)
{
    double farthest = 0.0;
    for (uint32_t i = 0; i < solve->touches.count; i++) {
        const struct touch *touch = &solve->touches.touch[i];
        const struct tissue_link *link = &solve->links[i];
        vec3 moved = { 0.0, 0.0, 0.0 };
        for (uint32_t k = 0; k < link->count; k++) {
            const struct tissue_node *node = &solve->nodes[link->node[k]];
            moved = along(moved, link->weight[k], along(node->moved, node->response, node->load));
        }
        /* The gap changes by both. */
        const double tool = solve->problem.gap[i] - touch->gap + dot(link->normal, moved);
        farthest = max_of(farthest, length(moved) + fabs(tool));
    }
    return farthest;
}

double dpti_tissue_solve(struct tissue_solve *solve)
{
    for (uint32_t b = 0; b < solve->body_count; b++)
        dpti_loaded_step_set(&solve->bodies[b].step);
    foresee(solve);
    set_free_gaps(solve);
    begin_problem(solve);
    if (dpti_complementarity_solve(&solve->problem) != COMPLEMENTARITY_SOLVED)
        solve->is_full = 1;
    note_held(solve);
    find_loads(solve);
    return farthest_of(solve);
}

int dpti_tissue_substep(struct tissue_solve *solve)
{
    const struct complementarity *problem = &solve->problem;
    const double share = 1.0 / (double)solve->bodies[0].step.info.substeps;
    int is_done = 1;
    for (uint32_t a = 0; a < problem->active_count; a++)
        solve->push[problem->active[a]] += share * problem->multiplier[a];
    for (uint32_t i = 0; i < solve->node_count; i++)
        dpti_loaded_step_add(&solve->bodies[solve->nodes[i].body].step, solve->nodes[i].node, solve->nodes[i].load);
    for (uint32_t b = 0; b < solve->body_count; b++)
        is_done &= dpti_loaded_step_go(&solve->bodies[b].step);
    return is_done;
}
