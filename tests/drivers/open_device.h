/* SPDX-License-Identifier: BSD-3-Clause */
/* Devices for tests: opened by name or not at all, and small files to open them with. */
#ifndef DPT_TESTS_DEVICE_H
#define DPT_TESTS_DEVICE_H

#include <stdarg.h>
#include <unistd.h>

#include "dynpoint/loop.h"
#include "lib/check.h"

static inline dpt_device *device_named(const char *format, ...)
{
    char name[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(name, sizeof name, format, arguments);
    va_end(arguments);
    dpt_device *device = NULL;
    dpt_device_error error = { .size = sizeof error };
    dpt_result result = dpt_device_open(name, &device, &error);
    CHECK(result == DPT_OK && device, "%s: %s: %s", name, dpt_result_name(result), error.text);
    if (result == DPT_OK)
        return device;
    check_failed++;
    exit(check_report());
}

static inline dpt_device_state state_of(dpt_device *device)
{
    dpt_device_state state = { .size = sizeof state };
    dpt_result result = dpt_device_read(device, &state);
    CHECK(result == DPT_OK, "read: %s", dpt_result_name(result));
    return state;
}

static inline dpt_device_counts counts_of(const dpt_device *device)
{
    dpt_device_counts counts = { .size = sizeof counts };
    CHECK(dpt_device_get_counts(device, &counts) == DPT_OK, "no counts");
    return counts;
}

static inline void write_force(dpt_device *device, double x, double y, double z)
{
    dpt_wrench wrench = { { x, y, z }, { 0.0, 0.0, 0.0 } };
    dpt_result result = dpt_device_write(device, &wrench);
    CHECK(result == DPT_OK, "write: %s", dpt_result_name(result));
}

/* A file with this text, at the returned path, until unlink(). */
struct small_file {
    char path[64];
};

static inline struct small_file file_with(const char *text)
{
    struct small_file file = { "/tmp/dynpoint-test-XXXXXX" };
    int handle = mkstemp(file.path);
    CHECK(handle >= 0 && write(handle, text, strlen(text)) == (ssize_t)strlen(text), "%s", file.path);
    close(handle);
    return file;
}

#endif
