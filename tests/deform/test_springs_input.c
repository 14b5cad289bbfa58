/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Springs take any input; no number that is not finite gets in or out; all kernels give the same bits.
 */
#include <float.h>
#include <stddef.h>

#include "deform/made_net.h"
#include "lib/size_checks.h"

static dpt_springs_def def_of(uint32_t integrator)
{
    dpt_springs_def def;
    dpt_springs_def_init(&def);
    def.integrator = integrator;
    return def;
}

static void make(struct made_net *net, const dpt_springs_def *def)
{
    memset(net, 0, sizeof *net);
    net_block(net, 5, 4, 7, 0.01, 5000.0, 1000.0);
    for (uint32_t i = 0; i < 20; i++)
        net_fix(net, i);
    net_drag(net, 1.0);
    CHECK(net_open(net, def) == DPT_OK, "not made");
}

static dpt_result create(struct made_net *net, const dpt_springs_def *def)
{
    const dpt_springs_def whole = def_of(DPT_INTEGRATOR_IMPLICIT);
    return dpti_springs_create_net(net->block, dpti_springs_net_bytes(&whole, &net->rows), def, &net->rows, &net->made);
}

static void defs_are_checked(void)
{
    const dpt_springs_def good = def_of(DPT_INTEGRATOR_IMPLICIT);
    struct made_net net;
    make(&net, &good);
    const double bad[] = { NAN, INFINITY, -INFINITY, 1e300, -1.0 };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const size_t at[] = { offsetof(dpt_springs_def, gravity), offsetof(dpt_springs_def, stiffness),
                              offsetof(dpt_springs_def, contact_stiffness), offsetof(dpt_springs_def, sleep_speed) };
        for (size_t k = 0; k < sizeof at / sizeof *at; k++) {
            dpt_springs_def def = good;
            memcpy((char *)&def + at[k], &bad[i], sizeof bad[i]);
            const dpt_result expected = fabs(bad[i]) <= DBL_MAX ? DPT_E_ARGUMENT : DPT_E_FINITE;
            if (!(k == 0 && bad[i] == -1.0))
                CHECK(create(&net, &def) == expected, "field %zu, %g", k, bad[i]);
        }
    }
    dpt_springs_def def = good;
    CHECK(create(&net, NULL) == DPT_E_ARGUMENT, "no def");
    def.size = 8;
    CHECK(create(&net, &def) == DPT_E_SIZE, "size");
    def = good;
    def.integrator = 3;
    CHECK(create(&net, &def) == DPT_E_ARGUMENT, "integrator");
    def = good;
    def.iterations = 0;
    CHECK(create(&net, &def) == DPT_E_ARGUMENT, "iterations");
    def = good;
    def.max_substeps = 0;
    CHECK(create(&net, &def) == DPT_E_ARGUMENT, "substeps");
    def = good;
    def.sleep_steps = 1;
    CHECK(create(&net, &def) == DPT_E_ARGUMENT, "sleep");
    def = good;
    def.reserved = 1;
    CHECK(create(&net, &def) == DPT_E_ARGUMENT, "reserved");
    def = good;
    def.reserved_pointer = &def;
    CHECK(create(&net, &def) == DPT_E_ARGUMENT, "reserved_pointer");
    def = good;
    def.reserved_word = 1;
    CHECK(create(&net, &def) == DPT_E_ARGUMENT, "reserved_word");
    def = good;
    def.integrator = DPT_INTEGRATOR_IMPLICIT;
    def.min_substeps = 65536;
    CHECK(create(&net, &def) == DPT_E_ARGUMENT, "min_substeps");
    def.min_substeps = 17;
    CHECK(create(&net, &def) == DPT_OK, "17 substeps of IMPLICIT, which max_substeps does not bound");
    def.integrator = DPT_INTEGRATOR_SYMPLECTIC;
    CHECK(create(&net, &def) == DPT_E_ARGUMENT, "17 substeps at least, and 16 at most");
    def.min_substeps = 16;
    CHECK(create(&net, &def) == DPT_OK, "16 substeps at least and at most");
    def = good;
    def.kernel = 77;
    CHECK(create(&net, &def) == DPT_E_UNSUPPORTED, "kernel");
    const size_t bytes = dpti_springs_net_bytes(&good, &net.rows);
    CHECK(dpti_springs_create_net(net.block, bytes - 1, &good, &net.rows, &net.made) == DPT_E_MEMORY, "too small");
    CHECK(dpti_springs_create_net((char *)net.block + 4, bytes, &good, &net.rows, &net.made) == DPT_E_ALIGN,
          "not aligned");
    CHECK(dpti_springs_create_net(NULL, bytes, &good, &net.rows, &net.made) == DPT_E_ARGUMENT, "NULL");
    net_close(&net);
}

static struct made_net sized;

