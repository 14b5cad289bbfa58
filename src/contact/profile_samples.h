/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Samples of a profile: how far the surface is at single points of the axis. Those beside each other are told of
 * what a new one found.
 */
#ifndef DPT_PROFILE_SAMPLES_H
#define DPT_PROFILE_SAMPLES_H

#include "contact/point_cache.h"
#include "nearest/dynamic_point.h"
#include "nearest/side.h"

/* The depth's own bound, of the mesh's diagonal. */
#define PROFILE_DEPTH_SHARE 1e-5

enum {
    PROFILE_SAMPLES = 96,
    PROFILE_CROSSINGS = 31,
    PROFILE_REACH_INTERVALS = 8,
    PROFILE_WARM_STARTS = 48
};

/* A place on the axis and a triangle that was nearest there. */
struct warm_start {
    double s;
    uint32_t triangle;
    float share; /* of its region's overlap: what would be wrong with it */
};

/* What counts for more than this is searched for; descent does for the rest. */
#define PROFILE_SEARCH_SHARE 0.005

/* Work after which descent has to do, but for the depth's proof; integrals have half as much again where samples are cheap. */
#define PROFILE_WORK_MAX 1600

struct profile_sample {
    double s;
    double height; /* signed distance to the triangle; the mesh's, if it is exact */
    vec3 normal;   /* unit, the way out: along it the height grows */
    double slope;  /* of the tangent: by how much the height grows over s, from 0 to 1 */
    vec3 gap;      /* x - q */
    double weight[3];
    uint32_t triangle; /* DPT_NONE: nothing is within reach here, height is the reach */
    uint32_t is_exact; /* no triangle is nearer */
    uint32_t
        is_proven; /* it is the lowest around, of its region or by dpti_profile_prove_deepest */
    uint32_t start_triangle;  /* the triangle that it began with */
    uint32_t has_depth_bound; /* `deep` is known */
    uint32_t has_span;        /* `span` is known */
    /* How deep it can be between here and the next sample, and where that was found. */
    struct depth_bound {
        double depth, s;
        uint32_t can_tighten; /* asking triangles may lower it */
        uint32_t reserved;
    } depth_bound;
    /* How far the surface is within reach between here and the next sample (contact_integrals.c). */
    struct span {
        double s;               /* of the bend */
        double w0, w, w1;       /* at the ends and there */
        double area;            /* over s, not over length */
        double error_estimate;  /* of it */
        uint32_t has_loose_end; /* the surface goes out of reach in it, one does not know where */
        uint32_t reserved;
    } span;
};

/* Where the axis goes through the surface. */
struct crossing {
    double s;
    double weight[3];
    uint32_t triangle;
    int32_t side_before,
        side_after; /* side of the axis there: +1 outside, -1 inside, 0 not known by this triangle */
};

#define SIDES_MAX 4

/* Sides of open sheets that are kept: +1 in front of the sheet's triangles, -1 behind. */
struct sides {
    uint32_t count;
    uint32_t part[SIDES_MAX];
    int32_t side[SIDES_MAX];
};

/* Of a part, or 0. */
int32_t dpti_sides_get(const struct sides *sides, uint32_t part);

/* The first one that is put stays; where there is no room, none is kept. */
void dpti_sides_put(struct sides *sides, uint32_t part, int32_t side);

