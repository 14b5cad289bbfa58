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

static inline vec3 lattice_in(uint64_t *random, int reach)
{
    return (vec3){ whole_in(random, -reach, reach), whole_in(random, -reach, reach),
                   whole_in(random, -reach, reach) };
}

static inline vec3 across_in(uint64_t *random, vec3 along_it)
{
    vec3 v = cross(along_it, any_in(random, 1.0));
    return scaled(v, 1.0 / max_of(length(v), 1e-300));
}

enum { LATTICE_ANY, LATTICE_FLAT, LATTICE_SHIFT, LATTICE_POINT, LATTICE_REST, LATTICE_NEEDLE };

/* Small whole numbers, of which exact touches are made. FLAT: all in one plane, moving in it. */
static inline void make_lattice(uint64_t *random, int kind, struct scene *scene)
{
    vec3 *all[7] = { scene->corner,    scene->corner + 1, scene->corner + 2, &scene->motion.a,
                     &scene->motion.b, &scene->motion.da, &scene->motion.db };
    int reach = 2 + (int)(random_bits(random) % 6);
    for (int i = 0; i < 7; i++)
        *all[i] = lattice_in(random, reach);
    if (kind == LATTICE_FLAT)
        for (int i = 0; i < 7; i++)
            all[i]->z = all[i]->x - all[i]->y;
    if (kind == LATTICE_SHIFT)
        scene->motion.db = scene->motion.da;
    if (kind == LATTICE_POINT)
        scene->motion.b = scene->motion.a;
    if (kind == LATTICE_POINT && one_in(random, 2))
        scene->motion.db = scene->motion.da;
    if (kind == LATTICE_REST)
        scene->motion.da = scene->motion.db = (vec3){ 0.0, 0.0, 0.0 };
    if (kind == LATTICE_NEEDLE)
        scene->corner[2] = along(scene->corner[0], whole_in(random, -1, 2),
                                 sub(scene->corner[1], scene->corner[0]));
}

/*
 * Built around a time of k / 8 at which a point of the axis, j / 8 along it, lies on a corner, on
 * an edge or in the face. TANGENT: it moves along the edge or the face there, so that it may touch
 * for one instant. All numbers are exact in double.
 */
enum { MEET_CORNER, MEET_EDGE, MEET_FACE, MEET_END = 4, MEET_TANGENT = 8, MEET_PARALLEL = 16 };
static inline void make_meeting(uint64_t *random, int kind, struct scene *scene)
{
    vec3 *v = scene->corner;
    for (int k = 0; k < 3; k++)
        v[k] = scaled(lattice_in(random, 4), 8.0);
    vec3 e = sub(v[1], v[0]), f = sub(v[2], v[0]), at = v[0];
    int feature = kind & 3;
    if (feature != MEET_CORNER)
        at = along(at, whole_in(random, 1, 7) / 8.0, e);
    if (feature == MEET_FACE)
        at = along(at, whole_in(random, 0, 2) / 8.0, f);
    vec3 u = scaled(lattice_in(random, 4), 8.0), way = scaled(lattice_in(random, 4), 8.0);
    vec3 turn = scaled(lattice_in(random, 4), 8.0);
    if (kind & MEET_PARALLEL)
        u = scaled(e, whole_in(random, -2, 2));
    if (kind & MEET_TANGENT)
        way = feature == MEET_FACE
                  ? along(scaled(e, whole_in(random, -1, 1)), whole_in(random, -1, 1), f)
                  : scaled(along(e, whole_in(random, -1, 1), u), whole_in(random, -1, 1));
    if (one_in(random, 3))
        turn = (vec3){ 0.0, 0.0, 0.0 };
    double t = whole_in(random, 0, 8) / 8.0;
    double s = kind & MEET_END ? whole_in(random, 0, 1) : whole_in(random, 0, 8) / 8.0;
    scene->motion.da = along(way, -s, turn);
    scene->motion.db = along(way, 1.0 - s, turn);
    scene->motion.a = along(along(at, -s, u), -t, scene->motion.da);
    scene->motion.b = along(along(at, 1.0 - s, u), -t, scene->motion.db);
}

/*
 * The same in numbers that are not exact, off by 1e-17 to 1e-5: so it touches, or misses by about
 * that.
 */
static inline void make_grazing(uint64_t *random, int kind, struct scene *scene)
{
    make_meeting(random, kind, scene);
    double off = power_in(random, -17.0, -5.0), size = 1.0 / 64.0;
    vec3 *all[7] = { scene->corner,    scene->corner + 1, scene->corner + 2, &scene->motion.a,
                     &scene->motion.b, &scene->motion.da, &scene->motion.db };
    for (int i = 0; i < 7; i++)
        *all[i] = add(scaled(*all[i], size), scaled(any_in(random, 1.0), off));
}

