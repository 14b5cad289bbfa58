/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a sampled loop of a held device and a spring must do: the spectral radius of its exact discrete model. Slow and
 * obvious: powers of the matrix, and Jacobi's rotations for the stiffness of a law, which is taken by differences.
 */
#ifndef DPT_TESTS_LOOP_MODEL_H
#define DPT_TESTS_LOOP_MODEL_H

#include "force/held_device.h"

enum { MODEL_DOUBLINGS = 30 };

/* 1/s: how fast the motion of one coordinate grows that is held by `stiffness` through the sampled loop. */
static inline double model_growth(const struct held_device *held, double stiffness)
{
    double step[2][2], gain[2], scale = 0;
    exact_step(held->mass, held->damping, held->hand, RIG_DT, step, gain);
    /* State: position, speed, the force that was computed last. */
    double a[3][3] = { { step[0][0], step[0][1], 0 }, { step[1][0], step[1][1], 0 }, { -stiffness, 0, 0 } };
    for (int i = 0; i < 2; i++) {
        if (held->delay)
            a[i][2] = gain[i];
        else
            a[i][0] -= gain[i] * stiffness;
    }
    /* The force in units that make all three of a size. */
    const double unit = stiffness > 0 ? stiffness : 1;
    for (int i = 0; i < 3; i++) {
        a[i][2] *= unit;
        a[2][i] /= unit;
    }
    for (int n = 0; n < MODEL_DOUBLINGS; n++) {
        double next[3][3] = { { 0 } }, size = 0;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                for (int k = 0; k < 3; k++)
                    next[i][j] += a[i][k] * a[k][j];
                size = fmax(size, fabs(next[i][j]));
            }
        scale = 2 * scale + log(size);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                a[i][j] = next[i][j] / size;
    }
    return scale / ldexp(1, MODEL_DOUBLINGS) / RIG_DT;
}

/* N/m: the stiffness from which on motion grows. */
static inline double model_limit(const struct held_device *held)
{
    double low = 1e-6, high = 1e6;
    for (int i = 0; i < 60; i++) {
        const double middle = sqrt(low * high);
        *(model_growth(held, middle) > 0 ? &high : &low) = middle;
    }
    return low;
}

/* A law, linearised: its stiffness along six directions across each other, the greatest first. */
struct model_law {
    double stiffness[HELD_AXES];
    double direction[HELD_AXES][HELD_AXES];
    double asymmetry; /* N/m: what differences show beside a gradient */
};

/* Jacobi's rotations; the columns of v are the directions. */
static inline void model_diagonalise(double a[HELD_AXES][HELD_AXES], double v[HELD_AXES][HELD_AXES])
{
    memset(v, 0, sizeof(double) * HELD_AXES * HELD_AXES);
    for (int i = 0; i < HELD_AXES; i++)
        v[i][i] = 1;
    for (int turn = 0; turn < 40 * HELD_AXES * HELD_AXES; turn++) {
        const int i = turn / HELD_AXES % HELD_AXES, j = turn % HELD_AXES;
        if (i >= j || a[i][j] == 0)
            continue;
        const double angle = 0.5 * atan2(2 * a[i][j], a[j][j] - a[i][i]);
        const double c = cos(angle), s = sin(angle);
        for (int k = 0; k < HELD_AXES; k++) {
            const double x = a[k][i], y = a[k][j], p = v[k][i], q = v[k][j];
            a[k][i] = c * x - s * y;
            a[k][j] = s * x + c * y;
            v[k][i] = c * p - s * q;
            v[k][j] = s * p + c * q;
        }
        for (int k = 0; k < HELD_AXES; k++) {
            const double x = a[i][k], y = a[j][k];
            a[i][k] = c * x - s * y;
            a[j][k] = s * x + c * y;
        }
    }
}

/* By central differences of `by` m about where the device is; the law has some ticks for each answer. */
static inline void model_linearise(struct held_device *held, struct rig *rig, double by, struct model_law *law)
{
    enum { TICKS = 4 };
    double rate[HELD_AXES][HELD_AXES], even[HELD_AXES][HELD_AXES], v[HELD_AXES][HELD_AXES];
    for (int j = 0; j < HELD_AXES; j++) {
        double force[2][HELD_AXES], at[HELD_AXES];
        for (int side = 0; side < 2; side++) {
            memcpy(at, held->at, sizeof at);
            at[j] += side ? by : -by;
            for (int i = 0; i < TICKS; i++)
                held_ask(held, rig, at, force[side]);
            for (int i = 0; i < TICKS; i++)
                held_ask(held, rig, held->at, held->wrench);
        }
        for (int i = 0; i < HELD_AXES; i++)
            rate[i][j] = (force[0][i] - force[1][i]) / (2 * by);
    }
    law->asymmetry = 0;
    for (int i = 0; i < HELD_AXES; i++)
        for (int j = 0; j < HELD_AXES; j++) {
            even[i][j] = 0.5 * (rate[i][j] + rate[j][i]);
            law->asymmetry = fmax(law->asymmetry, fabs(rate[i][j] - rate[j][i]));
        }
    model_diagonalise(even, v);
    for (int n = 0; n < HELD_AXES; n++) {
        int best = 0;
        for (int i = 1; i < HELD_AXES; i++)
            if (even[i][i] > even[best][best])
                best = i;
        law->stiffness[n] = even[best][best];
        for (int k = 0; k < HELD_AXES; k++)
            law->direction[n][k] = v[k][best];
        even[best][best] = -INFINITY;
    }
}

#endif
