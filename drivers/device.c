/* SPDX-License-Identifier: BSD-3-Clause */
/* The built-in drivers (the Makefile's DRIVERS, listed in built_with.h), and the calls that work for devices of all. */
#include <string.h>

#include "base/return_if_error.h"
#include "base/sized.h"
#include "base/wrench_limit.h"
#include "built_with.h"
#include "dynpoint/driver.h"
#include "settings.h"
#include "text/near_word.h"

/* All reason bits that have a name. */
static const uint32_t KNOWN_REASONS = 2u * DPT_REASON_DOCKED - 1u;

#define DRIVER(name) extern const dpt_driver name##_driver;
DPT_DRIVERS
#undef DRIVER

#define DRIVER(name) &name##_driver,
static const dpt_driver *const drivers[] = { DPT_DRIVERS NULL };
#undef DRIVER

const dpt_driver *dpt_driver_get(uint32_t index)
{
    return index < sizeof drivers / sizeof *drivers ? drivers[index] : NULL;
}

static const dpt_driver *find_driver(const char *name, size_t length)
{
    for (const dpt_driver *const *driver = drivers; *driver; driver++)
        if (strlen((*driver)->name) == length && !memcmp((*driver)->name, name, length))
            return *driver;
    return NULL;
}

const dpt_driver *dpt_driver_find(const char *name)
{
    return name ? find_driver(name, strlen(name)) : NULL;
}

/* Whether it is a driver of ours that this build leaves out. */
static int is_left_out(const char *name, size_t length)
{
    static const char *const back_ends[] = { DPT_BACK_ENDS };
    for (size_t i = 0; i < sizeof back_ends / sizeof *back_ends; i++)
        if (strlen(back_ends[i]) == length && !memcmp(back_ends[i], name, length))
            return 1;
    return 0;
}

/* A driver of this version has at least the first release's fields; of these only `find` may be NULL. */
static int is_complete(const dpt_driver *driver)
{
    return driver->size >= SIZED_FIRST(dpt_driver, steer) && driver->size <= SIZED_MAX &&
           driver->version == DPT_DRIVER_VERSION && driver->name && driver->open && driver->info && driver->read &&
           driver->write && driver->clear && driver->counts && driver->close;
}

/* Room for the struct that a driver fills in: a newer driver's is longer than ours. */
enum { DRIVER_STRUCT_MAX = 1024 };

#define WITH_ROOM(type)                                                                                                \
    union {                                                                                                            \
        type own;                                                                                                      \
        unsigned char room[DRIVER_STRUCT_MAX];                                                                         \
    }

/* Complete `own` and copy it to the caller's `error`, whose size was checked. Returns `result`. */
static dpt_result finish_open(dpt_result result, dpt_device_error *own, dpt_device_error *error)
{
    own->code = result;
    own->text[sizeof own->text - 1] = '\0';
    if (result != DPT_OK && !own->text[0])
        device_error(own, result, "%s", dpt_result_text(result));
    if (error)
        sized_write(error, error->size, own, sizeof *own);
    return result;
}

static dpt_result open_with(const dpt_driver *driver, const char *where, dpt_device **device, dpt_device_error *error)
{
    if (!device)
        return device_error(error, DPT_E_ARGUMENT, "there is no place for the device");
    if (!driver)
        return device_error(error, DPT_E_ARGUMENT, "there is no driver");
    if (!is_complete(driver))
        return device_error(error, DPT_E_UNSUPPORTED, "the driver is of another version, or lacks a function");
    if (where && !*where)
        where = NULL;
    dpt_device *opened = NULL;
    DPT_TRY(driver->open(driver, where, &opened, error));
    if (!opened)
        return device_error(error, DPT_E_DEVICE, "the driver gave no device");
    *opened = (dpt_device){ .driver = driver };
    *device = opened;
    return DPT_OK;
}

