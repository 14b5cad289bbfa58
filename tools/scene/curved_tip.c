/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/curved_tip.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "built_with.h"

#ifdef DPT_HAS_CONVEX

/* A depth is proven to this part of the tip's length, or not at all. */
#define PROVEN 1e-3

/* So many radii of a hull are tried, and so many directions are looked at. */
enum { RADIUS_STEPS = 20, GROWTH_STEPS = 1000 };

const char *curved_tip_left_out(void)
{
    return NULL;
}

static dpt_convex_shape shape_of(const struct tip_shape *tip)
{
    dpt_convex_shape shape = { .size = sizeof shape, .pose = tip->pose };
    memcpy(shape.extent, tip->extent, sizeof shape.extent);
    if (tip->kind != TIP_ELLIPSOID)
        shape.extent[1] = 0.0;
    switch (tip->kind) {
    case TIP_ELLIPSOID:
        shape.kind = DPT_CONVEX_KIND_ELLIPSOID;
        break;
    case TIP_CAPSULE:
        shape.kind = DPT_CONVEX_KIND_CAPSULE;
        shape.extent[2] = fmax(0.0, tip->extent[2] - tip->extent[0]);
        break;
    case TIP_CURVED_CYLINDER:
        shape.kind = DPT_CONVEX_KIND_CYLINDER;
        break;
    default:
        shape.kind = DPT_CONVEX_KIND_CONE;
    }
    return shape;
}

/*
 * m: how much farther an ellipsoid whose half axes are shorter by `radius`, grown by it, reaches than the whole one. Along
 * a unit n whose squares are shares of the axes, with d the shorter ones: s + radius - h, where s^2 is the mean of d^2, and
 * h^2 = s^2 + 2 radius (mean of d) + radius^2. For one mean of d that is greatest where n mixes the least and the largest
 * alone. From one share p of the largest to the next, s and h grow.
 */
static double growth(const double extent[3], double radius)
{
    const double low = 0.5 * fmin(extent[0], fmin(extent[1], extent[2])) - radius;
    const double high = 0.5 * fmax(extent[0], fmax(extent[1], extent[2])) - radius;
    double max = 0.0;
    for (int i = 0; i < GROWTH_STEPS; i++) {
        const double p = (double)i / GROWTH_STEPS, next = (double)(i + 1) / GROWTH_STEPS;
        const double square = low * low + p * (high - low) * (high + low);
        const double h = sqrt(square + radius * (2.0 * (low + p * (high - low)) + radius));
        max = fmax(max, sqrt(low * low + next * (high - low) * (high + low)) + radius - h);
    }
    return max;
}

/* Of hulls with corners round a smaller one and a radius, the one with the least error. */
dpt_result curved_tip_corners(const struct tip_shape *tip, double *corners, uint32_t *count, double *radius,
                              double *error)
{
    const int is_round = tip->kind == TIP_ELLIPSOID || tip->kind == TIP_CAPSULE;
    const uint32_t sides = tip->sides || is_round ? tip->sides : tip_sides_max(tip->kind);
    const dpt_convex_shape whole = shape_of(tip);
    const double *extent = whole.extent;
    const double thick = tip->kind == TIP_CAPSULE ? extent[0] : fmin(extent[0], fmin(extent[1], extent[2]));
    double tried[3 * DPT_HULL_CORNERS_MAX];
    dpt_result result = dpt_convex_corners(&whole, sides, corners, DPT_HULL_CORNERS_MAX, count, error);
    *radius = 0.0;
    for (int i = 1; result == DPT_OK && is_round && i < RADIUS_STEPS; i++) {
        const double r = 0.5 * thick * i / RADIUS_STEPS;
        dpt_convex_shape shape = whole;
        double wrong;
        uint32_t found;
        for (int k = 0; k < (tip->kind == TIP_CAPSULE ? 1 : 3); k++)
            shape.extent[k] -= 2.0 * r;
        if (dpt_convex_corners(&shape, sides, tried, DPT_HULL_CORNERS_MAX, &found, &wrong) != DPT_OK)
            break;
        wrong += tip->kind == TIP_CAPSULE ? 0.0 : growth(extent, r);
        if (wrong < *error) {
            *error = wrong;
            *radius = r;
            *count = found;
            memcpy(corners, tried, sizeof tried);
        }
    }
    return result;
}

static double length_of(const dpt_convex_shape *shape)
{
    return fmax(shape->extent[0], fmax(shape->extent[1], shape->extent[2]));
}

