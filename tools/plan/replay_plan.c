/* SPDX-License-Identifier: BSD-3-Clause */
#include "plan/replay_plan.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "cli/json_text.h"
#include "cli/law_name.h"
#include "cli/scene_command.h"
#include "measure/measure_setting.h"
#include "plan/plan_file.h"
#include "plan/plan_report.h"
#include "plan/plan_trace.h"

static const char help[] =
    "usage: dynpoint replay --plan PLAN.json [TRACE.csv] [options]\n"
    "\n"
    "Feels a plan's scene with the plan's setting (dynpoint plan) over a trace, and with the richest\n"
    "setting beside it, and says how far apart they are. Without a trace it is the plan's own.\n"
    "\n"
    "  --check       judge errors, unknown ticks, capacities and units of work by what the plan\n"
    "                promises; exit status 1, and the bound, if one is broken\n"
    "  --check=time  and the time of ticks, on the machine on which the plan was made\n"
    "  --seed S, --ticks N, --speed V\n"
    "                another trace of the hand that slides over each body, V m/s on average\n"
    "  --cheaper     with the next cheaper setting, over the part of the plan's own trace by which\n"
    "                that was measured\n"
    "  --json        what is said as one JSON object\n";

struct replay_plan_options {
    const char *plan, *trace;
    uint64_t seed, ticks;
    double speed;
    int check, check_time, cheaper, json;
};

int replay_has_plan(int argc, char **argv)
{
    for (int i = 1; i < argc; i++)
        if (!strcmp(argv[i], "--plan") || !strncmp(argv[i], "--plan=", 7))
            return 1;
    return 0;
}

/* Returns -1 to go on, else the exit status. */
static int read_options(int argc, char **argv, struct replay_plan_options *options)
{
    size_t operands;
    const struct option_def defs[] = {
        { .name = "--plan", .text = &options->plan, .kind = VALUE_FILE },
        { .name = "--check", .flag = &options->check },
        { .name = "--check=time", .flag = &options->check_time },
        { .name = "--seed", .count = &options->seed },
        { .name = "--ticks", .count = &options->ticks },
        { .name = "--speed", .number = &options->speed },
        { .name = "--cheaper", .flag = &options->cheaper },
        { .name = "--json", .flag = &options->json },
    };
    *options = (struct replay_plan_options){ .seed = UINT64_MAX, .ticks = UINT64_MAX };
    static const struct operand_def taken[] = { { .kind = VALUE_FILE } };
    int status = parse_options(argc, argv, COMMAND_SYNTAX(defs, help, taken), &options->trace, 1, &operands);
    if (status >= 0)
        return status;
    const int is_made = options->seed != UINT64_MAX || options->ticks != UINT64_MAX || options->speed != 0.0;
    if (!options->plan)
        return complain("replay", "--plan needs a value");
    if (!operands)
        options->trace = NULL;
    if (options->trace && is_made)
        return complain("replay", "--seed, --ticks and --speed are for a trace that is made");
    if (options->cheaper && (options->trace || is_made))
        return complain("replay", "--cheaper is measured over the plan's own trace");
    if (!(options->speed >= 0.0 && options->speed <= 1000.0))
        return complain("replay", "--speed must be 0 to 1000");
    if (options->ticks != UINT64_MAX && (options->ticks == 0 || options->ticks > 100000000))
        return complain("replay", "--ticks must be 1 to 100000000");
    if (options->ticks == UINT64_MAX)
        options->ticks = 0;
    options->check |= options->check_time;
    return -1;
}

/* The plan's own, a file's, or another one of the hand. Returns 0, or 2 after a message. */
static int open_trace(const struct replay_plan_options *options, const struct plan *plan, const struct scene *scene,
                      struct csv_table *trace)
{
    const struct plan_motion *motion = &plan->motion;
    const int is_made = options->seed != UINT64_MAX || options->ticks || options->speed != 0.0;
    const char *file = options->trace ? options->trace : is_made ? NULL : motion->file;
    if (file)
        return measure_trace_read(trace, scene, file, 2);
    return plan_trace_make(trace, scene, options->seed != UINT64_MAX ? options->seed : motion->seed,
                           options->ticks ? options->ticks : motion->ticks, plan->asked.rate, options->speed);
}

/* NULL, or why times are not judged. */
static const char *other_machine(const struct plan *plan, uint32_t kernel)
{
    struct measure_machine here;
    measure_machine_read(&here, kernel);
    if (strcmp(here.processor, plan->machine.processor))
        return "another processor";
    if (strcmp(here.system, plan->machine.system))
        return "another system";
    if (strcmp(here.kernel, plan->machine.kernel))
        return "another kernel";
    if (strcmp(here.compiler, plan->machine.compiler))
        return "another compiler";
    return strcmp(here.version, plan->machine.version) ? "another version" : NULL;
}

struct verdict {
    struct plan_figures figures, richest;
    struct plan_limits limits;
    enum plan_bound broken;
    const char *not_measured; /* why times count for nothing, or NULL */
    double speed, speed_limit;
};

