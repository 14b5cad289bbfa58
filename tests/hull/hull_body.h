/* SPDX-License-Identifier: BSD-3-Clause */
/* A mesh for the tests of hulls, as the library sees it and as the oracle does: triangles in the order of places. */
#ifndef DPT_TESTS_HULL_BODY_H
#define DPT_TESTS_HULL_BODY_H

#include "hull/hull_maker.h"
#include "kernel/kernel_ops.h"
#include "lib/fixture.h"
#include "mesh/surface.h"
#include "oracle/hull_surface.h"

struct hull_body {
    const char *name;
    struct fixture fixture;
    struct surface surface;
    struct kernel kernel;
    double *corners; /* 9 a triangle */
    struct oracle_triangles triangles;
    double diagonal;
};

int body_from_shape(struct hull_body *body, const char *name, uint64_t count);

/* Of DPT_DATA; `name` must live as long as the body. */
int body_from_data(struct hull_body *body, const char *data, const char *name);

void body_close(struct hull_body *body);

/* A random place on a random triangle, and the triangle's unit normal. */
vec3 body_place(const struct hull_body *body, uint64_t *random, vec3 *normal);

/* A sheet of `rows` by `rows` cells, flat or in waves, in z = 0. */
int body_from_sheet(struct hull_body *body, uint32_t rows, int is_wavy);

#endif
