/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint replay: move a tool through a world along a recorded motion, tick by tick. */
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/command_options.h"
#include "cli/commands.h"
#include "cli/complete.h"
#include "cli/force_check.h"
#include "cli/scene_command.h"
#include "csv.h"
#include "dynpoint/baseline.h"
#include "dynpoint/loop.h"
#include "plan/replay_plan.h"
#include "platform/clock.h"
#include "platform/file.h"
#include "record/recording_file.h"
#include "record/replay_recording.h"
#include "run/replay_report.h"
#include "scene/setting_words.h"
#include "shape/mesh_size.h"
#include "shape/trace_unit.h"

static const char help[] =
    "usage: dynpoint replay FILE.dpa TRACE.csv -o OUT.csv [options]\n"
    "       dynpoint replay FILE.dpr [FILE.dpa] [--tool ARM.dpa] [--json]\n"
    "       dynpoint replay --plan PLAN.json [TRACE.csv] [--check] [--json]\n"
    "\n"
    "Moves a tool along a trace (tick,ax,ay,az,bx,by,bz in m) and writes, for every tick, the nearest\n"
    "pair, its proof, contact, force, energy and proxy (its end a, and the turn from the x axis to the\n"
    "tool's). Ticks are integers that increase, within 2^53; one that is not\n"
    "the last one plus 1 is a jump. One of the inputs may be -, standard input.\n"
    "\n"
    "With a recording (FILE.dpr, of dynpoint run --record) it makes that scene again and compares\n"
    "every answer with the recorded one, bit for bit; replay FILE.dpr --help tells more. With\n"
    "a plan (of dynpoint plan -o) it says whether what the plan promises holds; so does\n"
    "replay --plan PLAN.json --help.\n"
    "\n"
    "  -o FILE              OUT.csv; - is standard output\n"
    "  --method M           exact (default), tree, brute; paper: dynamic points by neighbour descent\n"
    "  --parts K            pieces of the tool, each with its own dynamic point (paper); default 1\n"
    "  --budget N           at most N blocks of work a tick (exact); what is not proven then is bounded;\n"
    "                       default 0: unlimited\n"
    "  --certificate-bytes N  of memory for what was proven in earlier ticks; less costs time, never\n"
    "                       truth; default 1048576\n"
    "  --one-step           one move of the descent a tick (paper)\n"
    "  --radius R           of the tool, m; default 0: a line\n"
    "  --tip SHAPE:X,Y,Z[,RADIUS]\n"
    "                       a tip beside the line, up to 16, as run --tip. Then the tool has a frame:\n"
    "                       a is its origin, its z axis leads to b, and from tick to tick it turns as\n"
    "                       little as that takes, without a spin about the line; after a jump from\n"
    "                       world axes. The trace's line keeps its length. With the law proxy and the\n"
    "                       method exact; the proxy that is written is the frame's\n"
    "  --law LAW            of the force: proxy (default) pulls to where the tool would be if it went\n"
    "                       through nothing; bed: along the tool and at its ends; point pushes at the\n"
    "                       deepest point, and is the only one for --method paper\n"
    "  --stiffness K        of the force, N/m; default 500\n"
    "  --friction MU        of the mesh, with a proxy; default 0\n"
    "  --damping B          of the proxy's spring, Ns/m; default 0\n"
    "  --strip KIND         lay a strip under the tool where it is within the margin: shadow, or routes\n"
    "  --strip-width W      beside the radius, m; default 0\n"
    "  --limit              the wrench as a device's guard would let it through, not as it is\n"
    "  --until STAGE        track, contact or respond (default): how far a step goes\n"
    "  --dt T               length of a tick, s; default 0.001\n"
    "  --kernel K           auto (default), scalar, sse2, avx2, avx512, neon, wasm128: same\n"
    "                       answers, other speed\n"
    "  --repeat N           passes; the least time of each tick counts; default 1\n"
    "  --against M          compare every distance with another method's; exit status 1 if they differ\n"
    "                       by more than 1e-9 of the mesh's diagonal\n"
    "  --every N            with --against: only each Nth tick\n"
    "  --json               the summary as one JSON object on standard output\n";

static const char *const methods[] = { "exact", "tree", "brute", "paper", NULL };
static const char *const kernels[] = { "auto", "scalar", "sse2", "avx2", "avx512", "neon", "wasm128", NULL };

/* Larger than any count that an option takes. */
#define NOT_GIVEN UINT64_MAX

