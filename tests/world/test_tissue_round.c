/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Round tools on a block of springs: what they feel, by how many cells of the lattice are as wide as the patch that they
 * touch, against linear elasticity of the same block (oracle/elastic.h).
 *
 *     test_tissue_round [all]   with sixteen cells and finer elements, about half a minute
 */
#include <math.h>
#include <stdlib.h>

#include "oracle/elastic.h"
#include "world/tissue_rig.h"

#define CELL    0.004
#define YOUNG   5000.0
#define POISSON 0.25

/* By half the width of the patch: the tool's radius, how deep it is, the block's half width and depth. */
#define SHARP 10.0
#define SIZE  3.0

static int is_all;

/* A grid on the faces of a box, whose upper one is at z = 0: in cells of `edge`, cut in two by turns. */
struct grid {
    size_t size[3], vertex_count, triangles;
    double *vertices;
    uint32_t *corners, *numbers;
};

static uint32_t *number_at(const struct grid *grid, const size_t at[3])
{
    return &grid->numbers[at[0] + (grid->size[0] + 1) * (at[1] + (grid->size[1] + 1) * at[2])];
}

static void add_vertices(struct grid *grid, double edge)
{
    size_t at[3];
    for (at[2] = 0; at[2] <= grid->size[2]; at[2]++)
        for (at[1] = 0; at[1] <= grid->size[1]; at[1]++)
            for (at[0] = 0; at[0] <= grid->size[0]; at[0]++) {
                double *v = grid->vertices + 3 * grid->vertex_count;
                int is_inside = 1;
                for (size_t k = 0; k < 3; k++) {
                    is_inside &= at[k] > 0 && at[k] < grid->size[k];
                    v[k] = ((double)at[k] - (k < 2 ? 0.5 : 1.0) * (double)grid->size[k]) * edge;
                }
                if (!is_inside)
                    *number_at(grid, at) = (uint32_t)grid->vertex_count++;
            }
}

static void add_square(struct grid *grid, size_t axis, size_t side, size_t i, size_t j)
{
    const size_t turn = (i + j) & 1;
    uint32_t q[4];
    for (size_t k = 0; k < 4; k++) {
        size_t at[3];
        at[axis] = side * grid->size[axis];
        at[(axis + 1) % 3] = i + (k == 1 || k == 2);
        at[(axis + 2) % 3] = j + (k >= 2);
        q[k] = *number_at(grid, at);
    }
    for (size_t k = 0; k < 2; k++) {
        uint32_t *to = grid->corners + 3 * grid->triangles++;
        to[0] = q[turn];
        to[side ? 1 : 2] = q[turn + 1 + k];
        to[side ? 2 : 1] = q[(turn + 2 + k) % 4];
    }
}

static void make_grid(struct grid *grid, size_t across, size_t deep, double edge)
{
    const size_t most = (across + 1) * (across + 1) * (deep + 1);
    *grid = (struct grid){ .size = { across, across, deep },
                           .vertices = malloc(3 * most * sizeof *grid->vertices),
                           .corners = malloc(3 * (4 * across * across + 8 * across * deep) * sizeof *grid->corners),
                           .numbers = malloc(most * sizeof *grid->numbers) };
    add_vertices(grid, edge);
    for (size_t axis = 0; axis < 3; axis++)
        for (size_t side = 0; side < 2; side++)
            for (size_t i = 0; i < grid->size[(axis + 1) % 3]; i++)
                for (size_t j = 0; j < grid->size[(axis + 2) % 3]; j++)
                    add_square(grid, axis, side, i, j);
}

/* A tool on a block, `cells` of the lattice across the patch, each with `finer` edges of the surface. */
struct pressed {
    struct tissue_rig tissue;
    struct tissue_body *body;
    struct tissue_tool *tool;
    double half; /* m: of the patch */
    double depth;
    double held;    /* N: what the device makes good, so that the tool is as deep as it should be */
    uint32_t flags; /* of the force, in all ticks that were looked at */
};

