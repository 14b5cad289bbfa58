/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The self-test, of devices with a time of their own: there it reads and never waits. How long calls took decides two
 * of its lines, so what it counts is no part of the game's digest.
 */
#include "dynpoint/selftest.h"
#include "fuzz/calls/devices.h"
#include "fuzz/calls/witness.h"

struct report {
    uint32_t lines, stops_at, said[3];
};

static int hear(void *user, const dpt_selftest_line *line)
{
    struct report *report = user;
    HOLDS(line && line->size == sizeof *line && line->verdict <= DPT_SELFTEST_NOTE && line->what && line->what[0] &&
              line->unit && isfinite(line->measured),
          "line %u", report->lines);
    HOLDS(line->verdict != DPT_SELFTEST_NOTE || (line->measured == 0.0 && !line->unit[0]), "a note of %g %s",
          line->measured, line->unit);
    report->said[line->verdict]++;
    return ++report->lines == report->stops_at;
}

enum { DEF_SLOT = 2 };

static const void *draw_def(struct report *report, struct codes *codes)
{
    dpt_selftest_def def;
    CALL(dpt_selftest_def_defaults, &def, sizeof def);
    def.seconds = draw_in(0.1, 0.15);
    def.may_move = draw_one_in(8) ? 1u : 0u;
    if (def.may_move)
        def.push_seconds = draw_in(0.01, 0.02);
    if (draw_one_in(2))
        def.rate = draw_in(500.0, 5000.0);
    def.report = hear;
    def.user = report;
    if (draw_one_in(6)) {
        double *numbers[] = { &def.seconds, &def.rate, &def.push, &def.push_seconds };
        const double wrong[] = { NAN, -1.0, 0.5e-3, 4e6, -INFINITY };
        *numbers[draw_below(4)] = wrong[draw_below(5)];
    }
    if (draw_one_in(30))
        def.may_move = 2;
    may_fail(codes,
             def.may_move > 1 || !(def.seconds >= 0.1 && def.seconds <= 3600.0) ||
                 !(def.rate == 0.0 || (def.rate >= 1.0 && def.rate <= 1e6)) ||
                 !(def.push >= 0.001 && def.push <= 1.0) || !(def.push_seconds >= 0.01 && def.push_seconds <= 1.0),
             DPT_E_ARGUMENT);
    return draw_input(DEF_SLOT, &def, draw_size(sizeof def, sizeof def), sizeof def, sizeof def, codes);
}

/* A name with its driver's: dpt_driver_selftest takes one without. */
static dpt_result test_it(const char *name, int by_driver, const void *def, dpt_device *device,
                          dpt_selftest_counts *counts)
{
    const dpt_driver *driver = CALL(dpt_driver_find, name[0] == 's' ? "sim" : "replay");
    const char *colon = strchr(name, ':');
    return by_driver ? RESULT(dpt_driver_selftest, device ? driver : NULL, colon ? colon + 1 : NULL, def, counts)
                     : RESULT(dpt_device_selftest, device, def, counts);
}

static void test(void)
{
    struct report report = { .stops_at = draw_one_in(3) ? 1 + draw_below(20) : 0 };
    struct codes codes = { .count = 0 };
    const int no_device = draw_one_in(20), no_counts = draw_one_in(20), no_def = draw_one_in(200);
    const int by_driver = draw_one_in(2);
    const char *name = draw_device_name();
    dpt_selftest_counts now;
    dpt_device *device = NULL;
    const void *def = draw_def(&report, &codes);
    if (no_def)
        codes.count = 0;
    const uint32_t size = draw_size(sizeof now, sizeof now);
    void *counts = output_sized(0, size);
    if (!no_counts)
        size_codes_of_output(size, sizeof now, 0, &codes);
    may_fail(&codes, no_device || no_counts, DPT_E_ARGUMENT);
    if (!no_device)
        HOLDS(dpt_device_open(name, &device, NULL) == DPT_OK, "%s", name);
    const int is_refused = codes.count > 0;
    call_with("by driver %llu, stops at %llu", (uint64_t)by_driver, report.stops_at, 0, 0);
    const dpt_result result = test_it(name, by_driver, no_def ? NULL : def, device, no_counts ? NULL : counts);
    outputs_are_guarded(0, 1);
    const int is_stopped = !no_def && report.stops_at && report.lines == report.stops_at;
    may_fail(&codes, is_stopped, DPT_E_CANCELLED);
    expect(result, &codes);
    HOLDS(report.lines <= report.stops_at || !report.stops_at, "it went on after it was stopped");
    CALL(dpt_device_close, device);
    if (no_counts || output_is_untouched(0, sizeof size)) {
        HOLDS(is_refused, "nothing was told");
        return;
    }
    /* A driver that is NULL is an open that failed: the only line. */
    HOLDS(!is_refused || (by_driver && no_device), "%s, and counts", dpt_result_name(result));
    const uint64_t digest = run.digest;
    output_read(0, size, sizeof now, sizeof now, &now);
    run.digest = digest;
    HOLDS(now.passed + now.failed + now.notes > 0 && (no_def || (now.passed == report.said[DPT_SELFTEST_PASSED] &&
                                                                 now.failed == report.said[DPT_SELFTEST_FAILED] &&
                                                                 now.notes == report.said[DPT_SELFTEST_NOTE])),
          "%u lines were told", report.lines);
    met[MET_TESTED] += result == DPT_OK;
}

static void defaults(void)
{
    dpt_selftest_def whole;
    const uint32_t size = draw_size(sizeof whole, sizeof whole);
    const int is_null = draw_one_in(20);
    void *out = output_of_defaults(0, size);
    CALL(dpt_selftest_def_defaults, is_null ? NULL : out, size);
    CALL(dpt_selftest_def_defaults, &whole, sizeof whole);
    defaults_must_hold(0, size, is_null, &whole, sizeof whole);
}

static const struct move moves[] = { { "test", test, 1 }, { "defaults", defaults, 1 }, { NULL, NULL, 0 } };

const struct noun selftest_noun = { "self-test", NULL, NULL, moves };
