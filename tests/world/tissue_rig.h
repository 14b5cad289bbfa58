/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A world whose bodies give way or are rigid, and some tools with a proxy: each tick is a step of the world and one of all
 * springs together.
 *
 *     tissue_rig_open(&tissue);
 *     tissue_rig_add_soft(&tissue, &def);
 *     tissue_rig_add_tool(&tissue, &segment, 500.0);
 *     tissue.tool[0].device.position[2] = 0.1;
 *     tissue_rig_place(&tissue);
 *     for each tick: tissue_rig_tick(&tissue);
 *     tissue_rig_close(&tissue);
 */
#ifndef DPT_TESTS_TISSUE_RIG_H
#define DPT_TESTS_TISSUE_RIG_H

#include "lib/fixture.h"
#include "lib/rig.h"

enum { TISSUE_BODIES = 3, TISSUE_TOOLS = 2, TISSUE_LOADS = 1024, TISSUE_ROOM = 4096 };

struct tissue_def {
    const char *shape; /* of `dynpoint make`: a sheet where it is the membrane, whose border is fixed; else a lattice */
    uint64_t triangles;
    double young, density, drag, viscosity;
    double spacing;     /* of a lattice, m */
    double floor;       /* of a lattice: what is below that z is fixed; -1: nothing is */
    double place[3];    /* of the body */
    double stiffness;   /* what springs are multiplied by; 0: 1 */
    double load_radius; /* m: over which loads are spread; 0: they are not */
    double step;        /* s: springs are as stiff as one substep of that length allows; 0: as stiff as `young` says */
    uint32_t integrator;
    int sleeps;
};

struct tissue_body {
    struct fixture mesh;
    dpt_body id;
    dpt_springs *springs; /* NULL: rigid */
    uint32_t block;       /* of the rig: the springs' */
    size_t bytes;
    double place[3];
    double top; /* of the mesh at rest, along z */
    double load_radius;
    uint32_t integrator;
};

struct tissue_tool {
    dpt_tool id;
    dpt_segment segment;
    dpt_pose device;
    double stiffness, rho; /* N/m; m: of its turns */
    dpt_force_info force;
};

struct tissue_rig {
    struct rig rig;
    struct tissue_body body[TISSUE_BODIES];
    struct tissue_tool tool[TISSUE_TOOLS];
    uint32_t body_count, tool_count;
    int is_reversed; /* springs are handed over last body first */
    dpt_springs_info info[TISSUE_BODIES];
    dpt_result result; /* of the springs' step */
};

void tissue_rig_open(struct tissue_rig *tissue);
void tissue_rig_open_within(struct tissue_rig *tissue, uint32_t budget);
void tissue_rig_close(struct tissue_rig *tissue);

/* A ball of springs of 0.1 m, whose lower part is fixed, as soft as a liver; a membrane. */
struct tissue_def tissue_ball(void);
struct tissue_def tissue_sheet(void);

/* Returns NULL after a failed check. */
struct tissue_body *tissue_rig_add_soft(struct tissue_rig *tissue, const struct tissue_def *def);
struct tissue_body *tissue_rig_add_rigid(struct tissue_rig *tissue, const struct tissue_def *def);
struct tissue_tool *tissue_rig_add_tool(struct tissue_rig *tissue, const dpt_segment *segment, double stiffness);

/* Against turns, Nm/rad. */
void tissue_tool_turns(struct tissue_rig *tissue, struct tissue_tool *tool, double stiffness);

/* Its proxy does not turn away from the device: it is a thousand times as stiff against turns as its shape says. */
void tissue_tool_lock(struct tissue_rig *tissue, struct tissue_tool *tool);

/* All tools jump to their devices, which are in the open. */
void tissue_rig_place(struct tissue_rig *tissue);

/* The two halves of a tick, and both; the second half checks that the springs are stepped. */
void tissue_rig_step_world(struct tissue_rig *tissue);
void tissue_rig_step_springs(struct tissue_rig *tissue);
void tissue_rig_tick(struct tissue_rig *tissue);

/* Vertices as they are told, in the body's frame, and three corners a triangle. */
const float *tissue_vertices(const struct tissue_rig *tissue, const struct tissue_body *body, uint32_t *count);
const uint32_t *tissue_corners(const struct tissue_body *body, uint32_t *triangles);

/*
 * Before a step of the springs in so many substeps: how far each vertex is foreseen to move, 3 numbers each, m, where a tool
 * of that radius looks for pairs: by its speed, to the mean end of the substeps, with EULER of those after them.
 */
void tissue_foresee(const struct tissue_rig *tissue, const struct tissue_body *body, uint32_t substeps, double radius,
                    double *moved);

/* A node in the body's frame, with what its floats have lost, m. */
void tissue_node(const struct tissue_body *body, uint32_t node, double at[3]);

/* m: how far from surfaces tools are kept: 2e-6 of the largest mesh's box, which counts as 1 m at most. */
double tissue_clearance(const struct tissue_rig *tissue);

/*
 * After the world's step: the pose in which the tool's last step with tissue ended, with the room that it was given then;
 * without such a step, where the proxy was before the world's.
 */
dpt_pose tissue_tool_last_end(const struct tissue_rig *tissue, const struct tissue_tool *tool);

/* A tool's axis where its spring ends that gives the wrench: two ends, in the world. */
void tissue_tool_end(const struct tissue_tool *tool, double ends[6]);

#endif
