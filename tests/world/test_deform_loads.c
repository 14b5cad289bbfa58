/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The loads of tools on a deformable body are the reaction to their wrenches: forces and moments sum up to zero, for all
 * laws. Where they are: on vertices near the tool alone. What tissue makes of them is physics, and not judged here.
 *
 *     test_deform_loads [PER CENT]   of the ticks
 */
#include "world/deform_scene.h"

enum { LOADS_MAX = 8192 };

static uint64_t seed = 3;

/* A rod that pushes into a breathing sphere. */
struct push {
    struct deform_scene scene;
    dpt_pose body, tool;
    dpt_tool second; /* 0: there is none */
    dpt_pose second_pose;
    dpt_load loads[LOADS_MAX];
    uint32_t count;
    double *positions; /* the vertices of the last step */
};

static const dpt_segment rod[] = { { { 0.0, 0.0, 0.0 }, { 0.08, 0.0, 0.0 }, 0.004 },
                                   { { 0.08, 0.0, 0.0 }, { 0.1, 0.03, 0.0 }, 0.003 } };

/* What a user may set, drawn anew. */
static void vary_settings(const struct push *push, uint32_t law)
{
    dpt_tool_settings tool = { .size = sizeof tool };
    dpt_body_settings body = { .size = sizeof body };
    dpt_tool_get_settings(push->scene.rig.world, push->scene.rig.tool, &tool);
    tool.law = law;
    tool.stiffness = random_in(&seed, 100.0, 1000.0);
    tool.damping = random_bits(&seed) % 2 ? random_in(&seed, 0.0, 2.0) : 0.0;
    tool.lock_rotation = law == DPT_LAW_PROXY && random_bits(&seed) % 4 == 0;
    CHECK(dpt_tool_set_settings(push->scene.rig.world, push->scene.rig.tool, &tool) == DPT_OK, "tool");
    dpt_body_get_settings(push->scene.rig.world, push->scene.rig.body, &body);
    body.static_friction = random_bits(&seed) % 2 ? 0.6 : 0.0;
    body.kinetic_friction = 0.5 * body.static_friction;
    body.stiffness = random_bits(&seed) % 3 ? 0.0 : 800.0;
    CHECK(dpt_body_set_settings(push->scene.rig.world, push->scene.rig.body, &body) == DPT_OK, "body");
}

static int open_push(struct push *push, uint32_t law, double load_radius, uint32_t segments, double fade)
{
    dpt_world_def def = rig_def(law);
    dpt_deformable_def deform;
    dpt_deformable_def_init(&deform);
    deform.load_radius = load_radius;
    def.fade = fade;
    memset(push, 0, sizeof *push);
    if (!deform_scene_open(&push->scene, "sphere", 1280, &def, &deform))
        return 0;
    push->scene.kind = DEFORM_BREATH;
    push->scene.step = 2e-4;
    rig_add_tool(&push->scene.rig, rod, segments);
    push->positions = malloc(3 * sizeof *push->positions * (size_t)push->scene.vertices);
    push->body = pose_any(&seed, 0.3);
    CHECK(dpt_body_teleport(push->scene.rig.world, push->scene.rig.body, &push->body) == DPT_OK, "pose");
    vary_settings(push, law);
    return 1;
}

static void close_push(struct push *push)
{
    free(push->positions);
    deform_scene_close(&push->scene);
}

/* The rod comes from above, in the body's frame, leans a little, and is `depth` in the sphere of 0.1 m. */
static void place_tool(struct push *push, double depth, double lean)
{
    const double half = 0.5 * lean, along_z[4] = { sqrt(0.5), 0.0, -sqrt(0.5), 0.0 };
    const double turn[4] = { cos(half), sin(half), 0.0, 0.0 }, up[3] = { 0.0, 0.0, 0.1 - depth };
    double local[4], *q = push->tool.orientation, *p = push->body.orientation;
    for (int k = 0; k < 4; k++)
        local[k] = 0.0;
    local[0] = turn[0] * along_z[0] - turn[1] * along_z[1];
    local[1] = turn[0] * along_z[1] + turn[1] * along_z[0];
    local[2] = turn[0] * along_z[2] - turn[1] * along_z[3];
    local[3] = turn[0] * along_z[3] + turn[1] * along_z[2];
    q[0] = p[0] * local[0] - p[1] * local[1] - p[2] * local[2] - p[3] * local[3];
    q[1] = p[0] * local[1] + p[1] * local[0] + p[2] * local[3] - p[3] * local[2];
    q[2] = p[0] * local[2] - p[1] * local[3] + p[2] * local[0] + p[3] * local[1];
    q[3] = p[0] * local[3] + p[1] * local[2] - p[2] * local[1] + p[3] * local[0];
    turn3(push->body.orientation, up, push->tool.position);
    for (int k = 0; k < 3; k++)
        push->tool.position[k] += push->body.position[k];
    dpt_tool_set_pose(push->scene.rig.world, push->scene.rig.tool, &push->tool);
}

