/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/scene_file.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene/setting_words.h"
#include "scene/shape.h"
#include "text/open_file.h"

/* A copy of its own: `before` bytes of one text, and another one. */
static char *join(struct json_reader *reader, const struct json_value *at, const char *first, size_t before,
                  const char *then)
{
    const size_t size = strlen(then) + 1;
    char *joined = malloc(before + size);
    if (!joined) {
        json_refuse(reader, at, "memory ran out");
        return NULL;
    }
    memcpy(joined, first, before);
    memcpy(joined + before, then, size);
    return joined;
}

char *scene_file_take_path(struct json_reader *reader, const struct json_value *object, const char *key,
                           const char *path)
{
    const struct json_value at = json_member(object, key);
    const char *name = json_take_text(reader, object, key);
    const char *slash = strrchr(path, '/');
    if (!name)
        return NULL;
    if (!strcmp(name, "-")) {
        json_refuse(reader, &at, "standard input is none of a scene's files");
        return NULL;
    }
    return join(reader, &at, path, *name == '/' || !slash ? 0 : (size_t)(slash + 1 - path), name);
}

static void read_segments(struct scene_file *file, struct json_reader *reader, const struct json_value *list)
{
    static const char *const keys[] = { "a", "b", "radius", NULL };
    const size_t count = json_check_list(reader, list, 1, DPT_ARM_SEGMENTS_MAX);
    for (size_t i = 0; i < count; i++) {
        const struct json_value at = json_item(list, i);
        dpt_segment *segment = &file->segments[i];
        if (!json_check_object(reader, &at, keys))
            return;
        for (int k = 0; k < 3; k++)
            if (!json_member(&at, keys[k]).value)
                json_refuse(reader, &at, "needs a, b and radius");
        json_take_numbers(reader, &at, "a", 3, DPT_COORDINATE_MAX, segment->a);
        json_take_numbers(reader, &at, "b", 3, DPT_COORDINATE_MAX, segment->b);
        json_take_number(reader, &at, "radius", 0.0, 1.0, &segment->radius);
    }
    file->segment_count = (uint32_t)count;
}

static void read_dress_part(struct dress_part *part, struct json_reader *reader, const struct json_value *at,
                            const char *path)
{
    static const char *const keys[] = { "mesh", "scale", "position", "orientation", "hinge",
                                        "axis", "open",  "colour",   NULL };
    const struct json_value axis = json_member(at, "axis"), colour = json_member(at, "colour");
    *part = (struct dress_part){ .scale = 1.0, .pose = DPT_POSE_IDENTITY, .axis = { 1.0, 0.0, 0.0 }, .open = 0.5 };
    if (!json_check_object(reader, at, keys))
        return;
    part->mesh = scene_file_take_path(reader, at, "mesh", path);
    if (!part->mesh)
        json_refuse(reader, at, "needs a mesh");
    json_take_above(reader, at, "scale", 1e6, &part->scale);
    scene_file_read_pose(&part->pose, reader, at, "position", 10.0);
    part->has_hinge = json_member(at, "hinge").value != NULL;
    json_take_numbers(reader, at, "hinge", 3, 10.0, part->hinge);
    json_take_numbers(reader, at, "axis", 3, 1.0, part->axis);
    json_take_number(reader, at, "open", -3.2, 3.2, &part->open);
    if (!part->has_hinge && (axis.value || json_member(at, "open").value))
        json_refuse(reader, at, "axis and open are for a part with a hinge");
    if (!(part->axis[0] * part->axis[0] + part->axis[1] * part->axis[1] + part->axis[2] * part->axis[2] > 1e-6))
        json_refuse(reader, &axis, "is no direction");
    part->has_colour = colour.value != NULL;
    json_take_numbers(reader, at, "colour", 3, 1.0, part->colour);
    for (int k = 0; k < 3; k++)
        if (part->colour[k] < 0.0)
            json_refuse(reader, &colour, "has a number below 0");
}

