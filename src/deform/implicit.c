/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/implicit.h"

#include <math.h>
#include <string.h>

#include "deform/spring_energy.h"

/*
 * J and 1/s: energies below the floor are rounding. What damping has taken away is forgotten at that rate.
 */
#define ACCOUNT_FLOOR 1e-9
#define ACCOUNT_LEAK  1.0

/* A step from the points that nodes reach in `flight` seconds with the speeds they have. */
struct trial {
    float h, flight;
    double bound; /* J: the energy after it is proven not to exceed it, but for the work of loads */
    double work;  /* J: of loads and gravity */
};

void dpti_implicit_begin(struct dpt_springs *springs)
{
    const struct spring_net *net = &springs->net;
    struct spring_solve *solve = &springs->solve;
    for (uint32_t slice = 0; slice < net->slices; slice++)
        for (uint32_t lane = 0; lane < LANES; lane++) {
            const uint32_t node = LANES * slice + lane;
            double sum = 0.0;
            for (uint32_t entry = net->first[slice]; entry < net->first[slice + 1]; entry++)
                sum += (double)net->stiffness[LANES * (size_t)entry + lane];
            solve->mass[node] = node < net->nodes ? net->mass[node] : 0.0f;
            solve->stiffness[node] = (float)(springs->def.stiffness * sum);
        }
    dpti_implicit_forget(springs);
}

void dpti_implicit_forget(struct dpt_springs *springs)
{
    springs->solve.account = -1.0;
}

/* What is known of the energy, where nodes are now. */
static void open_account(struct dpt_springs *springs)
{
    struct spring_solve *solve = &springs->solve;
    solve->account = dpti_springs_kinetic(springs);
    for (uint32_t slice = 0; slice < springs->net.slices; slice++) {
        solve->energy[slice] = dpti_springs_elastic(springs, slice);
        solve->account += solve->energy[slice];
    }
}

/* Mass / h^2 with drag, and what the springs add to it. */
static void make_diagonal(struct dpt_springs *springs, double step)
{
    struct spring_solve *solve = &springs->solve;
    const float h = (float)step, more = 1.0f + (float)springs->lead / h;
    if (solve->step == step)
        return;
    solve->step = step;
    for (size_t slice = 0; slice < springs->net.slices; slice++)
        for (size_t lane = 0; lane < LANES; lane++) {
            const size_t i = LANES * slice + lane;
            const float drag = 1.0f + h * springs->nodes[slice].drag[lane];
            solve->diagonal[i] = solve->mass[i] * drag / (h * h);
            const float sum = solve->diagonal[i] + more * solve->stiffness[i];
            solve->per_diagonal[i] = solve->mass[i] > 0.0f ? 1.0f / sum : 0.0f;
        }
}

/* The right-hand side of a slice, from its forces. Returns what it adds to the residual's norm. */
static double begin_slice(struct dpt_springs *springs, size_t slice, const struct trial *trial)
{
    const struct spring_solve *solve = &springs->solve;
    const struct spring_slice *state = springs->state[springs->now] + slice;
    const float *force = solve->force + SPRING_ROWS * slice;
    const float *load = springs->loads[springs->loaded].force + SPRING_ROWS * slice;
    const float *mass = solve->mass + LANES * slice, *diagonal = solve->diagonal + LANES * slice;
    const float *per_diagonal = solve->per_diagonal + LANES * slice;
    const float scale = (float)springs->def.stiffness, per_h = 1.0f / trial->h;
    float *residual = solve->residual + SPRING_ROWS * slice;
    float *direction = solve->direction + SPRING_POINTS * slice, square[LANES] = { 0 };
    double lanes[LANES];
    for (int row = 0; row < 3; row++) {
        const float gravity = (float)springs->def.gravity[row];
        for (int i = 0; i < LANES; i++) {
            const int k = LANES * row + i;
            const float flown = trial->flight * state->v[k];
            const float b = scale * force[k] + load[k] + mass[i] * gravity +
                            mass[i] * per_h * state->v[k] - diagonal[i] * flown;
            residual[k] = b;
            direction[4 * i + row] = per_diagonal[i] * b;
            square[i] += b * b;
        }
    }
    memset(solve->change + SPRING_ROWS * slice, 0, SPRING_ROWS * sizeof *solve->change);
    for (int i = 0; i < LANES; i++)
        lanes[i] = (double)(square[i] * per_diagonal[i]);
    return spring_sum(lanes);
}

