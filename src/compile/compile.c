/* SPDX-License-Identifier: BSD-3-Clause */
/* The compiler from end to end: read, clean, order, adjacency, intersections, solid, normals, embed, springs, write. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "arm/arm_format.h"
#include "base/return_if_error.h"
#include "base/sized.h"
#include "base/vec3.h"
#include "compile/compile_context.h"
#include "compile/foreign.h"
#include "compile/model.h"
#include "compile/spring_build.h"
#include "compile/text.h"
#include "text/open_file.h"

/* ---- the format of a file ---- */

/* Do the bytes begin with the whole magic of a compiled mesh or arm? */
static int is_compiled(const unsigned char *bytes, size_t size)
{
    return size >= 8 && (memcmp(bytes, MESH_MAGIC, 8) == 0 || memcmp(bytes, ARM_MAGIC, 8) == 0);
}

static int is_ply(source_text text)
{
    source_word word;
    return text_next_word(&text, &word) && word_is(&word, "ply") && !text_next_word(&text, &word);
}

/* OFF with any prefix of the format, including those that the reader then refuses by name. */
static int is_off(source_text text)
{
    source_word word;
    text.has_comments = 1;
    if (!text_seek_word(&text) || !text_next_word(&text, &word))
        return 0;
    while (word.begin < word.end && memchr("STCN4n", *word.begin, 6))
        word.begin++;
    if (word.end - word.begin < 3 || memcmp(word.begin, "OFF", 3) != 0)
        return 0;
    const char *after = word.begin + 3;
    return after == word.end || (*after >= '0' && *after <= '9');
}

static int is_binary_stl(const unsigned char *bytes, size_t size)
{
    if (size < 84)
        return 0;
    uint64_t count =
        (uint64_t)bytes[80] | (uint64_t)bytes[81] << 8 | (uint64_t)bytes[82] << 16 | (uint64_t)bytes[83] << 24;
    return size == 84 + 50 * count;
}

static int is_ascii_stl(source_text text)
{
    source_word word;
    return text_seek_word(&text) && text_next_word(&text, &word) && word_is_any_case(&word, "solid") &&
           text_next_line(&text) && text_seek_word(&text) && text_next_word(&text, &word) &&
           word_is_any_case(&word, "facet");
}

static int has_vertex_line(source_text text)
{
    source_word word;
    do {
        if (text_next_word(&text, &word) && word_is(&word, "v") && text_next_word(&text, &word))
            return 1;
    } while (text_next_line(&text));
    return 0;
}

static uint32_t format_of_extension(const char *path)
{
    static const struct {
        const char *ending;
        uint32_t format;
    } extensions[] = {
        { "obj", DPT_FORMAT_OBJ }, { "stl", DPT_FORMAT_STL }, { "ply", DPT_FORMAT_PLY }, { "off", DPT_FORMAT_OFF }
    };
    const char *dot = path ? strrchr(path, '.') : NULL;
    if (!dot)
        return DPT_FORMAT_AUTO;
    source_word word = { dot + 1, dot + strlen(dot) };
    for (size_t i = 0; i < sizeof extensions / sizeof extensions[0]; i++) {
        if (word_is_any_case(&word, extensions[i].ending))
            return extensions[i].format;
    }
    return DPT_FORMAT_AUTO;
}

uint32_t source_format(const char *path, const unsigned char *bytes, size_t size)
{
    source_text text;
    text_begin(&text, NULL, bytes, size);
    if (is_ply(text))
        return DPT_FORMAT_PLY;
    if (is_off(text))
        return DPT_FORMAT_OFF;
    if (is_binary_stl(bytes, size) || is_ascii_stl(text))
        return DPT_FORMAT_STL;
    if (is_compiled(bytes, size) || foreign_format_of(bytes, size))
        return DPT_FORMAT_AUTO;
    uint32_t format = format_of_extension(path);
    if (format == DPT_FORMAT_AUTO && has_vertex_line(text))
        return DPT_FORMAT_OBJ;
    return format;
}

