/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A hull and one triangle against the oracle, on families of pairs that have gone wrong in someone's code: touching,
 * flat on a face, edge on edge, corner on corner, slivers, inside, through. Sizes from 1 mm to 1 km. Errors are in
 * units of 2^-53 of the largest |coordinate|. The table names the worst of each family, and how wide the oracle's own
 * interval was at most.
 *
 *     test_hull_pair [PAIRS = 100000] [SEED = 1]
 */
#include "hull/hull_maker.h"
#include "hull/hull_triangle.h"

#define UNIT 0x1p-53

/* Half of DISTANCE_ERROR (nearest/nearest_pair.h): the share of it that is for the pair. */
static const double BOUND = 64.0;

static unsigned long pair_count = 100000;
static uint64_t rng = 1;

/* One question. */
struct scene {
    struct made_hull made;
    struct hull_place place;
    double corners[3 * HULL_CORNERS_MAX]; /* of the hull, in the triangle's frame */
    double size, extent;
    vec3 v[3];
    double triangle[9];
};

static const char *text_of(const struct scene *scene)
{
    static char text[12000];
    snprintf(text, sizeof text, "hull %s; ", points_text(scene->corners, scene->place.hull->corner_count));
    const size_t length = strlen(text);
    snprintf(text + length, sizeof text - length, "triangle %s", points_text(scene->triangle, 3));
    return text;
}

static vec3 corner_of(const struct scene *scene, uint32_t i)
{
    return scene->place.corner[i];
}

static vec3 any_inside(const struct scene *scene)
{
    vec3 sum = { 0.0, 0.0, 0.0 };
    double all = 0.0;
    for (uint32_t i = 0; i < scene->place.hull->corner_count; i++) {
        const double part = random_in(&rng, 0.0, 1.0);
        sum = along(sum, part, corner_of(scene, i));
        all += part;
    }
    return scaled(sum, 1.0 / all);
}

/* Nothing, rounding, or any part of the size, to either side. */
static double any_gap(const struct scene *scene)
{
    if (one_in(&rng, 6))
        return 0.0;
    const double gap = scene->size * power_in(&rng, -17.0, 0.0);
    return one_in(&rng, 4) ? -gap : gap;
}

/* A corner that lies farthest along a direction. */
static uint32_t farthest(const struct scene *scene, vec3 n)
{
    uint32_t most = 0;
    for (uint32_t i = 1; i < scene->place.hull->corner_count; i++)
        if (dot(n, corner_of(scene, i)) > dot(n, corner_of(scene, most)))
            most = i;
    return most;
}

/* Families. Each sets the triangle to a hull that is in its place. */

static void make_far(struct scene *scene)
{
    const vec3 at = scaled(any_unit(&rng), scene->size * power_in(&rng, 0.0, 2.0));
    for (int k = 0; k < 3; k++)
        scene->v[k] = add(add(any_inside(scene), at), any_in(&rng, scene->size));
}

static void make_near(struct scene *scene)
{
    const double reach = scene->size * power_in(&rng, -2.0, 0.5);
    const vec3 at = along(any_inside(scene), scene->size * random_in(&rng, 0.0, 0.6), any_unit(&rng));
    for (int k = 0; k < 3; k++)
        scene->v[k] = add(at, any_in(&rng, reach));
}

/* In a plane that is parallel to a face: over it, beside it, or both. */
static void make_flat_on_face(struct scene *scene)
{
    const struct dpt_hull *hull = scene->place.hull;
    const struct hull_face *face = &hull->face[whole_in(&rng, 0, hull->face_count - 1)];
    const vec3 n = scene->place.normal[face - hull->face];
    const double gap = any_gap(scene), reach = scene->size * power_in(&rng, -2.0, 0.5);
    const vec3 from = corner_of(scene, hull->loop[face->first + whole_in(&rng, 0, face->count - 1)]);
    vec3 across[2];
    unit_across(n, across);
    for (int k = 0; k < 3; k++)
        scene->v[k] = along(along(along(from, gap, n), random_in(&rng, -reach, reach), across[0]),
                            random_in(&rng, -reach, reach), across[1]);
}

