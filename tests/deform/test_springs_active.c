/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The active region of springs: what rests sleeps, and what a tool feels is the same as if all were awake.
 */
#include "deform/made_net.h"

enum { ACROSS = 16, DEEP = 8, LAYER = ACROSS * ACROSS, STEPS = 3000 };

/* A block on a fixed bed, pressed on its top in the middle. */
struct press {
    struct made_net net;
    dpt_load loads[LAYER];
    uint32_t count;
};

static void open_press_of(struct press *press, uint32_t integrator, double sleep_speed, double drag, double viscosity)
{
    const double s = 0.005, middle = 0.5 * s * (ACROSS - 1);
    dpt_springs_def def;
    memset(press, 0, sizeof *press);
    dpt_springs_def_init(&def);
    def.integrator = integrator;
    def.sleep_speed = sleep_speed;
    net_block(&press->net, ACROSS, ACROSS, DEEP, s, 5000.0, 1000.0);
    press->net.viscosity = viscosity;
    for (uint32_t i = 0; i < LAYER; i++)
        net_fix(&press->net, i);
    net_drag(&press->net, drag);
    CHECK(net_open(&press->net, &def) == DPT_OK, "not made");
    for (uint32_t i = press->net.nodes - LAYER; i < press->net.nodes; i++) {
        const double x = (double)press->net.rest[3 * i] - middle;
        const double y = (double)press->net.rest[3 * i + 1] - middle;
        if (x * x + y * y < 0.01 * 0.01)
            press->loads[press->count++].vertex = i;
    }
}

static void open_press(struct press *press, uint32_t integrator, double sleep_speed)
{
    open_press_of(press, integrator, sleep_speed, 5.0, 2e-3);
}

/* Step under a force downwards, N, that is shared. Returns how deep the patch is, m, on average. */
static double push(struct press *press, double force, dpt_springs_info *report)
{
    double depth = 0.0;
    report->size = sizeof *report;
    for (uint32_t i = 0; i < press->count; i++)
        press->loads[i].force[2] = -force / press->count;
    const dpt_result result = dpt_springs_step(press->net.made, 1e-3, press->loads, press->count, report);
    CHECK(result == DPT_OK, "no step: %s", dpt_result_name(result));
    const float *x = net_positions(&press->net);
    for (uint32_t i = 0; i < press->count; i++) {
        const size_t at = 3 * (size_t)press->loads[i].vertex + 2;
        depth += ((double)press->net.rest[at] - (double)x[at]) / press->count;
    }
    return depth;
}

/* Press, hold, let go, and press again. */
static double force_at(int step)
{
    const double t = 1e-3 * step, full = 0.05;
    if (step < 500)
        return full * t / 0.5;
    if (step < 1500)
        return full;
    if (step < 2000)
        return 0.0;
    return full * 0.5 * (1.0 - cos(2.0 * 3.14159265358979 * 2.0 * t));
}

static void what_sleeps_is_not_felt(uint32_t integrator)
{
    struct press all, some;
    dpt_springs_info report;
    double worst = 0.0, deepest = 0.0, jump = 0.0, largest_step = 0.0, last[2] = { 0 }, share = 0.0;
    uint32_t least = UINT32_MAX, most = 0;
    open_press(&all, integrator, 0.0);
    open_press(&some, integrator, 1e-4);
    for (int i = 0; i < STEPS; i++) {
        const double full = push(&all, force_at(i), &report);
        CHECK(report.active == all.net.nodes, "%u awake", report.active);
        const double part = push(&some, force_at(i), &report);
        share += (double)report.active / report.nodes / STEPS;
        least = report.active < least ? report.active : least;
        most = i > 200 && report.active > most ? report.active : most;
        worst = fabs(full - part) > worst ? fabs(full - part) : worst;
        deepest = full > deepest ? full : deepest;
        largest_step = fabs(full - last[0]) > largest_step ? fabs(full - last[0]) : largest_step;
        jump = fabs(part - last[1]) > jump ? fabs(part - last[1]) : jump;
        last[0] = full;
        last[1] = part;
    }
    printf("    integrator %u: %.2f mm deep, off by %.4f mm; %.0f %% awake, at least %u of %u\n", integrator,
           1e3 * deepest, 1e3 * worst, 100.0 * share, least, report.nodes);
    CHECK(worst < 0.05 * deepest, "off by %g m of %g", worst, deepest);
    CHECK(jump < 1.05 * largest_step, "a step of %g m, awake %g", jump, largest_step);
    CHECK(most <= report.nodes - LAYER, "%u of %u awake, %u of them fixed", most, report.nodes, LAYER);
    CHECK(least < report.nodes / 10, "at least %u of %u awake", least, report.nodes);
    net_close(&all.net);
    net_close(&some.net);
}

