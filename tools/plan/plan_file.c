/* SPDX-License-Identifier: BSD-3-Clause */
#include "plan/plan_file.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "built_with.h"
#include "cli/command_options.h"
#include "cli/json_text.h"
#include "cli/law_name.h"
#include "scene/setting_words.h"

void plan_free(struct plan *plan)
{
    free(plan->scene);
    free(plan->motion.file);
    free(plan->device);
    memset(plan, 0, sizeof *plan);
}

char *copy_text(const char *text)
{
    char *copy = malloc(strlen(text) + 1);
    return copy ? strcpy(copy, text) : NULL;
}

uint64_t plan_unknown_limit(uint64_t ticks)
{
    return ticks / PLAN_UNKNOWN_ONE_IN;
}

enum plan_bound plan_judge(const struct plan_limits *limits, const struct plan_figures *figures, int with_time)
{
    const int is_broken[PLAN_BOUNDS] = {
        [PLAN_STEPS] = figures->failed > 0,
        [PLAN_BITS] = limits->same_bits && (figures->distance_error > 0.0 || figures->force_error > 0.0),
        [PLAN_DISTANCE] = !(figures->distance_error <= limits->error),
        [PLAN_FORCE] = !(figures->force_error <= limits->force_error),
        [PLAN_UNKNOWN] = figures->unknown > plan_unknown_limit(figures->ticks),
        [PLAN_CONTACTS] = figures->contacts > limits->contacts,
        [PLAN_STRIP] = figures->strip >= limits->strip && figures->strip,
        [PLAN_WORK] = figures->work_p999 > limits->work,
        [PLAN_TIME] = with_time && figures->time_p999 > limits->time,
    };
    for (int bound = PLAN_STEPS; bound < PLAN_BOUNDS; bound++)
        if (is_broken[bound])
            return (enum plan_bound)bound;
    return PLAN_HOLDS;
}

struct plan_text plan_broken_text(const struct plan_limits *limits, const struct plan_figures *figures,
                                  enum plan_bound bound)
{
    struct plan_text out = { "" };
    char *text = out.text;
    const size_t room = sizeof out.text;
    switch (bound) {
    case PLAN_STEPS:
        snprintf(text, room, "steps fail, %" PRIu64 " of %" PRIu64 " ticks", figures->failed, figures->ticks);
        break;
    case PLAN_BITS:
        snprintf(text, room, "answers change, by up to %.2g mm and %.2g N", 1e3 * figures->distance_error,
                 figures->force_error);
        break;
    case PLAN_DISTANCE:
        snprintf(text, room, "the distance is %.3g mm off, at most %.3g mm", 1e3 * figures->distance_error,
                 1e3 * limits->error);
        break;
    case PLAN_FORCE:
        snprintf(text, room, "the force is %.3g N off, at most %.3g N", figures->force_error, limits->force_error);
        break;
    case PLAN_UNKNOWN:
        snprintf(text, room, "%" PRIu64 " of %" PRIu64 " ticks are unknown, at most %" PRIu64, figures->unknown,
                 figures->ticks, plan_unknown_limit(figures->ticks));
        break;
    case PLAN_CONTACTS:
        snprintf(text, room, "%" PRIu32 " contacts in a tick, room for %" PRIu32, figures->contacts, limits->contacts);
        break;
    case PLAN_STRIP:
        snprintf(text, room, "%" PRIu32 " triangles in a strip, room for %" PRIu32, figures->strip, limits->strip);
        break;
    case PLAN_WORK:
        snprintf(text, room, "%.0f units at 99.9 %%, at most %.0f", figures->work_p999, limits->work);
        break;
    case PLAN_TIME:
        snprintf(text, room, "ticks take %.3g ms at 99.9 %%, at most %.3g ms%s", 1e3 * figures->time_p999,
                 1e3 * limits->time,
                 plan_was_busy(figures) ? ", and this machine was busy: try again with less beside it" : "");
        break;
    default:
        snprintf(text, room, "nothing is broken");
    }
    return out;
}

