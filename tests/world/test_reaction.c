/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What tools do to bodies is the reaction to their wrenches: sums over loads, tools and bodies that know nothing of how
 * the library splits a wrench. Random worlds of all laws, and closed forms on a box.
 *
 *     test_reaction [PER CENT]   of the worlds
 */
#include "lib/fixture.h"
#include "lib/rig.h"

enum { BODIES = 3, TOOLS = 3, LOADS_MAX = 64, SPREAD_MAX = 8192 };

static uint64_t seed = 11;

/* A sum of forces, its moment about the world's origin, and how large its parts were. */
struct sum {
    double force[3], moment[3];
    double size;
};

/* Add a force at a point, times `sign`, and a torque. */
static void add(struct sum *sum, double sign, const double at[3], const double force[3], const double torque[3])
{
    double moment[3];
    cross3(at, force, moment);
    for (int k = 0; k < 3; k++) {
        sum->force[k] += sign * force[k];
        sum->moment[k] += sign * (moment[k] + torque[k]);
    }
    sum->size += length3(force) * (1.0 + length3(at)) + length3(torque);
}

static int is_zero(const struct sum *sum)
{
    const double most = 1e-11 * sum->size;
    return length3(sum->force) <= most && length3(sum->moment) <= most;
}

#define CHECK_ZERO(sum, ...)                                                                                           \
    do {                                                                                                               \
        CHECK(is_zero(sum), __VA_ARGS__);                                                                              \
        if (!is_zero(sum))                                                                                             \
            printf("      force %g N, moment %g Nm, of %g\n", length3((sum)->force), length3((sum)->moment),           \
                   (sum)->size);                                                                                       \
    } while (0)

struct scene {
    struct fixture mesh[BODIES];
    struct rig rig;
    dpt_body body[BODIES];
    dpt_pose body_pose[BODIES]; /* of the last step */
    int is_soft[BODIES];
    dpt_tool tool[TOOLS];
    dpt_pose tool_pose[TOOLS];
    int is_free[TOOLS], is_valid[TOOLS];
    dpt_segment segments[TOOLS][2];
    uint32_t count[TOOLS];
    dpt_wrench shaped[TOOLS]; /* what the law gave, of tools with a shaper */
    uint64_t hull_block[2048];
};

static void shape(void *user, const dpt_force_info *info, double dt, dpt_wrench *wrench)
{
    (void)dt;
    *(dpt_wrench *)user = info->wrench;
    wrench->force[0] += 7.0;
    wrench->torque[1] = -3.0;
}

static void add_bodies(struct scene *scene)
{
    static const char *const shapes[] = { "sphere", "box", "membrane", "torus" };
    static const uint64_t sizes[] = { 320, 108, 512, 500 };
    for (int i = 0; i < BODIES; i++) {
        dpt_body_settings settings = { .size = sizeof settings };
        dpt_pose *pose = &scene->body_pose[i];
        const uint64_t which = random_bits(&seed) % 4;
        CHECK(fixture_from_shape(&scene->mesh[i], shapes[which], sizes[which]), "no mesh");
        *pose = (dpt_pose){ { 0.05 * i, random_in(&seed, -0.02, 0.02), 0.0 }, { 1.0, 0.0, 0.0, 0.0 } };
        random_turn(&seed, pose->orientation);
        scene->is_soft[i] = i == 0 && random_bits(&seed) % 2;
        if (scene->is_soft[i]) {
            dpt_deformable_def deform;
            dpt_deformable_def_init(&deform);
            deform.mesh = scene->mesh[i].mesh;
            deform.pose = pose;
            deform.max_points = 64;
            scene->body[i] = rig_add_deformable(&scene->rig, &deform);
        } else {
            scene->body[i] = rig_add_body(&scene->rig, scene->mesh[i].mesh, pose);
        }
        dpt_body_get_settings(scene->rig.world, scene->body[i], &settings);
        settings.static_friction = random_bits(&seed) % 2 ? 0.7 : 0.0;
        settings.kinetic_friction = 0.5 * settings.static_friction;
        settings.stiffness = random_bits(&seed) % 3 ? 0.0 : 900.0;
        dpt_body_set_settings(scene->rig.world, scene->body[i], &settings);
    }
}

