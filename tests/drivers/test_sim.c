/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The simulated device against closed forms of m x'' = -c x' - k x + F in long double: each force lasts a period, and
 * the motion is the sum of what its changes do (superposition of step responses). Then its energy, encoders, delay,
 * watchdog, hand, faults, and that the same calls give the same bits.
 */
#include <math.h>
#include <time.h>

#include "drivers/open_device.h"

/* Where a constant 1 N from time 0 brings a mass at rest, and how fast it is then. */
struct response {
    long double x, v;
};

static struct response step_response(long double m, long double c, long double k, long double t)
{
    struct response r;
    long double a = c / (2.0L * m), square = k / m - a * a;
    if (k == 0.0L && c == 0.0L) {
        r = (struct response){ 0.5L * t * t / m, t / m };
    } else if (k == 0.0L) {
        long double lag = -expm1l(-c * t / m);
        r = (struct response){ (t - lag * m / c) / c, lag / c };
    } else if (square > 0.0L) {
        long double w = sqrtl(square), e = expl(-a * t);
        r = (struct response){ (1.0L - e * (cosl(w * t) + a / w * sinl(w * t))) / k, e * sinl(w * t) / (w * m) };
    } else if (square == 0.0L) {
        long double e = expl(-a * t);
        r = (struct response){ (1.0L - e * (1.0L + a * t)) / k, e * t / m };
    } else {
        long double w = sqrtl(-square), slow = a - w, fast = a + w;
        long double s = expl(-slow * t), f = expl(-fast * t);
        r = (struct response){ (1.0L - (fast * s - slow * f) / (2.0L * w)) / k, (s - f) / (2.0L * w * m) };
    }
    return r;
}

/* Mass, damping, spring: free, nearly free, light, critical, heavy, stiff. The critical one is exact in binary;
 * none is so nearly free that the closed form itself cancels. */
static const double laws[][3] = {
    { 0.1, 0.5, 0.0 },    { 0.1, 0.0, 0.0 },       { 0.1, 1e-3, 0.0 },  { 0.1, 0.5, 200.0 },  { 0.25, 8.0, 64.0 },
    { 0.1, 20.0, 200.0 }, { 0.045, 5.0, 50000.0 }, { 0.001, 3.0, 1.0 }, { 0.1, 0.0, 1000.0 }, { 0.05, 0.2, 2.0 },
};
enum { LAWS = sizeof laws / sizeof *laws };

static dpt_device *mass_at_rest(const double *law, double rate)
{
    return device_named("sim:?mass=%.17g&damping=%.17g&grip=%.17g&hand=hold&rate=%.17g&force=1000", law[0], law[1],
                        law[2], rate);
}

static void forces_add_up_as_the_closed_form_says(void)
{
    enum { PERIODS = 400 };
    static const double rates[] = { 1000.0, 4000.0, 100.0 };
    double worst = 0.0;
    for (int l = 0; l < LAWS; l++)
        for (int r = 0; r < 3; r++) {
            uint64_t random = (uint64_t)(10 * l + r);
            double force[PERIODS][3], largest[3] = { 0.0 }, fastest[3] = { 0.0 };
            dpt_device *device = mass_at_rest(laws[l], rates[r]);
            for (int n = 0; n < PERIODS; n++) {
                for (int k = 0; k < 3; k++)
                    force[n][k] =
                        n && random_in(&random, 0.0, 1.0) < 0.7 ? force[n - 1][k] : random_in(&random, -5.0, 5.0);
                dpt_device_state state = state_of(device);
                write_force(device, force[n][0], force[n][1], force[n][2]);
                for (int k = 0; k < 3; k++) {
                    long double x = 0.0L, v = 0.0L;
                    for (int j = 0; j < n; j++) {
                        long double change = (long double)force[j][k] - (j ? force[j - 1][k] : 0.0);
                        struct response s =
                            step_response(laws[l][0], laws[l][1], laws[l][2], (long double)(n - j) / rates[r]);
                        x += change * s.x;
                        v += change * s.v;
                    }
                    largest[k] = fmax(largest[k], (double)fabsl(x));
                    fastest[k] = fmax(fastest[k], (double)fabsl(v));
                    double off = (double)fabsl(x - state.pose.position[k]) / (largest[k] + 1e-300);
                    double off_v = (double)fabsl(v - state.velocity[k]) / (fastest[k] + 1e-300);
                    worst = fmax(worst, fmax(off, off_v));
                    CHECK(n == 0 || (off < 1e-12 && off_v < 1e-12), "law %d at %g Hz, period %d: off by %g and %g", l,
                          rates[r], n, off, off_v);
                }
            }
            dpt_device_close(device);
        }
    printf("    within %.2g of the closed form\n", worst);
}