enum { ANY, SHIFT, SMALL, SPIN, SLIVER, SLIDE, BESIDE, DOT, FAR, TINY };
static inline void make_any(uint64_t *random, int kind, struct scene *scene)
{
    struct motion *m = &scene->motion;
    vec3 *v = scene->corner;
    for (int k = 0; k < 3; k++)
        v[k] = any_in(random, 1.0);
    *m = (struct motion){ any_in(random, 1.5), any_in(random, 1.5), any_in(random, 1.0),
                          any_in(random, 1.0) };
    if (kind == SHIFT)
        m->db = m->da;
    for (int k = 0; kind == SMALL && k < 3; k++)
        v[k] = scaled(v[k], 0.01);
    if (kind == SPIN)
        m->db = scaled(m->da, -1.0);
    if (kind == SLIVER)
        v[2] = add(along(v[0], random_in(random, 0.0, 1.0), sub(v[1], v[0])),
                   scaled(any_in(random, 1.0), power_in(random, -15.0, -2.0)));
    if (kind == SLIDE) { /* over the face, from above to below its edges or not at all */
        double height = power_in(random, -7.0, -2.0), lean = one_in(random, 2) ? 3.0 * height : 0.0;
        for (int k = 0; k < 3; k++)
            v[k].z = 0.0;
        m->a.z = m->b.z = height;
        m->da.z = random_in(random, -lean, lean);
        m->db.z = random_in(random, -lean, lean);
    }
    if (kind == BESIDE) { /* along an edge */
        vec3 off = scaled(any_in(random, 1.0), power_in(random, -7.0, -1.0));
        double slow = power_in(random, -5.0, 0.0);
        *m = (struct motion){ add(v[0], off), add(v[1], off), scaled(m->da, slow),
                              scaled(m->db, slow) };
    }
    if (kind == DOT)
        m->b = m->a;
    double size = kind == FAR ? 1.0 : kind == TINY ? 1e-6 : 0.0;
    vec3 away = kind == FAR ? (vec3){ 1e6, -7e5, 3e5 } : (vec3){ 0.0, 0.0, 0.0 };
    if (size > 0.0) {
        for (int k = 0; k < 3; k++)
            v[k] = add(scaled(v[k], size), away);
        *m = (struct motion){ add(scaled(m->a, size), away), add(scaled(m->b, size), away),
                              scaled(m->da, size), scaled(m->db, size) };
    }
}

/* What the rounding of a sweep is a share of: the largest of all coordinates. */
static inline double scene_extent(const struct scene *scene)
{
    const struct motion *m = &scene->motion;
    double most = max_of(extent_of(m->a), extent_of(m->b));
    most = max_of(most, max_of(extent_of(add(m->a, m->da)), extent_of(add(m->b, m->db))));
    for (int k = 0; k < 3; k++)
        most = max_of(most, extent_of(scene->corner[k]));
    return most;
}

/* How far apart things are: what a tolerance is a share of. */
static inline double scene_size(const struct scene *scene)
{
    const struct motion *m = &scene->motion;
    const vec3 all[6] = {
        m->a, m->b, add(m->a, m->da), add(m->b, m->db), scene->corner[1], scene->corner[2]
    };
    double most = 0.0;
    for (int k = 0; k < 6; k++)
        most = max_of(most, extent_of(sub(all[k], scene->corner[0])));
    return most;
}

/* The usual one, or down to rounding. */
static inline double any_tolerance(uint64_t *random, const struct scene *scene)
{
    double share = one_in(random, 2) ? 1e-6 : power_in(random, -11.0, -6.0);
    return max_of(share * scene_size(scene), 0x1p-42 * scene_extent(scene));
}

/* As exact numbers, to paste. */
static inline const char *scene_text(const struct scene *scene)
{
    static char text[1200];
    const struct motion *m = &scene->motion;
    const vec3 all[7] = {
        m->a, m->b, m->da, m->db, scene->corner[0], scene->corner[1], scene->corner[2]
    };
    size_t length = 0;
    for (int i = 0; i < 7; i++)
        length += (size_t)snprintf(text + length, sizeof text - length, "%s{%a,%a,%a}",
                                   i ? ", " : "", all[i].x, all[i].y, all[i].z);
    return text;
}

#define SCENE_MEETINGS(make)                                                                       \
    { "corner", make, MEET_CORNER }, { "corner, end", make, MEET_CORNER | MEET_END },              \
        { "edge", make, MEET_EDGE }, { "edge, end", make, MEET_EDGE | MEET_END },                  \
        { "edge, tangent", make, MEET_EDGE | MEET_TANGENT },                                       \
        { "edge, parallel", make, MEET_EDGE | MEET_PARALLEL },                                     \
        { "edge, both", make, MEET_EDGE | MEET_TANGENT | MEET_PARALLEL },                          \
        { "face, end", make, MEET_FACE | MEET_END },                                               \
        { "face, tangent", make, MEET_FACE | MEET_TANGENT },                                       \
        { "face, end, tangent", make, MEET_FACE | MEET_END | MEET_TANGENT },                       \
        { "face, parallel", make, MEET_FACE | MEET_PARALLEL },                                     \
    {                                                                                              \
        "corner, parallel", make, MEET_CORNER | MEET_PARALLEL | MEET_TANGENT                       \
    }

#endif
