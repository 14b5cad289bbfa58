/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What brakes, pulls and delays the simulated device's masses, against closed forms: stop distance, stiction, the
 * oscillator with dry friction, breaking away under a motor's lag, free fall, the hand's mass. A long period is compared
 * with the same time in 256 short ones.
 */
#include <math.h>

#include "drivers/open_device.h"

static int is_same(const dpt_device_state *a, const dpt_device_state *b)
{
    return !memcmp(a->joint, b->joint, sizeof a->joint) && !memcmp(a->velocity, b->velocity, sizeof a->velocity);
}

/* A push of n periods, then none: it slides v^2 m / 2 f_c far, and stays there bit for bit. */
static void it_stops_where_friction_has_taken_its_energy(void)
{
    static const double masses[] = { 0.05, 0.1, 1.0 }, frictions[] = { 0.073, 0.31, 2.53 }, rates[] = { 1000.0, 37.0 };
    for (int m = 0; m < 3; m++)
        for (int f = 0; f < 3; f++)
            for (int r = 0; r < 2; r++) {
                const double mass = masses[m], friction = frictions[f], rate = rates[r];
                dpt_device *device = device_named("sim:?mass=%g&damping=0&friction=%g&rate=%g", mass, friction, rate);
                const long double pushed = 17.0L / rate, a = (7.0L - friction) / mass;
                const long double v = a * pushed, brake = friction / (long double)mass;
                const long double begin = 0.5L * a * pushed * pushed, end = begin + 0.5L * v * v / brake;
                dpt_device_state state = state_of(device), before;
                const int last = (int)ceill((pushed + v / brake) * rate) + 20;
                for (int n = 1; n <= last; n++) {
                    before = state;
                    write_force(device, n <= 17 ? -7.0 : 0.0, 0.0, 0.0);
                    state = state_of(device);
                    const long double t = n / (long double)rate - pushed;
                    const int stands = t > v / brake;
                    if (t < 0.0L)
                        continue;
                    const long double x = stands ? end : begin + t * (v - 0.5L * brake * t);
                    CHECK(fabsl(-x - state.pose.position[0]) < 1e-12L * end, "period %d: %g, not %g", n,
                          state.pose.position[0], (double)-x);
                    CHECK((state.velocity[0] == 0.0) == stands, "period %d: %g m/s", n, state.velocity[0]);
                    CHECK(t - 1.0L / rate < v / brake || is_same(&before, &state), "it creeps");
                }
                dpt_device_close(device);
            }
}

static void at_rest_it_stays_bit_for_bit(void)
{
    struct small_file place = file_with("t,x,y,z,rx,ry,rz\n0,0.01,-0.02,0.003,0.1,0.2,-0.3\n");
    dpt_device *device = device_named("sim:?dofs=6&friction=0.25&stiction=0.5&turn_friction=0.01&turn_stiction=0.02&"
                                      "gravity=2&hand_mass=0.1&lag=0.001&hand=%s",
                                      place.path);
    const double weight = 2.0 * (0.1 + 0.1);
    uint64_t random = 5;
    const dpt_device_state first = state_of(device);
    for (int n = 0; n < 3000; n++) {
        dpt_wrench wrench;
        for (int k = 0; k < 3; k++) {
            wrench.force[k] = random_in(&random, -0.5, 0.5) + (k == 1 ? weight : 0.0);
            wrench.torque[k] = random_in(&random, -0.02, 0.02);
        }
        if (n == 0)
            wrench.force[1] = weight; /* the motor begins at 0 */
        CHECK(dpt_device_write(device, &wrench) == DPT_OK, "write");
        const dpt_device_state state = state_of(device);
        CHECK(is_same(&first, &state), "period %d: it moves", n);
    }
    dpt_device_close(device);
    unlink(place.path);
}

/* One unit in the last place decides, in both directions; then `friction` brakes, not `stiction`. */
static void it_breaks_away_above_stiction(void)
{
    for (int sign = -1; sign <= 1; sign += 2)
        for (int above = 0; above < 2; above++) {
            dpt_device *device = device_named("sim:?mass=0.5&damping=0&friction=0.25&stiction=0.75");
            const double force = sign * (above ? nextafter(0.75, 1.0) : 0.75);
            state_of(device);
            for (int n = 1; n <= 50; n++) {
                write_force(device, 0.0, 0.0, force);
                const double z = state_of(device).pose.position[2], t = n * 1e-3;
                CHECK(above ? fabs(z - sign * 0.5 * t * t) < 1e-12 : z == 0.0, "period %d: %g", n, z);
            }
            dpt_device_close(device);
        }
}

/*
 * The spring's centre jumps by A. Without a damper each half swing loses 2 f_c / k; it stops at the first turning point
 * where the spring is not above stiction. At 7 Hz it swings several times within a period.
 */
