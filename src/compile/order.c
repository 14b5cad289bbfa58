/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The order of the triangles defines the box tree: leaf k holds triangles 16 k to 16 k + 15, node j of the next level
 * holds leaves 16 j to 16 j + 15, and so on. Every node but the last of a level is full. So triangles may be split into
 * two subtrees only at a multiple of the capacity of the next lower level.
 */
#include <stdlib.h>
#include <string.h>

#include "base/lanes.h"
#include "base/return_if_error.h"
#include "compile/compile_context.h"
#include "compile/model.h"

struct item {
    float corner_sum[3]; /* three times the centroid */
    uint32_t triangle;   /* its index before the ordering */
};

/*
 * A range of at least this many items may be shared between threads. Both of its halves then restart the random pivots
 * from SEED, so that the result does not depend on the threads.
 */
#define FORK_MIN ((size_t)2 * PARALLEL_MIN)
#define SEED     1u

/* The state of one thread. */
struct ordering {
    struct item *items;
    const struct compile_context *context; /* for the progress callback; NULL in threads other than the caller's */
    size_t total;                          /* items of this thread: done / total is the progress */
    size_t done;
    uint64_t random;  /* state of the pivots' generator */
    uint32_t threads; /* that may order the current range */
};

static int comes_before(const struct item *a, const struct item *b, int axis)
{
    float x = a->corner_sum[axis], y = b->corner_sum[axis];
    return x < y || (x == y && a->triangle < b->triangle);
}

static void swap(struct item *a, struct item *b)
{
    struct item t = *a;
    *a = *b;
    *b = t;
}

/* Move the `rank` smallest items along `axis` to the front of first..end. Quickselect with pivots from a fixed seed. */
static void select_rank(struct ordering *order, size_t first, size_t end, size_t rank, int axis)
{
    struct item *items = order->items;
    size_t target = first + rank;
    while (end - first > 1) {
        order->random = order->random * 6364136223846793005u + 1442695040888963407u;
        struct item pivot = items[first + (size_t)(order->random >> 33) % (end - first)];
        size_t low = first, high = end - 1;
        while (low <= high) {
            while (comes_before(&items[low], &pivot, axis))
                low++;
            while (comes_before(&pivot, &items[high], axis))
                high--;
            if (low <= high) {
                swap(&items[low++], &items[high]);
                if (high-- == 0)
                    break;
            }
        }
        if (target <= high && high < end)
            end = high + 1;
        else if (target >= low)
            first = low;
        else
            return;
    }
}

static int widest_axis(const struct item *items, size_t count)
{
    float low[3], high[3];
    memcpy(low, items[0].corner_sum, sizeof low);
    memcpy(high, items[0].corner_sum, sizeof high);
    for (size_t i = 1; i < count; i++)
        for (int k = 0; k < 3; k++) {
            float c = items[i].corner_sum[k];
            low[k] = c < low[k] ? c : low[k];
            high[k] = c > high[k] ? c : high[k];
        }
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (high[k] - low[k] > high[axis] - low[axis])
            axis = k;
    return axis;
}

/* Count the items of a leaf as done. Report progress about once in 65,536 items. */
static dpt_result finish_leaf(struct ordering *order, size_t count)
{
    size_t reported = order->done >> 16;
    order->done += count;
    if (!order->context || order->done >> 16 == reported)
        return DPT_OK;
    return compile_report_progress(order->context, "order", (double)order->done / (double)order->total);
}

static dpt_result split(struct ordering *order, size_t first, size_t count, size_t capacity);

/* One half of a range, as an item of a parallel loop. */
struct split_job {
    struct ordering order;
    size_t first, count, capacity;
    dpt_result result;
};

static void split_half(void *context, size_t first, size_t end)
{
    struct split_job *jobs = context;
    for (size_t i = first; i < end; i++) {
        struct ordering order = jobs[i].order;
        jobs[i].result = split(&order, jobs[i].first, jobs[i].count, jobs[i].capacity);
    }
}

/*
 * Split both halves of first..first + left + right further. They get threads in proportion to their items, and run in
 * parallel if the right half gets at least one.
 */
static dpt_result split_large(struct ordering *order, size_t first, size_t left, size_t right, size_t capacity)
{
    const uint32_t threads = order->threads;
    uint64_t share = ((uint64_t)threads * right + (left + right) / 2) / (left + right);
    uint32_t right_threads = share < threads ? (uint32_t)share : threads - 1;
    order->random = SEED;
    if (right_threads == 0) {
        DPT_TRY(split(order, first, left, capacity));
        order->random = SEED;
        return split(order, first + left, right, capacity);
    }
    struct split_job jobs[2] = { { *order, first, left, capacity, DPT_OK },
                                 { *order, first + left, right, capacity, DPT_OK } };
    jobs[0].order.threads = threads - right_threads;
    jobs[0].order.total -= right;
    jobs[1].order.threads = right_threads;
    jobs[1].order.context = NULL;
    parallel_for(2, 2, 1, split_half, jobs);
    order->done += left + right;
    return jobs[0].result;
}

