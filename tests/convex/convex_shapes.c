/* SPDX-License-Identifier: BSD-3-Clause */
#include "convex/convex_shapes.h"

#include "convex/convex_body.h"

void random_pose(uint64_t *seed, double reach, dpt_pose *pose)
{
    double square = 0.0;
    for (int k = 0; k < 3; k++)
        pose->position[k] = random_in(seed, -reach, reach);
    while (square < 0.01 || square > 1.0) {
        square = 0.0;
        for (int k = 0; k < 4; k++) {
            pose->orientation[k] = random_in(seed, -1.0, 1.0);
            square += pose->orientation[k] * pose->orientation[k];
        }
    }
    for (int k = 0; k < 4; k++)
        pose->orientation[k] /= sqrt(square);
}

static void make_hull(struct curved *curved, double size, uint64_t *seed)
{
    dpt_hull_def def = { .size = sizeof def, .corners = curved->corners };
    const dpt_hull *hull = NULL;
    do {
        def.corner_count = 4 + (uint32_t)random_in(seed, 0.0, 30.0);
        for (uint32_t i = 0; i < 3 * def.corner_count; i++)
            curved->corners[i] = random_in(seed, -0.5, 0.5) * size;
        def.radius = random_in(seed, 0.0, 1.0) < 0.5 ? 0.0 : random_in(seed, 0.0, 0.1) * size;
    } while (dpt_hull_create(curved->block, sizeof curved->block, &def, &hull) != DPT_OK);
    curved->corner_count = def.corner_count;
    curved->hull_radius = def.radius;
    curved->shape.hull = hull;
}

void curved_random(struct curved *curved, uint32_t kind, int is_cut, double size, uint64_t *seed)
{
    dpt_convex_shape *shape = &curved->shape;
    *shape = (dpt_convex_shape){ .size = sizeof *shape, .kind = kind };
    curved->size = size;
    random_pose(seed, size, &shape->pose);
    if (kind == DPT_CONVEX_KIND_HULL) {
        make_hull(curved, size, seed);
        return;
    }
    shape->extent[0] = random_in(seed, 0.1, 1.0) * size;
    shape->extent[1] = kind == DPT_CONVEX_KIND_ELLIPSOID ? random_in(seed, 0.1, 1.0) * size : 0.0;
    shape->extent[2] = random_in(seed, 0.1, 1.0) * size;
    if (kind == DPT_CONVEX_KIND_CAPSULE && random_bits(seed) % 8 == 0)
        shape->extent[2] = 0.0;
    if (!is_cut)
        return;
    shape->flags = DPT_CONVEX_FLAG_BEVEL;
    random_unit(seed, shape->bevel);
    shape->bevel[3] =
        random_in(seed, -0.7, 0.9) * (0.5 * shape->extent[0] + 0.5 * shape->extent[2] * fabs(shape->bevel[2]));
}

/* ---- how far it reaches ---- */

static double reach_of_capsule(const dpt_convex_shape *shape, const double d[3])
{
    return 0.5 * shape->extent[0] * sqrt(dot3(d, d)) + 0.5 * shape->extent[2] * fabs(d[2]);
}

/* By duality: the least over l >= 0 of the whole capsule's reach along d - l n, plus l times the plane's distance. */
static double reach_of_cut(const dpt_convex_shape *shape, const double d[3])
{
    double low = 0.0, high = 1.0, best = HUGE_VAL;
    const double *n = shape->bevel;
    /* Past some l it only rises: double until then. */
    for (double last = HUGE_VAL; high < 1e6; high *= 2.0) {
        const double v[3] = { d[0] - high * n[0], d[1] - high * n[1], d[2] - high * n[2] };
        const double here = reach_of_capsule(shape, v) + high * n[3];
        if (here > last)
            break;
        last = here;
    }
    for (int i = 0; i < 120; i++) {
        const double l[2] = { low + 0.382 * (high - low), low + 0.618 * (high - low) };
        double at[2];
        for (int k = 0; k < 2; k++) {
            const double v[3] = { d[0] - l[k] * n[0], d[1] - l[k] * n[1], d[2] - l[k] * n[2] };
            at[k] = reach_of_capsule(shape, v) + l[k] * n[3];
            best = fmin(best, at[k]);
        }
        if (at[0] < at[1])
            high = l[1];
        else
            low = l[0];
    }
    return fmin(best, reach_of_capsule(shape, d));
}

static double reach_within(const struct curved *curved, const double d[3])
{
    const dpt_convex_shape *shape = &curved->shape;
    const double x = 0.5 * shape->extent[0], y = 0.5 * shape->extent[1], z = 0.5 * shape->extent[2];
    const double across = sqrt(d[0] * d[0] + d[1] * d[1]);
    double most = -HUGE_VAL;
    switch (shape->kind) {
    case DPT_CONVEX_KIND_CONE:
        return fmax(x * across + z * d[2], -z * d[2]);
    case DPT_CONVEX_KIND_CYLINDER:
        return x * across + z * fabs(d[2]);
    case DPT_CONVEX_KIND_ELLIPSOID:
        return sqrt(x * x * d[0] * d[0] + y * y * d[1] * d[1] + z * z * d[2] * d[2]);
    case DPT_CONVEX_KIND_CAPSULE:
        return shape->flags & DPT_CONVEX_FLAG_BEVEL ? reach_of_cut(shape, d) : reach_of_capsule(shape, d);
    default:
        for (uint32_t i = 0; i < curved->corner_count; i++)
            most = fmax(most, dot3(curved->corners + 3 * i, d));
        return most + curved->hull_radius;
    }
}

