/* SPDX-License-Identifier: BSD-3-Clause */
#include "strip/strip_random.h"

const char *shadow_text(const struct scene *scene, const dpt_shadow *s)
{
    static char text[1024];
    const double *a = s->segment.a, *b = s->segment.b, *d = s->direction;
    int n = snprintf(text, sizeof text,
                     "%s: from %u, %a %a %a  %a %a %a, radius %a, direction %a %a %a, width %a, depth %a",
                     scene->subject->name, s->triangle, a[0], a[1], a[2], b[0], b[1], b[2], s->segment.radius, d[0],
                     d[1], d[2], s->width, s->depth);
    if (scene->pose)
        snprintf(text + n, sizeof text - (size_t)n, ", pose %a %a %a  %a %a %a %a", scene->held_pose.position[0],
                 scene->held_pose.position[1], scene->held_pose.position[2], scene->held_pose.orientation[0],
                 scene->held_pose.orientation[1], scene->held_pose.orientation[2], scene->held_pose.orientation[3]);
    return text;
}

void random_pose(const struct scene *scene, uint64_t *seed, dpt_pose *pose)
{
    random_turn(seed, pose->orientation);
    for (int k = 0; k < 3; k++)
        pose->position[k] = random_in(seed, -2, 2) * scene->subject->diagonal;
}

void random_shadow(const struct scene *scene, uint64_t *seed, dpt_shadow *shadow)
{
    const double size = scene->subject->diagonal;
    const double length = size * ONE_OF(seed, 0, 0.003, 0.01, 0.05, 0.1, 0.2, 0.5, 1, 1.5);
    const double radius = size * ONE_OF(seed, 0, 0, 0.003, 0.01, 0.03);
    const double height = radius + size * ONE_OF(seed, -0.02, -0.003, 0, 0, 0.001, 0.005, 0.02);
    double ends[6], tilt[3];
    tool_at(scene, seed, length, height, ONE_OF(seed, 0, 0.5, 0.9, 1), ends);
    shadow_below(scene, ends, radius, shadow);
    shadow->width = size * ONE_OF(seed, 0, 0, 0.002, 0.01, 0.05, 0.3);
    shadow->depth = size * ONE_OF(seed, 0, 0.002, 0.01, 0.03, 0.1, 0.3, 2);
    random_unit(seed, tilt);
    switch (random_bits(seed) % 12) {
    case 0: /* any way */
        memcpy(shadow->direction, tilt, sizeof tilt);
        break;
    case 1: /* along the axis, exactly or nearly */
        for (int k = 0; k < 3; k++)
            shadow->direction[k] = ends[3 + k] - ends[k];
        const double off = ONE_OF(seed, 0, 1e-12, 1e-6, 1e-3);
        for (int k = 0; k < 3; k++)
            shadow->direction[k] = length > 0 ? shadow->direction[k] + off * length * tilt[k] : tilt[k];
        break;
    case 2: /* of any length */
        unit3(shadow->direction);
        const double by = ONE_OF(seed, 1e-60, 1e-6, 1e5);
        for (int k = 0; k < 3; k++)
            shadow->direction[k] *= by;
        break;
    case 3: /* from anywhere */
        do {
            shadow->triangle = (uint32_t)(random_bits(seed) % scene->subject->info.source_triangles);
        } while (scene->subject->surface.corner[shadow->triangle][0] == ORACLE_NONE);
        break;
    default:
        break;
    }
    if (!(dot3(shadow->direction, shadow->direction) > 0))
        memcpy(shadow->direction, tilt, sizeof tilt);
}
