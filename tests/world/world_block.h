/* SPDX-License-Identifier: BSD-3-Clause */
/* A world in a block from the heap, for tests of the world's calls. */
#ifndef DPT_TESTS_WORLD_BLOCK_H
#define DPT_TESTS_WORLD_BLOCK_H

#include <math.h>

#include "dynpoint/baseline.h"
#include "lib/fixture.h"

struct world_block {
    void *block;
    size_t bytes;
    dpt_world *world;
};

/* A failed check if the world cannot be created. */
void world_block_open(struct world_block *made, const dpt_world_def *def);

/* Room for 4 bodies, 3 tools, 6 segments. */
dpt_world_def small_def(void);

dpt_segment capsule(double ax, double ay, double az, double bx, double by, double bz, double radius);

#endif
