/* SPDX-License-Identifier: BSD-3-Clause */
/* Random numbers (SplitMix64), and poses. A part of answers.c, which alone includes it. */
#ifndef DPT_BENCH_ANSWERS_DRAW_H
#define DPT_BENCH_ANSWERS_DRAW_H

#include "bench/answers.h"
#include <math.h>

static uint64_t random_state;

static uint64_t bits(void)
{
    uint64_t z = (random_state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static uint32_t below(uint32_t count)
{
    return (uint32_t)(bits() % count);
}

static int once_in(uint32_t count)
{
    return below(count) == 0;
}

static double in(double low, double high)
{
    return low + (high - low) * ((double)(bits() >> 11) * 0x1p-53);
}

#define ONE_OF(array) (array)[below(sizeof(array) / sizeof(array)[0])]

static void draw_unit(double *out, int count)
{
    double square;
    do {
        square = 0.0;
        for (int i = 0; i < count; i++) {
            out[i] = in(-1.0, 1.0);
            square += out[i] * out[i];
        }
    } while (square < 0.01 || square > 1.0);
    for (int i = 0; i < count; i++)
        out[i] /= sqrt(square);
}

static dpt_pose draw_pose(double size)
{
    dpt_pose pose;
    for (int i = 0; i < 3; i++)
        pose.position[i] = in(-size, size);
    draw_unit(pose.orientation, 4);
    return pose;
}

static void turn(const double q[4], const double v[3], double out[3])
{
    const double t[3] = { 2.0 * (q[2] * v[2] - q[3] * v[1]), 2.0 * (q[3] * v[0] - q[1] * v[2]),
                          2.0 * (q[1] * v[1] - q[2] * v[0]) };
    out[0] = v[0] + q[0] * t[0] + q[2] * t[2] - q[3] * t[1];
    out[1] = v[1] + q[0] * t[1] + q[3] * t[0] - q[1] * t[2];
    out[2] = v[2] + q[0] * t[2] + q[1] * t[1] - q[2] * t[0];
}

static void apply(const dpt_pose *pose, const double v[3], double out[3])
{
    double turned[3];
    turn(pose->orientation, v, turned);
    for (int i = 0; i < 3; i++)
        out[i] = turned[i] + pose->position[i];
}

static void make_unit(double q[4])
{
    double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int i = 0; i < 4; i++)
        q[i] /= length;
}

/* A part of the way from one pose to another. */
static dpt_pose between(const dpt_pose *from, const dpt_pose *to, double share)
{
    dpt_pose pose;
    double dot = 0.0;
    for (int i = 0; i < 4; i++)
        dot += from->orientation[i] * to->orientation[i];
    for (int i = 0; i < 3; i++)
        pose.position[i] = from->position[i] + share * (to->position[i] - from->position[i]);
    for (int i = 0; i < 4; i++)
        pose.orientation[i] = (1.0 - share) * from->orientation[i] + (dot < 0.0 ? -share : share) * to->orientation[i];
    make_unit(pose.orientation);
    return pose;
}

#endif
