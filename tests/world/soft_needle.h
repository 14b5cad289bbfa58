/* SPDX-License-Identifier: BSD-3-Clause */
/* A needle that stands upright above a body of springs, its end a the point: tissue_rig.h has the rest. */
#ifndef DPT_TESTS_SOFT_NEEDLE_H
#define DPT_TESTS_SOFT_NEEDLE_H

#include "dynpoint/insertion.h"
#include "world/tissue_rig.h"

#define NEEDLE_LENGTH  0.1
#define NEEDLE_RADIUS  0.0006
#define NEEDLE_SLOW    2e-5 /* m: of the device in a tick */
#define NEEDLE_LATERAL 0.003

struct soft_needle {
    struct tissue_rig tissue;
    struct tissue_tool *tool;
    struct tissue_body *body;
    double depth; /* of the device's tip beneath the body's top at rest, m */
};

/* 0.4 N to puncture, 0.1 N to cut, and that friction, N/m. */
dpt_body_settings soft_needle_gel(double friction);

/* What a needle meets in a body. */
void soft_needle_set_gel(struct soft_needle *needle, const struct tissue_body *body, const dpt_body_settings *gel);

/* A ball of 5 kPa. */
struct tissue_def soft_needle_liver(uint32_t integrator);

/* In a world with room for 6 channels. 0 after a failed check. */
int soft_needle_open(struct soft_needle *needle, const struct tissue_def *def, const dpt_body_settings *gel,
                     double stiffness);
int soft_needle_open_within(struct soft_needle *needle, const struct tissue_def *def, const dpt_body_settings *gel,
                            double stiffness, uint32_t budget);
int soft_needle_open_on(struct soft_needle *needle, const struct tissue_def *def, const dpt_body_settings *gel,
                        double stiffness, uint32_t kernel);
/* No contacts are listed. */
int soft_needle_open_unlisted(struct soft_needle *needle, const struct tissue_def *def, const dpt_body_settings *gel,
                              double stiffness);
/* Without a body: you add what you like, of this mesh. */
int soft_needle_open_over(struct soft_needle *needle, const struct tissue_def *def, double stiffness);
void soft_needle_close(struct soft_needle *needle);

/* The device to its depth; with a tick, which returns |force|. */
void soft_needle_aim(struct soft_needle *needle);
double soft_needle_tick(struct soft_needle *needle);

/* The device goes to a depth, slowly; it stands. */
void soft_needle_go(struct soft_needle *needle, double depth);
void soft_needle_hold(struct soft_needle *needle, int ticks);

uint32_t soft_needle_channels(const struct soft_needle *needle, dpt_channel *all, uint32_t capacity);
dpt_channel soft_needle_channel(const struct soft_needle *needle);

/* m: from the entry, where the only channel's triangle and weights have it, to the axis where the tool's spring ends. */
double soft_needle_beside_entry(const struct soft_needle *needle);

enum { SOFT_NEEDLE_CELLS = 8 };
#define SOFT_NEEDLE_CELL 0.01

/* The surface of those of 8 x 8 x 8 cells that are solid; x and y about the origin, z from 0 on. Valid till the next. */
const struct tissue_arrays *soft_needle_cells(int (*is_solid)(int x, int y, int z));

enum { SOFT_NEEDLE_STRETCHES = 32 };

/*
 * Of the tool's axis, where its spring ends, the stretches that lie within the body's surface, by all triangles: their
 * lengths from the point on, m. Returns how many there are.
 */
uint32_t soft_needle_stretches(const struct soft_needle *needle, double lengths[SOFT_NEEDLE_STRETCHES]);

/* m: of all of them. */
double soft_needle_inside(const struct soft_needle *needle);

/* Whether an axis, given by its ends, goes through a triangle, and at which share of it. */
int soft_needle_crosses(const double ends[6], const float *vertices, const uint32_t *corners, double *share);

#endif
