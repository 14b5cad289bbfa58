/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * From recorded pushes to mass, damping, friction and delay (docs/algorithms/identify.md). Written for positions;
 * angles are the same with inertia for mass and torque for force.
 */
#ifndef DPT_DRIVERS_IDENTIFY_FIT_H
#define DPT_DRIVERS_IDENTIFY_FIT_H

#include "dynpoint/identify.h"
#include "identify_record.h"

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

/* DPT_E_EMPTY: the record does not tell, for the device slid too little. DPT_E_MEMORY. */
dpt_result identify_fit(const struct identify_record *record, const struct identify_fit_def *def,
                        struct identify_fit *fit);

#endif
