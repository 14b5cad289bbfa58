/* SPDX-License-Identifier: BSD-3-Clause */
/* Files of lines "name=value": of device dynamics, and of settings. Blank lines and lines that begin with '#' are skipped. */
#ifndef DPT_DRIVERS_SETTINGS_FILE_H
#define DPT_DRIVERS_SETTINGS_FILE_H

#include "dynpoint/device.h"

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
