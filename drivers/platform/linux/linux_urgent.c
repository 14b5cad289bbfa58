/* SPDX-License-Identifier: BSD-3-Clause */
#define _GNU_SOURCE
#include "platform/urgent.h"

#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include "dynpoint/loop.h"

/* A memory lock covers the whole process, so the loops of all threads share one. */
static struct {
    pthread_mutex_t mutex;
    int holders; /* loops that hold the lock */
    int is_ours; /* no memory was locked before the first loop */
} memory = { .mutex = PTHREAD_MUTEX_INITIALIZER };

/*
 * Under a finite limit MCL_FUTURE makes later allocations and threads of the process fail, unless the process is
 * privileged. It is privileged if it can lock one byte more than the limit. PROT_NONE makes this test cost no memory.
 */
static int may_lock_all(void)
{
    struct rlimit limit;
    if (getrlimit(RLIMIT_MEMLOCK, &limit) != 0)
        return 0;
    if (limit.rlim_cur == RLIM_INFINITY)
        return 1;
    const size_t bytes = (size_t)limit.rlim_cur + 1;
    void *more = mmap(NULL, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_LOCKED, -1, 0);
    if (more == MAP_FAILED)
        return 0;
    munmap(more, bytes);
    return 1;
}

/* Locked memory of this process; -1 if the system does not report it. */
static long locked_kilobytes(void)
{
    char line[128];
    long kilobytes = -1;
    FILE *status = fopen("/proc/self/status", "r");
    if (!status)
        return -1;
    while (kilobytes < 0 && fgets(line, sizeof line, status))
        if (sscanf(line, "VmLck: %ld", &kilobytes) != 1)
            kilobytes = -1;
    fclose(status);
    return kilobytes;
}

static int lock_memory(void)
{
    pthread_mutex_lock(&memory.mutex);
    if (!memory.holders) {
        memory.is_ours = locked_kilobytes() == 0;
        if (may_lock_all() && mlockall(MCL_CURRENT | MCL_FUTURE) == 0)
            memory.holders = 1;
    } else {
        memory.holders++;
    }
    const int is_locked = memory.holders > 0;
    pthread_mutex_unlock(&memory.mutex);
    return is_locked;
}

static void unlock_memory(void)
{
    pthread_mutex_lock(&memory.mutex);
    memory.holders--;
    if (!memory.holders && memory.is_ours)
        munlockall();
    pthread_mutex_unlock(&memory.mutex);
}

/* How late the system may let this thread's timers be, ns. It has no effect in a thread with real-time priority. */
static int timer_slack(void)
{
    return prctl(PR_GET_TIMERSLACK, 0, 0, 0, 0);
}

static void set_timer_slack(int slack)
{
    prctl(PR_SET_TIMERSLACK, slack, 0, 0, 0);
}

typedef char processors_fit[sizeof(cpu_set_t) <= sizeof((struct urgent *)0)->processors ? 1 : -1];

/* Run on one processor alone. Returns 0 if that is not permitted, or there is none of this number. */
static int pin(struct urgent *saved, uint32_t cpu)
{
    cpu_set_t all, one;
    if (cpu > CPU_SETSIZE || pthread_getaffinity_np(pthread_self(), sizeof all, &all) != 0)
        return 0;
    memcpy(saved->processors, &all, sizeof all);
    CPU_ZERO(&one);
    CPU_SET(cpu - 1, &one);
    saved->is_pinned = pthread_setaffinity_np(pthread_self(), sizeof one, &one) == 0;
    return saved->is_pinned;
}

/* Returns 0 if the thread could not be given its processors back. */
static int unpin(const struct urgent *saved)
{
    cpu_set_t all;
    memcpy(&all, saved->processors, sizeof all);
    return pthread_setaffinity_np(pthread_self(), sizeof all, &all) == 0;
}

/* The longest sleep that processors may need to wake from, us: 0, for as long as the file is open. */
static int keep_awake(void)
{
    const int32_t longest = 0;
    const int file = open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC);
    if (file >= 0 && write(file, &longest, sizeof longest) == sizeof longest)
        return file;
    if (file >= 0)
        close(file);
    return -1;
}

uint32_t urgent_begin(struct urgent *saved, uint32_t priority, uint32_t lock, uint32_t cpu, uint32_t awake)
{
    uint32_t notes = 0;
    memset(saved, 0, sizeof *saved);
    saved->latency = awake ? keep_awake() : -1;
    if (awake && saved->latency < 0)
        notes |= DPT_LOOP_NOTE_NO_AWAKE;
    if (cpu && !pin(saved, cpu))
        notes |= DPT_LOOP_NOTE_NO_CPU;
    if (lock) {
        saved->holds_lock = lock_memory();
        notes |= saved->holds_lock ? 0 : DPT_LOOP_NOTE_NO_LOCK;
    }
    const int slack = timer_slack();
    saved->slack = slack > 0 ? slack : 0;
    if (saved->slack)
        set_timer_slack(1);
    if (!priority)
        return notes;
    struct sched_param before;
    const struct sched_param param = { .sched_priority = (int)priority };
    if (pthread_getschedparam(pthread_self(), &saved->policy, &before) == 0 &&
        pthread_setschedparam(pthread_self(), SCHED_FIFO, &param) == 0) {
        saved->is_scheduled = 1;
        saved->priority = before.sched_priority;
    } else {
        notes |= DPT_LOOP_NOTE_NO_PRIORITY;
    }
    return notes;
}

uint32_t urgent_end(const struct urgent *saved)
{
    uint32_t notes = 0;
    const struct sched_param before = { .sched_priority = saved->priority };
    if (saved->is_scheduled && pthread_setschedparam(pthread_self(), saved->policy, &before) != 0)
        notes |= DPT_LOOP_NOTE_NO_RETURN;
    /* After the priority, because restoring that may change the slack. */
    if (saved->slack)
        set_timer_slack(saved->slack);
    if (saved->is_pinned && !unpin(saved))
        notes |= DPT_LOOP_NOTE_NO_RETURN;
    if (saved->latency >= 0)
        close(saved->latency);
    if (saved->holds_lock)
        unlock_memory();
    return notes;
}
