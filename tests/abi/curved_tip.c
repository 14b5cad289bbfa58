/* SPDX-License-Identifier: BSD-3-Clause */
/* A user of libdynpoint_convex: a needle's cone, a tenth of a millimetre in a plate, is taken out upward. */
#include <dynpoint.h>
#include <dynpoint/compile.h>
#include <dynpoint/convex.h>

int main(void)
{
    const double vertices[9] = { -1, -1, 0, 1, -1, 0, 0, 1, 0 };
    const uint32_t corners[3] = { 0, 1, 2 };
    dpt_convex_shape tip = { .size = sizeof tip, .pose = DPT_POSE_IDENTITY, .extent = { 0.001, 0, 0.002 } };
    dpt_pose pose = { { 0.01, 0.02, 0.0009 }, { 1, 0, 0, 0 } };
    dpt_convex_contact contact = { .size = sizeof contact };
    dpt_compiled file;
    const dpt_mesh *mesh;
    if (dpt_compile_arrays(vertices, 3, corners, 1, NULL, &file, NULL) != DPT_OK ||
        dpt_mesh_open(file.bytes, file.size, &mesh) != DPT_OK ||
        dpt_convex_touch(&tip, &pose, mesh, NULL, &contact) != DPT_OK)
        return 1;
    dpt_compiled_free(&file);
    return contact.depth > 0.99e-4 && contact.depth < 1.01e-4 && contact.direction[2] > 0.999 ? 0 : 1;
}