static void step_push(struct push *push)
{
    const float *positions;
    uint32_t count;
    rig_tick(&push->scene.rig);
    dpt_body_get_vertices(push->scene.rig.world, push->scene.rig.body, &positions, &count);
    for (size_t i = 0; i < 3 * (size_t)count; i++)
        push->positions[i] = (double)positions[i];
}

/* Add a tool's wrench, about the world's origin. Returns its force, N. */
static double add_wrench(const struct push *push, dpt_tool tool, const dpt_pose *pose, double sum[3], double moment[3])
{
    dpt_force_info force = { .size = sizeof force };
    double about[3];
    dpt_tool_get_force_info(push->scene.rig.world, tool, &force);
    cross3(pose->position, force.wrench.force, about);
    for (int k = 0; k < 3; k++) {
        sum[k] += force.wrench.force[k];
        moment[k] += about[k] + force.wrench.torque[k];
    }
    return sqrt(force.wrench.force[0] * force.wrench.force[0] + force.wrench.force[1] * force.wrench.force[1] +
                force.wrench.force[2] * force.wrench.force[2]);
}

/* Loads and wrenches about the world's origin. Returns the force of all tools, N. */
static double check_balance(struct push *push, const char *name)
{
    double sum[3] = { 0.0 }, moment[3] = { 0.0 }, at[3], load[3], part[3], peak = 0.0, arm = 0.0, worst = 0.0;
    const dpt_result result =
        dpt_body_get_loads(push->scene.rig.world, push->scene.rig.body, push->loads, LOADS_MAX, &push->count);
    CHECK(result == DPT_OK, "%s: %s", name, dpt_result_name(result));
    double force = add_wrench(push, push->scene.rig.tool, &push->tool, sum, moment);
    if (push->second)
        force += add_wrench(push, push->second, &push->second_pose, sum, moment);
    for (uint32_t i = 0; i < push->count; i++) {
        turn3(push->body.orientation, push->positions + 3 * (size_t)push->loads[i].vertex, at);
        turn3(push->body.orientation, push->loads[i].force, load);
        for (int k = 0; k < 3; k++)
            at[k] += push->body.position[k];
        cross3(at, load, part);
        for (int k = 0; k < 3; k++) {
            sum[k] += load[k];
            moment[k] += part[k];
            peak = fmax(peak, fabs(load[k]));
            arm = fmax(arm, fabs(at[k]));
        }
    }
    for (int k = 0; k < 3; k++)
        worst = fmax(worst, fmax(fabs(sum[k]), fabs(moment[k]) / (1.0 + arm)));
    peak = fmax(peak, force);
    CHECK(worst <= 1e-12 * peak + 1e-15, "%s: %g N of %g are left", name, worst, peak);
    return force;
}

/* m: no load is farther from the tool's axis, where that is now. */
static void check_nearness(const struct push *push, double reach, const char *name)
{
    for (uint32_t i = 0; i < push->count; i++) {
        double at[3], square = 0.0, u[3], along_axis = 0.0;
        const double x[3] = { 1.0, 0.0, 0.0 };
        turn3(push->body.orientation, push->positions + 3 * (size_t)push->loads[i].vertex, at);
        turn3(push->tool.orientation, x, u);
        for (int k = 0; k < 3; k++) {
            at[k] += push->body.position[k] - push->tool.position[k];
            along_axis += at[k] * u[k];
        }
        along_axis = fmin(fmax(along_axis, 0.0), 0.1);
        for (int k = 0; k < 3; k++)
            square += (at[k] - along_axis * u[k]) * (at[k] - along_axis * u[k]);
        CHECK(sqrt(square) <= reach, "%s: %g m away", name, sqrt(square));
    }
}

