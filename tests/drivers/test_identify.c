/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Identification finds what a device is made of: simulated devices, whose numbers are known, and a plant of the test's
 * own, integrated in small steps: test_identify [PERCENT of the seeds].
 */
#include "drivers/identify_plant.h"
#include "drivers/open_device.h"
#include "dynpoint/identify.h"
#include "lib/size_checks.h"

static dpt_identify_result identify(dpt_device *device, uint64_t seed)
{
    dpt_identify_def def;
    dpt_identify_result result = { .size = sizeof result };
    dpt_identify_def_init(&def);
    def.may_move = 1;
    def.seed = seed;
    def.seconds = 0.5;
    CHECK(dpt_device_identify(device, &def, &result) == DPT_OK, "it failed");
    dpt_device_close(device);
    return result;
}

static dpt_identify_result identify_named(const char *settings, uint64_t seed)
{
    return identify(device_named("sim:?%s", settings), seed);
}

static dpt_identify_result identify_plan(const struct plant_plan *plan, uint64_t seed)
{
    dpt_device *device = NULL;
    plant_plan = *plan;
    CHECK(dpt_device_open_with(&plant_driver, NULL, &device, NULL) == DPT_OK, "open");
    return identify(device, seed);
}

/* Within 5 %, or, where the term is small, within the interval; which is never far wider than that. */
static void check_value(const char *where, const char *what, const dpt_identified *found, double truth, double wide)
{
    const int is_close = fabs(found->value - truth) <= 0.05 * truth;
    const int is_inside = truth >= found->low && truth <= found->high;
    CHECK(wide > 0.0 ? is_inside : is_close, "%s: %s %g (%g to %g), is %g", where, what, found->value, found->low,
          found->high, truth);
    CHECK(found->low <= found->value && found->value <= found->high, "%s: %s %g not in %g to %g", where, what,
          found->value, found->low, found->high);
    CHECK(found->high - found->low <= 0.3 * truth + wide, "%s: %s is anything from %g to %g", where, what, found->low,
          found->high);
}

static const uint32_t TRANSLATION =
    DPT_IDENTIFIED_RATE | DPT_IDENTIFIED_MASS | DPT_IDENTIFIED_DAMPING | DPT_IDENTIFIED_FRICTION | DPT_IDENTIFIED_DELAY;

static void check_whole(const char *where, const dpt_identify_result *result)
{
    CHECK(result->end == DPT_IDENTIFY_END_COMPLETE && result->flags == 0 &&
              (result->measured & TRANSLATION) == TRANSLATION,
          "%s: %s, flags %u, measured %x", where, dpt_identify_end_text(result->end), result->flags, result->measured);
}

