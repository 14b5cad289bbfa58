/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/cell_file.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command_options.h"

int complain_of_file(const char *command, const char *path, const dpt_diag *diag)
{
    if (diag->line)
        return complain(command, "%s:%" PRIu64 ": %s", path, diag->line, diag->text);
    if (diag->byte)
        return complain(command, "%s: byte %" PRIu64 ": %s", path, diag->byte, diag->text);
    return complain(command, "%s: %s", path, diag->text);
}

/* The first `length` bytes of the base, and an ending; NULL when memory runs out. */
static char *path_of(const char *base, size_t length, const char *ending)
{
    const size_t ending_size = strlen(ending) + 1;
    char *path = malloc(length + ending_size);
    if (path) {
        memcpy(path, base, length);
        memcpy(path + length, ending, ending_size);
    }
    return path;
}

int cell_files_name(struct cell_files *files, const char *command, const char *base)
{
    const char *dot = strrchr(base, '.');
    const int has_ending = dot && (strcmp(dot, ".node") == 0 || strcmp(dot, ".ele") == 0);
    const size_t length = has_ending ? (size_t)(dot - base) : strlen(base);
    files->node_path = path_of(base, length, ".node");
    files->ele_path = path_of(base, length, ".ele");
    if (!files->node_path || !files->ele_path)
        return complain(command, "%s: memory ran out", base);
    return 0;
}

typedef dpt_result read_fn(struct tetgen *mesh, const struct compile_context *context, const unsigned char *bytes,
                           size_t size);

static int load(struct cell_files *files, const char *command, const char *path, read_fn *read,
                const dpt_compile_def *def)
{
    dpt_diag diag = { .size = sizeof diag };
    struct compile_context context;
    size_t size;
    void *bytes = load_file(command, path, &size);
    if (!bytes)
        return 2;
    compile_context_init(&context, def, &diag);
    const dpt_result result = read(&files->mesh, &context, bytes, size);
    free(bytes);
    return result == DPT_OK ? 0 : complain_of_file(command, path, &diag);
}

int cell_files_load(struct cell_files *files, const char *command, dpt_compile_def *def)
{
    int status = load(files, command, files->node_path, tetgen_read_nodes, def);
    if (status == 0)
        status = load(files, command, files->ele_path, tetgen_read_cells, def);
    if (status != 0)
        return status;
    def->nodes = files->mesh.nodes;
    def->cells = files->mesh.cells;
    def->node_count = files->mesh.node_count;
    def->cell_count = files->mesh.cell_count;
    return 0;
}

void cell_files_free(struct cell_files *files)
{
    free(files->node_path);
    free(files->ele_path);
    tetgen_free(&files->mesh);
}
