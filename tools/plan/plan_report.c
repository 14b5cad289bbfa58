/* SPDX-License-Identifier: BSD-3-Clause */
#include "plan/plan_report.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "cli/json_text.h"
#include "cli/law_name.h"
#include "plan/plan_file.h"
#include "plan/plan_knobs.h"

void plan_report_head(FILE *file)
{
    fprintf(file, "\n  %-30s %11s %9s %8s %16s %17s %9s\n", "", "distance", "force", "unknown", "units a tick",
            "us a tick", "bytes");
    fprintf(file, "  %-30s %11s %9s %8s %8s %7s %8s %8s\n", "", "error, mm", "error, N", "", "99.9 %", "most", "median",
            "99.9 %");
}

void plan_report_figures(FILE *file, const char *what, const struct plan_figures *figures)
{
    fprintf(file, "  %-30s %11.3g %9.3g %8" PRIu64 " %8.0f %7" PRIu32 " %8.3g %8.3g %9" PRIu64 "\n", what,
            1e3 * figures->distance_error, figures->force_error, figures->unknown, figures->work_p999, figures->work,
            1e6 * figures->time_median, 1e6 * figures->time_p999, figures->bytes);
}

void plan_report_busy(FILE *file, const struct plan_figures *figures)
{
    if (plan_was_busy(figures))
        fprintf(
            file,
            "  this machine was busy: all took %.2f times as long by the clock as of the processor's time, by which "
            "ticks are judged\n",
            figures->busy);
}

static void report_asked(FILE *file, const struct plan *plan, const struct plan_figures *richest)
{
    fprintf(file, "  asked for: distances within %g mm", 1e3 * plan->asked.error);
    if (plan->asked.force_error < INFINITY)
        fprintf(file, ", the wrench within %g N of the richest setting's", plan->asked.force_error);
    else
        fprintf(file, ", no force");
    fprintf(file, ";\n  at most 1 tick in %d unknown; 99.9 %% of ticks within half a period, %g ms\n",
            PLAN_UNKNOWN_ONE_IN, 1e3 * PLAN_TIME_SHARE / plan->asked.rate);
    fprintf(file, "  measured over %" PRIu64 " ticks of ", plan->motion.ticks);
    if (plan->motion.file)
        fprintf(file, "%s", plan->motion.file);
    else
        fprintf(file, "a made trace, seed %" PRIu64, plan->motion.seed);
    fprintf(file,
            ", up to %.3g m/s: the first half to choose by,\n"
            "  the second and that one backwards %g times as fast%s to verify\n",
            plan->motion.speed, PLAN_SPEED_FACTOR, plan->motion.file ? "" : ", and two of other seeds");
    if (plan->asked.force_error < INFINITY)
        fprintf(file, "  a force is felt in %" PRIu64 " of %" PRIu64 " ticks there\n", richest->felt, richest->ticks);
}

static void report_margin(FILE *file, const struct plan *plan)
{
    const double margin = plan->setting.world.margin;
    fprintf(file, "  %-20s %-12.3g ", "margin, mm", 1e3 * margin);
    if (plan->thinnest > 0.0 && 3.0 * margin >= plan->thinnest * (1.0 - 1e-9))
        fprintf(file, "a third of the thinnest wall, %.3g mm; motion asks for more\n", 1e3 * plan->thinnest);
    else
        fprintf(file, "a tick at %g times the speed%s%s\n", PLAN_SPEED_FACTOR,
                plan->quantum > 0.0 ? ", and a step of the device" : "",
                plan->thinnest > 0.0 ? "; below a third of the thinnest wall" : "");
}

static void report_coupling(FILE *file, const struct plan *plan)
{
    fprintf(file, "  %-20s %-12g ", "stiffness, N/m", plan->setting.world.stiffness);
    if (!plan->device)
        fprintf(file, "no --device: nothing is said of stability\n");
    else if (plan->stable > 0.0)
        fprintf(file, "%s holds %.4g N/m at its limit, and this with a gain margin of %g\n", plan->device, plan->stable,
                PLAN_GAIN_MARGIN);
    else
        fprintf(file, "%s: mass or damping is not known\n", plan->device);
}