dpt_result dpt_device_open_with(const dpt_driver *driver, const char *where, dpt_device **device,
                                dpt_device_error *error)
{
    WITH_ROOM(dpt_device_error) out = { .own = { .size = sizeof out.own } };
    if (device)
        *device = NULL;
    if (error)
        DPT_TRY(sized_check(error, sizeof *error, 0));
    return finish_open(open_with(driver, where, device, &out.own), &out.own, error);
}

dpt_result dpt_device_open(const char *name, dpt_device **device, dpt_device_error *error)
{
    dpt_device_error own = { .size = sizeof own };
    if (device)
        *device = NULL;
    if (error)
        DPT_TRY(sized_check(error, sizeof *error, 0));
    if (!name)
        return finish_open(device_error(&own, DPT_E_ARGUMENT, "there is no name"), &own, error);
    size_t length = strcspn(name, ":");
    const dpt_driver *driver = find_driver(name, length);
    if (driver)
        return dpt_device_open_with(driver, name[length] ? name + length + 1 : NULL, device, error);
    if (is_left_out(name, length))
        return finish_open(
            device_error(&own, DPT_E_ABSENT, "this build was made without the driver '%.*s'", (int)length, name), &own,
            error);
    const size_t bare = strcspn(name, "?");
    if (bare < length && find_driver(name, bare))
        return finish_open(device_error(&own, DPT_E_UNSUPPORTED,
                                        "there is no driver '%.*s': settings follow a colon, as in %.*s:%.60s",
                                        (int)(length < 60 ? length : 60), name, (int)bare, name, name + bare),
                           &own, error);
    struct near_word near = near_word_begin(name, length);
    for (const dpt_driver *const *known = drivers; *known; known++)
        near_word_try(&near, (*known)->name);
    device_error(&own, DPT_E_UNSUPPORTED, "there is no driver '%.*s'", (int)(length < 60 ? length : 60), name);
    return finish_open(device_error_meant(&own, DPT_E_UNSUPPORTED, near.word), &own, error);
}

dpt_result dpt_device_get_info(const dpt_device *device, dpt_device_info *info)
{
    WITH_ROOM(dpt_device_info) out = { .own = { .size = sizeof out.own } };
    if (!device || !info)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(info, sizeof *info, 0));
    device->driver->info(device, &out.own);
    sized_write(info, info->size, &out.own, sizeof out.own);
    return DPT_OK;
}

dpt_result dpt_device_read(dpt_device *device, dpt_device_state *state)
{
    WITH_ROOM(dpt_device_state) out;
    if (!device || !state)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(state, sizeof *state, 0));
    memset(&out.own, 0, sizeof out.own);
    memcpy(&out.own, state, state->size < sizeof out.own ? state->size : sizeof out.own);
    out.own.size = sizeof out.own;
    memset(out.own.reserved, 0, sizeof out.own.reserved);
    dpt_result result = device->driver->read(device, &out.own);
    if (out.own.reasons & ~KNOWN_REASONS)
        out.own.reasons = (out.own.reasons & KNOWN_REASONS) | DPT_REASON_DEVICE;
    if (result != DPT_OK)
        out.own.fresh = 0;
    if (result == DPT_E_LOST)
        out.own.status = DPT_DEVICE_STATUS_LOST;
    sized_write(state, state->size, &out.own, sizeof out.own);
    return result;
}

dpt_result dpt_device_write(dpt_device *device, const dpt_wrench *wrench)
{
    static const dpt_wrench zero;
    if (!device || !wrench)
        return DPT_E_ARGUMENT;
    if (!wrench_is_finite(wrench)) {
        device->driver->write(device, &zero);
        return DPT_E_FINITE;
    }
    return device->driver->write(device, wrench);
}

dpt_result dpt_device_clear(dpt_device *device)
{
    return device ? device->driver->clear(device) : DPT_E_ARGUMENT;
}

static int can_be_steered(const dpt_driver *driver)
{
    return driver->size >= offsetof(dpt_driver, reserved_pointer) && driver->steer;
}

