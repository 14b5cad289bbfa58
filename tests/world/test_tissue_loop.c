/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A sampled device on tissue: a mass with damping that holds each wrench for a sample, at 0.9 of the stiffness up to which a
 * rigid wall is stable; and a device that trembles on a body that sleeps.
 *
 *     test_tissue_loop [PER CENT = 100]
 */
#include "dynpoint/coupling.h"
#include "dynpoint/passivity.h"
#include "force/exact_step.h"
#include "world/tissue_rig.h"

/* kg, N s/m, N: the device, and what presses it down; N/m: how the hand holds it across. */
#define MASS    0.1
#define DAMPING 0.5
#define PUSH    1.0
#define GRIP    300.0

static const dpt_segment ball = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 }, 0.006 };

static struct tissue_def block_def(void)
{
    struct tissue_def def = tissue_ball();
    def.shape = "box";
    def.triangles = 432;
    return def;
}

static struct tissue_def liver_def(void)
{
    struct tissue_def def = tissue_ball();
    def.shape = "liver";
    def.triangles = 1200;
    return def;
}

/* Put the tool above the body: in the middle of a block, else over the highest vertex. */
static void put_above(struct tissue_rig *tissue, int is_block)
{
    struct tissue_tool *tool = &tissue->tool[0];
    uint32_t count = 0, top = 0;
    const float *at = tissue_vertices(tissue, &tissue->body[0], &count);
    for (uint32_t i = 1; i < count; i++)
        top = at[3 * i + 2] > at[3 * top + 2] ? i : top;
    for (uint32_t k = 0; k < 3; k++)
        tool->device.position[k] = is_block && k < 2 ? 0.003 : (double)at[3 * top + k];
    tool->device.position[2] += tool->segment.radius + 0.001;
    tissue_rig_place(tissue);
}

struct device {
    double at[3], speed[3], rest[3];
    double step[2][2][2], gain[2][2]; /* held across, and free */
};

static void device_open(struct device *device, const struct tissue_tool *tool, double dt)
{
    memset(device, 0, sizeof *device);
    exact_step(MASS, DAMPING, GRIP, dt, device->step[0], device->gain[0]);
    exact_step(MASS, DAMPING, 0.0, dt, device->step[1], device->gain[1]);
    for (int k = 0; k < 3; k++)
        device->rest[k] = device->at[k] = tool->device.position[k];
}

static void device_move(struct device *device, const dpt_wrench *wrench)
{
    for (int k = 0; k < 3; k++) {
        const int free = k == 2;
        const double force = wrench->force[k] - (free ? PUSH : 0.0), off = device->at[k] - device->rest[k];
        const double speed = device->speed[k];
        device->at[k] = device->rest[k] + device->step[free][0][0] * off + device->step[free][0][1] * speed +
                        device->gain[free][0] * force;
        device->speed[k] =
            device->step[free][1][0] * off + device->step[free][1][1] * speed + device->gain[free][1] * force;
    }
}

/* What a loop of some seconds ends in. */
struct ending {
    double fastest, last; /* m/s: of all, and of the last tenth */
    double force;         /* N */
    dpt_passivity_info account;
};

static void run_loop(struct tissue_rig *tissue, double seconds, struct ending *ending)
{
    static dpt_passivity passivity;
    struct tissue_tool *tool = &tissue->tool[0];
    const double dt = tissue->rig.dt;
    const int ticks = (int)(seconds / dt);
    dpt_passivity_def def;
    dpt_wrench sent = { { 0.0 }, { 0.0 } };
    struct device device;
    *ending = (struct ending){ .account = { .size = sizeof ending->account } };
    dpt_passivity_def_init(&def);
    def.damping = DAMPING;
    def.force_slew = def.torque_slew = 0.0;
    def.observe_only = 1;
    passivity.size = sizeof passivity;
    CHECK(dpt_passivity_init(&passivity, &def) == DPT_OK, "no observer");
    device_open(&device, tool, dt);
    for (int t = 0; t < ticks; t++) {
        memcpy(tool->device.position, device.at, sizeof device.at);
        tissue_rig_tick(tissue);
        const dpt_passivity_sample sample = { .size = sizeof sample,
                                              .dt = dt,
                                              .energy = tool->force.energy,
                                              .body_work = tool->force.body_work,
                                              .pose = tool->device,
                                              .sent = sent };
        dpt_wrench asked = sent = tool->force.wrench;
        CHECK(dpt_passivity_step(&passivity, &sample, &asked) == DPT_OK, "not observed");
        device_move(&device, &sent);
        ending->fastest = fmax(ending->fastest, length3(device.speed));
        if (t > ticks - ticks / 10)
            ending->last = fmax(ending->last, length3(device.speed));
    }
    ending->force = length3(sent.force);
    dpt_passivity_get_info(&passivity, &ending->account);
}

