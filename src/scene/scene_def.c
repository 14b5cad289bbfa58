/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/scene_def.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "built_with.h"
#include "scene/host_file.h"
#include "scene/setting_words.h"

void scene_def_init(struct scene_def *def, const char *command)
{
    *def = (struct scene_def){ .command = command,
                               .zoom = NAN,
                               .force_scale = NAN,
                               .clutch = -1,
                               .length = NAN,
                               .radius = NAN,
                               .force = { .friction = NAN } };
}

static int is_scene_file_name(const char *path)
{
    return host_file_ends_in(path, ".json");
}

#ifdef DPT_HAS_JANSSON

dpt_result scene_def_read(struct scene_def *def, dpt_host_error *error)
{
    if (def->scene_bytes.bytes || !is_scene_file_name(def->path))
        return DPT_OK;
    def->file = calloc(1, sizeof *def->file);
    if (!def->file)
        return host_refuse(error, DPT_E_MEMORY, "memory ran out");
    return scene_file_load(def->file, def->path, error);
}

void scene_def_free(struct scene_def *def)
{
    if (def->file)
        scene_file_free(def->file);
    free(def->file);
    def->file = NULL;
}

#else

dpt_result scene_def_read(struct scene_def *def, dpt_host_error *error)
{
    if (def->scene_bytes.bytes || !is_scene_file_name(def->path))
        return DPT_OK;
    return host_refuse(error, DPT_E_ABSENT,
                       "%s: this build reads no scene files: install libjansson-dev and pkg-config, and build it again",
                       def->path);
}

void scene_def_free(struct scene_def *def)
{
    def->file = NULL;
}

#endif

static double first_given(double a, double b, double otherwise)
{
    return !isnan(a) ? a : !isnan(b) ? b : otherwise;
}

/* The tool of a file, unless the options name another one. */
static dpt_result complete_tool(struct scene_def *def, dpt_host_error *error)
{
    const struct scene_file *file = def->file;
    const struct listed_scene *listed = scene_listed(def->path);
    const struct setting_names *names = setting_names_for(def->command);
    const int has_own = file && (file->arm || file->segment_count);
    if (has_own && !def->tool && (!isnan(def->length) || !isnan(def->radius)))
        return host_refuse(error, DPT_E_ARGUMENT, "%s: %s and %s are for a stylus; its tool is %s", def->path,
                           names->length, names->radius, file->arm ? "an arm's" : "segments");
    const int takes_file = file && !def->tool && !def->segment_count;
    if (takes_file && !def->tips.count)
        def->tips = file->tips;
    if (takes_file && !def->jaw.is_given)
        def->jaw = file->jaw;
    if (takes_file && file->arm)
        def->tool = file->arm;
    if (takes_file && !def->tips.count)
        def->piercing = file->piercing;
    if (listed && listed->is_needle && !def->tool && !def->segment_count && !def->tips.count)
        def->piercing = DPT_PIERCING_A;
    if (def->piercing && def->force.law != DPT_LAW_PROXY)
        return host_refuse(error, DPT_E_ARGUMENT, "%s: a tool pierces by the law proxy alone (tool.law, %s)", def->path,
                           names->law);
    if (def->force.law != DPT_LAW_PROXY && !tip_shapes_are_curved(&def->tips))
        return host_refuse(error, DPT_E_ARGUMENT,
                           "%s: tips are felt by the law proxy alone (tool.law, %s), but for curved ones", def->path,
                           names->law);
    return DPT_OK;
}

/* Which body moves out of the way of a tool; -1: none. */
static int displacing_body(const struct scene_file *file)
{
    for (uint32_t i = 0; file && i < file->body_count; i++)
        if (file->bodies[i].listed.response == DPT_RESPONSE_DISPLACE)
            return (int)i;
    return -1;
}

/* What moves triangles out of the way of a tool is a law that lets the tool go in. */
static dpt_result check_responses(const struct scene_def *def, dpt_host_error *error)
{
    const int displaced = displacing_body(def->file);
    if (displaced < 0 || def->force.law != DPT_LAW_PROXY)
        return DPT_OK;
    return host_refuse(error, DPT_E_ARGUMENT,
                       "%s: bodies[%d].physics.response: displace is for the laws point and bed (tool.law, %s)",
                       def->path, displaced, setting_names_for(def->command)->law);
}

dpt_result scene_def_complete(struct scene_def *def, const uint32_t *law, dpt_host_error *error)
{
    const struct listed_scene *listed = scene_listed(def->path);
    const struct scene_file *file = def->file;
    def->force.law = law ? *law : file && file->law >= 0 ? (uint32_t)file->law : DPT_LAW_PROXY;
    DPT_TRY(complete_tool(def, error));
    DPT_TRY(check_responses(def, error));
    def->zoom = first_given(def->zoom, file ? file->zoom : NAN, 1.0);
    def->force_scale = first_given(def->force_scale, file ? file->force_scale : NAN, 1.0);
    def->length = first_given(def->length, file ? file->length : NAN, listed ? listed->length : 0.1);
    def->radius = first_given(def->radius, file ? file->radius : NAN, listed ? listed->radius : 0.002);
    if (def->clutch < 0 && file)
        def->clutch = file->clutch;
    if (isnan(def->force.friction) && !file && !listed && !def->body_count)
        def->force.friction = 0.0;
    return DPT_OK;
}

int scene_def_has_file(const struct scene_def *def, const char *path)
{
    int has = host_file_is_same(def->path, path) || host_file_is_same(def->tool, path);
    for (uint32_t i = 0; def->file && i < def->file->body_count; i++)
        has |= host_file_is_same(def->file->bodies[i].mesh, path);
    for (uint32_t i = 0; def->file && i < def->file->dress_count; i++)
        has |= host_file_is_same(def->file->dress[i].mesh, path);
    return has;
}
