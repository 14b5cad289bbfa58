/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Springs take any input; no number that is not finite gets in or out; all kernels give the same bits.
 */
#include <float.h>
#include <stddef.h>

#include "deform/spring_rig.h"
#include "lib/size_checks.h"

static dpt_springs_def def_of(uint32_t integrator)
{
    dpt_springs_def def;
    dpt_springs_def_init(&def);
    def.integrator = integrator;
    return def;
}

static void make(struct rig *rig, const dpt_springs_def *def)
{
    memset(rig, 0, sizeof *rig);
    rig_block(rig, 5, 4, 7, 0.01, 5000.0, 1000.0);
    for (uint32_t i = 0; i < 20; i++)
        rig_fix(rig, i);
    rig_drag(rig, 1.0);
    CHECK(rig_open(rig, def) == DPT_OK, "not made");
}

static dpt_result create(struct rig *rig, const dpt_springs_def *def)
{
    const dpt_springs_def whole = def_of(DPT_INTEGRATOR_IMPLICIT);
    return dpti_springs_create_net(rig->block, dpti_springs_net_bytes(&whole, &rig->net), def, &rig->net, &rig->made);
}

static void defs_are_checked(void)
{
    const dpt_springs_def good = def_of(DPT_INTEGRATOR_IMPLICIT);
    struct rig rig;
    make(&rig, &good);
    const double bad[] = { NAN, INFINITY, -INFINITY, 1e300, -1.0 };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const size_t at[] = { offsetof(dpt_springs_def, gravity), offsetof(dpt_springs_def, stiffness),
                              offsetof(dpt_springs_def, contact_stiffness), offsetof(dpt_springs_def, sleep_speed) };
        for (size_t k = 0; k < sizeof at / sizeof *at; k++) {
            dpt_springs_def def = good;
            memcpy((char *)&def + at[k], &bad[i], sizeof bad[i]);
            const dpt_result expected = fabs(bad[i]) <= DBL_MAX ? DPT_E_ARGUMENT : DPT_E_FINITE;
            if (!(k == 0 && bad[i] == -1.0))
                CHECK(create(&rig, &def) == expected, "field %zu, %g", k, bad[i]);
        }
    }
    dpt_springs_def def = good;
    CHECK(create(&rig, NULL) == DPT_E_ARGUMENT, "no def");
    def.size = 8;
    CHECK(create(&rig, &def) == DPT_E_SIZE, "size");
    def = good;
    def.integrator = 3;
    CHECK(create(&rig, &def) == DPT_E_ARGUMENT, "integrator");
    def = good;
    def.iterations = 0;
    CHECK(create(&rig, &def) == DPT_E_ARGUMENT, "iterations");
    def = good;
    def.max_substeps = 0;
    CHECK(create(&rig, &def) == DPT_E_ARGUMENT, "substeps");
    def = good;
    def.sleep_steps = 1;
    CHECK(create(&rig, &def) == DPT_E_ARGUMENT, "sleep");
    def = good;
    def.reserved = 1;
    CHECK(create(&rig, &def) == DPT_E_ARGUMENT, "reserved");
    def = good;
    def.reserved_pointer = &def;
    CHECK(create(&rig, &def) == DPT_E_ARGUMENT, "reserved_pointer");
    def = good;
    def.kernel = 77;
    CHECK(create(&rig, &def) == DPT_E_UNSUPPORTED, "kernel");
    const size_t bytes = dpti_springs_net_bytes(&good, &rig.net);
    CHECK(dpti_springs_create_net(rig.block, bytes - 1, &good, &rig.net, &rig.made) == DPT_E_MEMORY, "too small");
    CHECK(dpti_springs_create_net((char *)rig.block + 4, bytes, &good, &rig.net, &rig.made) == DPT_E_ALIGN,
          "not aligned");
    CHECK(dpti_springs_create_net(NULL, bytes, &good, &rig.net, &rig.made) == DPT_E_ARGUMENT, "NULL");
    rig_close(&rig);
}