double curved_reach(const struct curved *curved, const double d[3])
{
    double own[3];
    turn_back3(curved->shape.pose.orientation, d, own);
    return reach_within(curved, own) + dot3(curved->shape.pose.position, d);
}

int curved_holds(const struct curved *curved, const double x[3], double slack)
{
    const dpt_convex_shape *shape = &curved->shape;
    const double a = 0.5 * shape->extent[0], b = 0.5 * shape->extent[1], c = 0.5 * shape->extent[2];
    const double across = sqrt(x[0] * x[0] + x[1] * x[1]);
    const double off = fmax(0.0, fabs(x[2]) - c);
    switch (shape->kind) {
    case DPT_CONVEX_KIND_CONE:
        return fabs(x[2]) <= c + slack && across <= a * (x[2] + c) / (2.0 * c) + slack * (1 + a / c);
    case DPT_CONVEX_KIND_CYLINDER:
        return fabs(x[2]) <= c + slack && across <= a + slack;
    case DPT_CONVEX_KIND_ELLIPSOID:
        return sqrt(x[0] * x[0] / a / a + x[1] * x[1] / b / b + x[2] * x[2] / c / c) <=
               1.0 + slack / fmin(a, fmin(b, c));
    case DPT_CONVEX_KIND_CAPSULE:
        return sqrt(across * across + off * off) <= a + slack &&
               (!(shape->flags & DPT_CONVEX_FLAG_BEVEL) || dot3(x, shape->bevel) <= shape->bevel[3] + slack);
    default:
        return 0;
    }
}

void curved_centre(const struct curved *curved, double centre[3])
{
    const dpt_convex_shape *shape = &curved->shape;
    double own[3] = { 0.0, 0.0, 0.0 };
    if (shape->kind == DPT_CONVEX_KIND_CONE)
        own[2] = 0.25 * shape->extent[2];
    for (uint32_t i = 0; shape->kind == DPT_CONVEX_KIND_HULL && i < curved->corner_count; i++)
        for (int k = 0; k < 3; k++)
            own[k] += curved->corners[3 * i + (uint32_t)k] / curved->corner_count;
    pose_point(&shape->pose, own, centre);
}

/* ---- against a triangle ---- */

double curved_width(const struct curved *curved, const dpt_pose *tool, const double triangle[9], const double n[3])
{
    double back[3], most = -HUGE_VAL;
    const double minus[3] = { -n[0], -n[1], -n[2] };
    for (int k = 0; k < 3; k++)
        most = fmax(most, dot3(triangle + 3 * k, n));
    turn_back3(tool->orientation, minus, back);
    return most + curved_reach(curved, back) + dot3(tool->position, minus);
}

double curved_least(const struct curved *curved, const dpt_pose *tool, const double triangle[9], const double *front,
                    int samples, uint64_t *seed, double n[3])
{
    double least = HUGE_VAL;
    double spread = 0.0;
    for (int i = 0; i < samples; i++) {
        double d[3];
        random_unit(seed, d);
        if (i >= samples / 2) {
            /* The second half looks about the best, ever more closely. */
            spread = spread > 0.0 ? spread * exp(-24.0 / samples) : 0.5;
            for (int k = 0; k < 3; k++)
                d[k] = n[k] + spread * d[k];
            unit3(d);
        }
        if (i == 0 && front)
            memcpy(d, front, 3 * sizeof *front);
        if (front && dot3(d, front) < 0.0)
            for (int k = 0; k < 3; k++)
                d[k] = -d[k];
        const double width = curved_width(curved, tool, triangle, d);
        if (width < least) {
            least = width;
            memcpy(n, d, 3 * sizeof *d);
        }
    }
    return least;
}

/* The difference that is the least along v: a corner less a point of the shape, which test_convex_corners looks at. */
static vec3 least_difference(const struct convex_body *body, const dpt_pose *tool, const double triangle[9],
                             const double by[3], vec3 v)
{
    double d[3], own[3], x[3];
    uint32_t best = 0;
    vec3_store(v, d);
    for (uint32_t k = 1; k < 3; k++)
        if (dot3(triangle + 3 * k, d) < dot3(triangle + 3 * best, d))
            best = k;
    turn_back3(tool->orientation, d, own);
    vec3_store(frame_to_world(&body->frame, dpti_convex_support(body, frame_turn_back(&body->frame, vec3_of(own)))), x);
    pose_point(tool, x, x);
    return sub(sub(vec3_of(triangle + 3 * best), vec3_of(x)), vec3_of(by));
}

int curved_parted(const struct curved *curved, const dpt_pose *tool, const double triangle[9], const double by[3],
                  int steps, double *distance)
{
    struct convex_body body;
    CHECK(dpti_convex_body_of(&curved->shape, &body) == DPT_OK, "no shape");
    vec3 v = least_difference(&body, tool, triangle, by, (vec3){ 0.3, 0.5, 0.7 });
    for (int i = 0; i < steps && dot(v, v) > 0.0; i++) {
        const vec3 w = least_difference(&body, tool, triangle, by, v), way = sub(w, v);
        *distance = length(v);
        if (dot(v, w) > 0.0)
            return 1;
        v = along(v, nearest_on(v, way, (vec3){ 0.0, 0.0, 0.0 }), way);
    }
    *distance = length(v);
    return 0;
}
