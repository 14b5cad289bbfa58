/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The nearest pair of a hull and a mesh against the oracle, which looks at every triangle: hulls of all kinds near, far
 * and through, that jump, and that walk with the last triangle as a hint; limits; and searches that end early. Meshes
 * that `dynpoint make` knows, and organs below DPT_DATA.
 *
 *     test_hull_search [POSES = 1000000] [SEED = 1]
 */
#include "hull/hull_body.h"
#include "hull/hull_search.h"

static unsigned long pose_count = 1000000;
static uint64_t rng = 1;

/* A hull that jumps and walks about a body, both of them anywhere in the world. */
struct walker {
    struct made_hull made;
    dpt_pose tool, body;
    struct frame tool_frame, body_frame;
    struct hull_place place;
    double corners[3 * HULL_CORNERS_MAX]; /* in the body's frame, as it is placed */
    double exact[3 * HULL_CORNERS_MAX];   /* by the oracle, of the poses */
    uint32_t last;                        /* the triangle that was nearest */
};

struct tally {
    unsigned long poses, meet, hinted, ended;
    double worst, work;
};

static void place_walker(struct walker *walker)
{
    const struct oracle_motion still = { walker->tool, walker->tool, walker->body, walker->body };
    frame_of_pose(&walker->tool, &walker->tool_frame);
    frame_of_pose(&walker->body, &walker->body_frame);
    hull_place_set(&walker->place, walker->made.hull, &walker->tool_frame, &walker->body_frame);
    const uint32_t count = walker->made.as.corner_count;
    for (uint32_t i = 0; i < count; i++)
        vec3_store(walker->place.corner[i], walker->corners + 3 * i);
    oracle_motion_at(&still, 0.0, walker->made.as.corner[0], count, walker->exact);
}

/* A hull of another size, at the surface, near it or far away. */
static void jump(const struct hull_body *body, struct walker *walker)
{
    const double size = body->diagonal * power_in(&rng, -2.5, -0.2);
    vec3 n;
    const vec3 x = body_place(body, &rng, &n);
    const double off = one_in(&rng, 8)   ? 0.0
                       : one_in(&rng, 4) ? body->diagonal * power_in(&rng, -0.5, 1.0)
                                         : size * power_in(&rng, -1.0, 0.5);
    make_any_hull(&rng, size, &walker->made);
    walker->body = (dpt_pose)DPT_POSE_IDENTITY;
    if (one_in(&rng, 2))
        walker->body = any_pose(&rng, body->diagonal);
    walker->tool = any_pose(&rng, 0.0);
    struct frame frame;
    frame_of_pose(&walker->body, &frame);
    vec3_store(frame_to_world(&frame, along(x, one_in(&rng, 6) ? -off : off, n)), walker->tool.position);
    walker->last = DPT_NONE;
}

/* On by a step, turned by a little. */
static void step(const struct hull_body *body, struct walker *walker)
{
    const double far = one_in(&rng, 2) ? 1e-3 * body->diagonal : 0.1 * walker->made.size;
    const vec3 by = scaled(any_unit(&rng), far * random_in(&rng, 0.0, 1.0));
    vec3_store(add(vec3_of(walker->tool.position), by), walker->tool.position);
    const vec3 turn = any_in(&rng, 0.02);
    double *q = walker->tool.orientation, square = 0.0;
    for (int k = 0; k < 3; k++)
        q[1 + k] += (&turn.x)[k];
    for (int k = 0; k < 4; k++)
        square += q[k] * q[k];
    for (int k = 0; k < 4; k++)
        q[k] /= sqrt(square);
}

static struct hull_nearest ask(const struct hull_body *body, const struct walker *walker, uint32_t hint, double limit,
                               struct work *work, int *is_proven)
{
    struct hull_nearest nearest;
    memset(&nearest, 0xff, sizeof nearest);
    *is_proven = dpti_hull_search(&body->surface, &body->kernel, &walker->place, hint, limit, work, &nearest);
    return nearest;
}

