/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A needle that is in one body, and other bodies: one that comes to its tip or stands beside its shaft, one that it goes
 * into as well, and other needles. What moving bodies do to it is in the account of energy.
 */
#include "insertion/needle_rig.h"

/* m: walls are felt that much before they are touched, 2e-6 of the box's diagonal. */
#define CLEARANCE 4e-7

/* m: of the second box, beneath the first: its top is at a depth of 0.085 m. */
#define BEHIND (-0.085)

static dpt_pose at_height(double z)
{
    dpt_pose pose = DPT_POSE_IDENTITY;
    pose.position[2] = z;
    return pose;
}

/* A needle over the box, with a second one beneath it, which is of that gel, too, unless it is NULL. */
static dpt_body open_two(struct needle_rig *needle, const dpt_body_settings *first, const dpt_body_settings *second,
                         double z)
{
    const dpt_pose pose = at_height(z);
    needle_open(needle, first, 3);
    const dpt_body behind = rig_add_body(&needle->rig, needle->box.mesh, &pose);
    if (second)
        CHECK(dpt_body_set_settings(needle->rig.world, behind, second) == DPT_OK, "settings");
    rig_place(&needle->rig);
    return behind;
}

/* That in a body, of `count` channels. */
static dpt_channel channel_of(const struct needle_rig *needle, dpt_body body, uint32_t count)
{
    dpt_channel channels[3], none = { .size = sizeof none };
    CHECK(needle_channels(needle, channels, 3) == count, "not %u channels", count);
    for (uint32_t i = 0; i < count; i++)
        if (channels[i].body == body)
            return channels[i];
    return none;
}

/*
 * The tip rests on a body that cannot be pierced. That moves up against the tip, or the body that the needle is in moves
 * down: the tip stays on it, and the spring holds what the bodies' motion gave, as there is no friction.
 */
static void a_body_that_comes_to_the_tip(void)
{
    for (int kind = 0; kind < 2; kind++) {
        struct needle_rig needle;
        dpt_body_settings gel = needle_gel();
        gel.shaft_friction = gel.cutting_force = 0;
        const dpt_body behind = open_two(&needle, &gel, NULL, BEHIND);
        needle_go(&needle, 0.09, 0.02);
        const double before = needle.rig.force.energy, force = needle_force(&needle);
        double work = 0;
        for (int i = 1; i <= 2000; i++) {
            const dpt_pose pose = at_height(kind ? -1e-6 * i : BEHIND + 1e-6 * i);
            dpt_body_set_pose(needle.rig.world, kind ? needle.rig.body : behind, &pose);
            rig_step(&needle.rig);
            work += needle.rig.force.body_work;
            const double top = 0.085 - (kind ? 0 : 1e-6 * i);
            CHECK(needle.rig.force.flags == DPT_FORCE_FLAG_INSERTED, "kind %d, tick %d: flags %u", kind, i,
                  needle.rig.force.flags);
            CHECK(fabs(needle_tip(&needle) + NEEDLE_RADIUS - top) < 4e-6, "kind %d, tick %d: the tip is at %g", kind, i,
                  needle_tip(&needle));
        }
        const double wanted = kind ? 0 : RIG_STIFFNESS * 0.002;
        CHECK(fabs(needle_force(&needle) - force - wanted) < 0.01, "%g N more", needle_force(&needle) - force);
        CHECK(fabs(work - (needle.rig.force.energy - before)) < 0.02 * before, "kind %d: %g J of work, %g J stored",
              kind, work, needle.rig.force.energy - before);
        needle_close(&needle);
    }
}

