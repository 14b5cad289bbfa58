/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A host of the driver for OpenHaptics, with a stand-in for the vendor's library. Calls of the driver to the loader, the
 * clock, the environment and the file system go through here (tests.mk); the stand-in's own do not.
 */
#ifndef DPT_TESTS_HD_HOST_H
#define DPT_TESTS_HD_HOST_H

#include <dlfcn.h>
#include <math.h>
#include <stdarg.h>
#include <time.h>
#include <unistd.h>

#include "drivers/hd/function_table.h"
#include "drivers/hd/stand_in.h"
#include "dynpoint/loop.h"
#include "lib/check.h"

/* What the driver asked the system for, and what it is told. */
static struct {
    /* The loader: of every name the reason why it is not there, or the real loader's answer. */
    const char *(*refuse)(const char *name);
    const char *reason;
    char tried[1024]; /* names, with a blank behind each */
    int flags, closes;
    const char *lacks; /* the function that a library has not */

    int fails_calloc;
    const char *library, *gtdd_home; /* of the environment */
    const char *forbidden;           /* a port */

    /* The clock: the real one with `skew`, or `now` while it is held. */
    int clock_is_held, clock_fails;
    uint64_t now;
    int64_t skew;
} host;

#define WRAP(result, name, ...)                                                                                        \
    result __real_##name(__VA_ARGS__);                                                                                 \
    result __wrap_##name(__VA_ARGS__);                                                                                 \
    result __wrap_##name(__VA_ARGS__)

WRAP(void *, dlopen, const char *name, int flags)
{
    const size_t used = strlen(host.tried);
    snprintf(host.tried + used, sizeof host.tried - used, "%s ", name);
    host.flags = flags;
    host.reason = host.refuse ? host.refuse(name) : NULL;
    return host.reason ? NULL : __real_dlopen(name, flags);
}

char *__real_dlerror(void);
char *__wrap_dlerror(void);
char *__wrap_dlerror(void)
{
    static char text[512];
    if (!host.reason)
        return __real_dlerror();
    snprintf(text, sizeof text, "%s", host.reason);
    return text;
}

WRAP(void *, dlsym, void *handle, const char *name)
{
    return host.lacks && !strcmp(host.lacks, name) ? NULL : __real_dlsym(handle, name);
}

WRAP(void *, calloc, size_t count, size_t size)
{
    return host.fails_calloc ? NULL : __real_calloc(count, size);
}

WRAP(char *, getenv, const char *name)
{
    const char *value = !strcmp(name, "DPT_HD_LIBRARY") ? host.library
                        : !strcmp(name, "GTDD_HOME")    ? host.gtdd_home
                                                        : __real_getenv(name);
    return (char *)(uintptr_t)value;
}

/* The system's file about the port that is forbidden, and no other port. */
WRAP(FILE *, fopen, const char *path, const char *mode)
{
    static char hidraw[] = "HID_ID=0003:00002988:00000304\nHID_NAME=Touch\n";
    static char serial[] = "DEVTYPE=usb_interface\nPRODUCT=2988/302/100\n";
    const char *port = host.forbidden ? host.forbidden + strlen("/dev/") : NULL;
    if (strncmp(path, "/sys/class/", 11) != 0)
        return __real_fopen(path, mode);
    if (!port || !strstr(path, port) || strchr(strstr(path, port), '/')[-1] != port[strlen(port) - 1])
        return NULL;
    char *text = strstr(port, "hidraw") ? hidraw : serial;
    return fmemopen(text, strlen(text), mode);
}

WRAP(int, access, const char *path, int mode)
{
    (void)mode;
    return host.forbidden && !strcmp(path, host.forbidden) ? -1 : 0;
}

static uint64_t real_now(void);

WRAP(int, clock_gettime, clockid_t clock, struct timespec *time)
{
    if (host.clock_fails)
        return -1;
    if (clock != CLOCK_MONOTONIC)
        return __real_clock_gettime(clock, time);
    const uint64_t now = host.clock_is_held ? host.now : real_now() + (uint64_t)host.skew;
    time->tv_sec = (time_t)(now / 1000000000u);
    time->tv_nsec = (long)(now % 1000000000u);
    return 0;
}

static uint64_t real_now(void)
{
    struct timespec time;
    __real_clock_gettime(CLOCK_MONOTONIC, &time);
    return (uint64_t)time.tv_sec * 1000000000u + (uint64_t)time.tv_nsec;
}

