/* SPDX-License-Identifier: BSD-3-Clause */
/* Loops that serve a device with a time of its own for some ticks, whatever the host's tick does. */
#include "dynpoint/loop.h"
#include "fuzz/calls/devices.h"
#include "fuzz/calls/witness.h"

struct host {
    dpt_loop *loop;
    dpt_device *device;
    dpt_device_info info;
    double period;
    uint64_t ticks, idle;
    int stops, clears, is_odd;
};

/* All that a tick is told is what the witness has written down. */
static void sample_must_hold(const struct host *host, const dpt_loop_sample *sample)
{
    HOLDS(sample && sample->size == sizeof *sample && sample->state && sample->info, "no sample");
    HOLDS(!memcmp(sample->info, &host->info, sizeof host->info), "not the device's info");
    HOLDS(witness.is_to_be_seen && sample->state->size == sizeof witness.state &&
              !memcmp(sample->state, &witness.state, sizeof witness.state),
          "not the sample that was read");
    const uint64_t now = witness.state.time_ns;
    double dt = host->period;
    if (witness.has_ticked && now > witness.ticked_ns)
        dt = (double)(now - witness.ticked_ns) * 1e-9;
    HOLDS(sample->dt == dt, "dt %.17g, and not %.17g", sample->dt, dt);
    HOLDS(sample->commands == witness.taken, "%u commands, and not %u", sample->commands, witness.taken);
    HOLDS(!memcmp(&sample->sent, &witness.acts, sizeof witness.acts) && sample->sent_ns == witness.acts_ns,
          "%g N of %llu ns are said to have acted, and not %g N of %llu ns", sample->sent.force[0],
          (unsigned long long)sample->sent_ns, witness.acts.force[0], (unsigned long long)witness.acts_ns);
    met[MET_SENT] += witness.acts.force[0] != 0.0;
    game_digest(&sample->sent, sizeof sample->sent);
}

static dpt_result tick(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    struct host *host = user;
    host->ticks++;
    sample_must_hold(host, sample);
    witness.is_to_be_seen = 0;
    witness.has_ticked = 1;
    witness.ticked_ns = sample->state->time_ns;
    witness.taken = 0;
    for (int k = 0; k < 3; k++)
        HOLDS(wrench->force[k] == 0.0 && wrench->torque[k] == 0.0, "a wrench before the call");
    for (int k = 0; k < 3; k++) {
        wrench->force[k] = draw_in(-20.0, 20.0);
        wrench->torque[k] = draw_in(-1.0, 1.0);
    }
    if (host->is_odd && draw_one_in(4))
        wrench->force[draw_below(3)] = draw_odd_number();
    if (host->stops && draw_one_in(6))
        CALL(dpt_loop_stop, host->loop);
    if (host->clears && draw_one_in(4))
        RESULT(dpt_device_clear, host->device);
    return host->is_odd && draw_one_in(4) ? DPT_E_FINITE : DPT_OK;
}

/* What is read is told to the one or to the other. */
static void idle(void *user, const dpt_loop_sample *sample)
{
    struct host *host = user;
    host->idle++;
    HOLDS(sample && sample->size == sizeof *sample && sample->state && sample->info, "no sample");
    HOLDS(sample->dt == 0.0 && sample->late == 0.0, "%g s, late by %g s", sample->dt, sample->late);
    numbers_are_finite(sample->sent.force, 6, "what acted");
}

enum { GUARD_SLOT = 2, DEF_SLOT = 3 };

/* NULL, or one whose limits may be wrong; `guard` is what it comes to. */
static const dpt_guard_def *draw_guard(dpt_guard_def *guard, struct codes *codes)
{
    CALL(dpt_guard_def_defaults, guard, sizeof *guard);
    if (draw_one_in(3))
        return NULL;
    double *most[] = { &guard->force_max, &guard->torque_max };
    double *times[] = { &guard->hold, &guard->stop, &guard->start };
    for (int i = 0; i < 2; i++)
        if (draw_one_in(2))
            *most[i] = draw_one_in(4) ? 0.0 : draw_in(0.0, 20.0);
    for (int i = 0; i < 3; i++)
        if (draw_one_in(3))
            *times[i] = draw_one_in(2) ? draw_in(0.0, 0.01) : draw_in(0.0, 2.0);
    if (draw_one_in(12))
        guard->force_slew = draw_one_in(2) ? 0.0 : -1.0;
    if (draw_one_in(20))
        *times[draw_below(3)] = draw_one_in(2) ? NAN : 101.0;
    guard->reserved = draw_one_in(40) ? 1u : 0u;
    int is_wrong = guard->reserved || !(guard->force_slew >= 0.0) || !(guard->start <= 100.0);
    for (int i = 0; i < 2; i++)
        is_wrong |= !(*times[i] <= 10.0);
    may_fail(codes, is_wrong, DPT_E_ARGUMENT);
    return draw_input(GUARD_SLOT, guard, draw_size(sizeof *guard, sizeof *guard), sizeof *guard, sizeof *guard, codes);
}

