/* SPDX-License-Identifier: BSD-3-Clause */
#include "hull/hull_motion.h"

#include "base/quaternion.h"

double throw_radius(const struct hull_throw *thrown)
{
    return max_of(thrown->made->hull->radius + thrown->clearance, 0.0);
}

struct oracle_interval throw_distance(const struct hull_throw *thrown, double time, uint32_t triangle, double limit)
{
    double corners[3 * ORACLE_CORNERS], one[9];
    const struct oracle_hull *as = &thrown->made->as;
    oracle_motion_at(&thrown->motion, time, as->corner[0], as->corner_count, corners);
    if (triangle == DPT_NONE)
        return oracle_hull_surface(corners, as->corner_count, thrown->triangles, time, limit, NULL);
    oracle_triangle_at(thrown->triangles, triangle, time, one);
    return oracle_hull_triangle(corners, as->corner_count, one, NULL);
}

static vec3 any_direction(const struct hull_throw *thrown, uint64_t *random)
{
    const double *c = thrown->triangles->corners + 9 * (size_t)whole_in(random, 0, thrown->triangles->count - 1);
    const vec3 a = vec3_of(c), n = cross(sub(vec3_of(c + 3), a), sub(vec3_of(c + 6), a));
    return one_in(random, 2) && length(n) > 0.0 ? scaled(unit_of(n), one_in(random, 2) ? 1.0 : -1.0) : any_unit(random);
}

void throw_sweep(uint64_t *random, struct hull_throw *thrown, uint32_t work)
{
    vec3 directions[SWEEP_DIRECTIONS_MAX];
    struct work meter = work_of(work);
    for (int i = 0; i < SWEEP_DIRECTIONS_MAX; i++)
        directions[i] = any_direction(thrown, random);
    struct hull_sweep sweep = { .surface = thrown->surface,
                                .kernel = thrown->kernel,
                                .hull = thrown->made->hull,
                                .clearance = thrown->clearance,
                                .tolerance = thrown->tolerance,
                                .resolution = thrown->resolution,
                                .tick = thrown->tick,
                                .tick_from = thrown->tick_from,
                                .directions = directions,
                                .direction_count = whole_in(random, 0, SWEEP_DIRECTIONS_MAX),
                                .work = &meter,
                                .triangle = DPT_NONE,
                                .time = -1.0 };
    if (one_in(random, 2))
        sweep.triangle = whole_in(random, 0, thrown->triangles->count - 1);
    if (!sweep.direction_count)
        sweep.directions = NULL;
    const struct placement from = { .tool = thrown->motion.tool_from, .body = thrown->motion.body_from };
    const struct placement to = { .tool = thrown->motion.tool_to, .body = thrown->motion.body_to };
    thrown->status = dpti_hull_sweep(&sweep, &from, &to);
    thrown->time = sweep.time;
    thrown->triangle = sweep.triangle;
    thrown->work = meter.done;
}

static const char *throw_text(const struct hull_throw *thrown)
{
    static char text[16000];
    const dpt_pose *poses = &thrown->motion.tool_from;
    size_t length = 0;
    for (int i = 0; i < 4; i++) {
        const double *p = poses[i].position, *q = poses[i].orientation;
        length += (size_t)snprintf(text + length, sizeof text - length, "pose %a,%a,%a, %a,%a,%a,%a; ", p[0], p[1],
                                   p[2], q[0], q[1], q[2], q[3]);
    }
    snprintf(text + length, sizeof text - length, "radius %a, clearance %a, tolerance %a, hull %s",
             thrown->made->hull->radius, thrown->clearance, thrown->tolerance,
             points_text(thrown->made->as.corner[0], thrown->made->as.corner_count));
    return text;
}

/* Not met at this time, which is before that of the answer. */
static void check_free_at(const struct hull_throw *thrown, double time)
{
    const double radius = throw_radius(thrown);
    if (!(time >= 0.0 && time < thrown->time))
        return;
    const struct oracle_interval apart = throw_distance(thrown, time, DPT_NONE, radius + thrown->tolerance);
    CHECK(apart.upper > radius - thrown->noise, "status %d, free until %.17g, and met at %.17g: %g of %g: %s",
          thrown->status, thrown->time, time, apart.upper, radius, throw_text(thrown));
}

