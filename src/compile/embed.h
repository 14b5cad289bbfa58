/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks the nodes and cells of an embedding, and embeds vertices in them. */
#ifndef DPT_COMPILE_EMBED_H
#define DPT_COMPILE_EMBED_H

#include "compile/model.h"

/* Nodes and cells to embed in. */
struct embed_cells {
    const double *nodes;   /* 3 each */
    const uint32_t *cells; /* 4 nodes each */
    uint32_t node_count, cell_count;
    double scale; /* of the nodes, to m */
};

/* Embed the vertices of the model. The cells must have been checked. Fills in the model's embedding. */
dpt_result embed_in(struct model *model, soup *source, const struct embed_cells *cells);

/*
 * Check node `number` at x, y, z, in units of the source: finite, and not too far off after scaling. Returns DPT_OK, or
 * fills the diag and returns its code.
 */
dpt_result embed_check_node(const struct compile_context *context, const double x[3], int64_t number,
                            source_location location);

/* Check a cell of four of `nodes`: it has a volume. Their indices must be right. Returns as embed_check_node. */
dpt_result embed_check_cell(const struct compile_context *context, const double *nodes, const uint32_t cell[4],
                            int64_t number, source_location location);

#endif
