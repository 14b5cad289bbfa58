/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/loaded_step.h"

#include <math.h>
#include <string.h>

#include "deform/active_region.h"
#include "deform/spring_step.h"
#include "deform/spring_vertices.h"

/* The share of the stable step that a substep uses. */
#define STABLE_SHARE 0.9

/*
 * Of a substep: the least viscosity of SYMPLECTIC. Nodes that are thrown about go through more of a spring's turns than a
 * step resolves, and would gain energy from that; a slow motion does not feel it.
 */
#define LEAST_LEAD 0.01

/*
 * Of a substep in which tools touch: the least viscosity. Of SYMPLECTIC a push meets the springs where nodes are at its
 * beginning, and the tool where they are at its end; of IMPLICIT the answer to a change of the loads is not the whole one.
 * Without viscosity a tool that moves is driven by that.
 */
#define TOUCHED_LEAD          0.75
#define TOUCHED_LEAD_IMPLICIT 0.25

static void add_load(struct spring_loads *to, uint32_t node, double weight, const double force[3])
{
    const uint32_t slice = node / LANES, lane = node % LANES;
    if (!to->marked[slice])
        to->slices[to->count++] = slice;
    to->marked[slice] = 1;
    for (uint32_t row = 0; row < 3; row++)
        to->force[SPRING_ROWS * (size_t)slice + LANES * row + lane] += (float)(weight * force[row]);
}

/* The loads of a step, in place of those of the step before the last; on nodes, or on vertices that follow them. */
static void set_loads(struct spring_loads *to, const dpt_load *loads, uint32_t count,
                      const struct spring_vertices *vertices)
{
    for (uint32_t i = 0; i < to->count; i++) {
        to->marked[to->slices[i]] = 0;
        memset(to->force + SPRING_ROWS * (size_t)to->slices[i], 0, SPRING_ROWS * sizeof *to->force);
    }
    to->count = 0;
    for (uint32_t i = 0; i < count; i++) {
        const size_t first = 4 * (size_t)loads[i].vertex;
        if (!vertices || !vertices->nodes)
            add_load(to, loads[i].vertex, 1.0, loads[i].force);
        for (size_t k = first; vertices && vertices->nodes && k < first + 4; k++)
            add_load(to, vertices->nodes[k], (double)vertices->weights[k], loads[i].force);
    }
}

static uint32_t substeps_no_longer_than(double longest, double dt)
{
    const uint32_t whole = (uint32_t)(dt / longest);
    return whole + ((double)whole * longest < dt);
}

uint32_t dpti_springs_substeps_of(const struct dpt_springs *springs, double dt)
{
    const uint32_t least = springs->def.min_substeps ? springs->def.min_substeps : 1;
    if (springs->def.integrator == DPT_INTEGRATOR_IMPLICIT)
        return least;
    const double longest = STABLE_SHARE * springs->stable_step;
    if (!(dt <= longest * (double)springs->def.max_substeps))
        return 0;
    const uint32_t stable = substeps_no_longer_than(longest, dt);
    return stable > least ? stable : least;
}

uint32_t dpti_springs_touched_substeps(const struct dpt_springs *springs, double dt)
{
    const uint32_t own = dpti_springs_substeps_of(springs, dt), most = springs->def.max_substeps;
    if (springs->def.integrator != DPT_INTEGRATOR_SYMPLECTIC ||
        springs->net.viscosity * (double)own >= TOUCHED_LEAD * dt)
        return own;
    /* A step d with a viscosity of v d is stable where d^2 omega^2 (1 + 2 v) <= 4. */
    const double root = sqrt((1.0 + 2.0 * TOUCHED_LEAD * STABLE_SHARE) * springs->square);
    const double longest = min_of(2.0 * STABLE_SHARE / root, DPT_SPRINGS_STEP_MAX);
    if (!(dt <= longest * (double)most))
        return own ? most : 0;
    const uint32_t substeps = substeps_no_longer_than(longest, dt);
    return substeps > own ? substeps : own;
}

