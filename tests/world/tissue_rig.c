/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/tissue_rig.h"

#include "deform/spring_state.h"
#include "mesh/mesh_format.h"
#include "proxy/proxy.h"

/* How a rod presses: m in a tick; ticks for which it is held, and the last of them, which are looked at. */
#define PRESS 2e-5
enum { HOLD = 1200, LOOKED_AT = 300 };

const uint32_t tissue_integrators[TISSUE_INTEGRATORS] = { DPT_INTEGRATOR_SYMPLECTIC, DPT_INTEGRATOR_EULER,
                                                          DPT_INTEGRATOR_IMPLICIT };

const dpt_segment tissue_upright = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.06 }, 0.004 };

void tissue_rig_open(struct tissue_rig *tissue)
{
    tissue_rig_open_within(tissue, 0);
}

static void open_of(struct tissue_rig *tissue, const dpt_world_def *def)
{
    memset(tissue, 0, sizeof *tissue);
    tissue->kernel = def->kernel;
    rig_open(&tissue->rig, def, NULL, NULL, 0);
}

static void open_world(struct tissue_rig *tissue, uint32_t budget, uint32_t kernel, uint32_t channels)
{
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    def.budget = budget;
    def.kernel = kernel;
    def.max_channels = channels;
    open_of(tissue, &def);
}

void tissue_rig_open_unlisted(struct tissue_rig *tissue, uint32_t channels)
{
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    def.max_contacts = 0;
    def.max_channels = channels;
    open_of(tissue, &def);
}

void tissue_rig_open_within(struct tissue_rig *tissue, uint32_t budget)
{
    open_world(tissue, budget, DPT_KERNEL_AUTO, 0);
}

void tissue_rig_open_pierced(struct tissue_rig *tissue, uint32_t channels, uint32_t budget, uint32_t kernel)
{
    open_world(tissue, budget, kernel, channels);
}

void tissue_rig_open_on(struct tissue_rig *tissue, uint32_t kernel)
{
    open_world(tissue, 0, kernel, 0);
}

struct tissue_tool *tissue_rig_open_rod(struct tissue_rig *tissue, double stiffness, double lean, double radius)
{
    const dpt_segment lying = { { 0.0, 0.0, -0.03 }, { 0.0, 0.0, 0.03 }, 0.0 };
    const double axis[3] = { 0.0, 1.0, 0.0 };
    dpt_segment segment = lean > 1.57 ? lying : tissue_upright;
    segment.radius = radius;
    tissue_rig_open(tissue);
    struct tissue_tool *rod = tissue_rig_add_tool(tissue, &segment, stiffness);
    pose_orient(&rod->device, axis, lean);
    return rod;
}

void tissue_rig_close(struct tissue_rig *tissue)
{
    rig_close(&tissue->rig);
    for (uint32_t i = 0; i < tissue->body_count; i++)
        fixture_free(&tissue->body[i].mesh);
}

struct tissue_def tissue_ball(void)
{
    return (struct tissue_def){ .shape = "sphere",
                                .triangles = 512,
                                .young = 2e4,
                                .density = 1000.0,
                                .drag = 5.0,
                                .viscosity = 1e-3,
                                .spacing = 0.02,
                                .floor = -0.02,
                                .integrator = DPT_INTEGRATOR_SYMPLECTIC };
}

struct tissue_def tissue_sheet(void)
{
    struct tissue_def def = tissue_ball();
    def.shape = "membrane";
    def.young = 1e5;
    def.border[0] = def.border[1] = 0.09;
    return def;
}

struct tissue_def tissue_asleep(uint32_t kind, uint32_t integrator)
{
    struct tissue_def def = kind == DPT_NET_SHEET ? tissue_sheet() : tissue_ball();
    def.border[0] = 0.099;
    def.border[1] = 0.0;
    def.integrator = integrator;
    def.sleeps = 1;
    return def;
}

