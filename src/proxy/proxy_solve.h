/* SPDX-License-Identifier: BSD-3-Clause */
/* The motion that a proxy's constraints allow. */
#ifndef DPT_PROXY_SOLVE_H
#define DPT_PROXY_SOLVE_H

#include "proxy/proxy_tick.h"

/*
 * The motion nearest to the wanted one that the constraints allow, into tick->solved. Where none meets them all: one
 * that makes nothing worse; where there is none either: one that leaves half of the clearance. 0: not even that.
 */
int dpti_proxy_solve(struct proxy_tick *tick, const double *wanted);

/*
 * The motion nearest to the wanted one on some planes (half_spaces.h) that meets all constraints. 0, and nothing is
 * changed, if there is none.
 */
int dpti_proxy_solve_stuck(struct proxy_tick *tick, const double *wanted, const struct half_space *planes,
                           uint32_t plane_count, double *held);

#endif