/* Conjugate gradients, preconditioned by the diagonal, for the change. norm: of the residual. */
static void solve_change(struct dpt_springs *springs, float h, double norm)
{
    const struct active_region *region = &springs->region;
    struct spring_solve *solve = &springs->solve;
    const float scale = (float)springs->def.stiffness * (1.0f + (float)springs->lead / h);
    for (uint32_t n = 0; n < springs->def.iterations && norm > 0.0; n++) {
        double lanes[LANES] = { 0.0 }, next[LANES] = { 0.0 };
        for (uint32_t i = 0; i < region->count; i++) {
            const size_t slice = region->slices[i];
            springs->kernel.spring_product(&springs->rows, (uint32_t)slice, scale,
                                           solve->diagonal + LANES * slice, solve->direction,
                                           solve->product + SPRING_ROWS * slice, lanes);
        }
        const double curvature = spring_sum(lanes);
        if (!(curvature > 0.0))
            return;
        for (uint32_t i = 0; i < region->count; i++) {
            const size_t slice = region->slices[i], row = SPRING_ROWS * slice;
            springs->kernel.spring_descend(
                (float)(norm / curvature), solve->direction + SPRING_POINTS * slice,
                solve->product + row, solve->per_diagonal + LANES * slice, solve->change + row,
                solve->residual + row, next);
        }
        const double left = spring_sum(next);
        for (uint32_t i = 0; i < region->count; i++) {
            const size_t slice = region->slices[i];
            springs->kernel.spring_turn((float)(left / norm), solve->residual + SPRING_ROWS * slice,
                                        solve->per_diagonal + LANES * slice,
                                        solve->direction + SPRING_POINTS * slice);
        }
        norm = left;
    }
}

/*
 * With viscosity the springs were taken where they are not: w^T L w / 2, of the way w from there to the end, is what
 * their energy may exceed its tangent by. Directions are used up by now, and take w.
 */
static double excess_by_way(struct dpt_springs *springs, const struct trial *trial)
{
    static const float none[LANES] = { 0.0f };
    const struct active_region *region = &springs->region;
    struct spring_solve *solve = &springs->solve;
    const float back = trial->flight > 0.0f ? (float)springs->lead : 0.0f;
    double lanes[LANES] = { 0.0 };
    for (uint32_t i = 0; i < region->count; i++) {
        const size_t slice = region->slices[i];
        const struct spring_slice *state = springs->state[springs->now] + slice;
        for (int k = 0; k < SPRING_ROWS; k++)
            solve->direction[SPRING_POINTS * slice + 4 * (size_t)(k % LANES) + (size_t)k / LANES] =
                solve->change[SPRING_ROWS * slice + (size_t)k] - back * state->v[k];
    }
    for (uint32_t i = 0; i < region->count; i++)
        springs->kernel.spring_product(
            &springs->rows, region->slices[i], (float)springs->def.stiffness, none,
            solve->direction, solve->product + SPRING_ROWS * (size_t)region->slices[i], lanes);
    return 0.5 * spring_sum(lanes);
}

