/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/deform_body.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/return_if_error.h"
#include "base/sized.h"
#include "deform/deform_vertices.h"
#include "deform/spring_state.h"
#include "proxy/proxy.h"
#include "strip/strip_state.h"
#include "tissue/tissue_solve.h"
#include "track/body_search.h"
#include "world/world_members.h"

void dpt_deformable_def_defaults(dpt_deformable_def *def, size_t size)
{
    const dpt_deformable_def defaults = { .max_points = 16, .passes = 8 };
    sized_defaults(def, size, &defaults, sizeof defaults);
}

enum { MAX_POINTS_MAX = 65535, PASSES_MAX = 1024 };

/* s: the longest, and one that is over in any step. */
#define PERIOD_MAX 1e3
#define PERIOD_MIN 1e-12

/* The default box: all that coordinates may be. */
static void set_default_box(dpt_deformable_def *def)
{
    for (int k = 0; k < 3; k++) {
        if (def->box_min[k] != 0.0 || def->box_max[k] != 0.0)
            return;
    }
    for (int k = 0; k < 3; k++) {
        def->box_min[k] = -DPT_COORDINATE_MAX;
        def->box_max[k] = DPT_COORDINATE_MAX;
    }
}

/* Read and check a caller's def; the box is set, and rounded to float. */
static dpt_result read_def(const dpt_deformable_def *given, dpt_deformable_def *def)
{
    dpt_deformable_def_init(def);
    if (!given)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_read(given, SIZED_FIRST(dpt_deformable_def, compliance), def, sizeof *def));
    if (!def->mesh || !def->max_points || def->max_points > MAX_POINTS_MAX)
        return DPT_E_ARGUMENT;
    if (!(def->period >= 0.0 && def->period <= PERIOD_MAX) || !(def->load_radius >= 0.0) ||
        !within(def->load_radius, DPT_COORDINATE_MAX))
        return DPT_E_ARGUMENT;
    if (def->response > DPT_RESPONSE_DISPLACE || !def->passes || def->passes > PASSES_MAX)
        return DPT_E_ARGUMENT;
    if (!(def->compliance >= 0.0 && def->compliance <= DPT_COMPLIANCE_MAX) || def->reserved_pointer ||
        (def->compliance > 0.0 && def->response == DPT_RESPONSE_DISPLACE))
        return DPT_E_ARGUMENT;
    set_default_box(def);
    if (!vec3_within(def->box_min, DPT_COORDINATE_MAX) || !vec3_within(def->box_max, DPT_COORDINATE_MAX))
        return DPT_E_FINITE;
    for (int k = 0; k < 3; k++) {
        def->box_min[k] = (float)def->box_min[k];
        def->box_max[k] = (float)def->box_max[k];
        if (!(def->box_min[k] <= def->mesh->box_min[k] && def->box_max[k] >= def->mesh->box_max[k]))
            return DPT_E_ARGUMENT;
    }
    return DPT_OK;
}

static int has_embedding(const struct dpt_mesh *mesh)
{
    const uint32_t *nodes;
    const float *weights;
    uint32_t count;
    return dpt_mesh_get_embedding(mesh, &nodes, &weights, &count) == DPT_OK && count > 0;
}

/* Where the arrays are: from the first multiple of 64 behind the struct on. */
struct deform_layout {
    uint64_t points, tools, target, next, solve, yield, motion;
    uint64_t bytes; /* of all, wherever the block begins */
};

static struct deform_layout layout_of(const dpt_deformable_def *def)
{
    const uint64_t floats = 3 * (uint64_t)def->mesh->vertices;
    const int has_yield = def->compliance > 0.0, is_bound = def->period > 0.0 || has_yield;
    const uint64_t target_floats = is_bound ? floats : 0;
    const uint64_t next_floats = is_bound || has_embedding(def->mesh) ? floats : 0;
    struct deform_layout layout = { .points = 0 };
    struct spring_net net;
    layout.tools = mesh_aligned(sizeof(struct load_point) * (uint64_t)def->max_points);
    layout.target = layout.tools + mesh_aligned(sizeof(struct tool_load) * (uint64_t)def->max_points);
    layout.next = layout.target + mesh_aligned(sizeof(float) * target_floats);
    layout.solve = layout.next + mesh_aligned(sizeof(float) * next_floats);
    const int is_solved = mesh_spring_net(def->mesh, &net) || has_yield;
    const uint64_t yield_bytes =
        has_yield ? sizeof(struct local_yield) + dpti_yield_bytes(def, def->mesh->vertices) : 0;
    layout.yield = layout.solve + mesh_aligned(is_solved ? sizeof(struct tissue_solve) : 0);
    layout.motion = layout.yield + mesh_aligned(yield_bytes);
    layout.bytes =
        mesh_aligned(sizeof(struct deform)) + MESH_ALIGN + layout.motion + dpti_surface_motion_bytes(def->mesh);
    return layout;
}

