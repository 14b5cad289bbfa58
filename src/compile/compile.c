/* SPDX-License-Identifier: BSD-3-Clause */
/* The compiler from end to end: read, clean, order, adjacency, intersections, solid, normals, embed, springs, write. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "base/sized.h"
#include "base/vec3.h"
#include "compile/model.h"
#include "compile/parallel.h"
#include "compile/spring_build.h"

static const source_location nowhere = { 0, 0 };

/* Pi in rad, rounded up: a caller's pi may be rounded, or come from 180 degrees. */
#define CREASE_MAX 3.1415926536

/* Hashing this many bytes takes a tenth of a millisecond: then a thread of its own pays. */
#define HASH_MIN ((size_t)1 << 17)

/* FNV-1a, 64 bits. It identifies the source, so that a stale .dpa can be recognised. */
static uint64_t hash_of(const void *bytes, size_t size)
{
    const unsigned char *b = bytes;
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ b[i]) * 0x100000001b3u;
    return hash;
}

static dpt_result build(soup *source, uint64_t source_size, uint64_t source_hash, dpt_compiled *out)
{
    struct model model = { .corners = NULL };
    dpt_result result = soup_check_corners(source);
    if (result == DPT_OK)
        result = soup_report_progress(source, "clean", 0.0);
    if (result == DPT_OK)
        result = model_clean(&model, source);
    if (result == DPT_OK)
        result = soup_report_progress(source, "order", 0.0);
    if (result == DPT_OK)
        result = model_order(&model, source);
    if (result == DPT_OK)
        result = soup_report_progress(source, "adjacency", 0.0);
    if (result == DPT_OK)
        result = model_adjacency(&model, source);
    if (result == DPT_OK)
        result = soup_report_progress(source, "intersections", 0.0);
    if (result == DPT_OK)
        result = model_intersections(&model, source);
    if (result == DPT_OK)
        result = soup_report_progress(source, "solid", 0.0);
    if (result == DPT_OK)
        result = model_solid(&model, source);
    if (result == DPT_OK)
        result = soup_report_progress(source, "normals", 0.0);
    if (result == DPT_OK)
        result = model_normals(&model, source, source->crease);
    if (result == DPT_OK && source->def && source->def->cell_count)
        result = soup_report_progress(source, "embed", 0.0);
    if (result == DPT_OK)
        result = model_embed(&model, source);
    if (result == DPT_OK && source->def && source->def->springs)
        result = soup_report_progress(source, "springs", 0.0);
    if (result == DPT_OK)
        result = model_springs(&model, source);
    if (result == DPT_OK)
        result = soup_report_progress(source, "write", 0.0);
    if (result == DPT_OK)
        result = model_write(&model, source, source_size, source_hash, out);
    model_free(&model);
    return result;
}

void dpt_compile_def_defaults(dpt_compile_def *def, size_t size)
{
    const dpt_compile_def defaults = { .scale = 1.0, .crease = CREASE_DEFAULT, .threads = 1 };
    sized_defaults(def, size, &defaults, sizeof defaults);
}

/*
 * State of one public call. `def` and `diag` are copies in this library's version; the caller's may be older or newer.
 */
struct compile_call {
    soup source;
    dpt_compile_def def;
    dpt_spring_net_def springs;
    dpt_diag diag;
};

/* Copy the def of the springs. */
static dpt_result take_springs(struct compile_call *call)
{
    soup *source = &call->source;
    const dpt_spring_net_def *given = call->def.springs;
    call->springs.size = sizeof call->springs;
    call->def.springs = &call->springs;
    dpt_result result = sized_read(given, sizeof call->springs, &call->springs, sizeof call->springs);
    if (result == DPT_E_UNSUPPORTED)
        return soup_fail(source, result, nowhere, "the def of the springs has newer fields");
    if (result != DPT_OK)
        return soup_fail(source, result, nowhere, "the size of the springs' def is not set");
    if (call->def.cell_count)
        return soup_fail(source, DPT_E_ARGUMENT, nowhere, "springs and cells exclude each other");
    return springs_check(source, &call->springs);
}

/* Check the arguments and fill in `call`. end_call must follow, whatever is returned. */
static dpt_result begin_call(struct compile_call *call, const dpt_compile_def *given, dpt_compiled *out,
                             const dpt_diag *diag)
{
    soup *source = &call->source;
    dpt_compile_def *def = &call->def;
    memset(call, 0, sizeof *call);
    soup_init(source, NULL, &call->diag);
    if (out)
        *out = (dpt_compiled){ NULL, 0 };
    if (diag)
        DPT_TRY(sized_check(diag, sizeof *diag, 0));
    if (!out)
        return soup_fail(source, DPT_E_ARGUMENT, nowhere, "no place for the bytes");
    dpt_result result = given ? sized_read(given, SIZED_FIRST(dpt_compile_def, crease), def, sizeof *def) : DPT_OK;
    if (result == DPT_E_UNSUPPORTED)
        return soup_fail(source, result, nowhere, "the def has fields of a newer version");
    if (result != DPT_OK)
        return soup_fail(source, result, nowhere, "the def's size field is not set");
    if (given && sized_of(given) < offsetof(dpt_compile_def, name))
        def->springs = NULL; /* of half a pointer */
    if (given && sized_of(given) < sizeof *def)
        def->name = NULL; /* likewise */
    soup_init(source, def, &call->diag);
    if (def->reserved)
        return soup_fail(source, DPT_E_ARGUMENT, nowhere, "the def's reserved fields are not 0");
    if (def->format > DPT_FORMAT_OFF)
        return soup_fail(source, DPT_E_ARGUMENT, nowhere, "no such format");
    if (def->scale < 0.0 || !within(def->scale, 1e30))
        return soup_fail(source, DPT_E_ARGUMENT, nowhere, "the scale must be positive");
    if (!(source->crease > 0.0 && source->crease <= CREASE_MAX))
        return soup_fail(source, DPT_E_ARGUMENT, nowhere, "the crease must be 0..pi");
    if (!def->node_count != !def->cell_count)
        return soup_fail(source, DPT_E_ARGUMENT, nowhere, "nodes without cells, or cells without");
    if (def->cell_count && (!def->nodes || !def->cells))
        return soup_fail(source, DPT_E_ARGUMENT, nowhere, "no nodes or no cells");
    return def->springs ? take_springs(call) : DPT_OK;
}

