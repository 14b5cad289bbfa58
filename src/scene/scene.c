/* SPDX-License-Identifier: BSD-3-Clause */
#define _POSIX_C_SOURCE 200809L
#include "scene/scene.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/quaternion.h"
#include "base/return_if_error.h"
#include "scene/host_file.h"
#include "scene/setting_words.h"

/* Device to root: a URDF's z is up and its x ahead; a device's y is up and its z towards the user. */
static const double device_to_root[4] = { 0.5, 0.5, -0.5, -0.5 };

/* The tool's position, in the root's frame, with every joint in the middle of its limits. */
static dpt_result middle_position(const dpt_arm *arm, double position[3])
{
    double joints[DPT_JOINTS_MAX] = { 0.0 };
    dpt_pose tool;
    dpt_arm_joint joint = { .size = sizeof joint };
    for (uint32_t i = 0; dpt_arm_get_joint(arm, i, &joint) == DPT_OK; i++)
        joints[i] = 0.5 * (joint.lower + joint.upper);
    DPT_TRY(dpt_arm_forward(arm, joints, &tool));
    memcpy(position, tool.position, sizeof tool.position);
    return DPT_OK;
}

static uint32_t copy_tool_segments(const dpt_arm *arm, dpt_segment *segments)
{
    uint32_t count = 0;
    while (count < DPT_ARM_SEGMENTS_MAX && dpt_arm_get_segment(arm, count, &segments[count]) == DPT_OK)
        count++;
    return count;
}

/* To the tool: those that a proxy feels, or those that are felt without one. */
static dpt_result add_tips(struct scene *scene)
{
    struct curved_tips *curved = &scene->curved;
    if (scene->force.law == DPT_LAW_PROXY)
        return scene_tips_add(&scene->tips, scene->stage.world, scene->stage.tool);
    for (curved->body_count = 0; curved->body_count < scene->bodies.count; curved->body_count++) {
        const struct scene_body *body = &scene->bodies.body[curved->body_count];
        curved->bodies[curved->body_count] = (dpt_convex_body){ .mesh = body->mesh, .pose = &body->pose };
        curved->body_ids[curved->body_count] = body->id;
    }
    return curved_tips_attach(curved, &scene->tips.shapes, scene->stage.world, scene->stage.tool, &scene->force);
}

static dpt_result sharpen(const struct scene *scene)
{
    dpt_tool_settings settings = { .size = sizeof settings };
    if (!scene->piercing)
        return DPT_OK;
    DPT_TRY(dpt_tool_get_settings(scene->stage.world, scene->stage.tool, &settings));
    settings.piercing = scene->piercing;
    return dpt_tool_set_settings(scene->stage.world, scene->stage.tool, &settings);
}

/* Create the world, with its bodies and its tool. */
static dpt_result fill_world(struct scene *scene, const dpt_world_def *def)
{
    struct scene_stage *stage = &scene->stage;
    DPT_TRY(scene_stage_open(stage, def));
    DPT_TRY(scene_stage_add_bodies(stage, &scene->bodies, &scene->force, scene->physics_rate));
    DPT_TRY(scene_stage_add_tool(stage, scene->segments, scene->segment_count, &scene->force,
                                 scene->device.wrench_dofs < 6));
    DPT_TRY(sharpen(scene));
    return add_tips(scene);
}

dpt_result scene_make_world(struct scene *scene, const dpt_device_info *device, uint32_t budget, dpt_host_error *error)
{
    dpt_world_def world;
    scene->device = *device;
    dpt_world_def_init(&world);
    world.sweep_budget = scene->sweep_budget;
    world.max_contacts = scene->shows_contacts ? SCENE_CONTACTS : 0;
    if (scene->planned)
        world = *scene->planned;
    world.max_bodies = scene->bodies.count;
    world.max_tools = 1;
    world.max_segments = scene->segment_count;
    world.max_tips = scene->force.law == DPT_LAW_PROXY ? scene->tips.count : 0;
    world.max_channels = scene->piercing ? SCENE_CHANNELS : scene_bodies_channels(&scene->bodies);
    world.budget = budget;
    if (scene_bodies_displace(&scene->bodies))
        world.strip = DPT_STRIP_KIND_SHADOW;
    const dpt_result result = fill_world(scene, &world);
    if (result == DPT_E_MEMORY)
        return host_refuse(error, result, "memory ran out");
    return result == DPT_OK ? DPT_OK : host_refuse(error, result, "%s", dpt_result_text(result));
}

