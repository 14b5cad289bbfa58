/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Meshes of tetrahedra as TetGen writes them: NAME.node has the nodes, NAME.ele the cells. A word that begins with #
 * ends its line. Attributes, regions and boundary markers are ignored, and so are the numbers of cells.
 */
#ifndef DPT_COMPILE_READ_TETGEN_H
#define DPT_COMPILE_READ_TETGEN_H

#include "compile/soup.h"

struct tetgen {
    double *nodes;   /* 3 each, in units of the source */
    uint32_t *cells; /* 4 nodes each, from 0 */
    uint32_t node_count, cell_count;
    uint32_t base; /* number of the first node in the files, 0 or 1 */
};

/*
 * Read all bytes of one of the two files; the nodes come first. `source` gives the scale and the diag. Nodes and cells
 * that the compiler would refuse are refused here, with their line. Returns DPT_OK, or fills the diag and returns its
 * code. Call tetgen_free in either case; begin with a zeroed struct.
 */
dpt_result tetgen_read_nodes(struct tetgen *mesh, const struct compile_context *context, const unsigned char *bytes,
                             size_t size);
dpt_result tetgen_read_cells(struct tetgen *mesh, const struct compile_context *context, const unsigned char *bytes,
                             size_t size);
void tetgen_free(struct tetgen *mesh);

#endif
