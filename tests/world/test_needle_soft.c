/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A needle that goes into a soft body: a wall that ruptures, friction along the shaft, what is felt and what the tissue
 * gets, holes that stay, silence, and no creep.
 *
 *     test_needle_soft [PER CENT = 100]
 */
#include "world/soft_needle.h"

#define PI 3.14159265358979323846

/* N: against going in. */
static double axial(const struct soft_needle *needle)
{
    return needle->tool->force.wrench.force[2];
}

/* m: how far any vertex went since the last call. */
static double fastest_vertex(const struct soft_needle *needle)
{
    static float last[3 * TISSUE_ROOM];
    uint32_t count;
    double farthest = 0.0;
    const float *at = tissue_vertices(&needle->tissue, needle->body, &count);
    for (uint32_t i = 0; i < count; i++) {
        const double way[3] = { (double)(at[3 * i] - last[3 * i]), (double)(at[3 * i + 1] - last[3 * i + 1]),
                                (double)(at[3 * i + 2] - last[3 * i + 2]) };
        farthest = fmax(farthest, length3(way));
    }
    memcpy(last, at, 3 * count * sizeof *at);
    return farthest;
}

static void a_wall_ruptures(void)
{
    for (int i = 0; i < TISSUE_INTEGRATORS; i++) {
        const struct tissue_def def = soft_needle_liver(tissue_integrators[i]);
        const dpt_body_settings gel = soft_needle_gel(20.0);
        const double stiffness = 200.0;
        struct soft_needle needle;
        double last = 0.0, before = 0.0, largest = 0.0, swung = 0.0;
        uint32_t ruptures = 0, flagged = 0;
        if (!soft_needle_open(&needle, &def, &gel, stiffness))
            return;
        for (int k = 0; k < 1500; k++) {
            needle.depth += NEEDLE_SLOW;
            const double force = soft_needle_tick(&needle), jump = fabs(force - last);
            swung = fastest_vertex(&needle);
            const uint32_t flags = needle.tool->force.flags;
            if (flags & DPT_FORCE_FLAG_RUPTURE) {
                before = ruptures ? before : last;
                ruptures = 1;
                flagged++;
                CHECK(jump <= stiffness * (3.0 * NEEDLE_SLOW + 1e-3) * 1.001, "a drop of %g N", jump);
            } else {
                /* What ruptured swings back, and takes the needle along. */
                largest = fmax(largest, jump - (ruptures ? stiffness * swung : 0.0));
            }
            last = force;
        }
        const dpt_channel channel = soft_needle_channel(&needle);
        CHECK(largest <= 1.2 * stiffness * NEEDLE_SLOW, "%d: a jump of %g N without a flag", i, largest);
        CHECK(ruptures && flagged <= 4 && channel.ruptures == 1, "%d: %u ticks flagged, %u walls", i, flagged,
              channel.ruptures);
        CHECK(before >= gel.puncture_force && before <= gel.puncture_force + 2.0 * stiffness * NEEDLE_SLOW,
              "%d: it ruptured at %g N", i, before);
        CHECK(channel.flags == DPT_CHANNEL_FLAG_OCCUPIED && channel.depth > 0.005, "%d: %g m in", i, channel.depth);
        soft_needle_close(&needle);
    }
}

/* phi l and the cut are felt, l by all triangles; and the body gets what is felt. */
static void the_shaft_rubs_by_its_length(void)
{
    for (int i = 0; i < TISSUE_INTEGRATORS; i++) {
        const struct tissue_def def = soft_needle_liver(tissue_integrators[i]);
        const dpt_body_settings gel = soft_needle_gel(15.0);
        struct soft_needle needle;
        if (!soft_needle_open(&needle, &def, &gel, 500.0))
            return;
        for (double depth = 0.012; depth < 0.045; depth += 0.008) {
            soft_needle_go(&needle, depth);
            const double inside = soft_needle_inside(&needle), wanted = gel.cutting_force + gel.shaft_friction * inside;
            const dpt_channel channel = soft_needle_channel(&needle);
            CHECK(inside > 0.003 && fabs(channel.inside - inside) < 1e-4, "%d: %g m inside, told %g", i, inside,
                  channel.inside);
            CHECK(fabs(axial(&needle) - wanted) <= 0.02 * wanted, "%d: at %g m %g N, not %g", i, depth, axial(&needle),
                  wanted);
            CHECK(fabs(channel.friction + channel.tip - axial(&needle)) < 1e-2 * wanted, "%d: told %g and %g N", i,
                  channel.friction, channel.tip);
        }
        soft_needle_close(&needle);
    }
}