/* Those that are given, or those of the file. The caller frees them; NULL after filling the error. */
static void *load_bytes(const char *path, const struct scene_bytes *given, size_t *size, dpt_host_error *error)
{
    if (!given->bytes)
        return host_file_load(path, size, error);
    *size = given->size;
    return host_file_copy(given->bytes, given->size, error);
}

/* Open the arm whose tool is used, if there is one. */
static dpt_result load_tool_arm(struct scene *scene, const struct scene_def *def, dpt_host_error *error)
{
    size_t size = 0;
    scene->tool_arm = def->segment_count ? NULL : scene->arm;
    if (!def->tool)
        return DPT_OK;
    scene->tool_bytes = load_bytes(def->tool, &def->tool_bytes, &size, error);
    if (!scene->tool_bytes)
        return error->code;
    file_identity_add(&scene->tool_file, scene->tool_bytes, size);
    scene->tool_arm = host_file_open_arm(def->tool, scene->tool_bytes, size, error);
    return scene->tool_arm ? DPT_OK : error->code;
}

/* The tips, the arm's only where they are felt. */
static dpt_result make_tips(struct scene *scene, const struct scene_def *def, dpt_host_error *error)
{
    const char *path = def->tool ? def->tool : def->path;
    const dpt_arm *arm = def->force.law == DPT_LAW_PROXY ? scene->tool_arm : NULL;
    dpt_arm_info info = { .size = sizeof info };
    if (scene->tool_arm && !arm && dpt_arm_get_info(scene->tool_arm, &info) == DPT_OK && info.tips && info.segments)
        host_note(error, "%s: note: its tool's tips are felt by the law proxy alone: left out", path);
    return scene_tips_make(&scene->tips, path, setting_names_for(def->command)->jaw, &def->tips, arm, &def->jaw, error);
}

/* What the law cannot feel: bodies of the caller's that move out of a proxy's way, and curved tips at what gives way. */
static dpt_result check_law(const struct scene *scene, const struct scene_def *def, dpt_host_error *error)
{
    if (def->body_count && def->force.law == DPT_LAW_PROXY && scene_bodies_displace(&scene->bodies))
        return host_refuse(error, DPT_E_ARGUMENT, "%s: bodies: displace is for the laws point and bed (%s)", def->path,
                           setting_names_for(def->command)->law);
    for (uint32_t i = 0; i < scene->bodies.count && def->tips.count && def->force.law != DPT_LAW_PROXY; i++)
        if (scene_body_is_soft(&scene->bodies.body[i]))
            return host_refuse(error, DPT_E_UNSUPPORTED,
                               "%s: bodies[%u] gives way: by the laws point and bed curved tips feel rigid bodies "
                               "alone (tool.law, %s)",
                               def->path, (unsigned)i, setting_names_for(def->command)->law);
    return DPT_OK;
}

/* Needles are thick, and go through bodies that are pushed by loads. */
static dpt_result check_needle(const struct scene *scene, const struct scene_def *def, dpt_host_error *error)
{
    for (uint32_t i = 0; i < scene->bodies.count && scene_bodies_channels(&scene->bodies); i++)
        if (scene_body_is_soft(&scene->bodies.body[i]) && scene->bodies.body[i].response == DPT_RESPONSE_DISPLACE)
            return host_refuse(error, DPT_E_UNSUPPORTED,
                               "%s: bodies[%u] is displaced: needles pierce bodies that are pushed by loads", def->path,
                               (unsigned)i);
    if (def->piercing && !(def->radius > 0.0 && def->length > 0.0) && !(def->file && def->file->segment_count))
        return host_refuse(error, DPT_E_ARGUMENT, "%s: a needle has a length and a radius above 0", def->path);
    return DPT_OK;
}

