/* SPDX-License-Identifier: BSD-3-Clause */
/* Prints an arm of three joints, as desktop devices have, as an array in C for measure.c. */
#include <stdio.h>

#include "dynpoint/compile.h"

int main(void)
{
    const dpt_arm_joint joint = { .size = sizeof joint, .kind = DPT_JOINT_CONTINUOUS };
    const dpt_arm_joint joints[3] = { joint, joint, joint };
    dpt_arm_link links[3];
    for (uint32_t i = 0; i < 3; i++)
        links[i] = (dpt_arm_link){ .size = sizeof *links,
                                   .parent = i - 1,
                                   .joint = i,
                                   .pose = { { 0.0, i == 2 ? 0.135 : 0.0, 0.0 }, { 1.0 } },
                                   .axis = { i != 0, 0.0, i == 0 },
                                   .factor = 1.0,
                                   .mass = 0.1,
                                   .centre = { 0.0, 0.07, 0.0 } };
    const dpt_arm_def def = { .size = sizeof def,
                              .joint_count = 3,
                              .link_count = 3,
                              .tool_link = 2,
                              .tool = { { 0.0, 0.135, 0.0 }, { 1.0 } },
                              .joints = joints,
                              .links = links };
    dpt_compiled file;
    if (dpt_compile_arm(&def, &file, NULL) != DPT_OK)
        return 1;
    printf("#include <stddef.h>\nextern const unsigned char flash_arm[];\n"
           "extern const size_t flash_arm_size;\nconst size_t flash_arm_size = %zu;\n"
           "__attribute__((aligned(64))) const unsigned char flash_arm[] = {",
           file.size);
    for (size_t i = 0; i < file.size; i++)
        printf("%s%u,", i % 16 ? "" : "\n", ((const unsigned char *)file.bytes)[i]);
    puts("\n};");
    dpt_compiled_free(&file);
    return 0;
}