static struct tissue_body *add_mesh(struct tissue_rig *tissue, const struct tissue_def *def)
{
    struct tissue_body *body = &tissue->body[tissue->body_count++];
    const struct tissue_arrays *arrays = def->arrays;
    const int is_sheet = !arrays && !strcmp(def->shape, "membrane");
    const dpt_spring_region below = { .kind = DPT_REGION_BOX, .fixed = 1, .box = { -1, -1, -1, 1, 1, def->floor } };
    const double x = def->border[0], y = def->border[1];
    const dpt_spring_region border[4] = { { .kind = DPT_REGION_BOX, .fixed = 1, .box = { -1, -1, -1, -x, 1, 1 } },
                                          { .kind = DPT_REGION_BOX, .fixed = 1, .box = { x, -1, -1, 1, 1, 1 } },
                                          { .kind = DPT_REGION_BOX, .fixed = 1, .box = { -1, -1, -1, 1, -y, 1 } },
                                          { .kind = DPT_REGION_BOX, .fixed = 1, .box = { -1, y, -1, 1, 1, 1 } } };
    const dpt_spring_net_def net = { .size = sizeof net,
                                     .kind = is_sheet ? DPT_NET_SHEET : DPT_NET_VOLUME,
                                     .young = def->young,
                                     .thickness = is_sheet ? 1e-3 : 0.0,
                                     .density = def->density,
                                     .drag = def->drag,
                                     .viscosity = def->viscosity,
                                     .spacing = is_sheet ? 0.0 : def->spacing,
                                     .regions = is_sheet ? border : &below,
                                     .region_count = is_sheet ? (y > 0.0 ? 4 : 2) : def->floor > -1.0 };
    dpt_mesh_info info = { .size = sizeof info };
    memcpy(body->place, def->place, sizeof body->place);
    if (!(arrays ? fixture_from_arrays_with_springs(&body->mesh, arrays->vertices, arrays->vertex_count,
                                                    arrays->corners, arrays->triangles, &net)
                 : fixture_with_springs(&body->mesh, def->shape, def->triangles, &net)))
        return NULL;
    dpt_mesh_get_info(body->mesh.mesh, &info);
    body->top = info.box_max[2];
    return body;
}

static dpt_pose pose_of(const struct tissue_body *body)
{
    dpt_pose pose = DPT_POSE_IDENTITY;
    memcpy(pose.position, body->place, sizeof pose.position);
    return pose;
}

struct tissue_body *tissue_rig_add_soft(struct tissue_rig *tissue, const struct tissue_def *def)
{
    struct tissue_body *body = add_mesh(tissue, def);
    dpt_deformable_def deform;
    dpt_springs_def springs;
    if (!body)
        return NULL;
    const dpt_pose pose = pose_of(body);
    dpt_deformable_def_init(&deform);
    dpt_springs_def_init(&springs);
    deform.mesh = springs.mesh = body->mesh.mesh;
    deform.pose = &pose;
    deform.max_points = 64;
    deform.load_radius = def->load_radius;
    deform.period = def->period;
    for (int k = 0; k < 3; k++) {
        deform.box_min[k] = -1.0;
        deform.box_max[k] = 1.0;
    }
    springs.integrator = def->integrator;
    springs.kernel = tissue->kernel;
    springs.sleep_speed = def->sleeps ? springs.sleep_speed : 0.0;
    springs.stiffness = def->stiffness > 0.0 ? def->stiffness : 1.0;
    if (def->step > 0.0) {
        dpt_mesh_info info = { .size = sizeof info };
        dpt_mesh_get_info(body->mesh.mesh, &info);
        const double share = (def->integrator == DPT_INTEGRATOR_EULER ? 0.3 : 0.35) * info.stable_step / def->step;
        springs.stiffness = fmin(fmax(share * share, 1e-9), 1e9);
    }
    body->id = rig_add_deformable(&tissue->rig, &deform);
    body->springs = rig_add_springs(&tissue->rig, &springs);
    body->block = tissue->rig.block_count - 1;
    body->bytes = dpt_springs_bytes(&springs);
    body->integrator = def->integrator;
    body->load_radius = def->load_radius;
    return body->id && body->springs ? body : NULL;
}

struct tissue_body *tissue_rig_add_mesh(struct tissue_rig *tissue, const struct tissue_def *def)
{
    return add_mesh(tissue, def);
}

struct tissue_body *tissue_rig_add_rigid(struct tissue_rig *tissue, const struct tissue_def *def)
{
    struct tissue_body *body = add_mesh(tissue, def);
    if (!body)
        return NULL;
    const dpt_pose pose = pose_of(body);
    body->id = rig_add_body(&tissue->rig, body->mesh.mesh, &pose);
    return body->id ? body : NULL;
}

struct tissue_tool *tissue_rig_add_tool(struct tissue_rig *tissue, const dpt_segment *segment, double stiffness)
{
    struct tissue_tool *tool = &tissue->tool[tissue->tool_count++];
    const dpt_pose identity = DPT_POSE_IDENTITY;
    *tool = (struct tissue_tool){ .segment = *segment,
                                  .device = identity,
                                  .stiffness = stiffness,
                                  .rho = apart(segment->a, segment->b) / sqrt(12.0),
                                  .force = { .size = sizeof tool->force } };
    tool->id = rig_add_tool(&tissue->rig, segment, 1);
    rig_set_law(&tissue->rig, tool->id, DPT_LAW_PROXY, stiffness);
    return tool;
}

