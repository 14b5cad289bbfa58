/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The patches of surface round a proxy: docs/algorithms/patch.md. All triangles of one body within reach of the axis of one
 * segment or tip, found once in many ticks; and what a tick makes of them, of all parts of the tool and bodies together.
 */
#ifndef DPT_PROXY_PATCH_H
#define DPT_PROXY_PATCH_H

#include "hull/hull_search.h"
#include "proxy/proxy_tick.h"
#include "sweep/sweep_triangle.h"

enum { PATCH_BLOCKS = 4, PATCH_LEAVES = PATCH_BLOCKS * LANES, PATCH_TRIANGLES_MAX = 192, PATCH_BESIDE_LINE_MAX = 64 };

/*
 * A segment or tip has patches of so many bodies; so many of them a tool may have, and pairs of one and a body near it, of
 * which so many are of tips.
 */
enum { PATCH_BODIES = 2, PATCH_AXES_MAX = 8, PATCH_SIDES_MAX = 8, PATCH_TIP_SIDES_MAX = 2 };

/* An axis in the frame of a body. */
struct patch_place {
    vec3 a, u;
    uint32_t body_id; /* 0: none */
    uint32_t reserved;
};

/* The leaves, with their boxes as children of a node of their own. Kept from tick to tick. */
struct proxy_patch {
    vec3 a, b;        /* the axis about which it lies, in the body's frame */
    double reach;     /* m: each triangle that near to that axis is in one of the leaves; 0: there is no patch */
    double spare;     /* what was found beside what was asked for, as a multiple of the reach */
    uint32_t body_id; /* the body, which does not deform */
    uint32_t count;   /* of leaves */
    /* Of a tool's first one: where a tick found nothing to do, or no list, and left the tool to searches. */
    struct patch_place still;    /* of the tool's first segment */
    uint32_t crowded;            /* no list could be made: none is tried for so many ticks that begin elsewhere */
    uint32_t is_off;             /* 1: none of the tool's is used, as a test wants */
    uint32_t leaf[PATCH_LEAVES]; /* ascending */
    float box[PATCH_BLOCKS][MESH_BOX_WORDS];
};

/* A triangle of the patch. */
struct patch_triangle {
    pair found;    /* its nearest pair with the axis, if is_found */
    double gap;    /* m: of that pair; else no more than it */
    vec3 normal;   /* unit, to the axis: across the last pair that was found, or near that; 0: of none */
    double height; /* m, of a ball: the triangle lies behind the plane normal . x = height; HUGE_VAL: none was found */
    uint32_t triangle; /* place */
    uint16_t is_found;
    uint16_t is_held;  /* it has a constraint */
    uint16_t has_face; /* which may be its own plane */
    uint16_t space;    /* the number of the constraint; HALF_SPACES_MAX: a neighbour has the same */
    uint16_t side;     /* of which it is */
    uint32_t feature;  /* of a tip's pair that is found: hull/hull_triangle.h */
};

/* A segment of the tool, or a tip and its hull's axis. */
struct patch_axis {
    struct part part;
    vec3 a, b; /* in the world, at tick->at */
};

/* A tip beside a body, in the body's frame: its corners where it is, and behind them where a motion leads. */
struct patch_tip {
    vec3 corner[2 * HULL_CORNERS_MAX];
    vec3 plane[HULL_PLANES]; /* unit, towards the body: what lies beyond one of these is the less near */
    double support[HULL_PLANES];
};

/* A segment or tip beside a body. */
struct patch_side {
    struct proxy_patch *patch;
    struct patch_tip *tip; /* NULL: a segment */
    struct part part;
    const struct body *body;
    double radius, spread;         /* m: of the part; and no corner of a tip is farther from its axis */
    uint32_t number;               /* of the part: proxy_triangle.segment */
    uint32_t nearest;              /* in the list; PATCH_TRIANGLES_MAX: none that is near */
    vec3 a, u;                     /* the axis in the body's frame */
    double moved;                  /* m: no point of it has moved farther since the last look */
    uint32_t listed[PATCH_LEAVES]; /* of each leaf, the lanes that are in the list */
};

/* A tick's view of the patches. */
struct patch_view {
    struct proxy_patch *first; /* of the tool */
    const struct body *body;   /* the nearest when the tick began */
    int is_ball;
    int is_made;   /* there is a list */
    int is_listed; /* motions stay within the list: beside a ball, and of tips */
    int has_tips;
    int again_count;     /* motions in this tick that were tried again, but shorter */
    double near;         /* m: the nearest pairs are looked for up to that gap */
    double reach;        /* m: no triangle outside of the list has a gap below that */
    double covered;      /* m: the same of triangles outside of the patches, and of other bodies */
    double wished;       /* m: the longest reach that was asked for in this tick */
    double longest;      /* m: of the motions that were made in this tick */
    double trust;        /* m: no longer motion is tried next */
    double room;         /* m: a longer reach had no room in the patches in this tick */
    struct frame placed; /* the tool, for the axes */
    uint32_t axis_count, side_count, tip_count, count;
    struct patch_axis axes[PATCH_AXES_MAX];
    struct patch_side sides[PATCH_SIDES_MAX];
    struct patch_tip tips[PATCH_TIP_SIDES_MAX];
    struct patch_triangle list[PATCH_TRIANGLES_MAX];
};

