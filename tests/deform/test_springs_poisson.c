/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Volumes of another Poisson's ratio than springs have, against linear elasticity by finite elements (oracle/elastic.h): a
 * block that is indented by a patch of 10 mm, and one that is pressed between plates. What is left of its volume when a fifth
 * of its length is pressed away: against a Neo-Hookean solid (oracle/neo_hookean.h).
 *
 *     test_springs_poisson [all]   with finer lattices, about two minutes
 */
#include "deform/made_net.h"
#include "oracle/elastic.h"
#include "oracle/neo_hookean.h"

#define YOUNG 5000.0

static int is_long;

/* A block of 2 half x 2 half x depth whose lower face is held, and a patch of 2 patch x 2 patch of its upper one. */
struct pressed {
    struct made_net net;
    struct elastic_block block;
};

static int is_patch(const struct pressed *of, uint32_t node)
{
    const float *at = of->net.rest + 3 * (size_t)node;
    const double half = of->block.half, reach = of->block.patch + 0.1 * of->block.cell;
    return (double)at[2] > of->block.depth - 0.1 * of->block.cell && fabs((double)at[0] - half) < reach &&
           fabs((double)at[1] - half) < reach;
}

/* Press it in by a share of its depth, little by little, and wait until it rests. */
static void press(struct pressed *of, const struct elastic_block *block, double share)
{
    const double cell = block->cell;
    const uint32_t across = (uint32_t)(2.0 * block->half / cell + 1.5), deep = (uint32_t)(block->depth / cell + 1.5);
    const uint32_t parts = share > 0.02 ? 20 : 2;
    dpt_springs_def def;
    *of = (struct pressed){ .block = *block };
    struct made_net *net = &of->net;
    dpt_springs_def_init(&def);
    def.integrator = DPT_INTEGRATOR_IMPLICIT;
    def.iterations = 16;
    def.sleep_speed = 0.0;
    net->poisson = block->poisson;
    net_block(net, across, across, deep, cell, YOUNG, 1000.0);
    net_drag(net, 60.0);
    for (uint32_t i = 0; i < net->nodes; i++)
        if (is_patch(of, i) || (double)net->rest[3 * i + 2] < 0.1 * cell)
            net_fix(net, i);
    CHECK(net_open(net, &def) == DPT_OK, "not made");
    for (uint32_t part = 1; part <= parts; part++) {
        for (uint32_t i = 0; i < net->nodes; i++) {
            const float *rest = net->rest + 3 * (size_t)i;
            const float at[3] = { rest[0], rest[1], rest[2] - (float)(share * block->depth * part / parts) };
            if (is_patch(of, i))
                CHECK(dpt_springs_set_nodes(net->made, i, 1, at, NULL) == DPT_OK, "not pushed");
        }
        net_steps(net, 5e-3, part < parts ? 4 : 80);
    }
}

/* N/m: on the patch. Free nodes are in balance. */
static double stiffness_of(const struct pressed *of, double share)
{
    const struct made_net *net = &of->net;
    double *force = calloc(3 * (size_t)net->nodes, sizeof *force), sum = 0.0, rest = 0.0;
    net_forces(net, net_positions(net), force);
    for (uint32_t i = 0; i < net->nodes; i++) {
        const double *f = force + 3 * (size_t)i;
        if (net->mass[i] > 0.0f)
            rest = fmax(rest, sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]));
        else if (is_patch(of, i))
            sum += f[2];
    }
    free(force);
    CHECK(rest < 2e-3 * sum, "%g N are not in balance, of %g", rest, sum);
    return sum / (share * of->block.depth);
}

/* Pushed between plates that let it slide, a block of any ratio has E A / depth, and bulges by that ratio, exactly. */
static void the_oracle_is_right(void)
{
    const double ratios[] = { 0.1, 0.3, 0.45 };
    for (int i = 0; i < 3; i++) {
        const struct elastic_block column = { 0.01, 0.02, 0.01, 0.005, YOUNG, ratios[i], 1, 1 };
        const double stiffness = oracle_elastic_stiffness(&column), bulge = oracle_elastic_bulge(&column);
        CHECK(fabs(stiffness * 0.02 / (YOUNG * 0.02 * 0.02) - 1.0) < 1e-9, "%g: %g N/m", ratios[i], stiffness);
        CHECK(fabs(bulge * 0.02 / (0.01 * ratios[i]) - 1.0) < 1e-9, "%g bulges by %g", ratios[i], bulge);
        CHECK(fabs(oracle_elastic_loss(&column) - (1.0 - 2.0 * ratios[i])) < 1e-9, "%g: it loses %g", ratios[i],
              oracle_elastic_loss(&column));
    }
    /* Where nothing locks, elements of both kinds have one limit, and means come from nearer to it. */
    struct elastic_block indented = { 0.03, 0.03, 0.005, 0.005, YOUNG, 0.45, 0, 0 };
    double force[2][2];
    for (int mean = 0; mean < 2; mean++)
        for (int finer = 0; finer < 2; finer++) {
            indented.is_mean = mean;
            indented.cell = 0.005 / (1 << (finer + is_long));
            force[mean][finer] = oracle_elastic_stiffness(&indented);
        }
    const double limit[2] = { 2.0 * force[0][1] - force[0][0], 2.0 * force[1][1] - force[1][0] };
    printf("    0.45, full: %.1f %.1f -> %.1f N/m; mean: %.1f %.1f -> %.1f\n", force[0][0], force[0][1], limit[0],
           force[1][0], force[1][1], limit[1]);
    CHECK(fabs(limit[0] / limit[1] - 1.0) < 0.02, "limits %g and %g", limit[0], limit[1]);
}

