/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What happens to a needle that is in: bodies that move, appear and go, teleports, budgets, holes that stay, and what is
 * refused. And that worlds without what can be pierced are what they were, bit for bit.
 */
#include "insertion/needle_rig.h"

/* A needle 0.03 m deep in the box. */
static void open_inside(struct needle_rig *needle, uint32_t channels)
{
    const dpt_body_settings gel = needle_gel();
    needle_open(needle, &gel, channels);
    needle_go(needle, 0.03, 0.02);
    CHECK(needle->rig.force.flags & DPT_FORCE_FLAG_INSERTED, "it is not in");
}

static int is_same_tick(const struct rig *one, const struct rig *other)
{
    return !memcmp(&one->force, &other->force, sizeof one->force) &&
           !memcmp(&one->proxy, &other->proxy, sizeof one->proxy) &&
           !memcmp(&one->step, &other->step, sizeof one->step) && !memcmp(&one->hit, &other->hit, sizeof one->hit);
}

/* The same hand in three worlds: without channels, with room for them, and with a tool that would pierce. */
static void what_cannot_be_pierced_is_as_before(void)
{
    struct needle_rig plain, roomy, sharp;
    uint64_t seed = 5;
    double way[5] = { 0 };
    needle_open(&plain, NULL, 0);
    needle_open(&roomy, NULL, 4);
    needle_open(&sharp, NULL, 4);
    dpt_body_settings wood = needle_gel();
    wood.puncture_force = 0;
    rig_set_body(&sharp.rig, wood);
    for (int i = 0; i < 4000; i++) {
        for (int k = 0; k < 5; k++)
            way[k] = 0.995 * way[k] + random_in(&seed, -1, 1);
        plain.at[0] = 0.01 + 0.004 * way[0];
        plain.at[1] = 0.004 * way[1];
        plain.depth = 0.003 + 0.001 * way[2];
        plain.lean[0] = 0.05 * way[3];
        plain.lean[1] = 0.05 * way[4];
        struct needle_rig *others[2] = { &roomy, &sharp };
        needle_step(&plain);
        for (int k = 0; k < 2; k++) {
            memcpy(others[k]->at, plain.at, sizeof plain.at);
            memcpy(others[k]->lean, plain.lean, sizeof plain.lean);
            others[k]->depth = plain.depth;
            needle_step(others[k]);
            CHECK(is_same_tick(&plain.rig, &others[k]->rig), "tick %d, world %d", i, k);
        }
    }
    CHECK(plain.rig.force.folds > 0 || plain.rig.force.reason != DPT_FORCE_STALE, "nothing happened");
    needle_close(&plain);
    needle_close(&roomy);
    needle_close(&sharp);
}

/* In the body's frame. */
static void entry_in_body(const struct needle_rig *needle, double entry[3], double axis[3])
{
    const dpt_channel channel = needle_channel(needle);
    dpt_pose pose;
    dpt_body_get_pose(needle->rig.world, needle->rig.body, &pose);
    pose_local(&pose, channel.entry, entry);
    turn_back3(pose.orientation, channel.axis, axis);
}

