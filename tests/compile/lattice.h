/* SPDX-License-Identifier: BSD-3-Clause */
/* A block of space cut into tetrahedra, as a physics mesh for the tests of embeddings. */
#ifndef DPT_TESTS_LATTICE_H
#define DPT_TESTS_LATTICE_H

#include <stddef.h>
#include <stdint.h>

#include "dynpoint/compile.h"

struct lattice {
    double *nodes;
    uint32_t *cells;
    uint32_t node_count, cell_count;
};

/*
 * across^3 cubes between two corners, six tetrahedra each. With a seed that is not 0 inner nodes are moved a little,
 * nodes and cells are shuffled, and cells are wound either way.
 */
void lattice_make(struct lattice *lattice, uint32_t across, const double low[3], const double high[3], uint64_t seed);

void lattice_free(struct lattice *lattice);

/* Let a def embed in it. */
void lattice_use(const struct lattice *lattice, dpt_compile_def *def);

#endif
