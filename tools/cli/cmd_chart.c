/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint chart: speed against accuracy of every method, law and setting over a scene. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "chart/chart_csv.h"
#include "chart/chart_json.h"
#include "chart/chart_peers.h"
#include "chart/chart_picture.h"
#include "cli/command_options.h"
#include "cli/commands.h"
#include "cli/scene_command.h"
#include "measure/measure_setting.h"
#include "scene/setting_words.h"

static const char help[] =
    "usage: dynpoint chart SCENE|SCENE.json|MESH.dpa|ARM.dpa [TRACE.csv] -o NAME [options]\n"
    "\n"
    "Leads the tool through a scene by every method, law and setting, and says what each took\n"
    "and what it got wrong: NAME.csv, one row a setting; NAME.svg, time against error with the\n"
    "frontier; and NAME.histograms.csv, how often a tick took how long (docs/chart.md). A scene\n"
    "is one that dynpoint run knows. Without a trace a hand slides over the scene's first body,\n"
    "as of dynpoint make trace. A trace has at least 10000 ticks.\n"
    "\n"
    "  -o NAME         what the three files are called\n"
    "  --ticks N       of the trace that is made; default 10000\n"
    "  --seed S        of it; default 1\n"
    "  --length L      of the stylus, m; default the scene's; of a mesh alone, as of make trace\n"
    "  --radius R      of it, m; default the scene's, or 0.002\n"
    "  --tool ARM.dpa  the tool is that of an arm\n"
    "  --stiffness K   of the force, N/m; default 500\n"
    "  --friction MU   of all bodies, with a proxy; default the scene's, or 0\n"
    "  --until STAGE   track: the nearest pair alone; contact: contact too; respond, the\n"
    "                  default: force too\n"
    "  --passes N      a tick's time is the least of N passes; default 3\n"
    "  --repeats N     measure all N times, in turn: times are the middle ones, with the least\n"
    "                  and the largest beside them; default 1\n"
    "  --peers DIR     other libraries too: programs peer_NAME there, as tests/bench/peers.sh\n"
    "                  builds them; for a mesh alone\n"
    "  --title TEXT    above the picture; the scene's name if not given\n"
    "  --json          the rows as one JSON object on standard output, instead of the table\n";

enum { TICKS_MIN = 10000, TICKS_MAX = 10000000, PASSES_MAX = 1000, NAME_ROOM = 4096 };

/* What is written, and how it is called behind -o. */
enum { FILE_CSV, FILE_HISTOGRAMS, FILE_SVG, FILES };
static const char *const endings[FILES] = { ".csv", ".histograms.csv", ".svg" };

struct chart_request {
    struct scene_def scene;
    const char *trace, *name, *title, *peers, *until;
    enum chart_part last;
    uint64_t ticks, seed, passes, repeats;
    int json;
    double stylus; /* m, of a trace that is made; 0: as of make trace */
    char path[FILES][NAME_ROOM];
};

static int write_picture(FILE *file, const struct chart_request *request, const struct chart_head *head,
                         const struct chart_rows *rows)
{
    char subtitle[512];
    const struct measure_machine *machine = &head->machine;
    const char *title = request->title ? request->title : request->scene.path;
    snprintf(subtitle, sizeof subtitle, "%zu ticks. %s, dynpoint %s, %s", head->ticks, machine->processor,
             machine->version, machine->kernel);
    return chart_picture_write(file, rows, head->repeats, title, subtitle) ? complain("chart", "memory ran out") : 0;
}

/* Write one of the files, to be kept. */
static int write_file(struct output *output, int which, const struct chart_request *request,
                      const struct chart_head *head, const struct chart_rows *rows)
{
    int status = output_open(output, "chart", request->path[which]);
    if (status)
        return status;
    if (which == FILE_CSV)
        chart_csv_write(output->file, head, rows);
    else if (which == FILE_HISTOGRAMS)
        chart_histograms_write(output->file, rows);
    else
        status = write_picture(output->file, request, head, rows);
    if (output_complete(output, "chart"))
        return 2;
    if (status)
        output_drop(output);
    return status;
}