/* A body that sways takes the needle with it: the channel is where it was in the body, and the needle in the channel. */
static void a_channel_moves_with_its_body(void)
{
    struct needle_rig needle;
    open_inside(&needle, 1);
    double entry[3], axis[3], now[3], along[3], ends[6];
    entry_in_body(&needle, entry, axis);
    const dpt_pose device = needle.rig.device;
    const double force = needle_force(&needle), depth = needle_channel(&needle).depth;
    for (int i = 1; i <= 3000; i++) {
        dpt_pose pose = DPT_POSE_IDENTITY;
        const double x[3] = { 0.6, 0.8, 0 }, swing = sin(2 * acos(-1.0) * i / 1000);
        pose.position[0] = 0.01 * swing;
        pose.position[2] = -0.004 * swing;
        pose_orient(&pose, x, 0.2 * swing);
        dpt_body_set_pose(needle.rig.world, needle.rig.body, &pose);
        /* The hand goes with it. */
        pose_point(&pose, device.position, needle.rig.device.position);
        turn_times(pose.orientation, device.orientation, needle.rig.device.orientation);
        rig_step(&needle.rig);
        CHECK(needle.rig.force.flags == DPT_FORCE_FLAG_INSERTED, "tick %d: flags %u", i, needle.rig.force.flags);
        entry_in_body(&needle, now, along);
        CHECK(apart(now, entry) < 1e-12 && apart(axis, along) < 1e-12, "the channel has moved in the body");
        rig_proxy_ends(&needle.rig, 0, ends);
        const dpt_channel channel = needle_channel(&needle);
        double shaft[3], away[3], across[3];
        for (int k = 0; k < 3; k++) {
            shaft[k] = (ends[3 + k] - ends[k]) / NEEDLE_LENGTH;
            away[k] = ends[3 + k] - channel.entry[k];
        }
        cross3(away, channel.axis, across);
        CHECK(apart(shaft, channel.axis) < 1e-9 && length3(across) < 1e-10, "tick %d: aside by %g", i, length3(across));
        CHECK(fabs(channel.depth - depth) < 1e-9, "it has slipped by %g", channel.depth - depth);
        CHECK(fabs(length3(needle.rig.force.wrench.force) - force) < 1e-6, "the force has changed");
    }
    needle_close(&needle);
}

/* Aside, the channel holds as a rigid contact does; the needle does not leave it however far and fast the hand goes. */
static void a_hand_that_goes_aside_pulls_at_the_channel(void)
{
    struct needle_rig needle;
    open_inside(&needle, 1);
    uint64_t seed = 3;
    double ends[6];
    needle.at[0] += 0.002;
    needle_step(&needle);
    CHECK(fabs(needle.rig.force.wrench.force[0] + RIG_STIFFNESS * 0.002) < 1e-9, "%g N aside",
          needle.rig.force.wrench.force[0]);
    for (int i = 0; i < 2000; i++) {
        needle.at[0] = random_in(&seed, -0.2, 0.2);
        needle.at[1] = random_in(&seed, -0.2, 0.2);
        needle.lean[0] = random_in(&seed, -3, 3);
        needle.lean[1] = random_in(&seed, -3, 3);
        needle.depth = random_in(&seed, 0.0, 0.1);
        needle_step(&needle);
        if (!(needle.rig.force.flags & DPT_FORCE_FLAG_INSERTED))
            break;
        rig_proxy_ends(&needle.rig, 0, ends);
        CHECK(fabs(ends[0] - 0.011) < 1e-12 && fabs(ends[4] - 0.007) < 1e-12, "tick %d: it left sideways", i);
    }
    needle_close(&needle);
}

/*
 * A device without torque may turn as it likes: its force is that at the tool's origin, and there is none of a torque
 * alone.
 */
static void a_device_without_torque_turns_freely(void)
{
    struct needle_rig needle;
    dpt_tool_settings settings = { .size = sizeof settings };
    const dpt_body_settings gel = needle_gel();
    const double x[3] = { 1, 0, 0 };
    needle_open(&needle, &gel, 2);
    dpt_tool_get_settings(needle.rig.world, needle.rig.tool, &settings);
    settings.lock_rotation = 1;
    CHECK(dpt_tool_set_settings(needle.rig.world, needle.rig.tool, &settings) == DPT_OK, "settings");
    needle_go(&needle, 0.03, 0.02);
    const dpt_force_info before = needle.rig.force;
    const dpt_pose straight = needle.rig.device;
    CHECK(before.flags == DPT_FORCE_FLAG_INSERTED, "it is not in");
    for (int i = 0; i <= 200; i++) {
        dpt_pose turn = DPT_POSE_IDENTITY;
        pose_orient(&turn, x, 0.01 * i);
        needle.rig.device = straight;
        turn_times(turn.orientation, straight.orientation, needle.rig.device.orientation);
        rig_step(&needle.rig);
        CHECK(apart(needle.rig.force.wrench.force, before.wrench.force) < 1e-9, "turned by %g rad: %g N more", 0.01 * i,
              apart(needle.rig.force.wrench.force, before.wrench.force));
        CHECK(fabs(needle.rig.force.energy - before.energy) < 1e-9, "%g J", needle.rig.force.energy);
    }
    /* Out and in again as before. */
    needle.rig.device = straight;
    needle_go(&needle, -0.005, 0.02);
    needle.at[0] += 0.5 * NEEDLE_RADIUS;
    for (int i = 0; i < 1000; i++) {
        needle.depth += 1e-5;
        needle_step(&needle);
        CHECK(!(needle.rig.force.flags & DPT_FORCE_FLAG_RUPTURE), "a puncture in a hole");
    }
    CHECK(needle.rig.force.flags & DPT_FORCE_FLAG_INSERTED, "it does not go in again");
    needle_close(&needle);
}