/* At 1 kHz in 5 s, and at 10 kHz, where it is still coming to rest, in 1.5 s; a ball, or an upright capsule. */
static void a_device_comes_to_rest(void)
{
    for (int i = 0; i < (int)part_of(8); i++) {
        const double dt = i & 1 ? 1e-4 : 1e-3, limit = dpt_stable_stiffness(MASS, DAMPING, dt, 0.0, 0.0);
        const struct tissue_def def = i & 2 ? liver_def() : block_def();
        struct tissue_rig tissue;
        tissue_rig_open(&tissue);
        tissue.rig.dt = dt;
        if (tissue_rig_add_soft(&tissue, &def)) {
            struct ending ending;
            tissue_rig_add_tool(&tissue, i & 4 ? &tissue_upright : &ball, 0.9 * limit);
            put_above(&tissue, !(i & 2));
            run_loop(&tissue, i & 1 ? 1.5 : 5.0, &ending);
            CHECK(ending.last < (i & 1 ? 1e-2 : 1e-3) * ending.fastest, "case %d: at %g m/s, after %g", i, ending.last,
                  ending.fastest);
            CHECK(fabs(ending.force - PUSH) < 0.01 * PUSH, "case %d: %g N", i, ending.force);
            CHECK(ending.account.account_min >= -2.0 * ending.account.eps, "case %d: account %g J, eps %g", i,
                  ending.account.account_min, ending.account.eps);
        }
        tissue_rig_close(&tissue);
    }
}

/* What the test above looks for is there beyond the limit: on a rigid block the device neither rests nor is passive. */
static void beyond_the_limit_it_does_not(void)
{
    const double limit = dpt_stable_stiffness(MASS, DAMPING, RIG_DT, 0.0, 0.0);
    const struct tissue_def def = block_def();
    for (int i = 0; i < 2; i++) {
        struct tissue_rig tissue;
        tissue_rig_open(&tissue);
        if (tissue_rig_add_rigid(&tissue, &def)) {
            struct ending ending;
            tissue_rig_add_tool(&tissue, &ball, (i ? 1.1 : 0.9) * limit);
            put_above(&tissue, 1);
            run_loop(&tissue, 10.0, &ending);
            const int is_passive = ending.account.account_min >= -2.0 * ending.account.eps;
            CHECK(i ? ending.last > 0.3 * ending.fastest : ending.last < 0.1 * ending.fastest,
                  "%d: at %g m/s, after %g", i, ending.last, ending.fastest);
            CHECK(is_passive == !i, "%d: account %g J, eps %g", i, ending.account.account_min, ending.account.eps);
        }
        tissue_rig_close(&tissue);
    }
}

/* ---- a device that trembles ---- */

