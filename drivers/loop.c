/* SPDX-License-Identifier: BSD-3-Clause */
/* The servo loop (loop.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "base/sized.h"
#include "base/vec3.h"
#include "dynpoint/loop.h"
#include "loop_line.h"
#include "platform/clock.h"
#include "platform/urgent.h"

enum { ZERO_WRITES_MAX = 10 };

enum { LINES_MAX = 2 };

struct dpt_loop {
    struct loop_line_def lines[LINES_MAX]; /* the first one's samples set the pace */
    int line_count;
    dpt_loop_def def;     /* its guards are NULL: the lines have their content */
    double period;        /* s */
    uint64_t period_ns;   /* the same in ns */
    int is_deterministic; /* the devices' time passes by reads */
    int stop;             /* set by dpt_loop_stop, read atomically */
};

/* The state of one run. */
struct run {
    struct dpt_loop *loop;
    struct loop_line lines[LINES_MAX];
    uint64_t now;         /* ns, of the monotonic clock, or the time of a deterministic device */
    int64_t suspended_ns; /* how long the machine was suspended since boot: the largest value read */
};

void dpt_loop_def_defaults(dpt_loop_def *def, size_t size)
{
    const dpt_loop_def defaults = { .priority = 80, .lock = 1 };
    sized_defaults(def, size, &defaults, sizeof defaults);
}

static int is_deterministic(const struct loop_line_def *line)
{
    return (line->info.flags & DPT_DEVICE_FLAG_DETERMINISTIC) != 0;
}

/* Another device goes by the same clock. */
static dpt_result open_lines(struct dpt_loop *loop, dpt_device *device)
{
    const dpt_loop_def *def = &loop->def;
    DPT_TRY(loop_line_open(&loop->lines[0], device, def->guard, loop->period_ns));
    loop->line_count = 1;
    loop->is_deterministic = is_deterministic(&loop->lines[0]);
    if (!def->other)
        return def->other_guard ? DPT_E_ARGUMENT : DPT_OK;
    DPT_TRY(loop_line_open(&loop->lines[1], def->other, def->other_guard, loop->period_ns));
    loop->line_count = 2;
    return def->other == device || is_deterministic(&loop->lines[1]) != loop->is_deterministic ? DPT_E_ARGUMENT
                                                                                               : DPT_OK;
}

dpt_result dpt_loop_open(dpt_device *device, const dpt_loop_def *given, dpt_loop **out)
{
    dpt_loop loop = { .stop = 0 };
    dpt_device_info info = { .size = sizeof info };
    if (out)
        *out = NULL;
    if (!device || !given || !out)
        return DPT_E_ARGUMENT;
    dpt_loop_def_init(&loop.def);
    DPT_TRY(sized_read(given, sizeof loop.def, &loop.def, sizeof loop.def));
    DPT_TRY(dpt_device_get_info(device, &info));
    const double rate = loop.def.rate != 0.0 ? loop.def.rate : info.rate;
    if (!loop.def.tick || loop.def.reserved_pointer || loop.def.reserved_pointer_2 || loop.def.priority > 99 ||
        loop.def.lock > 1 || loop.def.reopen > 1 || loop.def.awake > 1 || !(rate >= 1.0 && rate <= 100000.0))
        return DPT_E_ARGUMENT;
    loop.period = 1.0 / rate;
    loop.period_ns = (uint64_t)(1e9 / rate + 0.5);
    DPT_TRY(open_lines(&loop, device));
    loop.def.guard = loop.def.other_guard = NULL;
    *out = malloc(sizeof loop);
    if (!*out)
        return DPT_E_MEMORY;
    **out = loop;
    return DPT_OK;
}

void dpt_loop_close(dpt_loop *loop)
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

static dpt_result sleep_until(const dpt_loop *loop, const struct clock_timer *timer, uint64_t deadline)
{
    int ended;
    do
        ended = clock_timer_wait(timer, deadline);
    while (ended > 0 && !must_stop(loop));
    return ended < 0 ? DPT_E_SYSTEM : DPT_OK;
}

