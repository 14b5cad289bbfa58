/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/scene_bodies.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "base/sized.h"
#include "scene/host_file.h"
#include "scene/shape.h"

/* A path, and a number of a body. */
enum { SCENE_WHERE_BYTES = 4200 };

void scene_bodies_of_mesh(struct scene_bodies *bodies, const dpt_mesh *mesh)
{
    memset(bodies, 0, sizeof *bodies);
    bodies->body[0] = (struct scene_body){ .mesh = mesh, .pose = DPT_POSE_IDENTITY };
    bodies->count = 1;
}

void scene_bodies_of_arm(struct scene_bodies *bodies, const dpt_arm *arm)
{
    dpt_arm_body from = { .size = sizeof from };
    memset(bodies, 0, sizeof *bodies);
    while (dpt_arm_get_body(arm, bodies->count, &from) == DPT_OK)
        bodies->body[bodies->count++] = (struct scene_body){ .mesh = from.mesh, .pose = from.pose };
}

/* Take over all of a listed body but its shape and springs. */
static void settle_body(struct scene_body *body, const struct listed_body *listed)
{
    body->pose = listed->pose;
    body->integrator = listed->integrator;
    body->iterations = listed->iterations;
    body->response = listed->response;
    body->name = listed->shape;
    body->has_colour = listed->has_colour;
    memcpy(body->colour, listed->colour, sizeof body->colour);
    body->look = listed->look;
    body->sleep_speed = listed->sleep_speed;
    if (listed->friction > 0.0)
        body->settings = (dpt_body_settings){ .size = sizeof body->settings,
                                              .static_friction = listed->friction,
                                              .kinetic_friction = listed->friction };
    if (listed->surface.size)
        body->settings = listed->surface;
    body->load_radius = listed->load_radius;
    body->spread = listed->spread;
    body->period = listed->period;
    body->room = listed->room;
}

/* `where` is what a message begins with. */
static dpt_result make_body(struct scene_body *body, const char *where, const struct listed_body *listed,
                            struct file_identity *identity, dpt_host_error *error)
{
    struct shape shape;
    shape_reason reason;
    dpt_compile_def def;
    dpt_diag diag = { .size = sizeof diag };
    dpt_compile_def_init(&def);
    def.springs = listed->springs.kind ? &listed->springs : NULL;
    settle_body(body, listed);
    if (shape_make(listed->shape, listed->triangles, 0, &shape, reason))
        return host_refuse(error, DPT_E_ARGUMENT, "%s%s", where, reason);
    dpt_result result = dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count,
                                           &def, &body->compiled, &diag);
    shape_free(&shape);
    if (result == DPT_OK)
        result = dpt_mesh_open(body->compiled.bytes, body->compiled.size, &body->mesh);
    if (result != DPT_OK)
        return host_refuse(error, result, "%s%s: %s", where, listed->shape,
                           diag.code ? diag.text : dpt_result_text(result));
    file_identity_add(identity, body->compiled.bytes, body->compiled.size);
    return DPT_OK;
}

static dpt_result load_body(struct scene_body *body, const char *where, const struct scene_file_body *from,
                            struct file_identity *identity, dpt_host_error *error)
{
    dpt_mesh_info info = { .size = sizeof info };
    size_t size = 0;
    settle_body(body, &from->listed);
    body->is_rigid = from->softness == SCENE_FILE_RIGID;
    body->file_bytes = host_file_load(from->mesh, &size, error);
    if (!body->file_bytes)
        return error->code;
    file_identity_add(identity, body->file_bytes, size);
    body->mesh = host_file_open_mesh(from->mesh, body->file_bytes, size, error);
    if (!body->mesh)
        return error->code;
    dpt_mesh_get_info(body->mesh, &info);
    if (from->softness == SCENE_FILE_SOFT && !info.springs)
        return host_refuse(error, DPT_E_ARGUMENT, "%s%s has no springs, so it does not give way", where, from->mesh);
    if (from->listed.response == DPT_RESPONSE_DISPLACE && info.nodes)
        return host_refuse(error, DPT_E_ARGUMENT, "%sresponse: displace is for springs of a sheet", where);
    return DPT_OK;
}

dpt_result scene_bodies_of_list(struct scene_bodies *bodies, const struct listed_scene *listed,
                                struct file_identity *identity, dpt_host_error *error)
{
    memset(bodies, 0, sizeof *bodies);
    bodies->gravity = listed->gravity;
    for (const struct listed_body *body = listed->bodies; body->shape; body++)
        DPT_TRY(make_body(&bodies->body[bodies->count++], "", body, identity, error));
    return DPT_OK;
}

