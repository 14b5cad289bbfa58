/* SPDX-License-Identifier: BSD-3-Clause */
#define _POSIX_C_SOURCE 200809L
#include "view/view_scene.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dynpoint/base.h"
#include "scene/setting_words.h"

enum { NUMBER_BYTES = 40, BLOB_MAX = 0x7fffffff };

/* A text that grows. */
struct text {
    char *bytes;
    size_t size, room;
    int is_bad; /* memory ran out */
};

static void append_bytes(struct text *text, const char *bytes, size_t size)
{
    while (!text->is_bad && text->size + size > text->room) {
        const size_t room = text->room ? 2 * text->room : 4096;
        char *grown = realloc(text->bytes, room);
        text->is_bad = !grown;
        if (!grown)
            return;
        text->bytes = grown;
        text->room = room;
    }
    if (text->is_bad)
        return;
    memcpy(text->bytes + text->size, bytes, size);
    text->size += size;
}

static void append(struct text *text, const char *words)
{
    append_bytes(text, words, strlen(words));
}

/* The length of the UTF-8 sequence at `s`, or 0 where there is none. */
static size_t sequence_length(const unsigned char *s)
{
    const size_t length = s[0] < 0x80             ? 1
                          : (s[0] & 0xe0) == 0xc0 ? 2
                          : (s[0] & 0xf0) == 0xe0 ? 3
                          : (s[0] & 0xf8) == 0xf0 ? 4
                                                  : 0;
    for (size_t i = 1; i < length; i++)
        if ((s[i] & 0xc0) != 0x80)
            return 0;
    if ((length == 2 && s[0] < 0xc2) || (length == 3 && s[0] == 0xe0 && s[1] < 0xa0) ||
        (length == 3 && s[0] == 0xed && s[1] >= 0xa0) ||
        (length == 4 && ((s[0] == 0xf0 && s[1] < 0x90) || s[0] > 0xf4 || (s[0] == 0xf4 && s[1] >= 0x90))))
        return 0;
    return length;
}

/* A JSON string. A byte that is no UTF-8 becomes U+FFFD. */
static void append_string(struct text *text, const char *words)
{
    const unsigned char *s = (const unsigned char *)words;
    append(text, "\"");
    while (*s) {
        const size_t length = sequence_length(s);
        char escape[8];
        if (!length) {
            append(text, "\\ufffd");
        } else if (*s < 0x20 || *s == '"' || *s == '\\' || *s == 0x7f) {
            snprintf(escape, sizeof escape, "\\u%04x", (unsigned)*s);
            append(text, escape);
        } else {
            append_bytes(text, (const char *)s, length);
        }
        s += length ? length : 1;
    }
    append(text, "\"");
}

static void append_number(struct text *text, double number)
{
    char digits[NUMBER_BYTES];
    snprintf(digits, sizeof digits, "%.17g", isfinite(number) ? number : 0.0);
    append(text, digits);
}

static void append_numbers(struct text *text, const double *numbers, int count)
{
    for (int i = 0; i < count; i++) {
        append(text, i ? "," : "");
        append_number(text, numbers[i]);
    }
}

/* NULL is null. */
static void append_list(struct text *text, const double *numbers, int count)
{
    append(text, numbers ? "[" : "null");
    append_numbers(text, numbers, numbers ? count : 0);
    append(text, numbers ? "]" : "");
}

static void append_named(struct text *text, const char *name, double number)
{
    append(text, ",\"");
    append(text, name);
    append(text, "\":");
    append_number(text, number);
}

/* The meshes, each once. Where each one's arrays begin in the blob, in bytes. */
struct parts {
    const dpt_mesh **mesh; /* as many as there are bodies, at most */
    uint32_t count;
    size_t blob;
};

static uint32_t mesh_index(struct parts *parts, const dpt_mesh *mesh)
{
    for (uint32_t i = 0; i < parts->count; i++)
        if (parts->mesh[i] == mesh)
            return i;
    parts->mesh[parts->count] = mesh;
    return parts->count++;
}

struct arrays {
    const float *positions;
    const uint32_t *corners, *numbers;
    uint32_t vertices, triangles;
};

static struct arrays arrays_of(const dpt_mesh *mesh)
{
    struct arrays arrays;
    dpt_mesh_get_vertices(mesh, &arrays.positions, &arrays.vertices);
    dpt_mesh_get_triangles(mesh, &arrays.corners, &arrays.numbers, &arrays.triangles);
    return arrays;
}

static void append_meshes(struct text *text, struct parts *parts)
{
    append(text, ",\"meshes\":[");
    for (uint32_t i = 0; i < parts->count; i++) {
        const struct arrays arrays = arrays_of(parts->mesh[i]);
        append(text, i ? ",{\"name\":\"\"" : "{\"name\":\"\"");
        append_named(text, "vertices", arrays.vertices);
        append_named(text, "triangles", arrays.triangles);
        append_named(text, "positions", (double)parts->blob);
        parts->blob += 12 * (size_t)arrays.vertices;
        append_named(text, "corners", (double)parts->blob);
        parts->blob += 12 * (size_t)arrays.triangles;
        append_named(text, "sources", (double)parts->blob);
        parts->blob += 4 * (size_t)arrays.triangles;
        append(text, "}");
    }
    append(text, "]");
}

