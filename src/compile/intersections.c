/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which triangles cut each other, first within each part, then those of different parts (docs/algorithms/compile.md).
 * A tree over the triangles in their order, which is that of the box tree: leaves of 16, then nodes of 16. Each leaf is
 * searched for by itself, so that the result does not depend on the threads.
 */
#include <stdlib.h>
#include <string.h>

#include "base/lanes.h"
#include "base/return_if_error.h"
#include "compile/model.h"
#include "compile/parallel.h"
#include "compile/triangle_pair.h"
#include "mesh/mesh_format.h"

/*
 * Work is counted in tests of a box against 16 boxes and in pairs of triangles. A leaf may take LEAF_WORK; leaves that do
 * not come to an end share, in their order, what the mesh has beyond that. Organs take 2 to 9 a triangle.
 */
#define LEAF_WORK   1024u
#define SHARED_WORK 64u                 /* a triangle */
#define SHARED_MIN  ((uint64_t)1 << 23) /* suffices for all pairs of 4,000 triangles */

/* Of this many leaves or vertices a thread is worth making. */
#define LEAVES_MIN   256u
#define VERTICES_MIN 2048u

/* So many leaves are searched before their pairs are counted. */
#define BATCH 4096u

/* Far above the rounding of what it is for. */
#define STAR_MARGIN 0x1p-40

/* The boxes of 16 triangles or nodes; one that is not there meets nothing. */
struct box_block {
    float low[3][LANES], high[3][LANES];
};

/* Of a leaf. */
struct leaf_result {
    uint32_t pairs;
    uint32_t example[2];
    int is_stopped;
};

struct box_tree {
    const struct model *model;
    const uint32_t *triangles; /* borrowed */
    uint32_t triangle_count;
    uint32_t levels; /* 0 are the leaves */
    uint32_t level_count[MESH_LEVELS_MAX + 1], level_first[MESH_LEVELS_MAX + 1];
    struct box_block *blocks;
    uint32_t *
        labels; /* of a leaf or node: pairs within those of one label are passed over; DPT_NONE: none */
    struct leaf_result *results;
    const uint8_t *star_is_simple; /* a vertex's star is */
    int is_between_parts;          /* pairs of different parts, not within one */
};

struct leaf_search {
    const struct box_tree *tree;
    uint32_t leaf;
    uint64_t work, max_work;
    struct leaf_result *result;
};

static void load_facet_corners(const struct model *model, uint32_t triangle, struct facet *facet)
{
    const uint32_t *corner = model->corners + 3 * (size_t)triangle;
    for (int k = 0; k < 3; k++)
        facet->corner[k] =
            (struct corner){ vec3_of_float(model->positions + 3 * (size_t)corner[k]), corner[k] };
    facet_finish(facet);
}

/* A triangle at a vertex, as its part will be wound: from the vertex to its next corner and to its last one. */
struct wedge {
    vec3 next, last;
    uint32_t next_neighbour, last_neighbour; /* neighbours */
};

static struct wedge wedge_of(const struct model *model, uint32_t triangle, uint32_t vertex)
{
    const uint32_t *corner = model->corners + 3 * (size_t)triangle;
    const uint32_t *neighbour = model->neighbours + 3 * (size_t)triangle;
    const int k = corner[0] == vertex ? 0 : corner[1] == vertex ? 1 : 2, last = (k + 2) % 3;
    const vec3 x = vec3_of_float(model->positions + 3 * (size_t)vertex);
    const vec3 a = sub(vec3_of_float(model->positions + 3 * (size_t)corner[(k + 1) % 3]), x);
    const vec3 b = sub(vec3_of_float(model->positions + 3 * (size_t)corner[last]), x);
    return model->is_turned[triangle] ? (struct wedge){ b, a, neighbour[last], neighbour[k] }
                                      : (struct wedge){ a, b, neighbour[k], neighbour[last] };
}

