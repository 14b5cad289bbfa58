/* SPDX-License-Identifier: BSD-3-Clause */
#include "strip/route_scene.h"

void route_scene_open(struct route_scene *scene, const struct subject *subject)
{
    const uint32_t count = subject->info.source_triangles;
    scene->subject = subject;
    scene->strip = guarded_strip_open(&scene->block, count < 1u << 20 ? count : 1u << 20, subject->info.vertices);
    scene->tau = malloc(count * sizeof *scene->tau);
    scene->route = malloc(count * sizeof *scene->route);
    scene->back = malloc(count * sizeof *scene->back);
}

const char *strip_text(const dpt_strip *strip)
{
    static char text[256];
    uint32_t count = 0, flags = 0;
    const uint32_t *triangles = dpt_strip_get_triangles(strip, &count, &flags);
    int length = snprintf(text, sizeof text, "flags %u, %u triangles:", flags, count);
    for (uint32_t i = 0; i < count && length < 240; i++)
        length += snprintf(text + length, sizeof text - (size_t)length, " %u", triangles[i]);
    return text;
}

void check_answer(const struct route_scene *scene, uint32_t from, uint32_t to, dpt_result result, const char *by)
{
    const dpt_result wanted = expected_result(scene, from, to);
    const uint32_t length = oracle_route(&scene->subject->surface, scene->tau, from, scene->route);
    CHECK(result == wanted, "%s, %s, %u to %u: %s, not %s", scene->subject->name, by, from, to, dpt_result_name(result),
          dpt_result_name(wanted));
    if (result == wanted)
        CHECK(strip_is(scene->strip, scene->route, result == DPT_OK ? length : 0),
              "%s, %s, %u to %u: %s; not %u: %u %u %u ...", scene->subject->name, by, from, to,
              strip_text(scene->strip), length, scene->route[0], length > 1 ? scene->route[1] : 0,
              length > 2 ? scene->route[2] : 0);
}

uint32_t triangle_nearby(const struct oracle_surface *surface, uint32_t from, uint64_t *seed)
{
    for (uint64_t steps = random_bits(seed) % 8; steps > 0 && surface->corner[from][0] != ORACLE_NONE; steps--) {
        const uint32_t v = surface->corner[from][random_bits(seed) % 3];
        from = surface->fan[surface->first[v] + random_bits(seed) % (surface->first[v + 1] - surface->first[v])];
    }
    return from;
}

int subject_with_hub(struct subject *subject, uint32_t fan, uint32_t tail)
{
    const uint32_t points = 1 + fan + 4 * tail, triangles = fan + 4 * tail;
    double *vertices = calloc(3 * (size_t)points, sizeof *vertices);
    uint32_t *corners = malloc(3 * (size_t)triangles * sizeof *corners), *c = corners;
    for (uint32_t i = 0; i < fan; i++) {
        vertices[3 * (i + 1)] = 0.1 * cos(6.283185307179586 * i / fan);
        vertices[3 * (i + 1) + 1] = 0.1 * sin(6.283185307179586 * i / fan);
        const uint32_t triangle[3] = { 0, 1 + i, 1 + (i + 1) % fan };
        memcpy(c, triangle, sizeof triangle);
        c += 3;
    }
    for (uint32_t side = 0; side < 2; side++) {
        const uint32_t first = 1 + fan + 2 * tail * side;
        uint32_t a = 1 + side * (fan / 2), b = a + 1;
        for (uint32_t i = 0; i < tail; i++) {
            for (uint32_t k = 0; k < 2; k++) {
                double *v = vertices + 3 * (first + 2 * i + k);
                v[0] = (side ? -1 : 1) * (0.11 + 0.01 * i);
                v[1] = 0.01 * k;
            }
            const uint32_t square[6] = { a, b, first + 2 * i, b, first + 2 * i, first + 2 * i + 1 };
            memcpy(c, square, sizeof square);
            c += 6;
            a = first + 2 * i;
            b = a + 1;
        }
    }
    const int opened = subject_from_arrays(subject, "hub with tails", vertices, points, corners, triangles);
    free(vertices);
    free(corners);
    return opened;
}
