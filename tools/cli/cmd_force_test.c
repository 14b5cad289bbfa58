/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint force-test: motions that break a force law, over a mesh of the user's own. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command_options.h"
#include "cli/commands.h"
#include "cli/law_name.h"
#include "lab/force_trial.h"
#include "shape/mesh_size.h"

static const char help[] =
    "usage: dynpoint force-test FILE.dpa [options]\n"
    "\n"
    "Tests a law of force on your mesh. A needle is pushed in at many places, upright to lying, with the\n"
    "tremor of a hand, and led along closed paths. A longer one is pushed through the mesh, and begins\n"
    "inside. The force must not turn, jump, come late or give energy. Where the place that the proxy\n"
    "rested at has vanished it goes to another: a fold, which is the mesh's. How many ticks have one is\n"
    "told; they may turn the force and let go of it, within the bound of jumps, but not push harder.\n"
    "Exit status 1 if a bound is broken.\n"
    "\n"
    "  --law LAW        proxy (default), bed or point (see dynpoint replay --help)\n"
    "  --length L       of the needle, m; default 0.1\n"
    "  --radius R       of it, m; default 0.002\n"
    "  --stiffness K    N/m; default 500\n"
    "  --friction MU    of the mesh, with the proxy; default 0\n"
    "  --depth D        that it is pushed in, m; default 0.005\n"
    "  --through D      the same, of the longer needle; default 0.027\n"
    "  --speed V        m/s; default 0.1\n"
    "  --low-pass T     a first-order low-pass of T seconds behind the law, as a driver may have one, to\n"
    "                   see what it costs; default 0: none\n"
    "  --places N       where it is tried; default 40\n"
    "  --paths N        closed paths; default 100\n"
    "  --contacts N     that a tick lists, dpt_world_def.max_contacts; default 32; 0: none, to see what the\n"
    "                   force alone costs\n"
    "  --seed S         default 1\n"
    "  --json           one JSON object on standard output\n";

/* Of the ticks with a force. */
#define LAGGING_MAX 0.01

/* Ticks: of the tick itself, and one on the way. */
#define DELAY_MAX 1.0

/* Of the range of a path's energy; of the paths. */
#define EMITTED      1e-3
#define EMITTED_MOST 3e-3
#define EMITTING_MAX 0.01

/* A line of the report. HUGE_VAL: any value will do. */
struct bound {
    const char *name, *what;
    double value, limit;
    int is_broken;
};

static struct bound bound_of(const char *name, const char *what, double value, double limit)
{
    return (struct bound){ name, what, value, limit, !(value <= limit) };
}

static double share(uint64_t part, uint64_t all)
{
    return all ? (double)part / (double)all : 0.0;
}

struct force_report {
    struct push_result push;
    struct push_result through;
    struct inside_result inside;
    struct delay_result delay;
    struct path_result paths;
};

enum { BOUNDS = 10 };

static void take_bounds(const struct force_trial_def *def, const struct force_report *report,
                        struct bound bounds[BOUNDS])
{
    const struct push_result *push = &report->push, *through = &report->through;
    const int has_proxy = def->law == DPT_LAW_PROXY;
    const struct bound all[BOUNDS] = {
        bound_of("turns",
                 def->friction > 0.0 ? "ticks that turn it by over 30 degrees and friction's cone"
                                     : "ticks that turn the force by more than 30 degrees",
                 (double)push->turns, 0.0),
        bound_of("through_turns", "the same, of a needle that is held through the mesh", (double)through->turns, 0.0),
        bound_of("jumps", "ticks that change it by more than K (3 |motion| + 1 mm)",
                 (double)(push->jumps + through->jumps), 0.0),
        bound_of("delay", "ticks that the force is behind the device", report->delay.ticks, DELAY_MAX),
        bound_of("fold_pushes", "ticks of a fold that push harder than the motion explains",
                 (double)(push->fold_pushes + through->fold_pushes), def->low_pass > 0.0 ? HUGE_VAL : 0.0),
        bound_of("lagging", "share of ticks whose proxy lags by more than 1 %", share(push->lagging, push->ticks),
                 LAGGING_MAX),
        bound_of("penetrations", "ticks whose proxy is in the mesh",
                 (double)(push->penetrations + through->penetrations), 0.0),
        bound_of("felt_inside", "ticks of a needle that began inside, and felt it", (double)report->inside.felt,
                 has_proxy ? 0.0 : HUGE_VAL),
        bound_of("emitted", "most energy given on a closed path, of its range", report->paths.emitted_max,
                 has_proxy ? EMITTED : EMITTED_MOST),
        bound_of("emitting", "share of closed paths that give more than 0.1 %",
                 share(report->paths.emitting, report->paths.paths), EMITTING_MAX),
    };
    memcpy(bounds, all, sizeof all);
}

