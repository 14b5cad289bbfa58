/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint plan: no more than a scene needs, from measurement. */
#include "cli/cmd_plan.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command_options.h"
#include "cli/commands.h"
#include "cli/force_check.h"
#include "cli/scene_command.h"
#include "dynpoint/identify.h"
#include "host/host_coupling.h"
#include "measure/measure_setting.h"
#include "plan/plan_file.h"
#include "plan/plan_report.h"
#include "plan/plan_trace.h"
#include "run/run_settings.h"
#include "shape/mesh_size.h"
#include "text/parse_number.h"

static const char help[] =
    "usage: dynpoint plan SCENE|SCENE.json|MESH.dpa --error E [--force-error F] [options]\n"
    "\n"
    "Finds the cheapest setting with which a scene is felt within bounds: measures the richest one\n"
    "over half of a trace, takes away one thing after another, keeps what holds, and verifies that\n"
    "on the other half, forwards, and backwards 1.5 times as fast. Says what was chosen, what the\n"
    "next cheaper setting breaks, and what the next better one costs. Exit status 1 with the bound\n"
    "that cannot be kept, if nothing keeps all of them (docs/plan.md).\n"
    "\n"
    "  --error E        of distances, as 0.1mm\n"
    "  --force-error F  of the wrench, as 0.05N, against the richest setting of the same law; without\n"
    "                   it no force is needed\n"
    "  --rate R         of the loop, as 1kHz; default 1000\n"
    "  --law LAW        proxy, bed or point: what is felt is asked for, not chosen; default the\n"
    "                   scene's\n"
    "  --stiffness K    of the force, N/m; default as stiff as the device holds, or 500\n"
    "  --device FILE    dynamics of the device, that device identify -o wrote: how stiff it can be\n"
    "                   held with a gain margin of 1.5\n"
    "  --friction MU, --damping B, --length L, --radius R\n"
    "                   as of dynpoint run\n"
    "  --smooth-normals contacts and force have normals without facets\n"
    "  --trace T.csv    motion of the tool, a row a tick at that rate, at least 10,000; default:\n"
    "                   a hand slides over each body\n"
    "  --seed S         of that hand; default 1\n"
    "  --ticks N        of its trace, at least 10,000; default 20,000\n"
    "  -o FILE          the plan, for replay --plan and run --plan\n"
    "  --header H.h     the same as C: fills in the world, bodies and the tool\n"
    "  --json           what is told as one JSON object on standard output: the plan, and what was\n"
    "                   refused; or the bound that cannot be kept\n";

enum { TICKS_LEAST = 10000 };

/* N/m: where neither a stiffness nor a device is given; as of dynpoint replay. */
#define STIFFNESS_USUAL 500.0

struct plan_options {
    struct scene_def scene;
    const char *error, *force_error, *rate, *stiffness, *device, *trace, *out, *header, *law;
    uint64_t seed, ticks;
    int smooth, json;
};

/* Returns 0, or 2 after a message. */
static int read_bounds(const struct plan_options *options, struct plan *plan, double *stiffness)
{
    struct plan_asked *asked = &plan->asked;
    *asked = (struct plan_asked){ .force_error = INFINITY, .rate = 1000.0 };
    *stiffness = NAN;
    if (!options->error)
        return complain("plan", "--error is needed: by how much a distance may be off, as 0.1mm");
    if (quantity_read("plan", "--error", options->error, QUANTITY_LENGTH, &asked->error) ||
        (options->force_error &&
         quantity_read("plan", "--force-error", options->force_error, QUANTITY_FORCE, &asked->force_error)) ||
        (options->rate && quantity_read("plan", "--rate", options->rate, QUANTITY_RATE, &asked->rate)) ||
        (options->stiffness && quantity_read("plan", "--stiffness", options->stiffness, QUANTITY_STIFFNESS, stiffness)))
        return 2;
    if (!(asked->error > 0.0 && asked->error <= DPT_COORDINATE_MAX))
        return complain("plan", "--error must be above 0, at most 1e6 m");
    if (!(asked->force_error > 0.0))
        return complain("plan", "--force-error must be above 0");
    if (!(asked->rate >= 10.0 && asked->rate <= 1e5))
        return complain("plan", "--rate must be 10 to 100000 Hz");
    if (options->stiffness && !(*stiffness > 0.0 && *stiffness <= 1e9))
        return complain("plan", "--stiffness must be above 0, at most 1e9 N/m");
    if (options->ticks < TICKS_LEAST || options->ticks > 100000000)
        return complain("plan", "--ticks must be 10000 to 100000000: fewer say nothing of 1 in 10,000");
    return 0;
}

