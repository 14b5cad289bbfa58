/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How far a body's surface is from each point of an axis: the signed distance along the tool, as few samples as tell
 * its least value within DEPTH_SHARE of the mesh's diagonal, and its shape near the surface.
 * docs/algorithms/depth.md, docs/algorithms/regions.md.
 */
#ifndef DPT_DISTANCE_PROFILE_H
#define DPT_DISTANCE_PROFILE_H

#include "contact/point_cache.h"
#include "nearest/dynamic_point.h"
#include "nearest/side.h"

/* The depth's own bound, of the mesh's diagonal. */
#define PROFILE_DEPTH_SHARE 1e-5

enum { PROFILE_SAMPLES = 96, PROFILE_CROSSINGS = 31, PROFILE_ZONES = 8, PROFILE_SEEDS = 48 };

/* A place on the axis and a triangle that was nearest there. */
struct seed {
    double s;
    uint32_t triangle;
    float share; /* of its region's overlap: what would be wrong with it */
};

/* What counts for more than this is searched for; descent does for the rest. */
#define PROFILE_SHARE 0.005

/* Work after which descent has to do, but for the depth's proof; integrals have half as much again where samples are cheap. */
#define PROFILE_WORK 1600

struct sample {
    double s;
    double height; /* signed distance to the triangle; the mesh's, if it is exact */
    vec3 normal;   /* unit, the way out: along it the height grows */
    double rise;   /* of the tangent: by how much the height grows over s, from 0 to 1 */
    vec3 gap;      /* x - q */
    double weight[3];
    uint32_t triangle; /* DPT_NONE: nothing is within reach here, height is the reach */
    uint32_t exact;    /* no triangle is nearer */
    uint32_t proven;   /* it is the lowest around, of its region or by profile_prove */
    uint32_t was;      /* the triangle that it began with */
    uint32_t bounded;  /* `deep` is known */
    uint32_t spanned;  /* `span` is known */
    /* How deep it can be between here and the next sample, and where that was found. */
    struct deep {
        double bound, s;
        uint32_t coarse; /* asking triangles may lower it */
        uint32_t reserved;
    } deep;
    /* How far the surface is within reach between here and the next sample (contact_integrals.c). */
    struct span {
        double s;         /* of the bend */
        double w0, w, w1; /* at the ends and there */
        double area;      /* over s, not over length */
        double doubt;     /* of it */
        uint32_t loose;   /* the surface goes out of reach in it, one does not know where */
        uint32_t reserved;
    } span;
};

/* Where the axis goes through the surface. */
struct crossing {
    double s;
    double weight[3];
    uint32_t triangle;
    int32_t before,
        after; /* side of the axis there: +1 outside, -1 inside, 0 not known by this triangle */
};

#define SIDES_MOST 4

/* Sides of open sheets that are kept: +1 in front of the sheet's triangles, -1 behind. */
struct sides {
    uint32_t count;
    uint32_t part[SIDES_MOST];
    int32_t side[SIDES_MOST];
};

/* Of a part, or 0. */
int32_t sides_get(const struct sides *sides, uint32_t part);

/* The first one that is put stays; where there is no room, none is kept. */
void sides_put(struct sides *sides, uint32_t part, int32_t side);

struct profile {
    const struct surface *surface;
    const struct kernel *kernel;
    const struct axis *axis;
    const struct sides *sides;
    struct memo *memo; /* NULL: without a budget */
    uint32_t body;     /* slot, in the memo */
    uint32_t regions;  /* they come after the depth, and no budget ends them */
    uint32_t coarse;   /* its regions are of fewer samples than they should be */
    double size;       /* length of the axis */
    double reach;      /* surface farther than that from the axis does not count */
    double tolerance;  /* of the depth */
    uint32_t work;     /* 16-lane blocks */
    uint32_t most;     /* and how many it may look at; UINT32_MAX: what it takes */
    uint32_t cut;      /* that was not enough */
    uint32_t winding;  /* the mesh has parts whose inside the winding number tells */
    uint32_t full;     /* more crossings than there is room for: what is known is not all */
    uint32_t sideless; /* it goes through an open sheet of which no side is kept */
    uint32_t crossings;
    uint32_t zones;
    uint32_t count;
    uint32_t same;    /* so many samples, with what is between, are as regions saw them last */
    uint32_t deepest; /* the sample with the least height, exact */
    struct crossing crossing[PROFILE_CROSSINGS];
    int32_t sign[PROFILE_CROSSINGS + 1]; /* between crossings; 0: each sample has its own */
    double zone_from[PROFILE_ZONES],
        zone_to[PROFILE_ZONES]; /* of s: the surface may be within reach */
    struct sample sample[PROFILE_SAMPLES];
};

