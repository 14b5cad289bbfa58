/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A block that is indented by a patch of 10 mm, against linear elasticity by finite elements (oracle/elastic.h).
 *
 *     test_springs_indent [all]   with finer lattices and elements, about a minute
 */
#include "deform/made_net.h"
#include "oracle/elastic.h"

#define HALF    0.03
#define DEPTH   0.03
#define PATCH   0.005
#define YOUNG   5000.0
#define POISSON 0.25

static int is_long;

static double stiffness_of(double patch, double cell, double poisson)
{
    const struct elastic_block block = { HALF, DEPTH, patch, cell, YOUNG, poisson, 0, 0 };
    return oracle_elastic_stiffness(&block);
}

/* Pushed and held all over, a block is as stiff as its sides let it: between none, and walls around it. */
static void the_oracle_is_right(void)
{
    const double cells[] = { 0.005, 0.0025, 0.00125, 0.000625 };
    const struct elastic_block column = { 0.01, 0.01, 0.01, 0.0025, YOUNG, 0.0, 0, 0 };
    /* Without Poisson's ratio a held face asks for nothing sideways: E A / depth, exactly. */
    const double uniform = oracle_elastic_stiffness(&column), area = 4.0 * 0.01 * 0.01;
    CHECK(fabs(uniform / (YOUNG * area / 0.01) - 1.0) < 1e-9, "%g N/m", uniform);
    /* A wide thin layer, 24 times as wide as deep, is nearly between walls. */
    const struct elastic_block layer = { 0.03, 0.0025, 0.03, 0.00125, YOUNG, POISSON, 0, 0 };
    const double walls = YOUNG * (1.0 - POISSON) / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));
    const double wide = oracle_elastic_stiffness(&layer) / (walls * 0.06 * 0.06 / 0.0025);
    CHECK(wide < 1.0 && wide > 0.97, "%g of a layer between walls", wide);
    double last = 0.0, step = 0.0;
    for (int i = 0; i < (is_long ? 4 : 3); i++) {
        const double stiffness = stiffness_of(PATCH, cells[i], POISSON);
        printf("    cells of %g mm: %.4f N/m\n", 1e3 * cells[i], stiffness);
        if (i > 1)
            CHECK((last - stiffness) / step > 0.35 && (last - stiffness) / step < 0.65, "falls by %g, then %g", step,
                  last - stiffness);
        step = last - stiffness;
        last = stiffness;
    }
}

/* N: on nodes that are held above a height; *rest: what is left on free ones, the largest. */
static double force_above(const struct made_net *net, const float *x, double height, double *rest)
{
    double *force = calloc(3 * (size_t)net->nodes, sizeof *force), sum = 0.0;
    net_forces(net, x, force);
    *rest = 0.0;
    for (uint32_t i = 0; i < net->nodes; i++) {
        const double *f = force + 3 * (size_t)i;
        if (net->mass[i] > 0.0f)
            *rest = fmax(*rest, sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]));
        else if ((double)net->rest[3 * (size_t)i + 2] > height)
            sum += f[2];
    }
    free(force);
    return sum;
}

static int is_patch(const struct made_net *net, uint32_t node, double cell)
{
    const float *at = net->rest + 3 * (size_t)node;
    return (double)at[2] > DEPTH - 0.1 * cell && fabs((double)at[0] - HALF) < PATCH + 0.1 * cell &&
           fabs((double)at[1] - HALF) < PATCH + 0.1 * cell;
}

/* N/m: of the lattice, indented by a share of its depth, little by little: a leap could turn cells inside out. */
static double lattice_stiffness(double cell, double share)
{
    const uint32_t across = (uint32_t)(2.0 * HALF / cell + 1.5);
    const uint32_t deep = (uint32_t)(DEPTH / cell + 1.5), parts = 40;
    struct made_net net = { 0 };
    dpt_springs_def def;
    dpt_springs_def_init(&def);
    def.integrator = DPT_INTEGRATOR_IMPLICIT;
    def.iterations = 16;
    def.sleep_speed = 0.0;
    net_block(&net, across, across, deep, cell, YOUNG, 1000.0);
    net_drag(&net, 60.0);
    for (uint32_t i = 0; i < net.nodes; i++)
        if (is_patch(&net, i, cell) || (double)net.rest[3 * i + 2] < 0.1 * cell)
            net_fix(&net, i);
    CHECK(net_open(&net, &def) == DPT_OK, "not made");
    for (uint32_t part = 1; part <= parts; part++) {
        for (uint32_t i = 0; i < net.nodes; i++) {
            const float *rest = net.rest + 3 * (size_t)i;
            const float at[3] = { rest[0], rest[1], rest[2] - (float)(share * DEPTH * part / parts) };
            if (is_patch(&net, i, cell))
                CHECK(dpt_springs_set_nodes(net.made, i, 1, at, NULL) == DPT_OK, "not pushed");
        }
        net_steps(&net, 2e-3, part < parts ? 4 : 250);
    }
    double left;
    const double force = force_above(&net, net_positions(&net), 0.5 * DEPTH, &left);
    CHECK(left < 1e-3 * force, "%g N are not in balance, of %g", left, force);
    net_close(&net);
    return force / (share * DEPTH);
}

/*
 * A patch that is held at nodes acts as if it were a part of a cell wider, in cubes of elements as well. So a lattice is
 * compared with elements of its own size while strains are small, and with the limit of fine ones at 5 %. There springs
 * give way by a tenth, as strains under the patch are 15 %.
 */
static void an_indented_block_pushes_back(void)
{
    const double cells[] = { 0.005, 0.0025, 0.00125 };
    const double finest = is_long ? 0.000625 : 0.00125;
    double limit[2];
    for (int i = 0; i < 2; i++) {
        const double poisson = i ? 0.45 : POISSON;
        limit[i] = 2.0 * stiffness_of(PATCH, finest, poisson) - stiffness_of(PATCH, 2.0 * finest, poisson);
    }
    printf("    elements: %.2f N/m with 1/4, %.2f with 0.45\n", limit[0], limit[1]);
    for (int i = 0; i < (is_long ? 3 : 2); i++) {
        const double alike = stiffness_of(PATCH, cells[i], POISSON);
        const double small = lattice_stiffness(cells[i], 0.005);
        const double large = lattice_stiffness(cells[i], 0.05);
        printf("    lattice of %g mm: in by 0.5 %% %.2f N/m, off by %+.1f %% from elements of its size, "
               "%+.1f %% from their limit; in by 5 %% %.2f N/m, %+.1f %%, and %+.1f %% from 0.45\n",
               1e3 * cells[i], small, 100.0 * (small / alike - 1.0), 100.0 * (small / limit[0] - 1.0), large,
               100.0 * (large / limit[0] - 1.0), 100.0 * (large / limit[1] - 1.0));
        CHECK(fabs(small / alike - 1.0) < 0.065 * cells[i] / cells[0], "%g, elements %g", small, alike);
        if (i)
            CHECK(fabs(large / limit[0] - 1.0) < 0.1, "%g, elements %g", large, limit[0]);
    }
}

int main(int argc, char **argv)
{
    is_long = argc > 1 && !strcmp(argv[1], "all");
    TEST(the_oracle_is_right);
    TEST(an_indented_block_pushes_back);
    return check_report();
}
