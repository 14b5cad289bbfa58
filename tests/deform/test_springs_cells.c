/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The terms of cells' volumes: their force is the gradient of the energy that made_net.c writes down on its own, none is
 * stiffer than the stable step and IMPLICIT take it to be, and cells that were turned inside out come back.
 *
 *     test_springs_cells [leaps]   as many random leaps, 1,000 by default
 */
#include "deform/cell_volume.h"
#include "deform/made_net.h"
#include "lib/rig.h"

#define SIZE 0.01

static const double ratios[] = { 0.1, 0.3, 0.4, 0.45 };
enum { RATIOS = sizeof ratios / sizeof *ratios };

static int leaps = 1000;
static uint64_t seed = 1;

/* -1 to 1. */
static double chance(void)
{
    seed = 6364136223846793005u * seed + 1442695040888963407u;
    return (double)(seed >> 11) / 4503599627370496.0 - 1.0;
}

/* A free block of nx x ny x nz nodes, or with its lowest layer fixed. */
static void open_block(struct made_net *net, uint32_t n, double poisson, const dpt_springs_def *def, int is_fixed)
{
    *net = (struct made_net){ .poisson = poisson, .viscosity = net->viscosity };
    net_block(net, n, n, n, SIZE, 5000.0, 1000.0);
    for (uint32_t i = 0; is_fixed && i < n * n; i++)
        net_fix(net, i);
    CHECK(net_open(net, def) == DPT_OK, "not made");
}

/* Throw all nodes about by up to so many cells each way. */
static void scatter(struct made_net *net, double cells)
{
    float *x = malloc(3 * (size_t)net->nodes * sizeof *x);
    for (uint32_t i = 0; i < 3 * net->nodes; i++)
        x[i] = net->mass[i / 3] > 0.0f ? (float)((double)net->rest[i] + cells * SIZE * chance()) : net->rest[i];
    CHECK(dpt_springs_set_nodes(net->made, 0, net->nodes, x, NULL) == DPT_OK, "not put");
    free(x);
}

/* What the library's cells pull at a node where it is now. */
static void pull_at(const struct made_net *net, float *force, double *energy)
{
    dpt_springs *springs = net->made;
    const float *points = springs->points[springs->at];
    double lanes[LANES] = { 0.0 };
    dpti_cells_pull(springs, points);
    memset(force, 0, net->rows.slices * SPRING_ROWS * sizeof *force);
    for (uint32_t slice = 0; slice < net->rows.slices; slice++)
        dpti_cells_add(springs, slice, force + SPRING_ROWS * (size_t)slice);
    for (uint32_t slice = 0; slice < net->rows.cell_slices; slice++)
        springs->kernel.cell_energy(&springs->volumes.cells, slice, points,
                                    springs->volumes.pulls + CELL_PULLS * (size_t)slice, lanes);
    *energy = spring_sum(lanes);
}

