/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Every call of the system that drivers and loop make fails in its turn: the first, the second ..., once or from then on,
 * until a run gets through without. Each failure is a code with words, or counted; nothing leaks; the device ends with
 * zero force. The linker puts the functions below between the drivers and the C library (tests.mk).
 */
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <time.h>

#include "drivers/open_device.h"

enum call {
    NO_CALL,
    MALLOC,
    CALLOC,
    REALLOC,
    OPEN,
    READ,
    CLOCK,
    BOOT_CLOCK,
    SLEEP,
    GET_LIMIT,
    LOCK,
    GET_SCHED,
    SET_SCHED,
    CALLS
};

static const char *const call_names[CALLS] = { "none",
                                               "malloc",
                                               "calloc",
                                               "realloc",
                                               "open",
                                               "read",
                                               "clock_gettime",
                                               "clock_gettime, since boot",
                                               "clock_nanosleep",
                                               "getrlimit",
                                               "mlockall",
                                               "pthread_getschedparam",
                                               "pthread_setschedparam" };

static struct {
    enum call call;
    int at, onwards, error;
    int is_armed, did_fail;
    int made[CALLS];
    int blocks, files; /* that are held */
    int short_reads;
    int policy, priority, locks, unlocks;
} plan;

/* The error that this call is to fail with; 0: it is to be made. */
static int failure_of(enum call call)
{
    if (!plan.is_armed)
        return 0;
    int number = ++plan.made[call];
    if (call != plan.call || number < plan.at || (number > plan.at && !plan.onwards))
        return 0;
    plan.did_fail = 1;
    errno = plan.error;
    return plan.error;
}

#define WRAP(result, name, ...)                                                                                        \
    result __real_##name(__VA_ARGS__);                                                                                 \
    result __wrap_##name(__VA_ARGS__);                                                                                 \
    result __wrap_##name(__VA_ARGS__)

WRAP(void *, malloc, size_t size)
{
    void *block = failure_of(MALLOC) ? NULL : __real_malloc(size);
    plan.blocks += plan.is_armed && block;
    return block;
}

WRAP(void *, calloc, size_t count, size_t size)
{
    void *block = failure_of(CALLOC) ? NULL : __real_calloc(count, size);
    plan.blocks += plan.is_armed && block;
    return block;
}

WRAP(void *, realloc, void *block, size_t size)
{
    void *grown = failure_of(REALLOC) ? NULL : __real_realloc(block, size);
    plan.blocks += plan.is_armed && grown && !block;
    return grown;
}

WRAP(void, free, void *block)
{
    plan.blocks -= plan.is_armed && block;
    __real_free(block);
}

int __real_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...)
{
    int file = failure_of(OPEN) ? -1 : __real_open(path, flags);
    plan.files += plan.is_armed && file >= 0;
    return file;
}

WRAP(int, close, int file)
{
    plan.files -= plan.is_armed && file >= 0;
    return __real_close(file);
}

WRAP(ssize_t, read, int file, void *bytes, size_t size)
{
    if (failure_of(READ))
        return -1;
    return __real_read(file, bytes, plan.is_armed && plan.short_reads && size > 7 ? 7 : size);
}

WRAP(int, clock_gettime, clockid_t clock, struct timespec *time)
{
    return failure_of(clock == CLOCK_MONOTONIC ? CLOCK : BOOT_CLOCK) ? -1 : __real_clock_gettime(clock, time);
}

WRAP(int, clock_nanosleep, clockid_t clock, int flags, const struct timespec *until, struct timespec *left)
{
    int error = failure_of(SLEEP);
    return error ? error : __real_clock_nanosleep(clock, flags, until, left);
}

WRAP(int, nanosleep, const struct timespec *time, struct timespec *left)
{
    return __real_nanosleep(time, left);
}

WRAP(int, mlockall, int flags)
{
    plan.locks += flags == (MCL_CURRENT | MCL_FUTURE);
    return failure_of(LOCK) ? -1 : 0;
}

WRAP(int, munlockall, void)
{
    plan.unlocks++;
    return 0;
}