static const char *const law_names[] = { "point", "bed", "proxy" };

static void push_with(uint32_t law, double load_radius, uint32_t segments)
{
    static struct push push;
    const char *name = law_names[law];
    double largest = 0.0;
    uint64_t acted = 0;
    if (!open_push(&push, law, load_radius, segments, 0.0))
        return;
    for (uint64_t tick = 0; tick < part_of(400); tick++) {
        const double depth = 0.016 * sin(0.04 * (double)tick) - 0.007;
        if (tick % 2) {
            deform_scene_advance(&push.scene);
            deform_scene_set(&push.scene, DEFORM_WHOLE);
        }
        place_tool(&push, depth, 0.3 * sin(0.013 * (double)tick));
        step_push(&push);
        const double force = check_balance(&push, name);
        largest = fmax(largest, force);
        acted += force > 0.0;
        CHECK(force == 0.0 || push.count, "%s: a force without loads", name);
        check_nearness(&push, 0.035 + load_radius, name);
    }
    CHECK(acted > least_seen(40) && largest > 0.1, "%s: %u ticks, %g N", name, (unsigned)acted, largest);
    close_push(&push);
}

static void loads_are_the_reaction(void)
{
    for (uint32_t law = 0; law < 3; law++)
        for (int k = 0; k < 6; k++)
            push_with(law, k % 3 * 0.01, law == DPT_LAW_PROXY ? 1 + (uint32_t)k % 2 : 1);
}

/* Two proxies at once, one of which is thrown through the body; forces that fade have their loads, too. */
static void two_tools_have_their_loads(void)
{
    static struct push push;
    uint64_t faded = 0;
    if (!open_push(&push, DPT_LAW_PROXY, 0.01, 1, 0.01))
        return;
    push.second = rig_add_tool(&push.scene.rig, rod, 1);
    for (uint64_t tick = 0; tick < part_of(400); tick++) {
        dpt_force_info force = { .size = sizeof force };
        place_tool(&push, 0.012 * sin(0.05 * (double)tick) - 0.004, 0.1);
        push.second_pose = push.tool;
        for (int k = 0; k < 3; k++)
            push.second_pose.position[k] += 0.02 * sin(0.03 * (double)tick + k) + (tick % 40 == 20 ? 0.05 : 0.0);
        dpt_tool_set_pose(push.scene.rig.world, push.second, &push.second_pose);
        deform_scene_advance(&push.scene);
        deform_scene_set(&push.scene, DEFORM_WHOLE);
        step_push(&push);
        check_balance(&push, "two tools");
        dpt_tool_get_force_info(push.scene.rig.world, push.second, &force);
        faded += force.flags & DPT_FORCE_FLAG_FADING ? 1 : 0;
        if (tick % 100 == 99) {
            dpt_tool_settings settings = { .size = sizeof settings };
            dpt_tool_get_settings(push.scene.rig.world, push.second, &settings);
            settings.law = tick % 200 == 99 ? DPT_LAW_BED : DPT_LAW_PROXY;
            dpt_tool_set_settings(push.scene.rig.world, push.second, &settings);
        }
    }
    printf("    %u ticks in which a force faded\n", (unsigned)faded);
    close_push(&push);
}

/* One point for two tools: what is missing is told. */
static void too_few_points_are_told(void)
{
    static struct push push;
    dpt_deformable_def def;
    dpt_deformable_def_init(&def);
    def.max_points = 1;
    dpt_result result = DPT_OK;
    memset(&push, 0, sizeof push);
    if (!deform_scene_open(&push.scene, "sphere", 1280, NULL, &def))
        return;
    for (int t = 0; t < 2; t++)
        dpt_tool_add(push.scene.rig.world, rod, 1, t ? &push.second : &push.scene.rig.tool);
    push.body = push.second_pose = (dpt_pose)DPT_POSE_IDENTITY;
    for (int tick = 0; tick < 20 && result == DPT_OK; tick++) {
        place_tool(&push, -0.01 + 1e-3 * tick, 0.0);
        push.second_pose = push.tool;
        push.second_pose.position[0] += 0.02;
        dpt_tool_set_pose(push.scene.rig.world, push.second, &push.second_pose);
        rig_tick(&push.scene.rig);
        result = dpt_body_get_loads(push.scene.rig.world, push.scene.rig.body, push.loads, LOADS_MAX, &push.count);
    }
    CHECK(result == DPT_E_FULL && push.count < LOADS_MAX, "%s, %u loads", dpt_result_name(result), push.count);
    deform_scene_close(&push.scene);
}