/* Where a slice's nodes are after a trial, and the sums of its bound. Returns 0 if they leave the finite range. */
static int end_slice(struct dpt_springs *springs, size_t slice, struct trial *trial)
{
    const struct spring_solve *solve = &springs->solve;
    const struct spring_slice *from = springs->state[springs->now] + slice;
    struct spring_slice *to = springs->state[1 - springs->now] + slice;
    const float *force = solve->force + SPRING_ROWS * slice;
    const float *change = solve->change + SPRING_ROWS * slice;
    const float *load = springs->loads[springs->loaded].force + SPRING_ROWS * slice;
    const float *mass = solve->mass + LANES * slice, *diagonal = solve->diagonal + LANES * slice;
    const float scale = (float)springs->def.stiffness, per_h = 1.0f / trial->h;
    const float back = trial->flight > 0.0f ? (float)springs->lead : 0.0f;
    const int has_lead = springs->lead > 0.0;
    float bound[LANES] = { 0 }, work[LANES] = { 0 }, square[LANES] = { 0 };
    uint32_t bad = 0;
    for (int row = 0; row < 3; row++) {
        const float gravity = (float)springs->def.gravity[row];
        for (int i = 0; i < LANES; i++) {
            const int k = LANES * row + i;
            const float v0 = from->v[k], c = change[k], flown = trial->flight * v0;
            const float moved = flown + c, v1 = moved * per_h, way = moved + from->rest[k];
            const float x1 = from->x[k] + way, pull = scale * force[k];
            /* Without viscosity c^T L c comes from c^T A c, which the solution knows. */
            const float b =
                pull + load[k] + mass[i] * gravity + mass[i] * per_h * v0 - diagonal[i] * flown;
            const float curved = has_lead
                                     ? 0.0f
                                     : c * (b - solve->residual[SPRING_ROWS * slice + (size_t)k]) -
                                           c * c * diagonal[i];
            to->rest[k] = way - (x1 - from->x[k]);
            to->x[k] = x1;
            to->v[k] = v1;
            bound[i] += 0.5f * curved - pull * (c - back * v0) + 0.5f * mass[i] * (v1 * v1);
            work[i] += (load[k] + mass[i] * gravity) * moved;
            square[i] += v1 * v1;
            bad |= (uint32_t) !(fabsf(x1) <= (float)DPT_COORDINATE_MAX);
            bad |= (uint32_t) !(fabsf(v1) <= (float)SPRING_FAST);
        }
    }
    float most = 0.0f;
    for (int i = 0; i < LANES; i++) {
        if (mass[i] > 0.0f) {
            trial->bound += (double)bound[i];
            trial->work += (double)work[i];
        }
        most = square[i] > most ? square[i] : most;
    }
    springs->region.square[slice] = most;
    return !bad;
}

static int try_step(struct dpt_springs *springs, struct trial *trial)
{
    const struct active_region *region = &springs->region;
    struct spring_solve *solve = &springs->solve;
    float *points = springs->points[springs->at];
    const float lead = trial->flight > 0.0f ? (float)springs->lead : 0.0f;
    double norm = 0.0;
    int finite = 1;
    for (uint32_t i = 0; i < region->count; i++) {
        const size_t slice = region->slices[i];
        spring_place(springs->state[springs->now] + slice, trial->flight + lead,
                     points + SPRING_POINTS * slice);
    }
    for (uint32_t i = 0; i < region->count; i++) {
        const size_t slice = region->slices[i];
        double lanes[LANES] = { 0.0 };
        springs->kernel.spring_energy(&springs->rows, (uint32_t)slice, points,
                                      solve->force + SPRING_ROWS * slice, lanes);
        solve->energy[slice] = 0.25 * springs->def.stiffness * spring_sum(lanes);
        norm += begin_slice(springs, slice, trial);
    }
    solve_change(springs, trial->h, norm);
    trial->bound = springs->lead > 0.0 ? excess_by_way(springs, trial) : 0.0;
    trial->work = 0.0;
    for (uint32_t i = 0; i < region->count; i++)
        finite &= end_slice(springs, region->slices[i], trial);
    for (uint32_t slice = 0; slice < springs->net.slices; slice++)
        trial->bound += solve->energy[slice];
    return finite;
}

int dpti_implicit_step(struct dpt_springs *springs, double h, uint32_t *flags)
{
    struct spring_solve *solve = &springs->solve;
    struct trial trial = { .h = (float)h, .flight = (float)h };
    if (solve->account < 0.0)
        open_account(springs);
    make_diagonal(springs, h);
    *flags = 0;
    if (!try_step(springs, &trial) ||
        !(trial.bound <= solve->account + trial.work + ACCOUNT_FLOOR)) {
        trial.flight = 0.0f;
        *flags = DPT_SPRINGS_FLAG_HELD;
        if (!try_step(springs, &trial))
            return 0;
    }
    const double allowed = solve->account + trial.work;
    const double kept = 1.0 - (ACCOUNT_LEAK * h < 1.0 ? ACCOUNT_LEAK * h : 1.0);
    solve->account = trial.bound + (allowed > trial.bound ? kept * (allowed - trial.bound) : 0.0);
    springs->now = 1 - springs->now;
    return 1;
}
