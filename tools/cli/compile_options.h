/* SPDX-License-Identifier: BSD-3-Clause */
/* What `dynpoint compile` reads beside a mesh: springs and the files that they name, and a physics mesh. */
#ifndef DPT_TOOLS_COMPILE_OPTIONS_H
#define DPT_TOOLS_COMPILE_OPTIONS_H

#include "compile/read_regions.h"
#include "compile/read_tetgen.h"

/* Masses and springs of `dynpoint compile --springs KIND`: the options, and the files that they name. */

/* As given; NULL and NAN: not given. Begin with spring_options_init. */
struct spring_options {
    const char *kind, *regions_path, *fixed_path;
    double young, density, drag, viscosity, thickness, bending, spacing, poisson;
    dpt_spring_net_def def;
    struct spring_regions regions;
};

/* The words of --springs. */
extern const char *const spring_kinds[];

void spring_options_init(struct spring_options *options);

/*
 * Check them, read the files, and let `def` make the springs. `out`, the file to write, must be none of them. Returns
 * 0, or 2 after a message. Call spring_options_free in either case.
 */
int spring_options_take(struct spring_options *options, const char *command, const char *out, dpt_compile_def *def);

void spring_options_free(struct spring_options *options);

/* The physics mesh of `dynpoint compile --nodes BASE`: TetGen's BASE.node and BASE.ele. */

struct cell_files {
    char *node_path, *ele_path;
    struct tetgen mesh;
};

/*
 * Name the two files; BASE may have the ending of either of them. Returns 0, or 2 after a message. Call
 * cell_files_free in either case; begin with a zeroed struct.
 */
int cell_files_name(struct cell_files *files, const char *command, const char *base);

/* Read them, and let `def`, whose scale counts, embed in them. Returns 0, or 2 after a message. */
int cell_files_load(struct cell_files *files, const char *command, dpt_compile_def *def);

void cell_files_free(struct cell_files *files);

/* Say what a diag says of the file at `path`. Returns 2, the exit status. */
int complain_of_file(const char *command, const char *path, const dpt_diag *diag);

#endif
