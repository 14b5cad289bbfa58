/* SPDX-License-Identifier: BSD-3-Clause */
#include "track/near_pair.h"

#include "lib/solid.h"

static const struct {
    const char *name;
    uint64_t triangles;
    double at[3];
} shapes[NEAR_BODIES] = { { "liver", 2692, { 0, 0, 0 } },
                          { "torus", 1000, { 0.25, 0.05, 0.1 } },
                          { "membrane", 0, { 0, 0, 0.25 } } };

int near_solids_open(struct solid solids[NEAR_BODIES])
{
    for (int i = 0; i < NEAR_BODIES; i++)
        if (!solid_from_shape(&solids[i], shapes[i].name, shapes[i].triangles))
            return 0;
    return 1;
}

static void open_world(struct near_pair *pair, struct near_world *made, const dpt_world_def *def, int near_only)
{
    dpt_tool_settings settings = { .size = sizeof settings };
    rig_open(&made->rig, def, NULL, pair->segments, NEAR_SEGMENTS);
    for (int i = 0; i < NEAR_BODIES; i++)
        made->body[i] = rig_add_body(&made->rig, pair->solids[i].mesh, &pair->body_pose[i]);
    dpt_tool_teleport(made->rig.world, made->rig.tool, &pair->pose);
    dpt_tool_get_settings(made->rig.world, made->rig.tool, &settings);
    settings.near_only = (uint32_t)near_only;
    CHECK(dpt_tool_set_settings(made->rig.world, made->rig.tool, &settings) == DPT_OK, "near_only");
}

/* A line that bends: 0.4 m in all. */
static void bend_segments(struct near_pair *pair)
{
    double at[3] = { 0, 0, 0 }, way[3] = { 0, 0, 1 };
    for (int i = 0; i < NEAR_SEGMENTS; i++) {
        dpt_segment *segment = &pair->segments[i];
        segment->radius = i % 3 ? 0.001 : 0.002;
        memcpy(segment->a, at, sizeof at);
        for (int k = 0; k < 3; k++)
            way[k] += random_in(&pair->seed, -0.3, 0.3);
        unit3(way);
        for (int k = 0; k < 3; k++)
            segment->b[k] = at[k] += 0.4 / NEAR_SEGMENTS * way[k];
    }
}

static dpt_pose any_pose(struct near_pair *pair, const double about[3], double within)
{
    dpt_pose pose;
    for (int k = 0; k < 3; k++)
        pose.position[k] = about[k] + random_in(&pair->seed, -within, within);
    random_turn(&pair->seed, pose.orientation);
    return pose;
}

/* At rest, slow, or fast. */
static void choose_motion(struct near_pair *pair)
{
    static const double speeds[] = { 0, 1e-5, 1e-4, 1e-4, 1e-3, 5e-3 };
    const double speed = speeds[random_bits(&pair->seed) % (sizeof speeds / sizeof *speeds)];
    pair->spin[0] = 1;
    for (int k = 0; k < 3; k++) {
        pair->speed[k] = random_in(&pair->seed, -speed, speed) - 0.02 * speed * pair->pose.position[k];
        pair->spin[1 + k] = random_in(&pair->seed, -5 * speed, 5 * speed);
    }
}

void near_pair_open(struct near_pair *pair, const struct solid *solids, const dpt_world_def *def, uint32_t near_budget,
                    uint64_t seed)
{
    static const double origin[3] = { 0, 0, 0 };
    dpt_world_def given = *def;
    memset(pair, 0, sizeof *pair);
    pair->solids = solids;
    pair->seed = seed;
    pair->has_budget = near_budget != 0;
    given.max_segments = 2 * NEAR_SEGMENTS;
    bend_segments(pair);
    for (int i = 0; i < NEAR_BODIES; i++)
        pair->body_pose[i] = any_pose(pair, shapes[i].at, 0);
    pair->pose = any_pose(pair, origin, 0.3);
    choose_motion(pair);
    open_world(pair, &pair->all, &given, 0);
    given.budget = near_budget;
    open_world(pair, &pair->near, &given, 1);
}