static inline vec3 profile_point(const struct profile *profile, double s)
{
    return along(profile->axis->local_a, s, profile->axis->u);
}

/* The square of how far x(s) is from the point of the mesh that is nearest to a sample; the sample's triangle is no farther. */
static inline double profile_square_to(const struct profile *profile, const struct sample *sample,
                                       double s)
{
    vec3 way = along(sample->gap, s - sample->s, profile->axis->u);
    return dot(way, way);
}

/* Between which crossings a place is: an index into `sign`. */
static inline uint32_t profile_stretch(const struct profile *profile, double s)
{
    uint32_t k = 0;
    while (k < profile->crossings && profile->crossing[k].s < s)
        k++;
    return k;
}

static inline uint32_t profile_spare(const struct profile *profile)
{
    return profile->work < profile->most ? profile->most - profile->work : 0;
}

/* The way out, at a crossing or a pair, by the triangle that it is on; zero where there is none. */
vec3 profile_way_out(const struct profile *profile, uint32_t triangle, const double weight[3]);

/*
 * All crossings and zones, as far as there is work left for them, and whether the axis goes through an open sheet without a
 * side (crossings.c).
 */
void profile_cross(struct profile *profile);

/* How far a point of the axis is from a triangle: no less, and no more than rounding above it. */
double profile_reach(const struct profile *profile, uint32_t triangle, double s);

/* Sides may change without a crossing: each sample has its own. */
static inline int profile_by_sample(const struct profile *profile)
{
    return profile->sides->count > 0 || profile->winding;
}

/*
 * Make the profile of an axis. `nearest` is the axis' nearest pair with this body where that is known exactly, or
 * NULL. `seeds` are places of an earlier tick. Returns 0 when the axis is outside and nothing is within reach:
 * there is no contact then. Where it is cut, full or sideless, it may have no samples.
 *
 * First the caller sets tree, kernel, axis, sides, memo, regions, body, reach, tolerance and most.
 */
int profile_make(struct profile *profile, const struct nearest *nearest, const struct seed *seeds,
                 uint32_t seed_count);

/* One more sample, by a search or by descent from those beside it; its index, or DPT_NONE without room or work for it. */
uint32_t profile_ask(struct profile *profile, double s, int exact);

/*
 * From one place of the axis, inside, to another: split it until nothing can be deeper than the lowest sample by more than
 * the tolerance, and confirm that one by a search. Returns it, or DPT_NONE if there is no sample.
 */
uint32_t profile_prove(struct profile *profile, double from, double to);

/* Outside: the nearest point of the axis from one place to another, if it is nearer than `reach`; else DPT_NONE. */
uint32_t profile_approach(struct profile *profile, double from, double to, double reach);

/* Mark where the surface comes within reach and goes out of it, so that samples are wherever it is within. */
void profile_enclose(struct profile *profile);

/* Search between two samples for surface within reach that no sample tells of, where the axis is outside. */
void profile_look(struct profile *profile, double first, double last);

/* Outside, and within a zone: between sample i and the next there is a stretch of which the two do not tell. Which. */
int profile_is_blind(const struct profile *profile, uint32_t i, double *from, double *to);

/* What the profile is between two samples: the heights' two tangents meet at `s`, `height`. */
struct bend {
    double s, height;
};
struct bend profile_bend(const struct profile *profile, const struct sample *from,
                         const struct sample *to);

#endif
