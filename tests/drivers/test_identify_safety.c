/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Identification ends at once, and with zero force, for each reason that it names; and no command is ever stronger than
 * the bound. The plant fails as it is told, and remembers its commands.
 */
#include "drivers/identify_plant.h"
#include "drivers/open_device.h"
#include "dynpoint/identify.h"

struct listener {
    uint64_t calls, stop_at; /* stop_at 0: never */
    uint32_t stages;         /* bit of each stage */
    double done;
    int went_back;
};

static int listen(void *user, const dpt_identify_progress *progress)
{
    struct listener *listener = user;
    CHECK(progress->size == sizeof *progress && progress->stage <= DPT_IDENTIFY_STAGE_TURN && progress->axis < 3 &&
              progress->done >= 0.0 && progress->done <= 1.0,
          "progress: stage %u, axis %u, %g", progress->stage, progress->axis, progress->done);
    listener->went_back |= progress->done < listener->done;
    listener->done = progress->done;
    listener->stages |= 1u << progress->stage;
    return ++listener->calls == listener->stop_at;
}

static dpt_identify_result run(const struct plant_plan *plan, uint32_t button, struct listener *listener)
{
    dpt_device *device = NULL;
    dpt_identify_def def;
    dpt_identify_result result = { .size = sizeof result };
    dpt_identify_def_init(&def);
    def.may_move = 1;
    def.button = button;
    def.seconds = 0.2;
    def.report = listener ? listen : NULL;
    def.user = listener;
    plant_plan = *plan;
    CHECK(dpt_device_open_with(&plant_driver, NULL, &device, NULL) == DPT_OK, "open");
    CHECK(dpt_device_identify(device, &def, &result) == DPT_OK, "it failed");
    dpt_device_close(device);
    return result;
}

/* No command was too strong, and no force stays. */
static void check_commands(const char *what, double bound)
{
    const double *force = plant_after.written.force;
    CHECK(plant_after.strongest <= bound * (1.0 + 1e-12), "%s: %g N were sent", what, plant_after.strongest);
    CHECK(plant_after.strongest_turn == 0.0, "%s: a torque", what);
    CHECK(force[0] == 0.0 && force[1] == 0.0 && force[2] == 0.0 && plant_after.writes > 0,
          "%s: the last command is %g %g %g", what, force[0], force[1], force[2]);
}