static void press_open(struct pressed *of, uint32_t cells, uint32_t finer, int is_long)
{
    const size_t across = (size_t)SIZE * cells * finer;
    const double half = 0.5 * cells * CELL, radius = SHARP * half, reach = is_long ? 2.0 * SIZE * half : 0.0;
    struct grid grid;
    make_grid(&grid, across, across / 2, CELL / finer);
    const struct tissue_arrays arrays = { grid.vertices, grid.vertex_count, grid.corners, grid.triangles };
    const struct tissue_def def = { .arrays = &arrays,
                                    .young = YOUNG,
                                    .density = 1000.0,
                                    .drag = 60.0 * 0.03 / (SIZE * half),
                                    .viscosity = 1e-3,
                                    .spacing = CELL,
                                    .floor = -SIZE * half + 0.1 * CELL,
                                    .integrator = DPT_INTEGRATOR_SYMPLECTIC };
    const dpt_segment segment = { { 0.0, -reach, 0.0 }, { 0.0, reach, 0.0 }, radius };
    *of = (struct pressed){ .half = half, .depth = half / SHARP };
    tissue_rig_open(&of->tissue);
    of->body = tissue_rig_add_soft(&of->tissue, &def);
    of->tool = tissue_rig_add_tool(&of->tissue, &segment, 10.0 * YOUNG * half);
    of->tool->device.position[2] = radius + 1e-3 * half;
    tissue_rig_place(&of->tissue);
    free(grid.vertices);
    free(grid.corners);
    free(grid.numbers);
}

/* The device goes where the tool is `share` of its depth under the force that is held. */
static double press_tick(struct pressed *of, double share)
{
    of->tool->device.position[2] = of->tool->segment.radius - share * of->depth - of->held / of->tool->stiffness;
    const double force = tissue_rig_tick(&of->tissue);
    of->flags |= of->tool->force.flags;
    return force;
}

enum { DOWN = 100, SETTLE = 150, STILL = 50 };

/* Press it in and hold it still. Returns the mean force at its depth, N; *jump: the largest between two ticks, by it. */
static double press(struct pressed *of, double *jump)
{
    double force = 0.0, last = 0.0, mean = 0.0;
    for (int i = 0; i < DOWN + SETTLE; i++) {
        force = press_tick(of, fmin(1.0, (i + 1.0) / DOWN));
        of->held += 0.05 * (force - of->held);
    }
    *jump = 0.0;
    of->flags = 0;
    for (int i = 0; i < STILL; i++) {
        last = force;
        force = press_tick(of, 1.0);
        *jump = fmax(*jump, fabs(force - last));
        mean += force / STILL;
    }
    *jump /= mean;
    /* By Hertz's law for what is left: the ball's force grows by 1.5 of what its depth does. */
    const double depth = of->tool->segment.radius - of->tool->device.position[2] - mean / of->tool->stiffness;
    return mean * pow(of->depth / depth, of->tool->rho > 0.0 ? 1.0 : 1.5);
}

/* N: on a ball or a cylinder, of a block whose patch is 2 m wide, and by what that grows with it. */
static double elements(int is_long, double cells, double size)
{
    const struct elastic_block block = { size, size, 0.0, 2.0 / cells, YOUNG, POISSON, 0, 0 };
    const struct elastic_tool tool = { SHARP, 1.0 / SHARP, is_long };
    return oracle_elastic_force(&block, &tool);
}

/* N: the limit of finer elements, of a block of SIZE, for a patch 2 m wide: of a ball and of a cylinder. */
static const double limit[2] = { 962.8, 2545.4 };

static double hertz(void)
{
    return 4.0 / 3.0 * YOUNG / (1.0 - POISSON * POISSON) * sqrt(SHARP) * pow(1.0 / SHARP, 1.5);
}

/*
 * A layer on a held face is stiffer than a half space, by a series in half the patch by the depth (E. Dimitriadis and
 * others, Biophys. J. 82, 2002). A block as wide as it is deep is a little softer.
 */
