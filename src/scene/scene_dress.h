/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a tool looks like by meshes of the user's own, for the eye alone: nothing of it is felt. Its frame has its origin at
 * end a of the tool's first segment, its z axis towards end b, and its x axis as near to the tool's as that allows. A part
 * with a hinge is a jaw, which turns about it as the jaws open.
 */
#ifndef DPT_SCENE_DRESS_H
#define DPT_SCENE_DRESS_H

#include "dynpoint/compile.h"
#include "dynpoint/mesh.h"

enum { DRESS_PARTS_MAX = 8 };

struct dress_part {
    char *mesh;    /* path of a mesh that the compiler reads */
    double scale;  /* m in the mesh's unit */
    dpt_pose pose; /* in the dress's frame, of a jaw that is closed */
    int has_hinge, has_colour;
    double hinge[3], axis[3]; /* m, and a direction, in the dress's frame */
    double open;              /* rad about the axis, of jaws that are wholly open */
    double colour[3];
};

/* Begin with zeros. */
struct scene_dress {
    struct dress_part part[DRESS_PARTS_MAX]; /* without the paths */
    uint32_t count;
    dpt_compiled compiled[DRESS_PARTS_MAX];
    const dpt_mesh *mesh[DRESS_PARTS_MAX];
};

#endif
