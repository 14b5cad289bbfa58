/* SPDX-License-Identifier: BSD-3-Clause */
/* A user of libdynpoint_urdf: compiles the description that is named, and asks where the tool is at rest. */
#include <dynpoint.h>
#include <dynpoint/urdf.h>

int main(int argc, char **argv)
{
    const double rest[DPT_JOINTS_MAX] = { 0.0 };
    dpt_compiled file;
    const dpt_arm *arm;
    dpt_pose tool;
    if (argc != 2 || dpt_urdf_compile_file(argv[1], NULL, &file, NULL) != DPT_OK ||
        dpt_arm_open(file.bytes, file.size, &arm) != DPT_OK || dpt_arm_forward(arm, rest, &tool) != DPT_OK)
        return 1;
    dpt_compiled_free(&file);
    return tool.position[0] > 0.3 - 1e-12 && tool.position[0] < 0.3 + 1e-12 ? 0 : 1;
}
