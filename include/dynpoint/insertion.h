/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Needles: tools that pierce bodies. docs/algorithms/insertion.md.
 *
 *     def.max_channels = 8;                               before dpt_world_create
 *     body_settings.puncture_force = 2.0;                 N
 *     body_settings.shaft_friction = 60.0;                N/m
 *     dpt_body_set_settings(world, body, &body_settings);
 *     tool_settings.piercing = DPT_PIERCING_B;            end b of its segment is the point
 *     dpt_tool_set_settings(world, tool, &tool_settings);
 *
 * The tip presses against a wall of the body, as any tool does, until the wall ruptures. From then on the tool is in a
 * channel: a straight hole along its axis, fixed to the body. There it moves along that line alone. Friction holds its
 * shaft, and its tip cuts where it goes deeper than it has been. The far side of the body, and bodies behind it, are
 * further walls. A tool that is drawn out is free again. The hole stays: in it the tip meets no wall and cuts nothing
 * that it has cut. Only the tool that made a hole goes into it: where its tip is within its radius of the channel's line
 * and within twice that of the mouth along it, and where it leans from the line by a cosine of 0.9 or more. One that is
 * in another channel goes in where the hole lies on its line within a tenth of its radius, or its radius in a body that
 * gives way.
 *
 * In a body, the needle can pass only where its straight cylinder cuts walls that have ruptured. Needles do not bend.
 *
 * A body that gives way is pierced if it has springs or a compliance (body.h). Step it with dpt_bodies_step_springs: needle,
 * coupling and tissue are then solved together. A hole moves with the tissue at its entry. Where a rigid body's channel keeps
 * its line, the shaft in tissue is held at points that move with it; entered again, the hole takes the tool as it points.
 *
 * If bodies move so that the tool's line cannot follow, the tool leaves all its channels, as by a teleport
 * (DPT_FORCE_FLAG_SQUEEZED). This happens in three cases: another body meets its shaft, or its tip where that cannot go
 * back along the line; two bodies that it is in move sideways to each other by a tenth of its radius; or a budget ends
 * the search for what moving bodies meet. After that the tool counts as inside until it has been outside. A hole ends
 * with its body, which a teleport of the body ends too, and with its tool or that tool's size (dpt_tool_set_segments).
 * dpt_world_reset closes all holes.
 *
 * A wall ruptures only after all walls behind it have been found (insertion.md says how much work this is). With a small
 * budget this takes several steps. Until then the wall holds, with DPT_FORCE_FLAG_BEHIND.
 * In a body that gives way the walls are found again in each step. If a budget spreads that over several steps, the tip
 * goes no deeper meanwhile.
 *
 * Threads: as for the world.
 */
#ifndef DYNPOINT_INSERTION_H
#define DYNPOINT_INSERTION_H

#include "dynpoint/world.h"

DPT_BEGIN

/* Regions of a body, beside what is of none. */
enum { DPT_BODY_REGIONS_MAX = 15 };

/*
 * What a region of a body's surface takes of a needle, in place of the fields of dpt_body_settings with these names, and
 * in their ranges. All 0: nothing pierces it. The bristles' stiffness is the body's; where that is 0, the region with
 * most friction slips beyond 10 um.
 */
typedef struct dpt_body_region {
    uint32_t size;     /* sizeof(dpt_body_region), set by the caller; of an array, in the first item */
    uint32_t reserved; /* 0 */
    double puncture_force;
    double toughness;
    double cutting_force;
    double shaft_friction;
    double shaft_viscosity;
} dpt_body_region;

