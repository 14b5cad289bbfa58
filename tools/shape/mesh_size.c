/* SPDX-License-Identifier: BSD-3-Clause */
#include "shape/mesh_size.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/vec3.h"

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

double unit_metres(const char *unit)
{
    static const struct {
        const char *name;
        double metres;
    } units[] = { { "mm", 0.001 }, { "cm", 0.01 }, { "m", 1.0 }, { "in", 0.0254 } };
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (strcmp(unit, units[i].name) == 0)
            return units[i].metres;
    return 0.0;
}
