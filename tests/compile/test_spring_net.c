/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Masses and springs, against counts of the paper, the continuum's energy and the mesh's own volume and area; all sums
 * are formed here, from the public arrays. What a net does in motion is not judged here.
 *
 * test_spring_net
 *
 * With DPT_DATA in the environment organs from there are filled too.
 */
#include <math.h>

#include "compile/spring_subject.h"
#include "dynpoint/springs.h"
#include "lib/check.h"

/* x' = gradient x of all nodes: the energy of all springs, each counted in both of its rows. */
static double energy_of(const dpt_mesh_springs *net, const double gradient[9])
{
    double sum = 0.0;
    for (uint32_t i = 0; i < net->nodes; i++)
        for (size_t w = words_begin(net, i); w < words_end(net, i); w += 16) {
            const uint32_t j = net->neighbours[w];
            double apart[3] = { 0 }, length2 = 0.0;
            for (size_t r = 0; r < 3; r++) {
                for (size_t c = 0; c < 3; c++)
                    apart[r] += gradient[3 * r + c] *
                                ((double)net->rest[3 * (size_t)j + c] - (double)net->rest[3 * (size_t)i + c]);
                length2 += apart[r] * apart[r];
            }
            const double longer = sqrt(length2) - (double)net->length[w];
            if (j != i)
                sum += 0.25 * (double)net->stiffness[w] * longer * longer;
        }
    return sum;
}

/* The part of the energy that is quadratic in the strain: of both signs, whose odd parts cancel. */
static double strain_energy(const dpt_mesh_springs *net, const double strain[9])
{
    double stretched[9], pressed[9];
    for (int i = 0; i < 9; i++) {
        stretched[i] = (i % 4 == 0) + strain[i];
        pressed[i] = (i % 4 == 0) - strain[i];
    }
    return 0.5 * (energy_of(net, stretched) + energy_of(net, pressed));
}

/* What a linear material stores per volume: lambda / 2 tr(e)^2 + mu e:e. */
static double continuum(double lambda, double mu, const double strain[9])
{
    const double trace = strain[0] + strain[4] + strain[8];
    double squares = 0.0;
    for (int i = 0; i < 9; i++)
        squares += strain[i] * strain[i];
    return 0.5 * lambda * trace * trace + mu * squares;
}

#define SMALL 2e-4

/* Three stretches and three shears; a sheet has the first, the second and the fourth. */
static const double strains[6][9] = {
    { SMALL, 0, 0, 0, 0, 0, 0, 0, 0 },     { 0, 0, 0, 0, SMALL, 0, 0, 0, 0 },     { 0, 0, 0, 0, 0, 0, 0, 0, SMALL },
    { 0, SMALL, 0, SMALL, 0, 0, 0, 0, 0 }, { 0, 0, SMALL, 0, 0, 0, SMALL, 0, 0 }, { 0, 0, 0, 0, 0, SMALL, 0, SMALL, 0 },
};

static void expect_energy(const struct subject *subject, const double strain[9], double wanted, double error)
{
    const double energy = strain_energy(&subject->net, strain);
    CHECK(fabs(energy / wanted - 1.0) <= error, "energy %.9g J, not %.9g", energy, wanted);
}

static void sheets_have_the_papers_counts(void)
{
    const struct {
        const char *name;
        uint64_t triangles;
        uint32_t springs;
    } sheets[] = { { "membrane", 512, 1056 }, { "cloth", 2048, 4160 } };
    for (int i = 0; i < 2; i++) {
        struct subject subject;
        const dpt_spring_net_def def = def_of(DPT_NET_SHEET);
        double volume, area;
        if (!make_subject(&subject, sheets[i].name, sheets[i].triangles, &def))
            continue;
        CHECK(subject.info.springs == sheets[i].springs && subject.info.spring_nodes == subject.info.vertices &&
                  !subject.info.nodes,
              "%s: %u springs, %u nodes", sheets[i].name, subject.info.springs, subject.info.spring_nodes);
        measure(subject.mesh, &volume, &area);
        CHECK(fabs(sum_of_masses(&subject.net) - area) < 1e-7 * area && fabs(subject.info.spring_mass - area) < 1e-12,
              "%s: %.9g and %.9g kg, not %.9g", sheets[i].name, sum_of_masses(&subject.net), subject.info.spring_mass,
              area);
        CHECK(subject.info.poisson == 1.0 / 3.0, "nu %g", subject.info.poisson);
        expect_rows(&subject);
        free(subject.file.bytes);
    }
}

