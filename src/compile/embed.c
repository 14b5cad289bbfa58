/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Embed the vertices in a mesh of tetrahedra: each vertex gets a cell, and the weights of the cell's corners.
 *
 * A vertex takes the cell that it is within, or the nearest one. Of several the one with the lowest number wins, so the
 * answer depends neither on the tree of boxes, which only excludes cells, nor on the threads.
 */
#include "compile/embed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "compile/compile_context.h"
#include "mesh/mesh_format.h"
#include "nearest/segment_triangle.h"

/* Weights of a cell that is used, in size. Rounding may add a little; the file holds up to MESH_WEIGHT_MAX. */
#define WEIGHT_MAX 100.0

#define WIDTH      4u
#define LEVELS_MAX 17u /* 4^16 cells are all that 32 bits can number */

/* The least vertices for a thread of its own. */
#define EMBED_MIN 512u

static const source_location nowhere = { 0, 0 };

struct box {
    double low[3], high[3];
};

/* The corner of a cell, and the edges from it to the other three. */
struct frame_of_cell {
    vec3 corner[4], edge[3];
    double volume; /* times 6; of either sign */
};

struct cell_tree {
    const double *nodes; /* 3 each, m */
    const uint32_t *cells;
    uint32_t *order; /* the cells, near ones together */
    struct box *boxes;
    uint32_t level_count[LEVELS_MAX], level_first[LEVELS_MAX]; /* level 0: a box for each cell */
    uint32_t levels;
    double rounding; /* more than that of any distance, m */
};

/* The nearest cell so far. */
struct search {
    const struct cell_tree *tree;
    vec3 x;
    double nearest2; /* squared distance of the nearest cell, whatever its weights, m^2 */
    double best2;    /* of the nearest cell that can be used */
    double limit2;   /* boxes farther than this hold none that is as near: best2, and rounding */
    uint32_t cell;   /* that one; DPT_NONE: none yet */
    double weight[4];
};

/* Vertices that are embedded by one thread write their own entries alone. */
struct embedding {
    const struct cell_tree *tree;
    const struct model *model;
    double *distance2; /* of each vertex; below 0: no cell can be used */
};

static struct frame_of_cell frame_of(const double *nodes, const uint32_t cell[4], double scale)
{
    struct frame_of_cell frame;
    for (int k = 0; k < 4; k++)
        frame.corner[k] = scaled(vec3_of(nodes + 3 * (size_t)cell[k]), scale);
    for (int k = 0; k < 3; k++)
        frame.edge[k] = sub(frame.corner[k + 1], frame.corner[0]);
    frame.volume = dot(frame.edge[0], cross(frame.edge[1], frame.edge[2]));
    return frame;
}

dpt_result embed_check_node(const struct compile_context *context, const double x[3], int64_t number,
                            source_location location)
{
    for (int k = 0; k < 3; k++)
        if (!within(context->scale * x[k], DPT_COORDINATE_MAX))
            return compile_fail(context, DPT_E_FINITE, location,
                                "%c of node %lld is %.9g (times %.9g): not finite, or beyond %.0f m", "xyz"[k],
                                (long long)number, x[k], context -> scale, DPT_COORDINATE_MAX);
    return DPT_OK;
}

/* The sum of the sizes of the products that cross(a, b) is made of. */
static vec3 cross_sizes(vec3 a, vec3 b)
{
    return (vec3){ fabs(a.y * b.z) + fabs(a.z * b.y), fabs(a.z * b.x) + fabs(a.x * b.z),
                   fabs(a.x * b.y) + fabs(a.y * b.x) };
}

/* The bound of the rounding is Shewchuk's (1997) for the same determinant. */
dpt_result embed_check_cell(const struct compile_context *context, const double *nodes, const uint32_t cell[4],
                            int64_t number, source_location location)
{
    const struct frame_of_cell frame = frame_of(nodes, cell, context->scale);
    const vec3 e = frame.edge[0], sizes = cross_sizes(frame.edge[1], frame.edge[2]);
    const double rounding = 8.0 * 0x1p-53 * (fabs(e.x) * sizes.x + fabs(e.y) * sizes.y + fabs(e.z) * sizes.z);
    if (fabs(frame.volume) > rounding)
        return DPT_OK;
    return compile_fail(context, DPT_E_FINITE, location, "cell %lld has no volume: its four nodes lie in one plane",
                        (long long)number);
}

