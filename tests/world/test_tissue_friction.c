/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Friction of a tool on tissue that is solved together with it. Oracles: Coulomb's law about the normal that brute force
 * finds over the surface after the step; sums of forces and of work; and the same motion made by the body instead of the
 * device. How stiff the tissue is, and how it is shared among touches, is not judged here.
 */
#include "lib/mesh_builder.h"
#include "world/tissue_matrix.h"
#include "world/tissue_rig.h"

#define HOLD_MU  0.5
#define SLIDE_MU 0.4
#define DEPTH    0.006
#define LEANING  1.2
#define TICK     2e-5 /* m, of a device that moves aside */
#define AROUND   8e-3 /* m: of a circle */

/* A rough body and the rod that presses it; NULL after a failed check. */
static struct tissue_tool *begin(struct tissue_rig *tissue, uint32_t kind, uint32_t integrator, double lean,
                                 double *jump)
{
    double mean;
    const struct tissue_def def = tissue_asleep(kind, integrator);
    struct tissue_tool *rod = tissue_rig_open_rod(tissue, 667.0, lean, 0.004);
    if (!tissue_rig_add_soft(tissue, &def))
        return NULL;
    tissue_body_roughen(tissue, &tissue->body[0], HOLD_MU, SLIDE_MU);
    *jump = tissue_rod_press_and_hold(tissue, DEPTH, &mean);
    CHECK(mean > 1e-3, "it is not touched: %g N", mean);
    return rod;
}

static void a_held_tool_sticks_and_is_silent(void)
{
    static const double leans[] = { 0.0, 0.6, 1.2, 1.5708 };
    for (int i = 0; i < (int)part_of(24); i++) {
        struct tissue_rig tissue;
        double jump;
        struct tissue_tool *rod =
            begin(&tissue, i % 2 ? DPT_NET_SHEET : DPT_NET_VOLUME, (uint32_t)(i / 2 % 3), leans[i / 6], &jump);
        if (rod) {
            const double force = length3(rod->force.wrench.force);
            CHECK(jump <= fmax(1e-3 * force, 1e-3), "case %d: jumps of %g N at %g N", i, jump, force);
            CHECK(i % 2 || (rod->force.sticking > 0 && rod->force.slipping == 0), "case %d: %u stick, %u slip", i,
                  rod->force.sticking, rod->force.slipping);
        }
        tissue_rig_close(&tissue);
    }
}

/* By how much the distance to the surface grows with the tool's place: the normal. */
static void normal_at(const struct tissue_rig *tissue, double normal[3])
{
    const dpt_pose end = tissue_tool_last_end(tissue, &tissue->tool[0]);
    oracle_mesh *brute = tissue_surface(tissue, &tissue->body[0]);
    double ends[6];
    pose_ends(&end, &tissue->tool[0].segment, ends);
    const double here = oracle_brute(brute, ends, NULL);
    for (int k = 0; k < 3; k++) {
        double moved[6];
        memcpy(moved, ends, sizeof moved);
        moved[k] += 1e-7;
        moved[3 + k] += 1e-7;
        normal[k] = (oracle_brute(brute, moved, NULL) - here) / 1e-7;
    }
    oracle_brute_close(brute);
}

/* Drawn aside until it slides: of one touch the force lies in the cone, and on it while it slides. */
static void a_touch_obeys_coulombs_law(void)
{
    struct tissue_rig tissue;
    double jump, most = 0.0, worst = 0.0;
    uint32_t stuck = 0, slid = 0;
    struct tissue_tool *rod = begin(&tissue, DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC, LEANING, &jump);
    if (rod)
        for (int t = 0; t < 400; t++) {
            double normal[3], across[3];
            rod->device.position[1] += TICK;
            tissue_rig_tick(&tissue);
            if (rod->force.sticking + rod->force.slipping != 1 || t % 4)
                continue;
            normal_at(&tissue, normal);
            const double push = dot3(rod->force.wrench.force, normal);
            for (int k = 0; k < 3; k++)
                across[k] = rod->force.wrench.force[k] - push * normal[k];
            const double share = length3(across) / push;
            stuck += rod->force.sticking;
            slid += rod->force.slipping;
            if (rod->force.slipping)
                worst = fmax(worst, fabs(share - SLIDE_MU));
            else
                most = fmax(most, share);
        }
    CHECK(stuck > 20 && slid > 20, "it stuck in %u ticks and slid in %u", stuck, slid);
    CHECK(most > 0.95 * HOLD_MU && most <= 1.005 * HOLD_MU, "it held up to %g of its push", most);
    CHECK(worst < 0.01 * SLIDE_MU, "sliding, it was off by %g", worst);
    tissue_rig_close(&tissue);
}

