/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The sweep of hulls against the oracle (hull_motion.h): anything that moves anyhow near meshes, turns by up to half a
 * circle, and hulls that are thrown at sheets thinner than anything, which they never pass unseen.
 *
 *     test_hull_sweep [THROWS = 20000] [SEED = 1]
 */
#include "hull/hull_motion.h"

static unsigned long throw_count = 20000;
static uint64_t rng = 1;

/* A turn after another one, by any angle up to half a circle. */
static void turn_on(const double *from, double angle, double *to)
{
    dpt_pose at = DPT_POSE_IDENTITY, turn = DPT_POSE_IDENTITY;
    memcpy(at.orientation, from, sizeof at.orientation);
    pose_turn(any_unit(&rng), angle, &turn);
    const dpt_pose turned = pose_in(&turn, &at);
    for (int k = 0; k < 4; k++)
        to[k] = turned.orientation[k];
    if (one_in(&rng, 4))
        for (int k = 0; k < 4; k++)
            to[k] = -to[k];
}

static double any_angle(void)
{
    static const double most[] = { 0.0, 1e-3, 0.1, 1.0, 3.14 };
    return most[whole_in(&rng, 0, 4)] * random_in(&rng, -1.0, 1.0);
}

/* In the body's frame from one place to another, both turned by up to `turn`; the body itself may move and turn. */
static void put_motion(struct hull_throw *thrown, vec3 from, vec3 to, double angle, double body_angle, double body_way)
{
    dpt_pose at[2] = { DPT_POSE_IDENTITY, DPT_POSE_IDENTITY };
    struct oracle_motion *m = &thrown->motion;
    at[0] = any_pose(&rng, 0.0);
    vec3_store(from, at[0].position);
    vec3_store(to, at[1].position);
    turn_on(at[0].orientation, angle, at[1].orientation);
    m->body_from = m->body_to = (dpt_pose)DPT_POSE_IDENTITY;
    if (body_way > 0.0) {
        m->body_from = any_pose(&rng, body_way);
        vec3_store(add(vec3_of(m->body_from.position), any_in(&rng, body_way)), m->body_to.position);
        turn_on(m->body_from.orientation, body_angle, m->body_to.orientation);
    }
    m->tool_from = pose_in(&m->body_from, &at[0]);
    m->tool_to = pose_in(&m->body_to, &at[1]);
    thrown->noise = 0x1p-44 * (1.0 + extent_of(vec3_of(m->tool_from.position)) +
                               extent_of(vec3_of(m->tool_to.position)) + extent_of(vec3_of(m->body_to.position)));
}

static void any_hull(struct made_hull *made, double size)
{
    make_any_hull(&rng, size, made);
    if (one_in(&rng, 2))
        CHECK(make_hull(made, size * power_in(&rng, -3.0, 0.0)) == DPT_OK, "with a radius");
}

static void any_limits(struct hull_throw *thrown, double diagonal)
{
    const double radius = thrown->made->hull->radius;
    thrown->tolerance = diagonal * (one_in(&rng, 2) ? 1e-6 : power_in(&rng, -9.0, -4.0));
    thrown->clearance = one_in(&rng, 2)   ? 0.0
                        : one_in(&rng, 2) ? -radius * random_in(&rng, 0.0, 1.5)
                                          : thrown->made->size * random_in(&rng, 0.0, 0.1);
}

/* Past a place on the mesh, through it, or away from there, from rest to several diagonals in a tick. */
static void throw_at(const struct hull_body *body, struct made_hull *made, struct throw_tally *tally)
{
    vec3 n;
    const vec3 x = body_place(body, &rng, &n);
    const double size = body->diagonal * power_in(&rng, -2.5, -0.5);
    if (one_in(&rng, 4) || !made->hull)
        any_hull(made, size);
    struct hull_throw thrown = {
        .surface = &body->surface, .kernel = &body->kernel, .triangles = &body->triangles, .made = made
    };
    const double far = one_in(&rng, 8) ? 0.0 : body->diagonal * power_in(&rng, -4.0, 0.5);
    const vec3 way = scaled(any_unit(&rng), far);
    const double part = random_in(&rng, -0.3, 1.0);
    const vec3 by = along(x, made->size * random_in(&rng, 0.5, 2.5), n);
    const int is_moving = one_in(&rng, 2);
    any_limits(&thrown, body->diagonal);
    put_motion(&thrown, along(one_in(&rng, 4) ? x : by, -part, way), along(one_in(&rng, 2) ? x : by, 1.0 - part, way),
               any_angle(), is_moving ? any_angle() : 0.0,
               is_moving ? body->diagonal * power_in(&rng, -3.0, 0.3) : 0.0);
    check_throw(&rng, &thrown, tally);
}

