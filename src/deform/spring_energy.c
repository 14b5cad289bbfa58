/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/spring_energy.h"

#include <math.h>

#include "base/vec3.h"

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
