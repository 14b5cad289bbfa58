/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Compile, open and print robots' descriptions (URDF) and compiled arms, for the commands compile and info.
 */
#ifndef DPT_TOOLS_ARM_FILE_H
#define DPT_TOOLS_ARM_FILE_H

#include "cli/command_options.h"
#include "dynpoint/compile.h"

/* As in dpt_urdf_def; NULL and 0: not given. */
struct arm_options {
    const char *tool, *packages;
    int without_scene;
    struct option_texts skip;
};

/* 1 if any was given. */
int arm_options_are_given(const struct arm_options *options);

/* 1 if the path ends in .urdf or .xml. */
int is_urdf_name(const char *path);

/* 1 if the text, zero-terminated, is XML with a <robot> near its beginning. */
int is_urdf_text(const char *text);

/*
 * Compile a URDF. Prints notes to standard error, after the file's name.
 *   mesh             how to compile the meshes that it names
 *   options          the rest; packages are looked for in the folders of ROS_PACKAGE_PATH and AMENT_PREFIX_PATH too
 *
 * Returns 0, or 2 after a message; always 2 in a build without urdfdom.
 */
int compile_urdf(const char *path, const dpt_compile_def *mesh, const struct arm_options *options,
                 dpt_compiled *compiled);

/* Print one line about a compiled arm. */
void report_arm(FILE *file, const dpt_compiled *compiled, const char *out);

/* Convert an arm to this machine's byte order and open it. NULL after a message. */
const dpt_arm *open_arm(const char *command, const char *path, void *bytes, size_t size);

void print_arm_text(const char *path, const dpt_arm *arm);
void print_arm_json(const dpt_arm *arm);

#endif
