/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Motions and triangles for the tests of the sweep, made to touch, to graze and to miss by little.
 */
#ifndef DPT_TESTS_SWEEP_SCENE_H
#define DPT_TESTS_SWEEP_SCENE_H

#include "lib/check.h"
#include "sweep/sweep_mesh.h"

struct scene {
    struct motion motion;
    vec3 corner[3];
};

static inline struct moving_triangle triangle_at_rest(const vec3 corner[3])
{
    return (struct moving_triangle){ .corner = { corner[0], corner[1], corner[2] } };
}

struct scene_family {
    const char *name;
    void (*make)(uint64_t *random, int kind, struct scene *scene);
    int kind;
};

static inline int one_in(uint64_t *random, unsigned n)
{
    return random_bits(random) % n == 0;
}

static inline double whole_in(uint64_t *random, int low, int high)
{
    return low + (double)(random_bits(random) % (unsigned)(high - low + 1));
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

static inline vec3 across_in(uint64_t *random, vec3 along_it)
{
    vec3 v = cross(along_it, any_in(random, 1.0));
    return scaled(v, 1.0 / max_of(length(v), 1e-300));
}

enum { LATTICE_ANY, LATTICE_FLAT, LATTICE_SHIFT, LATTICE_POINT, LATTICE_REST, LATTICE_NEEDLE };

/* Small whole numbers, of which exact touches are made. FLAT: all in one plane, moving in it. */
void make_lattice(uint64_t *random, int kind, struct scene *scene);

/*
 * Built around a time of k / 8 at which a point of the axis, j / 8 along it, lies on a corner, on
 * an edge or in the face. TANGENT: it moves along the edge or the face there, so that it may touch
 * for one instant. All numbers are exact in double.
 */
enum { MEET_CORNER, MEET_EDGE, MEET_FACE, MEET_END = 4, MEET_TANGENT = 8, MEET_PARALLEL = 16 };
void make_meeting(uint64_t *random, int kind, struct scene *scene);

/*
 * The same in numbers that are not exact, off by 1e-17 to 1e-5: so it touches, or misses by about
 * that.
 */
void make_grazing(uint64_t *random, int kind, struct scene *scene);

enum { ANY, SHIFT, SMALL, SPIN, SLIVER, SLIDE, BESIDE, DOT, FAR, TINY };
void make_any(uint64_t *random, int kind, struct scene *scene);

/* What the rounding of a sweep is a share of: the largest of all coordinates. */
double scene_extent(const struct scene *scene);

/* How far apart things are: what a tolerance is a share of. */
double scene_size(const struct scene *scene);

/* The usual one, or down to rounding. */
static inline double any_tolerance(uint64_t *random, const struct scene *scene)
{
    double share = one_in(random, 2) ? 1e-6 : power_in(random, -11.0, -6.0);
    return max_of(share * scene_size(scene), 0x1p-42 * scene_extent(scene));
}

/* As exact numbers, to paste. */
const char *scene_text(const struct scene *scene);

#define SCENE_MEETINGS(make)                                                                                           \
    { "corner", make, MEET_CORNER }, { "corner, end", make, MEET_CORNER | MEET_END }, { "edge", make, MEET_EDGE },     \
        { "edge, end", make, MEET_EDGE | MEET_END }, { "edge, tangent", make, MEET_EDGE | MEET_TANGENT },              \
        { "edge, parallel", make, MEET_EDGE | MEET_PARALLEL },                                                         \
        { "edge, both", make, MEET_EDGE | MEET_TANGENT | MEET_PARALLEL }, { "face, end", make, MEET_FACE | MEET_END }, \
        { "face, tangent", make, MEET_FACE | MEET_TANGENT },                                                           \
        { "face, end, tangent", make, MEET_FACE | MEET_END | MEET_TANGENT },                                           \
        { "face, parallel", make, MEET_FACE | MEET_PARALLEL },                                                         \
    {                                                                                                                  \
        "corner, parallel", make, MEET_CORNER | MEET_PARALLEL | MEET_TANGENT                                           \
    }

#endif
