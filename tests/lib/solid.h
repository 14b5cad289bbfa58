/* SPDX-License-Identifier: BSD-3-Clause */
/* For the tests of depth and regions: a mesh as the library and as the oracles see it, and a capsule that slides. */
#ifndef DPT_TESTS_SOLID_H
#define DPT_TESTS_SOLID_H

#include "data/motion.h"
#include "dynpoint.h"
#include "dynpoint/compile.h"
#include "lib/check.h"
#include "lib/vector.h"
#include "oracle/depth.h"
#include "scene/shape.h"

struct solid {
    const char *name;
    dpt_compiled compiled;
    const dpt_mesh *mesh;
    dpt_mesh_info info;
    float *corners; /* 9 a triangle that was kept */
    oracle_mesh *brute;
    struct oracle_solid oracle;
    struct motion_place place;
    double diagonal;
};

static inline void solid_close(struct solid *solid)
{
    oracle_brute_close(solid->brute);
    free(solid->corners);
    dpt_compiled_free(&solid->compiled);
}

int solid_from_arrays(struct solid *solid, const char *name, const double *vertices, size_t vertex_count,
                      const uint32_t *corners, size_t triangle_count);

int solid_from_shape(struct solid *solid, const char *name, uint64_t count);

/* `name` must live as long as the solid. */
int solid_from_file(struct solid *solid, const char *name, const char *path, double scale);

/* A plane-like net of `rows` by `columns` cells, two triangles each; wraps round where asked. */
int solid_from_net(struct solid *solid, const char *name, uint32_t rows, uint32_t columns, int wrap,
                   void (*place)(double u, double v, double x[3]));

/*
 * About the origin, of what is convex: the radii of the ball that touches its faces from within and of the one that
 * holds it, and by what angle a face's normal is off the way from there to a corner, at most.
 */
void solid_balls(const struct solid *solid, double *inner, double *outer, double *tilt);

/* Turn a segment about the point at `s`. */
void turn_about(double ends[6], double s, const double axis[3], double angle);

/*
 * A capsule that slides over a mesh: along a direction that turns slowly, itself turning, held at `gap` by small steps
 * along the way out. It stays outside with its axis, so that the stateless nearest pair tells that way.
 */
struct slide {
    const dpt_mesh *mesh;
    double ends[6], radius;
    double gap;       /* wanted */
    double step;      /* of a tick, m */
    double spin;      /* of a tick, rad */
    double axis[3];   /* about it */
    double course[3]; /* unit */
    uint64_t seed;
};

/* From a random triangle, lying on it. */
void slide_begin(struct slide *slide, const struct solid *solid, uint64_t seed, double length, double radius);

void slide_step(struct slide *slide);

/* Ids that were seen, and when last: one that was gone does not come back. */
struct id_history {
    uint32_t id[4096];
    uint64_t tick[4096];
    size_t count;
    uint64_t ticks; /* so far, for callers that count none */
};

void check_ids(struct id_history *ids, uint64_t tick, const dpt_contact *contacts, uint32_t count, const char *text);

/* The middle of a random triangle, and its normal, of unit length. */
void solid_random_place(const struct solid *solid, uint64_t *seed, double at[3], double out[3]);

#endif
