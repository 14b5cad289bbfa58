/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The files that benchmarks and peers share (README.md here), for programs that know the library. What fails ends the
 * program.
 */
#ifndef DPT_BENCH_PLAIN_FILES_H
#define DPT_BENCH_PLAIN_FILES_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dynpoint/mesh.h"

static inline void plain_fail(const char *path, const char *what)
{
    fprintf(stderr, "%s: %s\n", path, what);
    exit(2);
}

/* The bytes of a .dpa stay until the program ends. */
static inline const dpt_mesh *plain_open_mesh(const char *path)
{
    FILE *file = fopen(path, "rb");
    void *bytes = NULL;
    const dpt_mesh *mesh;
    long size = -1;
    int here = file && fseek(file, 0, SEEK_END) == 0 && (size = ftell(file)) > 0 && fseek(file, 0, SEEK_SET) == 0 &&
               !posix_memalign(&bytes, 64, (size_t)size);
    if (!here || fread(bytes, (size_t)size, 1, file) != 1 || dpt_mesh_open(bytes, (size_t)size, &mesh) != DPT_OK)
        plain_fail(path, "the mesh cannot be read");
    fclose(file);
    return mesh;
}

/* TRACE.csv: 6 numbers a tick, at most `most` ticks. */
static inline double *plain_read_trace(const char *path, size_t most, size_t *ticks)
{
    FILE *file = fopen(path, "r");
    char line[512];
    double *trace = (double *)malloc(6 * most * sizeof(double));
    *ticks = 0;
    while (file && trace && *ticks < most && fgets(line, sizeof line, file)) {
        double *x = trace + 6 * *ticks;
        *ticks += sscanf(line, "%*[^,],%lf,%lf,%lf,%lf,%lf,%lf", x, x + 1, x + 2, x + 3, x + 4, x + 5) == 6;
    }
    if (file)
        fclose(file);
    if (*ticks < 2)
        plain_fail(path, "the trace holds no motion");
    return trace;
}

static inline void plain_put_word(FILE *file, uint32_t word)
{
    for (int i = 0; i < 4; i++)
        fputc((int)(word >> (8 * i) & 255), file);
}

/* MESH.tri. */
static inline void plain_write_tri(const char *path, const float *xyz, uint32_t vertices, const uint32_t *corners,
                                   uint32_t triangles)
{
    FILE *file = fopen(path, "wb");
    if (!file)
        plain_fail(path, "cannot be written");
    plain_put_word(file, vertices);
    plain_put_word(file, triangles);
    for (size_t i = 0; i < 3 * (size_t)vertices; i++) {
        uint32_t bits;
        memcpy(&bits, &xyz[i], sizeof bits);
        plain_put_word(file, bits);
    }
    for (size_t i = 0; i < 3 * (size_t)triangles; i++)
        plain_put_word(file, corners[i]);
    if (fclose(file))
        plain_fail(path, "cannot be written");
}

#endif
