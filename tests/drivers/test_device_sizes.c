/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Structs of devices, drivers and loops, of callers that are older or newer than the library; and drivers from outside
 * that are older or newer than it.
 */
#include "drivers/open_device.h"
#include "dynpoint/driver.h"
#include "dynpoint/recorder.h"
#include "lib/size_checks.h"

/* A driver whose headers are newer: its structs go on where the library's end. */
struct newer_info {
    dpt_device_info now;
    double later[4];
};
struct newer_state {
    dpt_device_state now;
    double later[8]; /* more joints, say */
};
struct newer_counts {
    dpt_device_counts now;
    uint64_t later[4];
};
struct newer_error {
    dpt_device_error now;
    char later[256];
};

struct still {
    dpt_device device;
    uint64_t sample, sizes; /* calls whose struct's size was not the library's own */
};

static struct still still;
static int is_newer;
static dpt_result opening;

static dpt_result still_open(const dpt_driver *driver, const char *where, dpt_device **device, dpt_device_error *error)
{
    (void)driver, (void)where;
    if (opening == DPT_OK) {
        still = (struct still){ .sizes = 0 };
        memset(&still.device, 0x5a, sizeof still.device);
    }
    still.sizes += error->size != sizeof *error;
    if (is_newer) {
        struct newer_error all = { .now = { .size = sizeof all } };
        memset(all.now.text, 'x', sizeof all.now.text);
        memset(all.later, 'y', sizeof all.later);
        memcpy(error, &all, sizeof all);
    } else {
        snprintf(error->text, sizeof error->text, "it was opened");
    }
    *device = &still.device;
    return opening;
}

static void still_info(const dpt_device *device, dpt_device_info *info)
{
    struct newer_info all = { .now = { .size = sizeof all, .rate = 1000.0, .workspace_max = { 1, 1, 1 } },
                              .later = { 7, 7, 7, 7 } };
    still.sizes += info->size != sizeof *info || device != &still.device;
    memcpy(info, &all, is_newer ? sizeof all : sizeof *info);
}

static dpt_result still_read(dpt_device *device, dpt_device_state *state)
{
    struct newer_state all = { .now = { .size = sizeof all, .status = DPT_DEVICE_STATUS_READY } };
    still.sizes += state->size != sizeof *state || device != &still.device;
    all.now.sequence = still.sample;
    all.now.time_ns = 1000000 * still.sample++;
    all.now.fresh = 1;
    all.now.pose.orientation[0] = 1.0;
    for (int i = 0; i < DPT_JOINTS_MAX; i++)
        all.now.joint[i] = 1.0 + i;
    for (int i = 0; i < 8; i++)
        all.later[i] = 7.0;
    memcpy(state, &all, is_newer ? sizeof all : sizeof *state);
    return DPT_OK;
}

static dpt_result still_write(dpt_device *device, const dpt_wrench *wrench)
{
    (void)device, (void)wrench;
    return DPT_OK;
}

static dpt_result still_clear(dpt_device *device)
{
    (void)device;
    return DPT_OK;
}

static void still_counts(const dpt_device *device, dpt_device_counts *counts)
{
    struct newer_counts all = { .now = { .size = sizeof all, .samples = 3, .resets = 9 } };
    still.sizes += counts->size != sizeof *counts || device != &still.device;
    memset(all.later, 0x77, sizeof all.later);
    memcpy(counts, &all, is_newer ? sizeof all : sizeof *counts);
}

static void still_close(dpt_device *device)
{
    (void)device;
}

static const dpt_driver still_driver = {
    .size = sizeof(dpt_driver),
    .version = DPT_DRIVER_VERSION,
    .name = "still",
    .about = "a test's own",
    .open = still_open,
    .info = still_info,
    .read = still_read,
    .write = still_write,
    .clear = still_clear,
    .counts = still_counts,
    .close = still_close,
};

static dpt_device *device;

static dpt_result info(void *out)
{
    return dpt_device_get_info(device, out);
}

/* The same sample each time, so that two answers can be compared. */
static dpt_result state(void *out)
{
    still.sample = 5;
    return dpt_device_read(device, out);
}

static dpt_result counts(void *out)
{
    return dpt_device_get_counts(device, out);
}

/* What is refused fills the error, and says so by its code. */
static dpt_result error_of_a_name(void *out)
{
    dpt_device *none;
    dpt_result result = dpt_device_open("nonesuch", &none, out);
    return result == DPT_E_UNSUPPORTED ? DPT_OK : result;
}