/* What is handed over, and what it means. */
static const void *draw_def(struct host *host, dpt_loop_def *def, struct codes *codes)
{
    dpt_guard_def guard;
    CALL(dpt_loop_def_defaults, def, sizeof *def);
    def->tick = draw_one_in(24) ? NULL : tick;
    def->user = host;
    def->idle = draw_one_in(2) ? idle : NULL;
    def->ticks = 1 + draw_below(24);
    def->reopen = draw_below(2);
    def->priority = draw_one_in(24) ? 100 : draw_below(100);
    def->reserved_pointer = draw_one_in(40) ? def : NULL;
    def->reserved_pointer_2 = draw_one_in(80) ? def : NULL;
    def->awake = draw_one_in(40) ? 2u : 0u;
    if (draw_one_in(12))
        def->rate = draw_one_in(3) ? NAN : draw_one_in(2) ? 2e5 : draw_in(400.0, 2000.0);
    const double rate = def->rate != 0.0 ? def->rate : host->info.rate;
    def->guard = draw_guard(&guard, codes);
    may_fail(codes,
             !def->tick || def->priority > 99 || def->reserved_pointer || def->reserved_pointer_2 || def->awake > 1 ||
                 !(rate >= 1.0 && rate <= 1e5),
             DPT_E_ARGUMENT);
    /* A command that does not count until the next tick; it may be a matter of rounding. */
    host->period = 1.0 / rate;
    may_fail(codes, guard.hold < host->period - 2e-9, DPT_E_ARGUMENT);
    codes->or_done = !codes->count && guard.hold < host->period + 2e-9;
    may_fail(codes, codes->or_done, DPT_E_ARGUMENT);
    witness.force_max = host->info.wrench_dofs < 3 ? 0.0 : fmin(guard.force_max, host->info.force_max);
    witness.torque_max = host->info.wrench_dofs < 6 ? 0.0 : fmin(guard.torque_max, host->info.torque_max);
    const int was_done = codes->or_done;
    const void *given = draw_input(DEF_SLOT, def, draw_size(sizeof *def, sizeof *def), sizeof *def, sizeof *def, codes);
    if (was_done && codes->count > 1)
        codes->or_done = 0;
    return given;
}

static void stats_must_hold(const dpt_loop_stats *stats, const dpt_loop_def *def, const struct host *host)
{
    HOLDS(stats->ticks <= def->ticks, "%llu ticks of %llu", (unsigned long long)stats->ticks,
          (unsigned long long)def->ticks);
    HOLDS(stats->fresh + stats->failed + stats->stale + stats->not_ready + stats->lost == stats->ticks,
          "%llu ticks are not all told", (unsigned long long)stats->ticks);
    HOLDS(stats->fresh + stats->failed <= host->ticks && host->ticks <= stats->ticks, "the host ticked %llu times",
          (unsigned long long)host->ticks);
    HOLDS(host->idle == (def->idle ? stats->ticks - host->ticks : 0), "%llu ticks without a sample",
          (unsigned long long)host->idle);
    /* At the end up to ten commands of zero, the last of which may be taken. */
    const uint64_t commands = stats->sent + stats->refused;
    HOLDS(commands < witness.writes && commands + 10 >= witness.writes &&
              stats->sent + (witness.last_result == DPT_OK) == witness.written,
          "%llu sent, %llu refused, of %llu, %llu of which the device took", (unsigned long long)stats->sent,
          (unsigned long long)stats->refused, (unsigned long long)witness.writes, (unsigned long long)witness.written);
    HOLDS(witness.unseen < witness.writes - commands, "%llu samples were not shown",
          (unsigned long long)witness.unseen);
    HOLDS(stats->lost <= witness.lost && stats->losses <= stats->lost && stats->reopened <= stats->losses &&
              stats->reordered <= stats->stale,
          "lost %llu times, %llu ticks, back %llu times", (unsigned long long)stats->losses,
          (unsigned long long)stats->lost, (unsigned long long)stats->reopened);
    HOLDS(stats->stops <= stats->ticks && stats->clamped <= host->ticks && stats->not_finite <= host->ticks &&
              stats->slewed <= stats->ticks,
          "the guard counts more than there was");
    HOLDS(stats->late_max == 0.0 && stats->took_max == 0.0 && !stats->notes && !stats->missed, "nothing is late here");
    const double time = CALL(dpt_loop_quantile, stats->took, draw_in(0.0, 1.0));
    HOLDS(isfinite(time) && time >= 0.0, "%g s", time);
}