/* E h = 10 N/m and nu = 1/3 in the plane: mu = E / (2 (1 + nu)), lambda = E nu / (1 - nu^2). */
static void a_grid_is_as_stiff_as_its_material(void)
{
    struct subject subject;
    dpt_spring_net_def def = def_of(DPT_NET_SHEET);
    def.young = 2500.0;
    def.thickness = 0.004;
    if (!make_subject(&subject, "membrane", 512, &def))
        return;
    for (int i = 0; i < 4; i++)
        if (i != 2)
            expect_energy(&subject, strains[i], 0.04 * continuum(10.0 * 3.0 / 8.0, 10.0 * 3.0 / 8.0, strains[i]), 1e-4);
    free(subject.file.bytes);
}

/*
 * The diagonals of the grid's squares alternate. So bending springs run straight on over the vertices with four edges:
 * both ways over 113 inside, one way over 30 at the border.
 */
static void bending_springs_are_added(void)
{
    struct subject plain, bent;
    dpt_spring_net_def def = def_of(DPT_NET_SHEET);
    if (!make_subject(&plain, "membrane", 512, &def))
        return;
    def.bending = 1000.0;
    if (make_subject(&bent, "membrane", 512, &def)) {
        CHECK(bent.info.springs == plain.info.springs + 2 * 113 + 30, "%u springs", bent.info.springs);
        const double more = strain_energy(&bent.net, strains[0]) / strain_energy(&plain.net, strains[0]);
        CHECK(more > 1.01 && more < 1.4, "%g times as stiff in its plane", more);
        expect_rows(&bent);
        free(bent.file.bytes);
    }
    free(plain.file.bytes);
}

/* Cells as in the box: 6 x 5 x 4 of 0.02 m. lambda = mu = 0.4 E. */
static void a_block_is_as_stiff_as_its_material(void)
{
    struct subject subject;
    dpt_spring_net_def def = def_of(DPT_NET_VOLUME);
    const double volume = 0.12 * 0.10 * 0.08;
    def.spacing = 0.02;
    def.young = 3000.0;
    def.density = 1100.0;
    if (!make_subject(&subject, "box", 12, &def))
        return;
    CHECK(subject.info.nodes == 210 && subject.info.spring_nodes == 210 && subject.info.springs == 523 + 868 &&
              subject.info.poisson == 0.25 && !subject.info.outside_vertices,
          "%u nodes, %u springs, %u outside", subject.info.spring_nodes, subject.info.springs,
          subject.info.outside_vertices);
    CHECK(fabs(sum_of_masses(&subject.net) / (1100.0 * volume) - 1.0) < 1e-6, "%.9g kg", sum_of_masses(&subject.net));
    for (int i = 0; i < 6; i++)
        expect_energy(&subject, strains[i], volume * continuum(1200.0, 1200.0, strains[i]), 1e-4);
    expect_rows(&subject);
    free(subject.file.bytes);
}

