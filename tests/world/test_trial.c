/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Motions that are tried. The oracle walks the motion in 300 steps and asks for the nearest pair at each, without a
 * world: it cannot judge a touch between two of its steps that is nearer than their length, so it allows that.
 */
#include <math.h>

#include "dynpoint/compile.h"
#include "lib/fixture.h"
#include "lib/random.h"
#include "lib/rig.h"

enum { BODIES = 3, SEGMENTS = 2, STEPS = 300 };

static struct fixture meshes[BODIES];
static double diagonal[BODIES];

struct scene {
    struct rig rig;
    dpt_body body[BODIES];
    dpt_pose pose[BODIES];
    dpt_segment segment[SEGMENTS];
};

static void scene_open(struct scene *scene, uint64_t *random)
{
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    def.budget = random_bits(random) % 2 ? 50 : 0;
    rig_open(&scene->rig, &def, NULL, NULL, 0);
    for (int i = 0; i < BODIES; i++) {
        scene->pose[i] = pose_random(random, 0.1);
        scene->body[i] = rig_add_body(&scene->rig, meshes[i].mesh, &scene->pose[i]);
    }
    for (int i = 0; i < SEGMENTS; i++) {
        for (int k = 0; k < 3; k++) {
            scene->segment[i].a[k] = random_in(random, -0.05, 0.05);
            scene->segment[i].b[k] = random_in(random, -0.05, 0.05);
        }
        scene->segment[i].radius = i ? random_in(random, 0.0, 0.01) : 0.0;
    }
    rig_add_tool(&scene->rig, scene->segment, SEGMENTS);
}

/* The gap of those ends to the nearest body, from their axis. */
static double nearest(const struct scene *scene, const double ends[6], uint32_t *body)
{
    const dpt_query_def pair = { .size = sizeof pair, .pair = 1 };
    double least = HUGE_VAL;
    for (uint32_t i = 0; i < BODIES; i++) {
        dpt_hit hit = DPT_HIT_INIT;
        dpt_query_segments(meshes[i].mesh, &scene->pose[i], ends, NULL, 1, &hit, &pair);
        if (hit.distance < least) {
            least = hit.distance;
            *body = scene->body[i];
        }
    }
    return least;
}

/* The shortest turn, by sines: another way than the library's halving. */
static dpt_pose between(const dpt_pose *from, const dpt_pose *to, double t)
{
    dpt_pose pose;
    double cosine = 0.0, sign = 1.0, p = 1.0 - t, q = t;
    for (int k = 0; k < 4; k++)
        cosine += from->orientation[k] * to->orientation[k];
    if (cosine < 0.0)
        sign = -1.0;
    const double angle = acos(fmin(1.0, fabs(cosine)));
    if (angle > 1e-8) {
        p = sin((1.0 - t) * angle) / sin(angle);
        q = sin(t * angle) / sin(angle);
    }
    for (int k = 0; k < 3; k++)
        pose.position[k] = from->position[k] + t * (to->position[k] - from->position[k]);
    for (int k = 0; k < 4; k++)
        pose.orientation[k] = p * from->orientation[k] + sign * q * to->orientation[k];
    return pose;
}

static double largest_diagonal(void)
{
    return fmax(diagonal[0], fmax(diagonal[1], diagonal[2]));
}

/* How near the tool comes to a touch on the way up to `until`, negative if it goes past one. */
static double least_gap_until(const struct scene *scene, const dpt_pose *from, const dpt_pose *to, double until,
                              double clearance, double *step)
{
    double least = HUGE_VAL, before[6], ends[6];
    uint32_t body;
    *step = 0.0;
    for (int i = 0; i < SEGMENTS; i++)
        for (int k = 0; k <= STEPS; k++) {
            const dpt_pose pose = between(from, to, until * k / STEPS);
            const double size = fmax(0.0, scene->segment[i].radius + clearance);
            pose_ends(&pose, &scene->segment[i], ends);
            if (k > 0)
                for (int e = 0; e < 6; e += 3)
                    *step = fmax(*step, sqrt(pow(ends[e] - before[e], 2.0) + pow(ends[e + 1] - before[e + 1], 2.0) +
                                             pow(ends[e + 2] - before[e + 2], 2.0)));
            memcpy(before, ends, sizeof ends);
            if (k < STEPS || until == 1.0)
                least = fmin(least, nearest(scene, ends, &body) - size);
        }
    return least;
}

