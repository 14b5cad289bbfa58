/* SPDX-License-Identifier: BSD-3-Clause */
/* Masses and springs of `dynpoint compile --springs KIND`: the options, and the files that they name. */
#ifndef DPT_TOOLS_SPRING_OPTIONS_H
#define DPT_TOOLS_SPRING_OPTIONS_H

#include "compile/read_regions.h"

/* As given; NULL and NAN: not given. Begin with spring_options_init. */
struct spring_options {
    const char *kind, *regions_path, *fixed_path;
    double young, density, drag, viscosity, thickness, bending, spacing;
    dpt_spring_net_def def;
    struct spring_regions regions;
};

void spring_options_init(struct spring_options *options);

/*
 * Check them, read the files, and let `def` make the springs. `out`, the file to write, must be none of them. Returns
 * 0, or 2 after a message. Call spring_options_free in either case.
 */
int spring_options_take(struct spring_options *options, const char *command, const char *out, dpt_compile_def *def);

void spring_options_free(struct spring_options *options);

#endif
