/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * An oracle for sampled loops: masses with damping, held by a sampled spring and damper through a delay of any length.
 * One step of the whole loop is written down as a matrix, the device's part by the series of the matrix exponential, and
 * the matrix is squared until its size tells how fast motion grows. It knows no friction and no quanta.
 */
#ifndef DPT_TESTS_LOOP_MATRIX_H
#define DPT_TESTS_LOOP_MATRIX_H

#include <math.h>

#include "force/exact_step.h"

enum { LOOP_AXES_MAX = 2, LOOP_DELAY_MAX = 12, LOOP_STATES_MAX = 36, LOOP_DOUBLINGS = 26 };

struct matrix_loop {
    int axes;
    double mass[LOOP_AXES_MAX], damping[LOOP_AXES_MAX]; /* kg or kg m2, Ns/m or Nms/rad */
    double stiffness[LOOP_AXES_MAX][LOOP_AXES_MAX];
    double virtual_damping[LOOP_AXES_MAX][LOOP_AXES_MAX];
    double period, delay; /* s */
};

typedef double loop_matrix[LOOP_STATES_MAX][LOOP_STATES_MAX];

/* Position and velocity after `time`: of position, velocity and a constant force before. */
static inline void loop_free_motion(double mass, double damping, double time, double row[2][3])
{
    double step[2][2], gain[2];
    exact_step(mass, damping, 0, time, step, gain);
    for (int i = 0; i < 2; i++) {
        row[i][0] = step[i][0];
        row[i][1] = step[i][1];
        row[i][2] = gain[i];
    }
}

/*
 * State, of each axis: position, velocity, last position, and the commands of the last periods, the newest first. Returns
 * how many numbers that is.
 */
static inline int loop_step_matrix(const struct matrix_loop *loop, loop_matrix a)
{
    const int periods = (int)floor(loop->delay / loop->period);
    const double late = loop->delay - periods * loop->period;
    const int per_axis = 3 + periods + 1, n = loop->axes * per_axis;
    memset(a, 0, sizeof(loop_matrix));
    for (int i = 0; i < loop->axes; i++) {
        const int at = i * per_axis;
        double first[2][3], second[2][3], command[LOOP_STATES_MAX] = { 0 };
        for (int j = 0; j < loop->axes; j++) {
            command[j * per_axis] = -loop->stiffness[i][j] - loop->virtual_damping[i][j] / loop->period;
            command[j * per_axis + 2] = loop->virtual_damping[i][j] / loop->period;
        }
        loop_free_motion(loop->mass[i], loop->damping[i], late, first);
        loop_free_motion(loop->mass[i], loop->damping[i], loop->period - late, second);
        for (int r = 0; r < 2; r++) {
            /* The older command acts on the first piece, and what it did there goes on through the second. */
            const double older = second[r][0] * first[0][2] + second[r][1] * first[1][2];
            const double newer = second[r][2];
            a[at + r][at] += second[r][0];
            a[at + r][at + 1] += second[r][0] * first[0][1] + second[r][1] * first[1][1];
            a[at + r][at + 3 + periods] += older;
            for (int k = 0; k < n && periods == 0; k++)
                a[at + r][k] += newer * command[k];
            if (periods > 0)
                a[at + r][at + 3 + periods - 1] += newer;
        }
        a[at + 2][at] = 1;
        memcpy(a[at + 3], command, sizeof command);
        for (int k = 1; k <= periods; k++)
            a[at + 3 + k][at + 3 + k - 1] = 1;
    }
    return n;
}

/* The logarithm of the factor by which motion grows in a period: below 0 it dies away. */
static inline double loop_growth(const struct matrix_loop *loop)
{
    static loop_matrix a, next;
    const int n = loop_step_matrix(loop, a);
    double scale = 0;
    /* Forces in units of a stiffness, velocities in units of a period: entries of one size. */
    const double unit = loop->stiffness[0][0] > 0 ? loop->stiffness[0][0] : 1;
    const int per_axis = n / loop->axes;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            const double to = i % per_axis >= 3 ? unit : i % per_axis == 1 ? 1 / loop->period : 1;
            const double from = j % per_axis >= 3 ? unit : j % per_axis == 1 ? 1 / loop->period : 1;
            a[i][j] *= from / to;
        }
    for (int round = 0; round < LOOP_DOUBLINGS; round++) {
        double size = 0;
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) {
                next[i][j] = 0;
                for (int k = 0; k < n; k++)
                    next[i][j] += a[i][k] * a[k][j];
                size = fmax(size, fabs(next[i][j]));
            }
        scale = 2 * scale + log(size);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                a[i][j] = next[i][j] / size;
    }
    return scale / ldexp(1, LOOP_DOUBLINGS);
}

#endif
