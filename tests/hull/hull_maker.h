/* SPDX-License-Identifier: BSD-3-Clause */
/* Hulls for tests: points of many kinds, what the library makes of them, and where they are. */
#ifndef DPT_TESTS_HULL_MAKER_H
#define DPT_TESTS_HULL_MAKER_H

#include "hull/hull_state.h"
#include "lib/check.h"
#include "oracle/hull.h"
#include "oracle/hull_distance.h"

enum {
    CLOUD_CUBE,      /* anywhere in a cube */
    CLOUD_SPHERE,    /* on a sphere: all are corners */
    CLOUD_LATTICE,   /* small whole numbers: many in one plane, on one line or in one place, exactly */
    CLOUD_STRETCHED, /* a cube that is long or flat, by up to 1000 */
    CLOUD_INSIDE,    /* a few corners, and the rest inside of their hull, on its faces and its edges */
    CLOUD_REPEATED,  /* every point several times */
    CLOUD_POLYGON,   /* flat, in a plane of two axes */
    CLOUD_BOX,
    CLOUD_WEDGE,
    CLOUD_CYLINDER,
    CLOUD_CONE,
    CLOUDS
};

extern const char *const cloud_names[CLOUDS];

struct made_hull {
    double point[3 * DPT_HULL_CORNERS_MAX];
    uint32_t count;
    double size, extent; /* m: the diagonal of its box, and its largest coordinate */
    uint64_t block[2048];
    const dpt_hull *hull;
    struct oracle_hull as; /* as it tells */
};

/* Points of a kind, about 1 m in size, about the origin. count 0: any number of them. */
void cloud_points(uint64_t *random, int kind, uint32_t count, struct made_hull *made);

/* The same larger by a factor and elsewhere. */
void cloud_place(struct made_hull *made, double factor, const double offset[3]);

/* Make a hull of the points, with guards behind its block. What went wrong otherwise is a failed check. */
dpt_result make_hull(struct made_hull *made, double radius);

/* A hull of any kind that is valid, with any number of corners, of this size. */
void make_any_hull(uint64_t *random, double size, struct made_hull *made);

/* The points as text, exact, to paste. */
const char *points_text(const double *points, uint32_t count);

static inline int one_in(uint64_t *random, unsigned n)
{
    return random_bits(random) % n == 0;
}

static inline uint32_t whole_in(uint64_t *random, uint32_t low, uint32_t high)
{
    return low + (uint32_t)(random_bits(random) % (high - low + 1));
}

static inline double power_in(uint64_t *random, double low, double high)
{
    return pow(10.0, random_in(random, low, high));
}

static inline vec3 any_in(uint64_t *random, double reach)
{
    return (vec3){ random_in(random, -reach, reach), random_in(random, -reach, reach),
                   random_in(random, -reach, reach) };
}

static inline vec3 any_unit(uint64_t *random)
{
    vec3 v;
    do {
        v = any_in(random, 1.0);
    } while (!(dot(v, v) > 0.01 && dot(v, v) < 1.0));
    return unit_of(v);
}

/* A turn by an angle about an axis. */
static inline void pose_turn(vec3 axis, double angle, dpt_pose *pose)
{
    pose->orientation[0] = cos(0.5 * angle);
    vec3_store(scaled(axis, sin(0.5 * angle)), pose->orientation + 1);
}

dpt_pose any_pose(uint64_t *random, double reach);

#endif
