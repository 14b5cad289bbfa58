/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The shape of a tool's tip, as the user says it: in a scene file (docs/scene.md), by --tip, and in a recording's text
 * (docs/format.md). A hull is made of it (dynpoint/hull.h).
 */
#ifndef DPT_SCENE_TIP_SHAPE_H
#define DPT_SCENE_TIP_SHAPE_H

#include <stddef.h>
#include <stdio.h>

#include "dynpoint/arm.h"
#include "dynpoint/convex.h"
#include "dynpoint/hull.h"
#include "scene/force_options.h"
#include "scene/host_error.h"

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

/* Read "SHAPE:X,Y,Z" or "SHAPE:X,Y,Z,RADIUS", the text of a setting of this name (setting_words.h). */
dpt_result tip_shape_parse(struct tip_shape *shape, const char *name, const char *text, dpt_host_error *error);

/* Its line in a recording: write all but the key, at most `room` bytes with a zero; read from `text` to `end`. */
enum { TIP_SHAPE_LINE = 400 };
void tip_shape_write(const struct tip_shape *shape, char line[TIP_SHAPE_LINE]);
int tip_shape_read(struct tip_shape *shape, const char *text, const char *end); /* 0: it is none */

/*
 * Curved tips of a tool (docs/algorithms/convex.md): the hull round one, which a proxy feels, and the wrench of them
 * where the tool has no proxy. In a build without libccd there are none.
 */

/* NULL if this build supports curved tips; else the reason, for the end of a message. */
const char *curved_tip_left_out(void);

/* Likewise, of a build with DPT_LOADS_CONVEX: it has no libccd in it, and whoever loads that tells. */
const char *convex_library_fault(void);

/*
 * The hull that holds it: corners in the tool's frame, and a radius; there is room for DPT_HULL_CORNERS_MAX.
 *   error  m: the hull exceeds the tip by this much at most
 *
 * Returns DPT_E_UNSUPPORTED in a build without curved tips.
 */
dpt_result curved_tip_corners(const struct tip_shape *tip, double *corners, uint32_t *count, double *radius,
                              double *error);

/* All of a tool, felt without a proxy. Begin with zeros and with the bodies; it stays where it is, as long as the tool. */
struct curved_tips {
    dpt_convex_body bodies[DPT_ARM_BODIES_MAX];
    uint32_t body_ids[DPT_ARM_BODIES_MAX];
    uint32_t body_count;
    dpt_convex_shape shape[TIP_SHAPES_MAX];
    dpt_convex_shaper shaper[TIP_SHAPES_MAX];
    dpt_convex_contact contact[TIP_SHAPES_MAX]; /* of the last step */
    uint32_t count;
    double error;      /* m: of the depths that were proven so far, the largest error */
    uint64_t unproven; /* depths for which nothing proved that there is no shorter way out */
};

/* Let a rigid tool feel them from now on, by a law that has no proxy. */
dpt_result curved_tips_attach(struct curved_tips *tips, const struct tip_shapes *shapes, dpt_world *world,
                              dpt_tool tool, const struct force_options *force);

/* Call before each step. A tool whose step gives no answer then feels no force. */
void curved_tips_begin_tick(struct curved_tips *tips);

/*
 * After it: 1 if how deep one is could not be told, as more triangles than libdynpoint_convex takes are near; J, what they
 * store; and the tool's hit becomes that of the deepest one, if one is deeper.
 */
int curved_tips_have_failed(const struct curved_tips *tips);
double curved_tips_energy(const struct curved_tips *tips);
void curved_tips_deepen(const struct curved_tips *tips, dpt_hit *hit);

/*
 * A line for people: how well they are felt. Without curved tips none.
 *   hull_error  m, of the hulls that a proxy feels
 */
void curved_tips_print_error(FILE *file, const struct curved_tips *tips, double hull_error);

#endif