/* The tool's segments, in its own frame. Returns their number, or 0 after filling the error. */
static uint32_t load_segments(struct scene *scene, const struct scene_def *def, dpt_segment *segments,
                              dpt_host_error *error)
{
    uint32_t count = scene->tool_arm ? copy_tool_segments(scene->tool_arm, segments) : 0;
    if (def->segment_count) {
        count = def->segment_count;
        memcpy(segments, def->segments, count * sizeof *segments);
    } else if (!scene->tool_arm && def->file) {
        count = def->file->segment_count;
        memcpy(segments, def->file->segments, count * sizeof *segments);
    }
    if (count > 0)
        return count;
    if (scene->tips.arm) {
        segments[0] = (dpt_segment){ .radius = 0.0 }; /* the point that a tool has at least */
        return 1;
    }
    if (def->tool) {
        host_refuse(error, DPT_E_EMPTY, "%s: its tool has no capsule, and no tip that is felt", def->tool);
        return 0;
    }
    scene->stylus.radius = def->radius;
    segments[0] = scene->stylus;
    scene->has_stylus = def->tips.count == 0 && !def->piercing;
    /* The hand of a listed needle stands upright, as nothing turns it. */
    if (!scene->has_stylus)
        segments[0].b[scene_listed(def->path) && def->piercing ? 1 : 2] = def->length;
    return 1;
}

/* What the user asks for; else the listed scene's, and a stylus for what is one. */
static enum tool_look look_of(const struct scene *scene, const struct scene_def *def)
{
    const struct listed_scene *listed = def->scene_bytes.bytes || def->body_count ? NULL : scene_listed(def->path);
    if (def->file && def->file->look >= 0)
        return (enum tool_look)def->file->look;
    if (scene->tool_arm || def->segment_count || (def->file && def->file->segment_count))
        return TOOL_LOOK_NONE;
    return listed && listed->look ? listed->look : TOOL_LOOK_STYLUS;
}

/* Read the meshes. The error names the part. */
static dpt_result open_dress(struct scene_dress *dress, const char *path, const struct dress_part *parts,
                             uint32_t count, dpt_host_error *error)
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

static void close_dress(struct scene_dress *dress)
{
    for (uint32_t i = 0; i < DRESS_PARTS_MAX; i++)
        dpt_compiled_free(&dress->compiled[i]);
}

static int has_dress_jaws(const struct scene_dress *dress)
{
    for (uint32_t i = 0; i < dress->count; i++)
        if (dress->part[i].has_hinge)
            return 1;
    return 0;
}

static dpt_result put_look(struct scene *scene, const struct scene_def *def, dpt_host_error *error)
{
    const struct scene_file *file = def->file;
    scene->look = look_of(scene, def);
    if (file && file->dress_count) {
        scene->look = TOOL_LOOK_NONE;
        DPT_TRY(open_dress(&scene->dress, def->path, file->dress, file->dress_count, error));
    }
    scene->tips.has_seen_jaws = scene->look == TOOL_LOOK_FORCEPS || has_dress_jaws(&scene->dress);
    return DPT_OK;
}

/* A listed scene's meshes do not tell its port. In nm, as no locale changes how whole numbers are written. */
static void add_port(struct file_identity *identity, const double port[3])
{
    char text[96];
    const int size = snprintf(text, sizeof text, "port %lld %lld %lld", llround(1e9 * port[0]), llround(1e9 * port[1]),
                              llround(1e9 * port[2]));
    file_identity_add(identity, text, (size_t)size);
}

/* The bodies, of a name or of a file. */
static dpt_result open_bodies(struct scene *scene, const struct scene_def *def, dpt_host_error *error)
{
    const char *path = def->path;
    const struct listed_scene *listed = scene_listed(path);
    size_t size = 0;
    if (def->body_count) {
        DPT_TRY(scene_bodies_of_caller(&scene->bodies, path, def->bodies, def->body_count, error));
        scene->bodies.gravity = def->gravity;
        return DPT_OK;
    }
    if (listed && !def->scene_bytes.bytes) {
        scene->camera = listed->camera;
        scene->inset = listed->inset;
        DPT_TRY(scene_bodies_of_list(&scene->bodies, listed, &scene->file, error));
        if (listed->has_port)
            add_port(&scene->file, listed->port);
        return DPT_OK;
    }
    if (def->file) {
        scene->file = def->file->identity;
        scene->camera = def->file->camera;
        scene->inset = def->file->inset;
        return scene_bodies_of_file(&scene->bodies, path, def->file, &scene->file, error);
    }
    scene->bytes = load_bytes(path, &def->scene_bytes, &size, error);
    if (!scene->bytes) {
        char told[256];
        if (error->code != DPT_E_OPEN || errno != ENOENT || !scene_listed_is_meant(path))
            return error->code;
        scene_listed_tell(path, told, sizeof told);
        return host_refuse(error, DPT_E_OPEN, "%s: there is no scene of this name, and no such file: %s", path, told);
    }
    file_identity_add(&scene->file, scene->bytes, size);
    if (host_file_is_arm(scene->bytes, size)) {
        scene->arm = host_file_open_arm(path, scene->bytes, size, error);
        if (scene->arm)
            scene_bodies_of_arm(&scene->bodies, scene->arm);
        return scene->arm ? DPT_OK : error->code;
    }
    const dpt_mesh *mesh = host_file_open_mesh(path, scene->bytes, size, error);
    if (mesh)
        scene_bodies_of_mesh(&scene->bodies, mesh);
    return mesh ? DPT_OK : error->code;
}