/* Free the soup and write the caller's diag. Returns `result`. */
static dpt_result end_call(struct compile_call *call, dpt_result result, dpt_diag *diag)
{
    soup_free(&call->source);
    if (diag && sized_check(diag, sizeof *diag, 0) == DPT_OK)
        sized_write(diag, diag->size, &call->diag, sizeof call->diag);
    return result;
}

/* Reading and hashing a file's bytes: two items of a parallel loop. */
struct read_job {
    soup *source;
    uint32_t format;
    const unsigned char *bytes;
    size_t size;
    dpt_result result;
    uint64_t hash;
};

static void read_and_hash(void *context, size_t first, size_t end)
{
    struct read_job *job = context;
    if (first == 0)
        job->result = read_source(job->source, job->format, job->bytes, job->size);
    if (end == 2)
        job->hash = hash_of(job->bytes, job->size);
}

static dpt_result compile_bytes(struct compile_call *call, const char *path, const unsigned char *bytes, size_t size,
                                dpt_compiled *out)
{
    soup *source = &call->source;
    uint32_t format = call->def.format;
    if (format == DPT_FORMAT_AUTO)
        format = source_format(path, bytes, size);
    DPT_TRY(soup_report_progress(source, "read", 0.0));
    struct read_job job = { .source = source, .format = format, .bytes = bytes, .size = size };
    parallel_for(size < HASH_MIN ? 1 : source->threads, 2, 1, read_and_hash, &job);
    DPT_TRY(job.result);
    return build(source, size, job.hash, out);
}

dpt_result dpt_compile_bytes(const void *bytes, size_t size, const dpt_compile_def *def, dpt_compiled *out,
                             dpt_diag *diag)
{
    struct compile_call call;
    dpt_result result = begin_call(&call, def, out, diag);
    if (result == DPT_OK && !bytes && size)
        result = soup_fail(&call.source, DPT_E_ARGUMENT, nowhere, "no bytes");
    if (result == DPT_OK)
        result = compile_bytes(&call, call.def.name, size ? bytes : (const void *)"", size, out);
    return end_call(&call, result, diag);
}

/* Read all of a file into a block that grows, because a pipe has no length. The caller frees *bytes. */
static dpt_result read_all(soup *source, FILE *file, unsigned char **bytes, size_t *size)
{
    size_t capacity = 0;
    for (;;) {
        if (*size == capacity) {
            size_t new_capacity = capacity ? 2 * capacity : (size_t)1 << 16;
            unsigned char *grown = new_capacity > capacity ? realloc(*bytes, new_capacity) : NULL;
            if (!grown)
                return soup_fail(source, DPT_E_MEMORY, nowhere, "memory ran out");
            *bytes = grown;
            capacity = new_capacity;
        }
        size_t read_count = fread(*bytes + *size, 1, capacity - *size, file);
        *size += read_count;
        if (ferror(file))
            return soup_fail(source, DPT_E_OPEN, nowhere, "it cannot be read: %s", strerror(errno));
        if (!read_count)
            return DPT_OK;
    }
}

dpt_result dpt_compile_file(const char *path, const dpt_compile_def *def, dpt_compiled *out, dpt_diag *diag)
{
    struct compile_call call;
    unsigned char *bytes = NULL;
    size_t size = 0;
    dpt_result result = begin_call(&call, def, out, diag);
    if (result == DPT_OK && !path)
        result = soup_fail(&call.source, DPT_E_ARGUMENT, nowhere, "no name of a file");
    FILE *file = result == DPT_OK ? fopen(path, "rb") : NULL;
    if (result == DPT_OK && !file)
        result = soup_fail(&call.source, DPT_E_OPEN, nowhere, "it cannot be opened: %s", strerror(errno));
    if (result == DPT_OK)
        result = read_all(&call.source, file, &bytes, &size);
    if (result == DPT_OK)
        result = compile_bytes(&call, path, bytes, size, out);
    if (file)
        fclose(file);
    free(bytes);
    return end_call(&call, result, diag);
}

dpt_result dpt_compile_arrays(const double *vertices, size_t vertex_count, const uint32_t *corners,
                              size_t triangle_count, const dpt_compile_def *def, dpt_compiled *out, dpt_diag *diag)
{
    struct compile_call call;
    dpt_result result = begin_call(&call, def, out, diag);
    if (result == DPT_OK && ((!vertices && vertex_count) || (!corners && triangle_count)))
        result = soup_fail(&call.source, DPT_E_ARGUMENT, nowhere, "no vertices or no corners");
    for (size_t v = 0; result == DPT_OK && v < vertex_count; v++)
        result = soup_add_vertex(&call.source, vertices[3 * v], vertices[3 * v + 1], vertices[3 * v + 2],
                                 (source_location){ 0, 3 * sizeof *vertices * v });
    for (size_t t = 0; result == DPT_OK && t < triangle_count; t++)
        result = soup_add_polygon(&call.source, corners + 3 * t, 3, (source_location){ 0, 3 * sizeof *corners * t });
    if (result == DPT_OK)
        result = build(&call.source, 0, 0, out);
    return end_call(&call, result, diag);
}
