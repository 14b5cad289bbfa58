/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/cell_volume.h"

#include <math.h>
#include <string.h>

#include "base/lanes.h"
#include "base/vec3.h"

/* The pressure of a cell, by its shear modulus, is never more than this; nor are volumes for which it grows. */
#define PRESSURE_MAX 2.0
#define VOLUME_MAX   1e6

/* The slices of nodes in which a slice of cells has corners, each once. Returns how many. */
static uint32_t corner_slices(const struct spring_net *net, uint32_t slice, uint32_t list[CELL_CORNERS])
{
    const uint32_t *node = net->cell_nodes + CELL_CORNERS * (size_t)slice;
    uint32_t count = 0;
    for (uint32_t i = 0; i < CELL_CORNERS; i++) {
        uint32_t k = 0;
        while (k < count && list[k] != node[i] / LANES)
            k++;
        if (k == count)
            list[count++] = node[i] / LANES;
    }
    return count;
}

uint64_t dpti_cells_corner_slices(const struct spring_net *net)
{
    uint32_t list[CELL_CORNERS];
    uint64_t count = 0;
    for (uint32_t slice = 0; slice < net->cell_slices; slice++)
        count += corner_slices(net, slice, list);
    return count;
}

static void begin_kernel(struct dpt_springs *springs)
{
    const struct spring_net *net = &springs->net;
    const double slope = cell_slope(net->poisson), turn_slope = cell_turn_slope(net->poisson);
    const double turn = cell_turn(net->poisson), growth = PRESSURE_MAX / fabs(slope);
    springs->volumes.cells = (struct spring_cells){
        .nodes = net->cell_nodes,
        .stiffness = net->cell_stiffness,
        .per_edges = (float)(0.25 / net->cell_size),
        .quarter = (float)(0.25 * net->cell_size),
        .slope = (float)slope,
        .turn = (float)turn,
        .turn_slope = (float)turn_slope,
        .smallest = (float)(turn - (PRESSURE_MAX + slope * (turn - 1.0)) / turn_slope),
        .largest = (float)(growth < VOLUME_MAX ? 1.0 + growth : VOLUME_MAX),
    };
}

/* Where each node finds what its cells pull: a cell's corners 7 to 4 share a point with corners 0 to 3. */
static void begin_places(struct dpt_springs *springs)
{
    const struct spring_net *net = &springs->net;
    uint32_t *places = springs->volumes.places;
    for (size_t i = 0; i < CELL_CORNERS * (size_t)net->slices; i++)
        places[i] = CELL_PULLS * net->cell_slices;
    for (uint32_t cell = 0; cell < net->cells; cell++) {
        const uint32_t slice = cell / LANES, lane = cell % LANES;
        for (uint32_t corner = 0; corner < 8; corner++) {
            const uint32_t node = net->cell_nodes[CELL_CORNERS * (size_t)slice + LANES * corner + lane];
            const uint32_t row = corner < 4 ? corner : 7 - corner;
            places[CELL_CORNERS * (size_t)(node / LANES) + LANES * corner + node % LANES] =
                CELL_PULLS * slice + SPRING_POINTS * row + 4 * lane;
        }
    }
}

/* Raise the stiffness of a spring in the row of one of its nodes. */
static void raise(const struct spring_net *net, float *bound, uint32_t node, uint32_t end, float by)
{
    for (uint32_t entry = net->first[node / LANES]; entry < net->first[node / LANES + 1]; entry++) {
        const size_t at = LANES * (size_t)entry + node % LANES;
        if (net->neighbour[at] == end)
            bound[at] += by;
    }
}

/* Springs along the diagonals of faces are raised by what bounds the cell's term. */
static void begin_bound(struct dpt_springs *springs)
{
    const struct spring_net *net = &springs->net;
    float *bound = springs->volumes.bound;
    const float share = (float)cell_bound(net->poisson);
    memcpy(bound, net->stiffness, LANES * (size_t)net->first[net->slices] * sizeof *bound);
    for (uint32_t cell = 0; cell < net->cells; cell++) {
        const uint32_t *node = net->cell_nodes + CELL_CORNERS * (size_t)(cell / LANES) + cell % LANES;
        for (uint32_t corner = 0; corner < 8; corner++)
            for (uint32_t axes = 3; axes < 7; axes += axes == 3 ? 2 : 1)
                raise(net, bound, node[LANES * corner], node[LANES * (corner ^ axes)],
                      share * net->cell_stiffness[cell]);
    }
    springs->bound.stiffness = bound;
}

