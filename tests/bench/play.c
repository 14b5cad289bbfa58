/* SPDX-License-Identifier: BSD-3-Clause */
#include "bench/play.h"

#include <string.h>

#include "bench/plain_files.h"
#include "bench/timing.h"
#include "dynpoint/baseline.h"

enum { PATH_BYTES = 500 };

struct way {
    const char *name, *until_name;
    uint32_t method, parts, until, law;
};

#define PAPER(name, parts)                                                                                             \
    { name, "track", DPT_METHOD_PAPER, parts, DPT_UNTIL_TRACK, DPT_LAW_POINT },                                        \
    {                                                                                                                  \
        name, "respond", DPT_METHOD_PAPER, parts, DPT_UNTIL_RESPOND, DPT_LAW_POINT                                     \
    }

static const struct way ways[] = {
    { "exact", "track", DPT_METHOD_EXACT, 1, DPT_UNTIL_TRACK, DPT_LAW_PROXY },
    { "exact", "contact", DPT_METHOD_EXACT, 1, DPT_UNTIL_CONTACT, DPT_LAW_PROXY },
    { "exact", "respond", DPT_METHOD_EXACT, 1, DPT_UNTIL_RESPOND, DPT_LAW_PROXY },
    PAPER("paper-1", 1),
    PAPER("paper-2", 2),
    PAPER("paper-4", 4),
    PAPER("paper-8", 8),
    PAPER("paper-16", 16),
    { "brute", "track", DPT_METHOD_BRUTE, 1, DPT_UNTIL_TRACK, DPT_LAW_POINT },
    { "brute", "respond", DPT_METHOD_BRUTE, 1, DPT_UNTIL_RESPOND, DPT_LAW_POINT },
};

struct stage {
    void *block, *body_block;
    dpt_world *world;
    dpt_body body[PLAY_BODIES];
    dpt_tool tool;
};

static void *array(size_t count, size_t bytes)
{
    void *made = calloc(count, bytes);
    if (!made)
        plain_fail("play", "no memory");
    return made;
}

static uint32_t vertices_of(const dpt_mesh *mesh, const float **xyz)
{
    uint32_t count = 0;
    dpt_mesh_get_vertices(mesh, xyz, &count);
    return count;
}

static uint32_t triangles_of(const dpt_mesh *mesh, const uint32_t **corners, const uint32_t **numbers)
{
    uint32_t count = 0;
    dpt_mesh_get_triangles(mesh, corners, numbers, &count);
    return count;
}

static dpt_segment segment_at(const struct play *play, int tick)
{
    dpt_segment segment = { .radius = play->radius };
    memcpy(segment.a, play->ends + 6 * tick, sizeof segment.a);
    memcpy(segment.b, play->ends + 6 * tick + 3, sizeof segment.b);
    return segment;
}

static dpt_result add_soft(const struct play *play, struct stage *stage)
{
    dpt_deformable_def def;
    dpt_deformable_def_init(&def);
    def.mesh = play->mesh[0];
    for (int k = 0; k < 3; k++) {
        def.box_min[k] = -1.0;
        def.box_max[k] = 1.0;
    }
    const size_t bytes = dpt_deformable_bytes(&def);
    stage->body_block = array(1, bytes);
    return dpt_body_add_deformable(stage->world, stage->body_block, bytes, &def, &stage->body[0]);
}

static void open_stage(const struct play *play, const struct way *way, struct stage *stage)
{
    dpt_world_def def;
    dpt_baseline_def baseline;
    dpt_world_def_init(&def);
    def.max_contacts = 32;
    dpt_baseline_def_init(&baseline);
    memset(stage, 0, sizeof *stage);
    baseline.parts = way->parts;
    def.method = way->method;
    def.until = way->until;
    def.law = way->law;
    def.baseline = way->method == DPT_METHOD_PAPER ? &baseline : NULL;
    stage->block = array(1, dpt_world_bytes(&def));
    dpt_result result = dpt_world_create(stage->block, dpt_world_bytes(&def), &def, &stage->world);
    for (int i = 0; i < play->bodies && result == DPT_OK; i++)
        result = !i && play->positions ? add_soft(play, stage)
                                       : dpt_body_add(stage->world, play->mesh[i], NULL, &stage->body[i]);
    const dpt_segment segment = segment_at(play, 0);
    if (result == DPT_OK)
        result = dpt_tool_add(stage->world, &segment, 1, &stage->tool);
    if (result != DPT_OK)
        plain_fail(way->name, dpt_result_text(result));
}

/* Where each triangle of the source is in MESH.tri; a block for all bodies, `from` says where each begins. */
static uint32_t *places_of(const struct play *play, size_t from[PLAY_BODIES])
{
    size_t all = 0;
    uint32_t base = 0;
    dpt_mesh_info info = { .size = sizeof info };
    for (int i = 0; i < play->bodies; i++) {
        from[i] = all;
        dpt_mesh_get_info(play->mesh[i], &info);
        all += info.source_triangles;
    }
    uint32_t *places = array(all, sizeof *places);
    for (int i = 0; i < play->bodies; i++) {
        const uint32_t *corners, *numbers;
        const uint32_t count = triangles_of(play->mesh[i], &corners, &numbers);
        for (uint32_t t = 0; t < count; t++)
            places[from[i] + numbers[t]] = base + t;
        base += count;
    }
    return places;
}

static FILE *open_file(const struct play *play, const char *dir, const char *end, const char *mode)
{
    char path[PATH_BYTES];
    snprintf(path, sizeof path, "%s/%s.%s", dir, play->name, end);
    FILE *file = fopen(path, mode);
    if (!file)
        plain_fail(path, "cannot be written");
    return file;
}