WRAP(int, getrlimit, int resource, struct rlimit *limit)
{
    *limit = (struct rlimit){ RLIM_INFINITY, RLIM_INFINITY };
    return resource == RLIMIT_MEMLOCK && failure_of(GET_LIMIT) ? -1 : 0;
}

WRAP(int, pthread_getschedparam, pthread_t thread, int *policy, struct sched_param *param)
{
    int error = failure_of(GET_SCHED);
    return error ? error : __real_pthread_getschedparam(thread, policy, param);
}

WRAP(int, pthread_setschedparam, pthread_t thread, int policy, const struct sched_param *param)
{
    (void)thread;
    int error = failure_of(SET_SCHED);
    if (!error) {
        plan.policy = policy;
        plan.priority = param->sched_priority;
    }
    return error;
}

/* What a host does, from open to close. */
struct outcome {
    dpt_result opened, created, ran;
    dpt_device_error error;
    dpt_loop_stats stats;
    int ends_with_force, was_urgent;
};

static dpt_result hold(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    struct outcome *outcome = user;
    (void)sample;
    outcome->was_urgent += plan.policy == SCHED_FIFO && plan.priority == 80;
    wrench->force[0] = 1.0;
    return DPT_OK;
}

/* The mass is free: force changes its speed. */
static int gives_force(dpt_device *device)
{
    dpt_device_state before = { .size = sizeof before }, after = before;
    const struct timespec time = { 0, 3000000 };
    dpt_device_read(device, &before);
    __real_nanosleep(&time, NULL);
    dpt_device_read(device, &after);
    return before.velocity[0] != after.velocity[0];
}

static struct outcome host_runs(const char *name, uint64_t ticks)
{
    struct outcome outcome = { .error.size = sizeof outcome.error, .stats.size = sizeof outcome.stats };
    dpt_device *device = NULL;
    dpt_loop *loop = NULL;
    dpt_loop_def def;
    dpt_guard_def guard;
    memset(plan.made, 0, sizeof plan.made);
    plan.did_fail = plan.blocks = plan.files = plan.policy = plan.priority = plan.locks = plan.unlocks = 0;
    plan.is_armed = 1;
    outcome.opened = dpt_device_open(name, &device, &outcome.error);
    if (outcome.opened == DPT_OK) {
        dpt_loop_def_init(&def);
        def.tick = hold;
        def.user = &outcome;
        def.ticks = ticks;
        dpt_guard_def_init(&guard);
        guard.start = 0.0;
        def.guard = &guard;
        outcome.created = dpt_loop_open(device, &def, &loop);
        if (outcome.created == DPT_OK)
            outcome.ran = dpt_loop_run(loop, &outcome.stats);
        enum call call = plan.call;
        plan.call = NO_CALL;
        outcome.ends_with_force = !strncmp(name, "sim", 3) && gives_force(device);
        plan.call = call;
        dpt_loop_close(loop);
        dpt_device_close(device);
    }
    plan.is_armed = 0;
    return outcome;
}

static struct small_file script, trace;

/* Four rows would fit in one block: these make tables and texts grow. */
static void make_files(void)
{
    static char text[1 << 18];
    char *at = text + sprintf(text, "t,fx,fy,fz\n");
    for (int row = 0; row < 700; row++)
        at += sprintf(at, "%d,0,0,0\n", row);
    script = file_with(text);
    at = text + sprintf(text, "tick,ax,ay,az,bx,by,bz\n");
    for (int row = 0; row < 3000; row++)
        at += sprintf(at, "%d,%d.000001,0,0,%d.000001,0,0.2500001\n", row, row, row);
    trace = file_with(text);
}

static const struct scenario {
    const char *name;
    const struct small_file *file;
    uint64_t ticks;
    int is_live;
} scenarios[] = {
    { "sim:?mass=1&damping=0&hand=", &script, 20, 0 },
    { "sim:?mass=1&damping=0&live=1&hand=", &script, 20, 1 },
    { "replay:", &trace, 20, 0 },
};
enum { SCENARIOS = sizeof scenarios / sizeof *scenarios };

static struct outcome run(const struct scenario *scenario)
{
    char name[256];
    snprintf(name, sizeof name, "%s%s", scenario->name, scenario->file->path);
    return host_runs(name, scenario->ticks);
}

