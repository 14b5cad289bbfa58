/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Embeddings, against an oracle that asks every cell, in long double, by other formulas: signed volumes for the
 * weights, and the nearest of all corners, edges and faces for the distance. What lies on faces, edges and nodes is
 * judged in integers. The oracle cannot judge which of cells at nearly the same distance is taken.
 *
 *     test_embed [PER CENT]   of the random cases
 */
#include <math.h>

#include "compile/lattice.h"
#include "lib/dpa.h"

typedef long double real;

/* A mesh of loose triangles, in which vertex i is its own, and what it was compiled to. */
struct subject {
    double *points; /* 3 each */
    uint32_t point_count;
    dpt_compile_def def;
    dpt_compiled compiled;
    const dpt_mesh *mesh;
    dpt_mesh_info info;
    const float *xyz, *weights;
    const uint32_t *sources, *nodes;
};

static dpt_result compile(struct subject *subject, dpt_diag *diag)
{
    const uint32_t triangles = subject->point_count / 3;
    uint32_t *corners = malloc(3 * triangles * sizeof *corners);
    for (uint32_t i = 0; i < 3 * triangles; i++)
        corners[i] = i;
    subject->def.size = sizeof subject->def;
    const dpt_result result = dpt_compile_arrays(subject->points, subject->point_count, corners, triangles,
                                                 &subject->def, &subject->compiled, diag);
    free(corners);
    return result;
}

static int open_subject(struct subject *subject)
{
    dpt_diag diag = { .size = sizeof diag };
    uint32_t vertices, node_count = 0;
    subject->info.size = sizeof subject->info;
    if (compile(subject, &diag) != DPT_OK ||
        dpt_mesh_convert(subject->compiled.bytes, subject->compiled.size, NULL) != DPT_OK ||
        dpt_mesh_open(subject->compiled.bytes, subject->compiled.size, &subject->mesh) != DPT_OK) {
        CHECK(0, "%s", diag.text);
        return 0;
    }
    dpt_mesh_get_info(subject->mesh, &subject->info);
    dpt_mesh_get_vertices(subject->mesh, &subject->xyz, &vertices);
    dpt_mesh_get_vertex_sources(subject->mesh, &subject->sources, &vertices);
    dpt_mesh_get_embedding(subject->mesh, &subject->nodes, &subject->weights, &node_count);
    CHECK(node_count == subject->def.node_count && subject->info.nodes == node_count, "%u nodes", node_count);
    return node_count > 0;
}

static void close_subject(struct subject *subject)
{
    dpt_compiled_free(&subject->compiled);
    free(subject->points);
}

/* ---- the oracle ---- */

static void corner_of(const dpt_compile_def *def, uint32_t cell, int k, real x[3])
{
    const double scale = def->scale != 0.0 ? def->scale : 1.0;
    for (int i = 0; i < 3; i++)
        x[i] = (real)(scale * def->nodes[3 * (size_t)def->cells[4 * (size_t)cell + (size_t)k] + (size_t)i]);
}