static uint32_t grown(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

void plan_figures_join(struct plan_figures *figures, const struct plan_figures *other)
{
    figures->ticks += other->ticks;
    figures->failed += other->failed;
    figures->felt += other->felt;
    figures->near_folds += other->near_folds;
    figures->unknown += other->unknown;
    figures->work_total += other->work_total;
    figures->distance_error = fmax(figures->distance_error, other->distance_error);
    figures->force_error = fmax(figures->force_error, other->force_error);
    figures->contacts = grown(figures->contacts, other->contacts);
    figures->strip = grown(figures->strip, other->strip);
    figures->work = grown(figures->work, other->work);
    figures->work_p999 = fmax(figures->work_p999, other->work_p999);
    figures->time_median = fmax(figures->time_median, other->time_median);
    figures->time_p999 = fmax(figures->time_p999, other->time_p999);
    figures->busy = fmax(figures->busy, other->busy);
    figures->bytes = figures->bytes > other->bytes ? figures->bytes : other->bytes;
}

#ifdef DPT_HAS_JANSSON

#include "scene/json_value.h"

enum { PLAN_BYTES_MAX = 1 << 20 };

int plan_file_read(struct plan *plan, const char *command, const char *path)
{
    struct json_fault fault;
    dpt_host_error error = { .size = sizeof error };
    size_t size;
    memset(plan, 0, sizeof *plan);
    char *bytes = load_file(command, path, &size);
    if (!bytes)
        return 2;
    int status = size > PLAN_BYTES_MAX ? complain(command, "%s: a plan has at most %d bytes", path, PLAN_BYTES_MAX) : 0;
    if (status == 0 && !plan_file_parse(plan, bytes, size, &fault))
        status = complain_of(command, json_fault_refuse(&fault, path, &error), &error);
    free(bytes);
    return status;
}

#else

int plan_file_read(struct plan *plan, const char *command, const char *path)
{
    memset(plan, 0, sizeof *plan);
    return complain(command, "%s: this build reads no plans: install libjansson-dev and pkg-config, and build it again",
                    path);
}

#endif

const char *const plan_integrator_words[] = { "symplectic", "euler", "implicit", "scene", NULL };
const char *const plan_bound_words[] = { "none",     "steps", "bits", "distance", "force", "unknown",
                                         "contacts", "strip", "work", "time",     NULL };
const char *const plan_trace_words[] = { "first half",   "second half",  "second half, backwards",
                                         "another seed", "a third seed", NULL };

static void write_pair(FILE *file, const char *before, const char *key, const char *text)
{
    fprintf(file, "%s\"%s\": ", before, key);
    json_write_text(file, text);
}

static void write_setting(FILE *file, const char *indent, const struct measure_setting *setting)
{
    const dpt_world_def *world = &setting->world;
    const int scene = setting->integrator < 0;
    const char *between = "";
    fprintf(
        file,
        "{ \"law\": \"%s\", \"stiffness\": %.17g, \"damping\": %.17g, \"lock_rotation\": %" PRIu32 ", \"dt\": %.17g,\n"
        "%s  \"until\": \"%s\", \"budget\": %" PRIu32 ", \"sweep_budget\": %" PRIu32 ", \"certificate_bytes\": %" PRIu64
        ", \"margin\": %.17g,\n"
        "%s  \"max_contacts\": %" PRIu32 ", \"smooth_normals\": %" PRIu32
        ", \"strip\": \"%s\", \"strip_capacity\": %" PRIu32 ",\n%s  ",
        law_name(world->law), world->stiffness, setting->damping, setting->lock_rotation, setting->dt, indent,
        until_words[world->until], world->budget, world->sweep_budget, world->certificate_bytes, world->margin, indent,
        world->max_contacts, world->smooth_normals, strip_words[world->strip], world->strip_capacity, indent);
    if (!isnan(setting->friction))
        fprintf(file, "\"friction\": %.17g, ", setting->friction);
    fprintf(file, "\"integrator\": \"%s\", \"iterations\": %" PRIu32 ", \"rigid\": [",
            plan_integrator_words[scene ? 3 : setting->integrator], setting->iterations);
    for (unsigned body = 0; body < 64; body++) {
        if (!(setting->rigid >> body & 1))
            continue;
        fprintf(file, "%s%u", between, body);
        between = ", ";
    }
    fprintf(file, "] }");
}

static void write_figures(FILE *file, const char *indent, const struct plan_figures *figures)
{
    fprintf(file,
            "{ \"ticks\": %" PRIu64 ", \"failed\": %" PRIu64
            ", \"distance_error\": %.17g, \"force_error\": %.17g,\n%s  \"felt\": %" PRIu64 ", \"near_folds\": %" PRIu64
            ", \"unknown\": %" PRIu64 ", \"contacts\": %" PRIu32 ", \"strip\": %" PRIu32 ", \"work\": %" PRIu32
            ", \"work_p999\": %.17g,\n%s  \"work_total\": %" PRIu64
            ", \"time_median\": %.17g, \"time_p999\": %.17g, \"bytes\": %" PRIu64 " }",
            figures->ticks, figures->failed, figures->distance_error, figures->force_error, indent, figures->felt,
            figures->near_folds, figures->unknown, figures->contacts, figures->strip, figures->work, figures->work_p999,
            indent, figures->work_total, figures->time_median, figures->time_p999, figures->bytes);
}

static void write_neighbour(FILE *file, const char *key, const struct plan_neighbour *neighbour)
{
    if (!neighbour->knob[0])
        return;
    fprintf(file, ",\n  \"%s\": {\n", key);
    write_pair(file, "    ", "knob", neighbour->knob);
    write_pair(file, ", ", "value", neighbour->value);
    fprintf(file, ", \"breaks\": \"%s\", \"trace\": \"%s\",\n    \"setting\": ", plan_bound_words[neighbour->broken],
            plan_trace_words[neighbour->trace]);
    write_setting(file, "    ", &neighbour->setting);
    fprintf(file, ",\n    \"figures\": ");
    write_figures(file, "    ", &neighbour->figures);
    fprintf(file, " }");
}

static void write_scene(FILE *file, const struct plan *plan)
{
    write_pair(file, "  ", "scene", plan->scene);
    fprintf(file, ",\n  \"scene_bytes\": %" PRIu64 ", \"scene_crc32\": \"%08" PRIx32 "\"", plan->identity.bytes,
            plan->identity.crc32);
    if (!isnan(plan->length))
        fprintf(file, ", \"length\": %.17g, \"radius\": %.17g", plan->length, plan->radius);
    fprintf(file, ",\n  \"meshes\": [");
    for (uint32_t i = 0; i < plan->mesh_count; i++)
        fprintf(file, "%s{ \"triangles\": %" PRIu32 ", \"crc32\": \"%08" PRIx32 "\" }", i ? ", " : "",
                plan->mesh[i].triangles, plan->mesh[i].crc32);
    fprintf(file, "],\n  \"motion\": { ");
    if (plan->motion.file) {
        write_pair(file, "", "file", plan->motion.file);
        fprintf(file, ", ");
    }
    fprintf(file, "\"seed\": %" PRIu64 ", \"ticks\": %" PRIu64 ", \"speed\": %.17g },\n", plan->motion.seed,
            plan->motion.ticks, plan->motion.speed);
}

static void write_promise(FILE *file, const struct plan *plan)
{
    const struct plan_limits *limits = &plan->limits;
    fprintf(file, "  \"promises\": { \"distance\": %.17g, ", limits->error);
    if (limits->force_error < INFINITY)
        fprintf(file, "\"force\": %.17g, ", limits->force_error);
    fprintf(file,
            "\"unknown_one_in\": %d, \"contacts\": %" PRIu32 ", \"strip\": %" PRIu32
            ", \"work_p999\": %.17g, \"time_p999\": %.17g, \"speed\": %.17g",
            PLAN_UNKNOWN_ONE_IN, limits->contacts, limits->strip, limits->work, limits->time,
            PLAN_SPEED_FACTOR * plan->motion.speed);
    if (plan->stable > 0.0)
        fprintf(file, ", \"gain_margin\": %g", PLAN_GAIN_MARGIN);
    fprintf(file,
            " },\n  \"does_not_promise\": [\"motions faster than the speed above\", \"bodies, tools "
            "and contacts that its trace has not met\", \"times on another machine, or beside other work\", \"%s\"],\n",
            plan->stable > 0.0 ? "stability with another device, or another hand than the coupling's margin allows"
                               : "stability: no identified device was given");
}

void plan_file_write(FILE *file, const struct plan *plan)
{
    const struct measure_machine *machine = &plan->machine;
    fprintf(file, "{\n  \"dynpoint_plan\": %d,\n", PLAN_FORMAT);
    write_scene(file, plan);
    fprintf(file, "  \"asked\": { \"error\": %.17g, ", plan->asked.error);
    if (plan->asked.force_error < INFINITY)
        fprintf(file, "\"force_error\": %.17g, ", plan->asked.force_error);
    fprintf(file, "\"rate\": %.17g },\n", plan->asked.rate);
    fprintf(file, "  \"thinnest_wall\": %.17g, \"quantum\": %.17g,\n", plan->thinnest, plan->quantum);
    if (plan->device) {
        write_pair(file, "  ", "device", plan->device);
        fprintf(file, ", \"stable\": %.17g,\n", plan->stable);
    }
    fprintf(file, "  \"setting\": ");
    write_setting(file, "  ", &plan->setting);
    fprintf(file, ",\n");
    write_promise(file, plan);
    fprintf(file, "  \"measured\": ");
    write_figures(file, "  ", &plan->figures);
    write_pair(file, ",\n  \"machine\": { ", "processor", machine->processor);
    write_pair(file, ", ", "system", machine->system);
    write_pair(file, ", ", "kernel", machine->kernel);
    write_pair(file, ", ", "compiler", machine->compiler);
    write_pair(file, ", ", "version", machine->version);
    fprintf(file, " }");
    write_neighbour(file, "cheaper", &plan->cheaper);
    write_neighbour(file, "better", &plan->better);
    fprintf(file, "\n}\n");
}
