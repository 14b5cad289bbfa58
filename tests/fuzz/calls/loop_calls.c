/* SPDX-License-Identifier: BSD-3-Clause */
/* Loops that serve a device with a time of its own for some ticks, whatever the host's tick does. */
#include "dynpoint/loop.h"
#include "fuzz/calls/devices.h"

struct host {
    dpt_loop *loop;
    dpt_device *device;
    uint64_t ticks;
    int stops, clears, is_odd;
};

static dpt_result tick(void *user, const dpt_device_state *state, double dt, dpt_wrench *wrench)
{
    struct host *host = user;
    host->ticks++;
    HOLDS(state && isfinite(dt) && dt > 0.0, "dt %g", dt);
    for (int k = 0; k < 3; k++)
        HOLDS(wrench->force[k] == 0.0 && wrench->torque[k] == 0.0, "a wrench before the call");
    for (int k = 0; k < 3; k++)
        wrench->force[k] = draw_in(-20.0, 20.0);
    if (host->is_odd && draw_one_in(4))
        wrench->force[draw_below(3)] = draw_odd_number();
    if (host->stops && draw_one_in(6))
        CALL(dpt_loop_stop, host->loop);
    if (host->clears && draw_one_in(4))
        RESULT(dpt_device_clear, host->device);
    return host->is_odd && draw_one_in(4) ? DPT_E_FINITE : DPT_OK;
}

static void draw_def(dpt_loop_def *def, struct host *host, struct codes *codes)
{
    CALL(dpt_loop_def_defaults, def, sizeof *def);
    def->tick = tick;
    def->user = host;
    def->ticks = 1 + draw_below(24);
    def->reopen = draw_below(2);
    if (draw_one_in(12))
        def->tick = NULL;
    if (draw_one_in(12))
        def->priority = 100;
    if (draw_one_in(12))
        def->rate = draw_one_in(2) ? NAN : 2e5;
    may_fail(codes, !def->tick || def->priority > 99 || def->rate != 0.0, DPT_E_ARGUMENT);
}

static void stats_must_hold(const dpt_loop_stats *stats, const dpt_loop_def *def,
                            const struct host *host)
{
    HOLDS(stats->ticks <= def->ticks, "%llu ticks of %llu", (unsigned long long)stats->ticks,
          (unsigned long long)def->ticks);
    HOLDS(stats->fresh + stats->failed + stats->stale + stats->not_ready + stats->lost ==
              stats->ticks,
          "%llu ticks are not all told", (unsigned long long)stats->ticks);
    HOLDS(stats->fresh + stats->failed <= host->ticks && host->ticks <= stats->ticks,
          "the host ticked %llu times", (unsigned long long)host->ticks);
    HOLDS(stats->late_max == 0.0 && stats->took_max == 0.0, "nothing is late here");
    const double time = CALL(dpt_loop_quantile, stats->took, draw_in(0.0, 1.0));
    HOLDS(isfinite(time) && time >= 0.0, "%g s", time);
}

static void run_loop(void)
{
    struct host host = { .stops = draw_one_in(3),
                         .clears = draw_one_in(3),
                         .is_odd = draw_one_in(2) };
    struct codes codes = { .count = 0 }, of_run = { .count = 0 };
    dpt_loop_def def;
    dpt_loop_stats *stats = output_of(0, sizeof *stats);
    const char *name = draw_device_name();
    HOLDS(RESULT(dpt_device_open, name, &host.device, NULL) == DPT_OK, "%s", name);
    draw_def(&def, &host, &codes);
    if (draw_one_in(20)) {
        def.size = 8;
        may_fail(&codes, 1, DPT_E_SIZE);
    }
    /* At 1 Hz a command does not count until the next tick. */
    may_fail(&codes, strstr(name, "rate=1&") != NULL, DPT_E_ARGUMENT);
    const int no_device = draw_one_in(30), no_loop = draw_one_in(30);
    may_fail(&codes, no_device || no_loop, DPT_E_ARGUMENT);
    if (strncmp(name, "replay", 6) == 0) {
        codes.or_done = !codes.count; /* so it may be with its rate */
        may_fail(&codes, 1, DPT_E_ARGUMENT);
    }
    const dpt_result result =
        RESULT(dpt_loop_create, no_device ? NULL : host.device, &def, no_loop ? NULL : &host.loop);
    expect(result, &codes);
    HOLDS((result == DPT_OK) == (host.loop != NULL), "%s", dpt_result_name(result));
    if (host.loop) {
        const int no_stats = draw_one_in(4);
        stats->size = sizeof *stats;
        if (draw_one_in(30))
            stats->size = 8;
        if (draw_one_in(8))
            CALL(dpt_loop_stop, host.loop);
        may_fail(&of_run, !no_stats && stats->size != sizeof *stats, DPT_E_SIZE);
        of_run.or_done = !of_run.count;
        may_fail(&of_run, of_run.or_done, DPT_E_LOST);
        may_fail(&of_run, of_run.or_done, DPT_E_NOT_READY);
        const dpt_result ran = RESULT(dpt_loop_run, host.loop, no_stats ? NULL : stats);
        expect(ran, &of_run);
        outputs_are_guarded(0, 1);
        if (!no_stats && ran != DPT_E_SIZE)
            stats_must_hold(stats, &def, &host);
    }
    CALL(dpt_loop_free, host.loop);
    CALL(dpt_device_close, host.device);
}

static void refuse_null(void)
{
    dpt_loop *loop;
    CALL(dpt_loop_free, NULL);
    CALL(dpt_loop_stop, NULL);
    HOLDS(RESULT(dpt_loop_run, NULL, NULL) == DPT_E_ARGUMENT, "no loop");
    HOLDS(RESULT(dpt_loop_create, NULL, NULL, &loop) == DPT_E_ARGUMENT && !loop, "no device");
    const double time = CALL(dpt_loop_quantile, NULL, draw_odd_number());
    HOLDS(time == 0.0, "%g s of nothing", time);
}

static void defaults(void)
{
    const uint32_t size = draw_size(sizeof(dpt_loop_def), sizeof(dpt_loop_def));
    void *out = output_of(0, size > 4096 ? 8 : size);
    CALL(dpt_loop_def_defaults, draw_one_in(20) ? NULL : out, size);
    outputs_are_guarded(0, 1);
    HOLDS((size >= 4 && size <= 4096) || output_is_untouched(0, 0), "size %u", size);
}

static const struct move moves[] = { { "run", run_loop, 2 },
                                     { "refuse NULL", refuse_null, 1 },
                                     { "defaults", defaults, 1 },
                                     { NULL, NULL, 0 } };

const struct noun loop_noun = { "loop", NULL, NULL, moves };
