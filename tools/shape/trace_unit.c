/* SPDX-License-Identifier: BSD-3-Clause */
#include "shape/trace_unit.h"

#include <math.h>
#include <stdio.h>

#include "base/frame.h"
#include "base/vec3.h"

#define NEAR_RADII   10.0
#define MILLIMETRE   1e-3
#define HARDLY_ANY   0.01
#define NEARLY_ALL   0.9
#define SIZE_LEAST   0.05 /* radii: what moves less does not feel its way over a mesh */
#define RADIUS_LEAST 1e-9 /* m, of a body that is a point */

struct trace_ball trace_ball_of(const dpt_mesh *mesh, const dpt_pose *pose)
{
    dpt_mesh_info info = { .size = sizeof info };
    struct frame frame;
    struct trace_ball ball;
    dpt_mesh_get_info(mesh, &info);
    const vec3 min = vec3_of(info.box_min), max = vec3_of(info.box_max);
    vec3 centre = scaled(add(min, max), 0.5);
    if (pose && frame_of_pose(pose, &frame) == DPT_OK)
        centre = frame_to_world(&frame, centre);
    vec3_store(centre, ball.centre);
    ball.radius = fmax(0.5 * length(sub(max, min)), RADIUS_LEAST);
    return ball;
}

/* How many rows come near to a body, their numbers times `scale`. */
static size_t near_rows(const struct csv_table *trace, double scale, const struct trace_ball *balls, size_t count)
{
    size_t near = 0;
    for (size_t i = 0; i < trace->rows; i++) {
        const double *row = csv_table_row(trace, i);
        const vec3 a = scaled(vec3_of(row + 1), scale), b = scaled(vec3_of(row + 4), scale);
        int is_near = 0;
        for (size_t k = 0; k < count && !is_near; k++) {
            const vec3 centre = vec3_of(balls[k].centre);
            const double reach = NEAR_RADII * balls[k].radius;
            is_near = length(sub(a, centre)) < reach || length(sub(b, centre)) < reach;
        }
        near += (size_t)is_near;
    }
    return near;
}

/* m: the diagonal of the box of all that the tool passes. */
static double trace_size(const struct csv_table *trace)
{
    double min[3] = { HUGE_VAL, HUGE_VAL, HUGE_VAL }, max[3] = { -HUGE_VAL, -HUGE_VAL, -HUGE_VAL };
    for (size_t i = 0; i < trace->rows; i++)
        for (int k = 0; k < 6; k++) {
            const double x = csv_table_row(trace, i)[1 + k];
            min[k % 3] = fmin(min[k % 3], x);
            max[k % 3] = fmax(max[k % 3], x);
        }
    return length(sub(vec3_of(max), vec3_of(min)));
}

void trace_note_unit(const char *path, const struct csv_table *trace, const struct trace_ball *balls, size_t count)
{
    const double rows = (double)trace->rows;
    double radius = HUGE_VAL;
    for (size_t k = 0; k < count; k++)
        radius = fmin(radius, balls[k].radius);
    if (MILLIMETRE * trace_size(trace) < SIZE_LEAST * radius ||
        (double)near_rows(trace, 1.0, balls, count) > HARDLY_ANY * rows ||
        (double)near_rows(trace, MILLIMETRE, balls, count) < NEARLY_ALL * rows)
        return;
    fprintf(
        stderr,
        "%s: note: its tool stays ten times as far away as the mesh is large: are its numbers millimetres? They are "
        "taken as metres; divide them by 1000\n",
        path);
}
