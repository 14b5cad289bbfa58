/* SPDX-License-Identifier: BSD-3-Clause */
/* What the bodies of a scene cost before and beside the ticks: to compile, to add to a world, and to refit. */
#ifndef DPT_TOOLS_CHART_BODIES_H
#define DPT_TOOLS_CHART_BODIES_H

#include "scene/scene.h"

/* Times are s, the least of three, or of refits the median; sizes are bytes. */
struct chart_body {
    uint32_t triangles;
    uint64_t mesh_bytes;
    double compile; /* from its triangles in memory, one thread */
    double add;     /* as a rigid body, to a world */
    /* As a body whose vertices move: its own memory, and all vertices moved, with the step behind it. */
    size_t deform_bytes;
    double refit;
};

/* Returns 0, or 2 after a message. */
int chart_body_measure(struct chart_body *measured, const struct scene *scene, uint32_t body);

#endif
