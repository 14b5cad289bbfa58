/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Tips of tools: convex bodies at the end of a tool's segments, such as a blade, a needle's bevel or a jaw
 * (docs/algorithms/tips.md). A tip is a hull at a pose in the tool's frame. It moves with the tool, and the tips of the
 * proxy do not go through a surface either. The pose of a tip may change from step to step.
 *
 * Tips are numbered after the tool's segments: in hits and contacts `segment` of the first tip is the number of the
 * tool's segments. dpt_tool_get_segment_hit takes that number too.
 *
 * Threads: as all calls on a world (world.h).
 */
#ifndef DYNPOINT_TIP_H
#define DYNPOINT_TIP_H

#include "dynpoint/hull.h"
#include "dynpoint/tool.h"

DPT_BEGIN

/* One tip. The world keeps the pointer: the hull must stay where it is while the tool has the tip. */
typedef struct dpt_tip {
    uint32_t size;     /* sizeof(dpt_tip), set by the caller; in an array, set that of the first item */
    uint32_t reserved; /* 0 */
    const dpt_hull *hull;
    /* Where the hull's frame is in the tool's; read by the call. NULL: the same frame. */
    const dpt_pose *pose;
} dpt_tip;

/*
 * Give a tool its tips, in place of those that it has; count 0: none. Then the tool is as if it had just been placed
 * where it is, as after dpt_tool_teleport.
 *
 * A tool needs at least one segment beside its tips. Where the tip is all there is, give it a segment of no length inside
 * the tip. A tip counts as a segment along its hull's axis for the tool's centre and for what its turns weigh
 * (docs/algorithms/force.md), and the tool turns in all directions then.
 *
 *   hits      of a tip: distance is that of the hull's polyhedron, gap that of its surface; p is on the polyhedron, and s
 *             is 0. Where tip and body meet, distance is 0, and how deep is not known
 *   contacts  a tip has at most one, its nearest pair, while that is within the world's margin. s0, s1 and the integrals
 *             are 0
 *
 * A search for a tip's nearest pair that the budget ends begins anew in the next step. A strip is not made of a tip.
 *
 * DPT_E_FINITE, DPT_E_POSE: a tip's pose is none. DPT_E_FULL: the world's max_tips. DPT_E_UNSUPPORTED: the tool has no
 * proxy (DPT_LAW_PROXY) in a world that responds, or is free. While a tool has tips, its law stays, and it cannot be made
 * free.
 */
DPT_API dpt_result dpt_tool_set_tips(dpt_world *world, dpt_tool tool, const dpt_tip *tips, uint32_t count);

/*
 * Say where a tip is to be in its tool's frame from the next step on, as a jaw that opens or closes. It moves there: its
 * position on a straight line, its orientation on the shorter arc. For a jaw on a hinge let the hull's frame have its
 * origin on the hinge.
 *   tip   counts from 0 in the tool's tips
 *   pose  of the hull's frame, in the tool's. On an error the tip keeps the last one
 *
 * A tip goes through nothing on its way either. In each step first the tool's proxy follows its device, with all tips as
 * they stand in its frame; then each tip moves on, while the tool stands, and stops before what it would meet. It goes on
 * when the way is free. Where nothing is in the way it arrives in the same step, bit for bit. So:
 *
 *   - A tip never pushes: jaws that close on tissue stop, and neither the tool nor the tissue moves. What is felt is the
 *     tool's proxy, which holds its tips as they stand.
 *   - Where a tip is taken from under a tool that rests on it, the tool sinks in the next step.
 *   - A tool that has not been outside yet (DPT_FORCE_INSIDE), that was placed anew, or that has no proxy has its tips
 *     where they are wanted, through everything.
 *   - Tips of one tool do not hold each other.
 *   - The budget ends the way of a tip too; it goes on in the next step.
 *
 * For the tool's centre and for what its turns weigh, a tip counts where dpt_tool_set_tips put it.
 */
DPT_API dpt_result dpt_tool_set_tip_pose(dpt_world *world, dpt_tool tool, uint32_t tip, const dpt_pose *pose);

/* Where a tip stood in its tool's frame at the end of the last step; hits, contacts and snapshots are of that place. */
DPT_API dpt_result dpt_tool_get_tip_pose(const dpt_world *world, dpt_tool tool, uint32_t tip, dpt_pose *pose);

DPT_END

#endif
