/* SPDX-License-Identifier: BSD-3-Clause */
/* A trace whose numbers are probably no metres. */
#ifndef DPT_TOOLS_TRACE_UNIT_H
#define DPT_TOOLS_TRACE_UNIT_H

#include "csv.h"
#include "dynpoint.h"

/* A ball round a body, m, where the body stands. */
struct trace_ball {
    double centre[3], radius;
};

/* The ball round the box of a mesh; `pose` NULL: the mesh's own frame. */
struct trace_ball trace_ball_of(const dpt_mesh *mesh, const dpt_pose *pose);

/*
 * Note on standard error that a trace is probably in millimetres: hardly any of its rows come within ten radii of a body,
 * nearly all would if its numbers were a thousandth, and then it would move by a twentieth of a radius at least.
 */
void trace_note_unit(const char *path, const struct csv_table *trace, const struct trace_ball *balls, size_t count);

#endif
