/* SPDX-License-Identifier: BSD-3-Clause */
#include "plan/plan_file.h"

#include <inttypes.h>
#include <math.h>

#include "cli/json_text.h"
#include "cli/law_name.h"
#include "cli/setting_words.h"

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
    fprintf(file,
            "{ \"law\": \"%s\", \"stiffness\": %.17g, \"damping\": %.17g, \"lock_rotation\": %" PRIu32
            ", \"dt\": %.17g,\n%s  "
            "\"until\": \"%s\", \"budget\": %" PRIu32 ", \"sweep_budget\": %" PRIu32 ", \"certificate_bytes\": %" PRIu64
            ", \"margin\": %.17g,\n%s  \"max_contacts\": %" PRIu32 ", \"smooth_normals\": %" PRIu32
            ", \"strip\": \"%s\", \"strip_capacity\": %" PRIu32 ",\n%s  ",
            law_name(world->law), world->stiffness, setting->damping, setting->lock_rotation, setting->dt, indent,
            until_words[world->until], world->budget, world->sweep_budget, world->certificate_bytes, world->margin,
            indent, world->max_contacts, world->smooth_normals, strip_words[world->strip], world->strip_capacity,
            indent);
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