static void an_indented_block_pushes_back(void)
{
    const double ratios[] = { 0.1, 0.3, 0.45 }, cells[] = { 0.005, 0.0025, 0.00125 };
    for (int i = is_long ? 0 : 1; i < 3; i++) {
        double error[3];
        for (int k = 0; k < (is_long ? 3 : 2); k++) {
            const struct elastic_block block = { 0.03, 0.03, 0.005, cells[k], YOUNG, ratios[i], 1, 0 };
            struct pressed pressed;
            press(&pressed, &block, 0.005);
            const double stiffness = stiffness_of(&pressed, 0.005), alike = oracle_elastic_stiffness(&block);
            error[k] = stiffness / alike - 1.0;
            printf("    %g, cells of %g mm: %.2f N/m, elements as large %.2f: %+.1f %%\n", ratios[i], 1e3 * cells[k],
                   stiffness, alike, 100.0 * error[k]);
            net_close(&pressed.net);
        }
        CHECK(fabs(error[1]) < 0.1 && fabs(error[1]) < 0.7 * fabs(error[0]), "%g: off by %g, then %g", ratios[i],
              error[0], error[1]);
    }
}

/* Between plates that hold it, by 1 %. */
static void a_pressed_block_bulges(void)
{
    const double ratios[] = { 0.1, 0.3, 0.45 };
    for (int i = 0; i < 3; i++) {
        const struct elastic_block block = { 0.02, 0.04, 0.02, 0.005, YOUNG, ratios[i], 1, 0 };
        const struct elastic_block fine = { 0.02, 0.04, 0.02, 0.0025, YOUNG, ratios[i], 1, 0 };
        struct pressed pressed;
        press(&pressed, &block, 0.01);
        const struct made_net *net = &pressed.net;
        const float *x = net_positions(net);
        double out = 0.0;
        for (uint32_t n = 0; n < net->nodes; n++) {
            const float *at = net->rest + 3 * (size_t)n;
            if (fabs((double)at[0] - 0.04) < 1e-4 && fabs((double)at[1] - 0.02) < 1e-4 &&
                fabs((double)at[2] - 0.02) < 1e-4)
                out = (double)x[3 * (size_t)n] - (double)at[0];
        }
        const double bulge = out / (0.01 * 0.04), is = oracle_elastic_bulge(&fine);
        const double stiffness = stiffness_of(&pressed, 0.01), should_be = oracle_elastic_stiffness(&fine);
        printf("    %g: bulges by %.4f of the way, elements %.4f: %+.1f %%; %.1f N/m, %+.1f %%\n", ratios[i], bulge, is,
               100.0 * (bulge / is - 1.0), stiffness, 100.0 * (stiffness / should_be - 1.0));
        CHECK(fabs(bulge / is - 1.0) < 0.05, "%g: bulges by %g, elements %g", ratios[i], bulge, is);
        CHECK(fabs(stiffness / should_be - 1.0) < 0.05, "%g: %g N/m, elements %g", ratios[i], stiffness, should_be);
        net_close(&pressed.net);
    }
}

/*
 * Push both ends of a free block together evenly, so that its sides are free and it is pressed alike all over. For so long
 * it comes to rest, and does not turn over yet.
 */
static void push(struct made_net *net, uint32_t across, double force)
{
    dpt_load *loads = calloc(net->nodes, sizeof *loads);
    const uint32_t deep = net->nodes / (across * across);
    uint32_t count = 0;
    for (uint32_t i = 0; i < net->nodes; i++) {
        const uint32_t x = i % across, y = i / across % across, z = i / (across * across);
        const double share = (x && x < across - 1 ? 1.0 : 0.5) * (y && y < across - 1 ? 1.0 : 0.5);
        if (z == 0 || z == deep - 1)
            loads[count++] = (dpt_load){ .vertex = i, .force = { 0.0, 0.0, (z ? -1.0 : 1.0) * share * force } };
    }
    for (int step = 0; step < 100; step++)
        CHECK(dpt_springs_step(net->made, 2e-3, loads, count, NULL) == DPT_OK, "step %d", step);
    free(loads);
}

