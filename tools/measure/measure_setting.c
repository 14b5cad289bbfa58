/* SPDX-License-Identifier: BSD-3-Clause */
#include "measure/measure_setting.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/quaternion.h"
#include "base/vec3.h"
#include "cli/command_options.h"
#include "dynpoint/kernel.h"
#include "host/tool_spread.h"
#include "platform/machine.h"
#include "shape/trace_hand.h"
#include "shape/trace_unit.h"

/* Of all tools together: more than any motion needs that a hand can make. */
enum { CONTACTS_OF_RICHEST = 1024 };

#define STIFFNESS          500.0
#define CERTIFICATES_BYTES ((uint64_t)64 << 20)

void measure_setting_init(struct measure_setting *setting, const struct scene *scene)
{
    *setting = (struct measure_setting){
        .parts = 1,
        .friction = scene->force.friction,
        .damping = scene->force.damping,
        .integrator = -1,
        .sleep_speed = NAN,
        .physics = scene->physics_rate,
        .dt = 1e-3,
    };
    dpt_world_def_init(&setting->world);
    setting->world.sweep_budget = 0;
    setting->world.max_contacts = SCENE_CONTACTS;
    setting->world.law = scene->force.law;
    setting->world.stiffness = scene->force.stiffness > 0.0 ? scene->force.stiffness : STIFFNESS;
    if (scene_bodies_displace(&scene->bodies))
        setting->world.strip = DPT_STRIP_KIND_SHADOW;
}

struct measure_setting measure_setting_richest(const struct measure_setting *setting, const struct scene *scene)
{
    struct measure_setting richest;
    measure_setting_init(&richest, scene);
    richest.world.law = setting->world.law;
    if (setting->world.method == DPT_METHOD_PAPER && richest.world.law == DPT_LAW_PROXY)
        richest.world.law = DPT_LAW_POINT;
    richest.world.stiffness = setting->world.stiffness;
    richest.world.margin = setting->world.margin;
    richest.world.onset = setting->world.onset;
    richest.world.side_limit = setting->world.side_limit;
    richest.world.fade = setting->world.fade;
    richest.world.smooth_normals = setting->world.smooth_normals;
    richest.world.kernel = setting->world.kernel;
    richest.world.max_contacts = CONTACTS_OF_RICHEST;
    richest.world.certificate_bytes = CERTIFICATES_BYTES;
    richest.friction = setting->friction;
    richest.damping = setting->damping;
    richest.lock_rotation = setting->lock_rotation;
    richest.dt = setting->dt;
    return richest;
}

const char *measure_setting_fault(const struct measure_setting *setting, const struct scene *scene)
{
    const dpt_world_def *world = &setting->world;
    const int is_proxy = world->law == DPT_LAW_PROXY && world->until == DPT_UNTIL_RESPOND;
    if (world->method == DPT_METHOD_PAPER && is_proxy)
        return "the paper's method has no proxy";
    if (world->method != DPT_METHOD_EXACT && (world->budget || world->sweep_budget))
        return "budgets are for the exact method";
    if (scene->tips.count && !is_proxy)
        return "tips are felt by a proxy alone";
    if (scene_bodies_displace(&scene->bodies) && is_proxy)
        return "what a tool moves out of its way is felt by the laws point and bed";
    return NULL;
}

void measure_setting_change(const struct measure_setting *setting, struct scene_bodies *bodies)
{
    for (uint32_t i = 0; i < bodies->count; i++) {
        struct scene_body *body = &bodies->body[i];
        if (setting->rigid >> i & 1)
            body->is_rigid = 1;
        if (setting->integrator >= 0)
            body->integrator = (uint32_t)setting->integrator;
        if (setting->iterations)
            body->iterations = setting->iterations;
        if (!isnan(setting->sleep_speed))
            body->sleep_speed = setting->sleep_speed > 0.0 ? setting->sleep_speed : -1.0;
    }
}

void measure_tool_begin(struct measure_tool *tool, const struct scene *scene)
{
    dpt_segment lines[DPT_ARM_SEGMENTS_MAX + SCENE_TIPS_MAX];
    uint32_t count = scene->segment_count;
    memset(tool, 0, sizeof *tool);
    tool->scene = scene;
    memcpy(lines, scene->segments, count * sizeof *lines);
    for (uint32_t i = 0; i < scene->tips.count; i++, count++)
        scene_tips_axis(&scene->tips, i, lines[count].a, lines[count].b);
    tool->rho = tool_spread(lines, count, tool->own_centre);
}

static void lead_whole(struct measure_tool *tool, const double *ends)
{
    const struct scene *scene = tool->scene;
    const vec3 a = vec3_of(ends), z = { 0.0, 0.0, 1.0 };
    const vec3 axis = unit_of(sub(vec3_of(ends + 3), a));
    const int had_axis = !tool->is_jump && dot(vec3_of(tool->axis), vec3_of(tool->axis)) > 0.0;
    struct quaternion turn = { 1.0, { 0.0, 0.0, 0.0 } };
    if (had_axis)
        turn = quaternion_of(tool->pose.orientation);
    if (dot(axis, axis) > 0.0) {
        const struct quaternion by = quaternion_of_turn(had_axis ? vec3_of(tool->axis) : z, axis);
        turn = quaternion_unit(quaternion_product(by, turn));
        vec3_store(axis, tool->axis);
    }
    quaternion_store(turn, tool->pose.orientation);
    vec3_store(a, tool->pose.position);
    for (uint32_t i = 0; i < scene->segment_count; i++) {
        const dpt_segment *own = &scene->segments[i];
        vec3_store(add(a, quaternion_turn(turn, vec3_of(own->a))), tool->segments[i].a);
        vec3_store(add(a, quaternion_turn(turn, vec3_of(own->b))), tool->segments[i].b);
        tool->segments[i].radius = own->radius;
    }
    vec3_store(add(a, quaternion_turn(turn, vec3_of(tool->own_centre))), tool->centre);
}