static void without_failures_all_is_well(void)
{
    plan.call = NO_CALL;
    for (int s = 0; s < SCENARIOS; s++) {
        struct outcome outcome = run(&scenarios[s]);
        CHECK(!outcome.opened && !outcome.created && !outcome.ran && outcome.stats.ticks == 20, "scenario %d: %s", s,
              outcome.error.text);
        CHECK(plan.blocks == 0 && plan.files == 0 && !outcome.ends_with_force, "scenario %d: %d blocks, %d files", s,
              plan.blocks, plan.files);
        CHECK(plan.made[CALLOC] == 1 && plan.made[REALLOC] >= 4 && plan.made[OPEN] == 1 && plan.made[READ] >= 2 &&
                  plan.made[MALLOC] == 1,
              "scenario %d: calls are not wrapped", s);
        CHECK((plan.made[CLOCK] > 40) == scenarios[s].is_live && (plan.made[SLEEP] >= 20) == scenarios[s].is_live,
              "scenario %d: %d clocks", s, plan.made[CLOCK]);
        CHECK(plan.locks == scenarios[s].is_live && plan.unlocks == plan.locks &&
                  plan.made[SET_SCHED] == 2 * scenarios[s].is_live,
              "scenario %d: %d locks", s, plan.locks);
        CHECK((outcome.was_urgent > 0) == scenarios[s].is_live && plan.policy != SCHED_FIFO, "scenario %d: policy %d",
              s, plan.policy);
    }
    plan.short_reads = 1;
    for (int s = 0; s < SCENARIOS; s++) {
        struct outcome outcome = run(&scenarios[s]);
        CHECK(!outcome.opened && !outcome.ran && plan.made[READ] > 500, "scenario %d by seven bytes: %s", s,
              outcome.error.text);
    }
    plan.short_reads = 0;
}

/* From the second tick on: no memory, no files, and the clock a few times a tick. */
static void ticks_ask_little(void)
{
    plan.call = NO_CALL;
    for (int s = 0; s < SCENARIOS; s++) {
        struct scenario longer = scenarios[s];
        int made[CALLS];
        run(&scenarios[s]);
        memcpy(made, plan.made, sizeof made);
        longer.ticks += 300;
        struct outcome outcome = run(&longer);
        CHECK(outcome.stats.ticks == 320, "scenario %d: %d ticks", s, (int)outcome.stats.ticks);
        for (enum call call = MALLOC; call <= READ; call++)
            CHECK(plan.made[call] == made[call], "scenario %d: %s in a tick", s, call_names[call]);
        /* One that finds nothing fresh asks once less: on a busy machine any of the first 20. */
        CHECK(plan.made[BOOT_CLOCK] - made[BOOT_CLOCK] <= 300 * longer.is_live,
              "scenario %d: the clock since boot %d times in 300 ticks", s, plan.made[BOOT_CLOCK] - made[BOOT_CLOCK]);
        CHECK(plan.made[CLOCK] - made[CLOCK] <= (5 * 300 + 20) * longer.is_live,
              "scenario %d: the clock %d times in 300 ticks", s, plan.made[CLOCK] - made[CLOCK]);
    }
}