static void the_force_is_the_gradient(void)
{
    const double far[] = { 1e-3, 0.1, 0.3, 0.6, 1.0, 3.0 };
    for (int r = 0; r < RATIOS; r++)
        for (size_t i = 0; i < sizeof far / sizeof *far; i++) {
            struct made_net net = { 0 };
            dpt_springs_def def;
            dpt_springs_def_init(&def);
            open_block(&net, 4, ratios[r], &def, 0);
            float *force = malloc(net.rows.slices * SPRING_ROWS * sizeof *force);
            double *truth = calloc(3 * (size_t)net.nodes, sizeof *truth), energy, most = 0.0, off = 0.0;
            double sum = 0.0, told = 0.0;
            scatter(&net, far[i]);
            pull_at(&net, force, &energy);
            const uint32_t springs = net.springs;
            net.springs = 0;
            net_forces(&net, net_positions(&net), truth);
            net.springs = springs;
            for (uint32_t k = 0; k < 3 * net.nodes; k++) {
                const uint32_t node = k / 3;
                const double is = (double)force[SPRING_ROWS * (node / LANES) + LANES * (k % 3) + node % LANES];
                most = fmax(most, fabs(truth[k]));
                off = fmax(off, fabs(is - truth[k]));
            }
            const float *x = net_positions(&net);
            for (uint32_t c = 0; c < net.cells; c++) {
                double at[24];
                for (int k = 0; k < 24; k++)
                    at[k] = (double)x[3 * net.corners[c][k / 3] + (uint32_t)k % 3];
                sum += net_cell_energy(&net, c, at);
            }
            for (uint32_t slice = 0; slice < net.rows.cell_slices; slice++)
                told += dpti_cells_elastic(net.made, slice);
            CHECK(off < (far[i] < 0.01 ? 1e-2 : 1e-4) * most, "%g, %g cells: off by %g of %g N", ratios[r], far[i], off,
                  most);
            CHECK(fabs(told - sum) < 1e-4 * fabs(sum) && fabs(energy - sum) < 1e-3 * fabs(sum),
                  "%g, %g cells: %g J and %g J, %g", ratios[r], far[i], told, energy, sum);
            free(force);
            free(truth);
            net_close(&net);
        }
}

/* A cell that is stretched and pressed along random axes, and bent by a little. */
static void deform_cell(double x[24])
{
    double f[9], push[3];
    const double bend = 0.1 * (chance() + 1.0);
    for (int k = 0; k < 9; k++)
        f[k] = chance();
    for (int k = 0; k < 3; k++)
        push[k] = exp(1.5 * chance()) * (chance() < -0.9 ? 0.01 : 1.0);
    /* Gram and Schmidt: a frame, and its axes by so much each. */
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < a; b++) {
            const double along = f[3 * a] * f[3 * b] + f[3 * a + 1] * f[3 * b + 1] + f[3 * a + 2] * f[3 * b + 2];
            for (int k = 0; k < 3; k++)
                f[3 * a + k] -= along * f[3 * b + k];
        }
        const double size = sqrt(f[3 * a] * f[3 * a] + f[3 * a + 1] * f[3 * a + 1] + f[3 * a + 2] * f[3 * a + 2]);
        for (int k = 0; k < 3; k++)
            f[3 * a + k] /= size;
    }
    for (int c = 0; c < 8; c++)
        for (int k = 0; k < 3; k++) {
            x[3 * c + k] = bend * SIZE * chance();
            for (int a = 0; a < 3; a++)
                x[3 * c + k] += (c >> a & 1) * SIZE * push[a] * f[3 * a + k];
        }
}

/* The second difference of a cell's energy along u, by what springs along the diagonals of its faces would have. */
static double stiffness_along(const struct made_net *net, const double x[24], const double u[24])
{
    const double by = 1e-4 * SIZE, weight = net->cell_stiffness[0] * cell_bound(net->poisson);
    double more[24], less[24], bound = 0.0;
    for (int k = 0; k < 24; k++) {
        more[k] = x[k] + by * u[k];
        less[k] = x[k] - by * u[k];
    }
    for (int a = 0; a < 8; a++)
        for (int b = a + 1; b < 8; b++)
            for (int k = 0; k < 3 && __builtin_popcount((unsigned)(a ^ b)) == 2; k++)
                bound += weight * (u[3 * a + k] - u[3 * b + k]) * (u[3 * a + k] - u[3 * b + k]);
    const double curve =
        net_cell_energy(net, 0, more) - 2.0 * net_cell_energy(net, 0, x) + net_cell_energy(net, 0, less);
    return curve / (by * by * bound);
}