static real volume_of(real x[4][3])
{
    real e[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            e[i][k] = x[i + 1][k] - x[0][k];
    return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
           e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

/* The share of the volume that is left when corner k is moved to the point. */
static void oracle_weights(const dpt_compile_def *def, uint32_t cell, const real at[3], real weight[4])
{
    real x[4][3];
    for (int k = 0; k < 4; k++)
        corner_of(def, cell, k, x[k]);
    const real whole = volume_of(x);
    for (int k = 0; k < 4; k++) {
        real kept[3];
        memcpy(kept, x[k], sizeof kept);
        memcpy(x[k], at, sizeof kept);
        weight[k] = volume_of(x) / whole;
        memcpy(x[k], kept, sizeof kept);
    }
}

static real dot_of(const real a[3], const real b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The distance to the simplex of `count` corners, 1 to 3: that of its inside, if it is above, and of all its sides. */
static real simplex_distance(const real *const corner[3], int count, const real at[3])
{
    real e[2][3], from[3], t[2] = { 0, 0 }, best = INFINITY;
    for (int k = 0; k < 3; k++) {
        from[k] = at[k] - corner[0][k];
        e[0][k] = count > 1 ? corner[1][k] - corner[0][k] : 0;
        e[1][k] = count > 2 ? corner[2][k] - corner[0][k] : 0;
    }
    if (count == 2)
        t[0] = dot_of(from, e[0]) / dot_of(e[0], e[0]);
    if (count == 3) {
        const real aa = dot_of(e[0], e[0]), ab = dot_of(e[0], e[1]), bb = dot_of(e[1], e[1]);
        const real a = dot_of(from, e[0]), b = dot_of(from, e[1]), det = aa * bb - ab * ab;
        t[0] = (a * bb - b * ab) / det;
        t[1] = (b * aa - a * ab) / det;
    }
    if (t[0] >= 0 && t[1] >= 0 && t[0] + t[1] <= 1) {
        real gap[3];
        for (int k = 0; k < 3; k++)
            gap[k] = from[k] - t[0] * e[0][k] - t[1] * e[1][k];
        best = sqrtl(dot_of(gap, gap));
    }
    for (int left = 0; count > 1 && left < count; left++) {
        const real *side[3] = { corner[(left + 1) % count], corner[(left + 2) % count], NULL };
        best = fminl(best, simplex_distance(side, count - 1, at));
    }
    return best;
}

static real oracle_distance(const dpt_compile_def *def, uint32_t cell, const real at[3], const real weight[4])
{
    real x[4][3], best = INFINITY;
    int is_inside = 1;
    for (int k = 0; k < 4; k++) {
        corner_of(def, cell, k, x[k]);
        is_inside &= weight[k] >= 0;
    }
    for (int left = 0; left < 4; left++) {
        const real *face[3] = { x[(left + 1) % 4], x[(left + 2) % 4], x[(left + 3) % 4] };
        best = fminl(best, simplex_distance(face, 3, at));
    }
    return is_inside ? 0 : best;
}

static real size_of(const real weight[4])
{
    real size = 0;
    for (int k = 0; k < 4; k++)
        size = fmaxl(size, fabsl(weight[k]));
    return size;
}

static real least_of(const real weight[4])
{
    return fminl(fminl(weight[0], weight[1]), fminl(weight[2], weight[3]));
}

/* ---- what must hold ---- */

/* The sum is 1 to the last bit, and where the nodes are, the weights give the vertex. */
static void expect_reproduction(const struct subject *subject, uint32_t v, const real at[3], real extent)
{
    const float *weight = subject->weights + 4 * (size_t)v;
    const double scale = subject->def.scale != 0.0 ? subject->def.scale : 1.0;
    double sum = 0.0;
    real size = 1;
    for (int k = 0; k < 4; k++) {
        sum += (double)weight[k];
        size = fmaxl(size, fabsl((real)weight[k]));
    }
    CHECK(sum == 1.0, "vertex %u: the sum is %.17g", v, sum);
    for (int i = 0; i < 3; i++) {
        real x = 0, low = INFINITY, high = -INFINITY;
        for (size_t k = 0; k < 4; k++) {
            const size_t node = subject->nodes[4 * (size_t)v + k];
            const real place = (real)(scale * subject->def.nodes[3 * node + (size_t)i]);
            x += (real)weight[k] * place;
            low = fminl(low, place);
            high = fmaxl(high, place);
        }
        const real bound = 0x1p-22L * size * (high - low) + 0x1p-45L * size * extent;
        CHECK(fabsl(x - at[i]) <= bound, "vertex %u: off by %.3Lg of %.3Lg", v, x - at[i], bound);
    }
}

struct tally {
    uint32_t outside, on_the_limit;
    real distance;
};

/* The cell is the nearest that can be used, or the first that holds the vertex. */
static void expect_cell(const struct subject *subject, uint32_t v, real extent, struct tally *tally)
{
    const dpt_compile_def *def = &subject->def;
    const uint32_t *nodes = subject->nodes + 4 * (size_t)v;
    real at[3], weight[4], own[4] = { 0 }, usable = INFINITY, nearest = INFINITY, chosen = INFINITY;
    uint32_t holder = DPT_NONE, cell = DPT_NONE;
    for (int i = 0; i < 3; i++)
        at[i] = (real)subject->xyz[3 * (size_t)v + (size_t)i];
    for (uint32_t c = 0; c < def->cell_count; c++) {
        oracle_weights(def, c, at, weight);
        const real distance = oracle_distance(def, c, at, weight), size = size_of(weight);
        nearest = fminl(nearest, distance);
        if (size < 99.99L)
            usable = fminl(usable, distance);
        if (least_of(weight) > 1e-9L && holder == DPT_NONE)
            holder = c;
        if (cell == DPT_NONE && !memcmp(def->cells + 4 * (size_t)c, nodes, 4 * sizeof *nodes)) {
            cell = c;
            chosen = distance;
            memcpy(own, weight, sizeof own);
            CHECK(size < 100.01L, "vertex %u has a weight of %.3Lg", v, size);
        }
    }
    const real slack = 1e-14L * extent;
    CHECK(cell != DPT_NONE, "vertex %u: its nodes are no cell", v);
    CHECK(chosen <= usable + slack, "vertex %u: cell %u at %.3Lg, one at %.3Lg", v, cell, chosen, usable);
    CHECK(holder >= cell || holder == DPT_NONE, "vertex %u: cell %u, and %u holds it", v, cell, holder);
    const real unit = 0x1p-23L * fmaxl(1, 2 * size_of(own));
    for (int k = 0; k < 4; k++)
        CHECK(fabsl((real)subject->weights[4 * (size_t)v + (size_t)k] - own[k]) <= unit + 1e-8L * (chosen > 0),
              "vertex %u: weight %.9g, not %.9Lg", v, (double)subject->weights[4 * (size_t)v + (size_t)k], own[k]);
    expect_reproduction(subject, v, at, extent);
    const real moved = 1.75L * (real)subject->info.rounding;
    tally->distance = fmaxl(tally->distance, nearest);
    tally->outside += nearest > moved + slack;
    tally->on_the_limit += fabsl(nearest - moved) <= slack;
}

static void expect_embedding(struct subject *subject)
{
    struct tally tally = { 0, 0, 0 };
    real extent = 0;
    const double scale = subject->def.scale != 0.0 ? subject->def.scale : 1.0;
    if (open_subject(subject)) {
        for (uint32_t i = 0; i < 3 * subject->def.node_count; i++)
            extent = fmaxl(extent, fabsl((real)(scale * subject->def.nodes[i])));
        for (uint32_t i = 0; i < 3 * subject->info.vertices; i++)
            extent = fmaxl(extent, fabsl((real)subject->xyz[i]));
        for (uint32_t v = 0; v < subject->info.vertices; v++)
            expect_cell(subject, v, extent, &tally);
        CHECK(subject->info.outside_vertices >= tally.outside &&
                  subject->info.outside_vertices <= tally.outside + tally.on_the_limit,
              "%u outside, not %u", subject->info.outside_vertices, tally.outside);
        CHECK(fabsl((real)subject->info.outside_distance - tally.distance) <= 1e-12L * extent, "%.9g off, not %.9Lg",
              subject->info.outside_distance, tally.distance);
    }
    close_subject(subject);
}

/* Points anywhere in a cube about the origin. */
static void scatter(struct subject *subject, uint32_t count, double reach, uint64_t *random)
{
    subject->point_count = count;
    subject->points = malloc(3 * count * sizeof *subject->points);
    for (uint32_t i = 0; i < 3 * count; i++)
        subject->points[i] = random_in(random, -reach, reach);
}

/* Within a block of space, and up to half of its side outside. */
static void blocks_of_space(void)
{
    const double low[3] = { -1.0, -0.9, -1.1 }, high[3] = { 1.0, 1.2, 0.8 };
    uint64_t random = 3;
    for (uint64_t i = 0; i < part_of(60); i++) {
        struct subject subject = { .def.scale = i % 3 == 0 ? 0.001 : i % 3 == 1 ? 0.0 : 1.0 / 3.0 };
        struct lattice lattice;
        scatter(&subject, 90, i % 2 ? 0.85 : 2.0, &random);
        lattice_make(&lattice, 1 + (uint32_t)(i % 5), low, high, 1 + i);
        lattice_use(&lattice, &subject.def);
        expect_embedding(&subject);
        lattice_free(&lattice);
    }
}

/* The vertex that the diag names has no cell that it can use. */
static void expect_no_cell(struct subject *subject, const char *text)
{
    unsigned number = UINT32_MAX;
    real at[3], weight[4];
    CHECK(sscanf(text, "vertex %u is", &number) == 1 && number < subject->point_count, "%s", text);
    for (int i = 0; i < 3 && number < subject->point_count; i++)
        at[i] = (real)(float)subject->points[3 * (size_t)number + (size_t)i];
    for (uint32_t c = 0; c < subject->def.cell_count && number < subject->point_count; c++) {
        oracle_weights(&subject->def, c, at, weight);
        CHECK(size_of(weight) > 99.99L, "vertex %u could use cell %u", number, c);
    }
    close_subject(subject);
}

/*
 * Cells through each other, some of them so thin that few vertices can use them. Where one can use none, the compiler
 * must say so.
 */
static void cells_at_random(void)
{
    uint64_t random = 5;
    uint32_t embedded = 0, refused = 0;
    for (uint64_t i = 0; i < part_of(100); i++) {
        enum { NODES = 40, CELLS = 30 };
        struct subject subject = { .points = NULL };
        double nodes[3 * NODES];
        uint32_t cells[4 * CELLS];
        scatter(&subject, 60, i % 4 ? 1.0 : 3.0, &random);
        for (int k = 0; k < 3 * NODES; k++)
            nodes[k] = random_in(&random, -1.0, 1.0);
        for (int k = 0; k < 3 * NODES && i % 2; k += 3)
            nodes[k + 2] *= i % 4 == 1 ? 1e-3 : k % 2 ? 0.02 : 1.0;
        for (int c = 0; c < CELLS; c++)
            for (int k = 0; k < 4; k++)
                cells[4 * c + k] = (uint32_t)(random_bits(&random) % (NODES / 4)) + NODES / 4 * (uint32_t)k;
        subject.def = (dpt_compile_def){ .nodes = nodes, .cells = cells, .node_count = NODES, .cell_count = CELLS };
        dpt_diag diag = { .size = sizeof diag };
        if (compile(&subject, &diag) == DPT_OK) {
            dpt_compiled_free(&subject.compiled);
            expect_embedding(&subject);
            embedded++;
        } else {
            expect_no_cell(&subject, diag.text);
            refused++;
        }
    }
    CHECK(embedded >= least_seen(20) && refused >= least_seen(5), "%u embedded, %u refused", embedded, refused);
}

/* Far from the origin the weights are as good as there: only the vertices are rounded more. */
static void far_from_the_origin(void)
{
    const double low[3] = { 4000.0, -3000.0, 900.0 }, high[3] = { 4000.5, -2999.5, 900.5 };
    uint64_t random = 7;
    struct subject subject = { .points = NULL };
    struct lattice lattice;
    scatter(&subject, 300, 0.3, &random);
    for (uint32_t i = 0; i < 3 * subject.point_count; i++)
        subject.points[i] += 0.5 * (low[i % 3] + high[i % 3]);
    lattice_make(&lattice, 4, low, high, 9);
    lattice_use(&lattice, &subject.def);
    expect_embedding(&subject);
    lattice_free(&lattice);
}

/* ---- on faces, edges and nodes ---- */

/* Six times the volume, of whole numbers. */
static int64_t whole_volume(int64_t x[4][3])
{
    int64_t e[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            e[i][k] = x[i + 1][k] - x[0][k];
    return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
           e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

/* Four weights times the cell's volume, exact; returns the volume, made positive. All coordinates in quarters. */
static int64_t whole_weights(const dpt_compile_def *def, uint32_t cell, const float *at, int64_t weight[4])
{
    int64_t x[4][3], point[3];
    for (int i = 0; i < 3; i++) {
        point[i] = (int64_t)(4.0f * at[i]);
        for (int k = 0; k < 4; k++)
            x[k][i] = (int64_t)(4.0 * def->nodes[3 * (size_t)def->cells[4 * (size_t)cell + (size_t)k] + (size_t)i]);
    }
    const int64_t whole = whole_volume(x), sign = whole < 0 ? -1 : 1;
    for (int k = 0; k < 4; k++) {
        int64_t kept[3];
        memcpy(kept, x[k], sizeof kept);
        memcpy(x[k], point, sizeof kept);
        weight[k] = sign * whole_volume(x);
        memcpy(x[k], kept, sizeof kept);
    }
    return sign * whole;
}

/* Each point of a grid of quarters is on a node, an edge, a face or within; the first cell that holds it is taken. */
static void faces_edges_and_nodes(void)
{
    const double low[3] = { 0, 0, 0 }, high[3] = { 3, 3, 3 };
    struct lattice lattice;
    struct subject subject = { .points = NULL };
    uint32_t on_nodes = 0, on_cells = 0;
    lattice_make(&lattice, 3, low, high, 11);
    for (uint32_t i = 0; i < 3 * lattice.node_count; i++)
        lattice.nodes[i] = floor(lattice.nodes[i] + 0.5);
    lattice_use(&lattice, &subject.def);
    subject.point_count = 13 * 13 * 13 / 3 * 3;
    subject.points = malloc(3 * subject.point_count * sizeof *subject.points);
    for (uint32_t i = 0; i < subject.point_count; i++) {
        const uint32_t shuffled = i * 1000u % 2197u; /* so that three in a row are no line */
        subject.points[3 * i] = 0.25 * (shuffled % 13);
        subject.points[3 * i + 1] = 0.25 * (shuffled / 13 % 13);
        subject.points[3 * i + 2] = 0.25 * (shuffled / 169);
    }
    const int is_open = open_subject(&subject);
    for (uint32_t v = 0; is_open && v < subject.info.vertices; v++) {
        int64_t weight[4], whole = 0;
        uint32_t cell = 0, holders = 0, first = DPT_NONE;
        for (; cell < lattice.cell_count; cell++) {
            whole_weights(&subject.def, cell, subject.xyz + 3 * (size_t)v, weight);
            if (weight[0] < 0 || weight[1] < 0 || weight[2] < 0 || weight[3] < 0)
                continue;
            holders++;
            first = first == DPT_NONE ? cell : first;
        }
        CHECK(first != DPT_NONE &&
                  !memcmp(subject.nodes + 4 * (size_t)v, lattice.cells + 4 * (size_t)first, 4 * sizeof first),
              "vertex %u is not in cell %u", v, first);
        if (first != DPT_NONE)
            whole = whole_weights(&subject.def, first, subject.xyz + 3 * (size_t)v, weight);
        for (size_t k = 0; whole && k < 4; k++) {
            on_nodes += weight[k] == whole;
            CHECK((double)subject.weights[4 * (size_t)v + k] == (double)weight[k] / (double)whole,
                  "vertex %u: weight %.9g, not %.9g", v, (double)subject.weights[4 * (size_t)v + k],
                  (double)weight[k] / (double)whole);
        }
        on_cells += holders > 1;
    }
    CHECK(on_nodes > 50 && on_cells > 1000, "%u on nodes, %u in several cells", on_nodes, on_cells);
    CHECK(subject.info.outside_vertices == 0 && subject.info.outside_distance == 0.0, "%u outside",
          subject.info.outside_vertices);
    close_subject(&subject);
    lattice_free(&lattice);
}

/* Beyond the corners of a cube: of the cells that meet there, at the same distance, the first is taken. */
static void equally_near_cells(void)
{
    const double low[3] = { 0, 0, 0 }, high[3] = { 1, 1, 1 };
    uint32_t ties = 0;
    for (uint64_t seed = 1; seed < 20; seed++) {
        struct lattice lattice;
        struct subject subject = { .point_count = 9 };
        subject.points = malloc(27 * sizeof *subject.points);
        for (uint32_t i = 0; i < 27; i++) {
            const uint32_t corner = i / 3 % 8;
            subject.points[i] = corner >> i % 3 & 1 ? 1.5 : -0.5;
        }
        lattice_make(&lattice, 1, low, high, seed);
        lattice_use(&lattice, &subject.def);
        const int is_open = open_subject(&subject);
        for (uint32_t v = 0; is_open && v < subject.info.vertices; v++) {
            uint32_t first = DPT_NONE, cells = 0;
            for (uint32_t i = 0; i < 4 * lattice.cell_count; i++) {
                int is_corner = 1;
                for (size_t k = 0; k < 3; k++)
                    is_corner &=
                        (lattice.nodes[3 * lattice.cells[i] + k] == 1.0) == (subject.xyz[3 * (size_t)v + k] == 1.5f);
                cells += (uint32_t)is_corner;
                first = is_corner && first == DPT_NONE ? i / 4 : first;
            }
            ties += cells > 1;
            CHECK(first != DPT_NONE && !memcmp(subject.nodes + 4 * (size_t)v, lattice.cells + 4 * (size_t)first, 16),
                  "vertex %u is not in cell %u, the first of %u", v, first, cells);
        }
        close_subject(&subject);
        lattice_free(&lattice);
    }
    CHECK(ties > 100, "%u ties", ties);
}

/* Nodes that are vertices of the source, unrounded: no vertex is outside for having been rounded. */
static void rounding_leaves_no_one_outside(void)
{
    uint64_t random = 13;
    for (uint64_t i = 0; i < part_of(200); i++) {
        struct subject subject = { .points = NULL };
        double nodes[12];
        const uint32_t cell[4] = { 0, 1, 2, 3 };
        scatter(&subject, 6, 1.0, &random);
        for (uint32_t k = 0; k < 12; k++)
            nodes[k] = subject.points[k];
        for (uint32_t k = 12; k < 18; k++) /* on a face, and on an edge */
            subject.points[k] =
                k < 15 ? (nodes[k - 12] + nodes[k - 9] + nodes[k - 6]) / 3.0 : 0.5 * (nodes[k - 15] + nodes[k - 6]);
        subject.def = (dpt_compile_def){ .nodes = nodes, .cells = cell, .node_count = 4, .cell_count = 1 };
        if (open_subject(&subject))
            CHECK(subject.info.outside_vertices == 0 && subject.info.vertices == 6 &&
                      subject.info.outside_distance <= 1.75 * subject.info.rounding,
                  "%u of %u outside, %.3g m", subject.info.outside_vertices, subject.info.vertices,
                  subject.info.outside_distance);
        close_subject(&subject);
    }
}

/* A thin cell near by would give weights of thousands: the next one is taken, and the distance is still the true. */
static void thin_cells_are_passed_over(void)
{
    const double nodes[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0.3, 0.3, -1e-4, 0, 0, -1 };
    const uint32_t cells[] = { 0, 1, 2, 3, 0, 2, 1, 4 };
    const double points[] = { 0.2, 0.2, 0.5, 0.4, 0.1, 0.5, 0.1, 0.4, 0.5 };
    struct subject subject = { .point_count = 3 };
    subject.points = malloc(sizeof points);
    memcpy(subject.points, points, sizeof points);
    subject.def = (dpt_compile_def){ .nodes = nodes, .cells = cells, .node_count = 5, .cell_count = 2 };
    if (open_subject(&subject)) {
        for (uint32_t v = 0; v < 3; v++)
            CHECK(!memcmp(subject.nodes + 4 * (size_t)v, cells + 4, 16), "vertex %u", v);
        CHECK(subject.info.outside_vertices == 3 && subject.info.outside_distance == 0.5, "%.9g",
              subject.info.outside_distance);
    }
    close_subject(&subject);
}

static void bytes_do_not_depend_on_threads(void)
{
    const double low[3] = { -1, -1, -1 }, high[3] = { 1, 1, 1 };
    uint64_t random = 19;
    struct subject subject = { .points = NULL };
    struct lattice lattice;
    dpt_compiled one = { NULL, 0 };
    scatter(&subject, 9000, 1.3, &random);
    lattice_make(&lattice, 9, low, high, 21);
    lattice_use(&lattice, &subject.def);
    for (uint32_t threads = 1; threads <= 64; threads = threads < 4 ? threads + 1 : 4 * threads) {
        subject.def.threads = threads;
        CHECK(compile(&subject, NULL) == DPT_OK, "%u threads", threads);
        if (!one.bytes) {
            one = subject.compiled;
            continue;
        }
        CHECK(subject.compiled.size == one.size && !memcmp(subject.compiled.bytes, one.bytes, one.size),
              "other bytes with %u threads", threads);
        dpt_compiled_free(&subject.compiled);
    }
    subject.compiled = one;
    close_subject(&subject);
    lattice_free(&lattice);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(blocks_of_space);
    TEST(cells_at_random);
    TEST(far_from_the_origin);
    TEST(faces_edges_and_nodes);
    TEST(equally_near_cells);
    TEST(rounding_leaves_no_one_outside);
    TEST(thin_cells_are_passed_over);
    TEST(bytes_do_not_depend_on_threads);
    return check_report();
}