static void run_it(struct host *host, const dpt_loop_def *def)
{
    struct codes codes = { .count = 0 };
    dpt_loop_stats now;
    const uint32_t size = draw_size(sizeof now, sizeof now);
    const int no_stats = draw_one_in(4);
    void *stats = output_sized(0, size);
    if (draw_one_in(8))
        CALL(dpt_loop_stop, host->loop);
    if (!no_stats)
        size_codes_of_output(size, sizeof now, 0, &codes);
    const int is_refused = codes.count > 0;
    const dpt_result result = RESULT(dpt_loop_run, host->loop, no_stats ? NULL : stats);
    outputs_are_guarded(0, 1);
    if (is_refused) {
        expect(result, &codes);
        HOLDS(output_is_untouched(0, sizeof size) && !witness.reads, "it ran, and was refused");
        return;
    }
    const dpt_wrench zero = { { 0.0 }, { 0.0 } };
    HOLDS(witness.writes > 0 && !memcmp(&witness.last, &zero, sizeof zero), "it did not end with zero force");
    HOLDS(result == witness.last_result || (result == DPT_E_LOST && witness.lost), "%s, and not %s",
          dpt_result_name(result), dpt_result_name(witness.last_result));
    if (!no_stats && output_read(0, size, sizeof now, sizeof now, &now))
        stats_must_hold(&now, def, host);
}

static void run_loop(void)
{
    struct host host = { .stops = draw_one_in(3),
                         .clears = draw_one_in(3),
                         .is_odd = draw_one_in(2),
                         .info = { .size = sizeof host.info } };
    struct codes codes = { .count = 0 };
    dpt_loop_def def;
    const char *name = draw_device_name();
    HOLDS(RESULT(dpt_device_open_with, &witness_driver, name, &host.device, NULL) == DPT_OK, "%s", name);
    RESULT(dpt_device_get_info, host.device, &host.info);
    witness.is_clumsy = draw_one_in(2);
    witness.is_deaf = draw_one_in(20);
    const void *given = draw_def(&host, &def, &codes);
    const int no_device = draw_one_in(30), no_loop = draw_one_in(30), no_def = draw_one_in(30);
    if (no_device || no_loop || no_def)
        codes.or_done = 0;
    may_fail(&codes, no_device || no_loop || no_def, DPT_E_ARGUMENT);
    const dpt_result result =
        RESULT(dpt_loop_open, no_device ? NULL : host.device, no_def ? NULL : given, no_loop ? NULL : &host.loop);
    expect(result, &codes);
    outputs_are_guarded(GUARD_SLOT, 2);
    HOLDS((result == DPT_OK) == (host.loop != NULL), "%s", dpt_result_name(result));
    if (host.loop) {
        /* It has read the guard's def. */
        output_of(GUARD_SLOT, sizeof(dpt_guard_def));
        run_it(&host, &def);
    }
    CALL(dpt_loop_close, host.loop);
    CALL(dpt_device_close, host.device);
}

static void refuse_null(void)
{
    dpt_loop *loop;
    CALL(dpt_loop_close, NULL);
    CALL(dpt_loop_stop, NULL);
    HOLDS(RESULT(dpt_loop_run, NULL, NULL) == DPT_E_ARGUMENT, "no loop");
    HOLDS(RESULT(dpt_loop_open, NULL, NULL, &loop) == DPT_E_ARGUMENT && !loop, "no device");
    const double time = CALL(dpt_loop_quantile, NULL, draw_odd_number());
    HOLDS(time == 0.0, "%g s of nothing", time);
}

static void defaults(void)
{
    dpt_loop_def whole;
    const uint32_t size = draw_size(sizeof whole, sizeof whole);
    const int is_null = draw_one_in(20);
    void *out = output_of_defaults(0, size);
    CALL(dpt_loop_def_defaults, is_null ? NULL : out, size);
    CALL(dpt_loop_def_defaults, &whole, sizeof whole);
    defaults_must_hold(0, size, is_null, &whole, sizeof whole);
}

static const struct move moves[] = {
    { "run", run_loop, 4 }, { "refuse NULL", refuse_null, 1 }, { "defaults", defaults, 1 }, { NULL, NULL, 0 }
};

const struct noun loop_noun = { "loop", NULL, NULL, moves };