static void turn_freely(struct push *push)
{
    dpt_tool_settings tool = { .size = sizeof tool };
    dpt_tool_get_settings(push->scene.rig.world, push->scene.rig.tool, &tool);
    tool.lock_rotation = 0;
    CHECK(dpt_tool_set_settings(push->scene.rig.world, push->scene.rig.tool, &tool) == DPT_OK, "tool");
}

/* A proxy that starts again has no points, but its force fades: until it has, the tissue feels it. */
static void a_force_that_fades_has_loads(void)
{
    uint32_t fading = 0;
    double largest = 0.0;
    for (int k = 0; k < 8; k++) {
        static struct push push;
        dpt_force_info report = { .size = sizeof report };
        if (!open_push(&push, DPT_LAW_PROXY, k % 2 * 0.01, 1, 0.01))
            return;
        turn_freely(&push);
        place_tool(&push, -0.01, 1.5);
        step_push(&push);
        for (int tick = 0; tick < 30; tick++) {
            place_tool(&push, 0.003 + 1e-4 * tick, tick < 15 ? 1.5 : 3.0);
            step_push(&push);
            const double force = check_balance(&push, "fade");
            dpt_tool_get_force_info(push.scene.rig.world, push.scene.rig.tool, &report);
            if (tick < 15 || !(report.flags & DPT_FORCE_FLAG_FADING))
                continue;
            fading++;
            largest = fmax(largest, force);
            CHECK(force == 0.0 || push.count, "a force of %g N without loads", force);
        }
        close_push(&push);
    }
    CHECK(fading > 20 && largest > 0.1, "%u ticks fade, %g N", fading, largest);
}

/* Loads are of the last step, whatever was set after it. */
static void loads_are_of_the_last_step(void)
{
    static struct push push, other;
    if (!open_push(&push, DPT_LAW_PROXY, 0.01, 1, 0.0))
        return;
    place_tool(&push, -0.01, 0.1);
    step_push(&push);
    for (int k = 0; k < 5; k++) {
        place_tool(&push, 0.004, 0.1);
        step_push(&push);
    }
    CHECK(check_balance(&push, "before") > 0.1, "no force");
    other = push;
    for (int k = 0; k < 2; k++) {
        deform_scene_advance(&push.scene);
        deform_scene_set(&push.scene, k ? DEFORM_LIST : DEFORM_RANGES);
    }
    const dpt_pose elsewhere = pose_any(&seed, 0.3);
    dpt_body_set_pose(push.scene.rig.world, push.scene.rig.body, &elsewhere);
    check_balance(&push, "after");
    CHECK(other.count == push.count && !memcmp(other.loads, push.loads, push.count * sizeof(dpt_load)),
          "%u loads, then %u", other.count, push.count);
    uint32_t count = 0;
    CHECK(dpt_body_get_loads(push.scene.rig.world, push.scene.rig.body, push.loads, push.count - 1, &count) ==
                  DPT_E_FULL &&
              count == push.count,
          "%u of %u", count, push.count);
    CHECK(dpt_body_get_loads(push.scene.rig.world, push.scene.rig.body, NULL, 0, &count) == DPT_E_FULL &&
              count == push.count,
          "%u of %u", count, push.count);
    close_push(&push);
}

/* A sphere in one tetrahedron, whose nodes shear and shrink it. */
static const double cage[4][3] = { { -1.0, -1.0, -1.0 }, { 1.5, -0.8, -0.7 }, { -0.2, 1.5, -0.6 }, { 0.1, 0.1, 1.4 } };