/* Where the device's origin is: above the bodies, or where an arm's tool is in the middle of its limits. */
static dpt_result place_device(struct scene *scene, const struct scene_def *def, dpt_host_error *error)
{
    const struct listed_scene *listed = scene_listed(def->path);
    const struct scene_file *file = def->file;
    if (def->has_origin) {
        memcpy(scene->origin, def->origin, sizeof scene->origin);
    } else if (file && file->has_origin) {
        memcpy(scene->origin, file->origin, sizeof scene->origin);
    } else if (listed && listed->has_origin) {
        memcpy(scene->origin, listed->origin, sizeof scene->origin);
    } else if (!scene->arm) {
        scene_bodies_top(&scene->bodies, scene->origin);
        scene->origin[1] += scene_tips_drop(&scene->tips, def->radius) + 0.005;
    } else if (middle_position(scene->arm, scene->origin) != DPT_OK) {
        return host_refuse(error, DPT_E_ARGUMENT, "%s: the arm's joints have no middle", def->path);
    }
    return DPT_OK;
}

/* Where the tool enters, if the scene has a port and the tool is its own stylus. */
static dpt_result place_port(struct scene *scene, const struct scene_def *def, dpt_host_error *error)
{
    const struct listed_scene *listed = def->scene_bytes.bytes || def->body_count ? NULL : scene_listed(def->path);
    const double *port = def->file && def->file->has_port ? def->file->port
                         : listed && listed->has_port     ? listed->port
                                                          : NULL;
    if (!port || scene->tool_arm || def->segment_count || !(def->length > 0.0))
        return DPT_OK;
    return scene_port_set(&scene->port, port, scene->origin, def->length)
               ? DPT_OK
               : host_refuse(error, DPT_E_ARGUMENT, "%s: tool.port is where the device's origin is", def->path);
}

dpt_result scene_open(struct scene *scene, const struct scene_def *def, dpt_host_error *error)
{
    static const double identity[4] = { 1.0, 0.0, 0.0, 0.0 };
    const struct setting_names *names = setting_names_for(def->command);
    dpt_world_def defaults;
    memset(scene, 0, sizeof *scene);
    dpt_world_def_init(&defaults);
    scene->sweep_budget = defaults.sweep_budget;
    scene->shows_contacts = 1;
    scene->command = def->command;
    scene->zoom = def->zoom;
    scene->force_scale = def->force_scale;
    scene->clutch = def->clutch;
    memcpy(scene->turned, identity, sizeof scene->turned);
    scene->length = def->length;
    scene->force = def->force;
    scene->physics_rate = def->physics;
    DPT_TRY(open_bodies(scene, def, error));
    if (def->physics != 0.0)
        DPT_TRY(scene_physics_choose(&scene->bodies, def->path, names->physics, def->physics, error));
    memcpy(scene->device_to_scene, scene->arm ? device_to_root : identity, sizeof scene->device_to_scene);
    if (!scene->bodies.count)
        return host_refuse(error, DPT_E_EMPTY, "%s: an arm whose scene has no body: name a mesh, and this one as %s",
                           def->path, names->tool);
    DPT_TRY(load_tool_arm(scene, def, error));
    DPT_TRY(check_law(scene, def, error));
    DPT_TRY(check_needle(scene, def, error));
    scene->piercing = def->piercing;
    DPT_TRY(put_look(scene, def, error));
    DPT_TRY(make_tips(scene, def, error));
    DPT_TRY(place_device(scene, def, error));
    DPT_TRY(place_port(scene, def, error));
    scene->segment_count = load_segments(scene, def, scene->segments, error);
    return scene->segment_count ? DPT_OK : error->code;
}

