/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The point cache: what searches found at single points of rigid bodies. Only worlds with a budget have one. A tool at
 * rest needs the same points in every tick, so a contact that is too much work for the budget of one tick is complete
 * after a few ticks (docs/algorithms/budget.md). What the cache does not hold is searched for.
 */
#ifndef DPT_PROFILE_SAMPLES_H
#define DPT_PROFILE_SAMPLES_H

#include "contact/winding_number.h"
#include "nearest/bvh.h"
#include "nearest/dynamic_point.h"
#include "nearest/nearest_pair.h"

/* Entries of a set. */
enum { POINT_CACHE_WAYS = 4 };

/* A point of a body and what is known of it. Coordinates must match exactly. */
struct cached_point {
    vec3 x;            /* in the body's frame */
    uint32_t body;     /* slot + 1; 0: the entry is empty */
    uint32_t triangle; /* place of the nearest triangle, or DPT_NONE: not known */
    uint32_t descent;  /* place of the triangle at which a descent ended, or DPT_NONE: not known */
    int32_t winding;   /* the winding number, rounded */
    uint32_t has_winding;
    uint32_t tick; /* in which it was last used */
};

struct point_cache {
    struct cached_point *entries; /* POINT_CACHE_WAYS a set, the newest first */
    uint32_t sets;                /* number of sets */
    uint32_t tick;                /* the current one */
    /* The search that the budget suspended last. */
    uint32_t body;     /* slot + 1; 0: there is none */
    uint32_t triangle; /* place of the nearest triangle so far */
    vec3 x;            /* in the body's frame */
    struct bvh_traversal traversal;
};

/* The entry of point x, in the frame of the body at slot `body`; NULL if there is none. */
const struct cached_point *dpti_point_cache_find(const struct point_cache *cache, uint32_t body, vec3 x);

/*
 * The entry of point x, for the caller to fill in. A new entry replaces the oldest of its set, unless the current tick
 * has used that one: otherwise a tick's last points would evict its first. Returns NULL then.
 */
struct cached_point *dpti_point_cache_put(const struct point_cache *cache, uint32_t body, vec3 x);

/*
 * Resume the suspended search if it was for x: *triangle gets the place of the nearest triangle so far, *traversal
 * where the search stopped. Returns 0 if there is none or it was for another point.
 */
int dpti_point_cache_resume(const struct point_cache *cache, uint32_t body, vec3 x, uint32_t *triangle,
                            struct bvh_traversal *traversal);

/* Store a search that the budget stopped, in place of the one stored before. */
void dpti_point_cache_suspend(struct point_cache *cache, uint32_t body, vec3 x, uint32_t triangle,
                              const struct bvh_traversal *traversal);

/* Forget all points of the body at a slot, or everything if `body` is DPT_NONE. Call it before a slot is reused. */
void dpti_point_cache_forget(struct point_cache *cache, uint32_t body);

/*
 * Samples of a distance profile: the signed distance of the surface at single points of the axis. A new sample shares
 * its triangle with its neighbours, which take it over if it is nearer than their own.
 */

/* The depth's tolerance, as a share of the mesh's diagonal. */
#define PROFILE_DEPTH_SHARE 1e-5

enum {
    PROFILE_SAMPLES = 96,
    PROFILE_CROSSINGS = 31,
    PROFILE_REACH_INTERVALS = 8,
    PROFILE_WINDING_RANGES = 16,
    PROFILE_WARM_STARTS = 48
};

/* A point of the axis at which a later tick takes a sample, and a triangle to start from. */
struct warm_start {
    double s;          /* 0..1 */
    uint32_t triangle; /* place; it was the nearest there */
    float share;       /* of its region's overlap that this sample decides */
};

/* A sample that decides on more than this share of the overlap is searched for. The others descend. */
#define PROFILE_SEARCH_SHARE 0.005

/*
 * Units of work after which samples for the integrals are no longer searched for, but descend. Half as many are added
 * where samples are cheap. The proof of the depth goes on.
 */
#define PROFILE_WORK_MAX 1600

/* How deep the axis can be between a sample and the next, m, and the place s at which to split the stretch. */
struct depth_bound {
    double depth, s;
    uint32_t can_tighten; /* distances to triangles may lower it */
    uint32_t reserved;
};

/* How far the surface is within reach between a sample and the next (contact_integrals.c). */
struct span {
    double s; /* of the bend */
    /* w = reach - height, m: at this sample, at the bend and at the next sample. */
    double w0, w, w1;
    double area;           /* integral of w over s, m */
    double error_estimate; /* of the area, m */
    /* The surface goes out of reach in this span, and the place is not known well enough. */
    uint32_t has_loose_end;
    uint32_t reserved;
};

