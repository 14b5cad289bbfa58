/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A cubic lattice in the closed parts (docs/algorithms/springs.md): its cells, the share of each that is inside,
 * springs and masses, and the embedding of the vertices.
 *
 * Rays along x measure the inside: RAYS by RAYS of them through each cell, each one exactly along its length. Whether a
 * ray meets a triangle is decided by the triangle's edges in the plane of y and z, each in the same way for both of its
 * triangles. So a ray that enters a closed part leaves it.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "base/vec3.h"
#include "compile/embed.h"
#include "compile/spring_build.h"
#include "mesh/mesh_format.h"

/* Cells in the box of the closed parts: by default, and at most. */
#define CELLS_USUAL 20000.0
#define CELLS_MAX   (1u << 22)

/* Rays through a cell along y, and along z. */
#define RAYS 4u

/* A cell at the surface counts by at least this share of it: nothing hangs loose, and nothing is too soft to solve. */
#define SHARE_MIN 0.0625

/* A cell is touched by what comes inside of it by this, times its size: not by what lies along its faces. */
#define TOUCH 1e-5

static const source_location nowhere = { 0, 0 };

/* Where a ray meets a triangle: the winding number grows by `turn` there. */
struct crossing {
    double x;
    int turn;
};

struct crossings {
    struct crossing *list;
    uint32_t *first;  /* of each ray and one more: its first in `list` */
    uint32_t rays[2]; /* along y and z */
};

static int is_closed(const struct model *model, uint32_t t)
{
    return (model->parts[model->part_of[t]].flags & MESH_PART_CLOSED) != 0;
}

static void corners_of(const struct model *model, uint32_t t, vec3 corner[3])
{
    for (int k = 0; k < 3; k++)
        corner[k] = vec3_of_float(model->positions + 3 * (size_t)model->corners[3 * (size_t)t + (size_t)k]);
}

