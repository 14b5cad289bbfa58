/* SPDX-License-Identifier: BSD-3-Clause */
/* What every answer about a closed mesh owes, boxes, and axes of many kinds, for the tests of depth. */
#ifndef DPT_TESTS_DEPTH_CHECKS_H
#define DPT_TESTS_DEPTH_CHECKS_H

#include "lib/rig.h"
#include "lib/solid.h"

extern double ends_before[6]; /* of the tick before, in a world */

/* What it takes to see it again. */
const char *answer_text(const struct solid *solid, const char *by, const double ends[6], double radius,
                        const dpt_hit *hit);

/* What an answer about a closed mesh owes whatever the truth is. */
void check_form(const char *text, const dpt_hit *hit);

/*
 * The region that has the hit's gap leads out: from its deepest point by how deep the axis is to the surface. Returns
 * how far off the surface it lands.
 */
double check_way_out(const struct solid *solid, const struct rig *rig, double margin, const double ends[6],
                     double radius, const dpt_hit *hit);

static inline double radius_of(const struct solid *solid, uint64_t i)
{
    static const double shares[4] = { 0, 0.0007, 0.008, 0.03 };
    return shares[i % 4] * solid->diagonal;
}

/* Axes of many kinds about the origin: outside, crossing, inside, points, through the middle. */
void ends_about(uint64_t *seed, double size, uint64_t i, double ends[6]);

int box_of(struct solid *solid, const double half[3]);

/* A rig of a body and a point that feels it by its segments (rig_step_ends). 0 after a failed check. */
int depth_rig_open(struct rig *rig, const dpt_mesh *mesh, double margin, uint32_t max_contacts);

#endif