/* Going round a vertex as seen along a direction; `across` leads to one side of a line through it. */
struct star_walk {
    vec3 direction, across;
    int is_uneven;  /* not each step goes forward by less than half a turn, beyond rounding */
    uint32_t turns; /* steps to that side from the other one */
};

static void step_to(struct star_walk *walk, vec3 from, vec3 to)
{
    const vec3 d = walk->direction, across = walk->across;
    const double side_from = dot(across, from);
    walk->is_uneven |= !(dot(cross(from, to), d) >
                         STAR_MARGIN * dot(cross_magnitude(from, to), magnitude_of(d))) ||
                       !(fabs(side_from) > STAR_MARGIN * extent_of(across) * extent_of(from));
    walk->turns += side_from < 0.0 && dot(across, to) > 0.0;
}

/* On from the end of an open fan to its beginning, through what is free. */
static void close_fan(struct star_walk *walk, vec3 end, vec3 begin)
{
    const vec3 d = walk->direction, quarter = scaled(cross(d, end), 1.0 / length(d));
    const vec3 steps_round[3] = { end, quarter, scaled(end, -1.0) };
    const double sine = dot(cross(end, begin), d) * length(d);
    const double cosine = dot(cross(d, end), cross(d, begin));
    /* Less than half a turn, about half, or more. */
    const int steps = fabs(sine) < -cosine ? 1 : sine > 0.0 ? 0 : 2;
    for (int i = 0; i < steps; i++)
        step_to(walk, steps_round[i], steps_round[i + 1]);
    step_to(walk, steps_round[steps], begin);
}

/*
 * Seen from some direction, the triangles at a vertex lie round it side by side, once at most: then no two of them cut
 * each other.
 */
static int star_is_simple(const struct model *model, uint32_t vertex)
{
    static const vec3 guides[2] = { { 0.31, 0.57, 0.76 }, { 0.76, -0.31, 0.57 } };
    const uint32_t first = model->fan_first[vertex], end = model->fan_first[vertex + 1];
    struct star_walk walk = { .turns = 0 };
    vec3 open_next = { 0.0, 0.0, 0.0 }, open_last = open_next;
    uint32_t begins = 0, ends = 0;
    for (uint32_t i = first; i < end; i++) {
        const uint32_t t = model->fans[i];
        const struct wedge wedge = wedge_of(model, t, vertex);
        if (wedge.next_neighbour == MESH_EDGE_MANY || wedge.last_neighbour == MESH_EDGE_MANY ||
            !(model->parts[model->part_of[t]].flags & MESH_PART_WOUND))
            return 0;
        walk.direction = add(walk.direction, cross(wedge.next, wedge.last));
        begins += wedge.next_neighbour == MESH_EDGE_OPEN;
        ends += wedge.last_neighbour == MESH_EDGE_OPEN;
        open_next = wedge.next_neighbour == MESH_EDGE_OPEN ? wedge.next : open_next;
        open_last = wedge.last_neighbour == MESH_EDGE_OPEN ? wedge.last : open_last;
    }
    const vec3 d = walk.direction;
    walk.across = cross(d, guides[0]);
    if (dot(walk.across, walk.across) < 0.01 * dot(d, d))
        walk.across = cross(d, guides[1]);
    for (uint32_t i = first; i < end && !walk.is_uneven; i++) {
        const struct wedge wedge = wedge_of(model, model->fans[i], vertex);
        step_to(&walk, wedge.next, wedge.last);
    }
    if (begins > 0 && begins + ends == 2 && !walk.is_uneven)
        close_fan(&walk, open_last, open_next);
    return !walk.is_uneven && walk.turns == 1 && begins < 2;
}

struct stars {
    const struct model *model;
    uint8_t *is_simple;
};

static void check_stars(void *context, size_t first, size_t end)
{
    const struct stars *stars = context;
    for (size_t v = first; v < end; v++)
        stars->is_simple[v] = (uint8_t)star_is_simple(stars->model, (uint32_t)v);
}