struct distance_profile {
    const struct surface *surface;
    const struct kernel *kernel;
    const struct axis *axis;
    const struct sides *sides;
    struct point_cache *point_cache; /* NULL: without a budget */
    uint32_t body;                   /* slot, in the memo */
    uint32_t contacts_wanted;        /* they come after the depth, and no budget ends them */
    uint32_t is_coarse;              /* its regions are of fewer samples than they should be */
    double axis_length;              /* length of the axis */
    double reach;                    /* surface farther than that from the axis does not count */
    double tolerance;                /* of the depth */
    struct work work;                /* of this profile alone */
    uint32_t is_cut;                 /* that was not enough */
    uint32_t has_winding_parts;      /* the mesh has parts whose inside the winding number tells */
    uint32_t is_full;     /* more crossings than there is room for: what is known is not all */
    uint32_t is_sideless; /* it goes through an open sheet of which no side is kept */
    uint32_t crossing_count;
    uint32_t reach_interval_count;
    uint32_t sample_count;
    uint32_t
        unchanged_count; /* so many samples, with what is between, are as regions saw them last */
    uint32_t deepest;    /* the sample with the least height, exact */
    struct crossing crossing[PROFILE_CROSSINGS];
    int32_t sign[PROFILE_CROSSINGS + 1]; /* between crossings; 0: each sample has its own */
    double reach_from[PROFILE_REACH_INTERVALS],
        reach_to[PROFILE_REACH_INTERVALS]; /* of s: the surface may be within reach */
    struct profile_sample sample[PROFILE_SAMPLES];
};

static inline vec3 profile_point(const struct distance_profile *profile, double s)
{
    return along(profile->axis->local_a, s, profile->axis->u);
}

/* The square of how far x(s) is from the point of the mesh that is nearest to a sample; the sample's triangle is no farther. */
static inline double profile_square_distance(const struct distance_profile *profile,
                                             const struct profile_sample *sample, double s)
{
    vec3 offset = along(sample->gap, s - sample->s, profile->axis->u);
    return dot(offset, offset);
}

/* Between which crossings a place is: an index into `sign`. */
static inline uint32_t profile_stretch(const struct distance_profile *profile, double s)
{
    uint32_t k = 0;
    while (k < profile->crossing_count && profile->crossing[k].s < s)
        k++;
    return k;
}

/* The way out, at a crossing or a pair, by the triangle that it is on; zero where there is none. */
vec3 dpti_profile_exit_direction(const struct distance_profile *profile, uint32_t triangle,
                                 const double weight[3]);

/* How far a point of the axis is from a triangle: no less, and no more than rounding above it. */
double dpti_profile_distance_to(const struct distance_profile *profile, uint32_t triangle,
                                double s);

/* Sides may change without a crossing: each sample has its own. */
static inline int profile_has_side_per_sample(const struct distance_profile *profile)
{
    return profile->sides->count > 0 || profile->has_winding_parts;
}

/* By the winding number: 1 inside. A point outside of the box sees all of the mesh in one half of its view. */
int dpti_profile_is_inside(struct distance_profile *profile, double s);

/* Of a point of the axis whose nearest pair this is: +1 outside, -1 inside. */
int dpti_profile_side_of(struct distance_profile *profile, double s, uint32_t triangle,
                         const pair *found);

/* From a triangle near a point of the axis, by descent; `exact` by search. What is cached of it is not cleared: flags tell. */
void dpti_profile_take_sample(struct distance_profile *profile, double s, uint32_t triangle,
                              int by_search, struct profile_sample *sample);

/* In order of s; of two at one place the exact one, or the newer, stays. Returns its index, or DPT_NONE. */
uint32_t dpti_profile_put_sample(struct distance_profile *profile,
                                 const struct profile_sample *sample);

/* Is the triangle of a new sample nearer to the one at i than its own? Then that one begins there. */
int dpti_profile_share_triangle(struct distance_profile *profile, uint32_t i, uint32_t triangle);

/* One more sample, by a search or by descent from those beside it; its index, or DPT_NONE without room or work for it. */
uint32_t dpti_profile_add_sample(struct distance_profile *profile, double s, int by_search);

/* Outside: the nearest point of the axis from one place to another, if it is nearer than `reach`; else DPT_NONE. */
uint32_t dpti_profile_add_nearest(struct distance_profile *profile, double from, double to,
                                  double limit);

/* The lowest of the samples on a part, if it is inside or behind. */
const struct profile_sample *dpti_profile_lowest_on(const struct distance_profile *profile,
                                                    uint32_t part);

#endif
