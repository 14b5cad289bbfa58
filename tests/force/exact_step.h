/* SPDX-License-Identifier: BSD-3-Clause */
/* How a mass on a spring with a damper moves under a constant force: the matrix exponential, by its series. */
#ifndef DPT_TESTS_EXACT_STEP_H
#define DPT_TESTS_EXACT_STEP_H

#include <string.h>

/* exp of [[0, 1, 0], [-k / m, -b / m, 1 / m], [0, 0, 0]] * time, by its series. */
static inline void exact_step(double mass, double damping, double spring, double time, double step[2][2],
                              double gain[2])
{
    const double a[3][3] = { { 0, time, 0 },
                             { -spring / mass * time, -damping / mass * time, time / mass },
                             { 0, 0, 0 } };
    double sum[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, term[3][3];
    memcpy(term, sum, sizeof term);
    for (int n = 1; n < 60; n++) {
        double next[3][3] = { { 0 } };
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                for (int k = 0; k < 3; k++)
                    next[i][j] += term[i][k] * a[k][j] / n;
        memcpy(term, next, sizeof term);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                sum[i][j] += term[i][j];
    }
    for (int i = 0; i < 2; i++) {
        step[i][0] = sum[i][0];
        step[i][1] = sum[i][1];
        gain[i] = sum[i][2];
    }
}

#endif