size_t dpt_deformable_bytes(const dpt_deformable_def *given)
{
    dpt_deformable_def def;
    if (read_def(given, &def) != DPT_OK)
        return 0;
    const uint64_t bytes = layout_of(&def).bytes;
    return bytes <= SIZE_MAX ? (size_t)bytes : 0;
}

dpt_result dpt_body_add_deformable(dpt_world *world, void *block, size_t bytes, const dpt_deformable_def *given,
                                   dpt_body *body)
{
    dpt_deformable_def def;
    struct frame frame;
    if (!world || !block || !body)
        return DPT_E_ARGUMENT;
    DPT_TRY(read_def(given, &def));
    DPT_TRY(frame_of_pose(def.pose, &frame));
    if ((uintptr_t)block % 8)
        return DPT_E_ALIGN;
    const struct deform_layout layout = layout_of(&def);
    if (bytes < layout.bytes)
        return DPT_E_MEMORY;
    DPT_TRY(dpti_body_can_add(world));
    const uintptr_t end = (uintptr_t)block + sizeof(struct deform);
    char *base = (char *)block + sizeof(struct deform) + (mesh_aligned(end) - end);
    struct deform *made = block;
    struct surface surface;
    memset(made, 0, sizeof *made);
    made->def = def;
    made->def.pose = NULL;
    made->points = (void *)(base + layout.points);
    made->tools = (void *)(base + layout.tools);
    made->target = (void *)(base + layout.target);
    made->next = (void *)(base + layout.next);
    made->solve = layout.yield > layout.solve ? base + layout.solve : NULL;
    made->yield = layout.motion > layout.yield ? (void *)(base + layout.yield) : NULL;
    if (made->solve)
        memset(made->solve, 0, sizeof(struct tissue_solve));
    if (made->yield)
        dpti_yield_make(made->yield, made->yield + 1, &def, def.mesh->vertices, made->target);
    dpti_surface_of_motion(def.mesh, def.box_min, def.box_max, base + layout.motion, &made->motion, &surface);
    if (def.period > 0.0 || made->yield)
        memcpy(made->target, surface.positions, 3 * sizeof(float) * (size_t)def.mesh->vertices);
    *body = dpti_body_add(world, &surface, def.pose);
    return DPT_OK;
}

static struct body *find_deformable(const struct dpt_world *world, dpt_body body)
{
    struct body *found = world_find_body(world, body);
    return found && found->surface.motion ? found : NULL;
}

static void move_now(struct dpt_world *world, struct body *body, const struct vertex_update *update)
{
    int has_begun_anew;
    const double moved = dpti_deform_move(&body->surface, &world->kernel, update, &has_begun_anew);
    dpti_body_note_vertices(world, body, moved, has_begun_anew);
}

/* Vertices are bound for where others are already, or will be in the next step. */
static int has_target(const struct deform *deform)
{
    return deform->def.period > 0.0 || deform->yield;
}

/* The vertices of an update are where the others are already bound for. */
static void set_target(struct deform *deform, const struct vertex_update *update)
{
    for (uint32_t i = 0; i < update->count; i++) {
        const uint32_t vertex = update->list ? update->list[i] : update->first + i;
        memcpy(deform->target + 3 * (size_t)vertex, update->positions + 3 * (size_t)i, 3 * sizeof(float));
    }
    deform->time_left = max_of(deform->def.period, PERIOD_MIN);
    if (deform->yield)
        deform->yield->foresees = 0;
}