/* The sheet in one world, as a body whose vertices move. */
static void soften_sheet(const struct near_pair *pair, struct near_world *one)
{
    dpt_deformable_def def;
    dpt_mesh_info info = pair->solids[NEAR_SHEET].info;
    dpt_deformable_def_init(&def);
    def.mesh = pair->solids[NEAR_SHEET].mesh;
    def.pose = &pair->body_pose[NEAR_SHEET];
    for (int k = 0; k < 3; k++) {
        def.box_min[k] = info.box_min[k] - 0.1;
        def.box_max[k] = info.box_max[k] + 0.1;
    }
    dpt_body_remove(one->rig.world, one->body[NEAR_SHEET]);
    one->body[NEAR_SHEET] = rig_add_deformable(&one->rig, &def);
}

void near_pair_soften(struct near_pair *pair)
{
    pair->is_soft = 1;
    soften_sheet(pair, &pair->all);
    soften_sheet(pair, &pair->near);
}

/* A wave runs through the sheet, which stands still for some ticks. */
static void move_vertices(struct near_pair *pair)
{
    static float moved[3 * SHEET_VERTICES_MAX];
    const float *rest;
    uint32_t count;
    dpt_mesh_get_vertices(pair->solids[NEAR_SHEET].mesh, &rest, &count);
    CHECK(count <= SHEET_VERTICES_MAX, "%u vertices", count);
    pair->wave += random_bits(&pair->seed) % 3 ? 0.02 : 0;
    for (uint32_t v = 0; v < count && count <= SHEET_VERTICES_MAX; v++) {
        memcpy(moved + 3 * v, rest + 3 * v, 3 * sizeof *moved);
        moved[3 * v + 2] += (float)(0.03 * sin(pair->wave + 20 * (double)rest[3 * v]));
    }
    dpt_body_set_vertices(pair->all.rig.world, pair->all.body[NEAR_SHEET], 0, count, moved, -1);
    dpt_body_set_vertices(pair->near.rig.world, pair->near.body[NEAR_SHEET], 0, count, moved, -1);
}

void near_pair_close(struct near_pair *pair)
{
    rig_close(&pair->all.rig);
    rig_close(&pair->near.rig);
}

/* Numbers of what happens beside motion: so many, the first of which give a body a new place. */
enum { BODY_JUMPS = 1, BODY_COMES_AND_GOES = 2, BODY_MOVES = 3, TOOL_JUMPS = 4, SETTINGS_CHANGE = 8, DISTURBANCES = 9 };

/* In one world, what happens beside motion; `what` is a kind of it, `pose` a place near the tool. */
static void disturb(struct near_pair *pair, struct near_world *one, uint64_t what, int which, const dpt_pose *pose)
{
    dpt_pose bad = DPT_POSE_IDENTITY;
    dpt_body_settings settings = { .size = sizeof settings };
    dpt_tool_settings tool = { .size = sizeof tool };
    dpt_body body = one->body[which];
    bad.position[0] = NAN;
    switch (what) {
    case 0:
        dpt_body_teleport(one->rig.world, body, pose);
        break;
    case BODY_JUMPS:
        dpt_body_set_pose(one->rig.world, body, pose);
        break;
    case BODY_COMES_AND_GOES:
        dpt_body_remove(one->rig.world, body);
        dpt_body_add(one->rig.world, pair->solids[which].mesh, pose, &one->body[which]);
        break;
    case 3:
        dpt_body_get_settings(one->rig.world, body, &settings);
        settings.unfelt = !settings.unfelt;
        dpt_body_set_settings(one->rig.world, body, &settings);
        break;
    case TOOL_JUMPS:
        dpt_tool_teleport(one->rig.world, one->rig.tool, pose);
        break;
    case 5:
        dpt_tool_set_pose(one->rig.world, one->rig.tool, &bad);
        dpt_world_step(one->rig.world, 1e-3, NULL);
        break;
    case 6:
        dpt_world_step(one->rig.world, NAN, NULL);
        break;
    case 7:
        dpt_world_reset(one->rig.world);
        break;
    case SETTINGS_CHANGE: /* and back, with a body that moved meanwhile */
        dpt_body_set_pose(one->rig.world, one->body[1], &pair->body_pose[1]);
        dpt_tool_get_settings(one->rig.world, one->rig.tool, &tool);
        tool.near_only = 0;
        dpt_tool_set_settings(one->rig.world, one->rig.tool, &tool);
        dpt_world_step(one->rig.world, 1e-3, NULL);
        tool.near_only = one == &pair->near;
        dpt_tool_set_settings(one->rig.world, one->rig.tool, &tool);
        break;
    default:
        break;
    }
}

