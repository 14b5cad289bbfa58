/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/surface_regions.h"

#include <stdlib.h>

static int is_in(const dpt_spring_region *place, const double x[3])
{
    double square = 0.0;
    for (int k = 0; k < 3; k++) {
        if (place->kind == DPT_REGION_BOX && !(x[k] >= place->box[k] && x[k] <= place->box[3 + k]))
            return 0;
        square += (x[k] - place->box[k]) * (x[k] - place->box[k]);
    }
    return place->kind == DPT_REGION_BOX || square <= place->box[3] * place->box[3];
}

static uint8_t region_of(const struct surface_regions *regions, const double corners[9])
{
    const double x[3] = { (corners[0] + corners[3] + corners[6]) / 3.0, (corners[1] + corners[4] + corners[7]) / 3.0,
                          (corners[2] + corners[5] + corners[8]) / 3.0 };
    for (uint32_t i = regions->count; i > 0; i--)
        if (is_in(&regions->place[i - 1], x))
            return (uint8_t)i;
    return 0;
}

dpt_result surface_regions_set(const struct surface_regions *regions, dpt_world *world, dpt_body body,
                               const dpt_mesh *mesh, uint8_t **of_triangle)
{
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(mesh, &info);
    uint8_t *made = calloc(info.source_triangles, 1);
    *of_triangle = made;
    if (!made)
        return DPT_E_MEMORY;
    for (uint32_t i = 0; i < info.source_triangles; i++) {
        double corners[9];
        if (dpt_mesh_get_triangle(mesh, i, corners) == DPT_OK)
            made[i] = region_of(regions, corners);
    }
    return dpt_body_set_regions(world, body, made, info.source_triangles, regions->law, regions->count);
}
