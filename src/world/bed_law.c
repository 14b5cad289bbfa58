/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/tool_force.h"

/* Two ends of a tool meet if they are no farther apart than that share of its length. */
#define MEETING 1e-9

static double whole_length(const struct segment *segments, uint32_t count)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < count; i++)
        sum += length(sub(segments[i].b, segments[i].a));
    return sum;
}

/*
 * How much of an end's stiffness counts: 1 at a free end, 0 where the tool goes straight on. At a joint it is
 * min(1, |sum of u|), u the unit vectors of the segments that meet there; they share it.
 */
static double end_weight(const struct segment *segments, uint32_t count, uint32_t number, int end, double whole)
{
    const vec3 at = end ? segments[number].b : segments[number].a;
    vec3 sum = { 0.0, 0.0, 0.0 };
    double meeting = 0.0;
    for (uint32_t i = 0; i < count; i++)
        for (int e = 0; e < 2; e++) {
            const vec3 from = e ? segments[i].b : segments[i].a;
            const vec3 to = e ? segments[i].a : segments[i].b;
            if (!(length(sub(from, at)) <= MEETING * whole) || !(length(sub(to, from)) > 0.0))
                continue;
            sum = add(sum, unit_of(sub(to, from)));
            meeting += 1.0;
        }
    return meeting > 0.0 ? min_of(1.0, length(sum)) / meeting : 1.0;
}

/* Stiffness per length, N/m^2, and of each end, N/m: of a free one the tool's half. */
struct bed_stiffness {
    double line;
    double end[2];
};

/* Adds a segment's share to a wrench, with the torque about `origin`; a and b are its ends. Returns its energy, J. */
static double respond(const struct bed_depth *depth, const struct bed_stiffness *stiffness, vec3 a, vec3 b, vec3 origin,
                      dpt_wrench *sum)
{
    const vec3 at[2] = { a, b };
    double energy = 0.5 * stiffness->line * depth->square;
    vec3 force = scaled(depth->thrust, stiffness->line);
    vec3 torque = add(scaled(depth->moment, stiffness->line), cross(sub(a, origin), force));
    for (int e = 0; e < 2; e++) {
        const vec3 push = scaled(depth->end_thrust[e], stiffness->end[e]);
        energy += 0.5 * stiffness->end[e] * depth->end_square[e];
        force = add(force, push);
        torque = add(torque, cross(sub(at[e], origin), push));
    }
    vec3_store(add(vec3_of(sum->force), force), sum->force);
    vec3_store(add(vec3_of(sum->torque), torque), sum->torque);
    return energy;
}

double dpti_bed_push(const struct dpt_world *world, const struct tool *tool, uint32_t segment_index, vec3 origin,
                     dpt_wrench *sum)
{
    const struct segment *segments = &world->segments[tool->first_segment];
    const uint32_t number = segment_index - tool->first_segment;
    const struct segment *segment = &segments[number];
    const double whole = whole_length(segments, tool->segment_count);
    const struct bed_stiffness stiffness = {
        whole > 0.0 ? tool->stiffness / whole : 0.0,
        { 0.5 * tool->stiffness * end_weight(segments, tool->segment_count, number, 0, whole),
          0.5 * tool->stiffness * end_weight(segments, tool->segment_count, number, 1, whole) }
    };
    return respond(&segment->bed_depth, &stiffness, frame_to_world(&tool->felt_frame, segment->a),
                   frame_to_world(&tool->felt_frame, segment->b), origin, sum);
}