void measure_tool_lead(struct measure_tool *tool, const struct csv_table *trace, size_t row)
{
    const double *ends = csv_table_row(trace, row) + 1;
    tool->is_jump = trace_is_jump(trace, row);
    if (!tool->scene->has_stylus) {
        lead_whole(tool, ends);
        return;
    }
    dpt_segment *stylus = &tool->segments[0];
    memcpy(stylus->a, ends, sizeof stylus->a);
    memcpy(stylus->b, ends + 3, sizeof stylus->b);
    stylus->radius = tool->scene->stylus.radius;
    memcpy(tool->pose.position, stylus->a, sizeof stylus->a);
    tool->rho = tool_spread(stylus, 1, tool->centre);
}

dpt_result measure_tool_move(const struct measure_tool *tool, dpt_world *world, dpt_tool id)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    dpt_result result = DPT_OK;
    if (!tool->scene->has_stylus)
        return tool->is_jump ? dpt_tool_teleport(world, id, &tool->pose) : dpt_tool_set_pose(world, id, &tool->pose);
    if (tool->is_jump)
        result = dpt_tool_teleport(world, id, &identity);
    return result == DPT_OK ? dpt_tool_set_segments(world, id, tool->segments, 1) : result;
}

void measure_tool_weigh(const struct measure_tool *tool, const dpt_wrench *wrench, double weighed[6])
{
    const vec3 force = vec3_of(wrench->force);
    const vec3 arm = sub(vec3_of(tool->pose.position), vec3_of(tool->centre));
    const vec3 torque = add(vec3_of(wrench->torque), cross(arm, force));
    vec3_store(force, weighed);
    vec3_store(scaled(torque, tool->rho > 0.0 ? 1.0 / tool->rho : 0.0), weighed + 3);
}

enum { COLUMNS = 7 };

int measure_trace_make(struct csv_table *trace, const struct scene *scene, const struct measure_hand *def)
{
    const struct scene_body *body = &scene->bodies.body[def->body];
    const struct quaternion turn = quaternion_unit(quaternion_of(body->pose.orientation));
    const vec3 origin = vec3_of(body->pose.position);
    struct trace_hand hand;
    *trace = (struct csv_table){ .columns = COLUMNS };
    trace->values =
        def->ticks <= SIZE_MAX / (COLUMNS * sizeof(double)) ? malloc(def->ticks * COLUMNS * sizeof(double)) : NULL;
    if (!trace->values)
        return complain(scene->command, "memory ran out");
    trace->rows = def->ticks;
    trace_hand_begin(&hand, body->mesh, def->seed, def->length, def->band, def->speed);
    hand.stands = def->stands;
    for (size_t i = 0; i < trace->rows; i++) {
        double *row = trace->values + COLUMNS * i, ends[6];
        trace_hand_move(&hand, ends);
        row[0] = (double)i;
        vec3_store(add(origin, quaternion_turn(turn, vec3_of(ends))), row + 1);
        vec3_store(add(origin, quaternion_turn(turn, vec3_of(ends + 3))), row + 4);
    }
    return 0;
}

int measure_trace_read(struct csv_table *trace, const struct scene *scene, const char *path, size_t min)
{
    struct trace_ball balls[DPT_ARM_BODIES_MAX];
    dpt_device_error error = { .size = sizeof error };
    if (csv_table_read(trace, path, &trace_format, &error) != DPT_OK)
        return complain(scene->command, "%s", error.text);
    if (trace->rows >= min) {
        for (uint32_t i = 0; i < scene->bodies.count; i++)
            balls[i] = trace_ball_of(scene->bodies.body[i].mesh, &scene->bodies.body[i].pose);
        trace_note_unit(path, trace, balls, scene->bodies.count);
        return 0;
    }
    const size_t rows = trace->rows;
    csv_table_free(trace);
    return complain(scene->command, "%s: it has %zu ticks, and at least %zu are needed", path, rows, min);
}

#ifdef __clang__
#define COMPILER "clang " __clang_version__
#elif defined __GNUC__
#define COMPILER "gcc " __VERSION__
#else
#define COMPILER "unknown compiler"
#endif

static void take_text(char *to, size_t room, const char *from)
{
    size_t n = 0;
    for (; *from && n + 1 < room; from++)
        if (*from >= ' ' && *from <= '~' && !strchr("\"\\*/", *from))
            to[n++] = *from;
    while (n > 0 && to[n - 1] == ' ')
        n--;
    to[n] = '\0';
}

void measure_machine_read(struct measure_machine *machine, uint32_t kernel)
{
    char text[256];
    machine_processor(text, sizeof text);
    take_text(machine->processor, sizeof machine->processor, text);
    machine_system(text, sizeof text);
    take_text(machine->system, sizeof machine->system, text);
    take_text(machine->compiler, sizeof machine->compiler, COMPILER);
    take_text(machine->version, sizeof machine->version, dpt_version());
    take_text(machine->kernel, sizeof machine->kernel, dpt_kernel_name(kernel));
}