/*
 * Beside an edge. Within r of the side, the wall that the tip has ruptured goes on all the way down: it is one. Beyond the
 * edge the axis meets nothing, and the tip ruptures what it touches all the same.
 */
static void along_an_edge(void)
{
    for (int kind = 0; kind < 2; kind++) {
        struct needle_rig needle;
        dpt_body_settings gel = needle_gel();
        gel.static_friction = gel.kinetic_friction = 10;
        needle_open(&needle, &gel, 2);
        needle.at[0] = 0.06 + (kind ? 0.3 : -0.4) * NEEDLE_RADIUS;
        needle_step(&needle);
        rig_place(&needle.rig);
        needle_go(&needle, 0.096, 0.02);
        const dpt_channel channel = needle_channel(&needle);
        CHECK(channel.flags & DPT_CHANNEL_FLAG_OCCUPIED && channel.ruptures == 1, "%u walls", channel.ruptures);
        CHECK(kind ? channel.inside == 0 : fabs(channel.inside - 0.08) < 1e-6, "%g m inside", channel.inside);
        CHECK(needle_tip(&needle) > 0.085, "it has come to %g", needle_tip(&needle));
        needle_close(&needle);
    }
}

/* Out and in again: through the hole without a puncture, beside it with one. */
static void a_hole_stays(void)
{
    struct needle_rig needle;
    open_inside(&needle, 4);
    const uint32_t id = needle_channel(&needle).id;
    needle_go(&needle, -0.005, 0.02);
    CHECK(!(needle.rig.force.flags & DPT_FORCE_FLAG_INSERTED) && needle.rig.force.reason == DPT_FORCE_FREE, "out");
    CHECK(!(needle_channel(&needle).flags & DPT_CHANNEL_FLAG_OCCUPIED), "the hole is empty");
    needle.at[0] += 0.6 * NEEDLE_RADIUS;
    needle.lean[1] = 0.004;
    double most = 0;
    for (int i = 0; i < 1500; i++) {
        needle.depth += 1e-5;
        needle_step(&needle);
        most = fmax(most, needle_force(&needle));
        CHECK(!(needle.rig.force.flags & DPT_FORCE_FLAG_RUPTURE), "a puncture in a hole");
    }
    CHECK(needle_channel(&needle).id == id && needle_channel(&needle).depth > 0.008, "it went in again");
    CHECK(most < 0.5, "%g N: it cut again", most);
    needle_go(&needle, -0.005, 0.02);
    needle.at[0] += 2 * NEEDLE_RADIUS;
    needle_go(&needle, 0.02, 0.02);
    CHECK(needle_channels(&needle, NULL, 0) == 2, "no second hole");
    needle_close(&needle);
}