static double largest_jump(const struct force_report *report)
{
    return fmax(report->push.largest_jump, report->through.largest_jump);
}

static double gap_min(const struct force_report *report)
{
    return fmin(report->push.gap_min, report->through.gap_min);
}

static void print_json(const struct force_trial_def *def, const struct force_report *report, const struct bound *bounds,
                       int is_broken)
{
    printf("{\"law\":\"%s\",\"ticks\":%" PRIu64, law_name(def->law), report->push.ticks);
    for (int i = 0; i < BOUNDS; i++)
        printf(",\"%s\":%.9g", bounds[i].name, bounds[i].value);
    printf(",\"folds\":%.9g", share(report->push.folds, report->push.ticks));
    printf(",\"through_ticks\":%" PRIu64 ",\"through_folds\":%" PRIu64 ",\"delay_places\":%" PRIu64,
           report->through.ticks, report->through.folds, report->delay.places);
    printf(",\"us\":{\"median\":%.1f,\"p99\":%.1f}", report->push.us_median, report->push.us_p99);
    printf(",\"largest_jump\":%.9g", largest_jump(report));
    if (def->law == DPT_LAW_PROXY)
        printf(",\"least_gap\":%.9g", gap_min(report));
    printf(",\"inside_places\":%" PRIu64 ",\"paths\":%" PRIu64 ",\"lost\":%.9g,\"broken\":%d}\n", report->inside.places,
           report->paths.paths, report->paths.lost_max, is_broken);
}

static void print_table(const struct force_trial_def *def, const struct force_report *report,
                        const struct bound *bounds)
{
    printf("law %s: %" PRIu64 " ticks with a force, %" PRIu64 " through the mesh, %" PRIu64 " closed paths, %" PRIu64
           " places inside\n\n",
           law_name(def->law), report->push.ticks, report->through.ticks, report->paths.paths, report->inside.places);
    for (int i = 0; i < BOUNDS; i++) {
        printf("  %-6s %-58s %10.4g", bounds[i].is_broken ? "BROKEN" : "ok", bounds[i].what, bounds[i].value);
        if (bounds[i].limit < HUGE_VAL)
            printf("  at most %g", bounds[i].limit);
        printf("\n");
    }
    printf("\n  largest change of the force in a tick %.3f N; lost on a closed path without a fold at most %.3g\n",
           largest_jump(report), report->paths.lost_max);
    if (def->law == DPT_LAW_PROXY)
        printf("  ticks with a fold %.3g %%, held through the mesh %.3g %%\n",
               100.0 * share(report->push.folds, report->push.ticks),
               100.0 * share(report->through.folds, report->through.ticks));
    printf("  a tick with a force took %.1f us (median), %.1f (99 %%)\n", report->push.us_median, report->push.us_p99);
    if (report->push.unknown)
        printf("  no force on %" PRIu64 " ticks, as contact was not known\n", report->push.unknown);
    if (def->law == DPT_LAW_PROXY)
        printf("  least gap of the proxy %.3g m\n", gap_min(report));
}

/* The exit status where one is out of range, else -1. */
static int check_ranges(const struct force_trial_def *def)
{
    const struct {
        const char *name;
        double value, low, high;
    } ranges[] = { { "--friction", def->friction, 0.0, 10.0 }, { "--length", def->length, 1e-3, 10.0 },
                   { "--radius", def->radius, 0.0, 1.0 },      { "--stiffness", def->stiffness, 1e-3, 1e9 },
                   { "--depth", def->depth, 1e-5, 1.0 },       { "--through", def->through, 1e-5, 1.0 },
                   { "--low-pass", def->low_pass, 0.0, 1.0 },  { "--speed", def->speed, 1e-3, 10.0 } };
    for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++)
        if (!(ranges[i].value >= ranges[i].low && ranges[i].value <= ranges[i].high))
            return complain("force-test", "%s must be %g to %g", ranges[i].name, ranges[i].low, ranges[i].high);
    if (def->contacts > 0xffff)
        return complain("force-test", "--contacts must be 0 to 65535");
    if (!def->places || !def->paths || def->places > 100000 || def->paths > 100000)
        return complain("force-test", "--places and --paths must be 1 to 100000");
    return -1;
}