static void check_outcome(const struct outcome *outcome, const char *what)
{
    const dpt_loop_stats *stats = &outcome->stats;
    CHECK(plan.blocks == 0 && plan.files == 0, "%s: %d blocks and %d files leak", what, plan.blocks, plan.files);
    CHECK(!outcome->ends_with_force, "%s: it ends with force", what);
    switch (plan.call) {
    case MALLOC:
        CHECK(outcome->created == DPT_E_MEMORY, "%s: %d", what, outcome->created);
        break;
    case CALLOC:
    case REALLOC:
        CHECK(outcome->opened == DPT_E_MEMORY && strstr(outcome->error.text, "memory"), "%s: %s", what,
              outcome->error.text);
        break;
    case OPEN:
    case READ:
        if (plan.error == EINTR)
            CHECK(outcome->opened == DPT_OK && outcome->ran == DPT_OK, "%s: %s", what, outcome->error.text);
        else
            CHECK(outcome->opened == DPT_E_OPEN && outcome->error.code == DPT_E_OPEN &&
                      strstr(outcome->error.text, "/tmp/dynpoint-test-") &&
                      strstr(outcome->error.text, strerror(plan.error)),
                  "%s: %s", what, outcome->error.text);
        break;
    case CLOCK:
        CHECK(outcome->opened == DPT_OK && outcome->created == DPT_OK, "%s: %s", what, outcome->error.text);
        CHECK(outcome->ran == DPT_E_SYSTEM || stats->stale + stats->refused > 0, "%s: not noticed", what);
        break;
    case BOOT_CLOCK:
        CHECK(outcome->ran == DPT_OK, "%s: %d", what, outcome->ran);
        break;
    case SLEEP:
        CHECK(outcome->ran == (plan.error == EINTR ? DPT_OK : DPT_E_SYSTEM), "%s: %d", what, outcome->ran);
        CHECK(plan.error != EINTR || (stats->ticks == 20 && plan.made[SLEEP] == 21), "%s: %d ticks, %d sleeps", what,
              (int)stats->ticks, plan.made[SLEEP]);
        break;
    case GET_LIMIT:
    case LOCK:
        CHECK(outcome->ran == DPT_OK && stats->notes == DPT_LOOP_NOTE_NO_LOCK && !plan.unlocks, "%s: notes %u", what,
              stats->notes);
        break;
    case GET_SCHED:
    case SET_SCHED:
        CHECK(outcome->ran == DPT_OK &&
                  (stats->notes == DPT_LOOP_NOTE_NO_PRIORITY || stats->notes == DPT_LOOP_NOTE_NO_RETURN),
              "%s: notes %u", what, stats->notes);
        CHECK((stats->notes == DPT_LOOP_NOTE_NO_RETURN) == (plan.call == SET_SCHED && plan.at == 2), "%s: notes %u",
              what, stats->notes);
        break;
    default:
        break;
    }
}

static void every_call_fails_in_its_turn(void)
{
    static const struct {
        enum call call;
        int error, onwards;
    } kinds[] = {
        { MALLOC, ENOMEM, 0 },   { MALLOC, ENOMEM, 1 },     { CALLOC, ENOMEM, 0 },     { CALLOC, ENOMEM, 1 },
        { REALLOC, ENOMEM, 0 },  { REALLOC, ENOMEM, 1 },    { OPEN, EACCES, 0 },       { OPEN, EMFILE, 1 },
        { READ, EIO, 0 },        { READ, EIO, 1 },          { READ, EINTR, 0 },        { CLOCK, EINVAL, 0 },
        { CLOCK, EINVAL, 1 },    { BOOT_CLOCK, EINVAL, 0 }, { BOOT_CLOCK, EINVAL, 1 }, { SLEEP, EINVAL, 0 },
        { SLEEP, EINVAL, 1 },    { SLEEP, EINTR, 0 },       { GET_LIMIT, EINVAL, 0 },  { LOCK, EPERM, 0 },
        { GET_SCHED, EPERM, 0 }, { SET_SCHED, EPERM, 0 },   { SET_SCHED, EPERM, 1 },
    };
    int walked = 0;
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
        for (int s = 0; s < SCENARIOS; s++)
            for (plan.at = 1;; plan.at++) {
                plan.call = kinds[k].call;
                plan.error = kinds[k].error;
                plan.onwards = kinds[k].onwards;
                struct outcome outcome = run(&scenarios[s]);
                if (!plan.did_fail)
                    break;
                char what[128];
                snprintf(what, sizeof what, "scenario %d, %s %d%s: %s", s, call_names[plan.call], plan.at,
                         plan.onwards ? " and on" : "", strerror(plan.error));
                check_outcome(&outcome, what);
                walked++;
            }
    plan.call = NO_CALL;
    CHECK(walked > 200, "only %d failures", walked);
    printf("    %d failures\n", walked);
}

int main(void)
{
    make_files();
    TEST(without_failures_all_is_well);
    TEST(ticks_ask_little);
    TEST(every_call_fails_in_its_turn);
    unlink(script.path);
    unlink(trace.path);
    return check_report();
}