static struct rig sized;

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
    const struct sized def = { "dpt_springs_def", sizeof good, sizeof good, create_sized };
    const struct sized report = { "dpt_springs_info", sizeof(dpt_springs_info), sizeof(dpt_springs_info),
                                  report_sized };
    dpt_springs_def defaults;
    dpt_springs_def_init(&defaults);
    make(&sized, &good);
    check_input(&def, &good);
    check_defaults(&def, fill_in, &defaults);
    check_output(&report);
    rig_close(&sized);
}

/* All positions and speeds as bits. */
static void state_of(const struct rig *rig, float *to)
{
    memcpy(to, rig_positions(rig), 3 * (size_t)rig->nodes * sizeof *to);
    memcpy(to + 3 * (size_t)rig->nodes, rig_speeds(rig), 3 * (size_t)rig->nodes * sizeof *to);
}

enum { NODES = 140 };

static void bad_steps_change_nothing(void)
{
    for (uint32_t integrator = DPT_INTEGRATOR_SYMPLECTIC; integrator <= DPT_INTEGRATOR_IMPLICIT; integrator++) {
        dpt_springs_def def = def_of(integrator);
        struct rig rig;
        float before[6 * NODES], after[6 * NODES];
        dpt_load load = { .vertex = 100, .force = { 0.01, 0.0, 0.0 } };
        make(&rig, &def);
        const double dt = integrator == DPT_INTEGRATOR_EULER ? 1e-9 : 1e-3;
        const dpt_result done = dpt_springs_step(rig.made, dt, &load, 1, NULL);
        CHECK(done == DPT_OK, "no step: %s", dpt_result_name(done));
        state_of(&rig, before);
        const double times[] = { 0.0, -1.0, 1.5, NAN, INFINITY };
        for (size_t i = 0; i < sizeof times / sizeof *times; i++)
            CHECK(dpt_springs_step(rig.made, times[i], NULL, 0, NULL) == (i < 3 ? DPT_E_ARGUMENT : DPT_E_FINITE),
                  "dt %g", times[i]);
        const double forces[] = { NAN, INFINITY, -INFINITY, 1e10, DBL_MAX };
        for (size_t i = 0; i < sizeof forces / sizeof *forces; i++) {
            load.force[1] = forces[i];
            CHECK(dpt_springs_step(rig.made, dt, &load, 1, NULL) == DPT_E_FINITE, "%g", forces[i]);
        }
        load.force[1] = 0.0;
        load.vertex = NODES;
        CHECK(dpt_springs_step(rig.made, dt, &load, 1, NULL) == DPT_E_ARGUMENT, "node");
        CHECK(dpt_springs_step(rig.made, dt, NULL, 1, NULL) == DPT_E_ARGUMENT, "no loads");
        CHECK(dpt_springs_step(NULL, dt, NULL, 0, NULL) == DPT_E_ARGUMENT, "NULL");
        float wild[3] = { NAN, 0.0f, 0.0f };
        CHECK(dpt_springs_set_nodes(rig.made, 50, 1, wild, NULL) == DPT_E_FINITE, "NaN");
        CHECK(dpt_springs_set_nodes(rig.made, 50, 1, before, wild) == DPT_E_FINITE, "NaN");
        wild[0] = 2e6f;
        CHECK(dpt_springs_set_nodes(rig.made, 50, 1, wild, NULL) == DPT_E_FINITE, "far");
        CHECK(dpt_springs_set_nodes(rig.made, NODES, 1, before, NULL) == DPT_E_ARGUMENT, "beyond");
        CHECK(dpt_springs_set_nodes(rig.made, 1, UINT32_MAX, before, NULL) == DPT_E_ARGUMENT, "all");
        CHECK(dpt_springs_get_nodes(rig.made, NODES - 1, after, NULL) == DPT_E_ARGUMENT, "count");
        CHECK(dpt_springs_get_nodes(rig.made, NODES, NULL, NULL) == DPT_E_ARGUMENT, "NULL");
        CHECK(dpt_springs_get_energy(rig.made, NULL, NULL) == DPT_E_ARGUMENT, "NULL");
        CHECK(dpt_springs_get_count(NULL) == 0 && dpt_springs_get_stable_step(NULL) == 0.0, "NULL");
        state_of(&rig, after);
        CHECK(!memcmp(before, after, sizeof after), "integrator %u: moved", integrator);
        rig_close(&rig);
    }
}

