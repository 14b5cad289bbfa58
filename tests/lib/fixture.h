/* SPDX-License-Identifier: BSD-3-Clause */
/* Meshes for tests, compiled in memory from arrays or from the shapes that `dynpoint make` knows. */
#ifndef DPT_TESTS_FIXTURE_H
#define DPT_TESTS_FIXTURE_H

#include "dynpoint.h"
#include "dynpoint/compile.h"
#include "lib/check.h"
#include "scene/shape.h"

struct fixture {
    dpt_compiled compiled;
    const dpt_mesh *mesh;
};

int fixture_from_arrays(struct fixture *fixture, const double *vertices, size_t vertex_count, const uint32_t *corners,
                        size_t triangle_count);

int fixture_from_arrays_with_springs(struct fixture *fixture, const double *vertices, size_t vertex_count,
                                     const uint32_t *corners, size_t triangle_count, const dpt_spring_net_def *net);

/* `count` 0: as many triangles as the shape has usually. */
int fixture_from_shape(struct fixture *fixture, const char *name, uint64_t count);
int fixture_with_springs(struct fixture *fixture, const char *name, uint64_t count, const dpt_spring_net_def *net);

static inline void fixture_free(struct fixture *fixture)
{
    dpt_compiled_free(&fixture->compiled);
}

#endif
