/* SPDX-License-Identifier: BSD-3-Clause */
#include "insertion/region_law.h"

#include "base/return_if_error.h"
#include "base/sized.h"
#include "mesh/mesh_format.h"
#include "world/world_members.h"

static dpt_result read_region(const dpt_body_region *given, uint32_t stride, struct pierce_law *law)
{
    dpt_body_region region = { .size = sizeof region };
    DPT_TRY(sized_take(given, stride, sizeof region, &region, sizeof region));
    *law = (struct pierce_law){ region.puncture_force, region.toughness,       region.cutting_force,
                                region.shaft_friction, region.shaft_viscosity, 0.0 };
    return !region.reserved && dpti_pierce_law_is_valid(law) ? DPT_OK : DPT_E_ARGUMENT;
}

static int has_needle(const struct dpt_world *world, uint32_t body_id)
{
    for (uint32_t t = 0; t < world->tool_slot_end; t++)
        if (dpti_is_inserted_in(world, &world->tools[t], body_id))
            return 1;
    return 0;
}

dpt_result dpt_body_set_regions(dpt_world *world, dpt_body body, const uint8_t *of_triangle, uint32_t triangles,
                                const dpt_body_region *regions, uint32_t count)
{
    struct body_regions read = { .of_triangle = count ? of_triangle : NULL, .count = count };
    if (!world || (count && (!of_triangle || !regions)))
        return DPT_E_ARGUMENT;
    struct body *found = world_find_body(world, body);
    if (!found)
        return DPT_E_HANDLE;
    if (!world->channels)
        return DPT_E_UNSUPPORTED;
    if (count > DPT_BODY_REGIONS_MAX)
        return DPT_E_LIMIT;
    if (count && triangles != found->surface.mesh->source_triangles)
        return DPT_E_ARGUMENT;
    for (uint32_t i = 0; i < count; i++)
        DPT_TRY(read_region(sized_item(regions, i), sized_of(regions), &read.law[i]));
    for (uint32_t i = 0; i < count; i++)
        if (pierce_law_is_any(&read.law[i]) && !dpti_body_can_be_pierced(found))
            return DPT_E_UNSUPPORTED;
    for (uint32_t i = 0; count && i < triangles; i++)
        if (of_triangle[i] > count)
            return DPT_E_INDEX;
    if (has_needle(world, body))
        dpti_body_begin_anew(world, found);
    dpti_channels_forget_body(world, body);
    *body_regions_of(world, found) = read;
    world->has_changed = 1;
    return DPT_OK;
}