/* An empty lane meets nothing. */
static void clear_block(struct box_block *block)
{
    for (int axis = 0; axis < 3; axis++)
        for (uint32_t lane = 0; lane < LANES; lane++) {
            block->low[axis][lane] = HUGE_VALF;
            block->high[axis][lane] = -HUGE_VALF;
        }
}

/* Wider than flat, so that what lies in one plane meets, and what only touches does not. */
static void put_triangle_box(struct box_block *block, uint32_t lane, const struct model *model,
                             uint32_t triangle)
{
    const uint32_t *corner = model->corners + 3 * (size_t)triangle;
    for (uint32_t axis = 0; axis < 3; axis++) {
        const float a = model->positions[3 * (size_t)corner[0] + axis];
        const float b = model->positions[3 * (size_t)corner[1] + axis];
        const float c = model->positions[3 * (size_t)corner[2] + axis];
        float low = a < b ? a : b, high = a < b ? b : a;
        low = c < low ? c : low;
        high = c > high ? c : high;
        block->low[axis][lane] = low < high ? low : nextafterf(low, -HUGE_VALF);
        block->high[axis][lane] = low < high ? high : nextafterf(high, HUGE_VALF);
    }
}

/* Of 16 boxes. */
static void put_child_box(struct box_block *block, uint32_t lane, const struct box_block *child)
{
    for (int axis = 0; axis < 3; axis++) {
        float low = HUGE_VALF, high = -HUGE_VALF;
        for (uint32_t k = 0; k < LANES; k++) {
            low = child->low[axis][k] < low ? child->low[axis][k] : low;
            high = child->high[axis][k] > high ? child->high[axis][k] : high;
        }
        block->low[axis][lane] = low;
        block->high[axis][lane] = high;
    }
}

static int has_vertex(const struct model *model, uint32_t triangle, uint32_t vertex)
{
    const uint32_t *corner = model->corners + 3 * (size_t)triangle;
    return corner[0] == vertex || corner[1] == vertex || corner[2] == vertex;
}

static int label_holds(const struct box_tree *tree, uint32_t label, uint32_t triangle)
{
    return tree->is_between_parts ? tree->model->part_of[triangle] == label
                                  : has_vertex(tree->model, triangle, label);
}

/* What all of a leaf's triangles share: their part, or a vertex with a plain star. */
static uint32_t leaf_label(const struct box_tree *tree, const uint32_t *triangles, uint32_t count)
{
    uint32_t candidates[3], n = 0;
    const uint32_t *corner = tree->model->corners + 3 * (size_t)triangles[0];
    if (tree->is_between_parts)
        candidates[n++] = tree->model->part_of[triangles[0]];
    for (int k = 0; !tree->is_between_parts && k < 3; k++)
        if (tree->star_is_simple[corner[k]])
            candidates[n++] = corner[k];
    for (uint32_t i = 0; i < n; i++) {
        uint32_t agreeing = 1;
        while (agreeing < count && label_holds(tree, candidates[i], triangles[agreeing]))
            agreeing++;
        if (agreeing == count)
            return candidates[i];
    }
    return DPT_NONE;
}

static void fill_leaves(void *context, size_t first, size_t end)
{
    const struct box_tree *tree = context;
    for (size_t leaf = first; leaf < end; leaf++) {
        const uint32_t *triangles = tree->triangles + leaf * LANES;
        const uint32_t remaining = tree->triangle_count - (uint32_t)leaf * LANES;
        const uint32_t count = remaining < LANES ? remaining : LANES;
        clear_block(&tree->blocks[leaf]);
        for (uint32_t lane = 0; lane < count; lane++)
            put_triangle_box(&tree->blocks[leaf], lane, tree->model, triangles[lane]);
        tree->labels[leaf] = leaf_label(tree, triangles, count);
    }
}