/* Across the direction in which a corner lies farthest, around it. */
static void make_corner_on_face(struct scene *scene)
{
    const vec3 n = any_unit(&rng), at = corner_of(scene, farthest(scene, n));
    const double gap = any_gap(scene), reach = scene->size * power_in(&rng, -1.0, 0.5);
    vec3 across[2];
    unit_across(n, across);
    const double turn = random_in(&rng, 0.0, 6.28);
    for (int k = 0; k < 3; k++)
        scene->v[k] = along(along(along(at, gap, n), reach * cos(turn + 2.1 * k), across[0]),
                            reach * sin(turn + 2.1 * k), across[1]);
}

/* From a corner's outside, a triangle that points at it. */
static void make_corner_on_corner(struct scene *scene)
{
    const vec3 n = any_unit(&rng), at = corner_of(scene, farthest(scene, n));
    const double reach = scene->size * power_in(&rng, -1.0, 0.5);
    scene->v[0] = along(at, any_gap(scene), n);
    for (int k = 1; k < 3; k++)
        scene->v[k] = along(add(scene->v[0], any_in(&rng, reach)), 1.5 * reach, n);
}

/* A direction between those of two faces, and a place on the edge that they share. */
static vec3 any_on_edge(const struct scene *scene, vec3 *n, vec3 *along_it)
{
    const struct dpt_hull *hull = scene->place.hull;
    const uint32_t e = whole_in(&rng, 0, hull->edge_count - 1);
    const vec3 a = corner_of(scene, hull->edge[e][0]), b = corner_of(scene, hull->edge[e][1]);
    vec3 sum = { 0.0, 0.0, 0.0 };
    const double part = random_in(&rng, 0.05, 0.95);
    int seen = 0;
    for (uint32_t f = 0; f < hull->face_count; f++) {
        int ends = 0;
        for (uint32_t i = 0; i < hull->face[f].count; i++) {
            const uint8_t c = hull->loop[hull->face[f].first + i];
            ends += c == hull->edge[e][0] || c == hull->edge[e][1];
        }
        if (ends == 2)
            sum = along(sum, seen++ ? 1.0 - part : part, scene->place.normal[f]);
    }
    /* A flat hull's two faces look away from each other: out, across the edge. */
    if (hull->is_flat)
        sum = scaled(cross(sub(b, a), scene->place.normal[0]), part > 0.5 ? -1.0 : 1.0);
    *n = unit_of(sum);
    *along_it = unit_of(sub(b, a));
    return along(a, random_in(&rng, 0.02, 0.98), sub(b, a));
}

/* The triangle's edge over that of the hull, at any angle or nearly along it, the third corner farther out. */
static void make_edge_on_edge(struct scene *scene)
{
    vec3 n, u;
    const vec3 at = any_on_edge(scene, &n, &u), q = along(at, any_gap(scene), n), w = cross(n, u);
    const double angle = one_in(&rng, 3) ? power_in(&rng, -16.0, -1.0) : random_in(&rng, 0.0, 3.14);
    const double reach = scene->size * power_in(&rng, -2.0, 0.5);
    const vec3 d = add(scaled(u, cos(angle)), scaled(w, sin(angle)));
    scene->v[0] = along(q, -reach * random_in(&rng, -0.1, 1.0), d);
    scene->v[1] = along(q, reach * random_in(&rng, 0.0, 1.0), d);
    scene->v[2] = along(along(q, random_in(&rng, 0.0, reach), n), random_in(&rng, -reach, reach), d);
}

static void make_corner_on_edge(struct scene *scene)
{
    vec3 n, u;
    const vec3 at = any_on_edge(scene, &n, &u);
    const double reach = scene->size * power_in(&rng, -1.0, 0.5);
    scene->v[0] = along(at, any_gap(scene), n);
    for (int k = 1; k < 3; k++)
        scene->v[k] = along(add(scene->v[0], any_in(&rng, reach)), 1.5 * reach, n);
}

/* Thin, or with one short edge, near the hull; now and then without any area. */
static void make_sliver(struct scene *scene)
{
    make_near(scene);
    const vec3 e = sub(scene->v[1], scene->v[0]);
    const double thin = one_in(&rng, 5) ? 0.0 : power_in(&rng, -16.0, -2.0);
    const vec3 off = scaled(any_in(&rng, scene->size), thin);
    scene->v[2] = add(along(scene->v[0], one_in(&rng, 3) ? 0.0 : random_in(&rng, -0.2, 1.2), e), off);
    if (thin == 0.0 && one_in(&rng, 3))
        scene->v[1] = scene->v[0];
}