/* A push of one period, then nothing: v decays by exp(-c t / m), and with it the energy; x goes m v / c far. */
static void free_decay(void)
{
    dpt_device *device = device_named("sim:?mass=0.2&damping=2&rate=1000");
    state_of(device);
    write_force(device, 3.0, 0.0, -1.0);
    dpt_device_state first = state_of(device), state;
    for (int n = 1; n <= 2000; n++) {
        write_force(device, 0.0, 0.0, 0.0);
        state = state_of(device);
        long double decay = expl(-10.0L * (long double)n * 1e-3L);
        for (int k = 0; k < 3; k += 2) {
            long double v0 = first.velocity[k], x = first.pose.position[k] + v0 * 0.1L * (1.0L - decay);
            CHECK(fabsl(state.velocity[k] - v0 * decay) <= 1e-12L * fabsl(v0), "v after %d: %g", n, state.velocity[k]);
            CHECK(fabsl(state.pose.position[k] - x) <= 1e-12L * fabsl(x), "x after %d: %g", n, state.pose.position[k]);
        }
    }
    dpt_device_close(device);
}

/* Driven at its own frequency it grows to F / (c w), and lags by a quarter. */
static void resonance(void)
{
    const double m = 0.1, c = 0.2, k = 160.0, w = sqrt(k / m), rate = 20000.0;
    dpt_device *device = mass_at_rest((const double[]){ m, c, k }, rate);
    double peak = 0.0, in_phase = 0.0;
    int periods = 0;
    for (int n = 0; n < 200000; n++) {
        double t = n / rate;
        double x = state_of(device).pose.position[0];
        write_force(device, sin(w * t), 0.0, 0.0);
        if (t < 9.0)
            continue;
        peak = fmax(peak, fabs(x));
        in_phase += x * sin(w * t);
        periods++;
    }
    CHECK(fabs(peak * c * w - 1.0) < 1e-3, "%g m, not %g", peak, 1.0 / (c * w));
    CHECK(fabs(in_phase / periods) < 2e-2 * peak, "it does not lag by a quarter: %g", in_phase / periods);
    dpt_device_close(device);
}

static double energy_of(const dpt_device_state *state, double m, double k)
{
    double energy = 0.0;
    for (int i = 0; i < 3; i++)
        energy += 0.5 * m * state->velocity[i] * state->velocity[i] +
                  0.5 * k * state->pose.position[i] * state->pose.position[i];
    return energy;
}

static void energy_is_kept_or_lost_but_never_made(void)
{
    for (int l = 0; l < LAWS; l++) {
        const double m = laws[l][0], c = laws[l][1], k = laws[l][2];
        dpt_device *device = mass_at_rest(laws[l], 1000.0);
        dpt_device_state before = state_of(device), state;
        uint64_t random = 3;
        double force[3] = { 0.0 }, scale = 0.0;
        for (int n = 0; n < 3000; n++) {
            for (int i = 0; i < 3; i++)
                force[i] = n < 1000 ? random_in(&random, -1.0, 1.0) : 0.0;
            write_force(device, force[0], force[1], force[2]);
            state = state_of(device);
            double work = 0.0, gain = energy_of(&state, m, k) - energy_of(&before, m, k);
            for (int i = 0; i < 3; i++)
                work += force[i] * (state.pose.position[i] - before.pose.position[i]);
            scale = fmax(scale, energy_of(&state, m, k));
            CHECK(gain <= work + 1e-13 * scale, "law %d, period %d: %g J from nothing", l, n, gain - work);
            if (c == 0.0)
                CHECK(fabs(gain - work) <= 1e-12 * scale, "law %d, period %d: %g J lost", l, n, work - gain);
            before = state;
        }
        dpt_device_close(device);
    }
}

