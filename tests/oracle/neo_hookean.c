/* SPDX-License-Identifier: BSD-3-Clause */
#include "oracle/neo_hookean.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CORNERS = 8, POINTS = 8, CELLS_MAX = 16, ROUNDS = 4000 };

/* Of the square of all forces: less is none. */
#define ROUNDING 1e-24

/* mu is 1: a volume does not depend on it. */
static double lambda_of(double poisson)
{
    return 2.0 * poisson / (1.0 - 2.0 * poisson);
}

/* No stress across: t - 1 + lambda J (J - 1) = 0 with J = length t, t the square of the stretch across. */
double oracle_neo_hookean_free(double poisson, double length)
{
    const double lambda = lambda_of(poisson), a = lambda * length * length, b = 1.0 - lambda * length;
    return length * (-b + sqrt(b * b + 4.0 * a)) / (2.0 * a);
}

/* An eighth of the cube, in units of a cell; the rest is its mirror image. */
struct cube {
    double lambda;
    unsigned across;
    size_t n; /* numbers */
    double gradient[POINTS][CORNERS][3];
    unsigned char *is_free;
    double *x, *force, *way, *last;
    double volume; /* of the last call of find_force */
    int is_turned; /* a cell was inside out */
};

static size_t node_at(const struct cube *cube, size_t x, size_t y, size_t z)
{
    return x + (cube->across + 1) * (y + (cube->across + 1) * z);
}

static void set_gradients(struct cube *cube)
{
    const double place[2] = { 0.5 - sqrt(1.0 / 12.0), 0.5 + sqrt(1.0 / 12.0) };
    for (int p = 0; p < POINTS; p++)
        for (int c = 0; c < CORNERS; c++)
            for (int k = 0; k < 3; k++) {
                double product = 1.0;
                for (int l = 0; l < 3; l++) {
                    const double at = place[p >> l & 1];
                    const int is_far = c >> l & 1;
                    product *= l == k ? (is_far ? 1.0 : -1.0) : (is_far ? at : 1.0 - at);
                }
                cube->gradient[p][c][k] = product;
            }
}

/* The cofactors of f, which are J times its inverse turned round. Returns J. */
static double cofactors(double f[3][3], double to[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
            to[i][j] = f[a][c] * f[b][d] - f[a][d] * f[b][c];
        }
    return f[0][0] * to[0][0] + f[0][1] * to[0][1] + f[0][2] * to[0][2];
}

static void add_cell(struct cube *cube, const size_t node[CORNERS], const double *x, double *force)
{
    double f[POINTS][3][3], cofactor[POINTS][3][3], j[POINTS], mean = 0.0;
    memset(f, 0, sizeof f);
    for (int p = 0; p < POINTS; p++) {
        for (int c = 0; c < CORNERS; c++)
            for (int i = 0; i < 3; i++)
                for (int k = 0; k < 3; k++)
                    f[p][i][k] += x[3 * node[c] + (size_t)i] * cube->gradient[p][c][k];
        j[p] = cofactors(f[p], cofactor[p]);
        cube->is_turned |= !(j[p] > 0.0);
        mean += j[p] / POINTS;
    }
    cube->volume += mean;
    for (int p = 0; p < POINTS; p++)
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) {
                const double stress = f[p][i][k] + (cube->lambda * (mean - 1.0) - 1.0 / j[p]) * cofactor[p][i][k];
                for (int c = 0; c < CORNERS; c++)
                    force[3 * node[c] + (size_t)i] -= stress * cube->gradient[p][c][k] / POINTS;
            }
}

static void find_force(struct cube *cube, const double *x, double *force)
{
    memset(force, 0, cube->n * sizeof *force);
    cube->volume = 0.0;
    cube->is_turned = 0;
    for (size_t z = 0; z < cube->across; z++)
        for (size_t y = 0; y < cube->across; y++)
            for (size_t x0 = 0; x0 < cube->across; x0++) {
                size_t node[CORNERS];
                for (size_t c = 0; c < CORNERS; c++)
                    node[c] = node_at(cube, x0 + (c & 1), y + (c >> 1 & 1), z + (c >> 2));
                add_cell(cube, node, x, force);
            }
    for (size_t i = 0; i < cube->n; i++)
        force[i] = cube->is_free[i] ? force[i] : 0.0;
}

static double product_of(const struct cube *cube, const double *a, const double *b)
{
    double sum = 0.0;
    for (size_t i = 0; i < cube->n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* Along the way to where the force has no part along it, by secants. Returns 0 if that leads nowhere. */
static int go(struct cube *cube, double *at)
{
    double step = 1e-3 / sqrt(product_of(cube, cube->way, cube->way)), gone = 0.0;
    double before = product_of(cube, cube->force, cube->way);
    for (int i = 0; i < 4; i++) {
        memcpy(at, cube->x, cube->n * sizeof *at);
        for (size_t k = 0; k < cube->n; k++)
            at[k] += step * cube->way[k];
        find_force(cube, at, cube->force);
        const double now = product_of(cube, cube->force, cube->way);
        gone += step;
        memcpy(cube->x, at, cube->n * sizeof *at);
        if (cube->is_turned)
            return 0;
        const double slope = (before - now) / step;
        if (!(slope > 0.0) || fabs(now) < 1e-3 * fabs(before))
            break;
        step = now / slope;
        before = now;
    }
    return gone > 0.0;
}

/* Conjugate gradients after Polak and Ribiere. */
static int rest(struct cube *cube)
{
    double *at = malloc(cube->n * sizeof *at);
    find_force(cube, cube->x, cube->force);
    memcpy(cube->way, cube->force, cube->n * sizeof *cube->way);
    double size = product_of(cube, cube->force, cube->force);
    const double goal = 1e-16 * size + ROUNDING;
    int is_done = size <= goal;
    for (int round = 0; at && round < ROUNDS && !is_done; round++) {
        memcpy(cube->last, cube->force, cube->n * sizeof *cube->last);
        if (!go(cube, at))
            break;
        const double now = product_of(cube, cube->force, cube->force);
        const double turn = fmax(0.0, (now - product_of(cube, cube->force, cube->last)) / size);
        for (size_t i = 0; i < cube->n; i++)
            cube->way[i] = cube->force[i] + turn * cube->way[i];
        size = now;
        is_done = size <= goal;
    }
    free(at);
    return is_done;
}

double oracle_neo_hookean_held(double poisson, double length, unsigned cells)
{
    struct cube cube = { .lambda = lambda_of(poisson), .across = cells / 2 };
    double left = 0.0;
    if (cells % 2 || cells < 2 || cells > CELLS_MAX)
        return 0.0;
    const size_t side = cube.across + 1;
    cube.n = 3 * side * side * side;
    cube.x = calloc(4 * cube.n, sizeof *cube.x);
    cube.is_free = malloc(cube.n);
    if (cube.x && cube.is_free) {
        cube.force = cube.x + cube.n;
        cube.way = cube.force + cube.n;
        cube.last = cube.way + cube.n;
        set_gradients(&cube);
        for (size_t i = 0; i < cube.n / 3; i++) {
            const size_t at[3] = { i % side, i / side % side, i / side / side };
            for (size_t k = 0; k < 3; k++) {
                cube.x[3 * i + k] = (double)at[k] * (k == 2 ? length : 1.0);
                cube.is_free[3 * i + k] = at[k] > 0 && at[2] < cube.across;
            }
        }
        left = rest(&cube) ? cube.volume / (double)(cube.across * cube.across * cube.across) : 0.0;
    }
    free(cube.is_free);
    free(cube.x);
    return left;
}