/* Its middle, or a place in it, is in the hull. */
static void make_through(struct scene *scene)
{
    const vec3 at = any_inside(scene);
    const double reach = scene->size * power_in(&rng, -1.0, 1.0);
    vec3 sum = { 0.0, 0.0, 0.0 };
    for (int k = 0; k < 3; k++) {
        scene->v[k] = any_in(&rng, reach);
        sum = along(sum, 1.0 / 3.0, scene->v[k]);
    }
    for (int k = 0; k < 3; k++)
        scene->v[k] = add(sub(scene->v[k], sum), at);
}

static void make_inside(struct scene *scene)
{
    const double part = power_in(&rng, -3.0, 0.0);
    const vec3 at = any_inside(scene);
    for (int k = 0; k < 3; k++)
        scene->v[k] = along(at, part, sub(any_inside(scene), at));
}

/* Corners of the triangle are corners of the hull, or lie on its edges, exactly or nearly. */
static void make_shared(struct scene *scene)
{
    const struct dpt_hull *hull = scene->place.hull;
    make_near(scene);
    const int shared = (int)whole_in(&rng, 1, 3);
    for (int k = 0; k < shared; k++) {
        const uint32_t c = whole_in(&rng, 0, hull->corner_count - 1);
        scene->v[k] = corner_of(scene, c);
        if (one_in(&rng, 3))
            scene->v[k] = scaled(add(corner_of(scene, 0), corner_of(scene, c)), 0.5);
    }
}

/* What a family measured. */
struct row {
    const char *name;
    void (*make)(struct scene *scene);
    unsigned long pairs, meet, apart, open;
    double worst, widest;
};

static struct row families[] = {
    { .name = "far", .make = make_far },
    { .name = "near", .make = make_near },
    { .name = "flat on a face", .make = make_flat_on_face },
    { .name = "corner on face", .make = make_corner_on_face },
    { .name = "corner on corner", .make = make_corner_on_corner },
    { .name = "edge on edge", .make = make_edge_on_edge },
    { .name = "corner on edge", .make = make_corner_on_edge },
    { .name = "sliver", .make = make_sliver },
    { .name = "through", .make = make_through },
    { .name = "inside", .make = make_inside },
    { .name = "shared corners", .make = make_shared },
};

/* A hull somewhere: a third of them as they were made, for a place hides what is small. */
static void put_hull(struct scene *scene)
{
    const double size = power_in(&rng, -3.0, 3.0);
    dpt_pose tool = DPT_POSE_IDENTITY;
    struct frame frame;
    make_any_hull(&rng, size, &scene->made);
    if (!one_in(&rng, 3))
        tool = any_pose(&rng, size * power_in(&rng, -1.0, 2.0));
    CHECK(frame_of_pose(&tool, &frame) == DPT_OK, "pose");
    hull_place_set(&scene->place, scene->made.hull, &frame, &frame_identity);
    for (uint32_t i = 0; i < scene->made.hull->corner_count; i++)
        vec3_store(scene->place.corner[i], scene->corners + 3 * i);
    scene->size = size;
}

static void end_scene(struct scene *scene)
{
    scene->extent = 0.0;
    for (int k = 0; k < 3; k++) {
        vec3_store(scene->v[k], scene->triangle + 3 * k);
        scene->extent = max_of(scene->extent, extent_of(scene->v[k]));
    }
    for (uint32_t i = 0; i < scene->made.hull->corner_count; i++)
        scene->extent = max_of(scene->extent, extent_of(scene->place.corner[i]));
}

static struct oracle_interval interval_of(const struct scene *scene)
{
    return oracle_hull_triangle(scene->corners, scene->place.hull->corner_count, scene->triangle, NULL);
}

/* How far a point is from the hull, and from the triangle. */
static double off_hull(const struct scene *scene, vec3 x)
{
    double point[9];
    for (int k = 0; k < 3; k++)
        vec3_store(x, point + 3 * k);
    return oracle_hull_triangle(scene->corners, scene->place.hull->corner_count, point, NULL).lower;
}