/* The pair that was found is one of that triangle, as far apart as it says. */
static void check_found(const struct hull_body *body, const struct walker *walker, const struct hull_nearest *nearest,
                        double bound)
{
    const double *w = nearest->found.pair.weight;
    CHECK(nearest->triangle < body->triangles.count, "triangle %u", nearest->triangle);
    if (nearest->triangle >= body->triangles.count)
        return;
    const double *c = body->corners + 9 * (size_t)nearest->triangle;
    const struct oracle_interval own = oracle_hull_triangle(walker->corners, walker->made.as.corner_count, c, NULL);
    CHECK(nearest->distance >= own.lower - bound && nearest->distance <= own.upper + bound,
          "%.17g, its triangle is at %.17g", nearest->distance, own.lower);
    CHECK(fabs(sqrt(nearest->found.pair.distance2) - nearest->distance) <= bound &&
              fabs(length(nearest->found.pair.gap) - nearest->distance) <= bound,
          "pair %g, gap %g, distance %g", sqrt(nearest->found.pair.distance2), length(nearest->found.pair.gap),
          nearest->distance);
    CHECK(w[0] >= 0.0 && w[1] >= 0.0 && w[2] >= 0.0 && fabs(w[0] + w[1] + w[2] - 1.0) < 1e-9, "weights %g, %g, %g",
          w[0], w[1], w[2]);
}

/* Nearer than a limit there is one, or none. */
static void check_limit(const struct hull_body *body, const struct walker *walker, uint32_t hint, double distance,
                        double bound)
{
    int is_proven;
    struct work work = work_of(WORK_UNLIMITED);
    const double limit = distance * random_in(&rng, 0.0, 2.0);
    const struct hull_nearest nearest = ask(body, walker, hint, limit, &work, &is_proven);
    CHECK(is_proven, "not proven");
    if (fabs(limit - distance) <= bound)
        return;
    CHECK((nearest.triangle == DPT_NONE) == (distance > limit), "triangle %u, %g, limit %g", nearest.triangle, distance,
          limit);
    if (nearest.triangle != DPT_NONE)
        CHECK(fabs(nearest.distance - distance) <= bound, "%g, not %g, limit %g", nearest.distance, distance, limit);
}

/* With little work it says so, and what it says is no less than the truth; with twice as much it comes to an end. */
static unsigned long check_budget(const struct hull_body *body, const struct walker *walker, double distance,
                                  double bound)
{
    uint32_t most = 1, hint = DPT_NONE;
    unsigned long ended = 0;
    int is_whole;
    struct work whole = work_of(WORK_UNLIMITED);
    ask(body, walker, DPT_NONE, HUGE_VAL, &whole, &is_whole);
    const uint32_t full = whole.done;
    for (;; most += 1 + most / 2) {
        int is_proven;
        struct work work = { 7, 7 + most };
        const struct hull_nearest nearest = ask(body, walker, hint, HUGE_VAL, &work, &is_proven);
        if (nearest.triangle != DPT_NONE) {
            CHECK(nearest.distance >= distance - bound, "%g, less than %g", nearest.distance, distance);
            check_found(body, walker, &nearest, bound);
            hint = nearest.triangle;
        }
        CHECK(work.done - 7 <= most + WORK_COUNTED_ON, "%u units of %u", work.done - 7, most);
        if (is_proven) {
            CHECK(fabs(nearest.distance - distance) <= bound, "%g, not %g, of %u units", nearest.distance, distance,
                  most);
            return ended;
        }
        ended++;
        CHECK(work_left(&work) == 0 || most <= WORK_COUNTED_ON, "%u of %u units left", work_left(&work), most);
        CHECK(most <= 4 * full + 4000, "%u units do not suffice, %u did", most, full);
        if (most > 4 * full + 4000)
            return ended;
    }
}

