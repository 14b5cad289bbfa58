/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Devices: simulated and replayed ones with a time of their own, opened by good and bad names, read, written,
 * cleared and closed in any order. No name here leads to a real device.
 */
#include "dynpoint/driver.h"
#include "dynpoint/openhaptics.h"
#include "fuzz/calls/devices.h"

enum { DEVICES = 3 };

struct device_model {
    dpt_device *open;
    int is_replay, has_state, is_lost;
    uint64_t sequence, time_ns, writes;
    uint32_t wrench_dofs;
};

static struct device_model devices[DEVICES];

static const char *const good_names[] = {
    "sim",
    "sim:",
    "sim:?hand=press&reach=0.05&cycle=0.05",
    "sim:?hand=wipe&dofs=6&rate=2000",
    "sim:?hand=hold&delay=3&step=1e-5",
    "sim:?fault=estop@0.01&watchdog=0.002",
    "sim:?fault=unplugged@0.02&dofs=6",
    "sim:?fault=silent@0.005",
    "sim:?fault=docked@0&mass=1e-4&grip=1e5&damping=0",
    "sim:?rate=1&force=0&torque=0",
    "sim:?hand=press&friction=0.2&stiction=0.5&lag=0.003&gravity=2",
    "sim:?dofs=6&delay=1.5&jitter=0.0009&loss=0.2&double=0.2&turn_friction=0.001&seed=7",
};

static const struct {
    const char *name;
    dpt_result code;
} bad_names[] = {
    { "", DPT_E_UNSUPPORTED },
    { ":", DPT_E_UNSUPPORTED },
    { "simulated", DPT_E_UNSUPPORTED },
    { "si", DPT_E_UNSUPPORTED },
    { "sim:somewhere", DPT_E_SETTING },
    { "sim:?", DPT_E_SETTING },
    { "sim:?mass", DPT_E_SETTING },
    { "sim:?mass=", DPT_E_SETTING },
    { "sim:?mass=nan", DPT_E_SETTING },
    { "sim:?mass=-1", DPT_E_SETTING },
    { "sim:?mass=1e999", DPT_E_SETTING },
    { "sim:?rate=0", DPT_E_SETTING },
    { "sim:?dofs=4", DPT_E_SETTING },
    { "sim:?fault=tired@1", DPT_E_SETTING },
    { "sim:?hand=/nonexistent/hand.csv", DPT_E_OPEN },
    { "replay", DPT_E_SETTING },
    { "replay:/nonexistent/trace.csv", DPT_E_OPEN },
    { "replay:/", DPT_E_OPEN },
};

const char *draw_device_name(void)
{
    static char name[160];
    if (!draw_one_in(4))
        return good_names[draw_below(sizeof good_names / sizeof *good_names)];
    snprintf(name, sizeof name, "replay:%s?rate=%u%s", trace_path, 100 + draw_below(2000),
             draw_one_in(2) ? "&again=1" : "");
    return name;
}

static struct device_model *draw_device(void)
{
    struct device_model *of = &devices[draw_below(DEVICES)];
    return of->open ? of : NULL;
}

static void open(void)
{
    struct device_model *of = &devices[draw_below(DEVICES)];
    const int is_bad = draw_one_in(3), no_name = draw_one_in(40), no_device = draw_one_in(40);
    const uint32_t which = draw_below(sizeof bad_names / sizeof *bad_names);
    const char *name = is_bad ? bad_names[which].name : draw_device_name();
    struct codes codes = { .count = 0 };
    dpt_device *made = NULL;
    const int has_error = draw_one_in(2);
    dpt_device_error told;
    const uint32_t size = draw_size(sizeof told, sizeof told);
    dpt_device_error *error = output_sized(0, size);
    if (has_error)
        size_codes_of_output(size, sizeof told, 0, &codes);
    CALL(dpt_device_close, of->open);
    *of = (struct device_model){ .open = NULL };
    may_fail(&codes, no_name || no_device, DPT_E_ARGUMENT);
    may_fail(&codes, is_bad, bad_names[which].code);
    call_with("name %llu, bad %llu", which, (uint64_t)is_bad, 0, 0);
    const dpt_result result =
        RESULT(dpt_device_open, no_name ? NULL : name, no_device ? NULL : &made, has_error ? error : NULL);
    expect(result, &codes);
    outputs_are_guarded(0, 1);
    HOLDS((result == DPT_OK) == (made != NULL), "%s", dpt_result_name(result));
    if (!has_error || output_is_untouched(0, sizeof size))
        HOLDS(!has_error || result == DPT_E_SIZE, "nothing was told");
    else if (output_read(0, size, sizeof told, sizeof told, &told))
        HOLDS(told.code == result && memchr(told.text, 0, sizeof told.text) && (result == DPT_OK || told.text[0]),
              "code %d", told.code);
    of->open = made;
    of->is_replay = !strncmp(name, "replay", 6);
}

