/* SPDX-License-Identifier: BSD-3-Clause */
/* For the tests of strips: a mesh as the library has it and as the oracles do, and strips on the heap. */
#ifndef DPT_TESTS_STRIP_SUBJECT_H
#define DPT_TESTS_STRIP_SUBJECT_H

#include <math.h>

#include "dynpoint.h"
#include "dynpoint/compile.h"
#include "dynpoint/strip.h"
#include "lib/check.h"
#include "oracle/surface.h"
#include "scene/shape.h"

struct subject {
    char name[264];
    dpt_compiled compiled;
    const dpt_mesh *mesh;
    dpt_mesh_info info;
    struct oracle_surface surface; /* by source numbers */
    double diagonal;
};

static inline void subject_close(struct subject *subject)
{
    oracle_surface_close(&subject->surface);
    dpt_compiled_free(&subject->compiled);
}

/* What is compiled already; 0 when it cannot be opened. */
int subject_open(struct subject *subject);

int subject_from_arrays(struct subject *subject, const char *name, const double *vertices, size_t vertex_count,
                        const uint32_t *corners, size_t triangle_count);

int subject_from_shape(struct subject *subject, const char *name, uint64_t count);

int subject_from_file(struct subject *subject, const char *data, const char *folder, const char *file);

/*
 * Triangles of a lattice of size^3 points, drawn at random: of many parts, and every kind of neighbour; some come
 * twice or have no area.
 */
int subject_from_lattice(struct subject *subject, uint32_t size, uint32_t triangles, uint64_t seed);

/* Each public mesh, opened. */
void for_public_meshes(const char *data, void (*each)(const struct subject *subject));

/* A strip in a block of exactly the bytes it asked for, and 8 more that must stay. */
struct guarded_strip {
    unsigned char *block;
    size_t bytes;
    dpt_strip *strip;
};

dpt_strip *guarded_strip_open(struct guarded_strip *guarded, uint32_t capacity, uint32_t search);

static inline void guarded_strip_close(struct guarded_strip *guarded)
{
    for (size_t i = guarded->bytes; i < guarded->bytes + 8; i++)
        CHECK(guarded->block[i] == 0x5a, "wrote %zu bytes beyond its block", i - guarded->bytes + 1);
    free(guarded->block);
}

#endif
