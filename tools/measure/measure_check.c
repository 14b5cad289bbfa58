/* SPDX-License-Identifier: BSD-3-Clause */
#include "measure/measure_check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "shape/mesh_size.h"

/* Its box is wider than the mesh's by this many diagonals: what gives way stays within. */
#define ROOM 4.0

static dpt_result add_body(struct measure_brute *brute, const struct scene_body *body, uint32_t i)
{
    dpt_deformable_def def;
    dpt_mesh_info info = { .size = sizeof info };
    if (!body->springs)
        return dpt_body_add(brute->world, body->mesh, &body->pose, &brute->id[i]);
    dpt_deformable_def_init(&def);
    dpt_mesh_get_info(body->mesh, &info);
    def.mesh = body->mesh;
    def.pose = &body->pose;
    for (int k = 0; k < 3; k++) {
        def.box_min[k] = info.box_min[k] - ROOM * box_diagonal(&info);
        def.box_max[k] = info.box_max[k] + ROOM * box_diagonal(&info);
    }
    const size_t bytes = dpt_deformable_bytes(&def);
    brute->body_block[i] = malloc(bytes);
    if (!brute->body_block[i])
        return DPT_E_MEMORY;
    return dpt_body_add_deformable(brute->world, brute->body_block[i], bytes, &def, &brute->id[i]);
}

dpt_result measure_brute_open(struct measure_brute *brute, const struct scene_bodies *bodies,
                              const struct measure_tool *tool, uint32_t searches)
{
    dpt_world_def def;
    memset(brute, 0, sizeof *brute);
    brute->searches = searches;
    brute->segments = tool->scene->segment_count;
    brute->body_count = bodies->count;
    dpt_world_def_init(&def);
    def.method = DPT_METHOD_BRUTE;
    def.until = DPT_UNTIL_TRACK;
    def.law = DPT_LAW_POINT;
    def.max_bodies = bodies->count;
    def.max_tools = 1;
    def.max_segments = brute->segments;
    def.max_tips = 0;
    const size_t bytes = dpt_world_bytes(&def);
    brute->block = malloc(bytes);
    if (!brute->block)
        return DPT_E_MEMORY;
    dpt_result result = dpt_world_create(brute->block, bytes, &def, &brute->world);
    for (uint32_t i = 0; result == DPT_OK && i < bodies->count; i++)
        result = add_body(brute, &bodies->body[i], i);
    if (result == DPT_OK)
        result = dpt_tool_add(brute->world, tool->segments, brute->segments, &brute->tool);
    return result;
}

void measure_brute_close(struct measure_brute *brute)
{
    free(brute->block);
    for (uint32_t i = 0; i < brute->body_count; i++)
        free(brute->body_block[i]);
}

/* A world that was reset searches again, though nothing has moved. */
static dpt_result search(struct measure_brute *brute)
{
    dpt_step step = { .size = sizeof step };
    dpt_result result = DPT_OK;
    brute->ns = UINT32_MAX;
    for (uint32_t i = 0; result == DPT_OK && i < brute->searches; i++) {
        dpt_world_reset(brute->world);
        const uint64_t begin = clock_now();
        result = dpt_world_step(brute->world, 1e-3, &step);
        const uint64_t ns = clock_now() - begin;
        brute->ns = ns < brute->ns ? (uint32_t)ns : brute->ns;
        brute->work = step.work;
    }
    return result;
}

/*
 * m: how far a segment's hit is off. Of one that is not the tool's only a bound may be told, where it is far (near_only):
 * then it is how far the truth is outside of that.
 */
static double off_by(const dpt_hit *hit, uint32_t nearest, double truth)
{
    if (hit->status == DPT_STATUS_BOUNDED && hit->segment != nearest)
        return fmax(0.0, fmax(hit->lower_bound - truth, truth - hit->distance));
    return fabs(hit->distance - truth);
}

dpt_result measure_brute_compare(struct measure_brute *brute, const struct scene_bodies *bodies,
                                 const struct measure_tool *tool, const dpt_world *world, dpt_tool id, double *error)
{
    dpt_result result = DPT_OK;
    for (uint32_t i = 0; result == DPT_OK && i < bodies->count; i++) {
        const float *vertices;
        uint32_t count;
        if (!brute->body_block[i])
            continue;
        result = dpt_body_get_vertices(world, bodies->body[i].id, &vertices, &count);
        if (result == DPT_OK)
            result = dpt_body_set_vertices(brute->world, brute->id[i], 0, count, vertices, -1.0);
    }
    if (result == DPT_OK)
        result = dpt_tool_set_segments(brute->world, brute->tool, tool->segments, brute->segments);
    if (result == DPT_OK)
        result = search(brute);
    dpt_hit nearest = DPT_HIT_INIT;
    dpt_tool_get_hit(world, id, &nearest);
    *error = 0.0;
    for (uint32_t i = 0; result == DPT_OK && i < brute->segments; i++) {
        dpt_hit hit = DPT_HIT_INIT, true_hit = DPT_HIT_INIT;
        dpt_tool_get_segment_hit(world, id, i, &hit);
        result = dpt_tool_get_segment_hit(brute->world, brute->tool, i, &true_hit);
        *error = fmax(*error, off_by(&hit, nearest.segment, true_hit.distance));
    }
    return result;
}