/* Forces and moments of the loads and the wrench, about the world's origin. */
static void loads_balance(void)
{
    const struct tissue_def def = soft_needle_liver(DPT_INTEGRATOR_SYMPLECTIC);
    const dpt_body_settings gel = soft_needle_gel(15.0);
    struct soft_needle needle;
    if (!soft_needle_open(&needle, &def, &gel, 500.0))
        return;
    double worst = 0.0, peak = 0.0;
    for (int k = 0; k < 2500; k++) {
        static float at[3 * TISSUE_ROOM];
        dpt_load loads[TISSUE_LOADS];
        double sum[3], torque[3], moment[3];
        uint32_t count = 0, vertices;
        needle.depth += k < 2000 ? NEEDLE_SLOW : 0.0;
        needle.tool->device.position[0] = NEEDLE_LATERAL + (k > 1500 ? 4e-6 * (k - 1500) : 0.0);
        soft_needle_aim(&needle);
        tissue_rig_step_world(&needle.tissue);
        const float *positions = tissue_vertices(&needle.tissue, needle.body, &vertices);
        memcpy(at, positions, 3 * vertices * sizeof *at);
        tissue_rig_step_springs(&needle.tissue);
        const dpt_wrench *wrench = &needle.tool->force.wrench;
        const dpt_result result =
            dpt_body_get_loads(needle.tissue.rig.world, needle.body->id, loads, TISSUE_LOADS, &count);
        CHECK(result == DPT_OK, "loads: %s", dpt_result_name(result));
        cross3(needle.tool->device.position, wrench->force, torque);
        for (int c = 0; c < 3; c++) {
            sum[c] = wrench->force[c];
            torque[c] += wrench->torque[c];
        }
        for (uint32_t i = 0; i < count; i++) {
            double place[3];
            for (int c = 0; c < 3; c++)
                place[c] = (double)at[3 * loads[i].vertex + (uint32_t)c] + needle.body->place[c];
            cross3(place, loads[i].force, moment);
            for (int c = 0; c < 3; c++) {
                sum[c] += loads[i].force[c];
                torque[c] += moment[c];
            }
        }
        worst = fmax(worst, fmax(length3(sum), length3(torque)));
        peak = fmax(peak, length3(wrench->force));
    }
    CHECK(peak > 0.4 && worst <= 1e-12 * peak, "loads are off by %g of %g N", worst, peak);
    soft_needle_close(&needle);
}

/* 20 Hz and more of 51 ms, as `dynpoint stability hum` has it: what is left of a line, and the jumps. */
static void check_silent(struct soft_needle *needle, const char *what, double dt)
{
    enum { ROOM = 5100 };
    static double force[ROOM];
    const int window = (int)(0.051 / dt), ticks = 10 * window;
    double hum = 0.0, jump = 0.0, mean = 0.0;
    for (int i = 0; i < ticks; i++) {
        force[i] = soft_needle_tick(needle);
        mean += force[i] / ticks;
        jump = fmax(jump, i ? fabs(force[i] - force[i - 1]) : 0.0);
    }
    for (int from = 0; from + window <= ticks; from += window) {
        double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, square = 0.0, cosine = 0.0, sine = 0.0;
        for (int i = 0; i < window; i++) {
            x += i;
            y += force[from + i];
            xx += (double)i * i;
            xy += i * force[from + i];
        }
        const double slope = (window * xy - x * y) / (window * xx - x * x), start = (y - slope * x) / window;
        for (int i = 0; i < window; i++) {
            const double off = force[from + i] - start - slope * i, turn = 2.0 * PI * i / window;
            square += off * off / window;
            cosine += off * cos(turn);
            sine += off * sin(turn);
        }
        /* One turn in the window is sway, below 20 Hz. */
        square -= 2.0 * (cosine * cosine + sine * sine) / window / window;
        hum = fmax(hum, sqrt(fmax(square, 0.0)));
    }
    CHECK(mean > 0.1 && hum <= fmax(1e-3 * mean, 1e-4), "%s: hum of %g N at %g", what, hum, mean);
    CHECK(jump <= 1e-3 * mean, "%s: a jump of %g N at %g", what, jump, mean);
}

static void a_still_needle_is_silent(void)
{
    static const double stiffnesses[] = { 200.0, 667.0, 2000.0 };
    for (int i = 0; i < (int)part_of(18); i++) {
        const struct tissue_def def = soft_needle_liver(tissue_integrators[i % 3]);
        dpt_body_settings gel = soft_needle_gel(15.0);
        const double dt = i / 9 ? 1e-4 : 1e-3;
        struct soft_needle needle;
        char what[80];
        gel.shaft_viscosity = i % 2 ? 20.0 : 0.0;
        if (!soft_needle_open(&needle, &def, &gel, stiffnesses[i / 3 % 3]))
            return;
        soft_needle_go(&needle, 0.03);
        needle.tissue.rig.dt = dt;
        needle.tool->device.position[0] += 0.001;
        soft_needle_hold(&needle, (int)(0.4 / dt));
        snprintf(what, sizeof what, "integrator %d, %g N/m, %g s", i % 3, stiffnesses[i / 3 % 3], dt);
        check_silent(&needle, what, dt);
        soft_needle_close(&needle);
    }
}

