/* SPDX-License-Identifier: BSD-3-Clause */
/* The size of a mesh, and a hint if its unit is probably wrong. */
#ifndef DPT_TOOLS_MESH_SIZE_H
#define DPT_TOOLS_MESH_SIZE_H

#include "dynpoint.h"

/* The box of a mesh as text, "0.3 x 0.2 x 0.15 m". */
struct size_text {
    char text[64];
};
struct size_text size_text(const dpt_mesh_info *info);

double box_diagonal(const dpt_mesh_info *info);

/*
 * NULL if the largest side of the box is 5 mm to 3 m, else the probable cure, as "is it in millimetres? --unit mm".
 */
const char *size_hint(const dpt_mesh_info *info);

/* The words of --unit, ended by NULL. */
extern const char *const unit_words[];

/* Metres of one of them; 0 for any other word. */
double unit_metres(const char *unit);

/* How thick a mesh is: the lengths of rays that go inward from its triangles. */

/*
 * A triangle's wall: the ray from the middle of the triangle, against its normal, to the next surface. It counts if its
 * own middle is inside the mesh. An open sheet has no inside, and so no wall. What is nearer to the ray's beginning than
 * 1e-9 of the mesh's diagonal is the surface itself.
 */
struct mesh_thickness {
    uint32_t walls;    /* triangles that have one; 0: the mesh has none, and the rest is 0 */
    uint32_t triangle; /* source number of the triangle with the thinnest wall */
    double min;        /* m */
    double low;        /* m: a hundredth of the walls are at most so thick */
};

/*
 * Measure all walls, by public calls alone: 20 us a triangle or so. The answer is the same on every machine. Shows
 * progress on a terminal. Returns 0, or 2 after a message.
 */
int mesh_thickness_measure(const char *command, const dpt_mesh *mesh, struct mesh_thickness *found);

#endif
