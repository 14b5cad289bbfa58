/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a loop asks of the system for the time that it runs, and that it gives it back: locked memory, which must not
 * take a host its threads and its memory, and timers without slack. Each test is a process of its own.
 */
#define _GNU_SOURCE
#include <grp.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include "drivers/open_device.h"

enum { NOBODY = 65534, CANNOT = 77, USUAL_LIMIT = 8 << 20, MUCH = 64 << 20, SLACK = 70000 };

/* 0: it holds; CANNOT: it could not be tried here. */
static int in_a_process(void (*test)(void))
{
    int status = 1;
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        test();
        fflush(stdout);
        _exit(check_bad ? 1 : 0);
    }
    CHECK(child > 0 && waitpid(child, &status, 0) == child, "no process");
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 1;
    CHECK(code == 0 || code == CANNOT, "it failed with status %d", status);
    return code;
}

static dpt_loop_stats run_def(dpt_loop_def def)
{
    dpt_device *device = device_named("sim:?hand=press&live=1");
    dpt_loop_stats stats = { .size = sizeof stats };
    dpt_loop *loop;
    def.ticks = 20;
    CHECK(dpt_loop_open(device, &def, &loop) == DPT_OK, "no loop");
    CHECK(dpt_loop_run(loop, &stats) == DPT_OK, "the run failed");
    dpt_loop_close(loop);
    dpt_device_close(device);
    return stats;
}

static dpt_loop_stats run_loop(dpt_loop_tick_fn *tick, uint32_t priority, uint32_t lock)
{
    dpt_loop_def def;
    dpt_loop_def_init(&def);
    def.tick = tick;
    def.priority = priority;
    def.lock = lock;
    return run_def(def);
}

static void *nothing(void *user)
{
    return user;
}

/* A host's other work: a thread, and memory. */
static int can_work(void)
{
    pthread_t thread;
    if (pthread_create(&thread, NULL, nothing, NULL) != 0)
        return 0;
    pthread_join(thread, NULL);
    char *block = malloc(MUCH);
    if (!block)
        return 0;
    memset(block, 1, MUCH);
    const int is_written = block[MUCH / 2] == 1;
    free(block);
    return is_written;
}

static int could_work, ticks;

static dpt_result work(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    (void)user, (void)sample, (void)wrench;
    if (ticks++ == 5)
        could_work = can_work();
    return DPT_OK;
}

static void work_under_the_usual_limit(void)
{
    struct rlimit limit = { 0, 0 };
    getrlimit(RLIMIT_MEMLOCK, &limit);
    if (limit.rlim_max > USUAL_LIMIT)
        limit.rlim_max = USUAL_LIMIT;
    limit.rlim_cur = limit.rlim_max;
    if (setrlimit(RLIMIT_MEMLOCK, &limit) != 0 ||
        (geteuid() == 0 && (setgroups(0, NULL) != 0 || setgid(NOBODY) != 0 || setuid(NOBODY) != 0)))
        _exit(CANNOT);
    const dpt_loop_stats stats = run_loop(work, 0, 1);
    CHECK(ticks > 5 && could_work, "no thread or no memory while it runs");
    CHECK(can_work(), "no thread or no memory after it");
    CHECK(stats.notes == DPT_LOOP_NOTE_NO_LOCK, "notes %u", stats.notes);
}

static void an_unprivileged_host_keeps_threads_and_memory(void)
{
    if (in_a_process(work_under_the_usual_limit) == CANNOT)
        SKIP("the usual limit of locked memory", "this user cannot become another one");
}

/* Of this process; -1: not told. */
static long locked_kilobytes(void)
{
    char line[128];
    long kilobytes = -1;
    FILE *status = fopen("/proc/self/status", "r");
    while (status && kilobytes < 0 && fgets(line, sizeof line, status))
        if (sscanf(line, "VmLck: %ld", &kilobytes) != 1)
            kilobytes = -1;
    if (status)
        fclose(status);
    return kilobytes;
}

static long locked_inside, locked_between;

static dpt_result look(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    (void)user, (void)sample, (void)wrench;
    locked_inside = locked_kilobytes();
    return DPT_OK;
}

static dpt_result look_around_another(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    if (ticks++ == 5) {
        run_loop(look, 0, 1);
        locked_between = locked_kilobytes();
    }
    return look(user, sample, wrench);
}

static char page[4096];

static void lock_and_unlock(void)
{
    CHECK(run_loop(look, 0, 0).notes == 0 && locked_inside == 0, "locked unasked");
    CHECK(run_loop(look, 0, 1).notes == 0 && locked_inside > 1000, "%ld kB locked", locked_inside);
    CHECK(locked_kilobytes() == 0, "%ld kB stay locked", locked_kilobytes());
    ticks = 0;
    CHECK(run_loop(look_around_another, 0, 1).notes == 0 && locked_between > 1000 && locked_inside > 1000,
          "%ld kB after another loop", locked_between);
    CHECK(locked_kilobytes() == 0, "%ld kB stay locked after two", locked_kilobytes());
    /* What the host locked is the host's. */
    CHECK(mlock(page, sizeof page) == 0, "mlock");
    run_loop(look, 0, 1);
    CHECK(locked_kilobytes() > 0, "the host's page is unlocked");
}

static void lock_without_a_limit(void)
{
    const struct rlimit none = { RLIM_INFINITY, RLIM_INFINITY };
    if (setrlimit(RLIMIT_MEMLOCK, &none) != 0 || locked_kilobytes() != 0 || mlock(page, sizeof page) != 0 ||
        locked_kilobytes() == 0)
        _exit(CANNOT);
    munlock(page, sizeof page);
    lock_and_unlock();
}

