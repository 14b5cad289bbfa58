/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/scene_text.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "scene/setting_words.h"
#include "text/parse_number.h"

enum kind { TEXT, COUNT, NUMBER };

#define KEY(kind, field)                                                                                               \
    {                                                                                                                  \
#field, kind, offsetof(struct scene_text, field), sizeof(((struct scene_text *)0)->field)                      \
    }

static const struct key {
    const char *name;
    enum kind kind;
    size_t at, room;
} keys[] = {
    KEY(TEXT, scene),
    KEY(COUNT, scene_bytes),
    KEY(COUNT, scene_crc32),
    KEY(TEXT, tool),
    KEY(COUNT, tool_bytes),
    KEY(COUNT, tool_crc32),
    KEY(COUNT, embedded),
    KEY(NUMBER, origin_x),
    KEY(NUMBER, origin_y),
    KEY(NUMBER, origin_z),
    KEY(NUMBER, zoom),
    KEY(NUMBER, length),
    KEY(NUMBER, radius),
    KEY(TEXT, law),
    KEY(NUMBER, stiffness),
    KEY(NUMBER, friction),
    KEY(NUMBER, damping),
    KEY(NUMBER, rotational_stiffness),
    KEY(COUNT, budget),
    KEY(COUNT, sweep_budget),
    KEY(NUMBER, force_max),
    KEY(TEXT, device),
    KEY(TEXT, device_kind),
    KEY(COUNT, device_flags),
    KEY(COUNT, pose_dofs),
    KEY(COUNT, wrench_dofs),
    KEY(COUNT, joints),
    KEY(NUMBER, force_scale),
    KEY(COUNT, clutch),
    KEY(COUNT, passivity),
    KEY(NUMBER, passive_damping),
    KEY(NUMBER, passive_spin_damping),
    KEY(NUMBER, passive_force_max),
    KEY(NUMBER, passive_torque_max),
    KEY(NUMBER, passive_force_slew),
    KEY(NUMBER, passive_torque_slew),
    KEY(NUMBER, passive_delay),
    KEY(NUMBER, physics),
    KEY(COUNT, planned),
    KEY(COUNT, plan_until),
    KEY(COUNT, plan_certificate_bytes),
    KEY(NUMBER, plan_margin),
    KEY(COUNT, plan_max_contacts),
    KEY(COUNT, plan_smooth_normals),
    KEY(COUNT, plan_sweep_budget),
    KEY(COUNT, plan_strip_capacity),
    KEY(COUNT, plan_rigid_low),
    KEY(COUNT, plan_rigid_high),
    KEY(COUNT, plan_integrator),
    KEY(COUNT, plan_iterations),
};
enum { KEYS = sizeof keys / sizeof *keys };

/* A line for each tip. */
#define TIP_KEY "tip="

/* A line for the jaws, where their motion was given. */
#define JAW_KEY "jaw="

/* A line for the end of the tool that pierces, where one does. */
#define PIERCING_KEY "piercing="