static void read_dress(struct scene_file *file, struct json_reader *reader, const struct json_value *list,
                       const char *path)
{
    const size_t count = json_check_list(reader, list, 1, DRESS_PARTS_MAX);
    if (file->look >= 0)
        json_refuse(reader, list, "is in place of a look");
    for (size_t i = 0; i < count && !json_has_failed(reader); i++) {
        const struct json_value at = json_item(list, i);
        file->dress_count = (uint32_t)i + 1;
        read_dress_part(&file->dress[i], reader, &at, path);
    }
}

static int has_seen_jaws(const struct scene_file *file)
{
    int has = file->look == TOOL_LOOK_FORCEPS;
    for (uint32_t i = 0; i < file->dress_count; i++)
        has |= file->dress[i].has_hinge;
    return has;
}

/* Without a time it stands at `to`. */
static void read_jaw(const struct scene_file *file, struct jaw_motion *jaw, struct json_reader *reader,
                     const struct json_value *tool)
{
    static const char *const keys[] = { "from", "to", "seconds", "button", NULL };
    uint64_t button = 0;
    const struct json_value at = json_member(tool, "jaw");
    if (!json_check_object(reader, &at, keys))
        return;
    if (!json_member(tool, "arm").value && !has_seen_jaws(file))
        json_refuse(reader, &at,
                    "is for the tool of an arm, and one that looks like forceps or has a dress with a hinge");
    if (!json_member(&at, "to").value)
        json_refuse(reader, &at, "needs to");
    *jaw = (struct jaw_motion){ .is_given = 1, .button = -1.0 };
    json_take_number(reader, &at, "from", 0.0, 1.0, &jaw->from);
    json_take_number(reader, &at, "to", 0.0, 1.0, &jaw->to);
    json_take_number(reader, &at, "seconds", 0.0, 1e6, &jaw->seconds);
    json_take_count(reader, &at, "button", 0, 31, &button);
    if (!json_member(&at, "button").value)
        return;
    jaw->button = (double)button;
    if (!(jaw->seconds > 0.0))
        json_refuse(reader, &at, "needs seconds above 0 with a button");
}

/* Needles are one straight part. */
static void read_piercing(struct scene_file *file, struct json_reader *reader, const struct json_value *tool)
{
    static const char *const ends[] = { "none", "a", "b", NULL };
    const struct json_value at = json_member(tool, "piercing");
    file->piercing = (uint32_t)json_take_word(reader, tool, "piercing", ends, DPT_PIERCING_NONE);
    if (file->piercing && (file->arm || file->tips.count || file->segment_count > 1))
        json_refuse(reader, &at, "is for a stylus or one segment, without tips");
}

/* What is led through a port is a stylus. */
static void read_port(struct scene_file *file, struct json_reader *reader, const struct json_value *tool)
{
    const struct json_value at = json_member(tool, "port");
    file->has_port = at.value != NULL;
    json_take_numbers(reader, tool, "port", 3, DPT_COORDINATE_MAX, file->port);
    if (file->has_port && (file->arm || file->segment_count || file->piercing || file->length == 0.0))
        json_refuse(reader, &at, "is for a stylus that has a length");
}

static void read_tool(struct scene_file *file, struct json_reader *reader, const struct json_value *at,
                      const char *path)
{
    static const char *const keys[] = { "length", "radius", "segments", "arm",  "jaw",   "tips",
                                        "law",    "look",   "piercing", "port", "dress", NULL };
    if (!json_check_object(reader, at, keys))
        return;
    const struct json_value segments = json_member(at, "segments"), arm = json_member(at, "arm"),
                            tips = json_member(at, "tips");
    const int is_stylus = json_member(at, "length").value || json_member(at, "radius").value;
    if (is_stylus + (segments.value != NULL) + (arm.value != NULL) > 1)
        json_refuse(reader, at, "is one of these: a stylus of a length and a radius, segments, an arm's");
    json_take_number(reader, at, "length", 0.0, 10.0, &file->length);
    json_take_number(reader, at, "radius", 0.0, 1.0, &file->radius);
    if (segments.value)
        read_segments(file, reader, &segments);
    file->arm = scene_file_take_path(reader, at, "arm", path);
    if (tips.value)
        scene_file_read_tips(&file->tips, reader, &tips);
    file->look = json_take_word(reader, at, "look", tool_look_words, -1);
    const struct json_value dress = json_member(at, "dress");
    if (dress.value)
        read_dress(file, reader, &dress, path);
    if (json_member(at, "jaw").value)
        read_jaw(file, &file->jaw, reader, at);
    file->law = json_take_word(reader, at, "law", law_names, -1);
    read_piercing(file, reader, at);
    read_port(file, reader, at);
}

