/* SPDX-License-Identifier: BSD-3-Clause */
/* What a plan says to people. */
#ifndef DPT_TOOLS_PLAN_REPORT_H
#define DPT_TOOLS_PLAN_REPORT_H

#include "plan/plan_search.h"

/* What was asked, what was chosen knob by knob, what that does, and what lies beside it. */
void plan_report(FILE *file, const struct plan *plan, const struct plan_search *search, const struct scene *scene);

/* A line of figures, and the line above them. */
void plan_report_head(FILE *file);
void plan_report_figures(FILE *file, const char *what, const struct plan_figures *figures);

#endif