static void the_oracle_is_right(void)
{
    const double pi = acos(-1.0), size = 6.0, by = 1.0 / size;
    const double a = -(1.2876 - 1.4678 * POISSON + 1.3442 * POISSON * POISSON) / (1.0 - POISSON);
    const double b = (0.6387 - 1.0277 * POISSON + 1.5164 * POISSON * POISSON) / (1.0 - POISSON);
    const double layer = 1.0 - 2.0 * a / pi * by + 4.0 * a * a / (pi * pi) * by * by -
                         8.0 / pow(pi, 3.0) * (a * a * a + 4.0 * pi * pi / 15.0 * b) * pow(by, 3.0) +
                         16.0 * a / pow(pi, 4.0) * (a * a * a + 3.0 * pi * pi / 5.0 * b) * pow(by, 4.0);
    const double deep = elements(0, is_all ? 8.0 : 4.0, size) / hertz();
    printf("    6 deep: %.3f of a half space's force, a layer %.3f\n", deep, layer);
    CHECK(deep < layer && deep > 0.965 * layer, "%g, a layer %g", deep, layer);
    for (int is_long = 0; is_long < 2; is_long++) {
        const double is = elements(is_long, is_all ? 16.0 : 4.0, SIZE);
        printf("    %s: %.1f N of %.1f\n", is_long ? "cylinder" : "ball", is, limit[is_long]);
        CHECK(fabs(is / limit[is_long] - 1.0) < (is_all ? 1e-3 : 1e-2), "%g, limit %g", is, limit[is_long]);
    }
}

/* By how much the force is off. */
static double error_of(uint32_t cells, uint32_t finer, int is_long)
{
    struct pressed pressed;
    double jump, off = 1.0;
    press_open(&pressed, cells, finer, is_long);
    if (pressed.body) {
        const double force = press(&pressed, &jump), scale = pressed.half * pressed.half;
        off = force / (limit[is_long] * scale) - 1.0;
        printf("    %s, %u cells, edges of 1/%u: %+.1f %%, jumps of %.1g of the force, work %u\n",
               is_long ? "cylinder" : "ball", cells, finer, 100.0 * off, jump, pressed.tissue.info[0].work);
        CHECK(jump < 1e-3, "%u cells, 1/%u: it jumps by %g of its force", cells, finer, jump);
        CHECK(!(pressed.flags & DPT_FORCE_FLAG_CROWDED), "%u cells, 1/%u: it is crowded", cells, finer);
    }
    tissue_rig_close(&pressed.tissue);
    return off;
}

/* At four cells a lattice is up to an eighth too stiff, where edges are shorter than cells; from eight on it is right. */
static void a_ball_feels_an_elastic_block(void)
{
    for (uint32_t finer = 1; finer < (is_all ? 5 : 3); finer *= 2) {
        const double four = error_of(4, finer, 0), eight = is_all || finer == 1 ? error_of(8, finer, 0) : 0.0;
        CHECK(four > -0.02 && four < 0.125, "four cells: %g", four);
        CHECK(fabs(eight) < 0.025, "eight cells: %g", eight);
        if (is_all) {
            const double sixteen = error_of(16, finer, 0);
            CHECK(fabs(sixteen) < 0.05, "sixteen cells: %g", sixteen);
        }
    }
}

static void a_cylinder_feels_an_elastic_block(void)
{
    for (uint32_t finer = 1; finer < (is_all ? 5 : 3); finer *= 2) {
        const double four = error_of(4, finer, 1), eight = is_all ? error_of(8, finer, 1) : 0.0;
        CHECK(fabs(four) < 0.04, "four cells: %g", four);
        CHECK(fabs(eight) < 0.04, "eight cells: %g", eight);
    }
}

/* Edges of a cell are all vertices that touch, each by itself: the tool ends on them. */
static void a_tool_ends_on_the_vertices(void)
{
    struct pressed pressed;
    double jump, ends[6], nearest = HUGE_VAL;
    uint32_t count = 0, touched = 0;
    press_open(&pressed, 4, 1, 0);
    if (pressed.body) {
        press(&pressed, &jump);
        const double radius = pressed.tool->segment.radius;
        const float *x = tissue_vertices(&pressed.tissue, pressed.body, &count);
        tissue_tool_end(pressed.tool, ends);
        for (uint32_t i = 0; i < count; i++) {
            const double at[3] = { (double)x[3 * i], (double)x[3 * i + 1], (double)x[3 * i + 2] };
            const double gap = apart(at, ends) - radius - tissue_clearance(&pressed.tissue);
            nearest = fmin(nearest, gap);
            touched += gap < 1e-6;
        }
        printf("    %u vertices touch, the deepest by %.2g m\n", touched, -nearest);
        CHECK(nearest > -1e-6, "a vertex is %g m in the tool", -nearest);
        CHECK(touched == 21, "%u vertices touch", touched);
    }
    tissue_rig_close(&pressed.tissue);
}

