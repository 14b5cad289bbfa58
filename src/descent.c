/* SPDX-License-Identifier: BSD-3-Clause */
#include "descent.h"

struct step {
    struct nearest best;
    int shared; /* vertices that the best neighbour has in common with the triangle left */
    uint32_t tried;
};

static int has_corner(const uint32_t *corners, uint32_t vertex)
{
    return corners[0] == vertex || corners[1] == vertex || corners[2] == vertex;
}

/* How many of the first `count` corners of `of` the triangle has. */
static int shared_corners(const uint32_t *of, int count, const uint32_t *triangle)
{
    int shared = 0;
    for (int k = 0; k < count; k++)
        shared += has_corner(triangle, of[k]);
    return shared;
}

static void try_neighbour(const struct tree *tree, vec3 a, vec3 u, uint32_t neighbour, int shared,
                          struct step *step)
{
    pair found = tree_pair(tree, neighbour, a, u);
    struct nearest *best = &step->best;
    step->tried++;
    if (found.distance2 > best->pair.distance2)
        return;
    if (found.distance2 == best->pair.distance2) {
        if (shared < step->shared)
            return;
        if (shared == step->shared && tree->sources[neighbour] > tree->sources[best->triangle])
            return;
    }
    best->pair = found;
    best->triangle = neighbour;
    step->shared = shared;
}

/* The nearest neighbour, if it is nearer: 1 and `nearest` is there. */
static int move(const struct tree *tree, vec3 a, vec3 u, struct nearest *nearest)
{
    const uint32_t *first = mesh_words(tree->mesh, MESH_FAN_FIRST);
    const uint32_t *fans = mesh_words(tree->mesh, MESH_FANS);
    const uint32_t *here = tree->corners + 3 * (size_t)nearest->triangle;
    struct step step = { .best = *nearest, .shared = 4 }; /* to stay wins every tie */
    for (int k = 0; k < 3; k++)
        for (uint32_t i = first[here[k]]; i < first[here[k] + 1]; i++) {
            const uint32_t *there = tree->corners + 3 * (size_t)fans[i];
            if (fans[i] == nearest->triangle || shared_corners(here, k, there))
                continue; /* itself, or met in the fan of an earlier corner */
            try_neighbour(tree, a, u, fans[i], shared_corners(here, 3, there), &step);
        }
    int moved = step.best.triangle != nearest->triangle;
    step.best.work += (step.tried + LANES - 1) / LANES;
    *nearest = step.best;
    return moved;
}

void descend(const struct tree *tree, vec3 a, vec3 u, int one_step, struct nearest *nearest)
{
    nearest->pair = tree_pair(tree, nearest->triangle, a, u);
    while (move(tree, a, u, nearest) && !one_step)
        ;
}
