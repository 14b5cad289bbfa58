/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/open_device.h"

#include <stdio.h>
#include <string.h>

#include "cli/command_options.h"
#include "host/host_session.h"
#include "platform/clock.h"
#include "platform/program.h"
#include "scene/host_file.h"

int open_device(const char *command, const char *name, dpt_device **device)
{
    dpt_device_error error = { .size = sizeof error };
    dpt_result result = dpt_device_open(name, device, &error);
    if (result != DPT_OK)
        return complain(command, "%s: %s", name, error.text[0] ? error.text : dpt_result_text(result));
    if (error.text[0])
        complain(command, "%s: %s", name, error.text);
    return 0;
}

int end_fault(const char *command, const char *name, dpt_device *device)
{
    dpt_host_error error = { .size = sizeof error };
    const dpt_result result = host_device_end_fault(device, name, &error);
    if (error.text[0])
        complain(command, "%s", error.text);
    return result == DPT_OK ? 0 : 2;
}

int device_output_check(const char *command, const char *path, const char *name)
{
    return host_file_is_of_device(path, name)
               ? complain(command, "%s: it is an input too, and would be overwritten", path)
               : 0;
}

static volatile int is_requested;
static dpt_loop *volatile running;

static void stop(void)
{
    is_requested = 1;
    if (running)
        dpt_loop_stop(running);
}

int stop_requested(void)
{
    return is_requested;
}

const volatile int *stop_flag(void)
{
    return &is_requested;
}

void stop_watch(dpt_loop *loop, double seconds)
{
    running = loop;
    program_watch(stop, seconds);
}

double seconds_now(void)
{
    return 1e-9 * (double)clock_now();
}

void sleep_seconds(double seconds)
{
    clock_sleep((uint64_t)(1e9 * seconds));
}