/* The pair's points exist, and are as far apart as it says. */
static void check_pair(const struct scene *scene, const struct hull_pair *found, double bound)
{
    const double *w = found->pair.weight, distance = sqrt(found->pair.distance2);
    vec3 q = scaled(scene->v[0], w[0]);
    for (int k = 1; k < 3; k++)
        q = along(q, w[k], scene->v[k]);
    CHECK(w[0] >= 0.0 && w[1] >= 0.0 && w[2] >= 0.0 && fabs(w[0] + w[1] + w[2] - 1.0) < 1e-12, "weights %g, %g, %g: %s",
          w[0], w[1], w[2], text_of(scene));
    CHECK(fabs(length(found->pair.gap) - distance) <= bound, "gap %g, distance %g: %s", length(found->pair.gap),
          distance, text_of(scene));
    CHECK(found->pair.s == 0.0, "s %g", found->pair.s);
    /* Where they meet, a crossing at a small angle is known less well. */
    const double off = off_hull(scene, add(q, found->pair.gap));
    CHECK(off <= (found->feature == DPT_NONE ? 16.0 : 1.0) * bound, "p is %g units off the hull, feature %u: %s",
          off / (scene->extent * UNIT), found->feature, text_of(scene));
}

static int has_feature(const struct dpt_hull *hull, uint32_t feature)
{
    if (feature < HULL_EDGE)
        return feature < hull->corner_count;
    if (feature < HULL_FACE)
        return (feature - HULL_EDGE) / 3 < hull->edge_count;
    return feature < HULL_FEATURES && (feature - HULL_FACE) / 3 < hull->face_count;
}

/* Those that were taken. */
struct taken {
    uint32_t count[HULL_FEATURES];
    double distance[HULL_FEATURES];
    uint32_t unknown;
};

static void take(void *user, const struct hull_pair *found)
{
    struct taken *taken = user;
    if (found->feature >= HULL_FEATURES) {
        taken->unknown++;
        return;
    }
    taken->count[found->feature]++;
    taken->distance[found->feature] = sqrt(found->pair.distance2);
}

/* Every feature whose pair is within the limit is listed once; the nearest of them is the nearest pair. */
static void check_features(const struct scene *scene, const struct oracle_interval *truth, double limit, double bound)
{
    static struct taken taken;
    const struct dpt_hull *hull = scene->place.hull;
    double least = HUGE_VAL;
    memset(&taken, 0, sizeof taken);
    dpti_hull_features(&scene->place, scene->v, limit, take, &taken);
    CHECK(taken.unknown == 0, "%u that are none: %s", taken.unknown, text_of(scene));
    for (uint32_t f = 0; f < HULL_FEATURES; f++) {
        struct hull_pair found;
        if (!has_feature(hull, f)) {
            CHECK(taken.count[f] == 0, "feature %u is none: %s", f, text_of(scene));
            continue;
        }
        if (!dpti_hull_feature(&scene->place, f, scene->v, &found)) {
            CHECK(taken.count[f] == 0, "feature %u has no pair: %s", f, text_of(scene));
            continue;
        }
        const double distance = sqrt(found.pair.distance2);
        CHECK(found.feature == f, "feature %u, not %u", found.feature, f);
        CHECK(distance >= truth->lower - bound, "feature %u: %g, the distance is %g: %s", f, distance, truth->lower,
              text_of(scene));
        least = min_of(least, distance);
        if (fabs(distance - limit) <= bound)
            continue;
        CHECK(taken.count[f] == (distance <= limit), "feature %u, %g of %g, %u times: %s", f, distance, limit,
              taken.count[f], text_of(scene));
        CHECK(!taken.count[f] || fabs(taken.distance[f] - distance) <= bound, "feature %u: %g, %g", f,
              taken.distance[f], distance);
    }
    CHECK(truth->lower <= bound || least <= truth->upper + bound,
          "no feature is nearer than %g, the distance is %g: %s", least, truth->upper, text_of(scene));
}

/*
 * The nearest pair is one of its neighbours' nearest; and as both are convex, a pair that is nearest among its neighbours
 * is nearest of all. With a lean that is small beside what makes pairs differ, where they are not too near for a
 * direction, and of triangles that have a face: of two edges in one place it is chance which one has the pair.
 */