/* Check the def's nodes and cells, which other readers may have brought. */
static dpt_result check_cells(const struct compile_context *context)
{
    const dpt_compile_def *def = context->def;
    if (def->node_count > INT32_MAX || def->cell_count > INT32_MAX)
        return compile_fail(context, DPT_E_LIMIT, nowhere, "more than %d nodes or cells", INT32_MAX);
    for (size_t i = 0; i < def->node_count; i++)
        DPT_TRY(embed_check_node(context, def->nodes + 3 * i, (int64_t)i, nowhere));
    for (size_t i = 0; i < def->cell_count; i++) {
        const uint32_t *cell = def->cells + 4 * i;
        for (int k = 0; k < 4; k++)
            if (cell[k] >= def->node_count)
                return compile_fail(context, DPT_E_INDEX, nowhere, "cell %zu names node %u, and there are only %u", i,
                                    cell[k], def->node_count);
        DPT_TRY(embed_check_cell(context, def->nodes, cell, (int64_t)i, nowhere));
    }
    return DPT_OK;
}

static void box_add(struct box *box, const double *low, const double *high)
{
    for (int k = 0; k < 3; k++) {
        box->low[k] = min_of(box->low[k], low[k]);
        box->high[k] = max_of(box->high[k], high[k]);
    }
}

static const struct box empty_box = { { HUGE_VAL, HUGE_VAL, HUGE_VAL }, { -HUGE_VAL, -HUGE_VAL, -HUGE_VAL } };

static struct box box_of_cell(const struct cell_tree *tree, uint32_t cell)
{
    struct box box = empty_box;
    for (size_t k = 0; k < 4; k++) {
        const double *x = tree->nodes + 3 * (size_t)tree->cells[4 * (size_t)cell + k];
        box_add(&box, x, x);
    }
    return box;
}

/* A cell and where it lies along a curve through all of space that keeps near places together (Morton's). */
struct placed_cell {
    uint64_t code;
    uint32_t cell;
};

/* Spread 21 bits, two zeros after each. */
static uint64_t spread(uint64_t bits)
{
    bits = (bits | bits << 32) & 0x001f00000000ffffu;
    bits = (bits | bits << 16) & 0x001f0000ff0000ffu;
    bits = (bits | bits << 8) & 0x100f00f00f00f00fu;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3u;
    return (bits | bits << 2) & 0x1249249249249249u;
}

static uint64_t code_of(const struct box *box, const struct box *all)
{
    uint64_t code = 0;
    for (int k = 0; k < 3; k++) {
        const double side = all->high[k] - all->low[k];
        const double middle = 0.5 * (box->low[k] + box->high[k]) - all->low[k];
        const double share = side > 0.0 ? clamp01(middle / side) : 0.0;
        code |= spread((uint64_t)(share * 0x1fffff)) << k;
    }
    return code;
}

static int by_code(const void *a, const void *b)
{
    const struct placed_cell *left = a, *right = b;
    if (left->code != right->code)
        return left->code < right->code ? -1 : 1;
    return left->cell < right->cell ? -1 : left->cell > right->cell;
}

/* Put the cells into the order of the curve. */
static dpt_result order_cells(struct cell_tree *tree, const struct compile_context *context, uint32_t count)
{
    struct placed_cell *placed = compile_alloc(context, count, sizeof *placed);
    struct box all = empty_box;
    if (!placed)
        return DPT_E_MEMORY;
    for (uint32_t i = 0; i < count; i++) {
        const struct box box = box_of_cell(tree, i);
        box_add(&all, box.low, box.high);
    }
    for (uint32_t i = 0; i < count; i++) {
        const struct box box = box_of_cell(tree, i);
        placed[i] = (struct placed_cell){ code_of(&box, &all), i };
    }
    qsort(placed, count, sizeof *placed, by_code);
    for (uint32_t i = 0; i < count; i++)
        tree->order[i] = placed[i].cell;
    free(placed);
    return DPT_OK;
}