static void nothing_is_met_before_the_time(void)
{
    static const struct {
        const char *shape;
        uint64_t count;
    } subjects[] = { { "box", 12 }, { "membrane", 128 }, { "cloth", 450 }, { "liver", 600 }, { "star", 2000 } };
    static struct made_hull made;
    const size_t count = sizeof subjects / sizeof *subjects;
    for (size_t i = 0; i < count; i++) {
        struct hull_body body;
        struct throw_tally tally = { .throws = 0 };
        if (!body_from_shape(&body, subjects[i].shape, subjects[i].count))
            continue;
        const unsigned long throws = 1 + throw_count / (2 * count);
        made.hull = NULL;
        while (tally.throws < throws)
            throw_at(&body, &made, &tally);
        print_throws(subjects[i].shape, &tally);
        CHECK(tally.hits > throws / 20 && tally.hits < throws, "%lu hits", tally.hits);
        body_close(&body);
    }
}

/* The lowest and the highest corner over the plane z = 0 at a time, and whether all are over the sheet. */
static int heights_at(const struct hull_throw *thrown, double time, double *low, double *high)
{
    double corners[3 * ORACLE_CORNERS];
    const struct oracle_hull *as = &thrown->made->as;
    int is_over = 1;
    oracle_motion_at(&thrown->motion, time, as->corner[0], as->corner_count, corners);
    *low = HUGE_VAL;
    *high = -HUGE_VAL;
    for (uint32_t i = 0; i < as->corner_count; i++) {
        *low = min_of(*low, corners[3 * i + 2]);
        *high = max_of(*high, corners[3 * i + 2]);
        is_over &= fabs(corners[3 * i]) < 0.499 && fabs(corners[3 * i + 1]) < 0.499;
    }
    return is_over;
}

/*
 * From one side of a flat sheet, 1 m wide, to the other one, over the sheet all the while that it takes. Returns 1 if
 * the throw was one: then it is a hit, before the hull is through.
 */
static int check_pass(const struct hull_throw *thrown)
{
    enum { TIMES = 64 };
    double low, high, first = HUGE_VAL;
    heights_at(thrown, 0.0, &low, &high);
    const double side = low > 0.0 ? 1.0 : high < 0.0 ? -1.0 : 0.0;
    if (side == 0.0)
        return 0;
    for (int i = 0; i <= TIMES && first > 1.0; i++) {
        const int is_over = heights_at(thrown, (double)i / TIMES, &low, &high);
        const double ahead = side > 0.0 ? low : -high, behind = side > 0.0 ? high : -low;
        if (!is_over && ahead < throw_radius(thrown) + 0.3)
            return 0;
        if (behind < 0.0)
            first = (double)i / TIMES;
    }
    if (first > 1.0)
        return 0;
    CHECK(thrown->status == SWEEP_HIT && thrown->time < first, "behind the sheet at %g: status %d, time %g", first,
          thrown->status, thrown->time);
    return 1;
}

