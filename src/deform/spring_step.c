/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/spring_step.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "deform/cell_volume.h"
#include "deform/loaded_step.h"

static vec3 place_of(const struct spring_slice *state, uint32_t node)
{
    const float *x = state[node / LANES].x + node % LANES;
    return (vec3){ (double)x[0], (double)x[LANES], (double)x[2 * LANES] };
}

double dpti_springs_elastic(const struct dpt_springs *springs, uint32_t slice)
{
    const struct spring_net *net = &springs->net;
    const struct spring_slice *state = springs->state[springs->now];
    double sum = 0.0;
    for (uint32_t entry = net->first[slice]; entry < net->first[slice + 1]; entry++)
        for (uint32_t lane = 0; lane < LANES && LANES * slice + lane < net->nodes; lane++) {
            const size_t at = LANES * (size_t)entry + lane;
            const vec3 to = sub(place_of(state, net->neighbour[at]), place_of(state, LANES * slice + lane));
            const double square = dot(to, to), length = (double)net->length[at];
            const double shortest = (double)SPRING_SHORTEST * length;
            const double distance = sqrt(square) > shortest ? sqrt(square) : shortest;
            sum += (double)net->stiffness[at] * ((distance - length) * (distance - length) +
                                                 (distance > shortest ? 0.0 : shortest * shortest - square));
        }
    return 0.25 * springs->def.stiffness * sum;
}

double dpti_springs_kinetic(const struct dpt_springs *springs)
{
    const struct spring_slice *state = springs->state[springs->now];
    double sum = 0.0;
    for (uint32_t node = 0; node < springs->net.nodes; node++) {
        const float *v = state[node / LANES].v + node % LANES;
        const vec3 speed = { (double)v[0], (double)v[LANES], (double)v[2 * LANES] };
        sum += (double)springs->net.mass[node] * dot(speed, speed);
    }
    return 0.5 * sum;
}

/* ---- explicit steps ---- */

/*
 * One mode, x'' = -w2 (x + t x') - c x'. The step's matrix has the trace 1 + (1 - h t w2 - s h2 w2) / (1 + h c) and the
 * determinant (1 - h t w2 + e h2 w2) / (1 + h c), where s is 1 for SYMPLECTIC and e is 1 for EULER. Its eigenvalues
 * are at most 1 while the determinant is, and while 1 + trace + determinant is not negative.
 */
double dpti_springs_limit(uint32_t integrator, double square, double viscosity, double drag)
{
    double limit = DPT_SPRINGS_STEP_MAX;
    if (!(square > 0.0))
        return limit;
    const double lead = viscosity - drag / square, root = lead * lead - 4.0 / square;
    if (integrator == DPT_INTEGRATOR_SYMPLECTIC)
        limit = sqrt(lead * lead + 4.0 / square) - lead;
    else {
        limit = viscosity + drag / square;
        if (lead > 0.0 && root >= 0.0 && lead - sqrt(root) < limit)
            limit = lead - sqrt(root);
    }
    return limit < DPT_SPRINGS_STEP_MAX ? limit : DPT_SPRINGS_STEP_MAX;
}

/* What is known of forces holds no more. A body of which nothing is foreseen has none to forget. */
static void forget_forces(struct explicit_step *step)
{
    step->forced = DPT_NONE;
}

void dpti_explicit_begin(struct explicit_step *step, struct dpt_springs *springs, double h)
{
    *step = (struct explicit_step){ .springs = springs,
                                    .motion = { .step = (float)h,
                                                .scale = (float)springs->def.stiffness,
                                                .lead = (float)springs->lead,
                                                .far = (float)DPT_COORDINATE_MAX,
                                                .fast = (float)SPRING_FAST,
                                                .is_euler = springs->def.integrator == DPT_INTEGRATOR_EULER } };
    for (int k = 0; k < 3; k++)
        step->motion.gravity[k] = (float)springs->def.gravity[k];
    forget_forces(step);
}

/* What springs and cells do to a slice that is awake. */
static void find_force(struct explicit_step *step, uint32_t slice, float force[SPRING_ROWS])
{
    struct dpt_springs *springs = step->springs;
    const float *points = springs->points[springs->at];
    springs->kernel.spring_forces(&springs->rows, slice, points, force);
    if (!springs->net.cells)
        return;
    if (step->pulled != springs->region.count)
        dpti_cells_pull(springs, points);
    step->pulled = springs->region.count;
    dpti_cells_add(springs, slice, force);
}

/* The same, where it may be known: a substep that is foreseen, and then made, asks twice. */
static const float *force_on(struct explicit_step *step, uint32_t slice)
{
    struct dpt_springs *springs = step->springs;
    float *force = springs->forces + SPRING_ROWS * (size_t)slice;
    if (step->forced != springs->region.count)
        memset(springs->is_forced, 0, springs->net.slices);
    step->forced = springs->region.count;
    if (!springs->is_forced[slice])
        find_force(step, slice, force);
    springs->is_forced[slice] = 1;
    return force;
}