/* What ends channels, and what a tool feels then. */
static void bodies_and_tools_that_go(void)
{
    struct needle_rig needle;
    dpt_pose pose = DPT_POSE_IDENTITY;
    open_inside(&needle, 2);
    dpt_body_remove(needle.rig.world, needle.rig.body);
    rig_step(&needle.rig);
    CHECK(needle_channels(&needle, NULL, 0) == 0 && needle.rig.force.reason == DPT_FORCE_FREE, "after the body");
    CHECK(length3(needle.rig.force.wrench.force) == 0, "it still pushes");
    needle_close(&needle);

    open_inside(&needle, 2);
    dpt_body_teleport(needle.rig.world, needle.rig.body, &pose);
    needle_step(&needle);
    CHECK(needle_channels(&needle, NULL, 0) == 0 && needle.rig.force.reason == DPT_FORCE_INSIDE, "a body that jumped");
    needle_close(&needle);

    open_inside(&needle, 2);
    dpt_tool_teleport(needle.rig.world, needle.rig.tool, &needle.rig.device);
    needle_step(&needle);
    CHECK(needle.rig.force.reason == DPT_FORCE_INSIDE, "a tool that jumped has reason %u", needle.rig.force.reason);
    CHECK(!(needle_channel(&needle).flags & DPT_CHANNEL_FLAG_OCCUPIED), "it jumped out of its channel");
    needle_go(&needle, -0.005, 0.02);
    needle_go(&needle, 0.01, 0.02);
    CHECK(needle.rig.force.flags & DPT_FORCE_FLAG_INSERTED, "and goes in again");
    CHECK(dpt_world_reset(needle.rig.world) == DPT_OK && needle_channels(&needle, NULL, 0) == 0, "reset");
    needle_close(&needle);

    open_inside(&needle, 1);
    dpt_segment shaft = needle.rig.segments[0];
    dpt_tool_remove(needle.rig.world, needle.rig.tool);
    uint32_t count = 7;
    CHECK(dpt_tool_get_channels(needle.rig.world, needle.rig.tool, NULL, 0, &count) == DPT_E_HANDLE && count == 0,
          "channels of a tool that is gone");
    /* Another takes its place, with its own channel. */
    CHECK(dpt_tool_add(needle.rig.world, &shaft, 1, &needle.rig.tool) == DPT_OK, "tool");
    dpt_tool_settings settings = { .size = sizeof settings };
    dpt_tool_get_settings(needle.rig.world, needle.rig.tool, &settings);
    CHECK(settings.piercing == DPT_PIERCING_NONE, "a new tool pierces");
    settings.piercing = DPT_PIERCING_B;
    CHECK(dpt_tool_set_settings(needle.rig.world, needle.rig.tool, &settings) == DPT_OK, "settings");
    needle.depth = -0.005;
    needle_step(&needle);
    needle_go(&needle, 0.01, 0.02);
    CHECK(needle_channels(&needle, NULL, 0) == 1, "the only room is free again");
    needle_close(&needle);
}

/* A body that appears beside a needle that is in is no matter; one that appears round it is. */
static void bodies_that_appear(void)
{
    struct needle_rig needle;
    dpt_pose pose = DPT_POSE_IDENTITY;
    open_inside(&needle, 2);
    pose.position[0] = 0.15;
    rig_add_body(&needle.rig, needle.box.mesh, &pose);
    pose.position[0] = 0.011 + 0.06 + 0.002;
    pose.position[2] = 0.04 + 0.04 + 0.001;
    rig_add_body(&needle.rig, needle.box.mesh, &pose);
    needle_step(&needle);
    CHECK(needle.rig.force.flags & DPT_FORCE_FLAG_INSERTED && needle.rig.force.reason == DPT_FORCE_ACTS, "beside");
    pose.position[0] = 0.0;
    rig_add_body(&needle.rig, needle.box.mesh, &pose);
    needle_step(&needle);
    needle_step(&needle);
    CHECK(needle.rig.force.reason == DPT_FORCE_INSIDE && !(needle.rig.force.flags & DPT_FORCE_FLAG_INSERTED), "round");
    needle_close(&needle);
}

/* Without a pose of the tool bodies that rest are no matter. What moves then may have gone anywhere. */
static void ticks_without_a_pose(void)
{
    for (int moves = 0; moves < 2; moves++) {
        struct needle_rig needle;
        dpt_pose body = DPT_POSE_IDENTITY;
        open_inside(&needle, 2);
        CHECK(dpt_tool_set_pose(needle.rig.world, needle.rig.tool, NULL) == DPT_E_ARGUMENT, "no pose");
        for (int i = 0; i < 3; i++) {
            body.position[0] += 0.001 * moves;
            dpt_body_set_pose(needle.rig.world, needle.rig.body, &body);
            dpt_world_step(needle.rig.world, RIG_DT, NULL);
        }
        needle_step(&needle);
        needle_step(&needle);
        CHECK((needle.rig.force.reason == DPT_FORCE_INSIDE) == moves, "reason %u", needle.rig.force.reason);
        CHECK((needle.rig.force.flags & DPT_FORCE_FLAG_INSERTED) == (moves ? 0 : DPT_FORCE_FLAG_INSERTED), "flags %u",
              needle.rig.force.flags);
        needle_close(&needle);
    }
}

