/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/active_region.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/lanes.h"
#include "deform/cell_volume.h"

/* At most this many neighbours are compared, to find repeats: in a lattice a slice has about 30. */
enum { TOLD_APART = 64 };

uint32_t dpti_slice_neighbours(const struct spring_net *net, uint32_t slice, uint32_t *list)
{
    const uint32_t *at = net->neighbour + LANES * (size_t)net->first[slice];
    const uint32_t *end = net->neighbour + LANES * (size_t)net->first[slice + 1];
    uint32_t known[TOLD_APART], count = 0, last = slice;
    for (; at < end; at++) {
        const uint32_t other = *at / LANES;
        const uint32_t max = count < TOLD_APART ? count : TOLD_APART;
        uint32_t i = 0;
        if (other == last || other == slice)
            continue;
        last = other;
        while (i < max && known[i] != other)
            i++;
        if (i < max)
            continue;
        known[count % TOLD_APART] = other;
        if (list)
            list[count] = other;
        count++;
    }
    return count;
}

uint64_t dpti_slice_neighbours_count(const struct spring_net *net)
{
    uint64_t count = 0;
    for (uint32_t slice = 0; slice < net->slices; slice++)
        count += dpti_slice_neighbours(net, slice, NULL);
    return count;
}

/* ---- what sleeps ---- */

/*
 * How far a slice may move before its sleeping neighbours wake, as a share of the displacement at the sleep speed in the
 * steps until sleep.
 */
#define DRIFT_SHARE 0.0625f

/* A load may change without waking a slice by this share of itself, and of the mean load of a slice. */
#define LOAD_SHARE (1.0f / 256.0f)

/* Slices that are awake, in ascending order: sums run over them. */
void dpti_region_list(struct dpt_springs *springs)
{
    struct active_region *region = &springs->region;
    region->count = 0;
    for (uint32_t slice = 0; slice < springs->net.slices; slice++)
        if (region->is_awake[slice])
            region->slices[region->count++] = slice;
    dpti_cells_list(springs);
}

void dpti_region_begin(struct dpt_springs *springs)
{
    struct active_region *region = &springs->region;
    for (uint32_t slice = 0; slice < springs->net.slices; slice++) {
        region->first[slice + 1] =
            region->first[slice] +
            dpti_slice_neighbours(&springs->net, slice, region->neighbours + region->first[slice]);
        region->is_awake[slice] = region->is_fixed[slice] = 1;
        for (int i = 0; i < LANES; i++)
            if (springs->nodes[slice].per_mass[i] > 0.0f)
                region->is_fixed[slice] = 0;
        for (int i = 0; i < LANES; i++)
            region->drag[slice] = springs->nodes[slice].drag[i] > region->drag[slice] ? springs->nodes[slice].drag[i]
                                                                                      : region->drag[slice];
    }
    dpti_region_list(springs);
}

/* Whether a slice sleeps, and would move if it did not. */
static int can_wake(const struct active_region *region, uint32_t slice)
{
    return !region->is_awake[slice] && !region->is_fixed[slice];
}

/* Returns 1 if it was asleep. */
static uint32_t wake(struct active_region *region, uint32_t slice)
{
    const uint32_t was_asleep = !region->is_awake[slice];
    region->quiet[slice] = 0;
    region->is_awake[slice] = 1;
    return was_asleep;
}

/* The sum of the sizes of a row, less those of another one. */
static float sum_of_sizes(const float *row, const float *other)
{
    float lanes[LANES] = { 0.0f };
    for (int k = 0; k < SPRING_ROWS; k++)
        lanes[k % LANES] += fabsf(row[k] - other[k]);
    for (int half = LANES / 2; half; half /= 2)
        for (int i = 0; i < half; i++)
            lanes[i] += lanes[i + half];
    return lanes[0];
}

static int can_any_wake(const struct active_region *region, const struct spring_loads *loads)
{
    for (uint32_t i = 0; i < loads->count; i++)
        if (can_wake(region, loads->slices[i]))
            return 1;
    return 0;
}

void dpti_region_wake_loaded(struct dpt_springs *springs)
{
    static const float none[SPRING_ROWS] = { 0.0f };
    const struct spring_loads *now = &springs->loads[springs->loaded];
    const struct spring_loads *last = &springs->loads[1 - springs->loaded];
    struct active_region *region = &springs->region;
    float whole = 0.0f;
    uint32_t woken = 0;
    if (!can_any_wake(region, now) && !can_any_wake(region, last))
        return;
    for (uint32_t i = 0; i < now->count; i++)
        whole += sum_of_sizes(now->force + SPRING_ROWS * (size_t)now->slices[i], none);
    const float mean = now->count ? whole / (float)now->count : 0.0f;
    for (int which = 0; which < 2; which++) {
        const struct spring_loads *listed = which ? last : now;
        for (uint32_t i = 0; i < listed->count; i++) {
            const size_t slice = listed->slices[i], row = SPRING_ROWS * slice;
            const float *held = region->held + row;
            if (can_wake(region, (uint32_t)slice) &&
                sum_of_sizes(now->force + row, held) > LOAD_SHARE * (sum_of_sizes(held, none) + mean))
                woken += wake(region, (uint32_t)slice);
        }
    }
    if (woken)
        dpti_region_list(springs);
}

