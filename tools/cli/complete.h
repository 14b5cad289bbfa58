/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a shell completes a line with. `dynpoint complete WORD...` is called by the shells' scripts (tools/packaging/complete)
 * with the words before the cursor but "dynpoint"; the last one, which may be empty, is the one to complete. It prints
 *
 *     a word a line that begins with the last one, and
 *     :files    where the name of a file may stand
 *
 * The tables that say so are those by which arguments are read (command_options.h).
 */
#ifndef DPT_TOOLS_COMPLETE_H
#define DPT_TOOLS_COMPLETE_H

#include "cli/command_options.h"

/* The first argument of a command whose others are to be completed. */
#define COMPLETE_ARGUMENT "--complete"

/* Print what the last of the arguments may be. */
void complete_argument(int argc, char **argv, const struct command_syntax *syntax);

/* Print the words, ended by NULL, that begin with `text`. */
void complete_words(const char *text, const char *const *words);

#endif