/* One point of the axis. Or a mark, whose triangle is DPT_NONE: no triangle is within reach there. */
struct profile_sample {
    double s; /* 0..1 */
    /* Signed distance to the triangle, m; to the mesh, if is_exact. The reach, if this is a mark. */
    double height;
    vec3 normal;  /* the exit direction, unit, in the body's frame: the height grows along it */
    double slope; /* of the height: its derivative by s, m */
    vec3 gap;     /* x - q in the body's frame: from the triangle's nearest point to the axis' */
    double weight[3];
    uint32_t triangle;        /* place, or DPT_NONE */
    uint32_t is_exact;        /* no triangle is nearer */
    uint32_t is_proven;       /* it is the deepest point of a region or of a stretch, by proof */
    uint32_t start_triangle;  /* place of the triangle from which its descent or search started */
    uint32_t has_depth_bound; /* depth_bound is known */
    uint32_t has_span;        /* `span` is known */
    struct depth_bound depth_bound;
    struct span span;
};

/* A place where the axis goes through the surface. Sides: +1 outside, -1 inside, 0 not known from this triangle. */
struct crossing {
    double s; /* 0..1 */
    double weight[3];
    uint32_t triangle;   /* place */
    int32_t side_before; /* of the axis at smaller s */
    int32_t side_after;  /* at larger s */
    int32_t winding;     /* by how much the winding number grows here, along the axis */
    uint32_t is_counted; /* `winding` is known from this triangle */
};

/* In place of a winding number: each place of the stretch has its own. */
#define WINDING_UNKNOWN INT32_MIN

#define SIDES_MAX 4

/* Known sides of open sheets: the tool came from +1, in front of the sheet's triangles, or from -1, behind them. */
struct sides {
    uint32_t count;
    uint32_t part[SIDES_MAX];
    int32_t side[SIDES_MAX];
};

/* The known side of a part, or 0. */
int32_t dpti_sides_get(const struct sides *sides, uint32_t part);

/* Add the side of a part. Does nothing if one is known already, or if there is no room. */
void dpti_sides_put(struct sides *sides, uint32_t part, int32_t side);

/* A part of a stretch without a winding number that has one. */
struct winding_range {
    double from, to; /* s */
    int32_t winding;
    uint32_t reserved;
};

struct distance_profile {
    /* The caller sets these, and reach, tolerance and work. */
    const struct surface *surface;
    const struct kernel *kernel;
    const struct axis *axis;
    const struct sides *sides;
    struct point_cache *point_cache; /* NULL: without a budget */
    uint32_t body;                   /* slot; its key in the point cache */
    uint32_t contacts_wanted;        /* regions follow after the depth, and no budget ends them */
    uint32_t ends_wanted;            /* regions: also the depth at the axis' ends */
    uint32_t is_coarse;              /* the regions come from fewer samples than they should */
    double axis_length;              /* m */
    double reach;                    /* surface farther than that from the axis does not count, m */
    double margin;                   /* m, of the reach: beyond the tool's surface */
    double inset;                    /* m: overlaps count from so far within the reach */
    double tolerance;                /* of the depth, m */
    struct work work;                /* of this profile alone */
    uint32_t is_cut;                 /* the work was spent before the profile was complete */
    uint32_t has_winding_parts;      /* holes or sheets: a side may change without a crossing */
    uint32_t has_windings;           /* stretches have winding numbers: `winding`, `winding_range` */
    uint32_t is_full;                /* more than PROFILE_CROSSINGS crossings: some are missing */
    uint32_t is_sideless;            /* the axis crosses an open sheet whose side is not known */
    uint32_t crossing_count;
    uint32_t reach_interval_count;
    uint32_t sample_count;
    uint32_t unchanged_count;                    /* so many samples, from the first, are as at the last sum_spans */
    uint32_t deepest;                            /* index of the sample with the least height; it is exact */
    struct crossing crossing[PROFILE_CROSSINGS]; /* in order of s */
    /* Side of the axis before crossing k, after the last one for k = crossing_count; 0: each sample has its own. */
    int32_t sign[PROFILE_CROSSINGS + 1];
    int32_t winding[PROFILE_CROSSINGS + 1]; /* of the same stretches, rounded; or WINDING_UNKNOWN */
    uint32_t winding_range_count;
    struct winding_range winding_range[PROFILE_WINDING_RANGES];
    /* Stretches of the axis, in s, outside of which no surface is within reach. */
    double reach_from[PROFILE_REACH_INTERVALS];
    double reach_to[PROFILE_REACH_INTERVALS];
    struct profile_sample sample[PROFILE_SAMPLES]; /* in order of s */
};