/* Returns how many were asleep. */
static uint32_t wake_neighbours(struct active_region *region, uint32_t slice)
{
    uint32_t woken = 0;
    for (uint32_t i = region->first[slice]; i < region->first[slice + 1]; i++)
        if (can_wake(region, region->neighbours[i]))
            woken += wake(region, region->neighbours[i]);
    return woken;
}

void dpti_region_disturb(struct dpt_springs *springs, uint32_t slice)
{
    wake(&springs->region, slice);
    wake_neighbours(&springs->region, slice);
}

static int has_sleeping_neighbour(const struct active_region *region, uint32_t slice)
{
    for (uint32_t i = region->first[slice]; i < region->first[slice + 1]; i++)
        if (can_wake(region, region->neighbours[i]))
            return 1;
    return 0;
}

/* The largest way of a coordinate from where neighbours that sleep know the slice to be. */
static float way_since_told(const struct dpt_springs *springs, uint32_t slice)
{
    const float *x = springs->state[springs->now][slice].x;
    const float *told = springs->region.told + SPRING_ROWS * (size_t)slice;
    float lanes[LANES] = { 0.0f };
    for (int k = 0; k < SPRING_ROWS; k++) {
        const float displacement = fabsf(x[k] - told[k]);
        lanes[k % LANES] = displacement > lanes[k % LANES] ? displacement : lanes[k % LANES];
    }
    for (int half = LANES / 2; half; half /= 2)
        for (int i = 0; i < half; i++)
            lanes[i] = lanes[i + half] > lanes[i] ? lanes[i + half] : lanes[i];
    return lanes[0];
}

/* It rests where it is, in both states and both points. */
static void fall_asleep(struct dpt_springs *springs, uint32_t slice)
{
    struct active_region *region = &springs->region;
    struct spring_slice *now = springs->state[springs->now] + slice;
    memset(now->v, 0, sizeof now->v);
    memcpy(springs->state[1 - springs->now] + slice, now, sizeof *now);
    for (int i = 0; i < 2; i++)
        springs->kernel.spring_points(now, 0.0f, springs->points[i] + SPRING_POINTS * (size_t)slice);
    if (springs->solve.direction)
        memset(springs->solve.direction + SPRING_POINTS * (size_t)slice, 0,
               SPRING_POINTS * sizeof *springs->solve.direction);
    memcpy(region->held + SPRING_ROWS * (size_t)slice,
           springs->loads[springs->loaded].force + SPRING_ROWS * (size_t)slice, SPRING_ROWS * sizeof *region->held);
    region->is_awake[slice] = 0;
    for (uint32_t i = region->first[slice]; i < region->first[slice + 1]; i++) {
        const size_t other = region->neighbours[i];
        if (region->is_told[other])
            continue;
        region->is_told[other] = 1;
        memcpy(region->told + SPRING_ROWS * other, springs->state[springs->now][other].x,
               SPRING_ROWS * sizeof *region->told);
    }
}

/* Wake those that sleep beside what has moved too far. Returns how many. */
static uint32_t wake_where_moved(struct dpt_springs *springs, float drift)
{
    struct active_region *region = &springs->region;
    uint32_t woken = 0;
    if (region->count == springs->net.slices)
        return 0;
    for (uint32_t i = 0; i < region->count; i++) {
        const uint32_t slice = region->slices[i];
        if (!region->is_told[slice])
            continue;
        if (has_sleeping_neighbour(region, slice)) {
            if (!(way_since_told(springs, slice) > drift))
                continue;
            woken += wake_neighbours(region, slice);
        }
        region->is_told[slice] = 0;
    }
    return woken;
}

/*
 * What creeps must not freeze on the way. With drag a force moves a node no faster than it would in 1 / drag seconds: a
 * slow node is out of balance by drag times its speed, and that is kept to what makes a free node as fast as the sleep
 * speed in the steps until sleep. With viscosity a way of speed times viscosity is left: that is kept to the drift. As
 * it takes so long, neighbours wake the sooner.
 */
void dpti_region_settle(struct dpt_springs *springs, double dt)
{
    struct active_region *region = &springs->region;
    const uint32_t steps = springs->def.sleep_steps;
    const float slow = (float)springs->def.sleep_speed, time = (float)dt * (float)steps;
    const float creep = 1.0f + (float)springs->net.viscosity / (DRIFT_SHARE * time);
    const float drift = DRIFT_SHARE * slow * time / creep;
    uint32_t changed = 0;
    if (!(slow > 0.0f))
        return;
    for (uint32_t i = 0; i < region->count; i++) {
        const uint32_t slice = region->slices[i];
        const float max = slow / (creep + time * region->drag[slice]);
        if (region->square[slice] <= max * max)
            region->quiet[slice]++;
        else
            region->quiet[slice] = 0;
    }
    changed = wake_where_moved(springs, drift);
    for (uint32_t i = 0; i < region->count; i++)
        if (region->quiet[region->slices[i]] >= steps) {
            fall_asleep(springs, region->slices[i]);
            changed++;
        }
    if (changed)
        dpti_region_list(springs);
}
