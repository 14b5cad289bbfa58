/* SPDX-License-Identifier: BSD-3-Clause */
/* What one tick of a proxy works with: src/proxy/proxy_step.c. */
#ifndef DPT_PROXY_TICK_H
#define DPT_PROXY_TICK_H

#include "force/friction.h"
#include "nearest/pair_features.h"
#include "proxy/proxy_pose.h"
#include "track/tool_parts.h"

/* The most triangles in one problem: the remembered ones, and the nearest of each segment. */
enum { PROXY_TRIANGLES_MAX = PROXY_MEMORY + 16 };

/*
 * m: clearances grow with the largest body up to that size, and no farther. A larger body is swept as finely as one of
 * that size; otherwise everything else in its world would be felt too early.
 */
#define PROXY_SCALE_MAX 1.0

/*
 * A motion shorter than these shares of what is left to the device, or of the clearance, is not made. Of what is left to the
 * device only where it is also short beside an edge: a thin tool that the device pulls round one from far away goes by motions
 * as short as its radius.
 */
#define PROXY_CONVERGED    3e-4
#define PROXY_MOTION_SMALL 1e-3
#define PROXY_EDGE_SHARE   0.1

/* m/s: how fast a proxy may move, beyond twice the device's motion, when what held it is gone (a fold). */
#define PROXY_FOLD_SPEED 1.0

/* rad: beyond that turn from a device that has itself turned as far since it was free, a proxy is put there again. */
#define PROXY_TURN_MAX 1.0

/* As a share of the clearance: a gap that is large enough. */
#define PROXY_GAP_KEPT 0.7

/* The pair behind a constraint. */
struct proxy_source {
    uint32_t triangle; /* in proxy_tick.triangles */
    int feature;       /* of the pair: nearest/pair_features.h, of a tip hull/hull_triangle.h */
    double s;          /* of its point on the axis; of a tip 0 */
    double gap;        /* m */
    vec3 p;            /* that point, in the world */
    vec3 carried;      /* how far the body moved its point on the mesh before this tick, while that counts */
};

/* Whether the holding contacts are known at the end of the tick. */
enum { PROXY_HELD_UNKNOWN, PROXY_HELD_SOLVED, PROXY_HELD_NOT };

struct proxy_tick {
    struct dpt_world *world;
    struct tool *tool;
    struct proxy *proxy;
    struct proxy_pose at, device;
    struct proxy_pose goal; /* what it follows: the device, or where friction held the tool in its step with tissue */
    int is_led;             /* the latter: then no friction is added to it */
    int has_ended;          /* there was such a step, which ended at `end` */
    int has_end;            /* and the proxy has not tried to go there */
    double dented;          /* the share of the tool's radius that surfaces may dent on the way of a motion */
    double spare;           /* m: so much less than the minimum gap is enough after a motion */
    dpt_pose end;
    vec3 axes[3];     /* of `at`, for turns */
    double clearance; /* m: contacts are held so far apart */
    double min_gap;   /* m: no pose is accepted whose gap is less */
    double edge;      /* m: the radius of its way round a sharp edge; of a tool with tips it does not count: HUGE_VAL */
    double gap;       /* m: of the tool's surface at `at`; a lower bound where a budget ended the search */
    int is_before;    /* `at` is proven only for where bodies were at `time` of their motion before this tick */
    double time;      /* 0..1 */
    double made;      /* the share that was made of the last motion that was solved for */
    double lift;      /* m: while is_before, added to the clearance of contacts */
    int only_aside;   /* while is_before, no way to the goal was found: motions lead out of the bodies' way alone */
    int is_lost;      /* the segments' nearest pairs are of another pose than `at` */
    int held;         /* PROXY_HELD_... */
    int is_fast;      /* the device moved by more than half of what a fold may in a tick */
    int is_left;      /* searches first: one with patches made no motion here, or no list has had room of late */
    int is_moved;     /* a motion was made in this tick */
    int is_dragged;   /* it went along with a body while it stuck to another one: a motion is to make that good */
    int is_settled;   /* the last solution is of `at`, and leaves no motion to make */
    int is_waiting;   /* a budget ended the tick's motions before the proxy arrived */
    uint32_t triangle_count;
    uint32_t space_count;
    uint32_t contact_count; /* of the solution, contacts with friction */
    int is_begun;           /* the solution is of these constraints, or fewer: the next solve begins there */
    struct half_spaces_result solved;
    /* From here on a tick does not begin with zeros. Triangles are copies, as proxy->memory changes during the tick. */
    struct proxy_triangle triangles[HALF_SPACES_MAX]; /* one a constraint within the patch */
    struct half_space spaces[HALF_SPACES_MAX];
    struct proxy_source sources[HALF_SPACES_MAX];
    struct friction_contact contacts[HALF_SPACE_DIMENSIONS];
    uint32_t contact_spaces[HALF_SPACE_DIMENSIONS]; /* the constraints of the contacts */
};

/* Whether a motion of length `size` that was solved for, where `left` is left to the device, is not worth making. */
static inline int proxy_has_arrived(const struct proxy_tick *tick, double size, double left)
{
    return size < PROXY_MOTION_SMALL * tick->clearance ||
           (size < PROXY_CONVERGED * left && size < PROXY_EDGE_SHARE * tick->edge &&
            tick->gap > PROXY_GAP_KEPT * tick->clearance && (tick->is_moved || !tick->is_dragged));
}

/* m: of the segment or tip that a constraint is of. */
static inline double proxy_radius_of(const struct proxy_tick *tick, uint32_t space)
{
    return part_radius(tool_part(tick->world, tick->tool, tick->triangles[tick->sources[space].triangle].segment));
}

/* m: where the tool's surface touches, in the world. */
static inline vec3 proxy_touch_of(const struct proxy_tick *tick, uint32_t space)
{
    return along(tick->sources[space].p, -proxy_radius_of(tick, space), vec3_of(tick->spaces[space].normal));
}

/* The tip that a triangle is near; NULL: it is a segment. */
static inline const struct tip *proxy_tip_of(const struct proxy_tick *tick, const struct proxy_triangle *triangle)
{
    return tool_part(tick->world, tick->tool, triangle->segment).tip;
}

#endif
