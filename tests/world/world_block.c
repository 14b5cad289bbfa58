/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/world_block.h"

void world_block_open(struct world_block *made, const dpt_world_def *def)
{
    made->bytes = dpt_world_bytes(def);
    made->block = malloc(made->bytes);
    made->world = NULL;
    dpt_result result = dpt_world_create(made->block, made->bytes, def, &made->world);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
}

dpt_world_def small_def(void)
{
    dpt_world_def def;
    dpt_world_def_init(&def);
    def.max_contacts = 32;
    def.law = DPT_LAW_POINT;
    def.max_bodies = 4;
    def.max_tools = 3;
    def.max_segments = 6;
    return def;
}

dpt_segment capsule(double ax, double ay, double az, double bx, double by, double bz, double radius)
{
    return (dpt_segment){ { ax, ay, az }, { bx, by, bz }, radius };
}