/* The energy that the solver has for nodes at x' = turn (1 + by strain) x, the turn by 0.5 rad about z or none. */
static double solver_energy(const struct subject *subject, dpt_springs *springs, const double strain[9], double by,
                            int is_turned)
{
    const double c = is_turned ? 0.87758256189037276 : 1.0, s = is_turned ? 0.47942553860420301 : 0.0;
    const uint32_t count = subject->net.nodes;
    float *x = malloc(3 * (size_t)count * sizeof *x);
    double elastic = 0.0, kinetic;
    for (uint32_t i = 0; i < count; i++) {
        const float *rest = subject->net.rest + 3 * (size_t)i;
        double y[3];
        for (int r = 0; r < 3; r++) {
            y[r] = (double)rest[r];
            for (int k = 0; k < 3; k++)
                y[r] += by * strain[3 * r + k] * (double)rest[k];
        }
        x[3 * (size_t)i] = (float)(c * y[0] - s * y[1]);
        x[3 * (size_t)i + 1] = (float)(s * y[0] + c * y[1]);
        x[3 * (size_t)i + 2] = (float)y[2];
    }
    CHECK(dpt_springs_set_nodes(springs, 0, count, x, NULL) == DPT_OK, "not put");
    CHECK(dpt_springs_get_energy(springs, &elastic, &kinetic) == DPT_OK, "no energy");
    free(x);
    return elastic;
}

/* With another Poisson's ratio a file and the solver hold the material's energy, turned or not, and the file says it. */
static void cells_have_the_ratio(void)
{
    const double ratios[] = { 0.1, 0.3, 0.45 }, volume = 0.12 * 0.10 * 0.08, young = 3000.0;
    for (int r = 0; r < 3; r++) {
        struct subject subject;
        dpt_spring_net_def def = def_of(DPT_NET_VOLUME);
        dpt_springs_def solver;
        dpt_springs *springs = NULL;
        def.spacing = 0.02;
        def.young = young;
        def.poisson = ratios[r];
        if (!make_subject(&subject, "box", 12, &def))
            continue;
        CHECK(subject.info.poisson == ratios[r] && subject.info.format_version == 7, "%g in format %u",
              subject.info.poisson, subject.info.format_version);
        dpt_springs_def_init(&solver);
        solver.mesh = subject.mesh;
        void *block = malloc(dpt_springs_bytes(&solver));
        CHECK(dpt_springs_create(block, dpt_springs_bytes(&solver), &solver, &springs) == DPT_OK, "not made");
        const double mu = young / (2.0 * (1.0 + ratios[r])), lambda = 2.0 * mu * ratios[r] / (1.0 - 2.0 * ratios[r]);
        for (int i = 0; i < 6 && springs; i++)
            for (int is_turned = 0; is_turned < 2; is_turned++) {
                const double energy = 0.5 * (solver_energy(&subject, springs, strains[i], 10.0, is_turned) +
                                             solver_energy(&subject, springs, strains[i], -10.0, is_turned));
                const double material = 100.0 * volume * continuum(lambda, mu, strains[i]);
                CHECK(fabs(energy / material - 1.0) < 2e-3, "%g, strain %d: %g J, of the material %g", ratios[r], i,
                      energy, material);
            }
        free(block);
        free(subject.file.bytes);
    }
}

/* An edge that is the longest of one of its triangles alone has no shear spring. */
static void slim_triangles_are_not_crossed(void)
{
    const double vertices[] = { 0, 0, 0, 1, 0, 0, 0.5, 0.3, 0, 0.5, -3, 0 };
    const uint32_t corners[] = { 0, 1, 2, 1, 0, 3 };
    const dpt_spring_net_def def = def_of(DPT_NET_SHEET);
    const dpt_compile_def compile = { .size = sizeof compile, .springs = &def };
    dpt_compiled compiled;
    struct subject subject;
    CHECK(dpt_compile_arrays(vertices, 4, corners, 2, &compile, &compiled, NULL) == DPT_OK, "does not compile");
    if (!open_subject(&subject, &compiled))
        return;
    CHECK(subject.info.springs == 5, "%u springs", subject.info.springs);
    free(subject.file.bytes);
}

