/* SPDX-License-Identifier: BSD-3-Clause */
/* openhaptics.h and dpt_device_map; what the driver's declarations rest on; and the exchange between its threads. */
#include <math.h>
#include <pthread.h>
#include <sched.h>

#include "drivers/hd/function_table.h"
#include "dynpoint/device.h"
#include "dynpoint/openhaptics.h"
#include "exchange/latest_value.h"
#include "lib/check.h"

/* That the compiler took both is the test of values and signatures; each has three sources or more. */
static void constants_and_signatures_are_written_twice(void)
{
#define SOURCE(name, value, sources) { #name, sources },
    static const struct {
        const char *name, *sources;
    } constants[] = { TABLE_CONSTANTS(SOURCE) };
#undef SOURCE
#define ONE(...) +1
    const int count = (int)(sizeof constants / sizeof *constants);
    CHECK(count == 0 HD_CONSTANTS(ONE) && count >= 57, "%d constants", count);
    CHECK((0 HD_FUNCTIONS(ONE, ONE)) >= 22, "%d functions", 0 HD_FUNCTIONS(ONE, ONE));
#undef ONE
    for (int i = 0; i < count; i++)
        CHECK(strlen(constants[i].sources) >= 5 && constants[i].sources[0] == 'A', "%s has only %s", constants[i].name,
              constants[i].sources);
}

/* As the vendor's utilities say, and the impulse beside the other forces. */
static void errors_are_told_apart(void)
{
    static const uint32_t force[] = { 0x200, 0x201, 0x202, 0x203, 0x204 };
    static const uint32_t scheduler[] = { 0x302, 0x303, 0x304, 0x500, 0x501 };
    int forces = 0, schedulers = 0;
    for (uint32_t code = 0; code < 0x1000; code++) {
        forces += dpt_hd_is_force_error(code);
        schedulers += dpt_hd_is_scheduler_error(code);
    }
    for (int i = 0; i < 5; i++)
        CHECK(dpt_hd_is_force_error(force[i]) == 1 && dpt_hd_is_scheduler_error(scheduler[i]) == 1, "%x, %x", force[i],
              scheduler[i]);
    CHECK(forces == 5 && schedulers == 5, "%d, %d", forces, schedulers);
    CHECK(!dpt_hd_is_force_error(UINT32_MAX) && !dpt_hd_is_scheduler_error(UINT32_MAX), "none");
}

static void lengths_are_rounded_once(void)
{
    uint64_t seed = 3;
    for (int n = 0; n < 10000; n++) {
        double metres[3], mm[3], back[3];
        for (int k = 0; k < 3; k++)
            metres[k] = random_in(&seed, -1.0, 1.0) * pow(10.0, random_in(&seed, -9.0, 5.0));
        CHECK(dpt_hd_to_millimetres(metres, mm) == DPT_OK && dpt_hd_to_metres(mm, back) == DPT_OK, "%g", metres[0]);
        for (int k = 0; k < 3; k++) {
            CHECK(mm[k] == 1000.0 * metres[k] && back[k] == mm[k] / 1000.0, "%.17g", metres[k]);
            CHECK(fabs(back[k] - metres[k]) <= 0x1p-52 * fabs(metres[k]), "%.17g", metres[k]);
            /* On a grid of 2^-20 m all is exact. */
            metres[k] = floor(random_in(&seed, -1e6, 1e6)) * 0x1p-20;
        }
        dpt_hd_to_millimetres(metres, metres);
        dpt_hd_to_metres(metres, back);
        for (int k = 0; k < 3; k++)
            CHECK(back[k] * 0x1p20 == floor(back[k] * 0x1p20) && back[k] * 1000.0 == metres[k], "%.17g", back[k]);
    }
    double good[3] = { 1.0, 2.0, 3.0 }, out[3] = { 7.0, 7.0, 7.0 };
    const double wrong[] = { NAN, INFINITY, -INFINITY, 2e9 };
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) {
            good[k] = wrong[i];
            CHECK(dpt_hd_to_metres(good, out) == DPT_E_FINITE && dpt_hd_to_millimetres(good, out) == DPT_E_FINITE &&
                      out[0] == 7.0,
                  "%g", wrong[i]);
            good[k] = 1.0;
        }
    CHECK(dpt_hd_to_metres(NULL, out) == DPT_E_ARGUMENT && dpt_hd_to_metres(good, NULL) == DPT_E_ARGUMENT &&
              dpt_hd_to_millimetres(NULL, out) == DPT_E_ARGUMENT && dpt_hd_to_millimetres(good, NULL) == DPT_E_ARGUMENT,
          "NULL");
}