static void add_tip(struct scene *scene, dpt_tool tool)
{
    double corners[3 * DPT_HULL_CORNERS_MAX];
    const dpt_hull_shape box = { .size = sizeof box, .kind = DPT_HULL_KIND_BOX, .extent = { 0.02, 0.01, 0.01 } };
    dpt_hull_def def = { .size = sizeof def, .corners = corners, .radius = 0.001 };
    dpt_tip tip = { .size = sizeof tip };
    CHECK(dpt_hull_shape_corners(&box, corners, DPT_HULL_CORNERS_MAX, &def.corner_count) == DPT_OK &&
              dpt_hull_create(scene->hull_block, sizeof scene->hull_block, &def, &tip.hull) == DPT_OK &&
              dpt_tool_set_tips(scene->rig.world, tool, &tip, 1) == DPT_OK,
          "no tip");
}

static void add_tools(struct scene *scene)
{
    for (int i = 0; i < TOOLS; i++) {
        dpt_segment *rod = scene->segments[i];
        dpt_tool_settings settings = { .size = sizeof settings };
        rod[0] = (dpt_segment){ { 0, 0, 0 }, { 0.06, 0, 0 }, random_bits(&seed) % 3 ? 0.004 : 0.0 };
        rod[1] = (dpt_segment){ { 0.06, 0, 0 }, { 0.07, 0.03, 0 }, 0.003 };
        scene->count[i] = 1 + (uint32_t)(random_bits(&seed) % 2);
        scene->tool[i] = rig_add_tool(&scene->rig, rod, scene->count[i]);
        dpt_tool_get_settings(scene->rig.world, scene->tool[i], &settings);
        settings.law = (uint32_t)(random_bits(&seed) % 3);
        settings.stiffness = random_in(&seed, 100.0, 1000.0);
        settings.damping = random_bits(&seed) % 2 ? random_in(&seed, 0.0, 2.0) : 0.0;
        settings.lock_rotation = random_bits(&seed) % 4 == 0;
        CHECK(dpt_tool_set_settings(scene->rig.world, scene->tool[i], &settings) == DPT_OK, "settings");
        if (random_bits(&seed) % 4 == 0)
            CHECK(dpt_tool_set_shaper(scene->rig.world, scene->tool[i], shape, &scene->shaped[i]) == DPT_OK, "shaper");
        else if (settings.law == DPT_LAW_PROXY && i == 0)
            add_tip(scene, scene->tool[i]);
        else
            scene->is_free[i] = (scene->count[i] == 1 || settings.law != DPT_LAW_PROXY) && random_bits(&seed) % 2;
        scene->tool_pose[i] = (dpt_pose){ { 0.05 * i, 0.0, 0.2 }, { sqrt(0.5), 0.0, sqrt(0.5), 0.0 } };
        scene->is_valid[i] = 1;
    }
}

static void open_scene(struct scene *scene)
{
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    memset(scene, 0, sizeof *scene);
    def.max_contacts = random_bits(&seed) % 2 ? 64 : random_bits(&seed) % 2 ? 2 : 0;
    def.fade = random_bits(&seed) % 2 ? 0.01 : 0.0;
    def.side_limit = 0.01;
    def.budget = random_bits(&seed) % 3 ? 0 : 400;
    rig_open(&scene->rig, &def, NULL, NULL, 0);
    add_bodies(scene);
    add_tools(scene);
}

static void close_scene(struct scene *scene)
{
    rig_close(&scene->rig);
    for (int i = 0; i < BODIES; i++)
        fixture_free(&scene->mesh[i]);
}