static void check_local(const struct scene *scene)
{
    struct hull_pair nearest;
    const struct oracle_interval truth = interval_of(scene);
    const double lean = 1e-7,
                 reach = scene->size + length(sub(scene->v[1], scene->v[0])) + length(sub(scene->v[2], scene->v[0]));
    const vec3 e = sub(scene->v[1], scene->v[0]), g = sub(scene->v[2], scene->v[0]);
    if (!(length(cross(e, g)) > 1e-9 * max_of(dot(e, e), dot(g, g))) ||
        !(truth.lower > 1e8 * UNIT * scene->extent && truth.lower > 1e-6 * reach) ||
        !dpti_hull_triangle(&scene->place, scene->v, HUGE_VAL, &nearest))
        return;
    CHECK(dpti_hull_pair_is_local(&scene->place, scene->v, &nearest, 1e-4),
          "the nearest pair, feature %u, weights %g, %g, %g, is not: %s", nearest.feature, nearest.pair.weight[0],
          nearest.pair.weight[1], nearest.pair.weight[2], text_of(scene));
    for (uint32_t f = 0; f < HULL_FEATURES; f++) {
        struct hull_pair found;
        if (!has_feature(scene->place.hull, f) || !dpti_hull_feature(&scene->place, f, scene->v, &found) ||
            !dpti_hull_pair_is_local(&scene->place, scene->v, &found, lean))
            continue;
        const double distance = sqrt(found.pair.distance2);
        CHECK(distance <= truth.upper + 1e-3 * reach, "feature %u at %g is no local pair, the distance is %g: %s", f,
              distance, truth.upper, text_of(scene));
    }
}

/* A nearer limit finds nothing, a farther one the same. */
static void check_limit(const struct scene *scene, const struct oracle_interval *truth, double distance, double bound)
{
    struct hull_pair found;
    const double limit = distance * (1.0 + power_in(&rng, -12.0, 0.0) * (one_in(&rng, 2) ? 1 : -1));
    const int is_near = dpti_hull_triangle(&scene->place, scene->v, limit, &found);
    if (is_near)
        CHECK(sqrt(found.pair.distance2) <= limit && sqrt(found.pair.distance2) <= truth->upper + bound,
              "%g, limit %g: %s", sqrt(found.pair.distance2), limit, text_of(scene));
    CHECK(!is_near || truth->lower - bound < limit, "found nearer than %g, at %g: %s", limit, truth->lower,
          text_of(scene));
    CHECK(is_near || truth->upper + bound >= limit, "none nearer than %g, at %g: %s", limit, truth->upper,
          text_of(scene));
    CHECK(!dpti_hull_triangle(&scene->place, scene->v, 0.0, &found), "nearer than 0: %s", text_of(scene));
}

static void check_scene(struct row *row, const struct scene *scene)
{
    struct hull_pair found;
    const double unit = UNIT * scene->extent, bound = BOUND * unit;
    const struct oracle_interval truth = interval_of(scene);
    const int is_near = dpti_hull_triangle(&scene->place, scene->v, HUGE_VAL, &found);
    row->pairs++;
    CHECK(is_near, "nothing within any limit: %s", text_of(scene));
    if (!is_near)
        return;
    const double distance = sqrt(found.pair.distance2);
    const double error = max_of(truth.lower - distance, distance - truth.upper);
    CHECK(error <= bound, "%g, not %g..%g, %g units: %s", distance, truth.lower, truth.upper, error / unit,
          text_of(scene));
    CHECK(found.feature != DPT_NONE || distance == 0.0, "%g, and no feature: %s", distance, text_of(scene));
    check_pair(scene, &found, bound);
    if (found.feature != DPT_NONE) {
        struct hull_pair again;
        CHECK(has_feature(scene->place.hull, found.feature), "feature %u", found.feature);
        CHECK(dpti_hull_feature(&scene->place, found.feature, scene->v, &again) &&
                  fabs(sqrt(again.pair.distance2) - distance) <= bound,
              "feature %u by itself: %s", found.feature, text_of(scene));
        check_limit(scene, &truth, distance, bound);
    }
    check_features(scene, &truth, (distance + 1e-3 * scene->size) * random_in(&rng, 0.5, 3.0), bound);
    row->meet += truth.upper <= unit;
    row->apart += truth.lower > 0.0;
    row->open += truth.upper - truth.lower > 4.0 * max_of(unit, UNIT * truth.upper);
    row->worst = max_of(row->worst, error / unit);
    row->widest = max_of(row->widest, (truth.upper - truth.lower) / unit);
}