/* A turn of 0.5 rad about (1, 2, 2) / 3, by Rodrigues. */
static void turns_cost_nothing(void)
{
    const double axis[3] = { 1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0 }, c = cos(0.5), s = sin(0.5);
    double turn[9];
    struct subject subject;
    const dpt_spring_net_def defs[2] = { def_of(DPT_NET_SHEET), def_of(DPT_NET_VOLUME) };
    for (int i = 0; i < 9; i++) {
        const int row = i / 3, column = i % 3, third = 3 - row - column;
        const double sign = (column - row + 3) % 3 == 1 ? -1.0 : 1.0;
        turn[i] = (row == column ? c : sign * s * axis[third]) + (1.0 - c) * axis[row] * axis[column];
    }
    for (int i = 0; i < 2; i++)
        if (make_subject(&subject, "torus", 600, &defs[i])) {
            const double turned = energy_of(&subject.net, turn);
            CHECK(turned < 1e-5 * strain_energy(&subject.net, strains[0]), "%g J", turned);
            free(subject.file.bytes);
        }
}

/* Bodies with curved walls: mass against the volume, stiffness against the continuum's. */
static void curved_bodies_are_filled(void)
{
    const struct {
        const char *name;
        uint64_t triangles;
        double error;
    } bodies[] = { { "sphere", 1280, 0.01 }, { "torus", 2000, 0.01 }, { "liver", 12578, 0.01 } };
    for (int b = 0; b < 3; b++) {
        struct subject subject;
        double volume, area;
        dpt_spring_net_def def = def_of(DPT_NET_VOLUME);
        if (!make_subject(&subject, bodies[b].name, bodies[b].triangles, &def))
            continue;
        measure(subject.mesh, &volume, &area);
        const double error = sum_of_masses(&subject.net) / (1000.0 * volume) - 1.0;
        CHECK(fabs(error) < bodies[b].error, "%s: %.3g of the mass off", bodies[b].name, error);
        CHECK(!subject.info.outside_vertices, "%s: %u vertices outside", bodies[b].name, subject.info.outside_vertices);
        for (int i = 0; i < 6; i++)
            expect_energy(&subject, strains[i], volume * continuum(2000.0, 2000.0, strains[i]), bodies[b].error);
        free(subject.file.bytes);
    }
}

/* A cube of this size about x, y, z, its eight vertices from `first`, turned inside out if `inward`. */
static void add_cube(double *vertices, uint32_t *corners, uint32_t first, double x, double size, int inward)
{
    static const uint32_t sides[12][3] = {
        { 0, 2, 1 }, { 1, 2, 3 }, { 4, 5, 6 }, { 5, 7, 6 }, { 0, 1, 4 }, { 1, 5, 4 },
        { 2, 6, 3 }, { 3, 6, 7 }, { 0, 4, 2 }, { 2, 4, 6 }, { 1, 3, 5 }, { 3, 7, 5 }
    };
    for (uint32_t i = 0; i < 8; i++)
        for (uint32_t k = 0; k < 3; k++)
            vertices[3 * (first + i) + k] = ((i >> k & 1) - 0.5) * size + (k == 0 ? x : 0.0);
    for (uint32_t i = 0; i < 12; i++)
        for (uint32_t k = 0; k < 3; k++)
            corners[36 * (first / 8) + 3 * i + k] = first + sides[i][inward && k > 0 ? 3 - k : k];
}

/* Two cubes, 0.1 m and `size`: as many nodes and kilograms. */
static void expect_cubes(double x, double size, int inward, uint32_t nodes, double mass)
{
    double vertices[48];
    uint32_t corners[72];
    dpt_spring_net_def def = def_of(DPT_NET_VOLUME);
    const dpt_compile_def compile = { .size = sizeof compile, .springs = &def };
    dpt_compiled compiled;
    struct subject subject;
    def.spacing = 0.01;
    add_cube(vertices, corners, 0, 0.0, 0.1, 0);
    add_cube(vertices, corners, 8, x, size, inward);
    CHECK(dpt_compile_arrays(vertices, 16, corners, 24, &compile, &compiled, NULL) == DPT_OK, "does not compile");
    if (!open_subject(&subject, &compiled))
        return;
    CHECK(fabs(sum_of_masses(&subject.net) - mass) < 1e-6, "%.9g kg, not %g", sum_of_masses(&subject.net), mass);
    CHECK(subject.info.nodes == nodes, "%u nodes, not %u", subject.info.nodes, nodes);
    free(subject.file.bytes);
}