/*
 * Give regions of a body's surface laws of their own: skin that is thicker here, a capsule, a vessel's wall. A wall
 * ruptures by the law of the triangle that the tip touches first. Behind a triangle by which the needle goes into the
 * body it is cut, and rubs, by that triangle's law, as far as the needle comes out again. In a body that gives way a
 * layer keeps that law while the needle is in it. Holes in the body close, as by a teleport of it. To be called between
 * steps.
 *   of_triangle   the region of each triangle, by source number: 0: none, the body's own settings; k: regions[k - 1]. It
 *                 is used where it is, and must stay unchanged as long as the body, or until other regions are set
 *   triangles     dpt_mesh_info.source_triangles
 *   regions       are copied. NULL if count is 0
 *   count         0: the body has none any more, and of_triangle is not used
 *
 * DPT_E_UNSUPPORTED: the world has no room for channels; or a region can be pierced, of a body that cannot
 * (dpt_body_settings.puncture_force). DPT_E_LIMIT: more than DPT_BODY_REGIONS_MAX. DPT_E_INDEX: a triangle is of a region
 * that is not there. DPT_E_ARGUMENT: another number of triangles, or a number out of range. After an error the body has
 * the regions that it had.
 */
DPT_API dpt_result dpt_body_set_regions(dpt_world *world, dpt_body body, const uint8_t *of_triangle, uint32_t triangles,
                                        const dpt_body_region *regions, uint32_t count);

/* Bits of dpt_channel.flags. */
enum { DPT_CHANNEL_FLAG_OCCUPIED = 1 /* the tool is in it */ };

/*
 * A channel, from the last step. Lengths in m; points and directions are in the world, where the body is now.
 *
 *   id         never 0; a later channel has a larger one
 *   body       that it is in
 *   triangle   source number, and `weight` the weights of its corners at the entry, in the order of
 *              dpt_mesh_get_triangle; their sum is 1
 *   flags      DPT_CHANNEL_FLAG_...
 *   ruptures   walls that are open, from the entry on
 *   layers     stretches inside of the body that the tip has gone into and not come back from
 *   entry      where its axis enters the body
 *   axis       unit, into the body
 *   depth      of the tip's axis beyond the entry; 0: it is not in. A tip that is still within the wall may be below 0
 *   deepest    where it has been
 *   inside     length of the shaft inside the body
 *   friction   N, on the tool along its shaft, above 0 against going in
 *   tip        N, likewise at its tip: what it takes to cut, or presses against the next wall
 */
typedef struct dpt_channel {
    uint32_t size; /* the caller's sizeof(dpt_channel); in an array, set that of the first item */
    uint32_t id;
    uint32_t body;
    uint32_t triangle;
    uint32_t flags;
    uint32_t ruptures;
    uint32_t layers;
    uint32_t reserved; /* 0 */
    double weight[3];
    double entry[3];
    double axis[3];
    double depth;
    double deepest;
    double inside;
    double friction;
    double tip;
} dpt_channel;

/*
 * The channels that a tool has made, also those that it has left, in no stated order. DPT_E_UNSUPPORTED: the world has
 * no room for channels.
 *   channels   at most `capacity` are written. channels[0].size must be set. May be NULL if capacity is 0
 *   count      how many there are, which may be more than `capacity`
 */
DPT_API dpt_result dpt_tool_get_channels(const dpt_world *world, dpt_tool tool, dpt_channel *channels,
                                         uint32_t capacity, uint32_t *count);

/*
 * Put a piercing tool in, where its device is: as if it had been pushed there along its axis, through all walls of
 * bodies that can be pierced. For scenes that begin with a needle in. To be called between steps, where bodies rest.
 *
 * DPT_E_ARGUMENT: its rear end is inside of a body or behind an open sheet, or would meet such a body on its straight
 * way out; it touches one that cannot be pierced, it goes into none, or through more walls than a channel has room for
 * (16). DPT_E_FULL: no room for its channels, of which a tool has 6 at most. DPT_E_UNSUPPORTED: the tool does not
 * pierce, or has no valid pose. After the first two the tool is as after
 * dpt_tool_teleport to where its device is; it is so before it is put in, too.
 */
DPT_API dpt_result dpt_tool_insert(dpt_world *world, dpt_tool tool);

DPT_END

#endif
