/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What the sub-commands share: error messages, options, and files read and written as a whole.
 */
#ifndef DPT_TOOLS_COMMAND_OPTIONS_H
#define DPT_TOOLS_COMMAND_OPTIONS_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "dynpoint.h"
#include "dynpoint/host.h"

/*
 * Errors of a command name what was typed from now on: another command that it serves, as view does run, or a sub-command
 * of it. Both texts last.
 */
void complain_as(const char *command, const char *typed);

/* Print "dynpoint COMMAND: ..." as one line on standard error; returns 2, the exit status. */
int complain(const char *command, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 2, 3)))
#endif
    ;

/*
 * What a call of the host library returned, and said: prints it if it failed, or if there is a note for people. Returns 0,
 * or 2, the exit status, after a failure.
 */
int complain_of(const char *command, dpt_result result, const dpt_host_error *error);

/* The values of an option that may be given several times, in their order. */
enum { OPTION_TEXTS_MAX = 16 };
struct option_texts {
    const char *text[OPTION_TEXTS_MAX];
    size_t count;
};

/* What a value or an operand is: what a shell may complete it with. */
enum value_kind { VALUE_ANY, VALUE_FILE, VALUE_SCENE, VALUE_DEVICE };

/* An option of a command, and where its value goes: exactly one of the pointers is not NULL. */
struct option_def {
    const char *name; /* "--scale", "-o" */
    const char **text;
    double *number;
    uint64_t *count;
    int *flag;
    struct option_texts *texts;
    enum value_kind kind;
    const char *const *words; /* of a text: all that it may be, ended by NULL; or NULL */
};

struct operand_def {
    enum value_kind kind;
    const char *const *words; /* what it may be, ended by NULL; or NULL */
};

/* What a command takes. */
struct command_syntax {
    const struct option_def *options;
    size_t option_count;
    const char *help;                   /* what --help prints */
    const struct operand_def *operands; /* in their order, for completion alone */
    size_t operand_count;
    int repeats; /* the last of them may be given again and again */
};

/* A command's syntax, of arrays. */
#define COMMAND_SYNTAX(options, help, operands)                                                                        \
    (&(struct command_syntax){ options, sizeof(options) / sizeof *(options), help, operands,                           \
                               sizeof(operands) / sizeof *(operands), 0 })

/*
 * Sort the arguments after argv[0] into options and operands. An option's value may follow it after a blank or after an
 * equals sign. Texts that have words are one of them, or refused. --help, -h, --version and -V are answered. If the first
 * argument is COMPLETE_ARGUMENT, what the last one may be is printed instead (complete.h).
 *   operand    room for `operand_capacity` operands
 *   operands   how many there were
 *
 * Returns -1 to go on, else the exit status.
 */
int parse_options(int argc, char **argv, const struct command_syntax *syntax, const char **operand,
                  size_t operand_capacity, size_t *operands);

/* Those of the options that `names` has, with blanks between, into `chosen`, which has room for all; how many there are. */
size_t choose_options(const struct option_def *options, size_t count, const char *names, struct option_def *chosen);

/* The first argument that is one of the words, as word_index; -1: none is. A command that has others of its own begins so. */
int find_word(int argc, char **argv, const char *const *words);

/* The index of the text in `words`, which ends with NULL; -1 if it is none of them. */
int word_index(const char *text, const char *const *words);

/* Say that a text is none of the words, which they are, and which was probably meant. Returns 2. */
int complain_of_word(const char *command, const char *what, const char *text, const char *const *words);

/*
 * A file to write. It is written under another name beside the path, and renamed when complete. "-" is standard output.
 * If the path is no regular file (a device, a pipe, a link), it is written directly and never replaced. A file that is
 * replaced keeps its permissions.
 */
struct output {
    FILE *file;
    const char *path;
    char *part_path; /* what is written and renamed; NULL: nothing is renamed */
};

/* Refuse an output that is one of the inputs (ended by NULL), by whatever name. Returns 0, or 2 after a message. */
int output_check(const char *command, const char *path, const char *const *inputs);

/*
 * Refuse a name that says another format than the one that is written. Names that say none are taken.
 *   endings   those of the format, with blanks between: ".csv .txt"
 *   what      "a picture in SVG"
 * Returns 0, or 2 after a message.
 */
int output_check_name(const char *command, const char *path, const char *endings, const char *what);

/* Each returns 0, or 2 after a message; then nothing is left behind. */
int output_open(struct output *output, const char *command, const char *path);
int output_complete(struct output *output, const char *command); /* call when all is written */
int output_keep(struct output *output, const char *command);     /* flush standard output, rename */
int output_close(struct output *output, const char *command);    /* both */
void output_drop(struct output *output);                         /* remove it instead */

/* Flush standard output. Returns 0, or 2 after a message. */
int flush_stdout(const char *command);

/*
 * Show progress on a terminal for work that takes more than a second: which fraction (0..1) of `what` is done, and the
 * time that is left if the rest goes on like that. At 1 the line is wiped. Begin with a zeroed meter.
 */
struct meter {
    long began; /* s */
    int shown;
};
void meter_show(struct meter *meter, const char *what, double done);

/*
 * Read a file as a whole; "-" is standard input. It is opened and read once, so it may be a pipe. The bytes are aligned
 * to 64 and followed by a zero; the caller frees them. NULL after a message.
 */
void *load_file(const char *command, const char *path, size_t *size);

/* Open a file's bytes as a mesh; NULL after a message that names the wrong byte and section. */
const dpt_mesh *open_mesh(const char *command, const char *path, void *bytes, size_t size);

/* Read and open a mesh. *bytes is what to free. NULL after a message, with nothing to free. */
const dpt_mesh *load_mesh(const char *command, const char *path, void **bytes);

#endif
