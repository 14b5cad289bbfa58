/* SPDX-License-Identifier: BSD-3-Clause */
#include "tissue/tissue_link.h"

#include <string.h>

#include "tissue/tissue_shaft.h"
#include "tissue/tissue_spread.h"
#include "track/deform_state.h"
#include "track/tool_parts.h"

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

/* Where the last node of a slice is told. */
static uint16_t *last_of_slice(struct tissue_solve *solve, uint32_t body, uint32_t slice)
{
    uint32_t place = ((slice + 977u * body) * 2654435769u) >> 21;
    for (; solve->slices[place]; place = (place + 1) % TISSUE_SLICES) {
        const struct tissue_node *known = &solve->nodes[solve->slices[place] - 1];
        if (known->node / LANES == slice && known->body == body)
            break;
    }
    return &solve->slices[place];
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
    uint16_t *last = last_of_slice(solve, body, node / LANES);
    solve->nodes[solve->node_count] = (struct tissue_node){ .body = body,
                                                            .node = node,
                                                            .response = dpti_loaded_step_response(step, node),
                                                            .begin = dpti_loaded_step_place(step, node),
                                                            .next = *last };
    solve->table[slot] = ++solve->node_count;
    *last = (uint16_t)solve->node_count;
    return solve->node_count - 1;
}

