/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a hand feels: a mesh, the bodies of a scene by name or of a scene file, or those of an arm's scene; and with what: a
 * stylus, segments, or an arm's tool, each with tips or without. The scene's frame is the mesh's frame, or that of the arm's root.
 */
#ifndef DPT_SCENE_H
#define DPT_SCENE_H

#include "dynpoint/device.h"
#include "dynpoint/loop.h"
#include "scene/scene_bodies.h"
#include "scene/scene_def.h"
#include "scene/scene_dress.h"
#include "scene/scene_passivity.h"
#include "scene/scene_port.h"
#include "scene/scene_stage.h"
#include "scene/scene_tips.h"
#include "scene/tip_shape.h"

/* dpt_world_def.max_contacts of worlds whose contacts are shown, or whose law tells sides by them. */
enum { SCENE_CONTACTS = 32 };

struct scene {
    const char *command; /* as in scene_def */
    struct file_identity file,
        tool_file;            /* of the scene, its meshes and its port; of the tool's arm, zeros if none was named */
    struct scene_stage stage; /* the world, the bodies in it, and the tool */
    const dpt_arm *arm;       /* the arm of the scene; NULL: there is none */
    const dpt_arm *tool_arm;  /* the arm whose tool is used; NULL: there is none */
    struct scene_bodies bodies;
    /* Until, memory, margin, contacts, sweeps and strips of the world, as a plan has them; NULL: the defaults. */
    const dpt_world_def *planned;
    uint32_t sweep_budget;                      /* dpt_world_def's; a plan has its own */
    int shows_contacts;                         /* the world lists its contacts; likewise */
    double physics_rate;                        /* Hz; 0: what is soft is stepped in each tick */
    dpt_segment segments[DPT_ARM_SEGMENTS_MAX]; /* of the tool, in its own frame */
    uint32_t segment_count;
    uint32_t piercing;         /* the tool's end that does, DPT_PIERCING_...: it is no stylus then */
    struct scene_tips tips;    /* of the tool */
    struct curved_tips curved; /* of them, those that are felt without a proxy */
    struct force_options force;
    int has_stylus; /* the tool is the stylus, without tips, no needle: free, so that a trace of it can be replayed */
    dpt_segment stylus; /* in the scene's frame, as moved last */
    double length;
    double zoom;
    double force_scale;
    double origin[3];          /* of the device, in the scene's frame, m */
    double device_to_scene[4]; /* rotation, quaternion (w, x, y, z) */
    double turned[4];          /* of the tool from the device, in the scene, by the clutch */
    int clutch;                /* button, or -1 */
    int is_clutched, has_pose; /* the clutch is down; the tool was moved */
    struct scene_port port;    /* through which the tool enters; it leads the tool in place of the hand's turn */
    uint64_t ticks;            /* calls of scene_feel */
    dpt_pose pose;             /* of the tool, moved last */
    dpt_force_info force_info; /* of the last tick that had a force, in the scene's frame */
    struct scene_passivity passivity;
    dpt_device_info device;
    struct scene_camera camera, inset;
    enum tool_look look;
    struct scene_dress dress; /* in its place */
    void *bytes, *tool_bytes;
};

/* What a scene is felt with, in a loop. */
struct scene_hand {
    dpt_device *device;
    const char *name; /* of the device, as it was given */
    double rate;      /* of the loop, Hz */
    double force_max; /* of the guard, N */
};

/* Read the files; those of a scene file after scene_def_read. Call scene_close also after a failure. */
dpt_result scene_open(struct scene *scene, const struct scene_def *def, dpt_host_error *error);
void scene_close(struct scene *scene);

/*
 * Make the world in which this device moves the tool.
 *   budget   units of work a step; 0: unlimited
 */
dpt_result scene_make_world(struct scene *scene, const dpt_device_info *device, uint32_t budget, dpt_host_error *error);

/*
 * Move the tool to the hand's pose and take a step. The wrench is that of the hand, in the device's axes, after the
 * passivity controller if scene_passivity_begin was called.
 *
 * A body that could not go on was held where it was (scene_bodies.h): the tick has its wrench.
 *
 * While the clutch is down the tool stands still: DPT_E_NOT_READY, and no wrench. Afterwards it goes on from there, with
 * the hand wherever that is.
 */
dpt_result scene_feel(struct scene *scene, const dpt_loop_sample *sample, dpt_wrench *wrench);

/* What a scene's needle is in, all its channels together (insertion.h). Zeros: none, or the scene has no needle. */
struct scene_needle {
    double depth;      /* m: of the tip beyond the entry of the first channel */
    double inside;     /* m: of the shaft, inside of all bodies */
    uint32_t ruptures; /* walls that are open in these channels */
    uint32_t layers;   /* that the tip has gone into and not come back from */
};

struct scene_needle scene_get_needle(const struct scene *scene);

/*
 * After it: the tool's hit, and what its force was. Of a tool with curved tips and without a proxy, the hit is that of
 * the deepest of them if it is deeper than the segments, and the energy is theirs too.
 */
void scene_get_hit(const struct scene *scene, dpt_hit *hit);
void scene_get_force_info(const struct scene *scene, dpt_force_info *force);

/* m: how much larger, or deeper, than they are the curved tips are felt, at most, so far; 0: there are none. */
double scene_tip_error(const struct scene *scene);

/* The steps of what is soft so far. */
uint64_t scene_soft_steps(const struct scene *scene);

/* A point of the device's frame in the scene, and back; not of a device that is the scene's arm. */
void scene_of_device(const struct scene *scene, const double point[3], double out[3]);
void scene_to_device(const struct scene *scene, const double point[3], double out[3]);

/*
 * How deep the tool is, m. With a proxy it is how long the spring is that pulls with this force, N; else `depth`, that of
 * its hit.
 */
double scene_depth(const struct scene *scene, double force, double depth);

#endif