/* What was refused of a knob, in a line behind its value. */
static void report_refused(FILE *file, const struct plan *plan, const struct plan_search *search, const char *knob)
{
    for (uint32_t i = 0; i < search->refused_count; i++) {
        const struct plan_neighbour *refused = &search->refused[i];
        if (strcmp(refused->knob, knob))
            continue;
        const struct plan_limits limits =
            plan_limits_of(&plan->asked, &refused->setting, &search->bench[refused->trace],
                           refused->broken == PLAN_BITS || refused->broken == PLAN_WORK);
        fprintf(file, "%s: %s", refused->value, plan_broken_text(&limits, &refused->figures, refused->broken).text);
        return;
    }
    if (!strcmp(knob, "budget") && plan->setting.world.budget == PLAN_BUDGET_AMPLE)
        fprintf(file, "of what gives way, rare ticks take many times more than was seen");
    else
        fprintf(file, "-");
}

static void report_knobs(FILE *file, const struct plan *plan, const struct plan_search *search,
                         const struct scene *scene)
{
    fprintf(file, "\n  %-20s %-12s %s\n", "", "chosen", "the next cheaper, and what it breaks");
    for (size_t i = 0; i < plan_knob_count; i++) {
        const struct plan_knob *knob = &plan_knobs[i];
        for (uint32_t body = 0; body < (knob->of_bodies ? scene->bodies.count : 1); body++) {
            char name[48], value[48];
            if (knob->of_bodies && !scene_body_is_soft(&scene->bodies.body[body]))
                continue;
            plan_knob_name(knob, body, name, sizeof name);
            knob->print(&plan->setting, scene, body, value, sizeof value);
            fprintf(file, "  %-20s %-12s ", name, value);
            report_refused(file, plan, search, name);
            fprintf(file, "\n");
        }
    }
    report_margin(file, plan);
    report_coupling(file, plan);
}

void plan_report(FILE *file, const struct plan *plan, const struct plan_search *search, const struct scene *scene)
{
    char what[120];
    fprintf(file, "%s, law %s, at %g Hz\n", plan->scene, law_name(plan->setting.world.law), plan->asked.rate);
    report_asked(file, plan, &search->richest);
    report_knobs(file, plan, search, scene);
    plan_report_head(file);
    plan_report_figures(file, "chosen", &plan->figures);
    plan_report_figures(file, "richest", &search->richest);
    plan_report_figures(file, "chosen, on the first half", &search->first);
    if (plan->cheaper.knob[0]) {
        snprintf(what, sizeof what, "%s %s, there", plan->cheaper.knob, plan->cheaper.value);
        plan_report_figures(file, what, &plan->cheaper.figures);
    }
    if (plan->better.knob[0]) {
        snprintf(what, sizeof what, "%s %s", plan->better.knob, plan->better.value);
        plan_report_figures(file, what, &plan->better.figures);
    }
    plan_report_busy(file, &plan->figures);
    if (plan->cheaper.knob[0])
        fprintf(file, "\n  next cheaper: %s %s breaks the bound '%s' (%s)\n", plan->cheaper.knob, plan->cheaper.value,
                plan_bound_words[plan->cheaper.broken], plan_trace_words[plan->cheaper.trace]);
    else
        fprintf(file, "\n  next cheaper: nothing is left to take away\n");
    if (plan->better.knob[0])
        fprintf(file,
                "  next better: %s %s, without a budget: errors of %.3g mm and %.3g N for %.2f times the units at "
                "99.9 %%\n",
                plan->better.knob, plan->better.value, 1e3 * plan->better.figures.distance_error,
                plan->better.figures.force_error,
                plan->figures.work_p999 > 0.0 ? plan->better.figures.work_p999 / plan->figures.work_p999 : 1.0);
    else
        fprintf(file, "  next better: nothing tells more; the richest has more memory and a larger budget\n");
}

/* A plan's file without its ends of lines, and the blanks that begin a line. No text of JSON has such an end. */
static void copy_in_a_line(FILE *to, FILE *from)
{
    int letter, is_indent = 0;
    while ((letter = getc(from)) != EOF) {
        is_indent = letter == '\n' || (is_indent && letter == ' ');
        if (!is_indent)
            putc(letter, to);
    }
}