static dpt_result error_of_no_name(void *out)
{
    dpt_device *none;
    dpt_result result = dpt_device_open(NULL, &none, out);
    return result == DPT_E_ARGUMENT ? DPT_OK : result;
}

static dpt_result error_of_no_driver(void *out)
{
    dpt_device *none;
    dpt_result result = dpt_device_open_with(NULL, NULL, &none, out);
    return result == DPT_E_ARGUMENT ? DPT_OK : result;
}

static dpt_result error_of_a_driver(void *out)
{
    dpt_device *none;
    opening = DPT_E_PERMISSION;
    dpt_result result = dpt_device_open_with(&still_driver, NULL, &none, out);
    opening = DPT_OK;
    CHECK(result != DPT_E_PERMISSION || !none, "refused, with a device");
    return result == DPT_E_PERMISSION ? DPT_OK : result;
}

#define WHOLE(type) sizeof(type), sizeof(type)

static dpt_result tick(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    (void)user, (void)sample;
    wrench->force[0] = 1.0;
    return DPT_OK;
}

/* The loop and its guard, of which nothing is counted in one tick but that. */
static dpt_result loop_of(void *loop_def, dpt_loop_stats *stats)
{
    dpt_loop *loop;
    dpt_device *sim = device_named("sim:");
    dpt_result result = dpt_loop_open(sim, loop_def, &loop);
    if (result == DPT_OK && stats)
        result = dpt_loop_run(loop, stats);
    CHECK((loop != NULL) == (result == DPT_OK || stats), "%s", dpt_result_name(result));
    dpt_loop_close(loop);
    dpt_device_close(sim);
    return result;
}

static dpt_loop_def a_loop_def(void)
{
    dpt_loop_def def;
    dpt_loop_def_init(&def);
    def.tick = tick;
    def.ticks = 5;
    return def;
}

static dpt_result loop_stats(void *out)
{
    dpt_loop_def def = a_loop_def();
    return loop_of(&def, out);
}

static dpt_result loop_def(void *given)
{
    return loop_of(given, NULL);
}

static dpt_result guard_def_of_a_loop(void *given)
{
    dpt_loop_def def = a_loop_def();
    def.guard = given;
    return loop_of(&def, NULL);
}

/* A recorder that is closed with these counts; where they are refused, it is closed without. */
static dpt_result recorder_of(void *def, void *counts)
{
    const dpt_record_header header = { .size = sizeof header };
    struct small_file file = file_with("");
    dpt_recorder *recorder;
    dpt_result result = dpt_recorder_open(file.path, &header, def, &recorder);
    if (result == DPT_OK && counts)
        result = dpt_recorder_close(recorder, counts);
    if (recorder && (result != DPT_OK || !counts))
        CHECK(dpt_recorder_close(recorder, NULL) == DPT_OK, "close");
    unlink(file.path);
    return result;
}

static dpt_result recorder_counts(void *out)
{
    return recorder_of(NULL, out);
}

static dpt_result recorder_def(void *given)
{
    return recorder_of(given, NULL);
}

static const struct sized outputs[] = {
    { "dpt_device_info", WHOLE(dpt_device_info), info },
    { "dpt_device_state", WHOLE(dpt_device_state), state },
    { "dpt_device_counts", WHOLE(dpt_device_counts), counts },
    { "dpt_device_error of a name", WHOLE(dpt_device_error), error_of_a_name },
    { "dpt_device_error of no name", WHOLE(dpt_device_error), error_of_no_name },
    { "dpt_device_error of no driver", WHOLE(dpt_device_error), error_of_no_driver },
    { "dpt_device_error of a driver", WHOLE(dpt_device_error), error_of_a_driver },
    { "dpt_loop_stats", WHOLE(dpt_loop_stats), loop_stats },
    { "dpt_recorder_counts", WHOLE(dpt_recorder_counts), recorder_counts },
};

/* ---- what the library takes ---- */

static dpt_result map(void *given)
{
    const double from[3] = { 0, 0, 0 }, to[3] = { 1, 1, 1 };
    double scale, offset[3];
    return dpt_device_map(given, from, to, &scale, offset);
}

static dpt_result coupling_of(void *given)
{
    dpt_coupling_def def;
    dpt_coupling_def_init(&def);
    return dpt_device_fill_coupling(given, &def);
}