/* The oracle's interval, from corners alone, holds what each feature against each gives. */
static void check_oracle(const struct scene *scene)
{
    struct oracle_hull there;
    const struct oracle_interval truth = interval_of(scene);
    oracle_hull_at(&scene->made.as, scene->corners, &there);
    const double least = oracle_hull_by_features(&there, scene->triangle);
    /* Where the hull was put, its faces are flat but for rounding. */
    const double allowed = 8.0 * UNIT * scene->extent;
    CHECK(least >= truth.lower - allowed && least <= truth.upper + allowed, "%g by features, %g..%g: %s", least,
          truth.lower, truth.upper, text_of(scene));
}

static void pairs_are_the_nearest(void)
{
    static struct scene scene;
    const size_t count = sizeof families / sizeof *families;
    for (unsigned long i = 0; i < pair_count; i++) {
        struct row *row = &families[random_bits(&rng) % count];
        if (i % 8 == 0)
            put_hull(&scene);
        row->make(&scene);
        end_scene(&scene);
        check_scene(row, &scene);
        if (i % 16 == 0)
            check_oracle(&scene);
    }
    printf("    %-18s %8s %8s %8s %10s   %s\n", "family", "pairs", "apart", "meet", "worst",
           "oracle's widest, in units; wider than four");
    for (size_t i = 0; i < count; i++) {
        const struct row *row = &families[i];
        printf("    %-18s %8lu %8lu %8lu %10.3g   %.3g; %lu\n", row->name, row->pairs, row->apart, row->meet,
               row->worst, row->widest, row->open);
        CHECK(row->open * 100 <= row->pairs, "%s: %lu of %lu intervals stay open", row->name, row->open, row->pairs);
    }
}

/* A plane that is said to be between two sets is; where they are apart by a millionth of their size, one is found. */
static void planes_lie_between(void)
{
    static struct scene scene;
    unsigned long apart = 0, missed = 0, claimed = 0;
    for (unsigned long i = 0; i < pair_count; i++) {
        const size_t families_count = sizeof families / sizeof *families;
        if (i % 8 == 0)
            put_hull(&scene);
        families[random_bits(&rng) % families_count].make(&scene);
        end_scene(&scene);
        const struct oracle_interval truth = interval_of(&scene);
        const double unit = UNIT * scene.extent;
        const double wanted = one_in(&rng, 2) ? 0.0 : truth.upper * random_in(&rng, 0.0, 1.1);
        vec3 n = one_in(&rng, 2) ? any_in(&rng, scene.size) : (vec3){ 0.0, 0.0, 0.0 };
        const uint32_t count = scene.place.hull->corner_count;
        const int is_found = dpti_separate(scene.v, 3, scene.place.corner, count, wanted, &n);
        if (is_found) {
            double gap = HUGE_VAL;
            for (uint32_t c = 0; c < count; c++)
                for (int k = 0; k < 3; k++)
                    gap = min_of(gap, dot(n, sub(corner_of(&scene, c), scene.v[k])));
            CHECK(fabs(length(n) - 1.0) < 1e-12, "%.17g long", length(n));
            CHECK(gap > wanted - 4.0 * unit, "%g, not %g: %s", gap, wanted, text_of(&scene));
            CHECK(truth.upper > wanted - 4.0 * unit, "a plane where they are %g apart, not %g: %s", truth.upper, wanted,
                  text_of(&scene));
            claimed++;
        }
        const double size = scene.size + length(sub(scene.v[1], scene.v[0])) + length(sub(scene.v[2], scene.v[0]));
        if (truth.lower - wanted > 1e-6 * size + 16.0 * unit) {
            apart++;
            missed += !is_found;
        }
    }
    printf("    %lu planes; %lu pairs apart by a millionth, %lu planes not found\n", claimed, apart, missed);
    CHECK(missed * 1000 <= apart, "%lu of %lu", missed, apart);
    CHECK(apart > pair_count / 4, "%lu of %lu are apart", apart, pair_count);
}

static void local_pairs_are_nearest_of_all(void)
{
    static struct scene scene;
    for (unsigned long i = 0; i < pair_count; i++) {
        const size_t count = sizeof families / sizeof *families;
        if (i % 8 == 0)
            put_hull(&scene);
        families[random_bits(&rng) % count].make(&scene);
        end_scene(&scene);
        check_local(&scene);
    }
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &pair_count, &rng);
    TEST(pairs_are_the_nearest);
    TEST(planes_lie_between);
    TEST(local_pairs_are_nearest_of_all);
    return check_report();
}