static void close_file(const struct play *play, FILE *file)
{
    if (fclose(file))
        plain_fail(play->name, "a file cannot be written");
}

static void write_answers(const struct play *play, const char *dir, const struct way *way, const struct stage *stage,
                          const dpt_hit *hits)
{
    char end[64];
    size_t from[PLAY_BODIES];
    uint32_t *places = places_of(play, from);
    snprintf(end, sizeof end, "%s.csv", way->name);
    FILE *file = open_file(play, dir, end, "w");
    fprintf(file, "tick,distance,triangle\n");
    for (int tick = 0; tick < play->ticks; tick++) {
        int body = 0;
        while (body < play->bodies - 1 && stage->body[body] != hits[tick].body)
            body++;
        fprintf(file, "%d,%.17g,%u\n", tick, hits[tick].distance, places[from[body] + hits[tick].triangle]);
    }
    close_file(play, file);
    free(places);
}

static double quantile(double *sorted, int count, int percent)
{
    return count ? sorted[(size_t)percent * (size_t)(count - 1) / 100] : 0.0;
}

static void play_one(const struct play *play, const struct way *way, FILE *rows, const char *dir)
{
    struct stage stage;
    const float *rest;
    const uint32_t vertices = vertices_of(play->mesh[0], &rest);
    double *set = array((size_t)play->ticks, sizeof *set);
    double *step = array((size_t)play->ticks, sizeof *step);
    dpt_hit *hits = array((size_t)play->ticks, sizeof *hits);
    open_stage(play, way, &stage);
    for (int tick = 0; tick < play->ticks; tick++) {
        const dpt_segment segment = segment_at(play, tick);
        const float *positions = play->positions ? play->positions(play->self, tick) : NULL;
        const double begin = now();
        dpt_result result =
            positions ? dpt_body_set_vertices(stage.world, stage.body[0], 0, vertices, positions, -1.0) : DPT_OK;
        set[tick] = positions ? now() - begin : 0.0;
        if (result == DPT_OK)
            result = dpt_tool_set_segments(stage.world, stage.tool, &segment, 1);
        const double middle = now();
        if (result == DPT_OK)
            result = dpt_world_step(stage.world, 1e-3, NULL);
        step[tick] = now() - middle;
        hits[tick].size = sizeof *hits;
        if (result == DPT_OK)
            result = dpt_tool_get_hit(stage.world, stage.tool, &hits[tick]);
        if (result != DPT_OK)
            plain_fail(way->name, dpt_result_text(result));
    }
    if (way->until == DPT_UNTIL_TRACK)
        write_answers(play, dir, way, &stage, hits);
    const int count = play->ticks - 1;
    qsort(set + 1, (size_t)count, sizeof *set, by_size);
    qsort(step + 1, (size_t)count, sizeof *step, by_size);
    fprintf(rows, "%s,%s,%s,%d,%.0f,%.0f,%.0f\n", play->name, way->name, way->until_name, count,
            quantile(set + 1, count, 50), quantile(step + 1, count, 50), quantile(step + 1, count, 99));
    fflush(rows);
    free(stage.block);
    free(stage.body_block);
    free(set);
    free(step);
    free(hits);
}

void play_all(const struct play *play, FILE *rows, const char *dir)
{
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++)
        if (play->with_brute || ways[i].method != DPT_METHOD_BRUTE)
            play_one(play, &ways[i], rows, dir);
}

static void write_mesh(const struct play *play, const char *dir)
{
    char path[PATH_BYTES];
    uint32_t vertices = 0, triangles = 0;
    const float *xyz;
    const uint32_t *corners;
    for (int i = 0; i < play->bodies; i++) {
        vertices += vertices_of(play->mesh[i], &xyz);
        triangles += triangles_of(play->mesh[i], &corners, NULL);
    }
    float *all_xyz = array(3 * (size_t)vertices, sizeof *all_xyz);
    uint32_t *all_corners = array(3 * (size_t)triangles, sizeof *all_corners);
    uint32_t base = 0;
    size_t at = 0;
    for (int i = 0; i < play->bodies; i++) {
        const uint32_t count = vertices_of(play->mesh[i], &xyz);
        const uint32_t of_them = triangles_of(play->mesh[i], &corners, NULL);
        if (!i && play->first)
            xyz = play->first;
        memcpy(all_xyz + 3 * (size_t)base, xyz, 3 * (size_t)count * sizeof *xyz);
        for (size_t c = 0; c < 3 * (size_t)of_them; c++)
            all_corners[at++] = base + corners[c];
        base += count;
    }
    snprintf(path, sizeof path, "%s/%s.tri", dir, play->name);
    plain_write_tri(path, all_xyz, vertices, all_corners, triangles);
    free(all_xyz);
    free(all_corners);
}

void play_write(const struct play *play, const char *dir)
{
    write_mesh(play, dir);
    FILE *trace = open_file(play, dir, "csv", "w");
    fprintf(trace, "tick,ax,ay,az,bx,by,bz\n");
    for (int tick = 0; tick < play->ticks; tick++) {
        const double *x = play->ends + 6 * tick;
        fprintf(trace, "%d,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", tick, x[0], x[1], x[2], x[3], x[4], x[5]);
    }
    close_file(play, trace);
}

void play_write_motion(const struct play *play, const char *dir)
{
    const float *rest;
    const uint32_t vertices = vertices_of(play->mesh[0], &rest);
    FILE *motion = open_file(play, dir, "motion", "wb");
    fwrite(&vertices, sizeof vertices, 1, motion);
    for (int tick = 0; tick < play->ticks; tick++)
        fwrite(play->positions(play->self, tick), 3 * sizeof(float), vertices, motion);
    close_file(play, motion);
}