/* The tip meets what is not pierced: a body behind, and one that can be pierced where there is no more room. */
static void what_stops_a_tip(void)
{
    for (int kind = 0; kind < 2; kind++) {
        struct needle_rig needle;
        dpt_pose pose = DPT_POSE_IDENTITY;
        dpt_wrench wrench;
        open_inside(&needle, 1);
        pose.position[2] = -0.085;
        const dpt_body behind = rig_add_body(&needle.rig, needle.box.mesh, &pose);
        dpt_body_settings gel = needle_gel();
        if (kind)
            CHECK(dpt_body_set_settings(needle.rig.world, behind, &gel) == DPT_OK, "settings");
        needle_go(&needle, 0.098, 0.02);
        CHECK(fabs(needle_tip(&needle) + NEEDLE_RADIUS - 0.085) < 2e-6, "the tip is at %g", needle_tip(&needle));
        CHECK(!(needle.rig.force.flags & DPT_FORCE_FLAG_CHANNELS_FULL) == !kind, "flags %u", needle.rig.force.flags);
        dpt_body_get_wrench(needle.rig.world, behind, &wrench);
        CHECK(fabs(-wrench.force[2] - (needle_force(&needle) - 40 * 0.08)) < 0.01, "%g N on what is behind",
              wrench.force[2]);
        needle_close(&needle);
    }
}

/* A pile of ten plates of 2 mm, 2 mm apart, has 20 walls: the needle goes through the first 16, and no farther. */
static void a_line_with_too_many_walls(void)
{
    struct needle_rig needle;
    struct solid pile;
    needle_open_over_plates(&needle, &pile, NEEDLE_PLATES_MAX, 0.002, 0.004);
    needle_go(&needle, 0.09, 0.02);
    const dpt_channel channel = needle_channel(&needle);
    CHECK(channel.ruptures == 16 && fabs(channel.inside - 0.016) < 1e-6, "%u walls, %g m inside", channel.ruptures,
          channel.inside);
    CHECK(fabs(needle_tip(&needle) + NEEDLE_RADIUS - 0.032) < 2e-6, "the tip is at %g", needle_tip(&needle));
    needle_close(&needle);
    solid_close(&pile);
}

/* Between two plates, its rear end beneath the upper one: it could only be drawn out through that. */
static void a_needle_whose_way_out_is_closed(void)
{
    struct needle_rig needle;
    struct solid pile;
    needle_open_over_plates(&needle, &pile, 2, 0.002, 0.05);
    dpt_pose between = needle.rig.device;
    between.position[2] -= 0.115;
    dpt_tool_set_pose(needle.rig.world, needle.rig.tool, &between);
    CHECK(dpt_tool_insert(needle.rig.world, needle.rig.tool) == DPT_E_ARGUMENT, "it is put in");
    CHECK(needle_channels(&needle, NULL, 0) == 0, "and yet it is in");
    needle_close(&needle);
    solid_close(&pile);
}

