/* SPDX-License-Identifier: BSD-3-Clause */
/* How often the solid parts of a mesh go round a point (docs/algorithms/winding.md). */
#ifndef DPT_WINDING_NUMBER_H
#define DPT_WINDING_NUMBER_H

#include "nearest/bvh.h"

#define WINDING_ERROR 0.01

/*
 * The generalised winding number of the parts that are MESH_PART_SOLID, as they are wound in the file: inside of
 * the material it is above 1/2, where a closed part is alone 1, outside 0, near a hole between.
 *
 *   x      in the mesh's frame, m
 *   work   16-lane blocks; HUGE_VAL where those that are left do not suffice
 *
 * Wrong by at most WINDING_ERROR. 0 for a mesh without moments, which is one without a part that is
 * MESH_PART_WINDING, and for an x that is not finite. Time grows with the logarithm of the triangles.
 */
double dpti_winding_number(const struct surface *surface, const struct kernel *kernel, vec3 x,
                           struct work *work);

#endif
