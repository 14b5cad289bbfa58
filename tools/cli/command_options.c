/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/command_options.h"

#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>
#include <unistd.h>

#include "cli/complete.h"
#include "platform/file.h"
#include "platform/program.h"
#include "scene/host_file.h"
#include "text/near_word.h"
#include "text/open_file.h"
#include "text/parse_number.h"

static struct {
    const char *command, *typed;
} renamed;

void complain_as(const char *command, const char *typed)
{
    renamed.command = command;
    renamed.typed = typed;
}

int complain(const char *command, const char *format, ...)
{
    va_list arguments;
    if (renamed.command && !strcmp(command, renamed.command))
        command = renamed.typed;
    fprintf(stderr, *command ? "dynpoint %s: " : "dynpoint%s: ", command);
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
    return 2;
}

int complain_of(const char *command, dpt_result result, const dpt_host_error *error)
{
    if (result != DPT_OK)
        return complain(command, "%s", error->text);
    if (error->text[0])
        fprintf(stderr, "%s\n", error->text);
    return 0;
}

int complain_of_word(const char *command, const char *what, const char *text, const char *const *words)
{
    char known[160]; /* of more words than there is room for, their number */
    size_t length = 0, count = 0;
    struct near_word near = near_word_begin(text, strlen(text));
    known[0] = '\0';
    for (; words[count]; count++) {
        near_word_try(&near, words[count]);
        if (length < sizeof known)
            length += (size_t)snprintf(known + length, sizeof known - length, "%s%s", count ? ", " : "", words[count]);
    }
    if (length >= sizeof known)
        snprintf(known, sizeof known, "the %zu that there are", count);
    if (near.word)
        return complain(command, "%s: '%s' is none of %s; did you mean %s?", what, text, known, near.word);
    return complain(command, "%s: '%s' is none of %s", what, text, known);
}

/* The option that an argument names, to its end or to its equals sign; NULL: none. */
static const struct option_def *find_option(const char *argument, const struct command_syntax *syntax)
{
    const size_t whole = strlen(argument), name = strcspn(argument, "=");
    const struct option_def *found = NULL;
    for (const struct option_def *option = syntax->options; option < syntax->options + syntax->option_count; option++) {
        const size_t length = strlen(option->name);
        if (length == whole && !memcmp(option->name, argument, whole))
            return option;
        if (length == name && !memcmp(option->name, argument, name))
            found = option;
    }
    return found;
}

static int complain_of_option(const char *command, const char *argument, const struct command_syntax *syntax)
{
    struct near_word near = near_word_begin(argument, strcspn(argument, "="));
    for (size_t i = 0; i < syntax->option_count; i++)
        near_word_try(&near, syntax->options[i].name);
    if (near.word)
        return complain(command, "unknown option %s; did you mean %s? (see --help)", argument, near.word);
    return complain(command, "unknown option %s (see --help)", argument);
}

/* Returns -1 to go on, else the exit status. */
static int read_value(const char *command, const struct option_def *option, const char *value)
{
    const char *end = value + strlen(value);
    int64_t whole;
    if (option->text) {
        if (option->words && word_index(value, option->words) < 0)
            return complain_of_word(command, option->name, value, option->words);
        *option->text = value;
    } else if (option->number && parse_double(value, end, option->number) != end)
        return complain(command, "%s: '%s' is not a number", option->name, value);
    else if (option->count) {
        if (parse_int(value, end, &whole) != end || whole < 0)
            return complain(command, "%s: '%s' is not a count", option->name, value);
        *option->count = (uint64_t)whole;
    } else if (option->texts) {
        if (option->texts->count == OPTION_TEXTS_MAX)
            return complain(command, "%s: at most %d of them", option->name, OPTION_TEXTS_MAX);
        option->texts->text[option->texts->count++] = value;
    }
    return -1;
}

static int is_one_of(const char *argument, const char *name, const char *short_name)
{
    return !strcmp(argument, name) || !strcmp(argument, short_name);
}