/* The tool's segments in the world, with its frame at a pose. */
static void place_segments(const struct near_pair *pair, const dpt_pose *pose, dpt_segment *placed)
{
    for (int i = 0; i < NEAR_SEGMENTS; i++)
        placed[i] = pose_segment(pose, &pair->segments[i]);
}

void near_pair_ends(const struct near_pair *pair, uint32_t segment, double ends[6])
{
    pose_ends(&pair->pose, &pair->segments[segment], ends);
}

static void give_pose(const struct near_pair *pair, struct near_world *one)
{
    dpt_segment placed[NEAR_SEGMENTS];
    if (pair->is_free)
        place_segments(pair, &pair->pose, placed);
    if (pair->is_free)
        dpt_tool_set_segments(one->rig.world, one->rig.tool, placed, NEAR_SEGMENTS);
    else
        dpt_tool_set_pose(one->rig.world, one->rig.tool, &pair->pose);
}

void near_pair_tick(struct near_pair *pair)
{
    struct near_world *worlds[2] = { &pair->all, &pair->near };
    uint64_t what = random_bits(&pair->seed) % (40 * DISTURBANCES);
    if (what == BODY_JUMPS && pair->bodies_are_slow)
        what = DISTURBANCES;
    const int which = (int)(random_bits(&pair->seed) % NEAR_BODIES);
    if (what == BODY_COMES_AND_GOES && pair->is_soft && which == NEAR_SHEET)
        what = DISTURBANCES;
    const dpt_pose place = any_pose(pair, pair->pose.position, 0.2);
    if (random_bits(&pair->seed) % 30 == 0)
        choose_motion(pair);
    for (int k = 0; k < 3; k++)
        pair->pose.position[k] += pair->speed[k];
    pose_turn_by(&pair->pose, pair->spin);
    const int moves_body = random_bits(&pair->seed) % 4 == 0;
    if (moves_body) {
        static const double little[4] = { 1, 2e-4, -1e-4, 1e-4 };
        pair->body_pose[1].position[2] += 1e-4;
        pose_turn_by(&pair->body_pose[1], little);
    }
    if (what == SETTINGS_CHANGE)
        pair->body_pose[1].position[0] += 0.01;
    if (what < BODY_MOVES)
        pair->body_pose[which] = place;
    if (what == TOOL_JUMPS)
        pair->pose = place;
    if (pair->is_soft)
        move_vertices(pair);
    for (int w = 0; w < 2; w++) {
        struct near_world *one = worlds[w];
        if (moves_body)
            dpt_body_set_pose(one->rig.world, one->body[1], &pair->body_pose[1]);
        disturb(pair, one, what, which, &place);
        give_pose(pair, one);
        one->result = dpt_world_step(one->rig.world, 1e-3, &one->rig.step);
    }
}

