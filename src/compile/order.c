/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The order of the triangles is the tree: leaf k holds triangles 16 k to 16 k + 15, its parent the
 * leaves 16 j to 16 j + 15, and so on. So a cut between two subtrees may fall only at a multiple of the
 * smaller one's capacity, and every node but the last of a level is full.
 */
#include <stdlib.h>
#include <string.h>

#include "../check.h"
#include "../kernel.h"
#include "model.h"

struct item {
    float centre[3]; /* sum of the corners: three times the centroid */
    uint32_t triangle;
};

struct ordering {
    struct item *items;
    soup *source;
    size_t total;
    size_t done;
    uint64_t random;
};

static int before(const struct item *a, const struct item *b, int axis)
{
    float x = a->centre[axis], y = b->centre[axis];
    return x < y || (x == y && a->triangle < b->triangle);
}

static void swap(struct item *a, struct item *b)
{
    struct item t = *a;
    *a = *b;
    *b = t;
}

/* Put the `rank` least items of first..end in front: quickselect with pivots drawn from a fixed seed. */
static void select_rank(struct ordering *order, size_t first, size_t end, size_t rank, int axis)
{
    struct item *items = order->items;
    size_t target = first + rank;
    while (end - first > 1) {
        order->random = order->random * 6364136223846793005u + 1442695040888963407u;
        struct item pivot = items[first + (size_t)(order->random >> 33) % (end - first)];
        size_t low = first, high = end - 1;
        while (low <= high) {
            while (before(&items[low], &pivot, axis))
                low++;
            while (before(&pivot, &items[high], axis))
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
    memcpy(low, items[0].centre, sizeof low);
    memcpy(high, items[0].centre, sizeof high);
    for (size_t i = 1; i < count; i++)
        for (int k = 0; k < 3; k++) {
            float c = items[i].centre[k];
            low[k] = c < low[k] ? c : low[k];
            high[k] = c > high[k] ? c : high[k];
        }
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (high[k] - low[k] > high[axis] - low[axis])
            axis = k;
    return axis;
}

static dpt_result leaf_done(struct ordering *order, size_t count)
{
    size_t before_this = order->done >> 16;
    order->done += count;
    if (order->done >> 16 == before_this)
        return DPT_OK;
    return soup_progress(order->source, "order", (double)order->done / (double)order->total);
}

/* Order first..first + count, whose subtrees hold `capacity` triangles each. */
static dpt_result split(struct ordering *order, size_t first, size_t count, size_t capacity)
{
    if (count <= LANES)
        return leaf_done(order, count);
    while (count <= capacity)
        capacity /= LANES;
    size_t subtrees = (count + capacity - 1) / capacity;
    size_t left = subtrees / 2 * capacity;
    select_rank(order, first, first + count, left, widest_axis(order->items + first, count));
    DPT_TRY(split(order, first, left, capacity));
    return split(order, first + left, count - left, capacity);
}

static void take_items(const struct model *model, const float *positions, struct item *items)
{
    for (uint32_t t = 0; t < model->triangle_count; t++) {
        const uint32_t *corner = model->corners + 3 * (size_t)t;
        const float *a = positions + 3 * (size_t)corner[0];
        const float *b = positions + 3 * (size_t)corner[1];
        const float *c = positions + 3 * (size_t)corner[2];
        for (int k = 0; k < 3; k++)
            items[t].centre[k] = a[k] + b[k] + c[k];
        items[t].triangle = t;
    }
}

/* Move corners and sources to the new order. `spare` has room for 3 words a triangle. */
static void permute_triangles(struct model *model, const struct item *items, uint32_t *spare)
{
    size_t count = model->triangle_count;
    for (size_t t = 0; t < count; t++)
        memcpy(spare + 3 * t, model->corners + 3 * (size_t)items[t].triangle, 3 * sizeof *spare);
    memcpy(model->corners, spare, 3 * count * sizeof *spare);
    for (size_t t = 0; t < count; t++)
        spare[t] = model->sources[items[t].triangle];
    memcpy(model->sources, spare, count * sizeof *spare);
    for (size_t t = 0; t < count; t++)
        model->places[model->sources[t]] = (uint32_t)t;
}

/* Vertices in the order of their first use, for locality. `number` has a word a source vertex. */
static dpt_result take_vertices(struct model *model, soup *source, uint32_t *number)
{
    memset(number, 0xff, source->vertex_count * sizeof *number);
    uint32_t count = 0;
    for (size_t c = 0; c < 3 * (size_t)model->triangle_count; c++) {
        uint32_t v = model->corners[c];
        if (number[v] == DPT_NONE)
            number[v] = count++;
        model->corners[c] = number[v];
    }
    model->vertex_count = count;
    model->positions = model_array(source, count, 3 * sizeof *model->positions);
    if (!model->positions)
        return DPT_E_MEMORY;
    for (size_t v = 0; v < source->vertex_count; v++)
        if (number[v] != DPT_NONE)
            memcpy(model->positions + 3 * (size_t)number[v], source->positions + 3 * v,
                   3 * sizeof *model->positions);
    return DPT_OK;
}

dpt_result model_order(struct model *model, soup *source)
{
    size_t count = model->triangle_count;
    struct item *items = model_array(source, count, sizeof *items);
    uint32_t *spare = model_array(source, count, 3 * sizeof *spare);
    uint32_t *number = model_array(source, source->vertex_count, sizeof *number);
    dpt_result result = DPT_E_MEMORY;
    if (items && spare && number) {
        size_t capacity = LANES;
        while (capacity < count)
            capacity *= LANES;
        struct ordering order = { .items = items, .source = source, .total = count, .random = 1 };
        take_items(model, source->positions, items);
        result = split(&order, 0, count, capacity);
        if (result == DPT_OK) {
            permute_triangles(model, items, spare);
            result = take_vertices(model, source, number);
        }
    }
    free(items);
    free(spare);
    free(number);
    return result;
}