/* Order first..first + count. `capacity` is that of a node of the level below, or of a higher one. */
static dpt_result split(struct ordering *order, size_t first, size_t count, size_t capacity)
{
    if (count <= LANES)
        return finish_leaf(order, count);
    while (count <= capacity)
        capacity /= LANES;
    size_t subtrees = (count + capacity - 1) / capacity;
    size_t left = subtrees / 2 * capacity;
    select_rank(order, first, first + count, left, widest_axis(order->items + first, count));
    if (count >= FORK_MIN)
        return split_large(order, first, left, count - left, capacity);
    DPT_TRY(split(order, first, left, capacity));
    return split(order, first + left, count - left, capacity);
}

static void fill_items(const struct model *model, const float *positions, struct item *items)
{
    for (uint32_t t = 0; t < model->triangle_count; t++) {
        const uint32_t *corner = model->corners + 3 * (size_t)t;
        const float *a = positions + 3 * (size_t)corner[0];
        const float *b = positions + 3 * (size_t)corner[1];
        const float *c = positions + 3 * (size_t)corner[2];
        for (int k = 0; k < 3; k++)
            items[t].corner_sum[k] = a[k] + b[k] + c[k];
        items[t].triangle = t;
    }
}

/* The new arrays, and what they are filled from. */
struct permutation {
    const struct model *model;
    const struct item *items;
    uint32_t *corners, *sources;
};

static void permute_triangles(void *context, size_t first, size_t end)
{
    const struct permutation *to = context;
    for (size_t t = first; t < end; t++) {
        size_t from = to->items[t].triangle;
        memcpy(to->corners + 3 * t, to->model->corners + 3 * from, 3 * sizeof *to->corners);
        to->sources[t] = to->model->sources[from];
        to->model->places[to->sources[t]] = (uint32_t)t;
    }
}

static dpt_result permute(struct model *model, soup *source, const struct item *items)
{
    struct permutation to = { .model = model, .items = items };
    to.corners = compile_alloc(source->context, model->triangle_count, 3 * sizeof *to.corners);
    to.sources = compile_alloc(source->context, model->triangle_count, sizeof *to.sources);
    if (!to.corners || !to.sources) {
        free(to.corners);
        free(to.sources);
        return DPT_E_MEMORY;
    }
    parallel_for(source->context->threads, model->triangle_count, PARALLEL_MIN, permute_triangles, &to);
    free(model->corners);
    free(model->sources);
    model->corners = to.corners;
    model->sources = to.sources;
    return DPT_OK;
}

/*
 * Number the vertices in the order of their first use, for locality, and copy their positions. `vertex_number` is
 * scratch of one word for each vertex of the source.
 */
static dpt_result number_vertices(struct model *model, soup *source, uint32_t *vertex_number)
{
    memset(vertex_number, 0xff, source->vertex_count * sizeof *vertex_number);
    uint32_t count = 0;
    for (size_t c = 0; c < 3 * (size_t)model->triangle_count; c++) {
        uint32_t v = model->corners[c];
        if (vertex_number[v] == DPT_NONE)
            vertex_number[v] = count++;
        model->corners[c] = vertex_number[v];
    }
    model->vertex_count = count;
    model->positions = compile_alloc(source->context, count, 3 * sizeof *model->positions);
    model->vertex_sources = compile_alloc(source->context, count, sizeof *model->vertex_sources);
    if (!model->positions || !model->vertex_sources)
        return DPT_E_MEMORY;
    for (size_t v = 0; v < source->vertex_count; v++)
        if (vertex_number[v] != DPT_NONE) {
            memcpy(model->positions + 3 * (size_t)vertex_number[v], source->positions + 3 * v,
                   3 * sizeof *model->positions);
            model->vertex_sources[vertex_number[v]] = (uint32_t)v;
        }
    return DPT_OK;
}

dpt_result model_order(struct model *model, soup *source)
{
    size_t count = model->triangle_count;
    struct item *items = compile_alloc(source->context, count, sizeof *items);
    uint32_t *vertex_number = compile_alloc(source->context, source->vertex_count, sizeof *vertex_number);
    dpt_result result = DPT_E_MEMORY;
    if (items && vertex_number) {
        size_t capacity = LANES;
        while (capacity < count)
            capacity *= LANES;
        struct ordering order = { .items = items,
                                  .context = source->context,
                                  .total = count,
                                  .random = SEED,
                                  .threads = source->context->threads };
        fill_items(model, source->positions, items);
        result = split(&order, 0, count, capacity);
        if (result == DPT_OK)
            result = permute(model, source, items);
        if (result == DPT_OK)
            result = number_vertices(model, source, vertex_number);
    }
    free(items);
    free(vertex_number);
    return result;
}