/* Whether a point of the hit's body is where the hit says: on its mesh. */
static void check_point(const struct near_pair *pair, const dpt_hit *hit)
{
    for (int i = 0; i < NEAR_BODIES; i++) {
        dpt_hit at = DPT_HIT_INIT;
        double ends[6];
        if (pair->near.body[i] != hit->body || (pair->is_soft && i == NEAR_SHEET))
            continue;
        memcpy(ends, hit->q, sizeof hit->q);
        memcpy(ends + 3, hit->q, sizeof hit->q);
        dpt_query_segments(pair->solids[i].mesh, &pair->body_pose[i], ends, NULL, 1, &at, NULL);
        CHECK(at.distance < 1e-9, "body %d: q is %g off its mesh", i, at.distance);
    }
}

static void compare_left_out(struct near_pair *pair, const dpt_hit *all, const dpt_hit *near, uint32_t segment)
{
    pair->left_out++;
    CHECK(near->lower_bound <= all->distance + all->error_bound, "segment %u: at least %g, but it is %g", segment,
          near->lower_bound, all->distance);
    CHECK(near->distance >= all->distance - all->error_bound, "segment %u: %g, but it is %g", segment, near->distance,
          all->distance);
    CHECK(fabs(apart(near->p, near->q) - near->distance) < 1e-12, "segment %u: %g between %g", segment, near->distance,
          apart(near->p, near->q));
    CHECK(!(near->flags & (DPT_HIT_FLAG_GAP | DPT_HIT_FLAG_BUDGET)), "segment %u: flags %u", segment, near->flags);
    if (pair->answers % 64 == 0)
        check_point(pair, near);
}

/* With a budget a search may have ended, and sides of sheets may be forgotten: then contact is another. */
static void compare_hit(struct near_pair *pair, uint32_t segment, int has_budget)
{
    dpt_hit all = DPT_HIT_INIT, near = DPT_HIT_INIT;
    dpt_tool_get_segment_hit(pair->all.rig.world, pair->all.rig.tool, segment, &all);
    dpt_tool_get_segment_hit(pair->near.rig.world, pair->near.rig.tool, segment, &near);
    CHECK((all.status == DPT_STATUS_STALE) == (near.status == DPT_STATUS_STALE), "segment %u: %u and %u", segment,
          all.status, near.status);
    if (all.status == DPT_STATUS_STALE)
        return;
    pair->answers++;
    if (!has_budget)
        CHECK(near.contact == all.contact, "segment %u: contact %u, but it is %u (%g, status %u)", segment,
              near.contact, all.contact, all.gap, near.status);
    if (near.status == DPT_STATUS_EXACT)
        CHECK(fabs(near.distance - all.distance) <= near.error_bound + all.error_bound, "segment %u: %g and %g",
              segment, near.distance, all.distance);
    else if (!has_budget)
        compare_left_out(pair, &all, &near, segment);
    else
        CHECK(near.lower_bound <= all.distance + all.error_bound && near.distance >= all.distance - all.error_bound,
              "segment %u: %g to %g, but it is %g", segment, near.lower_bound, near.distance, all.distance);
}