/* A dpt_force_fn. */
static void add_wrenches(void *user, const dpt_force_info *report, double dt, dpt_wrench *wrench)
{
    struct curved_tips *tips = user;
    for (uint32_t i = 0; i < tips->count; i++) {
        const dpt_convex_contact *contact = &tips->contact[i];
        dpt_convex_shape_wrench(&tips->shaper[i], report, dt, wrench);
        if (contact->contact != DPT_CONTACT_PENETRATING)
            continue;
        if (contact->error_bound > PROVEN * length_of(&tips->shape[i]))
            tips->unproven++;
        else
            tips->error = fmax(tips->error, contact->error_bound);
    }
}

dpt_result curved_tips_attach(struct curved_tips *tips, const struct tip_shapes *shapes, dpt_world *world,
                              dpt_tool tool, const struct force_options *force)
{
    tips->count = shapes->count;
    for (uint32_t i = 0; i < tips->count; i++) {
        tips->shape[i] = shape_of(&shapes->shape[i]);
        tips->contact[i] = (dpt_convex_contact){ .size = sizeof tips->contact[i] };
        tips->shaper[i] = (dpt_convex_shaper){ .size = sizeof tips->shaper[i],
                                               .law = force->law,
                                               .world = world,
                                               .shape = &tips->shape[i],
                                               .bodies = tips->bodies,
                                               .contact = &tips->contact[i],
                                               .tool = tool,
                                               .body_count = tips->body_count,
                                               .stiffness = force->stiffness };
    }
    return tips->count ? dpt_tool_set_shaper(world, tool, add_wrenches, tips) : DPT_OK;
}

#else

const char *curved_tip_left_out(void)
{
    return "this build has no curved tips: install libccd (Debian: libccd-dev pkg-config) and run make again, without "
           "CONVEX=no";
}

dpt_result curved_tip_corners(const struct tip_shape *tip, double *corners, uint32_t *count, double *radius,
                              double *error)
{
    (void)tip, (void)corners;
    *count = 0;
    *radius = *error = 0.0;
    return DPT_E_UNSUPPORTED;
}

dpt_result curved_tips_attach(struct curved_tips *tips, const struct tip_shapes *shapes, dpt_world *world,
                              dpt_tool tool, const struct force_options *force)
{
    (void)tips, (void)world, (void)tool, (void)force;
    return shapes->count ? DPT_E_UNSUPPORTED : DPT_OK;
}

#endif

void curved_tips_begin_tick(struct curved_tips *tips)
{
    for (uint32_t i = 0; i < tips->count; i++) {
        tips->contact[i] = (dpt_convex_contact){ .size = sizeof tips->contact[i] };
        tips->shaper[i].energy = 0.0;
        tips->shaper[i].body = DPT_NONE;
        tips->shaper[i].errors = 0;
    }
}

int curved_tips_have_failed(const struct curved_tips *tips)
{
    uint32_t errors = 0;
    for (uint32_t i = 0; i < tips->count; i++)
        errors += tips->shaper[i].errors;
    return errors > 0;
}

double curved_tips_energy(const struct curved_tips *tips)
{
    double energy = 0.0;
    for (uint32_t i = 0; i < tips->count; i++)
        energy += tips->shaper[i].energy;
    return energy;
}

void curved_tips_deepen(const struct curved_tips *tips, dpt_hit *hit)
{
    if (curved_tips_have_failed(tips))
        hit->contact = DPT_CONTACT_UNKNOWN;
    for (uint32_t i = 0; i < tips->count; i++) {
        const dpt_convex_contact *contact = &tips->contact[i];
        const double depth = hit->contact == DPT_CONTACT_PENETRATING ? hit->depth : 0.0;
        if (tips->shaper[i].body == DPT_NONE || !(contact->depth > depth))
            continue;
        hit->status = DPT_STATUS_BOUNDED;
        hit->contact = DPT_CONTACT_PENETRATING;
        hit->flags = DPT_HIT_FLAG_GAP;
        hit->triangle = contact->triangle;
        hit->body = tips->body_ids[tips->shaper[i].body];
        hit->distance = hit->lower_bound = 0.0;
        hit->depth = contact->depth;
        hit->gap = -contact->depth;
        hit->error_bound = contact->error_bound;
        for (int k = 0; k < 3; k++) {
            hit->p[k] = contact->point[k];
            hit->q[k] = contact->point[k] + contact->depth * contact->direction[k];
        }
    }
}

void curved_tips_print_error(FILE *file, const struct curved_tips *tips, double hull_error)
{
    if (hull_error > 0.0 && !tips->count)
        fprintf(file, "  curved tips: the proxy feels hulls that are up to %.3g mm larger\n", 1e3 * hull_error);
    if (tips->count)
        fprintf(file, "  curved tips: depths are proven to %.3g mm, but for %" PRIu64 " of them\n", 1e3 * tips->error,
                tips->unproven);
}