/* Hulls of a millimetre to a third of a metre, some of them flat and face on, at a sheet 1 m wide without thickness. */
static void sheets_are_not_passed_unseen(void)
{
    struct hull_body sheets[3];
    static struct made_hull made;
    unsigned long passes = 0;
    struct throw_tally tally = { .throws = 0 };
    if (!body_from_sheet(&sheets[0], 1, 0) || !body_from_sheet(&sheets[1], 8, 0) || !body_from_sheet(&sheets[2], 40, 0))
        return;
    while (tally.throws < 1 + throw_count / 2) {
        const struct hull_body *sheet = &sheets[whole_in(&rng, 0, 2)];
        const double size = power_in(&rng, -3.0, -0.8);
        const double side = one_in(&rng, 2) ? 1.0 : -1.0;
        any_hull(&made, size);
        struct hull_throw thrown = {
            .surface = &sheet->surface, .kernel = &sheet->kernel, .triangles = &sheet->triangles, .made = &made
        };
        any_limits(&thrown, 1.0);
        const double reach = size + throw_radius(&thrown), far = reach * power_in(&rng, 0.0, 3.0);
        const vec3 x = { random_in(&rng, -0.2, 0.2), random_in(&rng, -0.2, 0.2), 0.0 };
        const vec3 way = { 0.3 * random_in(&rng, -1.0, 1.0), 0.3 * random_in(&rng, -1.0, 1.0),
                           side * (reach + far * random_in(&rng, 0.0, 1.0)) };
        const int is_moving = one_in(&rng, 3);
        put_motion(&thrown, add(x, way), along(x, -random_in(&rng, 0.3, 1.5), way), any_angle(),
                   is_moving ? 0.2 * any_angle() : 0.0, is_moving ? power_in(&rng, -3.0, 0.0) : 0.0);
        check_throw(&rng, &thrown, &tally);
        passes += (unsigned long)check_pass(&thrown);
    }
    print_throws("sheets", &tally);
    printf("    %lu throws through a sheet\n", passes);
    CHECK(passes > throw_count / 10, "%lu throws were any", passes);
    for (int i = 0; i < 3; i++)
        body_close(&sheets[i]);
}

/*
 * Along a sheet, at a height over it that is a little more than the radius, or a little less; the sheet goes along with
 * it in half of the throws.
 */
static void what_grazes_is_told_apart(void)
{
    struct hull_body sheet;
    static struct made_hull made;
    struct throw_tally tally = { .throws = 0 };
    if (!body_from_sheet(&sheet, 8, 0))
        return;
    while (tally.throws < 1 + throw_count / 8) {
        const double size = power_in(&rng, -2.5, -0.8);
        if (tally.throws % 4 == 0)
            any_hull(&made, size);
        struct hull_throw thrown = {
            .surface = &sheet.surface, .kernel = &sheet.kernel, .triangles = &sheet.triangles, .made = &made
        };
        any_limits(&thrown, 1.0);
        const double side = one_in(&rng, 2) ? 1.0 : -1.0, part = random_in(&rng, -1.0, 4.0);
        const vec3 way = scaled(any_in(&rng, 1.0), power_in(&rng, -3.0, 0.0));
        const int is_moving = one_in(&rng, 2);
        vec3 x = { random_in(&rng, -0.3, 0.3), random_in(&rng, -0.3, 0.3), 0.0 };
        put_motion(&thrown, x, along(x, 1.0, (vec3){ way.x, way.y, 0.0 }), 0.0, 0.0, 0.0);
        double low, high;
        heights_at(&thrown, 0.0, &low, &high);
        const double lift = side * (throw_radius(&thrown) + part * thrown.tolerance) - (side > 0.0 ? low : high);
        thrown.motion.tool_from.position[2] += lift;
        thrown.motion.tool_to.position[2] += lift;
        if (is_moving) {
            const vec3 by = any_in(&rng, 1.0);
            double *const to[2] = { thrown.motion.tool_to.position, thrown.motion.body_to.position };
            for (int k = 0; k < 2; k++)
                vec3_store(add(vec3_of(to[k]), by), to[k]);
        }
        check_throw(&rng, &thrown, &tally);
        const int is_over = heights_at(&thrown, 0.0, &low, &high);
        const double off = thrown.noise / thrown.tolerance;
        CHECK(part < 2.0 + off || thrown.resolution > 0.0 || thrown.status == SWEEP_FREE, "%g tolerances over it: hit",
              part);
        CHECK(part > -off || !is_over || thrown.status == SWEEP_HIT, "%g tolerances over it: free", part);
    }
    print_throws("grazing", &tally);
    CHECK(tally.near_misses > 0 || throw_count < 1000, "none was near");
    body_close(&sheet);
}