static void an_oscillator_loses_as_much_in_each_swing(void)
{
    const double mass = 0.2, spring = 500.0, friction = 0.3, stiction = 1.1, a = 0.02;
    const double w = sqrt(spring / mass), rates[] = { 1000.0, 100.0, 7.0 };
    int swings = 0;
    while (spring * (a - 2.0 * swings * friction / spring) > stiction)
        swings++;
    const double rest = (swings % 2 ? -1.0 : 1.0) * (a - 2.0 * swings * friction / spring);
    const double time = swings * 3.14159265358979324 / w;
    CHECK(swings > 5, "%d swings", swings);
    for (int r = 0; r < 3; r++) {
        char text[64];
        snprintf(text, sizeof text, "t,x,y,z\n0,0,0,0\n%.17g,0,%g,0\n", 0.5 / rates[r], a);
        struct small_file jump = file_with(text);
        dpt_device *device = device_named("sim:?mass=%g&damping=0&grip=%g&friction=%g&stiction=%g&rate=%g&hand=%s",
                                          mass, spring, friction, stiction, rates[r], jump.path);
        dpt_device_state state = state_of(device);
        for (int n = 1; n < 2.0 + (time + 0.2) * rates[r]; n++) {
            state = state_of(device);
            const double t = (n - 1) / rates[r];
            const int swing = (int)floor(t * w / 3.14159265358979324);
            const double sign = swing % 2 ? -1.0 : 1.0;
            const double part = a - (2.0 * swing + 1.0) * friction / spring;
            const double x = t >= time ? -rest : -sign * friction / spring - part * cos(w * t);
            CHECK(fabs(state.pose.position[1] - a - x) < 1e-12, "%g Hz, %g s: %.17g, not %.17g", rates[r], t,
                  state.pose.position[1] - a, x);
            CHECK((state.velocity[1] == 0.0) == (t >= time || n == 1), "%g Hz, %g s: %g m/s", rates[r], t,
                  state.velocity[1]);
        }
        dpt_device_close(device);
        unlink(jump.path);
    }
}

/* Where a free mass is when a force F (1 - exp(-t / lag)) has acted for t, and how fast. */
static void lagged_push(long double force, long double mass, long double lag, long double t, long double *x,
                        long double *v)
{
    const long double gone = -expm1l(-t / lag);
    *v = force / mass * (t - lag * gone);
    *x = force / mass * (0.5L * t * t - lag * (t - lag * gone));
}

static void the_force_follows_with_a_lag(void)
{
    static const double lags[] = { 1e-5, 2e-4, 1e-3, 0.02, 1.0 };
    for (int l = 0; l < 5; l++) {
        dpt_device *device = device_named("sim:?mass=0.25&damping=0&lag=%.17g", lags[l]);
        dpt_device_info info = { .size = sizeof info };
        CHECK(dpt_device_get_info(device, &info) == DPT_OK && info.delay == lags[l], "%g s", info.delay);
        for (int n = 0; n < 300; n++) {
            const dpt_device_state state = state_of(device);
            long double x, v;
            lagged_push(3.0L, 0.25L, lags[l], n * 1e-3L, &x, &v);
            CHECK(fabsl(x - state.pose.position[0]) <= 1e-9L * x && fabsl(v - state.velocity[0]) <= 1e-9L * v,
                  "lag %g, period %d: %.17g, not %.17g", lags[l], n, state.pose.position[0], (double)x);
            write_force(device, 3.0, 0.0, 0.0);
        }
        dpt_device_close(device);
    }
}

/* The motor's force reaches stiction within a period: it breaks away then. */
static void a_lagging_motor_breaks_away_within_a_period(void)
{
    const long double lag = 0.004L, force = 3.0L, stiction = 1.3L, friction = 0.6L, mass = 0.2L;
    const long double leaves = -lag * log1pl(-stiction / force);
    dpt_device *device = device_named("sim:?mass=0.2&damping=0&friction=0.6&stiction=1.3&lag=0.004");
    const dpt_device_state first = state_of(device);
    long double x0, v0;
    lagged_push(force, mass, lag, leaves, &x0, &v0);
    for (int n = 1; n <= 200; n++) {
        write_force(device, 3.0, 0.0, 0.0);
        const dpt_device_state state = state_of(device);
        const long double t = n * 1e-3L, slides = t - leaves;
        long double x, v;
        lagged_push(force, mass, lag, t, &x, &v);
        x -= x0 + v0 * slides + 0.5L * friction / mass * slides * slides;
        v -= v0 + friction / mass * slides;
        CHECK(slides < 0.0L ? is_same(&first, &state)
                            : fabsl(x - state.pose.position[0]) < 1e-13L && fabsl(v - state.velocity[0]) < 1e-13L,
              "period %d: %g m, %g m/s", n, state.pose.position[0], state.velocity[0]);
    }
    dpt_device_close(device);
}