static void fill_level(const struct box_tree *tree, uint32_t level)
{
    for (uint32_t node = 0; node < tree->level_count[level]; node++) {
        const uint32_t at = tree->level_first[level] + node;
        const uint32_t below = tree->level_first[level - 1] + node * LANES;
        const uint32_t remaining = tree->level_count[level - 1] - node * LANES;
        clear_block(&tree->blocks[at]);
        tree->labels[at] = tree->labels[below];
        for (uint32_t lane = 0; lane < LANES && lane < remaining; lane++) {
            put_child_box(&tree->blocks[at], lane, &tree->blocks[below + lane]);
            if (tree->labels[below + lane] != tree->labels[at])
                tree->labels[at] = DPT_NONE;
        }
    }
}

static void fill_tree(struct box_tree *tree, const uint32_t *triangles, uint32_t count,
                      uint32_t threads)
{
    uint64_t nodes;
    tree->triangles = triangles;
    tree->triangle_count = count;
    tree->levels = mesh_levels((count + LANES - 1) / LANES, tree->level_count, &nodes);
    tree->level_first[0] = 0;
    for (uint32_t level = 1; level <= tree->levels; level++)
        tree->level_first[level] = tree->level_first[level - 1] + tree->level_count[level - 1];
    parallel_for(threads, tree->level_count[0], LEAVES_MIN, fill_leaves, tree);
    for (uint32_t level = 1; level <= tree->levels; level++)
        fill_level(tree, level);
}

/* Which of 16 boxes meet a lane's. */
static uint32_t lanes_meeting(const struct box_block *block, const struct box_block *other,
                              uint32_t lane)
{
    static const uint32_t bit[LANES] = {
        0x1,   0x2,   0x4,   0x8,   0x10,   0x20,   0x40,   0x80,
        0x100, 0x200, 0x400, 0x800, 0x1000, 0x2000, 0x4000, 0x8000
    };
    const float low[3] = { other->low[0][lane], other->low[1][lane], other->low[2][lane] };
    const float high[3] = { other->high[0][lane], other->high[1][lane], other->high[2][lane] };
    uint32_t lanes = 0;
    for (uint32_t k = 0; k < LANES; k++) {
        const int meets = (block->low[0][k] < high[0]) & (low[0] < block->high[0][k]) &
                          (block->low[1][k] < high[1]) & (low[1] < block->high[1][k]) &
                          (block->low[2][k] < high[2]) & (low[2] < block->high[2][k]);
        lanes |= bit[k] & (uint32_t)-meets;
    }
    return lanes;
}

static int stop_if_spent(struct leaf_search *search)
{
    search->result->is_stopped |= search->work >= search->max_work;
    return search->result->is_stopped;
}

/* Two triangles of which it is known without looking. */
static int is_skipped_pair(const struct box_tree *tree, uint32_t a, uint32_t b)
{
    const uint32_t *corner = tree->model->corners + 3 * (size_t)a;
    if (tree->is_between_parts)
        return tree->model->part_of[a] == tree->model->part_of[b];
    for (int k = 0; k < 3; k++)
        if (has_vertex(tree->model, b, corner[k]) && tree->star_is_simple[corner[k]])
            return 1;
    return 0;
}

static void test_pair(struct leaf_search *search, uint32_t a, const struct facet *one, uint32_t b)
{
    const struct model *model = search->tree->model;
    struct leaf_result *result = search->result;
    struct facet two;
    load_facet_corners(model, b, &two);
    if (!facets_cut(one, &two, &search->work))
        return;
    if (!result->pairs++) {
        result->example[0] = model->sources[a];
        result->example[1] = model->sources[b];
    }
}

