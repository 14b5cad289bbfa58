/* SPDX-License-Identifier: BSD-3-Clause */
#include "shape/insert_hand.h"

#include <math.h>

/* s: a tick; of a ramp to the full speed and of one back; of a pause below and of a rest above. */
#define TICK  1e-3
#define RAMP  0.05
#define PAUSE 0.5
#define REST  0.25

/* Of the depth: so far above the surface it rests. */
#define HEIGHT 0.25

void insert_hand_begin(struct insert_hand *hand, const struct trace_hand *place, double length, double depth,
                       double speed)
{
    const double scale = place->length / 0.3;
    *hand = (struct insert_hand){ .entry = place->at,
                                  .normal = place->normal,
                                  .length = length > 0.0 ? length : 0.1 * scale,
                                  .depth = depth > 0.0 ? depth : 0.03 * scale,
                                  .speed = speed > 0.0 ? speed : 0.02 * scale };
    hand->height = HEIGHT * hand->depth;
}

/* s: a way that is too short for whole ramps has shorter ones. */
static double ramp_of(const struct insert_hand *hand)
{
    return min_of(RAMP, (hand->height + hand->depth) / hand->speed);
}

/* s: of the way down, or up. The two ramps take as long as one at full speed. */
static double way_time(const struct insert_hand *hand)
{
    return (hand->height + hand->depth) / hand->speed + ramp_of(hand);
}

uint64_t insert_hand_ticks(const struct insert_hand *hand)
{
    return (uint64_t)min_of(ceil((2.0 * way_time(hand) + PAUSE + REST) / TICK), INSERT_TICKS_MAX);
}

/* m: how far it has come on its way after a time, s. */
static double way_at(const struct insert_hand *hand, double time)
{
    const double all = way_time(hand), left = all - time, ramp = ramp_of(hand);
    if (time <= 0.0)
        return 0.0;
    if (left <= 0.0)
        return hand->height + hand->depth;
    if (time < ramp)
        return 0.5 * hand->speed * time * time / ramp;
    if (left < ramp)
        return hand->height + hand->depth - 0.5 * hand->speed * left * left / ramp;
    return hand->speed * (time - 0.5 * ramp);
}

void insert_hand_move(struct insert_hand *hand, double ends[6])
{
    const double all = way_time(hand);
    const double time = TICK * (double)(hand->ticks++ % insert_hand_ticks(hand));
    const double below = time < all + PAUSE ? way_at(hand, time) : way_at(hand, 2.0 * all + PAUSE - time);
    const vec3 tip = along(hand->entry, hand->height - below, hand->normal);
    vec3_store(tip, ends);
    vec3_store(along(tip, hand->length, hand->normal), ends + 3);
}
