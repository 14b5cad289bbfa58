/* SPDX-License-Identifier: BSD-3-Clause */
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/law_name.h"
#include "plan/plan_file.h"
#include "scene/json_value.h"
#include "scene/setting_words.h"

/* Numbers that are not negative have this as their largest one. */
#define HUGE_NUMBER 1e300

static char *take_copy(struct json_reader *reader, const struct json_value *object, const char *key)
{
    const char *text = json_take_text(reader, object, key);
    char *copy = text ? copy_text(text) : NULL;
    if (text && !copy)
        json_refuse(reader, object, "memory ran out");
    return copy;
}

static void take_short_text(struct json_reader *reader, const struct json_value *object, const char *key, char *to,
                            size_t room)
{
    const char *text = json_take_text(reader, object, key);
    const struct json_value at = json_member(object, key);
    if (text && strlen(text) >= room)
        json_refuse(reader, &at, "has more than %zu bytes", room - 1);
    else if (text)
        strcpy(to, text);
}

static void take_u32(struct json_reader *reader, const struct json_value *object, const char *key, uint32_t *to)
{
    uint64_t count = *to;
    json_take_count(reader, object, key, 0, UINT32_MAX, &count);
    *to = (uint32_t)count;
}

static void take_positive(struct json_reader *reader, const struct json_value *object, const char *key, double *to)
{
    json_take_number(reader, object, key, 0.0, HUGE_NUMBER, to);
}

/* Eight digits, base 16. */
static void take_crc32(struct json_reader *reader, const struct json_value *object, const char *key, uint32_t *to)
{
    const struct json_value at = json_member(object, key);
    const char *text = json_take_text(reader, object, key);
    if (!text)
        return;
    size_t digits = 0;
    while (isxdigit((unsigned char)text[digits]))
        digits++;
    if (digits != 8 || text[digits])
        json_refuse(reader, &at, "must be eight digits, base 16");
    else
        *to = (uint32_t)strtoul(text, NULL, 16);
}

static void require(struct json_reader *reader, const struct json_value *object, const char *const *keys)
{
    for (; *keys; keys++)
        if (!json_member(object, *keys).value)
            json_refuse(reader, object, "the key '%s' is missing", *keys);
}

static void take_rigid(struct json_reader *reader, const struct json_value *object, uint64_t *rigid)
{
    const struct json_value list = json_member(object, "rigid");
    const size_t count = json_check_list(reader, &list, 0, 64);
    for (size_t i = 0; i < count; i++) {
        const struct json_value at = json_item(&list, i);
        uint64_t body = 0;
        json_whole(reader, &at, 0, 63, &body);
        *rigid |= (uint64_t)1 << body;
    }
}

static void take_setting(struct json_reader *reader, const struct json_value *object, const char *key,
                         struct measure_setting *setting)
{
    static const char *const keys[] = { "law",
                                        "stiffness",
                                        "damping",
                                        "lock_rotation",
                                        "dt",
                                        "until",
                                        "budget",
                                        "sweep_budget",
                                        "margin",
                                        "max_contacts",
                                        "certificate_bytes",
                                        "strip",
                                        "strip_capacity",
                                        "smooth_normals",
                                        "friction",
                                        "integrator",
                                        "iterations",
                                        "rigid",
                                        NULL };
    static const char *const needed[] = { "law",          "stiffness",         "dt", "until", "budget", "margin",
                                          "max_contacts", "certificate_bytes", NULL };
    const struct json_value at = json_member(object, key);
    dpt_world_def *world = &setting->world;
    *setting =
        (struct measure_setting){ .parts = 1, .friction = NAN, .integrator = -1, .sleep_speed = NAN, .dt = 1e-3 };
    dpt_world_def_init(world);
    world->sweep_budget = 0;
    if (!json_check_object(reader, &at, keys))
        return;
    require(reader, &at, needed);
    world->law = (uint32_t)json_take_word(reader, &at, "law", law_names, DPT_LAW_PROXY);
    world->until = (uint32_t)json_take_word(reader, &at, "until", until_words, 0);
    world->strip = (uint32_t)json_take_word(reader, &at, "strip", strip_words, 0);
    setting->integrator = json_take_word(reader, &at, "integrator", plan_integrator_words, -1);
    if (setting->integrator > DPT_INTEGRATOR_IMPLICIT)
        setting->integrator = -1;
    json_take_number(reader, &at, "stiffness", 0.0, 1e9, &world->stiffness);
    json_take_number(reader, &at, "damping", 0.0, 1e9, &setting->damping);
    json_take_number(reader, &at, "friction", 0.0, 10.0, &setting->friction);
    json_take_number(reader, &at, "margin", 0.0, DPT_COORDINATE_MAX, &world->margin);
    json_take_above(reader, &at, "dt", 1.0, &setting->dt);
    take_u32(reader, &at, "budget", &world->budget);
    take_u32(reader, &at, "sweep_budget", &world->sweep_budget);
    json_take_count(reader, &at, "certificate_bytes", 0, (uint64_t)1 << 40, &world->certificate_bytes);
    uint64_t contacts = 0, smooth = 0, lock = 0, strip = world->strip_capacity, iterations = 0;
    json_take_count(reader, &at, "max_contacts", 0, 65535, &contacts);
    json_take_count(reader, &at, "lock_rotation", 0, 1, &lock);
    json_take_count(reader, &at, "smooth_normals", 0, 1, &smooth);
    json_take_count(reader, &at, "strip_capacity", 1, 1 << 20, &strip);
    json_take_count(reader, &at, "iterations", 0, 1024, &iterations);
    world->max_contacts = (uint32_t)contacts;
    world->smooth_normals = (uint32_t)smooth;
    setting->lock_rotation = (uint32_t)lock;
    world->strip_capacity = (uint32_t)strip;
    setting->iterations = (uint32_t)iterations;
    take_rigid(reader, &at, &setting->rigid);
}

