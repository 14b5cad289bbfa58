/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/displace.h"

#include "mesh/surface_normal.h"

/* Of the overlap: corners are moved by that much more, so that rounding to float leaves no overlap. */
#define BEYOND (1.0 + 1e-6)

static void displace_triangle(struct surface *surface, const struct displacing_tool *tool,
                              uint32_t place)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    struct frame frame;
    dpt_overlap overlap;
    double square = 0.0;
    frame_of_pose(&identity, &frame);
    dpti_strip_overlap(surface, &frame, tool->a, tool->u, tool->radius, (double)tool->side, place,
                       &overlap);
    if (!(overlap.overlap > 0.0))
        return;
    const vec3 normal = dpti_surface_face_normal(surface, place);
    for (int k = 0; k < 3; k++)
        square += overlap.weight[k] * overlap.weight[k];
    const double out = -BEYOND * (double)tool->side * overlap.overlap / square;
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t vertex = surface_corner(surface, place, k);
        if (overlap.weight[k] > 0.0)
            dpti_deform_put(
                surface, vertex,
                along(surface_vertex(surface, vertex), out * overlap.weight[k], normal));
    }
}

void dpti_displace(struct surface *surface, const struct dpt_strip *strip,
                   const struct displacing_tool *tool, uint32_t passes)
{
    const uint32_t *places = mesh_words(surface->mesh, MESH_PLACES);
    for (uint32_t pass = 0; pass < passes; pass++)
        for (uint32_t i = 0; i < strip->count; i++)
            displace_triangle(surface, tool, places[strip->triangles[i]]);
}
