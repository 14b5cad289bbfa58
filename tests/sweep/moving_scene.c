/* SPDX-License-Identifier: BSD-3-Clause */
#include "sweep/moving_scene.h"

static vec3 whole_vector(uint64_t *random, int reach)
{
    return (vec3){ whole_in(random, -reach, reach), whole_in(random, -reach, reach), whole_in(random, -reach, reach) };
}

void make_moving_lattice(uint64_t *random, int kind, struct moving_scene *scene)
{
    struct motion *m = &scene->motion;
    vec3 *v = scene->corner, *d = scene->shift;
    vec3 *all[10] = { v, v + 1, v + 2, &m->a, &m->b, &m->da, &m->db, d, d + 1, d + 2 };
    int reach = 2 + (int)(random_bits(random) % 6);
    for (int i = 0; i < 10; i++)
        *all[i] = whole_vector(random, i == 3 || i == 4 ? 2 * reach : reach);
    for (int i = 0; kind == MOVING_FLAT && i < 10; i++)
        all[i]->z = all[i]->x - all[i]->y;
    if (kind == MOVING_FLAT && one_in(random, 2))
        for (int i = 5; i < 10; i++)
            *all[i] = add(*all[i], (vec3){ 1.0, -1.0, 2.0 });
    if (kind == MOVING_POINT)
        m->b = m->a;
    if (kind == MOVING_POINT && one_in(random, 2))
        m->db = m->da;
    if (kind == MOVING_NEEDLE)
        v[2] = along(v[0], whole_in(random, -1, 2), sub(v[1], v[0]));
    if (kind == MOVING_TOGETHER || kind == MOVING_EQUAL)
        d[1] = d[2] = d[0];
    if (kind == MOVING_EQUAL)
        m->da = m->db = d[0];
    scene->radius = one_in(random, 2) ? 0.0 : whole_in(random, 1, 3);
}

static vec3 point_of(const vec3 v[3], const double weight[3])
{
    return along(along(scaled(v[0], weight[0]), weight[1], v[1]), weight[2], v[2]);
}

/* What was made for a time is taken back to time 0. */
static void rewind_to_start(struct moving_scene *scene, double time)
{
    struct motion *m = &scene->motion;
    m->a = along(m->a, -time, m->da);
    m->b = along(m->b, -time, m->db);
    for (int k = 0; k < 3; k++)
        scene->corner[k] = along(scene->corner[k], -time, scene->shift[k]);
}

/* How the segment's point moves over the triangle's. */
static vec3 instant_way(uint64_t *random, int kind, const vec3 v[3], vec3 u)
{
    vec3 e = sub(v[1], v[0]), f = sub(v[2], v[0]);
    double i = whole_in(random, -1, 1), j = whole_in(random, -1, 1);
    if (!(kind & MEET_TANGENT))
        return scaled(whole_vector(random, 4), 8.0);
    return along(scaled(e, i), j, (kind & 3) == MEET_FACE ? f : u);
}

void make_moving_instant(uint64_t *random, int kind, struct moving_scene *scene)
{
    vec3 *v = scene->corner, turn = scaled(whole_vector(random, 4), 8.0);
    double weight[3] = { 1.0, 0.0, 0.0 };
    for (int k = 0; k < 3; k++) {
        v[k] = scaled(whole_vector(random, 4), 8.0);
        scene->shift[k] = scaled(whole_vector(random, 4), 8.0);
    }
    if ((kind & 3) != MEET_CORNER)
        weight[1] = whole_in(random, 1, 5) / 8.0;
    if ((kind & 3) == MEET_FACE)
        weight[2] = whole_in(random, 1, 3) / 8.0;
    weight[0] -= weight[1] + weight[2];
    vec3 u =
        kind & MEET_PARALLEL ? scaled(sub(v[1], v[0]), whole_in(random, -2, 2)) : scaled(whole_vector(random, 4), 8.0);
    double s = kind & MEET_END ? whole_in(random, 0, 1) : whole_in(random, 0, 8) / 8.0;
    vec3 at = point_of(v, weight);
    vec3 way = add(point_of(scene->shift, weight), instant_way(random, kind, v, u));
    scene->motion.a = along(at, -s, u);
    scene->motion.b = along(at, 1.0 - s, u);
    scene->motion.da = along(way, -s, turn);
    scene->motion.db = along(way, 1.0 - s, turn);
    scene->radius = 0.0;
    rewind_to_start(scene, whole_in(random, 0, 8) / 8.0);
}