static void the_truth_is_found(void)
{
    static const struct {
        const char *settings;
        double mass, damping, friction, step, delay;
    } cases[] = {
        { "mass=0.045&friction=0.26&step=5.5e-5&force=3.3&delay=1", 0.045, 0.5, 0.26, 5.5e-5, 0.001 },
        { "mass=0.045&friction=0.26&step=5.5e-5&force=3.3&delay=2", 0.045, 0.5, 0.26, 5.5e-5, 0.002 },
        { "mass=0.045&friction=0.26&stiction=0.3&step=5.5e-5&force=3.3&delay=1.5", 0.045, 0.5, 0.26, 5.5e-5, 0.0015 },
        { "mass=0.1", 0.1, 0.5, 0.0, 0.0, 0.0 },
        { "mass=0.1&step=1e-5&delay=3.3", 0.1, 0.5, 0.0, 1e-5, 0.0033 },
        { "mass=0.2&damping=2&friction=0.1&step=2e-5", 0.2, 2.0, 0.1, 2e-5, 0.0 },
        { "mass=0.2&damping=2&friction=0.1&step=2e-5&force=3.3&delay=1", 0.2, 2.0, 0.1, 2e-5, 0.001 },
        { "mass=0.1&friction=0.1&step=1e-5&lag=0.002", 0.1, 0.5, 0.1, 1e-5, 0.002 },
        { "mass=0.1&friction=0.2&gravity=1&step=1e-5&delay=1", 0.1, 0.5, 0.2, 1e-5, 0.001 },
        { "mass=0.01&damping=0.1&step=1e-5&delay=1", 0.01, 0.1, 0.0, 1e-5, 0.001 },
        { "mass=1&damping=5&step=1e-5&delay=1", 1.0, 5.0, 0.0, 1e-5, 0.001 },
        { "mass=0.1&friction=0.05&step=2e-5&rate=4000&delay=4", 0.1, 0.5, 0.05, 2e-5, 0.001 },
        { "mass=0.1&friction=0.1&step=2e-5&loss=0.005&double=0.005&delay=1", 0.1, 0.5, 0.1, 2e-5, 0.001 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *where = cases[i].settings;
        const dpt_identify_result result = identify_named(where, 3 + i);
        check_whole(where, &result);
        check_value(where, "mass", &result.mass, cases[i].mass, 0.0);
        check_value(where, "damping", &result.damping, cases[i].damping, 0.0);
        check_value(where, "friction", &result.friction, cases[i].friction, cases[i].friction > 0.0 ? 0.0 : 0.01);
        check_value(where, "delay", &result.delay, cases[i].delay, 0.0006);
        CHECK(fabs(result.position_step - cases[i].step) <= 1e-3 * cases[i].step &&
                  (cases[i].step > 0.0) == ((result.measured & DPT_IDENTIFIED_POSITION_STEP) != 0),
              "%s: steps of %g m", where, result.position_step);
    }
}

/* Two kinds of dynamics at once, and another integrator. */
static void a_plant_of_another_kind_is_found(void)
{
    struct plant_plan plan = plant_of(0.045, 0.5);
    plan.friction = 0.26;
    plan.stiction = 0.28;
    plan.step = 5.5e-5;
    plan.force_max = 3.3;
    plan.delay = 0.00135;
    dpt_identify_result result = identify_plan(&plan, 5);
    check_whole("a weak one", &result);
    check_value("a weak one", "mass", &result.mass, 0.045, 0.0);
    check_value("a weak one", "damping", &result.damping, 0.5, 0.0);
    check_value("a weak one", "friction", &result.friction, 0.26, 0.0);
    check_value("a weak one", "delay", &result.delay, 0.00135, 0.0006);
    plan = plant_of(0.1, 0.8);
    plan.friction = 0.1;
    plan.gravity = 0.05;
    plan.step = 1e-5;
    plan.lag = 0.0015;
    plan.delay = 0.001;
    result = identify_plan(&plan, 6);
    check_whole("a lag", &result);
    check_value("a lag", "mass", &result.mass, 0.1, 0.0);
    check_value("a lag", "damping", &result.damping, 0.8, 0.0);
    check_value("a lag", "friction", &result.friction, 0.1, 0.0);
    check_value("a lag", "delay", &result.delay, 0.0025, 0.0003);
}

/*
 * Masses that differ by direction. M^-1 = (8 3; 3 10) in x and y has the eigenvalues 9 +- sqrt(10); the least mass lies
 * along (3, 1 + sqrt(10)).
 */
static void the_least_direction_is_found(void)
{
    struct plant_plan plan = plant_of(0.1, 0.5);
    const double least = 1.0 / (9.0 + sqrt(10.0)), y = 1.0 + sqrt(10.0);
    plan.inverse_mass[0] = 8.0;
    plan.inverse_mass[1] = plan.inverse_mass[3] = 3.0;
    plan.damping[0] = 1.5;
    plan.damping[8] = 0.3;
    plan.step = 1e-5;
    const dpt_identify_result result = identify_plan(&plan, 2);
    const double *along = result.mass_direction, *damped = result.damping_direction;
    check_whole("coupled", &result);
    check_value("coupled", "mass", &result.mass, least, 0.0);
    check_value("coupled", "damping", &result.damping, 0.3, 0.0);
    CHECK(fabs((3.0 * along[0] + y * along[1]) / sqrt(9.0 + y * y)) > 0.999, "along %g %g %g", along[0], along[1],
          along[2]);
    CHECK(fabs(damped[2]) > 0.999, "least damped along %g %g %g", damped[0], damped[1], damped[2]);
    CHECK(fabs(result.mass_matrix[1] + 3.0 / 71.0) < 0.002 && result.mass_matrix[1] == result.mass_matrix[3],
          "%g beside the diagonal", result.mass_matrix[1]);
    plan = plant_of(0.1, 0.5);
    const dpt_identify_result alike = identify_plan(&plan, 2);
    CHECK(alike.mass_direction[0] == 0.0 && alike.mass_direction[1] == 0.0 && alike.mass_direction[2] == 0.0,
          "a direction where all are alike");
}

/* A slow motor is told from a late one, or the mass would be too large. */
static void a_lag_is_found(void)
{
    for (uint64_t seed = 1; seed <= part_of(3); seed++) {
        const dpt_identify_result result = identify_named("friction=0.1&step=1e-5&lag=0.003", seed);
        check_whole("a lag", &result);
        CHECK(fabs(result.mass.value - 0.1) < 5e-4, "%g kg", result.mass.value);
        CHECK(fabs(result.friction.value - 0.1) < 5e-4, "%g N", result.friction.value);
    }
}

/* A light device with much friction and coarse steps: a reversal takes 2 ms, and must not count as sliding. */
static void reversals_are_left_out(void)
{
    int missed = 0;
    for (uint64_t seed = 1; seed <= part_of(8); seed++) {
        const dpt_identify_result result =
            identify_named("mass=0.01&damping=0.1&friction=0.2&step=5.5e-5&delay=1", seed);
        check_whole("light", &result);
        missed += result.mass.low > 0.01 || result.mass.high < 0.01;
    }
    CHECK(missed <= 2, "%d intervals missed", missed);
}

static void rotation_is_found(void)
{
    const char *where = "dofs=6&step=2e-5&turn_step=2e-4&turn_friction=2e-3&friction=0.1&delay=1";
    const dpt_identify_result result = identify_named(where, 1);
    check_whole(where, &result);
    CHECK(result.measured & DPT_IDENTIFIED_INERTIA && result.measured & DPT_IDENTIFIED_SPIN_DAMPING &&
              result.measured & DPT_IDENTIFIED_SPIN_FRICTION,
          "measured %x", result.measured);
    check_value(where, "inertia", &result.inertia, 1e-4, 0.0);
    check_value(where, "spin damping", &result.spin_damping, 1e-3, 0.0);
    check_value(where, "spin friction", &result.spin_friction, 2e-3, 0.0);
    check_value(where, "mass", &result.mass, 0.1, 0.0);
    CHECK(fabs(result.angle_step - 2e-4) < 2e-7, "steps of %g rad", result.angle_step);
    CHECK(result.torque_bound == 0.01, "%g Nm", result.torque_bound);
}

/* Of 80 intervals of 95 %, 4 should miss. */
static void intervals_hold_the_truth(void)
{
    const double truth[4] = { 0.045, 0.5, 0.26, 0.001 };
    int missed = 0;
    for (uint64_t seed = 1; seed <= part_of(20); seed++) {
        const dpt_identify_result result =
            identify_named("mass=0.045&friction=0.26&step=5.5e-5&force=3.3&delay=1", seed);
        const dpt_identified *values[4] = { &result.mass, &result.damping, &result.friction, &result.delay };
        for (int k = 0; k < 4; k++)
            missed += truth[k] < values[k]->low || truth[k] > values[k]->high;
    }
    CHECK(missed <= 8, "%d intervals missed", missed);
}

static void a_hand_is_found_out(void)
{
    static const char *const held[] = { "hand=hold", "hand=hold&hand_mass=0.1&hand_damping=5",
                                        "hand=hold&grip=60&step=5.5e-5&friction=0.05",
                                        "dofs=6&hand=hold&turn_grip=0.1" };
    for (size_t i = 0; i < sizeof held / sizeof *held; i++) {
        const dpt_identify_result result = identify_named(held[i], 1);
        CHECK(result.end == DPT_IDENTIFY_END_COMPLETE && result.flags == DPT_IDENTIFY_FLAG_HELD, "%s: %s, flags %u",
              held[i], dpt_identify_end_text(result.end), result.flags);
    }
    const dpt_identify_result both = identify_named(held[1], 1);
    CHECK(fabs(both.stiffness - 200.0) < 4.0 && fabs(both.mass.value - 0.2) < 0.01, "%g N/m, %g kg", both.stiffness,
          both.mass.value);
    struct plant_plan plan = plant_of(0.1, 0.5);
    plan.spring = 100.0;
    plan.tremor = 0.5e-3;
    const dpt_identify_result trembles = identify_plan(&plan, 1);
    CHECK(trembles.flags & DPT_IDENTIFY_FLAG_HELD, "flags %u", trembles.flags);
    /* It moves by itself: without a push that shows, too. */
    dpt_identify_result moved = { .size = sizeof moved };
    dpt_device *device = device_named("sim:?hand=press");
    CHECK(dpt_device_identify(device, NULL, &moved) == DPT_OK && moved.flags == DPT_IDENTIFY_FLAG_HELD, "flags %u",
          moved.flags);
    dpt_device_close(device);
}

/* Nothing is divided by what does not move. */
static void a_locked_device_says_so(void)
{
    struct plant_plan plans[3] = { plant_of(0.1, 0.5), plant_of(0.1, 0.5), plant_of(0.1, 0.5) };
    plans[0].is_locked = 1;
    plans[1].friction = 0.6;
    plans[2].spring = 1e5;
    for (int i = 0; i < 3; i++) {
        const dpt_identify_result result = identify_plan(&plans[i], 1);
        CHECK(result.end == DPT_IDENTIFY_END_COMPLETE && result.flags & DPT_IDENTIFY_FLAG_STUCK &&
                  result.measured == DPT_IDENTIFIED_RATE && result.mass.value == 0.0,
              "plan %d: flags %u, measured %x", i, result.flags, result.measured);
    }
    const dpt_identify_result turned = identify_named("dofs=6&turn_friction=0.05", 1);
    CHECK(turned.flags == DPT_IDENTIFY_FLAG_TURN_STUCK && turned.measured & DPT_IDENTIFIED_MASS &&
              !(turned.measured & DPT_IDENTIFIED_INERTIA),
          "flags %u, measured %x", turned.flags, turned.measured);
}

static void what_needs_no_force_is_measured_without(void)
{
    dpt_identify_result result = { .size = sizeof result };
    dpt_device *device = NULL;
    plant_plan = plant_of(0.1, 0.5);
    dpt_device_open_with(&plant_driver, NULL, &device, NULL);
    CHECK(dpt_device_identify(device, NULL, &result) == DPT_OK, "it failed");
    dpt_device_close(device);
    CHECK(plant_after.nonzero == 0 && plant_after.x[0] == 0.0, "it was pushed");
    CHECK(result.measured == DPT_IDENTIFIED_RATE && fabs(result.rate - 1000.0) < 1e-6 && result.samples >= 1000 &&
              result.jitter < 1e-9,
          "measured %x, %g Hz, %g s", result.measured, result.rate, result.jitter);
    device = device_named("sim:?loss=0.05&double=0.05");
    CHECK(dpt_device_identify(device, NULL, &result) == DPT_OK, "it failed");
    dpt_device_close(device);
    CHECK(result.lost > 20 && result.lost < 150 && result.doubled > 20 && result.doubled < 100, "%d lost, %d doubled",
          (int)result.lost, (int)result.doubled);
    CHECK(fabs(result.rate - 1000.0) < 1.0, "%g Hz", result.rate);
    device = device_named("sim:?live=1");
    CHECK(dpt_device_identify(device, NULL, &result) == DPT_OK && result.measured & DPT_IDENTIFIED_RATE, "measured %x",
          result.measured);
    dpt_device_close(device);
}

/* Steps of a linkage make no grid along x, y and z. */
static void steps_of_a_linkage_are_found(void)
{
    for (double step = 1e-5; step < 5e-5; step *= 3.0) {
        struct plant_plan plan = plant_of(0.1, 0.5);
        plan.friction = 0.1;
        plan.step = step;
        plan.is_linkage = 1;
        const dpt_identify_result result = identify_plan(&plan, 1);
        check_whole("a linkage", &result);
        CHECK(result.position_step > 0.8 * step && result.position_step < 1.25 * step, "%g m instead of %g",
              result.position_step, step);
        check_value("a linkage", "mass", &result.mass, 0.1, 0.0);
        check_value("a linkage", "damping", &result.damping, 0.5, 0.0);
        check_value("a linkage", "friction", &result.friction, 0.1, 0.0);
    }
}

/* The same seed gives the same pushes, another one others. */
static void pushes_are_repeatable(void)
{
    const dpt_identify_result a = identify_named("step=2e-5", 7), b = identify_named("step=2e-5", 7);
    const dpt_identify_result other = identify_named("step=2e-5", 8);
    CHECK(!memcmp(&a, &b, sizeof a), "the same seed, another answer");
    CHECK(memcmp(&a, &other, sizeof a) != 0, "another seed, the same answer");
}

/* ---- arguments ---- */

static dpt_result call_with_def(void *def)
{
    dpt_identify_result result = { .size = sizeof result };
    dpt_device *device = device_named("sim:");
    const dpt_result code = dpt_device_identify(device, def, &result);
    dpt_device_close(device);
    return code;
}

static dpt_result call_with_result(void *result)
{
    dpt_identify_def def;
    dpt_identify_def_init(&def);
    def.seconds = 0.1;
    dpt_device *device = device_named("sim:");
    const dpt_result code = dpt_device_identify(device, &def, result);
    dpt_device_close(device);
    return code;
}

static void defaults(void *def, size_t size)
{
    dpt_identify_def_defaults(def, size);
}

static void arguments_are_checked(void)
{
    const struct sized of_def = { "dpt_identify_def", sizeof(dpt_identify_def), sizeof(dpt_identify_def),
                                  call_with_def };
    const struct sized of_result = { "dpt_identify_result", sizeof(dpt_identify_result), sizeof(dpt_identify_result),
                                     call_with_result };
    dpt_identify_def good, def;
    dpt_identify_result result = { .size = sizeof result };
    dpt_identify_def_init(&good);
    CHECK(!good.may_move && good.button == DPT_IDENTIFY_NO_BUTTON && good.blocks == 8 && good.seed == 1 &&
              good.seconds == 1.0 && !good.report,
          "defaults");
    check_input(&of_def, &good);
    check_output(&of_result);
    check_defaults(&of_def, defaults, &good);
    for (int i = 0; i < 7; i++) {
        def = good;
        def.may_move = i == 0 ? 2 : 0;
        def.button = i == 1 ? 32 : def.button;
        def.blocks = i == 2 ? 3 : i == 3 ? 33 : 8;
        def.seconds = i == 4 ? 0.0 : i == 5 ? 61.0 : i == 6 ? NAN : 1.0;
        CHECK(call_with_def(&def) == DPT_E_ARGUMENT, "wrong value %d", i);
    }
    dpt_device *device = device_named("sim:");
    CHECK(dpt_device_identify(NULL, &good, &result) == DPT_E_ARGUMENT &&
              dpt_device_identify(device, &good, NULL) == DPT_E_ARGUMENT,
          "NULL");
    dpt_device_close(device);
    for (uint32_t end = 0; end <= DPT_IDENTIFY_END_NO_WATCHDOG; end++)
        CHECK(strlen(dpt_identify_end_text(end)) > 4, "end %u", end);
    CHECK(!strcmp(dpt_identify_end_text(DPT_IDENTIFY_END_NO_WATCHDOG + 1), "?"), "no end");
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(the_truth_is_found);
    TEST(a_plant_of_another_kind_is_found);
    TEST(the_least_direction_is_found);
    TEST(a_lag_is_found);
    TEST(reversals_are_left_out);
    TEST(rotation_is_found);
    TEST(intervals_hold_the_truth);
    TEST(a_hand_is_found_out);
    TEST(a_locked_device_says_so);
    TEST(what_needs_no_force_is_measured_without);
    TEST(steps_of_a_linkage_are_found);
    TEST(pushes_are_repeatable);
    TEST(arguments_are_checked);
    return check_report();
}