dpt_result scene_bodies_of_file(struct scene_bodies *bodies, const char *path, const struct scene_file *file,
                                struct file_identity *identity, dpt_host_error *error)
{
    memset(bodies, 0, sizeof *bodies);
    bodies->gravity = file->gravity;
    for (uint32_t i = 0; i < file->body_count; i++) {
        const struct scene_file_body *from = &file->bodies[i];
        struct scene_body *body = &bodies->body[bodies->count++];
        char where[SCENE_WHERE_BYTES];
        snprintf(where, sizeof where, "%s: bodies[%u]: ", path, (unsigned)i);
        body->settings = from->settings;
        body->surface_regions = from->surface_regions;
        DPT_TRY(from->mesh ? load_body(body, where, from, identity, error)
                           : make_body(body, where, &from->listed, identity, error));
    }
    return DPT_OK;
}

/* Why it cannot be; NULL: it can. */
static const char *fault_of(const dpt_host_body *body)
{
    const double numbers[] = { body->load_radius, body->period, body->room };
    dpt_mesh_info info = { .size = sizeof info };
    if (dpt_mesh_get_info(body->mesh, &info) != DPT_OK)
        return "it has no mesh";
    if (body->flags & ~(uint32_t)DPT_HOST_BODY_FLAG_RIGID || body->reserved)
        return "it has flags that there are not";
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (!(numbers[i] >= 0.0 && numbers[i] <= (i == 1 ? 1000.0 : DPT_COORDINATE_MAX)))
            return "load_radius and room must be 0 to 1e6 m, period 0 to 1000 s";
    if (!(body->sleep_speed >= -1.0 && body->sleep_speed <= DPT_COORDINATE_MAX))
        return "sleep_speed must be -1 to 1e6 m/s";
    if (body->integrator > DPT_INTEGRATOR_IMPLICIT || body->response > DPT_RESPONSE_DISPLACE || body->iterations > 1024)
        return "integrator, response or iterations are none of those that there are";
    return body->response == DPT_RESPONSE_DISPLACE && info.nodes ? "response: displace is for springs of a sheet"
                                                                 : NULL;
}

dpt_result scene_bodies_of_caller(struct scene_bodies *bodies, const char *path, const dpt_host_body *from,
                                  uint32_t count, dpt_host_error *error)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    memset(bodies, 0, sizeof *bodies);
    for (uint32_t i = 0; i < count; i++) {
        dpt_host_body given = { .size = sizeof given };
        struct scene_body *body = &bodies->body[bodies->count];
        dpt_result result = sized_take(sized_item(from, i), sized_of(from), sizeof given, &given, sizeof given);
        const char *fault = result == DPT_OK ? fault_of(&given) : dpt_result_text(result);
        if (!fault && given.settings) {
            body->settings.size = sizeof body->settings;
            result = sized_read(given.settings, SIZED_FIRST(dpt_body_settings, puncture_force), &body->settings,
                                sizeof body->settings);
            fault = result == DPT_OK ? NULL : dpt_result_text(result);
        }
        if (fault)
            return host_refuse(error, result == DPT_OK ? DPT_E_ARGUMENT : result, "%s: bodies[%u]: %s", path,
                               (unsigned)i, fault);
        body->mesh = given.mesh;
        body->pose = given.pose ? *given.pose : identity;
        body->name = given.name;
        body->is_rigid = (given.flags & DPT_HOST_BODY_FLAG_RIGID) != 0;
        body->load_radius = given.load_radius;
        body->period = given.period;
        body->room = given.room;
        body->sleep_speed = given.sleep_speed;
        body->integrator = given.integrator;
        body->iterations = given.iterations;
        body->response = given.response;
        bodies->count++;
    }
    return DPT_OK;
}

void scene_bodies_leave(struct scene_bodies *bodies)
{
    for (uint32_t i = 0; i < bodies->count; i++) {
        struct scene_body *body = &bodies->body[i];
        free(body->block);
        free(body->springs_block);
        free(body->compliances);
        free(body->of_triangle);
        body->of_triangle = NULL;
        body->block = body->springs_block = NULL;
        body->compliances = NULL;
        body->block_bytes = body->springs_bytes = 0;
        body->springs = NULL;
        body->id = 0;
    }
}

void scene_bodies_close(struct scene_bodies *bodies)
{
    scene_bodies_leave(bodies);
    for (uint32_t i = 0; i < bodies->count; i++) {
        dpt_compiled_free(&bodies->body[i].compiled);
        free(bodies->body[i].file_bytes);
    }
    bodies->count = 0;
}