/* Every node has WIDTH children, the last one of a level perhaps fewer. */
static dpt_result build_tree(struct cell_tree *tree, const struct compile_context *context, uint32_t count)
{
    size_t boxes = 0;
    uint32_t level_size = count;
    for (tree->levels = 0; tree->levels == 0 || tree->level_count[tree->levels - 1] > 1;) {
        tree->level_first[tree->levels] = (uint32_t)boxes;
        tree->level_count[tree->levels++] = level_size;
        boxes += level_size;
        level_size = level_size / WIDTH + (level_size % WIDTH != 0);
    }
    tree->order = compile_alloc(context, count, sizeof *tree->order);
    tree->boxes = compile_alloc(context, boxes, sizeof *tree->boxes);
    if (!tree->order || !tree->boxes)
        return DPT_E_MEMORY;
    DPT_TRY(order_cells(tree, context, count));
    for (uint32_t i = 0; i < count; i++)
        tree->boxes[i] = box_of_cell(tree, tree->order[i]);
    for (uint32_t level = 1; level < tree->levels; level++) {
        const struct box *below = tree->boxes + tree->level_first[level - 1];
        struct box *here = tree->boxes + tree->level_first[level];
        for (uint32_t i = 0; i < tree->level_count[level]; i++)
            here[i] = empty_box;
        for (uint32_t i = 0; i < tree->level_count[level - 1]; i++)
            box_add(&here[i / WIDTH], below[i].low, below[i].high);
    }
    return DPT_OK;
}

static double box_distance2(const struct box *box, vec3 x)
{
    const double at[3] = { x.x, x.y, x.z };
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
        const double off = max_of(max_of(box->low[k] - at[k], at[k] - box->high[k]), 0.0);
        sum += off * off;
    }
    return sum;
}

/* The weights of the corners that give x; outside of the cell some are below 0. */
static void weights_of(const struct frame_of_cell *frame, vec3 x, double weight[4])
{
    const vec3 *e = frame->edge, from = sub(x, frame->corner[0]);
    const double per_volume = 1.0 / frame->volume, first = dot(from, cross(e[1], e[2])),
                 second = dot(from, cross(e[2], e[0])), third = dot(from, cross(e[0], e[1]));
    weight[0] = (frame->volume - first - second - third) * per_volume;
    weight[1] = first * per_volume;
    weight[2] = second * per_volume;
    weight[3] = third * per_volume;
}

static int is_within(const double weight[4])
{
    return weight[0] >= 0.0 && weight[1] >= 0.0 && weight[2] >= 0.0 && weight[3] >= 0.0;
}

/* The squared distance of x, which is not within, and a cell: that of the nearest face that x is in front of. */
static double cell_distance2(const struct frame_of_cell *frame, vec3 x, const double weight[4])
{
    double distance2 = HUGE_VAL;
    pair found;
    for (int k = 0; k < 4; k++) {
        if (weight[k] >= 0.0)
            continue;
        const vec3 face[3] = { frame->corner[(k + 1) % 4], frame->corner[(k + 2) % 4], frame->corner[(k + 3) % 4] };
        point_triangle(x, face, &found);
        distance2 = min_of(distance2, found.distance2);
    }
    return distance2;
}

static void take_cell(struct search *search, uint32_t cell, double distance2, const double weight[4])
{
    const double limit = sqrt(distance2) * (1.0 + 0x1p-40) + search->tree->rounding;
    search->best2 = distance2;
    search->limit2 = limit * limit;
    search->cell = cell;
    memcpy(search->weight, weight, sizeof search->weight);
}

