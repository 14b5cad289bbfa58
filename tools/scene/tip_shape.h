/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The shape of a tool's tip, as the user says it: in a scene file (docs/scene.md), by --tip, and in a recording's text
 * (docs/format.md). A hull is made of it (dynpoint/hull.h).
 */
#ifndef DPT_TOOLS_TIP_SHAPE_H
#define DPT_TOOLS_TIP_SHAPE_H

#include <stddef.h>

#include "cli/command_options.h"
#include "dynpoint/hull.h"

enum { TIP_SHAPES_MAX = 16 }; /* of one tool */

#define TIP_EXTENT_MAX 10.0 /* m, of each extent, and of each coordinate of its place */
#define TIP_RADIUS_MAX 1.0  /* m */

/* Curved ones, beside the kinds of dpt_hull_shape. Their extents are their lengths along x, y and z. */
enum { TIP_ELLIPSOID = DPT_HULL_KIND_CONE + 1, TIP_CAPSULE, TIP_CURVED_CYLINDER, TIP_CURVED_CONE };

struct tip_shape {
    uint32_t kind;    /* DPT_HULL_KIND_..., or TIP_... */
    uint32_t sides;   /* of what is round; 0: the default */
    double extent[3]; /* m */
    double radius;    /* m */
    dpt_pose pose;    /* in the tool's frame */
};

struct tip_shapes {
    struct tip_shape shape[TIP_SHAPES_MAX];
    uint32_t count;
};

/* The words for the kinds, in their order, then NULL. */
extern const char *const tip_shape_words[];

/* 1 for what is round about z: its lengths along x and y are the same. */
int tip_is_round(uint32_t kind);

/* How many sides the polygon round it has at most, 3 being the least; 0: it has none. */
uint32_t tip_sides_max(uint32_t kind);

/* 1 for an ellipsoid and the like, which every law can feel: the proxy as a hull that holds it. */
int tip_is_curved(uint32_t kind);
int tip_shapes_are_curved(const struct tip_shapes *tips); /* all of them */

/* Why there is no such tip, for the end of a message; NULL: there is one. */
const char *tip_shape_fault(const struct tip_shape *shape);

/* m: by so much the hull is larger than the curved tip at most; 0 for others. */
double tip_shape_error(const struct tip_shape *shape);
double tip_shapes_error(const struct tip_shapes *tips); /* the largest of them */

/* Make the hull. *block is what to free once no tool uses it; NULL after a failure. */
dpt_result tip_shape_make(const struct tip_shape *shape, void **block, const dpt_hull **hull);

/* Read the values of --tip, "SHAPE:X,Y,Z" or "SHAPE:X,Y,Z,RADIUS". Returns 0, or 2 after a message. */
int tip_shapes_of_options(struct tip_shapes *tips, const char *command, const struct option_texts *texts);

/* Its line in a recording: write all but the key, at most `room` bytes with a zero; read from `text` to `end`. */
enum { TIP_SHAPE_LINE = 400 };
void tip_shape_write(const struct tip_shape *shape, char line[TIP_SHAPE_LINE]);
int tip_shape_read(struct tip_shape *shape, const char *text, const char *end); /* 0: it is none */

#endif