static dpt_result fill_coupling(void *def)
{
    const dpt_device_info info = { .size = sizeof info, .mass = 0.1 };
    return dpt_device_fill_coupling(&info, def);
}

static void structs_of_any_size(void)
{
    dpt_device_info good = { .size = sizeof good, .workspace_max = { 1, 1, 1 } };
    dpt_coupling_def def;
    dpt_coupling_def_init(&def);
    const struct sized of_coupling = { "dpt_device_info of a coupling", WHOLE(dpt_device_info), coupling_of };
    const struct sized of_def = { "dpt_coupling_def to fill", WHOLE(dpt_coupling_def), fill_coupling };
    check_input(&of_coupling, &good);
    check_input(&of_def, &def);
    const struct sized of_map = { "dpt_device_info to map", WHOLE(dpt_device_info), map };
    for (is_newer = 0; is_newer < 2; is_newer++) {
        CHECK(dpt_device_open_with(&still_driver, NULL, &device, NULL) == DPT_OK, "open");
        for (size_t i = 0; i < sizeof outputs / sizeof *outputs; i++)
            check_output(&outputs[i]);
        CHECK(still.sizes == 0, "%d calls with another size than the library's", (int)still.sizes);
        dpt_device_close(device);
    }
    is_newer = 0;
    check_input(&of_map, &good);
}

static void loop_defaults(void *def, size_t size)
{
    dpt_loop_def_defaults(def, size);
}

static void loops_of_any_size(void)
{
    const struct sized of_def = { "dpt_loop_def", WHOLE(dpt_loop_def), loop_def };
    const struct sized of_guard = { "dpt_guard_def of a loop", WHOLE(dpt_guard_def), guard_def_of_a_loop };
    const struct sized of_defaults = { "dpt_loop_def", WHOLE(dpt_loop_def), NULL };
    const dpt_loop_def good = a_loop_def();
    dpt_loop_def defaults;
    dpt_guard_def guard;
    dpt_loop_def_init(&defaults);
    dpt_guard_def_init(&guard);
    CHECK(defaults.size == sizeof defaults && defaults.priority == 80 && defaults.lock == 1 && !defaults.guard,
          "priority %u, lock %u", defaults.priority, defaults.lock);
    check_input(&of_def, &good);
    check_input(&of_guard, &guard);
    check_defaults(&of_defaults, loop_defaults, &defaults);
}

static void recorder_defaults(void *def, size_t size)
{
    dpt_recorder_def_defaults(def, size);
}

static void recorders_of_any_size(void)
{
    const struct sized of_def = { "dpt_recorder_def", WHOLE(dpt_recorder_def), recorder_def };
    const struct sized of_defaults = { "dpt_recorder_def", WHOLE(dpt_recorder_def), NULL };
    dpt_recorder_def defaults;
    dpt_recorder_def_init(&defaults);
    CHECK(defaults.size == sizeof defaults && defaults.capacity == 4096 && !defaults.wait, "%u records",
          defaults.capacity);
    check_input(&of_def, &defaults);
    check_defaults(&of_defaults, recorder_defaults, &defaults);
}

/* What a device tells is in the def, and the rest of it stays. */
static void a_device_fills_a_coupling(void)
{
    dpt_coupling_def def;
    dpt_device_info info = { .size = sizeof info };
    dpt_coupling_def_init(&def);
    def.zoom = 3;
    def.stiffness = 70;
    def.loop_delay = 1e-4;
    info.wrench_dofs = 6;
    info.rate = 2000;
    double *const told[] = { &info.mass,     &info.inertia,       &info.damping,       &info.spin_damping,
                             &info.friction, &info.spin_friction, &info.position_step, &info.angle_step,
                             &info.delay,    &info.force_max,     &info.torque_max,    &info.stiffness_max };
    for (int i = 0; i < 12; i++)
        *told[i] = 0.001 * (i + 1);
    CHECK(dpt_device_fill_coupling(&info, &def) == DPT_OK, "fill");
    for (int i = 0; i < 12; i++)
        CHECK((&def.mass)[i] == 0.001 * (i + 1), "field %d: %g", i, (&def.mass)[i]);
    CHECK(def.has_torque == 1 && def.rate == 2000 && def.zoom == 3 && def.stiffness == 70 && def.loop_delay == 1e-4 &&
              def.gain_margin == 1.5 && def.size == sizeof def,
          "rate %g, zoom %g", def.rate, def.zoom);
    info.wrench_dofs = 3;
    CHECK(dpt_device_fill_coupling(&info, &def) == DPT_OK && def.has_torque == 0, "force alone");
    CHECK(dpt_device_fill_coupling(NULL, &def) == DPT_E_ARGUMENT &&
              dpt_device_fill_coupling(&info, NULL) == DPT_E_ARGUMENT,
          "of nothing");
}