/* Returns 1 if the two come as near as half of the tolerance before that time. */
static int check_free(const struct hull_throw *thrown)
{
    const struct oracle_hull *as = &thrown->made->as;
    const double slack = max_of(0.5 * thrown->tolerance, thrown->noise);
    for (int i = 0; i < 9; i++)
        check_free_at(thrown, thrown->time * i / 9.0);
    for (int i = 1; i < 14; i += 3)
        check_free_at(thrown, thrown->time * (1.0 - pow(10.0, -i)));
    const struct oracle_meeting meeting = oracle_first_meeting(&thrown->motion, as->corner[0], as->corner_count,
                                                               thrown->triangles, throw_radius(thrown), slack, 60);
    if (!(meeting.free_until < thrown->time))
        return meeting.met_at < 1.5;
    for (double step = 1e-9; step < 1.0; step *= 2.0)
        check_free_at(thrown, meeting.free_until + step);
    return meeting.met_at < 1.5;
}

static void check_status(const struct hull_throw *thrown)
{
    const int status = thrown->status;
    CHECK(thrown->time >= 0.0 && thrown->time <= 1.0, "time %g", thrown->time);
    CHECK(status == SWEEP_FREE || status == SWEEP_HIT || status == SWEEP_UNFINISHED, "%d", status);
    CHECK(status != SWEEP_FREE || thrown->time == 1.0, "free until %g", thrown->time);
    CHECK(status != SWEEP_HIT || thrown->triangle < thrown->triangles->count, "triangle %u", thrown->triangle);
}

/* m: how far hull and triangle may go in the time that the resolution leaves open. */
static double way_left_open(const struct hull_throw *thrown)
{
    const struct oracle_hull *as = &thrown->made->as;
    const double speed = oracle_motion_speed(&thrown->motion, as->corner[0], as->corner_count);
    double fastest = 0.0;
    for (uint32_t k = 0; k < 9 && thrown->triangles->shift; k += 3)
        fastest = max_of(fastest, length(vec3_of(thrown->triangles->shift + 9 * (size_t)thrown->triangle + k)));
    return thrown->resolution * (speed + fastest);
}

/* How far the triangle of a hit is beyond the radius, and what the resolution leaves open, in tolerances. */
static double check_hit(const struct hull_throw *thrown)
{
    if (thrown->status != SWEEP_HIT || thrown->triangle >= thrown->triangles->count)
        return 0.0;
    const double apart = throw_distance(thrown, thrown->time, thrown->triangle, HUGE_VAL).lower;
    const double beyond = apart - throw_radius(thrown) - way_left_open(thrown);
    CHECK(beyond <= 2.0 * thrown->tolerance + thrown->noise, "hit at %.17g, %g tolerances beyond: %s", thrown->time,
          beyond / thrown->tolerance, throw_text(thrown));
    return beyond / thrown->tolerance;
}

void check_throw(uint64_t *random, struct hull_throw *thrown, struct throw_tally *tally)
{
    thrown->resolution = one_in(random, 3) ? power_in(random, -4.0, -0.3) : 0.0;
    throw_sweep(random, thrown, WORK_UNLIMITED);
    CHECK(thrown->status != SWEEP_UNFINISHED, "unfinished, of any work");
    check_status(thrown);
    const int is_near = check_free(thrown);
    tally->worst = max_of(tally->worst, check_hit(thrown));
    tally->throws++;
    tally->hits += thrown->status == SWEEP_HIT;
    tally->at_once += thrown->status == SWEEP_HIT && thrown->time == 0.0;
    tally->near_misses += thrown->status == SWEEP_FREE && is_near;
    tally->work += thrown->work;
    if (!one_in(random, 4))
        return;
    struct hull_throw little = *thrown;
    const uint32_t most = whole_in(random, 1, thrown->work);
    throw_sweep(random, &little, most);
    check_status(&little);
    CHECK(little.work <= most + WORK_COUNTED_ON, "%u units of %u", little.work, most);
    check_free(&little);
    check_hit(&little);
    tally->unfinished += little.status == SWEEP_UNFINISHED;
}

void print_throws(const char *name, const struct throw_tally *tally)
{
    printf("    %-10s %6lu throws, %6lu hits, %5lu at once, %4lu near misses, %5lu unfinished, "
           "worst %.3f tolerances, %.1f units\n",
           name, tally->throws, tally->hits, tally->at_once, tally->near_misses, tally->unfinished, tally->worst,
           tally->work / (double)tally->throws);
}

dpt_pose pose_in(const dpt_pose *body, const dpt_pose *at)
{
    dpt_pose pose;
    struct frame frame;
    frame_of_pose(body, &frame);
    vec3_store(frame_to_world(&frame, vec3_of(at->position)), pose.position);
    quaternion_store(
        quaternion_unit(quaternion_product(quaternion_of(body->orientation), quaternion_of(at->orientation))),
        pose.orientation);
    return pose;
}
