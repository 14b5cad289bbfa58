/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * TetGen's text: a line with the counts, then a line for each node or cell, which begins with its number.
 *
 *     .node   <nodes> 3 <attributes> <markers>         <number> <x> <y> <z> ...
 *     .ele    <cells> 4 <regions>                      <number> <node> <node> <node> <node> ...
 */
#include "compile/read_tetgen.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "compile/embed.h"
#include "compile/text.h"

/* What the two kinds of file differ in. */
struct kind {
    const char *items;      /* in messages */
    const char *count_name; /* of the first number */
    const char *width_name; /* of the second one */
    int64_t width;          /* which it must be */
    int64_t line_bytes;     /* of the shortest line of an item, with the end of the line before it */
};

static const struct kind of_nodes = { "nodes", "the number of nodes", "the dimension", 3, 8 };
static const struct kind of_cells = { "cells", "the number of cells", "the nodes of a cell", 4, 10 };

static dpt_result read_counts(source_text *text, const struct kind *kind, uint32_t *count)
{
    int64_t announced, width;
    if (!text_seek_word(text))
        return compile_fail(text->context, DPT_E_TRUNCATED, text_location(text), "the file ends before its counts");
    DPT_TRY(text_read_int(text, kind->count_name, &announced));
    DPT_TRY(text_read_int(text, kind->width_name, &width));
    if (width != kind->width)
        return compile_fail(text->context, DPT_E_FORMAT, text_location(text),
                            "%s is %" PRId64 ": only %" PRId64 " is read", kind->width_name, width, kind->width);
    if (announced < 1)
        return compile_fail(text->context, DPT_E_EMPTY, text_location(text), "%s is %" PRId64 ": one is the least",
                            kind->count_name, announced);
    const int64_t bytes_after = (int64_t)(text->end - text->at);
    if (announced > bytes_after / kind->line_bytes)
        return compile_fail(text->context, DPT_E_TRUNCATED, text_location(text),
                            "%" PRId64 " %s do not fit in %" PRId64 " bytes", announced, kind->items, bytes_after);
    if (announced > INT32_MAX)
        return compile_fail(text->context, DPT_E_LIMIT, text_location(text), "more than %d %s", INT32_MAX, kind->items);
    *count = (uint32_t)announced;
    return DPT_OK;
}

/* Go to the line of item i, from 0, and read its number. */
static dpt_result begin_item(source_text *text, const struct kind *kind, uint32_t i, uint32_t count, int64_t *number)
{
    if (!text_next_line(text) || !text_seek_word(text))
        return compile_fail(text->context, DPT_E_TRUNCATED, text_location(text),
                            "the file ends after %" PRIu32 " of %" PRIu32 " %s", i, count, kind->items);
    return text_read_int(text, "the number", number);
}

static dpt_result end_items(source_text *text, const struct kind *kind, uint32_t count)
{
    if (!text_next_line(text) || !text_seek_word(text))
        return DPT_OK;
    return compile_fail(text->context, DPT_E_TRAILING, text_location(text), "text follows the last of %" PRIu32 " %s",
                        count, kind->items);
}

static dpt_result begin_file(source_text *text, const struct kind *kind, const struct compile_context *context,
                             const unsigned char *bytes, size_t size, uint32_t *count)
{
    text_begin(text, context, bytes, size);
    text->has_comments = 1;
    DPT_TRY(text_refuse_utf16(text));
    return read_counts(text, kind, count);
}

static dpt_result no_memory(const source_text *text)
{
    return compile_fail(text->context, DPT_E_MEMORY, text_location(text), "memory ran out");
}

dpt_result tetgen_read_nodes(struct tetgen *mesh, const struct compile_context *context, const unsigned char *bytes,
                             size_t size)
{
    static const char *const names[3] = { "x", "y", "z" };
    source_text text;
    int64_t number;
    DPT_TRY(begin_file(&text, &of_nodes, context, bytes, size, &mesh->node_count));
    mesh->nodes = malloc(mesh->node_count * 3 * sizeof *mesh->nodes);
    if (!mesh->nodes)
        return no_memory(&text);
    for (uint32_t i = 0; i < mesh->node_count; i++) {
        double *x = mesh->nodes + 3 * (size_t)i;
        DPT_TRY(begin_item(&text, &of_nodes, i, mesh->node_count, &number));
        if (i == 0 && number != 0 && number != 1)
            return compile_fail(context, DPT_E_SYNTAX, text_location(&text),
                                "the first node has the number %" PRId64 ", not 0 or 1", number);
        if (i == 0)
            mesh->base = (uint32_t)number;
        if (number != (int64_t)i + mesh->base)
            return compile_fail(context, DPT_E_SYNTAX, text_location(&text), "node %" PRId64 " follows node %" PRId64,
                                number, (int64_t)i + mesh->base - 1);
        for (int k = 0; k < 3; k++)
            DPT_TRY(text_read_double(&text, names[k], &x[k]));
        DPT_TRY(embed_check_node(context, x, number, text_location(&text)));
    }
    return end_items(&text, &of_nodes, mesh->node_count);
}

static dpt_result read_cell(const struct tetgen *mesh, source_text *text, int64_t number, uint32_t cell[4])
{
    for (int k = 0; k < 4; k++) {
        int64_t node;
        DPT_TRY(text_read_int(text, "a node", &node));
        if (node < mesh->base || node - mesh->base >= mesh->node_count)
            return compile_fail(text->context, DPT_E_INDEX, text_location(text),
                                "cell %" PRId64 " names node %" PRId64 ": there are %" PRIu32 ", counted from %" PRIu32,
                                number, node, mesh->node_count, mesh->base);
        cell[k] = (uint32_t)(node - mesh->base);
    }
    return embed_check_cell(text->context, mesh->nodes, cell, number, text_location(text));
}

dpt_result tetgen_read_cells(struct tetgen *mesh, const struct compile_context *context, const unsigned char *bytes,
                             size_t size)
{
    source_text text;
    int64_t number;
    DPT_TRY(begin_file(&text, &of_cells, context, bytes, size, &mesh->cell_count));
    mesh->cells = malloc(mesh->cell_count * 4 * sizeof *mesh->cells);
    if (!mesh->cells)
        return no_memory(&text);
    for (uint32_t i = 0; i < mesh->cell_count; i++) {
        DPT_TRY(begin_item(&text, &of_cells, i, mesh->cell_count, &number));
        DPT_TRY(read_cell(mesh, &text, number, mesh->cells + 4 * (size_t)i));
    }
    return end_items(&text, &of_cells, mesh->cell_count);
}

void tetgen_free(struct tetgen *mesh)
{
    free(mesh->nodes);
    free(mesh->cells);
    memset(mesh, 0, sizeof *mesh);
}