static void the_active_region_is_enough(void)
{
    for (uint64_t i = 0; i < part_of(2); i++)
        what_sleeps_is_not_felt(i ? DPT_INTEGRATOR_IMPLICIT : DPT_INTEGRATOR_SYMPLECTIC);
}

/* At rest nothing is awake; a load wakes its own slices first, and the same load again none. */
static void a_body_at_rest_sleeps(void)
{
    struct press press;
    dpt_springs_info report = { .size = sizeof report };
    open_press(&press, DPT_INTEGRATOR_SYMPLECTIC, 1e-5);
    for (int i = 0; i < 200; i++)
        CHECK(dpt_springs_step(press.net.made, 1e-3, NULL, 0, &report) == DPT_OK, "no step");
    CHECK(report.active == 0, "%u are awake", report.active);
    press.loads[0].force[2] = -0.01;
    CHECK(dpt_springs_step(press.net.made, 1e-3, press.loads, 1, &report) == DPT_OK && report.active == LANES,
          "%u are awake", report.active);
    for (int i = 0; i < 20000 && report.active; i++)
        CHECK(dpt_springs_step(press.net.made, 1e-3, press.loads, 1, &report) == DPT_OK, "no step");
    CHECK(report.active == 0, "%u are awake under the same load", report.active);
    CHECK(dpt_springs_step(press.net.made, 1e-3, NULL, 0, &report) == DPT_OK && report.active == LANES,
          "%u wake when it ends", report.active);
    net_close(&press.net);
}

/* A slice that creeps wakes those beside it; a node that is put elsewhere wakes its own and those beside it. */
static void a_moved_node_wakes_its_neighbours(void)
{
    struct press press;
    dpt_springs_info report = { .size = sizeof report };
    open_press(&press, DPT_INTEGRATOR_IMPLICIT, 1e-5);
    for (int i = 0; i < 200; i++)
        CHECK(dpt_springs_step(press.net.made, 1e-3, NULL, 0, &report) == DPT_OK, "no step");
    CHECK(report.active == 0, "%u are awake", report.active);
    const uint32_t node = press.net.nodes - LAYER / 2;
    float at[3];
    memcpy(at, press.net.rest + 3 * node, sizeof at);
    at[2] -= 1e-3f;
    CHECK(dpt_springs_set_nodes(press.net.made, node, 1, at, NULL) == DPT_OK, "not moved");
    CHECK(dpt_springs_step(press.net.made, 1e-3, NULL, 0, &report) == DPT_OK, "no step");
    CHECK(report.active >= 4 * LANES && report.active <= 12 * LANES, "%u are awake", report.active);
    for (int i = 0; i < 20000 && report.active; i++)
        CHECK(dpt_springs_step(press.net.made, 1e-3, NULL, 0, &report) == DPT_OK, "no step");
    double worst = 0.0;
    for (size_t i = 0; i < 3 * (size_t)press.net.nodes; i++) {
        const double off = fabs((double)net_positions(&press.net)[i] - (double)press.net.rest[i]);
        worst = off > worst ? off : worst;
    }
    CHECK(report.active == 0 && worst < 2e-5, "%u awake, %g m away from rest", report.active, worst);
    net_close(&press.net);
}

