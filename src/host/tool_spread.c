/* SPDX-License-Identifier: BSD-3-Clause */
#include "host/tool_spread.h"

#include <math.h>

#include "base/vec3.h"

double tool_spread(const dpt_segment *lines, uint32_t count, double centre[3])
{
    double whole = 0.0, square = 0.0;
    vec3 sum = { 0.0, 0.0, 0.0 };
    for (uint32_t i = 0; i < count; i++)
        whole += length(sub(vec3_of(lines[i].b), vec3_of(lines[i].a)));
    const int are_points = !(whole > 0.0);
    for (int turn = 0; turn < 2; turn++)
        for (uint32_t i = 0; i < count; i++) {
            const vec3 a = vec3_of(lines[i].a), b = vec3_of(lines[i].b);
            const vec3 middle = scaled(add(a, b), 0.5);
            const double size = length(sub(b, a));
            const double share = are_points ? 1.0 / count : size / whole;
            if (turn == 0) {
                sum = along(sum, share, middle);
                continue;
            }
            const vec3 from = sub(middle, sum);
            square += share * (dot(from, from) + size * size / 12.0);
        }
    vec3_store(sum, centre);
    return sqrt(square);
}