static void take_figures(struct json_reader *reader, const struct json_value *object, const char *key,
                         struct plan_figures *figures)
{
    static const char *const keys[] = { "ticks",       "failed",     "distance_error", "force_error",
                                        "felt",        "near_folds", "unknown",        "contacts",
                                        "strip",       "work",       "work_p999",      "work_total",
                                        "time_median", "time_p999",  "bytes",          NULL };
    const struct json_value at = json_member(object, key);
    if (!json_check_object(reader, &at, keys))
        return;
    json_take_count(reader, &at, "ticks", 0, INT64_MAX, &figures->ticks);
    json_take_count(reader, &at, "failed", 0, INT64_MAX, &figures->failed);
    json_take_count(reader, &at, "felt", 0, INT64_MAX, &figures->felt);
    json_take_count(reader, &at, "near_folds", 0, INT64_MAX, &figures->near_folds);
    json_take_count(reader, &at, "unknown", 0, INT64_MAX, &figures->unknown);
    json_take_count(reader, &at, "work_total", 0, INT64_MAX, &figures->work_total);
    json_take_count(reader, &at, "bytes", 0, INT64_MAX, &figures->bytes);
    take_u32(reader, &at, "contacts", &figures->contacts);
    take_u32(reader, &at, "strip", &figures->strip);
    take_u32(reader, &at, "work", &figures->work);
    take_positive(reader, &at, "distance_error", &figures->distance_error);
    take_positive(reader, &at, "force_error", &figures->force_error);
    take_positive(reader, &at, "work_p999", &figures->work_p999);
    take_positive(reader, &at, "time_median", &figures->time_median);
    take_positive(reader, &at, "time_p999", &figures->time_p999);
}

static void take_neighbour(struct json_reader *reader, const struct json_value *object, const char *key,
                           struct plan_neighbour *neighbour)
{
    static const char *const keys[] = { "knob", "value", "breaks", "trace", "setting", "figures", NULL };
    static const char *const needed[] = { "knob", "value", "breaks", "trace", "setting", NULL };
    const struct json_value at = json_member(object, key);
    if (!json_check_object(reader, &at, keys))
        return;
    require(reader, &at, needed);
    take_short_text(reader, &at, "knob", neighbour->knob, sizeof neighbour->knob);
    take_short_text(reader, &at, "value", neighbour->value, sizeof neighbour->value);
    neighbour->broken = (enum plan_bound)json_take_word(reader, &at, "breaks", plan_bound_words, 0);
    neighbour->trace = json_take_word(reader, &at, "trace", plan_trace_words, 0);
    take_setting(reader, &at, "setting", &neighbour->setting);
    take_figures(reader, &at, "figures", &neighbour->figures);
}

static void take_meshes(struct json_reader *reader, const struct json_value *object, struct plan *plan)
{
    static const char *const keys[] = { "triangles", "crc32", NULL };
    const struct json_value list = json_member(object, "meshes");
    plan->mesh_count = (uint32_t)json_check_list(reader, &list, 1, PLAN_MESHES_MAX);
    for (uint32_t i = 0; i < plan->mesh_count; i++) {
        const struct json_value at = json_item(&list, i);
        if (!json_check_object(reader, &at, keys))
            return;
        take_u32(reader, &at, "triangles", &plan->mesh[i].triangles);
        take_crc32(reader, &at, "crc32", &plan->mesh[i].crc32);
    }
}

static void take_motion(struct json_reader *reader, const struct json_value *object, struct plan_motion *motion)
{
    static const char *const keys[] = { "file", "seed", "ticks", "speed", NULL };
    static const char *const needed[] = { "seed", "ticks", "speed", NULL };
    const struct json_value at = json_member(object, "motion");
    if (!json_check_object(reader, &at, keys))
        return;
    require(reader, &at, needed);
    motion->file = take_copy(reader, &at, "file");
    json_take_count(reader, &at, "seed", 0, INT64_MAX, &motion->seed);
    json_take_count(reader, &at, "ticks", 1, 1000000000, &motion->ticks);
    take_positive(reader, &at, "speed", &motion->speed);
}

