/* SPDX-License-Identifier: BSD-3-Clause */
#include "compile/lattice.h"

#include <stdlib.h>
#include <string.h>

#include "lib/random.h"

static void place_nodes(struct lattice *lattice, uint32_t across, const double low[3], const double high[3],
                        uint64_t *random)
{
    const uint32_t side = across + 1;
    for (uint32_t i = 0; i < lattice->node_count; i++) {
        const uint32_t at[3] = { i % side, i / side % side, i / side / side };
        for (int k = 0; k < 3; k++) {
            const int is_inner = at[k] > 0 && at[k] < across;
            const double moved = *random && is_inner ? random_in(random, -0.12, 0.12) : 0.0;
            lattice->nodes[3 * i + (uint32_t)k] = low[k] + (high[k] - low[k]) * ((double)at[k] + moved) / across;
        }
    }
}

/* Six ways from one corner of a cube to the opposite one, along its edges. */
static void cut_cube(uint32_t *cells, uint32_t corner, uint32_t side)
{
    const uint32_t step[3] = { 1, side, side * side };
    static const int ways[6][3] = { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 2, 1, 0 } };
    for (int i = 0; i < 6; i++) {
        uint32_t node = corner;
        for (int k = 0; k < 4; k++) {
            cells[4 * i + k] = node;
            node += k < 3 ? step[ways[i][k]] : 0;
        }
    }
}

static void swap_items(void *items, size_t size, size_t a, size_t b)
{
    unsigned char kept[32], *bytes = items;
    memcpy(kept, bytes + a * size, size);
    memmove(bytes + a * size, bytes + b * size, size);
    memcpy(bytes + b * size, kept, size);
}

static void shuffle(struct lattice *lattice, uint64_t *random)
{
    uint32_t *number = malloc(lattice->node_count * sizeof *number);
    uint32_t *place = malloc(lattice->node_count * sizeof *place);
    for (uint32_t i = 0; i < lattice->node_count; i++)
        number[i] = i;
    for (uint32_t i = lattice->node_count - 1; i > 0; i--) {
        const size_t other = random_bits(random) % (i + 1);
        swap_items(number, sizeof *number, i, other);
        swap_items(lattice->nodes, 3 * sizeof *lattice->nodes, i, other);
    }
    for (uint32_t i = 0; i < lattice->node_count; i++)
        place[number[i]] = i;
    for (uint32_t i = 0; i < 4 * lattice->cell_count; i++)
        lattice->cells[i] = place[lattice->cells[i]];
    for (uint32_t i = lattice->cell_count - 1; i > 0; i--) {
        uint32_t *cell = lattice->cells + 4 * (size_t)i;
        swap_items(cell, sizeof *cell, 0, random_bits(random) % 4);
        swap_items(cell, sizeof *cell, 1, 1 + random_bits(random) % 3);
        swap_items(lattice->cells, 4 * sizeof *cell, i, random_bits(random) % (i + 1));
    }
    free(number);
    free(place);
}

void lattice_make(struct lattice *lattice, uint32_t across, const double low[3], const double high[3], uint64_t seed)
{
    const uint32_t side = across + 1, cubes = across * across * across;
    uint64_t random = seed;
    lattice->node_count = side * side * side;
    lattice->cell_count = 6 * cubes;
    lattice->nodes = malloc(lattice->node_count * 3 * sizeof *lattice->nodes);
    lattice->cells = malloc(lattice->cell_count * 4 * sizeof *lattice->cells);
    place_nodes(lattice, across, low, high, &random);
    for (uint32_t i = 0; i < cubes; i++)
        cut_cube(lattice->cells + 24 * (size_t)i,
                 i % across + side * (i / across % across) + side * side * (i / across / across), side);
    if (seed)
        shuffle(lattice, &random);
}

void lattice_free(struct lattice *lattice)
{
    free(lattice->nodes);
    free(lattice->cells);
}

void lattice_use(const struct lattice *lattice, dpt_compile_def *def)
{
    def->nodes = lattice->nodes;
    def->cells = lattice->cells;
    def->node_count = lattice->node_count;
    def->cell_count = lattice->cell_count;
}
