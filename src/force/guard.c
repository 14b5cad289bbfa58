/* SPDX-License-Identifier: BSD-3-Clause */
/* The guard (guard.h): limits, a ramp up at the start, a ramp down in silence. */
#include <string.h>

#include "base/return_if_error.h"
#include "base/sized.h"
#include "base/wrench_limit.h"
#include "dynpoint/guard.h"

/*
 * The content of a dpt_guard. It is copied out of and back into the opaque bytes, which are an object of another
 * type.
 */
struct guard {
    uint64_t mark; /* GUARD_MARK once it is initialised */
    uint64_t stops, clamped, slewed, not_finite;
    uint64_t hold_ns, stop_ns, now_ns, fresh_ns;
    uint32_t state, reserved;
    double force_max, torque_max, force_slew, torque_slew, start_time;
    double gain;
    double stop_gain;       /* the gain at the start of the ramp to zero */
    dpt_wrench command;     /* the newest one, clamped */
    dpt_wrench stop_wrench; /* the wrench at the start of the ramp to zero */
    dpt_wrench sent;
};

typedef char guard_fits[sizeof(struct guard) <= sizeof((dpt_guard *)0)->opaque ? 1 : -1];

/* Memory that was not initialised holds this by chance only, once in 2^64. */
static const uint64_t GUARD_MARK = 0x6775617264206f6eu;

static int load(const dpt_guard *from, struct guard *guard)
{
    if (!from || sized_check(from, sizeof *from, 0) != DPT_OK)
        return 0;
    memcpy(guard, from->opaque, sizeof *guard);
    return guard->mark == GUARD_MARK;
}

static void store(const struct guard *guard, dpt_guard *to)
{
    memcpy(to->opaque, guard, sizeof *guard);
}

void dpt_guard_def_defaults(dpt_guard_def *def, size_t size)
{
    const dpt_guard_def defaults = {
        .force_max = 5.0,
        .torque_max = 0.2,
        .force_slew = 2000.0,
        .torque_slew = 80.0,
        .hold = 0.003,
        .stop = 0.002,
        .start = 0.1,
    };
    sized_defaults(def, size, &defaults, sizeof defaults);
}

static int in_range(double value, double max_change)
{
    return value >= 0.0 && value <= max_change;
}

static int def_is_valid(const dpt_guard_def *def)
{
    return in_range(def->force_max, 1000.0) && in_range(def->torque_max, 1000.0) &&
           in_range(def->force_slew, DBL_MAX) && in_range(def->torque_slew, DBL_MAX) && in_range(def->hold, 10.0) &&
           in_range(def->stop, 10.0) && in_range(def->start, 100.0) && !def->reserved;
}

dpt_result dpt_guard_init(dpt_guard *to, const dpt_guard_def *given)
{
    dpt_guard_def def;
    if (!to)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(to, sizeof *to, 0));
    const uint32_t size = to->size;
    memset(to, 0, size);
    dpt_guard_def_init(&def);
    if (given)
        DPT_TRY(sized_read(given, sizeof *given, &def, sizeof def));
    if (!def_is_valid(&def))
        return DPT_E_ARGUMENT;
    const struct guard guard = {
        .mark = GUARD_MARK,
        .hold_ns = (uint64_t)(def.hold * 1e9 + 0.5),
        .stop_ns = (uint64_t)(def.stop * 1e9 + 0.5),
        .force_max = def.force_max,
        .torque_max = def.torque_max,
        .force_slew = def.force_slew,
        .torque_slew = def.torque_slew,
        .start_time = def.start,
    };
    to->size = size;
    store(&guard, to);
    return DPT_OK;
}

dpt_result dpt_guard_get_info(const dpt_guard *from, dpt_guard_info *info)
{
    struct guard guard;
    dpt_guard_info own = { .size = sizeof own };
    if (!info)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(info, sizeof *info, 0));
    const int is_made = load(from, &guard);
    if (is_made) {
        own.state = guard.state;
        own.stops = guard.stops;
        own.clamped = guard.clamped;
        own.slewed = guard.slewed;
        own.not_finite = guard.not_finite;
        own.now_ns = guard.now_ns;
        own.fresh_ns = guard.fresh_ns;
        own.gain = guard.gain;
        own.command = guard.command;
        own.sent = guard.sent;
    }
    sized_write(info, info->size, &own, sizeof own);
    return is_made ? DPT_OK : DPT_E_ARGUMENT;
}