/* The state that the next substep begins with. */
static const struct spring_slice *state_of(const struct explicit_step *step)
{
    return step->springs->state[step->done ? 1 - step->springs->now : step->springs->now];
}

int dpti_explicit_substep(struct explicit_step *step)
{
    struct dpt_springs *springs = step->springs;
    const struct active_region *region = &springs->region;
    const float *load = springs->loads[springs->loaded].force;
    const struct spring_slice *from = state_of(step);
    struct spring_slice *to = springs->state[1 - springs->now];
    float *next = springs->points[1 - springs->at], found[SPRING_ROWS];
    const int is_foreseen = step->forced == region->count;
    uint32_t bad = 0;
    for (uint32_t i = 0; i < region->count; i++) {
        const size_t slice = region->slices[i];
        const float *force = found;
        if (is_foreseen && springs->is_forced[slice])
            force = springs->forces + SPRING_ROWS * slice;
        else
            find_force(step, (uint32_t)slice, found);
        bad |=
            springs->kernel.spring_move(&step->motion, springs->nodes + slice, force, load + SPRING_ROWS * slice,
                                        from + slice, to + slice, next + SPRING_POINTS * slice, region->square + slice);
    }
    springs->at = 1 - springs->at;
    step->pulled = 0;
    forget_forces(step);
    step->done++;
    return !bad;
}

void dpti_explicit_take(struct explicit_step *step)
{
    step->springs->now = 1 - step->springs->now;
}

void dpti_explicit_undo(struct explicit_step *step, int is_taken)
{
    struct dpt_springs *springs = step->springs;
    if (is_taken)
        springs->now = 1 - springs->now;
    const struct spring_slice *last = springs->state[springs->now];
    for (uint32_t i = 0; i < springs->region.count; i++) {
        const size_t slice = springs->region.slices[i];
        springs->kernel.spring_points(last + slice, step->motion.lead,
                                      springs->points[springs->at] + SPRING_POINTS * slice);
    }
}

int dpti_springs_substeps(struct dpt_springs *springs, double h, uint32_t count)
{
    struct explicit_step step;
    int is_done = 1;
    dpti_explicit_begin(&step, springs, h);
    for (uint32_t i = 0; i < count && is_done; i++)
        is_done = dpti_explicit_substep(&step);
    if (is_done)
        dpti_explicit_take(&step);
    else
        dpti_explicit_undo(&step, 0);
    return is_done;
}

double dpti_explicit_response(const struct explicit_step *step, uint32_t node)
{
    const struct spring_nodes *nodes = step->springs->nodes + node / LANES;
    const double h = (double)step->motion.step, drag = (double)nodes->drag[node % LANES];
    return h * h * (double)nodes->per_mass[node % LANES] / (1.0 + h * drag);
}

vec3 dpti_explicit_place(const struct explicit_step *step, uint32_t node)
{
    return spring_place(state_of(step), node);
}

void dpti_explicit_foresee(struct explicit_step *step, uint32_t slice, uint32_t lanes, double moved[SPRING_ROWS],
                           double slid[SPRING_ROWS])
{
    const struct dpt_springs *springs = step->springs;
    const float *load = springs->loads[springs->loaded].force + SPRING_ROWS * (size_t)slice;
    const struct spring_slice *from = state_of(step) + slice;
    const double h = (double)step->motion.step;
    float points[SPRING_POINTS], square;
    struct spring_slice to;
    if (!springs->region.is_awake[slice]) {
        const float *held = springs->region.held + SPRING_ROWS * (size_t)slice;
        for (uint32_t i = 0; i < SPRING_ROWS; i++)
            moved[i] = slid[i] =
                dpti_explicit_response(step, LANES * slice + i % LANES) * ((double)load[i] - (double)held[i]);
        return;
    }
    springs->kernel.spring_move(&step->motion, springs->nodes + slice, force_on(step, slice), load, from, &to, points,
                                &square);
    for (uint32_t lane = 0; lanes; lane++, lanes >>= 1)
        for (uint32_t i = lane; i < SPRING_ROWS && lanes & 1; i += LANES) {
            moved[i] = ((double)to.x[i] - (double)from->x[i]) + ((double)to.rest[i] - (double)from->rest[i]);
            slid[i] = step->motion.is_euler ? h * (double)to.v[i] : moved[i];
            if (step->motion.is_euler)
                moved[i] += slid[i];
        }
}

/* ---- the stable step ---- */

/* Passes in search of a swing that is faster than the file says, and what counts as rounding. */
enum { PASSES = 24 };
#define ROUNDING 1e-4

/*
 * Of a step: so much viscosity a net has that goes by what its file says. Nodes that are thrown about turn springs, which
 * gives them energy; what rows say leaves room enough for that, cells by themselves do not.
 */
#define VISCOUS 0.125