/* Returns -1 to go on, else the exit status. */
static int read_options(int argc, char **argv, struct plan_options *options, struct plan *plan, double *stiffness)
{
    size_t operands;
    struct scene_def *scene = &options->scene;
    const struct option_def defs[] = {
        { .name = "--error", .text = &options->error },
        { .name = "--force-error", .text = &options->force_error },
        { .name = "--rate", .text = &options->rate },
        { .name = "--law", .text = &options->law, .words = law_names },
        { .name = "--stiffness", .text = &options->stiffness },
        { .name = "--device", .text = &options->device, .kind = VALUE_FILE },
        { .name = "--friction", .number = &scene->force.friction },
        { .name = "--damping", .number = &scene->force.damping },
        { .name = "--length", .number = &scene->length },
        { .name = "--radius", .number = &scene->radius },
        { .name = "--smooth-normals", .flag = &options->smooth },
        { .name = "--trace", .text = &options->trace, .kind = VALUE_FILE },
        { .name = "--seed", .count = &options->seed },
        { .name = "--ticks", .count = &options->ticks },
        { .name = "-o", .text = &options->out, .kind = VALUE_FILE },
        { .name = "--header", .text = &options->header, .kind = VALUE_FILE },
        { .name = "--json", .flag = &options->json },
    };
    static const struct operand_def taken[] = { { .kind = VALUE_SCENE } };
    int status = parse_options(argc, argv, COMMAND_SYNTAX(defs, help, taken), &scene->path, 1, &operands);
    if (status >= 0)
        return status;
    if (operands != 1)
        return complain("plan", "a scene, SCENE.json or MESH.dpa is needed (see --help)");
    if (read_bounds(options, plan, stiffness) || read_scene_def(scene) || complete_scene_def(scene, options->law))
        return 2;
    if (force_options_check("plan", &scene->force))
        return 2;
    if (!(scene->length >= 0.0 && scene->length <= 10.0) || !(scene->radius >= 0.0 && scene->radius <= 1.0))
        return complain("plan", "--length must be 0 to 10, --radius 0 to 1");
    const char *const outputs[] = { options->out, options->header };
    const char *const inputs[] = { options->trace ? options->trace : scene->path, options->device, NULL };
    for (int i = 0; i < 2; i++)
        if (outputs[i] && (check_scene_output(scene, outputs[i]) || output_check("plan", outputs[i], inputs)))
            return 2;
    if ((options->out && output_check_name("plan", options->out, ".json", "a plan in JSON")) ||
        (options->header && output_check_name("plan", options->header, ".h .c", "source text in C")))
        return 2;
    for (int i = 0; i < 2; i++)
        if (options->json && outputs[i] && !strcmp(outputs[i], "-"))
            return complain("plan", "--json and %s - both want standard output", i ? "--header" : "-o");
    if (options->out && options->header && !strcmp(options->out, options->header))
        return complain("plan", "-o and --header name the same file");
    return -1;
}

/* Why a device cannot be held as stiffly as was asked for. */
static struct plan_text limit_text(const dpt_coupling *coupling, double asked)
{
    struct plan_text said;
    char *text = said.text;
    const size_t room = sizeof said.text;
    switch (coupling->limit) {
    case DPT_COUPLING_STEP:
        snprintf(text, room, "K %g: the device's steps would be felt above %.4g N/m", asked, coupling->stiffness);
        break;
    case DPT_COUPLING_MAKER:
        snprintf(text, room, "K %g: the device's maker states no more than %.4g N/m", asked, coupling->stiffness);
        break;
    case DPT_COUPLING_UNKNOWN:
        snprintf(text, room, "K %g: the device's mass or damping is not known: dynpoint device identify measures them",
                 asked);
        break;
    default:
        if (coupling->delay_needed > 0.0)
            snprintf(text, room, "K %g needs T/2 + t_d <= %.3g ms; you have %.3g", asked, 1e3 * coupling->delay_needed,
                     1e3 * coupling->delay);
        else
            snprintf(text, room, "K %g: no rate holds it with this device; it is held by %.4g N/m", asked,
                     coupling->stiffness);
    }
    return said;
}

