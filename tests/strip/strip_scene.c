/* SPDX-License-Identifier: BSD-3-Clause */
#include "strip/strip_scene.h"

void turn_by(const long double q[4], const double x[3], long double out[3])
{
    long double once[3];
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        once[k] = q[1 + i] * x[j] - q[1 + j] * x[i];
    }
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        out[k] = x[k] + 2 * (q[0] * once[k] + q[1 + i] * once[j] - q[1 + j] * once[i]);
    }
}

void scene_place(struct scene *scene, const dpt_pose *pose)
{
    const struct oracle_surface *surface = &scene->subject->surface;
    long double q[4] = { 1, 0, 0, 0 }, at[3] = { 0, 0, 0 }, square = 0;
    scene->pose = pose ? &scene->held_pose : NULL;
    if (pose) {
        scene->held_pose = *pose;
        for (int k = 0; k < 4; k++)
            square += (long double)pose->orientation[k] * pose->orientation[k];
        for (int k = 0; k < 4; k++)
            q[k] = pose->orientation[k] / sqrtl(square);
        for (int k = 0; k < 3; k++)
            at[k] = pose->position[k];
    }
    for (uint32_t v = 0; v < surface->vertices; v++) {
        turn_by(q, surface->place[v], scene->place[v]);
        for (int k = 0; k < 3; k++)
            scene->place[v][k] += at[k];
    }
}

void scene_open(struct scene *scene, const struct subject *subject)
{
    const struct oracle_surface *surface = &subject->surface;
    *scene = (struct scene){ .subject = subject };
    scene->place = malloc(((size_t)surface->vertices + 1) * sizeof *scene->place);
    scene->mark = calloc(surface->triangles, 1);
    scene->sheet.surface = surface;
    scene->sheet.in = malloc(surface->triangles);
    scene->sheet.queue = malloc(2 * (size_t)surface->triangles * sizeof *scene->sheet.queue);
    scene_place(scene, NULL);
    scene->sheet.place = (const long double(*)[3])scene->place;
}

void scene_triangle(const struct scene *scene, uint32_t triangle, double corners[9])
{
    double local[9];
    long double q[4] = { 1, 0, 0, 0 }, x[3], square = 0;
    dpt_mesh_get_triangle(scene->subject->mesh, triangle, local);
    memcpy(corners, local, sizeof local);
    if (!scene->pose)
        return;
    for (int k = 0; k < 4; k++)
        square += (long double)scene->held_pose.orientation[k] * scene->held_pose.orientation[k];
    for (int k = 0; k < 4; k++)
        q[k] = scene->held_pose.orientation[k] / sqrtl(square);
    for (int i = 0; i < 3; i++) {
        turn_by(q, local + 3 * i, x);
        for (int k = 0; k < 3; k++)
            corners[3 * i + k] = (double)(x[k] + scene->held_pose.position[k]);
    }
}

dpt_hit nearest_of(const struct scene *scene, const double ends[6], double radius)
{
    dpt_hit hit = DPT_HIT_INIT;
    const dpt_result result = dpt_query_segments(scene->subject->mesh, scene->pose, ends, &radius, 1, &hit, NULL);
    CHECK(result == DPT_OK, "%s: %s", scene->subject->name, dpt_result_name(result));
    return hit;
}

void oracle_shadow_of(const struct scene *scene, const dpt_shadow *shadow, struct oracle_shadow *oracle)
{
    double ends[6], extent = 0;
    ends_of(&shadow->segment, ends);
    const double length = apart(ends, ends + 3);
    const double reach = shadow->segment.radius + shadow->width;
    for (int k = 0; k < 6; k++)
        extent = fmax(extent, fabs(ends[k]));
    extent += length + reach + shadow->depth + 2 * scene->subject->diagonal;
    for (int k = 0; k < 3; k++)
        extent = fmax(extent, fmax(fabs(scene->subject->info.box_min[k]), fabs(scene->subject->info.box_max[k])));
    oracle_shadow_make(oracle, ends, reach, shadow->direction, shadow->depth, scene->subject->diagonal + length,
                       extent);
}

void shadow_below(const struct scene *scene, const double ends[6], double radius, dpt_shadow *shadow)
{
    const dpt_hit hit = nearest_of(scene, ends, radius);
    double c[9];
    *shadow = (dpt_shadow){ .size = sizeof *shadow, .triangle = hit.triangle, .segment = { .radius = radius } };
    memcpy(shadow->segment.a, ends, sizeof shadow->segment.a);
    memcpy(shadow->segment.b, ends + 3, sizeof shadow->segment.b);
    for (int k = 0; k < 3; k++)
        shadow->direction[k] = hit.q[k] - hit.p[k];
    if (unit3(shadow->direction) > 0)
        return;
    scene_triangle(scene, hit.triangle, c);
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        shadow->direction[k] = (c[3 + i] - c[i]) * (c[6 + j] - c[j]) - (c[3 + j] - c[j]) * (c[6 + i] - c[i]);
    }
    unit3(shadow->direction);
}

void tool_at(const struct scene *scene, uint64_t *seed, double length, double height, double flat, double ends[6])
{
    const struct oracle_surface *surface = &scene->subject->surface;
    double c[9], n[3], lie[3], x[3], weight[3], sum = 0;
    uint32_t t;
    do {
        t = (uint32_t)(random_bits(seed) % surface->triangles);
    } while (surface->corner[t][0] == ORACLE_NONE);
    scene_triangle(scene, t, c);
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = (c[3 + i] - c[i]) * (c[6 + j] - c[j]) - (c[3 + j] - c[j]) * (c[6 + i] - c[i]);
        weight[k] = random_in(seed, 0, 1);
        sum += weight[k];
    }
    unit3(n);
    random_unit(seed, lie);
    const double up = dot3(lie, n), at = random_in(seed, 0, 1);
    for (int k = 0; k < 3; k++)
        lie[k] -= flat * up * n[k];
    unit3(lie);
    for (int k = 0; k < 3; k++) {
        x[k] = (weight[0] * c[k] + weight[1] * c[3 + k] + weight[2] * c[6 + k]) / sum + height * n[k];
        ends[k] = x[k] - at * length * lie[k];
        ends[3 + k] = x[k] + (1 - at) * length * lie[k];
    }
}
