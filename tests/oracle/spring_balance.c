/* SPDX-License-Identifier: BSD-3-Clause */
#include "oracle/spring_balance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 80, PASSES = 5000 };

struct system {
    size_t n;
    double *right, *change, *left, *way, *product, *diagonal;
};

static int is_free(const struct oracle_springs *springs, size_t i)
{
    return springs->mass[i / 3] > 0.0f;
}

/* What acts on each node, and the diagonal of the matrix. */
static void add_forces(const struct oracle_springs *springs, const double *x, double *force, double *diagonal)
{
    const size_t n = 3 * (size_t)springs->nodes;
    memcpy(force, springs->load, n * sizeof *force);
    memset(diagonal, 0, n * sizeof *diagonal);
    for (uint32_t i = 0; i < springs->springs; i++) {
        const struct oracle_spring *spring = &springs->list[i];
        const size_t a = 3 * (size_t)spring->a, b = 3 * (size_t)spring->b;
        const double d[3] = { x[b] - x[a], x[b + 1] - x[a + 1], x[b + 2] - x[a + 2] };
        const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        const double turn = 1.0 - spring->length / sqrt(square), across = fmax(turn, 0.0);
        for (size_t k = 0; k < 3; k++) {
            const double own = spring->stiffness * (across + (1.0 - across) * d[k] * d[k] / square);
            force[a + k] += spring->stiffness * turn * d[k];
            force[b + k] -= spring->stiffness * turn * d[k];
            diagonal[a + k] += own;
            diagonal[b + k] += own;
        }
    }
    for (size_t i = 0; i < n; i++)
        force[i] = is_free(springs, i) ? force[i] : 0.0;
}

static void multiply(const struct oracle_springs *springs, const double *x, const double *way, double *to)
{
    const size_t n = 3 * (size_t)springs->nodes;
    memset(to, 0, n * sizeof *to);
    for (uint32_t i = 0; i < springs->springs; i++) {
        const struct oracle_spring *spring = &springs->list[i];
        const size_t a = 3 * (size_t)spring->a, b = 3 * (size_t)spring->b;
        double d[3], w[3], square = 0.0, inner = 0.0;
        for (size_t k = 0; k < 3; k++) {
            d[k] = x[b + k] - x[a + k];
            w[k] = way[b + k] - way[a + k];
            square += d[k] * d[k];
            inner += d[k] * w[k];
        }
        const double across = fmax(1.0 - spring->length / sqrt(square), 0.0);
        const double along = (1.0 - across) * inner / square;
        for (size_t k = 0; k < 3; k++) {
            const double pull = spring->stiffness * (across * w[k] + along * d[k]);
            to[a + k] -= pull;
            to[b + k] += pull;
        }
    }
    for (size_t i = 0; i < n; i++)
        to[i] = is_free(springs, i) ? to[i] : 0.0;
}

static double norm_of(const struct system *system)
{
    double sum = 0.0;
    for (size_t i = 0; i < system->n; i++)
        sum += system->left[i] * system->left[i] / system->diagonal[i];
    return sum;
}

static void solve(const struct oracle_springs *springs, const double *x, struct system *system)
{
    for (size_t i = 0; i < system->n; i++) {
        system->change[i] = 0.0;
        system->left[i] = system->right[i];
        system->way[i] = system->left[i] / system->diagonal[i];
    }
    double norm = norm_of(system);
    const double goal = 1e-10 * norm;
    for (int i = 0; i < PASSES && norm > goal; i++) {
        double curvature = 0.0;
        multiply(springs, x, system->way, system->product);
        for (size_t k = 0; k < system->n; k++)
            curvature += system->way[k] * system->product[k];
        for (size_t k = 0; k < system->n; k++) {
            system->change[k] += norm / curvature * system->way[k];
            system->left[k] -= norm / curvature * system->product[k];
        }
        const double next = norm_of(system);
        for (size_t k = 0; k < system->n; k++)
            system->way[k] = system->left[k] / system->diagonal[k] + next / norm * system->way[k];
        norm = next;
    }
}

static int make_system(const struct oracle_springs *springs, struct system *system)
{
    system->n = 3 * (size_t)springs->nodes;
    system->right = calloc(6 * system->n, sizeof(double));
    system->change = system->right + system->n;
    system->left = system->change + system->n;
    system->way = system->left + system->n;
    system->product = system->way + system->n;
    system->diagonal = system->product + system->n;
    return system->right != NULL;
}

double oracle_spring_balance(const struct oracle_springs *springs, double longest, double *x)
{
    struct system system;
    double most = HUGE_VAL;
    if (!make_system(springs, &system))
        return -1.0;
    for (int round = 0; round < ROUNDS && most > 1e-10; round++) {
        add_forces(springs, x, system.right, system.diagonal);
        for (size_t i = 0; i < system.n; i++)
            system.diagonal[i] = system.diagonal[i] > 0.0 ? system.diagonal[i] : 1.0;
        solve(springs, x, &system);
        most = 0.0;
        for (size_t i = 0; i < system.n; i++)
            most = fmax(most, fabs(system.change[i]));
        for (size_t i = 0; i < system.n; i++)
            x[i] += (most > longest ? longest / most : 1.0) * system.change[i];
    }
    free(system.right);
    return most;
}

double oracle_spring_rest(const struct oracle_springs *springs, const double *x)
{
    struct system system;
    double most = 0.0;
    if (!make_system(springs, &system))
        return -1.0;
    add_forces(springs, x, system.right, system.diagonal);
    for (size_t i = 0; i < system.n; i++)
        most = fmax(most, fabs(system.right[i]));
    free(system.right);
    return most;
}