static double any_way(uint64_t *random)
{
    static const double ways[] = { 1e-4, 1e-3, 1e-2, 1.0 };
    return ways[random_bits(random) % 4] * random_in(random, 0.3, 1.0);
}

static double any_side(uint64_t *random)
{
    return power_in(random, -3.0, -1.3);
}

static void any_shifts(uint64_t *random, struct moving_scene *scene)
{
    double way = any_way(random);
    scene->motion.da = any_in(random, way);
    scene->motion.db = one_in(random, 2) ? scene->motion.da : any_in(random, way);
    way = any_way(random);
    for (int k = 0; k < 3; k++)
        scene->shift[k] = any_in(random, way);
}

static double any_radius(uint64_t *random)
{
    return one_in(random, 2) ? 0.0 : power_in(random, -4.0, -2.3);
}

/* By how much a touch is missed, or is more than a touch. */
static double any_gap(uint64_t *random, double size)
{
    return size * power_in(random, -9.0, -3.0) * (one_in(random, 2) ? 1.0 : -1.0);
}

/* A direction from the triangle to the segment, at right angles to what touches; u is turned out of the triangle. */
static vec3 apart_from(uint64_t *random, int kind, const vec3 v[3], double s, vec3 *u)
{
    vec3 e = unit_of(sub(v[1], v[0])), f = sub(v[2], v[0]), n = unit_of(cross(e, f));
    if ((kind & 3) == MEET_FACE) {
        if (!(kind & MEET_END))
            *u = along(*u, -dot(*u, n), n);
        if ((s - 0.5) * dot(*u, n) > 0.0)
            *u = scaled(*u, -1.0);
        return n;
    }
    if ((kind & 3) == MEET_CORNER) {
        vec3 back = sub(scaled(v[0], 2.0), add(v[1], v[2]));
        return unit_of(along(back, -dot(back, *u) / max_of(dot(*u, *u), 1e-300), *u));
    }
    n = kind & MEET_PARALLEL ? across_in(random, e) : unit_of(cross(*u, e));
    return dot(n, f) > 0.0 ? scaled(n, -1.0) : n;
}

void make_moving_meeting(uint64_t *random, int kind, struct moving_scene *scene)
{
    struct motion *m = &scene->motion;
    vec3 *v = scene->corner, place = any_in(random, 1.0);
    double size = any_side(random), weight[3] = { 1.0, 0.0, 0.0 };
    for (int k = 0; k < 3; k++)
        v[k] = any_in(random, size);
    if ((kind & 3) != MEET_CORNER)
        weight[1] = random_in(random, 0.05, 0.6);
    if ((kind & 3) == MEET_FACE)
        weight[2] = random_in(random, 0.05, 0.35);
    weight[0] -= weight[1] + weight[2];
    vec3 u = kind & MEET_PARALLEL ? sub(v[1], v[0]) : any_in(random, 1.0);
    u = scaled(u, power_in(random, -3.0, -0.5) / max_of(length(u), 1e-300));
    double s = kind & MEET_END ? whole_in(random, 0, 1) : random_in(random, 0.1, 0.9);
    vec3 n = apart_from(random, kind, v, s, &u);
    any_shifts(random, scene);
    vec3 fall = sub(along(scaled(m->da, 1.0 - s), s, m->db), point_of(scene->shift, weight));
    scene->radius = any_radius(random);
    double off = scene->radius;
    if (kind & MEET_TANGENT) {
        m->da = along(m->da, -dot(fall, n), n);
        m->db = along(m->db, -dot(fall, n), n);
        off += any_gap(random, size);
    }
    for (int k = 0; k < 3; k++)
        v[k] = add(v[k], place);
    vec3 at = along(point_of(v, weight), off, n);
    m->a = along(at, -s, u);
    m->b = along(at, 1.0 - s, u);
    rewind_to_start(scene, random_in(random, 0.0, 1.0));
}

/* A segment through a point, or by it. */
static void put_segment(uint64_t *random, struct moving_scene *scene, vec3 at, vec3 direction)
{
    vec3 u = scaled(direction, power_in(random, -3.0, -0.8));
    double s = random_in(random, -0.1, 1.1);
    scene->motion.a = along(at, -s, u);
    scene->motion.b = along(at, 1.0 - s, u);
}

