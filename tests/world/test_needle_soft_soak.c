/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Long runs of a needle on a soft body, with a torus before it that cannot be pierced.
 *
 *     test_needle_soft_soak [TICKS = 20000 [SEED = 1]]
 *
 * A hand moves the needle at up to 0.3 m/s, to and fro and aside, and turns it; integrators, stiffnesses, bodies that
 * sway, budgets and teleports vary. After each tick all triangles are looked at:
 *
 *   - The needle is nowhere nearer to the torus than its radius, but for what tissue may dent it.
 *   - Of the soft body that it is in, the axis goes through as many walls as have ruptured at most.
 *   - Where a wall more is open than ever was in that channel, the tip is at it: none opens far ahead.
 *   - The force is finite.
 *   - Parts of the body that lean on the shaft from outside do not go through it, but in one tick of 2,000: then the axis
 *     goes through three walls or more.
 *
 * What counts as inside (DPT_FORCE_INSIDE) is not judged.
 */
#include "world/soft_needle.h"

enum { RUN_TICKS = 1000, CHANNELS_MAX = 1000 };

/* m: so near to the tip is a wall that ruptures, also where it is slanted and swings back. */
#define AHEAD 0.003

/* m: where the depth changes by more in a tick the surface has folded onto the shaft, and that is the entry now. */
#define FOLD 0.004

/* As a share of the radius: so far tissue may dent a tool on its way (src/proxy/proxy_step.c). */
#define DENTED 0.5

static unsigned long ticks_wanted = 20000;
static uint64_t first_seed = 1;

static struct {
    unsigned long judged, channels, ruptures, holes, through, folded;
} seen;

struct run {
    struct soft_needle needle;
    struct tissue_body *torus;
    oracle_mesh *all;
    uint64_t seed;
    double speed[4], way, aside[2], lean;
    int sways;
    uint32_t open[CHANNELS_MAX]; /* the most walls that were open in a channel, by its id */
    double depth[CHANNELS_MAX];  /* of the tip in the last tick that it was in it */
};

static int open_run(struct run *run, uint64_t seed)
{
    *run = (struct run){ .seed = seed };
    struct tissue_def def = soft_needle_liver(tissue_integrators[seed % 3]);
    struct tissue_def torus = { .shape = "torus", .triangles = 64, .place = { 0.12, 0.0, 0.0 } };
    dpt_body_settings gel = soft_needle_gel(random_in(&run->seed, 0.0, 40.0));
    def.young = random_in(&run->seed, 3e3, 3e4);
    /* A box is thin enough to be gone through. */
    if (seed / 3 % 2 == 0) {
        def.shape = "box";
        def.triangles = 432;
    }
    gel.puncture_force = random_in(&run->seed, 0.1, 0.6);
    gel.shaft_viscosity = seed % 2 ? random_in(&run->seed, 0.0, 40.0) : 0.0;
    gel.shaft_stiffness = seed % 4 == 1 ? 3e4 : 0.0;
    run->sways = seed % 5 == 0;
    if (!soft_needle_open_within(&run->needle, &def, &gel, random_in(&run->seed, 100.0, 2000.0),
                                 seed % 7 == 3 ? 20000 : 0))
        return 0;
    run->torus = tissue_rig_add_rigid(&run->needle.tissue, &torus);
    tissue_rig_place(&run->needle.tissue);
    run->all = run->torus ? tissue_surface(&run->needle.tissue, run->torus) : NULL;
    return run->all != NULL;
}

static void move_hand(struct run *run, int tick)
{
    struct soft_needle *needle = &run->needle;
    const double axis[3] = { 0.0, 1.0, 0.0 };
    if (tick % 125 == 0)
        for (int k = 0; k < 4; k++)
            run->speed[k] = random_in(&run->seed, -1.0, 1.0);
    if (tick % 250 == 0)
        run->speed[0] = 1.0;
    needle->depth += 3e-4 * run->speed[0];
    needle->depth = fmin(fmax(needle->depth, -0.02), 0.09);
    run->aside[0] = fmin(fmax(run->aside[0] + 2e-5 * run->speed[1], -0.01), 0.01);
    run->aside[1] = fmin(fmax(run->aside[1] + 2e-5 * run->speed[2], -0.01), 0.01);
    run->lean = fmin(fmax(run->lean + 5e-4 * run->speed[3], -0.3), 0.3);
    needle->tool->device.position[0] = NEEDLE_LATERAL + run->aside[0];
    needle->tool->device.position[1] = 0.002 + run->aside[1];
    pose_orient(&needle->tool->device, axis, run->lean);
    if (random_bits(&run->seed) % 500 == 0) {
        needle->depth = -0.015;
        soft_needle_aim(needle);
        dpt_tool_teleport(needle->tissue.rig.world, needle->tool->id, &needle->tool->device);
    }
    if (!run->sways)
        return;
    dpt_pose pose = DPT_POSE_IDENTITY;
    pose.position[0] = 0.002 * sin(0.02 * tick);
    dpt_body_set_pose(needle->tissue.rig.world, needle->body->id, &pose);
}