/* Until it rests, at home or trembling by 0.03 mm round it. */
static void tremble(struct tissue_rig *tissue, const double home[3], int ticks, uint64_t *seed)
{
    for (int t = 0; t < ticks; t++) {
        for (int k = 0; k < 3; k++)
            tissue->tool[0].device.position[k] = home[k] + random_in(seed, -1.5e-5, 1.5e-5);
        tissue_rig_tick(tissue);
    }
    memcpy(tissue->tool[0].device.position, home, 3 * sizeof *home);
    for (int t = 0; t < 500; t++)
        tissue_rig_tick(tissue);
}

/* Pulled aside and trembling: what sticks rolls, but does not creep. A first while is for the tissue to settle. */
static void what_sticks_does_not_creep(void)
{
    struct tissue_rig tissue;
    double jump;
    struct tissue_tool *rod = begin(&tissue, DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC, LEANING, &jump);
    if (rod) {
        const int ticks = 1000 * (int)part_of(100);
        uint64_t seed = 5;
        double home[3];
        for (int t = 0; t < 100; t++) {
            rod->device.position[1] += TICK;
            tissue_rig_tick(&tissue);
        }
        memcpy(home, rod->device.position, sizeof home);
        tremble(&tissue, home, 3000, &seed);
        const dpt_pose from = tissue_tool_last_end(&tissue, rod);
        tremble(&tissue, home, ticks, &seed);
        const dpt_pose to = tissue_tool_last_end(&tissue, rod);
        const double drift = apart(to.position, from.position);
        printf("    crept by %.3g m in %d ticks\n", drift, ticks);
        CHECK(rod->force.sticking == 1, "it does not stick");
        CHECK(drift < 1e-6, "it crept by %g m in %d ticks", drift, ticks);
    }
    tissue_rig_close(&tissue);
}

/* Round and round on the surface: forces and torques sum up to zero in each tick, and the device only ever gives work. */
static void rubbing_takes_work(void)
{
    struct tissue_rig tissue;
    double jump, worst = 0.0, peak = 0.0, work = 0.0, last[3], from[3];
    struct tissue_tool *rod = begin(&tissue, DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC, 1.5708, &jump);
    if (rod) {
        const double x = rod->device.position[0], y = rod->device.position[1];
        const int ticks = 1200;
        for (int t = 0; t < 3 * ticks; t++) {
            const double angle = 2.0 * PI * t / ticks;
            dpt_wrench on_body;
            double torque[3];
            memcpy(last, rod->force.wrench.force, sizeof last);
            memcpy(from, rod->device.position, sizeof from);
            rod->device.position[0] = x + AROUND * sin(angle);
            rod->device.position[1] = y + AROUND * (1.0 - cos(angle));
            peak = fmax(peak, tissue_rig_tick(&tissue));
            dpt_body_get_wrench(tissue.rig.world, tissue.body[0].id, &on_body);
            cross3(rod->device.position, rod->force.wrench.force, torque);
            for (int k = 0; k < 3; k++) {
                worst = fmax(worst, fabs(on_body.force[k] + rod->force.wrench.force[k]));
                worst = fmax(worst, fabs(on_body.torque[k] + rod->force.wrench.torque[k] + torque[k]));
                /* The first round begins with the tool straight below the device. */
                if (t >= ticks)
                    work -= 0.5 * (last[k] + rod->force.wrench.force[k]) * (rod->device.position[k] - from[k]);
            }
        }
        CHECK(worst <= 1e-12 * peak, "off by %g N of %g N", worst, peak);
        CHECK(work > 0.3 * SLIDE_MU * peak * 4.0 * PI * AROUND, "two rounds took %g J", work);
    }
    tissue_rig_close(&tissue);
}

