/* SPDX-License-Identifier: BSD-3-Clause */
#include "lib/arm_bytes.h"

void arm_file(char path[64], const struct chain_joint *chain, uint32_t count, const double tool[3])
{
    dpt_arm_joint joints[DPT_JOINTS_MAX];
    dpt_arm_link links[DPT_JOINTS_MAX];
    dpt_diag diag = { .size = sizeof diag };
    dpt_compiled compiled = { NULL, 0 };
    dpt_arm_def def = { .size = sizeof def,
                        .joint_count = count,
                        .link_count = count,
                        .tool_link = count - 1,
                        .tool = DPT_POSE_IDENTITY,
                        .joints = joints,
                        .links = links,
                        .name = "test" };
    for (uint32_t i = 0; i < count; i++) {
        const struct chain_joint *from = &chain[i];
        joints[i] = (dpt_arm_joint){ .size = sizeof joints[i],
                                     .kind = from->kind,
                                     .lower = from->lower,
                                     .upper = from->upper,
                                     .effort = from->effort };
        snprintf(joints[i].name, sizeof joints[i].name, "joint_%u", i);
        links[i] = (dpt_arm_link){ .size = sizeof links[i],
                                   .parent = i ? i - 1 : DPT_NONE,
                                   .joint = i,
                                   .slides = from->kind == DPT_JOINT_PRISMATIC,
                                   .pose = DPT_POSE_IDENTITY,
                                   .factor = 1.0,
                                   .mass = from->mass,
                                   .centre = { 0.1, 0.0, 0.0 } };
        memcpy(links[i].pose.position, from->at, sizeof from->at);
        memcpy(links[i].axis, from->axis, sizeof from->axis);
    }
    memcpy(def.tool.position, tool, sizeof def.tool.position);
    const dpt_result result = dpt_compile_arm(&def, &compiled, &diag);
    strcpy(path, "/tmp/dynpoint-arm-XXXXXX");
    const int file = mkstemp(path);
    if (result != DPT_OK || file < 0 || write(file, compiled.bytes, compiled.size) != (ssize_t)compiled.size) {
        printf("no arm at %s: %s\n", path, diag.text);
        exit(1);
    }
    close(file);
    dpt_compiled_free(&compiled);
}
