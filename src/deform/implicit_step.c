/* SPDX-License-Identifier: BSD-3-Clause */
#include <float.h>
#include <string.h>

#include "deform/cell_volume.h"
#include "deform/loaded_step.h"
#include "deform/spring_step.h"

/*
 * J and 1/s: energies below the floor are rounding. What damping has taken away is forgotten at that rate.
 */
#define ACCOUNT_FLOOR 1e-9
#define ACCOUNT_LEAK  1.0

/*
 * J: a node's share of a norm for which its square, a float, is out of underflow's reach. Passes that go on below would
 * take steps that no longer fit the residual, and make it grow.
 */
#define NORM_PER_NODE ((double)FLT_MIN)

/*
 * A change of the loads is answered by S = OWN / D - REACH / D A / D, of the matrix A and its diagonal D. Of a mode whose
 * eigenvalue in A / D is l, which is 0 to 2, S leaves 1 - OWN l + REACH l^2: at most a half from l = 0.21 to 1.95.
 */
#define ANSWER_OWN   2.7
#define ANSWER_REACH 1.25

/* What is known after a step. */
struct outcome {
    double bound; /* J: the energy is proven not to exceed it */
    double work;  /* J: of loads and gravity */
    uint32_t bad; /* 1: it leaves the finite range */
};

