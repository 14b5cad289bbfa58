/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * On which side of surfaces a proxy is, by an oracle that knows it (side_scene.h). While the device turns by less than
 * 1 rad from where contact began, no motion of the hand takes the proxy to the other side, and nothing puts it there. When
 * the hand lifts, the proxy is led back to it.
 * A proxy that is put, because the device has turned farther, because bodies left it no room, or because they moved
 * unseen, has no force until it is in front again.
 *
 *     test_proxy_side [TICKS [SEED]]      of random motions
 */
#include "force/side_scene.h"

/* Of one random motion. */
enum { MOTION_TICKS = 1000, LIFT_TICKS = 250 };

/* rad: the device never turns farther from where it was free last. */
#define TURN_MOST 0.99

static unsigned long ticks_wanted = 20000;
static uint64_t first_seed = 1;

static struct {
    uint64_t motions, ticks, acts, toppled;
    double most_turned;
} all;

static const struct {
    const char *name;
    uint32_t count;
    dpt_segment segments[2];
} tools[] = {
    { "point", 1, { { { 0, 0, 0 }, { 0, 0, 0 }, 0 } } },
    { "line of 20 mm", 1, { { { 0, 0, 0 }, { 0, 0, 0.02 }, 0 } } },
    { "stylus of 50 mm", 1, { { { 0, 0, 0 }, { 0, 0, 0.05 }, 0.001 } } },
    { "rod of 100 mm", 1, { { { 0, 0, -0.05 }, { 0, 0, 0.05 }, 0.003 } } },
    { "line of 200 mm", 1, { { { 0, 0, 0 }, { 0, 0, 0.2 }, 0 } } },
    { "shaft of 300 mm", 1, { { { 0, 0, 0 }, { 0, 0, 0.3 }, 0.0025 } } },
    { "hook", 2, { { { 0, 0, 0 }, { 0, 0, 0.08 }, 0.001 }, { { 0, 0, 0 }, { 0.02, 0, 0 }, 0.001 } } },
};
enum { TOOLS = sizeof tools / sizeof *tools };

/* rad: the turn between two orientations. */
static double turn_between(const double p[4], const double q[4])
{
    const double cosine = fabs(p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3]);
    return 2 * acos(fmin(1, cosine));
}

/* A hand that goes from aim to aim, turns, and is sometimes elsewhere at once. */
struct hand {
    uint64_t seed;
    double aim[3], speed, spin[3], free_turn[4], reach;
    dpt_pose start;
};

/* In the open over the scene, turned in any way. */
static void begin(struct hand *hand, struct side_scene *scene)
{
    double lowest = 0, axis[3];
    random_unit(&hand->seed, axis);
    pose_orient(&scene->rig.device, axis, random_bits(&hand->seed) % 3 ? random_in(&hand->seed, 0, 3.1) : 0);
    hand->reach = 0.02;
    for (uint32_t i = 0; i < scene->rig.count; i++) {
        double ends[6];
        pose_ends(&scene->rig.device, &scene->rig.segments[i], ends);
        lowest = fmin(lowest, fmin(ends[2], ends[5]) - scene->rig.segments[i].radius);
        hand->reach = fmax(hand->reach, apart(scene->rig.segments[i].a, scene->rig.segments[i].b));
    }
    for (int k = 0; k < 2; k++)
        scene->rig.device.position[k] = random_in(&hand->seed, -0.1, 0.1);
    scene->rig.device.position[2] =
        side_scene_top(scene) - lowest + (scene->is_moving || scene->is_soft ? 0.15 : 0.003);
    hand->start = scene->rig.device;
    memcpy(hand->free_turn, hand->start.orientation, sizeof hand->free_turn);
}

static void choose_aim(struct hand *hand, const struct side_scene *scene, int is_last)
{
    const double deep = is_last ? -1.1 * hand->reach : random_in(&hand->seed, -0.2, 1.6) * hand->reach;
    for (int k = 0; k < 3; k++)
        hand->aim[k] = hand->start.position[k] + (is_last || k == 2 ? 0 : random_in(&hand->seed, -0.1, 0.1));
    hand->aim[2] -= deep + (deep > 0 ? hand->start.position[2] - side_scene_top(scene) : 0);
    hand->speed = 1e-3 * pow(10, random_in(&hand->seed, -1.5, 0));
    if (is_last)
        hand->speed = fmax(1e-3, apart(hand->aim, scene->rig.device.position) / (LIFT_TICKS - 50));
    for (int k = 0; k < 3; k++)
        hand->spin[k] = random_bits(&hand->seed) % 2 ? 0 : random_in(&hand->seed, -5e-3, 5e-3);
}

