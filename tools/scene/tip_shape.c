/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/tip_shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/frame.h"
#include "scene/curved_tip.h"
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

static int read_option(struct tip_shape *shape, const char *command, const char *text)
{
    static const dpt_pose identity = DPT_POSE_IDENTITY;
    const char *end = text + strlen(text), *colon = strchr(text, ':');
    const int kind = colon ? read_kind(text, (size_t)(colon - text)) : -1;
    double numbers[4] = { 0.0 };
    if (kind < 0 || read_numbers(colon + 1, end, numbers, 4) < 3)
        return complain(command,
                        "--tip takes SHAPE:X,Y,Z or SHAPE:X,Y,Z,RADIUS, with the shape box, wedge, "
                        "cylinder, cone, ellipsoid, capsule, curved-cylinder or curved-cone; it is '%s'",
                        text);
    *shape = (struct tip_shape){
        .kind = (uint32_t)kind, .extent = { numbers[0], numbers[1], numbers[2] }, .radius = numbers[3], .pose = identity
    };
    const char *fault = tip_shape_fault(shape);
    return fault ? complain(command, "--tip %s: %s", text, fault) : 0;
}

/* As many as one option has. */
typedef char tip_options_fit[(int)OPTION_TEXTS_MAX <= (int)TIP_SHAPES_MAX ? 1 : -1];

int tip_shapes_of_options(struct tip_shapes *tips, const char *command, const struct option_texts *texts)
{
    for (size_t i = 0; i < texts->count; i++)
        if (read_option(&tips->shape[i], command, texts->text[i]))
            return 2;
    tips->count = (uint32_t)texts->count;
    return 0;
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
