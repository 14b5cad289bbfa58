/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * An arm's bytes as they are; then with length and checksum made good, so that nonsense gets past them. Refused with
 * code, section and byte; or used: its answers are finite, and what it tells of itself compiles to such an arm again.
 */
#include <math.h>
#include <string.h>

#include "arm/arm_format.h"
#include "dynpoint/compile.h"
#include "fuzz/target.h"

static dpt_mesh_fault verify(const void *bytes, size_t size)
{
    dpt_mesh_fault fault = { .size = sizeof fault };
    dpt_result result = dpt_arm_verify(bytes, size, &fault);
    MUST(fault.code == result);
    MUST(memchr(fault.section, 0, sizeof fault.section) && fault.byte <= size);
    MUST((result == DPT_OK) == !fault.section[0]);
    return fault;
}

static void expect_finite(const double *numbers, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        MUST(isfinite(numbers[i]));
}

static void use_motion(const dpt_arm *arm, uint32_t joints)
{
    double at[DPT_JOINTS_MAX], rates[DPT_JOINTS_MAX], out[6 * DPT_JOINTS_MAX];
    const double gravity[3] = { 1.0, -2.0, -9.81 };
    const dpt_wrench wrench = { { 1.0, 2.0, 3.0 }, { 4.0, 5.0, 6.0 } };
    dpt_pose tool;
    for (uint32_t i = 0; i < joints; i++) {
        at[i] = 0.3 * i - 1.0;
        rates[i] = 0.5 - 0.2 * i;
    }
    MUST(dpt_arm_forward(arm, at, &tool) == DPT_OK);
    expect_finite(tool.position, 3);
    double square = 0.0;
    for (int i = 0; i < 4; i++)
        square += tool.orientation[i] * tool.orientation[i];
    MUST(fabs(square - 1.0) < 1e-9);
    MUST(dpt_arm_velocity(arm, at, rates, out, out + 3) == DPT_OK);
    expect_finite(out, 6);
    MUST(dpt_arm_jacobian(arm, at, out) == DPT_OK);
    expect_finite(out, 6 * joints);
    MUST(dpt_arm_efforts(arm, at, &wrench, out) == DPT_OK);
    expect_finite(out, joints);
    MUST(dpt_arm_weight(arm, at, gravity, out) == DPT_OK);
    expect_finite(out, joints);
}

static void use(const dpt_arm *arm)
{
    dpt_arm_info info = { .size = sizeof info };
    dpt_arm_joint joints[DPT_JOINTS_MAX];
    dpt_arm_link links[DPT_ARM_LINKS_MAX];
    dpt_segment segments[DPT_ARM_SEGMENTS_MAX];
    dpt_arm_body bodies[DPT_ARM_BODIES_MAX];
    dpt_compiled again;
    MUST(dpt_arm_get_info(arm, &info) == DPT_OK);
    use_motion(arm, info.joints);
    for (uint32_t i = 0; i < info.joints; i++) {
        joints[i].size = sizeof *joints;
        MUST(dpt_arm_get_joint(arm, i, &joints[i]) == DPT_OK);
    }
    for (uint32_t i = 0; i < info.links; i++) {
        links[i].size = sizeof *links;
        MUST(dpt_arm_get_link(arm, i, &links[i]) == DPT_OK);
    }
    for (uint32_t i = 0; i < info.segments; i++)
        MUST(dpt_arm_get_segment(arm, i, &segments[i]) == DPT_OK);
    for (uint32_t i = 0; i < info.bodies; i++) {
        bodies[i].size = sizeof *bodies;
        MUST(dpt_arm_get_body(arm, i, &bodies[i]) == DPT_OK);
        fuzz_use_mesh(bodies[i].mesh, FUZZ_FORGED, FUZZ_QUERY);
    }
    const dpt_arm_def def = { .size = sizeof def,
                              .joint_count = info.joints,
                              .link_count = info.links,
                              .segment_count = info.segments,
                              .body_count = info.bodies,
                              .tool_link = info.tool_link,
                              .tool = info.tool,
                              .joints = joints,
                              .links = links,
                              .segments = segments,
                              .bodies = bodies,
                              .name = info.name,
                              .root_name = info.root_name,
                              .tool_name = info.tool_name,
                              .source_bytes = info.source_bytes,
                              .source_hash = info.source_hash };
    MUST(dpt_compile_arm(&def, &again, NULL) == DPT_OK && again.size == info.bytes);
    dpt_compiled_free(&again);
}

/* As they came; and a copy in the host's byte order, if it can be had. */
static void try(const void *bytes, size_t size)
{
    const dpt_arm *arm = NULL;
    dpt_mesh_fault fault = verify(bytes, size);
    void *copy = malloc(size);
    MUST(copy);
    memcpy(copy, bytes, size);
    MUST(dpt_arm_open(bytes, size, &arm) == fault.code && (fault.code == DPT_OK) == (arm != NULL));
    fault = (dpt_mesh_fault){ .size = sizeof fault };
    if (dpt_arm_convert(copy, size, &fault) == DPT_OK) {
        MUST(dpt_arm_open(copy, size, &arm) == DPT_OK);
        use(arm);
        fuzz_accepted++;
    } else {
        MUST(fault.section[0] && fault.byte <= size);
    }
    free(copy);
}

FUZZ_TARGET(arm)
{
    if (size == 0)
        return 0;
    const uint64_t accepted = fuzz_accepted;
    try(bytes, size);
    struct dpt_arm *sealed = malloc(size);
    MUST(sealed);
    memcpy(sealed, bytes, size);
    if (fuzz_accepted == accepted && size >= sizeof *sealed) {
        const int swapped = sealed->byte_order == MESH_BYTE_ORDER_SWAPPED;
        sealed->bytes = size;
        if (swapped)
            mesh_swap8(&sealed->bytes, 1);
        sealed->crc32 = arm_crc(sealed, size);
        if (swapped)
            mesh_swap4(&sealed->crc32, 1);
        try(sealed, size);
    }
    free(sealed);
    return 0;
}
