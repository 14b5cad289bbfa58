/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a hand feels, and with what: a mesh, or the bodies of an arm's scene; a stylus, or an arm's tool. The
 * scene's frame is the mesh's, or that of the arm's root.
 */
#ifndef DPT_TOOLS_SCENE_H
#define DPT_TOOLS_SCENE_H

#include "dynpoint.h"
#include "dynpoint/device.h"

struct scene_def {
    const char *path; /* of a compiled mesh or arm */
    const char
        *tool; /* of a compiled arm; NULL: the scene's own, or where that is a mesh the stylus */
    const char *
        origin; /* "X,Y,Z": where the device's origin is, m; NULL: above a mesh, or at the arm's middle */
    double zoom;   /* metres of the scene for one of the hand */
    double length; /* of the stylus, m */
    double radius;
    double stiffness; /* N/m */
};

struct scene {
    dpt_world *world;
    dpt_tool tool;
    const dpt_arm *arm;                         /* that the scene is of; NULL: of a mesh */
    const dpt_mesh *mesh;                       /* likewise; NULL: of an arm */
    dpt_segment segments[DPT_ARM_SEGMENTS_MAX]; /* of the tool, in its own frame */
    uint32_t segment_count;
    double stiffness;
    int has_stylus;     /* the tool is the stylus: free, so that a trace of it can be replayed */
    dpt_segment stylus; /* of the scene's frame, as it was moved last */
    double length;
    double zoom;
    double origin[3];          /* the device's, in the scene's frame */
    double device_to_scene[4]; /* from the device's axes to the scene's */
    dpt_device_info device;
    void *block, *bytes, *tool_bytes;
};

/* Read the files. 0, or 2 after a complaint. On failure too scene_close is to be called. */
int scene_open(struct scene *scene, const struct scene_def *def);
void scene_close(struct scene *scene);

/*
 * Make the world, which this device will move in. 0, or 2 after a complaint.
 *   budget  of a step, units of work; 0: unlimited
 */
int scene_make_world(struct scene *scene, const dpt_device *device, uint32_t budget);

/* Move the tool to where the hand is, take a step; the wrench is in the device's axes. */
dpt_result scene_feel(struct scene *scene, const dpt_device_state *state, double dt,
                      dpt_wrench *wrench);

#endif