/* A cavity is empty, and what lies in two parts counts once. */
static void cavities_are_empty(void)
{
    expect_cubes(0.0, 0.06, 1, 11 * 11 * 11 - 5 * 5 * 5, 1.0 - 0.216);
    expect_cubes(0.05, 0.06, 0, 11 * 11 * 11 + 3 * 7 * 7, 1.0 + 0.5 * 0.216);
}

static void vertices_follow_the_lattice(void)
{
    struct subject subject;
    const dpt_spring_net_def def = def_of(DPT_NET_VOLUME);
    const uint32_t *nodes;
    const float *weights, *xyz;
    uint32_t node_count, count;
    if (!make_subject(&subject, "liver", 2000, &def))
        return;
    dpt_mesh_get_embedding(subject.mesh, &nodes, &weights, &node_count);
    dpt_mesh_get_vertices(subject.mesh, &xyz, &count);
    CHECK(node_count == subject.net.nodes, "%u nodes", node_count);
    for (size_t v = 0; v < count; v++)
        for (size_t k = 0; k < 3; k++) {
            double x = 0.0;
            for (size_t n = 4 * v; n < 4 * v + 4; n++)
                x += (double)weights[n] * (double)subject.net.rest[3 * (size_t)nodes[n] + k];
            CHECK(fabs(x - (double)xyz[3 * v + k]) < 1e-8, "vertex %zu is off by %g", v, x - (double)xyz[3 * v + k]);
        }
    free(subject.file.bytes);
}

/*
 * The largest eigenvalue of M^-1 K at rest, by power iteration, for a net whose lengths are `longer` times those at
 * rest: K of a spring is k n n' + k (1 - 1 / longer) (1 - n n').
 */
static double largest_eigenvalue(const dpt_mesh_springs *net, double longer)
{
    double *x = malloc(6 * (size_t)net->nodes * sizeof *x), *y = x + 3 * (size_t)net->nodes;
    double value = 0.0;
    uint64_t random = 7;
    for (size_t i = 0; i < 3 * (size_t)net->nodes; i++)
        x[i] = random_in(&random, -1.0, 1.0);
    for (int round = 0; round < 400; round++) {
        double size2 = 0.0;
        for (uint32_t i = 0; i < net->nodes; i++) {
            double force[3] = { 0 };
            for (size_t w = words_begin(net, i); w < words_end(net, i) && net->mass[i] > 0.0f; w += 16) {
                const uint32_t j = net->neighbours[w];
                double d[3], n[3], along = 0.0;
                for (size_t k = 0; k < 3; k++) {
                    n[k] = ((double)net->rest[3 * (size_t)j + k] - (double)net->rest[3 * (size_t)i + k]) /
                           (double)net->length[w];
                    d[k] = x[3 * (size_t)i + k] - x[3 * (size_t)j + k];
                    along += n[k] * d[k];
                }
                for (int k = 0; k < 3; k++)
                    force[k] +=
                        (double)net->stiffness[w] * (along * n[k] + (1.0 - 1.0 / longer) * (d[k] - along * n[k]));
            }
            for (size_t k = 0; k < 3; k++) {
                y[3 * (size_t)i + k] = net->mass[i] > 0.0f ? force[k] / (double)net->mass[i] : 0.0;
                size2 += y[3 * (size_t)i + k] * y[3 * (size_t)i + k];
            }
        }
        value = sqrt(size2);
        for (size_t i = 0; i < 3 * (size_t)net->nodes; i++)
            x[i] = y[i] / value;
    }
    free(x);
    return value;
}

