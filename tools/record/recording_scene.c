/* SPDX-License-Identifier: BSD-3-Clause */
#include "record/recording_scene.h"

#include <inttypes.h>
#include <math.h>

#include "cli/command_options.h"
#include "measure/measure_setting.h"
#include "scene/scene_list.h"

static int check_identity(const char *command, const char *path, const char *what, const struct file_identity *file,
                          uint64_t bytes, uint64_t crc32)
{
    if (file->bytes == bytes && file->crc32 == crc32)
        return 0;
    return complain(
        command, "%s: this is another %s than the recording's, which has %" PRIu64 " bytes and the CRC-32 %08" PRIx64,
        path, what, bytes, crc32);
}

static void observe(struct scene *scene, const struct scene_text *text)
{
    dpt_passivity_def def;
    dpt_passivity_def_init(&def);
    def.damping = text->passive_damping;
    def.spin_damping = text->passive_spin_damping;
    def.force_max = text->passive_force_max;
    def.torque_max = text->passive_torque_max;
    def.force_slew = text->passive_force_slew;
    def.torque_slew = text->passive_torque_slew;
    def.delay = text->passive_delay;
    scene_passivity_begin(&scene->passivity, &def);
}

void recording_scene_embedded(const struct scene_text *text, const char *scene_path, const char *tool_path,
                              int embedded[EMBED_FILES])
{
    embedded[EMBED_SCENE] = text->embedded && !scene_path && !scene_listed(text->scene);
    embedded[EMBED_TOOL] = text->embedded && !tool_path && text->tool[0];
}

/* Let what comes from the recording be the scene's. Returns 0, or 2 after a message. */
static int read_embedded(struct scene_def *def, struct recording_embed *embed, const char *path,
                         const struct scene_text *text, const int embedded[EMBED_FILES])
{
    if (!embedded[EMBED_SCENE] && !embedded[EMBED_TOOL])
        return 0;
    const int status = recording_embed_read(embed, def->command, path, text, embedded);
    const struct embedded_file *scene = &embed->file[EMBED_SCENE], *tool = &embed->file[EMBED_TOOL];
    if (status == 0 && embedded[EMBED_SCENE]) {
        def->path = path;
        def->scene_bytes = (struct scene_bytes){ scene->bytes, (size_t)scene->total };
    }
    if (status == 0 && embedded[EMBED_TOOL]) {
        def->tool = path;
        def->tool_bytes = (struct scene_bytes){ tool->bytes, (size_t)tool->total };
    }
    return status;
}

/* What a plan left, before the world is made of it. Returns 0, or 2 after a message. */
static int take_plan(struct scene *scene, const struct scene_text *text, const char *path,
                     struct measure_setting *setting)
{
    const uint64_t most = UINT32_MAX;
    if (text->sweep_budget > most)
        return complain(scene->command, "%s: its header has a sweep_budget that is none", path);
    if (!text->planned)
        return 0;
    if (text->plan_until > DPT_UNTIL_CONTACT || text->plan_integrator > 1 + DPT_INTEGRATOR_IMPLICIT ||
        text->plan_iterations > most || text->plan_max_contacts > most || text->plan_smooth_normals > 1 ||
        text->plan_sweep_budget > most || text->plan_strip_capacity > most || text->plan_rigid_low > most ||
        text->plan_rigid_high > most)
        return complain(scene->command, "%s: its header has a plan's setting that is none", path);
    *setting = scene_text_setting(text);
    measure_setting_change(setting, &scene->bodies);
    scene->planned = setting;
    return 0;
}

int recording_scene_open(struct scene *scene, const char *command, const char *path, const struct scene_text *text,
                         const char *scene_path, const char *tool_path)
{
    struct recording_embed embed = { .room = 0 };
    int embedded[EMBED_FILES];
    struct measure_setting setting;
    char origin[96];
    const int has_own_friction = text->friction == SCENE_TEXT_OWN_FRICTION;
    struct scene_def def = { .command = command,
                             .path = scene_path ? scene_path : text->scene,
                             .tool = tool_path       ? tool_path
                                     : text->tool[0] ? text->tool
                                                     : NULL,
                             .origin = origin,
                             .zoom = text->zoom,
                             .force_scale = text->force_scale,
                             .clutch = text->clutch < SCENE_TEXT_NO_CLUTCH ? (int)text->clutch : -1,
                             .length = text->length,
                             .radius = text->radius,
                             .tips = text->tips,
                             .jaw = text->jaw,
                             .physics = text->physics,
                             .force = { .stiffness = text->stiffness,
                                        .friction = has_own_friction ? NAN : text->friction,
                                        .damping = text->damping } };
    const dpt_device_info info = { .size = sizeof info,
                                   .flags = (uint32_t)text->device_flags,
                                   .pose_dofs = (uint32_t)text->pose_dofs,
                                   .wrench_dofs = (uint32_t)text->wrench_dofs,
                                   .joints = (uint32_t)text->joints };
    snprintf(origin, sizeof origin, "%.17g,%.17g,%.17g", text->origin_x, text->origin_y, text->origin_z);
    recording_scene_embedded(text, scene_path, tool_path, embedded);
    int status = read_embedded(&def, &embed, path, text, embedded);
    if (status == 0)
        status = law_by_name(command, text->law, &def.force.law);
    if (status == 0)
        status = force_options_check(command, &def.force);
    if (status == 0 && def.tips.count && def.force.law != DPT_LAW_PROXY)
        status = complain(command, "%s: its header has tips, and another law than proxy", path);
    if (status == 0)
        status = scene_def_read(&def);
    if (status == 0)
        status = scene_open(scene, &def);
    recording_embed_free(&embed);
    if (status == 0)
        status = check_identity(command, def.path, "scene", &scene->file, text->scene_bytes, text->scene_crc32);
    if (status == 0)
        status = check_identity(command, def.tool ? def.tool : "", "tool", &scene->tool_file, text->tool_bytes,
                                text->tool_crc32);
    scene->sweep_budget = (uint32_t)text->sweep_budget;
    if (status == 0)
        status = take_plan(scene, text, path, &setting);
    if (status == 0)
        status = scene_make_world(scene, &info, (uint32_t)text->budget);
    scene->planned = NULL;
    if (status == 0 && text->passivity)
        observe(scene, text);
    scene_def_free(&def);
    return status;
}