/* 3D Slicer writes which way its axes point into the header, or the first comment, of a mesh. */
static void note_space(const soup *source, const unsigned char *bytes, size_t size)
{
    static const char word[] = "SPACE=";
    const size_t length = sizeof word - 1, end = size < 1024 ? size : 1024;
    for (size_t at = 0; at + length + 3 <= end; at++) {
        if (memcmp(bytes + at, word, length) != 0)
            continue;
        if (memcmp(bytes + at + length, "LPS", 3) == 0)
            compile_note(
                source->context, (source_location){ 0, at },
                "SPACE=LPS, by 3D Slicer, in mm: x to the patient's left, y to the back; of meshes in RAS x and y "
                "are reversed");
        if (memcmp(bytes + at + length, "RAS", 3) == 0)
            compile_note(
                source->context, (source_location){ 0, at },
                "SPACE=RAS, by 3D Slicer, in mm: x to the patient's right, y to the front; of meshes in LPS x and "
                "y are reversed");
        return;
    }
}

static dpt_result refuse_format(const soup *source, const unsigned char *bytes, size_t size)
{
    const struct foreign_format *foreign = foreign_format_of(bytes, size);
    const source_location nowhere = { 0, 0 };
    if (!size)
        return compile_fail(source->context, DPT_E_EMPTY, nowhere, "the file is empty");
    if (foreign)
        return compile_fail(source->context, DPT_E_FORMAT, nowhere,
                            "this is %s: make it an STL (docs/algorithms/compile.md#other-formats)", foreign->name);
    return compile_fail(source->context, DPT_E_FORMAT, nowhere, "neither OBJ, STL, PLY nor OFF");
}

dpt_result read_source(soup *source, uint32_t format, const unsigned char *bytes, size_t size)
{
    if (format != DPT_FORMAT_STL && is_compiled(bytes, size))
        return compile_fail(source->context, DPT_E_FORMAT, (source_location){ 0, 0 },
                            "this is compiled already: a .dpa file");
    if (format != DPT_FORMAT_AUTO)
        note_space(source, bytes, size);
    switch (format) {
    case DPT_FORMAT_OBJ:
        return read_obj(source, bytes, size);
    case DPT_FORMAT_STL:
        return read_stl(source, bytes, size);
    case DPT_FORMAT_PLY:
        return read_ply(source, bytes, size);
    case DPT_FORMAT_OFF:
        return read_off(source, bytes, size);
    default:
        return refuse_format(source, bytes, size);
    }
}

/* ---- from end to end ---- */

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

/* Begin a step: the callback hears of it. */
static dpt_result begin_step(const struct compile_context *context, const char *step)
{
    return compile_report_progress(context, step, 0.0);
}

static dpt_result take_steps(struct model *model, soup *source)
{
    const struct compile_context *context = source->context;
    DPT_TRY(soup_check_corners(source));
    DPT_TRY(soup_recentre(source));
    DPT_TRY(soup_check_rounding(source));
    DPT_TRY(soup_cut_polygons(source));
    DPT_TRY(begin_step(context, "clean"));
    DPT_TRY(model_clean(model, source));
    DPT_TRY(begin_step(context, "order"));
    DPT_TRY(model_order(model, source));
    DPT_TRY(begin_step(context, "adjacency"));
    DPT_TRY(model_adjacency(model, context));
    DPT_TRY(begin_step(context, "intersections"));
    DPT_TRY(model_intersections(model, context));
    DPT_TRY(begin_step(context, "solid"));
    DPT_TRY(model_solid(model, context));
    DPT_TRY(begin_step(context, "normals"));
    DPT_TRY(model_normals(model, context, context->crease));
    if (context->def && context->def->cell_count)
        DPT_TRY(begin_step(context, "embed"));
    DPT_TRY(model_embed(model, source));
    if (context->def && context->def->springs)
        DPT_TRY(begin_step(context, "springs"));
    DPT_TRY(model_springs(model, source));
    return begin_step(context, "write");
}

static dpt_result build(soup *source, uint64_t source_size, uint64_t source_hash, dpt_compiled *out)
{
    struct model model = { .corners = NULL };
    dpt_result result = take_steps(&model, source);
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
    struct compile_context context;
    soup source;
    dpt_compile_def def;
    dpt_spring_net_def springs;
    dpt_diag diag;
};

