/* SPDX-License-Identifier: BSD-3-Clause */
#include "insertion/region_law.h"

int dpti_body_is_pierced(const struct dpt_world *world, const struct body *body)
{
    const struct body_regions *regions = body_regions_of(world, body);
    int is_any = pierce_law_is_any(&body->pierce);
    for (uint32_t i = 0; i < regions->count; i++)
        is_any |= pierce_law_is_any(&regions->law[i]);
    return is_any;
}

static double rupture_or_never(const struct pierce_law *law, double radius, double stiffness)
{
    return pierce_law_is_any(law) ? rupture_force(law, radius, stiffness) : HUGE_VAL;
}

double dpti_weakest_rupture(const struct dpt_world *world, const struct body *body, double radius, double stiffness)
{
    const struct body_regions *regions = body_regions_of(world, body);
    double least = rupture_or_never(&body->pierce, radius, stiffness);
    for (uint32_t i = 0; i < regions->count; i++)
        least = min_of(least, rupture_or_never(&regions->law[i], radius, stiffness));
    return least;
}

const struct pierce_law *dpti_cutting_law(const struct dpt_world *world, const struct body *body,
                                          const struct channel *channel)
{
    for (uint32_t i = 0; i < channel->layer_count; i++)
        if (channel->deepest < channel->layers[i].to)
            return region_law(world, body, channel->layers[i].region);
    return &body->pierce;
}

struct pierce_law dpti_shaft_law(const struct dpt_world *world, const struct body *body, const struct channel *channel,
                                 double tip)
{
    const struct body_regions *regions = body_regions_of(world, body);
    struct pierce_law law = body->pierce;
    double friction = 0.0, viscosity = 0.0, most = law.shaft_friction;
    if (!regions->count)
        return law;
    for (uint32_t i = 0; i < regions->count; i++)
        most = max_of(most, regions->law[i].shaft_friction);
    if (!(law.shaft_stiffness > 0.0))
        law.shaft_stiffness = max_of(most, 1.0) / SHAFT_STRETCH;
    const double inside = dpti_channel_inside(channel, tip);
    if (!(inside > 0.0))
        return law;
    for (uint32_t i = 0; i < channel->layer_count; i++) {
        const struct pierce_law *layer = region_law(world, body, channel->layers[i].region);
        const double share = dpti_layer_inside(channel, i, tip) / inside;
        friction += share * layer->shaft_friction;
        viscosity += share * layer->shaft_viscosity;
    }
    law.shaft_friction = friction;
    law.shaft_viscosity = viscosity;
    return law;
}
