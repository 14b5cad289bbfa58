/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The tool that a trace moves: the row's segment, set free in each tick; or, with tips, a tool with a pose that is made
 * of the row's segment.
 */
#ifndef DPT_TOOLS_REPLAY_TOOL_H
#define DPT_TOOLS_REPLAY_TOOL_H

#include "csv.h"
#include "dynpoint/tip.h"
#include "scene/curved_tip.h"

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

/* Into a world that has none: the segment, and after the tool has its law, the tips, which feel this one body. */
dpt_result replay_tool_add(const struct replay_tool *tool, const struct csv_table *trace, dpt_world *world,
                           dpt_tool *added);
dpt_result replay_tool_add_tips(struct replay_tool *tool, dpt_world *world, dpt_tool added, const dpt_mesh *mesh,
                                const struct force_options *force);

/* m: how much larger, or deeper, than they are the curved tips are felt, at most; 0: there are none. */
double replay_tool_error(const struct replay_tool *tool);

/* Place it for a row; rows in their order. A jump is a teleport. */
void replay_tool_place(struct replay_tool *tool, const struct csv_table *trace, size_t row, dpt_world *world,
                       dpt_tool added);

#endif