static void print_json(const struct replay_plan_options *options, const struct verdict *verdict)
{
    const struct plan_figures *figures = &verdict->figures;
    printf("{\"plan\":");
    json_write_text(stdout, options->plan);
    printf(",\"ticks\":%" PRIu64 ",\"failed\":%" PRIu64
           ",\"distance_error\":%.17g,\"force_error\":%.17g,\"felt\":%" PRIu64 ",\"near_folds\":%" PRIu64
           ",\"unknown\":%" PRIu64 ",\"contacts\":%" PRIu32 ",\"strip\":%" PRIu32 ",\"work\":%" PRIu32
           ",\"work_p999\":%.17g,\"work_total\":%" PRIu64
           ",\"time_median\":%.17g,\"time_p999\":%.17g,\"busy\":%.17g,\"bytes\":%" PRIu64
           ",\"speed\":%.17g,\"speed_limit\":%.17g",
           figures->ticks, figures->failed, figures->distance_error, figures->force_error, figures->felt,
           figures->near_folds, figures->unknown, figures->contacts, figures->strip, figures->work, figures->work_p999,
           figures->work_total, figures->time_median, figures->time_p999, figures->busy, figures->bytes, verdict->speed,
           verdict->speed_limit);
    if (options->check)
        printf(",\"broken\":\"%s\"", plan_bound_words[verdict->broken]);
    printf(",\"times_count\":%s}\n", verdict->not_measured ? "false" : "true");
}

static void print_text(const struct replay_plan_options *options, const struct verdict *verdict)
{
    plan_report_head(stdout);
    plan_report_figures(stdout, options->cheaper ? "the next cheaper" : "the plan's setting", &verdict->figures);
    plan_report_figures(stdout, "richest", &verdict->richest);
    printf("\n");
    if (verdict->speed > verdict->speed_limit * (1.0 + 1e-9))
        printf("  the trace moves at up to %.3g m/s: beyond %.3g nothing is promised\n", verdict->speed,
               verdict->speed_limit);
    if (options->check_time && !verdict->not_measured)
        plan_report_busy(stdout, &verdict->figures);
    if (verdict->not_measured)
        printf("  time: not measured here, but on %s\n", verdict->not_measured);
    if (options->check && verdict->broken == PLAN_HOLDS)
        printf("%s: holds over %" PRIu64 " ticks\n", options->plan, verdict->figures.ticks);
    else if (options->check)
        printf("%s: broken: %s: %s\n", options->plan, plan_bound_words[verdict->broken],
               plan_broken_text(&verdict->limits, &verdict->figures, verdict->broken).text);
}

static int measure(const struct replay_plan_options *options, const struct plan *plan, const struct scene *scene,
                   const struct csv_table *trace, struct verdict *verdict)
{
    const struct measure_setting *setting = options->cheaper ? &plan->cheaper.setting : &plan->setting;
    struct plan_bench bench = { .progress = NULL };
    int status = plan_bench_open(&bench, scene, trace, &plan->setting);
    if (status == 0)
        status = plan_bench_measure(&bench, setting, options->check_time ? 3 : 1, &verdict->figures);
    if (status == 0) {
        verdict->richest = bench.richest;
        verdict->not_measured = other_machine(plan, bench.reference.kernel);
        verdict->limits = plan->limits;
        /* As when it was refused. */
        if (options->cheaper)
            verdict->limits = plan_limits_of(&plan->asked, setting, &bench,
                                             plan->cheaper.broken == PLAN_BITS || plan->cheaper.broken == PLAN_WORK);
        verdict->broken =
            plan_judge(&verdict->limits, &verdict->figures, options->check_time && !verdict->not_measured);
        verdict->speed = plan_trace_speed(trace, plan->setting.dt);
        verdict->speed_limit = PLAN_SPEED_FACTOR * plan->motion.speed;
    }
    plan_bench_close(&bench);
    return status;
}

static int replay(const struct replay_plan_options *options, const struct plan *plan, const struct scene *scene)
{
    struct csv_table whole, part = { .rows = 0 };
    struct verdict verdict;
    int status = plan_scene_check(plan, scene, options->plan);
    if (status == 0 && options->cheaper && !plan->cheaper.knob[0])
        return complain("replay", "%s: there is no cheaper setting", options->plan);
    if (status)
        return status;
    status = open_trace(options, plan, scene, &whole);
    if (status)
        return status;
    if (options->cheaper)
        status = plan_trace_of(&part, scene, plan, &whole, plan->cheaper.trace);
    if (status == 0)
        status = measure(options, plan, scene, options->cheaper ? &part : &whole, &verdict);
    if (options->cheaper)
        plan_trace_leave(&part, plan->cheaper.trace);
    csv_table_free(&whole);
    if (status)
        return status;
    if (options->json)
        print_json(options, &verdict);
    else
        print_text(options, &verdict);
    return options->check && verdict.broken != PLAN_HOLDS ? 1 : 0;
}

int replay_plan(int argc, char **argv)
{
    struct replay_plan_options options;
    struct plan plan;
    struct scene scene;
    struct scene_def def;
    scene_def_init(&def, "replay");
    int status = read_options(argc, argv, &options);
    if (status >= 0)
        return status;
    status = plan_file_read(&plan, "replay", options.plan);
    if (status == 0) {
        plan_scene_def(&plan, &def);
        status = read_scene_def(&def);
        if (status == 0)
            status = complete_scene_def(&def, law_name(plan.setting.world.law));
        if (status == 0) {
            status = open_scene(&scene, &def);
            if (status == 0)
                status = replay(&options, &plan, &scene);
            scene_close(&scene);
        }
    }
    scene_def_free(&def);
    plan_free(&plan);
    return status;
}
