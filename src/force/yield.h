/* SPDX-License-Identifier: BSD-3-Clause */
/* Compliant surfaces, springs in series with the coupling: docs/algorithms/force.md. */
#ifndef DPT_YIELD_H
#define DPT_YIELD_H

#include "force/half_spaces.h"

/*
 * half_spaces.h finds y = goal + sum of m normal for hard constraints. Where constraint i may be violated by v at the
 * cost of v^2 / (2 c), c its compliance, the multipliers are those m' >= 0 with
 *     (N + diag(c)) m' = N m      N_ij = normal_i . normal_j
 * for those that are not 0.
 *
 * Adds sum of (m - m') normal to `yielded`, and sets each share = m' / m, of the active constraints in their order.
 * Compliances are >= 0. Returns what the constraints store, sum of c m'^2 / 2.
 */
double dpti_yield(const struct half_space *spaces, const struct half_spaces_result *hard, uint32_t dimensions,
                  const double *compliance, double *share, double *yielded);

#endif
