/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/return_if_error.h"
#include "base/sincos.h"
#include "base/sized.h"
#include "hull/hull_state.h"

enum { SIDES_DEFAULT = 16, SIDES_MIN = 3 };

static uint32_t sides_max(uint32_t kind)
{
    return kind == DPT_HULL_KIND_CYLINDER ? HULL_CORNERS_MAX / 2 : HULL_CORNERS_MAX - 1;
}

static dpt_result check_shape(dpt_hull_shape *shape)
{
    const int is_round = shape->kind == DPT_HULL_KIND_CYLINDER || shape->kind == DPT_HULL_KIND_CONE;
    if (shape->kind > DPT_HULL_KIND_CONE || shape->reserved)
        return DPT_E_ARGUMENT;
    if (is_round && !shape->sides)
        shape->sides = SIDES_DEFAULT;
    if (is_round ? shape->sides < SIDES_MIN || shape->sides > sides_max(shape->kind) : shape->sides)
        return DPT_E_ARGUMENT;
    for (int k = 0; k < 3; k++)
        if (!(shape->extent[k] >= 0.0 && shape->extent[k] <= DPT_COORDINATE_MAX))
            return DPT_E_FINITE;
    return DPT_OK;
}

struct corner_list {
    double *corners;
    uint32_t capacity, count;
};

static void put(struct corner_list *list, double x, double y, double z)
{
    if (list->count < list->capacity)
        vec3_store((vec3){ x, y, z }, list->corners + 3 * (size_t)list->count);
    list->count++;
}

/* A polygon around a circle across z, with one side's middle on the x axis. */
static void put_polygon(struct corner_list *list, uint32_t sides, double radius, double z)
{
    double sine, cosine;
    turn_sincos(0.5 / sides, &sine, &cosine);
    /* A unit in the last place more than the circle: the polygon holds it. */
    const double outer = radius / cosine * (1.0 + 0x1p-50);
    for (uint32_t i = 0; i < sides; i++) {
        turn_sincos((i + 0.5) / sides, &sine, &cosine);
        put(list, outer * cosine, outer * sine, z);
    }
}

dpt_result dpt_hull_shape_corners(const dpt_hull_shape *given, double *corners, uint32_t capacity, uint32_t *count)
{
    dpt_hull_shape shape = { .size = sizeof shape };
    if (count)
        *count = 0;
    if (!given || !count || (!corners && capacity))
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_read(given, sizeof shape, &shape, sizeof shape));
    DPT_TRY(check_shape(&shape));
    const double x = 0.5 * shape.extent[0], y = 0.5 * shape.extent[1], z = 0.5 * shape.extent[2];
    struct corner_list list = { corners, capacity, 0 };
    switch (shape.kind) {
    case DPT_HULL_KIND_BOX:
    case DPT_HULL_KIND_WEDGE:
        for (int i = 0; i < 8; i++)
            if (shape.kind == DPT_HULL_KIND_BOX || i >= 4)
                put(&list, i & 1 ? x : -x, i & 2 ? y : -y, i & 4 ? z : -z);
        if (shape.kind == DPT_HULL_KIND_WEDGE)
            for (int i = 0; i < 2; i++)
                put(&list, i ? x : -x, 0.0, -z);
        break;
    case DPT_HULL_KIND_CYLINDER:
        put_polygon(&list, shape.sides, x, -z);
        put_polygon(&list, shape.sides, x, z);
        break;
    default:
        put_polygon(&list, shape.sides, x, z);
        put(&list, 0.0, 0.0, -z);
    }
    *count = list.count;
    return list.count > capacity ? DPT_E_FULL : DPT_OK;
}