/* All files, or none. */
static int write_files(const struct chart_request *request, const struct chart_head *head,
                       const struct chart_rows *rows)
{
    struct output output[FILES];
    int written = 0, kept = 0, status = 0;
    while (status == 0 && written < FILES) {
        status = write_file(&output[written], written, request, head, rows);
        written += status == 0;
    }
    if (status == 0 && request->json && chart_json_write(stdout, head, rows))
        status = complain("chart", "--json: no temporary file can be made");
    if (status == 0 && !request->json)
        chart_table_print(stdout, head, rows);
    while (status == 0 && kept < FILES)
        status = output_keep(&output[kept++], "chart");
    for (; kept < written; kept++)
        output_drop(&output[kept]);
    return status;
}

/* All rows once. */
static int measure_once(const struct chart_request *request, const struct scene *scene, const struct csv_table *trace,
                        const struct measure_effort *effort, struct chart_rows *rows)
{
    struct measure_setting base;
    measure_setting_init(&base, scene);
    chart_rows_list(rows, scene, &base, request->last);
    if (!rows->count)
        return complain("chart", "%s: nothing feels it with --until %s", request->scene.path, request->until);
    const int status = chart_rows_measure(rows, scene, trace, effort);
    return status || !request->peers
               ? status
               : chart_peers_measure(rows, scene, trace, request->peers, request->name, effort->passes);
}

/* Measure all that is to be told; the first of the repeats becomes the chart. */
static int measure(const struct chart_request *request, const struct scene *scene, const struct csv_table *trace,
                   struct chart_head *head, struct chart_rows *repeats)
{
    const double count = (double)request->repeats;
    struct meter meter = { .began = 0 };
    int status = 0;
    *head = (struct chart_head){ .scene = request->scene.path,
                                 .trace = request->trace,
                                 .seed = request->seed,
                                 .ticks = trace->rows,
                                 .passes = (uint32_t)request->passes,
                                 .repeats = (uint32_t)request->repeats,
                                 .body_count = scene->bodies.count };
    for (uint32_t i = 0; status == 0 && i < head->repeats; i++) {
        const struct measure_effort effort = {
            .passes = head->passes, .meter = &meter, .name = "chart", .begin = i / count, .end = (i + 1) / count
        };
        status = measure_once(request, scene, trace, &effort, &repeats[i]);
    }
    meter_show(&meter, "", 1.0);
    if (status == 0)
        chart_repeats_join(repeats, head->repeats);
    for (uint32_t i = 0; status == 0 && i < head->body_count; i++)
        status = chart_body_measure(&head->body[i], scene, i);
    measure_machine_read(&head->machine, repeats->truth.kernel);
    return status;
}

static int open_trace(const struct chart_request *request, const struct scene *scene, struct csv_table *trace)
{
    const struct measure_hand hand = { .seed = request->seed,
                                       .ticks = (size_t)request->ticks,
                                       .length = request->stylus };
    return request->trace ? measure_trace_read(trace, scene, request->trace, TICKS_MIN)
                          : measure_trace_make(trace, scene, &hand);
}

/* Opened before anything is measured, so that an error shows at once, and not kept: an interrupt leaves nothing. */
static int check_output(const char *path)
{
    struct output output;
    const int status = output_open(&output, "chart", path);
    if (status == 0) {
        fclose(output.file);
        output_drop(&output);
    }
    return status;
}

static int chart(const struct chart_request *request, const struct scene *scene)
{
    struct csv_table trace = { .rows = 0 };
    struct chart_rows *rows = calloc((size_t)request->repeats, sizeof *rows);
    struct chart_head *head = calloc(1, sizeof *head);
    int status = rows && head ? 0 : complain("chart", "memory ran out");
    if (status == 0 && request->peers)
        status = chart_peers_check(scene, request->peers);
    if (status == 0)
        status = open_trace(request, scene, &trace);
    for (int i = 0; status == 0 && i < FILES; i++)
        status = check_output(request->path[i]);
    if (status == 0)
        status = measure(request, scene, &trace, head, rows);
    if (status == 0)
        status = write_files(request, head, rows);
    csv_table_free(&trace);
    for (uint64_t i = 0; rows && i < request->repeats; i++)
        chart_rows_free(&rows[i]);
    free(rows);
    free(head);
    return status;
}