/*
 * Pressed together by a fifth with free sides, a block of 0.45 keeps its volume within 3 %, all of it alike, and as much as a
 * Neo-Hookean solid does. Linear strains taken at their word, sides that grow by 0.45 of a fifth, leave 95.0 %.
 */
static void volume_is_kept(void)
{
    const double cell = 0.005;
    struct made_net net = { .poisson = 0.45 };
    dpt_springs_def def;
    dpt_springs_def_init(&def);
    def.integrator = DPT_INTEGRATOR_IMPLICIT;
    def.iterations = 16;
    def.sleep_speed = 0.0;
    net_block(&net, 7, 7, 9, cell, YOUNG, 1000.0);
    net_drag(&net, 175.0);
    CHECK(net_open(&net, &def) == DPT_OK, "not made");
    push(&net, 7, 0.6283 * YOUNG / 2.9 * cell * cell);
    const float *x = net_positions(&net);
    double volume = 0.0, low = 1.0, high = 0.0;
    for (uint32_t c = 0; c < net.cells; c++) {
        const double kept = net_cell_volume(&net, c, x) / (cell * cell * cell);
        volume += kept / net.cells;
        low = fmin(low, kept);
        high = fmax(high, kept);
    }
    const double shorter = 1.0 - (double)(x[3 * (net.nodes - 1) + 2] - x[2]) / (8.0 * cell);
    printf("    shorter by %.3f: %.2f %% of the volume, cells %.2f to %.2f\n", shorter, 100.0 * volume, 100.0 * low,
           100.0 * high);
    CHECK(fabs(shorter - 0.2) < 0.002, "shorter by %g", shorter);
    CHECK(volume > 0.97 && volume < 1.0 && high - low < 1e-3, "%g of the volume, %g to %g", volume, low, high);
    const double solid = oracle_neo_hookean_free(0.45, 1.0 - shorter);
    printf("    Neo-Hookean %.2f %%\n", 100.0 * solid);
    CHECK(fabs(volume - solid) < 5e-3, "%g of the volume, a Neo-Hookean solid %g", volume, solid);
    net_close(&net);
}

static double volume_left(const struct made_net *net, double cell)
{
    double sum = 0.0;
    for (uint32_t c = 0; c < net->cells; c++)
        sum += net_cell_volume(net, c, net_positions(net)) / (cell * cell * cell * net->cells);
    return sum;
}

/*
 * Between plates that hold it a block loses more, as its pressure is higher there: where strains are small as much as linear
 * elasticity says, and pressed by a fifth as much as a Neo-Hookean solid, of which 96.2 % is left at 0.45. None keeps 97.
 */
static void plates_take_volume(void)
{
    const double ratios[] = { 0.3, 0.45 };
    CHECK(fabs(oracle_neo_hookean_held(0.0, 0.8, 8) - 0.8) < 1e-9, "0 of Poisson's ratio has no way out");
    for (int i = 0; i < 2; i++) {
        const struct elastic_block block = { 0.02, 0.04, 0.02, 0.005, YOUNG, ratios[i], 1, 0 };
        const double loss = oracle_elastic_loss(&block), small = 1.0 - oracle_neo_hookean_held(ratios[i], 0.999, 8);
        CHECK(fabs(small / (0.001 * loss) - 1.0) < 0.01, "%g: the oracles lose %g and %g", ratios[i], small,
              0.001 * loss);
        for (int is_large = 0; is_large < 2; is_large++) {
            struct pressed pressed;
            const double share = is_large ? 0.2 : 0.01;
            const double solid = 1.0 - oracle_neo_hookean_held(ratios[i], 1.0 - share, 8);
            press(&pressed, &block, share);
            const double lost = 1.0 - volume_left(&pressed.net, block.cell);
            printf("    %g, between plates, by %g: %.2f %% left, Neo-Hookean %.2f %%, linear %.2f %%\n", ratios[i],
                   share, 100.0 * (1.0 - lost), 100.0 * (1.0 - solid), 100.0 * (1.0 - share * loss));
            CHECK(fabs(lost / solid - 1.0) < 0.08, "%g, by %g: %g lost, a Neo-Hookean solid %g", ratios[i], share, lost,
                  solid);
            net_close(&pressed.net);
        }
    }
}

int main(int argc, char **argv)
{
    is_long = argc > 1 && !strcmp(argv[1], "all");
    TEST(the_oracle_is_right);
    TEST(an_indented_block_pushes_back);
    TEST(a_pressed_block_bulges);
    TEST(volume_is_kept);
    TEST(plates_take_volume);
    return check_report();
}