static int take_settings(int argc, char **argv, struct force_trial_def *def, const char **path, int *json)
{
    const char *law = "proxy";
    size_t operands;
    const struct option_def options[] = {
        { .name = "--law", .text = &law, .words = law_names },
        { .name = "--length", .number = &def->length },
        { .name = "--radius", .number = &def->radius },
        { .name = "--stiffness", .number = &def->stiffness },
        { .name = "--friction", .number = &def->friction },
        { .name = "--depth", .number = &def->depth },
        { .name = "--through", .number = &def->through },
        { .name = "--low-pass", .number = &def->low_pass },
        { .name = "--speed", .number = &def->speed },
        { .name = "--places", .count = &def->places },
        { .name = "--paths", .count = &def->paths },
        { .name = "--contacts", .count = &def->contacts },
        { .name = "--seed", .count = &def->seed },
        { .name = "--json", .flag = json },
    };
    static const struct operand_def taken[] = { { .kind = VALUE_FILE } };
    int status = parse_options(argc, argv, COMMAND_SYNTAX(options, help, taken), path, 1, &operands);
    if (status >= 0)
        return status;
    if (operands != 1)
        return complain("force-test", "FILE.dpa is needed (see --help)");
    status = law_by_name("force-test", law, &def->law);
    if (status)
        return status;
    if (def->friction != 0.0 && def->law != DPT_LAW_PROXY)
        return complain("force-test", "--friction is for --law proxy");
    return check_ranges(def);
}

/* Each part has a time of its own. */
struct shown_part {
    struct meter meter;
    const char *part;
};

static void show_part(void *user, const char *part, double done)
{
    struct shown_part *shown = user;
    if (part != shown->part) {
        meter_show(&shown->meter, "", 1.0);
        *shown = (struct shown_part){ .part = part };
    }
    meter_show(&shown->meter, part, done);
}

int command_force_test(int argc, char **argv)
{
    struct force_trial_def def = { .length = 0.1,
                                   .radius = 0.002,
                                   .stiffness = 500.0,
                                   .depth = 0.005,
                                   .through = 0.027,
                                   .speed = 0.1,
                                   .places = 40,
                                   .paths = 100,
                                   .contacts = 32,
                                   .seed = 1 };
    struct force_report report;
    struct bound bounds[BOUNDS];
    const char *path;
    void *bytes;
    int json = 0, is_broken = 0;
    dpt_result failure = DPT_OK;
    struct shown_part shown = { .part = "" };
    const int status = take_settings(argc, argv, &def, &path, &json);
    if (status >= 0)
        return status;
    def.mesh = load_mesh("force-test", path, &bytes);
    if (!def.mesh)
        return 2;
    def.failure = &failure;
    def.show = show_part;
    def.user = &shown;
    const int is_done = force_trial_push(&def, &report.push) && force_trial_through(&def, &report.through) &&
                        force_trial_delay(&def, &report.delay) && force_trial_inside(&def, &report.inside) &&
                        force_trial_paths(&def, &report.paths);
    meter_show(&shown.meter, "", 1.0);
    free(bytes);
    if (failure != DPT_OK)
        return complain("force-test", "%s: a tick failed: %s", path, dpt_result_text(failure));
    if (!is_done)
        return complain("force-test", "%s: memory ran out, or no triangle to push at", path);
    if (!report.push.ticks)
        return complain("force-test", "%s: no place could be touched: is --length or --depth wrong?", path);
    take_bounds(&def, &report, bounds);
    for (int i = 0; i < BOUNDS; i++)
        is_broken |= bounds[i].is_broken;
    if (json)
        print_json(&def, &report, bounds, is_broken);
    else
        print_table(&def, &report, bounds);
    return is_broken;
}