static void read_device(struct scene_file *file, struct json_reader *reader, const struct json_value *at)
{
    static const char *const keys[] = { "url", "zoom", "force_scale", "origin", "clutch", NULL };
    uint64_t clutch = 0;
    if (!json_check_object(reader, at, keys))
        return;
    const struct json_value url = json_member(at, "url");
    const char *device = json_take_text(reader, at, "url");
    file->device = device ? join(reader, &url, "", 0, device) : NULL;
    json_take_above(reader, at, "zoom", 1000.0, &file->zoom);
    json_take_number(reader, at, "force_scale", 1e-3, 1000.0, &file->force_scale);
    json_take_numbers(reader, at, "origin", 3, DPT_COORDINATE_MAX, file->origin);
    file->has_origin = json_member(at, "origin").value != NULL;
    json_take_count(reader, at, "clutch", 0, 31, &clutch);
    file->clutch = json_member(at, "clutch").value ? (int)clutch : -1;
}

/* The keys of a place to look from end with what else the object may have. */
static void read_camera(struct scene_camera *camera, struct json_reader *reader, const struct json_value *at,
                        const char *more)
{
    const char *const keys[] = { "position", "target", "up", more, NULL };
    double position[3] = { 0.0 }, target[3] = { 0.0 }, up[3] = { 0.0, 1.0, 0.0 }, ahead[3];
    double cross = 0.0, squares = 1.0;
    if (!json_check_object(reader, at, keys))
        return;
    if (!json_member(at, "position").value || !json_member(at, "target").value)
        json_refuse(reader, at, "needs a position and a target");
    json_take_numbers(reader, at, "position", 3, DPT_COORDINATE_MAX, position);
    json_take_numbers(reader, at, "target", 3, DPT_COORDINATE_MAX, target);
    json_take_numbers(reader, at, "up", 3, DPT_COORDINATE_MAX, up);
    for (int k = 0; k < 3; k++)
        ahead[k] = target[k] - position[k];
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        const double across = ahead[l] * up[m] - ahead[m] * up[l];
        cross += across * across;
    }
    squares *= ahead[0] * ahead[0] + ahead[1] * ahead[1] + ahead[2] * ahead[2];
    squares *= up[0] * up[0] + up[1] * up[1] + up[2] * up[2];
    if (!(cross > 1e-12 * squares))
        json_refuse(reader, at, "looks nowhere, or up and ahead are one line");
    for (int k = 0; k < 3; k++) {
        camera->place[k] = position[k];
        camera->place[3 + k] = target[k];
        camera->place[6 + k] = up[k];
    }
    camera->is_given = 1;
}

static void read_view(struct scene_file *file, struct json_reader *reader, const struct json_value *at)
{
    const struct json_value inset = json_member(at, "inset");
    read_camera(&file->camera, reader, at, "inset");
    if (inset.value)
        read_camera(&file->inset, reader, &inset, NULL);
}

/* So many triangles are made, as far as shapes have a usual number. */
static uint64_t triangles_of(const struct listed_body *listed)
{
    for (size_t i = 0; listed->shape && !listed->triangles && i < shape_kind_count; i++)
        if (!strcmp(shape_kinds[i].name, listed->shape))
            return shape_kinds[i].default_count;
    return listed->triangles;
}