/* One axis of turning is exact; the quaternion is that turn's. */
static void turns_as_it_moves(void)
{
    dpt_device *device = device_named("sim:?dofs=6&inertia=2e-4&turn_damping=1e-3&torque=1");
    dpt_wrench wrench = { { 0.0, 0.0, 0.0 }, { 0.0, 0.01, 0.0 } };
    for (int n = 0; n < 300; n++) {
        dpt_device_state state = state_of(device);
        struct response s = step_response(2e-4L, 1e-3L, 0.0L, (long double)n * 1e-3L);
        double turn = 0.01 * (double)s.x;
        const double *q = state.pose.orientation;
        CHECK(fabs(q[0] - cos(0.5 * turn)) < 1e-12 && fabs(q[2] - sin(0.5 * turn)) < 1e-12 && q[1] == 0.0 &&
                  q[3] == 0.0,
              "period %d: %g %g %g %g", n, q[0], q[1], q[2], q[3]);
        CHECK(fabs(state.joint[4] - turn) < 1e-12 && fabs(state.spin[1] - 0.01 * (double)s.v) < 1e-12,
              "period %d: %g rad, %g rad/s", n, state.joint[4], state.spin[1]);
        CHECK(dpt_device_write(device, &wrench) == DPT_OK, "write");
    }
    dpt_device_close(device);
}

/* What a coupling is computed from, as the model has it; a device that does not turn has none of the turns'. */
static void it_tells_its_dynamics(void)
{
    static const char numbers[] = "mass=0.25&damping=0.75&inertia=3e-4&turn_damping=2e-3&step=1e-5&"
                                  "turn_step=2e-5&delay=3&rate=2000";
    for (int dofs = 3; dofs <= 6; dofs += 3) {
        dpt_device *device = device_named("sim:?dofs=%d&%s", dofs, numbers);
        dpt_device_info info = { .size = sizeof info };
        const double turns = dofs == 6;
        CHECK(dpt_device_get_info(device, &info) == DPT_OK && info.mass == 0.25 && info.damping == 0.75 &&
                  info.position_step == 1e-5 && info.delay == 0.0015 && info.friction == 0.0 &&
                  info.spin_friction == 0.0,
              "%g kg, %g Ns/m, %g s", info.mass, info.damping, info.delay);
        CHECK(info.inertia == 3e-4 * turns && info.spin_damping == 2e-3 * turns && info.angle_step == 2e-5 * turns,
              "%d: %g kg m2, %g Nms, %g rad", dofs, info.inertia, info.spin_damping, info.angle_step);
        dpt_device_close(device);
    }
}

static void encoders_round(void)
{
    const double step = 5e-4;
    dpt_device *fine = device_named("sim:?force=100"), *coarse = device_named("sim:?force=100&step=%g", step);
    dpt_device_info info = { .size = sizeof info };
    double before = 0.0;
    int moved = 0;
    CHECK(dpt_device_get_info(coarse, &info) == DPT_OK && info.position_step == step, "%g", info.position_step);
    for (int n = 0; n < 1000; n++) {
        double x = state_of(fine).pose.position[1];
        dpt_device_state state = state_of(coarse);
        double seen = state.pose.position[1], push = n % 200 < 100 ? 0.4 : -0.4;
        CHECK(fabs(seen - step * round(x / step)) < 1e-15 || fabs(fabs(x / step - floor(x / step)) - 0.5) < 1e-9,
              "%g seen as %g", x, seen);
        CHECK(fabs(seen - x) <= 0.5 * step * (1.0 + 1e-9), "%g seen as %g", x, seen);
        CHECK(fabs(state.velocity[1] - (seen - before) * 1000.0) < 1e-12, "%g m/s", state.velocity[1]);
        moved += seen != before;
        before = seen;
        write_force(fine, 0.0, push, 0.0);
        write_force(coarse, 0.0, push, 0.0);
    }
    CHECK(moved > 10 && moved < 900, "%d steps", moved);
    dpt_device_close(fine);
    dpt_device_close(coarse);
}

