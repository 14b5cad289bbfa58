/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Long runs of a needle: it goes through what it has pierced, and through nothing else.
 *
 *     test_needle_soak [TICKS = 100000 [SEED = 1]]
 *
 * A hand moves a needle at up to 1 m/s among boxes that can be pierced and a torus and a sheet that cannot, with jumps
 * of up to 0.3 m, teleports, budgets, and bodies that move. After each tick all triangles of all bodies are looked at:
 *
 *   - A body that the needle is in no channel of is not nearer than its radius.
 *   - In a channel the needle is on its line: it never leaves it sideways.
 *   - Of a body that it is in, a ball of its radius that is led along its axis from the rear end to the tip touches the surface
 *     in at most as many stretches as walls have ruptured. It is led by steps, in each 20th tick.
 *
 * What counts as inside (DPT_FORCE_INSIDE) has no force, and is not judged.
 */
#include "insertion/needle_rig.h"

enum { RUN_TICKS = 1000, BODIES = 4, LED_EACH = 20, LED_STEPS = 1000 };

static unsigned long ticks_wanted = 100000;
static uint64_t first_seed = 1;

/* What happened, so that a run that pierces nothing fails. */
static struct {
    unsigned long judged, inside, channels, ruptures, led;
} seen;

static struct solid box, torus, hub;

struct run {
    struct rig rig;
    uint64_t seed;
    dpt_body bodies[BODIES];
    const struct solid *solids[BODIES];
    dpt_pose poses[BODIES];
    double radius, speed[6];
    int moves;
};

static void open_run(struct run *run, uint64_t seed)
{
    static const struct solid *const kinds[BODIES] = { &box, &torus, &hub, &box };
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    dpt_tool_settings settings = { .size = sizeof settings };
    *run = (struct run){ .seed = seed };
    run->radius = random_in(&run->seed, 0.0002, 0.0015);
    const dpt_segment shaft = { { 0, 0, 0 }, { 0, 0, NEEDLE_LENGTH }, run->radius };
    def.max_channels = 3;
    if (seed % 4 == 1)
        def.budget = 2000;
    if (seed % 4 == 2)
        def.sweep_budget = 200;
    run->moves = seed % 3 == 0;
    rig_open(&run->rig, &def, NULL, &shaft, 1);
    for (int i = 0; i < BODIES; i++) {
        run->solids[i] = kinds[i];
        run->poses[i] = pose_any(&run->seed, 0.02);
        run->poses[i].position[2] -= 0.09 * i;
        run->bodies[i] = rig_add_body(&run->rig, kinds[i]->mesh, &run->poses[i]);
        dpt_body_settings gel = needle_gel();
        gel.puncture_force = random_in(&run->seed, 0.2, 2);
        gel.shaft_friction = random_in(&run->seed, 0, 60);
        gel.static_friction = gel.kinetic_friction = seed % 2 ? 0.8 : 0.0;
        if (kinds[i] == &box)
            CHECK(dpt_body_set_settings(run->rig.world, run->bodies[i], &gel) == DPT_OK, "settings");
    }
    dpt_tool_get_settings(run->rig.world, run->rig.tool, &settings);
    settings.piercing = DPT_PIERCING_B;
    CHECK(dpt_tool_set_settings(run->rig.world, run->rig.tool, &settings) == DPT_OK, "settings");
    run->rig.device.position[2] = 0.3;
}

/* The hand: mostly along the needle, which points at a body, to and fro; sometimes a jump. */
static void move_hand(struct run *run, int tick)
{
    dpt_pose *device = &run->rig.device;
    const double z[3] = { 0, 0, 1 };
    double axis[3];
    if (tick % 250 == 0) {
        const dpt_pose *goal = &run->poses[tick / 250 % 2 ? 0 : random_bits(&run->seed) % BODIES];
        double toward[3];
        random_unit(&run->seed, toward);
        /* Three of four times about along an axis of the body. */
        if (random_bits(&run->seed) % 4) {
            double unit[3] = { 0, 0, 0 }, along[3];
            unit[random_bits(&run->seed) % 3] = random_bits(&run->seed) % 2 ? 1 : -1;
            turn3(goal->orientation, unit, along);
            for (int k = 0; k < 3; k++)
                toward[k] = along[k] + 0.2 * toward[k];
            unit3(toward);
        }
        turn_from_z(toward, device->orientation);
        turn3(device->orientation, z, axis);
        for (int k = 0; k < 3; k++)
            device->position[k] = goal->position[k] - 0.2 * axis[k] + random_in(&run->seed, -0.02, 0.02);
        dpt_tool_teleport(run->rig.world, run->rig.tool, device);
        run->speed[0] = random_in(&run->seed, 0.2, 1.0);
    }
    if (tick % 250 == 100 || tick % 250 == 180)
        run->speed[0] = random_in(&run->seed, -1.0, 1.0);
    turn3(device->orientation, z, axis);
    for (int k = 0; k < 3; k++) {
        run->speed[1 + k] = 0.98 * run->speed[1 + k] + random_in(&run->seed, -0.01, 0.01);
        device->position[k] += 1e-3 * (run->speed[0] * axis[k] + run->speed[1 + k]);
    }
    if (random_bits(&run->seed) % 400 == 0)
        for (int k = 0; k < 3; k++)
            device->position[k] += random_in(&run->seed, -0.15, 0.15);
    double about[3];
    random_unit(&run->seed, about);
    dpt_pose turn = DPT_POSE_IDENTITY;
    pose_orient(&turn, about, random_in(&run->seed, 0, 0.004));
    pose_turn_by(device, turn.orientation);
}