/* The point of the axis at s, in the body's frame. */
static inline vec3 profile_point(const struct distance_profile *profile, double s)
{
    return along(profile->axis->local_a, s, profile->axis->u);
}

/*
 * The square of the distance from the axis at s to a sample's nearest point on the mesh, m^2. The sample's triangle is
 * no farther than that.
 */
static inline double profile_square_distance(const struct distance_profile *profile,
                                             const struct profile_sample *sample, double s)
{
    vec3 offset = along(sample->gap, s - sample->s, profile->axis->u);
    return dot(offset, offset);
}

/* m: the axis at s is no nearer to a sample's triangle. That distance is convex along the axis, so above its tangent. */
static inline double profile_tangent_distance(const struct profile_sample *sample, double s)
{
    const double tangent = sample->height + sample->slope * (s - sample->s);
    return sample->height < 0.0 ? -tangent : tangent;
}

/* The stretch between crossings that holds s: an index into `sign`. */
static inline uint32_t profile_stretch(const struct distance_profile *profile, double s)
{
    uint32_t k = 0;
    while (k < profile->crossing_count && profile->crossing[k].s < s)
        k++;
    return k;
}

/*
 * The exit direction at a point of the surface: the normal of its face, edge or vertex, turned to the known side. Unit,
 * in the body's frame; zero on a part that has neither an inside nor a known side.
 *
 *   triangle  place; `weight` of its corners, at the point
 */
vec3 dpti_profile_exit_direction(const struct distance_profile *profile, uint32_t triangle, const double weight[3]);

/* The distance of the axis at s to a triangle, a place, m: never below the true one, and above it by rounding alone. */
double dpti_profile_distance_to(const struct distance_profile *profile, uint32_t triangle, double s);

/* 1: the side may change without a crossing, so each sample determines its own. */
static inline int profile_has_side_per_sample(const struct distance_profile *profile)
{
    return profile->sides->count > 0 || profile->has_winding_parts;
}

/*
 * The winding number at s, rounded; 0 outside of the mesh's box. If the work is spent, the profile is cut and the answer
 * does not count.
 */
int32_t dpti_profile_winding(struct distance_profile *profile, double s);

/* 1: the axis at s is inside, by the winding number: that of its stretch, or of the place itself. */
int dpti_profile_is_inside(struct distance_profile *profile, double s);

/* The side of the axis at s: +1 outside, -1 inside. `found` is the nearest pair there, with `triangle`, a place. */
int dpti_profile_side_of(struct distance_profile *profile, double s, uint32_t triangle, const pair *found);

/*
 * Take a sample of the axis at s, without putting it into the profile.
 *
 *   triangle   place from which to start; near by, if possible
 *   by_search  1: search for the nearest triangle; 0: descend to a nearer one
 *   sample     gets everything but depth_bound and span: their flags are cleared
 *
 * If the work is spent, the profile is cut, and the sample's triangle may not be the nearest.
 */
void dpti_profile_take_sample(struct distance_profile *profile, double s, uint32_t triangle, int by_search,
                              struct profile_sample *sample);

/*
 * Put a sample into the profile, in order of s. Of two samples at one place the exact one stays, or the newer one. If
 * there is no room, a sample between two others with its own triangle is dropped. Returns the index, or DPT_NONE: no
 * room.
 */
uint32_t dpti_profile_put_sample(struct distance_profile *profile, const struct profile_sample *sample);

/*
 * Offer another sample's triangle to sample i. If it is nearer than the sample's own, the sample is taken again, by
 * descent from there. Returns 1 if it was.
 */
int dpti_profile_share_triangle(struct distance_profile *profile, uint32_t i, const struct profile_sample *other);

/*
 * Add a sample at s, by a search or by descent from a neighbour's triangle, and share its triangle with its neighbours.
 * Returns its index, or DPT_NONE if there was no room or no work left.
 */
uint32_t dpti_profile_add_sample(struct distance_profile *profile, double s, int by_search);

/*
 * Search for the point of the axis between two places, s in 0..1, that is nearest to the surface, and add a sample
 * there. The axis must be outside between them. Returns the sample's index, or DPT_NONE if no surface is nearer than
 * `limit`, in m, or the work was spent.
 */
uint32_t dpti_profile_add_nearest(struct distance_profile *profile, double from, double to, double limit);

/* The sample with the least height on a part, if it is inside or behind; NULL otherwise. */
const struct profile_sample *dpti_profile_lowest_on(const struct distance_profile *profile, uint32_t part);

#endif