static double coordinate(vec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/* Which places first, first + 1, ... of a grid with this step lie in an interval: *begin..*end, within 0..count. */
static void span(double low, double high, double first, double step, uint32_t count, uint32_t *begin, uint32_t *end)
{
    const double b = floor((low - first) / step) - 1.0, e = ceil((high - first) / step) + 2.0;
    *begin = b < 0.0 ? 0 : b > count ? count : (uint32_t)b;
    *end = e < 0.0 ? 0 : e > count ? count : (uint32_t)e;
}

/* By Newton's method, as no library's cube root is the same on every machine. Of a number that is not negative. */
static double cube_root(double x)
{
    double root = max_of(x, 1.0);
    for (int i = 0; i < 200; i++)
        root -= (root - x / (root * root)) / 3.0;
    return root;
}

/* Choose the lattice about the box of the closed parts. */
static dpt_result choose_cells(struct spring_lattice *lattice, const struct model *model, soup *source, double spacing)
{
    double low[3] = { HUGE_VAL, HUGE_VAL, HUGE_VAL }, high[3] = { -HUGE_VAL, -HUGE_VAL, -HUGE_VAL };
    double longest = 0.0, volume = 1.0, cells = 1.0;
    for (uint32_t t = 0; t < model->triangle_count; t++) {
        vec3 corner[3];
        corners_of(model, t, corner);
        for (int i = 0; i < 9 && is_closed(model, t); i++) {
            low[i % 3] = min_of(low[i % 3], coordinate(corner[i / 3], i % 3));
            high[i % 3] = max_of(high[i % 3], coordinate(corner[i / 3], i % 3));
        }
    }
    if (!(high[0] >= low[0]))
        return compile_fail(source->context, DPT_E_ARGUMENT, nowhere,
                            "no part of the mesh is closed: springs of a volume need an inside");
    for (int k = 0; k < 3; k++)
        longest = max_of(longest, high[k] - low[k]);
    for (int k = 0; k < 3; k++)
        volume *= max_of(high[k] - low[k], 1e-3 * longest);
    if (!(spacing > 0.0))
        spacing = cube_root(volume / CELLS_USUAL);
    for (int k = 0; k < 3; k++) {
        const double count = max_of(ceil((high[k] - low[k]) / spacing - TOUCH), 1.0);
        cells *= count;
        if (!(cells <= CELLS_MAX))
            return compile_fail(source->context, DPT_E_LIMIT, nowhere,
                                "a lattice with a spacing of %.3g m has more than %u cells", spacing, CELLS_MAX);
        lattice->cells[k] = (uint32_t)count;
        lattice->low[k] = 0.5 * (low[k] + high[k]) - 0.5 * count * spacing;
    }
    lattice->spacing = spacing;
    return DPT_OK;
}

static size_t cell_at(const struct spring_lattice *lattice, uint32_t i, uint32_t j, uint32_t k)
{
    return ((size_t)k * lattice->cells[1] + j) * lattice->cells[0] + i;
}

static size_t corner_at(const struct spring_lattice *lattice, uint32_t i, uint32_t j, uint32_t k)
{
    return ((size_t)k * (lattice->cells[1] + 1) + j) * (lattice->cells[0] + 1) + i;
}

/*
 * How often the edge from a to b runs past the point (y, z) on the side of larger z: 1 if y grows along it, -1 if it
 * falls, else 0. The edge's place is computed from its lower end, whichever way it runs.
 */
static int edge_turn(vec3 a, vec3 b, double y, double z)
{
    const int falls = b.y < a.y || (b.y == a.y && b.z < a.z);
    const vec3 lower = falls ? b : a, upper = falls ? a : b;
    if (!(lower.y <= y && y < upper.y))
        return 0;
    const double at = lower.z + (upper.z - lower.z) * ((y - lower.y) / (upper.y - lower.y));
    return at > z ? (falls ? -1 : 1) : 0;
}

/* Where the plane of a triangle is at y, z; within the triangle's own extent along x. */
static double plane_x(const vec3 corner[3], double y, double z)
{
    const vec3 n = cross(sub(corner[1], corner[0]), sub(corner[2], corner[0]));
    const double low = min_of(min_of(corner[0].x, corner[1].x), corner[2].x);
    const double high = max_of(max_of(corner[0].x, corner[1].x), corner[2].x);
    const double x = corner[0].x - (n.y * (y - corner[0].y) + n.z * (z - corner[0].z)) / n.x;
    return x >= low && x <= high ? x : x > high ? high : low;
}

/* Count the crossings of each ray in first[ray + 1], or write them at first[ray]++ if there is a list. */
static void cross_rays(struct crossings *crossings, const struct spring_lattice *lattice, const struct model *model)
{
    const double step = lattice->spacing / RAYS;
    const double y0 = lattice->low[1] + 0.5 * step, z0 = lattice->low[2] + 0.5 * step;
    for (uint32_t t = 0; t < model->triangle_count; t++) {
        uint32_t j, j_end, k, k_begin, k_end;
        vec3 c[3];
        if (!is_closed(model, t))
            continue;
        corners_of(model, t, c);
        span(min_of(min_of(c[0].y, c[1].y), c[2].y), max_of(max_of(c[0].y, c[1].y), c[2].y), y0, step,
             crossings->rays[0], &j, &j_end);
        span(min_of(min_of(c[0].z, c[1].z), c[2].z), max_of(max_of(c[0].z, c[1].z), c[2].z), z0, step,
             crossings->rays[1], &k_begin, &k_end);
        for (; j < j_end; j++)
            for (k = k_begin; k < k_end; k++) {
                const double y = y0 + step * j, z = z0 + step * k;
                const int turn =
                    edge_turn(c[0], c[1], y, z) + edge_turn(c[1], c[2], y, z) + edge_turn(c[2], c[0], y, z);
                const uint32_t ray = k * crossings->rays[0] + j;
                if (!turn)
                    continue;
                if (crossings->list)
                    crossings->list[crossings->first[ray]++] = (struct crossing){ plane_x(c, y, z), turn };
                else
                    crossings->first[ray + 1]++;
            }
    }
}

static int compare_crossings(const void *a, const void *b)
{
    const struct crossing *c = a, *d = b;
    return c->x < d->x ? -1 : c->x > d->x ? 1 : c->turn < d->turn ? -1 : c->turn > d->turn;
}

/* Add a ray's stretch inside, from..to along x, to the cells that it runs through. */
static void add_stretch(struct spring_lattice *lattice, double from, double to, uint32_t j, uint32_t k)
{
    const double each = 1.0 / (RAYS * RAYS);
    uint32_t i, end;
    span(from, to, lattice->low[0], lattice->spacing, lattice->cells[0], &i, &end);
    for (; i < end; i++) {
        const double low = lattice->low[0] + lattice->spacing * i;
        const double inside = min_of(to, low + lattice->spacing) - max_of(from, low);
        if (inside > 0.0)
            lattice->share[cell_at(lattice, i, j, k)] += (float)(each * inside / lattice->spacing);
    }
}

/* The share of each cell that is inside: where the winding number along the rays is above 0. */
static dpt_result measure(struct spring_lattice *lattice, const struct model *model, soup *source)
{
    struct crossings crossings = { .rays = { lattice->cells[1] * RAYS, lattice->cells[2] * RAYS } };
    const uint32_t rays = crossings.rays[0] * crossings.rays[1];
    crossings.first = compile_alloc(source->context, (size_t)rays + 1, sizeof *crossings.first);
    if (!crossings.first)
        return DPT_E_MEMORY;
    memset(crossings.first, 0, ((size_t)rays + 1) * sizeof *crossings.first);
    cross_rays(&crossings, lattice, model);
    uint64_t count = 0;
    for (uint32_t ray = 0; ray < rays; ray++)
        crossings.first[ray + 1] = (uint32_t)(count += crossings.first[ray + 1]);
    if (count <= UINT32_MAX)
        crossings.list = compile_alloc(source->context, (size_t)count, sizeof *crossings.list);
    if (!crossings.list) {
        free(crossings.first);
        return compile_fail(source->context, DPT_E_MEMORY, nowhere, "memory ran out");
    }
    cross_rays(&crossings, lattice, model);
    uint32_t begin = 0;
    for (uint32_t ray = 0; ray < rays; ray++) {
        const uint32_t end = crossings.first[ray];
        const uint32_t j = ray % crossings.rays[0] / RAYS, k = ray / crossings.rays[0] / RAYS;
        int winding = 0;
        qsort(crossings.list + begin, end - begin, sizeof *crossings.list, compare_crossings);
        for (uint32_t c = begin; c < end; c++) {
            if (winding > 0)
                add_stretch(lattice, crossings.list[c - 1].x, crossings.list[c].x, j, k);
            winding += crossings.list[c].turn;
        }
        begin = end;
    }
    free(crossings.list);
    free(crossings.first);
    return DPT_OK;
}

/* Does an axis separate a triangle from a cube about the origin with this half width? */
static int separates(vec3 axis, const vec3 corner[3], double half)
{
    const double a = dot(axis, corner[0]), b = dot(axis, corner[1]), c = dot(axis, corner[2]);
    const double reach = half * (fabs(axis.x) + fabs(axis.y) + fabs(axis.z));
    return min_of(min_of(a, b), c) > reach || max_of(max_of(a, b), c) < -reach;
}

/* Does a triangle come into a cube? By the 13 axes of Akenine-Moller (2001). */
static int meets_cube(const vec3 corner[3], vec3 centre, double half)
{
    static const vec3 axes[3] = { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 0.0, 0.0, 1.0 } };
    const vec3 at[3] = { sub(corner[0], centre), sub(corner[1], centre), sub(corner[2], centre) };
    for (int i = 0; i < 3; i++)
        if (separates(axes[i], at, half))
            return 0;
    if (separates(cross(sub(at[1], at[0]), sub(at[2], at[0])), at, half))
        return 0;
    for (int e = 0; e < 3; e++)
        for (int i = 0; i < 3; i++)
            if (separates(cross(sub(at[(e + 1) % 3], at[e]), axes[i]), at, half))
                return 0;
    return 1;
}