static void take_asked(struct json_reader *reader, const struct json_value *object, struct plan_asked *asked)
{
    static const char *const keys[] = { "error", "force_error", "rate", NULL };
    static const char *const needed[] = { "error", "rate", NULL };
    const struct json_value at = json_member(object, "asked");
    asked->force_error = INFINITY;
    if (!json_check_object(reader, &at, keys))
        return;
    require(reader, &at, needed);
    take_positive(reader, &at, "error", &asked->error);
    take_positive(reader, &at, "force_error", &asked->force_error);
    json_take_number(reader, &at, "rate", 1.0, 1e5, &asked->rate);
}

static void take_limits(struct json_reader *reader, const struct json_value *object, struct plan *plan)
{
    static const char *const keys[] = { "distance",  "force",     "unknown_one_in", "contacts",    "strip",
                                        "work_p999", "time_p999", "speed",          "gain_margin", NULL };
    static const char *const needed[] = { "distance", "contacts", "strip", "work_p999", "time_p999", NULL };
    const struct json_value at = json_member(object, "promises");
    struct plan_limits *limits = &plan->limits;
    limits->force_error = INFINITY;
    if (!json_check_object(reader, &at, keys))
        return;
    require(reader, &at, needed);
    take_positive(reader, &at, "distance", &limits->error);
    take_positive(reader, &at, "force", &limits->force_error);
    take_positive(reader, &at, "work_p999", &limits->work);
    take_positive(reader, &at, "time_p999", &limits->time);
    take_u32(reader, &at, "contacts", &limits->contacts);
    take_u32(reader, &at, "strip", &limits->strip);
}

static void take_machine(struct json_reader *reader, const struct json_value *object, struct measure_machine *machine)
{
    static const char *const keys[] = { "processor", "system", "kernel", "compiler", "version", NULL };
    const struct json_value at = json_member(object, "machine");
    if (!json_check_object(reader, &at, keys))
        return;
    require(reader, &at, keys);
    take_short_text(reader, &at, "processor", machine->processor, sizeof machine->processor);
    take_short_text(reader, &at, "system", machine->system, sizeof machine->system);
    take_short_text(reader, &at, "kernel", machine->kernel, sizeof machine->kernel);
    take_short_text(reader, &at, "compiler", machine->compiler, sizeof machine->compiler);
    take_short_text(reader, &at, "version", machine->version, sizeof machine->version);
}

static void take_plan(struct json_reader *reader, const struct json_value *whole, struct plan *plan)
{
    static const char *const keys[] = {
        "dynpoint_plan", "scene",   "scene_bytes", "scene_crc32",      "length",   "radius",
        "meshes",        "motion",  "asked",       "thinnest_wall",    "quantum",  "device",
        "stable",        "setting", "promises",    "does_not_promise", "measured", "machine",
        "cheaper",       "better",  NULL
    };
    static const char *const needed[] = { "dynpoint_plan", "scene",   "scene_bytes", "scene_crc32", "meshes", "motion",
                                          "asked",         "setting", "promises",    "machine",     NULL };
    uint64_t format = PLAN_FORMAT;
    plan->length = plan->radius = NAN;
    if (!json_check_object(reader, whole, keys))
        return;
    require(reader, whole, needed);
    json_take_count(reader, whole, "dynpoint_plan", PLAN_FORMAT, PLAN_FORMAT, &format);
    plan->scene = take_copy(reader, whole, "scene");
    json_take_count(reader, whole, "scene_bytes", 0, INT64_MAX, &plan->identity.bytes);
    take_crc32(reader, whole, "scene_crc32", &plan->identity.crc32);
    json_take_number(reader, whole, "length", 0.0, 10.0, &plan->length);
    json_take_number(reader, whole, "radius", 0.0, 1.0, &plan->radius);
    take_meshes(reader, whole, plan);
    take_motion(reader, whole, &plan->motion);
    take_asked(reader, whole, &plan->asked);
    take_positive(reader, whole, "thinnest_wall", &plan->thinnest);
    take_positive(reader, whole, "quantum", &plan->quantum);
    take_positive(reader, whole, "stable", &plan->stable);
    plan->device = take_copy(reader, whole, "device");
    take_setting(reader, whole, "setting", &plan->setting);
    take_limits(reader, whole, plan);
    take_figures(reader, whole, "measured", &plan->figures);
    take_machine(reader, whole, &plan->machine);
    take_neighbour(reader, whole, "cheaper", &plan->cheaper);
    take_neighbour(reader, whole, "better", &plan->better);
}

int plan_file_parse(struct plan *plan, const char *text, size_t size, struct json_fault *fault)
{
    struct json_reader reader;
    const struct json_value whole = json_read(&reader, text, size);
    memset(plan, 0, sizeof *plan);
    if (whole.value)
        take_plan(&reader, &whole, plan);
    *fault = reader.fault;
    const int is_good = !json_has_failed(&reader);
    json_free(&reader);
    return is_good;
}
