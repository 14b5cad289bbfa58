/* SPDX-License-Identifier: BSD-3-Clause */
#define _DEFAULT_SOURCE
#include "urgent.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include "dynpoint/loop.h"

/* Memory is locked for a process, loops run in threads. */
static struct {
    pthread_mutex_t mutex;
    int holders;
    int is_ours; /* nothing was locked before */
} memory = { .mutex = PTHREAD_MUTEX_INITIALIZER };

/*
 * MCL_FUTURE under a finite limit makes later allocations and threads of the process fail, unless the process is
 * privileged. Whether it is, shows where one more page than the limit can be locked; PROT_NONE makes that cost nothing.
 */
static int may_lock_all(void)
{
#ifdef RLIMIT_MEMLOCK
    struct rlimit limit;
    if (getrlimit(RLIMIT_MEMLOCK, &limit) != 0)
        return 0;
    if (limit.rlim_cur == RLIM_INFINITY)
        return 1;
#ifdef MAP_LOCKED
    const size_t bytes = (size_t)limit.rlim_cur + 1;
    void *more = mmap(NULL, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_LOCKED, -1, 0);
    if (more == MAP_FAILED)
        return 0;
    munmap(more, bytes);
    return 1;
#else
    return 0;
#endif
#else
    return 1;
#endif
}

/* Of this process; -1: the system does not tell. */
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

/* By how much, in ns, the system may let this thread's timers be late. Without effect in a thread with a priority. */
static int timer_slack(void)
{
#ifdef __linux__
    return prctl(PR_GET_TIMERSLACK, 0, 0, 0, 0);
#else
    return 0;
#endif
}

static void set_timer_slack(int slack)
{
#ifdef __linux__
    prctl(PR_SET_TIMERSLACK, slack, 0, 0, 0);
#else
    (void)slack;
#endif
}

uint32_t urgent_begin(struct urgent *saved, uint32_t priority, uint32_t lock)
{
    uint32_t notes = 0;
    memset(saved, 0, sizeof *saved);
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
    const struct sched_param param = { .sched_priority = (int)priority };
    if (pthread_getschedparam(pthread_self(), &saved->policy, &saved->param) == 0 &&
        pthread_setschedparam(pthread_self(), SCHED_FIFO, &param) == 0)
        saved->is_scheduled = 1;
    else
        notes |= DPT_LOOP_NOTE_NO_PRIORITY;
    return notes;
}

uint32_t urgent_end(const struct urgent *saved)
{
    uint32_t notes = 0;
    if (saved->is_scheduled &&
        pthread_setschedparam(pthread_self(), saved->policy, &saved->param) != 0)
        notes |= DPT_LOOP_NOTE_NO_RETURN;
    /* After the priority: giving that back may set a slack of the system's own. */
    if (saved->slack)
        set_timer_slack(saved->slack);
    if (saved->holds_lock)
        unlock_memory();
    return notes;
}