/* Give the cells that the surface runs through at least SHARE_MIN; `is_touched` notes them. */
static void touch(struct spring_lattice *lattice, const struct model *model, uint8_t *is_touched)
{
    const double s = lattice->spacing, half = (0.5 - TOUCH) * s;
    for (uint32_t t = 0; t < model->triangle_count; t++) {
        uint32_t begin[3], end[3];
        vec3 c[3];
        if (!is_closed(model, t))
            continue;
        corners_of(model, t, c);
        for (int k = 0; k < 3; k++) {
            const double a = coordinate(c[0], k), b = coordinate(c[1], k), d = coordinate(c[2], k);
            span(min_of(min_of(a, b), d), max_of(max_of(a, b), d), lattice->low[k], s, lattice->cells[k], &begin[k],
                 &end[k]);
        }
        for (uint32_t k = begin[2]; k < end[2]; k++)
            for (uint32_t j = begin[1]; j < end[1]; j++)
                for (uint32_t i = begin[0]; i < end[0]; i++) {
                    const vec3 centre = { lattice->low[0] + s * (i + 0.5), lattice->low[1] + s * (j + 0.5),
                                          lattice->low[2] + s * (k + 0.5) };
                    uint8_t *touched = &is_touched[cell_at(lattice, i, j, k)];
                    *touched |= !*touched && meets_cube(c, centre, half);
                }
    }
    /* Where the surface is not, a cell is wholly inside or outside: what is between is rounding. */
    const size_t cells = (size_t)lattice->cells[0] * lattice->cells[1] * lattice->cells[2];
    for (size_t i = 0; i < cells; i++) {
        const float share = lattice->share[i];
        if (is_touched[i])
            lattice->share[i] = share < (float)SHARE_MIN ? (float)SHARE_MIN : share > 1.0f ? 1.0f : share;
        else
            lattice->share[i] = share > 0.5f ? 1.0f : 0.0f;
    }
}

