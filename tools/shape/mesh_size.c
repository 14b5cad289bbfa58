/* SPDX-License-Identifier: BSD-3-Clause */
#include "shape/mesh_size.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/vec3.h"
#include "cli/command_options.h"
#include "run/replay_report.h"

/* Usual sizes of the largest side, m: from a tooth to a patient. */
static const double SIDE_MIN = 0.005, SIDE_MAX = 3.0;

static vec3 box_size(const dpt_mesh_info *info)
{
    return sub(vec3_of(info->box_max), vec3_of(info->box_min));
}

struct size_text size_text(const dpt_mesh_info *info)
{
    struct size_text size;
    const vec3 box = box_size(info);
    snprintf(size.text, sizeof size.text, "%.4g x %.4g x %.4g m", box.x, box.y, box.z);
    return size;
}

double box_diagonal(const dpt_mesh_info *info)
{
    return length(box_size(info));
}

static int is_usual_size(double side)
{
    return side >= SIDE_MIN && side <= SIDE_MAX;
}

const char *size_hint(const dpt_mesh_info *info)
{
    const vec3 box = box_size(info);
    const double side = fmax(box.x, fmax(box.y, box.z)), source = side / info->scale;
    if (is_usual_size(side))
        return NULL;
    if (is_usual_size(source))
        return "is it in metres? --unit m";
    if (is_usual_size(0.001 * source))
        return "is it in millimetres? --unit mm";
    if (is_usual_size(0.01 * source))
        return "is it in centimetres? --unit cm";
    return "which unit is it in? --unit, or --scale";
}

const char *const unit_words[] = { "mm", "cm", "m", "in", NULL };

double unit_metres(const char *unit)
{
    static const double metres[] = { 0.001, 0.01, 1.0, 0.0254 };
    for (int i = 0; unit_words[i]; i++)
        if (strcmp(unit, unit_words[i]) == 0)
            return metres[i];
    return 0.0;
}

/* In diagonals of the mesh: what is as near to a ray as this is met, and what is so near to its beginning is not. */
#define TOUCH 1e-9

/* A ray is followed piece by piece, each twice as long as the one before: first this much of the diagonal. */
#define FIRST_PIECE (1.0 / 64.0)

struct wall {
    double length; /* m; 0: the ray meets nothing */
    uint32_t triangle;
    double middle[6]; /* a segment without length */
};

struct ray_caster {
    const dpt_mesh *mesh;
    double diagonal;
    uint32_t *near; /* room for all triangles */
    uint32_t capacity;
};

static vec3 corner_of(const double corners[9], int k)
{
    return vec3_of(corners + 3 * k);
}

/* The length at which a ray from `from` to `to` leaves, at most its own; 0: it meets nothing but `own`. */
static double first_meeting(const struct ray_caster *caster, vec3 from, vec3 to, uint32_t own)
{
    const double touch = TOUCH * caster->diagonal, whole = length(sub(to, from));
    double ends[6], corners[9], s, first = 0.0;
    uint32_t count = 0;
    vec3_store(from, ends);
    vec3_store(to, ends + 3);
    dpt_query_triangles(caster->mesh, NULL, ends, touch, caster->near, caster->capacity, &count);
    for (uint32_t i = 0; i < count && i < caster->capacity; i++) {
        if (caster->near[i] == own || dpt_mesh_get_triangle(caster->mesh, caster->near[i], corners))
            continue;
        if (dpt_segment_triangle(ends, corners, &s, NULL, NULL) > touch || s * whole <= touch)
            continue;
        if (first == 0.0 || s * whole < first)
            first = s * whole;
    }
    return first;
}

static void cast(const struct ray_caster *caster, uint32_t own, struct wall *wall)
{
    double corners[9];
    *wall = (struct wall){ .triangle = own };
    if (dpt_mesh_get_triangle(caster->mesh, own, corners))
        return;
    const vec3 a = corner_of(corners, 0), b = corner_of(corners, 1), c = corner_of(corners, 2);
    const vec3 normal = cross(sub(b, a), sub(c, a));
    const vec3 from = scaled(add(add(a, b), c), 1.0 / 3.0);
    const double size = length(normal);
    if (!(size > 0.0))
        return;
    for (double piece = FIRST_PIECE; wall->length == 0.0 && piece < 2.0; piece *= 2.0)
        wall->length = first_meeting(caster, from, along(from, -piece * caster->diagonal / size, normal), own);
    vec3_store(along(from, -0.5 * wall->length / size, normal), wall->middle);
    vec3_store(vec3_of(wall->middle), wall->middle + 3);
}

static int is_inside(const dpt_mesh *mesh, const struct wall *wall)
{
    dpt_hit hit = DPT_HIT_INIT;
    return wall->length > 0.0 && dpt_query_segments(mesh, NULL, wall->middle, NULL, 1, &hit, NULL) == DPT_OK &&
           hit.contact == DPT_CONTACT_PENETRATING;
}

int mesh_thickness_measure(const char *command, const dpt_mesh *mesh, struct mesh_thickness *found)
{
    dpt_mesh_info info = { .size = sizeof info };
    const uint32_t *corners, *numbers;
    struct meter meter = { .began = 0 };
    struct ray_caster caster = { .mesh = mesh };
    *found = (struct mesh_thickness){ .walls = 0 };
    dpt_mesh_get_info(mesh, &info);
    dpt_mesh_get_triangles(mesh, &corners, &numbers, &caster.capacity);
    caster.diagonal = box_diagonal(&info);
    caster.near = malloc(caster.capacity * sizeof *caster.near);
    double *lengths = malloc(caster.capacity * sizeof *lengths);
    const int status = caster.near && lengths ? 0 : complain(command, "memory ran out");
    for (uint32_t i = 0; status == 0 && i < caster.capacity; i++) {
        struct wall wall;
        if (i % 256 == 0)
            meter_show(&meter, "thickness", (double)i / caster.capacity);
        cast(&caster, numbers[i], &wall);
        if (!is_inside(mesh, &wall))
            continue;
        if (!found->walls || wall.length < found->min ||
            (wall.length == found->min && wall.triangle < found->triangle)) {
            found->min = wall.length;
            found->triangle = wall.triangle;
        }
        lengths[found->walls++] = wall.length;
    }
    meter_show(&meter, "", 1.0);
    if (status == 0) {
        sort_numbers(lengths, found->walls);
        found->low = percentile(lengths, found->walls, 0.01);
    }
    free(caster.near);
    free(lengths);
    return status;
}