/* Through its driver, as others would. */
static void open_with(void)
{
    const dpt_driver *sim = CALL(dpt_driver_find, "sim");
    dpt_device *made = NULL;
    dpt_driver other = *sim;
    const int kind = (int)draw_below(5);
    struct codes codes = { .count = 0 };
    if (kind == 1)
        other.version++;
    if (kind == 2)
        other.read = NULL;
    may_fail(&codes, kind == 1 || kind == 2, DPT_E_UNSUPPORTED);
    may_fail(&codes, kind == 3, DPT_E_ARGUMENT);
    const dpt_driver *driver = kind == 3 ? NULL : kind == 4 ? sim : &other;
    const char *where = draw_one_in(2) ? NULL : "?hand=press";
    expect(RESULT(dpt_device_open_with, driver, where, &made, NULL), &codes);
    CALL(dpt_device_close, made);
    CALL(dpt_device_close, NULL);
}

static void drivers(void)
{
    uint32_t count = 0;
    for (const dpt_driver *driver; (driver = CALL(dpt_driver_get, count)) != NULL; count++)
        HOLDS(CALL(dpt_driver_find, driver->name) == driver && driver->about[0], "driver %u", count);
    HOLDS(count >= 2, "%u drivers", count);
    HOLDS(!CALL(dpt_driver_get, count + (uint32_t)(draw_bits() >> 40)), "beyond the last");
    HOLDS(!CALL(dpt_driver_find, NULL) && !CALL(dpt_driver_find, "") && !CALL(dpt_driver_find, "simm"),
          "a name of none");
}

/* From its workspace to a box. */
static void map(const struct device_model *of, const dpt_device_info *info)
{
    double scale = -1.0, offset[3];
    const double low[3] = { -1, -2, -3 }, high[3] = { 1, draw_one_in(4) ? -3 : 2, 3 };
    const int is_flat = of->is_replay, is_wrong = high[1] < low[1];
    struct codes of_map = { .count = 0 };
    const void *given = draw_input(1, info, draw_size(sizeof *info, sizeof *info), sizeof *info, sizeof *info, &of_map);
    may_fail(&of_map, is_flat, DPT_E_FINITE);
    may_fail(&of_map, is_wrong, DPT_E_ARGUMENT);
    expect(RESULT(dpt_device_map, given, low, high, &scale, offset), &of_map);
    outputs_are_guarded(1, 1);
    HOLDS(of_map.count || (scale > 0.0 && isfinite(scale)), "scale %g", scale);
    HOLDS(RESULT(dpt_device_map, NULL, low, high, &scale, offset) == DPT_E_ARGUMENT, "no info");
}

static void info(void)
{
    struct device_model *of = draw_device();
    struct codes codes = { .count = 0 };
    const int no_out = draw_one_in(30);
    dpt_device_info now;
    const uint32_t size = draw_size(sizeof now, sizeof now);
    void *out = output_sized(0, size);
    if (!no_out)
        size_codes_of_output(size, sizeof now, 0, &codes);
    may_fail(&codes, !of || no_out, DPT_E_ARGUMENT);
    expect(RESULT(dpt_device_get_info, of ? of->open : NULL, no_out ? NULL : out), &codes);
    outputs_are_guarded(0, 1);
    if (codes.count) {
        HOLDS(output_is_untouched(0, sizeof size), "written on an error");
        return;
    }
    output_read(0, size, sizeof now, sizeof now, &now);
    numbers_are_finite(&now.rate, 21, "a device's info");
    HOLDS((now.pose_dofs == 3 || now.pose_dofs == 6) && now.joints <= DPT_JOINTS_MAX && now.wrench_dofs <= 6 &&
              now.buttons <= 32 && now.rate > 0.0 && memchr(now.name, 0, sizeof now.name) &&
              memchr(now.serial, 0, sizeof now.serial),
          "%u dofs", now.pose_dofs);
    now.size = sizeof now;
    map(of, &now);
}