/* Each tool goes about the bodies, in and out of them; now and then one rests, jumps or cannot be used. */
static void move(struct scene *scene, uint64_t tick)
{
    for (int i = 0; i < TOOLS; i++) {
        dpt_pose *pose = &scene->tool_pose[i];
        const uint64_t event = random_bits(&seed) % 60;
        if (tick / 20 % 4 == 3 && event)
            continue;
        const double depth = 0.14 + 0.05 * sin(0.1 * (double)tick + i);
        pose->position[0] = 0.05 * i + 0.03 * sin(0.03 * (double)tick);
        pose->position[1] = 0.02 * cos(0.05 * (double)tick + i);
        pose->position[2] = depth + random_in(&seed, 0.0, 5e-4);
        if (event == 0)
            CHECK(dpt_tool_teleport(scene->rig.world, scene->tool[i], pose) == DPT_OK, "teleport");
        else if (scene->is_free[i]) {
            dpt_segment moved[2];
            for (uint32_t s = 0; s < scene->count[i]; s++) {
                moved[s] = scene->segments[i][s];
                for (int k = 0; k < 3; k++) {
                    moved[s].a[k] = pose->position[k] + (k == 2 ? -moved[s].a[0] : 0.3 * moved[s].a[1]);
                    moved[s].b[k] = pose->position[k] + (k == 2 ? -scene->segments[i][s].b[0] : 0.3 * moved[s].b[1]);
                }
            }
            CHECK(dpt_tool_set_segments(scene->rig.world, scene->tool[i], moved, scene->count[i]) == DPT_OK,
                  "segments");
            memcpy(pose->position, moved[0].a, sizeof moved[0].a);
        } else {
            scene->is_valid[i] = event != 1;
            dpt_tool_set_pose(scene->rig.world, scene->tool[i], scene->is_valid[i] ? pose : NULL);
        }
    }
    const int moved = (int)(random_bits(&seed) % 20);
    if (moved < BODIES) {
        scene->body_pose[moved].position[2] += random_in(&seed, -1e-3, 1e-3);
        CHECK(dpt_body_set_pose(scene->rig.world, scene->body[moved], &scene->body_pose[moved]) == DPT_OK, "pose");
    }
}

/* How often what was looked at. */
struct seen {
    uint64_t ticks, touched, several, torques, named;
};

/* A tool's wrench, before its shaper; its torque is about the point that the tool's pose is of. */
static void add_tool_wrench(const struct scene *scene, int i, double sign, struct sum *sum)
{
    dpt_force_info info = { .size = sizeof info };
    CHECK(dpt_tool_get_force_info(scene->rig.world, scene->tool[i], &info) == DPT_OK, "force");
    const dpt_wrench *wrench = info.flags & DPT_FORCE_FLAG_SHAPED ? &scene->shaped[i] : &info.wrench;
    add(sum, sign, scene->tool_pose[i].position, wrench->force, wrench->torque);
}

static void check_loads(struct scene *scene, int i, struct sum on_body[BODIES], struct seen *seen)
{
    dpt_tool_load loads[LOADS_MAX] = { { .size = sizeof *loads } };
    dpt_contact contacts[LOADS_MAX] = { { .size = sizeof *contacts } };
    uint32_t count, contact_count, bodies = 0;
    struct sum sum = { .size = 0.0 };
    CHECK(dpt_tool_get_loads(scene->rig.world, scene->tool[i], loads, LOADS_MAX, &count) == DPT_OK &&
              count <= LOADS_MAX,
          "%u loads", count);
    dpt_tool_get_contacts(scene->rig.world, scene->tool[i], contacts, LOADS_MAX, &contact_count);
    for (uint32_t l = 0; l < count; l++) {
        const dpt_tool_load *load = &loads[l];
        uint32_t known = 0, body = 0;
        while (body < BODIES && scene->body[body] != load->body)
            body++;
        CHECK(body < BODIES, "a load on body %u", load->body);
        add(&sum, 1.0, load->point, load->force, load->torque);
        add(&on_body[body % BODIES], -1.0, load->point, load->force, load->torque);
        for (uint32_t k = 0; k < contact_count; k++)
            known |= contacts[k].id == load->contact && contacts[k].body == load->body &&
                     contacts[k].segment == load->segment;
        CHECK(known || !load->contact, "contact %u is not listed", load->contact);
        seen->named += known;
        seen->torques += length3(load->torque) > 1e-9;
        bodies |= 1u << body;
    }
    seen->touched += count > 0;
    seen->several += (bodies & (bodies - 1)) != 0;
    add_tool_wrench(scene, i, -1.0, &sum);
    CHECK_ZERO(&sum, "the loads of tool %d are not its wrench", i);
}

