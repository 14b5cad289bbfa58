/* SPDX-License-Identifier: BSD-3-Clause */
/* A user's program: compiles a triangle, opens it, and asks for a distance that is 1. ALONE: with the single files. */
#include <dynpoint.h>
#ifdef ALONE
#include <dynpoint_compile.h>
#else
#include <dynpoint/compile.h>
#endif
int main(void)
{
    const double vertices[9] = { 0, 0, 0, 1, 0, 0, 0, 1, 0 }, ends[6] = { 0.2, 0.2, 1, 0.3, 0.3, 2 };
    const uint32_t corners[3] = { 0, 1, 2 };
    dpt_compiled file;
    const dpt_mesh *mesh;
    dpt_hit hit = DPT_HIT_INIT;
    if (dpt_compile_arrays(vertices, 3, corners, 1, NULL, &file, NULL) != DPT_OK ||
        dpt_mesh_open(file.bytes, file.size, &mesh) != DPT_OK ||
        dpt_query_segments(mesh, NULL, ends, NULL, 1, &hit, NULL) != DPT_OK)
        return 1;
    return hit.distance - 1.0 <= hit.error_bound && 1.0 - hit.distance <= hit.error_bound ? 0 : 1;
}