static void read(void)
{
    struct device_model *of = draw_device();
    struct codes codes = { .count = 0 };
    const int no_out = draw_one_in(30);
    dpt_device_state now;
    const uint32_t size = draw_size(sizeof now, sizeof now);
    dpt_device_state *out = output_sized(0, size);
    if (!no_out)
        size_codes_of_output(size, sizeof now, 0, &codes);
    may_fail(&codes, !of || no_out, DPT_E_ARGUMENT);
    const int is_refused = codes.count > 0;
    codes.or_done = !is_refused;
    may_fail(&codes, !is_refused, DPT_E_LOST);
    const dpt_result result = RESULT(dpt_device_read, of ? of->open : NULL, no_out ? NULL : out);
    expect(result, &codes);
    outputs_are_guarded(0, 1);
    if (is_refused) {
        HOLDS(output_is_untouched(0, sizeof size), "written on an error");
        return;
    }
    output_read(0, size, sizeof now, offsetof(dpt_device_state, pose), &now);
    struct codes of_pose = { .count = 0 };
    pose_codes(&now.pose, &of_pose);
    HOLDS(!of_pose.count, "a pose that cannot be used");
    HOLDS(now.status <= DPT_DEVICE_STATUS_READY && now.reasons < 2 * DPT_REASON_DOCKED &&
              (now.status != DPT_DEVICE_STATUS_READY || !now.reasons),
          "status %u, reasons %x", now.status, now.reasons);
    HOLDS((result == DPT_E_LOST) == (now.status == DPT_DEVICE_STATUS_LOST) && (result == DPT_OK || !now.fresh),
          "%s, status %u, fresh %u", dpt_result_name(result), now.status, now.fresh);
    HOLDS(!of->has_state || now.sequence >= of->sequence || of->is_lost, "sample %llu after %llu",
          (unsigned long long)now.sequence, (unsigned long long)of->sequence);
    /* A line may double a sample. */
    const int is_doubled = now.sequence == of->sequence && now.time_ns == of->time_ns;
    HOLDS(!now.fresh || !of->has_state || of->is_lost || is_doubled || now.time_ns > of->time_ns,
          "a fresh sample of %llu ns after %llu", (unsigned long long)now.time_ns, (unsigned long long)of->time_ns);
    of->has_state = 1;
    of->is_lost = result == DPT_E_LOST;
    of->sequence = now.sequence;
    of->time_ns = now.time_ns;
}

static void write(void)
{
    struct device_model *of = draw_device();
    dpt_wrench wrench;
    double *numbers = (double *)(void *)&wrench;
    int is_finite = 1;
    struct codes codes = { .count = 0 };
    for (int k = 0; k < 6; k++)
        numbers[k] = draw_in(-10.0, 10.0);
    if (draw_one_in(8))
        numbers[draw_below(6)] = draw_odd_number();
    for (int k = 0; k < 6; k++)
        is_finite &= isfinite(numbers[k]) != 0;
    const int no_wrench = draw_one_in(30);
    may_fail(&codes, !of || no_wrench, DPT_E_ARGUMENT);
    may_fail(&codes, of && !no_wrench && !is_finite, DPT_E_FINITE);
    codes.or_done = !codes.count;
    may_fail(&codes, codes.or_done, DPT_E_LOST);
    may_fail(&codes, codes.or_done, DPT_E_NOT_READY);
    expect(RESULT(dpt_device_write, of ? of->open : NULL, no_wrench ? NULL : &wrench), &codes);
}

static void clear(void)
{
    struct device_model *of = draw_device();
    struct codes codes = { .count = 0 };
    may_fail(&codes, !of, DPT_E_ARGUMENT);
    expect(RESULT(dpt_device_clear, of ? of->open : NULL), &codes);
    if (of)
        of->has_state = 0;
}

static void steer(void)
{
    struct device_model *of = draw_device();
    double position[3];
    int is_good = 1;
    for (int k = 0; k < 3; k++) {
        position[k] = draw_one_in(20) ? draw_odd_number() : draw_in(-0.1, 0.1);
        is_good &= fabs(position[k]) <= DPT_COORDINATE_MAX;
    }
    const int no_position = draw_one_in(30);
    struct codes codes = { .count = 0 };
    may_fail(&codes, !of || no_position, DPT_E_ARGUMENT);
    may_fail(&codes, !codes.count && !is_good, DPT_E_FINITE);
    codes.or_done = !codes.count;
    may_fail(&codes, !codes.count, DPT_E_UNSUPPORTED);
    expect(RESULT(dpt_device_steer, of ? of->open : NULL, no_position ? NULL : position), &codes);
    if (of)
        of->has_state = 0;
}

