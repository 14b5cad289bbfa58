/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Whether the motion of a held device dies away. A constant push holds the device in balance at zero, and a tap
 * disturbs it there. The growth rate of the motion is fitted; bisection finds the stiffest coupling at which it does not
 * grow.
 */
#ifndef DPT_TOOLS_HAND_SWAY_H
#define DPT_TOOLS_HAND_SWAY_H

#include "lab/hand_loop.h"

/*
 * A device with the same mass and damping in all coordinates: turns count as m, times rho. With rho 0 it has 3 degrees
 * of freedom. The encoders have no steps, there is no friction, and nothing limits its force.
 */
struct hand_device hand_device_even(double mass, double damping, double delay, double rho);

/*
 * A law where the hand holds it, linearised: stiffness along directions across each other, the greatest first. Turns
 * count in m: times rho.
 */
struct hand_law {
    int axes;
    double stiffness[HAND_AXES]; /* N/m at the hand */
    double direction[HAND_AXES][HAND_AXES];
    double asymmetry; /* N/m: what differences show beside a gradient */
};

/* By central differences about zero, where the loop was lowered to. */
void hand_law_find(struct hand_loop *loop, struct hand_law *law);

/*
 * Let the hand hold the device: by 200 N/m, or twice what keeps the tool from toppling, and from sliding off what is
 * round, where the law is `felt` N/m along its stiffest direction.
 */
void hand_hold(struct hand_loop *loop, const struct hand_law *law, double felt);

/* A tap, and how long its motion is watched. */
struct hand_tap {
    double direction[HAND_AXES]; /* unit; turns in m */
    double stiffness;            /* N/m at the hand: of that motion */
    double reach;                /* m: how far it goes at first, about */
    double seconds;
};

struct hand_sway {
    double growth; /* 1/s, fitted, along the tap's direction */
    int is_stable; /* that dies away, and of all coordinates less is left than the tap gave */
};

/* Tap the device, and fit its motion. Returns a growth of NaN, not stable, if the run failed. */
struct hand_sway hand_sway(struct hand_loop *loop, const struct hand_tap *tap);

/* What a bisection searches, and between which bounds. */
struct hand_search {
    double low, high;    /* N/m, or Nm/rad if it is of rotation, of the scene: stable, and not */
    double felt;         /* N/m along the tap's direction at the hand, for each of the above */
    int is_turn;         /* the stiffness against turns is searched for */
    double turn_damping; /* Nms/rad, if it is */
    struct hand_tap tap; /* its stiffness is filled in */
};

/* The stiffest coupling that is stable; loop->damping stays. `low` if none above is. */
double hand_stiffest(struct hand_loop *loop, const struct hand_search *search);

/* A search for the translation along y, about a limit in N/m at the hand. */
struct hand_search hand_search_about(double limit, double seconds);

/* A search along the stiffest direction of a law that was linearised at loop->stiffness; from 0.01 to 3 of a limit. */
struct hand_search hand_search_for_law(const struct hand_loop *loop, const struct hand_law *law, double limit,
                                       double seconds);

#endif