/* Number the corners of cells along x, then y, then z, and place them. */
static dpt_result number_nodes(struct spring_lattice *lattice, soup *source)
{
    const uint32_t *n = lattice->cells;
    const size_t corners = ((size_t)n[0] + 1) * (n[1] + 1) * (n[2] + 1);
    lattice->node = compile_alloc(source->context, corners, sizeof *lattice->node);
    if (!lattice->node)
        return DPT_E_MEMORY;
    for (size_t i = 0; i < corners; i++)
        lattice->node[i] = DPT_NONE;
    for (uint32_t k = 0; k < n[2]; k++)
        for (uint32_t j = 0; j < n[1]; j++)
            for (uint32_t i = 0; i < n[0]; i++)
                if (lattice->share[cell_at(lattice, i, j, k)] > 0.0f) {
                    lattice->cell_count++;
                    for (uint32_t c = 0; c < 8; c++)
                        lattice->node[corner_at(lattice, i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))] = 0;
                }
    for (size_t i = 0; i < corners; i++)
        if (lattice->node[i] != DPT_NONE)
            lattice->node[i] = lattice->node_count++;
    lattice->rest = compile_alloc(source->context, lattice->node_count, 3 * sizeof *lattice->rest);
    lattice->grid = compile_alloc(source->context, lattice->node_count, 3 * sizeof *lattice->grid);
    if (!lattice->rest || !lattice->grid)
        return DPT_E_MEMORY;
    for (uint32_t k = 0; k <= n[2]; k++)
        for (uint32_t j = 0; j <= n[1]; j++)
            for (uint32_t i = 0; i <= n[0]; i++) {
                const uint32_t node = lattice->node[corner_at(lattice, i, j, k)], at[3] = { i, j, k };
                for (size_t axis = 0; axis < 3 && node != DPT_NONE; axis++) {
                    lattice->grid[3 * (size_t)node + axis] = (int32_t)at[axis];
                    lattice->rest[3 * (size_t)node + axis] = (float)(lattice->low[axis] + lattice->spacing * at[axis]);
                }
            }
    return DPT_OK;
}