uint32_t dpti_tissue_node(struct tissue_solve *solve, uint32_t body, uint32_t node)
{
    return number_of(solve, body, node, TISSUE_NODES_MAX);
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
    const struct tissue_body *body = &linking->solve->bodies[linking->link->body];
    const struct spring_vertices *vertices;
    if (body->step.yield) {
        if (dpti_yield_of(body->step.yield, vertex, body->body->surface.positions + 3 * (size_t)vertex))
            add_node(linking, vertex, weight);
        else
            linking->has_room = 0;
        return;
    }
    vertices = &body->step.springs->vertices;
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

/* The corners of the triangle alone, or the touch's vertices. */
static void add_corners(struct linking *linking, const struct surface *surface, const struct touch *touch)
{
    const struct touch_vertices *all = &linking->solve->vertices;
    for (uint32_t i = touch->vertices; i; i = all->vertex[i - 1].next)
        add_corner(linking, all->vertex[i - 1].vertex, all->vertex[i - 1].share);
    if (touch->vertices)
        return;
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

/* The point of a channel. What else touches along a shaft loads such points, and has no nodes of its own. */
static void add_point(struct linking *linking, const struct surface *surface, const struct touch *touch)
{
    const uint32_t number = shaft_touch_kind(touch);
    if (number >= SHAFT_MEAN)
        return;
    const struct channel_point *point = &linking->solve->shafts[shaft_of_touch(touch)].channel->points[number];
    for (uint32_t h = 0; h < point->hit_count; h++)
        for (uint32_t k = 0; k < 3; k++)
            if (point->hits[h].weight[k] != 0.0)
                add_corner(linking, surface_corner(surface, point->hits[h].triangle, k), point->hits[h].weight[k]);
}

/* The row along a touch's normal, which has pushed nothing yet. */
static void set_row(struct tissue_solve *solve, uint32_t i)
{
    const struct touch *touch = &solve->touches.touch[i];
    const uint32_t body = solve->links[i].body;
    struct tissue_row *row = &solve->rows[i];
    *row = (struct tissue_row){ .touch = i, .along = touch->normal, .within = touch->normal };
    memcpy(row->lever, touch->row, sizeof row->lever);
    solve->push[i] = (vec3){ 0.0, 0.0, 0.0 };
    if (body != DPT_NONE)
        row->within = frame_turn_back(&solve->bodies[body].body->frame, touch->normal);
}

/* Returns 0 if there is no room for the nodes that the touch loads. */
static int link_touch(struct tissue_solve *solve, uint32_t i, int may_be_narrow)
{
    const struct touch *touch = &solve->touches.touch[i];
    struct tissue_link *link = &solve->links[i];
    struct linking linking = { solve, link, i, TISSUE_NODES_MAX, TISSUE_WEIGHTS_MAX, 1 };
    solve->linked++;
    *link = (struct tissue_link){ .body = body_of(solve, touch->body_id),
                                  .tool = tool_of(solve, touch->tool_slot),
                                  .node = solve->weighted + solve->weight_count,
                                  .weight = solve->weight + solve->weight_count };
    if (!touch->shaft)
        set_yield(solve, link, touch);
    set_row(solve, i);
    if (link->body == DPT_NONE)
        return 1;
    const struct body *body = solve->bodies[link->body].body;
    if (touch->shaft)
        add_point(&linking, &body->surface, touch);
    else if (deform_of(body)->def.load_radius > 0.0)
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
    memset(solve->slices, 0, sizeof solve->slices);
    for (uint32_t i = 0; i < solve->shaft_count; i++)
        solve->products[i].is_known = 0;
    solve->kept_count = 0;
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

/* ---- links that are kept ---- */

static struct kept_link kept_as(const struct tissue_solve *solve, const struct touch *touch)
{
    const uint32_t body = body_of(solve, touch->body_id);
    return (struct kept_link){ solve->shafts[shaft_of_touch(touch)].channel_id, shaft_touch_kind(touch), body,
                               tool_of(solve, touch->tool_slot) };
}

/* How many touches of shafts come before all others. */
static uint32_t count_first_shafts(const struct tissue_solve *solve)
{
    uint32_t count = 0;
    while (count < solve->touches.count && solve->touches.touch[count].shaft)
        count++;
    return count;
}

static int are_links_kept(const struct tissue_solve *solve)
{
    const uint32_t count = solve->kept_count;
    if (!count || count != count_first_shafts(solve))
        return 0;
    for (uint32_t i = 0; i < count; i++) {
        const struct kept_link now = kept_as(solve, &solve->touches.touch[i]);
        if (memcmp(&now, &solve->kept[i], sizeof now) != 0)
            return 0;
    }
    return 1;
}

/* Where physics is somebody else's, vertices that had come to rest were left to it. Returns 0 without room for them. */
static int list_kept_vertices(struct tissue_solve *solve)
{
    for (uint32_t i = 0; i < solve->kept_nodes; i++) {
        const struct tissue_node *node = &solve->nodes[i];
        const struct tissue_body *of = &solve->bodies[node->body];
        if (of->step.yield &&
            !dpti_yield_of(of->step.yield, node->node, of->body->surface.positions + 3 * (size_t)node->node))
            return 0;
    }
    return 1;
}

static void keep_links(struct tissue_solve *solve, uint32_t count)
{
    if (count > KEPT_LINKS_MAX)
        return;
    for (uint32_t i = 0; i < count; i++)
        solve->kept[i] = kept_as(solve, &solve->touches.touch[i]);
    solve->kept_count = count;
    solve->kept_nodes = solve->node_count;
    solve->kept_weights = solve->weight_count;
}

/* Nodes that came after those of the links that are kept: the last one first, so that searches pass by no empty place. */
static void forget_other_links(struct tissue_solve *solve)
{
    while (solve->node_count > solve->kept_nodes) {
        const struct tissue_node *node = &solve->nodes[solve->node_count - 1];
        solve->table[slot_of(solve, node->body, node->node)] = 0;
        *last_of_slice(solve, node->body, node->node / LANES) = (uint16_t)node->next;
        solve->node_count--;
    }
    solve->weight_count = solve->kept_weights;
    solve->linked = solve->kept_count;
}

/* Nodes that are kept begin elsewhere in each step, and may answer loads otherwise. */
static void begin_kept_nodes(struct tissue_solve *solve)
{
    const uint32_t last = shaft_of_touch(&solve->touches.touch[solve->kept_count - 1]);
    int is_same = 1;
    for (uint32_t i = 0; i < solve->node_count; i++) {
        struct tissue_node *node = &solve->nodes[i];
        const struct loaded_step *step = &solve->bodies[node->body].step;
        const double response = dpti_loaded_step_response(step, node->node);
        is_same &= response == node->response;
        node->response = response;
        node->begin = dpti_loaded_step_place(step, node->node);
        node->seen = 0;
    }
    for (uint32_t i = is_same ? last + 1 : 0; i < solve->shaft_count; i++)
        solve->products[i].is_known = 0;
}

/* Which touches are those of points of shafts, and where a shaft alone touches a body. */
static void note_shafts(struct tissue_solve *solve)
{
    for (uint32_t b = 0; b < solve->body_count; b++)
        solve->bodies[b].is_touched = solve->bodies[b].shaft = 0;
    for (uint32_t i = 0; i < solve->touches.count; i++) {
        const struct touch *touch = &solve->touches.touch[i];
        const uint32_t shaft = touch->shaft ? shaft_of_touch(touch) + 1 : 0;
        if (shaft && shaft_touch_kind(touch) < SHAFT_MEAN)
            solve->shafts[shaft - 1].touch[shaft_touch_kind(touch)] = i + 1;
        if (solve->links[i].body == DPT_NONE)
            continue;
        struct tissue_body *of = &solve->bodies[solve->links[i].body];
        of->shaft = of->is_touched && of->shaft != shaft ? 0 : shaft;
        of->is_touched = 1;
    }
}

static int link_all(struct tissue_solve *solve)
{
    const uint32_t first = count_first_shafts(solve);
    const int is_kept = are_links_kept(solve) && list_kept_vertices(solve);
    if (is_kept) {
        forget_other_links(solve);
        begin_kept_nodes(solve);
    } else {
        forget_links(solve);
    }
    for (uint32_t i = 0; i < solve->touches.count; i++) {
        if (i < first && is_kept)
            set_row(solve, i);
        else if (!link_touch(solve, i, 0))
            return 0;
        if (i + 1 == first)
            keep_links(solve, first);
    }
    return 1;
}

void dpti_tissue_link(struct tissue_solve *solve)
{
    solve->rub_count = solve->is_begun = solve->beside_count = 0;
    for (uint32_t i = 0; i < solve->shaft_count; i++)
        solve->products[i].beside = 0;
    solve->problem.matrix++;
    solve->problem.matrix += !solve->problem.matrix;
    if (!link_all(solve))
        link_nearest(solve);
    note_shafts(solve);
    for (uint32_t t = 0; t < solve->tool_count; t++)
        memset(&solve->tools[t].twist, 0, sizeof solve->tools[t].twist);
    solve->row_count = solve->touches.count;
}

/* A node of the solve that a load on one of them moves, too, and how far, m/N. Goes on as dpti_loaded_step_neighbour. */
static struct tissue_node *next_moved(struct tissue_solve *solve, const struct tissue_node *by, uint32_t *entry,
                                      double *response)
{
    uint32_t node;
    if (!loaded_step_has_neighbours(&solve->bodies[by->body].step))
        return NULL;
    while (dpti_loaded_step_neighbour(&solve->bodies[by->body].step, by->node, entry, &node, response)) {
        const uint32_t number = solve->table[slot_of(solve, by->body, node)];
        if (number)
            return &solve->nodes[number - 1];
    }
    return NULL;
}

void dpti_tissue_spread_touch(struct tissue_solve *solve, const struct tissue_link *link, double share)
{
    for (uint32_t k = 0; k < link->count; k++) {
        const struct tissue_node *node = &solve->nodes[link->node[k]], *other;
        const double weight = share * link->weight[k];
        double response;
        solve->spread[link->node[k]] += weight * node->response;
        for (uint32_t entry = 0; (other = next_moved(solve, node, &entry, &response)) != NULL;)
            solve->spread[other - solve->nodes] += weight * response;
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

double dpti_tissue_compliance(struct tissue_solve *solve, const struct tissue_link *link)
{
    double sum = 0.0;
    for (uint32_t k = 0; k < link->count; k++)
        solve->spread[link->node[k]] = link->weight[k];
    for (uint32_t k = 0; k < link->count; k++) {
        const struct tissue_node *node = &solve->nodes[link->node[k]], *other;
        double response;
        sum += link->weight[k] * link->weight[k] * node->response;
        for (uint32_t entry = 0; (other = next_moved(solve, node, &entry, &response)) != NULL;)
            sum += link->weight[k] * solve->spread[other - solve->nodes] * response;
    }
    for (uint32_t k = 0; k < link->count; k++)
        solve->spread[link->node[k]] = 0.0;
    return sum;
}

void dpti_tissue_add_answer(struct tissue_solve *solve, const struct tissue_link *link, double force, vec3 within)
{
    for (uint32_t k = 0; k < link->count; k++) {
        struct tissue_node *node = &solve->nodes[link->node[k]], *other;
        double response;
        node->answer = along(node->answer, force * link->weight[k] * node->response, within);
        for (uint32_t entry = 0; (other = next_moved(solve, node, &entry, &response)) != NULL;)
            other->answer = along(other->answer, force * link->weight[k] * response, within);
    }
}

void dpti_tissue_push_tool(struct tissue_solve *solve, const struct tissue_row *row, double force)
{
    struct tissue_tool *tool = &solve->tools[solve->links[row->touch].tool];
    for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
        tool->known[k] += force * row->lever[k] / tool->stiffness;
}

void dpti_tissue_add_known(struct tissue_solve *solve, const struct tissue_row *row, double force)
{
    dpti_tissue_push_tool(solve, row, force);
    dpti_tissue_add_answer(solve, &solve->links[row->touch], -force, row->within);
}

void dpti_tissue_answer(struct tissue_solve *solve)
{
    int is_asked = 0;
    for (uint32_t b = 0; b < solve->body_count; b++)
        is_asked |= solve->bodies[b].is_touched && !solve->bodies[b].shaft;
    for (uint32_t i = 0; i < solve->node_count; i++)
        solve->nodes[i].answer = (vec3){ 0.0, 0.0, 0.0 };
    for (uint32_t i = 0; i < solve->node_count && is_asked; i++) {
        struct tissue_node *node = &solve->nodes[i], *other;
        const vec3 load = node->load;
        double response;
        if ((load.x == 0.0 && load.y == 0.0 && load.z == 0.0) || solve->bodies[node->body].shaft)
            continue;
        node->answer = along(node->answer, node->response, load);
        for (uint32_t entry = 0; (other = next_moved(solve, node, &entry, &response)) != NULL;)
            other->answer = along(other->answer, response, load);
    }
}
