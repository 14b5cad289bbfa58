/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Errors of a measure_run against a reference run of the same trace, and its cost. The reference is usually
 * measure_setting_richest of the same law: forces of different laws are no errors of each other.
 *
 *     struct measure_setting richest = measure_setting_richest(&setting, &scene);
 *     measure_run(&reference, &scene, &trace, &richest, &effort);
 *     measure_judge(&judgement, &run, &reference);
 *
 * Ticks in which either of the two is stale are counted and judged no further. Shares of times and units are the nearest
 * rank; the first tick, which begins from nothing, is apart.
 */
#ifndef DPT_TOOLS_JUDGEMENT_H
#define DPT_TOOLS_JUDGEMENT_H

#include "measure/measure_run.h"
#include "measure/measure_setting.h"

/* Ticks before and after a fold of either run that are judged apart: the proxies let go at slightly different ticks. */
enum { JUDGEMENT_FOLD_TICKS = 5 };

/* Of sorted numbers; zeros if there are none. */
struct judgement_spread {
    double median, p99, p999, max;
};

struct judgement {
    size_t ticks;
    size_t exact, bounded, local, stale; /* of all, by status */

    /* Distances, in all of them that are not stale. Wrong: off by more than the reference's check.tolerance. */
    size_t wrong;
    size_t wrong_exact;      /* wrong, though said to be exact: never, or the library is at fault */
    size_t missed_crossings; /* wrong, where the reference's axis crosses */
    double distance_error;   /* the largest, m */
    size_t distance_tick;    /* where that is */

    /* Contact; 0 throughout with DPT_UNTIL_TRACK, which does not ask (has_contact is 0). */
    int has_contact;
    size_t unknown;  /* not decided in this run */
    size_t missed;   /* the reference touches or penetrates, and this run says it is separated */
    size_t invented; /* the reverse */

    /* The wrench, if both respond (has_wrench): |W - W'|, N, in ticks in which either feels a force. */
    int has_wrench;
    size_t wrench_ticks;            /* without those near a fold */
    struct judgement_spread wrench; /* of these */
    size_t wrench_tick;             /* of the largest */
    size_t near_fold_ticks;
    double near_fold_error;   /* the largest there, N */
    double wrench_peak;       /* the reference's largest |W|, N */
    size_t inside, undecided; /* ticks without a force for these reasons, DPT_FORCE_INSIDE and _UNDECIDED */

    /* Of this run alone: |W| from tick to tick where the trace does not jump, the largest, N; all, and away from folds. */
    double jump, calm_jump;
    size_t folds;
    double lag; /* of the proxy, the largest, m */

    struct judgement_spread work;        /* units */
    struct judgement_spread ns, soft_ns; /* the step, and physics behind it */
    struct judgement_spread whole_ns;    /* both together */
    struct judgement_spread crossing_ns; /* the step where the axis crosses, as this run says */
    struct judgement_spread other_ns;    /* and where it does not */
    double first_ns, first_work;
    size_t crossings;                                 /* of these ticks */
    struct tick_histogram histogram[TICK_HISTOGRAMS]; /* of ns and work */
};

/*
 * Judge. Both runs have the same ticks. Returns 0, or -1 if memory ran out or they do not. A run may be judged by itself,
 * for its cost and its jumps.
 */
int measure_judge(struct judgement *judgement, const struct measure_run *run, const struct measure_run *reference);

/* Sort numbers, and return their spread. */
struct judgement_spread judgement_spread_of(double *numbers, size_t count);

#endif
