/* SPDX-License-Identifier: BSD-3-Clause */
/* How large a mesh is, and whether its unit is likely to be another one. */
#ifndef DPT_TOOLS_MESH_SIZE_H
#define DPT_TOOLS_MESH_SIZE_H

#include "dynpoint.h"

/* "0.3 x 0.2 x 0.15 m", the box of a mesh. */
struct size_text {
    char text[64];
};
struct size_text size_text(const dpt_mesh_info *info);

double box_diagonal(const dpt_mesh_info *info);

/*
 * NULL for a box whose largest side is within 5 mm and 3 m, else the probable cure: "is it in millimetres? --unit mm".
 */
const char *size_hint(const dpt_mesh_info *info);

/* Metres of "mm", "cm", "m" or "in"; 0 for any other word. */
double unit_metres(const char *unit);

#endif