/* s: what SYMPLECTIC has at least; no more than what is stable. */
static double least_lead(const struct dpt_springs *springs, double h, int is_touched)
{
    const double d = h / STABLE_SHARE, stable = 0.5 * (4.0 / (springs->square * d) - d);
    return max_of(LEAST_LEAD * h, is_touched ? min_of(TOUCHED_LEAD * h, stable) : 0.0);
}

/* Springs are taken where nodes are after the lead. */
static void set_lead(struct dpt_springs *springs, double least)
{
    const struct active_region *region = &springs->region;
    const double lead = max_of(springs->net.viscosity, least);
    if (springs->lead == lead)
        return;
    springs->lead = lead;
    springs->solve.step = 0.0;
    for (uint32_t i = 0; i < region->count; i++)
        springs->kernel.spring_points(springs->state[springs->now] + region->slices[i], (float)lead,
                                      springs->points[springs->at] + SPRING_POINTS * (size_t)region->slices[i]);
}

void dpti_loaded_step_begin(struct loaded_step *step, struct dpt_springs *springs, double dt, uint32_t substeps,
                            uint32_t load_count, int is_touched)
{
    const double h = dt / (double)substeps;
    *step = (struct loaded_step){
        .springs = springs, .dt = dt, .load_count = load_count, .info = { .size = sizeof step->info }
    };
    step->info.substeps = substeps;
    step->info.nodes = springs->net.nodes;
    step->info.stable_step = springs->stable_step;
    springs->loaded = 1 - springs->loaded;
    if (springs->def.integrator == DPT_INTEGRATOR_SYMPLECTIC)
        set_lead(springs, least_lead(springs, h, is_touched));
    if (springs->def.integrator == DPT_INTEGRATOR_IMPLICIT) {
        set_lead(springs, is_touched ? TOUCHED_LEAD_IMPLICIT * h : 0.0);
        dpti_implicit_step_begin(&step->implicit, springs, h, substeps);
    } else {
        dpti_explicit_begin(&step->explicit, springs, h);
    }
}

void dpti_loaded_step_begin_yield(struct loaded_step *step, struct local_yield *yield, double dt, double share,
                                  uint32_t substeps)
{
    *step = (struct loaded_step){ .yield = yield, .share = share, .dt = dt, .info = { .size = sizeof step->info } };
    step->info.substeps = substeps;
    step->info.nodes = yield->vertex_count;
    step->info.active = yield->count;
    dpti_yield_begin(yield, dt, substeps);
}

static int is_implicit(const struct loaded_step *step)
{
    return step->springs->def.integrator == DPT_INTEGRATOR_IMPLICIT;
}

void dpti_loaded_step_foresee(struct loaded_step *step, uint32_t slice, uint32_t lanes, double moved[SPRING_ROWS],
                              double slid[SPRING_ROWS])
{
    if (step->yield)
        dpti_yield_foresee(step->yield, slice, step->dt, step->share, moved);
    else if (is_implicit(step))
        dpti_implicit_foresee(&step->implicit, slice, lanes, moved);
    else
        dpti_explicit_foresee(&step->explicit, slice, lanes, moved, slid);
    if (step->yield || is_implicit(step))
        memcpy(slid, moved, SPRING_ROWS * sizeof *slid);
}

vec3 dpti_loaded_step_place(const struct loaded_step *step, uint32_t node)
{
    if (step->yield)
        return dpti_yield_place(step->yield, node);
    return is_implicit(step) ? dpti_implicit_place(&step->implicit, node) : dpti_explicit_place(&step->explicit, node);
}

double dpti_loaded_step_response(const struct loaded_step *step, uint32_t node)
{
    if (step->yield)
        return step->share * dpti_yield_compliance(step->yield, node);
    return is_implicit(step) ? dpti_implicit_response(&step->implicit, node)
                             : dpti_explicit_response(&step->explicit, node);
}