static void delay_is_a_shift(void)
{
    enum { PERIODS = 200 };
    double x[PERIODS];
    for (int delay = 0; delay <= 15; delay++) {
        dpt_device *device = device_named("sim:?delay=%d", delay);
        uint64_t random = 1;
        for (int n = 0; n < PERIODS; n++) {
            double now = state_of(device).pose.position[2];
            if (delay == 0)
                x[n] = now;
            else
                CHECK(now == (n < delay ? 0.0 : x[n - delay]), "delay %d, period %d: %g", delay, n, now);
            write_force(device, 0.0, 0.0, random_in(&random, -1.0, 1.0));
        }
        dpt_device_close(device);
    }
}

/* Nothing is written: force for 10 ms, none after it; each period without a command counts. */
static void watchdog_ends_the_force(void)
{
    dpt_device *device = device_named("sim:?mass=1&damping=0&watchdog=0.01");
    dpt_wrench strong = { { 100.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 } };
    double before = 0.0;
    state_of(device);
    CHECK(dpt_device_write(device, &strong) == DPT_OK, "write");
    for (int n = 1; n <= 40; n++) {
        double v = state_of(device).velocity[0], expected = n <= 10 ? 0.008 : 0.0;
        CHECK(fabs(v - before - expected) < 1e-15, "period %d: %g N", n, 1000.0 * (v - before));
        before = v;
    }
    CHECK(counts_of(device).missed == 39, "%d missed", (int)counts_of(device).missed);
    CHECK(counts_of(device).commands == 1 && counts_of(device).samples == 41, "other counts");
    write_force(device, 1.0, 0.0, 0.0);
    CHECK(fabs(state_of(device).velocity[0] - before - 0.001) < 1e-15, "it does not come back");
    dpt_device_close(device);
}

static uint64_t hash_of_run(const char *settings, int ticks)
{
    dpt_device *device = device_named("sim:?%s", settings);
    uint64_t random = 11, hash = 0;
    for (int n = 0; n < ticks; n++) {
        dpt_device_state state = state_of(device);
        dpt_wrench wrench = { { 0.0, -100.0 * state.pose.position[1], 0.0 }, { 0.0, 0.0, 0.0 } };
        for (int k = 0; k < 3; k++)
            wrench.torque[k] = random_in(&random, -0.1, 0.1);
        CHECK(dpt_device_write(device, &wrench) == DPT_OK, "write");
        double numbers[24];
        memcpy(numbers, &state.pose, sizeof state.pose);
        memcpy(numbers + 7, state.velocity, sizeof state.velocity);
        memcpy(numbers + 10, state.spin, sizeof state.spin);
        memcpy(numbers + 13, state.joint, sizeof state.joint);
        numbers[21] = state.temperature;
        numbers[22] = (double)state.sequence;
        numbers[23] = (double)state.time_ns;
        for (int i = 0; i < 24; i++) {
            uint64_t bits;
            memcpy(&bits, &numbers[i], sizeof bits);
            hash = (hash ^ bits) * 0x100000001b3u;
        }
    }
    dpt_device_close(device);
    return hash;
}

/* The same on every machine (cross.sh). A seed is without effect where nothing is drawn. */
static void same_calls_same_bits(void)
{
    static const char plain[] = "dofs=6&hand=wipe&step=2e-5&turn_step=1e-4&delay=2";
    static const char rich[] = "dofs=6&hand=wipe&turn_step=1e-4&delay=1.3&jitter=0.0008&lag=0.003&loss=0.1&double=0.1&"
                               "gravity=3&friction=0.2&stiction=0.3&turn_friction=0.004&hand_mass=0.2&hand_damping=3&"
                               "seed=";
    const struct {
        const char *settings, *seed;
        int ticks;
        uint64_t hash;
    } runs[] = {
        { plain, "", 20000, 0xfafda5d30e94b982u },
        { plain, "&seed=9007199254740992", 20000, 0xfafda5d30e94b982u },
        { rich, "0", 3000, 0x22c01f6525854b47u },
        { rich, "1", 3000, 0x3e354c846f6f4031u },
        { rich, "123456789012345", 3000, 0xa63588757fdcd81eu },
    };
    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
        char settings[400];
        snprintf(settings, sizeof settings, "%s%s", runs[i].settings, runs[i].seed);
        const uint64_t hash = hash_of_run(settings, runs[i].ticks);
        CHECK(hash == hash_of_run(settings, runs[i].ticks), "two runs differ: %s", settings);
        CHECK(hash == runs[i].hash, "not what other machines have: %s: %llx", settings, (unsigned long long)hash);
    }
}