/* A pose there and back; the corners of the matrix that is known by heart. */
static void transforms_are_poses(void)
{
    uint64_t seed = 5;
    double worst = 0.0;
    const dpt_pose quarter = { { 0.001, 0.002, 0.003 }, { sqrt(0.5), 0.0, 0.0, sqrt(0.5) } };
    /* A quarter turn about z: x becomes y, y becomes -x. */
    const double known[16] = { 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1 };
    double transform[16];
    dpt_pose pose;
    CHECK(dpt_hd_to_transform(&quarter, transform) == DPT_OK, "transform");
    for (int i = 0; i < 16; i++)
        CHECK(fabs(transform[i] - known[i]) < 1e-15, "element %d: %g", i, transform[i]);
    CHECK(dpt_hd_to_pose(known, &pose) == DPT_OK, "pose");
    for (int k = 0; k < 4; k++)
        CHECK(fabs(pose.orientation[k] - quarter.orientation[k]) < 1e-15 &&
                  (k == 3 || pose.position[k] == quarter.position[k]),
              "%g", pose.orientation[k]);
    for (int n = 0; n < 10000; n++) {
        dpt_pose from, to;
        double square = 0.0, cosine = 0.0;
        for (int k = 0; k < 4; k++) {
            /* Now and then close to half a turn, about any axis. */
            from.orientation[k] = random_in(&seed, -1.0, 1.0) * (n % 7 == 0 && k == n % 4 ? 1e-9 : 1.0);
            square += from.orientation[k] * from.orientation[k];
        }
        for (int k = 0; k < 4; k++)
            from.orientation[k] /= sqrt(square);
        for (int k = 0; k < 3; k++)
            from.position[k] = random_in(&seed, -0.5, 0.5);
        CHECK(dpt_hd_to_transform(&from, transform) == DPT_OK && dpt_hd_to_pose(transform, &to) == DPT_OK, "pose %d",
              n);
        for (int k = 0; k < 4; k++)
            cosine += from.orientation[k] * to.orientation[k];
        for (int k = 0; k < 4; k++)
            worst = fmax(worst, fabs(to.orientation[k] - (cosine < 0 ? -1 : 1) * from.orientation[k]));
        for (int k = 0; k < 3; k++)
            CHECK(fabs(to.position[k] - from.position[k]) <= 0x1p-52 * fabs(from.position[k]), "pose %d: %.17g", n,
                  to.position[k]);
    }
    CHECK(worst < 1e-15, "%g", worst);
}