struct replay_settings {
    dpt_world_def def;
    dpt_baseline_def baseline;
    struct force_options force;
    struct replay_tool tool;
    double dt;
    uint64_t repeat, every, parts, budget;
    int against; /* a method, or -1 */
    int json, one_step, limit;
    const char *mesh, *trace, *out;
};

/* A world with one body and one tool. */
static int open_world(struct scene_stage *stage, const dpt_world_def *def, struct replay_settings *settings,
                      const dpt_mesh *mesh, const struct csv_table *trace)
{
    struct replay_tool *tool = &settings->tool;
    const dpt_segment segment = replay_tool_segment(tool, trace);
    dpt_body body = 0;
    dpt_result result = scene_stage_open(stage, def);
    if (result == DPT_E_UNSUPPORTED)
        return complain("replay", "--kernel %s: %s", kernels[def->kernel], dpt_result_text(result));
    if (result == DPT_OK)
        result = dpt_body_add(stage->world, mesh, NULL, &body);
    if (result == DPT_OK)
        result = force_options_set_body(&settings->force, stage->world, body);
    if (result == DPT_OK)
        result = scene_stage_add_tool(stage, &segment, 1, &settings->force, 0);
    if (result == DPT_OK)
        result = replay_tool_add_tips(tool, stage->world, stage->tool, mesh, &settings->force);
    tool->curved.body_ids[0] = body;
    return result == DPT_OK ? 0 : complain("replay", "%s", dpt_result_text(result));
}

/* Replace the wrench by what a guard lets through; its time is the row's. A stale answer switches the guard off. */
static void limit_wrench(dpt_guard *guard, uint64_t row, double dt, struct replayed_tick *tick)
{
    const dpt_wrench command = tick->wrench;
    const uint64_t now = (uint64_t)((double)row * dt * 1e9 + 0.5);
    dpt_guard_step(guard, now, &command, tick->hit.status != DPT_STATUS_STALE, &tick->wrench);
}

/* Returns 0, or 2 after a message: what follows a row that failed would be another motion. */
static int check_row(const struct csv_table *trace, size_t row, dpt_result result)
{
    return result == DPT_OK
               ? 0
               : complain("replay", "row %zu of %zu could not be felt: %s", row, trace->rows, dpt_result_text(result));
}

static int run_pass(struct scene_stage *stage, struct replay_settings *settings, struct replayed *replayed,
                    int is_first)
{
    struct meter meter = { .began = 0 };
    dpt_guard guard = { .size = sizeof guard };
    dpt_guard_init(&guard, NULL);
    dpt_result result = dpt_world_reset(stage->world);
    int status = 0;
    for (size_t i = 0; status == 0 && i < replayed->trace->rows; i++) {
        if (i % 256 == 0)
            meter_show(&meter, "replay", (double)i / (double)replayed->trace->rows);
        struct replayed_tick *tick = &replayed->ticks[i];
        if (result == DPT_OK)
            result = replay_tool_place(&settings->tool, replayed->trace, i, stage->world, stage->tool);
        const uint64_t begin = clock_now();
        if (result == DPT_OK)
            result = dpt_world_step(stage->world, settings->dt, NULL);
        double ns = (double)(clock_now() - begin);
        tick->ns = is_first || ns < tick->ns ? ns : tick->ns;
        tick->hit.size = sizeof tick->hit;
        dpt_tool_get_hit(stage->world, stage->tool, &tick->hit);
        curved_tips_deepen(&settings->tool.curved, &tick->hit);
        dpt_force_info force = { .size = sizeof force };
        dpt_tool_get_force_info(stage->world, stage->tool, &force);
        tick->wrench = force.wrench;
        tick->energy = force.energy + curved_tips_energy(&settings->tool.curved);
        tick->reason = force.reason;
        tick->force_flags = force.flags;
        dpt_tool_get_proxy(stage->world, stage->tool, &tick->proxy);
        if (settings->limit)
            limit_wrench(&guard, i, settings->dt, tick);
        dpt_tool_get_strip(stage->world, stage->tool, 0, NULL, 0, &tick->strip_triangles, &tick->strip_flags);
        if (curved_tips_have_failed(&settings->tool.curved))
            result = DPT_E_LIMIT;
        status = check_row(replayed->trace, i, result);
    }
    meter_show(&meter, "", 1.0);
    return status;
}