/* The second body is drawn down along the needle: it rubs by its speed, and what the spring gains it has put in. */
static void a_second_body_that_slides_along(void)
{
    struct needle_rig needle;
    dpt_body_settings smooth = needle_gel(), rough = needle_gel();
    smooth.shaft_friction = smooth.cutting_force = rough.cutting_force = 0;
    rough.shaft_friction = 20;
    rough.shaft_viscosity = 1e4;
    const dpt_body behind = open_two(&needle, &smooth, &rough, BEHIND);
    needle_go(&needle, 0.097, 0.02);
    for (int i = 0; i < 100; i++)
        rig_step(&needle.rig);
    CHECK(channel_of(&needle, behind, 2).flags & DPT_CHANNEL_FLAG_OCCUPIED, "it is not in both");
    double stored = needle.rig.force.energy, work = 0;
    double depth = 0;
    for (int i = 1; i <= 5000; i++) {
        const dpt_pose pose = at_height(BEHIND - 1e-6 * i);
        depth = channel_of(&needle, behind, 2).depth;
        dpt_body_set_pose(needle.rig.world, behind, &pose);
        rig_step(&needle.rig);
        const double gained = needle.rig.force.energy - stored - needle.rig.force.body_work;
        CHECK(gained <= 1e-9 + CLEARANCE * fabs(needle_force(&needle)), "tick %d: %g J gained", i, gained);
        stored = needle.rig.force.energy;
        work += needle.rig.force.body_work;
    }
    CHECK(needle_force(&needle) < -0.2 && work > stored, "%g N, %g J of work, %g J stored", needle_force(&needle), work,
          stored);
    const dpt_channel second = channel_of(&needle, behind, 2);
    const double speed = (depth - second.depth) / needle.rig.dt;
    CHECK(fabs(speed - 1e-3) < 1e-4, "it slips at %g m/s", speed);
    const double wanted = -(rough.shaft_friction + rough.shaft_viscosity * speed) * second.inside;
    CHECK(fabs(second.friction - wanted) < 0.02 * fabs(wanted), "%g N, not %g", second.friction, wanted);
    needle_close(&needle);
}

/* The body turns under a hand that rests aside of the hole: the spring gains what the body puts in. */
static void a_body_that_turns(void)
{
    for (uint32_t is_locked = 0; is_locked < 2; is_locked++) {
        struct needle_rig needle;
        dpt_tool_settings settings = { .size = sizeof settings };
        dpt_body_settings gel = needle_gel();
        gel.shaft_friction = gel.cutting_force = 0;
        needle_open(&needle, &gel, 1);
        dpt_tool_get_settings(needle.rig.world, needle.rig.tool, &settings);
        settings.lock_rotation = is_locked;
        CHECK(dpt_tool_set_settings(needle.rig.world, needle.rig.tool, &settings) == DPT_OK, "settings");
        needle_go(&needle, 0.03, 0.02);
        needle.at[0] += 0.003;
        needle_step(&needle);
        const double before = needle.rig.force.energy, x[3] = { 0, 1, 0 };
        double work = 0;
        for (int i = 1; i <= 1000; i++) {
            dpt_pose pose = DPT_POSE_IDENTITY;
            pose_orient(&pose, x, -1e-4 * i);
            dpt_body_set_pose(needle.rig.world, needle.rig.body, &pose);
            rig_step(&needle.rig);
            work += needle.rig.force.body_work;
        }
        const double gained = needle.rig.force.energy - before;
        CHECK(fabs(gained) > 1e-4 && fabs(work - gained) < 0.01 * fabs(gained), "locked %u: %g J of work, %g J stored",
              is_locked, work, gained);
        needle_close(&needle);
    }
}

/* Out of the second body, but not of the first, and on again: the hole is there, and is not cut again. */
static void a_hole_behind_the_first(void)
{
    struct needle_rig needle;
    const dpt_body_settings gel = needle_gel();
    const dpt_body behind = open_two(&needle, &gel, &gel, BEHIND);
    needle_go(&needle, 0.105, 0.02);
    for (int again = 0; again < 3; again++) {
        needle_go(&needle, 0.07, 0.02);
        CHECK(!(channel_of(&needle, behind, 2).flags & DPT_CHANNEL_FLAG_OCCUPIED), "it is not out of the second");
        CHECK(needle.rig.force.flags == DPT_FORCE_FLAG_INSERTED, "it is out of the first");
        double most = 0;
        while (needle.depth < 0.1) {
            needle.depth += 2e-5;
            needle_step(&needle);
            most = fmax(most, needle_force(&needle));
            CHECK(needle.rig.force.flags == DPT_FORCE_FLAG_INSERTED, "at %g: flags %u", needle.depth,
                  needle.rig.force.flags);
        }
        const dpt_channel second = channel_of(&needle, behind, 2);
        CHECK(second.flags & DPT_CHANNEL_FLAG_OCCUPIED && second.depth > 0.002, "it is not in again");
        CHECK(most < gel.shaft_friction * 0.1, "%g N: it has cut again", most);
    }
    needle_close(&needle);
}