static inline const struct patch_side *patch_side_of(const struct patch_view *view,
                                                     const struct patch_triangle *triangle)
{
    return &view->sides[triangle->side];
}

/* Whether one triangle is nearer than another, both of pairs that are found. Of equal ones that of the lower source. */
static inline int patch_is_nearer(const struct surface *surface, const struct patch_triangle *one,
                                  const struct patch_triangle *other)
{
    return one->found.distance2 < other->found.distance2 ||
           (one->found.distance2 == other->found.distance2 &&
            surface->sources[one->triangle] < surface->sources[other->triangle]);
}

/* Whether the proxy remembers a triangle: it held it or was hit. */
static inline int patch_is_remembered(const struct proxy *proxy, const struct patch_side *side, uint32_t triangle)
{
    for (uint32_t i = 0; i < PROXY_MEMORY; i++)
        if (proxy->memory[i].triangle == triangle && proxy->memory[i].body_id == side->body->id &&
            proxy->memory[i].segment == side->number)
            return 1;
    return 0;
}

/* Units of work that a look or a proof may take, so that it is not begun with less. */
enum { PATCH_WORK = 512 };

/* Whether the tick may work with patches: of a tool that is held by a rigid body. Begins the view. */
int dpti_patch_begin(struct proxy_tick *tick, struct patch_view *view);

/*
 * The triangles round tick->at, those with a gap up to `reach` m, or to less where there are too many; none has a
 * constraint. Beside a line the list may have less than the patches, which have all up to view->covered. tick->gap becomes
 * the nearest one's, or what is proven of it. Returns 0 if they have no room, or the work does not suffice.
 */
int dpti_patch_look(struct proxy_tick *tick, struct patch_view *view, double reach);

/*
 * Beside a line: list what its motion may meet of one side beyond the list's reach, and within the patch. Returns 0 if
 * there is no room.
 */
int dpti_patch_list_met(struct dpt_world *world, struct patch_view *view, uint32_t side, const struct sweep *sweep);

/* m: no point of the tool is farther from where the view has it at a pose, ends and corners on straight lines. */
double dpti_patch_moved(const struct patch_view *view, const struct proxy_pose *to);

/* Find a triangle's nearest pair with its side's axis, and the plane across it. */
void dpti_patch_find(struct dpt_world *world, const struct patch_view *view, struct patch_triangle *triangle);

/* Where the axis is at the start and at the end of a straight motion, in the body's frame. */
struct patch_way {
    vec3 a[2], b[2];
    vec3 x;        /* unit, along the axis at the start */
    double length; /* m, of the axis; 0: a ball */
    double spare;  /* m: no point of the axis that is so far beside a triangle, along x at the start, can be near it */
};

/* The way from where the axis of a side is. */
struct patch_way dpti_patch_way(const struct patch_side *side, int is_ball, vec3 to_a, vec3 to_b, double spare);

/* The part of the axis, as shares of it, that can be near a triangle. Returns 0 if there is none. */
static inline int patch_part_beside(const struct patch_way *way, const vec3 v[3], double part[2])
{
    part[0] = part[1] = 0.0;
    if (!(way->length > 0.0))
        return 1;
    const double origin = dot(way->x, way->a[0]), s0 = dot(way->x, v[0]), s1 = dot(way->x, v[1]),
                 s2 = dot(way->x, v[2]);
    part[0] = max_of(0.0, (min_of(s0, min_of(s1, s2)) - way->spare - origin) / way->length);
    part[1] = min_of(1.0, (max_of(s0, max_of(s1, s2)) + way->spare - origin) / way->length);
    return part[0] <= part[1];
}

/* m: the least height of that part over a triangle along a normal, at any time of the motion. */
static inline double patch_height(const struct patch_way *way, vec3 normal, const double part[2], const vec3 v[3])
{
    double least = HUGE_VAL;
    for (int time = 0; time < 2; time++) {
        const double a = dot(normal, way->a[time]), rise = dot(normal, way->b[time]) - a;
        least = min_of(least, a + min_of(part[0] * rise, part[1] * rise));
    }
    return least - max_of(dot(normal, v[0]), max_of(dot(normal, v[1]), dot(normal, v[2])));
}

/* The tick has made no motion. While the tool is there, it is not worth a look: what is known there serves as well. */
void dpti_patch_leave(struct patch_view *view);

/* The nearest pairs at tick->at become the answers of segments and tips. Returns 0 if the view does not have those of all. */
int dpti_patch_answer(struct proxy_tick *tick, const struct patch_view *view);

#endif