static void scripts_pull_and_push(void)
{
    struct small_file places = file_with("# a pull\r\nt,x,y,z,buttons\r\n0,0.01,0,0,0\r\n\r\n1,0.01,0,0,2\r\n"
                                         "1.5,0.03,-0.02,0,0\r\n");
    dpt_device *device = device_named("sim:?damping=10&hand=%s", places.path);
    dpt_device_state state;
    for (int n = 0; n <= 4000; n++) {
        state = state_of(device);
        if (n == 0 || n == 900)
            CHECK(state.pose.position[0] == 0.01 && state.buttons == 0, "at rest: %g", state.pose.position[0]);
        if (n == 1200)
            CHECK(state.buttons == 2 && state.pose.position[0] > 0.012, "on the way: %g", state.pose.position[0]);
    }
    CHECK(fabs(state.pose.position[0] - 0.03) < 1e-6 && fabs(state.pose.position[1] + 0.02) < 1e-6 &&
              state.buttons == 0,
          "it ends at %g %g", state.pose.position[0], state.pose.position[1]);
    dpt_device_close(device);
    unlink(places.path);

    struct small_file forces = file_with("t,fx,fy,fz,tx,ty,tz\n0,0,0,0,0,0,0\n0.1,2,0,0,0,0,0.001\n");
    device = device_named("sim:?dofs=6&mass=1&damping=0&inertia=1e-3&turn_damping=0&hand=%s", forces.path);
    for (int n = 0; n <= 300; n++) {
        state = state_of(device);
        long double v = 0.0L;
        for (int i = 0; i < n; i++)
            v += 1e-3L * (i < 100 ? 0.02L * i : 2.0L);
        CHECK(fabsl(state.velocity[0] - v) < 1e-12L && fabsl(state.spin[2] - 0.5L * v) < 1e-12L,
              "period %d: %g m/s, %g rad/s", n, state.velocity[0], state.spin[2]);
    }
    dpt_device_close(device);
    unlink(forces.path);

    device = device_named("sim:?hand=press&reach=0.02&cycle=2&damping=2");
    double lowest = 0.0;
    for (int n = 0; n < 4000; n++)
        lowest = fmin(lowest, state_of(device).pose.position[1]);
    CHECK(fabs(lowest + 0.02) < 1e-3, "pressed to %g", lowest);
    dpt_device_close(device);
}

/* A live one does what the other does; it only waits for the clock. */
static void live_is_the_same_in_time(void)
{
    dpt_device *live = device_named("sim:?hand=press&live=1"), *twin = device_named("sim:?hand=press");
    dpt_device_state state, wanted = state_of(twin);
    uint64_t seen = 0, stale = 0;
    const struct timespec nap = { 0, 300000 };
    for (int n = 0; n < 1000; n++) {
        struct timespec time;
        state = state_of(live);
        clock_gettime(CLOCK_MONOTONIC, &time);
        uint64_t now = (uint64_t)time.tv_sec * 1000000000u + (uint64_t)time.tv_nsec;
        seen += state.fresh;
        stale += state.fresh == 0;
        while (wanted.sequence < state.sequence)
            wanted = state_of(twin);
        CHECK(seen == state.sequence + 1, "%d samples to number %d", (int)seen, (int)state.sequence);
        CHECK(!memcmp(&wanted.pose, &state.pose, sizeof wanted.pose), "another pose");
        CHECK(state.time_ns <= now, "a sample of the future");
        nanosleep(&nap, NULL);
    }
    CHECK(stale > 0 && seen > 250, "%d of 1000 reads saw nothing new, %d samples", (int)stale, (int)seen);
    CHECK(counts_of(live).samples == state.sequence + 1, "%d samples", (int)counts_of(live).samples);
    dpt_device_close(live);
    dpt_device_close(twin);
}