void dpti_implicit_begin(struct dpt_springs *springs)
{
    const struct spring_net *net = &springs->net;
    struct spring_solve *solve = &springs->solve;
    solve->is_free = 1;
    for (uint32_t node = 0; node < net->nodes; node++)
        solve->is_free &= net->mass[node] > 0.0f;
    for (uint32_t slice = 0; slice < net->slices; slice++)
        for (uint32_t lane = 0; lane < LANES; lane++) {
            const uint32_t node = LANES * slice + lane;
            double sum = 0.0;
            for (uint32_t entry = net->first[slice]; entry < net->first[slice + 1]; entry++)
                sum += (double)springs->bound.stiffness[LANES * (size_t)entry + lane];
            solve->systems[slice].mass[lane] = node < net->nodes ? net->mass[node] : 0.0f;
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
    for (uint32_t slice = 0; slice < springs->net.cell_slices; slice++) {
        springs->volumes.energy[slice] = dpti_cells_elastic(springs, slice);
        solve->account += springs->volumes.energy[slice];
    }
}

void dpti_implicit_return(struct dpt_springs *springs, double account, const double common[3])
{
    struct spring_solve *solve = &springs->solve;
    memcpy(solve->common, common, sizeof solve->common);
    solve->account = account;
    if (account < 0.0)
        return;
    open_account(springs);
    solve->account = max_of(account, solve->account);
}

/* Mass / h^2 with drag, and what the springs add to it. */
static void make_diagonal(struct dpt_springs *springs, double step)
{
    struct spring_solve *solve = &springs->solve;
    const float h = (float)step, more = 1.0f + (float)springs->lead / h;
    float loosest = 1.0f;
    if (solve->step == step)
        return;
    solve->step = step;
    for (size_t slice = 0; slice < springs->net.slices; slice++)
        for (size_t lane = 0; lane < LANES; lane++) {
            struct spring_system *system = solve->systems + slice;
            const float drag = 1.0f + h * springs->nodes[slice].drag[lane];
            system->diagonal[lane] = system->mass[lane] * drag / (h * h);
            system->glide[lane] = system->mass[lane] > 0.0f ? 1.0f / drag : 0.0f;
            const float sum = system->diagonal[lane] + more * solve->stiffness[LANES * slice + lane];
            system->per_diagonal[lane] = system->mass[lane] > 0.0f ? 1.0f / sum : 0.0f;
            if (system->per_diagonal[lane] > loosest)
                loosest = system->per_diagonal[lane];
        }
    solve->min_norm = NORM_PER_NODE * (double)loosest * springs->net.nodes;
}

/* What the matrix multiplies the springs' stiffness by. */
static float scale_of(const struct dpt_springs *springs, float h)
{
    return (float)springs->def.stiffness * (1.0f + (float)springs->lead / h);
}

/* Conjugate gradients, preconditioned by the diagonal, for the change. norm: of the residual. */
static void run_passes(struct dpt_springs *springs, float h, double norm)
{
    const struct active_region *region = &springs->region;
    const struct kernel *kernel = &springs->kernel;
    struct spring_solve *solve = &springs->solve;
    const float scale = scale_of(springs, h);
    for (uint32_t n = 1; norm > solve->min_norm; n++) {
        double lanes[LANES] = { 0.0 }, next[LANES] = { 0.0 };
        for (uint32_t i = 0; i < region->count; i++) {
            const size_t slice = region->slices[i];
            kernel->spring_product(&springs->bound, (uint32_t)slice, scale, solve->systems[slice].diagonal,
                                   solve->direction, solve->product + SPRING_ROWS * slice, lanes);
        }
        const double curvature = spring_sum(lanes);
        if (!(curvature > 0.0))
            return;
        for (uint32_t i = 0; i < region->count; i++) {
            const size_t slice = region->slices[i];
            kernel->spring_descend((float)(norm / curvature), solve->direction + SPRING_POINTS * slice,
                                   solve->product + SPRING_ROWS * slice, solve->systems + slice, next);
        }
        if (n == springs->def.iterations)
            return;
        const double left = spring_sum(next);
        for (uint32_t i = 0; i < region->count; i++)
            kernel->spring_turn((float)(left / norm), solve->systems + region->slices[i],
                                solve->direction + SPRING_POINTS * (size_t)region->slices[i]);
        norm = left;
    }
}

/*
 * With viscosity the springs were taken where they are not: w^T L w / 2, of the displacement w from there to the end,
 * is what their energy may exceed its tangent by. Directions are used up by now, and take w.
 */
static double excess_by_way(struct dpt_springs *springs, const struct spring_trial *trial)
{
    static const float none[LANES] = { 0.0f };
    const struct active_region *region = &springs->region;
    struct spring_solve *solve = &springs->solve;
    double lanes[LANES] = { 0.0 };
    for (uint32_t i = 0; i < region->count; i++) {
        const size_t slice = region->slices[i];
        const struct spring_system *system = solve->systems + slice;
        const float *restrict v = springs->state[springs->now][slice].v;
        float *restrict direction = solve->direction + SPRING_POINTS * slice;
        for (int row = 0; row < 3; row++) {
            const float more = trial->step * trial->common[row];
            for (int lane = 0; lane < LANES; lane++) {
                const int k = LANES * row + lane;
                const float speed = trial->flies * system->glide[lane] * (v[k] + more);
                direction[4 * lane + row] = system->change[k] - trial->back * speed;
            }
        }
    }
    for (uint32_t i = 0; i < region->count; i++)
        springs->kernel.spring_product(&springs->bound, region->slices[i], (float)springs->def.stiffness, none,
                                       solve->direction, solve->product + SPRING_ROWS * (size_t)region->slices[i],
                                       lanes);
    return 0.5 * spring_sum(lanes);
}

/* Solve for the change with loads in rows of 48 a slice. */
static void solve_change(struct dpt_springs *springs, const struct spring_trial *trial, const float *load)
{
    const struct active_region *region = &springs->region;
    const struct kernel *kernel = &springs->kernel;
    struct spring_solve *solve = &springs->solve;
    const struct spring_slice *from = springs->state[springs->now];
    float *points = springs->points[springs->at];
    double norm[LANES] = { 0.0 };
    for (uint32_t i = 0; i < region->count; i++)
        kernel->spring_aim(trial, from + region->slices[i], solve->systems + region->slices[i],
                           points + SPRING_POINTS * (size_t)region->slices[i]);
    dpti_cells_pull_energy(springs, points);
    for (uint32_t i = 0; i < region->count; i++) {
        const size_t slice = region->slices[i], row = SPRING_ROWS * slice;
        double energy[LANES] = { 0.0 };
        kernel->spring_energy(&springs->rows, (uint32_t)slice, points, solve->force + row, energy);
        solve->energy[slice] = 0.25 * springs->def.stiffness * spring_sum(energy);
        if (springs->net.cells)
            dpti_cells_add(springs, (uint32_t)slice, solve->force + row);
        kernel->spring_begin(trial, from + slice, solve->force + row, load + row, solve->systems + slice,
                             solve->direction + SPRING_POINTS * slice, norm);
    }
    run_passes(springs, trial->step, spring_sum(norm));
}

/* Take the change, with the loads of the step. */
static struct outcome take_change(struct dpt_springs *springs, const struct spring_trial *trial)
{
    const struct active_region *region = &springs->region;
    struct spring_solve *solve = &springs->solve;
    const struct spring_slice *from = springs->state[springs->now];
    struct spring_slice *to = springs->state[1 - springs->now];
    const float *load = springs->loads[springs->loaded].force;
    double bound[LANES] = { 0.0 }, work[LANES] = { 0.0 };
    struct outcome outcome = { .bad = 0 };
    if (trial->has_lead)
        outcome.bound = excess_by_way(springs, trial);
    for (uint32_t i = 0; i < region->count; i++) {
        const size_t slice = region->slices[i], row = SPRING_ROWS * slice;
        outcome.bad |=
            springs->kernel.spring_end(trial, from + slice, solve->force + row, load + row, solve->systems + slice,
                                       to + slice, bound, work, springs->region.square + slice);
    }
    outcome.work = spring_sum(work);
    outcome.bound += spring_sum(bound);
    for (uint32_t slice = 0; slice < springs->net.slices; slice++)
        outcome.bound += solve->energy[slice];
    for (uint32_t slice = 0; slice < springs->net.cell_slices; slice++)
        outcome.bound += springs->volumes.energy[slice];
    return outcome;
}

/*
 * What a few passes leave of a motion that all nodes have in common, as in free fall, goes into the start of the next
 * step. A body that fixed nodes hold, or nodes that sleep, has none; there it would keep a press from its end.
 */
static void note_common(struct dpt_springs *springs, double h)
{
    struct spring_solve *solve = &springs->solve;
    const struct active_region *region = &springs->region;
    double lanes[4][LANES] = { { 0.0 } };
    for (uint32_t i = 0; i < region->count; i++) {
        const struct spring_system *system = solve->systems + region->slices[i];
        const float *v0 = springs->state[springs->now][region->slices[i]].v;
        const float *v1 = springs->state[1 - springs->now][region->slices[i]].v;
        for (int lane = 0; lane < LANES; lane++) {
            const float mass = system->mass[lane];
            const float kept = mass > 0.0f ? system->glide[lane] : 1.0f;
            for (int row = 0; row < 3; row++)
                lanes[row][lane] += (double)(mass * (v1[LANES * row + lane] / kept - v0[LANES * row + lane]));
            lanes[3][lane] += (double)mass;
        }
    }
    const double mass = spring_sum(lanes[3]);
    for (int row = 0; row < 3; row++)
        solve->common[row] = mass > 0.0 ? spring_sum(lanes[row]) / (mass * h) : 0.0;
}

/* ---- a step whose loads are found ---- */

void dpti_implicit_step_begin(struct implicit_step *step, struct dpt_springs *springs, double h, uint32_t substeps)
{
    *step = (struct implicit_step){ .springs = springs,
                                    .h = h,
                                    .trial = { .step = (float)h,
                                               .per_step = 1.0f / (float)h,
                                               .flies = 1.0f,
                                               .back = (float)springs->lead,
                                               .scale = (float)springs->def.stiffness,
                                               .far = (float)DPT_COORDINATE_MAX,
                                               .fast = (float)SPRING_FAST,
                                               .has_lead = springs->lead > 0.0 } };
    for (int k = 0; k < 3; k++)
        step->trial.gravity[k] = (float)springs->def.gravity[k];
    make_diagonal(springs, h);
    if (substeps > 1)
        memcpy(springs->solve.begin, springs->state[springs->now], springs->net.slices * sizeof(struct spring_slice));
}

/* What the last substep left. */
static void take_over(struct implicit_step *step)
{
    struct spring_solve *solve = &step->springs->solve;
    for (int k = 0; k < 3; k++)
        step->trial.common[k] = (float)solve->common[k];
    if (solve->account < 0.0)
        open_account(step->springs);
}

double dpti_implicit_response(const struct implicit_step *step, uint32_t node)
{
    return (ANSWER_OWN - ANSWER_REACH) * (double)step->springs->solve.systems[node / LANES].per_diagonal[node % LANES];
}

int dpti_implicit_neighbour(const struct implicit_step *step, uint32_t node, uint32_t *entry, uint32_t *other,
                            double *response)
{
    const struct dpt_springs *springs = step->springs;
    const struct spring_system *systems = springs->solve.systems;
    const uint32_t first = springs->net.first[node / LANES], end = springs->net.first[node / LANES + 1];
    const double scale = (double)scale_of(springs, (float)step->h);
    for (; first + *entry < end; ++*entry) {
        const size_t at = LANES * (size_t)(first + *entry) + node % LANES;
        if (!(springs->bound.stiffness[at] > 0.0f))
            continue;
        *other = springs->net.neighbour[at];
        *response = ANSWER_REACH * scale * (double)springs->bound.stiffness[at] *
                    (double)systems[node / LANES].per_diagonal[node % LANES] *
                    (double)systems[*other / LANES].per_diagonal[*other % LANES];
        ++*entry;
        return 1;
    }
    return 0;
}

vec3 dpti_implicit_place(const struct implicit_step *step, uint32_t node)
{
    return spring_place(step->springs->state[step->springs->now], node);
}

/* The loads that a slice's nodes are foreseen with. */
static const float *loads_before(const struct dpt_springs *springs, uint32_t slice)
{
    const float *row =
        springs->region.is_awake[slice] ? springs->loads[1 - springs->loaded].force : springs->region.held;
    return row + SPRING_ROWS * (size_t)slice;
}

static void add_near(struct dpt_springs *springs, uint32_t slice)
{
    struct spring_solve *solve = &springs->solve;
    if (!solve->is_near[slice])
        solve->near[solve->near_count++] = slice;
    solve->is_near[slice] = 1;
}

/* The slices that are loaded, or were in the step before, and their neighbours. */
static void find_near(struct dpt_springs *springs)
{
    struct spring_solve *solve = &springs->solve;
    const struct active_region *region = &springs->region;
    while (solve->near_count)
        solve->is_near[solve->near[--solve->near_count]] = 0;
    for (int which = 0; which < 2; which++)
        for (uint32_t i = 0; i < springs->loads[which].count; i++) {
            const uint32_t slice = springs->loads[which].slices[i];
            add_near(springs, slice);
            for (uint32_t k = region->first[slice]; k < region->first[slice + 1]; k++)
                add_near(springs, region->neighbours[k]);
        }
}

/* Whether loads on a slice may have changed. */
static int has_change(const struct dpt_springs *springs, uint32_t slice)
{
    return !springs->region.is_awake[slice] || springs->loads[0].marked[slice] || springs->loads[1].marked[slice];
}

/*
 * How far the change of the loads moves nodes: into the rows of the slices that are near. Directions are zero but where
 * loads are.
 */
static void find_answer(struct implicit_step *step)
{
    struct dpt_springs *springs = step->springs;
    struct spring_solve *solve = &springs->solve;
    const float scale = scale_of(springs, (float)step->h);
    find_near(springs);
    for (uint32_t i = 0; i < solve->near_count; i++) {
        const uint32_t slice = solve->near[i];
        const float *now = springs->loads[springs->loaded].force + SPRING_ROWS * (size_t)slice;
        const float *before = loads_before(springs, slice), *per_diagonal = solve->systems[slice].per_diagonal;
        float *direction = solve->direction + SPRING_POINTS * (size_t)slice;
        if (!has_change(springs, slice))
            continue;
        for (uint32_t row = 0; row < 3; row++)
            for (uint32_t lane = 0; lane < LANES; lane++)
                direction[4 * lane + row] = per_diagonal[lane] * (now[LANES * row + lane] - before[LANES * row + lane]);
    }
    for (uint32_t i = 0; i < solve->near_count; i++) {
        const size_t slice = solve->near[i];
        const struct spring_system *restrict system = solve->systems + slice;
        const float *restrict direction = solve->direction + SPRING_POINTS * slice;
        float *restrict product = solve->product + SPRING_ROWS * slice;
        double lanes[LANES] = { 0.0 };
        springs->kernel.spring_product(&springs->bound, (uint32_t)slice, scale, system->diagonal, solve->direction,
                                       product, lanes);
        for (uint32_t row = 0; row < 3; row++)
            for (uint32_t lane = 0; lane < LANES; lane++)
                product[LANES * row + lane] =
                    (float)ANSWER_OWN * direction[4 * lane + row] -
                    (float)ANSWER_REACH * system->per_diagonal[lane] * product[LANES * row + lane];
    }
    for (uint32_t i = 0; i < solve->near_count; i++)
        memset(solve->direction + SPRING_POINTS * (size_t)solve->near[i], 0, SPRING_POINTS * sizeof(float));
}

/* What the loads before do. Passes leave directions that are of no use any more. */
static void foresee_all(struct implicit_step *step)
{
    struct dpt_springs *springs = step->springs;
    take_over(step);
    solve_change(springs, &step->trial, springs->loads[1 - springs->loaded].force);
    for (uint32_t i = 0; i < springs->region.count; i++)
        memset(springs->solve.direction + SPRING_POINTS * (size_t)springs->region.slices[i], 0,
               SPRING_POINTS * sizeof(float));
    find_answer(step);
    step->is_foreseen = 1;
    step->active = springs->region.count;
}

void dpti_implicit_foresee(struct implicit_step *step, uint32_t slice, uint32_t lanes, double moved[SPRING_ROWS])
{
    struct dpt_springs *springs = step->springs;
    const struct spring_trial *trial = &step->trial;
    const struct spring_system *system = springs->solve.systems + slice;
    const float *v = springs->state[springs->now][slice].v;
    if (!step->is_foreseen)
        foresee_all(step);
    for (uint32_t lane = 0; lanes; lane++, lanes >>= 1)
        for (uint32_t k = lane; k < SPRING_ROWS && lanes & 1; k += LANES) {
            moved[k] =
                springs->solve.is_near[slice] ? (double)springs->solve.product[SPRING_ROWS * (size_t)slice + k] : 0.0;
            if (springs->region.is_awake[slice])
                moved[k] += (double)(trial->flies * system->glide[lane] *
                                     (trial->step * (v[k] + trial->step * trial->common[k / LANES]))) +
                            (double)system->change[k];
        }
}

/* The change takes in what the loads have changed by since it was solved for. */
static void answer_loads(struct implicit_step *step)
{
    const struct active_region *region = &step->springs->region;
    struct spring_solve *solve = &step->springs->solve;
    find_answer(step);
    for (uint32_t i = 0; i < solve->near_count; i++) {
        const size_t slice = solve->near[i];
        for (uint32_t k = 0; region->is_awake[slice] && k < SPRING_ROWS; k++)
            solve->systems[slice].change[k] += solve->product[SPRING_ROWS * slice + k];
    }
}

int dpti_implicit_substep(struct implicit_step *step, uint32_t *flags)
{
    struct dpt_springs *springs = step->springs;
    struct spring_solve *solve = &springs->solve;
    const float *load = springs->loads[springs->loaded].force;
    uint32_t held = 0;
    if (!step->is_foreseen)
        take_over(step);
    struct spring_trial trial = step->trial;
    if (step->is_foreseen && step->active == springs->region.count) {
        /* The residual is not that of the change any more: what the account needs is computed. */
        trial.has_lead = 1;
        answer_loads(step);
    } else {
        solve_change(springs, &trial, load);
    }
    struct outcome outcome = take_change(springs, &trial);
    if (outcome.bad || !(outcome.bound <= solve->account + outcome.work + ACCOUNT_FLOOR)) {
        trial = step->trial;
        trial.flies = trial.back = 0.0f;
        held = DPT_SPRINGS_FLAG_HELD;
        solve_change(springs, &trial, load);
        outcome = take_change(springs, &trial);
    }
    *flags |= held;
    if (outcome.bad)
        return 0;
    if (held || !solve->is_free || springs->region.count < springs->net.slices)
        memset(solve->common, 0, sizeof solve->common);
    else
        note_common(springs, step->h);
    const double allowed = solve->account + outcome.work;
    const double kept = 1.0 - (ACCOUNT_LEAK * step->h < 1.0 ? ACCOUNT_LEAK * step->h : 1.0);
    solve->account = outcome.bound + (allowed > outcome.bound ? kept * (allowed - outcome.bound) : 0.0);
    springs->now = 1 - springs->now;
    step->is_foreseen = 0;
    step->done++;
    return 1;
}

void dpti_implicit_undo(struct implicit_step *step, uint32_t substeps)
{
    struct dpt_springs *springs = step->springs;
    if (!step->done)
        return;
    if (substeps > 1)
        memcpy(springs->state[springs->now], springs->solve.begin, springs->net.slices * sizeof(struct spring_slice));
    else
        springs->now = 1 - springs->now;
    dpti_implicit_forget(springs);
}
