/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The bodies of a scene: a mesh, those of an arm's scene, or those of a scene by name, made and compiled in memory. A mesh
 * that was compiled with springs gives way.
 */
#ifndef DPT_TOOLS_SCENE_BODIES_H
#define DPT_TOOLS_SCENE_BODIES_H

#include "dynpoint/arm.h"
#include "dynpoint/compile.h"
#include "dynpoint/springs.h"
#include "force_options.h"
#include "scene_list.h"

struct scene_body {
    const dpt_mesh *mesh;
    dpt_pose pose;
    dpt_compiled compiled; /* {NULL, 0}: the mesh's bytes are a file's */
    uint32_t integrator;
    double load_radius;
    /* Of one that gives way, in a world; else NULL. */
    dpt_springs *springs;
    void *block, *springs_block;
    dpt_body id;
};

struct scene_bodies {
    struct scene_body body[DPT_ARM_BODIES_MAX];
    uint32_t count;
    double gravity; /* m/s^2, against y; what is soft feels it */
    uint64_t nodes,
        active; /* of the springs, summed over all steps: those there are, and those awake */
};

/* Make the list: of one mesh; of an arm, whose list may be empty. */
void scene_bodies_of_mesh(struct scene_bodies *bodies, const dpt_mesh *mesh);
void scene_bodies_of_arm(struct scene_bodies *bodies, const dpt_arm *arm);

/* Of a scene by name. Returns 0, or 2 after a message. */
int scene_bodies_of_list(struct scene_bodies *bodies, const char *command,
                         const struct listed_scene *listed);

void scene_bodies_close(struct scene_bodies *bodies);

/* The middle of the top of the first one's box, y being up, m. */
void scene_bodies_top(const struct scene_bodies *bodies, double top[3]);

/* Add them to a world, with what the options say of bodies. */
dpt_result scene_bodies_add(struct scene_bodies *bodies, dpt_world *world,
                            const struct force_options *options);

/* After a step of the world: what is soft goes on by dt, s. */
dpt_result scene_bodies_step(struct scene_bodies *bodies, dpt_world *world, double dt);

#endif