/* Find the lowest-numbered cell that x is within. */
static void find_holder(struct search *search, uint32_t level, uint32_t node)
{
    const struct cell_tree *tree = search->tree;
    if (box_distance2(&tree->boxes[tree->level_first[level] + node], search->x) > 0.0)
        return;
    if (level > 0) {
        const uint32_t end = tree->level_count[level - 1];
        for (uint32_t i = node * WIDTH; i < end && i < (node + 1) * WIDTH; i++)
            find_holder(search, level - 1, i);
        return;
    }
    const uint32_t cell = tree->order[node];
    double weight[4];
    if (cell > search->cell)
        return;
    const struct frame_of_cell frame = frame_of(tree->nodes, tree->cells + 4 * (size_t)cell, 1.0);
    weights_of(&frame, search->x, weight);
    if (is_within(weight)) {
        take_cell(search, cell, 0.0, weight);
        search->nearest2 = 0.0;
    }
}

/* Is this cell, which x is not within, the nearest one that can be used? */
static void try_cell(struct search *search, uint32_t cell)
{
    const struct cell_tree *tree = search->tree;
    const struct frame_of_cell frame = frame_of(tree->nodes, tree->cells + 4 * (size_t)cell, 1.0);
    double weight[4], size = 0.0;
    weights_of(&frame, search->x, weight);
    const double distance2 = cell_distance2(&frame, search->x, weight);
    search->nearest2 = min_of(search->nearest2, distance2);
    if (distance2 > search->best2 || (distance2 == search->best2 && cell > search->cell))
        return;
    for (int k = 0; k < 4; k++)
        size = max_of(size, fabs(weight[k]));
    if (size <= WEIGHT_MAX)
        take_cell(search, cell, distance2, weight);
}

/* Search below one box of a level, nearer boxes first. */
static void find_nearest(struct search *search, uint32_t level, uint32_t node)
{
    const struct cell_tree *tree = search->tree;
    if (level == 0) {
        try_cell(search, tree->order[node]);
        return;
    }
    uint32_t child[WIDTH], count = 0;
    double distance2[WIDTH];
    const uint32_t end = tree->level_count[level - 1];
    const struct box *boxes = tree->boxes + tree->level_first[level - 1];
    for (uint32_t i = node * WIDTH; i < end && i < (node + 1) * WIDTH; i++) {
        const double d2 = box_distance2(&boxes[i], search->x);
        uint32_t at = count++;
        for (; at > 0 && distance2[at - 1] > d2; at--) {
            distance2[at] = distance2[at - 1];
            child[at] = child[at - 1];
        }
        distance2[at] = d2;
        child[at] = i;
    }
    for (uint32_t i = 0; i < count && distance2[i] <= search->limit2; i++)
        find_nearest(search, level - 1, child[i]);
}

/*
 * Round weights to floats whose sum is 1 exactly: all are multiples of one unit, with at most 24 bits, and the largest
 * one takes what is left. So a translation of the nodes moves the vertex by just as much.
 */
static void round_weights(const double weight[4], float rounded[4])
{
    int largest = 0;
    for (int k = 1; k < 4; k++)
        largest = fabs(weight[k]) > fabs(weight[largest]) ? k : largest;
    for (double unit = 0x1p-24;; unit *= 2.0) {
        double multiple[4], left = 1.0 / unit, size = 0.0;
        for (int k = 0; k < 4; k++) {
            multiple[k] = k == largest ? 0.0 : floor(weight[k] / unit + 0.5);
            left -= multiple[k];
            size = max_of(size, fabs(multiple[k]));
        }
        if (max_of(size, fabs(left)) > 0x1p24)
            continue;
        multiple[largest] = left;
        for (int k = 0; k < 4; k++)
            rounded[k] = (float)(multiple[k] * unit);
        return;
    }
}

