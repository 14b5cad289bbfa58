/* SPDX-License-Identifier: BSD-3-Clause */
/* Which drivers are built in (the Makefile's DRIVERS, by built_with.h), and what holds for devices of all of them. */
#include <string.h>

#include "base/wrench_limit.h"
#include "built_with.h"
#include "dynpoint/driver.h"
#include "settings.h"

/* All that have a name. */
static const uint32_t REASONS = 2u * DPT_REASON_DOCKED - 1u;

#define DRIVER(name) extern const dpt_driver name##_driver;
DPT_DRIVERS
#undef DRIVER

#define DRIVER(name) &name##_driver,
static const dpt_driver *const drivers[] = { DPT_DRIVERS NULL };
#undef DRIVER

const dpt_driver *dpt_driver_at(uint32_t index)
{
    return index < sizeof drivers / sizeof *drivers ? drivers[index] : NULL;
}

static const dpt_driver *named(const char *name, size_t length)
{
    for (const dpt_driver *const *driver = drivers; *driver; driver++)
        if (strlen((*driver)->name) == length && !memcmp((*driver)->name, name, length))
            return *driver;
    return NULL;
}

const dpt_driver *dpt_driver_named(const char *name)
{
    return name ? named(name, strlen(name)) : NULL;
}

static int is_complete(const dpt_driver *driver)
{
    return driver->size == sizeof *driver && driver->version == DPT_DRIVER_VERSION &&
           driver->name && driver->open && driver->info && driver->read && driver->write &&
           driver->clear && driver->counts && driver->close;
}

dpt_result dpt_device_open_with(const dpt_driver *driver, const char *where, dpt_device **device,
                                dpt_device_error *error)
{
    if (error && error->size != sizeof *error)
        return DPT_E_SIZE;
    if (!device)
        return device_error(error, DPT_E_ARGUMENT, "there is no place for the device");
    *device = NULL;
    if (!driver)
        return device_error(error, DPT_E_ARGUMENT, "there is no driver");
    if (!is_complete(driver))
        return device_error(error, DPT_E_UNSUPPORTED,
                            "the driver is of another version, or lacks a function");
    if (where && !*where)
        where = NULL;
    dpt_device *opened = NULL;
    device_error(error, DPT_OK, "%s", "");
    dpt_result result = driver->open(driver, where, &opened, error);
    if (result == DPT_OK && !opened)
        return device_error(error, DPT_E_DEVICE, "the driver gave no device");
    if (result != DPT_OK) {
        if (error && !error->text[0])
            device_error(error, result, "%s", dpt_result_text(result));
        return result;
    }
    opened->driver = driver;
    *device = opened;
    return DPT_OK;
}

dpt_result dpt_device_open(const char *name, dpt_device **device, dpt_device_error *error)
{
    if (error && error->size != sizeof *error)
        return DPT_E_SIZE;
    if (device)
        *device = NULL;
    if (!name)
        return device_error(error, DPT_E_ARGUMENT, "there is no name");
    size_t length = strcspn(name, ":");
    const dpt_driver *driver = named(name, length);
    if (!driver)
        return device_error(error, DPT_E_UNSUPPORTED, "this build has no driver '%.*s'",
                            (int)(length < 60 ? length : 60), name);
    return dpt_device_open_with(driver, name[length] ? name + length + 1 : NULL, device, error);
}

dpt_result dpt_device_get_info(const dpt_device *device, dpt_device_info *info)
{
    if (!device || !info)
        return DPT_E_ARGUMENT;
    if (info->size != sizeof *info)
        return DPT_E_SIZE;
    memset(info, 0, sizeof *info);
    info->size = sizeof *info;
    device->driver->info(device, info);
    info->size = sizeof *info;
    return DPT_OK;
}

dpt_result dpt_device_read(dpt_device *device, dpt_device_state *state)
{
    if (!device || !state)
        return DPT_E_ARGUMENT;
    if (state->size != sizeof *state)
        return DPT_E_SIZE;
    dpt_result result = device->driver->read(device, state);
    state->size = sizeof *state;
    if (state->reasons & ~REASONS)
        state->reasons = (state->reasons & REASONS) | DPT_REASON_DEVICE;
    if (result != DPT_OK)
        state->fresh = 0;
    if (result == DPT_E_LOST)
        state->status = DPT_DEVICE_STATUS_LOST;
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

dpt_result dpt_device_get_counts(const dpt_device *device, dpt_device_counts *counts)
{
    if (!device || !counts)
        return DPT_E_ARGUMENT;
    if (counts->size != sizeof *counts)
        return DPT_E_SIZE;
    memset(counts, 0, sizeof *counts);
    counts->size = sizeof *counts;
    device->driver->counts(device, counts);
    counts->size = sizeof *counts;
    return DPT_OK;
}

void dpt_device_close(dpt_device *device)
{
    if (device)
        device->driver->close(device);
}

dpt_result dpt_device_map(const dpt_device_info *info, const double box_min[3],
                          const double box_max[3], double *scale, double offset[3])
{
    if (!info || !box_min || !box_max || !scale || !offset)
        return DPT_E_ARGUMENT;
    if (info->size != sizeof *info)
        return DPT_E_SIZE;
    const double *from = info->workspace_min, *to = info->workspace_max;
    double most = 0.0, middle[3];
    if (!vec3_within(box_min, DPT_COORDINATE_MAX) || !vec3_within(box_max, DPT_COORDINATE_MAX) ||
        !vec3_within(from, DPT_COORDINATE_MAX) || !vec3_within(to, DPT_COORDINATE_MAX))
        return DPT_E_FINITE;
    for (int k = 0; k < 3; k++) {
        if (box_min[k] > box_max[k])
            return DPT_E_ARGUMENT;
        if (!(to[k] - from[k] > 1e-6))
            return DPT_E_FINITE;
        most = larger(most, (box_max[k] - box_min[k]) / (to[k] - from[k]));
        middle[k] = 0.5 * (from[k] + to[k]);
    }
    *scale = most > 0.0 ? most : 1.0;
    for (int k = 0; k < 3; k++)
        offset[k] = 0.5 * (box_min[k] + box_max[k]) - *scale * middle[k];
    return DPT_OK;
}

const char *dpt_device_status_name(uint32_t status)
{
    static const char *const names[] = { "lost", "fault", "unready", "ready" };
    return status < sizeof names / sizeof *names ? names[status] : "?";
}

const char *dpt_device_reason_name(uint32_t reasons)
{
    static const char *const names[] = { "unplugged",  "silent",       "watchdog", "overheated",
                                         "overloaded", "uncalibrated", "estop",    "link",
                                         "version",    "device",       "docked" };
    for (uint32_t bit = 0; bit < sizeof names / sizeof *names; bit++)
        if (reasons >> bit & 1)
            return names[bit];
    return NULL;
}
