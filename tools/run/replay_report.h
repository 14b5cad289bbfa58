/* SPDX-License-Identifier: BSD-3-Clause */
/* Report a replayed trace: the answer of each tick, and how long it took. */
#ifndef DPT_TOOLS_REPLAY_REPORT_H
#define DPT_TOOLS_REPLAY_REPORT_H

#include <stdio.h>

#include "csv.h"
#include "dynpoint.h"
#include "dynpoint/tip.h"
#include "scene/tip_shape.h"

struct replayed_tick {
    dpt_hit hit;
    dpt_wrench wrench;
    double energy;            /* J */
    uint32_t reason;          /* DPT_FORCE_... */
    uint32_t force_flags;     /* DPT_FORCE_FLAG_... */
    dpt_pose proxy;           /* with DPT_LAW_PROXY */
    double ns;                /* shortest time of all passes */
    uint32_t strip_triangles; /* triangles in the strip */
    uint32_t strip_flags;
};

/* Comparison with another method on some of the ticks. */
struct comparison {
    const char *method; /* NULL: no comparison */
    uint64_t ticks;
    uint64_t wrong_count;      /* distances that differ by more than the tolerance */
    uint64_t missed_crossings; /* of them: the axis crosses the mesh, and the replayed method did not find it */
    double error_max;          /* m */
    double tolerance;          /* m */
    double median_ns;          /* median time of a tick */
};

struct replayed {
    const struct csv_table *trace;
    struct replayed_tick *ticks;
    uint32_t until;
    uint32_t law;        /* DPT_LAW_... */
    uint32_t strip_kind; /* DPT_STRIP_KIND_... */
    size_t world_bytes;
    uint64_t mesh_bytes;
    double diagonal;
    double tip_error;                 /* m, of curved tips; 0: there are none */
    const struct curved_tips *curved; /* those that were felt without a proxy */
    uint32_t kernel;
    const char *method;
    struct comparison against;
};

/* Write the ticks as CSV, and the summary as a JSON object or as a table for people. */
void replay_write_csv(FILE *file, const struct replayed *replayed);
void replay_print_json(FILE *file, const struct replayed *replayed);
void replay_print_table(FILE *file, const struct replayed *replayed);

/* Sort numbers, and the nearest-rank percentile of sorted ones; `fraction` is 0..1. 0 if there are none. */
void sort_numbers(double *values, size_t count);
double percentile(const double *sorted, size_t count, double fraction);

/*
 * The tool that a trace moves: the row's segment, set free in each tick; or, with tips, a tool with a pose that is made
 * of the row's segment.
 */

struct replay_tool {
    double radius; /* m, of the segment */
    struct tip_shapes tips;
    void *blocks[TIP_SHAPES_MAX];
    const dpt_hull *hulls[TIP_SHAPES_MAX];
    struct curved_tips curved; /* of the tips, those that are felt without a proxy */
    double length;             /* m, of the first row's segment */
    /* With tips: where the tool is. Its origin is the segment's end a, and its z axis leads to end b. */
    dpt_pose pose;
};

/* Make the hulls, and check that the trace moves a rigid tool. `tool` has its radius and tips. 0, or 2 after a message. */
int replay_tool_open(struct replay_tool *tool, const char *path, const struct csv_table *trace);
void replay_tool_close(struct replay_tool *tool);

/* Its segment, as it is added to a world. */
dpt_segment replay_tool_segment(const struct replay_tool *tool, const struct csv_table *trace);

/* After the tool has its law: the tips, which feel this one body. */
dpt_result replay_tool_add_tips(struct replay_tool *tool, dpt_world *world, dpt_tool added, const dpt_mesh *mesh,
                                const struct force_options *force);

/* m: how much larger, or deeper, than they are the curved tips are felt, at most; 0: there are none. */
double replay_tool_error(const struct replay_tool *tool);

/* Place it for a row; rows in their order. A jump is a teleport. */
dpt_result replay_tool_place(struct replay_tool *tool, const struct csv_table *trace, size_t row, dpt_world *world,
                             dpt_tool added);

#endif