static char library_path[256]; /* of the stand-in that is used */
static struct stand_in *lib;   /* what is in it */
static struct stand_in_device *there, *left;

/* Libraries lie beside the test. */
static inline const char *beside(const char *program, const char *file)
{
    static char path[256];
    const char *end = strrchr(program, '/');
    snprintf(path, sizeof path, "%.*s/%s", end ? (int)(end - program) : 1, end ? program : ".", file);
    return path;
}

static void take_stand_in(const char *program, const char *file)
{
    snprintf(library_path, sizeof library_path, "%s", beside(program, file));
    void *handle = __real_dlopen(library_path, RTLD_NOW | RTLD_GLOBAL);
    CHECK(handle != NULL, "%s", __real_dlerror());
    lib = handle ? __real_dlsym(handle, "stand_in") : NULL;
    if (!lib)
        exit(1);
    there = &lib->device[0];
    left = &lib->device[1];
}

/* Time goes by ticks, in this thread; or by itself. */
static void hold(void)
{
    if (host.clock_is_held)
        return;
    lib->hold();
    host.now = real_now() + (uint64_t)host.skew;
    host.clock_is_held = 1;
    lib->tick(); /* on a busy machine the last one may be long ago */
}

static void go(void)
{
    if (!host.clock_is_held)
        return;
    host.skew = (int64_t)(host.now - real_now());
    host.clock_is_held = 0;
    lib->go();
}

static void pass(double seconds)
{
    host.now += (uint64_t)(seconds * 1e9 + 0.5);
}

static inline void tick(int count)
{
    for (int i = 0; i < count; i++) {
        pass(1.0 / lib->rate);
        lib->tick();
    }
}

static dpt_device *device;
static dpt_device_error error = { .size = sizeof error };
static dpt_device_state state = { .size = sizeof state };

static const char *patience = "&silent=2"; /* "" where the default is meant */

/* `name` and settings, as in "Left Device" and "&watchdog=1". Time is held afterwards. */
static inline dpt_result open_at(dpt_device **opened, const char *name, const char *settings)
{
    char where[512];
    snprintf(where, sizeof where, "openhaptics:%s?library=%s%s%s", name, library_path, patience, settings);
    go();
    const dpt_result result = dpt_device_open(where, opened, &error);
    hold();
    CHECK(strlen(error.text) < sizeof error.text - 1, "cut off: %s", error.text);
    return result;
}

/* All as new, and the default device open, still, with its first samples read. */
static inline void start(const char *settings)
{
    const dpt_result result = open_at(&device, "", settings);
    CHECK(result == DPT_OK, "%s", error.text);
    if (result != DPT_OK)
        exit(1);
    tick(3);
    CHECK(dpt_device_read(device, &state) == DPT_OK, "read");
}

static void renew(void)
{
    go();
    host.skew = 0;
    lib->reset();
    there->moves = left->moves = 0;
}

static inline dpt_result clear_device(dpt_device *which)
{
    go();
    const dpt_result result = dpt_device_clear(which);
    hold();
    return result;
}

static inline void close_one(dpt_device *which)
{
    go();
    dpt_device_close(which);
    hold();
}

static inline double force_of(const struct stand_in_device *which)
{
    return which->force[1];
}

/* Closed, without a force and without a rule broken. */
static inline void finish(void)
{
    close_one(device);
    device = NULL;
    CHECK(!there->is_open && there->force[1] == 0.0, "it is not closed");
    CHECK(lib->violations == 0, "%u rules broken: %s", lib->violations, lib->violation);
    renew();
}

static inline dpt_result push(dpt_device *which, double y)
{
    const dpt_wrench wrench = { { 0.0, y, 0.0 }, { 0.0, 0.0, 0.0 } };
    return dpt_device_write(which, &wrench);
}

/* So many ticks under a force: read, write, tick. */
static inline void serve(int count, double y)
{
    for (int i = 0; i < count; i++) {
        CHECK(dpt_device_read(device, &state) == DPT_OK, "read, tick %d", i);
        CHECK(push(device, y) == DPT_OK, "write, tick %d", i);
        tick(1);
    }
    CHECK(dpt_device_read(device, &state) == DPT_OK, "read");
}

#endif
