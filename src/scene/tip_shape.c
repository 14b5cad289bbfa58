/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/tip_shape.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/frame.h"
#include "built_with.h"
#include "text/parse_number.h"

const char *const tip_shape_words[] = { "box",     "wedge",           "cylinder",    "cone", "ellipsoid",
                                        "capsule", "curved-cylinder", "curved-cone", NULL };

int tip_is_round(uint32_t kind)
{
    return kind >= DPT_HULL_KIND_CYLINDER && kind != TIP_ELLIPSOID;
}

uint32_t tip_sides_max(uint32_t kind)
{
    static const uint32_t max[] = { 0, 0, 32, 63, 12, 15, 32, 63 };
    return max[kind];
}

int tip_is_curved(uint32_t kind)
{
    return kind >= TIP_ELLIPSOID;
}

int tip_shapes_are_curved(const struct tip_shapes *tips)
{
    for (uint32_t i = 0; i < tips->count; i++)
        if (!tip_is_curved(tips->shape[i].kind))
            return 0;
    return 1;
}

/* The corners and the radius of its hull, which is larger than it by `error` at most. */
static dpt_result place_corners(const struct tip_shape *tip, double *corners, uint32_t *count, double *radius,
                                double *error)
{
    if (tip_is_curved(tip->kind))
        return curved_tip_corners(tip, corners, count, radius, error);
    *radius = tip->radius;
    *error = 0.0;
    const dpt_hull_shape shape = { .size = sizeof shape,
                                   .kind = tip->kind,
                                   .sides = tip->sides,
                                   .extent = { tip->extent[0], tip->extent[1], tip->extent[2] } };
    struct frame frame;
    dpt_result result = frame_of_pose(&tip->pose, &frame);
    if (result == DPT_OK)
        result = dpt_hull_shape_corners(&shape, corners, DPT_HULL_CORNERS_MAX, count);
    for (uint32_t i = 0; result == DPT_OK && i < *count; i++)
        vec3_store(frame_to_world(&frame, vec3_of(corners + 3 * (size_t)i)), corners + 3 * (size_t)i);
    return result;
}

dpt_result tip_shape_make(const struct tip_shape *shape, void **block, const dpt_hull **hull)
{
    double corners[3 * DPT_HULL_CORNERS_MAX], error;
    dpt_hull_def def = { .size = sizeof def, .corners = corners };
    *block = NULL;
    dpt_result result = place_corners(shape, corners, &def.corner_count, &def.radius, &error);
    if (result != DPT_OK)
        return result;
    const size_t bytes = dpt_hull_bytes(&def);
    *block = bytes ? malloc(bytes) : NULL;
    if (!*block)
        return bytes ? DPT_E_MEMORY : DPT_E_ARGUMENT;
    result = dpt_hull_create(*block, bytes, &def, hull);
    if (result != DPT_OK) {
        free(*block);
        *block = NULL;
    }
    return result;
}

double tip_shape_error(const struct tip_shape *shape)
{
    double corners[3 * DPT_HULL_CORNERS_MAX], radius, error;
    uint32_t count;
    return place_corners(shape, corners, &count, &radius, &error) == DPT_OK ? error : 0.0;
}

double tip_shapes_error(const struct tip_shapes *tips)
{
    double error = 0.0;
    for (uint32_t i = 0; i < tips->count; i++)
        error = fmax(error, tip_shape_error(&tips->shape[i]));
    return error;
}

static int is_within(const double *numbers, int count, double min, double max)
{
    for (int i = 0; i < count; i++)
        if (!(numbers[i] >= min && numbers[i] <= max))
            return 0;
    return 1;
}

const char *tip_shape_fault(const struct tip_shape *shape)
{
    void *block;
    const dpt_hull *hull;
    const double *extent = shape->extent;
    if (!is_within(extent, 3, 0.0, TIP_EXTENT_MAX))
        return "its lengths must be 0 to 10";
    if (!is_within(&shape->radius, 1, 0.0, TIP_RADIUS_MAX))
        return "its radius must be 0 to 1";
    if (tip_is_round(shape->kind) && extent[1] != 0.0 && extent[1] != extent[0])
        return "it is round: its length along y is that along x, or 0";
    if (!is_within(shape->pose.position, 3, -TIP_EXTENT_MAX, TIP_EXTENT_MAX))
        return "its place must be -10 to 10";
    if (tip_is_curved(shape->kind) && shape->radius != 0.0)
        return "it is curved: it has no radius beside its lengths";
    if (shape->kind == TIP_CAPSULE && extent[2] < extent[0])
        return "a capsule is at least as long as it is wide: its length along z is the whole one";
    if (tip_is_curved(shape->kind) && curved_tip_left_out())
        return curved_tip_left_out();
    const dpt_result result = tip_shape_make(shape, &block, &hull);
    free(block);
    if (result == DPT_E_MEMORY)
        return "memory ran out";
    if (result != DPT_OK && tip_is_curved(shape->kind))
        return "its lengths must be above 0, and none 10,000 times another";
    return result == DPT_OK ? NULL : "it is too thin: its corners lie on a line, or nearly so";
}