static void nothing_is_stiffer_than_its_bound(void)
{
    for (int r = 0; r < RATIOS; r++) {
        struct made_net net = { 0 };
        dpt_springs_def def;
        double most = 0.0;
        dpt_springs_def_init(&def);
        open_block(&net, 2, ratios[r], &def, 0);
        for (int n = 0; n < 5000; n++) {
            double x[24], u[24], at[24];
            deform_cell(x);
            memcpy(at, x, sizeof at);
            /* Along the gradient it is the stiffest, or nearly. */
            for (int k = 0; k < 24; k++) {
                at[k] = x[k] + 1e-5 * SIZE;
                u[k] = net_cell_energy(&net, 0, at);
                at[k] = x[k] - 1e-5 * SIZE;
                u[k] -= net_cell_energy(&net, 0, at);
                at[k] = x[k];
            }
            double size = 0.0;
            for (int k = 0; k < 24; k++)
                size += u[k] * u[k];
            for (int k = 0; k < 24; k++)
                u[k] = (size > 0.0 ? u[k] / sqrt(size) : 0.0) + (n % 2 ? 0.0 : chance());
            most = fmax(most, stiffness_along(&net, x, u));
        }
        printf("    %g: at most %.3f of the bound\n", ratios[r], most);
        CHECK(most < 1.0 && most > 0.8, "%g: %g of the bound", ratios[r], most);
        net_close(&net);
    }
}

static uint32_t turned_cells(const struct made_net *net)
{
    const float *x = net_positions(net);
    uint32_t count = 0;
    for (uint32_t c = 0; c < net->cells; c++)
        count += (uint32_t)net_cell_is_turned(net, c, x);
    return count;
}

/* A node leaps by up to three cells each way. */
static void leap(struct made_net *net)
{
    const uint32_t node = (uint32_t)((chance() + 1.0) * 0.5 * net->nodes) % net->nodes;
    float at[3];
    for (uint32_t k = 0; k < 3; k++)
        at[k] = net->rest[3 * node + k] + (float)(3.0 * SIZE * chance());
    CHECK(dpt_springs_set_nodes(net->made, node, 1, at, NULL) == DPT_OK, "not put");
}

/* Two random nodes of a block leap, or every tenth time all of them by up to a cell. */
static void cells_turn_back(void)
{
    uint32_t turned = 0, left = 0, blocks = 0;
    seed = 1;
    for (int method = 0; method < 2; method++)
        for (int r = 0; r < RATIOS; r++) {
            struct made_net net = { .viscosity = 1e-3 };
            dpt_springs_def def;
            dpt_springs_def_init(&def);
            def.integrator = method ? DPT_INTEGRATOR_IMPLICIT : DPT_INTEGRATOR_SYMPLECTIC;
            def.sleep_steps = 16;
            open_block(&net, 4, ratios[r], &def, 0);
            for (int n = 0; n < leaps / (4 * RATIOS); n++, blocks++) {
                net_reopen(&net, &def);
                if (n % 10 == 0)
                    scatter(&net, 1.0);
                for (int k = 0; k < 2 && n % 10; k++)
                    leap(&net);
                turned += turned_cells(&net) > 0;
                net_steps(&net, 2e-3, 500);
                left += turned_cells(&net);
            }
            net_close(&net);
        }
    printf("    %u blocks, %u of them turned inside out somewhere; after a second %u cells are\n", blocks, turned,
           left);
    CHECK(turned > blocks / 2 && left == 0, "%u of %u turned, %u cells are", turned, blocks, left);
}

static void energies(const struct made_net *net, double *all)
{
    double elastic, kinetic;
    CHECK(dpt_springs_get_energy(net->made, &elastic, &kinetic) == DPT_OK, "no energy");
    *all = elastic + kinetic;
}

/* kg m/s and kg m2/s. */
static void momenta(const struct made_net *net, double p[3], double l[3])
{
    const float *x = net_positions(net), *v;
    float *at = malloc(3 * (size_t)net->nodes * sizeof *at);
    memcpy(at, x, 3 * (size_t)net->nodes * sizeof *at);
    v = net_speeds(net);
    for (int k = 0; k < 3; k++)
        p[k] = l[k] = 0.0;
    for (uint32_t i = 0; i < net->nodes; i++)
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t a = (k + 1) % 3, b = (k + 2) % 3;
            p[k] += (double)net->mass[i] * (double)v[3 * i + k];
            l[k] += (double)net->mass[i] *
                    ((double)at[3 * i + a] * (double)v[3 * i + b] - (double)at[3 * i + b] * (double)v[3 * i + a]);
        }
    free(at);
}

