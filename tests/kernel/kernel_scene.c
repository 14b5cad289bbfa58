/* SPDX-License-Identifier: BSD-3-Clause */
#include "kernel/kernel_scene.h"

float coordinate(uint64_t *random)
{
    return (float)random_in(random, -1.0, 1.0);
}

void make_triangles(uint64_t *random, int shape, float block[9 * LANES])
{
    for (int lane = 0; lane < LANES; lane++) {
        double size = pow(10.0, random_in(random, -4.0, 0.0));
        float centre[3] = { coordinate(random), coordinate(random), coordinate(random) };
        float first[3], along_edge[3];
        for (int axis = 0; axis < 3; axis++) {
            first[axis] = centre[axis] * (float)(1.0 - size);
            along_edge[axis] = (float)(size * random_in(random, -1.0, 1.0));
        }
        for (int k = 0; k < 3; k++)
            for (int axis = 0; axis < 3; axis++) {
                float x = first[axis] + (float)(size * random_in(random, -1.0, 1.0));
                if (shape == SLIVERS)
                    x = first[axis] + along_edge[axis] * (float)(0.5 * k) +
                        (k == 1 ? 1e-6f * coordinate(random) : 0.0f);
                if (shape == POINTS)
                    x = first[axis];
                if (shape == FLAT && axis == 2)
                    x = 0.25f;
                block[(3 * k + axis) * LANES + lane] = x < -1.0f ? -1.0f : x > 1.0f ? 1.0f : x;
            }
    }
}

vec3 random_vec(uint64_t *random, double reach)
{
    return (vec3){ random_in(random, -reach, reach), random_in(random, -reach, reach),
                   random_in(random, -reach, reach) };
}

static void unit_frame(vec3 x, vec3 *y, vec3 *z)
{
    vec3 other = fabs(x.x) < 0.6 ? (vec3){ 1.0, 0.0, 0.0 } : (vec3){ 0.0, 1.0, 0.0 };
    *y = cross(other, x);
    *y = scaled(*y, 1.0 / length(*y));
    *z = cross(x, *y);
}

static void put(vec3 v, float out[3])
{
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

static float dot_float(const float n[3], const float p[3])
{
    return n[0] * p[0] + n[1] * p[1] + n[2] * p[2];
}

void put_normal(vec3 normal, struct filter_segment *segment)
{
    put(normal, segment->normal);
    float at_a = dot_float(segment->normal, segment->a);
    float at_b = dot_float(segment->normal, segment->b);
    segment->height = at_a > at_b ? at_a : at_b;
}

struct tool tool_at(uint64_t *random, vec3 a, vec3 x, double size)
{
    struct tool tool = { .a = a, .u = scaled(x, size), .x = x };
    vec3 y, z;
    unit_frame(x, &y, &z);
    put(a, tool.filter.a);
    put(add(a, tool.u), tool.filter.b);
    put(x, tool.filter.x);
    put(y, tool.filter.y);
    put(z, tool.filter.z);
    tool.filter.length = (float)size;
    tool.filter.limit = (float)pow(10.0, random_in(random, -3.0, 2.0));
    put_normal(y, &tool.filter);
    return tool;
}

struct tool make_tool(uint64_t *random, int shape)
{
    double reach = random_bits(random) % 8 ? 1.5 : 100.0;
    double size = random_bits(random) % 8 ? pow(10.0, random_in(random, -3.0, 1.0)) : 0.0;
    vec3 a = random_vec(random, reach);
    vec3 x = random_vec(random, 1.0);
    if (shape == FLAT && random_bits(random) % 2)
        x.z = random_in(random, -1e-6, 1e-6);
    return tool_at(random, a, scaled(x, 1.0 / length(x)), size);
}

struct tool make_long_tool(uint64_t *random)
{
    vec3 through = random_vec(random, 1.5), x = random_vec(random, 1.0);
    x = scaled(x, 1.0 / length(x));
    return tool_at(random, along(through, -5.0, x), x, 10.0);
}

struct tool move_tool(uint64_t *random, const struct tool *tool)
{
    vec3 way = random_vec(random, 1.0), pivot = random_vec(random, 1.0);
    way = scaled(way, pow(10.0, random_in(random, -6.0, 0.0)) / length(way));
    pivot = scaled(pivot, 1.0 / length(pivot));
    double angle = pow(10.0, random_in(random, -6.0, 0.0));
    vec3 x = scaled(tool->x, cos(angle));
    x = along(x, sin(angle), cross(pivot, tool->x));
    x = along(x, (1.0 - cos(angle)) * dot(pivot, tool->x), pivot);
    return tool_at(random, add(tool->a, way), scaled(x, 1.0 / length(x)), length(tool->u));
}

vec3 corner(const float *block, int k, int lane)
{
    return (vec3){ block[3 * k * LANES + lane], block[(3 * k + 1) * LANES + lane], block[(3 * k + 2) * LANES + lane] };
}

struct kernel best_kernel(void)
{
    struct kernel kernel;
    uint32_t chosen;
    dpti_kernel_get(DPT_KERNEL_AUTO, &kernel, &chosen);
    return kernel;
}

uint32_t degenerate_lanes(uint64_t *random, const struct tool *tool, float block[9 * LANES])
{
    uint32_t lanes = (uint32_t)(random_bits(random) & random_bits(random) & 0xffff);
    for (int lane = 0; lane < LANES; lane++)
        for (int row = 0; lanes >> lane & 1 && row < 9; row++)
            block[row * LANES + lane] = tool->filter.a[row % 3];
    return lanes;
}