/* What a body tells is what the loads are, by all tools and by each of them; of a deformable one, what its vertices get. */
static void check_body(const struct scene *scene, int i, const struct sum *of_loads)
{
    struct sum by_tool = *of_loads, by_all = *of_loads;
    dpt_wrench wrench;
    for (int t = 0; t < TOOLS; t++) {
        CHECK(dpt_tool_get_body_wrench(scene->rig.world, scene->tool[t], scene->body[i], &wrench) == DPT_OK, "wrench");
        add(&by_tool, -1.0, scene->body_pose[i].position, wrench.force, wrench.torque);
    }
    CHECK(dpt_body_get_wrench(scene->rig.world, scene->body[i], &wrench) == DPT_OK, "wrench");
    add(&by_all, -1.0, scene->body_pose[i].position, wrench.force, wrench.torque);
    CHECK_ZERO(&by_tool, "body %d, by tool", i);
    CHECK_ZERO(&by_all, "body %d", i);
    if (!scene->is_soft[i])
        return;
    dpt_load *loads = malloc(SPREAD_MAX * sizeof *loads);
    uint32_t count;
    const dpt_result result = dpt_body_get_loads(scene->rig.world, scene->body[i], loads, SPREAD_MAX, &count);
    double unbalanced[3] = { wrench.force[0], wrench.force[1], wrench.force[2] }, size = length3(unbalanced);
    for (uint32_t l = 0; result == DPT_OK && l < count; l++) {
        const double *f = loads[l].force;
        double turned[3];
        turn3(scene->body_pose[i].orientation, f, turned);
        for (int k = 0; k < 3; k++)
            unbalanced[k] -= turned[k];
        size += length3(f);
    }
    CHECK(result != DPT_OK || length3(unbalanced) <= 1e-9 * size, "vertices: %g of %g N", length3(unbalanced), size);
    free(loads);
}

static void check_tick(struct scene *scene, struct seen *seen)
{
    struct sum all = { .size = 0.0 }, on_body[BODIES] = { { .size = 0.0 } };
    for (int i = 0; i < TOOLS; i++) {
        check_loads(scene, i, on_body, seen);
        add_tool_wrench(scene, i, 1.0, &all);
    }
    for (int i = 0; i < BODIES; i++) {
        dpt_wrench wrench;
        check_body(scene, i, &on_body[i]);
        dpt_body_get_wrench(scene->rig.world, scene->body[i], &wrench);
        add(&all, 1.0, scene->body_pose[i].position, wrench.force, wrench.torque);
    }
    CHECK_ZERO(&all, "tools and bodies do not sum up to zero");
    seen->ticks++;
}

static void what_tools_do_to_bodies_is_the_reaction_to_their_wrenches(void)
{
    const uint64_t worlds = part_of(150);
    struct seen seen = { .ticks = 0 };
    for (uint64_t w = 0; w < worlds && check_bad < 10; w++) {
        struct scene *scene = malloc(sizeof *scene);
        open_scene(scene);
        for (uint64_t tick = 0; tick < 160 && check_bad < 10; tick++) {
            move(scene, tick);
            rig_tick(&scene->rig);
            check_tick(scene, &seen);
        }
        close_scene(scene);
        free(scene);
    }
    printf(
        "    %llu ticks; tools with loads %llu, on several bodies %llu; loads with a torque %llu, in a contact %llu\n",
        (unsigned long long)seen.ticks, (unsigned long long)seen.touched, (unsigned long long)seen.several,
        (unsigned long long)seen.torques, (unsigned long long)seen.named);
    CHECK(seen.touched >= least_seen(10000) && seen.several >= least_seen(500) && seen.torques >= least_seen(500) &&
              seen.named >= least_seen(2000),
          "too little was seen");
}

/* A box of 0.1 m about its frame's origin, and one tool, pressed onto its top by `depth`. */
struct press {
    struct fixture mesh;
    struct rig rig;
    double top;
};

static void open_press(struct press *press, uint32_t law, const dpt_segment *segment, const double at[3])
{
    dpt_world_def def = rig_def(law);
    dpt_mesh_info info = { .size = sizeof info };
    const dpt_pose pose = { { at[0], at[1], at[2] }, { 1.0, 0.0, 0.0, 0.0 } };
    def.max_contacts = 8;
    CHECK(fixture_from_shape(&press->mesh, "box", 12), "no box");
    dpt_mesh_get_info(press->mesh.mesh, &info);
    press->top = at[2] + info.box_max[2];
    rig_open(&press->rig, &def, NULL, segment, 1);
    rig_add_body(&press->rig, press->mesh.mesh, &pose);
}

