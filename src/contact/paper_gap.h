/* SPDX-License-Identifier: BSD-3-Clause */
/* The paper's gap, kept as a baseline: docs/algorithms/paper.md. */
#ifndef DPT_PAPER_GAP_H
#define DPT_PAPER_GAP_H

#include "contact/gap.h"

/*
 * The paper's signed gap of one part of a segment, in m. The sign is that of the triangle's own plane. A part that
 * crosses the triangle is as deep as its lower end is below that plane. *penetration gets the penetration in the world;
 * `body` is the body's frame.
 */
double dpti_contact_paper(const struct surface *surface, const struct frame *body, const struct axis *part,
                          const struct pair_search *nearest, double radius, struct penetration *penetration);

#endif
