/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The paper's response: triangles under a tool that it penetrates are moved out of it. docs/algorithms/deform.md.
 */
#ifndef DPT_DISPLACE_H
#define DPT_DISPLACE_H

#include "deform/deform_vertices.h"
#include "strip/strip_state.h"

/* A tool's axis a + s u, in the body's frame, and on which side of the surface it is: +1 in front, -1 behind. */
struct displacing_tool {
    vec3 a, u;
    double radius;
    int32_t side;
    int is_behind; /* 1: the axis goes through the surface, or is wholly behind it */
};

/*
 * Move the triangles of a strip out of a tool, `passes` times in the strip's order; between dpti_deform_begin and
 * dpti_deform_end. In each pass a triangle's nearest point is moved out of the tool, and the corners with it as they
 * are weighted there.
 */
void dpti_displace(struct surface *surface, const struct dpt_strip *strip, const struct displacing_tool *tool,
                   uint32_t passes);

#endif