/* A body stands so near beside the shaft that it leaves less than the gap of a contact: the needle goes on all the same. */
static void a_body_beside_the_shaft(void)
{
    struct needle_rig needle;
    const dpt_body_settings gel = needle_gel();
    dpt_pose pose = at_height(0.0805);
    needle_open(&needle, &gel, 1);
    pose.position[0] = 0.011 + 0.06 + NEEDLE_RADIUS + 1e-4;
    const dpt_body beside = rig_add_body(&needle.rig, needle.box.mesh, &pose);
    needle_go(&needle, 0.03, 0.02);
    while (pose.position[0] > 0.071 + NEEDLE_RADIUS + 1.1e-7) {
        pose.position[0] = fmax(0.071 + NEEDLE_RADIUS + 1.1e-7, pose.position[0] - 1e-6);
        dpt_body_set_pose(needle.rig.world, beside, &pose);
        needle_step(&needle);
    }
    CHECK(needle.rig.force.flags == DPT_FORCE_FLAG_INSERTED, "flags %u", needle.rig.force.flags);
    const double tip = needle_tip(&needle);
    needle_go(&needle, 0.035, 0.02);
    CHECK(fabs(needle_tip(&needle) - tip - 0.005) < 5e-4, "it went by %g", needle_tip(&needle) - tip);
    needle_close(&needle);
}

/*
 * A budget that is spent beside a body stops the needle, and no body: none feels a push of the tip. It goes on when the
 * hand rests.
 */
static void a_budget_is_no_wall(void)
{
    struct needle_rig needle;
    const dpt_body_settings gel = needle_gel();
    dpt_pose pose = at_height(0.0805);
    dpt_wrench wrench;
    needle_open_within(&needle, &gel, 1, 0, 1);
    pose.position[0] = 0.011 + 0.06 + NEEDLE_RADIUS + 2e-4;
    const dpt_body beside = rig_add_body(&needle.rig, needle.box.mesh, &pose);
    needle_go(&needle, 0.004, 0.02);
    for (int i = 0; i < 40; i++) {
        needle.depth += 1e-3;
        needle_step(&needle);
        dpt_body_get_wrench(needle.rig.world, beside, &wrench);
        CHECK(length3(wrench.force) == 0, "tick %d: %g N on what it does not touch", i, length3(wrench.force));
    }
    needle_go(&needle, 0.047, 0.02);
    const double wanted = 0.5 + 40 * needle_channel(&needle).inside;
    CHECK(fabs(needle_force(&needle) - wanted) < 0.02, "%g N, not %g", needle_force(&needle), wanted);
    needle_close(&needle);
}

enum { FINE_TRIANGLES = 12 * 40 * 40, SMALL_BUDGET = 6, REST = 2000 };

/* How a needle came into a box of many triangles. */
struct pierced {
    dpt_channel channel; /* id 0: it did not */
    int waited;          /* ticks that are flagged as behind before it is in */
    uint32_t most;       /* units of a tick */
};

/*
 * The hand goes 4 mm down and rests there, but for a tremor, until the needle is in. Another such box, if its pose is not
 * NULL, has the lower number.
 */
static struct pierced pierce_fine(uint32_t budget, double tremor, const dpt_pose *other)
{
    struct needle_rig needle;
    struct solid fine;
    struct pierced pierced = { .channel.id = 0 };
    const dpt_body_settings gel = needle_gel();
    dpt_world_info info = { .size = sizeof info };
    needle_open_within(&needle, NULL, 1, budget, 0);
    dpt_body_remove(needle.rig.world, needle.rig.body);
    CHECK(solid_from_shape(&fine, "box", FINE_TRIANGLES), "no box");
    const dpt_pose *poses[2] = { other, NULL };
    for (int i = other ? 0 : 1; i < 2; i++)
        CHECK(dpt_body_set_settings(needle.rig.world, rig_add_body(&needle.rig, fine.mesh, poses[i]), &gel) == DPT_OK,
              "settings");
    rig_place(&needle.rig);
    for (int rested = 0; rested < REST && !needle_channels(&needle, NULL, 0);) {
        const int rests = needle.depth >= 0.004;
        needle.depth += rests ? (++rested % 2 ? tremor : -tremor) : 2e-5;
        needle_step(&needle);
        pierced.waited += (needle.rig.force.flags & DPT_FORCE_FLAG_BEHIND) != 0;
    }
    dpt_world_get_info(needle.rig.world, &info);
    pierced.most = info.work;
    for (int i = 0; i < REST; i++)
        needle_step(&needle);
    if (needle_channels(&needle, NULL, 0))
        pierced.channel = needle_channel(&needle);
    solid_close(&fine);
    needle_close(&needle);
    return pierced;
}