void scene_close(struct scene *scene)
{
    scene_stage_close(&scene->stage);
    scene_bodies_close(&scene->bodies);
    scene_tips_close(&scene->tips);
    close_dress(&scene->dress);
    free(scene->bytes);
    free(scene->tool_bytes);
}

/* 1 if the device is the scene's arm. Then its joints give the tool's pose, whatever frame the device's pose is in. */
static int is_the_arm(const struct scene *scene)
{
    dpt_arm_info info = { .size = sizeof info };
    return scene->arm && scene->device.flags & DPT_DEVICE_FLAG_ARM && scene->device.pose_dofs == 6 &&
           dpt_arm_get_info(scene->arm, &info) == DPT_OK && info.joints == scene->device.joints;
}

void scene_of_device(const struct scene *scene, const double point[3], double out[3])
{
    quaternion_rotate(scene->device_to_scene, point, out);
    for (int k = 0; k < 3; k++)
        out[k] = scene->origin[k] + scene->zoom * out[k];
}

void scene_to_device(const struct scene *scene, const double point[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (point[k] - scene->origin[k]) / scene->zoom;
    quaternion_rotate_back(scene->device_to_scene, out, out);
}

double scene_depth(const struct scene *scene, double force, double depth)
{
    const int has_spring = scene->force.law == DPT_LAW_PROXY && scene->force.stiffness > 0.0;
    return has_spring ? force / scene->force.stiffness : depth;
}

/* The tool's pose in the scene's frame, and the rotation `axes` from the device's axes to the scene's. */
static dpt_result find_pose(const struct scene *scene, const dpt_device_state *state, dpt_pose *pose, double axes[4])
{
    if (is_the_arm(scene)) {
        const double *q = state->pose.orientation;
        const double back[4] = { q[0], -q[1], -q[2], -q[3] };
        dpt_result result = dpt_arm_forward(scene->arm, state->joint, pose);
        quaternion_multiply(pose->orientation, back, axes);
        return result;
    }
    memcpy(axes, scene->device_to_scene, sizeof scene->device_to_scene);
    scene_of_device(scene, state->pose.position, pose->position);
    quaternion_multiply(axes, state->pose.orientation, pose->orientation);
    quaternion_multiply(scene->turned, pose->orientation, pose->orientation);
    if (scene->port.is_given)
        scene_port_aim(&scene->port, pose->position, pose->orientation);
    return DPT_OK;
}

static dpt_result move_tool(struct scene *scene, const dpt_pose *pose)
{
    const double along[3] = { 0.0, 0.0, scene->length };
    dpt_segment *stylus = &scene->stylus;
    double reach[3];
    if (!scene->has_stylus)
        return dpt_tool_set_pose(scene->stage.world, scene->stage.tool, pose);
    quaternion_rotate(pose->orientation, along, reach);
    for (int k = 0; k < 3; k++) {
        stylus->a[k] = pose->position[k];
        stylus->b[k] = stylus->a[k] + reach[k];
    }
    return dpt_tool_set_segments(scene->stage.world, scene->stage.tool, stylus, 1);
}

/* The hand has moved under the clutch: where the tool stands is where the hand is now. */
static void reindex(struct scene *scene, const dpt_pose *hand)
{
    const double *q = hand->orientation;
    const double back[4] = { q[0], -q[1], -q[2], -q[3] };
    double by[4], size = 0.0;
    quaternion_multiply(scene->pose.orientation, back, by);
    quaternion_multiply(by, scene->turned, scene->turned);
    for (int k = 0; k < 4; k++)
        size += scene->turned[k] * scene->turned[k];
    for (int k = 0; k < 4; k++)
        scene->turned[k] /= sqrt(size);
    for (int k = 0; k < 3; k++)
        scene->origin[k] += scene->pose.position[k] - hand->position[k];
}

/* The device that is the arm has no clutch: its joints tell where the tool is. */
static int is_clutch_down(const struct scene *scene, const dpt_device_state *state)
{
    return scene->clutch >= 0 && state->buttons >> scene->clutch & 1 && scene->has_pose && !is_the_arm(scene);
}

/* At the hand: force and torque of the scene in the device's axes. */
static void to_hand(const struct scene *scene, const double axes[4], dpt_wrench *wrench)
{
    quaternion_rotate_back(axes, wrench->force, wrench->force);
    quaternion_rotate_back(axes, wrench->torque, wrench->torque);
    for (int k = 0; k < 3; k++) {
        wrench->force[k] *= scene->force_scale;
        wrench->torque[k] *= scene->force_scale / scene->zoom;
    }
    if (scene->device.wrench_dofs < 6)
        memset(wrench->torque, 0, sizeof wrench->torque);
}

/* A step of the world and of what is soft, by dt, s. */
static dpt_result step(struct scene *scene, double dt)
{
    curved_tips_begin_tick(&scene->curved);
    DPT_TRY(scene_stage_step_world(&scene->stage, dt, NULL));
    if (curved_tips_have_failed(&scene->curved))
        return DPT_E_LIMIT;
    return scene_stage_step_soft(&scene->stage, dt);
}

uint64_t scene_soft_steps(const struct scene *scene)
{
    return scene->stage.physics ? scene_physics_steps(scene->stage.physics) : scene->bodies.steps;
}

void scene_get_hit(const struct scene *scene, dpt_hit *hit)
{
    dpt_tool_get_hit(scene->stage.world, scene->stage.tool, hit);
    curved_tips_deepen(&scene->curved, hit);
}

void scene_get_force_info(const struct scene *scene, dpt_force_info *force)
{
    dpt_tool_get_force_info(scene->stage.world, scene->stage.tool, force);
    force->energy += curved_tips_energy(&scene->curved);
}

struct scene_needle scene_get_needle(const struct scene *scene)
{
    struct scene_needle needle = { .depth = 0.0 };
    dpt_channel channels[SCENE_CHANNELS] = { { .size = sizeof *channels } };
    uint32_t count = 0;
    if (scene->piercing)
        dpt_tool_get_channels(scene->stage.world, scene->stage.tool, channels, SCENE_CHANNELS, &count);
    for (uint32_t i = 0; i < count; i++) {
        if (!(channels[i].flags & DPT_CHANNEL_FLAG_OCCUPIED))
            continue;
        needle.depth = fmax(needle.depth, channels[i].depth);
        needle.inside += channels[i].inside;
        needle.ruptures += channels[i].ruptures;
        needle.layers += channels[i].layers;
    }
    return needle;
}

double scene_tip_error(const struct scene *scene)
{
    return scene->curved.count ? scene->curved.error : tip_shapes_error(&scene->tips.shapes);
}

dpt_result scene_feel(struct scene *scene, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    dpt_pose pose;
    double axes[4];
    dpt_force_info *report = &scene->force_info;
    const dpt_result result = find_pose(scene, sample->state, &pose, axes);
    const int was_clutched = scene->is_clutched;
    scene_bodies_begin_tick(&scene->bodies, scene->ticks++);
    scene->is_clutched = result == DPT_OK && is_clutch_down(scene, sample->state);
    if (scene->is_clutched)
        return DPT_E_NOT_READY;
    DPT_TRY(result);
    if (was_clutched) {
        reindex(scene, &pose);
        DPT_TRY(find_pose(scene, sample->state, &pose, axes));
    }
    DPT_TRY(move_tool(scene, &pose));
    DPT_TRY(scene_tips_move(&scene->tips, scene->stage.world, scene->stage.tool, sample->dt, sample->state->buttons));
    DPT_TRY(step(scene, sample->dt));
    scene->pose = pose;
    scene->has_pose = 1;
    report->size = sizeof *report;
    scene_get_force_info(scene, report);
    *wrench = report->wrench;
    if (scene->port.is_given)
        scene_port_carry(&scene->port, pose.position, wrench);
    to_hand(scene, axes, wrench);
    const double share = scene->force_scale / scene->zoom;
    scene_passivity_step(&scene->passivity, sample, share * report->energy, share * report->body_work, wrench);
    return DPT_OK;
}
