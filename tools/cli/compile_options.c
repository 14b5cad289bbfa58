/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/compile_options.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command_options.h"

const char *const spring_kinds[] = { "sheet", "volume", NULL };

void spring_options_init(struct spring_options *options)
{
    *options = (struct spring_options){ .young = NAN,
                                        .density = NAN,
                                        .drag = NAN,
                                        .viscosity = NAN,
                                        .thickness = NAN,
                                        .bending = NAN,
                                        .spacing = NAN,
                                        .poisson = NAN };
    dpt_spring_net_def_init(&options->def);
}

typedef dpt_result regions_read_fn(struct spring_regions *regions, const struct compile_context *context,
                                   const unsigned char *bytes, size_t size);

static int load_regions(struct spring_options *options, const char *command, const char *path, const char *out,
                        regions_read_fn *read)
{
    dpt_diag diag = { .size = sizeof diag };
    struct compile_context context;
    size_t size;
    if (!path)
        return 0;
    if (output_check(command, out, (const char *const[]){ path, NULL }))
        return 2;
    void *bytes = load_file(command, path, &size);
    if (!bytes)
        return 2;
    compile_context_init(&context, NULL, &diag);
    const dpt_result result = read(&options->regions, &context, bytes, size);
    free(bytes);
    return result == DPT_OK ? 0 : complain_of_file(command, path, &diag);
}

/* A number that was given is that of one kind of springs, or of both, and in its range. */
static int take_numbers(struct spring_options *options, const char *command)
{
    dpt_spring_net_def *def = &options->def;
    const struct {
        const char *name;
        double given, *to, min, max;
        uint32_t kind; /* the only one that has it; 0: both */
        int may_be_0;
    } numbers[] = {
        { "--young", options->young, &def->young, 0.0, 1e12, 0, 0 },
        { "--density", options->density, &def->density, 0.0, 1e9, 0, 0 },
        { "--drag", options->drag, &def->drag, 0.0, 1e9, 0, 1 },
        { "--viscosity", options->viscosity, &def->viscosity, 0.0, 1e9, 0, 1 },
        { "--thickness", options->thickness, &def->thickness, 0.0, 1e6, DPT_NET_SHEET, 0 },
        { "--bending", options->bending, &def->bending, 0.0, 1e12, DPT_NET_SHEET, 1 },
        { "--spacing", options->spacing, &def->spacing, 0.0, 1e6, DPT_NET_VOLUME, 0 },
        { "--poisson", options->poisson, &def->poisson, 0.1, 0.45, DPT_NET_VOLUME, 1 },
    };
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        const double given = numbers[i].given;
        if (isnan(given))
            continue;
        if (!options->kind)
            return complain(command, "%s needs --springs", numbers[i].name);
        if (numbers[i].kind && numbers[i].kind != def->kind)
            return complain(command, "%s is not for --springs %s", numbers[i].name, options->kind);
        if (!(given >= numbers[i].min && given <= numbers[i].max) || (given == 0.0 && !numbers[i].may_be_0))
            return complain(command, "%s must be %g to %g%s", numbers[i].name, numbers[i].min, numbers[i].max,
                            numbers[i].may_be_0 ? "" : ", and not 0");
        *numbers[i].to = given;
    }
    return 0;
}

int spring_options_take(struct spring_options *options, const char *command, const char *out, dpt_compile_def *def)
{
    const int is_sheet = options->kind && word_index(options->kind, spring_kinds) == 0;
    options->def.kind = is_sheet ? DPT_NET_SHEET : DPT_NET_VOLUME;
    if (take_numbers(options, command))
        return 2;
    if (!options->kind && (options->regions_path || options->fixed_path))
        return complain(command, "%s needs --springs", options->regions_path ? "--regions" : "--fixed");
    if (!options->kind)
        return 0;
    if (load_regions(options, command, options->regions_path, out, regions_read) ||
        load_regions(options, command, options->fixed_path, out, fixed_read))
        return 2;
    options->def.regions = options->regions.regions;
    options->def.region_count = (uint32_t)options->regions.region_count;
    options->def.fixed = options->regions.fixed;
    options->def.fixed_count = (uint32_t)options->regions.fixed_count;
    def->springs = &options->def;
    return 0;
}

void spring_options_free(struct spring_options *options)
{
    regions_free(&options->regions);
}

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

typedef dpt_result tetgen_read_fn(struct tetgen *mesh, const struct compile_context *context,
                                  const unsigned char *bytes, size_t size);

static int load_cells(struct cell_files *files, const char *command, const char *path, tetgen_read_fn *read,
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
    int status = load_cells(files, command, files->node_path, tetgen_read_nodes, def);
    if (status == 0)
        status = load_cells(files, command, files->ele_path, tetgen_read_cells, def);
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