/* Copy the def of the springs. */
static dpt_result take_springs(struct compile_call *call)
{
    const struct compile_context *context = &call->context;
    const dpt_spring_net_def *given = call->def.springs;
    call->springs.size = sizeof call->springs;
    call->def.springs = &call->springs;
    dpt_result result =
        sized_read(given, SIZED_FIRST(dpt_spring_net_def, poisson), &call->springs, sizeof call->springs);
    if (result == DPT_E_UNSUPPORTED)
        return compile_fail(context, result, nowhere, "the def of the springs has newer fields");
    if (result != DPT_OK)
        return compile_fail(context, result, nowhere, "the size of the springs' def is not set");
    if (call->def.cell_count)
        return compile_fail(context, DPT_E_ARGUMENT, nowhere, "springs and cells exclude each other");
    return springs_check(context, &call->springs);
}

/* A def of an older version may end within a pointer. */
static void drop_half_pointers(dpt_compile_def *def, size_t size)
{
    if (size < offsetof(dpt_compile_def, name))
        def->springs = NULL;
    if (size < offsetof(dpt_compile_def, note))
        def->name = NULL;
    if (size < offsetof(dpt_compile_def, note_user))
        def->note = NULL;
    if (size < sizeof *def)
        def->note_user = NULL;
}

/* Check the arguments and fill in `call`. end_call must follow, whatever is returned. */
static dpt_result begin_call(struct compile_call *call, const dpt_compile_def *given, dpt_compiled *out,
                             const dpt_diag *diag)
{
    struct compile_context *context = &call->context;
    dpt_compile_def *def = &call->def;
    memset(call, 0, sizeof *call);
    compile_context_init(context, NULL, &call->diag);
    soup_init(&call->source, context);
    if (out)
        *out = (dpt_compiled){ NULL, 0 };
    if (diag)
        DPT_TRY(sized_check(diag, sizeof *diag, 0));
    if (!out)
        return compile_fail(context, DPT_E_ARGUMENT, nowhere, "no place for the bytes");
    dpt_result result = given ? sized_read(given, SIZED_FIRST(dpt_compile_def, crease), def, sizeof *def) : DPT_OK;
    if (result == DPT_E_UNSUPPORTED)
        return compile_fail(context, result, nowhere, "the def has fields of a newer version");
    if (result != DPT_OK)
        return compile_fail(context, result, nowhere, "the def's size field is not set");
    if (given)
        drop_half_pointers(def, sized_of(given));
    compile_context_init(context, def, &call->diag);
    if (def->recentre > 1)
        return compile_fail(context, DPT_E_ARGUMENT, nowhere, "recentre must be 0 or 1");
    if (def->format > DPT_FORMAT_OFF)
        return compile_fail(context, DPT_E_ARGUMENT, nowhere, "no such format");
    if (def->scale < 0.0 || !within(def->scale, 1e30))
        return compile_fail(context, DPT_E_ARGUMENT, nowhere, "the scale must be positive");
    if (!(context->crease > 0.0 && context->crease <= CREASE_MAX))
        return compile_fail(context, DPT_E_ARGUMENT, nowhere, "the crease must be 0..pi");
    if (!def->node_count != !def->cell_count)
        return compile_fail(context, DPT_E_ARGUMENT, nowhere, "nodes without cells, or cells without");
    if (def->cell_count && (!def->nodes || !def->cells))
        return compile_fail(context, DPT_E_ARGUMENT, nowhere, "no nodes or no cells");
    if (def->cell_count && def->recentre)
        return compile_fail(context, DPT_E_ARGUMENT, nowhere, "recentre and cells exclude each other");
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
    DPT_TRY(compile_report_progress(source->context, "read", 0.0));
    struct read_job job = { .source = source, .format = format, .bytes = bytes, .size = size };
    parallel_for(size < HASH_MIN ? 1 : source->context->threads, 2, 1, read_and_hash, &job);
    DPT_TRY(job.result);
    return build(source, size, job.hash, out);
}

dpt_result dpt_compile_bytes(const void *bytes, size_t size, const dpt_compile_def *def, dpt_compiled *out,
                             dpt_diag *diag)
{
    struct compile_call call;
    dpt_result result = begin_call(&call, def, out, diag);
    if (result == DPT_OK && !bytes && size)
        result = compile_fail(&call.context, DPT_E_ARGUMENT, nowhere, "no bytes");
    if (result == DPT_OK)
        result = compile_bytes(&call, call.def.name, size ? (const unsigned char *)bytes : (const unsigned char *)"",
                               size, out);
    return end_call(&call, result, diag);
}