/* The box of a body's surface goes where its vertices go, up to the def's. Returns 0 if they would leave that. */
static int make_room(struct dpt_world *world, struct body *body, const struct vertex_update *update)
{
    const struct deform *deform = deform_of(body);
    const float *target = has_target(deform) ? deform->target : NULL;
    double low[3], high[3];
    if (dpti_deform_is_inside(&body->surface, &world->kernel, update->positions, update->count))
        return 1;
    if (!dpti_deform_is_in_limit(&body->surface, update->positions, update->count))
        return 0;
    dpti_deform_extent(&body->surface, update, target, low, high);
    dpti_body_search_leave_frame(world, handle_index(body->id));
    dpti_surface_move_box(&body->surface, low, high);
    dpti_broad_phase_put_body(world, handle_index(body->id));
    return 1;
}

/* There is room for the update. */
static void move_within_room(struct dpt_world *world, struct body *body, const struct vertex_update *update)
{
    struct deform *deform = deform_of(body);
    if (update->count && has_target(deform))
        set_target(deform, update);
    else if (update->count)
        move_now(world, body, update);
}

/* Check an update of a body, and make it; or hold the body where it is. */
static dpt_result move_vertices(struct dpt_world *world, struct body *body, const struct vertex_update *update)
{
    if (!make_room(world, body, update)) {
        body->held_tick = world_coming_tick(world);
        return DPT_E_FINITE;
    }
    move_within_room(world, body, update);
    return DPT_OK;
}

static struct vertex_update update_of(const struct dpt_world *world, const struct body *body,
                                      const struct spring_vertices *vertices, uint32_t count)
{
    const int is_list = deform_of(body)->yield || count < body->surface.mesh->vertices;
    return (struct vertex_update){ .positions = vertices->positions,
                                   .list = is_list ? vertices->list : NULL,
                                   .count = count,
                                   .bound = -1.0,
                                   .tick = world_coming_tick(world) };
}

int dpti_deform_has_room(struct dpt_world *world, struct body *body, const struct spring_vertices *vertices,
                         uint32_t count)
{
    const struct vertex_update update = update_of(world, body, vertices, count);
    return make_room(world, body, &update);
}

void dpti_deform_follow(struct dpt_world *world, struct body *body, const struct spring_vertices *vertices,
                        uint32_t count)
{
    const struct vertex_update update = update_of(world, body, vertices, count);
    if (count && deform_of(body)->yield)
        move_now(world, body, &update);
    else
        move_within_room(world, body, &update);
}

void dpti_deform_return(struct dpt_world *world, struct body *body, const struct spring_vertices *vertices,
                        uint32_t count, int is_unmoved)
{
    dpti_deform_follow(world, body, vertices, count);
    if (is_unmoved)
        dpti_surface_motion_forget(&deform_of(body)->motion);
}

/* A share of a step: less time than that counts as none, as sums of dt are off by so much. */
#define ARRIVED 1e-9

/* One step on the way to where the vertices are to be. */
static void move_on(struct dpt_world *world, struct body *body, double dt)
{
    struct deform *deform = deform_of(body);
    const uint32_t vertices = body->surface.mesh->vertices;
    const int arrives = !(deform->time_left - dt > ARRIVED * dt), is_target = arrives && !deform->yield;
    const float share = (float)(dt / deform->time_left);
    for (size_t i = 0; i < 3 * (size_t)vertices && !arrives; i++)
        deform->next[i] = body->surface.positions[i] + share * (deform->target[i] - body->surface.positions[i]);
    if (arrives && deform->yield)
        memcpy(deform->next, deform->target, 3 * sizeof *deform->next * (size_t)vertices);
    if (deform->yield)
        dpti_yield_move_on(deform->yield, arrives ? 1.0 : dt / deform->time_left, deform->next);
    const struct vertex_update update = { .positions = is_target ? deform->target : deform->next,
                                          .count = vertices,
                                          .bound = -1.0,
                                          .tick = world_coming_tick(world) };
    deform->time_left = arrives ? 0.0 : deform->time_left - dt;
    move_now(world, body, &update);
}