/* With a limit of 0 only the privileged can lock a page. */
static void lock_above_the_limit(void)
{
    struct rlimit limit;
    if (getrlimit(RLIMIT_MEMLOCK, &limit) != 0)
        _exit(CANNOT);
    limit.rlim_cur = 0;
    if (setrlimit(RLIMIT_MEMLOCK, &limit) != 0 || locked_kilobytes() != 0 || mlock(page, sizeof page) != 0 ||
        locked_kilobytes() == 0)
        _exit(CANNOT);
    munlock(page, sizeof page);
    lock_and_unlock();
}

static void memory_is_locked_for_as_long_as_it_runs(void)
{
    const int unlimited = in_a_process(lock_without_a_limit);
    const int privileged = in_a_process(lock_above_the_limit);
    if (unlimited == CANNOT && privileged == CANNOT)
        SKIP("locked memory", "not permitted, not told, or a sanitizer leaves it out");
}

#ifdef __linux__
static int slack_inside = -1;

static dpt_result look_at_slack(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    (void)user, (void)sample, (void)wrench;
    slack_inside = prctl(PR_GET_TIMERSLACK, 0, 0, 0, 0);
    return DPT_OK;
}

static void ask_for_slack(void)
{
    if (prctl(PR_SET_TIMERSLACK, SLACK, 0, 0, 0) != 0 || prctl(PR_GET_TIMERSLACK, 0, 0, 0, 0) != SLACK)
        _exit(CANNOT);
    for (uint32_t priority = 0; priority <= 80; priority += 80) {
        run_loop(look_at_slack, priority, 0);
        /* A thread with a priority has none; newer kernels say so. */
        CHECK(slack_inside == 1 || (priority && slack_inside == 0), "%d ns at priority %u", slack_inside, priority);
        const int slack = prctl(PR_GET_TIMERSLACK, 0, 0, 0, 0);
        CHECK(slack == SLACK, "%d ns after priority %u", slack, priority);
    }
}
#endif

static void timers_have_no_slack_while_it_runs(void)
{
#ifdef __linux__
    if (in_a_process(ask_for_slack) == CANNOT)
#endif
        SKIP("timer slack", "the system has none");
}

#ifdef __linux__
static int processors_inside = -1, files_inside = -1;

/* How many the thread may run on; *is_first is whether the first of them is among these. */
static int count_processors(int *is_first)
{
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) != 0)
        return -1;
    *is_first = CPU_ISSET(0, &set) != 0;
    return CPU_COUNT(&set);
}

/* How many open files are the one that keeps processors awake. */
static int count_awake_files(void)
{
    int count = 0;
    for (int file = 0; file < 256; file++) {
        char link[64], path[64];
        snprintf(link, sizeof link, "/proc/self/fd/%d", file);
        const ssize_t length = readlink(link, path, sizeof path - 1);
        path[length > 0 ? length : 0] = '\0';
        count += !strcmp(path, "/dev/cpu_dma_latency");
    }
    return count;
}

static dpt_result look_at_processors(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    int is_first = 0;
    (void)user, (void)sample, (void)wrench;
    processors_inside = count_processors(&is_first) == 1 && is_first;
    files_inside = count_awake_files();
    return DPT_OK;
}

static dpt_loop_def on_a_processor(uint32_t cpu, uint32_t awake)
{
    dpt_loop_def def;
    dpt_loop_def_init(&def);
    def.tick = look_at_processors;
    def.priority = def.lock = 0;
    def.cpu = cpu;
    def.awake = awake;
    return def;
}

static void run_on_one_processor(void)
{
    int is_first = 0;
    const int before = count_processors(&is_first);
    if (before < 1 || !is_first)
        _exit(CANNOT);
    const dpt_loop_stats stats = run_def(on_a_processor(1, 0));
    CHECK(processors_inside == 1 && stats.notes == 0, "inside %d, notes %u", processors_inside, stats.notes);
    CHECK(count_processors(&is_first) == before, "it does not get its processors back");
    const dpt_loop_stats none = run_def(on_a_processor(100000, 0));
    CHECK(none.notes == DPT_LOOP_NOTE_NO_CPU, "processor 100000: notes %u", none.notes);
    CHECK(count_processors(&is_first) == before, "after one that is not there");
}

static void keep_processors_awake(void)
{
    const dpt_loop_stats stats = run_def(on_a_processor(0, 1));
    CHECK(stats.notes == 0 || stats.notes == DPT_LOOP_NOTE_NO_AWAKE, "notes %u", stats.notes);
    CHECK(files_inside == (stats.notes == 0), "%d files, notes %u", files_inside, stats.notes);
    CHECK(count_awake_files() == 0, "the file stays open");
    run_def(on_a_processor(0, 0));
    CHECK(files_inside == 0, "processors are kept awake unasked");
    if (stats.notes)
        _exit(CANNOT);
}
#endif

static void it_runs_on_the_processor_that_was_asked_for(void)
{
#ifdef __linux__
    if (in_a_process(run_on_one_processor) == CANNOT)
#endif
        SKIP("a processor", "the system does not let the test choose one");
}

static void processors_are_kept_awake(void)
{
#ifdef __linux__
    if (in_a_process(keep_processors_awake) == CANNOT)
#endif
        SKIP("processors awake", "not permitted");
}

int main(void)
{
    TEST(an_unprivileged_host_keeps_threads_and_memory);
    TEST(memory_is_locked_for_as_long_as_it_runs);
    TEST(timers_have_no_slack_while_it_runs);
    TEST(it_runs_on_the_processor_that_was_asked_for);
    TEST(processors_are_kept_awake);
    return check_report();
}