static void a_needle_is_put_in(void)
{
    struct needle_rig needle;
    const dpt_body_settings gel = needle_gel();
    needle_open(&needle, &gel, 1);
    CHECK(dpt_tool_insert(needle.rig.world, needle.rig.tool) == DPT_E_ARGUMENT, "in the air");
    needle.depth = 0.03;
    needle_step(&needle);
    CHECK(dpt_tool_insert(needle.rig.world, needle.rig.tool) == DPT_OK, "it is not put in");
    needle_step(&needle);
    const dpt_channel channel = needle_channel(&needle);
    CHECK(fabs(channel.depth - 0.03) < 1e-9 && fabs(channel.deepest - 0.03) < 1e-9 && channel.ruptures == 1 &&
              fabs(channel.entry[2] - NEEDLE_TOP) < 1e-9 && fabs(channel.axis[2] + 1) < 1e-12,
          "depth %g, %u ruptures", channel.depth, channel.ruptures);
    CHECK(needle_force(&needle) == 0, "a force of %g", needle_force(&needle));
    needle_go(&needle, 0.04, 0.02);
    CHECK(fabs(needle_force(&needle) - (0.5 + 40 * needle_channel(&needle).inside)) < 0.01, "%g N",
          needle_force(&needle));
    /* Through the whole box, and with its rear end inside. */
    needle.depth = 0.09;
    needle_step(&needle);
    CHECK(dpt_tool_insert(needle.rig.world, needle.rig.tool) == DPT_E_FULL, "there is room for one channel");
    dpt_world_reset(needle.rig.world);
    CHECK(dpt_tool_insert(needle.rig.world, needle.rig.tool) == DPT_OK && needle_channel(&needle).ruptures == 2,
          "through");
    dpt_world_reset(needle.rig.world);
    needle.depth = 0.12;
    needle_step(&needle);
    CHECK(dpt_tool_insert(needle.rig.world, needle.rig.tool) == DPT_E_ARGUMENT, "its rear end is inside");
    CHECK(needle_channels(&needle, NULL, 0) == 0, "and yet it is in");
    needle_close(&needle);
}

static void within_a_budget_it_gets_there(void)
{
    enum { BUDGET = 60 };
    struct needle_rig needle;
    const dpt_body_settings gel = needle_gel();
    needle_open_within(&needle, &gel, 1, BUDGET, 0);
    needle_step(&needle);
    while (needle.depth < 0.03) {
        needle.depth += 2e-5;
        needle_step(&needle);
        CHECK(needle.rig.step.work <= BUDGET, "%u units", needle.rig.step.work);
    }
    CHECK(fabs(needle_force(&needle) - (0.5 + 40 * needle_channel(&needle).inside)) < 0.02, "%g N",
          needle_force(&needle));
    needle_close(&needle);
}

/* A free tool has no point, and one of another size fits no hole. */
static void a_size_that_changes_ends_holes(void)
{
    struct needle_rig needle;
    dpt_tool_settings settings = { .size = sizeof settings };
    open_inside(&needle, 1);
    dpt_segment thick = needle.rig.segments[0];
    thick.radius *= 2;
    CHECK(dpt_tool_set_segments(needle.rig.world, needle.rig.tool, &thick, 1) == DPT_OK, "segments");
    CHECK(needle_channels(&needle, NULL, 0) == 0, "the hole is there");
    CHECK(dpt_tool_get_settings(needle.rig.world, needle.rig.tool, &settings) == DPT_OK &&
              settings.piercing == DPT_PIERCING_NONE,
          "a free tool pierces");
    CHECK(dpt_tool_set_settings(needle.rig.world, needle.rig.tool, &settings) == DPT_OK, "its settings are refused");
    needle_close(&needle);
}