/* A free block that is hurled, turned and thrown about swings on without gain, and keeps both momenta. */
static void a_free_block_swings(void)
{
    seed = 1;
    for (int r = 0; r < RATIOS; r++) {
        struct made_net net = { 0 };
        dpt_springs_def def;
        double first, before, p[2][3], l[2][3], size = 0.0, turn = 0.0, off = 0.0, turned = 0.0;
        dpt_springs_def_init(&def);
        def.sleep_speed = 0.0;
        open_block(&net, 5, ratios[r], &def, 0);
        float *v = calloc(3 * (size_t)net.nodes, sizeof *v), *x = calloc(3 * (size_t)net.nodes, sizeof *x);
        for (uint32_t i = 0; i < net.nodes; i++) {
            const float *at = net.rest + 3 * (size_t)i;
            v[3 * i] = 0.1f - 5.0f * at[1];
            v[3 * i + 1] = 5.0f * at[0];
            for (uint32_t k = 0; k < 3; k++)
                x[3 * i + k] = at[k] + (float)(0.1 * SIZE * chance());
        }
        CHECK(dpt_springs_set_nodes(net.made, 0, net.nodes, x, v) == DPT_OK, "not put");
        energies(&net, &first);
        momenta(&net, p[0], l[0]);
        const double step = 0.1 * dpt_springs_get_stable_step(net.made);
        double most = first;
        for (int n = 0; n < 2000; n++) {
            net_steps(&net, step, 1);
            if (n % 50 == 49) {
                energies(&net, &before);
                most = fmax(most, before);
            }
        }
        momenta(&net, p[1], l[1]);
        for (int k = 0; k < 3; k++) {
            size = fmax(size, fabs(p[0][k]));
            turn = fmax(turn, fabs(l[0][k]));
            off = fmax(off, fabs(p[1][k] - p[0][k]));
            turned = fmax(turned, fabs(l[1][k] - l[0][k]));
        }
        printf("    %g: energy at most %.3f of the first, momentum off by %.1e, its moment by %.1e\n", ratios[r],
               most / first, off / size, turned / turn);
        CHECK(most < 1.4 * first, "%g: %g J of %g", ratios[r], most, first);
        CHECK(off < 1e-5 * size && turned < 2e-4 * turn, "%g: momentum off by %g of %g, moment by %g of %g", ratios[r],
              off, size, turned, turn);
        free(v);
        free(x);
        net_close(&net);
    }
}

/* IMPLICIT gains nothing from any start, however stiff; EULER with viscosity does not explode. */
static void no_integrator_gains(void)
{
    for (int r = 0; r < RATIOS; r++)
        for (int method = DPT_INTEGRATOR_SYMPLECTIC; method <= DPT_INTEGRATOR_IMPLICIT; method++)
            for (int stiff = 0; stiff < 3; stiff++) {
                struct made_net net = { .viscosity = method == DPT_INTEGRATOR_EULER ? 2e-3 : 0.0 };
                dpt_springs_def def;
                double first, all, most = 0.0;
                dpt_springs_def_init(&def);
                def.integrator = (uint32_t)method;
                def.stiffness = stiff == 0 ? 1.0 : stiff == 1 ? 100.0 : 1e4;
                def.sleep_speed = 0.0;
                open_block(&net, 4, ratios[r], &def, 1);
                const double step =
                    method == DPT_INTEGRATOR_IMPLICIT ? 2e-3 : 0.9 * dpt_springs_get_stable_step(net.made);
                scatter(&net, 0.3);
                energies(&net, &first);
                for (int n = 0; n < 200; n++) {
                    net_steps(&net, step, 1);
                    energies(&net, &all);
                    most = fmax(most, all);
                }
                CHECK(most < (method == DPT_INTEGRATOR_IMPLICIT ? 1.0001 : 1.4) * first,
                      "%g, integrator %d, k x %g: %g J of %g", ratios[r], method, def.stiffness, most, first);
                net_close(&net);
            }
}