/* A body that moves aside under a tool that sticks pulls it as a device that moves the other way does. */
static void a_body_carries_what_sticks(void)
{
    double pulled[2] = { 0.0, 0.0 };
    for (int by_body = 0; by_body < 2; by_body++) {
        struct tissue_rig tissue;
        double jump;
        struct tissue_tool *rod = begin(&tissue, DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC, LEANING, &jump);
        if (rod) {
            dpt_pose pose = DPT_POSE_IDENTITY;
            const double before = rod->force.wrench.force[1];
            for (int t = 0; t < 60; t++) {
                if (by_body) {
                    pose.position[1] -= TICK;
                    CHECK(dpt_body_set_pose(tissue.rig.world, tissue.body[0].id, &pose) == DPT_OK, "not moved");
                } else {
                    rod->device.position[1] += TICK;
                }
                tissue_rig_tick(&tissue);
            }
            for (int t = 0; t < 500; t++)
                tissue_rig_tick(&tissue);
            CHECK(rod->force.sticking == 1, "case %d: it does not stick", by_body);
            pulled[by_body] = rod->force.wrench.force[1] - before;
        }
        tissue_rig_close(&tissue);
    }
    CHECK(pulled[0] < -0.05, "it was pulled by %g N", pulled[0]);
    CHECK(fabs(pulled[1] - pulled[0]) < 0.01 * fabs(pulled[0]), "%g N by the device, %g N by the body", pulled[0],
          pulled[1]);
}

/* A damper is felt while the spring grows, makes nothing pull, and leaves a held tool silent. */
static void a_damper_is_felt_while_it_moves(void)
{
    double pressed[2] = { 0.0, 0.0 }, held[2] = { 0.0, 0.0 };
    for (int is_damped = 0; is_damped < 2; is_damped++) {
        struct tissue_rig tissue;
        dpt_tool_settings settings = { .size = sizeof settings };
        double jump;
        const struct tissue_def def = tissue_asleep(DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC);
        struct tissue_tool *rod = tissue_rig_open_rod(&tissue, 667.0, LEANING, 0.004);
        dpt_tool_get_settings(tissue.rig.world, rod->id, &settings);
        settings.damping = is_damped ? 1.0 : 0.0;
        CHECK(dpt_tool_set_settings(tissue.rig.world, rod->id, &settings) == DPT_OK, "not damped");
        if (tissue_rig_add_soft(&tissue, &def)) {
            jump = tissue_rod_press_and_hold(&tissue, 0.004, &held[is_damped]);
            CHECK(jump < 1e-3 * held[is_damped], "held, it jumps by %g N", jump);
            for (int t = 0; t < 100; t++) {
                tissue_rod_lower(&tissue, 0.004 + TICK * t);
                pressed[is_damped] = tissue_rig_tick(&tissue);
            }
            for (int t = 0; t < 60; t++) {
                tissue_rod_lower(&tissue, 0.006 - 1e-3 * t);
                tissue_rig_tick(&tissue);
                CHECK(rod->force.wrench.force[2] >= 0.0, "it pulls by %g N", rod->force.wrench.force[2]);
            }
        }
        tissue_rig_close(&tissue);
    }
    CHECK(fabs(held[1] - held[0]) < 5e-3 * held[0], "held, %g N and %g N", held[0], held[1]);
    /* The spring grows by less than the device moves, as the tissue gives way. */
    CHECK(pressed[1] > pressed[0] + 0.1 * TICK / 1e-3 && pressed[1] < pressed[0] + TICK / 1e-3,
          "pressed, %g N and %g N", pressed[0], pressed[1]);
}