static void compare_tool(const struct near_pair *pair, int has_budget)
{
    dpt_hit all = DPT_HIT_INIT, near = DPT_HIT_INIT;
    dpt_force_info force_all = { .size = sizeof force_all }, force = force_all;
    const struct near_world *one = &pair->near, *other = &pair->all;
    CHECK(one->result == other->result, "%d and %d", one->result, other->result);
    if (has_budget)
        return;
    dpt_tool_get_hit(other->rig.world, other->rig.tool, &all);
    dpt_tool_get_hit(one->rig.world, one->rig.tool, &near);
    CHECK(all.status == near.status, "the tool's status %u and %u", near.status, all.status);
    if (all.status == DPT_STATUS_EXACT)
        CHECK(fabs((near.distance - pair->segments[near.segment].radius) -
                   (all.distance - pair->segments[all.segment].radius)) <= near.error_bound + all.error_bound,
              "the tool is at %g, but it is at %g", near.distance, all.distance);
    CHECK(one->rig.step.status == other->rig.step.status && one->rig.step.contact == other->rig.step.contact,
          "the step's status %u and %u, contact %u and %u", one->rig.step.status, other->rig.step.status,
          one->rig.step.contact, other->rig.step.contact);
    CHECK(fabs(one->rig.step.distance - other->rig.step.distance) <= near.error_bound + all.error_bound,
          "the step's distance %g and %g", one->rig.step.distance, other->rig.step.distance);
    dpt_tool_get_force_info(other->rig.world, other->rig.tool, &force_all);
    dpt_tool_get_force_info(one->rig.world, one->rig.tool, &force);
    CHECK(force.reason == force_all.reason, "reason %u and %u", force.reason, force_all.reason);
    CHECK(one->rig.step.contacts == other->rig.step.contacts, "contacts %u and %u", one->rig.step.contacts,
          other->rig.step.contacts);
    for (int k = 0; k < 3; k++)
        CHECK(fabs(force.wrench.force[k] - force_all.wrench.force[k]) <= pair->force_error, "force %d: %.9g and %.9g",
              k, force.wrench.force[k], force_all.wrench.force[k]);
}

static void compare_sweep(const struct near_pair *pair, uint32_t segment)
{
    dpt_sweep all = { .size = sizeof all }, near = { .size = sizeof near };
    dpt_tool_get_sweep(pair->all.rig.world, pair->all.rig.tool, segment, &all);
    dpt_tool_get_sweep(pair->near.rig.world, pair->near.rig.tool, segment, &near);
    CHECK(near.status == all.status && near.time == all.time, "segment %u: swept %u %g and %u %g", segment, near.status,
          near.time, all.status, all.time);
}

void near_pair_check_proxy(const struct near_pair *pair)
{
    const struct near_world *one = &pair->near;
    dpt_force_info force = { .size = sizeof force };
    dpt_pose proxy;
    dpt_segment placed[NEAR_SEGMENTS];
    dpt_tool_get_force_info(one->rig.world, one->rig.tool, &force);
    if (force.reason != DPT_FORCE_ACTS || force.flags & (DPT_FORCE_FLAG_SQUEEZED | DPT_FORCE_FLAG_REPLACED))
        return;
    dpt_tool_get_proxy(one->rig.world, one->rig.tool, &proxy);
    place_segments(pair, &proxy, placed);
    for (int i = 0; i < NEAR_BODIES; i++) {
        dpt_body_settings settings = { .size = sizeof settings };
        dpt_body_get_settings(one->rig.world, one->body[i], &settings);
        for (int s = 0; s < NEAR_SEGMENTS && !settings.unfelt; s++) {
            dpt_hit hit = DPT_HIT_INIT;
            double ends[6];
            memcpy(ends, placed[s].a, sizeof placed[s].a);
            memcpy(ends + 3, placed[s].b, sizeof placed[s].b);
            dpt_query_segments(pair->solids[i].mesh, &pair->body_pose[i], ends, &placed[s].radius, 1, &hit, NULL);
            CHECK(hit.distance > placed[s].radius, "segment %d is %g in body %d", s, placed[s].radius - hit.distance,
                  i);
        }
    }
}

void near_pair_compare(struct near_pair *pair)
{
    dpt_wrench wrench;
    for (uint32_t i = 0; i < NEAR_SEGMENTS; i++)
        compare_hit(pair, i, pair->has_budget);
    for (uint32_t i = 0; i < NEAR_SEGMENTS && !pair->has_budget; i++)
        compare_sweep(pair, i);
    compare_tool(pair, pair->has_budget);
    dpt_tool_get_wrench(pair->near.rig.world, pair->near.rig.tool, &wrench);
    pair->forces += wrench.force[0] != 0 || wrench.force[1] != 0 || wrench.force[2] != 0;
}
