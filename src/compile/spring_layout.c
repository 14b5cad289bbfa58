/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The layout of a net in the file (spring_net.h): from shares of stiffness to rows, and from rows to slices of 16 nodes.
 *
 * In a lattice, springs of one direction share an entry. Nodes are numbered along x. So where 16 nodes lie in one line
 * of the lattice, the neighbours in an entry have 16 consecutive numbers too, and a solver loads them at once.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/lanes.h"
#include "base/return_if_error.h"
#include "base/vec3.h"
#include "compile/spring_build.h"
#include "mesh/mesh_format.h"

static const source_location nowhere = { 0, 0 };

/* Directions in a lattice: each coordinate one less, the same or one more. */
enum { DIRECTIONS = 27 };

/* Rows of springs: those of node v are row[v] .. row[v + 1] - 1. */
struct rows {
    uint32_t *row;
    uint32_t *end;    /* of each spring in a row: the other node, ascending */
    uint32_t *spring; /* and its number in `stiffness` and `length` */
    float *stiffness; /* of each spring */
    float *length;
};

static int compare_shares(const void *a, const void *b)
{
    const struct spring_share *s = a, *t = b;
    if (s->low != t->low)
        return s->low < t->low ? -1 : 1;
    if (s->high != t->high)
        return s->high < t->high ? -1 : 1;
    return s->order < t->order ? -1 : s->order > t->order;
}

/* Add up the shares of each spring; one share is left of each. */
static void join_shares(struct net *net)
{
    size_t count = 0;
    qsort(net->shares, net->share_count, sizeof *net->shares, compare_shares);
    for (size_t i = 0; i < net->share_count; i++) {
        const struct spring_share *share = &net->shares[i];
        struct spring_share *last = count ? &net->shares[count - 1] : NULL;
        if (last && last->low == share->low && last->high == share->high)
            last->stiffness += share->stiffness;
        else
            net->shares[count++] = *share;
    }
    net->share_count = count;
}

static int is_spring_number(double x)
{
    return x >= (double)MESH_SPRING_MIN && x <= (double)MESH_SPRING_MAX;
}

static dpt_result number_fails(const struct net *net, const char *what, uint32_t node, double x)
{
    const float *at = net->rest + 3 * (size_t)node;
    return compile_fail(net->source->context, DPT_E_FINITE, nowhere,
                        "the %s at (%.6g, %.6g, %.6g) is %.3g, not within 1e-15..1e15", what, (double)at[0],
                        (double)at[1], (double)at[2], x);
}

/*
 * Springs come sorted by their lower node, then by the other. So each row gets its lower neighbours first, then the
 * higher ones, both ascending.
 */
static dpt_result fill_rows(const struct net *net, const struct rows *rows)
{
    memset(rows->row, 0, ((size_t)net->node_count + 2) * sizeof *rows->row);
    uint32_t *next = rows->row + 1; /* where the next spring of a node goes */
    for (size_t i = 0; i < net->share_count; i++) {
        rows->row[net->shares[i].low + 2]++;
        rows->row[net->shares[i].high + 2]++;
    }
    for (size_t v = 2; v < (size_t)net->node_count + 2; v++)
        rows->row[v] += rows->row[v - 1];
    for (uint32_t i = 0; i < net->share_count; i++) {
        const uint32_t node[2] = { net->shares[i].low, net->shares[i].high };
        const vec3 along =
            sub(vec3_of_float(net->rest + 3 * (size_t)node[1]), vec3_of_float(net->rest + 3 * (size_t)node[0]));
        const double length = sqrt(dot(along, along)), stiffness = net->shares[i].stiffness;
        if (!is_spring_number(length))
            return number_fails(net, "length of a spring", node[0], length);
        if (!is_spring_number(stiffness))
            return number_fails(net, "stiffness of a spring", node[0], stiffness);
        rows->length[i] = (float)length;
        rows->stiffness[i] = (float)stiffness;
        for (int k = 0; k < 2; k++) {
            rows->end[next[node[k]]] = node[1 - k];
            rows->spring[next[node[k]]++] = i;
        }
    }
    return DPT_OK;
}