static void a_trial_stops_at_the_first_touch(void)
{
    uint64_t random = 11;
    int hits = 0, frees = 0, starts = 0, farthest = 0;
    const double tolerance = 1e-6 * largest_diagonal();
    for (int round = 0; round < 400; round++) {
        struct scene of;
        scene_open(&of, &random);
        const dpt_pose from = pose_random(&random, 0.15);
        dpt_pose to = pose_random(&random, 0.15), reached;
        const double share = round % 3 ? 0.1 : 1.0; /* short motions too */
        to = between(&from, &to, share);
        const double clearance = round % 4 ? random_in(&random, -0.004, 0.004) : 0.0;
        dpt_sweep first = { .size = sizeof first };
        dpt_tool_set_pose(of.rig.world, of.rig.tool, &from);
        void *copy = malloc(of.rig.world_bytes);
        memcpy(copy, of.rig.blocks[0], of.rig.world_bytes);
        CHECK(dpt_tool_try_pose(of.rig.world, of.rig.tool, &to, clearance, &first, &reached) == DPT_OK, "try");
        CHECK(!memcmp(copy, of.rig.blocks[0], of.rig.world_bytes), "a trial changed the world");
        free(copy);
        double step, gap = HUGE_VAL;
        uint32_t body = 0;
        const double way = least_gap_until(&of, &from, &to, first.time, clearance, &step);
        CHECK(way > -tolerance || first.time == 0.0, "round %d: %g m past a touch before time %g", round, -way,
              first.time);
        for (int i = 0; i < SEGMENTS; i++) {
            double ends[6];
            uint32_t at = 0;
            pose_ends(&reached, &of.segment[i], ends);
            const double here = nearest(&of, ends, &at) - fmax(0.0, of.segment[i].radius + clearance);
            if (here < gap) {
                gap = here;
                body = at;
            }
        }
        if (first.status == DPT_SWEEP_FREE) {
            CHECK(first.time == 1.0 && !memcmp(&reached, &to, sizeof to) && first.triangle == DPT_NONE,
                  "round %d: free, and not there", round);
            frees++;
        } else if (first.time == 0.0) {
            CHECK(gap <= tolerance && !memcmp(&reached, &from, sizeof from),
                  "round %d: a touch at the beginning, %g m away", round, gap);
            starts++;
        } else {
            hits++;
            CHECK(first.status == DPT_SWEEP_HIT && gap > 0.0 && gap <= tolerance,
                  "round %d: stopped %g m before the touch", round, gap);
            CHECK(first.body == body, "round %d: another body", round);
            const double normal =
                sqrt(pow(first.normal[0], 2.0) + pow(first.normal[1], 2.0) + pow(first.normal[2], 2.0));
            CHECK(fabs(normal - 1.0) < 1e-9 && first.age == 0, "round %d: normal %g", round, normal);
            farthest += first.segment == 1;
        }
        rig_close(&of.rig);
    }
    CHECK(hits > 60 && frees > 30 && starts > 30 && farthest > 10 && farthest < hits,
          "%d hits, %d free, %d at the beginning, %d of the second segment", hits, frees, starts, farthest);
}

/*
 * A speck, of 1 mm or less, lies where a point of the axis is at some time of a motion that jumps and turns: the motion meets it
 * by then. Tool and speck may turn.
 */
static void nothing_in_the_way_of_a_turn_is_missed(void)
{
    const int motions = (int)part_of(4000);
    static const double corners[9] = { 1e-3, 0, 0, -5e-4, 8e-4, 0, -5e-4, -8e-4, 0 };
    static const uint32_t triangle[3] = { 0, 1, 2 };
    uint64_t random = 5;
    uint32_t late = 0;
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    dpt_compiled file;
    const dpt_mesh *mesh;
    CHECK(dpt_compile_arrays(corners, 3, triangle, 1, NULL, &file, NULL) == DPT_OK &&
              dpt_mesh_open(file.bytes, file.size, &mesh) == DPT_OK,
          "the speck");
    for (int i = 0; i < motions; i++) {
        const double part = random_in(&random, 0.0, 1.0), s = random_in(&random, 0.0, 1.0);
        const double jump = i % 3 ? 0.0 : i % 2 ? 0.02 : 0.3;
        const dpt_segment axis = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.15 }, 0.0 };
        const dpt_pose from = pose_random(&random, 0.1);
        dpt_pose to = pose_random(&random, jump), at, reached, speck = pose_random(&random, 0.0);
        dpt_sweep first = { .size = sizeof first };
        struct rig rig;
        double ends[6];
        for (int k = 0; k < 3; k++)
            to.position[k] += from.position[k];
        at = between(&from, &to, part);
        pose_ends(&at, &axis, ends);
        for (int k = 0; k < 3; k++)
            speck.position[k] = ends[k] + s * (ends[3 + k] - ends[k]);
        rig_open(&rig, &def, NULL, &axis, 1);
        rig_add_body(&rig, mesh, &speck);
        CHECK(dpt_tool_teleport(rig.world, rig.tool, &from) == DPT_OK &&
                  dpt_tool_try_pose(rig.world, rig.tool, &to, 0.0, &first, &reached) == DPT_OK,
              "a trial");
        CHECK(first.status == DPT_SWEEP_HIT && first.time <= part + 1e-5, "motion %d: %u at %.9f, not by %.9f", i,
              first.status, first.time, part);
        late += first.time > part - 0.05;
        rig_close(&rig);
    }
    CHECK(late > (uint32_t)motions / 2, "%u were met about there", late);
    dpt_compiled_free(&file);
}