static void append_bodies(struct text *text, const struct view_scene *scene, struct parts *parts)
{
    append(text, ",\"bodies\":[");
    for (uint32_t i = 0; i < scene->body_count; i++) {
        const struct view_scene_body *body = &scene->bodies[i];
        append(text, i ? ",{\"name\":" : "{\"name\":");
        append_string(text, body->name);
        append_named(text, "id", body->id);
        append_named(text, "mesh", mesh_index(parts, body->mesh));
        append(text, ",\"pose\":[");
        append_numbers(text, body->pose.position, 3);
        append(text, ",");
        append_numbers(text, body->pose.orientation, 4);
        append(text, "],\"colour\":");
        append_list(text, body->colour, 3);
        append(text, ",\"look\":");
        append_string(text, body_look_words[body->look]);
        append(text, "}");
    }
    append(text, "]");
}

static void append_dress(struct text *text, const struct scene_dress *dress, struct parts *parts)
{
    append(text, ",\"dress\":[");
    for (uint32_t i = 0; dress && i < dress->count; i++) {
        const struct dress_part *part = &dress->part[i];
        const double hinge[7] = { part->hinge[0], part->hinge[1], part->hinge[2], part->axis[0],
                                  part->axis[1],  part->axis[2],  part->open };
        append(text, i ? ",{\"mesh\":" : "{\"mesh\":");
        append_number(text, mesh_index(parts, dress->mesh[i]));
        append(text, ",\"pose\":[");
        append_numbers(text, part->pose.position, 3);
        append(text, ",");
        append_numbers(text, part->pose.orientation, 4);
        append(text, "],\"hinge\":");
        append_list(text, part->has_hinge ? hinge : NULL, 7);
        append(text, ",\"colour\":");
        append_list(text, part->has_colour ? part->colour : NULL, 3);
        append(text, "}");
    }
    append(text, "]");
}

static void append_device(struct text *text, const struct view_scene *scene)
{
    append(text, ",\"device\":");
    if (!scene->device) {
        append(text, "null");
        return;
    }
    append(text, "{\"name\":");
    append_string(text, scene->device);
    append(text, scene->is_simulated ? ",\"simulated\":true" : ",\"simulated\":false");
    append_named(text, "rate", scene->rate);
    append(text, ",\"workspace\":");
    append_list(text, scene->has_workspace ? scene->workspace : NULL, 6);
    append(text, "}");
}

static unsigned char *put_words(unsigned char *to, const void *words, size_t count)
{
    for (size_t i = 0; i < count; i++, to += 4) {
        uint32_t word;
        memcpy(&word, (const char *)words + 4 * i, sizeof word);
        for (int k = 0; k < 4; k++)
            to[k] = (unsigned char)(word >> 8 * k);
    }
    return to;
}

static void *put_message(const struct text *text, const struct parts *parts, size_t *size)
{
    const size_t begin = (8 + text->size + 7) / 8 * 8;
    const uint32_t head[2] = { 1, (uint32_t)text->size }; /* the kind: a scene */
    unsigned char *message = parts->blob <= BLOB_MAX ? calloc(1, begin + parts->blob) : NULL;
    if (!message)
        return NULL;
    put_words(message, head, 2);
    memcpy(message + 8, text->bytes, text->size);
    unsigned char *to = message + begin;
    for (uint32_t i = 0; i < parts->count; i++) {
        const struct arrays arrays = arrays_of(parts->mesh[i]);
        to = put_words(to, arrays.positions, 3 * (size_t)arrays.vertices);
        to = put_words(to, arrays.corners, 3 * (size_t)arrays.triangles);
        to = put_words(to, arrays.numbers, arrays.triangles);
    }
    *size = begin + parts->blob;
    return message;
}

