/* SPDX-License-Identifier: BSD-3-Clause */
/* A plan as C, for a program of one's own. */
#ifndef DPT_TOOLS_PLAN_HEADER_H
#define DPT_TOOLS_PLAN_HEADER_H

#include "plan/plan.h"

/* Write the functions that fill in the defs and settings of a scene. The caller checks the file's error flag. */
void plan_header_write(FILE *file, const struct plan *plan, const struct scene *scene);

#endif