/* The direction from a node to its neighbour in a lattice: it grows with the neighbour's number. */
static uint32_t direction_of(const struct net *net, uint32_t node, uint32_t end)
{
    const int32_t *from = net->grid + 3 * (size_t)node, *to = net->grid + 3 * (size_t)end;
    return (uint32_t)((to[2] - from[2] + 1) * 9 + (to[1] - from[1] + 1) * 3 + to[0] - from[0] + 1);
}

/* Which entry of its slice a spring takes. `ranks`: that of each direction. */
static uint32_t entry_of(const struct net *net, const struct rows *rows, const uint32_t *ranks, uint32_t node,
                         uint32_t i)
{
    return net->grid ? ranks[direction_of(net, node, rows->end[i])] : i - rows->row[node];
}

/* The entries that a slice needs; in a lattice, the rank of each direction that one of its nodes has. */
static uint32_t slice_entries(const struct net *net, const struct rows *rows, uint32_t slice,
                              uint32_t ranks[DIRECTIONS])
{
    const uint32_t first = slice * LANES;
    uint32_t has[DIRECTIONS] = { 0 }, entries = 0;
    for (uint32_t v = first; v < net->node_count && v < first + LANES; v++) {
        const uint32_t springs = rows->row[v + 1] - rows->row[v];
        if (!net->grid && springs > entries)
            entries = springs;
        for (uint32_t i = rows->row[v]; net->grid && i < rows->row[v + 1]; i++)
            has[direction_of(net, v, rows->end[i])] = 1;
    }
    for (uint32_t k = 0; k < DIRECTIONS; k++) {
        ranks[k] = entries;
        entries += has[k];
    }
    return entries;
}

/* Count the entries of all slices. */
static dpt_result fill_first(const struct net *net, const struct rows *rows, struct model *model)
{
    uint32_t ranks[DIRECTIONS];
    uint64_t sum = 0;
    const uint32_t slices = mesh_slices(net->node_count);
    for (uint32_t v = 0; v < net->node_count; v++)
        if (rows->row[v + 1] - rows->row[v] > MESH_SLICE_ENTRIES_MAX)
            return compile_fail(net->source->context, DPT_E_LIMIT, nowhere, "vertex %u has more than %u springs",
                                model->vertex_sources[v], MESH_SLICE_ENTRIES_MAX);
    for (uint32_t s = 0; s <= slices; s++) {
        if (sum > MESH_SPRING_ENTRIES_MAX)
            return compile_fail(net->source->context, DPT_E_LIMIT, nowhere, "more than %u entries of springs",
                                MESH_SPRING_ENTRIES_MAX);
        model->spring_first[s] = (uint32_t)sum;
        sum += s < slices ? slice_entries(net, rows, s, ranks) : 0;
    }
    model->spring_entries = model->spring_first[slices];
    return DPT_OK;
}

static void fill_entries(const struct net *net, const struct rows *rows, struct model *model)
{
    for (uint32_t s = 0; s < mesh_slices(net->node_count); s++) {
        uint32_t ranks[DIRECTIONS];
        const size_t first = (size_t)model->spring_first[s] * LANES;
        slice_entries(net, rows, s, ranks);
        for (size_t e = first; e < (size_t)model->spring_first[s + 1] * LANES; e++) {
            model->spring_ends[e] = s * LANES + (uint32_t)(e % LANES);
            model->spring_stiffness[e] = 0.0f;
            model->spring_length[e] = 1.0f;
        }
        for (uint32_t v = s * LANES; v < net->node_count && v < (s + 1) * LANES; v++)
            for (uint32_t i = rows->row[v]; i < rows->row[v + 1]; i++) {
                const size_t e = first + entry_of(net, rows, ranks, v, i) * LANES + v % LANES;
                model->spring_ends[e] = rows->end[i];
                model->spring_stiffness[e] = rows->stiffness[rows->spring[i]];
                model->spring_length[e] = rows->length[rows->spring[i]];
            }
    }
}

