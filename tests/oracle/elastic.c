/* SPDX-License-Identifier: BSD-3-Clause */
#include "oracle/elastic.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { CORNERS = 8, DOFS = 3 * CORNERS };

struct grid {
    size_t across, deep, n; /* cells, and numbers */
    double element[DOFS][DOFS];
    unsigned char *is_free; /* 1 a number */
};

/* Gradients of a corner's shape in a cube of side 1. */
static void shape_gradient(size_t corner, const double at[3], double gradient[3])
{
    for (size_t k = 0; k < 3; k++) {
        gradient[k] = 1.0;
        for (size_t l = 0; l < 3; l++) {
            const int far = corner >> l & 1;
            gradient[k] *= k == l ? (far ? 1.0 : -1.0) : (far ? at[l] : 1.0 - at[l]);
        }
    }
}

/* The integral of lambda div u div v + 2 mu e(u):e(v) over a cube of side `cell`. */
static void make_element(const struct elastic_block *block, struct grid *grid)
{
    const double mu = block->young / (2.0 * (1.0 + block->poisson));
    const double lambda = 2.0 * mu * block->poisson / (1.0 - 2.0 * block->poisson);
    const double middle[3] = { 0.5, 0.5, 0.5 };
    const double place[2] = { 0.5 - sqrt(1.0 / 12.0), 0.5 + sqrt(1.0 / 12.0) };
    memset(grid->element, 0, sizeof grid->element);
    for (size_t point = 0; point < 8; point++) {
        const double at[3] = { place[point & 1], place[point >> 1 & 1], place[point >> 2] };
        double g[CORNERS][3], swelling[CORNERS][3];
        for (size_t i = 0; i < CORNERS; i++) {
            shape_gradient(i, at, g[i]);
            shape_gradient(i, block->is_mean ? middle : at, swelling[i]);
        }
        for (size_t i = 0; i < DOFS; i++)
            for (size_t j = 0; j < DOFS; j++) {
                const double *a = g[i / 3], *b = g[j / 3];
                const size_t k = i % 3, l = j % 3;
                const double same = k == l ? a[0] * b[0] + a[1] * b[1] + a[2] * b[2] : 0.0;
                grid->element[i][j] += 0.125 * block->cell *
                                       (lambda * swelling[i / 3][k] * swelling[j / 3][l] + mu * (a[l] * b[k] + same));
            }
    }
}

static size_t node_at(const struct grid *grid, size_t x, size_t y, size_t z)
{
    return x + (grid->across + 1) * (y + (grid->across + 1) * z);
}

static void multiply(const struct grid *grid, const double *u, double *to)
{
    memset(to, 0, grid->n * sizeof *to);
    for (size_t z = 0; z < grid->deep; z++)
        for (size_t y = 0; y < grid->across; y++)
            for (size_t x = 0; x < grid->across; x++) {
                size_t place[DOFS];
                double here[DOFS];
                for (size_t i = 0; i < DOFS; i++) {
                    const size_t c = i / 3;
                    place[i] = 3 * node_at(grid, x + (c & 1), y + (c >> 1 & 1), z + (c >> 2)) + i % 3;
                    here[i] = u[place[i]];
                }
                for (size_t i = 0; i < DOFS; i++) {
                    double sum = 0.0;
                    for (size_t j = 0; j < DOFS; j++)
                        sum += grid->element[i][j] * here[j];
                    to[place[i]] += sum;
                }
            }
}

static double dot(const struct grid *grid, const double *a, const double *b)
{
    double sum = 0.0;
    for (size_t i = 0; i < grid->n; i++)
        sum += grid->is_free[i] ? a[i] * b[i] : 0.0;
    return sum;
}

/* What is held is in u, and stays. */
static void solve(const struct grid *grid, double *u, double *left, double *way, double *product)
{
    multiply(grid, u, left);
    for (size_t i = 0; i < grid->n; i++)
        way[i] = left[i] = grid->is_free[i] ? -left[i] : 0.0;
    double norm = dot(grid, left, left);
    const double goal = 1e-20 * norm;
    for (int round = 0; round < 10000 && norm > goal; round++) {
        multiply(grid, way, product);
        const double by = norm / dot(grid, way, product);
        for (size_t i = 0; i < grid->n; i++) {
            u[i] += by * way[i];
            left[i] -= grid->is_free[i] ? by * product[i] : 0.0;
        }
        const double next = dot(grid, left, left);
        for (size_t i = 0; i < grid->n; i++)
            way[i] = left[i] + next / norm * way[i];
        norm = next;
    }
}

static size_t cells_of(double length, double cell)
{
    const double cells = floor(length / cell + 0.5);
    return fabs(cells * cell - length) < 1e-9 * length ? (size_t)cells : 0;
}

/* The force by the way of the patch; *bulge: how far the middle of a side moves. */
static double solve_block(const struct elastic_block *block, double *bulge)
{
    struct grid grid = { .across = cells_of(block->half, block->cell), .deep = cells_of(block->depth, block->cell) };
    const size_t patch = cells_of(block->patch, block->cell);
    if (!grid.across || !grid.deep || !patch || patch > grid.across)
        return -1.0;
    grid.n = 3 * (grid.across + 1) * (grid.across + 1) * (grid.deep + 1);
    double *all = calloc(4 * grid.n, sizeof *all), force = -1.0;
    grid.is_free = malloc(grid.n);
    if (all && grid.is_free) {
        double *u = all, *product = all + 3 * grid.n;
        make_element(block, &grid);
        memset(grid.is_free, 1, grid.n);
        for (size_t z = 0; z <= grid.deep; z++)
            for (size_t y = 0; y <= grid.across; y++)
                for (size_t x = 0; x <= grid.across; x++) {
                    const size_t at = 3 * node_at(&grid, x, y, z);
                    const int is_pushed = z == grid.deep && x <= patch && y <= patch;
                    if (is_pushed)
                        u[at + 2] = -1.0;
                    if (is_pushed || z == 0)
                        memset(grid.is_free + at + (block->slides ? 2 : 0), 0, block->slides ? 1 : 3);
                    if (x == 0)
                        grid.is_free[at] = 0;
                    if (y == 0)
                        grid.is_free[at + 1] = 0;
                }
        solve(&grid, u, all + grid.n, all + 2 * grid.n, product);
        multiply(&grid, u, product);
        force = 0.0;
        for (size_t y = 0; y <= patch; y++)
            for (size_t x = 0; x <= patch; x++)
                force -= 4.0 * product[3 * node_at(&grid, x, y, grid.deep) + 2];
        *bulge = u[3 * node_at(&grid, grid.across, 0, grid.deep / 2)];
    }
    free(grid.is_free);
    free(all);
    return force;
}

double oracle_elastic_stiffness(const struct elastic_block *block)
{
    double bulge;
    return solve_block(block, &bulge);
}

double oracle_elastic_bulge(const struct elastic_block *block)
{
    double bulge = 0.0;
    return solve_block(block, &bulge) > 0.0 ? bulge : 0.0;
}
