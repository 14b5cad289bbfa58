/* SPDX-License-Identifier: BSD-3-Clause */
/* The meshes on which proxies are judged: three that are made, and two real organs below DPT_DATA. */
#ifndef DPT_TESTS_BENCH_MESH_H
#define DPT_TESTS_BENCH_MESH_H

#include "lib/solid.h"

/* A shape of so many triangles, or a file of organs. */
static const struct {
    const char *name;
    uint64_t triangles;
} bench_meshes[] = { { "liver", 50332 },
                     { "torus", 61358 },
                     { "star", 20480 },
                     { "openhelp_spleen.stl", 0 },
                     { "hepatic_veins_sks.obj", 0 } };
enum { BENCH_MESHES = sizeof bench_meshes / sizeof *bench_meshes };

/* In metres. 0 where it is not there. */
static inline int bench_mesh_open(struct solid *solid, int number)
{
    const char *name = bench_meshes[number].name, *data = getenv("DPT_DATA");
    char path[1024];
    if (bench_meshes[number].triangles)
        return solid_from_shape(solid, name, bench_meshes[number].triangles);
    if (!data)
        return 0;
    snprintf(path, sizeof path, "%s/meshes/organs/%s", data, name);
    int is_open = solid_from_file(solid, name, path, 1);
    if (is_open && solid->diagonal > 1) {
        solid_close(solid);
        is_open = solid_from_file(solid, name, path, 1e-3);
    }
    return is_open;
}

#endif