/* At right angles to a direction, so that nothing of it is nearer than `off` to the point. */
static void put_across(uint64_t *random, struct moving_scene *scene, vec3 at, double off, vec3 direction)
{
    vec3 n = unit_of(direction);
    put_segment(random, scene, along(at, off, n), across_in(random, n));
}

static void turn(uint64_t *random, int fixed, double size, struct moving_scene *scene)
{
    vec3 *v = scene->corner, *d = scene->shift;
    double fast = any_way(random), slow = one_in(random, 2) ? 0.0 : any_way(random) * 0.01;
    vec3 spin = fixed == 1 ? any_in(random, 1.0) : sub(v[1], v[0]);
    vec3 drift = any_in(random, slow);
    for (int k = 0; k < 3; k++) {
        vec3 way = k < fixed ? (vec3){ 0.0, 0.0, 0.0 } : cross(spin, sub(v[k], v[0]));
        d[k] = along(drift, fast / max_of(length(way), 1e-300), way);
    }
    vec3 hinge = fixed == 1 ? v[0] : along(v[0], random_in(random, 0.0, 1.0), sub(v[1], v[0]));
    vec3 side = fixed == 1 ? any_in(random, 1.0) : across_in(random, spin);
    put_across(random, scene, hinge, scene->radius + size * power_in(random, -9.0, 0.0), side);
    scene->motion.da = any_in(random, slow);
    scene->motion.db = any_in(random, slow);
}

/* The triangle's own motion takes its area to 0 and through it. */
static void collapse(uint64_t *random, int kind, double size, struct moving_scene *scene)
{
    vec3 *v = scene->corner, *d = scene->shift;
    vec3 middle = scaled(add(add(v[0], v[1]), v[2]), 1.0 / 3.0);
    vec3 e = sub(v[1], v[0]), onto = along(v[0], random_in(random, 0.0, 1.0), e);
    double share = random_in(random, 0.8, 3.0);
    for (int k = 0; kind == SHRINK && k < 3; k++)
        d[k] = along(scaled(sub(middle, v[k]), share), one_in(random, 2) ? 1e-9 : 0.0, d[k]);
    if (kind == INVERT) {
        d[0] = d[1] = any_in(random, any_way(random) * 0.1);
        d[2] = add(d[0], scaled(sub(onto, v[2]), share));
    }
    double off = size * power_in(random, -6.0, 0.3);
    vec3 to = kind == SHRINK ? middle : onto, way = sub(to, v[kind == SHRINK ? 0 : 2]);
    if (kind == SHRINK) /* at half its length an edge is, and at twice the corner will be */
        off = length(way) * random_in(random, 0.3, 2.2);
    put_across(random, scene, to, scene->radius + off, way);
}

static void put_in_plane(uint64_t *random, struct moving_scene *scene)
{
    struct motion *m = &scene->motion;
    vec3 *v = scene->corner, *d = scene->shift;
    if (one_in(random, 2)) { /* in parallel with an edge, for good */
        v[1].y = v[0].y;
        m->b.y = m->a.y;
        m->db = m->da;
        d[1] = d[0];
    }
    vec3 *all[10] = { v, v + 1, v + 2, &m->a, &m->b, &m->da, &m->db, d, d + 1, d + 2 };
    double lift = one_in(random, 2) ? 0.0 : any_way(random);
    for (int i = 0; i < 10; i++)
        all[i]->z = i < 5 ? 0.25 : lift;
    if (one_in(random, 3))
        m->a.z = m->b.z = 0.25 + scene->radius + fabs(any_gap(random, 0.01));
}

static void move_together(uint64_t *random, double size, struct moving_scene *scene)
{
    double loose = one_in(random, 2) ? 0.0 : power_in(random, -12.0, -5.0);
    vec3 way = any_in(random, any_way(random));
    vec3 *all[5] = { &scene->motion.da, &scene->motion.db, scene->shift, scene->shift + 1, scene->shift + 2 };
    for (int i = 0; i < 5; i++)
        *all[i] = add(way, any_in(random, loose));
    vec3 *v = scene->corner;
    put_across(random, scene, v[0], scene->radius + fabs(any_gap(random, size)),
               sub(scaled(v[0], 2.0), add(v[1], v[2])));
}

