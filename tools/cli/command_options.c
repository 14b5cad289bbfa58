/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/command_options.h"

#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "scene/host_file.h"
#include "text/parse_number.h"

int complain(const char *command, const char *format, ...)
{
    va_list arguments;
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

static const struct option_def *find_option(const char *name, const struct option_def *options, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(options[i].name, name) == 0)
            return &options[i];
    return NULL;
}

static int read_value(const char *command, const struct option_def *option, const char *value)
{
    const char *end = value + strlen(value);
    int64_t whole;
    if (option->text)
        *option->text = value;
    else if (option->number && parse_double(value, end, option->number) != end)
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

int parse_options(int argc, char **argv, const struct command_syntax *syntax, const char **operand,
                  size_t operand_capacity, size_t *operands)
{
    const char *command = argv[0];
    *operands = 0;
    for (int i = 1; i < argc; i++) {
        const struct option_def *option = find_option(argv[i], syntax->options, syntax->option_count);
        if (strcmp(argv[i], "--help") == 0) {
            fputs(syntax->help, stdout);
            return 0;
        }
        if (strcmp(argv[i], "--version") == 0) {
            printf("dynpoint %s\n", dpt_version());
            return 0;
        }
        if (option && option->flag) {
            *option->flag = 1;
        } else if (option) {
            if (++i == argc)
                return complain(command, "%s needs a value", option->name);
            int status = read_value(command, option, argv[i]);
            if (status >= 0)
                return status;
        } else if (argv[i][0] == '-' && argv[i][1]) {
            return complain(command, "unknown option %s (see --help)", argv[i]);
        } else if (*operands == operand_capacity) {
            return complain(command, "one argument too many: %s (see --help)", argv[i]);
        } else {
            operand[(*operands)++] = argv[i];
        }
    }
    return -1;
}

int word_index(const char *text, const char *const *words)
{
    for (int i = 0; words[i]; i++)
        if (strcmp(text, words[i]) == 0)
            return i;
    return -1;
}

static int stat_file(const char *path, int standard, struct stat *status)
{
    return strcmp(path, "-") ? stat(path, status) : fstat(standard, status);
}

int output_check(const char *command, const char *path, const char *const *inputs)
{
    struct stat out, in;
    if (stat_file(path, STDOUT_FILENO, &out) != 0 || !S_ISREG(out.st_mode))
        return 0;
    for (; *inputs; inputs++)
        if (stat_file(*inputs, STDIN_FILENO, &in) == 0 && in.st_dev == out.st_dev && in.st_ino == out.st_ino)
            return complain(command, "%s: it is an input too, and would be overwritten", path);
    return 0;
}

/* Whether `endings` has the ending, whatever its case. */
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
    signal(SIGXFSZ, SIG_IGN); /* an error like that of a full disk */
    if (strcmp(path, "-") == 0)
        return 0;
    struct stat status;
    const int exists = lstat(path, &status) == 0;
    if (exists && !S_ISREG(status.st_mode)) {
        output->file = fopen(path, "wb");
        if (output->file)
            return 0;
        return complain(command, "%s: cannot be written: %s", path, strerror(errno));
    }
    signal(SIGPIPE, SIG_IGN); /* a closed pipe must not leave the .part file behind */
    output->part_path = malloc(strlen(path) + sizeof suffix);
    if (!output->part_path)
        return complain(command, "memory ran out");
    strcpy(output->part_path, path);
    strcat(output->part_path, suffix);
    output->file = fopen(output->part_path, "wb");
    if (output->file) {
        if (exists)
            fchmod(fileno(output->file), status.st_mode & 0777);
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
    if (status == 0 && output->part_path && rename(output->part_path, output->path) != 0)
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
        remove(output->part_path);
    free(output->part_path);
    output->part_path = NULL;
}

int flush_stdout(const char *command)
{
    if (fflush(stdout) == 0 && !ferror(stdout))
        return 0;
    return complain(command, "standard output cannot be written: %s", strerror(errno ? errno : EIO));
}

void meter_show(struct meter *meter, const char *what, double done)
{
    long now = (long)time(NULL);
    if (!meter->began)
        meter->began = now;
    if (done >= 1.0 && meter->shown)
        fputs("\r                     \r", stderr);
    if (done >= 1.0 || now - meter->began < 2 || !isatty(2))
        return;
    fprintf(stderr, "\r%-12.12s %3.0f %%", what, 100.0 * done);
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
