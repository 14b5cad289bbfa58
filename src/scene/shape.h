/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Test meshes, built in memory. The same arguments give the same bytes on every machine: only
 * + - * / and sqrt are used, and sincos.h, and nothing is fused (-ffp-contract=off). Metres; closed
 * meshes are wound outward.
 */
#ifndef DPT_SCENE_SHAPE_H
#define DPT_SCENE_SHAPE_H

#include <stddef.h>
#include <stdint.h>

#define SHAPE_TRIANGLES_MAX 10000000u

struct shape {
    double *vertices; /* 3 per vertex */
    size_t vertex_count;
    uint32_t *corners; /* 3 per triangle */
    size_t triangle_count;
};

void shape_free(struct shape *shape);

/* Which numbers of triangles a shape can have. */
enum shape_counts {
    SHAPE_ANY,
    SHAPE_EVEN,
    SHAPE_TWO_SQUARES,    /* 2 k^2 */
    SHAPE_TWELVE_SQUARES, /* 12 k^2 */
    SHAPE_RINGS           /* 64 k */
};

/* Build a shape of `count` triangles, a number that the shape can have. Returns 0, or -1 if memory runs out. */
typedef int shape_maker(uint32_t count, uint64_t seed, struct shape *shape);

struct shape_kind {
    const char *name;
    uint32_t default_count; /* triangles if the user gives no number; 0: a number is required */
    uint32_t count_min;
    enum shape_counts counts;
    shape_maker *make;
    const char *help;
};

extern const struct shape_kind shape_kinds[];
extern const size_t shape_kind_count;

/* Why a shape could not be made. */
#define SHAPE_REASON_BYTES 100
typedef char shape_reason[SHAPE_REASON_BYTES];

/*
 * Build a shape by its name. Returns 0, or -1 and the reason; then the shape is empty.
 *
 *   count   triangles; 0: the shape's default
 *   seed    moves the bumps of organs, the folds of the cloth and the spikes of the star
 */
int shape_make(const char *name, uint64_t count, uint64_t seed, struct shape *shape, shape_reason reason);

/*
 * The three bodies of the laparoscopic scene, `count` triangles in all. An odd count leaves the
 * stomach open at its inlet.
 */
enum { LAPAROSCOPIC_BODIES = 3, LAPAROSCOPIC_TRIANGLES = 5387, LAPAROSCOPIC_MIN = 1000 };
extern const char *const laparoscopic_names[LAPAROSCOPIC_BODIES];
int shape_make_laparoscopic(uint64_t count, uint64_t seed, struct shape bodies[LAPAROSCOPIC_BODIES],
                            shape_reason reason);

/* For the makers. */

/* A surface for new vertices: `project` moves a point near it onto it. */
struct shape_surface {
    void (*project)(const void *context, double point[3]);
    const void *context;
};

/* Start an empty shape with room for so many vertices and triangles. Returns 0, or -1 if memory runs out. */
int shape_begin(struct shape *shape, size_t vertices, size_t triangles);

/* Append within that room. */
void shape_add_vertex(struct shape *shape, double x, double y, double z);
void shape_add_triangle(struct shape *shape, size_t a, size_t b, size_t c);

/*
 * Split the longest edges, new vertices on the surface, until there are `count` triangles, for
 * which there must be room, also for one vertex each. A split adds two triangles; if one is missing
 * in the end, the longest border edge is split first, which adds one.
 */
int shape_split_to(struct shape *shape, size_t count, const struct shape_surface *surface);

/* The largest k with k^2 <= n. */
uint32_t square_root_below(uint64_t n);

/* Uniform in [0, 1). */
double shape_random(uint64_t *state);

shape_maker shape_sphere, shape_star, shape_liver, shape_stomach, shape_spleen;

#endif