static void press_to(struct press *press, double x, double y, double above)
{
    press->rig.device = (dpt_pose){ { x, y, press->top + above }, { 1.0, 0.0, 0.0, 0.0 } };
    rig_step(&press->rig);
}

static void close_press(struct press *press)
{
    rig_close(&press->rig);
    fixture_free(&press->mesh);
}

/* A ball of 5 mm, pressed by 2 mm at 500 N/m: 1 N down, and the body's torque is the moment of that about its frame. */
static void a_ball_pushes_a_box_down_where_it_touches(void)
{
    static const dpt_segment ball = { { 0, 0, 0 }, { 0, 0, 0 }, 0.005 };
    const double at[3] = { 0.3, -0.2, 0.1 };
    for (uint32_t law = DPT_LAW_POINT; law <= DPT_LAW_PROXY; law += DPT_LAW_PROXY - DPT_LAW_POINT) {
        struct press press;
        dpt_tool_load load = { .size = sizeof load };
        dpt_wrench wrench;
        uint32_t count;
        open_press(&press, law, &ball, at);
        press_to(&press, at[0] + 0.01, at[1] + 0.02, 0.02);
        CHECK(dpt_body_get_wrench(press.rig.world, press.rig.body, &wrench) == DPT_OK && length3(wrench.force) == 0.0 &&
                  length3(wrench.torque) == 0.0,
              "it touches nothing");
        for (int i = 0; i < 5; i++)
            press_to(&press, at[0] + 0.01, at[1] + 0.02, 0.003);
        dpt_body_teleport(press.rig.world, press.rig.body, NULL);
        CHECK(dpt_body_get_wrench(press.rig.world, press.rig.body, &wrench) == DPT_OK, "wrench");
        const double want[6] = { 0.0, 0.0, -1.0, -0.02, 0.01, 0.0 };
        for (int k = 0; k < 3; k++)
            CHECK(fabs(wrench.force[k] - want[k]) < 1e-3 && fabs(wrench.torque[k] - want[3 + k]) < 1e-4,
                  "law %u, axis %d: %g N, %g Nm", law, k, wrench.force[k], wrench.torque[k]);
        CHECK(dpt_tool_get_loads(press.rig.world, press.rig.tool, &load, 1, &count) == DPT_OK && count >= 1, "loads");
        CHECK(load.body == press.rig.body && load.segment == 0 && load.contact && load.force[2] > 0.0 &&
                  fabs(load.point[0] - at[0] - 0.01) < 1e-6 && fabs(load.point[1] - at[1] - 0.02) < 1e-6 &&
                  length3(load.torque) < 1e-6,
              "law %u: body %u, at %g %g, torque %g", law, load.body, load.point[0], load.point[1],
              length3(load.torque));
        close_press(&press);
    }
}

/* A bed of K N/m^2 over 40 mm in the box's middle, 1 mm deep: the load is in the middle of the rod, and lifts it alone. */
static void a_rod_in_a_bed_is_lifted_in_its_middle(void)
{
    static const dpt_segment rod = { { -0.01, 0, 0 }, { 0.03, 0, 0 }, 0.004 };
    const double at[3] = { 0.0, 0.0, 0.0 };
    struct press press;
    dpt_tool_load load = { .size = sizeof load };
    dpt_wrench wrench, on_body;
    uint32_t count;
    open_press(&press, DPT_LAW_BED, &rod, at);
    for (int i = 0; i < 5; i++)
        press_to(&press, 0.0, 0.005, 0.003);
    wrench = press.rig.force.wrench;
    CHECK(dpt_body_get_wrench(press.rig.world, press.rig.body, &on_body) == DPT_OK, "wrench");
    CHECK(dpt_tool_get_loads(press.rig.world, press.rig.tool, &load, 1, &count) == DPT_OK && count == 1, "%u loads",
          count);
    CHECK(wrench.force[2] > 0.0 && fabs(on_body.force[2] + wrench.force[2]) < 1e-12, "force");
    CHECK(fabs(load.point[0] - 0.01) < 1e-3 && fabs(load.point[1] - 0.005) < 1e-4, "at %g %g", load.point[0],
          load.point[1]);
    CHECK(fabs(on_body.torque[0] + 0.005 * wrench.force[2]) < 1e-6 * wrench.force[2], "torque %g", on_body.torque[0]);
    close_press(&press);
}