static void check_pose(const struct hull_body *body, struct walker *walker, struct tally *tally)
{
    int is_proven;
    struct work work = work_of(WORK_UNLIMITED);
    const double bound = dpti_hull_error(&walker->place, &body->surface, &walker->tool_frame, &walker->body_frame);
    const uint32_t hint = walker->last;
    const struct hull_nearest nearest = ask(body, walker, hint, HUGE_VAL, &work, &is_proven);
    const double distance = nearest.distance;
    CHECK(is_proven, "not proven");
    CHECK(bound > 0.0 && bound < 1e-12 * (body->diagonal + walker->made.size + extent_of(walker->tool_frame.origin) +
                                          extent_of(walker->body_frame.origin) + dpti_surface_extent(&body->surface)),
          "error %g", bound);
    const struct oracle_interval truth =
        oracle_hull_surface(walker->exact, walker->made.as.corner_count, &body->triangles, 0.0, HUGE_VAL, NULL);
    const double error = max_of(truth.lower - distance, distance - truth.upper);
    CHECK(error <= bound, "%s: %.17g, not %.17g..%.17g: %g bounds; hint %u", body->name, distance, truth.lower,
          truth.upper, error / bound, hint);
    check_found(body, walker, &nearest, bound);
    if (hint != DPT_NONE || one_in(&rng, 4)) {
        const uint32_t other = one_in(&rng, 2) ? whole_in(&rng, 0, body->triangles.count - 1) : DPT_NONE;
        struct work again = work_of(WORK_UNLIMITED);
        const struct hull_nearest same = ask(body, walker, other, HUGE_VAL, &again, &is_proven);
        CHECK(is_proven && fabs(same.distance - distance) <= bound, "%g, with hint %u %g", distance, other,
              same.distance);
        tally->hinted++;
    }
    if (one_in(&rng, 4))
        check_limit(body, walker, one_in(&rng, 2) ? nearest.triangle : DPT_NONE, distance, bound);
    if (one_in(&rng, 16))
        tally->ended += check_budget(body, walker, distance, bound);
    walker->last = nearest.triangle;
    tally->poses++;
    tally->meet += distance == 0.0;
    tally->worst = max_of(tally->worst, error / bound);
    tally->work += work.done;
}

/* Of a few poses all may be near one body without meeting it: over all bodies some meet and some do not. */
static struct tally all;

static void search_body(const struct hull_body *body, unsigned long poses)
{
    static struct walker walker;
    struct tally tally = { .poses = 0 };
    for (unsigned long i = 0; i < poses; i++) {
        if (i % 4 == 0)
            jump(body, &walker);
        else
            step(body, &walker);
        place_walker(&walker);
        check_pose(body, &walker, &tally);
    }
    printf("    %-24s %7lu poses, %6lu meet, %5lu ended early, worst %.3f bounds, %6.1f units\n", body->name,
           tally.poses, tally.meet, tally.ended, tally.worst, tally.work / (double)tally.poses);
    all.meet += tally.meet;
    all.poses += tally.poses;
}

static void some_meet(void)
{
    CHECK(all.meet > all.poses / 20 && all.meet < all.poses, "%lu of %lu meet", all.meet, all.poses);
    all.meet = all.poses = 0;
}

static void meshes_are_searched_exactly(void)
{
    static const struct {
        const char *shape;
        uint64_t count;
    } subjects[] = { { "liver", 1500 }, { "torus", 5568 },   { "star", 2000 },
                     { "cloth", 1800 }, { "membrane", 512 }, { "box", 12 } };
    const size_t count = sizeof subjects / sizeof *subjects;
    for (size_t i = 0; i < count; i++) {
        struct hull_body body;
        if (!body_from_shape(&body, subjects[i].shape, subjects[i].count))
            continue;
        search_body(&body, 1 + pose_count / count);
        body_close(&body);
    }
    some_meet();
}

/* Twenty times fewer: there are more triangles to look at. */
static void organs_are_searched_exactly(void)
{
    static const char *const organs[] = { "gallbladder_low.stl", "liver_dirty_low.stl", "liver_sofa.obj",
                                          "vessel_open_ends.stl", "openhelp_scene_low.stl" };
    const char *data = getenv("DPT_DATA");
    const size_t count = sizeof organs / sizeof *organs;
    for (size_t i = 0; i < count; i++) {
        struct hull_body body;
        if (!data) {
            SKIP(organs[i], "DPT_DATA is not set");
            continue;
        }
        if (!body_from_data(&body, data, organs[i]))
            continue;
        search_body(&body, 20 + pose_count / (20 * count));
        body_close(&body);
    }
    if (data)
        some_meet();
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &pose_count, &rng);
    TEST(meshes_are_searched_exactly);
    TEST(organs_are_searched_exactly);
    return check_report();
}
