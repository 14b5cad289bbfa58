/* SPDX-License-Identifier: BSD-3-Clause */
/* The paper's gap, kept as a baseline: docs/algorithms/paper.md. */
#ifndef DPT_PAPER_GAP_H
#define DPT_PAPER_GAP_H

#include "contact/gap.h"

/*
 * The paper's signed gap of one part of a segment and its push in the world (docs/algorithms/paper.md): the sign is
 * that of the triangle's own plane; a part that crosses is as deep as its lower end is under it.
 */
double dpti_contact_paper(const struct surface *surface, const struct frame *body,
                          const struct axis *part, const struct pair_search *nearest, double radius,
                          struct penetration *penetration);

#endif
