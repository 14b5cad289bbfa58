/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Robots' descriptions (URDF) and compiled arms, for compile and info.
 */
#ifndef DPT_TOOLS_ARM_FILE_H
#define DPT_TOOLS_ARM_FILE_H

#include "command_options.h"
#include "dynpoint/compile.h"

/* By the ending .urdf or .xml. */
int is_urdf_name(const char *path);

/* By a zero-terminated content: XML with a <robot> near its beginning. */
int is_urdf_text(const char *text);

/*
 * `mesh` is for the meshes in it; tool and packages as in dpt_urdf_def. Notes go to standard error, behind the file's
 * name. 0, or 2 after the complaint; a build without urdfdom complains always.
 */
int compile_urdf(const char *path, const dpt_compile_def *mesh, const char *tool,
                 const char *packages, dpt_compiled *compiled);

/* One line on what was compiled. */
void report_arm(FILE *file, const dpt_compiled *compiled, const char *out);

/* Bytes of an arm, sound or not; never of a mesh. */
int is_arm(const void *bytes, size_t size);

/* dpt_arm_convert and dpt_arm_open; NULL after a complaint with the byte and section that are wrong. */
const dpt_arm *open_arm(const char *command, const char *path, void *bytes, size_t size);

void print_arm_text(const char *path, const dpt_arm *arm);
void print_arm_json(const dpt_arm *arm);

#endif
