/* SPDX-License-Identifier: BSD-3-Clause */
#include "hull/hull_maker.h"

const char *const cloud_names[CLOUDS] = { "cube",    "sphere", "lattice", "stretched", "inside", "repeated",
                                          "polygon", "box",    "wedge",   "cylinder",  "cone" };

static void put(struct made_hull *made, vec3 x)
{
    vec3_store(x, made->point + 3 * made->count++);
}

/* On the outside of the first few, between them, or among them. */
static vec3 between(uint64_t *random, const struct made_hull *made, uint32_t corners)
{
    vec3 sum = { 0.0, 0.0, 0.0 };
    double left = 1.0;
    const uint32_t parts = whole_in(random, 1, 4);
    for (uint32_t i = 0; i < parts; i++) {
        const double part = i + 1 == parts ? left : left * whole_in(random, 0, 4) / 4.0;
        sum = along(sum, part, vec3_of(made->point + 3 * whole_in(random, 0, corners - 1)));
        left -= part;
    }
    return sum;
}

static void put_shape(uint64_t *random, int kind, struct made_hull *made)
{
    dpt_hull_shape shape = { .size = sizeof shape };
    shape.kind = (uint32_t)(kind - CLOUD_BOX);
    for (int k = 0; k < 3; k++)
        shape.extent[k] = power_in(random, -2.0, 0.0);
    if (kind >= CLOUD_CYLINDER && one_in(random, 2))
        shape.sides = whole_in(random, 3, kind == CLOUD_CONE ? 63 : 32);
    const dpt_result result = dpt_hull_shape_corners(&shape, made->point, DPT_HULL_CORNERS_MAX, &made->count);
    CHECK(result == DPT_OK, "%s: %s", cloud_names[kind], dpt_result_name(result));
}

void cloud_points(uint64_t *random, int kind, uint32_t count, struct made_hull *made)
{
    const uint32_t corners = kind == CLOUD_POLYGON ? 3 : 4;
    const double long_by = power_in(random, 0.0, 3.0);
    const int axis = (int)whole_in(random, 0, 2);
    made->count = 0;
    if (!count)
        count = whole_in(random, 4, DPT_HULL_CORNERS_MAX);
    if (kind >= CLOUD_BOX)
        put_shape(random, kind, made);
    while (kind < CLOUD_BOX && made->count < count) {
        const uint32_t i = made->count;
        vec3 x = any_in(random, 1.0);
        if (kind == CLOUD_SPHERE)
            x = any_unit(random);
        if (kind == CLOUD_LATTICE)
            x = (vec3){ whole_in(random, 0, 4) - 2.0, whole_in(random, 0, 4) - 2.0, whole_in(random, 0, 4) - 2.0 };
        if (kind == CLOUD_LATTICE && i < 4)
            x = (vec3){ 2.0 * (i == 1), 2.0 * (i == 2), 2.0 * (i == 3) };
        if (kind == CLOUD_STRETCHED)
            x = scaled((vec3){ x.x, x.y, long_by * x.z }, 1.0 / long_by);
        if (kind == CLOUD_STRETCHED && axis)
            x = (vec3){ x.z, axis == 1 ? x.x : x.z, x.y };
        if (kind == CLOUD_INSIDE && i >= corners)
            x = between(random, made, corners);
        if (kind == CLOUD_REPEATED && i >= corners && !one_in(random, 4))
            x = vec3_of(made->point + 3 * whole_in(random, 0, i - 1));
        if (kind == CLOUD_POLYGON) {
            double *const flat[3] = { &x.x, &x.y, &x.z };
            *flat[axis] = 0.25;
        }
        put(made, x);
    }
    const double none[3] = { 0.0, 0.0, 0.0 };
    cloud_place(made, 1.0, none);
}

void cloud_place(struct made_hull *made, double factor, const double offset[3])
{
    double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
    made->size = made->extent = 0.0;
    for (uint32_t i = 0; i < 3 * made->count; i++) {
        double *x = &made->point[i];
        *x = factor * *x + offset[i % 3];
        low[i % 3] = min_of(low[i % 3], *x);
        high[i % 3] = max_of(high[i % 3], *x);
        made->extent = max_of(made->extent, fabs(*x));
    }
    for (int k = 0; k < 3; k++)
        made->size += (high[k] - low[k]) * (high[k] - low[k]);
    made->size = sqrt(made->size);
}

dpt_result make_hull(struct made_hull *made, double radius)
{
    enum { GUARD = 0x5a };
    double points[3 * DPT_HULL_CORNERS_MAX];
    memcpy(points, made->point, sizeof points);
    const dpt_hull_def def = { .size = sizeof def, .corner_count = made->count, .corners = points, .radius = radius };
    const size_t bytes = dpt_hull_bytes(&def);
    made->hull = NULL;
    CHECK(bytes > 0 && bytes + 8 <= sizeof made->block, "%zu bytes", bytes);
    if (!bytes || bytes + 8 > sizeof made->block)
        return DPT_E_MEMORY;
    memset(made->block, GUARD, sizeof made->block);
    const dpt_result result = dpt_hull_create(made->block, bytes, &def, &made->hull);
    for (size_t i = bytes; i < bytes + 8; i++)
        CHECK(((unsigned char *)made->block)[i] == GUARD, "byte %zu behind the block", i - bytes);
    /* The corners are copied. */
    memset(points, 0xff, sizeof points);
    if (result != DPT_OK)
        return result;
    const char *fault = oracle_hull_read(made->hull, &made->as);
    CHECK(!fault, "%s", fault);
    return result;
}

void make_any_hull(uint64_t *random, double size, struct made_hull *made)
{
    static const uint32_t few[] = { 4, 5, 6, 8, 12 };
    const double none[3] = { 0.0, 0.0, 0.0 };
    dpt_result result;
    do {
        cloud_points(random, (int)whole_in(random, 0, CLOUDS - 1), one_in(random, 2) ? few[whole_in(random, 0, 4)] : 0,
                     made);
        cloud_place(made, size / made->size, none);
        result = make_hull(made, 0.0);
    } while (result != DPT_OK);
}

const char *points_text(const double *points, uint32_t count)
{
    static char text[72 * 3 * DPT_HULL_CORNERS_MAX];
    size_t length = 0;
    text[0] = 0;
    for (uint32_t i = 0; i < 3 * count; i++)
        length += (size_t)snprintf(text + length, sizeof text - length, "%s%a", i ? i % 3 ? "," : ", " : "", points[i]);
    return text;
}

dpt_pose any_pose(uint64_t *random, double reach)
{
    dpt_pose pose;
    vec3_store(any_in(random, reach), pose.position);
    pose_turn(any_unit(random), random_in(random, -3.1, 3.1), &pose);
    return pose;
}
