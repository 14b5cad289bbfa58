/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A snapshot's bytes. Refused with a code, and then each reader refuses them or finds an item within them; or accepted,
 * and then each item is there, and what they say of each other is so.
 */
#include "fuzz/target.h"

static int is_a_code(dpt_result result)
{
    return result == DPT_E_MAGIC || result == DPT_E_VERSION || result == DPT_E_TRUNCATED || result == DPT_E_LAYOUT ||
           result == DPT_E_ARGUMENT;
}

static void read_vertices(const uint8_t *bytes, size_t size, const dpt_snapshot_body *body)
{
    float *xyz = malloc(12 * (size_t)body->vertices + 1);
    MUST(xyz);
    MUST(dpt_snapshot_get_vertices(bytes, size, body->first_vertex, body->vertices, xyz) == DPT_OK);
    free(xyz);
}

static void use(const uint8_t *bytes, size_t size, const dpt_snapshot_info *info)
{
    for (uint32_t i = 0; i < info->bodies; i++) {
        dpt_snapshot_body body = { .size = sizeof body };
        MUST(dpt_snapshot_get_body(bytes, size, i, &body) == DPT_OK);
        if (body.first_vertex != DPT_NONE)
            read_vertices(bytes, size, &body);
    }
    for (uint32_t i = 0; i < info->tools; i++) {
        dpt_snapshot_tool tool = { .size = sizeof tool };
        MUST(dpt_snapshot_get_tool(bytes, size, i, &tool) == DPT_OK);
        MUST((uint64_t)tool.first_segment + tool.segments <= info->segments);
        MUST((uint64_t)tool.first_contact + tool.contacts <= info->contacts);
        MUST((uint64_t)tool.first_strip + tool.strip <= info->strip);
        MUST(tool.nearest_segment < tool.segments);
    }
    for (uint32_t i = 0; i < info->segments; i++) {
        dpt_snapshot_segment segment = { .size = sizeof segment };
        MUST(dpt_snapshot_get_segment(bytes, size, i, &segment) == DPT_OK);
        MUST(segment.tool < info->tools);
    }
    for (uint32_t i = 0; i < info->contacts; i++) {
        dpt_snapshot_contact contact = { .size = sizeof contact };
        MUST(dpt_snapshot_get_contact(bytes, size, i, &contact) == DPT_OK);
        MUST(contact.tool < info->tools);
    }
    for (uint32_t i = 0; i < info->strip; i++) {
        dpt_snapshot_strip strip = { .size = sizeof strip };
        MUST(dpt_snapshot_get_strip(bytes, size, i, &strip) == DPT_OK);
    }
}

FUZZ_TARGET(snapshot)
{
    dpt_snapshot_info info = { .size = sizeof info };
    dpt_snapshot_tool tool = { .size = sizeof tool };
    const dpt_result result = dpt_snapshot_get_info(bytes, size, &info);
    MUST(result == DPT_OK || (is_a_code(result) && !info.bodies && !info.tools && !info.vertices));
    if (result == DPT_OK) {
        fuzz_accepted++;
        use(bytes, size, &info);
    } else {
        MUST(is_a_code(dpt_snapshot_get_tool(bytes, size, 0, &tool)) || tool.size == sizeof tool);
    }
    return 0;
}
