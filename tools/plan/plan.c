/* SPDX-License-Identifier: BSD-3-Clause */
#include "plan/plan.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

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
        snprintf(text, room, "ticks take %.3g ms at 99.9 %%, at most %.3g ms", 1e3 * figures->time_p999,
                 1e3 * limits->time);
        break;
    default:
        snprintf(text, room, "nothing is broken");
    }
    return out;
}

static uint32_t larger(uint32_t a, uint32_t b)
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
    figures->contacts = larger(figures->contacts, other->contacts);
    figures->strip = larger(figures->strip, other->strip);
    figures->work = larger(figures->work, other->work);
    figures->work_p999 = fmax(figures->work_p999, other->work_p999);
    figures->time_median = fmax(figures->time_median, other->time_median);
    figures->time_p999 = fmax(figures->time_p999, other->time_p999);
    figures->bytes = figures->bytes > other->bytes ? figures->bytes : other->bytes;
}