void dpti_deform_begin_step(struct dpt_world *world, double dt)
{
    const dpt_wrench none = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 } };
    if (!world->deform_count)
        return;
    for (uint32_t t = 0; t < world->tool_slot_end; t++)
        world->tools[t].on_rigid = none;
    for (uint32_t i = 0; i < world->body_slot_end; i++) {
        struct body *body = &world->bodies[i];
        struct deform *deform = body->slot.used ? deform_of(body) : NULL;
        if (!deform)
            continue;
        deform->point_count = deform->tool_count = 0;
        deform->has_lost_tool = 0;
        if (deform->yield)
            dpti_yield_arrive(deform->yield);
        if (deform->time_left > 0.0 && dt > 0.0)
            move_on(world, body, dt);
    }
}

/* The bound that a caller states, or any that is negative. */
static int bound_is_valid(double bound)
{
    return bound <= DPT_COORDINATE_MAX; /* no NaN is */
}

dpt_result dpt_body_set_vertices(dpt_world *world, dpt_body id, uint32_t first, uint32_t count, const float *positions,
                                 double bound)
{
    if (!world || (!positions && count) || !bound_is_valid(bound))
        return DPT_E_ARGUMENT;
    struct body *body = find_deformable(world, id);
    if (!body)
        return DPT_E_HANDLE;
    const uint32_t vertices = body->surface.mesh->vertices;
    if (first > vertices || count > vertices - first)
        return DPT_E_ARGUMENT;
    const struct vertex_update update = {
        .positions = positions, .first = first, .count = count, .bound = bound, .tick = world_coming_tick(world)
    };
    return move_vertices(world, body, &update);
}

dpt_result dpt_body_set_vertex_list(dpt_world *world, dpt_body id, const uint32_t *vertices, uint32_t count,
                                    const float *positions, double bound)
{
    if (!world || ((!positions || !vertices) && count) || !bound_is_valid(bound))
        return DPT_E_ARGUMENT;
    struct body *body = find_deformable(world, id);
    if (!body)
        return DPT_E_HANDLE;
    for (uint32_t i = 0; i < count; i++)
        if (vertices[i] >= body->surface.mesh->vertices)
            return DPT_E_ARGUMENT;
    const struct vertex_update update = {
        .positions = positions, .list = vertices, .count = count, .bound = bound, .tick = world_coming_tick(world)
    };
    return move_vertices(world, body, &update);
}

dpt_result dpt_body_set_nodes(dpt_world *world, dpt_body id, const float *given)
{
    const uint32_t *nodes;
    const float *weights;
    uint32_t count;
    if (!world || !given)
        return DPT_E_ARGUMENT;
    struct body *body = find_deformable(world, id);
    if (!body)
        return DPT_E_HANDLE;
    DPT_TRY(dpt_mesh_get_embedding(body->surface.mesh, &nodes, &weights, &count));
    if (!count)
        return DPT_E_UNSUPPORTED;
    float *next = deform_of(body)->next;
    const uint32_t vertices = body->surface.mesh->vertices;
    for (uint32_t v = 0; v < vertices; v++) {
        vec3 sum = { 0.0, 0.0, 0.0 };
        for (uint32_t k = 4 * v; k < 4 * v + 4; k++)
            sum = along(sum, (double)weights[k], vec3_of_float(given + 3 * (size_t)nodes[k]));
        next[3 * (size_t)v] = (float)sum.x;
        next[3 * (size_t)v + 1] = (float)sum.y;
        next[3 * (size_t)v + 2] = (float)sum.z;
    }
    return dpt_body_set_vertices(world, id, 0, vertices, next, -1.0);
}

dpt_result dpt_body_get_vertices(const dpt_world *world, dpt_body id, const float **positions, uint32_t *count)
{
    if (!world || !positions || !count)
        return DPT_E_ARGUMENT;
    const struct body *body = find_deformable(world, id);
    *positions = body ? body->surface.positions : NULL;
    *count = body ? body->surface.mesh->vertices : 0;
    return body ? DPT_OK : DPT_E_HANDLE;
}

void dpti_deform_reset(struct body *body)
{
    struct deform *deform = body->slot.used ? deform_of(body) : NULL;
    if (!deform)
        return;
    dpti_surface_motion_forget(&deform->motion);
    if (deform->yield)
        dpti_yield_forget_loads(deform->yield);
    if (deform->solve)
        memset(deform->solve, 0, sizeof(struct tissue_solve));
    deform->point_count = deform->tool_count = 0;
    deform->has_lost_tool = 0;
    body->held_tick = 0;
}