/* What a step says of the same motion. */
static void a_step_meets_the_same(void)
{
    uint64_t random = 21;
    int met = 0;
    for (int round = 0; round < 400; round++) {
        struct scene of;
        scene_open(&of, &random);
        const dpt_pose from = pose_random(&random, 0.15);
        dpt_pose to = pose_random(&random, 0.15);
        to = between(&from, &to, 0.2);
        rig_step_to(&of.rig, &from);
        rig_tick(&of.rig);
        dpt_sweep first = { .size = sizeof first };
        dpt_hit hit = DPT_HIT_INIT;
        int is_free = 1;
        for (uint32_t i = 0; i < SEGMENTS; i++) {
            dpt_tool_get_segment_hit(of.rig.world, of.rig.tool, i, &hit);
            is_free &= hit.status == DPT_STATUS_EXACT && hit.distance > of.segment[i].radius;
        }
        dpt_tool_try_pose(of.rig.world, of.rig.tool, &to, 0.0, &first, NULL);
        rig_step_to(&of.rig, &to);
        double time = 1.0;
        int told = 1;
        for (uint32_t i = 0; i < SEGMENTS; i++) {
            dpt_sweep sweep = { .size = sizeof sweep };
            dpt_tool_get_sweep(of.rig.world, of.rig.tool, i, &sweep);
            told &= sweep.status == DPT_SWEEP_FREE || sweep.status == DPT_SWEEP_HIT;
            if (sweep.status == DPT_SWEEP_HIT)
                time = fmin(time, sweep.time);
        }
        if (is_free && told) {
            met += first.status == DPT_SWEEP_HIT;
            CHECK(fabs(first.time - time) < 1e-3, "round %d: %.9g, the step says %.9g", round, first.time, time);
        }
        rig_close(&of.rig);
    }
    CHECK(met > 20, "%d met something", met);
}

static void free_segments_too(void)
{
    uint64_t random = 31;
    int hits = 0;
    for (int round = 0; round < 200; round++) {
        struct scene of;
        dpt_segment from[SEGMENTS], to[SEGMENTS], reached[SEGMENTS];
        dpt_sweep first = { .size = sizeof first };
        scene_open(&of, &random);
        const dpt_pose at = pose_random(&random, 0.15), there = pose_random(&random, 0.15);
        for (int i = 0; i < SEGMENTS; i++) {
            from[i] = pose_segment(&at, &of.segment[i]);
            to[i] = pose_segment(&there, &of.segment[i]);
        }
        dpt_tool_set_segments(of.rig.world, of.rig.tool, from, SEGMENTS);
        memcpy(reached, to, sizeof to);
        CHECK(dpt_tool_try_segments(of.rig.world, of.rig.tool, reached, SEGMENTS, 0.001, &first, reached) == DPT_OK,
              "try");
        if (first.status == DPT_SWEEP_FREE)
            CHECK(!memcmp(reached, to, sizeof to), "round %d: not there", round);
        if (first.status == DPT_SWEEP_HIT && first.time > 0.0) {
            const dpt_segment *touched = &reached[first.segment];
            double ends[6];
            uint32_t body = 0;
            memcpy(ends, touched->a, 3 * sizeof *ends);
            memcpy(ends + 3, touched->b, 3 * sizeof *ends);
            const double gap = nearest(&of, ends, &body) - touched->radius - 0.001;
            CHECK(gap > 0.0 && gap < 1e-6 * largest_diagonal() && body == first.body, "round %d: %g m before the touch",
                  round, gap);
            hits++;
        }
        rig_close(&of.rig);
    }
    CHECK(hits > 30, "%d hits", hits);
}