static int compile_caged(struct fixture *fixture)
{
    static const uint32_t cell[4] = { 0, 1, 2, 3 };
    dpt_compile_def def;
    dpt_diag diag = { .size = sizeof diag };
    struct shape shape;
    shape_reason reason;
    CHECK(!shape_make("sphere", 1280, 0, &shape, reason), "%s", reason);
    dpt_compile_def_init(&def);
    def.nodes = &cage[0][0];
    def.node_count = 4;
    def.cells = cell;
    def.cell_count = 1;
    dpt_result result = dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count,
                                           &def, &fixture->compiled, &diag);
    shape_free(&shape);
    if (result == DPT_OK)
        result = dpt_mesh_open(fixture->compiled.bytes, fixture->compiled.size, &fixture->mesh);
    CHECK(result == DPT_OK, "%s", diag.text);
    return result == DPT_OK;
}

/* Where an affine map of the cage puts a point: it shrinks to `size` and leans by `lean`. */
static void map_point(double size, double lean, const double x[3], double y[3])
{
    y[0] = size * x[0] + lean * x[2];
    y[1] = size * x[1];
    y[2] = size * x[2];
}

static void nodes_move_vertices_and_get_their_loads(void)
{
    static dpt_load loads[LOADS_MAX];
    struct deform_scene scene;
    const dpt_segment pin = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.1 }, 0.004 };
    dpt_pose pose = { { 0.01, 0.0, 0.12 }, { 1.0, 0.0, 0.0, 0.0 } };
    const float *positions;
    uint32_t count;
    memset(&scene, 0, sizeof scene);
    if (!compile_caged(&scene.fixture) || !deform_scene_open_mesh(&scene, NULL, NULL))
        return;
    rig_add_tool(&scene.rig, &pin, 1);
    for (int tick = 0; tick < 60; tick++) {
        const double size = 1.0 - 1e-3 * tick, lean = 2e-3 * tick;
        dpt_force_info force = { .size = sizeof force };
        float nodes[12];
        double off = 0.0, sum[3];
        for (int n = 0; n < 4; n++) {
            double y[3];
            map_point(size, lean, cage[n], y);
            for (int k = 0; k < 3; k++)
                nodes[3 * n + k] = (float)y[k];
        }
        CHECK(dpt_body_set_nodes(scene.rig.world, scene.rig.body, nodes) == DPT_OK, "nodes");
        pose.position[2] -= 8e-4;
        rig_step_to(&scene.rig, &pose);
        dpt_body_get_vertices(scene.rig.world, scene.rig.body, &positions, &count);
        for (uint32_t v = 0; v < count; v++) {
            const double x[3] = { (double)scene.rest[3 * v], (double)scene.rest[3 * v + 1],
                                  (double)scene.rest[3 * v + 2] };
            double y[3];
            map_point(size, lean, x, y);
            for (uint32_t k = 0; k < 3; k++)
                off = fmax(off, fabs(y[k] - (double)positions[3 * v + k]));
        }
        CHECK(off < 1e-6, "a vertex is %g m off", off);
        dpt_tool_get_force_info(scene.rig.world, scene.rig.tool, &force);
        CHECK(dpt_body_get_node_loads(scene.rig.world, scene.rig.body, loads, LOADS_MAX, &count) == DPT_OK, "%u loads",
              count);
        memcpy(sum, force.wrench.force, sizeof sum);
        for (uint32_t i = 0; i < count; i++)
            for (int k = 0; k < 3; k++)
                sum[k] += loads[i].vertex < 4 ? loads[i].force[k] : HUGE_VAL;
        for (int k = 0; k < 3; k++)
            CHECK(fabs(sum[k]) <= 1e-6 * (1.0 + fabs(force.wrench.force[2])), "%g N are left", sum[k]);
        CHECK(tick < 50 || force.wrench.force[2] > 1.0, "%g N", force.wrench.force[2]);
    }
    CHECK(dpt_body_get_node_loads(scene.rig.world, scene.rig.body, loads, 3, &count) == DPT_E_FULL, "room for three");
    deform_scene_close(&scene);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(loads_are_the_reaction);
    TEST(two_tools_have_their_loads);
    TEST(too_few_points_are_told);
    TEST(a_force_that_fades_has_loads);
    TEST(loads_are_of_the_last_step);
    TEST(nodes_move_vertices_and_get_their_loads);
    return check_report();
}
