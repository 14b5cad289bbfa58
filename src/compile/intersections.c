/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Count the pairs of triangles that cut each other: first within each part, then between parts
 * (docs/algorithms/compile.md). Candidates come from a tree of boxes over the triangles, in the order of the file's box
 * tree: 16 triangles a leaf, 16 children a node. Each leaf is searched for by itself, so that the result does not
 * depend on the threads.
 */
#include <stdlib.h>
#include <string.h>

#include "base/lanes.h"
#include "base/return_if_error.h"
#include "compile/compile_context.h"
#include "compile/model.h"
#include "compile/triangle_pair.h"
#include "mesh/mesh_format.h"

/*
 * A unit of work is one test of a box against 16 boxes, or one pair of triangles. Each leaf may take LEAF_WORK. Leaves
 * that need more share, in their order, SHARED_MIN and SHARED_WORK per triangle of the mesh. Organs take 2 to 9 units
 * per triangle in all.
 */
#define LEAF_WORK   1024u
#define SHARED_WORK 64u
#define SHARED_MIN  ((uint64_t)1 << 23) /* enough for all pairs of 4,000 triangles */

/* The least work for a thread of its own, in leaves and in vertices. */
#define LEAVES_MIN   256u
#define VERTICES_MIN 2048u

/* The number of leaves that are searched before their pairs are counted. */
#define BATCH 4096u

/* Relative margin of the tests for a simple star, far above their rounding error. */
#define STAR_MARGIN 0x1p-40

/* The boxes of 16 triangles or nodes, in the mesh's frame. An empty lane meets no box. */
struct box_block {
    float low[3][LANES], high[3][LANES];
};

/* What the search from one leaf found. */
struct leaf_result {
    uint32_t pairs;
    uint32_t example[2]; /* the first such pair, by source numbers */
    int is_stopped;      /* 1: the work ran out */
};

/*
 * The tree of boxes. A leaf or node has a label if all of its triangles share a part, or (within one part) a vertex
 * with a simple star. Triangles below two nodes of the same label need no test. Label DPT_NONE: none.
 */
struct box_tree {
    const struct model *model;
    const uint32_t *triangles; /* in the order of the leaves, by place; borrowed */
    uint32_t triangle_count;
    uint32_t levels; /* above the leaves, which are level 0 */
    uint32_t level_count[MESH_LEVELS_MAX + 1], level_first[MESH_LEVELS_MAX + 1];
    struct box_block *blocks;
    uint32_t *labels; /* of each leaf and node */
    struct leaf_result *results;
    const uint8_t *star_is_simple; /* of each vertex */
    int is_between_parts;          /* 1: search for pairs of different parts; 0: within one part */
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
        facet->corner[k] = (struct corner){ vec3_of_float(model->positions + 3 * (size_t)corner[k]), corner[k] };
    facet_finish(facet);
}