/* Row k of a rotation. */
static void row_of(const double q[4], int k, double row[3])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double rows[3][3] = { { 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y) },
                                { 2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x) },
                                { 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y) } };
    memcpy(row, rows[k], sizeof rows[k]);
}

/* Where the box of a body's vertices begins and ends along an axis of the scene. */
static void extent_of(const struct scene_body *body, int k, double *low, double *high)
{
    const float *vertices;
    uint32_t count;
    double row[3];
    row_of(body->pose.orientation, k, row);
    dpt_mesh_get_vertices(body->mesh, &vertices, &count);
    for (size_t v = 0; v < count; v++) {
        const double x = body->pose.position[k] + row[0] * (double)vertices[3 * v] +
                         row[1] * (double)vertices[3 * v + 1] + row[2] * (double)vertices[3 * v + 2];
        *low = x < *low ? x : *low;
        *high = x > *high ? x : *high;
    }
}

void scene_bodies_top(const struct scene_bodies *bodies, double top[3])
{
    for (int k = 0; k < 3; k++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        extent_of(&bodies->body[0], k, &low, &high);
        top[k] = k == 1 ? high : 0.5 * (low + high);
    }
}

/* Of a mesh of this extent: what a load is spread over, where the scene does not say. */
#define LOAD_SHARE 0.05

/* Whether the tissue's step finds what a tool does to it (springs.h), which shares the load among all that it touches. */
static int is_solved_together(const struct scene_body *body, const struct force_options *options)
{
    return body->response == DPT_RESPONSE_LOAD && !(body->period > 0.0) && options->law == DPT_LAW_PROXY;
}

static double load_radius_of(const struct scene_body *body, const struct force_options *options, double diagonal)
{
    if (body->load_radius > 0.0 || is_solved_together(body, options))
        return body->load_radius;
    return body->spread > 0.0 ? body->spread : LOAD_SHARE * diagonal;
}

/* The least room, in diagonals of the mesh's box. */
#define ROOM_SHARE 3.0

static double diagonal_of(const dpt_mesh_info *info)
{
    double square = 0.0;
    for (int k = 0; k < 3; k++)
        square += (info->box_max[k] - info->box_min[k]) * (info->box_max[k] - info->box_min[k]);
    return sqrt(square);
}

static double room_of(const struct scene_body *body)
{
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(body->mesh, &info);
    return body->room > 0.0 ? body->room : fmax(SCENE_ROOM, ROOM_SHARE * diagonal_of(&info));
}

/* What its springs tell of how far vertices give way in a step of physics that is apart. A proxy is solved for with it. */
static dpt_result find_compliances(struct scene_body *body, const struct force_options *options,
                                   dpt_deformable_def *deform)
{
    uint32_t count;
    const float *vertices;
    if (!(body->apart > 0.0) || options->law != DPT_LAW_PROXY)
        return DPT_OK;
    dpt_mesh_get_vertices(body->mesh, &vertices, &count);
    body->compliances = calloc(count, sizeof *body->compliances);
    if (!body->compliances)
        return DPT_E_MEMORY;
    deform->compliance = DPT_COMPLIANCE_MAX;
    deform->compliances = body->compliances;
    return dpt_springs_get_compliances(body->springs, body->apart, count, body->compliances);
}

/* Rounding of a ratio of two periods. */
#define WHOLE 1e-9

/* s: substeps of IMPLICIT are no longer than that in a step of a rate of its own. */
#define IMPLICIT_SUBSTEP 1e-3

/* And those of the others are as many in a second as ticks of 1 kHz may have. */
#define SUBSTEPS_LOOP 1e-3

/* How many substeps a step may have, if the body is stepped at a rate of its own, or with the loop. */
static uint32_t substeps_most(const struct scene_body *body)
{
    dpt_springs_def usual;
    dpt_springs_def_init(&usual);
    return (uint32_t)ceil(usual.max_substeps * fmax(1.0, body->apart / SUBSTEPS_LOOP * (1.0 - WHOLE)));
}

static void choose_substeps(const struct scene_body *body, dpt_springs_def *springs)
{
    springs->max_substeps = substeps_most(body);
    if (body->apart > 0.0 && body->integrator == DPT_INTEGRATOR_IMPLICIT)
        springs->min_substeps = (uint32_t)ceil(body->apart / IMPLICIT_SUBSTEP * (1.0 - WHOLE));
}

