/* SPDX-License-Identifier: BSD-3-Clause */
/* The meshes of the laboratory's cases, made and compiled in memory. m. */
#ifndef DPT_TOOLS_LAB_MESH_H
#define DPT_TOOLS_LAB_MESH_H

#include "dynpoint/compile.h"
#include "lab/lab.h"

struct lab_mesh {
    dpt_compiled compiled;
    const dpt_mesh *mesh;
    double diagonal; /* of its box, m */
};

/* Where memory runs out, these set lab->is_out_of_memory, and return 0; the mesh is empty then. */

/* A shape of `dynpoint make` with `count` triangles; 0: its usual number. */
int lab_mesh_shape(struct lab *lab, struct lab_mesh *mesh, const char *name, uint64_t count);

int lab_mesh_arrays(struct lab *lab, struct lab_mesh *mesh, const double *vertices, size_t vertex_count,
                    const uint32_t *corners, size_t triangle_count);

/* A sheet: `place` gives the vertex at u, v in 0..1. Its front is where u grows with y, v with x, is seen from +z. */
int lab_mesh_net(struct lab *lab, struct lab_mesh *mesh, uint32_t rows, uint32_t columns,
                 void (*place)(const void *context, double u, double v, double x[3]), const void *context);

/*
 * A closed prism: a polygon of `count` corners x, z, counterclockwise seen along +y from below, from y = -half to
 * y = half. All of the polygon must be seen from the mean of its corners.
 */
enum { LAB_CORNERS_MAX = 16 };
int lab_mesh_prism(struct lab *lab, struct lab_mesh *mesh, const double (*corners)[2], uint32_t count, double half);

/* A closed box: x from low to high, z from `bottom` to `top`, y from -half to half. */
int lab_mesh_slab(struct lab *lab, struct lab_mesh *mesh, double low, double high, double bottom, double top,
                  double half);

void lab_mesh_close(struct lab_mesh *mesh);

#endif