static void move(struct hand *hand, struct side_scene *scene, int is_last)
{
    dpt_pose *device = &scene->rig.device, turned = *device;
    double way[3], turn[4] = { 1, 0, 0, 0 };
    for (int k = 0; k < 3; k++)
        way[k] = hand->aim[k] - device->position[k];
    const double far = length3(way), step = random_bits(&hand->seed) % 500 ? hand->speed : 0.1;
    for (int k = 0; k < 3; k++)
        device->position[k] +=
            (far > step ? step / far : 1) * way[k] + (is_last ? 0 : random_in(&hand->seed, -2e-5, 2e-5));
    for (int k = 0; k < 3; k++)
        turn[1 + k] = 0.5 * hand->spin[k];
    turn[0] = sqrt(1 - dot3(turn + 1, turn + 1));
    pose_turn_by(&turned, turn);
    if (scene->rig.force.reason == DPT_FORCE_FREE)
        memcpy(hand->free_turn, device->orientation, sizeof hand->free_turn);
    if (turn_between(turned.orientation, hand->free_turn) < TURN_MOST)
        memcpy(device->orientation, turned.orientation, sizeof turned.orientation);
}

/* Judge a tick. Returns 0 after a failed check. */
static int judge(struct side_scene *scene, const char *tool, uint64_t number)
{
    const dpt_force_info *force = &scene->rig.force;
    const int is_put =
        force->reason > DPT_FORCE_FREE || force->flags & (DPT_FORCE_FLAG_REPLACED | DPT_FORCE_FLAG_SQUEEZED);
    const double turned = turn_between(scene->rig.proxy.orientation, scene->rig.device.orientation);
    all.ticks++;
    all.acts += force->reason == DPT_FORCE_ACTS;
    all.toppled += turned > 1;
    all.most_turned = fmax(all.most_turned, turned);
    CHECK(!is_put, "%s, %s, motion %llu, tick %llu: reason %u, flags %u", scene->name, tool, (unsigned long long)number,
          scene->tick, force->reason, force->flags);
    return side_scene_judge(scene) && !is_put;
}

static int rubs(const struct rig *rig)
{
    dpt_body_settings settings = { .size = sizeof settings };
    dpt_body_get_settings(rig->world, rig->body, &settings);
    return settings.static_friction > 0;
}

static void one_motion(uint64_t number)
{
    struct side_scene scene;
    struct hand hand = { .seed = 1000003 * first_seed + number };
    const int shape = (int)(number % SIDE_SHAPES), tool = (int)(number / SIDE_SHAPES % TOOLS);
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    /* Where bodies move, a budget must leave room to find the way out: `dynpoint run` has 3,000 units. */
    if (random_bits(&hand.seed) % 8 == 0)
        def.budget = (side_shape_moves(shape) ? 3000 : 50) + (uint32_t)(random_bits(&hand.seed) % 400);
    if (side_scene_open(&scene, shape, &def, tools[tool].segments, tools[tool].count, hand.seed)) {
        int is_right = 1;
        rig_vary(&scene.rig, &hand.seed);
        begin(&hand, &scene);
        rig_place(&scene.rig);
        for (int tick = 0; is_right && tick < MOTION_TICKS; tick++) {
            const int is_last = tick >= MOTION_TICKS - LIFT_TICKS;
            if (tick % 250 == 0)
                choose_aim(&hand, &scene, is_last);
            move(&hand, &scene, is_last);
            side_scene_move(&scene);
            rig_step(&scene.rig);
            is_right = judge(&scene, tools[tool].name, number);
        }
        all.motions++;
        /* Friction may hold what the hand pulls along a wall; and a line or point may stay at a sharp edge: force.md. */
        CHECK(!is_right || rubs(&scene.rig) || tools[tool].segments[0].radius == 0 ||
                  scene.rig.force.reason == DPT_FORCE_FREE,
              "%s, %s, motion %llu: not led back", scene.name, tools[tool].name, (unsigned long long)number);
    }
    side_scene_close(&scene);
}

static void no_motion_of_the_hand_takes_it_behind(void)
{
    for (uint64_t number = 0; all.ticks < ticks_wanted; number++)
        one_motion(number);
    printf("    %llu motions, %llu ticks, %llu with a force, %llu turned by more than 1 rad, by %.3g at most\n",
           (unsigned long long)all.motions, (unsigned long long)all.ticks, (unsigned long long)all.acts,
           (unsigned long long)all.toppled, all.most_turned);
    CHECK(all.acts > all.ticks / 5 && all.toppled > all.ticks / 200, "%llu, %llu of %llu ticks",
          (unsigned long long)all.acts, (unsigned long long)all.toppled, (unsigned long long)all.ticks);
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &ticks_wanted, &first_seed);
    TEST(no_motion_of_the_hand_takes_it_behind);
    return check_report();
}
