/* SPDX-License-Identifier: BSD-3-Clause */
/* Meshes of the laboratory's loops, and the places of them where a hand presses a tool. */
#ifndef DPT_TOOLS_HAND_PLACE_H
#define DPT_TOOLS_HAND_PLACE_H

#include "dynpoint/compile.h"
#include "dynpoint/mesh.h"
#include "scene/shape.h"

struct hand_mesh {
    struct shape shape;
    dpt_compiled compiled;
    const dpt_mesh *mesh;
};

/* A test shape, so many times as large. Returns 0 if memory runs out. */
int hand_mesh_open(struct hand_mesh *mesh, const char *name, uint64_t triangles, double scale);
void hand_mesh_close(struct hand_mesh *mesh);

/* The same in its own size, with masses and springs. */
int hand_mesh_open_springs(struct hand_mesh *mesh, const char *name, uint64_t triangles,
                           const dpt_spring_net_def *springs);

/* Move each vertex of an open mesh. Returns 0 if memory runs out; it is closed then. */
int hand_mesh_warp(struct hand_mesh *mesh, void (*warp)(double x[3]));

/* A point of a surface, the way out there, and a direction across it. */
struct hand_place {
    const struct hand_mesh *mesh;
    double at[3], out[3], along[3];
};

/* The middle of a box's upper side, or of a membrane. */
void hand_place_middle(const struct hand_mesh *mesh, struct hand_place *place);

/* The highest place of a mesh, along z; of what is flat the middle. It is a little beside vertices and edges. */
void hand_place_top(const struct hand_mesh *mesh, struct hand_place *place);

/* The middle of a triangle that is drawn, and a direction that is. */
void hand_place_draw(const struct hand_mesh *mesh, uint64_t *seed, struct hand_place *place);

#endif
