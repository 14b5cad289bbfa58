/* SPDX-License-Identifier: BSD-3-Clause */
#include "strip/strip_coverage.h"

/* A tool that came down onto the surface, or not. */
static int lie_down(const struct scene *scene, uint64_t *seed, double length, double radius, double margin,
                    double ends[6])
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
static void add_pose_coverage(struct scene *scene, const double ends[6], double length, double radius, double margin,
                              dpt_strip *strip, struct coverage *coverage)
{
    const struct oracle_surface *surface = &scene->subject->surface;
    const dpt_mesh *mesh = scene->subject->mesh;
    dpt_shadow shadow;
    memset(scene->mark, 0, surface->triangles);
    shadow_below(scene, ends, radius, &shadow);
    shadow.depth = 0.25 * length + radius + margin;
    for (int kind = 0; kind < COVERAGE_STRIPS; kind++) {
        uint32_t count = 0, flags = 0;
        shadow.width = kind == COVERAGE_WIDE ? margin : 0;
        const dpt_result result =
            kind == COVERAGE_ROUTES
                ? dpt_strip_routes(strip, mesh, nearest_to(scene, ends), nearest_to(scene, ends + 3), shadow.triangle)
                : dpt_strip_shadow(strip, mesh, NULL, &shadow);
        CHECK(result == DPT_OK || (kind == COVERAGE_ROUTES && result == DPT_E_UNREACHABLE), "%s: %s",
              scene->subject->name, dpt_result_name(result));
        coverage->apart += result == DPT_E_UNREACHABLE;
        const uint32_t *triangles = dpt_strip_get_triangles(strip, &count, &flags);
        CHECK(!(flags & DPT_STRIP_FLAG_FULL), "%s: full", scene->subject->name);
        for (uint32_t i = 0; i < count; i++)
            scene->mark[triangles[i]] |= (unsigned char)(1 << kind);
        coverage->size[kind] += count;
        if (kind == COVERAGE_ROUTES)
            continue;
        oracle_shadow_of(scene, &shadow, &scene->shadow);
        oracle_sheet_loose(&scene->sheet, &scene->shadow, shadow.triangle);
        coverage->sheet[kind] += scene->sheet.sure;
        for (uint32_t i = 0; i < count; i++)
            coverage->in_strip[kind] += scene->sheet.in[triangles[i]] == ORACLE_SURE;
    }
    for (uint32_t t = 0; t < surface->triangles; t++) {
        double corners[9];
        if (surface->corner[t][0] == ORACLE_NONE)
            continue;
        scene_triangle(scene, t, corners);
        if (!(dpt_segment_triangle(ends, corners, NULL, NULL, NULL) <= radius + margin))
            continue;
        coverage->near++;
        for (int kind = 0; kind < COVERAGE_STRIPS; kind++)
            coverage->found[kind] += scene->mark[t] >> kind & 1;
    }
    coverage->poses++;
}

void coverage_of(const struct subject *subject, double share, size_t poses, uint64_t seed, struct coverage *coverage)
{
    const double length = share * subject->diagonal;
    const double radius = 0.005 * subject->diagonal, margin = 0.01 * subject->diagonal;
    struct scene scene;
    struct guarded_strip guarded;
    *coverage = (struct coverage){ .poses = 0 };
    scene_open(&scene, subject);
    dpt_strip *strip = guarded_strip_open(&guarded, subject->info.triangles, subject->info.vertices);
    for (size_t tries = 0; coverage->poses < poses && tries < 20 * poses; tries++) {
        double ends[6];
        if (lie_down(&scene, &seed, length, radius, margin, ends))
            add_pose_coverage(&scene, ends, length, radius, margin, strip, coverage);
    }
    guarded_strip_close(&guarded);
    scene_close(&scene);
}