/* Nm: what the loads that are told turn the body by, about z through the tool's origin. */
static double torque_of_loads(const struct tissue_rig *tissue)
{
    const struct tissue_body *body = &tissue->body[0];
    const double *origin = tissue->tool[0].device.position;
    dpt_load loads[TISSUE_LOADS];
    uint32_t count = 0, vertices;
    double sum = 0.0;
    dpt_body_get_loads(tissue->rig.world, body->id, loads, TISSUE_LOADS, &count);
    const float *at = tissue_vertices(tissue, body, &vertices);
    for (uint32_t i = 0; i < count; i++) {
        const float *v = at + 3 * loads[i].vertex;
        sum += (v[0] + body->place[0] - origin[0]) * loads[i].force[1];
        sum -= (v[1] + body->place[1] - origin[1]) * loads[i].force[0];
    }
    return sum;
}

/* rad: of a rod's end about z. */
static double turn_of_end(const struct tissue_rig *tissue)
{
    const dpt_pose end = tissue_tool_last_end(tissue, &tissue->tool[0]);
    return 2.0 * atan2(end.orientation[3], end.orientation[0]);
}

/* An upright rod is turned about the normal: the torque over 2/3 N a, a the radius of the disc on which its tip touches. */
static double turn_upright(struct tissue_rig *tissue, double turned)
{
    struct tissue_tool *rod = &tissue->tool[0];
    const double turn[4] = { cos(0.5 * turned), 0.0, 0.0, sin(0.5 * turned) }, radius = rod->segment.radius;
    memcpy(rod->device.orientation, turn, sizeof turn);
    tissue_rig_step_world(tissue);
    tissue_rig_step_springs(tissue);
    const double push = length3(rod->force.wrench.force);
    return -rod->force.wrench.torque[2] / (2.0 / 3.0 * push * fmin(radius, sqrt(2.0 * radius * push / rod->stiffness)));
}

/* While it sticks, its spring of K r^2 is wound up and its end turns as little as the surface does. Then it slips. */
static void a_touch_resists_a_turn_about_its_normal(void)
{
    enum { TURNS = 800 };
    for (int i = 0; i < TISSUE_INTEGRATORS; i++) {
        struct tissue_rig tissue;
        double jump, most = 0.0, off = 0.0, share = 0.0, first = 0.0;
        struct tissue_tool *rod = begin(&tissue, DPT_NET_VOLUME, tissue_integrators[i], 0.0, &jump);
        for (int t = 0; rod && t < TURNS; t++) {
            const double turned = 5e-4 * (t + 1);
            share = turn_upright(&tissue, turned);
            const double spring = rod->stiffness * rod->segment.radius * rod->segment.radius;
            const double torque = rod->force.wrench.torque[2], end = turn_of_end(&tissue);
            off = fmax(off, fabs(spring * (turned - end) + torque) / spring);
            most = fmax(most, share);
            first = t < TURNS / 2 ? end : first;
            if (t % 50 == 0) {
                uint32_t touches, others;
                const double asymmetry =
                    tissue_matrix_asymmetry(tissue.rig.world, tissue.body[0].id, &touches, &others);
                CHECK(touches && others && asymmetry < 1e-9, "%u pushes, %u rows that rub or twist: %g", touches,
                      others, asymmetry);
                CHECK(fabs(torque_of_loads(&tissue) + torque) <= 1e-7, "loads give %g Nm of %g",
                      torque_of_loads(&tissue), torque);
            }
        }
        CHECK(off < 1e-3, "integrator %d: the torque is off by %g rad", i, off);
        CHECK(first < 0.01, "integrator %d: it sticks, and turns by %g", i, first);
        CHECK(most > 0.98 * HOLD_MU && most < 1.005 * HOLD_MU, "integrator %d: it holds up to %g", i, most);
        CHECK(share > 0.99 * SLIDE_MU && share < 1.005 * HOLD_MU, "integrator %d: it slips with %g", i, share);
        CHECK(i == 1 || share < 1.01 * SLIDE_MU, "integrator %d: it slips with %g", i, share);
        tissue_rig_close(&tissue);
    }
}