int plan_report_json(FILE *file, const struct plan *plan, const struct plan_search *search)
{
    FILE *text = tmpfile();
    if (!text)
        return 1;
    plan_file_write(text, plan);
    rewind(text);
    fputs("{\"limit\":null,\"plan\":", file);
    copy_in_a_line(file, text);
    fclose(text);
    fprintf(file,
            ",\"richest\":{\"distance_error\":%.17g,\"force_error\":%.17g,\"work_p999\":%.17g,\"time_p999\":%.17g},"
            "\"refused\":[",
            search->richest.distance_error, search->richest.force_error, search->richest.work_p999,
            search->richest.time_p999);
    for (uint32_t i = 0; i < search->refused_count; i++) {
        const struct plan_neighbour *refused = &search->refused[i];
        fputs(i ? ",{\"knob\":" : "{\"knob\":", file);
        json_write_text(file, refused->knob);
        fputs(",\"value\":", file);
        json_write_text(file, refused->value);
        fprintf(file, ",\"breaks\":\"%s\",\"where\":\"%s\"}", plan_bound_words[refused->broken],
                plan_trace_words[refused->trace]);
    }
    fputs("]}\n", file);
    return 0;
}

void plan_report_limit_json(FILE *file, const char *limit)
{
    fputs("{\"limit\":", file);
    json_write_text(file, limit);
    fputs(",\"plan\":null}\n", file);
}

static const char *until_name(uint32_t until)
{
    static const char *const names[] = { "DPT_UNTIL_RESPOND", "DPT_UNTIL_TRACK", "DPT_UNTIL_CONTACT" };
    return names[until];
}

static const char *const law_constants[] = { "DPT_LAW_POINT", "DPT_LAW_BED", "DPT_LAW_PROXY" };
static const char *const integrator_constants[] = { "DPT_INTEGRATOR_SYMPLECTIC", "DPT_INTEGRATOR_EULER",
                                                    "DPT_INTEGRATOR_IMPLICIT" };

static void write_intro(FILE *file, const struct plan *plan)
{
    fprintf(file,
            "/*\n * Made by dynpoint plan: the settings of a scene, and what is promised of them.\n"
            " *\n *   distances are within %g m, at most 1 tick in %d is unknown, and 99.9 %% of\n"
            " *   ticks take at most %g s and %.0f units, at %g Hz, for motions of up to %g m/s\n",
            plan->limits.error, PLAN_UNKNOWN_ONE_IN, plan->limits.time, plan->limits.work, plan->asked.rate,
            PLAN_SPEED_FACTOR * plan->motion.speed);
    if (plan->limits.force_error < INFINITY)
        fprintf(file, " *   the wrench is within %g N of that of the richest setting\n", plan->limits.force_error);
    fprintf(file,
            " *\n * Measured on %s, %s, kernel %s, %s, dynpoint %s.\n"
            " * Not promised: other speeds, bodies that its trace has not met, other machines%s.\n"
            " */\n",
            plan->machine.processor, plan->machine.system, plan->machine.kernel, plan->machine.compiler,
            plan->machine.version, plan->stable > 0.0 ? ", another device" : ", stability");
}

static void write_world(FILE *file, const struct plan *plan, const struct scene *scene)
{
    const dpt_world_def *world = &plan->setting.world;
    fprintf(file,
            "/* The world. */\n"
            "static inline void plan_fill_world(dpt_world_def *def)\n"
            "{\n"
            "    dpt_world_def_init(def);\n"
            "    def->max_bodies = PLAN_BODIES;\n"
            "    def->max_tools = 1;\n"
            "    def->max_segments = %" PRIu32 ";\n"
            "    def->max_tips = %" PRIu32 ";\n"
            "    def->until = %s;\n"
            "    def->law = %s;\n"
            "    def->budget = %" PRIu32 ";\n"
            "    def->sweep_budget = %" PRIu32 ";\n"
            "    def->certificate_bytes = %" PRIu64 "u;\n"
            "    def->max_contacts = %" PRIu32 ";\n"
            "    def->smooth_normals = %" PRIu32 ";\n"
            "    def->margin = %.17g;\n"
            "    def->stiffness = %.17g;\n",
            scene->segment_count, scene->tips.count, until_name(world->until), law_constants[world->law], world->budget,
            world->sweep_budget, world->certificate_bytes, world->max_contacts, world->smooth_normals, world->margin,
            world->stiffness);
    if (world->strip)
        fprintf(file, "    def->strip = DPT_STRIP_KIND_SHADOW;\n    def->strip_capacity = %" PRIu32 ";\n",
                world->strip_capacity);
    fprintf(file, "}\n\n");
}