/* A hull whose place in the tool's frame is as far from the origin as a tip is from the hand. */
static void long_tool(struct made_hull *made, double size)
{
    double offset[3];
    do {
        make_any_hull(&rng, size, made);
        vec3_store(scaled(any_unit(&rng), size * random_in(&rng, 0.0, 4.0)), offset);
        cloud_place(made, 1.0, offset);
    } while (make_hull(made, one_in(&rng, 2) ? 0.0 : 0.1 * size) != DPT_OK);
}

/* The least height over z = 0 during a motion: at many times, and then at more about the least one. */
static double lowest_of(const struct hull_throw *thrown, double *when)
{
    enum { TIMES = 128 };
    double from = 0.0, to = 1.0, least = HUGE_VAL, low, high;
    for (int zoom = 0; zoom < 4; zoom++) {
        const double step = (to - from) / TIMES;
        for (int i = 0; i <= TIMES; i++) {
            const double time = min_of(1.0, from + i * step);
            heights_at(thrown, time, &low, &high);
            if (low < least) {
                least = low;
                *when = time;
            }
        }
        from = max_of(0.0, *when - step);
        to = min_of(1.0, *when + step);
    }
    return least;
}

/* Shift the whole motion along the body's z. As the body turns, it is not quite shifted by as much in between. */
static void lift(struct oracle_motion *motion, double by)
{
    struct frame from, to;
    frame_of_pose(&motion->body_from, &from);
    frame_of_pose(&motion->body_to, &to);
    vec3_store(along(vec3_of(motion->tool_from.position), by, from.z), motion->tool_from.position);
    vec3_store(along(vec3_of(motion->tool_to.position), by, to.z), motion->tool_to.position);
}

/* A corner of the hull, turned, that lies lowest. */
static vec3 lowest_corner(const struct made_hull *made, const dpt_pose *pose)
{
    struct frame frame;
    vec3 lowest = { 0.0, 0.0, HUGE_VAL };
    frame_of_pose(pose, &frame);
    for (uint32_t i = 0; i < made->as.corner_count; i++) {
        const vec3 x = frame_turn(&frame, vec3_of(made->as.corner[i]));
        if (x.z < lowest.z)
            lowest = x;
    }
    return lowest;
}

/*
 * A turn by an angle in whose middle, or thereabouts, that corner is lowest which is lowest then: the axis is at right
 * angles to the way that would sink it.
 */
static void put_arc(struct hull_throw *thrown, double angle)
{
    dpt_pose middle = any_pose(&rng, 0.0), *const ends[2] = { &thrown->motion.tool_from, &thrown->motion.tool_to };
    vec3 p = lowest_corner(thrown->made, &middle);
    for (int k = 0; k < 50 && !(p.z < 0.0); k++) {
        middle = any_pose(&rng, 0.0);
        p = lowest_corner(thrown->made, &middle);
    }
    const vec3 sinks = unit_of((vec3){ p.y, -p.x, 0.0 }), any = any_unit(&rng);
    const vec3 axis = unit_of(along(any, -dot(any, sinks), sinks));
    const double part = random_in(&rng, 0.1, 0.9);
    for (int e = 0; e < 2; e++) {
        const dpt_pose *body = e ? &thrown->motion.body_to : &thrown->motion.body_from;
        dpt_pose turn = DPT_POSE_IDENTITY, at = DPT_POSE_IDENTITY;
        pose_turn(axis, angle * (e ? 1.0 - part : -part), &turn);
        at = pose_in(&turn, &middle);
        const dpt_pose there = pose_in(body, &at);
        memcpy(ends[e]->orientation, there.orientation, sizeof there.orientation);
    }
}

/*
 * Turns whose lowest point comes a little too near to a sheet, or not quite: paths are arcs, and what the library takes
 * for them must hold them. Tools are up to four times as long as their tips, and turn by up to half a circle. With a
 * resolution, what is not quite too near may be a hit.
 */