static dpt_result create_sized(void *def)
{
    return create(&sized, def);
}

static void fill_in(void *def, size_t size)
{
    dpt_springs_def_defaults(def, size);
}

static dpt_result report_sized(void *report)
{
    return dpt_springs_step(sized.made, 1e-3, NULL, 0, report);
}

static void structs_are_taken_as_far_as_they_go(void)
{
    const dpt_springs_def good = def_of(DPT_INTEGRATOR_IMPLICIT);
    const struct sized def = { "dpt_springs_def", offsetof(dpt_springs_def, min_substeps), sizeof good, create_sized };
    const struct sized report = { "dpt_springs_info", offsetof(dpt_springs_info, result), sizeof(dpt_springs_info),
                                  report_sized };
    dpt_springs_def defaults;
    dpt_springs_def_init(&defaults);
    make(&sized, &good);
    check_input(&def, &good);
    check_defaults(&def, fill_in, &defaults);
    check_output(&report);
    net_close(&sized);
}

/* All positions and speeds as bits. */
static void state_of(const struct made_net *net, float *to)
{
    memcpy(to, net_positions(net), 3 * (size_t)net->nodes * sizeof *to);
    memcpy(to + 3 * (size_t)net->nodes, net_speeds(net), 3 * (size_t)net->nodes * sizeof *to);
}

enum { NODES = 140 };

static void bad_steps_change_nothing(void)
{
    for (uint32_t integrator = DPT_INTEGRATOR_SYMPLECTIC; integrator <= DPT_INTEGRATOR_IMPLICIT; integrator++) {
        dpt_springs_def def = def_of(integrator);
        struct made_net net;
        float before[6 * NODES], after[6 * NODES];
        dpt_load load = { .vertex = 100, .force = { 0.01, 0.0, 0.0 } };
        make(&net, &def);
        const double dt = integrator == DPT_INTEGRATOR_EULER ? 1e-9 : 1e-3;
        const dpt_result done = dpt_springs_step(net.made, dt, &load, 1, NULL);
        CHECK(done == DPT_OK, "no step: %s", dpt_result_name(done));
        state_of(&net, before);
        const double times[] = { 0.0, -1.0, 1.5, NAN, INFINITY };
        for (size_t i = 0; i < sizeof times / sizeof *times; i++)
            CHECK(dpt_springs_step(net.made, times[i], NULL, 0, NULL) == (i < 3 ? DPT_E_ARGUMENT : DPT_E_FINITE),
                  "dt %g", times[i]);
        const double forces[] = { NAN, INFINITY, -INFINITY, 1e10, DBL_MAX };
        for (size_t i = 0; i < sizeof forces / sizeof *forces; i++) {
            load.force[1] = forces[i];
            CHECK(dpt_springs_step(net.made, dt, &load, 1, NULL) == DPT_E_FINITE, "%g", forces[i]);
        }
        load.force[1] = 0.0;
        load.vertex = NODES;
        CHECK(dpt_springs_step(net.made, dt, &load, 1, NULL) == DPT_E_ARGUMENT, "node");
        CHECK(dpt_springs_step(net.made, dt, NULL, 1, NULL) == DPT_E_ARGUMENT, "no loads");
        CHECK(dpt_springs_step(NULL, dt, NULL, 0, NULL) == DPT_E_ARGUMENT, "NULL");
        float wild[3] = { NAN, 0.0f, 0.0f };
        CHECK(dpt_springs_set_nodes(net.made, 50, 1, wild, NULL) == DPT_E_FINITE, "NaN");
        CHECK(dpt_springs_set_nodes(net.made, 50, 1, before, wild) == DPT_E_FINITE, "NaN");
        wild[0] = 2e6f;
        CHECK(dpt_springs_set_nodes(net.made, 50, 1, wild, NULL) == DPT_E_FINITE, "far");
        CHECK(dpt_springs_set_nodes(net.made, NODES, 1, before, NULL) == DPT_E_ARGUMENT, "beyond");
        CHECK(dpt_springs_set_nodes(net.made, 1, UINT32_MAX, before, NULL) == DPT_E_ARGUMENT, "all");
        CHECK(dpt_springs_get_nodes(net.made, NODES - 1, after, NULL) == DPT_E_ARGUMENT, "count");
        CHECK(dpt_springs_get_nodes(net.made, NODES, NULL, NULL) == DPT_E_ARGUMENT, "NULL");
        CHECK(dpt_springs_get_energy(net.made, NULL, NULL) == DPT_E_ARGUMENT, "NULL");
        CHECK(dpt_springs_get_count(NULL) == 0 && dpt_springs_get_stable_step(NULL) == 0.0, "NULL");
        state_of(&net, after);
        CHECK(!memcmp(before, after, sizeof after), "integrator %u: moved", integrator);
        net_close(&net);
    }
}