static void the_stable_step_is_a_bound(void)
{
    dpt_spring_net_def sheet = def_of(DPT_NET_SHEET), volume = def_of(DPT_NET_VOLUME);
    const dpt_spring_region fixed = { .kind = DPT_REGION_SPHERE, .fixed = 1, .box = { 0.1, 0, 0, 0.04 } };
    const dpt_spring_net_def *defs[2] = { &sheet, &volume };
    sheet.regions = volume.regions = &fixed;
    sheet.region_count = volume.region_count = 1;
    volume.spacing = 0.02;
    for (int i = 0; i < 2; i++) {
        struct subject subject;
        if (!make_subject(&subject, "sphere", 320, defs[i]))
            continue;
        const double bound = 4.0 / (subject.info.stable_step * subject.info.stable_step);
        const double stretches[] = { 1.0, 1.5, 4.0, 1e9 };
        for (int k = 0; k < 4; k++) {
            const double value = largest_eigenvalue(&subject.net, stretches[k]);
            /* Without limits to stretch, a lattice comes near to what its cells say. */
            const double least = k == 3 && defs[i] == &volume ? 0.9 : 0.2;
            CHECK(value <= bound * (1.0 + 1e-5) && value > least * bound,
                  "%g s^-2 at %g times the length; the bound is %g", value, stretches[k], bound);
        }
        CHECK(subject.info.fixed_nodes > 0, "nothing is fixed");
        free(subject.file.bytes);
    }
}

/* The half at x < 0 is ten times as stiff, twice as heavy and damped; the end at x = 0.06 is fixed. */
static void regions_have_their_material(void)
{
    struct subject subject;
    const dpt_spring_region regions[] = {
        { DPT_REGION_BOX, 0, { -1, -1, -1, 1, 1, 1 }, 100.0, 10.0, 1.0 },
        { DPT_REGION_BOX, 0, { 0, -1, -1, 1, 1, 1 }, 5000.0, 1000.0, 0.0 },
        { DPT_REGION_BOX, 0, { -1, -1, -1, -1e-4, 1, 1 }, 50000.0, 2000.0, 3.0 },
        { DPT_REGION_BOX, 1, { 0.059, -1, -1, 1, 1, 1 }, 0.0, 0.0, 0.0 },
    };
    dpt_spring_net_def def = def_of(DPT_NET_VOLUME);
    const double volume = 0.12 * 0.10 * 0.08;
    def.spacing = 0.02;
    def.viscosity = 0.002;
    def.regions = regions;
    def.region_count = 4;
    if (!make_subject(&subject, "box", 12, &def))
        return;
    CHECK(fabs(subject.info.spring_mass / (1500.0 * volume) - 1.0) < 1e-6, "%.9g kg", subject.info.spring_mass);
    CHECK(subject.info.fixed_nodes == 30 && subject.net.viscosity == 0.002, "%u fixed", subject.info.fixed_nodes);
    for (uint32_t i = 0; i < subject.net.nodes; i++) {
        const float x = subject.net.rest[3 * (size_t)i];
        CHECK(subject.net.drag[i] == (x < -0.001f ? 3.0f : 0.0f), "drag %g at %g", (double)subject.net.drag[i],
              (double)x);
        CHECK((subject.net.mass[i] == 0.0f) == (x > 0.059f), "mass %g at %g", (double)subject.net.mass[i], (double)x);
    }
    for (int i = 0; i < 6; i++)
        expect_energy(&subject, strains[i], volume * continuum(11000.0, 11000.0, strains[i]), 1e-4);
    free(subject.file.bytes);
}

