/* SPDX-License-Identifier: BSD-3-Clause */
/* The servo loop (loop.h). */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/return_if_error.h"
#include "base/sized.h"
#include "base/vec3.h"
#include "clock.h"
#include "dynpoint/loop.h"
#include "urgent.h"

enum { ZERO_WRITES_MAX = 10 };

static const uint64_t SECOND = 1000000000u;

struct dpt_loop {
    dpt_device *device;
    dpt_device_info info;
    dpt_loop_def def;     /* def.guard is NULL: `guard` has its content */
    dpt_guard_def guard;  /* within what the device can do */
    double period;        /* s */
    uint64_t period_ns;   /* the same in ns */
    int is_deterministic; /* the device's time passes by reads */
    int stop;             /* set by dpt_loop_stop, read atomically */
};

/* The state of one run. */
struct run {
    struct dpt_loop *loop;
    dpt_loop_stats stats;
    dpt_guard guard;
    dpt_device_state state;
    dpt_loop_sample sample;
    uint64_t now; /* ns, of the monotonic clock, or the time of a deterministic device */
    int64_t
        suspended_ns; /* how long the machine was suspended since boot: the largest value read */
    int has_sequence;
    uint64_t sequence; /* of the newest sample that was accepted */
    int has_host_sample;
    uint64_t host_sample_ns; /* time_ns of the last sample that the host saw */
    int is_lost;
    uint64_t retry_ns; /* when to try dpt_device_clear again */
};

void dpt_loop_def_defaults(dpt_loop_def *def, size_t size)
{
    const dpt_loop_def defaults = { .priority = 80, .lock = 1 };
    sized_defaults(def, size, &defaults, sizeof defaults);
}

/* The loop's guard is the host's, with its limits lowered to what the device can do. */
static dpt_result limit_guard(const dpt_guard_def *given, struct dpt_loop *loop)
{
    const dpt_device_info *info = &loop->info;
    dpt_guard_def *def = &loop->guard;
    dpt_guard guard = { .size = sizeof guard };
    dpt_guard_def_init(def);
    if (given)
        DPT_TRY(sized_read(given, sizeof *given, def, sizeof *def));
    DPT_TRY(dpt_guard_init(&guard, def));
    if ((uint64_t)(def->hold * 1e9 + 0.5) < loop->period_ns)
        return DPT_E_ARGUMENT;
    const double force = info->wrench_dofs < 3 ? 0.0 : info->force_max;
    const double torque = info->wrench_dofs < 6 ? 0.0 : info->torque_max;
    def->force_max = min_of(def->force_max, max_of(force, 0.0));
    def->torque_max = min_of(def->torque_max, max_of(torque, 0.0));
    return DPT_OK;
}

dpt_result dpt_loop_create(dpt_device *device, const dpt_loop_def *given, dpt_loop **out)
{
    dpt_loop loop = { .device = device, .info.size = sizeof loop.info };
    if (out)
        *out = NULL;
    if (!device || !given || !out)
        return DPT_E_ARGUMENT;
    dpt_loop_def_init(&loop.def);
    DPT_TRY(sized_read(given, sizeof loop.def, &loop.def, sizeof loop.def));
    DPT_TRY(dpt_device_get_info(device, &loop.info));
    const double rate = loop.def.rate != 0.0 ? loop.def.rate : loop.info.rate;
    if (!loop.def.tick || loop.def.reserved_pointer || loop.def.reserved_pointer_2 ||
        loop.def.priority > 99 || loop.def.lock > 1 || loop.def.reopen > 1 || loop.def.awake > 1 ||
        !(rate >= 1.0 && rate <= 100000.0))
        return DPT_E_ARGUMENT;
    loop.period = 1.0 / rate;
    loop.period_ns = (uint64_t)(1e9 / rate + 0.5);
    loop.is_deterministic = (loop.info.flags & DPT_DEVICE_FLAG_DETERMINISTIC) != 0;
    DPT_TRY(limit_guard(loop.def.guard, &loop));
    loop.def.guard = NULL;
    *out = malloc(sizeof loop);
    if (!*out)
        return DPT_E_MEMORY;
    **out = loop;
    return DPT_OK;
}

void dpt_loop_free(dpt_loop *loop)
{
    free(loop);
}

void dpt_loop_stop(dpt_loop *loop)
{
    if (loop)
        __atomic_store_n(&loop->stop, 1, __ATOMIC_RELAXED);
}

static int must_stop(const dpt_loop *loop)
{
    return __atomic_load_n(&loop->stop, __ATOMIC_RELAXED);
}