/*
 * A device that comes from afar in one tick has all vertices within reach. What is near in the next ones is not more for
 * that: else touches would be as wide as the tool, and nothing would hold it.
 */
static void a_tool_comes_from_afar(void)
{
    struct tissue_def def = tissue_ball();
    struct tissue_rig tissue;
    def.shape = "liver";
    def.triangles = 50332;
    def.spacing = 0.0;
    def.floor = -0.035;
    def.young = 5e3;
    struct tissue_tool *rod = tissue_rig_open_rod(&tissue, 667.0, 1.5708, 0.015);
    if (tissue_rig_add_soft(&tissue, &def)) {
        double force = 0.0;
        uint32_t flags = 0;
        tissue_rod_lower(&tissue, -0.1);
        tissue_rig_place(&tissue);
        tissue_rod_lower(&tissue, 0.005);
        for (int i = 0; i < 100; i++) {
            force = tissue_rig_tick(&tissue);
            flags = i < 50 ? 0 : flags | rod->force.flags;
        }
        printf("    %.3f N\n", force);
        CHECK(force > 0.05 && force < 2.5, "it feels %g N", force);
        CHECK(!(flags & DPT_FORCE_FLAG_CROWDED), "it is crowded");
    }
    tissue_rig_close(&tissue);
}

/*
 * Led there and back over the surface, rough or not: jumps of a part of what the device pulls more in a tick, but where
 * it turns, and a closed path takes work.
 */
static void a_tool_is_led_across(void)
{
    enum { WAY = 200 };
    for (int is_rough = 0; is_rough < 2; is_rough++) {
        struct pressed pressed;
        double jump, last[3], work = 0.0, most = 0.0, peak = 0.0;
        press_open(&pressed, 4, 2, 0);
        if (is_rough)
            tissue_body_roughen(&pressed.tissue, pressed.body, 0.3, 0.2);
        press(&pressed, &jump);
        CHECK(jump < 1e-3, "it jumps by %g of its force", jump);
        memcpy(last, pressed.tool->force.wrench.force, sizeof last);
        for (int i = 0; i < 2 * WAY; i++) {
            const double way = (i < WAY ? 0.5 : -0.5) * pressed.half / WAY;
            const double *force = pressed.tool->force.wrench.force;
            pressed.tool->device.position[0] += way;
            press_tick(&pressed, 1.0);
            work -= 0.5 * (force[0] + last[0]) * way;
            most = fmax(most, i % WAY > 50 ? apart(force, last) : 0.0);
            peak = fmax(peak, length3(force));
            memcpy(last, force, sizeof last);
        }
        work /= peak * pressed.half;
        printf("    %s: jumps of %.2g of the force, takes %.3g of force times way\n", is_rough ? "rough" : "smooth",
               most / peak, work);
        CHECK(most < 0.2 * pressed.tool->stiffness * 0.5 * pressed.half / WAY, "it jumps by %g N", most);
        CHECK(work > (is_rough ? 0.05 : -1e-3), "it takes %g", work);
        CHECK(!(pressed.flags & DPT_FORCE_FLAG_CROWDED), "it is crowded");
        tissue_rig_close(&pressed.tissue);
    }
}

int main(int argc, char **argv)
{
    is_all = argc > 1 && !strcmp(argv[1], "all");
    TEST(the_oracle_is_right);
    TEST(a_ball_feels_an_elastic_block);
    TEST(a_cylinder_feels_an_elastic_block);
    TEST(a_tool_ends_on_the_vertices);
    TEST(a_tool_comes_from_afar);
    TEST(a_tool_is_led_across);
    return check_report();
}