static dpt_result add_soft(struct scene_bodies *bodies, struct scene_body *body, dpt_world *world,
                           const struct force_options *options)
{
    dpt_deformable_def deform;
    dpt_springs_def springs;
    dpt_mesh_info info = { .size = sizeof info };
    dpt_deformable_def_init(&deform);
    dpt_springs_def_init(&springs);
    dpt_mesh_get_info(body->mesh, &info);
    const double diagonal = diagonal_of(&info);
    deform.mesh = springs.mesh = body->mesh;
    const double room = room_of(body);
    for (int k = 0; k < 3; k++) {
        deform.box_min[k] = fmax(info.box_min[k] - room, -DPT_COORDINATE_MAX);
        deform.box_max[k] = fmin(info.box_max[k] + room, DPT_COORDINATE_MAX);
    }
    deform.pose = &body->pose;
    deform.load_radius = load_radius_of(body, options, diagonal);
    deform.period = body->period;
    deform.response = body->response;
    springs.integrator = body->integrator;
    if (body->iterations)
        springs.iterations = body->iterations;
    choose_substeps(body, &springs);
    if (body->sleep_speed != 0.0)
        springs.sleep_speed = fmax(body->sleep_speed, 0.0);
    for (int k = 0; k < 3; k++) {
        double row[3];
        row_of(body->pose.orientation, 1, row);
        springs.gravity[k] = -bodies->gravity * row[k];
    }
    body->springs_bytes = dpt_springs_bytes(&springs);
    body->springs_block = malloc(body->springs_bytes);
    if (!body->springs_block)
        return DPT_E_MEMORY;
    DPT_TRY(dpt_springs_create(body->springs_block, body->springs_bytes, &springs, &body->springs));
    DPT_TRY(find_compliances(body, options, &deform));
    body->block_bytes = dpt_deformable_bytes(&deform);
    body->block = malloc(body->block_bytes);
    return body->block ? dpt_body_add_deformable(world, body->block, body->block_bytes, &deform, &body->id)
                       : DPT_E_MEMORY;
}

int scene_bodies_displace(const struct scene_bodies *bodies)
{
    int displaces = 0;
    for (uint32_t i = 0; i < bodies->count; i++)
        displaces |= bodies->body[i].response == DPT_RESPONSE_DISPLACE;
    return displaces;
}

int scene_body_is_soft(const struct scene_body *body)
{
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(body->mesh, &info);
    return info.springs && !body->is_rigid;
}

uint32_t scene_bodies_channels(const struct scene_bodies *bodies)
{
    for (uint32_t i = 0; i < bodies->count; i++) {
        const dpt_body_settings *settings = &bodies->body[i].settings;
        if ((settings->size && (settings->puncture_force > 0.0 || settings->toughness > 0.0)) ||
            bodies->body[i].surface_regions.count)
            return SCENE_CHANNELS;
    }
    return 0;
}

dpt_result scene_bodies_add(struct scene_bodies *bodies, dpt_world *world, const struct force_options *options)
{
    dpt_result result = DPT_OK;
    for (uint32_t i = 0; result == DPT_OK && i < bodies->count; i++) {
        struct scene_body *body = &bodies->body[i];
        result = scene_body_is_soft(body) ? add_soft(bodies, body, world, options)
                                          : dpt_body_add(world, body->mesh, &body->pose, &body->id);
        if (result == DPT_OK && body->settings.size)
            result = dpt_body_set_settings(world, body->id, &body->settings);
        if (result == DPT_OK && body->surface_regions.count)
            result = surface_regions_set(&body->surface_regions, world, body->id, body->mesh, &body->of_triangle);
        if (result == DPT_OK && !isnan(options->friction))
            result = force_options_set_body(options, world, body->id);
    }
    return result;
}

/* Of the stable step, a substep takes at most this share (springs.h). */
#define STEP_SHARE 0.9

dpt_result scene_bodies_check_step(const struct scene_bodies *bodies, const char *path, double dt,
                                   dpt_host_error *error)
{
    for (uint32_t i = 0; i < bodies->count; i++) {
        const dpt_springs *springs = bodies->body[i].springs;
        const double stable = dpt_springs_get_stable_step(springs);
        const uint32_t most = substeps_most(&bodies->body[i]);
        const int is_implicit = bodies->body[i].integrator == DPT_INTEGRATOR_IMPLICIT;
        if (springs && !is_implicit && !(dt <= STEP_SHARE * stable * most))
            return host_refuse(error, DPT_E_UNSTABLE,
                               "%s: bodies[%u] is too stiff: its steps may take %.3g s, and %u of them "
                               "are less than %g s. Choose the integrator implicit, a material that "
                               "is less stiff or heavier, or a coarser mesh",
                               path, (unsigned)i, STEP_SHARE * stable, (unsigned)most, dt);
    }
    return DPT_OK;
}