/* The leaf's triangles against those of another one, or of itself, whose box lies in a lane of its parent. */
static void search_leaf(struct leaf_search *search, uint32_t other, const struct box_block *parent,
                        uint32_t lane)
{
    const struct box_tree *tree = search->tree;
    const struct box_block *own = &tree->blocks[search->leaf], *block = &tree->blocks[other];
    const struct box_block *own_parent = &tree->blocks[tree->level_first[1] + search->leaf / LANES];
    const uint32_t columns = lanes_meeting(block, own_parent, search->leaf % LANES);
    for (uint32_t rows = lanes_meeting(own, parent, lane); rows; rows &= rows - 1) {
        const uint32_t row = first_lane(rows), a = tree->triangles[search->leaf * LANES + row];
        uint32_t lanes = lanes_meeting(block, own, row) & columns;
        struct facet facet;
        int is_loaded = 0;
        search->work++;
        if (other == search->leaf)
            lanes &= ~lanes_of(row + 1);
        for (; lanes && !stop_if_spent(search); lanes &= lanes - 1) {
            const uint32_t b = tree->triangles[other * LANES + first_lane(lanes)];
            if (is_skipped_pair(tree, a, b))
                continue;
            if (!is_loaded)
                load_facet_corners(tree->model, a, &facet);
            is_loaded = 1;
            test_pair(search, a, &facet, b);
        }
    }
}

/* What is below a node, but for leaves before this one: they have looked for themselves. */
static void search_node(struct leaf_search *search, uint32_t level, uint32_t node)
{
    const struct box_tree *tree = search->tree;
    const struct box_block *own_parent = &tree->blocks[tree->level_first[1] + search->leaf / LANES];
    const struct box_block *block = &tree->blocks[tree->level_first[level] + node];
    const uint32_t label = tree->labels[search->leaf];
    search->work++;
    for (uint32_t lanes = lanes_meeting(block, own_parent, search->leaf % LANES);
         lanes && !stop_if_spent(search); lanes &= lanes - 1) {
        const uint32_t lane = first_lane(lanes), child = node * LANES + lane;
        if (child < search->leaf >> 4 * (level - 1))
            continue;
        if (label != DPT_NONE && label == tree->labels[tree->level_first[level - 1] + child])
            continue;
        if (level == 1)
            search_leaf(search, child, block, lane);
        else
            search_node(search, level - 1, child);
    }
}

/* From the root. Returns the work. */
static uint64_t search_from_leaf(const struct box_tree *tree, uint32_t leaf, uint64_t max_work)
{
    struct leaf_search search = { .tree = tree, .leaf = leaf, .max_work = max_work };
    search.result = &tree->results[leaf];
    *search.result = (struct leaf_result){ .pairs = 0 };
    search_node(&search, tree->levels, 0);
    return search.work;
}

/* Leaves from `first` on. */
struct batch {
    const struct box_tree *tree;
    uint32_t first;
};

static void search_batch(void *context, size_t first, size_t end)
{
    const struct batch *batch = context;
    for (size_t i = first; i < end; i++)
        search_from_leaf(batch->tree, batch->first + (uint32_t)i, LEAF_WORK);
}

static void add_leaf_result(struct model *model, const struct leaf_result *result)
{
    const uint32_t remaining = MESH_SELF_INTERSECTIONS_MAX - model->self_intersections;
    if (result->pairs && model->self_intersection[0] == DPT_NONE)
        memcpy(model->self_intersection, result->example, sizeof result->example);
    if (result->is_stopped || result->pairs >= remaining)
        model->self_intersections_more = 1;
    model->self_intersections += result->pairs < remaining ? result->pairs : remaining;
}

/*
 * What is found is added to the model's; returns whether there is anything, or may be. Where that is known, and pairs are
 * enough, the next batch is not searched.
 */
