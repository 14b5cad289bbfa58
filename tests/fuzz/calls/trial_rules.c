/* SPDX-License-Identifier: BSD-3-Clause */
#include "fuzz/calls/trial_rules.h"

#include "fuzz/calls/deform_model.h"
#include "fuzz/calls/rules.h"

/* Roundings of the test's own sums, per metre of the largest coordinate; on a turn by sines. */
static const double ROUNDING = 1e-13, TURNING = 1e-9;

/*
 * A touch may be told that early, of a mesh's diagonal (contact.h). A turn is followed in at most 1024 straight pieces
 * (docs/algorithms/swept_motion.md): of a long tool's turn each is farther off than that.
 */
static const double EARLY = 1e-6, PIECES = 1024.0;

int trial_is_known(const struct trial *trial)
{
    int is_known = trial->tool->is_usable;
    for (uint32_t i = 0; i < trial->scene->body_count; i++)
        is_known &= trial->scene->body[i].is_usable || trial->scene->body[i].unfelt;
    return is_known;
}

static double radius_of(const struct trial *trial, uint32_t i)
{
    return trial->by_pose ? trial->tool->segment[i].radius : trial->segment[i].radius;
}

static double size_of_touch(const struct trial *trial, uint32_t i)
{
    return fmax(0.0, radius_of(trial, i) + trial->clearance);
}

int trial_is_of_axes(const struct trial *trial)
{
    for (uint32_t i = 0; i < trial->tool->count; i++)
        if (radius_of(trial, i) + trial->clearance > 0.0)
            return 0;
    return trial->clearance < 0.0;
}

/* ---- the motion ---- */

static double largest(const double *numbers, int count, double most)
{
    for (int k = 0; k < count; k++)
        most = fmax(most, fabs(numbers[k]));
    return most;
}

static double extent_of(const struct trial *trial)
{
    const struct model_tool *tool = trial->tool;
    double extent = largest(tool->pose.position, 3, 1.0), reach = 0.0;
    if (trial->by_pose)
        extent = largest(trial->pose.position, 3, extent);
    for (uint32_t i = 0; i < tool->count; i++) {
        reach = largest(tool->segment[i].a, 6, reach);
        if (!trial->by_pose)
            extent = largest(trial->segment[i].a, 6, extent);
    }
    for (uint32_t i = 0; i < trial->scene->body_count; i++)
        extent = largest(trial->scene->body[i].pose.position, 3, extent);
    return extent + 2.0 * reach;
}

/* The shortest turn, by sines: another way than the library's. */
static void turn_between(const double *from, const double *to, double t, double *q)
{
    double cosine = 0.0, size_from = 0.0, size_to = 0.0, sign = 1.0;
    for (int k = 0; k < 4; k++) {
        cosine += from[k] * to[k];
        size_from += from[k] * from[k];
        size_to += to[k] * to[k];
    }
    cosine /= sqrt(size_from * size_to);
    if (cosine < 0.0)
        sign = -1.0;
    const double angle = acos(fmin(1.0, fabs(cosine)));
    double p = 1.0 - t, r = t;
    if (angle > 1e-6) {
        p = sin((1.0 - t) * angle) / sin(angle);
        r = sin(t * angle) / sin(angle);
    }
    for (int k = 0; k < 4; k++)
        q[k] = p * from[k] / sqrt(size_from) + sign * r * to[k] / sqrt(size_to);
}

static dpt_pose pose_at(const struct trial *trial, double t)
{
    const dpt_pose *from = &trial->tool->pose, *to = &trial->pose;
    dpt_pose pose;
    if (t <= 0.0 || t >= 1.0)
        return t <= 0.0 ? *from : *to;
    for (int k = 0; k < 3; k++)
        pose.position[k] = from->position[k] + t * (to->position[k] - from->position[k]);
    turn_between(from->orientation, to->orientation, t, pose.orientation);
    return pose;
}