static const double quarter_powers[4] = { 1.0, 1.189207115002721, 1.4142135623730951, 1.681792830507429 };

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

/*
 * Read the clock. It stands still while the machine is suspended, so the guard sees no silence: switch it off here. The
 * value of `suspended` may be too small, never too large (clock_read_suspended), so compare it with the largest before.
 */
static dpt_result read_clocks(struct run *run)
{
    int64_t suspended;
    DPT_TRY(clock_read_suspended(&run->now, &suspended));
    if (suspended > run->suspended_ns + (int64_t)run->loop->period_ns)
        for (int i = 0; i < run->loop->line_count; i++)
            loop_line_stop(&run->lines[i], run->now);
    run->suspended_ns = suspended > run->suspended_ns ? suspended : run->suspended_ns;
    return DPT_OK;
}

/* Read all devices. Returns how many are there. */
static int read_lines(struct run *run)
{
    const struct loop_line *first = &run->lines[0];
    int there = 0;
    for (int i = 0; i < run->loop->line_count; i++)
        loop_line_read(&run->lines[i]);
    if (run->loop->is_deterministic)
        run->now =
            first->is_fresh && first->state.time_ns > run->now ? first->state.time_ns : run->now + run->loop->period_ns;
    for (int i = 0; i < run->loop->line_count; i++)
        there += !loop_line_check_loss(&run->lines[i], run->now, (int)run->loop->def.reopen);
    return there;
}

/* The host answers to fresh samples, or hears that there are none. */
static void call_host(struct run *run, dpt_wrench *commands)
{
    const dpt_loop_def *def = &run->loop->def;
    const dpt_loop_sample *sample = &run->lines[0].sample;
    int has_sample = 0, is_answered = 0;
    for (int i = 0; i < run->loop->line_count; i++)
        has_sample |= loop_line_has_sample(&run->lines[i], run->loop->period);
    if (has_sample)
        is_answered = def->tick(def->user, sample, commands) == DPT_OK;
    else if (def->idle)
        def->idle(def->user, sample);
    for (int i = 0; i < run->loop->line_count; i++)
        loop_line_count(&run->lines[i], is_answered);
}

static dpt_result tick(struct run *run)
{
    dpt_wrench commands[LINES_MAX];
    memset(commands, 0, sizeof commands);
    const int there = read_lines(run);
    call_host(run, commands);
    /* Read the clock after the host: a command counts from its arrival, so one that took long begins a new ramp. */
    if (!run->loop->is_deterministic && there > 0)
        DPT_TRY(read_clocks(run));
    for (int i = 0; i < run->loop->line_count; i++)
        loop_line_send(&run->lines[i], &commands[i], run->now,
                       run->loop->is_deterministic ? run->lines[i].state.time_ns : run->now);
    return DPT_OK;
}

static int is_any_lost(const struct run *run)
{
    return run->lines[0].is_lost || (run->loop->line_count > 1 && run->lines[1].is_lost);
}

static int has_ended(const struct run *run)
{
    const dpt_loop *loop = run->loop;
    return must_stop(loop) || (loop->def.ticks && run->lines[0].stats.ticks >= loop->def.ticks) ||
           (is_any_lost(run) && !loop->def.reopen);
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
    const int64_t shift = phase->ticks_since_stale ? period / 16 : 0; /* but no more while samples are missing */
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
    return is_far ? (age < period / 2 ? step : -step) : shift > step ? step : shift < -step ? -step : shift;
}

static int64_t phase_shift(struct run *run, struct phase *phase, int is_stale, uint64_t deadline)
{
    const int64_t period = (int64_t)run->loop->period_ns;
    const int64_t age = (int64_t)(deadline - run->lines[0].state.time_ns);
    if (run->loop->def.rate != 0.0 || run->lines[0].is_lost)
        return 0;
    if (is_stale)
        return phase_stale(phase, period);
    return age > -period && age < period ? phase_fresh(phase, period, age) : 0;
}

