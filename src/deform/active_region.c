/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/active_region.h"

#include <math.h>
#include <string.h>

/* Slices that are awake, in ascending order: sums run over them. */
void dpti_region_list(struct dpt_springs *springs)
{
    struct active_region *region = &springs->region;
    region->count = 0;
    for (uint32_t slice = 0; slice < springs->net.slices; slice++)
        if (region->is_awake[slice])
            region->slices[region->count++] = slice;
}

void dpti_region_wake_all(struct dpt_springs *springs)
{
    struct active_region *region = &springs->region;
    for (uint32_t slice = 0; slice < springs->net.slices; slice++) {
        region->is_awake[slice] = 1;
        region->quiet[slice] = 0;
        region->drift[slice] = 0.0f;
    }
    region->quiet_slices = 0;
    dpti_region_list(springs);
}

/* Returns 1 if it was asleep. */
static uint32_t wake(struct active_region *region, uint32_t slice)
{
    const uint32_t was_asleep = !region->is_awake[slice];
    region->quiet_slices -= region->quiet[slice] > 0;
    region->quiet[slice] = 0;
    region->is_awake[slice] = 1;
    return was_asleep;
}

void dpti_region_wake_loaded(struct dpt_springs *springs)
{
    const struct spring_loads *now = &springs->loads[springs->loaded];
    const struct spring_loads *last = &springs->loads[1 - springs->loaded];
    uint32_t woken = 0;
    for (int which = 0; which < 2; which++) {
        const struct spring_loads *listed = which ? last : now;
        for (uint32_t i = 0; i < listed->count; i++) {
            const size_t slice = listed->slices[i], row = SPRING_ROWS * slice;
            if (memcmp(now->force + row, last->force + row, SPRING_ROWS * sizeof *now->force) != 0)
                woken += wake(&springs->region, (uint32_t)slice);
        }
    }
    if (woken)
        dpti_region_list(springs);
}

/* Returns how many were asleep. */
static uint32_t wake_neighbours(struct dpt_springs *springs, uint32_t slice)
{
    const uint32_t *at = springs->net.neighbour + LANES * (size_t)springs->net.first[slice];
    const uint32_t *end = springs->net.neighbour + LANES * (size_t)springs->net.first[slice + 1];
    uint32_t woken = 0, last = slice;
    for (; at < end; at++)
        if (*at / LANES != last) {
            last = *at / LANES;
            if (last != slice)
                woken += wake(&springs->region, last);
        }
    return woken;
}

void dpti_region_disturb(struct dpt_springs *springs, uint32_t slice)
{
    wake(&springs->region, slice);
    wake_neighbours(springs, slice);
}

/* It rests where it is, in both states and both points. */
static void fall_asleep(struct dpt_springs *springs, uint32_t slice)
{
    struct spring_slice *now = springs->state[springs->now] + slice;
    memset(now->v, 0, sizeof now->v);
    memcpy(springs->state[1 - springs->now] + slice, now, sizeof *now);
    for (int i = 0; i < 2; i++)
        spring_place(now, 0.0f, springs->points[i] + SPRING_POINTS * (size_t)slice);
    if (springs->solve.direction)
        memset(springs->solve.direction + SPRING_POINTS * (size_t)slice, 0,
               SPRING_POINTS * sizeof *springs->solve.direction);
    springs->region.is_awake[slice] = 0;
    springs->region.drift[slice] = 0.0f;
}

/* So far a slice may creep before its neighbours wake, as a share of what is slow in all steps until sleep. */
#define DRIFT_SHARE 0.25f

void dpti_region_settle(struct dpt_springs *springs, double dt)
{
    struct active_region *region = &springs->region;
    const float slow = (float)springs->def.sleep_speed, square = slow * slow;
    const float step = (float)dt,
                drift = DRIFT_SHARE * slow * step * (float)springs->def.sleep_steps;
    const uint32_t steps = springs->def.sleep_steps;
    uint32_t changed = 0;
    if (!(slow > 0.0f))
        return;
    for (uint32_t i = 0; i < region->count; i++) {
        const uint32_t slice = region->slices[i];
        if (region->square[slice] <= square) {
            region->quiet_slices += region->quiet[slice] == 0;
            region->quiet[slice]++;
            region->drift[slice] += step * sqrtf(region->square[slice]);
        } else {
            region->quiet_slices -= region->quiet[slice] > 0;
            region->quiet[slice] = 0;
            region->drift[slice] = 2.0f * drift;
        }
    }
    for (uint32_t i = 0; i < region->count && region->quiet_slices; i++) {
        const uint32_t slice = region->slices[i];
        if (region->drift[slice] > drift) {
            region->drift[slice] = 0.0f;
            changed += wake_neighbours(springs, slice);
        }
    }
    for (uint32_t i = 0; i < region->count; i++) {
        const uint32_t slice = region->slices[i];
        if (region->quiet[slice] >= steps) {
            fall_asleep(springs, slice);
            changed++;
        }
    }
    if (changed)
        dpti_region_list(springs);
}