static dpt_result sleep_until(const dpt_loop *loop, uint64_t deadline)
{
    struct timespec time = { .tv_sec = (time_t)(deadline / SECOND),
                             .tv_nsec = (long)(deadline % SECOND) };
    int error;
    do
        error = clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, NULL);
    while (error == EINTR && !must_stop(loop));
    return error == 0 || error == EINTR ? DPT_OK : DPT_E_SYSTEM;
}

static const double quarter_powers[4] = { 1.0, 1.189207115002721, 1.4142135623730951,
                                          1.681792830507429 };

static uint32_t bin_index(uint64_t ns)
{
    double us = (double)ns * 1e-3;
    uint32_t bin = 0;
    for (; us >= 2.0 && bin < DPT_LOOP_BINS; us *= 0.5)
        bin += 4;
    for (uint32_t k = 3; k > 0; k--)
        if (us >= quarter_powers[k]) {
            bin += k;
            break;
        }
    return bin < DPT_LOOP_BINS ? bin : DPT_LOOP_BINS - 1;
}

double dpt_loop_quantile(const uint64_t *bins, double fraction)
{
    uint64_t total = 0, seen = 0;
    uint32_t bin = 0;
    if (!bins || !(fraction >= 0.0 && fraction <= 1.0))
        return 0.0;
    for (uint32_t k = 0; k < DPT_LOOP_BINS; k++)
        total += bins[k];
    if (!total)
        return 0.0;
    for (; bin < DPT_LOOP_BINS - 1; bin++) {
        seen += bins[bin];
        if ((double)seen >= fraction * (double)total && seen)
            break;
    }
    double bin_end = 1e-6 * quarter_powers[(bin + 1) % 4];
    for (uint32_t k = 0; k < (bin + 1) / 4; k++)
        bin_end *= 2.0;
    return bin_end;
}

static int pose_is_sound(const dpt_pose *pose)
{
    const double *q = pose->orientation;
    return vec3_within(pose->position, DPT_COORDINATE_MAX) &&
           within(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1.0, 2e-6);
}

/* Count the sample that was read. Returns 1 if it is newer than all before. */
static int accept_sample(struct run *run)
{
    const dpt_device_state *state = &run->state;
    if (!state->fresh)
        return 0;
    if (run->has_sequence && state->sequence <= run->sequence) {
        run->stats.reordered++;
        return 0;
    }
    if (run->has_sequence)
        run->stats.skipped += state->sequence - run->sequence - 1;
    run->has_sequence = 1;
    run->sequence = state->sequence;
    return 1;
}

static void note_loss(struct run *run)
{
    run->stats.lost++;
    if (!run->is_lost) {
        run->is_lost = 1;
        run->stats.losses++;
        run->retry_ns = run->now + SECOND;
        run->has_sequence = run->has_host_sample = 0;
    }
    if (!run->loop->def.reopen || run->now < run->retry_ns)
        return;
    run->retry_ns = run->now + SECOND;
    dpt_device_clear(run->loop->device);
}

/* The device gives no force until it takes the next command. */
static void clear_sent(struct run *run)
{
    static const dpt_wrench zero;
    run->sample.sent = zero;
    run->sample.sent_ns = 0;
}

/* Tell the host of a tick that has no sample for it. */
static void call_idle(struct run *run)
{
    run->sample.dt = 0.0;
    if (run->loop->def.idle)
        run->loop->def.idle(run->loop->def.user, &run->sample);
}

/* Call the host with the fresh sample. */
static dpt_result call_host(struct run *run, dpt_wrench *command)
{
    const dpt_loop *loop = run->loop;
    run->sample.dt = loop->period;
    if (run->has_host_sample && run->state.time_ns > run->host_sample_ns)
        run->sample.dt = (double)(run->state.time_ns - run->host_sample_ns) * 1e-9;
    run->has_host_sample = 1;
    run->host_sample_ns = run->state.time_ns;
    const dpt_result result = loop->def.tick(loop->def.user, &run->sample, command);
    run->sample.commands = 0;
    return result;
}

static void send(struct run *run, const dpt_wrench *wrench)
{
    const dpt_result result = dpt_device_write(run->loop->device, wrench);
    if (result == DPT_OK) {
        run->stats.sent++;
        run->sample.commands++;
        run->sample.sent = *wrench;
        run->sample.sent_ns = run->loop->is_deterministic ? run->state.time_ns : run->now;
        return;
    }
    run->stats.refused++;
    if (result == DPT_E_NOT_READY || result == DPT_E_LOST)
        clear_sent(run);
}