/* The stiffness, from the device if there is one. Returns 0, 1 if it cannot be had, or 2 after a message. */
static int choose_stiffness(struct plan *plan, const struct scene *scene, const char *device, double asked, int json)
{
    dpt_device_info info = { .size = sizeof info };
    dpt_device_error error = { .size = sizeof error };
    dpt_coupling coupling;
    dpt_host_error said = { .size = sizeof said };
    plan->setting.world.stiffness = isnan(asked) ? STIFFNESS_USUAL : asked;
    if (!device)
        return 0;
    if (dpt_device_dynamics_read(device, &info, &error) != DPT_OK)
        return complain("plan", "%s", error.text);
    info.wrench_dofs = info.inertia > 0.0 ? 6 : 3;
    const struct coupling_options options = { .stiffness = asked,
                                              .gain_margin = PLAN_GAIN_MARGIN,
                                              .rate = plan->asked.rate,
                                              .loop_delay = HOST_LOOP_DELAY_PERIODS / plan->asked.rate };
    const struct coupled_tool tool = host_coupled_tool(scene);
    if (complain_of("plan", host_coupling_find(&tool, &info, &options, &coupling, &said), &said))
        return 2;
    if (!isnan(asked) && coupling.limit != DPT_COUPLING_ASKED) {
        const struct plan_text why = limit_text(&coupling, asked);
        if (json)
            plan_report_limit_json(stdout, why.text);
        else
            puts(why.text);
        return 1;
    }
    plan->setting.world.stiffness = coupling.stiffness;
    plan->setting.lock_rotation = info.wrench_dofs < 6;
    plan->stable = coupling.stable;
    plan->quantum = info.position_step * scene->zoom;
    plan->device = copy_text(device);
    return plan->device ? 0 : complain("plan", "memory ran out");
}

/* The thinnest wall of all bodies; 0: there is none. Returns 0, or 2 after a message. */
static int measure_walls(struct plan *plan, const struct scene *scene)
{
    for (uint32_t i = 0; i < scene->bodies.count; i++) {
        struct mesh_thickness found;
        if (mesh_thickness_measure("plan", scene->bodies.body[i].mesh, &found))
            return 2;
        if (found.walls && (plan->thinnest == 0.0 || found.min < plan->thinnest))
            plan->thinnest = found.min;
    }
    return 0;
}

/* Where contact begins: what a tick of the fastest motion may skip, but well below the thinnest wall. */
static void choose_margin(struct plan *plan)
{
    const double reach = PLAN_SPEED_FACTOR * plan->motion.speed / plan->asked.rate + plan->quantum;
    plan->setting.world.margin = plan->thinnest > 0.0 ? fmin(reach, plan->thinnest / 3.0) : reach;
}

static int open_trace(const struct plan_options *options, struct plan *plan, const struct scene *scene,
                      struct csv_table *trace)
{
    plan->motion.seed = options->seed;
    if (options->trace) {
        plan->motion.file = copy_text(options->trace);
        if (!plan->motion.file)
            return complain("plan", "memory ran out");
        if (measure_trace_read(trace, scene, options->trace, TICKS_LEAST))
            return 2;
    } else if (plan_trace_make(trace, scene, options->seed, options->ticks, plan->asked.rate, 0.0)) {
        return 2;
    }
    plan->motion.ticks = options->trace ? trace->rows : options->ticks;
    plan->motion.speed = plan_trace_speed(trace, 1.0 / plan->asked.rate);
    return 0;
}

static int write_file(const char *path, const struct plan *plan, const struct scene *scene, int is_header)
{
    struct output output;
    if (output_open(&output, "plan", path))
        return 2;
    if (is_header)
        plan_header_write(output.file, plan, scene);
    else
        plan_file_write(output.file, plan);
    return output_close(&output, "plan");
}

