/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a proxy that lies on an organ costs, in basic blocks a tick.
 *
 * It is the same however the organ is turned: what its sweep is given, the directions of contacts among it, is in the
 * body's frame. Directions in the world's take 3.4 % more where the body is turned. That they help at all is a matter
 * of time, which force-test on a liver shows. Which of several triangles in the way of a proxy is found first is a matter
 * of rounding: over 2,000 ticks it makes 1 %, over 6,000 a tenth of that.
 *
 * A ball has one contact, whose proof is one search. Where the proof of one sample of its axis does not count for the
 * others, there are 23, and twice as much work as in the rest of the tick.
 *
 * A line that is led at 1 m/s among spikes is tens of millimetres behind its device in many ticks. Such a tick ends when
 * it has taken long; one that tries each way to its end takes five times as much.
 *
 *     test_proxy_work [PER CENT of the ticks = 100]
 */
#include "lib/block_count.h"
#include "lib/hand_motion.h"
#include "lib/rig.h"
#include "lib/solid.h"

static const dpt_segment rod = { { -0.03, 0, 0 }, { 0.03, 0, 0 }, 0.002 };
static const dpt_segment ball = { { 0, 0, 0 }, { 0, 0, 0 }, 0.001 };

/* Turn a pose with its body, which stays at the origin. */
static void turn_with_body(dpt_pose *pose, const dpt_pose *body)
{
    turn3(body->orientation, pose->position, pose->position);
    turn_times(body->orientation, pose->orientation, pose->orientation);
}

/* Basic blocks of a tool that comes down on the body, and is led over it and turned as it lies. */
static uint64_t blocks_of_way(const struct solid *solid, const dpt_segment *segment, const dpt_pose *body,
                              uint32_t contacts, uint64_t ticks, uint64_t seed)
{
    const double z[3] = { 0, 0, 1 };
    uint64_t blocks = 0, lying = 0;
    double at[3] = { 0, 0, 0 }, way[2] = { 0, 0 }, turn = 0;
    struct rig rig;
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    def.max_contacts = contacts;
    rig_open(&rig, &def, solid->mesh, segment, 1);
    dpt_body_teleport(rig.world, rig.body, body);
    for (uint64_t t = 0; t < ticks; t++) {
        for (int k = 0; k < 2; k++) {
            const double middle = 0.5 * (solid->info.box_min[k] + solid->info.box_max[k]);
            way[k] = 0.98 * way[k] + random_in(&seed, -5e-5, 5e-5) - 1e-4 * at[k];
            at[k] += way[k];
            rig.device.position[k] = middle + at[k];
        }
        turn += random_in(&seed, -0.01, 0.01);
        rig.device.position[2] = solid->info.box_max[2] + 0.01 - fmin(0.04, 2e-4 * (double)t);
        pose_orient(&rig.device, z, turn);
        turn_with_body(&rig.device, body);
        if (t == 0)
            rig_place(&rig);
        const uint64_t begin = block_count;
        rig_step(&rig);
        blocks += block_count - begin;
        lying += rig.force.reason == DPT_FORCE_ACTS;
    }
    CHECK(lying > ticks / 3, "%u of %u ticks", (unsigned)lying, (unsigned)ticks);
    rig_close(&rig);
    return blocks;
}

/* Basic blocks a tick, over several ways: of one alone, folds that rounding decides make 1.5 %. */
static double blocks_of(const struct solid *solid, const dpt_segment *segment, const dpt_pose *body, uint32_t contacts)
{
    const uint64_t ticks = part_of(1000), ways = 8;
    uint64_t blocks = 0;
    for (uint64_t way = 1; way <= ways; way++)
        blocks += blocks_of_way(solid, segment, body, contacts, ticks, way);
    return (double)blocks / (double)(ways * ticks);
}

static void a_turned_body_costs_the_same(void)
{
    dpt_pose body = DPT_POSE_IDENTITY;
    const double axis[3] = { 0.6, 0, 0.8 };
    struct solid liver;
    if (!solid_from_shape(&liver, "liver", 50332))
        return;
    const double straight = blocks_of(&liver, &rod, &body, 0);
    pose_orient(&body, axis, 2.0);
    const double turned = blocks_of(&liver, &rod, &body, 0);
    printf("    %.0f basic blocks a tick, turned %.0f\n", straight, turned);
    CHECK(fabs(turned / straight - 1) < 0.01, "%g of it", turned / straight);
    solid_close(&liver);
}

static void a_ball_proves_its_contact_once(void)
{
    const dpt_pose body = DPT_POSE_IDENTITY;
    struct solid liver;
    if (!solid_from_shape(&liver, "liver", 50332))
        return;
    const double none = blocks_of(&liver, &ball, &body, 0), listed = blocks_of(&liver, &ball, &body, 32);
    printf("    %.0f basic blocks a tick, with its contact %.0f\n", none, listed);
    CHECK(listed < 2 * none, "%g times as many", listed / none);
    solid_close(&liver);
}

static int by_blocks(const void *one, const void *other)
{
    const uint64_t a = *(const uint64_t *)one, b = *(const uint64_t *)other;
    return (a > b) - (a < b);
}

static void lead_fast(const struct solid *star, uint64_t seed)
{
    enum { TICKS = 4000 };
    static const dpt_segment line = { { 0, 0, 0 }, { 0, 0, 0.2 }, 0 };
    static uint64_t blocks[TICKS];
    const uint64_t ticks = part_of(TICKS);
    uint64_t held = 0;
    uint32_t most = 0;
    struct rig rig;
    struct hand hand;
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    def.max_contacts = 0;
    rig_open(&rig, &def, star->mesh, &line, 1);
    hand_begin(&hand, star, HAND_FAST, HAND_FOLLOWS, 0.003, seed);
    hand_move(&hand, &rig.device);
    rig_place(&rig);
    for (uint64_t t = 0; t < ticks; t++) {
        hand_move(&hand, &rig.device);
        const uint64_t begin = block_count;
        rig_step(&rig);
        blocks[t] = block_count - begin;
        held += rig.force.reason == DPT_FORCE_ACTS;
        most = rig.step.work > most ? rig.step.work : most;
    }
    qsort(blocks, ticks, sizeof *blocks, by_blocks);
    printf(
        "    %llu of %llu ticks with a force; basic blocks: %llu in the median, %llu at 99 %%, %llu at most; %u units\n",
        (unsigned long long)held, (unsigned long long)ticks, (unsigned long long)blocks[ticks / 2],
        (unsigned long long)blocks[ticks * 99 / 100], (unsigned long long)blocks[ticks - 1], most);
    CHECK(held > ticks / 2, "%llu", (unsigned long long)held);
    CHECK(blocks[ticks * 99 / 100] < 6 * blocks[ticks / 2] && blocks[ticks - 1] < 13 * blocks[ticks / 2], "%llu, %llu",
          (unsigned long long)blocks[ticks * 99 / 100], (unsigned long long)blocks[ticks - 1]);
    rig_close(&rig);
}

static void a_fast_line_has_no_long_ticks(void)
{
    struct solid star;
    if (!solid_from_shape(&star, "star", 20480))
        return;
    lead_fast(&star, 3);
    lead_fast(&star, 7);
    solid_close(&star);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(a_turned_body_costs_the_same);
    TEST(a_ball_proves_its_contact_once);
    TEST(a_fast_line_has_no_long_ticks);
    return check_report();
}
