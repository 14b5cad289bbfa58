/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/scene_dress.h"

dpt_result scene_dress_open(struct scene_dress *dress, const char *path, const struct dress_part *parts, uint32_t count,
                            dpt_host_error *error)
{
    for (uint32_t i = 0; i < count; i++) {
        dpt_compile_def def;
        dpt_diag diag = { .size = sizeof diag };
        dpt_compile_def_init(&def);
        def.scale = parts[i].scale;
        dpt_result result = dpt_compile_file(parts[i].mesh, &def, &dress->compiled[i], &diag);
        if (result == DPT_OK)
            result = dpt_mesh_open(dress->compiled[i].bytes, dress->compiled[i].size, &dress->mesh[i]);
        if (result != DPT_OK)
            return host_refuse(error, result, "%s: tool.dress[%u]: %s: %s", path, (unsigned)i, parts[i].mesh,
                               diag.code ? diag.text : dpt_result_text(result));
        dress->part[i] = parts[i];
        dress->part[i].mesh = NULL;
        dress->count = i + 1;
    }
    return DPT_OK;
}

void scene_dress_close(struct scene_dress *dress)
{
    for (uint32_t i = 0; i < DRESS_PARTS_MAX; i++)
        dpt_compiled_free(&dress->compiled[i]);
}

int scene_dress_has_jaws(const struct scene_dress *dress)
{
    for (uint32_t i = 0; i < dress->count; i++)
        if (dress->part[i].has_hinge)
            return 1;
    return 0;
}