static void faults_come_when_asked_for(void)
{
    for (uint32_t bit = 1; dpt_device_reason_name(bit); bit <<= 1) {
        const char *name = dpt_device_reason_name(bit);
        dpt_device *device = device_named("sim:?mass=1&damping=0&fault=%s@0.05", name);
        dpt_device_state state = { .size = sizeof state };
        dpt_wrench wrench = { { 1.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 } };
        double at_fault = 0.0;
        for (int n = 0; n < 100; n++) {
            dpt_result result = dpt_device_read(device, &state);
            int is_silent = bit == DPT_REASON_SILENT && n >= 50 && n < 60;
            int is_lost = bit == DPT_REASON_UNPLUGGED || bit == DPT_REASON_SILENT;
            if (n < 50 || is_silent) {
                CHECK(result == DPT_OK && state.status == DPT_DEVICE_STATUS_READY && !state.reasons,
                      "%s, period %d: %s", name, n, dpt_device_status_name(state.status));
                CHECK(state.fresh == !is_silent, "%s, period %d: fresh %u", name, n, state.fresh);
                CHECK(dpt_device_write(device, &wrench) == DPT_OK, "%s, period %d: write", name, n);
                at_fault = state.velocity[0];
                continue;
            }
            CHECK(result == (is_lost ? DPT_E_LOST : DPT_OK), "%s: %s", name, dpt_result_name(result));
            CHECK(state.reasons == bit && state.status != DPT_DEVICE_STATUS_READY, "%s: %u", name, state.reasons);
            CHECK((state.status == DPT_DEVICE_STATUS_LOST) == is_lost && (state.fresh == 0) == is_lost, "%s: %s", name,
                  dpt_device_status_name(state.status));
            CHECK((state.code != 0) == (bit == DPT_REASON_DEVICE), "%s: code %u", name, state.code);
            CHECK(dpt_device_write(device, &wrench) == (is_lost ? DPT_E_LOST : DPT_E_NOT_READY), "%s: it takes force",
                  name);
            CHECK(is_lost || fabs(state.velocity[0] - at_fault) < 0.0011, "%s: it gives force", name);
        }
        CHECK(counts_of(device).missed == 0, "%s: it misses commands that it does not take", name);
        CHECK(dpt_device_clear(device) == DPT_OK, "%s: not cleared", name);
        state = state_of(device);
        CHECK(state.status == DPT_DEVICE_STATUS_READY && state.reasons == 0 && state.fresh > 0, "%s: %s after clear",
              name, dpt_device_status_name(state.status));
        double v = state.velocity[0];
        CHECK(fabs(state_of(device).velocity[0] - v) < 1e-15, "%s: force without a command", name);
        CHECK(dpt_device_write(device, &wrench) == DPT_OK && state_of(device).velocity[0] > v,
              "%s: no force after clear", name);
        dpt_device_close(device);
    }
}

