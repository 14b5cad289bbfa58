/* SPDX-License-Identifier: BSD-3-Clause */
/* The dynamics of a device from a record of pushes, by a linear fit, and the small matrices for it. */
#ifndef DPT_DRIVERS_IDENTIFY_FIT_H
#define DPT_DRIVERS_IDENTIFY_FIT_H

#include "dynpoint/identify.h"
#include "identify_record.h"

/* ---- small dense matrices, row by row ---- */

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

/*
 * From recorded pushes to mass, damping, friction and delay (docs/algorithms/identify.md). Written for positions;
 * angles are the same with inertia for mass and torque for force.
 */

/* What the fit must know of the device and of the pushes. */
struct identify_fit_def {
    double period;    /* s */
    double step;      /* smallest change of position, m */
    double speed;     /* that the pushes aimed at, m/s */
    double force;     /* the strongest push, N */
    double range;     /* how far the pushes went, m */
    double delay_max; /* s */
};

struct identify_fit {
    dpt_identified mass, damping, friction, delay, stiffness;
    double mass_matrix[9], damping_matrix[9];
    double mass_direction[3], damping_direction[3]; /* zero if all are alike */
    int is_held;                                    /* a spring pulls it back */
};

/* DPT_E_EMPTY: the device slid too little for a fit. DPT_E_MEMORY. */
dpt_result identify_fit(const struct identify_record *record, const struct identify_fit_def *def,
                        struct identify_fit *fit);

#endif