/* The same bits with every kernel. */
static void kernels_agree(void)
{
    static const uint32_t kernels[] = { DPT_KERNEL_SCALAR, DPT_KERNEL_SSE2, DPT_KERNEL_AVX2,
                                        DPT_KERNEL_AVX512, DPT_KERNEL_NEON, DPT_KERNEL_WASM128 };
    for (uint32_t method = 0; method < 2; method++) {
        float *first = NULL;
        for (size_t i = 0; i < sizeof kernels / sizeof *kernels; i++) {
            struct made_net net = { .viscosity = 1e-3 };
            dpt_springs_def def;
            dpt_springs_def_init(&def);
            def.integrator = method ? DPT_INTEGRATOR_IMPLICIT : DPT_INTEGRATOR_SYMPLECTIC;
            def.kernel = kernels[i];
            if (!rig_has_kernel(kernels[i]))
                continue;
            seed = 7;
            open_block(&net, 5, 0.45, &def, 1);
            scatter(&net, 1.0);
            net_steps(&net, 1e-3, 100);
            const float *x = net_positions(&net);
            const size_t bytes = 3 * (size_t)net.nodes * sizeof *x;
            if (first)
                CHECK(!memcmp(first, x, bytes), "kernel %u has other bits", kernels[i]);
            else
                memcpy(first = malloc(bytes), x, bytes);
            net_close(&net);
        }
        free(first);
    }
}

/* Where a part of a block sleeps, what is awake feels all of its cells. */
static void sleep_leaves_nothing_out(void)
{
    for (uint32_t method = 0; method < 2; method++) {
        struct made_net net = { .viscosity = 1e-3 };
        dpt_springs_def def;
        uint32_t partly = 0;
        dpt_springs_def_init(&def);
        def.integrator = method ? DPT_INTEGRATOR_IMPLICIT : DPT_INTEGRATOR_SYMPLECTIC;
        open_block(&net, 9, 0.45, &def, 1);
        const dpt_load load = { .vertex = net.nodes - 1, .force = { 0.0, 0.0, -2e-3 } };
        for (int n = 0; n < 600; n++) {
            const dpt_springs *springs = net.made;
            CHECK(dpt_springs_step(net.made, 1e-3, &load, n % 200 < 100 ? 1 : 0, NULL) == DPT_OK, "step %d", n);
            if (!springs->region.count || springs->region.count == net.rows.slices)
                continue;
            partly += springs->volumes.count < net.rows.cell_slices;
            uint32_t listed = 0;
            for (uint32_t c = 0; c < LANES * net.rows.cell_slices; c++) {
                int is_awake = 0;
                for (int k = 0; k < 8 && c < net.cells; k++)
                    is_awake |= springs->region.is_awake[net.corners[c][k] / LANES];
                for (listed = 0; listed < springs->volumes.count && springs->volumes.active[listed] != c / LANES;)
                    listed++;
                CHECK(!is_awake || listed < springs->volumes.count, "cell %u is left out", c);
            }
        }
        CHECK(partly > 20, "only %u steps had slices of cells that sleep", partly);
        net_close(&net);
    }
}

int main(int argc, char **argv)
{
    if (argc > 1)
        leaps = atoi(argv[1]);
    TEST(the_force_is_the_gradient);
    TEST(nothing_is_stiffer_than_its_bound);
    TEST(cells_turn_back);
    TEST(a_free_block_swings);
    TEST(no_integrator_gains);
    TEST(kernels_agree);
    TEST(sleep_leaves_nothing_out);
    return check_report();
}