static void write_bodies(FILE *file, const struct plan *plan, const struct scene *scene)
{
    fprintf(file, "/* A body, of 0 to PLAN_BODIES - 1, after it was added. */\n"
                  "static inline void plan_fill_body(uint32_t body, dpt_body_settings *settings)\n"
                  "{\n    switch (body) {\n");
    for (uint32_t i = 0; i < scene->bodies.count; i++) {
        const dpt_body_settings *own = &scene->bodies.body[i].settings;
        const double friction = plan->setting.friction;
        if (isnan(friction) && !own->size)
            continue;
        fprintf(file, "    case %" PRIu32 ":\n", i);
        if (own->size)
            fprintf(file,
                    "        settings->unfelt = %" PRIu32 ";\n        settings->side_limit = %.17g;\n"
                    "        settings->stiffness = %.17g;\n",
                    own->unfelt, own->side_limit, own->stiffness);
        fprintf(file,
                "        settings->static_friction = %.17g;\n"
                "        settings->kinetic_friction = %.17g;\n        break;\n",
                isnan(friction) ? own->static_friction : friction, isnan(friction) ? own->kinetic_friction : friction);
    }
    fprintf(file, "    default:\n        (void)settings;\n        break;\n    }\n}\n\n");
}

static void write_tool(FILE *file, const struct plan *plan)
{
    fprintf(file,
            "/* The tool, after it was added. */\n"
            "static inline void plan_fill_tool(dpt_tool_settings *settings)\n{\n"
            "    settings->law = %s;\n    settings->stiffness = %.17g;\n"
            "    settings->damping = %.17g;\n    settings->lock_rotation = %" PRIu32
            ";\n    settings->near_only = 1;\n}\n\n",
            law_constants[plan->setting.world.law], plan->setting.world.stiffness, plan->setting.damping,
            plan->setting.lock_rotation);
}

/* Which bodies give way, and how they are stepped. */
static void write_springs(FILE *file, const struct plan *plan, const struct scene *scene)
{
    const struct measure_setting *setting = &plan->setting;
    fprintf(file, "/* 1 if a body gives way, and how its springs are stepped; 0: it is rigid. */\n"
                  "static inline int plan_fill_springs(uint32_t body, dpt_springs_def *springs)\n"
                  "{\n    switch (body) {\n");
    for (uint32_t i = 0; i < scene->bodies.count; i++) {
        const struct scene_body *body = &scene->bodies.body[i];
        const uint32_t iterations = setting->iterations ? setting->iterations : body->iterations;
        if (!scene_body_is_soft(body) || setting->rigid >> i & 1)
            continue;
        fprintf(file, "    case %" PRIu32 ":\n        springs->integrator = %s;\n", i,
                integrator_constants[setting->integrator >= 0 ? (uint32_t)setting->integrator : body->integrator]);
        if (iterations)
            fprintf(file, "        springs->iterations = %" PRIu32 ";\n", iterations);
        if (body->sleep_speed != 0.0)
            fprintf(file, "        springs->sleep_speed = %.17g;\n", fmax(body->sleep_speed, 0.0));
        fprintf(file, "        return 1;\n");
    }
    fprintf(file, "    default:\n        (void)springs;\n        return 0;\n    }\n}\n\n");
}

void plan_header_write(FILE *file, const struct plan *plan, const struct scene *scene)
{
    write_intro(file, plan);
    fprintf(file,
            "#ifndef DYNPOINT_PLAN_H\n#define DYNPOINT_PLAN_H\n\n#include \"dynpoint.h\"\n\n"
            "#define PLAN_BODIES %" PRIu32 "\n#define PLAN_RATE %.17g /* Hz */\n\n",
            scene->bodies.count, plan->asked.rate);
    if (!isnan(plan->length))
        fprintf(file, "/* Of the stylus, m. */\n#define PLAN_LENGTH %.17g\n#define PLAN_RADIUS %.17g\n\n", plan->length,
                plan->radius);
    write_world(file, plan, scene);
    write_bodies(file, plan, scene);
    write_tool(file, plan);
    write_springs(file, plan, scene);
    fprintf(file, "#endif\n");
}