/*
 * Read the clock. It stands still while the machine is suspended, so the guard sees no silence: switch it off here. The
 * value of `suspended` may be too small, never too large (clock_read_suspended), so compare it with the largest before.
 */
static dpt_result read_clocks(struct run *run)
{
    int64_t suspended;
    dpt_wrench ignored;
    DPT_TRY(clock_read_suspended(&run->now, &suspended));
    if (suspended > run->suspended_ns + (int64_t)run->loop->period_ns)
        dpt_guard_step(&run->guard, run->now, NULL, 0, &ignored);
    run->suspended_ns = suspended > run->suspended_ns ? suspended : run->suspended_ns;
    return DPT_OK;
}

static dpt_result tick(struct run *run)
{
    dpt_wrench command = { { 0.0 }, { 0.0 } }, wrench;
    dpt_result result = dpt_device_read(run->loop->device, &run->state);
    int is_fresh = result == DPT_OK && accept_sample(run);
    const dpt_device_state *state = &run->state;

    run->stats.ticks++;
    if (run->loop->is_deterministic)
        run->now = is_fresh && state->time_ns > run->now ? state->time_ns
                                                         : run->now + run->loop->period_ns;
    if (result == DPT_E_LOST || state->status == DPT_DEVICE_STATUS_LOST) {
        note_loss(run);
        call_idle(run);
        clear_sent(run);
        dpt_guard_step(&run->guard, run->now, NULL, 0, &wrench);
        return DPT_OK;
    }
    run->stats.reopened += (uint64_t)run->is_lost;
    run->is_lost = 0;
    int is_ready = state->status == DPT_DEVICE_STATUS_READY && pose_is_sound(&state->pose);
    int has_command = 0;
    if (!is_fresh)
        run->stats.stale++;
    else if (!is_ready)
        run->stats.not_ready++;
    if (is_fresh && pose_is_sound(&state->pose)) {
        has_command = call_host(run, &command) == DPT_OK;
        if (is_ready && has_command)
            run->stats.fresh++;
        else if (is_ready)
            run->stats.failed++;
    } else {
        call_idle(run);
    }
    /* Read the clock after the host: a command counts from its arrival, so one that took long begins a new ramp. */
    if (!run->loop->is_deterministic)
        DPT_TRY(read_clocks(run));
    dpt_guard_step(&run->guard, run->now, has_command ? &command : NULL, is_ready, &wrench);
    if (state->status == DPT_DEVICE_STATUS_READY)
        send(run, &wrench);
    else
        clear_sent(run);
    return DPT_OK;
}

static int has_ended(const struct run *run)
{
    const dpt_loop *loop = run->loop;
    return must_stop(loop) || (loop->def.ticks && run->stats.ticks >= loop->def.ticks) ||
           (run->is_lost && !loop->def.reopen);
}

static void note_time(double *max_seconds, uint64_t *bins, uint64_t ns)
{
    *max_seconds = max_of(*max_seconds, (double)ns * 1e-9);
    bins[bin_index(ns)]++;
}

/*
 * The phase of the deadlines relative to the device's samples. A sample's age at the deadline is delay in the hand's
 * loop, so deadlines follow the samples as closely as possible. The smallest age over a window of ticks is held at
 * target_age. A tick without a fresh sample shows that its deadline was too early: the deadlines move back, and
 * target_age grows for a while.
 */
struct phase {
    int64_t target_age;         /* ns */
    int64_t min_age;            /* of this window's samples, ns */
    uint32_t ticks;             /* in this window */
    uint32_t ticks_since_stale; /* since the last tick without a fresh sample */
};

enum { PHASE_TICKS = 32, PHASE_SHRINK_TICKS = 8192 };

static void phase_start_window(struct phase *phase, int64_t period)
{
    phase->min_age = period;
    phase->ticks = 0;
}

static int64_t phase_stale(struct phase *phase, int64_t period)
{
    const int64_t shift =
        phase->ticks_since_stale ? period / 16 : 0; /* but no more while samples are missing */
    if (phase->ticks_since_stale >= PHASE_TICKS && phase->target_age < period / 2)
        phase->target_age += period / 16;
    phase->ticks_since_stale = 0;
    phase_start_window(phase, period);
    return shift;
}

/* Returns by how much to move the deadlines after a tick whose sample had this age, ns. */
static int64_t phase_fresh(struct phase *phase, int64_t period, int64_t age)
{
    const int64_t step = period / 16;
    if (++phase->ticks_since_stale % PHASE_SHRINK_TICKS == 0 && phase->target_age > period / 8)
        phase->target_age -= step;
    phase->min_age = age < phase->min_age ? age : phase->min_age;
    const int64_t shift = phase->target_age - phase->min_age;
    const int is_far = age < phase->target_age / 2 || age > 3 * (period / 4);
    if (++phase->ticks < PHASE_TICKS && !is_far)
        return 0;
    phase_start_window(phase, period);
    return is_far          ? (age < period / 2 ? step : -step)
           : shift > step  ? step
           : shift < -step ? -step
                           : shift;
}

