/* SPDX-License-Identifier: BSD-3-Clause */
/* For tests of tips that move: a rig whose tool has two jaws on a hinge, and a sheet that they may close on. */
#ifndef DPT_TESTS_JAW_RIG_H
#define DPT_TESTS_JAW_RIG_H

#include "proxy/tip_rig.h"

/* Of a jaw, m: it begins 1 mm from the hinge. */
#define JAW_LENGTH 0.04
#define JAW_WIDTH  0.006
#define JAW_HEIGHT 0.002

enum { JAW_CORNERS = 8 };

/* The hinge is the tool's y axis. The upper jaw has z from 0, the lower one up to 0; both are round by `radius`. */
struct jaws {
    struct rig rig;
    uint64_t blocks[2][2048];
    const dpt_hull *hulls[2];
    double corners[2][3 * JAW_CORNERS];
    double radius;
    dpt_pose wanted[2];
};

/* A rig with jaws that are closed. `def` as for rig_open. */
void jaws_open(struct jaws *jaws, const dpt_world_def *def, const dpt_mesh *mesh, double radius);

/* The same of a tool that there is already: jaws in place of the tips that it has. */
void jaws_give(struct jaws *jaws, double radius);

/* rad: how far both are wanted from where they meet. */
void jaws_want(struct jaws *jaws, double angle);

/* Where a jaw is in its tool, and whether that is where it is wanted, bit for bit. */
dpt_pose jaw_pose(const struct jaws *jaws, int jaw);
int jaw_is_there(const struct jaws *jaws, int jaw);

/* A jaw's corners in the world, where the proxy and the jaw in it are; without the radius. */
void jaw_corners(const struct jaws *jaws, int jaw, double corners[3 * JAW_CORNERS]);

/* m: how far a jaw's surface is from a body at the origin, as tip_rig_gap. */
struct oracle_interval jaw_gap(const struct jaws *jaws, int jaw, const struct oracle_triangles *triangles,
                               double limit);

/* The sheet, in z = 0. Returns 0 after a failure of the test. */
extern struct solid jaw_sheet;
int jaw_sheet_open(void);

/* The jaws stand over the sheet's rim, open, one on each side; the hinge is beside it. */
void stand_at_rim(struct jaws *jaws, double y, double angle);

/* Of the two far ends, how many corners are not on their side of the sheet. */
int jaws_passed(const struct jaws *jaws);

#endif