static void arcs_that_dip_are_hits(void)
{
    struct hull_body sheet;
    static struct made_hull made;
    unsigned long dips = 0, misses = 0;
    struct throw_tally tally = { .throws = 0 };
    if (!body_from_sheet(&sheet, 8, 0))
        return;
    for (unsigned long i = 0; i < 1 + throw_count / 4; i++) {
        const double size = power_in(&rng, -2.5, -1.3), angle = 0.02 + 3.1 * random_in(&rng, 0, 1);
        if (i % 4 == 0)
            long_tool(&made, size);
        struct hull_throw thrown = { .surface = &sheet.surface,
                                     .kernel = &sheet.kernel,
                                     .triangles = &sheet.triangles,
                                     .made = &made,
                                     .tolerance = power_in(&rng, -9.0, -5.0) };
        const vec3 x = { random_in(&rng, -0.1, 0.1), random_in(&rng, -0.1, 0.1), 0.0 };
        const vec3 way = scaled(any_in(&rng, size), one_in(&rng, 2) ? 0.0 : 0.3 * random_in(&rng, 0, 1));
        const int is_moving = one_in(&rng, 3);
        put_motion(&thrown, x, add(x, way), 0.0, is_moving ? 0.3 * random_in(&rng, -1.0, 1.0) : 0.0,
                   is_moving ? power_in(&rng, -2.0, 0.0) : 0.0);
        put_arc(&thrown, angle);
        const double wanted =
            throw_radius(&thrown) - made.size * power_in(&rng, -8.0, -2.0) * (one_in(&rng, 3) ? -1 : 1);
        double when, low = lowest_of(&thrown, &when), high;
        for (int k = 0; k < 6 && when > 0.005 && when < 0.995; k++) {
            lift(&thrown.motion, wanted - low);
            low = lowest_of(&thrown, &when);
        }
        if (when < 0.01 || when > 0.99 || !heights_at(&thrown, when, &low, &high))
            continue;
        check_throw(&rng, &thrown, &tally);
        const double over = low - throw_radius(&thrown);
        CHECK(over > -thrown.noise || (thrown.status == SWEEP_HIT && thrown.time <= when),
              "%g too near at %g: status %d, time %g", -over, when, thrown.status, thrown.time);
        CHECK(over < 2.0 * thrown.tolerance + thrown.noise || thrown.resolution > 0.0 || thrown.status == SWEEP_FREE,
              "no nearer than %g beyond: hit at %g", over, thrown.time);
        dips += over < -thrown.noise;
        misses += over > 2.0 * thrown.tolerance + thrown.noise;
    }
    print_throws("arcs", &tally);
    printf("    %lu dips, %lu near misses\n", dips, misses);
    CHECK(dips > throw_count / 16 && misses > throw_count / 64, "%lu dips, %lu misses", dips, misses);
    body_close(&sheet);
}

/* The least distance during a motion: at many times, and then at more about the least one. */
static double least_distance(const struct hull_throw *thrown, double *when)
{
    enum { TIMES = 24 };
    double from = 0.0, to = 1.0, least = HUGE_VAL;
    for (int zoom = 0; zoom < 5; zoom++) {
        const double step = (to - from) / TIMES;
        for (int i = 0; i <= TIMES; i++) {
            const double time = min_of(1.0, from + i * step);
            const double upper = throw_distance(thrown, time, DPT_NONE, HUGE_VAL).upper;
            if (upper < least) {
                least = upper;
                *when = time;
            }
        }
        from = max_of(0.0, *when - step);
        to = min_of(1.0, *when + step);
    }
    return least;
}

/*
 * A hull that turns beside a mesh and slides, and a radius that is a little more than what it comes near, or a little
 * less: here planes must turn with the hull. Of several times that are about as near, the least may be missed: so what
 * is a little less is not asked to be free.
 */