/* After scene_def_read. Returns 0, or 2 after a message. */
static int check_request(struct chart_request *request)
{
    struct scene_def *scene = &request->scene;
    const int is_mesh = !scene->file && !scene_listed(scene->path);
    static const enum chart_part parts[] = { CHART_FORCE, CHART_PAIR, CHART_CONTACT };
    const int has_length = !isnan(scene->length);
    const double stiffness = scene->force.stiffness;
    if (!request->trace && (request->ticks < TICKS_MIN || request->ticks > TICKS_MAX))
        return complain("chart", "--ticks must be %d to %d", TICKS_MIN, TICKS_MAX);
    if (request->passes < 1 || request->passes > PASSES_MAX)
        return complain("chart", "--passes must be 1 to %d", PASSES_MAX);
    request->last = parts[word_index(request->until, until_words)];
    if (request->repeats < 1 || request->repeats > CHART_REPEATS_MAX)
        return complain("chart", "--repeats must be 1 to %d", CHART_REPEATS_MAX);
    if (!(stiffness >= 0.0 && stiffness <= 1e9))
        return complain("chart", "--stiffness must be 0 to 1e9");
    if (scene->force.friction < 0.0 || scene->force.friction > 10.0)
        return complain("chart", "--friction must be 0 to 10");
    if (has_length && !(scene->length >= 0.0 && scene->length <= DPT_COORDINATE_MAX))
        return complain("chart", "--length must be 0 to 1e6");
    if (!isnan(scene->radius) && !(scene->radius >= 0.0 && scene->radius <= 1.0))
        return complain("chart", "--radius must be 0 to 1");
    if (!strcmp(request->name, "-") || strlen(request->name) + 20 > NAME_ROOM)
        return complain("chart", "-o takes a name, of %d files", FILES);
    if (complete_scene_def(scene, NULL))
        return 2;
    request->stylus = is_mesh && !has_length ? 0.0 : scene->length;
    const char *const traces[] = { request->trace, NULL };
    int status = 0;
    for (int i = 0; status == 0 && i < FILES; i++) {
        snprintf(request->path[i], NAME_ROOM, "%s%s", request->name, endings[i]);
        status = check_scene_output(scene, request->path[i]) || output_check("chart", request->path[i], traces) ? 2 : 0;
    }
    return status;
}

int command_chart(int argc, char **argv)
{
    struct chart_request request = {
        .ticks = TICKS_MIN, .seed = 1, .passes = 3, .repeats = 1, .until = until_words[0]
    };
    const char *operand[2] = { NULL, NULL };
    size_t operands;
    struct scene scene;
    const struct option_def options[] = { { .name = "-o", .text = &request.name, .kind = VALUE_FILE },
                                          { .name = "--ticks", .count = &request.ticks },
                                          { .name = "--seed", .count = &request.seed },
                                          { .name = "--length", .number = &request.scene.length },
                                          { .name = "--radius", .number = &request.scene.radius },
                                          { .name = "--tool", .text = &request.scene.tool, .kind = VALUE_FILE },
                                          { .name = "--stiffness", .number = &request.scene.force.stiffness },
                                          { .name = "--friction", .number = &request.scene.force.friction },
                                          { .name = "--until", .text = &request.until, .words = until_words },
                                          { .name = "--passes", .count = &request.passes },
                                          { .name = "--repeats", .count = &request.repeats },
                                          { .name = "--peers", .text = &request.peers, .kind = VALUE_FILE },
                                          { .name = "--title", .text = &request.title },
                                          { .name = "--json", .flag = &request.json } };
    scene_def_init(&request.scene, "chart");
    static const struct operand_def taken[] = { { .kind = VALUE_SCENE }, { .kind = VALUE_FILE } };
    int status = parse_options(argc, argv, COMMAND_SYNTAX(options, help, taken), operand, 2, &operands);
    if (status >= 0)
        return status;
    if (!operands || !request.name)
        return complain("chart", "a scene, SCENE.json, MESH.dpa or ARM.dpa, and -o NAME are needed (see --help)");
    request.scene.path = operand[0];
    request.trace = operand[1];
    status = read_scene_def(&request.scene) || check_request(&request) ? 2 : 0;
    if (status == 0) {
        status = open_scene(&scene, &request.scene);
        if (status == 0)
            status = chart(&request, &scene);
        scene_close(&scene);
    }
    scene_def_free(&request.scene);
    return status;
}
