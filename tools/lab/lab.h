/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A laboratory of force: cases that break methods on purpose (docs/stability.md). A case leads tools over meshes, or lets
 * a simulated hand hold them, and notes figures of each method: what was measured, how much is allowed, and so whether the
 * method holds. Some also note points for a chart.
 *
 * Cases are deterministic: the same figures on every machine, but for the last digits where the C library's sine is used.
 */
#ifndef DPT_TOOLS_LAB_H
#define DPT_TOOLS_LAB_H

#include <stddef.h>
#include <stdint.h>

#include "dynpoint.h"
#include "dynpoint/compile.h"

/* The methods that are compared. BALL is a proxy of one point at the tool's tip, as point-based toolkits have it. */
enum lab_method { LAB_POINT, LAB_BED, LAB_PROXY, LAB_BALL, LAB_METHODS };

/* dpt_world_def.max_contacts: the laws point and bed tell the sides of sheets by them. */
enum { LAB_CONTACTS = 32 };

/* The word for a method: "point", "bed", "proxy", "ball". */
const char *lab_method_name(int method);

struct lab_figure {
    const char *method; /* a method's word, or another subject, as "controller" */
    const char *what;   /* "largest change of force in a tick" */
    const char *unit;   /* "" if it has none */
    double value;
    double limit;    /* HUGE_VAL or -HUGE_VAL: a note, which every value meets */
    int is_at_least; /* the value must reach the limit; else it must not exceed it */
};

/* A cell of a case's table: a word, or a number where that is NULL; NAN: nothing. */
struct lab_cell {
    const char *word;
    double number;
};
enum { LAB_COLUMNS_MAX = 16 };

/* One point of a chart: a curve's name, and where it is. */
struct lab_point {
    const char *chart, *series;
    double x, y;
};

/* What a case has noted: figures, points, rows of its table. Strings belong to the case and are not copied. */
struct lab {
    double effort; /* 0..1: share of the whole number of places, paths and ticks */
    struct lab_figure *figures;
    size_t figure_count, figure_room;
    struct lab_point *points;
    size_t point_count, point_room;
    const char *const *columns; /* their names, as keys of JSON; NULL ends them. NULL: there is no table */
    struct lab_cell (*rows)[LAB_COLUMNS_MAX];
    size_t row_count, row_room;
    int is_out_of_memory;
};

struct lab_case {
    const char *name;   /* the word for the command line */
    const char *title;  /* of its section */
    const char *method; /* what is done, in a paragraph */
    const char *advice; /* what a user should do, in a paragraph */
    void (*run)(struct lab *lab);
    int is_named_only; /* it runs only where it is named: the library is known to break its limits */
};

/* All cases, in the order in which they are told; the last one is NULL. */
extern const struct lab_case *const lab_cases[];

/* Note a figure with an upper limit, with a lower limit, or without one. */
void lab_at_most(struct lab *lab, const char *method, const char *what, double value, const char *unit, double limit);
void lab_at_least(struct lab *lab, const char *method, const char *what, double value, const char *unit, double limit);
void lab_note(struct lab *lab, const char *method, const char *what, double value, const char *unit);

void lab_point_at(struct lab *lab, const char *chart, const char *series, double x, double y);

/* A row of the table whose columns are lab->columns. */
void lab_add_row(struct lab *lab, const struct lab_cell *cells);

/* 1 if the figure meets its limit; a NaN meets none. */
int lab_figure_holds(const struct lab_figure *figure);

/* The share of `whole` that is due at this effort; at least 1. */
uint64_t lab_share(const struct lab *lab, uint64_t whole);

/* Run a case. The figures and points are the lab's until lab_free. */
void lab_run(struct lab *lab, const struct lab_case *which, double effort);
void lab_free(struct lab *lab);

/* The cases of the laboratory, in the order in which they are told. Each is defined in the file of its subject. */

/* Geometry: a tool is led. */
#define LAB_GEOMETRY_CASES                                                                                             \
    CASE(spikes)                                                                                                       \
    CASE(microconcave)                                                                                                 \
    CASE(thinsheet)                                                                                                    \
    CASE(parallel)                                                                                                     \
    CASE(rocking)                                                                                                      \
    CASE(slot)                                                                                                         \
    CASE(bodies)                                                                                                       \
    CASE(segments)                                                                                                     \
    CASE(medial)                                                                                                       \
    CASE(border)                                                                                                       \
    CASE(sidelimit)                                                                                                    \
    CASE(folds)                                                                                                        \
    CASE(slivers)                                                                                                      \
    CASE(coincident)                                                                                                   \
    CASE(scale)                                                                                                        \
    CASE(hour)                                                                                                         \
    CASE(work)                                                                                                         \
    CASE(tilt)                                                                                                         \
    CASE(budget)

/* Loops: a simulated hand holds a device. */
#define LAB_LOOP_CASES                                                                                                 \
    CASE(wall)                                                                                                         \
    CASE(organs)                                                                                                       \
    CASE(delay)                                                                                                        \
    CASE(rate)                                                                                                         \
    CASE(phase)                                                                                                        \
    CASE(zoom)                                                                                                         \
    CASE(energy)                                                                                                       \
    CASE(late)                                                                                                         \
    CASE(rest)                                                                                                         \
    CASE(beat)

/* Tissue: vertices move. */
#define LAB_TISSUE_CASES                                                                                               \
    CASE(tissue)                                                                                                       \
    CASE(soft)                                                                                                         \
    CASE(pulse)                                                                                                        \
    CASE(reaction)                                                                                                     \
    CASE(displace)                                                                                                     \
    CASE(springs)                                                                                                      \
    CASE(hum)

#define LAB_CASES                                                                                                      \
    LAB_GEOMETRY_CASES                                                                                                 \
    LAB_LOOP_CASES                                                                                                     \
    LAB_TISSUE_CASES

#define CASE(name) extern const struct lab_case name##_case;
LAB_CASES
#undef CASE

/* The meshes of the laboratory's cases, made and compiled in memory. m. */

struct lab_mesh {
    dpt_compiled compiled;
    const dpt_mesh *mesh;
    double diagonal; /* of its box, m */
};

/* Where memory runs out, these set lab->is_out_of_memory, and return 0; the mesh is empty then. */

/* A shape of `dynpoint make` with `count` triangles; 0: its usual number. */
int lab_mesh_shape(struct lab *lab, struct lab_mesh *mesh, const char *name, uint64_t count);

int lab_mesh_arrays(struct lab *lab, struct lab_mesh *mesh, const double *vertices, size_t vertex_count,
                    const uint32_t *corners, size_t triangle_count);

/* A sheet of rows by columns cells. Where u grows with y and v with x, +z sees its front. */
struct lab_net {
    uint32_t rows, columns;
    void (*place)(const void *context, double u, double v, double x[3]); /* of the vertex at u, v in 0..1 */
    const void *context;
};
int lab_mesh_net(struct lab *lab, struct lab_mesh *mesh, const struct lab_net *net);

/*
 * A closed prism: a polygon of `count` corners x, z, counterclockwise seen along +y from below, from y = -half to
 * y = half. All of the polygon must be seen from the mean of its corners.
 */
enum { LAB_CORNERS_MAX = 16 };
int lab_mesh_prism(struct lab *lab, struct lab_mesh *mesh, const double (*corners)[2], uint32_t count, double half);

/* A closed box: x from low to high, z from `bottom` to `top`, y from -half to half. */
int lab_mesh_slab(struct lab *lab, struct lab_mesh *mesh, double low, double high, double bottom, double top,
                  double half);

void lab_mesh_close(struct lab_mesh *mesh);

#endif
