/* SPDX-License-Identifier: BSD-3-Clause */
/* The physics mesh of `dynpoint compile --nodes BASE`: TetGen's BASE.node and BASE.ele. */
#ifndef DPT_TOOLS_CELL_FILE_H
#define DPT_TOOLS_CELL_FILE_H

#include "compile/read_tetgen.h"

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