/* Whatever headers a driver has, its caller gets what both know. */
static void drivers_fill_in_their_own_structs(void)
{
    for (is_newer = 0; is_newer < 2; is_newer++) {
        dpt_device_error error = { .size = sizeof error };
        dpt_device_info told = { .size = sizeof told };
        dpt_device_counts counted = { .size = sizeof counted };
        CHECK(dpt_device_open_with(&still_driver, NULL, &device, &error) == DPT_OK && error.code == DPT_OK &&
                  error.size == sizeof error,
              "open");
        CHECK(strlen(error.text) == (is_newer ? sizeof error.text - 1 : strlen("it was opened")), "%d characters",
              (int)strlen(error.text));
        const dpt_device_state sample = state_of(device);
        CHECK(sample.size == sizeof sample && sample.fresh == 1 && sample.joint[0] == 1.0 &&
                  sample.joint[DPT_JOINTS_MAX - 1] == DPT_JOINTS_MAX,
              "a sample");
        CHECK(dpt_device_get_info(device, &told) == DPT_OK && told.rate == 1000.0 && told.size == sizeof told, "info");
        CHECK(dpt_device_get_counts(device, &counted) == DPT_OK && counted.resets == 9 &&
                  counted.size == sizeof counted,
              "counts");
        dpt_device_close(device);
    }
    is_newer = 0;
}

static void the_librarys_part_of_a_device_is_its_own(void)
{
    CHECK(dpt_device_open_with(&still_driver, NULL, &device, NULL) == DPT_OK, "open");
    CHECK(device->driver == &still_driver && !device->reserved[0] && !device->reserved[1] && !device->reserved[2],
          "what the driver left there stays");
    dpt_device_close(device);
}

/* Functions that a newer version adds are optional: a library that does not know them serves the driver without. */
static void drivers_of_any_size(void)
{
    struct {
        dpt_driver now;
        void (*later[4])(void);
    } newer = { .now = still_driver };
    memset((void *)newer.later, 0x5a, sizeof newer.later);
    const struct {
        uint32_t size, version;
        dpt_result result;
    } cases[] = {
        { sizeof(dpt_driver), DPT_DRIVER_VERSION, DPT_OK },
        { sizeof newer, DPT_DRIVER_VERSION, DPT_OK },
        { 4096, DPT_DRIVER_VERSION, DPT_OK },
        { 4097, DPT_DRIVER_VERSION, DPT_E_UNSUPPORTED },
        { offsetof(dpt_driver, steer) - 8, DPT_DRIVER_VERSION, DPT_E_UNSUPPORTED },
        { offsetof(dpt_driver, steer), DPT_DRIVER_VERSION, DPT_OK },
        { 0, DPT_DRIVER_VERSION, DPT_E_UNSUPPORTED },
        { sizeof(dpt_driver), 0, DPT_E_UNSUPPORTED },
        { sizeof(dpt_driver), 1, DPT_E_UNSUPPORTED },
        { sizeof(dpt_driver), DPT_DRIVER_VERSION + 1, DPT_E_UNSUPPORTED },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        dpt_device_error error = { .size = sizeof error };
        newer.now.size = cases[i].size;
        newer.now.version = cases[i].version;
        dpt_result result = dpt_device_open_with(&newer.now, NULL, &device, &error);
        CHECK(result == cases[i].result && error.code == result, "size %u, version %u: %s", cases[i].size,
              cases[i].version, dpt_result_name(result));
        if (result == DPT_OK)
            CHECK(state_of(device).fresh == 1, "size %u: no sample", cases[i].size);
    }
}

int main(void)
{
    TEST(structs_of_any_size);
    TEST(loops_of_any_size);
    TEST(a_device_fills_a_coupling);
    TEST(recorders_of_any_size);
    TEST(drivers_fill_in_their_own_structs);
    TEST(the_librarys_part_of_a_device_is_its_own);
    TEST(drivers_of_any_size);
    return check_report();
}