void tissue_body_roughen(struct tissue_rig *tissue, const struct tissue_body *body, double static_friction,
                         double kinetic_friction)
{
    dpt_body_settings settings = { .size = sizeof settings };
    dpt_body_get_settings(tissue->rig.world, body->id, &settings);
    settings.static_friction = static_friction;
    settings.kinetic_friction = kinetic_friction;
    CHECK(dpt_body_set_settings(tissue->rig.world, body->id, &settings) == DPT_OK, "not rough");
}

void tissue_body_soften(struct tissue_rig *tissue, const struct tissue_body *body, double stiffness)
{
    dpt_body_settings settings = { .size = sizeof settings };
    dpt_body_get_settings(tissue->rig.world, body->id, &settings);
    settings.stiffness = stiffness;
    CHECK(dpt_body_set_settings(tissue->rig.world, body->id, &settings) == DPT_OK, "not soft");
}

static void set_turns(const struct tissue_rig *tissue, const struct tissue_tool *tool, double stiffness,
                      uint32_t is_locked)
{
    dpt_tool_settings settings = { .size = sizeof settings };
    dpt_tool_get_settings(tissue->rig.world, tool->id, &settings);
    settings.rotational_stiffness = stiffness;
    settings.lock_rotation = is_locked;
    const dpt_result result = dpt_tool_set_settings(tissue->rig.world, tool->id, &settings);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
}

void tissue_tool_turns(struct tissue_rig *tissue, struct tissue_tool *tool, double stiffness)
{
    set_turns(tissue, tool, stiffness, 0);
    tool->rho = sqrt(stiffness / tool->stiffness);
}

void tissue_tool_lock(struct tissue_rig *tissue, struct tissue_tool *tool)
{
    set_turns(tissue, tool, 0.0, 1);
    tool->rho = 1e3 * apart(tool->segment.a, tool->segment.b) / sqrt(12.0);
}

void tissue_rig_place(struct tissue_rig *tissue)
{
    for (uint32_t i = 0; i < tissue->tool_count; i++)
        dpt_tool_teleport(tissue->rig.world, tissue->tool[i].id, &tissue->tool[i].device);
    rig_tick(&tissue->rig);
    tissue_rig_step_world(tissue);
}

void tissue_rig_step_world(struct tissue_rig *tissue)
{
    for (uint32_t i = 0; i < tissue->tool_count; i++) {
        const dpt_result result = dpt_tool_set_pose(tissue->rig.world, tissue->tool[i].id, &tissue->tool[i].device);
        CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    }
    rig_tick(&tissue->rig);
}

void tissue_rig_step_springs(struct tissue_rig *tissue)
{
    dpt_body ids[TISSUE_BODIES];
    dpt_springs *springs[TISSUE_BODIES];
    uint32_t count = 0;
    for (uint32_t i = 0; i < tissue->body_count; i++) {
        const struct tissue_body *body = &tissue->body[tissue->is_reversed ? tissue->body_count - 1 - i : i];
        if (!body->springs)
            continue;
        tissue->info[count].size = sizeof *tissue->info;
        ids[count] = body->id;
        springs[count++] = body->springs;
    }
    tissue->result = dpt_bodies_step_springs(tissue->rig.world, ids, springs, count, tissue->rig.dt, tissue->info);
    for (uint32_t i = 0; i < tissue->tool_count; i++)
        dpt_tool_get_force_info(tissue->rig.world, tissue->tool[i].id, &tissue->tool[i].force);
}

double tissue_rig_tick(struct tissue_rig *tissue)
{
    tissue_rig_step_world(tissue);
    tissue_rig_step_springs(tissue);
    CHECK(tissue->result == DPT_OK, "%s", dpt_result_name(tissue->result));
    return length3(tissue->tool[0].force.wrench.force);
}

void tissue_rod_lower(struct tissue_rig *tissue, double depth)
{
    struct tissue_tool *rod = &tissue->tool[0];
    rod->device.position[2] = tissue->body[0].top + rod->segment.radius - depth;
}

double tissue_rod_press_and_hold(struct tissue_rig *tissue, double depth, double *mean)
{
    double last = 0.0, jump = 0.0;
    tissue_rod_lower(tissue, -0.001);
    tissue_rig_place(tissue);
    for (double at = -0.001; at < depth; at += PRESS) {
        tissue_rod_lower(tissue, at);
        tissue_rig_tick(tissue);
    }
    *mean = 0.0;
    for (int i = 0; i < HOLD; i++) {
        const double force = tissue_rig_tick(tissue);
        if (i >= HOLD - LOOKED_AT) {
            jump = fmax(jump, fabs(force - last));
            *mean += force / LOOKED_AT;
        }
        last = force;
    }
    return jump;
}