static int64_t phase_shift(struct run *run, struct phase *phase, int is_stale, uint64_t deadline)
{
    const int64_t period = (int64_t)run->loop->period_ns;
    const int64_t age = (int64_t)(deadline - run->state.time_ns);
    if (run->loop->def.rate != 0.0 || run->is_lost)
        return 0;
    if (is_stale)
        return phase_stale(phase, period);
    return age > -period && age < period ? phase_fresh(phase, period, age) : 0;
}

static dpt_result run_by_clock(struct run *run)
{
    uint64_t period = run->loop->period_ns, deadline, begin, end;
    struct phase phase = { .target_age = (int64_t)period / 8, .min_age = (int64_t)period };
    DPT_TRY(clock_read_suspended(&deadline, &run->suspended_ns));
    while (!has_ended(run)) {
        DPT_TRY(sleep_until(run->loop, deadline));
        if (must_stop(run->loop))
            break;
        DPT_TRY(clock_read(&begin));
        const uint64_t late = begin > deadline ? begin - deadline : 0;
        note_time(&run->stats.late_max, run->stats.late, late);
        run->sample.late = (double)late * 1e-9;
        run->now = begin;
        const uint64_t stale_before = run->stats.stale;
        DPT_TRY(tick(run));
        DPT_TRY(clock_read(&end));
        note_time(&run->stats.took_max, run->stats.took, end > begin ? end - begin : 0);
        deadline +=
            period + (uint64_t)phase_shift(run, &phase, run->stats.stale != stale_before, deadline);
        if (end < deadline)
            continue;
        uint64_t missed = (end - deadline) / period + 1;
        run->stats.missed += missed;
        deadline += missed * period;
    }
    return DPT_OK;
}

static dpt_result run_by_device(struct run *run)
{
    while (!has_ended(run))
        DPT_TRY(tick(run));
    return DPT_OK;
}

/* Send zero force. If the line has no room, try again: it may have room a little later. */
static dpt_result send_zero(struct run *run)
{
    static const dpt_wrench zero;
    dpt_loop *loop = run->loop;
    const struct timespec period = { .tv_sec = (time_t)(loop->period_ns / SECOND),
                                     .tv_nsec = (long)(loop->period_ns % SECOND) };
    dpt_result result = dpt_device_write(loop->device, &zero);
    for (int i = 1; i < ZERO_WRITES_MAX && result == DPT_E_BUSY; i++) {
        if (loop->is_deterministic)
            dpt_device_read(loop->device, &run->state);
        else
            nanosleep(&period, NULL);
        result = dpt_device_write(loop->device, &zero);
    }
    return result;
}

dpt_result dpt_loop_run(dpt_loop *loop, dpt_loop_stats *stats)
{
    if (!loop)
        return DPT_E_ARGUMENT;
    if (stats)
        DPT_TRY(sized_check(stats, sizeof *stats, 0));
    struct urgent saved;
    struct run run = { .loop = loop };
    run.stats.size = sizeof run.stats;
    run.state.size = sizeof run.state;
    run.guard.size = sizeof run.guard;
    run.sample.size = sizeof run.sample;
    run.sample.state = &run.state;
    run.sample.info = &loop->info;
    dpt_guard_init(&run.guard, &loop->guard);

    if (!loop->is_deterministic)
        run.stats.notes = urgent_begin(&saved, loop->def.priority, loop->def.lock, loop->def.cpu,
                                       loop->def.awake);
    dpt_result result = loop->is_deterministic ? run_by_device(&run) : run_by_clock(&run);
    dpt_result zero_result = send_zero(&run);
    if (!loop->is_deterministic)
        run.stats.notes |= urgent_end(&saved);

    dpt_guard_info guard = { .size = sizeof guard };
    dpt_guard_get_info(&run.guard, &guard);
    run.stats.stops = guard.stops;
    run.stats.clamped = guard.clamped;
    run.stats.slewed = guard.slewed;
    run.stats.not_finite = guard.not_finite;
    if (stats)
        sized_write(stats, stats->size, &run.stats, sizeof run.stats);
    __atomic_store_n(&loop->stop, 0, __ATOMIC_RELAXED);
    if (result != DPT_OK)
        return result;
    return run.is_lost ? DPT_E_LOST : zero_result;
}
