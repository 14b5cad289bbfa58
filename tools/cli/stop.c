/* SPDX-License-Identifier: BSD-3-Clause */
#define _XOPEN_SOURCE 700
#include "cli/stop.h"

#include <signal.h>
#include <sys/time.h>
#include <time.h>

#include "clock.h"

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
