/* SPDX-License-Identifier: BSD-3-Clause */
/* The stand-in's scheduler and its thread. */
#define _POSIX_C_SOURCE 200809L
#include "drivers/hd/stand_in.h"

#include <pthread.h>
#include <string.h>
#include <time.h>

#include "drivers/hd/function_table.h"

enum { CALLBACKS = 16 };

struct scheduled {
    unsigned long id; /* 0: none */
    hd_callback *callback;
    void *user;
    unsigned short priority;
};

static pthread_mutex_t table_lock = PTHREAD_MUTEX_INITIALIZER; /* of what follows */
static struct scheduled table[CALLBACKS];
static unsigned long last_id;

static pthread_mutex_t tick_lock = PTHREAD_MUTEX_INITIALIZER; /* held through a tick */
static pthread_t thread;
static int runs, is_held;
static __thread int is_servo;

int stand_in_is_servo(void)
{
    return is_servo;
}

void stand_in_wait(void)
{
    const struct timespec time = { 0, 1000000 };
    nanosleep(&time, NULL);
}

int stand_in_runs(void)
{
    return __atomic_load_n(&runs, __ATOMIC_ACQUIRE);
}

static int find(unsigned long id)
{
    for (int i = 0; i < CALLBACKS; i++)
        if (id != 0 && table[i].id == id)
            return i;
    return -1;
}

static int remove_one(unsigned long id)
{
    pthread_mutex_lock(&table_lock);
    const int at = find(id);
    if (at >= 0)
        table[at].id = 0;
    pthread_mutex_unlock(&table_lock);
    return at >= 0;
}

static int has_callbacks(void)
{
    int count = 0;
    pthread_mutex_lock(&table_lock);
    for (int i = 0; i < CALLBACKS; i++)
        count += table[i].id != 0;
    pthread_mutex_unlock(&table_lock);
    return count > 0;
}

void stand_in_clear_scheduler(void)
{
    pthread_mutex_lock(&table_lock);
    memset(table, 0, sizeof table);
    pthread_mutex_unlock(&table_lock);
}

/* Of those that have not run in this tick the one of highest priority, the eldest first. */
static struct scheduled next_of(const unsigned long *done, int count)
{
    struct scheduled next = { .id = 0 };
    pthread_mutex_lock(&table_lock);
    for (int i = 0; i < CALLBACKS; i++) {
        int was = table[i].id == 0;
        for (int k = 0; k < count; k++)
            was |= done[k] == table[i].id;
        if (!was && (!next.id || table[i].priority > next.priority ||
                     (table[i].priority == next.priority && table[i].id < next.id)))
            next = table[i];
    }
    pthread_mutex_unlock(&table_lock);
    return next;
}

static void tick(void)
{
    unsigned long done[CALLBACKS];
    is_servo = 1;
    stand_in.ticks++;
    const unsigned raised = __atomic_load_n(&stand_in.raise, __ATOMIC_RELAXED);
    if (raised) {
        stand_in_push(raised, -28, (unsigned)stand_in.raise_device);
        if (stand_in.raise_more > 0)
            stand_in.raise_more--;
        else
            __atomic_store_n(&stand_in.raise, 0, __ATOMIC_RELAXED);
    }
    if (stand_in.drops_callbacks) {
        stand_in.drops_callbacks = 0;
        stand_in_clear_scheduler();
    }
    for (int count = 0; count < CALLBACKS; count++) {
        const struct scheduled next = next_of(done, count);
        if (!next.id)
            break;
        done[count] = next.id;
        if (next.callback(next.user) == HD_CALLBACK_DONE)
            remove_one(next.id);
    }
    stand_in_after_tick();
    is_servo = 0;
}

static void *serve(void *unused)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    while (stand_in_runs()) {
        pthread_mutex_lock(&tick_lock);
        if (!is_held && !stand_in.hangs)
            tick();
        pthread_mutex_unlock(&tick_lock);
        time.tv_nsec += 1000000000 / (long)stand_in.rate;
        if (time.tv_nsec >= 1000000000) {
            time.tv_nsec -= 1000000000;
            time.tv_sec++;
        }
        clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, NULL);
    }
    return unused;
}