static dpt_result run_by_timer(struct run *run, const struct clock_timer *timer)
{
    uint64_t period = run->loop->period_ns, deadline, begin, end;
    dpt_loop_stats *stats = &run->lines[0].stats;
    struct phase phase = { .target_age = (int64_t)period / 8, .min_age = (int64_t)period };
    DPT_TRY(clock_read_suspended(&deadline, &run->suspended_ns));
    while (!has_ended(run)) {
        DPT_TRY(sleep_until(run->loop, timer, deadline));
        if (must_stop(run->loop))
            break;
        DPT_TRY(clock_read(&begin));
        const uint64_t late = begin > deadline ? begin - deadline : 0;
        note_time(&stats->late_max, stats->late, late);
        for (int i = 0; i < run->loop->line_count; i++)
            run->lines[i].sample.late = (double)late * 1e-9;
        run->now = begin;
        const uint64_t stale_before = stats->stale;
        DPT_TRY(tick(run));
        DPT_TRY(clock_read(&end));
        note_time(&stats->took_max, stats->took, end > begin ? end - begin : 0);
        deadline += period + (uint64_t)phase_shift(run, &phase, stats->stale != stale_before, deadline);
        if (end < deadline)
            continue;
        uint64_t missed = (end - deadline) / period + 1;
        stats->missed += missed;
        deadline += missed * period;
    }
    return DPT_OK;
}

static dpt_result run_by_clock(struct run *run)
{
    struct clock_timer timer;
    clock_timer_open(&timer);
    const dpt_result result = run_by_timer(run, &timer);
    clock_timer_close(&timer);
    return result;
}

static dpt_result run_by_device(struct run *run)
{
    while (!has_ended(run))
        DPT_TRY(tick(run));
    return DPT_OK;
}

/* Send zero force. If the line has no room, try again: it may have room a little later. */
static dpt_result send_zero(const struct run *run, int index)
{
    static const dpt_wrench zero;
    const dpt_loop *loop = run->loop;
    dpt_device *device = loop->lines[index].device;
    dpt_device_state ignored = { .size = sizeof ignored };
    dpt_result result = dpt_device_write(device, &zero);
    for (int i = 1; i < ZERO_WRITES_MAX && result == DPT_E_BUSY; i++) {
        if (loop->is_deterministic)
            dpt_device_read(device, &ignored);
        else
            clock_sleep(loop->period_ns);
        result = dpt_device_write(device, &zero);
    }
    return result;
}

/* Of the devices; what is of the whole loop is in the first one's. */
static void write_stats(struct run *run, dpt_loop_stats *stats)
{
    const uint32_t size = stats->size;
    for (int i = 0; i < run->loop->line_count; i++)
        sized_write((unsigned char *)stats + (size_t)i * size, size, &run->lines[i].stats, sizeof run->lines[i].stats);
}

dpt_result dpt_loop_run(dpt_loop *loop, dpt_loop_stats *stats)
{
    if (!loop)
        return DPT_E_ARGUMENT;
    if (stats)
        DPT_TRY(sized_check(stats, sizeof *stats, loop->line_count > 1));
    struct urgent saved;
    struct run run = { .loop = loop };
    uint32_t *notes = &run.lines[0].stats.notes;
    for (int i = 0; i < loop->line_count; i++)
        loop_line_begin(&run.lines[i], &loop->lines[i]);
    if (loop->line_count > 1)
        run.lines[0].sample.other = &run.lines[1].sample;

    if (!loop->is_deterministic)
        *notes = urgent_begin(&saved, loop->def.priority, loop->def.lock, loop->def.cpu, loop->def.awake);
    dpt_result result = loop->is_deterministic ? run_by_device(&run) : run_by_clock(&run);
    for (int i = 0; i < loop->line_count; i++) {
        const dpt_result zero_result = send_zero(&run, i);
        result = result == DPT_OK && !is_any_lost(&run) ? zero_result : result;
    }
    if (!loop->is_deterministic)
        *notes |= urgent_end(&saved);
    for (int i = 0; i < loop->line_count; i++)
        loop_line_end(&run.lines[i]);
    if (stats)
        write_stats(&run, stats);
    __atomic_store_n(&loop->stop, 0, __ATOMIC_RELAXED);
    return result == DPT_OK && is_any_lost(&run) ? DPT_E_LOST : result;
}
