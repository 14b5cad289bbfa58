/* SPDX-License-Identifier: BSD-3-Clause */
#define _XOPEN_SOURCE 700
#include "cli/open_device.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/time.h>
#include <time.h>

#include "cli/command_options.h"
#include "clock.h"
#include "host/host_session.h"
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

static void on_signal(int number)
{
    (void)number;
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
    struct sigaction action = { .sa_handler = on_signal }, before;
    running = loop;
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGPIPE, &action, NULL);
    /* nohup ignores SIGHUP: leave it so. */
    if (sigaction(SIGHUP, NULL, &before) == 0 && before.sa_handler != SIG_IGN)
        sigaction(SIGHUP, &action, NULL);
    if (seconds < 1e9) {
        struct itimerval timer = { .it_value = { (time_t)seconds,
                                                 (suseconds_t)(1e6 * (seconds - (double)(time_t)seconds)) } };
        /* A timer of 0 would be none. */
        if (seconds < 1e-6)
            timer.it_value.tv_usec = 1;
        sigaction(SIGALRM, &action, NULL);
        setitimer(ITIMER_REAL, &timer, NULL);
    }
}

double seconds_now(void)
{
    return 1e-9 * (double)clock_now();
}

void sleep_seconds(double seconds)
{
    struct timespec time = { (time_t)seconds, (long)(1e9 * (seconds - (double)(time_t)seconds)) };
    nanosleep(&time, NULL);
}