static void put(const dpt_pose *pose, const dpt_segment *segment, dpt_segment *at)
{
    to_world(pose, segment->a, at->a);
    to_world(pose, segment->b, at->b);
    at->radius = segment->radius;
}

/* Segment i in the world on its way. */
static dpt_segment segment_at(const struct trial *trial, uint32_t i, double t)
{
    dpt_segment at;
    if (trial->by_pose) {
        const dpt_pose pose = pose_at(trial, t);
        put(&pose, &trial->tool->segment[i], &at);
        return at;
    }
    const dpt_segment *to = &trial->segment[i];
    put(&trial->tool->pose, &trial->tool->segment[i], &at);
    for (int k = 0; k < 3; k++) {
        at.a[k] = t >= 1.0 ? to->a[k] : at.a[k] + t * (to->a[k] - at.a[k]);
        at.b[k] = t >= 1.0 ? to->b[k] : at.b[k] + t * (to->b[k] - at.b[k]);
    }
    at.radius = to->radius;
    return at;
}

/* ---- what is told ---- */

static void place_must_hold(const struct trial *trial, double time, const dpt_pose *pose, const dpt_segment *segments)
{
    const double slack = ROUNDING * extent_of(trial);
    if (pose) {
        const dpt_pose expected = pose_at(trial, time);
        double same = 0.0, size = 0.0;
        HOLDS((time > 0.0 && time < 1.0) || !memcmp(pose, &expected, sizeof expected),
              "at time %g it is not where it was or will be", time);
        for (int k = 0; k < 4; k++) {
            same += pose->orientation[k] * expected.orientation[k];
            size += pose->orientation[k] * pose->orientation[k];
        }
        HOLDS(apart(pose->position, expected.position) <= slack && fabs(same) > 1.0 - 1e-5 &&
                  fabs(sqrt(size) - 1.0) <= 1e-6,
              "%g m from its way, turned by a cosine of %.17g", apart(pose->position, expected.position), same);
    }
    for (uint32_t i = 0; segments && i < trial->tool->count; i++) {
        const dpt_segment expected = segment_at(trial, i, time);
        HOLDS(time < 1.0 || !memcmp(&segments[i], &expected, sizeof expected), "segment %u is not where it will be", i);
        HOLDS(apart(segments[i].a, expected.a) <= slack && apart(segments[i].b, expected.b) <= slack &&
                  segments[i].radius == expected.radius,
              "segment %u is %g m from its way at time %g; usable %d, free %d", i, apart(segments[i].a, expected.a),
              time, trial->tool->is_usable, trial->tool->is_free);
    }
}

static void touch_must_hold(const struct trial *trial, const dpt_sweep *first)
{
    const struct model_body *body = scene_body((struct scene *)(uintptr_t)trial->scene, first->body);
    const double zero[3] = { 0.0, 0.0, 0.0 };
    HOLDS(body, "there is no body %x", first->body);
    HOLDS(first->segment < trial->tool->count, "segment %u", first->segment);
    triangle_must_be_there(body->subject, first->triangle);
    HOLDS(first->time >= 0.0 && first->time <= 1.0 && first->s >= 0.0 && first->s <= 1.0 && first->age == 0,
          "time %g, s %g, age %u", first->time, first->s, first->age);
    const double normal = apart(first->normal, zero);
    const int may_lack = body->soft && may_lack_normals(body->soft->now, body->soft->is_affine);
    HOLDS(fabs(normal - 1.0) <= 1e-6 || (normal == 0.0 && (first->time == 0.0 || may_lack)),
          "a normal of length %g at time %g", normal, first->time);
}