static void wrong_names_are_refused(void)
{
    struct small_file empty = file_with(""), header = file_with("t,x,y\n0,0,0\n"), few = file_with("t,x,y,z\n0,1,2\n"),
                      many = file_with("t,x,y,z\n\n0,1,2,3,4\n"), word = file_with("t,x,y,z\n0,1,nan,3\n"),
                      large = file_with("t,x,y,z\n0,1,1e400,3\n"), back = file_with("t,x,y,z\n1,0,0,0\n1,0,0,0\n"),
                      none = file_with("t,x,y,z\n# nothing\n");
    const struct {
        const char *settings, *path;
        dpt_result code;
        const char *text;
    } cases[] = {
        { "mass=0", "", DPT_E_SETTING, "mass is not within" },
        { "mass=heavy", "", DPT_E_SETTING, "'heavy' is not a number" },
        { "mass=1e999", "", DPT_E_SETTING, "mass" },
        { "mass", "", DPT_E_SETTING, "the setting 'mass' needs a value: mass=..." },
        { "weight=1", "", DPT_E_SETTING, "no setting 'weight'" },
        { "mass=1&", "", DPT_E_SETTING, "no setting ''" },
        { "dofs=4", "", DPT_E_SETTING, "dofs is 3 or 6" },
        { "live=0.5", "", DPT_E_SETTING, "live 0 or 1" },
        { "delay=16", "", DPT_E_SETTING, "delay" },
        { "friction=0.2&stiction=0.1", "", DPT_E_SETTING, "stiction is below friction" },
        { "turn_stiction=0&turn_friction=0.1", "", DPT_E_SETTING, "turn_stiction is below turn_" },
        { "spin_friction=0.1", "", DPT_E_SETTING, "no setting 'spin_friction'" },
        { "seed=0.5", "", DPT_E_SETTING, "seed an integer" },
        { "jitter=0.001", "", DPT_E_SETTING, "jitter is not below a period" },
        { "lag=1e-6", "", DPT_E_SETTING, "lag is neither 0 nor" },
        { "loss=1.5", "", DPT_E_SETTING, "loss is not within" },
        { "double=-1", "", DPT_E_SETTING, "double is not within" },
        { "fault=estop", "", DPT_E_SETTING, "estop@1.5" },
        { "fault=tired@1", "", DPT_E_SETTING, "estop@1.5" },
        { "fault=estop@soon", "", DPT_E_SETTING, "estop@1.5" },
        { "hand=", "/nowhere/hand.csv", DPT_E_OPEN, "/nowhere/hand.csv: No such file" },
        { "hand=", "/tmp", DPT_E_OPEN, "/tmp: Is a directory" },
        { "hand=", empty.path, DPT_E_SYNTAX, ":1: there are no rows" },
        { "hand=", header.path, DPT_E_SYNTAX, ":1: the header" },
        { "hand=", few.path, DPT_E_SYNTAX, ":2: there are too few" },
        { "hand=", many.path, DPT_E_SYNTAX, ":3: there are too many" },
        { "hand=", word.path, DPT_E_SYNTAX, ":2: a field is missing, or not a number" },
        { "hand=", large.path, DPT_E_SYNTAX, ":2: a number is too large" },
        { "hand=", back.path, DPT_E_SYNTAX, ":3: the first column" },
        { "hand=", none.path, DPT_E_SYNTAX, ":2: there are no rows" },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char name[128];
        dpt_device *device = (dpt_device *)&name;
        dpt_device_error error = { .size = sizeof error };
        snprintf(name, sizeof name, "sim:?%s%s", cases[i].settings, cases[i].path);
        dpt_result result = dpt_device_open(name, &device, &error);
        CHECK(result == cases[i].code && error.code == result && !device, "%s: %s", name, dpt_result_name(result));
        CHECK(strstr(error.text, cases[i].text) && !strchr(error.text, '\n'), "%s: %s", name, error.text);
        CHECK(dpt_device_open(name, &device, NULL) == cases[i].code, "%s, without an error", name);
    }
    dpt_device_error error = { .size = sizeof error };
    dpt_device *device;
    CHECK(dpt_device_open("sim:/dev/ttyACM0", &device, &error) == DPT_E_SETTING, "a place: %s", error.text);
    const char *const paths[] = { empty.path, header.path, few.path,  many.path,
                                  word.path,  large.path,  back.path, none.path };
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++)
        unlink(paths[i]);
}

/* With an argument: the bits alone, for machines that are emulated (cross.sh). */
int main(int argc, char **argv)
{
    (void)argv;
    TEST(same_calls_same_bits);
    if (argc > 1)
        return check_report();
    TEST(forces_add_up_as_the_closed_form_says);
    TEST(free_decay);
    TEST(resonance);
    TEST(energy_is_kept_or_lost_but_never_made);
    TEST(turns_as_it_moves);
    TEST(it_tells_its_dynamics);
    TEST(encoders_round);
    TEST(delay_is_a_shift);
    TEST(watchdog_ends_the_force);
    TEST(scripts_pull_and_push);
    TEST(live_is_the_same_in_time);
    TEST(faults_come_when_asked_for);
    TEST(wrong_names_are_refused);
    return check_report();
}