/* A rod that lies on the box is held at both ends of what touches it, also once it is not searched for any more. */
static void a_tool_at_rest_keeps_its_loads(void)
{
    static const dpt_segment rod = { { -0.02, 0, 0 }, { 0.03, 0, 0 }, 0.004 };
    const double at[3] = { 0.0, 0.0, 0.0 };
    struct press press;
    dpt_tool_load first[8] = { { .size = sizeof *first } }, last[8] = { { .size = sizeof *last } };
    uint32_t first_count, last_count;
    open_press(&press, DPT_LAW_PROXY, &rod, at);
    press_to(&press, 0.0, 0.005, 0.02);
    for (int i = 0; i < 4; i++)
        press_to(&press, 0.0, 0.005, 0.003);
    dpt_tool_get_loads(press.rig.world, press.rig.tool, first, 8, &first_count);
    for (int i = 0; i < 20; i++)
        press_to(&press, 0.0, 0.005, 0.003);
    dpt_tool_get_loads(press.rig.world, press.rig.tool, last, 8, &last_count);
    CHECK(press.rig.hit.work == 0, "it does not rest");
    CHECK(first_count >= 2 && last_count == first_count, "%u loads, then %u", first_count, last_count);
    for (uint32_t l = 0; l < first_count && l < last_count; l++)
        CHECK(fabs(first[l].point[0] - last[l].point[0]) < 1e-6 && first[l].force[2] > 0.0 && last[l].force[2] > 0.0,
              "load %u at %g, then at %g", l, first[l].point[0], last[l].point[0]);
    close_press(&press);
}

/* What is not there is told as such, and an answer stays that of the step. */
static void handles_and_lists_are_checked(void)
{
    static const dpt_segment ball = { { 0, 0, 0 }, { 0, 0, 0 }, 0.005 };
    const double at[3] = { 0.0, 0.0, 0.0 };
    struct press press;
    dpt_tool_load load = { .size = sizeof load };
    dpt_wrench wrench = { { 1, 1, 1 }, { 1, 1, 1 } };
    uint32_t count = 7;
    open_press(&press, DPT_LAW_PROXY, &ball, at);
    press_to(&press, 0.0, 0.0, 0.02);
    press_to(&press, 0.0, 0.0, 0.003);
    CHECK(dpt_body_get_wrench(press.rig.world, press.rig.tool, &wrench) == DPT_E_HANDLE && wrench.force[0] == 0.0,
          "a tool's id");
    CHECK(dpt_tool_get_body_wrench(press.rig.world, press.rig.body, press.rig.body, &wrench) == DPT_E_HANDLE,
          "a body's id");
    CHECK(dpt_tool_get_loads(press.rig.world, press.rig.tool, NULL, 0, &count) == DPT_OK && count > 0, "%u", count);
    CHECK(dpt_tool_get_loads(press.rig.world, press.rig.tool, NULL, 1, &count) == DPT_E_ARGUMENT && count == 0,
          "no room");
    load.size = 3;
    CHECK(dpt_tool_get_loads(press.rig.world, press.rig.tool, &load, 1, &count) == DPT_E_SIZE, "size");
    CHECK(dpt_tool_teleport(press.rig.world, press.rig.tool, NULL) != DPT_OK, "no pose");
    CHECK(dpt_world_reset(press.rig.world) == DPT_OK &&
              dpt_body_get_wrench(press.rig.world, press.rig.body, &wrench) == DPT_OK && length3(wrench.force) == 0.0,
          "after a reset nothing is pushed");
    close_press(&press);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(what_tools_do_to_bodies_is_the_reaction_to_their_wrenches);
    TEST(a_ball_pushes_a_box_down_where_it_touches);
    TEST(a_rod_in_a_bed_is_lifted_in_its_middle);
    TEST(a_tool_at_rest_keeps_its_loads);
    TEST(handles_and_lists_are_checked);
    return check_report();
}