/* Two presses under the same loads, one all awake. Returns how far they are apart in the end, as a share of the depth. */
static double apart_in_the_end(struct press *all, struct press *some, double force, double rise, int steps,
                               uint32_t *least)
{
    dpt_springs_info report;
    double full = 0.0, part = 0.0;
    *least = UINT32_MAX;
    for (int i = 0; i < steps; i++) {
        const double now = 1e-3 * i < rise ? force * 1e-3 * i / rise : force;
        full = push(all, now, &report);
        part = push(some, now, &report);
        *least = report.active < *least ? report.active : *least;
    }
    return fabs(full - part) / full;
}

/* A load that rises so slowly that nothing is faster than the speed at which nodes fall asleep. */
static void a_slowly_rising_load_is_followed(void)
{
    for (uint64_t i = 0; i < part_of(2); i++) {
        const uint32_t integrator = i ? DPT_INTEGRATOR_IMPLICIT : DPT_INTEGRATOR_SYMPLECTIC;
        struct press all, some;
        uint32_t least;
        open_press(&all, integrator, 0.0);
        open_press(&some, integrator, 1e-3);
        const double apart = apart_in_the_end(&all, &some, 0.1, 5.0, 5000, &least);
        printf("    integrator %u: off by %.2f %%, at least %u of %u awake\n", integrator, 100.0 * apart, least,
               all.net.nodes);
        CHECK(apart < 0.05, "off by %g of the depth", apart);
        CHECK(least < all.net.nodes / 4, "at least %u of %u awake", least, all.net.nodes);
        net_close(&all.net);
        net_close(&some.net);
    }
}

/* Nodes that are held back by drag or viscosity move as slowly as they sleep, and still have far to go. */
static void what_creeps_is_not_frozen(void)
{
    static const struct {
        uint32_t integrator;
        double drag, viscosity;
    } cases[] = { { DPT_INTEGRATOR_SYMPLECTIC, 2e4, 0.0 },
                  { DPT_INTEGRATOR_IMPLICIT, 2e4, 0.0 },
                  { DPT_INTEGRATOR_IMPLICIT, 5.0, 0.5 } };
    for (uint64_t i = 0; i < part_of(sizeof cases / sizeof *cases); i++) {
        struct press all, some;
        uint32_t least;
        open_press_of(&all, cases[i].integrator, 0.0, cases[i].drag, cases[i].viscosity);
        open_press_of(&some, cases[i].integrator, 1e-3, cases[i].drag, cases[i].viscosity);
        const double apart = apart_in_the_end(&all, &some, 0.05, 0.0, 3000, &least);
        printf("    drag %g 1/s, viscosity %g s: off by %.2f %%, at least %u awake\n", cases[i].drag,
               cases[i].viscosity, 100.0 * apart, least);
        CHECK(apart < 0.05, "off by %g of the depth", apart);
        net_close(&all.net);
        net_close(&some.net);
    }
}

/* A held tool's loads are rounded otherwise in each tick: that wakes nothing. One that is a tenth larger does. */
static void rounding_of_loads_wakes_nothing(void)
{
    struct press press;
    dpt_springs_info report = { .size = sizeof report };
    uint64_t seed = 1;
    open_press(&press, DPT_INTEGRATOR_SYMPLECTIC, 1e-3);
    for (int i = 0; i < 5000; i++)
        push(&press, 0.05 * (1.0 + random_in(&seed, -1e-3, 1e-3)), &report);
    CHECK(report.active == 0, "%u are awake", report.active);
    const double depth = push(&press, 0.05 * 1.1, &report);
    CHECK(report.active > 0 && report.active < report.nodes / 10, "%u are awake", report.active);
    double deeper = 0.0;
    for (int i = 0; i < 2000; i++)
        deeper = push(&press, 0.05 * 1.1, &report);
    CHECK(deeper > 1.08 * depth, "%g m deep, then %g", depth, deeper);
    net_close(&press.net);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(the_active_region_is_enough);
    TEST(a_slowly_rising_load_is_followed);
    TEST(what_creeps_is_not_frozen);
    TEST(a_body_at_rest_sleeps);
    TEST(rounding_of_loads_wakes_nothing);
    TEST(a_moved_node_wakes_its_neighbours);
    return check_report();
}