void *view_scene_message(const struct view_scene *scene, size_t *size)
{
    struct text text = { .size = 0 };
    struct parts parts = { .mesh = calloc(scene->body_count + DRESS_PARTS_MAX + 1u, sizeof *parts.mesh) };
    void *message = NULL;
    text.is_bad = !parts.mesh;
    append(&text, "{\"title\":");
    append_string(&text, scene->title);
    append(&text, ",\"program\":\"dynpoint " DPT_VERSION_STRING "\",\"mode\":");
    append_string(&text, scene->mode);
    append(&text, scene->has_control ? ",\"control\":true" : ",\"control\":false");
    append(&text, ",\"up\":");
    append_string(&text, scene->up);
    append_named(&text, "frame_rate", 60);
    append(&text, ",\"force_max\":");
    if (scene->force_max > 0.0)
        append_number(&text, scene->force_max);
    else
        append(&text, "null");
    append(&text, ",\"camera\":");
    append_list(&text, scene->camera, 9);
    append(&text, ",\"inset\":");
    append_list(&text, scene->inset, 9);
    append(&text, ",\"look\":");
    append_string(&text, tool_look_words[scene->look]);
    append(&text, scene->has_jaws ? ",\"jaws\":true" : ",\"jaws\":false");
    append_device(&text, scene);
    if (!text.is_bad) {
        append_bodies(&text, scene, &parts);
        append_dress(&text, scene->dress, &parts);
        append_meshes(&text, &parts);
        append(&text, "}");
    }
    if (!text.is_bad)
        message = put_message(&text, &parts, size);
    free(parts.mesh);
    free(text.bytes);
    return message;
}

enum { NAME_BYTES = 24 };

/* The box round the device's workspace, as it lies in the scene. */
static void map_workspace(const struct scene *scene, double box[6])
{
    for (int k = 0; k < 3; k++) {
        box[k] = HUGE_VAL;
        box[3 + k] = -HUGE_VAL;
    }
    for (int corner = 0; corner < 8; corner++) {
        double at[3];
        for (int k = 0; k < 3; k++)
            at[k] = corner >> k & 1 ? scene->device.workspace_max[k] : scene->device.workspace_min[k];
        scene_of_device(scene, at, at);
        for (int k = 0; k < 3; k++) {
            box[k] = fmin(box[k], at[k]);
            box[3 + k] = fmax(box[3 + k], at[k]);
        }
    }
}

static int has_workspace(const struct scene *scene)
{
    for (int k = 0; k < 3; k++)
        if (!(scene->device.workspace_min[k] < scene->device.workspace_max[k]))
            return 0;
    return 1;
}

void *scene_picture_message(const struct scene *scene, const struct scene_picture *picture, size_t *size)
{
    const struct scene_bodies *bodies = &scene->bodies;
    struct view_scene_body *list = calloc(bodies->count, sizeof *list);
    char(*names)[NAME_BYTES] = calloc(bodies->count, sizeof *names);
    void *message = NULL;
    struct view_scene told = { .title = picture->title,
                               .mode = picture->mode,
                               .device = picture->device,
                               .is_simulated = (scene->device.flags & DPT_DEVICE_FLAG_SIMULATED) != 0,
                               .has_workspace = has_workspace(scene),
                               .rate = picture->rate,
                               .has_control = picture->has_control,
                               .up = scene->arm ? "z" : "y",
                               .camera = scene->camera.is_given ? scene->camera.place : NULL,
                               .inset = scene->inset.is_given ? scene->inset.place : NULL,
                               .force_max = picture->force_max,
                               .look = scene->look,
                               .dress = &scene->dress,
                               .has_jaws = scene->tips.has_seen_jaws && scene->tips.motion.is_given,
                               .bodies = list,
                               .body_count = bodies->count };
    map_workspace(scene, told.workspace);
    for (uint32_t i = 0; list && names && i < bodies->count; i++) {
        const struct scene_body *body = &bodies->body[i];
        snprintf(names[i], sizeof names[i], "body %u", (unsigned)i);
        list[i] = (struct view_scene_body){ .name = body->name ? body->name : names[i],
                                            .mesh = body->mesh,
                                            .id = body->id,
                                            .pose = body->pose,
                                            .colour = body->has_colour ? body->colour : NULL,
                                            .look = body->look };
    }
    if (list && names)
        message = view_scene_message(&told, size);
    free(list);
    free(names);
    return message;
}

uint32_t scene_picture_vertices(const struct scene *scene)
{
    uint32_t sum = 0;
    for (uint32_t i = 0; i < scene->bodies.count; i++) {
        dpt_mesh_info info = { .size = sizeof info };
        if (scene->bodies.body[i].springs && !dpt_mesh_get_info(scene->bodies.body[i].mesh, &info))
            sum += info.vertices;
    }
    return sum;
}

struct view_tick scene_picture_tick(const struct scene *scene, const dpt_loop_sample *sample, double time, double took)
{
    dpt_force_info report = { .size = sizeof report };
    dpt_hit hit = DPT_HIT_INIT;
    double square = 0.0;
    scene_get_force_info(scene, &report);
    scene_get_hit(scene, &hit);
    for (int k = 0; k < 3; k++)
        square += report.wrench.force[k] * report.wrench.force[k];
    return (struct view_tick){ .time = time,
                               .force = (float)sqrt(square),
                               .depth = (float)scene_depth(scene, sqrt(square), hit.depth),
                               .energy = (float)report.energy,
                               .late = (float)sample->late,
                               .took = (float)took,
                               .contact = hit.contact,
                               .reason = report.reason,
                               .opening = (float)scene_tips_opening(&scene->tips) };
}
