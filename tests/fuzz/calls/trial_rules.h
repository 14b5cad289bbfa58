/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What must hold of a motion that was tried: by every triangle of every body, where the tool stopped and at some places
 * on its way.
 */
#ifndef DPT_TESTS_CALLS_TRIAL_RULES_H
#define DPT_TESTS_CALLS_TRIAL_RULES_H

#include "fuzz/calls/world_model.h"

struct trial {
    const struct scene *scene;
    const struct model_tool *tool;
    double clearance;
    int by_pose; /* to `pose`, else to `segment` */
    dpt_pose pose;
    dpt_segment segment[SEGMENTS_MAX];
};

/* Somebody knows: the tool has a place, and all bodies have. */
int trial_is_known(const struct trial *trial);

/* Every segment's axis counts alone, radius and clearance being less than nothing. */
int trial_is_of_axes(const struct trial *trial);

/* What was met, and where the tool is said to be then. */
void trial_must_hold(const struct trial *trial, const dpt_sweep *first, const dpt_pose *pose,
                     const dpt_segment *segments);

/* The same by all triangles. */
void trial_must_be_true(const struct trial *trial, const dpt_sweep *first, const dpt_pose *pose,
                        const dpt_segment *segments);

#endif