static void counts(void)
{
    struct device_model *of = draw_device();
    struct codes codes = { .count = 0 };
    dpt_device_counts now;
    const uint32_t size = draw_size(sizeof now, sizeof now);
    void *out = output_sized(0, size);
    size_codes_of_output(size, sizeof now, 0, &codes);
    may_fail(&codes, !of, DPT_E_ARGUMENT);
    expect(RESULT(dpt_device_get_counts, of ? of->open : NULL, out), &codes);
    outputs_are_guarded(0, 1);
    if (codes.count) {
        HOLDS(output_is_untouched(0, sizeof size), "written on an error");
    } else {
        output_read(0, size, sizeof now, sizeof now, &now);
        HOLDS(now.refused <= now.commands && !now.reserved, "%llu refused", (unsigned long long)now.refused);
    }
    HOLDS(RESULT(dpt_device_get_counts, of ? of->open : NULL, NULL) == DPT_E_ARGUMENT, "nowhere");
}

static void names(void)
{
    const uint32_t any = draw_one_in(2) ? draw_below(16) : (uint32_t)draw_bits();
    const char *status = CALL(dpt_device_status_name, any);
    HOLDS(status && (any < 4) == (strcmp(status, "?") != 0), "status %u", any);
    const char *reason = CALL(dpt_device_reason_name, any);
    HOLDS((reason != NULL) == ((any & (2 * DPT_REASON_DOCKED - 1)) != 0), "reasons %x", any);
}

/* OpenHaptics' units, which need nothing of it. */
static void units(void)
{
    double from[16], to[16];
    int is_good = 1;
    for (int k = 0; k < 16; k++)
        from[k] = draw_in(-1.0, 1.0);
    if (draw_one_in(4))
        from[draw_below(3)] = draw_odd_number();
    for (int k = 0; k < 3; k++)
        is_good &= fabs(from[k]) <= DPT_COORDINATE_MAX;
    struct codes codes = { .count = 0 }, of_pose = { .count = 0 };
    const int is_null = draw_one_in(20);
    may_fail(&codes, is_null, DPT_E_ARGUMENT);
    may_fail(&codes, !is_good, DPT_E_FINITE);
    const double *given = is_null ? NULL : from;
    expect(RESULT(dpt_hd_to_millimetres, given, to), &codes);
    for (int k = 0; k < 3; k++)
        is_good |= fabs(from[k]) <= 1e3 * DPT_COORDINATE_MAX;
    codes.or_done = codes.count == 1 && !is_null;
    expect(RESULT(dpt_hd_to_metres, given, to), &codes);
    dpt_pose pose = draw_pose(NULL), back;
    pose_codes(&pose, &of_pose);
    may_fail(&of_pose, is_null, DPT_E_ARGUMENT);
    expect(RESULT(dpt_hd_to_transform, is_null ? NULL : &pose, to), &of_pose);
    if (!of_pose.count) {
        numbers_are_finite(to, 16, "a transform");
        HOLDS(RESULT(dpt_hd_to_pose, to, &back) == DPT_OK, "there and not back");
        numbers_are_finite(back.position, 7, "a pose");
    }
    const dpt_result any = RESULT(dpt_hd_to_pose, given, &back);
    HOLDS(any == DPT_OK || any == DPT_E_POSE || any == DPT_E_FINITE || (is_null && any == DPT_E_ARGUMENT), "%s",
          dpt_result_name(any));
    const uint32_t code = draw_one_in(2) ? draw_below(0x600) : (uint32_t)draw_bits();
    HOLDS(CALL(dpt_hd_is_force_error, code) == (code >= 0x200 && code <= 0x204), "%x", code);
    HOLDS(CALL(dpt_hd_is_scheduler_error, code) == ((code >= 0x302 && code <= 0x304) || code == 0x500 || code == 0x501),
          "%x", code);
}

static void begin(void)
{
    for (int i = 0; i < DEVICES; i++)
        open();
}

static void end(void)
{
    for (int i = 0; i < DEVICES; i++)
        CALL(dpt_device_close, devices[i].open);
    memset(devices, 0, sizeof devices);
}

static const struct move moves[] = { { "open", open, 2 },   { "open with", open_with, 1 }, { "drivers", drivers, 1 },
                                     { "info", info, 2 },   { "read", read, 14 },          { "write", write, 10 },
                                     { "clear", clear, 2 }, { "counts", counts, 2 },       { "names", names, 1 },
                                     { "units", units, 2 }, { "steer", steer, 2 },         { NULL, NULL, 0 } };

const struct noun device_noun = { "device", begin, end, moves };