void scene_bodies_begin_tick(struct scene_bodies *bodies, uint64_t tick)
{
    bodies->tick = tick;
    bodies->is_held = 0;
}

void scene_bodies_hold(struct scene_bodies *bodies, uint32_t index, dpt_result why)
{
    struct scene_body *body = &bodies->body[index];
    if (body->held && body->held_last == bodies->tick)
        return;
    body->held_last = bodies->tick;
    if (!body->held++) {
        body->held_first = bodies->tick;
        body->held_why = why;
    }
    bodies->held += !bodies->is_held;
    bodies->is_held = 1;
}

/* What helps, after what is wrong. */
static void write_reason(const struct scene_body *body, char *text, size_t room)
{
    if (body->held_why == DPT_E_FINITE)
        snprintf(
            text, room,
            "it leaves its room, which ends %g m beyond its box, or moves without bounds: hold it by a fixed region, or "
            "give it more room (physics.room)",
            room_of(body));
    else if (body->held_why == DPT_E_UNSTABLE)
        snprintf(text, room, "a tick was too long for its springs: choose the integrator implicit, or shorter ticks");
    else
        snprintf(text, room, "%s", dpt_result_text(body->held_why));
}

int scene_bodies_held_text(const struct scene_bodies *bodies, char *text, size_t room)
{
    const struct scene_body *first = NULL;
    uint32_t count = 0;
    for (uint32_t i = 0; i < bodies->count; i++) {
        first = !first && bodies->body[i].held ? &bodies->body[i] : first;
        count += bodies->body[i].held > 0;
    }
    if (!first)
        return 0;
    char name[64] = "", reason[256];
    if (first->name)
        snprintf(name, sizeof name, " (%s)", first->name);
    write_reason(first, reason, sizeof reason);
    snprintf(text, room, "bodies[%u]%s%s was held where it was on %" PRIu64 " ticks from tick %" PRIu64 " on: %s",
             (unsigned)(first - bodies->body), name, count > 1 ? ", the first of several," : "", first->held,
             first->held_first, reason);
    return 1;
}

/* Those that were held; nothing else is an error of one body alone. */
static dpt_result take_reports(struct scene_bodies *bodies, const uint32_t *index, const dpt_springs_info *reports,
                               uint32_t count, dpt_result result)
{
    dpt_result left = result;
    for (uint32_t i = 0; i < count; i++) {
        if (reports[i].result == DPT_OK)
            continue;
        scene_bodies_hold(bodies, index[i], reports[i].result);
        left = DPT_OK;
    }
    return left;
}

static dpt_result step_springs(struct scene_bodies *bodies, dpt_world *world, double dt)
{
    dpt_body ids[DPT_ARM_BODIES_MAX] = { 0 };
    dpt_springs *springs[DPT_ARM_BODIES_MAX] = { NULL };
    dpt_springs_info reports[DPT_ARM_BODIES_MAX];
    double period[DPT_ARM_BODIES_MAX];
    uint32_t index[DPT_ARM_BODIES_MAX], count = 0;
    for (uint32_t i = 0; i < bodies->count; i++) {
        const struct scene_body *body = &bodies->body[i];
        if (!body->springs)
            continue;
        ids[count] = body->id;
        springs[count] = body->springs;
        period[count] = body->period;
        index[count] = i;
        reports[count++] = (dpt_springs_info){ .size = sizeof *reports };
    }
    dpt_result result = dpt_bodies_step_springs(world, ids, springs, count, dt, reports);
    if (result != DPT_OK)
        result = take_reports(bodies, index, reports, count, result);
    for (uint32_t i = 0; result == DPT_OK && i < count; i++) {
        bodies->nodes += reports[i].nodes;
        bodies->active += reports[i].active;
        if (reports[i].active)
            scene_bodies_note_moving(bodies, fmax(period[i], dt));
    }
    bodies->steps += result == DPT_OK;
    return result;
}

/* Where nothing gives way a tick ends here, and nothing is prepared. */
dpt_result scene_bodies_step(struct scene_bodies *bodies, dpt_world *world, double dt)
{
    for (uint32_t i = 0; i < bodies->count; i++)
        if (bodies->body[i].springs)
            return step_springs(bodies, world, dt);
    return DPT_OK;
}

void scene_bodies_note_moving(struct scene_bodies *bodies, double period)
{
    bodies->moving = fmax(bodies->moving, period);
}

void scene_bodies_count_moves(struct scene_bodies *bodies, double dt)
{
    bodies->moves += bodies->moving > 0.0;
    bodies->moving = fmax(bodies->moving - dt, 0.0);
}
