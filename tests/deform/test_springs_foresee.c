/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * dpt_springs_foresee: it tells where the step leads that is made then, bit for bit, and changes nothing: springs that are
 * asked in between go where others go that are not. A step of min_substeps is as many steps, to the bit, of IMPLICIT too.
 */
#include "lib/fixture.h"

#include <math.h>

#include "lib/check.h"

enum { STEPS = 60, MANY = 4, LOADS = 8, NODES_MOST = 4096 };

static const dpt_spring_region border = { .kind = DPT_REGION_BOX,
                                          .fixed = 1,
                                          .box = { -0.11, -0.11, -0.1, -0.08, 0.11, 0.1 } };

static dpt_springs *make(const dpt_mesh *mesh, uint32_t integrator, uint32_t min_substeps, void **block)
{
    dpt_springs_def def;
    dpt_springs *springs = NULL;
    dpt_springs_def_init(&def);
    def.mesh = mesh;
    def.integrator = integrator;
    def.gravity[2] = -9.81;
    def.min_substeps = min_substeps;
    def.max_substeps = 16 * MANY;
    if (min_substeps)
        def.sleep_speed = 0.0;
    *block = malloc(dpt_springs_bytes(&def));
    CHECK(*block && dpt_springs_create(*block, dpt_springs_bytes(&def), &def, &springs) == DPT_OK, "no springs");
    return springs;
}

static void set_loads(dpt_load loads[LOADS], uint32_t nodes, int step)
{
    for (uint32_t i = 0; i < LOADS; i++)
        loads[i] = (dpt_load){ .vertex = (nodes / LOADS) * i,
                               .force = { 0.01 * sin(0.1 * step), 0.0, -0.02 * (1.0 + cos(0.07 * step + i)) } };
}

static void compare(const dpt_mesh *mesh, uint32_t integrator)
{
    static float foreseen[3 * NODES_MOST], asked_at[3 * NODES_MOST], other_at[3 * NODES_MOST],
        speeds[2][3 * NODES_MOST];
    void *blocks[2];
    dpt_springs *asked = make(mesh, integrator, 0, &blocks[0]), *other = make(mesh, integrator, 0, &blocks[1]);
    const uint32_t nodes = dpt_springs_get_count(asked);
    const size_t bytes = 3 * sizeof *foreseen * nodes;
    dpt_load loads[LOADS];
    int told = 0, same = 0;
    for (int step = 0; asked && other && nodes <= NODES_MOST && step < STEPS; step++) {
        set_loads(loads, nodes, step + 1);
        CHECK(dpt_springs_foresee(asked, 1e-3, loads, LOADS, nodes, foreseen) == DPT_OK, "other loads, step %d", step);
        set_loads(loads, nodes, step);
        CHECK(dpt_springs_foresee(asked, 1e-3, loads, LOADS, nodes, foreseen) == DPT_OK, "step %d", step);
        CHECK(dpt_springs_step(asked, 1e-3, loads, LOADS, NULL) == DPT_OK, "step %d", step);
        CHECK(dpt_springs_step(other, 1e-3, loads, LOADS, NULL) == DPT_OK, "step %d", step);
        dpt_springs_get_nodes(asked, nodes, asked_at, speeds[0]);
        dpt_springs_get_nodes(other, nodes, other_at, speeds[1]);
        told += !memcmp(foreseen, asked_at, bytes);
        same += !memcmp(asked_at, other_at, bytes) && !memcmp(speeds[0], speeds[1], bytes);
    }
    CHECK(told == STEPS && same == STEPS, "integrator %u: %d of %d steps are told, and %d are as without", integrator,
          told, STEPS, same);
    CHECK(dpt_springs_foresee(asked, 1e-3, loads, LOADS, nodes + 1, foreseen) == DPT_E_ARGUMENT, "another count");
    CHECK(dpt_springs_foresee(asked, 1e-3, loads, LOADS, nodes, NULL) == DPT_E_ARGUMENT, "no room");
    CHECK(dpt_springs_foresee(NULL, 1e-3, loads, LOADS, nodes, foreseen) == DPT_E_ARGUMENT, "no springs");
    loads[0].force[0] = NAN;
    CHECK(dpt_springs_foresee(asked, 1e-3, loads, LOADS, nodes, foreseen) == DPT_E_FINITE, "no number");
    CHECK(integrator == DPT_INTEGRATOR_IMPLICIT ||
              dpt_springs_foresee(asked, 1.0, NULL, 0, nodes, foreseen) == DPT_E_UNSTABLE,
          "too long a step");
    free(blocks[0]);
    free(blocks[1]);
}