static int compare(struct replay_settings *settings, const dpt_mesh *mesh, struct replayed *replayed)
{
    struct comparison *against = &replayed->against;
    const struct csv_table *trace = replayed->trace;
    struct scene_stage stage = { .world = NULL };
    struct meter meter = { .began = 0 };
    dpt_world_def def = settings->def;
    def.method = (uint32_t)settings->against;
    def.baseline = NULL;
    def.budget = 0;
    def.until = DPT_UNTIL_TRACK;
    double *ns = malloc(trace->rows * sizeof *ns);
    int status = ns ? open_world(&stage, &def, settings, mesh, trace) : complain("replay", "memory ran out");
    for (size_t i = 0; status == 0 && i < trace->rows; i += settings->every) {
        dpt_hit hit = DPT_HIT_INIT;
        if (against->ticks % 64 == 0)
            meter_show(&meter, "compare", (double)i / (double)trace->rows);
        dpt_result result = replay_tool_place(&settings->tool, trace, i, stage.world, stage.tool);
        const uint64_t begin = clock_now();
        if (result == DPT_OK)
            result = dpt_world_step(stage.world, settings->dt, NULL);
        status = check_row(trace, i, result);
        ns[against->ticks++] = (double)(clock_now() - begin);
        dpt_tool_get_hit(stage.world, stage.tool, &hit);
        double error = fabs(hit.distance - replayed->ticks[i].hit.distance);
        against->wrong_count += error <= against->tolerance ? 0 : 1;
        against->error_max = fmax(against->error_max, error);
        against->missed_crossings += hit.distance == 0.0 && error > against->tolerance;
    }
    meter_show(&meter, "", 1.0);
    if (ns) {
        sort_numbers(ns, against->ticks);
        against->median_ns = percentile(ns, against->ticks, 0.5);
    }
    against->method = methods[settings->against];
    scene_stage_close(&stage);
    free(ns);
    return status;
}

static int write_results(const struct replay_settings *settings, const struct replayed *replayed)
{
    struct output output;
    int status = output_open(&output, "replay", settings->out);
    if (status)
        return status;
    replay_write_csv(output.file, replayed);
    status = output_complete(&output, "replay");
    if (status)
        return status;
    if (settings->json)
        replay_print_json(stdout, replayed);
    else if (strcmp(settings->out, "-") != 0)
        replay_print_table(stdout, replayed);
    status = output_keep(&output, "replay");
    return status ? status : replayed->against.wrong_count ? 1 : 0;
}

static void note_lengths(const struct replay_settings *settings, const dpt_mesh_info *info)
{
    const struct {
        const char *name;
        double length;
    } lengths[] = { { "--radius", settings->tool.radius }, { "--strip-width", settings->def.strip_width } };
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++)
        if (lengths[i].length > 0.5 * box_diagonal(info))
            fprintf(stderr, "%s: note: %s %g m is much for its box of %s\n", settings->mesh, lengths[i].name,
                    lengths[i].length, size_text(info).text);
}

static int run(struct replay_settings *settings, const dpt_mesh *mesh, const struct csv_table *trace)
{
    dpt_mesh_info info = { .size = sizeof info };
    dpt_world_info used = { .size = sizeof used };
    struct scene_stage stage = { .world = NULL };
    struct replayed replayed = {
        .trace = trace, .until = settings->def.until, .law = settings->force.law, .strip_kind = settings->def.strip
    };
    replayed.ticks = calloc(trace->rows, sizeof *replayed.ticks);
    int status = replayed.ticks ? replay_tool_open(&settings->tool, settings->trace, trace)
                                : complain("replay", "memory ran out");
    if (status == 0)
        status = open_world(&stage, &settings->def, settings, mesh, trace);
    if (status == 0) {
        dpt_mesh_get_info(mesh, &info);
        dpt_world_get_info(stage.world, &used);
        note_lengths(settings, &info);
        replayed.diagonal = box_diagonal(&info);
        replayed.against.tolerance = 1e-9 * replayed.diagonal;
        replayed.mesh_bytes = info.bytes;
        replayed.world_bytes = stage.bytes;
        replayed.kernel = used.kernel;
        replayed.method = methods[settings->def.method];
        for (uint64_t pass = 0; status == 0 && pass < settings->repeat; pass++)
            status = run_pass(&stage, settings, &replayed, pass == 0);
        replayed.curved = &settings->tool.curved;
        replayed.tip_error = replay_tool_error(&settings->tool);
        if (status == 0 && settings->against >= 0)
            status = compare(settings, mesh, &replayed);
    }
    if (status == 0)
        status = write_results(settings, &replayed);
    replay_tool_close(&settings->tool);
    scene_stage_close(&stage);
    free(replayed.ticks);
    return status;
}

/* Options that are words, and so are read further on. */
struct replay_words {
    const char *method, *until, *kernel, *against, *strip, *law, *plan;
    struct option_texts tips;
};

