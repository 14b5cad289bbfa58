/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A deformable body of a laboratory's loop that masses and springs of the library move, in every tick.
 *
 *     struct spring_body springs = { .mesh = mesh, .integrator = DPT_INTEGRATOR_SYMPLECTIC, .load_radius = 0.02 };
 *     spring_body_open(&springs, world);
 *     for each tick: dpt_world_step(world, dt, NULL); spring_body_step(&springs, dt);
 *     spring_body_close(&springs);
 */
#ifndef DPT_TOOLS_SPRING_BODY_H
#define DPT_TOOLS_SPRING_BODY_H

#include "dynpoint/springs.h"

struct spring_body {
    /* Given. The mesh has springs. */
    const dpt_mesh *mesh;
    uint32_t integrator; /* DPT_INTEGRATOR_... */
    double load_radius;  /* m */

    /* Made. */
    dpt_world *world;
    dpt_body body;
    void *block, *springs_block;
    dpt_springs *springs;
    int is_free;            /* until it is set, the body stands still */
    int has_failed;         /* a step was refused */
    uint64_t held;          /* steps with DPT_SPRINGS_FLAG_HELD */
    uint64_t nodes, active; /* sums over steps */
};

/* Add the body to a world. Returns 0 if memory runs out or the library refuses it; spring_body_close is due in any case. */
int spring_body_open(struct spring_body *body, dpt_world *world);
void spring_body_close(struct spring_body *body);

/* After a step of the world. */
void spring_body_step(struct spring_body *body, double dt);

/* J: what springs hold, and what moves. */
double spring_body_energy(const struct spring_body *body);

#endif
