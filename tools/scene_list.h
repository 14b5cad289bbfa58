/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The scenes that the program knows by name: shapes of `dynpoint make` (shape.h), and where they stand. Metres; y is
 * up, unless the scene says so.
 */
#ifndef DPT_TOOLS_SCENE_LIST_H
#define DPT_TOOLS_SCENE_LIST_H

#include "dynpoint/types.h"

enum { LISTED_BODIES_MAX = 8 };

struct listed_body {
    const char *shape; /* NULL: the list of bodies ends here */
    uint64_t triangles;
    dpt_pose pose;
};

struct listed_scene {
    const char *name, *about;
    struct listed_body bodies[LISTED_BODIES_MAX + 1];
};

/* The scene of a name; NULL: there is none. */
const struct listed_scene *scene_listed(const char *name);

#endif
