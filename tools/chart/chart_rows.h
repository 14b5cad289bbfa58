/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The rows of a chart: every method, law and setting that a scene can be felt with, and what came of each. A row is judged
 * by a run of the same law with every knob at its richest; one that gives no force, by one without a force.
 */
#ifndef DPT_TOOLS_CHART_ROWS_H
#define DPT_TOOLS_CHART_ROWS_H

#include "measure/judgement.h"
#include "scene/scene.h"

enum { CHART_ROWS_MAX = 96, CHART_NAME = 48 };

/* What a row computes. Rows of the same part are compared. */
enum chart_part {
    CHART_PAIR,    /* the nearest pair alone */
    CHART_CONTACT, /* contact, without a force */
    CHART_FORCE    /* all */
};

/* Times of a judgement: of the step, where the axis crosses and where it does not, and with physics behind it. */
enum chart_time { CHART_STEP, CHART_CROSSING, CHART_OTHER, CHART_WHOLE, CHART_TIMES };

struct chart_row {
    char name[CHART_NAME]; /* distinguishes it within its part, without commas: "exact at 8 units" */
    enum chart_part part;
    struct measure_setting setting;
    int is_peer;     /* another library: the setting does not apply */
    double build_ns; /* of a peer: to read the mesh */
    /* After chart_rows_measure. A failure is of this run or of the one that judges it: there is no judgement. */
    dpt_result failure;
    struct judgement judged;
    size_t world_bytes, body_bytes;
    /* After chart_repeats_join: of each of these times, ns, the least and the largest of the repeats. */
    struct judgement_spread min[CHART_TIMES], max[CHART_TIMES];
};

/* The first reference run, checked by brute force. It is the one without a force, if there is one. */
struct chart_truth {
    struct measure_check check;
    uint32_t kernel;
    double diagonal;
    size_t mesh_bytes;
    size_t crossings; /* ticks in which the axis crosses */
    double *distance; /* of each of the ticks, m */
    size_t ticks;
};

struct chart_rows {
    struct chart_row row[CHART_ROWS_MAX];
    int count;
    struct chart_truth truth;
};

/*
 * List what this scene can be felt with, of the parts up to `last`. `base` gives stiffness, friction, damping, margin and dt.
 * There may be none, as tips are felt by a proxy alone.
 */
void chart_rows_list(struct chart_rows *rows, const struct scene *scene, const struct measure_setting *base,
                     enum chart_part last);

/*
 * Run and judge all rows, and the runs that they are judged by. Of the effort `passes` and what shows progress count. Returns
 * 0, or 2 after a message.
 */
int chart_rows_measure(struct chart_rows *rows, const struct scene *scene, const struct csv_table *trace,
                       const struct measure_effort *effort);

/* Free what chart_rows_measure allocated. */
void chart_rows_free(struct chart_rows *rows);

/* What the bodies of a scene cost before and beside the ticks: to compile, to add to a world, and to refit. */

/* Times are in s: the minimum of three, or the median of refits. Sizes are in bytes. */
struct chart_body {
    uint32_t triangles;
    uint64_t mesh_bytes;
    double compile; /* from its triangles in memory, one thread */
    double add;     /* as a rigid body, to a world */
    /* As a body whose vertices move: its own memory, and all vertices moved, with the step behind it. */
    size_t deform_bytes;
    double refit;
};

/* Returns 0, or 2 after a message. */
int chart_body_measure(struct chart_body *measured, const struct scene *scene, uint32_t body);

#endif