void dpti_cells_begin(struct dpt_springs *springs)
{
    const struct spring_net *net = &springs->net;
    struct cell_volumes *volumes = &springs->volumes;
    begin_kernel(springs);
    begin_places(springs);
    begin_bound(springs);
    for (uint32_t slice = 0; slice < net->cell_slices; slice++) {
        uint32_t list[CELL_CORNERS];
        const uint32_t count = corner_slices(net, slice, list);
        memcpy(volumes->slices + volumes->first[slice], list, count * sizeof *list);
        volumes->first[slice + 1] = volumes->first[slice] + count;
    }
}

static int is_awake(const struct dpt_springs *springs, uint32_t slice)
{
    const struct cell_volumes *volumes = &springs->volumes;
    for (uint32_t i = volumes->first[slice]; i < volumes->first[slice + 1]; i++)
        if (springs->region.is_awake[volumes->slices[i]])
            return 1;
    return 0;
}

void dpti_cells_list(struct dpt_springs *springs)
{
    struct cell_volumes *volumes = &springs->volumes;
    volumes->count = 0;
    for (uint32_t slice = 0; slice < springs->net.cell_slices; slice++)
        if (is_awake(springs, slice))
            volumes->active[volumes->count++] = slice;
}

void dpti_cells_pull(struct dpt_springs *springs, const float *points)
{
    const struct cell_volumes *volumes = &springs->volumes;
    for (uint32_t i = 0; i < volumes->count; i++)
        springs->kernel.cell_pulls(&volumes->cells, volumes->active[i], points,
                                   volumes->pulls + CELL_PULLS * (size_t)volumes->active[i]);
}

void dpti_cells_pull_energy(struct dpt_springs *springs, const float *points)
{
    const struct cell_volumes *volumes = &springs->volumes;
    for (uint32_t i = 0; i < volumes->count; i++) {
        const uint32_t slice = volumes->active[i];
        double lanes[LANES] = { 0.0 };
        springs->kernel.cell_energy(&volumes->cells, slice, points, volumes->pulls + CELL_PULLS * (size_t)slice, lanes);
        volumes->energy[slice] = springs->def.stiffness * spring_sum(lanes);
    }
}

void dpti_cells_add(const struct dpt_springs *springs, uint32_t slice, float force[SPRING_ROWS])
{
    const struct cell_volumes *volumes = &springs->volumes;
    springs->kernel.cell_forces(volumes->places + CELL_CORNERS * (size_t)slice, volumes->pulls, force);
}

static vec3 place_of(const struct dpt_springs *springs, uint32_t node)
{
    const float *x = springs->state[springs->now][node / LANES].x + node % LANES;
    return (vec3){ (double)x[0], (double)x[LANES], (double)x[2 * LANES] };
}

/* A cell's volume by that at rest, as its term has it. */
static double volume_of(const struct dpt_springs *springs, const uint32_t *node)
{
    vec3 edge[3] = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 } };
    double size = 0.0;
    for (uint32_t corner = 0; corner < 8; corner++)
        for (int axis = 0; axis < 3; axis++)
            edge[axis] = along(edge[axis], (corner >> axis & 1 ? 0.25 : -0.25) / springs->net.cell_size,
                               place_of(springs, node[LANES * corner]));
    for (int axis = 0; axis < 3; axis++)
        size += dot(edge[axis], edge[axis]);
    const double most = (double)CELL_MOST, slack = most - (double)CELL_EXACT;
    const double reach = size > (double)CELL_EXACT ? size : (double)CELL_EXACT;
    const double less = slack / (reach - ((double)CELL_EXACT - slack));
    return (most - slack * less) / reach * dot(edge[0], cross(edge[1], edge[2]));
}

double dpti_cells_elastic(const struct dpt_springs *springs, uint32_t slice)
{
    const struct spring_net *net = &springs->net;
    const struct spring_cells *cells = &springs->volumes.cells;
    const double slope = (double)cells->slope, turn_slope = (double)cells->turn_slope;
    const double turn = (double)cells->turn, before = turn - 1.0;
    double sum = 0.0;
    for (uint32_t lane = 0; lane < LANES && LANES * slice + lane < net->cells; lane++) {
        const double volume = volume_of(springs, net->cell_nodes + CELL_CORNERS * (size_t)slice + lane);
        const double within = min_of(max_of(volume, (double)cells->smallest), (double)cells->largest);
        const double above = max_of(within - turn, 0.0),
                     below = min_of(within - turn, 0.0);
        const double pressure = slope * (before + above) + turn_slope * below;
        sum += (double)net->cell_stiffness[LANES * (size_t)slice + lane] *
               (0.5 * slope * (before + above) * (before + above) + (slope * before + 0.5 * turn_slope * below) * below +
                pressure * (volume - within));
    }
    return springs->def.stiffness * net->cell_size * net->cell_size * sum;
}
