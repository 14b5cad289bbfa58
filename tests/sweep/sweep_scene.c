/* SPDX-License-Identifier: BSD-3-Clause */
#include "sweep/sweep_scene.h"

static vec3 lattice_in(uint64_t *random, int reach)
{
    return (vec3){ whole_in(random, -reach, reach), whole_in(random, -reach, reach), whole_in(random, -reach, reach) };
}

void make_lattice(uint64_t *random, int kind, struct scene *scene)
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
        scene->corner[2] = along(scene->corner[0], whole_in(random, -1, 2), sub(scene->corner[1], scene->corner[0]));
}

void make_meeting(uint64_t *random, int kind, struct scene *scene)
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
        way = feature == MEET_FACE ? along(scaled(e, whole_in(random, -1, 1)), whole_in(random, -1, 1), f)
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

void make_grazing(uint64_t *random, int kind, struct scene *scene)
{
    make_meeting(random, kind, scene);
    double off = power_in(random, -17.0, -5.0), size = 1.0 / 64.0;
    vec3 *all[7] = { scene->corner,    scene->corner + 1, scene->corner + 2, &scene->motion.a,
                     &scene->motion.b, &scene->motion.da, &scene->motion.db };
    for (int i = 0; i < 7; i++)
        *all[i] = add(scaled(*all[i], size), scaled(any_in(random, 1.0), off));
}

void make_any(uint64_t *random, int kind, struct scene *scene)
{
    struct motion *m = &scene->motion;
    vec3 *v = scene->corner;
    for (int k = 0; k < 3; k++)
        v[k] = any_in(random, 1.0);
    *m = (struct motion){ any_in(random, 1.5), any_in(random, 1.5), any_in(random, 1.0), any_in(random, 1.0) };
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
        *m = (struct motion){ add(v[0], off), add(v[1], off), scaled(m->da, slow), scaled(m->db, slow) };
    }
    if (kind == DOT)
        m->b = m->a;
    double size = kind == FAR ? 1.0 : kind == TINY ? 1e-6 : 0.0;
    vec3 away = kind == FAR ? (vec3){ 1e6, -7e5, 3e5 } : (vec3){ 0.0, 0.0, 0.0 };
    if (size > 0.0) {
        for (int k = 0; k < 3; k++)
            v[k] = add(scaled(v[k], size), away);
        *m = (struct motion){ add(scaled(m->a, size), away), add(scaled(m->b, size), away), scaled(m->da, size),
                              scaled(m->db, size) };
    }
}

double scene_extent(const struct scene *scene)
{
    const struct motion *m = &scene->motion;
    double most = max_of(extent_of(m->a), extent_of(m->b));
    most = max_of(most, max_of(extent_of(add(m->a, m->da)), extent_of(add(m->b, m->db))));
    for (int k = 0; k < 3; k++)
        most = max_of(most, extent_of(scene->corner[k]));
    return most;
}

double scene_size(const struct scene *scene)
{
    const struct motion *m = &scene->motion;
    const vec3 all[6] = { m->a, m->b, add(m->a, m->da), add(m->b, m->db), scene->corner[1], scene->corner[2] };
    double most = 0.0;
    for (int k = 0; k < 6; k++)
        most = max_of(most, extent_of(sub(all[k], scene->corner[0])));
    return most;
}

const char *scene_text(const struct scene *scene)
{
    static char text[1200];
    const struct motion *m = &scene->motion;
    const vec3 all[7] = { m->a, m->b, m->da, m->db, scene->corner[0], scene->corner[1], scene->corner[2] };
    size_t length = 0;
    for (int i = 0; i < 7; i++)
        length += (size_t)snprintf(text + length, sizeof text - length, "%s{%a,%a,%a}", i ? ", " : "", all[i].x,
                                   all[i].y, all[i].z);
    return text;
}
