/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A channel: the hole that a piercing point has made in a body, a straight line fixed in the body's frame.
 * docs/algorithms/insertion.md.
 *
 * Places on the line are lengths in m from the mouth, where the tip was when the first wall ruptured. The tip is the
 * ball of the tool's radius about the end of its axis. A wall is a stretch of the line in which that ball touches the
 * surface; a layer is a stretch of the line that is inside.
 */
#ifndef DPT_CHANNEL_H
#define DPT_CHANNEL_H

#include "base/work.h"
#include "kernel/kernel_ops.h"
#include "mesh/surface.h"
#include "nearest/bvh.h"

enum { CHANNEL_WALLS_MAX = 16, CHANNEL_LAYERS_MAX = 8, CHANNEL_POINTS_MAX = 8, CHANNEL_HITS_MAX = 6 };

struct channel_stretch {
    double from, to;
    uint32_t region; /* of the surface where it begins; 0: none */
    uint32_t reserved;
};

/* A point of a surface: weights of its triangle's corners, times its share. */
struct channel_hit {
    uint32_t triangle; /* place */
    uint32_t reserved;
    double weight[3];
};

/* A point that the channel shares with its body: channel_points.h. */
struct channel_point {
    uint32_t hit_count; /* 0: of a rigid body */
    uint32_t reserved;
    double place;     /* on the line when it was made */
    double stiffness; /* N/m: of the bristles that hold the shaft across */
    vec3 rest;        /* of a rigid body: where it is, in the body's frame; else 0 */
    vec3 offset;      /* m: of the axis from the point where these are not stretched, in the body's frame */
    struct channel_hit hits[CHANNEL_HITS_MAX];
};

enum { CHANNEL_NEAR_MAX = 64 };

/*
 * The triangles of a surface that deforms that were within a margin beyond the radius of a line, in order: each where it
 * was when the search came by, which may take several ticks. All zeros: none were looked for.
 */
struct channel_near {
    uint32_t is_known; /* 1: all of them are noted */
    uint32_t count;
    uint32_t begun; /* of the surface's motion, when the search began, as is the next */
    float travel;
    double margin; /* m; 0: it has not begun */
    vec3 from, way;
    struct range range;                  /* of what is still to be looked at */
    uint32_t triangle[CHANNEL_NEAR_MAX]; /* places */
};

struct channel {
    uint32_t id;       /* never 0 in use; grows from one to the next */
    uint32_t body_id;  /* 0: there is no channel here */
    uint32_t tool_id;  /* that made it */
    uint32_t triangle; /* place: that of the entry */
    double weight[3];  /* of its corners, at the entry */
    vec3 mouth, axis;  /* in the body's frame; the axis is of unit length, into the body */
    double radius;     /* m: of the tool */
    double length;     /* m: the line is known that far, at least the tool's length */
    double entry;      /* where the axis goes through the first wall, or where the tip touches it if it does not */
    double limit;      /* no tip may go farther: there was no room to note what comes then */
    double deepest;    /* where the tip has been */
    uint32_t wall_count, open_count; /* the first `open_count` walls have ruptured */
    uint32_t layer_count;
    uint32_t is_from_inside; /* 1: the line comes out first: the mouth is inside, or behind an open sheet */
    struct channel_stretch walls[CHANNEL_WALLS_MAX];   /* ascending, apart from each other */
    struct channel_stretch layers[CHANNEL_LAYERS_MAX]; /* likewise */
    double opened;                                     /* so far walls are open, also where they move */
    uint32_t point_count;                              /* 0: the world has no bodies that deform */
    struct channel_point points[CHANNEL_POINTS_MAX];   /* by ascending place */
    struct channel_near near;                          /* its line in tissue, some ticks ago */
};

static inline int near_is_under_way(const struct channel_near *near)
{
    return near->margin > 0.0 && !near->is_known;
}

enum { CHANNEL_CROSSINGS_MAX = 2 * CHANNEL_LAYERS_MAX + 2 };

/* Where the line goes through a triangle. */
struct channel_crossing {
    double at;
    uint32_t is_entering;
    uint32_t triangle;
    double weight[3];
};

/* A search for what is along a line, that may take several ticks. */
struct channel_search {
    struct channel channel; /* as far as it is found */
    const struct surface *surface;
    const uint8_t *regions; /* of the surface's triangles, by their source numbers; NULL: it has none */
    struct range range;     /* of the triangles that are still to be looked at */
    double reach;           /* m: so far the line is looked at, the whole body through */
    double first;           /* where the tip touches first */
    uint32_t is_begun;
    uint32_t crossing_count;
    struct channel_crossing crossings[CHANNEL_CROSSINGS_MAX]; /* ascending */
};

/*
 * Begin to find walls and layers along the line from channel->mouth along channel->axis, with channel->radius and
 * ->length, of a surface that does not deform and stays where it is in memory, as its regions do.
 */
void dpti_channel_search_begin(struct channel_search *search, const struct channel *channel,
                               const struct surface *surface, const uint8_t *regions, const struct kernel *kernel,
                               struct work *work);

/*
 * Go on. Returns 0 if the work was spent before the end; else search->channel has all, and no wall of it is open. Walls
 * that the tip touches at once are one. A layer begins where the line goes in and ends where it comes out; where it never
 * comes out, as behind an open sheet, there is none.
 */
int dpti_channel_search_on(struct channel_search *search);

/*
 * The same of a surface that deforms, where it and the line are now. What was near a line a while ago is all that is near
 * another one, if that and the vertices have not moved farther than the margin since: `near` is of such a line, or is
 * made. Returns 0 if the work was spent before: with `near` as it is then, the next tick goes on.
 */
int dpti_channel_search_near(struct channel_search *search, const struct channel *channel,
                             const struct surface *surface, const uint8_t *regions, const struct kernel *kernel,
                             struct work *work, struct channel_near *near);

/* Where the tip stands before the next wall, `clearance` m from touching it; or at the limit. */
double dpti_channel_stop(const struct channel *channel, double clearance);

/* m: of the shaft from the tip back that is inside of the body. */
double dpti_channel_inside(const struct channel *channel, double tip);

/* m: likewise, that is in one of its layers. */
double dpti_layer_inside(const struct channel *channel, uint32_t layer, double tip);

/* How many layers begin before the tip. */
uint32_t dpti_channel_layers(const struct channel *channel, double tip);

/*
 * The place from which on the tip cuts: the deepest where it has been, or where the next layer begins. HUGE_VAL: it
 * cuts no more.
 */
double dpti_channel_uncut(const struct channel *channel);

#endif