/* What has no length may be endless: a pipe, /dev/zero. */
#define STREAM_MAX ((size_t)1 << 30)

static int has_length(FILE *file)
{
    const int has_one = fseek(file, 0, SEEK_END) == 0 && ftell(file) > 0;
    rewind(file);
    return has_one;
}

/* Read all of a file into a block that grows, because a pipe has no length. The caller frees *bytes. */
static dpt_result read_all(const struct compile_context *context, FILE *file, unsigned char **bytes, size_t *size)
{
    const size_t max = has_length(file) ? SIZE_MAX : STREAM_MAX;
    size_t capacity = 0;
    for (;;) {
        if (*size == capacity) {
            size_t new_capacity = capacity ? 2 * capacity : (size_t)1 << 16;
            unsigned char *grown = new_capacity > capacity ? realloc(*bytes, new_capacity) : NULL;
            if (!grown)
                return compile_fail(context, DPT_E_MEMORY, nowhere, "memory ran out");
            *bytes = grown;
            capacity = new_capacity;
        }
        size_t read_count = fread(*bytes + *size, 1, capacity - *size, file);
        *size += read_count;
        if (ferror(file))
            return compile_fail(context, DPT_E_OPEN, nowhere, "it cannot be read: %s", strerror(errno));
        if (!read_count)
            return DPT_OK;
        if (*size > max)
            return compile_fail(context, DPT_E_LIMIT, nowhere,
                                "it has no length, and more than %zu bytes come: what is larger must be a file", max);
    }
}

dpt_result dpt_compile_file(const char *path, const dpt_compile_def *def, dpt_compiled *out, dpt_diag *diag)
{
    struct compile_call call;
    unsigned char *bytes = NULL;
    size_t size = 0;
    dpt_result result = begin_call(&call, def, out, diag);
    if (result == DPT_OK && !path)
        result = compile_fail(&call.context, DPT_E_ARGUMENT, nowhere, "no name of a file");
    FILE *file = result == DPT_OK ? open_file(path, "rb") : NULL;
    if (result == DPT_OK && !file)
        result = compile_fail(&call.context, DPT_E_OPEN, nowhere, "it cannot be opened: %s", strerror(errno));
    if (result == DPT_OK)
        result = read_all(&call.context, file, &bytes, &size);
    if (result == DPT_OK)
        result = compile_bytes(&call, path, bytes, size, out);
    if (file)
        fclose(file);
    free(bytes);
    return end_call(&call, result, diag);
}

/* A count that is none, as -1 of another language, would be read far beyond the arrays. */
static dpt_result check_counts(const struct compile_context *context, size_t vertex_count, size_t triangle_count)
{
    if (vertex_count > COUNT_MAX)
        return compile_fail(context, DPT_E_LIMIT, nowhere, "more than %zu vertices", COUNT_MAX);
    if (triangle_count > TRIANGLES_MAX)
        return compile_fail(context, DPT_E_LIMIT, nowhere, "more than %zu triangles", TRIANGLES_MAX);
    return DPT_OK;
}

dpt_result dpt_compile_arrays(const double *vertices, size_t vertex_count, const uint32_t *corners,
                              size_t triangle_count, const dpt_compile_def *def, dpt_compiled *out, dpt_diag *diag)
{
    struct compile_call call;
    dpt_result result = begin_call(&call, def, out, diag);
    if (result == DPT_OK && ((!vertices && vertex_count) || (!corners && triangle_count)))
        result = compile_fail(&call.context, DPT_E_ARGUMENT, nowhere, "no vertices or no corners");
    if (result == DPT_OK)
        result = check_counts(&call.context, vertex_count, triangle_count);
    for (size_t v = 0; result == DPT_OK && v < vertex_count; v++)
        result = soup_add_vertex(&call.source, vertices[3 * v], vertices[3 * v + 1], vertices[3 * v + 2],
                                 (source_location){ 0, 3 * sizeof *vertices * v });
    for (size_t t = 0; result == DPT_OK && t < triangle_count; t++)
        result = soup_add_polygon(&call.source, corners + 3 * t, 3, (source_location){ 0, 3 * sizeof *corners * t });
    if (result == DPT_OK)
        result = build(&call.source, 0, 0, out);
    return end_call(&call, result, diag);
}