/* Two triangles with corners of their own, which meet in two places: fixing one of such a pair fixes both. */
static void vertices_are_fixed_by_number(void)
{
    const double loose[] = { 0, 0, 0, 0.1, 0, 0, 0, 0.1, 0, 0.1, 0, 0, 0.1, 0.1, 0, 0, 0.1, 0, 9, 9, 9 };
    const uint32_t corners[] = { 0, 1, 2, 3, 4, 5 }, fixed[] = { 3, 5 }, wrong[] = { 6, 7 };
    dpt_spring_net_def def = def_of(DPT_NET_SHEET);
    const dpt_compile_def compile = { .size = sizeof compile, .springs = &def };
    dpt_compiled compiled;
    dpt_diag diag = { .size = sizeof diag };
    struct subject subject;
    def.fixed = fixed;
    def.fixed_count = 2;
    CHECK(dpt_compile_arrays(loose, 7, corners, 2, &compile, &compiled, &diag) == DPT_OK, "%s", diag.text);
    if (open_subject(&subject, &compiled)) {
        CHECK(subject.info.fixed_nodes == 2 && subject.info.springs == 6, "%u fixed, %u springs",
              subject.info.fixed_nodes, subject.info.springs);
        for (uint32_t i = 0; i < subject.net.nodes; i++) {
            const float *x = subject.net.rest + 3 * (size_t)i;
            CHECK((subject.net.mass[i] == 0.0f) == (x[0] + x[1] > 0.09f && x[0] + x[1] < 0.11f), "vertex %u", i);
        }
        free(subject.file.bytes);
    }
    def.fixed_count = 1;
    def.fixed = wrong;
    CHECK(dpt_compile_arrays(loose, 7, corners, 2, &compile, &compiled, &diag) == DPT_E_ARGUMENT &&
              strstr(diag.text, "vertex 6"),
          "%s", diag.text);
    def.fixed = wrong + 1;
    CHECK(dpt_compile_arrays(loose, 7, corners, 2, &compile, &compiled, &diag) == DPT_E_INDEX &&
              strstr(diag.text, "vertex 7"),
          "%s", diag.text);
}

/* Organs of others fill as our own shapes do. Their unit is 1 mm. */
static void public_organs_are_filled(void)
{
    const char *const names[] = { "openhelp_liver", "openhelp_stomach", "gallbladder_fine" };
    for (int i = 0; i < 3; i++) {
        char path[1024];
        dpt_compiled compiled;
        struct subject subject;
        dpt_diag diag = { .size = sizeof diag };
        double volume, area;
        const dpt_spring_net_def def = def_of(DPT_NET_VOLUME);
        const dpt_compile_def compile = { .size = sizeof compile, .scale = 1e-3, .springs = &def };
        snprintf(path, sizeof path, "%s/meshes/organs/%s.stl", getenv("DPT_DATA"), names[i]);
        CHECK(dpt_compile_file(path, &compile, &compiled, &diag) == DPT_OK, "%s: %s", path, diag.text);
        if (!compiled.bytes || !open_subject(&subject, &compiled))
            continue;
        measure(subject.mesh, &volume, &area);
        const double error = sum_of_masses(&subject.net) / (1000.0 * volume) - 1.0;
        CHECK(fabs(error) < 0.02 && !subject.info.outside_vertices, "%s: %.3g of the mass off, %u vertices outside",
              names[i], error, subject.info.outside_vertices);
        expect_rows(&subject);
        free(subject.file.bytes);
    }
}

int main(void)
{
    TEST(sheets_have_the_papers_counts);
    TEST(a_grid_is_as_stiff_as_its_material);
    TEST(bending_springs_are_added);
    TEST(a_block_is_as_stiff_as_its_material);
    TEST(cells_have_the_ratio);
    TEST(slim_triangles_are_not_crossed);
    TEST(turns_cost_nothing);
    TEST(curved_bodies_are_filled);
    TEST(cavities_are_empty);
    TEST(vertices_follow_the_lattice);
    TEST(the_stable_step_is_a_bound);
    TEST(regions_have_their_material);
    TEST(vertices_are_fixed_by_number);
    if (getenv("DPT_DATA"))
        TEST(public_organs_are_filled);
    else
        SKIP("springs of public organs", "DPT_DATA is not set");
    return check_report();
}