/* A triangle at a vertex, wound as its part will be: the edges from that vertex to the next and to the last corner. */
struct wedge {
    vec3 next, last;
    uint32_t next_neighbour, last_neighbour; /* triangles over these two edges */
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

/*
 * A walk round a vertex, from edge to edge of its triangles, as seen along `direction`. Full turns are counted where
 * the walk passes from the back of a plane through the vertex, with the normal `across`, to its front.
 */
struct star_walk {
    vec3 direction, across;
    int is_uneven;  /* 1: some step is not surely forward by less than half a turn */
    uint32_t turns; /* full turns so far */
};

static void step_to(struct star_walk *walk, vec3 from, vec3 to)
{
    const vec3 d = walk->direction, across = walk->across;
    const double side_from = dot(across, from);
    walk->is_uneven |= !(dot(cross(from, to), d) > STAR_MARGIN * dot(cross_magnitude(from, to), magnitude_of(d))) ||
                       !(fabs(side_from) > STAR_MARGIN * extent_of(across) * extent_of(from));
    walk->turns += side_from < 0.0 && dot(across, to) > 0.0;
}

/* Walk on from the end of an open fan to its beginning, through the gap between them. */
static void close_fan(struct star_walk *walk, vec3 end, vec3 begin)
{
    const vec3 d = walk->direction, quarter = scaled(cross(d, end), 1.0 / length(d));
    const vec3 steps_round[3] = { end, quarter, scaled(end, -1.0) };
    const double sine = dot(cross(end, begin), d) * length(d);
    const double cosine = dot(cross(d, end), cross(d, begin));
    /* The gap is less than half a turn, about half or more: 0, 1 or 2 steps of a quarter turn come first. */
    const int steps = fabs(sine) < -cosine ? 1 : sine > 0.0 ? 0 : 2;
    for (int i = 0; i < steps; i++)
        step_to(walk, steps_round[i], steps_round[i + 1]);
    step_to(walk, steps_round[steps], begin);
}

/*
 * Is a vertex's star simple? That is: seen along some direction, its triangles lie side by side round the vertex, over
 * one turn at most. Then no two of them cut each other.
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

/* What check_stars reads and writes. */
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

/* Make all lanes empty: such a box meets no other. */
static void clear_block(struct box_block *block)
{
    for (int axis = 0; axis < 3; axis++)
        for (uint32_t lane = 0; lane < LANES; lane++) {
            block->low[axis][lane] = HUGE_VALF;
            block->high[axis][lane] = -HUGE_VALF;
        }
}

/*
 * Boxes meet only if they overlap; boxes that touch do not. So a flat box is widened by one float on either side:
 * triangles in one axis-aligned plane must meet.
 */
static void put_triangle_box(struct box_block *block, uint32_t lane, const struct model *model, uint32_t triangle)
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

/* Set a lane to the box around the 16 boxes of a child. */
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

/* Does the triangle lie in the part `label`, or have the vertex `label`? */
static int label_holds(const struct box_tree *tree, uint32_t label, uint32_t triangle)
{
    return tree->is_between_parts ? tree->model->part_of[triangle] == label : has_vertex(tree->model, triangle, label);
}

/* The label of a leaf: what all of its triangles share, their part or a vertex with a simple star. */
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

static void fill_tree(struct box_tree *tree, const uint32_t *triangles, uint32_t count, uint32_t threads)
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

/* Which of the 16 boxes of `block` meet the box in one lane of `other`? Returns a bit for each lane. */
static uint32_t lanes_meeting(const struct box_block *block, const struct box_block *other, uint32_t lane)
{
    static const uint32_t bit[LANES] = { 0x1,   0x2,   0x4,   0x8,   0x10,   0x20,   0x40,   0x80,
                                         0x100, 0x200, 0x400, 0x800, 0x1000, 0x2000, 0x4000, 0x8000 };
    const float low[3] = { other->low[0][lane], other->low[1][lane], other->low[2][lane] };
    const float high[3] = { other->high[0][lane], other->high[1][lane], other->high[2][lane] };
    uint32_t lanes = 0;
    for (uint32_t k = 0; k < LANES; k++) {
        const int meets = (block->low[0][k] < high[0]) & (low[0] < block->high[0][k]) & (block->low[1][k] < high[1]) &
                          (low[1] < block->high[1][k]) & (block->low[2][k] < high[2]) & (low[2] < block->high[2][k]);
        lanes |= bit[k] & (uint32_t)-meets;
    }
    return lanes;
}

/* Mark the search as stopped if its work has run out. Returns 1 if it is stopped. */
static int stop_if_spent(struct leaf_search *search)
{
    search->result->is_stopped |= search->work >= search->max_work;
    return search->result->is_stopped;
}

/*
 * Can two triangles be skipped? Between parts: both lie in one part. Within one: they share a vertex with a simple
 * star.
 */
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

/* Test one pair, and count it if the triangles cut each other. `one` is the facet of `a`. */
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

/*
 * Test the triangles of the search's leaf against those of leaf `other`, which may be the same. The box of `other` is
 * in `lane` of `parent`.
 */
static void search_leaf(struct leaf_search *search, uint32_t other, const struct box_block *parent, uint32_t lane)
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

/*
 * Search the leaves below a node. Leaves before this search's leaf are skipped: their own searches found those pairs.
 */
static void search_node(struct leaf_search *search, uint32_t level, uint32_t node)
{
    const struct box_tree *tree = search->tree;
    const struct box_block *own_parent = &tree->blocks[tree->level_first[1] + search->leaf / LANES];
    const struct box_block *block = &tree->blocks[tree->level_first[level] + node];
    const uint32_t label = tree->labels[search->leaf];
    search->work++;
    for (uint32_t lanes = lanes_meeting(block, own_parent, search->leaf % LANES); lanes && !stop_if_spent(search);
         lanes &= lanes - 1) {
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

/* Search the whole tree for pairs with the triangles of one leaf. Returns the work spent. */
static uint64_t search_from_leaf(const struct box_tree *tree, uint32_t leaf, uint64_t max_work)
{
    struct leaf_search search = { .tree = tree, .leaf = leaf, .max_work = max_work };
    search.result = &tree->results[leaf];
    *search.result = (struct leaf_result){ .pairs = 0 };
    search_node(&search, tree->levels, 0);
    return search.work;
}

/* Consecutive leaves, from leaf `first` on. */
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
 * Search from every leaf of the tree, and add the pairs to the model's. Returns 1 if there are pairs, or may be because
 * a search stopped. Once that is so and the model has its full number of pairs, no further batch is searched.
 */
static int search_leaves(struct box_tree *tree, struct model *model, uint32_t threads, uint64_t *shared_work)
{
    const uint32_t leaves = tree->level_count[0];
    int has_pairs = 0;
    for (struct batch batch = { tree, 0 }; batch.first < leaves; batch.first += BATCH) {
        const uint32_t remaining = leaves - batch.first, count = remaining < BATCH ? remaining : BATCH;
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

/* List the triangles of each part, ascending. */
static dpt_result list_parts(struct model *model, const struct compile_context *context)
{
    uint32_t *list = model->part_list = compile_alloc(context, model->triangle_count, sizeof *model->part_list);
    uint32_t *first = model->part_first =
        compile_alloc(context, (size_t)model->part_count + 1, sizeof *model->part_first);
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

/*
 * Search each part, and mark those that cut themselves. Then search for pairs of different parts, unless the model has
 * its full number of pairs. `all` is scratch of one word per triangle.
 */
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

dpt_result model_intersections(struct model *model, const struct compile_context *context)
{
    const size_t count = model->triangle_count;
    uint32_t levels[MESH_LEVELS_MAX + 1];
    uint64_t nodes;
    mesh_levels((uint32_t)((count + LANES - 1) / LANES), levels, &nodes);
    nodes += levels[0];
    struct box_tree tree = { .model = model };
    struct stars stars = { model, compile_alloc(context, model->vertex_count, 1) };
    uint32_t *all = compile_alloc(context, model->part_count > 1 ? count : 0, sizeof *all);
    model->part_cuts_itself = compile_alloc(context, model->part_count, 1);
    tree.star_is_simple = stars.is_simple;
    tree.blocks = compile_alloc(context, (size_t)nodes, sizeof *tree.blocks);
    tree.labels = compile_alloc(context, (size_t)nodes, sizeof *tree.labels);
    tree.results = compile_alloc(context, levels[0], sizeof *tree.results);
    dpt_result result = list_parts(model, context);
    if (!stars.is_simple || !all || !model->part_cuts_itself || !tree.blocks || !tree.labels || !tree.results)
        result = DPT_E_MEMORY;
    model->self_intersection[0] = model->self_intersection[1] = DPT_NONE;
    if (result == DPT_OK) {
        parallel_for(context->threads, model->vertex_count, VERTICES_MIN, check_stars, &stars);
        search_all(&tree, model, all, context->threads);
    }
    free(stars.is_simple);
    free(all);
    free(tree.blocks);
    free(tree.labels);
    free(tree.results);
    return result;
}