/* A long step of so many substeps, asked for in between, beside as many steps. */
static void compare_substeps(const dpt_mesh *mesh, uint32_t integrator)
{
    static float at[3][3 * NODES_MOST], speeds[2][3 * NODES_MOST];
    void *blocks[2];
    const uint32_t own = integrator == DPT_INTEGRATOR_IMPLICIT ? 1 : 16;
    dpt_springs *coarse = make(mesh, integrator, MANY * own, &blocks[0]);
    dpt_springs *fine = make(mesh, integrator, own, &blocks[1]);
    const uint32_t nodes = dpt_springs_get_count(coarse);
    const size_t bytes = 3 * sizeof **at * nodes;
    dpt_load loads[LOADS];
    int same = 0;
    for (int step = 0; coarse && fine && nodes <= NODES_MOST && step < STEPS / MANY; step++) {
        dpt_springs_info info = { .size = sizeof info };
        set_loads(loads, nodes, step);
        CHECK(dpt_springs_foresee(coarse, MANY * 1e-3, loads, LOADS, nodes, at[2]) == DPT_OK, "step %d", step);
        CHECK(dpt_springs_step(coarse, MANY * 1e-3, loads, LOADS, &info) == DPT_OK, "step %d", step);
        CHECK(info.substeps == MANY * own, "%u substeps", info.substeps);
        for (int i = 0; i < MANY; i++)
            CHECK(dpt_springs_step(fine, 1e-3, loads, LOADS, &info) == DPT_OK && info.substeps == own, "step %d", step);
        dpt_springs_get_nodes(coarse, nodes, at[0], speeds[0]);
        dpt_springs_get_nodes(fine, nodes, at[1], speeds[1]);
        same += !memcmp(at[0], at[1], bytes) && !memcmp(at[0], at[2], bytes) && !memcmp(speeds[0], speeds[1], bytes);
    }
    CHECK(same == STEPS / MANY, "integrator %u: %d of %d steps are those of %d", integrator, same, STEPS / MANY, MANY);
    free(blocks[0]);
    free(blocks[1]);
}

static void with_body(uint32_t kind, void (*of)(const dpt_mesh *, uint32_t))
{
    struct fixture body;
    const int is_sheet = kind == DPT_NET_SHEET;
    const dpt_spring_net_def net = { .size = sizeof net,
                                     .kind = kind,
                                     .young = is_sheet ? 1e5 : 5e3,
                                     .thickness = is_sheet ? 1e-3 : 0.0,
                                     .density = 1000.0,
                                     .drag = 10.0,
                                     .viscosity = 1e-3,
                                     .spacing = is_sheet ? 0.0 : 0.015,
                                     .poisson = is_sheet ? 0.0 : 0.45,
                                     .regions = &border,
                                     .region_count = 1 };
    if (!fixture_with_springs(&body, is_sheet ? "membrane" : "liver", is_sheet ? 512 : 1000, &net))
        return;
    for (uint32_t integrator = DPT_INTEGRATOR_SYMPLECTIC; integrator <= DPT_INTEGRATOR_IMPLICIT; integrator++)
        of(body.mesh, integrator);
    fixture_free(&body);
}

static void a_step_is_told(void)
{
    for (uint32_t kind = DPT_NET_SHEET; kind <= DPT_NET_VOLUME; kind++)
        with_body(kind, compare);
}

static void substeps_are_steps(void)
{
    for (uint32_t kind = DPT_NET_SHEET; kind <= DPT_NET_VOLUME; kind++)
        with_body(kind, compare_substeps);
}

int main(void)
{
    TEST(a_step_is_told);
    TEST(substeps_are_steps);
    return check_report();
}
