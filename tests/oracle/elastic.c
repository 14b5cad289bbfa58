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
    double *u, *left, *way, *product;
};

static size_t cells_of(double length, double cell)
{
    const double cells = floor(length / cell + 0.5);
    return fabs(cells * cell - length) < 1e-9 * length ? (size_t)cells : 0;
}

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
static void solve(const struct grid *grid)
{
    double *u = grid->u, *left = grid->left, *way = grid->way, *product = grid->product;
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

static void close_grid(struct grid *grid)
{
    free(grid->is_free);
    free(grid->u);
}

/* A quarter of the block, held by its mirror planes and its lower face. Returns 0 if that cannot be; close it in any case. */
static int open_grid(struct grid *grid, const struct elastic_block *block)
{
    *grid = (struct grid){ .across = cells_of(block->half, block->cell), .deep = cells_of(block->depth, block->cell) };
    if (!grid->across || !grid->deep)
        return 0;
    grid->n = 3 * (grid->across + 1) * (grid->across + 1) * (grid->deep + 1);
    grid->u = calloc(4 * grid->n, sizeof *grid->u);
    grid->is_free = malloc(grid->n);
    if (!grid->u || !grid->is_free)
        return 0;
    grid->left = grid->u + grid->n;
    grid->way = grid->left + grid->n;
    grid->product = grid->way + grid->n;
    make_element(block, grid);
    memset(grid->is_free, 1, grid->n);
    for (size_t z = 0; z <= grid->deep; z++)
        for (size_t y = 0; y <= grid->across; y++)
            for (size_t x = 0; x <= grid->across; x++) {
                unsigned char *is_free = grid->is_free + 3 * node_at(grid, x, y, z);
                is_free[0] = x && (z || block->slides);
                is_free[1] = y && (z || block->slides);
                is_free[2] = z > 0;
            }
    return 1;
}

/* The number of a node of the upper face along z. */
static size_t top_at(const struct grid *grid, size_t x, size_t y)
{
    return 3 * node_at(grid, x, y, grid->deep) + 2;
}

/* N: what holds the upper face, of the whole block. */
static double force_on_top(const struct grid *grid)
{
    double force = 0.0;
    multiply(grid, grid->u, grid->product);
    for (size_t y = 0; y <= grid->across; y++)
        for (size_t x = 0; x <= grid->across; x++)
            force -= grid->is_free[top_at(grid, x, y)] ? 0.0 : 4.0 * grid->product[top_at(grid, x, y)];
    return force;
}

/* m^3: what the quarter has lost of its volume, by the mean of each element. */
static double lost_volume(const struct grid *grid, double cell)
{
    const double middle[3] = { 0.5, 0.5, 0.5 };
    double sum = 0.0;
    for (size_t z = 0; z < grid->deep; z++)
        for (size_t y = 0; y < grid->across; y++)
            for (size_t x = 0; x < grid->across; x++)
                for (size_t i = 0; i < CORNERS; i++) {
                    const double *u = grid->u + 3 * node_at(grid, x + (i & 1), y + (i >> 1 & 1), z + (i >> 2));
                    double gradient[3];
                    shape_gradient(i, middle, gradient);
                    for (size_t k = 0; k < 3; k++)
                        sum -= gradient[k] * u[k] * cell * cell;
                }
    return sum;
}

struct solution {
    double force, bulge, lost; /* by the way of the patch: N, how far the middle of a side moves, m^2 */
};

static struct solution solve_block(const struct elastic_block *block)
{
    struct solution of = { -1.0, 0.0, 0.0 };
    struct grid grid = { 0 };
    const size_t patch = cells_of(block->patch, block->cell);
    if (open_grid(&grid, block) && patch && patch <= grid.across) {
        for (size_t y = 0; y <= patch; y++)
            for (size_t x = 0; x <= patch; x++) {
                const size_t at = top_at(&grid, x, y);
                grid.u[at] = -1.0;
                memset(grid.is_free + at - (block->slides ? 0 : 2), 0, block->slides ? 1 : 3);
            }
        solve(&grid);
        of = (struct solution){ force_on_top(&grid), grid.u[3 * node_at(&grid, grid.across, 0, grid.deep / 2)],
                                4.0 * lost_volume(&grid, block->cell) };
    }
    close_grid(&grid);
    return of;
}

/* How far below its lowest point the tool is, at a place of the upper face. */
static double height_of(const struct elastic_tool *tool, double x, double y)
{
    const double square = x * x + (tool->is_long ? 0.0 : y * y), radius = tool->radius;
    return square < radius * radius ? radius - sqrt(radius * radius - square) : 2.0 * radius;
}

/* Hold what goes into the tool, at the tool, and let go what it pulls at. Returns how many nodes that are. */
static size_t change_touches(struct grid *grid, const struct elastic_block *block, const struct elastic_tool *tool)
{
    size_t changed = 0;
    multiply(grid, grid->u, grid->product);
    for (size_t y = 0; y <= grid->across; y++)
        for (size_t x = 0; x <= grid->across; x++) {
            const size_t at = top_at(grid, x, y);
            const double end = height_of(tool, (double)x * block->cell, (double)y * block->cell) - tool->depth;
            const int touches = grid->is_free[at] ? grid->u[at] > end + 1e-9 * tool->depth : grid->product[at] < 0.0;
            changed += touches == grid->is_free[at];
            grid->is_free[at] = !touches;
            if (touches)
                grid->u[at] = end;
        }
    return changed;
}

double oracle_elastic_force(const struct elastic_block *block, const struct elastic_tool *tool)
{
    struct grid grid = { 0 };
    double force = -1.0;
    if (open_grid(&grid, block)) {
        for (int round = 0; round < 50 && change_touches(&grid, block, tool); round++)
            solve(&grid);
        force = force_on_top(&grid);
    }
    close_grid(&grid);
    return force;
}

double oracle_elastic_stiffness(const struct elastic_block *block)
{
    return solve_block(block).force;
}

double oracle_elastic_bulge(const struct elastic_block *block)
{
    return solve_block(block).bulge;
}

double oracle_elastic_loss(const struct elastic_block *block)
{
    const double side = 2.0 * block->half;
    return solve_block(block).lost / (side * side);
}