/* Returns -1 to go on, else the exit status. */
static int parse_settings(int argc, char **argv, struct replay_settings *settings, struct replay_words *words)
{
    const char *operand[2];
    size_t operands;
    const struct option_def options[] = {
        { .name = "-o", .text = &settings->out, .kind = VALUE_FILE },
        { .name = "--plan", .text = &words->plan, .kind = VALUE_FILE }, /* for completion: replay_plan took it */
        { .name = "--method", .text = &words->method, .words = methods },
        { .name = "--radius", .number = &settings->tool.radius },
        { .name = "--tip", .texts = &words->tips },
        { .name = "--law", .text = &words->law, .words = law_names },
        { .name = "--stiffness", .number = &settings->force.stiffness },
        { .name = "--friction", .number = &settings->force.friction },
        { .name = "--damping", .number = &settings->force.damping },
        { .name = "--until", .text = &words->until, .words = until_words },
        { .name = "--dt", .number = &settings->dt },
        { .name = "--kernel", .text = &words->kernel, .words = kernels },
        { .name = "--repeat", .count = &settings->repeat },
        { .name = "--against", .text = &words->against, .words = methods },
        { .name = "--every", .count = &settings->every },
        { .name = "--json", .flag = &settings->json },
        { .name = "--parts", .count = &settings->parts },
        { .name = "--budget", .count = &settings->budget },
        { .name = "--certificate-bytes", .count = &settings->def.certificate_bytes },
        { .name = "--one-step", .flag = &settings->one_step },
        { .name = "--limit", .flag = &settings->limit },
        { .name = "--strip", .text = &words->strip, .words = strip_words },
        { .name = "--strip-width", .number = &settings->def.strip_width },
    };
    static const struct operand_def taken[] = { { .kind = VALUE_FILE }, { .kind = VALUE_FILE } };
    int status = parse_options(argc, argv, COMMAND_SYNTAX(options, help, taken), operand, 2, &operands);
    if (status >= 0)
        return status;
    if (operands > 0 && is_recording(operand[0]))
        return replay_recording(argc, argv);
    if (operands != 2 || !settings->out)
        return complain("replay", "FILE.dpa, TRACE.csv and -o OUT.csv are needed (see --help)");
    settings->mesh = operand[0];
    settings->trace = operand[1];
    const char *const inputs[] = { settings->mesh, settings->trace, NULL };
    return output_check("replay", settings->out, inputs) ||
                   output_check_name("replay", settings->out, ".csv .txt", "a table of comma-separated values")
               ? 2
               : -1;
}

/* Returns 0, or 2 after a message. */
static int read_words(struct replay_settings *settings, const struct replay_words *words)
{
    const int method = word_index(words->method, methods);
    settings->against = words->against ? word_index(words->against, methods) : -1;
    settings->def.strip = (uint32_t)word_index(words->strip, strip_words);
    settings->def.method = (uint32_t)method;
    settings->def.until = (uint32_t)word_index(words->until, until_words);
    settings->def.kernel = (uint32_t)word_index(words->kernel, kernels);
    const char *law = words->law ? words->law : method == DPT_METHOD_PAPER ? "point" : "proxy";
    const int status = law_by_name("replay", law, &settings->force.law);
    return status ? status : force_options_check("replay", &settings->force);
}

/* Returns 0, or 2 after a message. */
static int read_tips(struct replay_settings *settings, const struct option_texts *tips)
{
    const dpt_world_def *def = &settings->def;
    const int has_proxy = settings->force.law == DPT_LAW_PROXY;
    if (read_tip_shapes(&settings->tool.tips, "replay", tips))
        return 2;
    const int is_felt = has_proxy || (def->until == DPT_UNTIL_RESPOND && tip_shapes_are_curved(&settings->tool.tips));
    if (tips->count && (def->method != DPT_METHOD_EXACT || settings->against >= 0 || !is_felt))
        return complain("replay",
                        "--tip is for the method exact and the law proxy, without --against; what is curved, for "
                        "the other laws too, with --until respond");
    settings->def.max_tips = has_proxy ? (uint32_t)tips->count : 0;
    return 0;
}

