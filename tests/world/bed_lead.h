/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * For tests of the bed: a line of 30 mm that is led along closed paths into a mesh and out again, and what it should feel
 * at a place, by a quadrature of the energy's gradient whose signed distances are those of zero-length queries.
 */
#ifndef DPT_TESTS_BED_LEAD_H
#define DPT_TESTS_BED_LEAD_H

#include "lib/rig.h"
#include "lib/solid.h"

#define BED_LENGTH    0.03
#define BED_RADIUS    0.002
#define BED_STIFFNESS 500.0

/* From the open to `depth` and back, wandering aside and turning; t = 0 and t = 1 are one place. */
struct bed_path {
    double place[3], out[3], side[3], other[3];
    double depth, wide, lean, tilt, phase;
};

/* Over a random triangle, 2 to 10 mm deep. */
void bed_path_make(struct bed_path *path, const struct solid *solid, uint64_t seed);

void bed_path_at(const struct bed_path *path, double t, dpt_pose *pose, double ends[6]);

/* So many ticks of equal t that no point of the tool moves by more than `step` in one. */
uint32_t bed_path_ticks(const struct bed_path *path, double step);

/* What is felt, with the torque about the middle. */
struct bed_felt {
    double force[3], torque[3], energy;
};

int bed_lead_open(struct rig *rig, const dpt_mesh *mesh);

/* Put down at t = 0. Returns 0 if something is there: such a path is none. */
int bed_lead_begin(struct rig *rig, const struct solid *solid, const struct bed_path *path);

/* A tick at t. */
struct bed_felt bed_lead_to(struct rig *rig, const struct bed_path *path, double t);

enum { BED_POINTS = 4096 };

/* The quadrature's. */
struct bed_truth {
    struct bed_felt felt;
    double deepest; /* of the tool's surface, m */
    int is_known;   /* not where a point is in an open sheet */
};

/*
 * By `points` points, a multiple of 16, at most BED_POINTS, in equal cells, and the two ends. If `skips`, groups of 16 that
 * are beyond reach as a whole get none: where the signed distance is 1-Lipschitz, which it is not in a hole of a mesh.
 */
void bed_truth_at(const dpt_mesh *mesh, const double ends[6], uint32_t points, int skips, struct bed_truth *truth);

#endif
