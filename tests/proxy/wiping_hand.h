/* SPDX-License-Identifier: BSD-3-Clause */
/* A hand that wipes close to the surface of a shape, with a tremor, from place to place. */
#ifndef DPT_TESTS_WIPING_HAND_H
#define DPT_TESTS_WIPING_HAND_H

#include "lib/fixture.h"
#include "lib/pose.h"
#include "mesh/surface.h"

struct subject {
    const char *shape;
    uint64_t triangles;
    struct fixture fixture;
    struct surface surface;
    vec3 centre;
    double diagonal;
};

static inline int open_subject(struct subject *subject)
{
    if (!fixture_from_shape(&subject->fixture, subject->shape, subject->triangles))
        return 0;
    dpti_surface_of_mesh(subject->fixture.mesh, &subject->surface);
    subject->centre = scaled(add(subject->surface.box_min, subject->surface.box_max), 0.5);
    subject->diagonal = length(sub(subject->surface.box_max, subject->surface.box_min));
    return 1;
}

struct hand {
    const struct subject *subject;
    uint64_t seed;
    double at[3], aim[3], speed, turn;
    int tick;
};

static inline void hand_begin(struct hand *hand, const struct subject *subject, uint64_t seed)
{
    double way[3];
    *hand = (struct hand){ .subject = subject, .seed = seed };
    random_unit(&hand->seed, way);
    vec3_store(along(subject->centre, 0.5 * subject->diagonal + 0.05, vec3_of(way)), hand->at);
}

/* A place near that of the last aim: all places are on or a little below the surface. */
static inline void hand_aim(struct hand *hand)
{
    const struct surface *surface = &hand->subject->surface;
    const double last[3] = { hand->aim[0], hand->aim[1], hand->aim[2] };
    do {
        const uint32_t triangle = (uint32_t)(random_bits(&hand->seed) % surface_triangles(surface));
        vec3_store(surface_corner_point(surface, triangle, 0), hand->aim);
    } while (hand->tick && apart(hand->aim, last) > 0.03);
    for (int k = 0; k < 3; k++)
        hand->aim[k] += random_in(&hand->seed, -0.002, 0.002);
    hand->speed = hand->tick ? pow(10, random_in(&hand->seed, -5, -3)) : 1e-3;
}

static inline void hand_move(struct hand *hand, dpt_pose *pose)
{
    static const double axis[3] = { 0.6, 0, 0.8 };
    double way[3];
    if (hand->tick % 300 == 0)
        hand_aim(hand);
    for (int k = 0; k < 3; k++)
        way[k] = hand->aim[k] - hand->at[k];
    const double far = unit3(way);
    for (int k = 0; k < 3; k++) {
        hand->at[k] += fmin(hand->speed, 0.02 * far) * way[k];
        pose->position[k] = hand->at[k] + 3e-5 * sin(0.06 * (1 + 0.1 * k) * hand->tick + k);
    }
    hand->turn += hand->speed * random_in(&hand->seed, 0, 3);
    pose_orient(pose, axis, hand->turn);
    hand->tick++;
}

#endif
