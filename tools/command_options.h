/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What the sub-commands share: complaints, options, whole files in and whole files out.
 */
#ifndef DPT_TOOLS_COMMAND_OPTIONS_H
#define DPT_TOOLS_COMMAND_OPTIONS_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "dynpoint.h"

/* Print "dynpoint COMMAND: ..." as one line on standard error; returns 2, the exit status. */
int complain(const char *command, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 2, 3)))
#endif
    ;

/* An option of a command. Exactly one of the pointers is set. */
struct option_def {
    const char *name; /* "--scale", "-o" */
    const char **text;
    double *number;
    uint64_t *count;
    int *flag;
};

/*
 * Sort the arguments after argv[0] into options and operands, at most `room` of these; *operands says how
 * many there were. Prints `help` for --help. Returns -1 to go on, else the exit status.
 */
int parse_options(int argc, char **argv, const struct option_def *options, size_t option_count,
                  const char *help, const char **operand, size_t operand_capacity,
                  size_t *operands);

/* Which of `words` (ended by NULL) the text is; -1 for none. */
int word_index(const char *text, const char *const *words);

/*
 * A file that is written beside and renamed when complete. "-" is standard output; what is no regular file
 * (a device, a pipe, a link) is written through, never replaced. A file that was there keeps its permissions.
 */
struct output {
    FILE *file;
    const char *path;
    char *part_path; /* NULL where nothing is renamed */
};

/* Refuses an output that is one of the inputs, by whatever name; NULL ends them. 0, or 2 after the complaint. */
int output_check(const char *command, const char *path, const char *const *inputs);

/* Each 0, or 2 after the complaint; then nothing is left behind. */
int output_open(struct output *output, const char *command, const char *path);
int output_complete(struct output *output, const char *command); /* all is written */
int output_keep(struct output *output, const char *command);     /* so is standard output */
int output_close(struct output *output, const char *command);    /* both */
void output_drop(struct output *output);                         /* instead of keeping it */

/* All that was printed is out: 0, or 2 after the complaint. */
int flush_stdout(const char *command);

/*
 * Progress on a terminal, for what takes more than a second: how much of `what` is done (0..1). The line
 * is wiped at 1. Begin with a zeroed meter.
 */
struct meter {
    long began; /* s */
    int shown;
};
void meter_show(struct meter *meter, const char *what, double done);

/*
 * The bytes of a file, which is opened and read once, so that it may be a pipe; "-" is standard input. Aligned to 64,
 * zero-terminated; NULL after the complaint.
 */
void *load_file(const char *command, const char *path, size_t *size);

/* Open a file's bytes as a mesh; NULL after a complaint with the byte and section that are wrong. */
const dpt_mesh *open_mesh(const char *command, const char *path, void *bytes, size_t size);

/* Both: an open mesh, and the bytes to free. */
const dpt_mesh *load_mesh(const char *command, const char *path, void **bytes);

#endif