void trial_must_hold(const struct trial *trial, const dpt_sweep *first, const dpt_pose *pose,
                     const dpt_segment *segments)
{
    const double zero[3] = { 0.0, 0.0, 0.0 };
    const int is_known = trial_is_known(trial);
    HOLDS((first->status == DPT_SWEEP_NONE) == !is_known && first->status <= DPT_SWEEP_HIT, "status %u", first->status);
    place_must_hold(trial, first->time, pose, segments);
    if (first->status == DPT_SWEEP_HIT) {
        touch_must_hold(trial, first);
        met[first->time > 0.0 ? MET_TRIED_HIT : MET_TRIED_START]++;
        return;
    }
    met[is_known ? MET_TRIED_FREE : MET_TRIED_NONE]++;
    HOLDS(first->time == (is_known ? 1.0 : 0.0) && first->triangle == DPT_NONE && !first->body && !first->age &&
              first->s == 0.0 && apart(first->normal, zero) == 0.0,
          "status %u, time %g, triangle %u", first->status, first->time, first->triangle);
}

/* ---- by all triangles ---- */

/* What a touch of that body may be off by. */
static double early_of(const struct trial *trial, const struct model_body *body, double extent)
{
    dpt_mesh_info info = { .size = sizeof info };
    double cosine = 0.0, bend = 0.0;
    dpt_mesh_get_info(body->subject->mesh, &info);
    if (trial->by_pose) {
        for (int k = 0; k < 4; k++)
            cosine += trial->tool->pose.orientation[k] * trial->pose.orientation[k];
        const double piece = 2.0 * acos(fmin(1.0, fabs(cosine))) / PIECES;
        bend = 2.0 * 1.25 * extent * piece * piece / 8.0;
    }
    return fmax(EARLY * apart(info.box_min, info.box_max), bend);
}

static double distance_of(const struct model_body *body, const dpt_segment *at)
{
    double local[6], corners[9], least = INFINITY;
    to_frame(&body->pose, at->a, local);
    to_frame(&body->pose, at->b, local + 3);
    for (uint32_t t = 0; t < body->subject->source_triangles; t++)
        if (corners_now(body, t, corners))
            least = fmin(least, dpt_segment_triangle(local, corners, NULL, NULL, NULL));
    return least;
}

/* Nothing touches at a time that is before the touch. */
static void way_must_be_free(const struct trial *trial, double t, double slack)
{
    for (uint32_t i = 0; i < trial->tool->count; i++) {
        const dpt_segment at = segment_at(trial, i, t);
        for (uint32_t b = 0; b < trial->scene->body_count; b++) {
            if (trial->scene->body[b].unfelt)
                continue;
            const double distance = distance_of(&trial->scene->body[b], &at);
            const double touch = size_of_touch(trial, i);
            HOLDS(distance > 0.0 && distance >= touch - slack,
                  "segment %u is %.17g m from body %u at time %.17g, a touch is %.17g", i, distance, b, t, touch);
        }
    }
}

void trial_must_be_true(const struct trial *trial, const dpt_sweep *first, const dpt_pose *pose,
                        const dpt_segment *segments)
{
    const double extent = extent_of(trial), slack = ROUNDING * extent;
    if (first->status == DPT_SWEEP_NONE || !(extent < 10.0))
        return;
    if (first->time > 0.0) {
        way_must_be_free(trial, 0.0, slack);
        for (int k = 0; k < 2; k++)
            way_must_be_free(trial, draw_in(0.0, first->time), TURNING * extent);
    }
    if (first->status == DPT_SWEEP_FREE) {
        way_must_be_free(trial, 1.0, slack);
        return;
    }
    if (!pose && !segments)
        return;
    dpt_segment at;
    if (pose)
        put(pose, &trial->tool->segment[first->segment], &at);
    else
        at = segments[first->segment];
    const struct model_body *body = scene_body((struct scene *)(uintptr_t)trial->scene, first->body);
    const double distance = distance_of(body, &at), touch = size_of_touch(trial, first->segment);
    HOLDS(distance <= touch + early_of(trial, body, extent) + slack,
          "it stopped %.17g m from what it touches, a touch is %.17g", distance, touch);
    HOLDS(first->time == 0.0 || distance >= touch - slack, "it stopped %.17g m behind a touch of %.17g", distance,
          touch);
}