/* Random pushes: stops, starts and turns within a period are found, however long the period is. */
static void a_long_period_is_its_parts(void)
{
    static const char *const laws[] = {
        "mass=0.1&damping=0.5&friction=0.4&stiction=0.7",
        "mass=0.1&damping=0&friction=0.4",
        "mass=0.1&damping=0.5&friction=0.4&stiction=0.7&lag=0.02",
        "mass=0.1&damping=0&friction=0.2&lag=0.05",
        "mass=0.1&damping=0.1&stiction=0.3&lag=0.03&hand=hold&grip=100",
        "mass=0.05&damping=0&friction=0.1&stiction=0.2&lag=0.002&hand=hold&grip=3000",
        "mass=0.05&damping=0&friction=0.05&stiction=0.1&lag=0.01&hand=hold&grip=110",
        "mass=0.05&damping=0&friction=0.05&stiction=0.1&lag=0.02&hand=hold&grip=110",
        "mass=0.02&damping=3&friction=0.1&stiction=0.2&lag=0.1&hand=hold&grip=50",
    };
    int rests = 0, turns = 0;
    for (size_t l = 0; l < sizeof laws / sizeof *laws; l++) {
        dpt_device *whole = device_named("sim:?rate=16&force=100&watchdog=0&%s", laws[l]),
                   *parts = device_named("sim:?rate=4096&force=100&watchdog=0&%s", laws[l]);
        uint64_t random = l;
        dpt_device_state state = state_of(whole), fine = state_of(parts);
        double largest = 0.0;
        for (int n = 0; n < 300; n++) {
            double force[3];
            for (int k = 0; k < 3; k++)
                force[k] = random_in(&random, 0.0, 1.0) < 0.3 ? 0.0 : random_in(&random, -1.5, 1.5);
            write_force(whole, force[0], force[1], force[2]);
            state = state_of(whole);
            for (int part = 0; part < 256; part++) {
                const dpt_device_state before = fine;
                write_force(parts, force[0], force[1], force[2]);
                fine = state_of(parts);
                for (int k = 0; k < 3; k++)
                    turns += before.velocity[k] * fine.velocity[k] < 0.0;
            }
            for (int k = 0; k < 3; k++) {
                largest = fmax(largest, fabs(fine.pose.position[k]));
                rests += state.velocity[k] == 0.0;
                CHECK(fabs(state.pose.position[k] - fine.pose.position[k]) <= 1e-9 * largest &&
                          (state.velocity[k] == 0.0) == (fine.velocity[k] == 0.0),
                      "law %d, period %d, axis %d: %.17g, in parts %.17g", (int)l, n, k, state.pose.position[k],
                      fine.pose.position[k]);
            }
        }
        dpt_device_close(whole);
        dpt_device_close(parts);
    }
    CHECK(rests > 500 && turns > 300, "%d at rest, %d turns", rests, turns);
}

