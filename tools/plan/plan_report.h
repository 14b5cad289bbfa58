/* SPDX-License-Identifier: BSD-3-Clause */
/* What a plan says to people. */
#ifndef DPT_TOOLS_PLAN_REPORT_H
#define DPT_TOOLS_PLAN_REPORT_H

#include "plan/plan_file.h"
#include "plan/plan_search.h"

/* What was asked, what was chosen knob by knob, what that does, and what lies beside it. */
void plan_report(FILE *file, const struct plan *plan, const struct plan_search *search, const struct scene *scene);

/*
 * The same as one JSON object in a line: the plan as its file has it, the richest setting's figures, and what was refused, with
 * the bound that it breaks. Returns 0, or 1 if there is no temporary file.
 */
int plan_report_json(FILE *file, const struct plan *plan, const struct plan_search *search);

/* No setting keeps all bounds, and which one it is. */
void plan_report_limit_json(FILE *file, const char *limit);

/* A line of figures, and the line above them. */
void plan_report_head(FILE *file);
void plan_report_figures(FILE *file, const char *what, const struct plan_figures *figures);

/* That the machine was busy when they were measured, if it was. */
void plan_report_busy(FILE *file, const struct plan_figures *figures);

/* A plan as C, for a program of one's own. */

/* Write the functions that fill in the defs and settings of a scene. The caller checks the file's error flag. */
void plan_header_write(FILE *file, const struct plan *plan, const struct scene *scene);

#endif