/* Masses, drags, and the stable step: from the numbers as the file has them. */
static dpt_result fill_nodes(struct net *net, const struct rows *rows, struct model *model, const uint8_t *is_fixed)
{
    double omega2 = 0.0;
    for (uint32_t v = 0; v < net->node_count; v++) {
        double x[3], sum = 0.0;
        vec3_store(vec3_of_float(net->rest + 3 * (size_t)v), x);
        if (!is_spring_number(net->mass[v]))
            return number_fails(net, "mass of the node", v, net->mass[v]);
        model->mass += net->mass[v];
        model->spring_drag[v] = (float)spring_material(net, x).drag;
        model->spring_mass[v] = is_fixed[v] ? 0.0f : (float)net->mass[v];
        model->fixed_nodes += is_fixed[v];
        for (uint32_t i = rows->row[v]; i < rows->row[v + 1]; i++)
            sum += (double)rows->stiffness[rows->spring[i]];
        if (net->cell_bound)
            sum += net->cell_bound[v];
        if (!is_fixed[v])
            omega2 = max_of(omega2, 2.0 * sum / (double)model->spring_mass[v]);
    }
    if (net->square > 0.0)
        omega2 = min_of(omega2, net->square * (1.0 + MESH_STEP_ROUNDING));
    model->stable_step = 2.0 / sqrt(omega2);
    return DPT_OK;
}

static dpt_result lay_out(struct net *net, const struct rows *rows, struct model *model, const uint8_t *is_fixed)
{
    soup *source = net->source;
    DPT_TRY(fill_rows(net, rows));
    model->spring_nodes = net->node_count;
    model->spring_count = (uint32_t)net->share_count;
    model->spring_mass = compile_alloc(source->context, net->node_count, sizeof *model->spring_mass);
    model->spring_drag = compile_alloc(source->context, net->node_count, sizeof *model->spring_drag);
    model->spring_first =
        compile_alloc(source->context, (size_t)mesh_slices(net->node_count) + 1, sizeof *model->spring_first);
    if (!model->spring_mass || !model->spring_drag || !model->spring_first)
        return DPT_E_MEMORY;
    DPT_TRY(fill_nodes(net, rows, model, is_fixed));
    DPT_TRY(fill_first(net, rows, model));
    const size_t words = (size_t)model->spring_entries * LANES;
    model->spring_ends = compile_alloc(source->context, words, sizeof *model->spring_ends);
    model->spring_stiffness = compile_alloc(source->context, words, sizeof *model->spring_stiffness);
    model->spring_length = compile_alloc(source->context, words, sizeof *model->spring_length);
    if (!model->spring_ends || !model->spring_stiffness || !model->spring_length)
        return DPT_E_MEMORY;
    fill_entries(net, rows, model);
    model->cell_size = net->cell_size;
    model->cell_count = net->cell_count;
    model->cell_nodes = net->cell_nodes;
    model->cell_stiffness = net->cell_stiffness;
    net->cell_nodes = NULL;
    net->cell_stiffness = NULL;
    return DPT_OK;
}

dpt_result spring_lay_out(struct net *net, struct model *model, const uint8_t *is_fixed)
{
    soup *source = net->source;
    join_shares(net);
    if (net->share_count > UINT32_MAX / 2)
        return compile_fail(source->context, DPT_E_LIMIT, nowhere, "more springs than can be numbered");
    const size_t springs = net->share_count;
    const struct rows rows = {
        .row = compile_alloc(source->context, (size_t)net->node_count + 2, sizeof *rows.row),
        .end = compile_alloc(source->context, 2 * springs, sizeof *rows.end),
        .spring = compile_alloc(source->context, 2 * springs, sizeof *rows.spring),
        .stiffness = compile_alloc(source->context, springs, sizeof *rows.stiffness),
        .length = compile_alloc(source->context, springs, sizeof *rows.length),
    };
    dpt_result result = DPT_E_MEMORY;
    if (rows.row && rows.end && rows.spring && rows.stiffness && rows.length)
        result = lay_out(net, &rows, model, is_fixed);
    free(rows.row);
    free(rows.end);
    free(rows.spring);
    free(rows.stiffness);
    free(rows.length);
    return result;
}