static dpt_result fill_cells(struct spring_lattice *lattice, const struct model *model, soup *source,
                             uint8_t *is_touched, size_t cells)
{
    memset(lattice->share, 0, cells * sizeof *lattice->share);
    memset(is_touched, 0, cells);
    DPT_TRY(measure(lattice, model, source));
    touch(lattice, model, is_touched);
    return number_nodes(lattice, source);
}

dpt_result spring_lattice_make(struct spring_lattice *lattice, const struct model *model, soup *source, double spacing)
{
    DPT_TRY(choose_cells(lattice, model, source, spacing));
    const size_t cells = (size_t)lattice->cells[0] * lattice->cells[1] * lattice->cells[2];
    lattice->share = compile_alloc(source->context, cells, sizeof *lattice->share);
    uint8_t *is_touched = compile_alloc(source->context, cells, 1);
    const dpt_result result =
        lattice->share && is_touched ? fill_cells(lattice, model, source, is_touched, cells) : DPT_E_MEMORY;
    free(is_touched);
    return result;
}

void spring_lattice_free(struct spring_lattice *lattice)
{
    free(lattice->share);
    free(lattice->node);
    free(lattice->rest);
    free(lattice->grid);
}

/* Call `work` for each cell of the body, with the numbers of its corners: bit k of a corner is axis k. */
typedef dpt_result cell_work(void *context, const uint32_t node[8], const double centre[3], double share);

static dpt_result each_cell(const struct spring_lattice *lattice, cell_work *work, void *context)
{
    const double s = lattice->spacing;
    for (uint32_t k = 0; k < lattice->cells[2]; k++)
        for (uint32_t j = 0; j < lattice->cells[1]; j++)
            for (uint32_t i = 0; i < lattice->cells[0]; i++) {
                const double share = (double)lattice->share[cell_at(lattice, i, j, k)];
                const double centre[3] = { lattice->low[0] + s * (i + 0.5), lattice->low[1] + s * (j + 0.5),
                                           lattice->low[2] + s * (k + 0.5) };
                uint32_t node[8];
                if (!(share > 0.0))
                    continue;
                for (uint32_t c = 0; c < 8; c++)
                    node[c] = lattice->node[corner_at(lattice, i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))];
                DPT_TRY(work(context, node, centre, share));
            }
    return DPT_OK;
}

struct cell_springs {
    struct net *net;
    double spacing;
    double shear; /* modulus, by Young's */
};

/* Note a cell whose volume has a term; the lanes of a slice beyond it are its own corners, without stiffness. */
static void note_cell(struct net *net, const uint32_t node[8], double stiffness)
{
    const uint32_t lane = net->cell_count % LANES, first = net->cell_count - lane;
    for (uint32_t c = 0; c < 8; c++) {
        for (uint32_t i = lane; i < LANES; i++)
            net->cell_nodes[8 * (size_t)first + LANES * c + i] = node[c];
        net->cell_bound[node[c]] += 3.0 * cell_bound(net->def->poisson) * stiffness;
    }
    net->cell_stiffness[net->cell_count++] = (float)stiffness;
}

/*
 * An edge is one of four cells', a face diagonal one of two cells'. With springs of k each, all cells full, a lattice
 * of spacing s is isotropic: both of Lame's constants are k / s. So k is the shear modulus times s, and Poisson's ratio
 * is 1/4; what another one needs is in the terms of volumes.
 *
 * Of a cell by itself, each coordinate free at its corners, the largest eigenvalue of the stiffness is 3 k: corners
 * whose signs along two axes agree move one way, the others the other way. Face diagonals of b k more, for the volume,
 * add 4 b k.
 */
