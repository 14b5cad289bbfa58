/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef DPT_TESTS_TISSUE_MATRIX_H
#define DPT_TESTS_TISSUE_MATRIX_H

#include "dynpoint.h"

/*
 * The matrix of the last problem that a body was solved in: what a newton along one row does to another is what one along the
 * other does to it, as springs and masses have it. The largest difference of the two, by the diagonal; with how many rows are
 * pushes, and how many rub or twist. 0 rows: there was no problem.
 */
double tissue_matrix_asymmetry(const dpt_world *world, dpt_body body, uint32_t *touches, uint32_t *others);

/* Of the last problem: by how much the shares of a touch's nodes miss 1 at most, and how many touches are of no shaft. */
uint32_t tissue_matrix_shares(const dpt_world *world, dpt_body body, double *off);

/* The body's solve is as it was when the body was added. */
void tissue_matrix_forget(dpt_world *world, dpt_body body);

#endif