int dpti_loaded_step_neighbour(const struct loaded_step *step, uint32_t node, uint32_t *entry, uint32_t *other,
                               double *response)
{
    return !step->yield && is_implicit(step) && dpti_implicit_neighbour(&step->implicit, node, entry, other, response);
}

void dpti_loaded_step_set(struct loaded_step *step)
{
    struct dpt_springs *springs = step->springs;
    if (step->yield)
        dpti_yield_unload(step->yield);
    else
        set_loads(&springs->loads[springs->loaded], springs->vertices.loads, step->load_count, &springs->vertices);
}

void dpti_loaded_step_add(struct loaded_step *step, uint32_t node, vec3 force)
{
    double on_node[3];
    vec3_store(force, on_node);
    if (step->yield)
        dpti_yield_load(step->yield, node, force);
    else
        add_load(&step->springs->loads[step->springs->loaded], node, 1.0, on_node);
}

/* Slices whose loads have changed wake; those that are awake make the substep. */
static void wake(struct loaded_step *step)
{
    struct dpt_springs *springs = step->springs;
    dpti_region_wake_loaded(springs);
    const uint32_t active = springs->region.count * LANES;
    step->info.active = active < step->info.nodes ? active : step->info.nodes;
}

int dpti_loaded_step_go(struct loaded_step *step)
{
    if (step->yield) {
        dpti_yield_go(step->yield, step->dt, step->share);
        return 1;
    }
    wake(step);
    step->has_failed = is_implicit(step) ? !dpti_implicit_substep(&step->implicit, &step->info.flags)
                                         : !dpti_explicit_substep(&step->explicit);
    return !step->has_failed;
}

void dpti_loaded_step_take(struct loaded_step *step)
{
    if (!is_implicit(step) && !step->is_taken)
        dpti_explicit_take(&step->explicit);
    step->is_taken = 1;
    dpti_spring_vertices_note(step->springs);
}

void dpti_loaded_step_keep(struct loaded_step *step)
{
    dpti_region_settle(step->springs, step->dt);
}

/* The largest squared speed of a slice. */
static float square_of(const struct spring_slice *slice)
{
    float square = 0.0f;
    for (int lane = 0; lane < LANES; lane++) {
        const float x = slice->v[lane], y = slice->v[LANES + lane], z = slice->v[2 * LANES + lane];
        square = x * x + y * y + z * z > square ? x * x + y * y + z * z : square;
    }
    return square;
}

/* What may have been gathered of its vertices is gathered anew after the next step. */
void dpti_loaded_step_undo(struct loaded_step *step)
{
    struct dpt_springs *springs = step->springs;
    if (step->yield) {
        dpti_yield_undo(step->yield);
        return;
    }
    if (is_implicit(step))
        dpti_implicit_undo(&step->implicit, step->info.substeps);
    else
        dpti_explicit_undo(&step->explicit, step->is_taken);
    springs->loaded = 1 - springs->loaded;
    for (uint32_t i = 0; i < springs->region.count; i++) {
        const uint32_t slice = springs->region.slices[i];
        springs->region.square[slice] = square_of(springs->state[springs->now] + slice);
    }
    dpti_spring_vertices_note(springs);
}

int dpti_loaded_step_make(struct loaded_step *step, struct dpt_springs *springs, double dt, const dpt_load *loads,
                          uint32_t count, const struct spring_vertices *vertices)
{
    dpti_loaded_step_begin(step, springs, dt, dpti_springs_substeps_of(springs, dt), 0, 0);
    set_loads(&springs->loads[springs->loaded], loads, count, vertices);
    wake(step);
    if (is_implicit(step)) {
        int is_done = 1;
        for (uint32_t i = 0; i < step->info.substeps && is_done; i++)
            is_done = dpti_implicit_substep(&step->implicit, &step->info.flags);
        return is_done;
    }
    step->is_taken = dpti_springs_substeps(springs, dt / (double)step->info.substeps, step->info.substeps);
    return step->is_taken;
}
