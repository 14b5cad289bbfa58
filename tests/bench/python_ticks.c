/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What tests/bench/python_ticks.py compares with: the same calls in C.
 *
 *     python_ticks FILE.dpa ticks N       ns a tick of set_pose, step and get_wrench, on a tool that stands still
 *     python_ticks FILE.dpa query N ENDS  ns a segment of dpt_query_segments, of a file of float64
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "dynpoint.h"

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return (double)time.tv_sec * 1e9 + (double)time.tv_nsec;
}

static void *read_file(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    void *bytes = NULL;
    if (!file || fseek(file, 0, SEEK_END) != 0)
        exit(2);
    *size = (size_t)ftell(file);
    rewind(file);
    if (posix_memalign(&bytes, 64, *size) != 0 || fread(bytes, 1, *size, file) != *size)
        exit(2);
    fclose(file);
    return bytes;
}

static double run_ticks(const dpt_mesh *mesh, long count)
{
    dpt_world_def def;
    dpt_world *world;
    dpt_body body;
    dpt_tool tool;
    dpt_wrench wrench;
    const dpt_segment segment = { { 0, 0, 0 }, { 0, 0.1, 0 }, 0.002 };
    const dpt_pose pose = { { 0, 0.5, 0 }, { 1, 0, 0, 0 } };
    dpt_world_def_init(&def);
    void *block = malloc(dpt_world_bytes(&def));
    if (dpt_world_create(block, dpt_world_bytes(&def), &def, &world) || dpt_body_add(world, mesh, NULL, &body) ||
        dpt_tool_add(world, &segment, 1, &tool))
        exit(2);
    const double began = now();
    for (long i = 0; i < count; i++) {
        dpt_tool_set_pose(world, tool, &pose);
        dpt_world_step(world, 0.001, NULL);
        dpt_tool_get_wrench(world, tool, &wrench);
    }
    const double took = now() - began;
    free(block);
    return took / (double)count;
}

int main(int argc, char **argv)
{
    size_t size, bytes;
    const dpt_mesh *mesh;
    if (argc < 4)
        return 2;
    const void *content = read_file(argv[1], &size);
    if (dpt_mesh_open(content, size, &mesh) != DPT_OK)
        return 2;
    const long count = atol(argv[3]);
    if (strcmp(argv[2], "ticks") == 0) {
        printf("%.2f\n", run_ticks(mesh, count));
        return 0;
    }
    const double *ends = read_file(argv[4], &bytes);
    dpt_hit *hits = calloc((size_t)count, sizeof *hits);
    if (!hits || bytes < (size_t)count * 48)
        return 2;
    hits->size = sizeof *hits;
    const double began = now();
    if (dpt_query_segments(mesh, NULL, ends, NULL, (size_t)count, hits, NULL) != DPT_OK)
        return 2;
    printf("%.2f\n", (now() - began) / (double)count);
    free(hits);
    return 0;
}