static void move_bodies(struct run *run)
{
    for (int i = 0; i < BODIES && run->moves; i++) {
        for (int k = 0; k < 3; k++)
            run->poses[i].position[k] += random_in(&run->seed, -2e-5, 2e-5);
        dpt_body_set_pose(run->rig.world, run->bodies[i], &run->poses[i]);
    }
}

static void local_ends(const struct run *run, int body, const double ends[6], double local[6])
{
    pose_local(&run->poses[body], ends, local);
    pose_local(&run->poses[body], ends + 3, local + 3);
}

/* In how many stretches of the axis a ball touches the body. */
static uint32_t stretches(const struct run *run, int body, const double ends[6])
{
    double local[6];
    uint32_t count = 0;
    int was_touching = 0;
    local_ends(run, body, ends, local);
    for (int i = 0; i <= LED_STEPS; i++) {
        double at[6];
        uint32_t triangle;
        point_at(local, (double)i / LED_STEPS, at);
        memcpy(at + 3, at, 3 * sizeof *at);
        const int is_touching = oracle_brute(run->solids[body]->brute, at, &triangle) < run->radius;
        count += is_touching && !was_touching;
        was_touching = is_touching;
    }
    return count;
}

/* Where two bodies move against each other, one of the lines may be a tenth of the radius aside. */
static void judge_line(const struct run *run, const double ends[6], const dpt_channel *channel, int tick)
{
    const double most = run->moves ? 0.1 * run->radius + 1e-6 : 1e-9;
    double shaft[3], from[3], across[3];
    for (int k = 0; k < 3; k++) {
        shaft[k] = (ends[3 + k] - ends[k]) / NEEDLE_LENGTH;
        from[k] = ends[3 + k] - channel->entry[k];
    }
    cross3(from, channel->axis, across);
    CHECK(apart(shaft, channel->axis) * NEEDLE_LENGTH < most && length3(across) < most,
          "tick %d: %g m aside of its line", tick, length3(across));
}

static void judge(struct run *run, int tick)
{
    dpt_channel channels[4] = { { .size = sizeof *channels } };
    uint32_t count = 0;
    double ends[6];
    if (run->rig.force.reason == DPT_FORCE_INSIDE || run->rig.force.reason == DPT_FORCE_UNDECIDED) {
        seen.inside++;
        return;
    }
    seen.judged++;
    seen.ruptures += (run->rig.force.flags & DPT_FORCE_FLAG_RUPTURE) != 0;
    rig_proxy_ends(&run->rig, 0, ends);
    dpt_tool_get_channels(run->rig.world, run->rig.tool, channels, 4, &count);
    int is_first = 1;
    for (int i = 0; i < BODIES; i++) {
        const dpt_channel *in = NULL;
        double local[6];
        uint32_t triangle;
        for (uint32_t k = 0; k < count; k++)
            if (channels[k].body == run->bodies[i] && channels[k].flags & DPT_CHANNEL_FLAG_OCCUPIED)
                in = &channels[k];
        local_ends(run, i, ends, local);
        if (!in) {
            const double distance = oracle_brute(run->solids[i]->brute, local, &triangle);
            CHECK(distance > run->radius, "tick %d: %g m inside of body %d", tick, run->radius - distance, i);
            continue;
        }
        seen.channels += (unsigned long)is_first;
        is_first = 0;
        CHECK(run->solids[i] == &box, "tick %d: body %d is pierced", tick, i);
        judge_line(run, ends, in, tick);
        if (tick % LED_EACH)
            continue;
        seen.led++;
        CHECK(stretches(run, i, ends) <= in->ruptures, "tick %d: %u stretches, %u ruptures", tick,
              stretches(run, i, ends), in->ruptures);
    }
}

static void a_needle_goes_through_what_it_has_pierced_alone(void)
{
    struct run run;
    for (unsigned long done = 0; done < ticks_wanted; done += RUN_TICKS) {
        open_run(&run, first_seed + done / RUN_TICKS);
        for (int tick = 0; tick < RUN_TICKS; tick++) {
            move_hand(&run, tick);
            move_bodies(&run);
            rig_step(&run.rig);
            judge(&run, tick);
        }
        rig_close(&run.rig);
    }
    printf("    %lu ticks judged, %lu inside, %lu in channels, %lu with a rupture, %lu led\n", seen.judged, seen.inside,
           seen.channels, seen.ruptures, seen.led);
    CHECK(seen.judged > ticks_wanted / 2, "most ticks are inside");
    CHECK(seen.channels > ticks_wanted / 20, "it is hardly in");
    CHECK(seen.led > seen.channels / LED_EACH / 2, "it is hardly looked at");
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &ticks_wanted, &first_seed);
    if (!solid_from_shape(&box, "box", 12) || !solid_from_shape(&torus, "torus", 64) ||
        !solid_from_shape(&hub, "hub", 40))
        return 1;
    TEST(a_needle_goes_through_what_it_has_pierced_alone);
    solid_close(&box);
    solid_close(&torus);
    solid_close(&hub);
    return check_report();
}