/* Numbers with commas between. Returns how many there are up to `end`, or 0 if there is anything else. */
static int read_numbers(const char *text, const char *end, double *numbers, int capacity)
{
    for (int count = 0; count < capacity;) {
        text = parse_double(text, end, &numbers[count++]);
        if (!text || text == end)
            return text ? count : 0;
        if (*text++ != ',')
            return 0;
    }
    return 0;
}

/* The kind of a word of `length` bytes, or -1. */
static int read_kind(const char *word, size_t length)
{
    for (int i = 0; tip_shape_words[i]; i++)
        if (strlen(tip_shape_words[i]) == length && !memcmp(tip_shape_words[i], word, length))
            return i;
    return -1;
}

dpt_result tip_shape_parse(struct tip_shape *shape, const char *name, const char *text, dpt_host_error *error)
{
    static const dpt_pose identity = DPT_POSE_IDENTITY;
    const char *end = text + strlen(text), *colon = strchr(text, ':');
    const int kind = colon ? read_kind(text, (size_t)(colon - text)) : -1;
    double numbers[4] = { 0.0 };
    if (kind < 0 || read_numbers(colon + 1, end, numbers, 4) < 3)
        return host_refuse(error, DPT_E_ARGUMENT,
                           "%s takes SHAPE:X,Y,Z or SHAPE:X,Y,Z,RADIUS, with the shape box, wedge, "
                           "cylinder, cone, ellipsoid, capsule, curved-cylinder or curved-cone; it is '%s'",
                           name, text);
    *shape = (struct tip_shape){
        .kind = (uint32_t)kind, .extent = { numbers[0], numbers[1], numbers[2] }, .radius = numbers[3], .pose = identity
    };
    const char *fault = tip_shape_fault(shape);
    return fault ? host_refuse(error, DPT_E_ARGUMENT, "%s %s: %s", name, text, fault) : DPT_OK;
}

/* The numbers of a line in their order. */
enum { LINE_NUMBERS = 12 };

void tip_shape_write(const struct tip_shape *shape, char line[TIP_SHAPE_LINE])
{
    const double *e = shape->extent, *p = shape->pose.position, *q = shape->pose.orientation;
    snprintf(line, TIP_SHAPE_LINE, "%s,%.17g,%.17g,%.17g,%.17g,%u,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g",
             tip_shape_words[shape->kind], e[0], e[1], e[2], shape->radius, (unsigned)shape->sides, p[0], p[1], p[2],
             q[0], q[1], q[2], q[3]);
}

int tip_shape_read(struct tip_shape *shape, const char *text, const char *end)
{
    const char *comma = memchr(text, ',', (size_t)(end - text));
    const int kind = comma ? read_kind(text, (size_t)(comma - text)) : -1;
    double n[LINE_NUMBERS];
    if (kind < 0 || read_numbers(comma + 1, end, n, LINE_NUMBERS) != LINE_NUMBERS)
        return 0;
    if (!(n[4] >= 0.0 && n[4] <= DPT_HULL_CORNERS_MAX && n[4] == floor(n[4])))
        return 0;
    *shape =
        (struct tip_shape){ .kind = (uint32_t)kind,
                            .sides = (uint32_t)n[4],
                            .extent = { n[0], n[1], n[2] },
                            .radius = n[3],
                            .pose = { .position = { n[5], n[6], n[7] }, .orientation = { n[8], n[9], n[10], n[11] } } };
    const char *fault = tip_shape_fault(shape);
    return !fault || (tip_is_curved(shape->kind) && fault == curved_tip_left_out());
}

#ifdef DPT_HAS_CONVEX

/* A depth is proven to this part of the tip's length, or not at all. */
#define PROVEN 1e-3

/* So many radii of a hull are tried, and so many directions are looked at. */
enum { RADIUS_STEPS = 20, GROWTH_STEPS = 1000 };

#ifdef DPT_LOADS_CONVEX
const char *curved_tip_left_out(void)
{
    return convex_library_fault();
}
#else
const char *curved_tip_left_out(void)
{
    return NULL;
}
#endif

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
