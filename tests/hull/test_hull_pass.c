/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Hulls whose corners go straight, past one triangle: where a plane is said to keep the two apart, they are, at all times.
 *
 *     test_hull_pass [MOTIONS = 4000 [SEED = 1]]
 */
#include "base/quaternion.h"
#include "hull/hull_maker.h"
#include "hull/hull_pass.h"
#include "hull/straight_hull.h"

static unsigned long motions = 4000;
static uint64_t rng = 1;

enum { TIMES = 33, HULLS = 40 };

/* Where planes were found: at rest, turning, of a pair at both ends; and where not. */
static struct {
    uint64_t still, turning, given, none;
} counts;

static vec3 any_vector(double size)
{
    return (vec3){ random_in(&rng, -size, size), random_in(&rng, -size, size), random_in(&rng, -size, size) };
}

static void turned(const dpt_pose *pose, double angle, double shift, dpt_pose *to)
{
    const struct quaternion turn = quaternion_of_small_turn(any_vector(angle));
    quaternion_store(quaternion_unit(quaternion_product(turn, quaternion_of(pose->orientation))), to->orientation);
    vec3_store(add(vec3_of(pose->position), any_vector(shift)), to->position);
}

static double distance_at(const struct hull_pass *pass, const vec3 v[3], double time)
{
    struct hull_place place = { .a = pass->corner[0], .u = { 0, 0, 0 } };
    struct hull_pair found;
    straight_hull_at(pass->hull, pass->from, pass->to, pass->body, time, &place);
    return dpti_hull_triangle(&place, v, HUGE_VAL, &found) ? sqrt(found.pair.distance2) : HUGE_VAL;
}

static void judge(const struct hull_pass *pass, const vec3 v[3], const char *how)
{
    for (int k = 0; k < TIMES; k++) {
        const double distance = distance_at(pass, v, k / (TIMES - 1.0));
        CHECK(distance > pass->apart - 1e-12, "%s: %g at %g, not %g", how, distance, k / (TIMES - 1.0), pass->apart);
    }
}

/* A triangle that is about as far from a corner of the hull as that moves. */
static void any_triangle(const struct hull_pass *pass, vec3 v[3])
{
    const double size = power_in(&rng, -2.0, 1.0);
    const vec3 corner = pass->corner[random_bits(&rng) % pass->hull->corner_count];
    const vec3 at = add(corner, any_vector(pass->apart + power_in(&rng, -1.0, 0.5) * pass->moved));
    v[0] = at;
    v[1] = add(at, any_vector(size));
    v[2] = add(at, any_vector(size));
}

/* The plane of the pair at the beginning and at the end. */
static int is_parted_by_pairs(const struct hull_pass *pass, const vec3 v[3])
{
    vec3 normal[2];
    for (int end = 0; end < 2; end++) {
        struct hull_place place = { .a = pass->corner[0], .u = { 0, 0, 0 } };
        struct hull_pair found;
        straight_hull_at(pass->hull, pass->from, pass->to, pass->body, end, &place);
        if (!dpti_hull_triangle(&place, v, HUGE_VAL, &found) || !(found.pair.distance2 > 0.0))
            return 0;
        normal[end] = unit_of(found.pair.gap);
    }
    const struct hull_turn turn = dpti_hull_turn_of(pass, normal[0], normal[1]);
    return dpti_hull_turn_parts(&turn, v, pass->apart);
}

static void pass_one(const struct dpt_hull *hull)
{
    vec3 corner[2 * HULL_CORNERS_MAX], v[3], n = any_vector(1.0);
    dpt_pose poses[3] = { DPT_POSE_IDENTITY, DPT_POSE_IDENTITY, DPT_POSE_IDENTITY };
    struct frame frames[3];
    double moved = 0;
    turned(&poses[0], 3.0, 1.0, &poses[0]);
    turned(&poses[0], power_in(&rng, -3.0, -0.2), power_in(&rng, -4.0, -0.5), &poses[1]);
    turned(&poses[2], 3.0, 1.0, &poses[2]);
    for (int k = 0; k < 3; k++)
        frame_of_pose(&poses[k], &frames[k]);
    for (uint32_t i = 0; i < hull->corner_count; i++) {
        corner[i] = hull_corner_at(hull, i, &frames[0], &frames[2]);
        corner[hull->corner_count + i] = hull_corner_at(hull, i, &frames[1], &frames[2]);
        moved = fmax(moved, length(sub(corner[hull->corner_count + i], corner[i])));
    }
    const struct hull_pass pass = { .hull = hull,
                                    .from = &frames[0],
                                    .to = &frames[1],
                                    .body = &frames[2],
                                    .corner = corner,
                                    .moved = moved,
                                    .apart = one_in(&rng, 2) ? 0.0 : power_in(&rng, -2.0, 0.0) * moved };
    any_triangle(&pass, v);
    if (dpti_hull_ends_apart(&pass, v, &n))
        CHECK(distance_at(&pass, v, 1.0) > pass.apart - 1e-12, "they are not apart at the end");
    if (is_parted_by_pairs(&pass, v)) {
        counts.given++;
        judge(&pass, v, "pairs at both ends");
    }
    if (!dpti_hull_passes(&pass, v, &n)) {
        counts.none++;
        return;
    }
    if (dot(n, n) > 0.0)
        counts.still++;
    else
        counts.turning++;
    judge(&pass, v, dot(n, n) > 0.0 ? "a plane" : "a plane that turns");
}

static void planes_keep_them_apart(void)
{
    static struct made_hull made;
    for (int h = 0; h < HULLS; h++) {
        make_any_hull(&rng, 1.0, &made);
        for (unsigned long i = 0; made.hull && i < motions / HULLS; i++)
            pass_one(made.hull);
    }
    printf("    a plane %llu times, one that turns %llu, of given pairs %llu; none %llu\n",
           (unsigned long long)counts.still, (unsigned long long)counts.turning, (unsigned long long)counts.given,
           (unsigned long long)counts.none);
    CHECK(counts.still > motions / 50 && counts.turning > 0 && counts.given > motions / 50 &&
              counts.none > motions / 50,
          "too few");
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &motions, &rng);
    TEST(planes_keep_them_apart);
    return check_report();
}