static dpt_result add_cell(void *context, const uint32_t node[8], const double centre[3], double share)
{
    const struct cell_springs *cell = context;
    const double s = cell->spacing;
    const struct material material = spring_material(cell->net, centre);
    const double stiffness = cell->shear * material.young * s * share;
    const double mass = material.density * s * s * s * share / 8.0;
    const double bound = cell->net->cell_bound ? 4.0 * cell_bound(cell->net->def->poisson) : 0.0;
    cell->net->square = max_of(cell->net->square, (3.0 + bound) * stiffness / mass);
    if (cell->net->cell_bound)
        note_cell(cell->net, node, stiffness);
    for (uint32_t a = 0; a < 8; a++) {
        cell->net->mass[node[a]] += mass;
        for (uint32_t b = a + 1; b < 8; b++) {
            const uint32_t axes = a ^ b;
            const uint32_t apart = (axes & 1) + (axes >> 1 & 1) + (axes >> 2);
            if (apart < 3)
                DPT_TRY(spring_add(cell->net, node[a], node[b], apart == 1 ? 0.25 * stiffness : 0.5 * stiffness));
        }
    }
    return DPT_OK;
}

dpt_result spring_lattice_springs(struct net *net, const struct spring_lattice *lattice)
{
    struct cell_springs cell = { net, lattice->spacing, 0.5 / (1.0 + net->def->poisson) };
    if (net->def->poisson != 0.25) {
        const uint32_t slices = mesh_slices(lattice->cell_count);
        net->cell_size = lattice->spacing;
        net->cell_bound = calloc(net->node_count, sizeof *net->cell_bound);
        net->cell_nodes = calloc((size_t)slices, 8 * LANES * sizeof *net->cell_nodes);
        net->cell_stiffness = calloc((size_t)slices, LANES * sizeof *net->cell_stiffness);
        if (!net->cell_bound || !net->cell_nodes || !net->cell_stiffness)
            return compile_fail(net->source->context, DPT_E_MEMORY, nowhere, "memory ran out");
    }
    return each_cell(lattice, add_cell, &cell);
}

/* The six tetrahedra about the diagonal from corner 0 to corner 7 (Kuhn 1960). Neighbouring cells' faces agree. */
static dpt_result cut_cell(void *context, const uint32_t node[8], const double centre[3], double share)
{
    static const uint8_t steps[6][2] = { { 1, 3 }, { 1, 5 }, { 2, 3 }, { 2, 6 }, { 4, 5 }, { 4, 6 } };
    uint32_t **next = context;
    (void)centre, (void)share;
    for (int i = 0; i < 6; i++) {
        const uint32_t cell[4] = { node[0], node[steps[i][0]], node[steps[i][1]], node[7] };
        memcpy(*next, cell, sizeof cell);
        *next += 4;
    }
    return DPT_OK;
}

dpt_result spring_lattice_embed(const struct spring_lattice *lattice, struct model *model, soup *source)
{
    double *nodes = compile_alloc(source->context, lattice->node_count, 3 * sizeof *nodes);
    uint32_t *cells = compile_alloc(source->context, lattice->cell_count, 24 * sizeof *cells), *next = cells;
    dpt_result result = DPT_E_MEMORY;
    if (nodes && cells) {
        for (size_t i = 0; i < 3 * (size_t)lattice->node_count; i++)
            nodes[i] = (double)lattice->rest[i];
        each_cell(lattice, cut_cell, &next);
        const struct embed_cells given = { nodes, cells, lattice->node_count, 6 * lattice->cell_count, 1.0 };
        result = embed_in(model, source, &given);
    }
    free(nodes);
    free(cells);
    return result;
}
