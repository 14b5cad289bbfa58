/* SPDX-License-Identifier: BSD-3-Clause */
#include "shape/trace_hand.h"

#include "base/sincos.h"
#include "dynpoint/query.h"

static double random01(struct trace_hand *hand)
{
    hand->random = hand->random * 6364136223846793005u + 1442695040888963407u;
    return (double)(hand->random >> 11) * 0x1p-53;
}

static double wave(double turns)
{
    double sine, cosine;
    turn_sincos(turns, &sine, &cosine);
    return sine;
}

static vec3 unit_or(vec3 v, vec3 otherwise)
{
    double size = length(v);
    return size > 1e-12 ? scaled(v, 1.0 / size) : otherwise;
}

static vec3 flattened(vec3 v, vec3 normal, double share)
{
    return along(v, -share * dot(v, normal), normal);
}

/* The nearest point of the mesh, and its triangle's normal. */
static vec3 drop_on_mesh(const struct trace_hand *hand, vec3 x, vec3 *normal)
{
    dpt_hit hit = DPT_HIT_INIT;
    double corners[9] = { 0 };
    const double ends[6] = { x.x, x.y, x.z, x.x, x.y, x.z };
    dpt_query_segments(hand->mesh, NULL, ends, NULL, 1, &hit, NULL);
    dpt_mesh_get_triangle(hand->mesh, hit.triangle, corners);
    vec3 a = vec3_of(corners);
    vec3 n = cross(sub(vec3_of(corners + 3), a), sub(vec3_of(corners + 6), a));
    *normal = unit_or(n, (vec3){ 0.0, 0.0, 1.0 });
    return vec3_of(hit.q);
}

static void place_hand(struct trace_hand *hand, const dpt_mesh_info *info)
{
    vec3 low = vec3_of(info->box_min), high = vec3_of(info->box_max);
    vec3 middle = scaled(add(low, high), 0.5), half = scaled(sub(high, low), 0.5);
    vec3 outside = { middle.x + half.x * (2.0 * random01(hand) - 1.0), middle.y + half.y * (2.0 * random01(hand) - 1.0),
                     high.z };
    for (int i = 0; i < 4; i++)
        hand->phase[i] = random01(hand);
    hand->at = drop_on_mesh(hand, outside, &hand->normal);
    vec3 any = { random01(hand) - 0.5, random01(hand) - 0.5, random01(hand) - 0.5 };
    hand->heading = unit_or(flattened(any, hand->normal, 1.0), (vec3){ 1.0, 0.0, 0.0 });
    hand->axis = unit_or(cross(hand->heading, hand->normal), (vec3){ 0.0, 1.0, 0.0 });
}

/*
 * A tool that stands begins so many bands above the surface, comes down to it in this time, s, leans by this slope, and
 * follows the surface's normal by this share a tick.
 */
#define LIFTED   8.0
#define LOWERING 0.3
#define LEANING  0.6
#define RIGHTING 0.003

static void wander(struct trace_hand *hand, double time)
{
    vec3 face;
    double pace = hand->speed * (1.0 + 0.67 * wave(0.31 * time + hand->phase[0]));
    hand->at = drop_on_mesh(hand, along(hand->at, 1e-3 * pace, hand->heading), &face);
    hand->normal = unit_or(along(scaled(hand->normal, 0.97), 0.03, face), face);
    vec3 left = cross(hand->normal, hand->heading);
    double bend = 0.02 * (random01(hand) - 0.5) + 0.002 * wave(0.17 * time + hand->phase[1]);
    hand->heading = unit_or(flattened(along(hand->heading, bend, left), hand->normal, 1.0), left);
    vec3 drift = cross(hand->normal, hand->axis);
    double turn = 0.002 * wave(0.23 * time + hand->phase[2]);
    double tilt = 0.04 * wave(0.19 * time + hand->phase[3]);
    vec3 lifted = along(along(hand->axis, turn, drift), 0.02 * tilt, hand->normal);
    hand->axis = unit_or(flattened(lifted, hand->normal, 0.02), drift);
    const vec3 leant = unit_or(along(hand->normal, LEANING, hand->axis), hand->normal);
    hand->up = hand->ticks > 1 ? unit_or(along(scaled(hand->up, 1.0 - RIGHTING), RIGHTING, leant), leant) : leant;
}

static void find_ends(const struct trace_hand *hand, double time, double ends[6])
{
    double height = hand->band * (0.35 + 0.65 * wave(0.71 * time + hand->phase[3]));
    double share = 0.5 + 0.45 * wave(0.13 * time + hand->phase[1]);
    vec3 touching = along(hand->at, height, hand->normal);
    if (hand->stands) {
        const double above = time < LOWERING ? hand->band * LIFTED * (1.0 - time / LOWERING) : 0.0;
        const vec3 tip = along(touching, above, hand->normal);
        vec3_store(tip, ends);
        vec3_store(along(tip, hand->length, hand->up), ends + 3);
        return;
    }
    vec3_store(along(touching, -share * hand->length, hand->axis), ends);
    vec3_store(along(touching, (1.0 - share) * hand->length, hand->axis), ends + 3);
}

void trace_hand_begin(struct trace_hand *hand, const dpt_mesh *mesh, uint64_t seed, double tool_length, double band,
                      double speed)
{
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(mesh, &info);
    const double scale = length(sub(vec3_of(info.box_max), vec3_of(info.box_min))) / 0.35;
    *hand = (struct trace_hand){ .mesh = mesh,
                                 .random = seed * 0x9e3779b97f4a7c15u + 1,
                                 .length = tool_length > 0.0 ? tool_length : 0.3 * scale,
                                 .band = band > 0.0 ? band : 0.005 * scale,
                                 .speed = speed > 0.0 ? speed : 0.3 * scale };
    place_hand(hand, &info);
}

void trace_hand_move(struct trace_hand *hand, double ends[6])
{
    const double time = 1e-3 * (double)hand->ticks++;
    wander(hand, time);
    find_ends(hand, time, ends);
}
