/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A world whose bodies give way or are rigid, and some tools with a proxy: each tick is a step of the world and one of all
 * springs together. z is up.
 *
 *     tissue_rig_open(&tissue);
 *     tissue_rig_add_soft(&tissue, &def);
 *     tissue_rig_add_tool(&tissue, &segment, 500.0);
 *     tissue.tool[0].device.position[2] = 0.1;
 *     tissue_rig_place(&tissue);
 *     for each tick: tissue_rig_tick(&tissue);
 *     tissue_rig_close(&tissue);
 *
 * Or a rod that comes down on what sleeps:
 *
 *     const struct tissue_def def = tissue_asleep(DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC);
 *     struct tissue_tool *rod = tissue_rig_open_rod(&tissue, 500.0, 1.2, 0.004);
 *     if (tissue_rig_add_soft(&tissue, &def))
 *         tissue_rod_press_and_hold(&tissue, 0.005, &mean);
 *     tissue_rig_close(&tissue);
 */
#ifndef DPT_TESTS_TISSUE_RIG_H
#define DPT_TESTS_TISSUE_RIG_H

#include "lib/fixture.h"
#include "lib/rig.h"
#include "oracle/brute.h"

enum { TISSUE_BODIES = 3, TISSUE_TOOLS = 2, TISSUE_LOADS = 1024, TISSUE_ROOM = 4096 };

/* SYMPLECTIC, EULER, IMPLICIT. */
enum { TISSUE_INTEGRATORS = 3 };
extern const uint32_t tissue_integrators[TISSUE_INTEGRATORS];

/* A rod of 60 mm and a radius of 4 mm along z, from its tip. */
extern const dpt_segment tissue_upright;

struct tissue_arrays {
    const double *vertices;
    size_t vertex_count;
    const uint32_t *corners;
    size_t triangles;
};

struct tissue_def {
    const char *shape; /* of `dynpoint make`: a sheet where it is the membrane, else a lattice */
    uint64_t triangles;
    const struct tissue_arrays *arrays; /* in place of a shape: a lattice */
    double young, density, drag, viscosity;
    double spacing;     /* of a lattice, m */
    double floor;       /* of a lattice: what is below that z is fixed; -1: nothing is */
    double border[2];   /* of a sheet, m: what is farther out along x is fixed, and along y unless that is 0 */
    double place[3];    /* of the body */
    double stiffness;   /* what springs are multiplied by; 0: 1 */
    double load_radius; /* m: over which loads are spread; 0: they are not */
    double period;      /* s: above 0 the forces of the step before move it; 0: it is solved together with the tools */
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
    uint32_t kernel; /* DPT_KERNEL_... */
    int is_reversed; /* springs are handed over last body first */
    dpt_springs_info info[TISSUE_BODIES];
    dpt_result result; /* of the springs' step */
};

void tissue_rig_open(struct tissue_rig *tissue);
void tissue_rig_open_within(struct tissue_rig *tissue, uint32_t budget);
void tissue_rig_open_on(struct tissue_rig *tissue, uint32_t kernel);
void tissue_rig_open_pierced(struct tissue_rig *tissue, uint32_t channels, uint32_t budget, uint32_t kernel);
void tissue_rig_open_unlisted(struct tissue_rig *tissue, uint32_t channels); /* no contacts are listed */
void tissue_rig_close(struct tissue_rig *tissue);

/* Opened with a tool, which it returns: a rod of 60 mm that leans, 0 is upright on its tip, pi / 2 lies across. */
struct tissue_tool *tissue_rig_open_rod(struct tissue_rig *tissue, double stiffness, double lean, double radius);

/* A ball of springs of 0.1 m, whose lower part is fixed, as soft as a liver; a membrane, whose four sides are. */
struct tissue_def tissue_ball(void);
struct tissue_def tissue_sheet(void);

/* The one or the other, by DPT_NET_...: it sleeps, and of a membrane the two sides across x are fixed, at their very edge. */
struct tissue_def tissue_asleep(uint32_t kind, uint32_t integrator);

/* Returns NULL after a failed check. A soft body cannot go farther than 1 m from its place along each axis. */
struct tissue_body *tissue_rig_add_soft(struct tissue_rig *tissue, const struct tissue_def *def);
/* A mesh alone, of which you make a body. */
struct tissue_body *tissue_rig_add_mesh(struct tissue_rig *tissue, const struct tissue_def *def);
struct tissue_body *tissue_rig_add_rigid(struct tissue_rig *tissue, const struct tissue_def *def);
struct tissue_tool *tissue_rig_add_tool(struct tissue_rig *tissue, const dpt_segment *segment, double stiffness);

/* The body is rough, or its own surface yields by so many N/m, from now on. */
void tissue_body_roughen(struct tissue_rig *tissue, const struct tissue_body *body, double static_friction,
                         double kinetic_friction);
void tissue_body_soften(struct tissue_rig *tissue, const struct tissue_body *body, double stiffness);

/* Against turns, Nm/rad. */
void tissue_tool_turns(struct tissue_rig *tissue, struct tissue_tool *tool, double stiffness);

/* Its proxy does not turn away from the device: it is a thousand times as stiff against turns as its shape says. */
void tissue_tool_lock(struct tissue_rig *tissue, struct tissue_tool *tool);

/* All tools jump to their devices, which are in the open. */
void tissue_rig_place(struct tissue_rig *tissue);

/* The two halves of a tick; and both, which checks that the springs are stepped, and returns |force| of the first tool. */
void tissue_rig_step_world(struct tissue_rig *tissue);
void tissue_rig_step_springs(struct tissue_rig *tissue);
double tissue_rig_tick(struct tissue_rig *tissue);

/* The first tool's device goes so deep, m, below the first body's top at rest. */
void tissue_rod_lower(struct tissue_rig *tissue, double depth);

/*
 * The first tool comes down from the open to a depth, m, by 20 um a tick, and is held for 1200 ticks. Returns the largest
 * jump of its force, N, in the last 300 of these, and in *mean the force.
 */
double tissue_rod_press_and_hold(struct tissue_rig *tissue, double depth, double *mean);

/* Vertices as they are told, in the body's frame, and three corners a triangle; of both the oracle's mesh, which you close. */
const float *tissue_vertices(const struct tissue_rig *tissue, const struct tissue_body *body, uint32_t *count);
const uint32_t *tissue_corners(const struct tissue_body *body, uint32_t *triangles);
oracle_mesh *tissue_surface(const struct tissue_rig *tissue, const struct tissue_body *body);

/*
 * Before a step of the springs in so many substeps: how far each vertex is foreseen to move, 3 numbers each, m, where a tool
 * of that radius looks for pairs: by its speed, to the mean end of the substeps, with EULER of those after them.
 */
void tissue_foresee(const struct tissue_rig *tissue, const struct tissue_body *body, uint32_t substeps, double radius,
                    double *moved);

/* All nodes in the body's frame, 3 numbers each, with what their floats have lost, m. */
void tissue_nodes(const struct tissue_body *body, double *at);

/* m: how far from surfaces tools are kept: 2e-6 of the largest mesh's box, which counts as 1 m at most. */
double tissue_clearance(const struct tissue_rig *tissue);

/*
 * The pose in which the tool's last step with tissue ended, with the room that it was given then; without such a step, where
 * the proxy was before the world's.
 */
dpt_pose tissue_tool_last_end(const struct tissue_rig *tissue, const struct tissue_tool *tool);

/* A tool's axis where its spring ends that gives the wrench: two ends, in the world. */
void tissue_tool_end(const struct tissue_tool *tool, double ends[6]);

#endif