static void what_cannot_be_tried(void)
{
    uint64_t random = 41;
    struct scene of;
    scene_open(&of, &random);
    const dpt_pose far = { { 5.0, 0.0, 0.0 }, { 1.0, 0.0, 0.0, 0.0 } };
    dpt_pose wrong = far, reached = far;
    dpt_sweep first = { .size = sizeof first, .status = 77 };
    dpt_segment segments[SEGMENTS];
    memcpy(segments, of.segment, sizeof segments);
    dpt_tool_set_pose(of.rig.world, of.rig.tool, &far);
    wrong.orientation[0] = 2.0;
#define REFUSED(call, code) CHECK((call) == (code) && first.status == 77, #call)
    REFUSED(dpt_tool_try_pose(of.rig.world, of.rig.tool, &wrong, 0.0, &first, NULL), DPT_E_POSE);
    wrong.position[1] = NAN;
    REFUSED(dpt_tool_try_pose(of.rig.world, of.rig.tool, &wrong, 0.0, &first, NULL), DPT_E_FINITE);
    REFUSED(dpt_tool_try_pose(of.rig.world, of.rig.tool, NULL, 0.0, &first, NULL), DPT_E_ARGUMENT);
    REFUSED(dpt_tool_try_pose(NULL, of.rig.tool, &far, 0.0, &first, NULL), DPT_E_ARGUMENT);
    REFUSED(dpt_tool_try_pose(of.rig.world, of.body[0], &far, 0.0, &first, NULL), DPT_E_HANDLE);
    REFUSED(dpt_tool_try_pose(of.rig.world, of.rig.tool, &far, NAN, &first, NULL), DPT_E_FINITE);
    REFUSED(dpt_tool_try_segments(of.rig.world, of.rig.tool, segments, 1, 0.0, &first, NULL), DPT_E_ARGUMENT);
    REFUSED(dpt_tool_try_segments(of.rig.world, of.rig.tool, NULL, SEGMENTS, 0.0, &first, NULL), DPT_E_ARGUMENT);
    segments[1].radius = -1.0;
    REFUSED(dpt_tool_try_segments(of.rig.world, of.rig.tool, segments, SEGMENTS, 0.0, &first, NULL), DPT_E_FINITE);
    CHECK(dpt_tool_try_pose(of.rig.world, of.rig.tool, &far, 0.0, NULL, NULL) == DPT_OK, "no outputs");

    /* Nobody knows where a body is. */
    dpt_body_set_pose(of.rig.world, of.body[1], &wrong);
    CHECK(dpt_tool_try_pose(of.rig.world, of.rig.tool, &of.pose[0], 0.0, &first, &reached) == DPT_OK &&
              first.status == DPT_SWEEP_NONE && first.time == 0.0 && !memcmp(&reached, &far, sizeof far),
          "a body's pose is not valid: %u", first.status);
    dpt_body_remove(of.rig.world, of.body[1]);
    CHECK(dpt_tool_try_pose(of.rig.world, of.rig.tool, &far, 0.0, &first, &reached) == DPT_OK &&
              first.status == DPT_SWEEP_FREE && first.time == 1.0,
          "it is gone: %u", first.status);
    dpt_tool_set_pose(of.rig.world, of.rig.tool, &wrong);
    CHECK(dpt_tool_try_pose(of.rig.world, of.rig.tool, &far, 0.0, &first, NULL) == DPT_OK &&
              first.status == DPT_SWEEP_NONE,
          "the tool's pose is not valid: %u", first.status);

    /* It is where it could be last. */
    dpt_segment there[SEGMENTS];
    CHECK(dpt_tool_try_segments(of.rig.world, of.rig.tool, of.segment, SEGMENTS, 0.0, &first, there) == DPT_OK &&
              first.status == DPT_SWEEP_NONE && first.time == 0.0 &&
              there[0].a[0] == far.position[0] + of.segment[0].a[0],
          "it is at x = %g", there[0].a[0]);
    rig_close(&of.rig);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    static const struct {
        const char *name;
        uint64_t triangles;
    } shapes[BODIES] = { { "torus", 1000 }, { "membrane", 0 }, { "box", 12 } };
    for (int i = 0; i < BODIES; i++) {
        dpt_mesh_info info = { .size = sizeof info };
        if (!fixture_from_shape(&meshes[i], shapes[i].name, shapes[i].triangles))
            return 2;
        dpt_mesh_get_info(meshes[i].mesh, &info);
        for (int k = 0; k < 3; k++)
            diagonal[i] += pow(info.box_max[k] - info.box_min[k], 2.0);
        diagonal[i] = sqrt(diagonal[i]);
    }
    TEST(a_trial_stops_at_the_first_touch);
    TEST(nothing_in_the_way_of_a_turn_is_missed);
    TEST(a_step_meets_the_same);
    TEST(free_segments_too);
    TEST(what_cannot_be_tried);
    for (int i = 0; i < BODIES; i++)
        fixture_free(&meshes[i]);
    return check_report();
}
