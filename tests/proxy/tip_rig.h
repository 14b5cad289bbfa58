/* SPDX-License-Identifier: BSD-3-Clause */
/* For tests of tips: a rig whose tool is a tip alone, and how far it is from its body by brute force. */
#ifndef DPT_TESTS_TIP_RIG_H
#define DPT_TESTS_TIP_RIG_H

#include "lib/rig.h"
#include "lib/solid.h"
#include "oracle/hull.h"
#include "oracle/hull_surface.h"

struct tip_rig {
    struct rig rig;
    uint64_t block[2048];
    const dpt_hull *hull;
    struct oracle_hull as; /* as it tells of itself, in the tool's frame */
    double radius;
};

/* A tip of that kind (DPT_HULL_KIND_...) and extent, m, round by `radius`. `def` as for rig_open. */
void tip_rig_open(struct tip_rig *tip, const dpt_world_def *def, const dpt_mesh *mesh, uint32_t kind,
                  const double extent[3], double radius);

/* The same of a tool that there is already: its tip in place of those that it has. */
void tip_rig_give(struct tip_rig *tip, uint32_t kind, const double extent[3], double radius);

/* The corners at a pose, 3 numbers each. */
void tip_rig_corners(const struct tip_rig *tip, const dpt_pose *pose, double *corners);

/* A solid's triangles for the oracle; free its corners. */
struct oracle_triangles tip_triangles(const struct solid *solid);

/*
 * m: how far the tip's surface is from a body at the origin, with the tool at `pose`, by the oracle: what it is at least,
 * and at most. Below 0: the surfaces meet. Infinity: it is more than `limit`.
 */
struct oracle_interval tip_rig_gap(const struct tip_rig *tip, const struct oracle_triangles *triangles,
                                   const dpt_pose *pose, double limit);

/* The tip's contact; how many it has. */
uint32_t tip_rig_contact(const struct tip_rig *tip, dpt_contact *contact);

#endif
