/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How a trace leads the tool of a scene. A stylus is the trace's segment, with the scene's radius. Any other tool goes as a
 * whole: its origin to end a, and its z axis towards end b, turned from tick to tick by the least turn.
 */
#ifndef DPT_TOOLS_MEASURE_TOOL_H
#define DPT_TOOLS_MEASURE_TOOL_H

#include "csv.h"
#include "scene/scene.h"

struct measure_tool {
    const struct scene *scene;
    int is_jump;                                /* at this row the motion jumps */
    dpt_pose pose;                              /* of a tool that goes as a whole */
    dpt_segment segments[DPT_ARM_SEGMENTS_MAX]; /* in the scene's frame, without tips */
    /* The norm of wrenches (docs/algorithms/force.md): the tool's centre, m, scene's frame, and how much a turn counts. */
    double centre[3];
    double rho;
    double own_centre[3]; /* in the tool's own frame */
    double axis[3];       /* unit: where z points; zeros before the first row */
};

void measure_tool_begin(struct measure_tool *tool, const struct scene *scene);

/* To the row, counted from 0. */
void measure_tool_lead(struct measure_tool *tool, const struct csv_table *trace, size_t row);

/* In a world, to where it was led. */
dpt_result measure_tool_move(const struct measure_tool *tool, dpt_world *world, dpt_tool id);

/* What the wrench of this tool weighs, in N: force, and torque about the centre over rho; zeros for a rho of 0. */
void measure_tool_weigh(const struct measure_tool *tool, const dpt_wrench *wrench, double weighed[6]);

#endif