/* The triangle goes along x, in a plane z; its highest y is that of a corner, and the segment is beside it. */
static void go_by(uint64_t *random, double size, struct moving_scene *scene)
{
    struct motion *m = &scene->motion;
    vec3 *v = scene->corner, *d = scene->shift;
    for (int k = 1; k < 3; k++) {
        vec3 e = sub(v[k], v[0]);
        v[k] = add(v[0], (vec3){ e.x, -fabs(e.y), 0.0 });
    }
    for (int k = 0; k < 3; k++)
        d[k] = (vec3){ d[0].x, 0.0, 0.0 };
    vec3 at = add(v[0], (vec3){ 0.0, scene->radius + any_gap(random, size), 0.0 });
    vec3 u = { random_in(random, -1.0, 1.0), 0.0, one_in(random, 3) ? 0.0 : 1.0 };
    m->a = along(at, random_in(random, -0.2, 0.01), u);
    m->b = along(at, random_in(random, 0.001, 0.2), u);
    m->da = m->db = scaled(u, one_in(random, 2) ? 0.0 : random_in(random, -0.01, 0.01));
    rewind_to_start(scene, random_in(random, 0.1, 0.9));
}

static void move_away(struct moving_scene *scene)
{
    const vec3 far = { 1000.0, -700.0, 300.0 };
    scene->motion.a = add(scene->motion.a, far);
    scene->motion.b = add(scene->motion.b, far);
    for (int k = 0; k < 3; k++)
        scene->corner[k] = add(scene->corner[k], far);
}

void make_moving_any(uint64_t *random, int kind, struct moving_scene *scene)
{
    double size = any_side(random);
    vec3 *v = scene->corner, place = any_in(random, 1.0);
    for (int k = 0; k < 3; k++)
        v[k] = add(place, any_in(random, size));
    scene->radius = any_radius(random);
    any_shifts(random, scene);
    if (kind == NEEDLES)
        v[2] = add(along(v[0], random_in(random, 0.0, 1.0), sub(v[1], v[0])),
                   any_in(random, size * power_in(random, -15.0, -2.0)));
    put_segment(random, scene, along(v[0], random_in(random, -0.5, 1.5), sub(v[2], v[0])), any_in(random, 1.0));
    if (kind == TURN_CORNER || kind == TURN_EDGE)
        turn(random, kind == TURN_CORNER ? 1 : 2, size, scene);
    else if (kind == INVERT || kind == SHRINK)
        collapse(random, kind, size, scene);
    else if (kind == IN_PLANE)
        put_in_plane(random, scene);
    else if (kind == TOGETHER)
        move_together(random, size, scene);
    else if (kind == EDGE_ON)
        go_by(random, size, scene);
    if (kind != INVERT && kind != SHRINK && kind != TOGETHER && kind != EDGE_ON)
        rewind_to_start(scene, random_in(random, 0.0, 1.0));
    if (kind == SPECK) {
        scene->motion.b = scene->motion.a;
        if (one_in(random, 2))
            scene->motion.db = scene->motion.da;
    }
    if (kind == AWAY)
        move_away(scene);
}

double moving_extent(const struct moving_scene *scene)
{
    const struct motion *m = &scene->motion;
    double most = max_of(extent_of(m->a), extent_of(m->b));
    most = max_of(most, max_of(extent_of(add(m->a, m->da)), extent_of(add(m->b, m->db))));
    for (int k = 0; k < 3; k++) {
        vec3 later = add(scene->corner[k], scene->shift[k]);
        most = max_of(most, max_of(extent_of(scene->corner[k]), extent_of(later)));
    }
    return most;
}

double moving_size(const struct moving_scene *scene)
{
    const struct motion *m = &scene->motion;
    const vec3 all[4] = { m->a, m->b, scene->corner[1], scene->corner[2] };
    double most = max_of(extent_of(m->da), extent_of(m->db));
    for (int k = 0; k < 4; k++)
        most = max_of(most, extent_of(sub(all[k], scene->corner[0])));
    for (int k = 0; k < 3; k++)
        most = max_of(most, extent_of(scene->shift[k]));
    return most;
}

const char *moving_text(const struct moving_scene *scene)
{
    static char text[1800];
    const struct motion *m = &scene->motion;
    const vec3 *v = scene->corner, *d = scene->shift;
    const vec3 all[10] = { m->a, m->b, m->da, m->db, v[0], v[1], v[2], d[0], d[1], d[2] };
    size_t length = (size_t)snprintf(text, sizeof text, "radius %a", scene->radius);
    for (int i = 0; i < 10; i++)
        length += (size_t)snprintf(text + length, sizeof text - length, ", {%a,%a,%a}", all[i].x, all[i].y, all[i].z);
    return text;
}