int parse_options(int argc, char **argv, const struct command_syntax *syntax, const char **operand,
                  size_t operand_capacity, size_t *operands)
{
    const char *command = argv[0];
    *operands = 0;
    if (argc > 1 && !strcmp(argv[1], COMPLETE_ARGUMENT)) {
        complete_argument(argc - 2, argv + 2, syntax);
        return 0;
    }
    for (int i = 1; i < argc; i++) {
        const struct option_def *option = find_option(argv[i], syntax);
        if (is_one_of(argv[i], "--help", "-h")) {
            fputs(syntax->help, stdout);
            return 0;
        }
        if (is_one_of(argv[i], "--version", "-V")) {
            printf("dynpoint %s\n", dpt_version());
            return 0;
        }
        const char *equals = option && argv[i][strlen(option->name)] == '=' ? argv[i] + strlen(option->name) : NULL;
        if (option && option->flag) {
            if (equals)
                return complain(command, "%s takes no value", option->name);
            *option->flag = 1;
        } else if (option) {
            if (!equals && ++i == argc)
                return complain(command, "%s needs a value", option->name);
            int status = read_value(command, option, equals ? equals + 1 : argv[i]);
            if (status >= 0)
                return status;
        } else if (argv[i][0] == '-' && argv[i][1]) {
            return complain_of_option(command, argv[i], syntax);
        } else if (*operands == operand_capacity) {
            return complain(command, "one argument too many: %s (see --help)", argv[i]);
        } else {
            operand[(*operands)++] = argv[i];
        }
    }
    return -1;
}

/* Whether one of `endings`, with blanks between, is the ending, whatever its case. */
static int is_among(const char *ending, const char *endings)
{
    const size_t length = strlen(ending);
    for (; *endings; endings += strspn(endings, " ")) {
        const size_t size = strcspn(endings, " ");
        if (size == length && strncasecmp(ending, endings, size) == 0)
            return 1;
        endings += size;
    }
    return 0;
}

size_t choose_options(const struct option_def *options, size_t count, const char *names, struct option_def *chosen)
{
    size_t taken = 0;
    for (size_t i = 0; i < count; i++)
        if (is_among(options[i].name, names))
            chosen[taken++] = options[i];
    return taken;
}

int word_index(const char *text, const char *const *words)
{
    for (int i = 0; words[i]; i++)
        if (strcmp(text, words[i]) == 0)
            return i;
    return -1;
}

int find_word(int argc, char **argv, const char *const *words)
{
    int found = -1;
    for (int i = 1; i < argc && found < 0; i++)
        found = word_index(argv[i], words);
    return found;
}

static int get_status(const char *path, FILE *standard, struct file_status *status)
{
    return strcmp(path, "-") ? file_get_status(path, status) : file_get_stream_status(standard, status);
}

int output_check(const char *command, const char *path, const char *const *inputs)
{
    struct file_status out, in;
    if (get_status(path, stdout, &out) != 0 || !out.is_regular)
        return 0;
    for (; *inputs; inputs++)
        if (get_status(*inputs, stdin, &in) == 0 && in.volume == out.volume && in.number == out.number)
            return complain(command, "%s: it is an input too, and would be overwritten", path);
    return 0;
}

int output_check_name(const char *command, const char *path, const char *endings, const char *what)
{
    static const char formats[] =
        ".csv .tsv .txt .json .dpa .dpr .svg .png .jpg .jpeg .gif .pdf .html .htm .obj .stl .ply "
        ".off .c .h .xml .zip .gz";
    const char *slash = strrchr(path, '/');
    const char *ending = strrchr(slash ? slash : path, '.');
    if (!ending || !is_among(ending, formats) || is_among(ending, endings))
        return 0;
    return complain(command, "%s: what is written is %s, and its name says another format: let it end in %.*s", path,
                    what, (int)strcspn(endings, " "), endings);
}

