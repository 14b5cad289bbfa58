/* SPDX-License-Identifier: BSD-3-Clause */
#include "insertion/shaft_balance.h"

double dpti_balance_friction(const struct balance *balance, double place)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < balance->count; i++) {
        const struct balance_part *part = &balance->parts[i];
        sum += shaft_resistance(&part->shaft, place + part->offset, balance->dt);
    }
    return sum;
}

static double left_at(const struct balance *balance, double place, double cutting)
{
    return balance->stiffness * (balance->device - place) - dpti_balance_friction(balance, place) - cutting;
}

/* Where bristles begin to slip, or to stick again: between two such places all is linear. */
static uint32_t list_bends(const struct balance *balance, double bends[2 * INSERTION_CHANNELS_MAX])
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < balance->count; i++) {
        const struct balance_part *part = &balance->parts[i];
        const double most = shaft_stretch_max(&part->shaft), at = part->shaft.anchor - part->offset;
        bends[count++] = at - most;
        bends[count++] = at + most;
    }
    return count;
}

/* The balance with so much at the tip. */
static double solve_with(const struct balance *balance, double cutting)
{
    double bends[2 * INSERTION_CHANNELS_MAX], low = -HUGE_VAL, high = HUGE_VAL;
    const uint32_t count = list_bends(balance, bends);
    for (uint32_t i = 0; i < count; i++) {
        if (left_at(balance, bends[i], cutting) > 0.0)
            low = max_of(low, bends[i]);
        else
            high = min_of(high, bends[i]);
    }
    /* Two points of the piece between, or beyond the last bend. */
    const double from = low > -HUGE_VAL ? low : min_of(high, balance->device) - 1.0;
    const double to = high < HUGE_VAL ? high : max_of(low, balance->device) + 1.0;
    const double left_from = left_at(balance, from, cutting), left_to = left_at(balance, to, cutting);
    if (!(left_from > left_to))
        return from;
    return from + (to - from) * (left_from / (left_from - left_to));
}

double dpti_balance_solve(const struct balance *balance, double *cutting)
{
    uint32_t passed = 0;
    double place = solve_with(balance, 0.0);
    *cutting = 0.0;
    for (;;) {
        uint32_t next = balance->count;
        double at = place;
        for (uint32_t i = 0; i < balance->count; i++) {
            const double uncut = balance->parts[i].uncut - balance->parts[i].offset;
            if (!(passed & 1u << i) && balance->parts[i].cutting > 0.0 && uncut < at) {
                at = uncut;
                next = i;
            }
        }
        if (next == balance->count)
            return place;
        const double more = *cutting + balance->parts[next].cutting;
        place = solve_with(balance, more);
        if (!(place > at)) {
            *cutting = max_of(*cutting, left_at(balance, at, 0.0));
            return at;
        }
        *cutting = more;
        passed |= 1u << next;
    }
}
