/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How much of what is under a tool a strip holds, at poses where the tool lies on the surface: its surface between 0 and
 * `margin` from the mesh. Against every triangle of the mesh. Sizes are of the mesh's diagonal: margin 0.01, radius
 * 0.005, and the length that is asked for; the depth is what a world takes, a quarter of the length, radius and margin.
 */
#ifndef DPT_TESTS_STRIP_RECALL_H
#define DPT_TESTS_STRIP_RECALL_H

#include "strip/strip_scene.h"

/* Sums over poses. `near`: triangles within the margin of the tool; strips: the paper's, and shadows of these widths. */
enum { RECALL_ROUTES, RECALL_NARROW, RECALL_WIDE, RECALL_STRIPS }; /* width 0 and margin */

struct recall {
    size_t poses, apart; /* where the paper's has no route, which counts as an empty strip */
    size_t near;
    size_t size[RECALL_STRIPS];   /* triangles of the strip */
    size_t found[RECALL_STRIPS];  /* of those that are near */
    size_t sheet[RECALL_STRIPS];  /* that meet the shadow and hang together over vertices */
    size_t walked[RECALL_STRIPS]; /* of them in the strip */
};

static inline uint32_t nearest_to(const struct scene *scene, const double at[3])
{
    const double ends[6] = { at[0], at[1], at[2], at[0], at[1], at[2] };
    return nearest_of(scene, ends, 0).triangle;
}

/* A tool that came down onto the surface, or not. */
static inline int lie_down(const struct scene *scene, uint64_t *seed, double length, double radius,
                           double margin, double ends[6])
{
    struct slide slide = { .mesh = scene->subject->mesh,
                           .radius = radius,
                           .gap = random_in(seed, 0.05, 0.8) * margin,
                           .step = 0.3 * margin,
                           .spin = 0.002,
                           .seed = random_bits(seed) };
    tool_at(scene, seed, length, radius + slide.gap, 1, slide.ends);
    random_unit(&slide.seed, slide.axis);
    random_unit(&slide.seed, slide.course);
    for (int i = 0; i < 40; i++)
        slide_step(&slide);
    const dpt_hit hit = nearest_of(scene, slide.ends, radius);
    memcpy(ends, slide.ends, sizeof slide.ends);
    return hit.distance > radius && hit.distance < radius + margin && hit.gap > 0;
}

/* scene->mark of a triangle: bit k of strip k, bit 7 where it is near. */
static inline void recall_pose(struct scene *scene, const double ends[6], double length,
                               double radius, double margin, dpt_strip *strip,
                               struct recall *recall)
{
    const struct oracle_surface *surface = &scene->subject->surface;
    const dpt_mesh *mesh = scene->subject->mesh;
    dpt_shadow shadow;
    memset(scene->mark, 0, surface->triangles);
    shadow_below(scene, ends, radius, &shadow);
    shadow.depth = 0.25 * length + radius + margin;
    for (int kind = 0; kind < RECALL_STRIPS; kind++) {
        uint32_t count = 0, flags = 0;
        shadow.width = kind == RECALL_WIDE ? margin : 0;
        const dpt_result result =
            kind == RECALL_ROUTES ? dpt_strip_routes(strip, mesh, nearest_to(scene, ends),
                                                     nearest_to(scene, ends + 3), shadow.triangle)
                                  : dpt_strip_shadow(strip, mesh, NULL, &shadow);
        CHECK(result == DPT_OK || (kind == RECALL_ROUTES && result == DPT_E_UNREACHABLE), "%s: %s",
              scene->subject->name, dpt_result_name(result));
        recall->apart += result == DPT_E_UNREACHABLE;
        const uint32_t *triangles = dpt_strip_get_triangles(strip, &count, &flags);
        CHECK(!(flags & DPT_STRIP_FLAG_FULL), "%s: full", scene->subject->name);
        for (uint32_t i = 0; i < count; i++)
            scene->mark[triangles[i]] |= (unsigned char)(1 << kind);
        recall->size[kind] += count;
        if (kind == RECALL_ROUTES)
            continue;
        oracle_shadow_of(scene, &shadow, &scene->shadow);
        oracle_sheet_loose(&scene->sheet, &scene->shadow, shadow.triangle);
        recall->sheet[kind] += scene->sheet.sure;
        for (uint32_t i = 0; i < count; i++)
            recall->walked[kind] += scene->sheet.in[triangles[i]] == ORACLE_SURE;
    }
    for (uint32_t t = 0; t < surface->triangles; t++) {
        double corners[9];
        if (surface->corner[t][0] == ORACLE_NONE)
            continue;
        scene_triangle(scene, t, corners);
        if (!(dpt_segment_triangle(ends, corners, NULL, NULL, NULL) <= radius + margin))
            continue;
        recall->near++;
        for (int kind = 0; kind < RECALL_STRIPS; kind++)
            recall->found[kind] += scene->mark[t] >> kind & 1;
    }
    recall->poses++;
}

/* Of a tool as long as this share of the diagonal. */
static inline void recall_of(const struct subject *subject, double share, size_t poses,
                             uint64_t seed, struct recall *recall)
{
    const double length = share * subject->diagonal;
    const double radius = 0.005 * subject->diagonal, margin = 0.01 * subject->diagonal;
    struct scene scene;
    struct held_strip held;
    *recall = (struct recall){ .poses = 0 };
    scene_open(&scene, subject);
    dpt_strip *strip = hold_strip(&held, subject->info.triangles, subject->info.vertices);
    for (size_t tries = 0; recall->poses < poses && tries < 20 * poses; tries++) {
        double ends[6];
        if (lie_down(&scene, &seed, length, radius, margin, ends))
            recall_pose(&scene, ends, length, radius, margin, strip, recall);
    }
    drop_strip(&held);
    scene_close(&scene);
}

static inline double share_of(size_t part, size_t whole)
{
    return whole ? (double)part / (double)whole : 1;
}

#endif