/* What is for one method alone, and the numbers that become the world's def. Returns 0, or 2 after a message. */
static int read_method(struct replay_settings *settings)
{
    dpt_world_def *def = &settings->def;
    if (settings->parts < 1 || settings->parts > 64)
        return complain("replay", "--parts must be 1 to 64");
    if (def->method != DPT_METHOD_PAPER && (settings->parts > 1 || settings->one_step))
        return complain("replay", "--parts and --one-step are for --method paper");
    if (def->method != DPT_METHOD_EXACT && settings->budget)
        return complain("replay", "--budget is for --method exact");
    if (settings->force.law == DPT_LAW_PROXY && def->method == DPT_METHOD_PAPER)
        return complain("replay", "--law proxy is for the other methods than paper");
    if (def->certificate_bytes > (uint64_t)1 << 40)
        return complain("replay", "--certificate-bytes must be 0 to 2^40");
    if (settings->budget > UINT32_MAX)
        return complain("replay", "--budget must be 0 to %u", (unsigned)UINT32_MAX);
    if (!(def->strip_width >= 0.0 && def->strip_width <= DPT_COORDINATE_MAX))
        return complain("replay", "--strip-width must be 0 to 1e6");
    def->budget = (uint32_t)settings->budget;
    settings->baseline.parts = (uint32_t)settings->parts;
    settings->baseline.one_step = (uint32_t)settings->one_step;
    def->baseline = &settings->baseline;
    return 0;
}

/* Returns -1 to go on, else the exit status. */
static int read_settings(int argc, char **argv, struct replay_settings *settings)
{
    struct replay_words words = { .method = "exact", .until = "respond", .kernel = "auto", .strip = "none" };
    const int status = parse_settings(argc, argv, settings, &words);
    if (status >= 0)
        return status;
    if (read_words(settings, &words) || read_tips(settings, &words.tips) || read_method(settings))
        return 2;
    if (!(settings->tool.radius >= 0.0 && settings->tool.radius <= DPT_COORDINATE_MAX))
        return complain("replay", "--radius must be 0 to 1e6");
    if (!(settings->dt > 0.0 && settings->dt <= 1e6))
        return complain("replay", "--dt must be above 0, at most 1e6");
    if (settings->against < 0 && settings->every != NOT_GIVEN)
        return complain("replay", "--every is for --against");
    if (settings->every == NOT_GIVEN)
        settings->every = 1;
    if (!settings->repeat || !settings->every)
        return complain("replay", "--repeat and --every must be 1 or more");
    if (settings->json && strcmp(settings->out, "-") == 0)
        return complain("replay", "--json and -o - both want standard output");
    return -1;
}

static int read_trace(struct csv_table *trace, const char *path)
{
    uint64_t line;
    const char *line_error;
    *trace = (struct csv_table){ .rows = 0 };
    const int file = strcmp(path, "-") ? file_open_read(path) : STDIN_FILENO;
    if (file < 0)
        return complain("replay", "%s: cannot be opened: %s", path, strerror(errno));
    dpt_result result = csv_table_stream(trace, file, UINT64_MAX, &trace_format, &line, &line_error);
    const int saved_errno = errno;
    if (file != STDIN_FILENO)
        close(file);
    if (result == DPT_OK)
        return 0;
    if (line_error)
        return complain("replay", "%s:%" PRIu64 ": %s", path, line ? line : 1, line_error);
    return complain("replay", "%s: cannot be read: %s", path,
                    result == DPT_E_OPEN ? strerror(saved_errno) : dpt_result_text(result));
}

int command_replay(int argc, char **argv)
{
    struct replay_settings settings = {
        .force = { .stiffness = 500.0 }, .dt = 1e-3, .repeat = 1, .every = NOT_GIVEN, .parts = 1
    };
    struct csv_table trace;
    void *bytes;
    /* It has options of its own. */
    const int first = argc > 1 && !strcmp(argv[1], COMPLETE_ARGUMENT) ? 2 : 1;
    if (argc > first && is_recording(argv[first]))
        return replay_recording(argc, argv);
    if (replay_has_plan(argc, argv))
        return replay_plan(argc, argv);
    dpt_world_def_init(&settings.def);
    settings.def.max_contacts = SCENE_CONTACTS;
    dpt_baseline_def_init(&settings.baseline);
    settings.def.max_bodies = settings.def.max_tools = settings.def.max_segments = 1;
    int status = read_settings(argc, argv, &settings);
    if (status >= 0)
        return status;
    const dpt_mesh *mesh = load_mesh("replay", settings.mesh, &bytes);
    if (!mesh)
        return 2;
    status = read_trace(&trace, settings.trace);
    if (status == 0) {
        const struct trace_ball ball = trace_ball_of(mesh, NULL);
        trace_note_unit(settings.trace, &trace, &ball, 1);
        status = run(&settings, mesh, &trace);
    }
    csv_table_free(&trace);
    free(bytes);
    return status;
}
