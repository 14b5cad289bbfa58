/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/frequency.h"

#include <float.h>

#include "deform/integrate.h"

/* Passes in search of a swing that is faster than the file says, and what counts as rounding. */
enum { PASSES = 24 };
#define ROUNDING 1e-4

/*
 * Of a step: so much viscosity a net has that goes by what its file says. Nodes that are thrown about turn springs, which
 * gives them energy; what rows say leaves room enough for that, cells by themselves do not.
 */
#define VISCOUS 0.125

/* The largest row of the stiffness, per mass (Gershgorin); a spring between two nodes that move counts twice. */
static double largest_row(const struct spring_net *net, double stiffness, double contact)
{
    double largest = 0.0;
    for (uint32_t slice = 0; slice < net->slices; slice++)
        for (uint32_t lane = 0; lane < LANES && LANES * slice + lane < net->nodes; lane++) {
            const double mass = (double)net->mass[LANES * (size_t)slice + lane];
            double sum = contact;
            for (uint32_t entry = net->first[slice]; entry < net->first[slice + 1]; entry++) {
                const size_t at = LANES * (size_t)entry + lane;
                const double k = stiffness * (double)net->stiffness[at];
                sum += net->mass[net->neighbour[at]] > 0.0f ? 2.0 * k : k;
            }
            if (mass > 0.0 && sum > largest * mass)
                largest = sum / mass;
        }
    return largest;
}

/* 1 / kg: of the lightest node that moves. */
static double most_per_mass(const struct spring_net *net)
{
    double most = 0.0;
    for (uint32_t node = 0; node < net->nodes; node++)
        if (net->mass[node] > 0.0f && 1.0 / (double)net->mass[node] > most)
            most = 1.0 / (double)net->mass[node];
    return most;
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
        springs->kernel.spring_product(&springs->rows, slice, scale, none, springs->points[0],
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
static double least_drag(const struct spring_net *net)
{
    double least = DBL_MAX;
    for (uint32_t node = 0; node < net->nodes; node++)
        if (net->mass[node] > 0.0f && (double)net->drag[node] < least)
            least = (double)net->drag[node];
    return least < DBL_MAX ? least : 0.0;
}

static void use(struct dpt_springs *springs, double square)
{
    springs->square = square;
    springs->stable_step =
        dpti_springs_limit(springs->def.integrator, square, springs->net.viscosity, least_drag(&springs->net));
}

void dpti_springs_find_step(struct dpt_springs *springs)
{
    const struct spring_net *net = &springs->net;
    const dpt_springs_def *def = &springs->def;
    const double rows = largest_row(net, def->stiffness, def->contact_stiffness);
    const double told = def->stiffness * net->square + def->contact_stiffness * most_per_mass(net);
    use(springs, rows);
    if (def->integrator == DPT_INTEGRATOR_IMPLICIT)
        springs->stable_step = DPT_SPRINGS_STEP_MAX;
    if (def->integrator != DPT_INTEGRATOR_SYMPLECTIC || !(net->square > 0.0 && told < rows))
        return;
    use(springs, told);
    if (net->viscosity < VISCOUS * springs->stable_step || swings_faster(springs, net->square))
        use(springs, rows);
}