static void what_is_refused(void)
{
    struct needle_rig needle;
    struct rig *rig = &needle.rig;
    dpt_body_settings gel = needle_gel();
    dpt_tool_settings tool = { .size = sizeof tool };
    dpt_tool other;
    uint32_t count;
    needle_open(&needle, NULL, 0);
    CHECK(dpt_body_set_settings(rig->world, rig->body, &gel) == DPT_E_UNSUPPORTED, "no room for channels");
    dpt_tool_get_settings(rig->world, rig->tool, &tool);
    tool.piercing = DPT_PIERCING_B;
    CHECK(dpt_tool_set_settings(rig->world, rig->tool, &tool) == DPT_E_UNSUPPORTED, "likewise");
    CHECK(dpt_tool_get_channels(rig->world, rig->tool, NULL, 0, &count) == DPT_E_UNSUPPORTED && count == 0, "likewise");
    CHECK(dpt_tool_insert(rig->world, rig->tool) == DPT_E_UNSUPPORTED, "likewise");
    needle_close(&needle);

    needle_open(&needle, NULL, 1);
    dpt_deformable_def soft;
    dpt_deformable_def_init(&soft);
    soft.mesh = needle.box.mesh;
    const size_t bytes = dpt_deformable_bytes(&soft);
    void *block = malloc(bytes);
    dpt_body body;
    CHECK(block && dpt_body_add_deformable(rig->world, block, bytes, &soft, &body) == DPT_OK, "a soft body");
    CHECK(dpt_body_set_settings(rig->world, body, &gel) == DPT_E_UNSUPPORTED, "neither springs nor a compliance");
    CHECK(dpt_body_remove(rig->world, body) == DPT_OK, "not removed");
    free(block);
    double *const numbers[] = { &gel.puncture_force, &gel.toughness,       &gel.cutting_force,
                                &gel.shaft_friction, &gel.shaft_viscosity, &gel.shaft_stiffness };
    for (int i = 0; i < 6; i++) {
        const double was = *numbers[i];
        static const double bad[] = { -1e-9, 1e13, NAN, INFINITY };
        for (int k = 0; k < 4; k++) {
            *numbers[i] = bad[k];
            CHECK(dpt_body_set_settings(rig->world, rig->body, &gel) == DPT_E_ARGUMENT, "number %d is %g", i, bad[k]);
        }
        *numbers[i] = was;
    }
    CHECK(dpt_body_set_settings(rig->world, rig->body, &gel) == DPT_OK, "what is good");
    dpt_tool_get_settings(rig->world, rig->tool, &tool);
    tool.piercing = 3;
    CHECK(dpt_tool_set_settings(rig->world, rig->tool, &tool) == DPT_E_ARGUMENT, "no such end");
    tool.piercing = DPT_PIERCING_B;
    tool.law = DPT_LAW_BED;
    CHECK(dpt_tool_set_settings(rig->world, rig->tool, &tool) == DPT_E_UNSUPPORTED, "a law without a proxy");
    static const dpt_segment two[2] = { { { 0, 0, 0 }, { 0, 0, 0.1 }, 0.001 }, { { 0, 0, 0 }, { 0.1, 0, 0 }, 0.001 } };
    static const dpt_segment thin = { { 0, 0, 0 }, { 0, 0, 0.1 }, 0 }, ball = { { 0, 0, 0 }, { 0, 0, 0 }, 0.001 };
    const dpt_segment *const shapes[3] = { two, &thin, &ball };
    tool.law = DPT_LAW_PROXY;
    for (int i = 0; i < 3; i++) {
        CHECK(dpt_tool_add(rig->world, shapes[i], i ? 1 : 2, &other) == DPT_OK, "tool");
        CHECK(dpt_tool_set_settings(rig->world, other, &tool) == DPT_E_UNSUPPORTED, "shape %d", i);
        dpt_tool_remove(rig->world, other);
    }
    CHECK(dpt_tool_get_channels(rig->world, rig->tool, NULL, 1, &count) == DPT_E_ARGUMENT, "no array");
    CHECK(dpt_tool_get_channels(rig->world, rig->tool, NULL, 0, NULL) == DPT_E_ARGUMENT, "no count");
    CHECK(dpt_tool_get_channels(NULL, rig->tool, NULL, 0, &count) == DPT_E_ARGUMENT, "no world");
    CHECK(dpt_tool_insert(NULL, rig->tool) == DPT_E_ARGUMENT && dpt_tool_insert(rig->world, 0) == DPT_E_HANDLE,
          "insert");
    needle_close(&needle);
}

int main(void)
{
    TEST(what_cannot_be_pierced_is_as_before);
    TEST(a_channel_moves_with_its_body);
    TEST(a_hand_that_goes_aside_pulls_at_the_channel);
    TEST(a_device_without_torque_turns_freely);
    TEST(along_an_edge);
    TEST(a_hole_stays);
    TEST(bodies_and_tools_that_go);
    TEST(bodies_that_appear);
    TEST(ticks_without_a_pose);
    TEST(what_stops_a_tip);
    TEST(a_line_with_too_many_walls);
    TEST(a_needle_whose_way_out_is_closed);
    TEST(a_needle_is_put_in);
    TEST(a_size_that_changes_ends_holes);
    TEST(within_a_budget_it_gets_there);
    TEST(what_is_refused);
    return check_report();
}
