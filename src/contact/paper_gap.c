/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/paper_gap.h"

#include "mesh/surface.h"

/* The height of the axis' lower end over the triangle's plane, m. The axis crosses that plane at the nearest pair. */
static double lower_end_height(const struct axis *axis, const struct pair_search *nearest, vec3 normal)
{
    double height_a = -nearest->pair.s * dot(axis->u, normal);
    double height_b = (1.0 - nearest->pair.s) * dot(axis->u, normal);
    return min_of(height_a, height_b);
}

double dpti_contact_paper(const struct surface *surface, const struct frame *body, const struct axis *part,
                          const struct pair_search *nearest, double radius, struct penetration *penetration)
{
    vec3 normal = dpti_surface_face_normal(surface, nearest->triangle);
    double distance = sqrt(nearest->pair.distance2), gap;
    if (distance == 0.0) {
        gap = lower_end_height(part, nearest, normal) - radius;
        penetration->direction = normal;
    } else {
        double side = dot(nearest->pair.gap, normal) < 0.0 ? -1.0 : 1.0;
        gap = side * distance - radius;
        penetration->direction = scaled(nearest->pair.gap, side / distance);
    }
    penetration->direction = frame_turn(body, penetration->direction);
    penetration->at = along(part->a, nearest->pair.s, sub(part->b, part->a));
    penetration->depth = max_of(0.0, -gap);
    return gap;
}
