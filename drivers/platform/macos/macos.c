/* SPDX-License-Identifier: BSD-3-Clause */
/* What macOS has of its own. */
#define _DARWIN_C_SOURCE
#include <errno.h>
#include <mach/mach_time.h>
#include <mach/thread_act.h>
#include <mach/thread_policy.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>
#include <sys/sysctl.h>
#include <time.h>

#include "base/return_if_error.h"
#include "dynpoint/loop.h"
#include "platform/clock.h"
#include "platform/library.h"
#include "platform/machine.h"
#include "platform/opener.h"
#include "platform/serial_latency.h"
#include "platform/urgent.h"

const char *const library_names_of_hd[] = { "libHD.dylib", NULL };
const char library_names_text_of_hd[] = "libHD.dylib";

const char opener_name[] = "open", opener_is_missing[] = "open cannot be started";

/* ---- clocks ---- */

/* CLOCK_MONOTONIC goes on while the machine sleeps, so the guard sees the silence. */
dpt_result clock_read_suspended(uint64_t *now, int64_t *suspended)
{
    *suspended = 0;
    return clock_read(now);
}

int clock_timer_open(struct clock_timer *timer)
{
    timer->handle = NULL;
    return 1;
}

int clock_timer_wait(const struct clock_timer *timer, uint64_t deadline)
{
    static const uint64_t second = 1000000000u;
    const uint64_t now = clock_now(), ns = deadline > now ? deadline - now : 0;
    const struct timespec time = { .tv_sec = (time_t)(ns / second), .tv_nsec = (long)(ns % second) };
    (void)timer;
    return nanosleep(&time, NULL) == 0 ? 0 : errno == EINTR ? 1 : -1;
}

void clock_timer_close(struct clock_timer *timer)
{
    (void)timer;
}

/* ---- what a loop asks for ---- */

/* How much of a period a tick may take, and how late it may be, ns: of a loop of 1 kHz. */
enum { PERIOD = 1000000, WORK = 500000 };

static uint32_t ticks_of(uint64_t ns)
{
    mach_timebase_info_data_t base;
    mach_timebase_info(&base);
    return (uint32_t)(ns * base.denom / base.numer);
}

/* All priorities are one here: the system's own class of threads that have a deadline in each period. */
uint32_t urgent_begin(struct urgent *saved, uint32_t priority, uint32_t lock, uint32_t cpu, uint32_t awake)
{
    uint32_t notes = (cpu ? DPT_LOOP_NOTE_NO_CPU : 0) | (awake ? DPT_LOOP_NOTE_NO_AWAKE : 0);
    thread_time_constraint_policy_data_t policy = {
        .period = ticks_of(PERIOD), .computation = ticks_of(WORK), .constraint = ticks_of(PERIOD), .preemptible = 1
    };
    memset(saved, 0, sizeof *saved);
    saved->latency = -1;
    notes |= lock ? DPT_LOOP_NOTE_NO_LOCK : 0;
    if (!priority)
        return notes;
    saved->is_scheduled =
        thread_policy_set(pthread_mach_thread_np(pthread_self()), THREAD_TIME_CONSTRAINT_POLICY,
                          (thread_policy_t)&policy, THREAD_TIME_CONSTRAINT_POLICY_COUNT) == KERN_SUCCESS;
    return notes | (saved->is_scheduled ? 0 : DPT_LOOP_NOTE_NO_PRIORITY);
}

uint32_t urgent_end(const struct urgent *saved)
{
    thread_standard_policy_data_t policy = { 0 };
    if (saved->is_scheduled &&
        thread_policy_set(pthread_mach_thread_np(pthread_self()), THREAD_STANDARD_POLICY, (thread_policy_t)&policy,
                          THREAD_STANDARD_POLICY_COUNT) != KERN_SUCCESS)
        return DPT_LOOP_NOTE_NO_RETURN;
    return 0;
}

/* ---- the machine ---- */

void machine_processor(char *text, size_t room)
{
    if (sysctlbyname("machdep.cpu.brand_string", text, &room, NULL, 0) != 0)
        snprintf(text, room, "unknown");
}

int machine_random(void *bytes, size_t size)
{
    return getentropy(bytes, size);
}

/* Its drivers have no such request. */
int serial_lower_latency(int line)
{
    (void)line;
    errno = ENOTTY;
    return -1;
}