static int finish(const struct plan_options *options, const struct plan *plan, const struct plan_search *search,
                  const struct scene *scene)
{
    int status = 0;
    if (options->out)
        status = write_file(options->out, plan, scene, 0);
    if (status == 0 && options->header)
        status = write_file(options->header, plan, scene, 1);
    if (status == 0 && options->json)
        return plan_report_json(stdout, plan, search) ? complain("plan", "--json: no temporary file can be made") : 0;
    if (status == 0 && (!options->out || strcmp(options->out, "-")) &&
        (!options->header || strcmp(options->header, "-")))
        plan_report(stdout, plan, search, scene);
    return status;
}

static int make_plan(const struct plan_options *options, struct plan *plan, double stiffness)
{
    struct scene scene;
    struct csv_table trace = { .rows = 0 };
    struct plan_search search;
    struct plan_text limit;
    memset(&search, 0, sizeof search);
    int status = open_scene(&scene, &options->scene);
    if (status == 0) {
        measure_setting_init(&plan->setting, &scene);
        plan->setting.dt = 1.0 / plan->asked.rate;
        plan->setting.world.smooth_normals = (uint32_t)options->smooth;
        plan->scene = copy_text(options->scene.path);
        plan->identity = scene.file;
        plan->length = scene.has_stylus ? scene.length : NAN;
        plan->radius = scene.has_stylus ? options->scene.radius : NAN;
        plan_meshes_of(plan, &scene);
        status = plan->scene ? choose_stiffness(plan, &scene, options->device, stiffness, options->json)
                             : complain("plan", "memory ran out");
    }
    if (status == 0)
        status = measure_walls(plan, &scene);
    if (status == 0)
        status = open_trace(options, plan, &scene, &trace);
    if (status == 0) {
        choose_margin(plan);
        status = plan_search(&search, plan, &scene, &trace, &limit);
        if (status == 1 && options->json)
            plan_report_limit_json(stdout, limit.text);
        else if (status == 1)
            printf("no setting keeps all bounds: %s\n", limit.text);
    }
    if (status == 0) {
        measure_machine_read(&plan->machine, search.bench[0].reference.kernel);
        status = finish(options, plan, &search, &scene);
    }
    plan_search_close(&search);
    csv_table_free(&trace);
    scene_close(&scene);
    return status;
}

int command_plan(int argc, char **argv)
{
    struct plan_options options = { .seed = 1, .ticks = 20000 };
    struct plan plan;
    double stiffness;
    memset(&plan, 0, sizeof plan);
    scene_def_init(&options.scene, "plan");
    int status = read_options(argc, argv, &options, &plan, &stiffness);
    if (status < 0)
        status = make_plan(&options, &plan, stiffness);
    plan_free(&plan);
    scene_def_free(&options.scene);
    return status;
}

static const struct unit {
    enum quantity_kind kind;
    const char *word;
    double size;
} units[] = {
    { QUANTITY_LENGTH, "m", 1.0 },       { QUANTITY_LENGTH, "cm", 1e-2 }, { QUANTITY_LENGTH, "mm", 1e-3 },
    { QUANTITY_LENGTH, "um", 1e-6 },     { QUANTITY_FORCE, "N", 1.0 },    { QUANTITY_FORCE, "mN", 1e-3 },
    { QUANTITY_RATE, "Hz", 1.0 },        { QUANTITY_RATE, "kHz", 1e3 },   { QUANTITY_STIFFNESS, "N/m", 1.0 },
    { QUANTITY_STIFFNESS, "N/mm", 1e3 },
};
enum { UNITS = sizeof units / sizeof *units };

int quantity_read(const char *command, const char *option, const char *text, enum quantity_kind kind, double *value)
{
    static const char *const known[] = { "m, cm, mm or um", "N or mN", "Hz or kHz", "N/m or N/mm" };
    const char *unit = parse_double(text, text + strlen(text), value);
    if (!unit)
        return complain(command, "%s: '%s' is not a number", option, text);
    while (*unit == ' ')
        unit++;
    for (int i = 0; *unit && i < UNITS; i++)
        if (units[i].kind == kind && !strcmp(unit, units[i].word)) {
            *value *= units[i].size;
            return 0;
        }
    return *unit ? complain(command, "%s: '%s' is not in %s", option, text, known[kind]) : 0;
}