static void read_bodies(struct scene_file *file, struct json_reader *reader, const struct json_value *list,
                        const char *path)
{
    const size_t count = json_check_list(reader, list, 1, DPT_ARM_BODIES_MAX);
    uint64_t triangles = 0;
    file->bodies = calloc(count + 1, sizeof *file->bodies);
    if (!file->bodies)
        json_refuse(reader, list, "memory ran out");
    for (size_t i = 0; i < count && !json_has_failed(reader); i++) {
        const struct json_value at = json_item(list, i);
        file->body_count = (uint32_t)i + 1;
        scene_file_read_body(&file->bodies[i], reader, &at, path);
        triangles += triangles_of(&file->bodies[i].listed);
    }
    if (triangles > SCENE_FILE_TRIANGLES_MAX)
        json_refuse(reader, list, "its shapes have %llu triangles; at most %d together", (unsigned long long)triangles,
                    SCENE_FILE_TRIANGLES_MAX);
}

static void read_scene(struct scene_file *file, struct json_reader *reader, const struct json_value *at,
                       const char *path)
{
    static const char *const keys[] = { "bodies", "gravity", "tool", "device", "view", NULL };
    if (!json_check_object(reader, at, keys))
        return;
    const struct json_value bodies = json_member(at, "bodies"), tool = json_member(at, "tool"),
                            device = json_member(at, "device"), view = json_member(at, "view");
    if (!bodies.value)
        json_refuse(reader, at, "there are no bodies");
    read_bodies(file, reader, &bodies, path);
    json_take_number(reader, at, "gravity", 0.0, 1000.0, &file->gravity);
    if (tool.value)
        read_tool(file, reader, &tool, path);
    if (device.value)
        read_device(file, reader, &device);
    if (view.value)
        read_view(file, reader, &view);
}

int scene_file_parse(struct scene_file *file, const char *path, const char *text, size_t size, struct json_fault *fault)
{
    struct json_reader reader;
    *file = (struct scene_file){
        .length = NAN, .radius = NAN, .law = -1, .look = -1, .zoom = NAN, .force_scale = NAN, .clutch = -1
    };
    file_identity_add(&file->identity, text, size);
    const struct json_value whole = json_read(&reader, text, size);
    read_scene(file, &reader, &whole, path);
    *fault = reader.fault;
    const int is_good = !json_has_failed(&reader);
    json_free(&reader);
    return is_good;
}

/* At most SCENE_FILE_BYTES_MAX + 1 bytes, which is one too many. */
static dpt_result read_bytes(const char *path, char *bytes, size_t *size, dpt_host_error *error)
{
    FILE *stream = open_file(path, "rb");
    if (!stream)
        return host_refuse(error, DPT_E_OPEN, "%s: cannot be opened: %s", path, strerror(errno));
    *size = fread(bytes, 1, SCENE_FILE_BYTES_MAX + 1, stream);
    const int failed = ferror(stream), reason = errno;
    fclose(stream);
    if (failed)
        return host_refuse(error, DPT_E_OPEN, "%s: cannot be read: %s", path, strerror(reason));
    if (*size > SCENE_FILE_BYTES_MAX)
        return host_refuse(error, DPT_E_LIMIT, "%s: a scene file has at most %d bytes", path, SCENE_FILE_BYTES_MAX);
    return DPT_OK;
}

dpt_result scene_file_load(struct scene_file *file, const char *path, dpt_host_error *error)
{
    struct json_fault fault;
    size_t size = 0;
    char *bytes = malloc(SCENE_FILE_BYTES_MAX + 1);
    memset(file, 0, sizeof *file);
    if (!bytes)
        return host_refuse(error, DPT_E_MEMORY, "%s: memory ran out", path);
    dpt_result result = read_bytes(path, bytes, &size, error);
    if (result == DPT_OK && !scene_file_parse(file, path, bytes, size, &fault))
        result = json_fault_refuse(&fault, path, error);
    free(bytes);
    return result;
}

void scene_file_free(struct scene_file *file)
{
    for (uint32_t i = 0; i < file->body_count; i++) {
        free(file->bodies[i].mesh);
        free(file->bodies[i].regions);
    }
    for (uint32_t i = 0; i < file->dress_count; i++)
        free(file->dress[i].mesh);
    free(file->bodies);
    free(file->arm);
    free(file->device);
    memset(file, 0, sizeof *file);
}
