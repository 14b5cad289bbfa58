/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/scene_command.h"

#include <math.h>
#include <stdlib.h>

#include "cli/law_name.h"

int read_scene_def(struct scene_def *def)
{
    dpt_host_error error = { .size = sizeof error };
    return complain_of(def->command, scene_def_read(def, &error), &error);
}

int complete_scene_def(struct scene_def *def, const char *word)
{
    dpt_host_error error = { .size = sizeof error };
    uint32_t law = DPT_LAW_PROXY;
    if (word && law_by_name(def->command, word, &law))
        return 2;
    return complain_of(def->command, scene_def_complete(def, word ? &law : NULL, &error), &error);
}

int read_origin(struct scene_def *def, const char *text)
{
    char *end;
    for (int k = 0; k < 3; k++) {
        def->origin[k] = strtod(text, &end);
        if (end == text || (k < 2 ? *end != ',' : *end != '\0') || !(fabs(def->origin[k]) <= DPT_COORDINATE_MAX))
            return complain(def->command, "--at takes three numbers, X,Y,Z");
        text = end + 1;
    }
    def->has_origin = 1;
    return 0;
}

/* As many as one option has. */
typedef char tip_options_fit[(int)OPTION_TEXTS_MAX <= (int)TIP_SHAPES_MAX ? 1 : -1];

int read_tip_shapes(struct tip_shapes *tips, const char *command, const struct option_texts *texts)
{
    dpt_host_error error = { .size = sizeof error };
    for (size_t i = 0; i < texts->count; i++)
        if (complain_of(command, tip_shape_parse(&tips->shape[i], "--tip", texts->text[i], &error), &error))
            return 2;
    tips->count = (uint32_t)texts->count;
    return 0;
}

int check_scene_output(const struct scene_def *def, const char *path)
{
    const struct scene_file *file = def->file;
    int status = output_check(def->command, path, (const char *const[]){ def->path, def->tool, NULL });
    for (uint32_t i = 0; status == 0 && file && i < file->body_count; i++)
        status = output_check(def->command, path, (const char *const[]){ file->bodies[i].mesh, NULL });
    for (uint32_t i = 0; status == 0 && file && i < file->dress_count; i++)
        status = output_check(def->command, path, (const char *const[]){ file->dress[i].mesh, NULL });
    return status;
}

int open_scene(struct scene *scene, const struct scene_def *def)
{
    dpt_host_error error = { .size = sizeof error };
    return complain_of(def->command, scene_open(scene, def, &error), &error);
}