static void hold(void)
{
    pthread_mutex_lock(&tick_lock);
    is_held = 1;
    pthread_mutex_unlock(&tick_lock);
}

static void go(void)
{
    pthread_mutex_lock(&tick_lock);
    is_held = 0;
    pthread_mutex_unlock(&tick_lock);
}

static void tick_by_hand(void)
{
    pthread_mutex_lock(&tick_lock);
    if (stand_in_runs() && !stand_in.hangs)
        tick();
    pthread_mutex_unlock(&tick_lock);
}

__attribute__((constructor)) static void begin(void)
{
    stand_in.hold = hold;
    stand_in.go = go;
    stand_in.tick = tick_by_hand;
}

void HD_CALL hdStartScheduler(void)
{
    if (stand_in_runs())
        return;
    stand_in_meanwhile(&stand_in.in_start);
    const unsigned failure = stand_in.fail_start;
    stand_in.fail_start = 0;
    if (failure) {
        stand_in_push(failure, 11, 0);
        return;
    }
    __atomic_store_n(&runs, 1, __ATOMIC_RELEASE);
    if (pthread_create(&thread, NULL, serve, NULL) != 0) {
        __atomic_store_n(&runs, 0, __ATOMIC_RELEASE);
        stand_in_push(HD_TIMER_ERROR, 0, 0);
    }
    for (int i = 0; i < 100 && stand_in.lingers && !stand_in.errors(); i++)
        stand_in_wait();
}

void HD_CALL hdStopScheduler(void)
{
    if (is_servo) {
        stand_in_break("the scheduler stopped in its own thread");
        return;
    }
    if (!stand_in_runs())
        return;
    __atomic_store_n(&runs, 0, __ATOMIC_RELEASE);
    pthread_join(thread, NULL);
    for (int i = 0; i < 3 * STAND_IN_DEVICES; i++)
        if (has_callbacks() &&
            (stand_in.device[i / 3].force[i % 3] != 0.0 || stand_in.device[i / 3].torque[i % 3] != 0.0))
            stand_in_break("the scheduler stopped under force");
}

void HD_CALL hdSetSchedulerRate(unsigned long rate)
{
    const unsigned failure = stand_in.fail_rate;
    stand_in.fail_rate = 0;
    if (failure || (rate != 500 && rate != 1000 && rate != 2000))
        stand_in_push(failure ? failure : HD_INVALID_VALUE, 0, 0);
    else
        stand_in.rate = (unsigned)rate;
}

unsigned long HD_CALL hdScheduleAsynchronous(hd_callback *callback, void *user, unsigned short priority)
{
    const unsigned failure = stand_in.fail_schedule;
    stand_in.fail_schedule = 0;
    int at = 0;
    unsigned long id = 0;
    pthread_mutex_lock(&table_lock);
    while (at < CALLBACKS && table[at].id)
        at++;
    if (at < CALLBACKS && !failure) {
        id = ++last_id;
        table[at] = (struct scheduled){ id, callback, user, priority };
    }
    pthread_mutex_unlock(&table_lock);
    if (!id)
        stand_in_push(failure ? failure : HD_SCHEDULER_FULL, 0, 0);
    return id;
}

void HD_CALL hdUnschedule(unsigned long id)
{
    if (!remove_one(id))
        stand_in_push(HD_INVALID_OPERATION, 0, 0);
}

unsigned char HD_CALL hdWaitForCompletion(unsigned long id, unsigned wait)
{
    stand_in_meanwhile(&stand_in.in_wait);
    for (;;) {
        pthread_mutex_lock(&table_lock);
        const int is_there = find(id) >= 0;
        pthread_mutex_unlock(&table_lock);
        if (!is_there || wait == HD_WAIT_CHECK_STATUS)
            return (unsigned char)is_there;
        stand_in_wait();
    }
}