void scene_text_of(struct scene_text *text, const struct scene *scene, const struct scene_def *def)
{
    memset(text, 0, sizeof *text);
    snprintf(text->scene, sizeof text->scene, "%s", def->path);
    snprintf(text->tool, sizeof text->tool, "%s", def->tool ? def->tool : "");
    snprintf(text->law, sizeof text->law, "%s", law_names[scene->force.law]);
    snprintf(text->device_kind, sizeof text->device_kind, "%s", scene->device.name);
    text->scene_bytes = scene->file.bytes;
    text->scene_crc32 = scene->file.crc32;
    text->tool_bytes = scene->tool_file.bytes;
    text->tool_crc32 = scene->tool_file.crc32;
    text->embedded = def->scene_bytes.bytes || def->tool_bytes.bytes;
    text->device_flags = scene->device.flags;
    text->pose_dofs = scene->device.pose_dofs;
    text->wrench_dofs = scene->device.wrench_dofs;
    text->joints = scene->device.joints;
    text->origin_x = scene->origin[0];
    text->origin_y = scene->origin[1];
    text->origin_z = scene->origin[2];
    text->zoom = scene->zoom;
    text->force_scale = scene->force_scale;
    text->clutch = scene->clutch < 0 ? SCENE_TEXT_NO_CLUTCH : (uint64_t)scene->clutch;
    text->passivity = (uint64_t)scene->passivity.is_used;
    if (scene->passivity.is_used) {
        const dpt_passivity_def *def_of = &scene->passivity.def;
        text->passive_damping = def_of->damping;
        text->passive_spin_damping = def_of->spin_damping;
        text->passive_force_max = def_of->force_max;
        text->passive_torque_max = def_of->torque_max;
        text->passive_force_slew = def_of->force_slew;
        text->passive_torque_slew = def_of->torque_slew;
        text->passive_delay = def_of->delay;
    }
    text->sweep_budget = scene->sweep_budget;
    text->physics = scene->physics_rate;
    text->length = def->length;
    text->radius = def->radius;
    text->stiffness = scene->force.stiffness;
    text->friction = isnan(scene->force.friction) ? SCENE_TEXT_OWN_FRICTION : scene->force.friction;
    text->damping = scene->force.damping;
    text->rotational_stiffness = scene->force.rotational_stiffness;
}

/* The end of the text so far, and what does not fit. */
struct writer {
    char *out;
    size_t length;
    int is_full;
};

static void append(struct writer *writer, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 2, 3)))
#endif
    ;

static void append(struct writer *writer, const char *format, ...)
{
    const size_t room = DPT_RECORD_TEXT_MAX + 1 - writer->length;
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(writer->out + writer->length, room, format, arguments);
    va_end(arguments);
    if (length < 0 || (size_t)length >= room)
        writer->is_full = 1;
    else
        writer->length += (size_t)length;
}

/* A name may have any character but a zero; a line has no end of a line. */
static void append_name(struct writer *writer, const char *name)
{
    for (; *name; name++) {
        if (*name == '%' || *name == '\n' || *name == '\r')
            append(writer, "%%%02X", (unsigned)*name);
        else
            append(writer, "%c", *name);
    }
}

static void append_key(struct writer *writer, const struct key *key, const struct scene_text *text)
{
    const char *from = (const char *)text + key->at;
    uint64_t count;
    double number;
    if (key->kind == TEXT && !*from)
        return;
    append(writer, "%s=", key->name);
    if (key->kind == TEXT) {
        append_name(writer, from);
    } else if (key->kind == COUNT) {
        memcpy(&count, from, sizeof count);
        append(writer, "%" PRIu64, count);
    } else {
        memcpy(&number, from, sizeof number);
        append(writer, "%.17g", number);
    }
    append(writer, "\n");
}

dpt_result scene_text_write(const struct scene_text *text, const struct scene *scene, char out[DPT_RECORD_TEXT_MAX + 1],
                            dpt_host_error *error)
{
    struct writer writer = { .out = out };
    out[0] = '\0';
    for (int i = 0; i < KEYS; i++)
        append_key(&writer, &keys[i], text);
    for (uint32_t i = 0; i < scene->segment_count; i++) {
        dpt_segment segment = scene->segments[i];
        if (scene->has_stylus)
            segment.b[2] = scene->length;
        append(&writer, "segment=");
        for (int k = 0; k < 3; k++)
            append(&writer, "%.17g,", segment.a[k]);
        for (int k = 0; k < 3; k++)
            append(&writer, "%.17g,", segment.b[k]);
        append(&writer, "%.17g\n", segment.radius);
    }
    for (uint32_t i = 0; i < scene->tips.shapes.count; i++) {
        char line[TIP_SHAPE_LINE];
        tip_shape_write(&scene->tips.shapes.shape[i], line);
        append(&writer, TIP_KEY "%s\n", line);
    }
    if (scene->piercing)
        append(&writer, PIERCING_KEY "%u\n", (unsigned)scene->piercing);
    if (scene->tips.motion.is_given)
        append(&writer, JAW_KEY "%.17g:%.17g:%.17g", scene->tips.motion.from, scene->tips.motion.to,
               scene->tips.motion.seconds);
    if (scene->tips.motion.is_given && scene->tips.motion.button >= 0.0)
        append(&writer, ":%g", scene->tips.motion.button);
    if (scene->tips.motion.is_given)
        append(&writer, "\n");
    return writer.is_full ? host_refuse(error, DPT_E_LIMIT, "the names are too long to record") : DPT_OK;
}

