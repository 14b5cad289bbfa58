/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Read a driver's `where`: an address, then '?' and settings with '&' between them, as in "file.csv?rate=1000&live=1".
 */
#ifndef DPT_DRIVERS_SETTINGS_H
#define DPT_DRIVERS_SETTINGS_H

#include "dynpoint/device.h"

/* A setting that a driver knows, and where its value goes: exactly one of `number` and `text` is not NULL. */
struct setting {
    const char *name;
    double *number;    /* min <= *number <= max */
    char *text;        /* room for text_bytes, the final zero included */
    double min, max;   /* for a number */
    size_t text_bytes; /* for a text */
};

/*
 * Device dynamics: the fields of dpt_device_info that a coupling is computed from and that a maker may not publish. 0
 * if the user has not set them. Each is a setting of the field's name.
 */
struct dynamics {
    double mass, inertia, damping, spin_damping, friction, spin_friction, delay;
    double position_step, angle_step;
};

enum { DYNAMICS_SETTINGS = 9 };

/* The settings of the fields of `dynamics`, in the order of the fields' names in docs/drivers.md. */
void dynamics_settings(struct dynamics *dynamics, struct setting settings[DYNAMICS_SETTINGS]);

/* Replace the fields of `info` that the user has set. */
void dynamics_override(const struct dynamics *dynamics, dpt_device_info *info);

/*
 * Read `where`, which may be NULL. Settings that it does not name keep their value.
 *   address    room for `address_bytes`; gets what stands before the '?', or ""
 *   dynamics   zero before the call; NULL if the driver has such settings of its own
 *
 * "settings=FILE" stands for all lines "name=value" of a file, which has none of these itself. Later settings override
 * earlier ones.
 *
 * DPT_E_SETTING: a setting is unknown, not a number, out of range or too long; `error` says which. Errors of the file
 * are those of settings.h.
 */
dpt_result settings_read(const char *where, char *address, size_t address_bytes, const struct setting *settings,
                         size_t count, struct dynamics *dynamics, dpt_device_error *error);

/* Write code and text into `error`, unless it is NULL, and return `code`. */
dpt_result device_error(dpt_device_error *error, dpt_result code, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 3, 4)))
#endif
    ;

/* Behind an error's text, unless it is NULL: the word that was probably meant, unless that is NULL. Returns `code`. */
dpt_result device_error_meant(dpt_device_error *error, dpt_result code, const char *word);

/*
 * A line "name=value" of a file of device dynamics or of settings. Blank lines and lines that begin with '#' are
 * skipped.
 */
struct settings_line {
    const char *path;
    int number; /* from 1 */
    const char *text, *end;
    const char *equals; /* where the name ends; NULL: there is no '=' */
};

/* Takes one line; what it returns ends the reading unless it is DPT_OK. */
typedef dpt_result settings_line_fn(void *user, const struct settings_line *line, dpt_device_error *error);

/*
 * Read a file, line by line.
 *
 * DPT_E_OPEN: it cannot be opened or read. DPT_E_LIMIT: it has more than 64 KiB. DPT_E_SYNTAX: a line has more than 510
 * characters.
 */
dpt_result settings_file_read(const char *path, settings_line_fn *take, void *user, dpt_device_error *error);

#endif