const struct segment_strip *dpti_deform_displacing_strip(const struct dpt_world *world, uint32_t segment_index,
                                                         uint32_t slot)
{
    if (world->def.strip != DPT_STRIP_KIND_SHADOW)
        return NULL;
    const struct segment_strip *strip = &world->segment_strips[segment_index];
    const struct segment *segment = &world->segments[segment_index];
    const struct tool *tool = &world->tools[segment->tool_slot];
    return strip->body_slot == slot && strip->strip->count && tool_is_active(world, tool) &&
                   !dpti_proxy_is_used(world, tool)
               ? strip
               : NULL;
}

/* Room about a tool's axis for what it moves out of its way. */
static void make_room_at(struct dpt_world *world, struct body *body, const struct segment_strip *strip)
{
    const double reach[] = { -strip->radius, strip->radius };
    float around[12];
    for (int i = 0; i < 4; i++) {
        const vec3 end = along(strip->a, (double)(i / 2), strip->u);
        around[3 * i] = (float)(end.x + reach[i % 2]);
        around[3 * i + 1] = (float)(end.y + reach[i % 2]);
        around[3 * i + 2] = (float)(end.z + reach[i % 2]);
    }
    const struct vertex_update update = { .positions = around, .count = 4, .tick = world_coming_tick(world) };
    make_room(world, body, &update);
}

static void displace_body(struct dpt_world *world, struct body *body)
{
    const struct deform *deform = deform_of(body);
    struct surface *surface = &body->surface;
    int has_begun_anew;
    for (uint32_t s = 0; s < world->segment_count; s++) {
        const struct segment_strip *strip = dpti_deform_displacing_strip(world, s, handle_index(body->id));
        if (strip)
            make_room_at(world, body, strip);
    }
    dpti_deform_begin(surface, world_coming_tick(world));
    for (uint32_t s = 0; s < world->segment_count; s++) {
        const struct segment_strip *strip = dpti_deform_displacing_strip(world, s, handle_index(body->id));
        if (!strip)
            continue;
        const struct displacing_tool tool = { strip->a, strip->u, strip->radius, strip->side,
                                              world->segments[s].penetration.depth > strip->radius };
        dpti_displace(surface, strip->strip, &tool, deform->def.passes);
    }
    const double moved = dpti_deform_end(surface, &has_begun_anew);
    dpti_body_note_vertices(world, body, moved, has_begun_anew);
}

void dpti_deform_displace(struct dpt_world *world)
{
    if (!world->deform_count)
        return;
    for (uint32_t i = 0; i < world->body_slot_end; i++) {
        struct body *body = &world->bodies[i];
        int has_strip = 0;
        if (!body->slot.used || !deform_of(body) || deform_of(body)->def.response != DPT_RESPONSE_DISPLACE)
            continue;
        for (uint32_t s = 0; s < world->segment_count && !has_strip; s++)
            has_strip = dpti_deform_displacing_strip(world, s, i) != NULL;
        if (has_strip)
            displace_body(world, body);
    }
}

dpt_result dpti_deform_get_loads(const struct dpt_world *world, const struct body *body,
                                 int (*is_left_out)(const void *user, uint32_t tool_slot), const void *user,
                                 dpt_load *loads, uint32_t capacity, uint32_t *count)
{
    const struct deform *deform = deform_of(body);
    const struct surface surface = surface_view(&body->surface, world_coming_tick(world), 0.0);
    uint32_t left_out = 0;
    *count = 0;
    for (uint32_t t = 0; t < deform->tool_count; t++) {
        const struct tool_load *load = &deform->tools[t];
        const uint32_t room = *count < capacity ? capacity - *count : 0;
        if (is_left_out && is_left_out(user, load->tool_slot)) {
            left_out++;
            continue;
        }
        *count += dpti_deform_spread(&surface, deform->points + load->first, load->count, deform->def.load_radius,
                                     &load->whole, room ? loads + *count : NULL, room);
    }
    const int has_lost_tool = deform->has_lost_tool && (!left_out || left_out < deform->tool_count);
    return *count > capacity || has_lost_tool ? DPT_E_FULL : DPT_OK;
}