/* Forces that throw nodes out of the finite range: refused, and the next step goes on from where nodes were. */
static void what_would_be_infinite_is_refused(void)
{
    for (uint32_t integrator = DPT_INTEGRATOR_SYMPLECTIC; integrator <= DPT_INTEGRATOR_IMPLICIT; integrator += 2) {
        dpt_springs_def def = def_of(integrator);
        struct rig rig, other;
        float before[6 * NODES], after[6 * NODES];
        dpt_load loads[NODES];
        make(&rig, &def);
        make(&other, &def);
        for (uint32_t i = 0; i < NODES; i++)
            loads[i] = (dpt_load){ .vertex = 50 + i / 4, .force = { 1e9, -1e9, 1e9 } };
        rig_steps(&rig, 2e-3, 3);
        rig_steps(&other, 2e-3, 3);
        state_of(&rig, before);
        uint32_t refused = 0;
        for (int i = 0; i < 5; i++)
            refused += dpt_springs_step(rig.made, 8e-3, loads, NODES, NULL) == DPT_E_FINITE;
        state_of(&rig, after);
        CHECK(refused == 5 && !memcmp(before, after, sizeof after), "integrator %u: %u refused", integrator, refused);
        loads[0].force[0] = 0.01;
        loads[0].force[1] = loads[0].force[2] = 0.0;
        for (int i = 0; i < 5; i++) {
            CHECK(dpt_springs_step(rig.made, 2e-3, loads, 1, NULL) == DPT_OK, "no step");
            CHECK(dpt_springs_step(other.made, 2e-3, loads, 1, NULL) == DPT_OK, "no step");
        }
        state_of(&rig, before);
        state_of(&other, after);
        CHECK(!memcmp(before, after, sizeof after), "integrator %u: goes on elsewhere", integrator);
        rig_close(&rig);
        rig_close(&other);
    }
}

/* Two nodes in one place, and springs without strength, make no NaN. */
static void nodes_may_meet(void)
{
    for (uint32_t integrator = DPT_INTEGRATOR_SYMPLECTIC; integrator <= DPT_INTEGRATOR_IMPLICIT; integrator += 2) {
        dpt_springs_def def = def_of(integrator);
        struct rig rig;
        float at[6];
        make(&rig, &def);
        memcpy(at, rig_positions(&rig) + 3 * 70, sizeof at);
        memcpy(at + 3, at, 3 * sizeof *at);
        CHECK(dpt_springs_set_nodes(rig.made, 70, 2, at, NULL) == DPT_OK, "not moved");
        rig_steps(&rig, 1e-3, 100);
        const float *x = rig_positions(&rig);
        for (size_t i = 0; i < 3 * NODES; i++)
            CHECK(fabsf(x[i]) < 1.0f, "coordinate %zu is %g", i, (double)x[i]);
        rig_close(&rig);
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
            struct rig rig;
            dpt_load load = { .vertex = 130, .force = { 0.02, -0.01, -0.05 } };
            make(&rig, &def);
            rig.net.viscosity = of & 2 ? 1e-4 : 0.0;
            def.gravity[1] = of & 4 ? -9.81 : 0.0;
            def.kernel = id;
            const dpt_result made = rig_reopen(&rig, &def);
            if (made == DPT_OK) {
                for (int i = 0; i < 100; i++)
                    CHECK(dpt_springs_step(rig.made, 1e-3, &load, 1, NULL) == DPT_OK, "no step");
                state_of(&rig, id == DPT_KERNEL_SCALAR ? first : now);
                if (id > DPT_KERNEL_SCALAR) {
                    CHECK(!memcmp(first, now, sizeof now), "%s differs, case %d", dpt_kernel_name(id), of);
                    compared++;
                }
            } else
                CHECK(made == DPT_E_UNSUPPORTED && id > DPT_KERNEL_SCALAR, "kernel %u", id);
            rig_close(&rig);
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