/*
 * A small budget finds the walls of a fine box in several ticks, in which the wall holds. Then it ruptures where it would
 * have with any budget.
 */
static void a_small_budget_pierces(void)
{
    const struct pierced whole = pierce_fine(0, 0.0, NULL);
    CHECK(whole.channel.id && !whole.waited, "it waits without a budget");
    for (int trembles = 0; trembles < 2; trembles++) {
        const struct pierced part = pierce_fine(SMALL_BUDGET, trembles * 1e-7, NULL);
        CHECK(part.channel.id && part.waited > 2 && part.most <= SMALL_BUDGET, "%d ticks waited, %u units in a tick",
              part.waited, part.most);
        CHECK(fabs(part.channel.entry[0] - whole.channel.entry[0]) < 1e-6 &&
                  fabs(part.channel.entry[2] - whole.channel.entry[2]) < 1e-6 && part.channel.ruptures == 1 &&
                  part.channel.layers == 1 && part.channel.depth > 1e-4,
              "another channel: at %g %g, %u ruptures, %g m in", part.channel.entry[0], part.channel.entry[2],
              part.channel.ruptures, part.channel.depth);
    }
}

/* The tip is in the box about a body that it does not touch: that takes nothing of what the search for walls has found. */
static void a_body_beside_ends_no_search(void)
{
    dpt_pose turned = { { 0.081, -0.053, 0.0 }, { 0.92387953251128674, 0.0, 0.0, 0.38268343236508977 } };
    const struct pierced part = pierce_fine(SMALL_BUDGET, 0.0, &turned);
    CHECK(part.channel.id && part.waited > 2 && part.channel.depth > 1e-4, "%d ticks waited, %g m in", part.waited,
          part.channel.depth);
}

enum { FAN = 1200 };

/* The needle's push on the top of a double cone of many triangles, N, which all have that corner. */
static int pierces_top(uint32_t budget)
{
    static double corners[3 * (FAN + 2)];
    static uint32_t triangles[6 * FAN];
    struct needle_rig needle;
    struct solid cone;
    dpt_body_settings gel = needle_gel();
    gel.static_friction = gel.kinetic_friction = 1.0;
    needle_open_within(&needle, NULL, 1, budget, 0);
    for (uint32_t i = 0; i < FAN; i++) {
        const double angle = 6.283185307179586 * i / FAN;
        const uint32_t next = (i + 1) % FAN, made[6] = { FAN, i, next, FAN + 1, next, i };
        corners[3 * i] = needle.at[0] + 0.05 * cos(angle);
        corners[3 * i + 1] = needle.at[1] + 0.05 * sin(angle);
        corners[3 * i + 2] = 0.03;
        memcpy(triangles + 6 * i, made, sizeof made);
    }
    for (int i = 0; i < 2; i++) {
        corners[3 * (FAN + i)] = needle.at[0];
        corners[3 * (FAN + i) + 1] = needle.at[1];
        corners[3 * (FAN + i) + 2] = i ? 0.0 : NEEDLE_TOP;
    }
    CHECK(solid_from_arrays(&cone, "cone", corners, FAN + 2, triangles, 2 * FAN), "no cone");
    dpt_body_remove(needle.rig.world, needle.rig.body);
    CHECK(dpt_body_set_settings(needle.rig.world, rig_add_body(&needle.rig, cone.mesh, NULL), &gel) == DPT_OK,
          "settings");
    rig_place(&needle.rig);
    /* Where it is, is found while it rests: a search goes over all triangles, as all are as near. */
    for (int i = 0; i < REST && needle.rig.force.reason != DPT_FORCE_FREE; i++)
        needle_step(&needle);
    needle_go(&needle, 0.004, 0.02);
    for (int i = 0; i < REST && !needle_channels(&needle, NULL, 0); i++)
        needle_step(&needle);
    const int pierces = needle_channels(&needle, NULL, 0) == 1;
    needle_close(&needle);
    solid_close(&cone);
    return pierces;
}