static void what_just_comes_near_is_a_hit(void)
{
    static const char *const shapes[] = { "box", "membrane", "star" };
    static const uint64_t counts[] = { 12, 128, 2000 };
    static struct made_hull made;
    for (int s = 0; s < 3; s++) {
        struct hull_body body;
        struct throw_tally tally = { .throws = 0 };
        unsigned long dips = 0;
        if (!body_from_shape(&body, shapes[s], counts[s]))
            continue;
        for (unsigned long i = 0; i < 1 + throw_count / (s == 2 ? 40 : 10); i++) {
            vec3 n;
            const vec3 x = body_place(&body, &rng, &n);
            const double size = body.diagonal * power_in(&rng, -1.5, 0.0);
            if (i % 4 == 0)
                long_tool(&made, size);
            struct hull_throw thrown = { .surface = &body.surface,
                                         .kernel = &body.kernel,
                                         .triangles = &body.triangles,
                                         .made = &made,
                                         .tolerance = body.diagonal * power_in(&rng, -8.0, -5.0) };
            const vec3 at = along(x, made.size * random_in(&rng, 0.2, 4.0), n);
            const vec3 way = scaled(any_in(&rng, made.size), power_in(&rng, -3.0, -0.3));
            double when;
            put_motion(&thrown, at, add(at, way), any_angle(), one_in(&rng, 3) ? 0.3 : 0.0,
                       one_in(&rng, 3) ? body.diagonal : 0.0);
            const double least = least_distance(&thrown, &when);
            const double deep = made.size * power_in(&rng, -8.0, -2.0) * (one_in(&rng, 3) ? -1 : 1);
            if (least < 1e-4 * made.size || least > 3.0 * made.size || least + deep < 0.0)
                continue;
            thrown.clearance = least + deep - made.hull->radius;
            check_throw(&rng, &thrown, &tally);
            CHECK(deep < thrown.noise || (thrown.status == SWEEP_HIT && thrown.time <= when),
                  "%s: %g too near at %g: status %d, time %g", shapes[s], deep, when, thrown.status, thrown.time);
            dips += deep > thrown.noise;
        }
        print_throws(shapes[s], &tally);
        CHECK(dips > throw_count / 200, "%lu dips", dips);
        body_close(&body);
    }
}

/* No corner is farther from where it ends than is said; where nothing turns, that is the way. */
static void displacements_hold_every_corner(void)
{
    static struct made_hull made;
    for (unsigned long i = 0; i < 200 + throw_count / 20; i++) {
        const double size = power_in(&rng, -3.0, 0.0);
        if (i % 4 == 0)
            any_hull(&made, size);
        const dpt_pose from = any_pose(&rng, size * power_in(&rng, -2.0, 2.0));
        dpt_pose to = from;
        const vec3 way = any_in(&rng, size * power_in(&rng, -3.0, 2.0));
        const double angle = any_angle();
        const dpt_pose identity = DPT_POSE_IDENTITY;
        if (!one_in(&rng, 6))
            vec3_store(add(vec3_of(from.position), way), to.position);
        if (angle != 0.0)
            turn_on(from.orientation, angle, to.orientation);
        const double said = dpti_hull_displacement(made.hull, &from, &to);
        const struct oracle_motion motion = { from, to, identity, identity };
        const uint32_t count = made.as.corner_count;
        double end[3 * ORACLE_CORNERS], then[3 * ORACLE_CORNERS], most = 0.0;
        oracle_motion_at(&motion, 1.0, made.as.corner[0], count, end);
        for (int t = 0; t < 32; t++) {
            oracle_motion_at(&motion, t / 32.0, made.as.corner[0], count, then);
            for (uint32_t c = 0; c < count; c++)
                most = max_of(most, length(sub(vec3_of(then + 3 * c), vec3_of(end + 3 * c))));
        }
        const double noise = 0x1p-46 * (size + extent_of(vec3_of(from.position)) + extent_of(way));
        const double speed = oracle_motion_speed(&motion, made.as.corner[0], count);
        CHECK(said >= most - noise, "%.17g, a corner went %.17g", said, most);
        CHECK(said <= 1.3 * speed + noise, "%g, no corner can go more than %g", said, speed);
        if (angle == 0.0)
            CHECK(fabs(said - most) <= noise + 1e-9 * most, "%.17g, not %.17g", said, most);
    }
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &throw_count, &rng);
    TEST(nothing_is_met_before_the_time);
    TEST(sheets_are_not_passed_unseen);
    TEST(what_grazes_is_told_apart);
    TEST(arcs_that_dip_are_hits);
    TEST(what_just_comes_near_is_a_hit);
    TEST(displacements_hold_every_corner);
    return check_report();
}
