/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The scenes that the program knows by name: shapes of `dynpoint make` (shape.h), where they stand, and of what they
 * are. SI units; y is up.
 */
#ifndef DPT_SCENE_LIST_H
#define DPT_SCENE_LIST_H

#include <stddef.h>

#include "dynpoint/body.h"
#include "dynpoint/compile.h"

enum { LISTED_BODIES_MAX = 8 };

/* What a body looks like: in the viewer. */
enum body_look { BODY_LOOK_ORGAN, BODY_LOOK_CLOTH, BODY_LOOK_BONE };

/* The instrument that is seen where the tool is, beyond what is felt. */
enum tool_look {
    TOOL_LOOK_NONE,
    TOOL_LOOK_STYLUS,
    TOOL_LOOK_NEEDLE,
    TOOL_LOOK_SCALPEL,
    TOOL_LOOK_FORCEPS,
    TOOL_LOOK_LAPAROSCOPE
};

/* Where one looks from. */
struct scene_camera {
    int is_given;
    double place[9]; /* position and target, m, and what is up in the picture */
};

struct listed_body {
    const char *shape; /* NULL: the list of bodies ends here */
    uint64_t triangles;
    dpt_pose pose;
    dpt_spring_net_def springs; /* kind 0: it is rigid; else its regions are in the shape's frame */
    uint32_t integrator;        /* DPT_INTEGRATOR_... */
    uint32_t iterations;        /* dpt_springs_def; 0: its default */
    double sleep_speed;         /* dpt_springs_def; 0: its default */
    double friction;            /* where the user gives none */
    dpt_body_settings surface;  /* beside that; size 0: none */
    double load_radius;         /* dpt_deformable_def, as the user asks for it; 0: none, or `spread` */
    double spread;              /* likewise, where tissue and tool are not solved together; 0: a share of the mesh */
    double period;              /* dpt_deformable_def */
    double room;                /* m: how far vertices may get beyond the mesh's box; 0: SCENE_ROOM (scene_bodies.h) */
    uint32_t response;          /* DPT_RESPONSE_... */
    int has_colour;
    double colour[3]; /* red, green and blue, 0 to 1: in the viewer */
    enum body_look look;
};

/* A sleep_speed: no node falls asleep. */
#define LISTED_SLEEPS_NEVER (-1.0)

struct listed_scene {
    const char *name;
    double gravity;   /* m/s^2, down */
    double origin[3]; /* of the device, if has_origin; else above the first body */
    int has_origin;
    double length, radius; /* of the stylus, where the user gives none */
    uint32_t is_needle;    /* 1: it stands upright, and its end a pierces, where the user gives no other tool */
    int has_port;
    double port[3];      /* m: where the stylus enters (scene_port.h) */
    enum tool_look look; /* TOOL_LOOK_NONE: the stylus's */
    struct scene_camera camera, inset;
    struct listed_body bodies[LISTED_BODIES_MAX + 1];
};

/* The name of one, from 0; NULL after the last. */
const char *scene_listed_name(uint32_t index);

/* The scene of a name; NULL: there is none. */
const struct listed_scene *scene_listed(const char *name);

/* Whether a text that names no file was meant as a scene's name: it has neither a slash nor a point. */
int scene_listed_is_meant(const char *text);

/* For a text that is none: "the scenes are ...; did you mean ...?" */
void scene_listed_tell(const char *text, char *told, size_t bytes);

#endif