/* Forces that throw nodes out of the finite range: refused, and the next step goes on from where nodes were. */
static void what_would_be_infinite_is_refused(void)
{
    for (uint32_t integrator = DPT_INTEGRATOR_SYMPLECTIC; integrator <= DPT_INTEGRATOR_IMPLICIT; integrator += 2) {
        dpt_springs_def def = def_of(integrator);
        struct made_net net, other;
        float before[6 * NODES], after[6 * NODES];
        dpt_load loads[NODES];
        make(&net, &def);
        make(&other, &def);
        for (uint32_t i = 0; i < NODES; i++)
            loads[i] = (dpt_load){ .vertex = 50 + i / 4, .force = { 1e9, -1e9, 1e9 } };
        net_steps(&net, 2e-3, 3);
        net_steps(&other, 2e-3, 3);
        state_of(&net, before);
        uint32_t refused = 0;
        for (int i = 0; i < 5; i++)
            refused += dpt_springs_step(net.made, 8e-3, loads, NODES, NULL) == DPT_E_FINITE;
        state_of(&net, after);
        CHECK(refused == 5 && !memcmp(before, after, sizeof after), "integrator %u: %u refused", integrator, refused);
        loads[0].force[0] = 0.01;
        loads[0].force[1] = loads[0].force[2] = 0.0;
        for (int i = 0; i < 5; i++) {
            CHECK(dpt_springs_step(net.made, 2e-3, loads, 1, NULL) == DPT_OK, "no step");
            CHECK(dpt_springs_step(other.made, 2e-3, loads, 1, NULL) == DPT_OK, "no step");
        }
        state_of(&net, before);
        state_of(&other, after);
        CHECK(!memcmp(before, after, sizeof after), "integrator %u: goes on elsewhere", integrator);
        net_close(&net);
        net_close(&other);
    }
}

/* Two nodes in one place, and springs without strength, make no NaN. */
static void nodes_may_meet(void)
{
    for (uint32_t integrator = DPT_INTEGRATOR_SYMPLECTIC; integrator <= DPT_INTEGRATOR_IMPLICIT; integrator += 2) {
        dpt_springs_def def = def_of(integrator);
        struct made_net net;
        float at[6];
        make(&net, &def);
        memcpy(at, net_positions(&net) + 3 * 70, sizeof at);
        memcpy(at + 3, at, 3 * sizeof *at);
        CHECK(dpt_springs_set_nodes(net.made, 70, 2, at, NULL) == DPT_OK, "not moved");
        net_steps(&net, 1e-3, 100);
        const float *x = net_positions(&net);
        for (size_t i = 0; i < 3 * NODES; i++)
            CHECK(fabsf(x[i]) < 1.0f, "coordinate %zu is %g", i, (double)x[i]);
        net_close(&net);
    }
}

/* The same calls give the same bits with every kernel of this machine. */
static void kernels_give_the_same_bits(void)
{
    uint32_t compared = 0;
    for (int of = 0; of < 8; of++) {
        float first[6 * NODES], now[6 * NODES];
        for (uint32_t id = DPT_KERNEL_SCALAR; id <= DPT_KERNEL_WASM128; id++) {
            dpt_springs_def def = def_of(of % 2 ? DPT_INTEGRATOR_IMPLICIT : DPT_INTEGRATOR_SYMPLECTIC);
            struct made_net net;
            dpt_load load = { .vertex = 130, .force = { 0.02, -0.01, -0.05 } };
            make(&net, &def);
            net.rows.viscosity = of & 2 ? 1e-4 : 0.0;
            def.gravity[1] = of & 4 ? -9.81 : 0.0;
            def.kernel = id;
            const dpt_result made = net_reopen(&net, &def);
            if (made == DPT_OK) {
                for (int i = 0; i < 100; i++)
                    CHECK(dpt_springs_step(net.made, 1e-3, &load, 1, NULL) == DPT_OK, "no step");
                state_of(&net, id == DPT_KERNEL_SCALAR ? first : now);
                if (id > DPT_KERNEL_SCALAR) {
                    CHECK(!memcmp(first, now, sizeof now), "%s differs, case %d", dpt_kernel_name(id), of);
                    compared++;
                }
            } else
                CHECK(made == DPT_E_UNSUPPORTED && id > DPT_KERNEL_SCALAR, "kernel %u", id);
            net_close(&net);
        }
    }
    if (!compared)
        SKIP("other kernels", "this build or machine has the scalar one alone");
}

int main(void)
{
    TEST(defs_are_checked);
    TEST(structs_are_taken_as_far_as_they_go);
    TEST(bad_steps_change_nothing);
    TEST(what_would_be_infinite_is_refused);
    TEST(nodes_may_meet);
    TEST(kernels_give_the_same_bits);
    return check_report();
}