static int hex_digit(char c)
{
    return c >= '0' && c <= '9' ? c - '0' : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* Returns 0 if it does not fit, or an escape is none. */
static int read_name(const char *from, const char *end, char *to, size_t room)
{
    for (; from < end && room > 1; from++, room--) {
        *to = *from;
        if (*from == '%') {
            const int high = end - from > 2 ? hex_digit(from[1]) : -1;
            const int low = end - from > 2 ? hex_digit(from[2]) : -1;
            if (high < 0 || low < 0 || (high == 0 && low == 0))
                return 0;
            *to = (char)(16 * high + low);
            from += 2;
        }
        to++;
    }
    *to = '\0';
    return from == end;
}

static int read_value(struct scene_text *text, const struct key *key, const char *from, const char *end)
{
    char *to = (char *)text + key->at;
    int64_t count;
    double number;
    if (key->kind == TEXT)
        return read_name(from, end, to, key->room);
    if (key->kind == COUNT) {
        if (parse_int(from, end, &count) != end || count < 0)
            return 0;
        memcpy(to, &count, sizeof count);
        return 1;
    }
    if (parse_double(from, end, &number) != end)
        return 0;
    memcpy(to, &number, sizeof number);
    return 1;
}

/* Returns 0 for the line of a tip that is none, or is one too many. */
static int read_tip_line(struct tip_shapes *tips, const char *line, const char *end)
{
    const size_t key = sizeof TIP_KEY - 1;
    if ((size_t)(end - line) < key || memcmp(line, TIP_KEY, key))
        return 1;
    return tips->count < TIP_SHAPES_MAX && tip_shape_read(&tips->shape[tips->count++], line + key, end);
}

/* Returns 0 for the line of a motion of jaws that is none. */
static int read_jaw_line(struct jaw_motion *motion, const char *line, const char *end)
{
    const size_t key = sizeof JAW_KEY - 1;
    if ((size_t)(end - line) < key || memcmp(line, JAW_KEY, key))
        return 1;
    return jaw_motion_parse(motion, line + key, end) && !jaw_motion_fault(motion);
}

/* Returns 0 for the line of an end that is none. */
static int read_piercing_line(uint32_t *piercing, const char *line, const char *end)
{
    const size_t key = sizeof PIERCING_KEY - 1;
    int64_t count;
    if ((size_t)(end - line) < key || memcmp(line, PIERCING_KEY, key))
        return 1;
    if (parse_int(line + key, end, &count) != end || count < DPT_PIERCING_A || count > DPT_PIERCING_B)
        return 0;
    *piercing = (uint32_t)count;
    return 1;
}

dpt_result scene_text_read(struct scene_text *text, const char *path, const char *in, dpt_host_error *error)
{
    memset(text, 0, sizeof *text);
    for (int line = 1; *in; line++) {
        const char *end = in + strcspn(in, "\n");
        const char *value = memchr(in, '=', (size_t)(end - in));
        if (!value)
            return host_refuse(error, DPT_E_SYNTAX, "%s: line %d of its header is not 'key=value'", path, line);
        const size_t length = (size_t)(value - in);
        int is_good = read_tip_line(&text->tips, in, end) && read_jaw_line(&text->jaw, in, end) &&
                      read_piercing_line(&text->piercing, in, end);
        for (int i = 0; i < KEYS; i++)
            if (strlen(keys[i].name) == length && !memcmp(keys[i].name, in, length))
                is_good &= read_value(text, &keys[i], value + 1, end);
        if (!is_good)
            return host_refuse(error, DPT_E_SYNTAX, "%s: line %d of its header: '%.*s' is none", path, line,
                               (int)(end - in), in);
        in = *end ? end + 1 : end;
    }
    return text->scene[0] ? DPT_OK : host_refuse(error, DPT_E_SYNTAX, "%s: its header names no scene", path);
}