static void what_sticks_does_not_twist(void)
{
    struct tissue_rig tissue;
    double jump;
    uint64_t seed = 11;
    if (begin(&tissue, DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC, 0.0, &jump)) {
        double turned = 0.0;
        while (turned < 1.0 && turn_upright(&tissue, turned) < 0.9 * HOLD_MU)
            turned += 5e-4;
        for (int t = 0; t < 500; t++)
            turn_upright(&tissue, turned);
        const double home = turn_of_end(&tissue);
        for (uint64_t t = 0; t < part_of(100000); t++)
            turn_upright(&tissue, turned + random_in(&seed, -2e-3, 2e-3));
        const double share = turn_upright(&tissue, turned);
        for (int t = 0; t < 500; t++)
            turn_upright(&tissue, turned);
        printf("    turned by %.3g rad of %.3g\n", turn_of_end(&tissue) - home, turned);
        CHECK(share > 0.8 * HOLD_MU, "it slips with %g", share);
        CHECK(fabs(turn_of_end(&tissue) - home) < 1e-4, "it creeps by %g rad", turn_of_end(&tissue) - home);
    }
    tissue_rig_close(&tissue);
}

enum { PRESSED = 400 };

/* A rod is pressed, turned and drawn aside, on a rough ball or sheet: all that it feels. */
static void press_on(uint32_t kernel, uint32_t kind, uint32_t integrator, dpt_wrench felt[PRESSED])
{
    const struct tissue_def def = tissue_asleep(kind, integrator);
    struct tissue_rig tissue;
    tissue_rig_open_on(&tissue, kernel);
    struct tissue_tool *rod = tissue_rig_add_tool(&tissue, &tissue_upright, 667.0);
    memset(felt, 0, PRESSED * sizeof *felt);
    if (tissue_rig_add_soft(&tissue, &def)) {
        tissue_body_roughen(&tissue, &tissue.body[0], HOLD_MU, SLIDE_MU);
        tissue_rod_lower(&tissue, -0.001);
        tissue_rig_place(&tissue);
        for (int t = 0; t < PRESSED; t++) {
            const double turn[4] = { 1.0, 1e-4, 0.0, 1e-3 };
            rod->device.position[1] += t > PRESSED / 2 ? TICK : 0.0;
            rod->device.position[2] -= TICK;
            pose_turn_by(&rod->device, turn);
            tissue_rig_tick(&tissue);
            felt[t] = rod->force.wrench;
        }
    }
    tissue_rig_close(&tissue);
}

static void all_kernels_have_the_same_bits(void)
{
    static dpt_wrench scalar[PRESSED], felt[PRESSED];
    uint32_t compared = 0;
    for (int i = 0; i < 2 + (int)part_of(4); i++) {
        const uint32_t kind = i & 1 ? DPT_NET_SHEET : DPT_NET_VOLUME, integrator = tissue_integrators[i % 3];
        press_on(DPT_KERNEL_SCALAR, kind, integrator, scalar);
        CHECK(length3(scalar[PRESSED - 1].force) > 1e-3, "case %d: it is not touched", i);
        for (uint32_t kernel = DPT_KERNEL_SCALAR + 1; kernel <= DPT_KERNEL_WASM128; kernel++)
            if (rig_has_kernel(kernel)) {
                press_on(kernel, kind, integrator, felt);
                CHECK(!memcmp(felt, scalar, sizeof felt), "case %d: %s has other bits", i, dpt_kernel_name(kernel));
                compared++;
            }
    }
    printf("    %u runs compared\n", compared);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(a_held_tool_sticks_and_is_silent);
    TEST(a_touch_obeys_coulombs_law);
    TEST(what_sticks_does_not_creep);
    TEST(rubbing_takes_work);
    TEST(a_body_carries_what_sticks);
    TEST(a_damper_is_felt_while_it_moves);
    TEST(a_touch_resists_a_turn_about_its_normal);
    TEST(what_sticks_does_not_twist);
    TEST(all_kernels_have_the_same_bits);
    return check_report();
}