/* Embed vertices first..end; stop at the first one that no cell can take. */
static void embed_vertices(void *context, size_t first, size_t end)
{
    const struct embedding *embedding = context;
    const struct cell_tree *tree = embedding->tree;
    const struct model *model = embedding->model;
    uint32_t last = DPT_NONE;
    for (size_t v = first; v < end; v++) {
        struct search search = { .tree = tree,
                                 .x = vec3_of_float(model->positions + 3 * v),
                                 .nearest2 = HUGE_VAL,
                                 .best2 = HUGE_VAL,
                                 .limit2 = HUGE_VAL,
                                 .cell = DPT_NONE };
        find_holder(&search, tree->levels - 1, 0);
        if (search.cell == DPT_NONE) {
            if (last != DPT_NONE)
                try_cell(&search, last); /* of the vertex before, which is mostly near */
            find_nearest(&search, tree->levels - 1, 0);
        }
        last = search.cell;
        embedding->distance2[v] = search.nearest2;
        if (search.cell == DPT_NONE) {
            embedding->distance2[v] = -max_of(search.nearest2, DBL_MIN);
            return;
        }
        memcpy(model->embedding_nodes + 4 * v, tree->cells + 4 * (size_t)search.cell,
               4 * sizeof *model->embedding_nodes);
        round_weights(search.weight, model->embedding_weights + 4 * v);
    }
}

/*
 * A vertex counts as outside if it is farther from all cells than rounding to a float may have moved it: sqrt(3) times
 * the largest rounding of a coordinate.
 */
static dpt_result count_outside(struct model *model, soup *source, const double *distance2)
{
    const double moved = 1.75 * source->rounding;
    for (uint32_t v = 0; v < model->vertex_count; v++) {
        if (distance2[v] < 0.0)
            return compile_fail(source->context, DPT_E_FINITE, nowhere,
                                "vertex %u is %.3g m from all cells: too far for weights of at most "
                                "%.0f (the same unit, the same frame?)",
                                model->vertex_sources[v], sqrt(-distance2[v]), WEIGHT_MAX);
        const double distance = sqrt(distance2[v]);
        model->outside_vertices += distance > moved;
        model->outside_distance = max_of(model->outside_distance, distance);
    }
    return DPT_OK;
}

static dpt_result embed(struct model *model, soup *source, const struct embed_cells *given, struct cell_tree *tree,
                        double *nodes, double *distance2)
{
    double extent = 0.0;
    for (size_t i = 0; i < 3 * (size_t)given->node_count; i++) {
        nodes[i] = given->scale * given->nodes[i];
        extent = max_of(extent, fabs(nodes[i]));
    }
    for (size_t i = 0; i < 3 * (size_t)model->vertex_count; i++)
        extent = max_of(extent, fabs((double)model->positions[i]));
    tree->rounding = 0x1p-46 * extent; /* more than pair_snap_to_zero takes away, too */
    DPT_TRY(build_tree(tree, source->context, given->cell_count));
    const struct embedding embedding = { tree, model, distance2 };
    parallel_for(source->context->threads, model->vertex_count, EMBED_MIN, embed_vertices, (void *)&embedding);
    return count_outside(model, source, distance2);
}

dpt_result embed_in(struct model *model, soup *source, const struct embed_cells *cells)
{
    double *nodes = compile_alloc(source->context, cells->node_count, 3 * sizeof *nodes);
    double *distance2 = compile_alloc(source->context, model->vertex_count, sizeof *distance2);
    struct cell_tree tree = { .nodes = nodes, .cells = cells->cells };
    model->embedding_nodes = compile_alloc(source->context, model->vertex_count, 4 * sizeof *model->embedding_nodes);
    model->embedding_weights =
        compile_alloc(source->context, model->vertex_count, 4 * sizeof *model->embedding_weights);
    dpt_result result = DPT_E_MEMORY;
    if (nodes && distance2 && model->embedding_nodes && model->embedding_weights)
        result = embed(model, source, cells, &tree, nodes, distance2);
    model->node_count = cells->node_count;
    free(nodes);
    free(distance2);
    free(tree.order);
    free(tree.boxes);
    return result;
}

dpt_result model_embed(struct model *model, soup *source)
{
    const dpt_compile_def *def = source->context->def;
    if (!def || !def->cell_count)
        return DPT_OK;
    DPT_TRY(check_cells(source->context));
    const struct embed_cells cells = { def->nodes, def->cells, def->node_count, def->cell_count,
                                       source->context->scale };
    return embed_in(model, source, &cells);
}