dpt_result dpt_device_steer(dpt_device *device, const double position[3])
{
    if (!device || !position)
        return DPT_E_ARGUMENT;
    if (!vec3_within(position, DPT_COORDINATE_MAX))
        return DPT_E_FINITE;
    return can_be_steered(device->driver) ? device->driver->steer(device, position) : DPT_E_UNSUPPORTED;
}

dpt_result dpt_device_get_counts(const dpt_device *device, dpt_device_counts *counts)
{
    WITH_ROOM(dpt_device_counts) out = { .own = { .size = sizeof out.own } };
    if (!device || !counts)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(counts, sizeof *counts, 0));
    device->driver->counts(device, &out.own);
    sized_write(counts, counts->size, &out.own, sizeof out.own);
    return DPT_OK;
}

void dpt_device_close(dpt_device *device)
{
    if (device)
        device->driver->close(device);
}

dpt_result dpt_device_map(const dpt_device_info *given, const double box_min[3], const double box_max[3], double *scale,
                          double offset[3])
{
    dpt_device_info info = { .size = sizeof info };
    if (!given || !box_min || !box_max || !scale || !offset)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_read(given, sizeof info, &info, sizeof info));
    const double *workspace_min = info.workspace_min, *workspace_max = info.workspace_max;
    double max_ratio = 0.0, workspace_middle[3];
    if (!vec3_within(box_min, DPT_COORDINATE_MAX) || !vec3_within(box_max, DPT_COORDINATE_MAX) ||
        !vec3_within(workspace_min, DPT_COORDINATE_MAX) || !vec3_within(workspace_max, DPT_COORDINATE_MAX))
        return DPT_E_FINITE;
    for (int k = 0; k < 3; k++) {
        if (box_min[k] > box_max[k])
            return DPT_E_ARGUMENT;
        if (!(workspace_max[k] - workspace_min[k] > 1e-6))
            return DPT_E_FINITE;
        max_ratio = max_of(max_ratio, (box_max[k] - box_min[k]) / (workspace_max[k] - workspace_min[k]));
        workspace_middle[k] = 0.5 * (workspace_min[k] + workspace_max[k]);
    }
    *scale = max_ratio > 0.0 ? max_ratio : 1.0;
    for (int k = 0; k < 3; k++)
        offset[k] = 0.5 * (box_min[k] + box_max[k]) - *scale * workspace_middle[k];
    return DPT_OK;
}

dpt_result dpt_device_fill_coupling(const dpt_device_info *given, dpt_coupling_def *out)
{
    dpt_device_info info = { .size = sizeof info };
    dpt_coupling_def def;
    if (!given || !out)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(out, sizeof *out, 0));
    DPT_TRY(sized_read(given, sizeof info, &info, sizeof info));
    DPT_TRY(sized_read(out, sizeof def, &def, sizeof def));
    def.has_torque = info.wrench_dofs == 6;
    def.mass = info.mass;
    def.inertia = info.inertia;
    def.damping = info.damping;
    def.spin_damping = info.spin_damping;
    def.friction = info.friction;
    def.spin_friction = info.spin_friction;
    def.position_step = info.position_step;
    def.angle_step = info.angle_step;
    def.delay = info.delay;
    def.force_max = info.force_max;
    def.torque_max = info.torque_max;
    def.stiffness_max = info.stiffness_max;
    def.rate = info.rate;
    sized_write(out, out->size, &def, sizeof def);
    return DPT_OK;
}

const char *dpt_device_status_name(uint32_t status)
{
    static const char *const names[] = { "lost", "fault", "unready", "ready" };
    return status < sizeof names / sizeof *names ? names[status] : "?";
}

const char *dpt_device_reason_name(uint32_t reasons)
{
    static const char *const names[] = { "unplugged", "silent", "watchdog", "overheated", "overloaded", "uncalibrated",
                                         "estop",     "link",   "version",  "device",     "docked" };
    for (uint32_t bit = 0; bit < sizeof names / sizeof *names; bit++)
        if (reasons >> bit & 1)
            return names[bit];
    return NULL;
}
