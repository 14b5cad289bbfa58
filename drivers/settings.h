/* SPDX-License-Identifier: BSD-3-Clause */
/* What drivers take from `where`: a place, and settings behind a '?' with '&' between, as in "file.csv?rate=1000". */
#ifndef DPT_DRIVERS_SETTINGS_H
#define DPT_DRIVERS_SETTINGS_H

#include "dynpoint/device.h"

/* One setting that is known. Exactly one of the pointers is set; what is not named stays as it is. */
struct setting {
    const char *name;
    double *number; /* least <= number <= most */
    char *text;     /* with its zero, at most `room` bytes */
    double min, max;
    size_t text_bytes;
};

/*
 * What a coupling is computed from and a maker may not tell: fields of dpt_device_info, 0 where nobody has named them.
 * Each is a setting of its own name.
 */
struct dynamics {
    double mass, inertia, damping, spin_damping, friction, spin_friction, delay;
    double position_step, angle_step;
};

/* What was named, in place of what the device told. */
void dynamics_override(const struct dynamics *dynamics, dpt_device_info *info);

/*
 * DPT_E_SETTING, and the reason in `error`, for what is unknown, no number or out of range. `place`, of `room` bytes,
 * is what stands before the '?', "" for a `where` that is NULL. `dynamics`, zero before, is NULL where a driver has
 * such settings of its own.
 */
dpt_result settings_read(const char *where, char *address, size_t address_bytes,
                         const struct setting *settings, size_t count, struct dynamics *dynamics,
                         dpt_device_error *error);

/* Write `error`, unless it is NULL, and return `code`. */
dpt_result device_error(dpt_device_error *error, dpt_result code, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 3, 4)))
#endif
    ;

#endif