static int is_on(const struct guard *guard)
{
    return guard->state == DPT_GUARD_STARTING || guard->state == DPT_GUARD_RUNNING;
}

static void go_off(struct guard *guard)
{
    guard->stops += (uint64_t)is_on(guard);
    guard->state = DPT_GUARD_OFF;
    guard->gain = 0.0;
    memset(&guard->sent, 0, sizeof guard->sent);
}

/* The ramp to zero depends on the length of the silence alone, not on how often the guard was stepped. */
static void watch_silence(struct guard *guard)
{
    uint64_t silence = guard->now_ns - guard->fresh_ns;
    if (is_on(guard) && silence > guard->hold_ns) {
        guard->stops++;
        guard->state = DPT_GUARD_STOPPING;
        guard->stop_wrench = guard->sent;
        guard->stop_gain = guard->gain;
    }
    if (guard->state != DPT_GUARD_STOPPING)
        return;
    if (silence >= guard->hold_ns + guard->stop_ns) {
        go_off(guard);
        return;
    }
    double left = (double)(guard->hold_ns + guard->stop_ns - silence) / (double)guard->stop_ns;
    guard->gain = guard->stop_gain * left;
    vec3_store(scaled(vec3_of(guard->stop_wrench.force), left), guard->sent.force);
    vec3_store(scaled(vec3_of(guard->stop_wrench.torque), left), guard->sent.torque);
}

static void accept(struct guard *guard, const dpt_wrench *command)
{
    guard->fresh_ns = guard->now_ns;
    guard->command = *command;
    int clamped = limit_length(guard->command.force, guard->force_max);
    clamped |= limit_length(guard->command.torque, guard->torque_max);
    guard->clamped += (uint64_t)clamped;
    if (!is_on(guard))
        guard->state = DPT_GUARD_STARTING;
}

static void ramp_up(struct guard *guard, double dt)
{
    guard->gain = guard->start_time > 0.0 ? guard->gain + dt / guard->start_time : 1.0;
    if (guard->gain < 1.0)
        return;
    guard->gain = 1.0;
    guard->state = DPT_GUARD_RUNNING;
}

/*
 * Move `sent` towards gain * command, by at most max_change if is_limited, up to `limit` in length. 1 if max_change
 * limited it.
 */
static int slew_towards(double *sent, const double *command, double gain, double max_change, int is_limited,
                        double limit)
{
    double change[3];
    vec3_store(sub(scaled(vec3_of(command), gain), vec3_of(sent)), change);
    int slewed = is_limited && limit_length(change, max_change);
    vec3_store(add(vec3_of(sent), vec3_of(change)), sent);
    limit_length(sent, limit);
    return slewed;
}

static void advance(struct guard *guard, double dt)
{
    int slewed = slew_towards(guard->sent.force, guard->command.force, guard->gain, guard->force_slew * dt,
                              guard->force_slew > 0.0, guard->force_max);
    slewed |= slew_towards(guard->sent.torque, guard->command.torque, guard->gain, guard->torque_slew * dt,
                           guard->torque_slew > 0.0, guard->torque_max);
    guard->slewed += (uint64_t)slewed;
}

/* One step of an initialised guard. `sent` is then what leaves the guard; all zeros if it is off. */
static void step(struct guard *guard, uint64_t now_ns, const dpt_wrench *command, int ready)
{
    double dt = 0.0;
    if (now_ns > guard->now_ns) {
        dt = (double)(now_ns - guard->now_ns) * 1e-9;
        guard->now_ns = now_ns;
    }
    watch_silence(guard);
    if (command && !wrench_is_finite(command)) {
        guard->not_finite++;
        ready = 0;
    }
    if (!ready) {
        go_off(guard);
        return;
    }
    if (guard->state == DPT_GUARD_OFF)
        dt = 0.0;
    if (guard->state == DPT_GUARD_STARTING)
        ramp_up(guard, dt);
    if (command)
        accept(guard, command);
    if (guard->state == DPT_GUARD_STARTING && guard->start_time == 0.0)
        ramp_up(guard, 0.0);
    if (is_on(guard))
        advance(guard, dt);
}

void dpt_guard_step(dpt_guard *at, uint64_t now_ns, const dpt_wrench *command, int ready, dpt_wrench *out)
{
    struct guard guard;
    if (out)
        memset(out, 0, sizeof *out);
    if (!load(at, &guard))
        return;
    step(&guard, now_ns, command, ready);
    store(&guard, at);
    if (out)
        *out = guard.sent;
}