const float *tissue_vertices(const struct tissue_rig *tissue, const struct tissue_body *body, uint32_t *count)
{
    const float *positions = NULL;
    if (body->springs)
        dpt_body_get_vertices(tissue->rig.world, body->id, &positions, count);
    else
        dpt_mesh_get_vertices(body->mesh.mesh, &positions, count);
    return positions;
}

const uint32_t *tissue_corners(const struct tissue_body *body, uint32_t *triangles)
{
    *triangles = body->mesh.mesh->triangles;
    return mesh_words(body->mesh.mesh, MESH_TRIANGLES);
}

oracle_mesh *tissue_surface(const struct tissue_rig *tissue, const struct tissue_body *body)
{
    uint32_t count = 0, triangles;
    const float *positions = tissue_vertices(tissue, body, &count);
    const uint32_t *corners = tissue_corners(body, &triangles);
    CHECK(positions, "no vertices");
    return oracle_brute_open(positions, count, corners, triangles);
}

void tissue_foresee(const struct tissue_rig *tissue, const struct tissue_body *body, uint32_t substeps, double radius,
                    double *moved)
{
    static float positions[3 * TISSUE_ROOM], speeds[3 * TISSUE_ROOM];
    const double ends = body->integrator == DPT_INTEGRATOR_EULER ? 1.5 : 0.5;
    const double ahead = tissue->rig.dt * (0.5 + ends / substeps);
    const uint32_t *nodes;
    const float *weights;
    uint32_t vertices, embedded;
    tissue_vertices(tissue, body, &vertices);
    memset(moved, 0, 3 * vertices * sizeof *moved);
    if (!body->springs)
        return;
    dpt_mesh_get_embedding(body->mesh.mesh, &nodes, &weights, &embedded);
    dpt_springs_get_nodes(body->springs, dpt_springs_get_count(body->springs), positions, speeds);
    for (uint32_t i = 0; i < vertices; i++, moved += 3) {
        for (uint32_t m = 0; m < (nodes ? 4u : 1u); m++)
            for (uint32_t k = 0; k < 3; k++)
                moved[k] += ahead * (nodes ? (double)weights[4 * i + m] : 1.0) *
                            (double)speeds[3 * (nodes ? nodes[4 * i + m] : i) + k];
        const double way = length3(moved);
        for (uint32_t k = 0; k < 3 && way > 0.25 * radius; k++)
            moved[k] *= 0.25 * radius / way;
    }
}

void tissue_nodes(const struct tissue_body *body, double *at)
{
    const struct spring_slice *slices = body->springs->state[body->springs->now];
    for (uint32_t node = 0; node < dpt_springs_get_count(body->springs); node++)
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t i = LANES * k + node % LANES;
            at[3 * node + k] = (double)slices[node / LANES].x[i] + (double)slices[node / LANES].rest[i];
        }
}

double tissue_clearance(const struct tissue_rig *tissue)
{
    double largest = 0.0;
    for (uint32_t i = 0; i < tissue->body_count; i++) {
        dpt_mesh_info info = { .size = sizeof info };
        dpt_mesh_get_info(tissue->body[i].mesh.mesh, &info);
        largest = fmax(largest, apart(info.box_min, info.box_max));
    }
    return 2e-6 * fmin(largest, 1.0);
}

dpt_pose tissue_tool_last_end(const struct tissue_rig *tissue, const struct tissue_tool *tool)
{
    return proxy_of(tissue->rig.world, world_find_tool(tissue->rig.world, tool->id))->end;
}

void tissue_tool_end(const struct tissue_tool *tool, double ends[6])
{
    double middle[3], arm[3], torque[3], axis[3], turned[3];
    const dpt_wrench *wrench = &tool->force.wrench;
    pose_ends(&tool->device, &tool->segment, ends);
    for (int k = 0; k < 3; k++) {
        middle[k] = 0.5 * (ends[k] + ends[3 + k]);
        arm[k] = tool->device.position[k] - middle[k];
        axis[k] = 0.5 * (ends[3 + k] - ends[k]);
    }
    cross3(arm, wrench->force, torque);
    for (int k = 0; k < 3; k++)
        torque[k] += wrench->torque[k];
    const double size = length3(torque),
                 angle = tool->rho > 0.0 ? size / (tool->stiffness * tool->rho * tool->rho) : 0.0;
    double turn[4] = { cos(0.5 * angle), 0.0, 0.0, 0.0 };
    for (int k = 0; k < 3 && angle > 0.0; k++)
        turn[1 + k] = sin(0.5 * angle) * torque[k] / size;
    turn3(turn, axis, turned);
    for (int k = 0; k < 3; k++) {
        middle[k] += wrench->force[k] / tool->stiffness;
        ends[k] = middle[k] - turned[k];
        ends[3 + k] = middle[k] + turned[k];
    }
}
