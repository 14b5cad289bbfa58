/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How the vertices of a mesh move in the benchmark of deformable bodies: the same for dynpoint and for the peers, bit
 * for bit, so C99 that is C++ too. A motion is "modes" or "dent", and how far a vertex moves in a tick at most.
 *
 *   modes   every vertex, every tick: waves about as long as the mesh, which run through it
 *   dent    DENT_VERTICES vertices near the tool sink in and rise again, for DENT_TICKS ticks; then others do
 *
 * vertex_motion_open_recorded plays back what was written to a file: uint32 count, and for each tick the positions of
 * the first `count` vertices, 3 floats each, in the byte order of the machine. After its last tick the vertices stay.
 */
#ifndef DPT_BENCH_VERTEX_MOTION_H
#define DPT_BENCH_VERTEX_MOTION_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DENT_VERTICES = 2000, DENT_TICKS = 100 };

struct dent_vertex {
    double square; /* of the distance from the dent's middle */
    uint32_t vertex;
};

struct vertex_motion {
    const float *rest;
    const double *trace; /* 6 numbers a tick: the ends of the tool */
    uint32_t vertices;
    int is_dent;
    double step;   /* m */
    float *cosine; /* the displacement is amplitude (cosine cos(phase) + sine sin(phase)) */
    float *sine;
    float *positions; /* of the last tick that was asked for */
    /* Of a dent: its vertices in ascending order, and where they are. */
    size_t stretch; /* which dent it is, + 1; 0: none yet */
    uint32_t count;
    uint32_t *list;
    float *listed;
    double inwards[3];
    struct dent_vertex *dent;
    /* Of what was recorded. */
    float *recorded;
    size_t recorded_ticks;
    uint32_t recorded_count;
};

/* 0 where there is no memory or no motion of this name. The arrays given are kept. */
static inline int vertex_motion_open(struct vertex_motion *motion, const char *name, double step, const float *rest,
                                     uint32_t vertices, const double *trace)
{
    const size_t floats = 3 * (size_t)vertices;
    double low[3], high[3], diagonal = 0.0;
    memset(motion, 0, sizeof *motion);
    motion->rest = rest;
    motion->trace = trace;
    motion->vertices = vertices;
    motion->step = step;
    motion->is_dent = !strcmp(name, "dent");
    motion->cosine = (float *)malloc(floats * sizeof(float));
    motion->sine = (float *)malloc(floats * sizeof(float));
    motion->positions = (float *)malloc(floats * sizeof(float));
    motion->list = (uint32_t *)malloc(DENT_VERTICES * sizeof(uint32_t));
    motion->listed = (float *)malloc(3 * DENT_VERTICES * sizeof(float));
    motion->dent = (struct dent_vertex *)malloc(vertices * sizeof(struct dent_vertex));
    if (!motion->cosine || !motion->sine || !motion->positions || !motion->list || !motion->listed || !motion->dent ||
        (!motion->is_dent && strcmp(name, "modes")))
        return 0;
    for (int k = 0; k < 3; k++) {
        low[k] = high[k] = (double)rest[k];
        for (size_t i = (size_t)k; i < floats; i += 3) {
            low[k] = fmin(low[k], (double)rest[i]);
            high[k] = fmax(high[k], (double)rest[i]);
        }
        diagonal += (high[k] - low[k]) * (high[k] - low[k]);
    }
    diagonal = sqrt(diagonal);
    for (size_t v = 0; v < vertices; v++) {
        double x[3], angle[3];
        for (size_t k = 0; k < 3; k++)
            x[k] = ((double)rest[3 * v + k] - low[k]) / diagonal;
        angle[0] = 7.0 * x[0] + 3.0 * x[1];
        angle[1] = 1.0 + 5.0 * x[2];
        angle[2] = 2.0 + 6.0 * x[1] + 2.0 * x[0];
        for (size_t k = 0; k < 3; k++) {
            motion->cosine[3 * v + k] = (float)(sin(angle[k]) / sqrt(3.0));
            motion->sine[3 * v + k] = (float)(cos(angle[k]) / sqrt(3.0));
        }
    }
    memcpy(motion->positions, rest, floats * sizeof(float));
    return 1;
}

/* What was recorded in a file; 0 where there is no such file, or it is none of this mesh. */
static inline int vertex_motion_open_recorded(struct vertex_motion *motion, const char *path, const float *rest,
                                              uint32_t vertices)
{
    FILE *file = fopen(path, "rb");
    long size = -1;
    memset(motion, 0, sizeof *motion);
    motion->rest = rest;
    motion->vertices = vertices;
    if (!file || fseek(file, 0, SEEK_END) || (size = ftell(file)) < 4 || fseek(file, 0, SEEK_SET) ||
        fread(&motion->recorded_count, 4, 1, file) != 1 || !motion->recorded_count ||
        motion->recorded_count > vertices) {
        if (file)
            fclose(file);
        return 0;
    }
    const size_t floats = 3 * (size_t)motion->recorded_count;
    motion->recorded_ticks = ((size_t)size - 4) / (floats * sizeof(float));
    motion->recorded = (float *)malloc((size_t)size);
    motion->positions = (float *)malloc(3 * (size_t)vertices * sizeof(float));
    const int whole =
        motion->recorded && motion->positions && motion->recorded_ticks &&
        fread(motion->recorded, floats * sizeof(float), motion->recorded_ticks, file) == motion->recorded_ticks;
    fclose(file);
    if (!whole)
        return 0;
    memcpy(motion->positions, rest, 3 * (size_t)vertices * sizeof(float));
    return 1;
}