/* How often the axis of the tool goes through the soft body's surface, from its point on. */
static uint32_t crossings(const struct run *run, const double ends[6])
{
    const struct soft_needle *needle = &run->needle;
    uint32_t triangles, vertices, count = 0;
    const float *at = tissue_vertices(&needle->tissue, needle->body, &vertices);
    const uint32_t *corners = tissue_corners(needle->body, &triangles);
    dpt_pose pose;
    double local[6], share;
    dpt_body_get_pose(needle->tissue.rig.world, needle->body->id, &pose);
    pose_local(&pose, ends, local);
    pose_local(&pose, ends + 3, local + 3);
    for (uint32_t t = 0; t < triangles; t++)
        count += (uint32_t)soft_needle_crosses(local, at, corners + 3 * (size_t)t, &share);
    return count;
}

static void a_wall_opens_at_the_tip(struct run *run, int tick, const dpt_channel *channel, const double ends[6])
{
    double ahead[6];
    const double share = AHEAD / NEEDLE_LENGTH;
    CHECK(channel->id < CHANNELS_MAX, "tick %d: %u channels", tick, channel->id);
    if (channel->id >= CHANNELS_MAX)
        return;
    const int has_folded = fabs(channel->depth - run->depth[channel->id]) > FOLD;
    run->depth[channel->id] = channel->depth;
    if (channel->ruptures <= run->open[channel->id])
        return;
    run->open[channel->id] = channel->ruptures;
    if (has_folded)
        return;
    memcpy(ahead, ends, sizeof ahead);
    for (int k = 0; k < 3; k++)
        ahead[k] -= share * (ends[3 + k] - ends[k]);
    CHECK(channel->ruptures <= crossings(run, ahead), "tick %d: %u walls are open, and %u are near", tick,
          channel->ruptures, crossings(run, ahead));
}

static void judge(struct run *run, int tick, double force)
{
    const struct soft_needle *needle = &run->needle;
    dpt_channel channels[6];
    const uint32_t count = soft_needle_channels(needle, channels, 6), flags = needle->tool->force.flags;
    dpt_pose proxy;
    double ends[6];
    uint32_t triangle, ruptures = 0;
    CHECK(isfinite(force), "tick %d: not finite", tick);
    if (needle->tool->force.reason == DPT_FORCE_INSIDE)
        return;
    CHECK(dpt_tool_get_proxy(needle->tissue.rig.world, needle->tool->id, &proxy) == DPT_OK, "no proxy");
    pose_point(&proxy, needle->tool->segment.a, ends);
    pose_point(&proxy, needle->tool->segment.b, ends + 3);
    double local[6];
    for (int k = 0; k < 6; k++)
        local[k] = ends[k] - run->torus->place[k % 3];
    const double distance = oracle_brute(run->all, local, &triangle);
    CHECK(distance > (1.0 - DENTED) * NEEDLE_RADIUS, "tick %d: %g m in the torus", tick, NEEDLE_RADIUS - distance);
    seen.judged++;
    for (uint32_t i = 0; i < count; i++)
        if (channels[i].flags & DPT_CHANNEL_FLAG_OCCUPIED) {
            ruptures += channels[i].ruptures;
            a_wall_opens_at_the_tip(run, tick, &channels[i], ends);
        }
    seen.holes += count > 0;
    seen.channels += ruptures > 0;
    seen.ruptures += (flags & DPT_FORCE_FLAG_RUPTURE) != 0;
    if (!(flags & DPT_FORCE_FLAG_INSERTED))
        return;
    const uint32_t through = crossings(run, ends);
    seen.through += through == 2;
    seen.folded += through > 2;
    CHECK(through <= ruptures || through > 2, "tick %d: through %u walls of %u", tick, through, ruptures);
}

static void it_goes_through_what_it_has_pierced_alone(void)
{
    struct run run;
    for (unsigned long done = 0; done < ticks_wanted; done += RUN_TICKS) {
        if (!open_run(&run, first_seed + done / RUN_TICKS))
            return;
        for (int tick = 0; tick < RUN_TICKS; tick++) {
            move_hand(&run, tick);
            judge(&run, tick, soft_needle_tick(&run.needle));
        }
        oracle_brute_close(run.all);
        soft_needle_close(&run.needle);
    }
    printf(
        "    %lu ticks judged, %lu in channels, %lu with a rupture, %lu with a hole, %lu right through, %lu folded\n",
        seen.judged, seen.channels, seen.ruptures, seen.holes, seen.through, seen.folded);
    CHECK(seen.through || ticks_wanted < 5000, "it never goes right through");
    CHECK(seen.folded <= ticks_wanted / 2000, "bodies lean on the shaft in %lu ticks", seen.folded);
    CHECK(seen.judged > ticks_wanted / 2, "most ticks are inside");
    CHECK(seen.channels > ticks_wanted / 10 && seen.ruptures, "it is hardly in");
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &ticks_wanted, &first_seed);
    TEST(it_goes_through_what_it_has_pierced_alone);
    return check_report();
}
