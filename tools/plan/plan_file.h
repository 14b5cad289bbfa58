/* SPDX-License-Identifier: BSD-3-Clause */
/* The file of a plan, JSON (docs/plan.md): written by `plan -o`, read by `replay` and `run`. */
#ifndef DPT_TOOLS_PLAN_FILE_H
#define DPT_TOOLS_PLAN_FILE_H

#include "plan/plan.h"

/* Words of the file, each list ended with NULL, in the order of their numbers. */
extern const char *const plan_integrator_words[]; /* DPT_INTEGRATOR_... and last "scene" */
extern const char *const plan_bound_words[];      /* enum plan_bound */
extern const char *const plan_trace_words[];      /* PLAN_FIRST_HALF, ... */

/* Write it. The caller checks the file's error flag. */
void plan_file_write(FILE *file, const struct plan *plan);

/*
 * Read a file. Returns 0, or 2 after a message that names the file, the place and the reason; always 2 in a build without
 * jansson. plan_free frees it, also after a failure.
 */
int plan_file_read(struct plan *plan, const char *command, const char *path);

/* Read a text. Returns 1, or 0 after filling the fault. Free the plan also then. For plan_file_read, where there is JSON. */
struct json_fault;
int plan_file_parse(struct plan *plan, const char *text, size_t size, struct json_fault *fault);

#endif