/* A hand that trembles beneath the limit of friction: the shaft is where it was, in the tissue. */
static void nothing_creeps(void)
{
    const struct tissue_def def = soft_needle_liver(DPT_INTEGRATOR_SYMPLECTIC);
    const dpt_body_settings gel = soft_needle_gel(30.0);
    const int ticks = (int)part_of(100000);
    struct soft_needle needle;
    uint64_t seed = 7;
    if (!soft_needle_open(&needle, &def, &gel, 500.0))
        return;
    soft_needle_go(&needle, 0.04);
    /* Back, until it holds with 0.9 of its limit the other way. */
    while (axial(&needle) > -0.9 * gel.shaft_friction * soft_needle_channel(&needle).inside)
        soft_needle_go(&needle, needle.depth - 1e-4);
    const double held = needle.depth;
    soft_needle_hold(&needle, 3000);
    const double depth = soft_needle_channel(&needle).depth;
    for (int k = 0; k < ticks; k++) {
        needle.depth = held + random_in(&seed, -3e-5, 3e-5);
        soft_needle_tick(&needle);
    }
    needle.depth = held;
    soft_needle_hold(&needle, 3000);
    const double crept = soft_needle_channel(&needle).depth - depth;
    CHECK(fabs(crept) < 1e-6, "crept by %g m in %d ticks", crept, ticks);
    soft_needle_close(&needle);
}

/* Drawn out, and in again: its own hole takes no rupture and nothing to cut, and is where the tissue has it. */
static void a_hole_stays(void)
{
    for (int i = 0; i < TISSUE_INTEGRATORS; i++) {
        const struct tissue_def def = soft_needle_liver(tissue_integrators[i]);
        const dpt_body_settings gel = soft_needle_gel(15.0);
        struct soft_needle needle;
        uint32_t ruptures = 0;
        if (!soft_needle_open(&needle, &def, &gel, 500.0))
            return;
        soft_needle_go(&needle, 0.03);
        const double first = axial(&needle);
        soft_needle_go(&needle, -0.002);
        CHECK(!(needle.tool->force.flags & DPT_FORCE_FLAG_INSERTED), "%d: it is not out", i);
        CHECK(soft_needle_channel(&needle).flags == 0 && length3(needle.tool->force.wrench.force) == 0.0,
              "%d: still held", i);
        soft_needle_hold(&needle, 500);
        while (needle.depth < 0.02) {
            soft_needle_go(&needle, needle.depth + NEEDLE_SLOW);
            ruptures += (needle.tool->force.flags & DPT_FORCE_FLAG_RUPTURE) != 0;
        }
        const dpt_channel channel = soft_needle_channel(&needle);
        CHECK(ruptures == 0 && channel.flags == DPT_CHANNEL_FLAG_OCCUPIED, "%d: %u ruptures, flags %x", i, ruptures,
              channel.flags);
        CHECK(channel.tip < 1e-3 && first > 0.3, "%d: %g N at the tip", i, channel.tip);
        CHECK(fabs(axial(&needle) - gel.shaft_friction * channel.inside) < 0.02 * first, "%d: %g N", i, axial(&needle));
        soft_needle_close(&needle);
    }
}

/* The hand goes aside: the tissue holds the needle, which stays in its hole. */
static void tissue_holds_it_across(void)
{
    for (int i = 0; i < TISSUE_INTEGRATORS; i++) {
        const struct tissue_def def = soft_needle_liver(tissue_integrators[i]);
        const dpt_body_settings gel = soft_needle_gel(15.0);
        struct soft_needle needle;
        double aside = 0.0, sum;
        if (!soft_needle_open(&needle, &def, &gel, 500.0))
            return;
        soft_needle_go(&needle, 0.03);
        for (int k = 0; k < 1500; k++) {
            needle.tool->device.position[0] += k < 500 ? 2e-5 : 0.0;
            soft_needle_tick(&needle);
            aside = fmax(aside, soft_needle_beside_entry(&needle));
        }
        sum = fabs(needle.tool->force.wrench.force[0]);
        CHECK(aside < 0.1 * NEEDLE_RADIUS, "%d: it left its hole by %g m", i, aside);
        CHECK(sum > 0.05, "%d: %g N aside", i, sum);
        soft_needle_close(&needle);
    }
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(a_wall_ruptures);
    TEST(the_shaft_rubs_by_its_length);
    TEST(loads_balance);
    TEST(tissue_holds_it_across);
    TEST(a_hole_stays);
    TEST(a_still_needle_is_silent);
    TEST(nothing_creeps);
    return check_report();
}