static inline void vertex_motion_close(struct vertex_motion *motion)
{
    free(motion->recorded);
    free(motion->cosine);
    free(motion->sine);
    free(motion->positions);
    free(motion->list);
    free(motion->listed);
    free(motion->dent);
}

/* The square of the distance of a vertex from the tool. */
static inline double square_from_tool(const float *vertex, const double ends[6])
{
    double u[3], v[3], uu = 0.0, uv = 0.0, square = 0.0;
    for (int k = 0; k < 3; k++) {
        u[k] = ends[3 + k] - ends[k];
        v[k] = (double)vertex[k] - ends[k];
        uu += u[k] * u[k];
        uv += u[k] * v[k];
    }
    const double s = uu > 0.0 ? fmin(fmax(uv / uu, 0.0), 1.0) : 0.0;
    for (int k = 0; k < 3; k++)
        square += (v[k] - s * u[k]) * (v[k] - s * u[k]);
    return square;
}

static inline int dent_order(const void *a, const void *b)
{
    const struct dent_vertex *x = (const struct dent_vertex *)a;
    const struct dent_vertex *y = (const struct dent_vertex *)b;
    return x->square != y->square ? (x->square > y->square) - (x->square < y->square)
                                  : (x->vertex > y->vertex) - (x->vertex < y->vertex);
}

static inline int list_order(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* Choose the dent of a stretch of ticks: about the vertex nearest to the tool in its first one. */
static inline void begin_dent(struct vertex_motion *motion, size_t stretch)
{
    const float *rest = motion->rest;
    const double *ends = motion->trace + 6 * stretch * DENT_TICKS;
    double sum[3] = { 0.0, 0.0, 0.0 }, length = 0.0;
    uint32_t middle = 0;
    memcpy(motion->positions, rest, 3 * (size_t)motion->vertices * sizeof(float));
    motion->stretch = stretch + 1;
    for (uint32_t v = 1; v < motion->vertices; v++)
        if (square_from_tool(rest + 3 * (size_t)v, ends) < square_from_tool(rest + 3 * (size_t)middle, ends))
            middle = v;
    for (uint32_t v = 0; v < motion->vertices; v++) {
        struct dent_vertex *dent = &motion->dent[v];
        dent->vertex = v;
        dent->square = 0.0;
        for (size_t k = 0; k < 3; k++) {
            const double x = (double)rest[3 * (size_t)v + k];
            const double from = x - (double)rest[3 * (size_t)middle + k];
            dent->square += from * from;
            sum[k] += x / motion->vertices;
        }
    }
    qsort(motion->dent, motion->vertices, sizeof *motion->dent, dent_order);
    motion->count = DENT_VERTICES;
    if (motion->count > motion->vertices)
        motion->count = motion->vertices;
    for (uint32_t i = 0; i < motion->count; i++)
        motion->list[i] = motion->dent[i].vertex;
    qsort(motion->list, motion->count, sizeof *motion->list, list_order);
    for (size_t k = 0; k < 3; k++) {
        motion->inwards[k] = sum[k] - (double)rest[3 * (size_t)middle + k];
        length += motion->inwards[k] * motion->inwards[k];
    }
    for (size_t k = 0; k < 3; k++)
        motion->inwards[k] /= sqrt(length);
    /* From here on by vertex, not by distance. */
    const double reach = motion->dent[motion->count - 1].square;
    for (uint32_t i = 0; i < motion->count; i++) {
        const float *x = rest + 3 * (size_t)motion->list[i];
        double square = 0.0;
        for (size_t k = 0; k < 3; k++) {
            const double from = (double)x[k] - (double)rest[3 * (size_t)middle + k];
            square += from * from;
        }
        motion->dent[i].square = 1.0 - square / reach;
    }
}

/* Set `positions`, and of a dent `list` and `listed`, to those of a tick; it depends on nothing but the tick. */
static inline void vertex_motion_at(struct vertex_motion *motion, size_t tick)
{
    const size_t floats = 3 * (size_t)motion->vertices;
    const double turn = motion->is_dent ? 2.0 * 3.14159265358979323846 / DENT_TICKS : 0.05;
    const double amplitude = motion->step / turn;
    if (motion->recorded) {
        const size_t count = 3 * (size_t)motion->recorded_count;
        const size_t at = tick < motion->recorded_ticks ? tick : motion->recorded_ticks - 1;
        memcpy(motion->positions, motion->recorded + count * at, count * sizeof(float));
        return;
    }
    if (!motion->is_dent) {
        const float c = (float)(amplitude * cos(turn * (double)tick));
        const float s = (float)(amplitude * sin(turn * (double)tick));
        for (size_t i = 0; i < floats; i++)
            motion->positions[i] = motion->rest[i] + (c * motion->cosine[i] + s * motion->sine[i]);
        return;
    }
    const size_t stretch = tick ? (tick - 1) / DENT_TICKS : 0;
    if (motion->stretch != stretch + 1)
        begin_dent(motion, stretch);
    const double depth = tick % DENT_TICKS ? amplitude * sin(turn * (double)(tick % DENT_TICKS)) : 0.0;
    for (uint32_t i = 0; i < motion->count; i++) {
        const size_t at = 3 * (size_t)motion->list[i];
        for (size_t k = 0; k < 3; k++) {
            const double moved = depth * motion->dent[i].square * motion->inwards[k];
            motion->listed[3 * i + k] = (float)((double)motion->rest[at + k] + moved);
            motion->positions[at + k] = motion->listed[3 * i + k];
        }
    }
}

#endif