static void what_is_no_transform_is_refused(void)
{
    const double identity[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
    const dpt_pose untouched = { { 7, 7, 7 }, { 7, 7, 7, 7 } };
    const struct {
        int at;
        double value;
        dpt_result result;
    } cases[] = { { 0, NAN, DPT_E_FINITE },  { 9, INFINITY, DPT_E_FINITE },
                  { 12, NAN, DPT_E_FINITE }, { 14, 2e9, DPT_E_FINITE },
                  { 0, -1.0, DPT_E_POSE },   { 5, 0.0, DPT_E_POSE },
                  { 10, 1.2, DPT_E_POSE },   { 4, 0.2, DPT_E_POSE },
                  { 2, -0.2, DPT_E_POSE },   { 9, 0.15, DPT_E_POSE },
                  { 10, 1.05, DPT_OK },      { 4, 0.05, DPT_OK },
                  { 3, NAN, DPT_OK },        { 15, 0.0, DPT_OK } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double transform[16];
        dpt_pose pose = untouched;
        memcpy(transform, identity, sizeof transform);
        transform[cases[i].at] = cases[i].value;
        CHECK(dpt_hd_to_pose(transform, &pose) == cases[i].result, "case %d", (int)i);
        CHECK(cases[i].result == DPT_OK || !memcmp(&pose, &untouched, sizeof pose), "case %d writes", (int)i);
    }
    dpt_pose pose = DPT_POSE_IDENTITY, bad = DPT_POSE_IDENTITY;
    double transform[16];
    CHECK(dpt_hd_to_pose(NULL, &pose) == DPT_E_ARGUMENT && dpt_hd_to_pose(identity, NULL) == DPT_E_ARGUMENT &&
              dpt_hd_to_transform(NULL, transform) == DPT_E_ARGUMENT &&
              dpt_hd_to_transform(&pose, NULL) == DPT_E_ARGUMENT,
          "NULL");
    bad.orientation[0] = 1.1;
    CHECK(dpt_hd_to_transform(&bad, transform) == DPT_E_POSE, "a long quaternion");
    bad.position[0] = NAN;
    CHECK(dpt_hd_to_transform(&bad, transform) == DPT_E_FINITE, "no number");
    CHECK(dpt_hd_to_transform(&pose, transform) == DPT_OK && !memcmp(transform, identity, sizeof identity),
          "the identity");
}

/* Every corner of the box comes from within the workspace, and the tightest axis from its ends. */
static void a_workspace_covers_a_model(void)
{
    uint64_t seed = 8;
    dpt_device_info info = { .size = sizeof info };
    double low[3], high[3], scale, offset[3];
    for (int n = 0; n < 1000; n++) {
        double tightest = 1.0;
        for (int k = 0; k < 3; k++) {
            info.workspace_min[k] = random_in(&seed, -0.2, 0.0);
            info.workspace_max[k] = random_in(&seed, 0.01, 0.2);
            low[k] = random_in(&seed, -3.0, 3.0);
            high[k] = low[k] + random_in(&seed, 0.0, 5.0);
        }
        CHECK(dpt_device_map(&info, low, high, &scale, offset) == DPT_OK && scale > 0.0, "map");
        for (int k = 0; k < 3; k++) {
            const double from = (low[k] - offset[k]) / scale, to = (high[k] - offset[k]) / scale;
            const double slack = fmin(from - info.workspace_min[k], info.workspace_max[k] - to);
            CHECK(slack > -1e-12, "axis %d: out by %g", k, slack);
            CHECK(fabs(from - info.workspace_min[k] - (info.workspace_max[k] - to)) < 1e-12,
                  "axis %d: not in the middle", k);
            tightest = fmin(tightest, slack);
        }
        CHECK(tightest < 1e-12, "larger than it need be: %g", tightest);
    }
    CHECK(dpt_device_map(&info, low, low, &scale, offset) == DPT_OK && scale == 1.0, "a point");
    CHECK(dpt_device_map(&info, high, low, &scale, offset) == DPT_E_ARGUMENT, "upside down");
    CHECK(dpt_device_map(NULL, low, high, &scale, offset) == DPT_E_ARGUMENT &&
              dpt_device_map(&info, NULL, high, &scale, offset) == DPT_E_ARGUMENT &&
              dpt_device_map(&info, low, NULL, &scale, offset) == DPT_E_ARGUMENT &&
              dpt_device_map(&info, low, high, NULL, offset) == DPT_E_ARGUMENT &&
              dpt_device_map(&info, low, high, &scale, NULL) == DPT_E_ARGUMENT,
          "NULL");
    low[1] = NAN;
    CHECK(dpt_device_map(&info, low, high, &scale, offset) == DPT_E_FINITE, "no number");
    low[1] = high[1] = 0.0;
    info.workspace_max[2] = info.workspace_min[2];
    CHECK(dpt_device_map(&info, low, high, &scale, offset) == DPT_E_FINITE, "a flat workspace");
    info.size = 4;
    CHECK(dpt_device_map(&info, low, high, &scale, offset) == DPT_E_SIZE, "another size");
}

/* One thread counts, in values of many words; the other sees whole ones, each later than the last, and the last. */
enum { TAKEN = 50000, WORDS = 40 };

static struct latest_value latest;
static uint64_t places[LATEST_VALUE_PLACES][WORDS], counted;
static int is_enough;

static void *count(void *unused)
{
    while (!__atomic_load_n(&is_enough, __ATOMIC_RELAXED)) {
        counted++;
        for (int i = 0; i < WORDS; i++)
            places[latest.writing][i] = counted;
        latest_value_publish(&latest);
        if (counted % 64 == 0)
            sched_yield();
    }
    return unused;
}

static void the_latest_value_is_whole_and_never_older(void)
{
    pthread_t thread;
    uint64_t last = 0;
    latest_value_init(&latest);
    CHECK(!latest_value_take(&latest), "something before there is anything");
    CHECK(pthread_create(&thread, NULL, count, NULL) == 0, "no thread");
    for (int taken = 0; taken < TAKEN;) {
        if (!latest_value_take(&latest)) {
            sched_yield();
            continue;
        }
        const uint64_t *value = places[latest.reading];
        taken++;
        CHECK(value[0] > last, "%d after %d", (int)value[0], (int)last);
        for (int i = 1; i < WORDS; i++)
            CHECK(value[i] == value[0], "torn: %d, %d", (int)value[0], (int)value[i]);
        last = value[0];
    }
    __atomic_store_n(&is_enough, 1, __ATOMIC_RELAXED);
    pthread_join(thread, NULL);
    CHECK(latest_value_take(&latest) == (last != counted) && places[latest.reading][0] == counted,
          "the last is not the last");
    CHECK(!latest_value_take(&latest), "something after the last");
}

int main(void)
{
    TEST(constants_and_signatures_are_written_twice);
    TEST(errors_are_told_apart);
    TEST(lengths_are_rounded_once);
    TEST(transforms_are_poses);
    TEST(what_is_no_transform_is_refused);
    TEST(a_workspace_covers_a_model);
    TEST(the_latest_value_is_whole_and_never_older);
    return check_report();
}
