/* SPDX-License-Identifier: BSD-3-Clause */
/* Small dense matrices, row by row. */
#ifndef DPT_DRIVERS_IDENTIFY_MATRIX_H
#define DPT_DRIVERS_IDENTIFY_MATRIX_H

enum { IDENTIFY_UNKNOWNS_MAX = 13 };

/*
 * Solve the normal equations a x = b of n unknowns; `a` is symmetric and not negative. An unknown that the equations do
 * not determine becomes 0. Returns the number of unknowns that they determine.
 */
int identify_solve(int n, const double a[IDENTIFY_UNKNOWNS_MAX][IDENTIFY_UNKNOWNS_MAX], const double *b, double *x);

/* The inverse of a matrix of 3 rows. Returns 0 if there is none; then it is zero. */
int identify_inverse(const double *a, double *inverse);

/* out = a b of 3 rows each. */
void identify_product(const double *a, const double *b, double *out);

/* Replace a matrix of 3 rows by its symmetric part. */
void identify_symmetric(double *a);

/* Eigenvalues of a symmetric matrix of n rows, the least first, and their unit vectors, row by row. */
void identify_eigen(int n, const double *a, double *values, double *vectors);

#endif
