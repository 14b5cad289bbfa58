/* SPDX-License-Identifier: BSD-3-Clause */
/* `dynpoint compile --list`: many meshes, on several threads, with a row of results for each. */
#ifndef DPT_TOOLS_COMPILE_LIST_H
#define DPT_TOOLS_COMPILE_LIST_H

#include "dynpoint/compile.h"

/*
 * Compile what a manifest lists: lines IN, a tab, OUT; empty lines and those that begin with # are skipped. The table of
 * results has a line for each, in the manifest's order: IN, OUT, a verdict (DPT_OK or an error's name), SHA-256 of the
 * .dpa file, seconds, and what was said of the source; tabs between.
 *
 * A row is added as soon as its file is there. Called again with a table that was cut, or whose files are missing, the
 * rest is done. The table's first line has the settings: a table of other settings is refused.
 *
 * One call at a time: the manifest is locked, unless it is a pipe, and a second call is refused. So is dynpoint.bulk of
 * Python's package. An output may be in one line alone, by any name of its folder.
 *
 *   def       its callbacks are not used; `threads` is how many meshes are compiled at one time
 *   results   at the end 0; 1 if some sources were refused; 2 after a message
 */
int compile_list(const char *manifest, const char *results, const dpt_compile_def *def);

#endif