static void a_sound_device_is_pushed_within_bounds(void)
{
    static const struct {
        double force_max, bound;
    } cases[] = { { 20.0, 0.5 }, { 5.0, 0.5 }, { 3.3, 0.33 }, { 1.0, 0.1 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct plant_plan plan = plant_of(0.05, 0.5);
        struct listener listener = { .calls = 0 };
        plan.force_max = cases[i].force_max;
        plan.friction = 0.25 * cases[i].bound;
        const dpt_identify_result result = run(&plan, DPT_IDENTIFY_NO_BUTTON, &listener);
        check_commands("sound", cases[i].bound);
        CHECK(fabs(result.force_bound - cases[i].bound) < 1e-12, "%g N", result.force_bound);
        CHECK(result.end == DPT_IDENTIFY_END_COMPLETE && result.measured & DPT_IDENTIFIED_MASS &&
                  plant_after.nonzero > 1000,
              "%s", dpt_identify_end_text(result.end));
        CHECK(result.speed_max < 0.2 && result.displacement_max < 0.02, "%g m/s, %g m", result.speed_max,
              result.displacement_max);
        CHECK(listener.calls > 100 && listener.stages == 3 && !listener.went_back, "%d reports, stages %x",
              (int)listener.calls, listener.stages);
    }
}

/* At several times of the measurement. */
static void each_fault_ends_it(void)
{
    static const struct {
        enum plant_fault fault;
        uint32_t end;
    } cases[] = {
        { PLANT_LOSES, DPT_IDENTIFY_END_SAMPLES },     { PLANT_IS_LATE, DPT_IDENTIFY_END_SAMPLES },
        { PLANT_REFUSES, DPT_IDENTIFY_END_SAMPLES },   { PLANT_BAD_POSE, DPT_IDENTIFY_END_SAMPLES },
        { PLANT_UNREADY, DPT_IDENTIFY_END_NOT_READY }, { PLANT_UNPLUGGED, DPT_IDENTIFY_END_LOST },
        { PLANT_RELEASED, DPT_IDENTIFY_END_RELEASED },
    };
    static const double times[] = { 0.35, 1.5, 2.005, 9.99, 20.3 };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (size_t k = 0; k < sizeof times / sizeof *times; k++) {
            char what[64];
            struct plant_plan plan = plant_of(0.1, 0.5);
            plan.friction = 0.1;
            plan.fault = cases[i].fault;
            plan.fault_time = times[k];
            snprintf(what, sizeof what, "fault %d at %g s", (int)cases[i].fault, times[k]);
            const dpt_identify_result result = run(&plan, 3, NULL);
            CHECK(result.end == cases[i].end, "%s: %s", what, dpt_identify_end_text(result.end));
            check_commands(what, 0.5);
            CHECK(!(result.measured & DPT_IDENTIFIED_MASS), "%s: a mass", what);
            CHECK((double)plant_after.period < 1e3 * times[k] + 35.0, "%s: it went on until %g s", what,
                  1e-3 * (double)plant_after.period);
        }
}

/* What pushes itself, and what something else pushes. */
static void a_runaway_is_let_go(void)
{
    struct plant_plan fast = plant_of(0.1, -6.0), slow = plant_of(0.1, 5.0);
    dpt_identify_result result = run(&fast, DPT_IDENTIFY_NO_BUTTON, NULL);
    CHECK(result.end == DPT_IDENTIFY_END_SPEED, "%s", dpt_identify_end_text(result.end));
    check_commands("a runaway", 0.5);
    CHECK(result.speed_max > 0.2 && result.speed_max < 0.3, "%g m/s", result.speed_max);
    slow.push = 0.8;
    slow.fault_time = 3.0;
    result = run(&slow, DPT_IDENTIFY_NO_BUTTON, NULL);
    CHECK(result.end == DPT_IDENTIFY_END_DISPLACEMENT, "%s", dpt_identify_end_text(result.end));
    check_commands("what is pushed away", 0.5);
    CHECK(result.displacement_max > 0.02 && result.displacement_max < 0.0205, "%g m", result.displacement_max);
    slow.push = 5.0;
    result = run(&slow, DPT_IDENTIFY_NO_BUTTON, NULL);
    CHECK(result.end == DPT_IDENTIFY_END_SPEED, "%s", dpt_identify_end_text(result.end));
    check_commands("what is struck", 0.5);
}

static void a_key_ends_it(void)
{
    static const uint64_t stops[] = { 1, 3, 6, 9, 20, 57, 130, 300 };
    for (size_t i = 0; i < sizeof stops / sizeof *stops; i++) {
        const struct plant_plan plan = plant_of(0.1, 0.5);
        struct listener listener = { .stop_at = stops[i] };
        const dpt_identify_result result = run(&plan, DPT_IDENTIFY_NO_BUTTON, &listener);
        CHECK(result.end == DPT_IDENTIFY_END_STOPPED && listener.calls == stops[i], "after %d of %d reports: %s",
              (int)listener.calls, (int)stops[i], dpt_identify_end_text(result.end));
        check_commands("a key", 0.5);
    }
}

static void a_button_that_is_not_held_moves_nothing(void)
{
    struct plant_plan plan = plant_of(0.1, 0.5);
    const dpt_identify_result held = run(&plan, 3, NULL);
    CHECK(held.end == DPT_IDENTIFY_END_COMPLETE, "%s", dpt_identify_end_text(held.end));
    const dpt_identify_result result = run(&plan, 1, NULL);
    CHECK(result.end == DPT_IDENTIFY_END_RELEASED && plant_after.nonzero == 0, "%s, %d pushes",
          dpt_identify_end_text(result.end), (int)plant_after.nonzero);
}

/* But for a simulated one whose time stands still while no one reads. */
static void without_a_watchdog_nothing_moves(void)
{
    struct plant_plan plan = plant_of(0.1, 0.5);
    plan.watchdog = 0.0;
    CHECK(run(&plan, DPT_IDENTIFY_NO_BUTTON, NULL).end == DPT_IDENTIFY_END_COMPLETE && plant_after.nonzero > 0,
          "a simulated one is refused");
    static const uint32_t flags[] = { DPT_DEVICE_FLAG_DETERMINISTIC, DPT_DEVICE_FLAG_SIMULATED, 0 };
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++) {
        plan.flags = flags[i];
        const dpt_identify_result result = run(&plan, DPT_IDENTIFY_NO_BUTTON, NULL);
        CHECK(result.end == DPT_IDENTIFY_END_NO_WATCHDOG && plant_after.nonzero == 0, "flags %u: %s, %d pushes",
              flags[i], dpt_identify_end_text(result.end), (int)plant_after.nonzero);
        check_commands("no watchdog", 0.0);
    }
}

/* What gives no force is watched, and nothing is said of its mass. */
static void what_gives_no_force_is_watched(void)
{
    struct plant_plan plan = plant_of(0.1, 0.5);
    plan.force_max = 0.0;
    const dpt_identify_result result = run(&plan, DPT_IDENTIFY_NO_BUTTON, NULL);
    CHECK(result.end == DPT_IDENTIFY_END_COMPLETE && result.measured == DPT_IDENTIFIED_RATE, "%s, measured %x",
          dpt_identify_end_text(result.end), result.measured);
    check_commands("no force", 0.0);
}

/* By the clock, too, whatever comes first: the end is in order. */
static void a_live_device_is_left_without_force(void)
{
    struct listener listener = { .stop_at = 20 };
    dpt_device *device = device_named("sim:?live=1");
    dpt_identify_def def;
    dpt_identify_result result = { .size = sizeof result };
    dpt_identify_def_init(&def);
    def.may_move = 1;
    def.seconds = 0.2;
    def.report = listen;
    def.user = &listener;
    CHECK(dpt_device_identify(device, &def, &result) == DPT_OK, "it failed");
    CHECK(result.end == DPT_IDENTIFY_END_STOPPED || result.end == DPT_IDENTIFY_END_SAMPLES, "%s",
          dpt_identify_end_text(result.end));
    dpt_device_close(device);
}

int main(void)
{
    TEST(a_sound_device_is_pushed_within_bounds);
    TEST(each_fault_ends_it);
    TEST(a_runaway_is_let_go);
    TEST(a_key_ends_it);
    TEST(a_button_that_is_not_held_moves_nothing);
    TEST(without_a_watchdog_nothing_moves);
    TEST(what_gives_no_force_is_watched);
    TEST(a_live_device_is_left_without_force);
    return check_report();
}
