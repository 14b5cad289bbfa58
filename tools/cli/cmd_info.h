/* SPDX-License-Identifier: BSD-3-Clause */
/* The object of dynpoint info --json, which dynpoint compile --json prints too. */
#ifndef DPT_TOOLS_CMD_INFO_H
#define DPT_TOOLS_CMD_INFO_H

#include "dynpoint.h"
#include "shape/mesh_size.h"

/* On standard output. `thickness` NULL: it was not asked for. */
void print_mesh_json(const dpt_mesh *mesh, const dpt_mesh_info *info, const struct mesh_thickness *thickness);

#endif
