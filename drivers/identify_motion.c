/* SPDX-License-Identifier: BSD-3-Clause */
#include "identify_motion.h"

#include <string.h>

#include "rotation.h"

const double identify_speed_max[IDENTIFY_SPACES] = { 0.2, 2.0 };
const double identify_displacement_max[IDENTIFY_SPACES] = { 0.02, 0.35 };

void identify_motion_init(struct identify_motion *motion, const dpt_device_info *info)
{
    const double periods = max_of(4.0, ceil(IDENTIFY_SPEED_TIME * info->rate));
    memset(motion, 0, sizeof *motion);
    motion->spaces = info->pose_dofs == 6 ? 2 : 1;
    motion->window = (uint32_t)min_of(periods, IDENTIFY_WINDOW_MAX - 1);
}

void identify_motion_pause(struct identify_motion *motion)
{
    motion->samples = 0;
}

void identify_motion_add(struct identify_motion *motion, const dpt_device_state *state)
{
    const uint64_t newest = motion->samples, window = motion->window;
    const uint64_t oldest = newest > window ? newest - window : 0;
    const uint64_t to = newest % (window + 1), from = oldest % (window + 1);
    if (!motion->has_start)
        motion->start = state->pose;
    motion->has_start = 1;
    for (int k = 0; k < 3; k++)
        motion->displacement[IDENTIFY_POSITIONS][k] = state->pose.position[k] - motion->start.position[k];
    rotation_between(motion->start.orientation, state->pose.orientation, motion->displacement[IDENTIFY_ANGLES]);
    motion->ring_ns[to] = state->time_ns;
    memcpy(motion->ring[to], motion->displacement, sizeof motion->ring[to]);
    const double dt = (double)(int64_t)(motion->ring_ns[to] - motion->ring_ns[from]) * 1e-9;
    for (uint32_t space = 0; space < motion->spaces; space++) {
        double *speed = motion->speed[space];
        for (int k = 0; k < 3; k++)
            speed[k] =
                newest >= window && dt > 0.0 ? (motion->ring[to][space][k] - motion->ring[from][space][k]) / dt : 0.0;
        motion->fastest[space] = max_of(motion->fastest[space], length(vec3_of(speed)));
        motion->furthest[space] = max_of(motion->furthest[space], length(vec3_of(motion->displacement[space])));
    }
    motion->samples++;
}
