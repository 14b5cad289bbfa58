/* SPDX-License-Identifier: BSD-3-Clause */
/* Choose the setting of a plan, and verify it. */
#ifndef DPT_TOOLS_PLAN_SEARCH_H
#define DPT_TOOLS_PLAN_SEARCH_H

#include "plan/plan_file.h"

enum { PLAN_REFUSED_MAX = 80 };

/* What was tried and refused, knob by knob: the first cheaper value that broke something, where it did. */
struct plan_search {
    struct plan_bench bench[PLAN_TRACES];
    struct csv_table trace[PLAN_TRACES];
    int traces; /* how many there are */
    struct plan_progress progress;
    struct plan_neighbour refused[PLAN_REFUSED_MAX];
    uint32_t refused_count, last_refused;
    struct plan_figures richest; /* over the traces by which is verified */
    struct plan_figures first;   /* of the chosen one on the first half */
};

/*
 * Fill in setting, limits, figures, cheaper and better of a plan, whose `asked` and `setting` say what is felt. Close the
 * search in any case.
 *
 * Returns 0; 1 if nothing meets the bounds, with the bound that is broken in `limit`; 2 after a message.
 */
int plan_search(struct plan_search *search, struct plan *plan, const struct scene *scene, const struct csv_table *whole,
                struct plan_text *limit);
void plan_search_close(struct plan_search *search);

/* The limits of a setting while it is looked for; with same_bits those of memory, which must not be felt but in units. */
struct plan_limits plan_limits_of(const struct plan_asked *asked, const struct measure_setting *setting,
                                  const struct plan_bench *bench, int same_bits);

#endif