static int search_leaves(struct box_tree *tree, struct model *model, uint32_t threads,
                         uint64_t *shared_work)
{
    const uint32_t leaves = tree->level_count[0];
    int has_pairs = 0;
    for (struct batch batch = { tree, 0 }; batch.first < leaves; batch.first += BATCH) {
        const uint32_t remaining = leaves - batch.first,
                       count = remaining < BATCH ? remaining : BATCH;
        if (has_pairs && model->self_intersections == MESH_SELF_INTERSECTIONS_MAX)
            break;
        parallel_for(threads, count, LEAVES_MIN, search_batch, &batch);
        for (uint32_t leaf = batch.first; leaf < batch.first + count; leaf++) {
            const struct leaf_result *result = &tree->results[leaf];
            if (result->is_stopped && *shared_work > 0) {
                const uint64_t work = search_from_leaf(tree, leaf, *shared_work);
                *shared_work -= work < *shared_work ? work : *shared_work;
            }
            has_pairs |= result->pairs || result->is_stopped;
            add_leaf_result(model, result);
        }
    }
    return has_pairs;
}

/* By part, each part's in their order. */
static dpt_result list_parts(struct model *model, soup *source)
{
    uint32_t *list = model->part_list =
        model_alloc(source, model->triangle_count, sizeof *model->part_list);
    uint32_t *first = model->part_first =
        model_alloc(source, (size_t)model->part_count + 1, sizeof *model->part_first);
    if (!list || !first)
        return DPT_E_MEMORY;
    uint32_t end = 0;
    for (uint32_t p = 0; p < model->part_count; p++) {
        first[p] = end;
        end += model->parts[p].triangles;
    }
    for (uint32_t t = 0; t < model->triangle_count; t++)
        list[first[model->part_of[t]]++] = t;
    for (uint32_t p = model->part_count; p > 0; p--)
        first[p] = first[p - 1];
    first[0] = 0;
    return DPT_OK;
}

/* All parts, to mark those that cut themselves; then between them, unless there are pairs enough. */
static void search_all(struct box_tree *tree, struct model *model, uint32_t *all, uint32_t threads)
{
    uint64_t shared_work = SHARED_MIN + SHARED_WORK * (uint64_t)model->triangle_count;
    for (uint32_t p = 0; p < model->part_count; p++) {
        const uint32_t count = model->parts[p].triangles;
        fill_tree(tree, model->part_list + model->part_first[p], count, threads);
        model->part_cuts_itself[p] = (uint8_t)search_leaves(tree, model, threads, &shared_work);
    }
    if (model->part_count == 1 || model->self_intersections == MESH_SELF_INTERSECTIONS_MAX)
        return;
    for (uint32_t t = 0; t < model->triangle_count; t++)
        all[t] = t;
    tree->is_between_parts = 1;
    fill_tree(tree, all, model->triangle_count, threads);
    search_leaves(tree, model, threads, &shared_work);
}

dpt_result model_intersections(struct model *model, soup *source)
{
    const size_t count = model->triangle_count;
    uint32_t levels[MESH_LEVELS_MAX + 1];
    uint64_t nodes;
    mesh_levels((uint32_t)((count + LANES - 1) / LANES), levels, &nodes);
    nodes += levels[0];
    struct box_tree tree = { .model = model };
    struct stars stars = { model, model_alloc(source, model->vertex_count, 1) };
    uint32_t *all = model_alloc(source, model->part_count > 1 ? count : 0, sizeof *all);
    model->part_cuts_itself = model_alloc(source, model->part_count, 1);
    tree.star_is_simple = stars.is_simple;
    tree.blocks = model_alloc(source, nodes, sizeof *tree.blocks);
    tree.labels = model_alloc(source, nodes, sizeof *tree.labels);
    tree.results = model_alloc(source, levels[0], sizeof *tree.results);
    dpt_result result = list_parts(model, source);
    if (!stars.is_simple || !all || !model->part_cuts_itself || !tree.blocks || !tree.labels ||
        !tree.results)
        result = DPT_E_MEMORY;
    model->self_intersection[0] = model->self_intersection[1] = DPT_NONE;
    if (result == DPT_OK) {
        parallel_for(source->threads, model->vertex_count, VERTICES_MIN, check_stars, &stars);
        search_all(&tree, model, all, source->threads);
    }
    free(stars.is_simple);
    free(all);
    free(tree.blocks);
    free(tree.labels);
    free(tree.results);
    return result;
}
