/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The bodies of a scene: a mesh, those of an arm's scene, of a scene by name, or of a scene file. Shapes are made and
 * compiled in memory. A mesh that was compiled with springs gives way.
 */
#ifndef DPT_SCENE_BODIES_H
#define DPT_SCENE_BODIES_H

#include "dynpoint/arm.h"
#include "dynpoint/compile.h"
#include "dynpoint/springs.h"
#include "scene/file_identity.h"
#include "scene/force_options.h"
#include "scene/scene_file.h"

struct scene_body {
    const dpt_mesh *mesh;
    dpt_pose pose;
    dpt_compiled compiled; /* {NULL, 0}: the mesh's bytes are a file's */
    void *file_bytes;      /* of a file that the scene names, or NULL */
    /* As in listed_body. */
    uint32_t integrator, iterations, response;
    double sleep_speed, load_radius, spread, period, room;
    double apart;               /* s: a step of its physics, which is apart from the loop's; 0: it is not */
    int is_rigid;               /* springs of the mesh are not used */
    dpt_body_settings settings; /* its size is 0: those of new bodies */
    struct surface_regions surface_regions;
    uint8_t *of_triangle; /* the region of each triangle, in a world that has the body; or NULL */
    const char *name;     /* of its shape, or NULL */
    int has_colour;
    double colour[3]; /* as in listed_body */
    enum body_look look;
    /* Of one that gives way, in a world; else NULL. */
    dpt_springs *springs;
    void *block, *springs_block;
    float *compliances; /* of its vertices, where physics is apart and a proxy is solved for with it; else NULL */
    size_t block_bytes, springs_bytes;
    dpt_body id;
    /* Ticks in which it was held where it was (springs.h), the first and the last of them, and why it was at first. */
    uint64_t held, held_first, held_last;
    dpt_result held_why;
};

struct scene_bodies {
    struct scene_body body[DPT_ARM_BODIES_MAX];
    uint32_t count;
    double gravity;         /* m/s^2, against y; what is soft feels it */
    uint64_t nodes, active; /* of the springs, summed over all steps: those there are, and those awake */
    uint64_t steps;         /* of the springs that were taken with the world's */
    uint64_t moves;         /* steps of the world in which vertices moved, or were set to */
    double moving;          /* s: time for which they still move after the last step */
    uint64_t tick;          /* number of the present tick, from 0 */
    uint64_t held;          /* ticks in which a body was held */
    int is_held;            /* 1: in the present tick */
};

/* m: how far what gives way may get beyond its mesh's box, at least, where the scene does not say. */
#define SCENE_ROOM 10.0

/* 1 if a body gives way. */
int scene_body_is_soft(const struct scene_body *body);

enum { SCENE_CHANNELS = 32 };

/* dpt_world_def.max_channels that a world of these bodies needs: some, where a needle may pierce one. */
uint32_t scene_bodies_channels(const struct scene_bodies *bodies);

/* Make the list: of one mesh; of an arm, whose list may be empty. */
void scene_bodies_of_mesh(struct scene_bodies *bodies, const dpt_mesh *mesh);
void scene_bodies_of_arm(struct scene_bodies *bodies, const dpt_arm *arm);

/* Of a scene by name, and of a scene file. Each adds what was read and made. */
dpt_result scene_bodies_of_list(struct scene_bodies *bodies, const struct listed_scene *listed,
                                struct file_identity *identity, dpt_host_error *error);
dpt_result scene_bodies_of_file(struct scene_bodies *bodies, const char *path, const struct scene_file *file,
                                struct file_identity *identity, dpt_host_error *error);

/* Of the caller's own, whose meshes stay open. */
dpt_result scene_bodies_of_caller(struct scene_bodies *bodies, const char *path, const dpt_host_body *from,
                                  uint32_t count, dpt_host_error *error);

void scene_bodies_close(struct scene_bodies *bodies);

/* The middle of the top of the first one's box, y being up, m. */
void scene_bodies_top(const struct scene_bodies *bodies, double top[3]);

/* 1 if a tool moves triangles of one of them out of its way: the world needs strips then. */
int scene_bodies_displace(const struct scene_bodies *bodies);

/* Add them to a world, with what the options say of bodies. */
dpt_result scene_bodies_add(struct scene_bodies *bodies, dpt_world *world, const struct force_options *options);

/* Free their memory in a world that no longer exists. They may then be added to another world, as at first. */
void scene_bodies_leave(struct scene_bodies *bodies);

/* Refuse bodies that are too stiff for steps of dt, s: no step of theirs would succeed. `path` is the scene's. */
dpt_result scene_bodies_check_step(const struct scene_bodies *bodies, const char *path, double dt,
                                   dpt_host_error *error);

/* A tick begins, and in it a body is held, as a step of its springs or new positions were refused. */
void scene_bodies_begin_tick(struct scene_bodies *bodies, uint64_t tick);
void scene_bodies_hold(struct scene_bodies *bodies, uint32_t index, dpt_result why);

/*
 * Write the first body that was held, on how many ticks, why, and what helps against it; returns 0, and writes nothing, if
 * none was.
 */
int scene_bodies_held_text(const struct scene_bodies *bodies, char *text, size_t room);

/* After a step of the world: what is soft goes on by dt, s. What cannot is held: that is no error. */
dpt_result scene_bodies_step(struct scene_bodies *bodies, dpt_world *world, double dt);

/* Vertices were set, which arrive after `period`, s. And once a step: dt of that has passed. */
void scene_bodies_note_moving(struct scene_bodies *bodies, double period);
void scene_bodies_count_moves(struct scene_bodies *bodies, double dt);

#endif
