/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What the regions of a body's surface take of a needle (dpt_body_set_regions): docs/algorithms/insertion.md. A wall has
 * the law of the triangle that the tip touches first, a layer that of the triangle by which the line goes in. Region 0 is
 * the body itself.
 */
#ifndef DPT_REGION_LAW_H
#define DPT_REGION_LAW_H

#include "dynpoint/insertion.h"
#include "insertion/world_channels.h"

/* Of a body. All zeros: it has none. */
struct body_regions {
    const uint8_t *of_triangle; /* by source number; the caller's */
    uint32_t count;
    uint32_t reserved;
    struct pierce_law law[DPT_BODY_REGIONS_MAX];
};

static inline struct body_regions *body_regions_of(const struct dpt_world *world, const struct body *body)
{
    return &world->body_regions[body - world->bodies];
}

/* That of a region by its number; of numbers that are not there the body's. */
static inline const struct pierce_law *region_law(const struct dpt_world *world, const struct body *body,
                                                  uint32_t region)
{
    const struct body_regions *regions = body_regions_of(world, body);
    return region && region <= regions->count ? &regions->law[region - 1] : &body->pierce;
}

/* The law of a triangle, by its place. */
static inline const struct pierce_law *triangle_law(const struct dpt_world *world, const struct body *body,
                                                    uint32_t triangle)
{
    const struct body_regions *regions = body_regions_of(world, body);
    return region_law(world, body, regions->count ? regions->of_triangle[body->surface.sources[triangle]] : 0);
}

/* Whether any of its regions can be pierced. Only where the world has channels. */
int dpti_body_is_pierced(const struct dpt_world *world, const struct body *body);

/* N: of the weakest of its regions, as rupture_force. */
double dpti_weakest_rupture(const struct dpt_world *world, const struct body *body, double radius, double stiffness);

/* Of the layer in which the tip cuts next. */
const struct pierce_law *dpti_cutting_law(const struct dpt_world *world, const struct body *body,
                                          const struct channel *channel);

/*
 * Along a shaft whose tip is at a place: the mean of its layers, each by the length that is inside. The bristles are as
 * stiff in all of them, so that they store nothing that was not put in where the shaft goes from one into the next.
 */
struct pierce_law dpti_shaft_law(const struct dpt_world *world, const struct body *body, const struct channel *channel,
                                 double tip);

#endif
