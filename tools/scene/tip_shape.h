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

struct tip_shape {
    uint32_t kind;    /* DPT_HULL_KIND_... */
    uint32_t sides;   /* of a cylinder and a cone; 0: the hull's default */
    double extent[3]; /* m */
    double radius;    /* m */
    dpt_pose pose;    /* in the tool's frame */
};

struct tip_shapes {
    struct tip_shape shape[TIP_SHAPES_MAX];
    uint32_t count;
};

/* The words for the kinds, in the order of DPT_HULL_KIND_..., then NULL. */
extern const char *const tip_shape_words[];

/* 1 for a cylinder and a cone: they have sides, and as many as tip_sides_max at most; at least 3. */
int tip_is_round(uint32_t kind);
uint32_t tip_sides_max(uint32_t kind);

/* Why there is no such tip, for the end of a message; NULL: there is one. */
const char *tip_shape_fault(const struct tip_shape *shape);

/* Make the hull. *block is what to free once no tool uses it; NULL after a failure. */
dpt_result tip_shape_make(const struct tip_shape *shape, void **block, const dpt_hull **hull);

/* Read the values of --tip, "SHAPE:X,Y,Z" or "SHAPE:X,Y,Z,RADIUS". Returns 0, or 2 after a message. */
int tip_shapes_of_options(struct tip_shapes *tips, const char *command, const struct option_texts *texts);

/* Its line in a recording: write all but the key, at most `room` bytes with a zero; read from `text` to `end`. */
enum { TIP_SHAPE_LINE = 400 };
void tip_shape_write(const struct tip_shape *shape, char line[TIP_SHAPE_LINE]);
int tip_shape_read(struct tip_shape *shape, const char *text, const char *end); /* 0: it is none */

#endif
