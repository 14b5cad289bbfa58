/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * dump_mesh MESH.dpa MESH.tri: the mesh as plain arrays, so that no peer needs this library. Binary,
 * little-endian: uint32 vertex count, uint32 triangle count, float x y z each, uint32 corners. Three
 * vertices a triangle; dropped triangles are left out.
 */
#include <stdlib.h>
#include <string.h>

#include "bench/plain_files.h"
#include "cli/command_options.h"

static void put_float(FILE *file, double value)
{
    float rounded = (float)value;
    uint32_t bits;
    memcpy(&bits, &rounded, sizeof bits);
    plain_put_word(file, bits);
}

int main(int argc, char **argv)
{
    void *bytes;
    double corners[9];
    struct output output;
    dpt_mesh_info info = { .size = sizeof info };
    if (argc != 3)
        return complain("dump_mesh", "MESH.dpa and MESH.tri are needed");
    const dpt_mesh *mesh = load_mesh("dump_mesh", argv[1], &bytes);
    if (!mesh || output_open(&output, "dump_mesh", argv[2]))
        return 2;
    dpt_mesh_get_info(mesh, &info);
    plain_put_word(output.file, 3 * info.triangles);
    plain_put_word(output.file, info.triangles);
    for (uint32_t t = 0; t < info.source_triangles; t++)
        if (dpt_mesh_get_triangle(mesh, t, corners) == DPT_OK)
            for (int i = 0; i < 9; i++)
                put_float(output.file, corners[i]);
    for (uint32_t c = 0; c < 3 * info.triangles; c++)
        plain_put_word(output.file, c);
    free(bytes);
    return output_close(&output, "dump_mesh");
}