/* Where all triangles are as near to the tip, to find which it touches takes more than a tick's work. */
static void no_budget_holds_a_wall_for_good(void)
{
    for (uint32_t budget = 4; budget <= 400; budget += budget < 60 ? 8 : 20)
        CHECK(pierces_top(budget), "%u units hold it", budget);
}

/* Where the far wall of one body and the near wall of the next are one for the tip, each takes a push of its own. */
static void one_wall_a_tick(void)
{
    struct needle_rig needle;
    const dpt_body_settings gel = needle_gel();
    uint32_t was = 0;
    open_two(&needle, &gel, &gel, -0.08 - 1e-7);
    while (needle.depth < 0.099) {
        needle.depth += 2e-5;
        needle_step(&needle);
        dpt_channel channels[2];
        const uint32_t count = needle_channels(&needle, channels, 2);
        const uint32_t open = (count > 0 ? channels[0].ruptures : 0) + (count > 1 ? channels[1].ruptures : 0);
        CHECK(open <= was + 1, "at %g: %u walls in one tick", needle.depth, open - was);
        was = open;
    }
    CHECK(was == 3, "%u walls", was);
    needle_close(&needle);
}

static dpt_tool add_needle(struct needle_rig *needle)
{
    const dpt_tool tool = rig_add_tool(&needle->rig, needle->rig.segments, 1);
    dpt_tool_settings settings = { .size = sizeof settings };
    dpt_tool_get_settings(needle->rig.world, tool, &settings);
    settings.piercing = DPT_PIERCING_B;
    CHECK(dpt_tool_set_settings(needle->rig.world, tool, &settings) == DPT_OK, "settings");
    return tool;
}

/* A needle that rests before a wall for want of a channel goes on when another needle is removed. */
static void room_that_another_needle_leaves(void)
{
    struct needle_rig needle;
    const dpt_body_settings gel = needle_gel();
    needle_open(&needle, &gel, 1);
    const dpt_tool other = add_needle(&needle);
    dpt_pose inside = needle.rig.device;
    inside.position[0] -= 0.03;
    inside.position[2] -= 0.035;
    dpt_tool_set_pose(needle.rig.world, other, &inside);
    CHECK(dpt_tool_insert(needle.rig.world, other) == DPT_OK, "the other one is not put in");
    needle_go(&needle, 0.004, 0.02);
    for (int i = 0; i < 200; i++)
        needle_step(&needle);
    CHECK(needle.rig.force.flags == DPT_FORCE_FLAG_CHANNELS_FULL, "flags %u", needle.rig.force.flags);
    dpt_tool_remove(needle.rig.world, other);
    for (int i = 0; i < 20; i++)
        needle_step(&needle);
    CHECK(needle.rig.force.flags & DPT_FORCE_FLAG_INSERTED, "flags %u", needle.rig.force.flags);
    needle_close(&needle);
}

/* A world that is reset numbers channels as a new one. */
static void ids_after_a_reset(void)
{
    struct needle_rig needle;
    const dpt_body_settings gel = needle_gel();
    needle_open(&needle, &gel, 1);
    for (int i = 0; i < 2; i++) {
        needle_go(&needle, 0.01, 0.02);
        CHECK(needle_channel(&needle).id == 1, "id %u", needle_channel(&needle).id);
        needle.depth = -0.005;
        dpt_world_reset(needle.rig.world);
        needle_step(&needle);
    }
    needle_close(&needle);
}

int main(void)
{
    TEST(a_body_that_comes_to_the_tip);
    TEST(a_second_body_that_slides_along);
    TEST(a_body_that_turns);
    TEST(a_hole_behind_the_first);
    TEST(a_body_beside_the_shaft);
    TEST(a_budget_is_no_wall);
    TEST(a_small_budget_pierces);
    TEST(a_body_beside_ends_no_search);
    TEST(no_budget_holds_a_wall_for_good);
    TEST(one_wall_a_tick);
    TEST(room_that_another_needle_leaves);
    TEST(ids_after_a_reset);
    return check_report();
}
