/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The pairs of a tool and a surface that may carry force in a step of the tissue: every pair within reach of the proxy,
 * where nothing touches yet, too. Of a segment they are those that can limit a motion (nearest/pair_features.h), of a tip
 * those of its features (hull/hull_triangle.h). Where springs' triangles are fine for a segment's radius, their vertices
 * touch instead, alone or some together (tissue/touch_vertices.h). docs/algorithms/tissue.md.
 */
#ifndef DPT_TOUCHES_H
#define DPT_TOUCHES_H

#include "base/work.h"
#include "proxy/proxy_pose.h"
#include "tissue/touch_vertices.h"

enum { TOUCHES_MAX = 256, TOUCH_DIMENSIONS = 6 };

/* A feature of a touch of a shaft: this, and its number. */
#define TOUCH_OF_SHAFT 0x40000000u

struct touch {
    uint32_t tool_slot;
    uint32_t part; /* of the tool: tool_parts.h */
    uint32_t body_id;
    uint32_t triangle;            /* place; of a touch of vertices one of theirs */
    uint32_t feature;             /* of the pair: nearest/pair_features.h, of a tip hull/hull_triangle.h */
    uint32_t vertices;            /* the first of its vertices in the list, plus 1; 0: it is a pair's */
    uint32_t shaft;               /* of a shaft in its channel: tissue_shaft.h; 0: it is none */
    uint32_t name;                /* of a touch of vertices: with its feature it is the same from step to step */
    vec3 at;                      /* the point on the surface, in the world; of vertices their mean, as is all below */
    vec3 normal;                  /* unit, in the world, towards the tool */
    double weight[3];             /* of the triangle's corners at that point; of vertices 0 */
    double gap;                   /* m, with the tool at its proxy, by the row: beyond the proxy's clearance */
    double row[TOUCH_DIMENSIONS]; /* how the gap grows with the unknowns of the proxy's motion */
};

/* All touches of a step. */
struct touches {
    uint32_t count;
    uint32_t is_full; /* 1: there were more than there is room for: those with the least gaps were taken */
    struct touch touch[TOUCHES_MAX];
};

/*
 * What is gathered: the pairs of a tool at its proxy's pose and a body, within `reach`, m. With `ahead`, s, the surface is
 * taken where its speeds lead it in that time, but no farther than a share of the tool's radius. Gaps are those of the
 * surface as it is, by the rows that hold there.
 */
struct touch_search {
    struct dpt_world *world;
    const struct tool *tool;
    const struct proxy *proxy;
    const struct proxy_pose *at;
    const struct body *body;
    const struct dpt_springs *springs; /* of the body; NULL: nobody steps them here */
    struct touch_vertices *vertices;   /* NULL: pairs alone */
    double reach;
    double left_out; /* m: of the segment of a tool that is in the body, from its point on; 0: it is not in */
    double ahead;
    double least; /* m: within it all is looked at; what is beyond it by the tool's radius, only if a tick has time */
    struct work *work; /* what is looked at is counted */
};

/* How a point of the tool, at `place` in the world, moves along a unit vector with the unknowns of the proxy's motion. */
void dpti_touch_lever(const struct proxy *proxy, const struct proxy_pose *at, const vec3 axes[3], vec3 place,
                      vec3 along, double lever[TOUCH_DIMENSIONS]);

/* Add them. Returns 0 if they are not all: there was no time for all within reach. */
int dpti_touches_gather(const struct touch_search *search, struct touches *touches);

#endif