int output_open(struct output *output, const char *command, const char *path)
{
    static const char suffix[] = ".part";
    *output = (struct output){ .file = stdout, .path = path };
    program_ignore_file_limit(); /* an error like that of a full disk */
    if (strcmp(path, "-") == 0)
        return 0;
    struct file_status status;
    const int exists = file_get_link_status(path, &status) == 0;
    if (exists && !status.is_regular) {
        output->file = open_file(path, "wb");
        if (output->file)
            return 0;
        return complain(command, "%s: cannot be written: %s", path, strerror(errno));
    }
    program_ignore_closed_pipe(); /* a closed pipe must not leave the .part file behind */
    output->part_path = malloc(strlen(path) + sizeof suffix);
    if (!output->part_path)
        return complain(command, "memory ran out");
    strcpy(output->part_path, path);
    strcat(output->part_path, suffix);
    output->file = open_file(output->part_path, "wb");
    if (output->file) {
        if (exists)
            file_keep_mode(output->file, &status);
        return 0;
    }
    complain(command, "%s: cannot be written: %s", path, strerror(errno));
    free(output->part_path);
    return 2;
}

int output_complete(struct output *output, const char *command)
{
    int failed = ferror(output->file) != 0;
    if (!failed)
        errno = 0;
    failed |= (output->file == stdout ? fflush : fclose)(output->file) != 0;
    if (!failed)
        return 0;
    complain(command, "%s: cannot be written: %s", output->path, strerror(errno ? errno : EIO));
    output_drop(output);
    return 2;
}

int output_keep(struct output *output, const char *command)
{
    int status = flush_stdout(command);
    if (status == 0 && output->part_path && file_replace(output->part_path, output->path) != 0)
        status = complain(command, "%s: cannot be written: %s", output->path, strerror(errno));
    if (status)
        output_drop(output);
    free(output->part_path);
    output->part_path = NULL;
    return status;
}

int output_close(struct output *output, const char *command)
{
    int status = output_complete(output, command);
    return status ? status : output_keep(output, command);
}

void output_drop(struct output *output)
{
    if (output->part_path)
        file_remove(output->part_path);
    free(output->part_path);
    output->part_path = NULL;
}

int flush_stdout(const char *command)
{
    if (fflush(stdout) == 0 && !ferror(stdout))
        return 0;
    return complain(command, "standard output cannot be written: %s", strerror(errno ? errno : EIO));
}

enum { METER_LETTERS = 44 };

void meter_show(struct meter *meter, const char *what, double done)
{
    long now = (long)time(NULL);
    if (!meter->began)
        meter->began = now;
    if (done >= 1.0 && meter->shown)
        fprintf(stderr, "\r%*s\r", METER_LETTERS, "");
    if (done >= 1.0 || now - meter->began < 2 || !isatty(2))
        return;
    char line[80], left[32] = "";
    const double seconds = (double)(now - meter->began) * (1.0 - done) / (done > 0.0 ? done : 1.0);
    if (done >= 0.01 && seconds < 90.0)
        snprintf(left, sizeof left, ", %.0f s left", seconds);
    else if (done >= 0.01)
        snprintf(left, sizeof left, ", %.0f min left", seconds / 60.0);
    snprintf(line, sizeof line, "%-14.14s %3.0f %%%s", what, 100.0 * done, left);
    fprintf(stderr, "\r%-*s", METER_LETTERS, line);
    meter->shown = 1;
}

void *load_file(const char *command, const char *path, size_t *size)
{
    dpt_host_error error = { .size = sizeof error };
    void *bytes = host_file_load(path, size, &error);
    if (!bytes)
        complain(command, "%s", error.text);
    return bytes;
}

const dpt_mesh *open_mesh(const char *command, const char *path, void *bytes, size_t size)
{
    dpt_host_error error = { .size = sizeof error };
    const dpt_mesh *mesh = host_file_open_mesh(path, bytes, size, &error);
    if (!mesh)
        complain(command, "%s", error.text);
    return mesh;
}

const dpt_mesh *load_mesh(const char *command, const char *path, void **bytes)
{
    size_t size;
    *bytes = load_file(command, path, &size);
    if (!*bytes)
        return NULL;
    const dpt_mesh *mesh = open_mesh(command, path, *bytes, size);
    if (!mesh)
        free(*bytes);
    return mesh;
}
