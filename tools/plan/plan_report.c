/* SPDX-License-Identifier: BSD-3-Clause */
#include "plan/plan_report.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

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
            ", up to %.3g m/s: the first half to choose by,\n  the second and that one backwards "
            "%g times as fast%s to verify\n",
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
