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

/* Metres of "mm", "cm", "m" or "in"; 0 for any other word. */
double unit_metres(const char *unit);

#endif