/* rms of |F| about a line through 51 samples, N. */
static double hum_of(const double *force)
{
    enum { HALF = 25, SAMPLES = 2 * HALF + 1 };
    double mean = 0.0, slope = 0.0, squares = 0.0, weights = 0.0;
    for (int i = 0; i < SAMPLES; i++) {
        mean += force[i] / SAMPLES;
        slope += (i - HALF) * force[i];
        weights += (double)(i - HALF) * (i - HALF);
    }
    for (int i = 0; i < SAMPLES; i++) {
        const double off = force[i] - mean - slope / weights * (i - HALF);
        squares += off * off / SAMPLES;
    }
    return sqrt(squares);
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/*
 * A body sleeps under a tool that is held still. The tool trembles by so much for 0.3 s, and is held still until the body
 * sleeps again, some times: while it trembles force jumps by no more than its own motion explains, and still it is silent.
 */
static void tremble(double by, uint32_t integrator, double stiffness, uint32_t *woken)
{
    enum { ROUNDS = 6, TREMBLES = 300, RESTS = 1500, SILENT_FROM = 60, WINDOW = 51 };
    static double force[RESTS], jumps[ROUNDS * TREMBLES];
    struct tissue_def def = tissue_ball();
    struct tissue_rig tissue;
    uint64_t seed = (uint64_t)(by * 1e7) + integrator;
    uint32_t count = 0;
    double hum = 0.0, most = 0.0;
    def.integrator = integrator;
    def.sleeps = 1;
    tissue_rig_open(&tissue);
    if (tissue_rig_add_soft(&tissue, &def)) {
        struct tissue_tool *tool = tissue_rig_add_tool(&tissue, &ball, stiffness);
        double still[3], last;
        put_above(&tissue, 0);
        for (int t = 0; t < 125; t++) {
            tool->device.position[2] -= 2e-5;
            tissue_rig_tick(&tissue);
        }
        for (int t = 0; t < 2 * RESTS; t++)
            tissue_rig_tick(&tissue);
        CHECK(!tissue.info[0].active, "%g m: %u nodes are awake", by, tissue.info[0].active);
        memcpy(still, tool->device.position, sizeof still);
        last = length3(tool->force.wrench.force);
        for (int round = 0; round < ROUNDS; round++) {
            uint32_t awake = 0;
            for (int t = 0; t < TREMBLES; t++) {
                double from[3];
                memcpy(from, tool->device.position, sizeof from);
                for (int k = 0; k < 3; k++)
                    tool->device.position[k] = still[k] + random_in(&seed, -by, by) / sqrt(3.0);
                tissue_rig_tick(&tissue);
                const double now = length3(tool->force.wrench.force);
                jumps[count++] = fabs(now - last) - 1.5 * stiffness * apart(from, tool->device.position);
                last = now;
                awake = tissue.info[0].active > awake ? tissue.info[0].active : awake;
            }
            *woken += awake > 0;
            memcpy(tool->device.position, still, sizeof still);
            for (int t = 0; t < RESTS; t++) {
                tissue_rig_tick(&tissue);
                force[t] = last = length3(tool->force.wrench.force);
            }
            CHECK(!tissue.info[0].active, "%g m: %u nodes are awake again", by, tissue.info[0].active);
            for (int t = SILENT_FROM; t + WINDOW <= RESTS; t++)
                hum = fmax(hum, hum_of(force + t));
            most = fmax(most, last);
        }
        qsort(jumps, count, sizeof *jumps, by_size);
        CHECK(hum <= fmax(1e-3 * most, 5e-4), "%g m: hums by %g N of %g N", by, hum, most);
        CHECK(jumps[count * 99 / 100] <= 2e-3, "%g m: jumps %g N beyond its own", by, jumps[count * 99 / 100]);
    }
    tissue_rig_close(&tissue);
}

static void a_tremor_across_waking_is_silent(void)
{
    static const double by[] = { 2e-5, 5e-6, 1e-6 };
    uint32_t woken = 0;
    for (int i = 0; i < (int)part_of(12); i++)
        tremble(by[i % 3], i / 3 & 1 ? DPT_INTEGRATOR_EULER : DPT_INTEGRATOR_SYMPLECTIC, i < 6 ? 500.0 : 1800.0,
                &woken);
    CHECK(woken, "no tremor has woken the body");
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(a_device_comes_to_rest);
    TEST(beyond_the_limit_it_does_not);
    TEST(a_tremor_across_waking_is_silent);
    return check_report();
}
