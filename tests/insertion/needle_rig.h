/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A needle over a box: 0.1 m long, end b its point, and pointing down. The box is 0.12 x 0.1 x 0.08 m with its middle
 * at the origin; its top is at NEEDLE_TOP.
 */
#ifndef DPT_TESTS_NEEDLE_RIG_H
#define DPT_TESTS_NEEDLE_RIG_H

#include "dynpoint/insertion.h"
#include "lib/rig.h"
#include "lib/solid.h"

#define NEEDLE_LENGTH 0.1
#define NEEDLE_RADIUS 0.0005
#define NEEDLE_TOP    0.04

struct needle_rig {
    struct rig rig;
    struct solid box;
    double at[2];   /* where the device's line is, m */
    double lean[2]; /* of the device: tangents along x and y */
    double depth;   /* of the device's tip beneath the box's top, m; above 0: beneath */
};

/* A gel that is easy to reckon with: 1 N to puncture, 0.5 N to cut, 40 N/m along the shaft. */
dpt_body_settings needle_gel(void);

/* With room for `channels`, and the box of that gel, at rest. 0 after a failed check. */
int needle_open(struct needle_rig *needle, const dpt_body_settings *gel, uint32_t channels);
/* The same with budgets of work a step, 0: without one; dpt_world_def. */
int needle_open_within(struct needle_rig *needle, const dpt_body_settings *gel, uint32_t channels, uint32_t budget,
                       uint32_t sweep_budget);

enum { NEEDLE_PLATES_MAX = 10 };

/*
 * Plates of that gel in one body, the first beneath NEEDLE_TOP and each next by `pitch` m beneath; the box is gone. Plate i
 * has the source triangles from 12 i on.
 */
void needle_open_over_plates(struct needle_rig *needle, struct solid *pile, int plates, double thickness, double pitch);

void needle_close(struct needle_rig *needle);

/* A step, the device's tip at `depth`. */
void needle_step(struct needle_rig *needle);

/* Steps by `speed` m/s up to that depth. */
void needle_go(struct needle_rig *needle, double depth, double speed);

/* A hand that wanders in and out of what is beneath NEEDLE_TOP, at some mm/s, with noise of 2 um. Begin with a seed. */
struct needle_wander {
    uint64_t seed;
    double speed, depth;
};

/* A step of it. */
void needle_wander(struct needle_rig *needle, struct needle_wander *wander);

/* N: along the needle, against going in. */
double needle_force(const struct needle_rig *needle);

/* m: of the proxy's tip beneath the box's top. */
double needle_tip(const struct needle_rig *needle);

/* The only channel. */
dpt_channel needle_channel(const struct needle_rig *needle);
uint32_t needle_channels(const struct needle_rig *needle, dpt_channel *channels, uint32_t capacity);

#endif
