/* SPDX-License-Identifier: BSD-3-Clause */
#include "lib/hand_motion.h"

#include "lib/pose.h"

const char *const hand_motion_names[HAND_MOTIONS] = { "wipe", "fast", "poke" };
const char *const hand_holding_names[HAND_HOLDINGS] = { "follows", "holds" };

enum { STAY = 500 };

#define ABOVE  0.02
#define HOP    0.04
#define NOD    0.45
#define SLOW   1e-4
#define FAST   1e-3
#define PERIOD 6.283185307179586

static void go_on(struct hand *hand)
{
    memcpy(hand->at, hand->next, sizeof hand->at);
    memcpy(hand->out, hand->next_out, sizeof hand->out);
    do {
        solid_random_place(hand->solid, &hand->seed, hand->next, hand->next_out);
        hand->way = apart(hand->at, hand->next);
    } while (hand->way > HOP || hand->way == 0 ||
             (hand->holding == HAND_HOLDS && apart(hand->start, hand->next) > HOP));
    hand->gone = 0;
}

void hand_begin(struct hand *hand, const struct solid *solid, int motion, int holding, double depth, uint64_t seed)
{
    double lean[3], to[3];
    *hand = (struct hand){ .solid = solid, .motion = motion, .holding = holding, .depth = depth, .seed = seed };
    solid_random_place(hand->solid, &hand->seed, hand->next, hand->next_out);
    memcpy(hand->start, hand->next, sizeof hand->start);
    go_on(hand);
    random_unit(&hand->seed, lean);
    random_unit(&hand->seed, hand->nod);
    hand->rate = random_in(&hand->seed, 0, 0.02);
    for (int k = 0; k < 3; k++)
        to[k] = hand->out[k] + random_in(&hand->seed, 0, 1) * lean[k];
    unit3(to);
    turn_from_z(to, hand->held);
}

static double height_at(const struct hand *hand)
{
    if (hand->tick < HAND_DESCENT)
        return ABOVE - (ABOVE + hand->depth) * (double)hand->tick / HAND_DESCENT;
    if (hand->motion == HAND_POKE)
        return -hand->depth * cos(PERIOD * (double)(hand->tick - HAND_DESCENT) / STAY);
    return -hand->depth;
}

static void orient(const struct hand *hand, const double out[3], dpt_pose *pose)
{
    const double nod = NOD * sin(hand->rate * (double)hand->tick);
    const double turn[4] = { cos(nod), sin(nod) * hand->nod[0], sin(nod) * hand->nod[1], sin(nod) * hand->nod[2] };
    double tilted[3] = { out[0] + 1.2, out[1], out[2] };
    if (hand->holding == HAND_HOLDS) {
        memcpy(pose->orientation, hand->held, sizeof pose->orientation);
        pose_turn_by(pose, turn);
        return;
    }
    unit3(tilted);
    turn_from_z(tilted, pose->orientation);
}

void hand_move(struct hand *hand, dpt_pose *pose)
{
    const uint64_t begun = hand->tick - HAND_DESCENT;
    const int pokes = hand->motion == HAND_POKE, is_down = hand->tick >= HAND_DESCENT;
    double out[3];
    if (is_down && !pokes)
        hand->gone += hand->motion == HAND_FAST ? FAST : SLOW;
    /* From one place of a poke to the next it goes while it is outside. */
    const double part = pokes && is_down ? (double)(begun % STAY) / STAY : 0.5;
    if (pokes)
        hand->gone = is_down ? hand->way * fmin(1, fmax(0, 2 * part - 0.5)) : 0;
    if (is_down && (pokes ? begun % STAY == STAY - 1 : hand->gone >= hand->way))
        go_on(hand);
    const double share = hand->gone / hand->way, height = height_at(hand);
    for (int k = 0; k < 3; k++)
        out[k] = hand->out[k] + share * (hand->next_out[k] - hand->out[k]);
    unit3(out);
    for (int k = 0; k < 3; k++)
        pose->position[k] = hand->at[k] + share * (hand->next[k] - hand->at[k]) + height * out[k];
    orient(hand, out, pose);
    hand->tick++;
}