/* The largest row of the stiffness, per mass (Gershgorin); a spring between two nodes that move counts twice. */
static double largest_row(const struct dpt_springs *springs)
{
    const struct spring_net *net = &springs->net;
    const double stiffness = springs->def.stiffness, contact = springs->def.contact_stiffness;
    double largest = 0.0;
    for (uint32_t slice = 0; slice < net->slices; slice++)
        for (uint32_t lane = 0; lane < LANES && LANES * slice + lane < net->nodes; lane++) {
            const double mass = (double)net->mass[LANES * (size_t)slice + lane];
            double sum = contact;
            for (uint32_t entry = net->first[slice]; entry < net->first[slice + 1]; entry++) {
                const size_t at = LANES * (size_t)entry + lane;
                const double k = stiffness * (double)springs->bound.stiffness[at];
                sum += net->mass[net->neighbour[at]] > 0.0f ? 2.0 * k : k;
            }
            if (mass > 0.0 && sum > largest * mass)
                largest = sum / mass;
        }
    return largest;
}

/* 1 / kg: of the lightest node that moves. */
static double max_per_mass(const struct spring_net *net)
{
    double max = 0.0;
    for (uint32_t node = 0; node < net->nodes; node++)
        if (net->mass[node] > 0.0f && 1.0 / (double)net->mass[node] > max)
            max = 1.0 / (double)net->mass[node];
    return max;
}

/* Three motions at once, along x, y and z, in which neighbours move as if by chance. */
static void begin_swing(struct dpt_springs *springs)
{
    uint32_t random = 1;
    for (uint32_t slice = 0; slice < springs->net.slices; slice++)
        for (uint32_t i = 0; i < SPRING_POINTS; i++) {
            random = 1664525u * random + 1013904223u;
            springs->points[0][SPRING_POINTS * (size_t)slice + i] =
                springs->nodes[slice].per_mass[i / 4] > 0.0f && i % 4 < 3 ? (random >> 31 ? 1.0f : -1.0f) : 0.0f;
        }
}

/* Mass times the square of the motion, summed up. */
static double size_of(const struct dpt_springs *springs)
{
    double sum = 0.0;
    for (size_t i = 0; i < 4 * (size_t)springs->net.nodes; i++)
        sum += (double)springs->net.mass[i / 4] * (double)springs->points[0][i] * (double)springs->points[0][i];
    return sum;
}

/* The motion becomes the acceleration that it causes, times `scale`. */
static void accelerate(struct dpt_springs *springs, float scale)
{
    static const float none[LANES] = { 0.0f };
    double unused[LANES] = { 0.0 };
    for (uint32_t slice = 0; slice < springs->net.slices; slice++)
        springs->kernel.spring_product(&springs->bound, slice, scale, none, springs->points[0],
                                       springs->state[1][slice].x, unused);
    for (uint32_t slice = 0; slice < springs->net.slices; slice++)
        for (uint32_t i = 0; i < LANES; i++)
            for (uint32_t row = 0; row < 3; row++)
                springs->points[0][SPRING_POINTS * (size_t)slice + 4 * i + row] =
                    springs->nodes[slice].per_mass[i] * springs->state[1][slice].x[LANES * row + i];
}

/*
 * Whether some motion swings faster. Powers of the matrix turn almost any motion into the fastest ones; none of them
 * grows by more than the largest eigenvalue.
 */
static int swings_faster(struct dpt_springs *springs, double square)
{
    begin_swing(springs);
    double before = size_of(springs);
    for (int pass = 0; pass < PASSES; pass++) {
        accelerate(springs, (float)(1.0 / square));
        const double after = size_of(springs);
        if (after > (1.0 + ROUNDING) * before)
            return 1;
        before = after;
    }
    return 0;
}

/* The least drag of all nodes that move. */
static double min_drag(const struct spring_net *net)
{
    double min = DBL_MAX;
    for (uint32_t node = 0; node < net->nodes; node++)
        if (net->mass[node] > 0.0f && (double)net->drag[node] < min)
            min = (double)net->drag[node];
    return min < DBL_MAX ? min : 0.0;
}

static void use(struct dpt_springs *springs, double square)
{
    springs->square = square;
    springs->stable_step =
        dpti_springs_limit(springs->def.integrator, square, springs->net.viscosity, min_drag(&springs->net));
}

void dpti_springs_find_step(struct dpt_springs *springs)
{
    const struct spring_net *net = &springs->net;
    const dpt_springs_def *def = &springs->def;
    const double rows = largest_row(springs);
    const double told = def->stiffness * net->square + def->contact_stiffness * max_per_mass(net);
    use(springs, rows);
    if (def->integrator == DPT_INTEGRATOR_IMPLICIT)
        springs->stable_step = DPT_SPRINGS_STEP_MAX;
    if (def->integrator != DPT_INTEGRATOR_SYMPLECTIC || !(net->square > 0.0 && told < rows))
        return;
    use(springs, told);
    if (net->viscosity < VISCOUS * springs->stable_step || swings_faster(springs, net->square))
        use(springs, rows);
}