dpt_result dpt_body_get_loads(const dpt_world *world, dpt_body id, dpt_load *loads, uint32_t capacity, uint32_t *count)
{
    if (count)
        *count = 0;
    if (!world || !count || (!loads && capacity))
        return DPT_E_ARGUMENT;
    const struct body *body = find_deformable(world, id);
    return body ? dpti_deform_get_loads(world, body, NULL, NULL, loads, capacity, count) : DPT_E_HANDLE;
}

dpt_result dpt_body_get_mean_loads(const dpt_world *world, dpt_body id, dpt_load *loads, uint32_t capacity,
                                   uint32_t *count, double *seconds)
{
    if (count)
        *count = 0;
    if (seconds)
        *seconds = 0.0;
    if (!world || !count || !seconds || (!loads && capacity))
        return DPT_E_ARGUMENT;
    const struct body *body = find_deformable(world, id);
    if (!body)
        return DPT_E_HANDLE;
    const struct local_yield *yield = deform_of(body)->yield;
    if (!yield)
        return DPT_E_UNSUPPORTED;
    *count = dpti_yield_mean(yield, loads, capacity);
    *seconds = yield->seconds;
    return *count > capacity ? DPT_E_FULL : DPT_OK;
}

dpt_result dpt_body_set_answered_loads(dpt_world *world, dpt_body id, const dpt_load *loads, uint32_t count)
{
    if (!world || (!loads && count))
        return DPT_E_ARGUMENT;
    struct body *body = find_deformable(world, id);
    if (!body)
        return DPT_E_HANDLE;
    struct deform *deform = deform_of(body);
    if (!deform->yield)
        return DPT_E_UNSUPPORTED;
    for (uint32_t i = 0; i < count; i++) {
        if (loads[i].vertex >= body->surface.mesh->vertices)
            return DPT_E_ARGUMENT;
        if (!vec3_within(loads[i].force, SPRING_LOAD_MAX))
            return DPT_E_FINITE;
    }
    if (!dpti_yield_set_answered(deform->yield, body->surface.positions, loads, count))
        return DPT_E_FULL;
    if (deform->yield->count)
        deform->time_left = max_of(deform->def.period, PERIOD_MIN);
    return DPT_OK;
}

dpt_result dpt_body_set_foreseen_vertices(dpt_world *world, dpt_body id, uint32_t first, uint32_t count,
                                          const float *positions)
{
    const struct body *body = world ? find_deformable(world, id) : NULL;
    if (!body)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    struct local_yield *yield = deform_of(body)->yield;
    if (!yield)
        return DPT_E_UNSUPPORTED;
    if (!yield->foresees)
        dpti_yield_note_reached(yield);
    DPT_TRY(dpt_body_set_vertices(world, id, first, count, positions, -1.0));
    yield->foresees = 1;
    return DPT_OK;
}

dpt_result dpt_body_get_node_loads(const dpt_world *world, dpt_body id, dpt_load *loads, uint32_t capacity,
                                   uint32_t *count)
{
    const uint32_t *nodes;
    const float *weights;
    uint32_t node_count, vertex_loads;
    if (count)
        *count = 0;
    if (!world || !count || (!loads && capacity))
        return DPT_E_ARGUMENT;
    const struct body *body = find_deformable(world, id);
    if (!body)
        return DPT_E_HANDLE;
    DPT_TRY(dpt_mesh_get_embedding(body->surface.mesh, &nodes, &weights, &node_count));
    if (!node_count)
        return DPT_E_UNSUPPORTED;
    const dpt_result result = dpt_body_get_loads(world, id, loads, capacity / 4, &vertex_loads);
    *count = 4 * vertex_loads;
    /* From the last one on: each load's four lie behind it, or begin where it is. */
    for (uint32_t i = result == DPT_OK ? vertex_loads : 0; i-- > 0;) {
        const dpt_load load = loads[i];
        for (uint32_t k = 0; k < 4; k++) {
            const size_t corner = 4 * (size_t)load.vertex + k;
            loads[4 * i + k].vertex = nodes[corner];
            loads[4 * i + k].reserved = 0;
            vec3_store(scaled(vec3_of(load.force), (double)weights[corner]), loads[4 * i + k].force);
        }
    }
    return result;
}