/* The motor stops it, drives it on, and the spring slows it again, all in the third period. */
static void a_short_stop_is_not_missed(void)
{
    static const double cases[][5] = {
        { 175.0, 0.021, -2.0, -4.1, -6.9 },
        { 201.0, 0.008, -1.4, -3.3, -4.6 },
        { 196.0, 0.004, 2.2, 5.6, 7.8 },
        { 168.0, 0.016, 1.9, 3.9, 7.0 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double x[2];
        int stops = 0;
        for (int is_fine = 0; is_fine < 2; is_fine++) {
            const int parts = is_fine ? 256 : 1;
            dpt_device *device =
                device_named("sim:?rate=%d&mass=0.1&damping=0&friction=0.05&stiction=0.1&grip=%g&lag=%g&"
                             "hand=hold&watchdog=0",
                             16 * parts, cases[i][0], cases[i][1]);
            double before = state_of(device).velocity[0];
            for (int n = 0; n < 3 * parts; n++) {
                write_force(device, cases[i][2 + n / parts], 0.0, 0.0);
                const dpt_device_state state = state_of(device);
                stops += n > 2 * parts && before * state.velocity[0] <= 0.0;
                x[is_fine] = state.pose.position[0];
                before = state.velocity[0];
            }
            dpt_device_close(device);
        }
        CHECK(stops > 0 && fabs(x[0] - x[1]) < 1e-12, "case %d: %.17g, in parts %.17g, %d stops", (int)i, x[0], x[1],
              stops);
    }
}

static void it_falls(void)
{
    dpt_device *free = device_named("sim:?gravity=9.81&damping=0"),
               *braked = device_named("sim:?gravity=9.81&mass=0.2&damping=4"),
               *held = device_named("sim:?gravity=9.81&mass=0.2&hand_mass=0.3&hand_damping=10&"
                                    "hand=hold&grip=250"),
               *carried = device_named("sim:?gravity=9.81&mass=0.2&dofs=6&force=100");
    dpt_device_state state;
    for (int n = 0; n <= 3000; n++) {
        const long double t = n * 1e-3L, end = 9.81L * 0.2L / 4.0L;
        state = state_of(free);
        CHECK(fabsl(state.pose.position[1] + 0.5L * 9.81L * t * t) <= 1e-12L * t && state.pose.position[0] == 0.0 &&
                  state.pose.position[2] == 0.0,
              "%g s: %g", (double)t, state.pose.position[1]);
        state = state_of(braked);
        CHECK(fabsl(state.velocity[1] - end * expm1l(-t * 20.0L)) < 1e-13L, "%g s: %g m/s", (double)t,
              state.velocity[1]);
        state = state_of(carried);
        CHECK(fabs(state.pose.position[1]) < 1e-12, "%g s: %g", (double)t, state.pose.position[1]);
        write_force(carried, 0.0, 9.81 * 0.2, 0.0);
        state = state_of(held);
    }
    CHECK(fabs(state.pose.position[1] + 0.5 * 9.81 / 250.0) < 1e-9, "the hand sags by %g", state.pose.position[1]);
    dpt_device_close(free);
    dpt_device_close(braked);
    dpt_device_close(held);
    dpt_device_close(carried);
}

/* The hand's mass and damping are the device's own where there is a hand; it does not report them. */
static void the_hand_adds_to_the_device(void)
{
    static const char with[] = "hand_mass=0.25&hand_damping=2&hand_inertia=0.0009765625&hand_turn_damping=0.001953125";
    static const char own[] = "dofs=6&mass=0.125&damping=0.5&inertia=0.000244140625&"
                              "turn_damping=0.0009765625&gravity=1";
    static const char both[] = "dofs=6&mass=0.375&damping=2.5&inertia=0.001220703125&"
                               "turn_damping=0.0029296875&gravity=1";
    struct small_file forces = file_with("t,fx,fy,fz\n0,0.5,0,0\n1,-0.5,0,0.2\n");
    const char *const hands[] = { "", "wipe", forces.path };
    for (int h = 0; h < 3; h++) {
        const char *hand = hands[h];
        dpt_device *device = device_named("sim:?%s&%s&hand=%s", own, with, hand),
                   *twin = device_named("sim:?%s&hand=%s", h ? both : own, hand);
        dpt_device_info info = { .size = sizeof info };
        CHECK(dpt_device_get_info(device, &info) == DPT_OK && info.mass == 0.125 && info.damping == 0.5 &&
                  info.inertia == 0.000244140625 && info.spin_damping == 0.0009765625,
              "it reports the hand's");
        for (int n = 0; n < 500; n++) {
            dpt_device_state a = state_of(device), b = state_of(twin);
            CHECK(is_same(&a, &b), "hand '%s', period %d: %g, not %g", hand, n, a.pose.position[1], b.pose.position[1]);
            const dpt_wrench wrench = { { 0.3, -0.1, 0.2 }, { 0.01, 0.0, -0.02 } };
            dpt_device_write(device, &wrench);
            dpt_device_write(twin, &wrench);
        }
        dpt_device_close(device);
        dpt_device_close(twin);
    }
    unlink(forces.path);
}

static void it_reports_its_friction(void)
{
    for (int dofs = 3; dofs <= 6; dofs += 3) {
        dpt_device *device = device_named("sim:?dofs=%d&friction=0.25&stiction=0.5&turn_friction=0.125&delay=2.5&"
                                          "lag=0.25&jitter=0.0005",
                                          dofs);
        dpt_device_info info = { .size = sizeof info };
        CHECK(dpt_device_get_info(device, &info) == DPT_OK && info.friction == 0.25 &&
                  info.spin_friction == (dofs == 6 ? 0.125 : 0.0),
              "%g N, %g Nm", info.friction, info.spin_friction);
        CHECK(fabs(info.delay - 0.25275) < 1e-15, "%g s", info.delay);
        dpt_device_close(device);
    }
}

int main(void)
{
    TEST(it_stops_where_friction_has_taken_its_energy);
    TEST(at_rest_it_stays_bit_for_bit);
    TEST(it_breaks_away_above_stiction);
    TEST(an_oscillator_loses_as_much_in_each_swing);
    TEST(the_force_follows_with_a_lag);
    TEST(a_lagging_motor_breaks_away_within_a_period);
    TEST(a_long_period_is_its_parts);
    TEST(a_short_stop_is_not_missed);
    TEST(it_falls);
    TEST(the_hand_adds_to_the_device);
    TEST(it_reports_its_friction);
    return check_report();
}
