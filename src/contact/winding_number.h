/* SPDX-License-Identifier: BSD-3-Clause */
/* How often the solid parts of a mesh wind round a point (docs/algorithms/winding.md). */
#ifndef DPT_WINDING_NUMBER_H
#define DPT_WINDING_NUMBER_H

#include "nearest/bvh.h"

/* The answer is off by at most this. */
#define WINDING_ERROR 0.01

/*
 * The generalised winding number of the parts that are MESH_PART_SOLID, as they are wound in the file. Above 1/2 the
 * point is inside of the material. Of a single closed part it is 1 inside and 0 outside; near a hole it lies between.
 *
 *   x      in the mesh's frame, m
 *   work   is spent in blocks of 16 lanes; if what is left does not suffice, the answer is HUGE_VAL
 *
 * It is 0 for a mesh without moments, which is one without a part that is MESH_PART_WINDING, and for an x that is not
 * finite. Time grows with the logarithm of the number of triangles.
 */
double dpti_winding_number(const struct surface *surface, const struct kernel *kernel, vec3 x, struct work *work);

#endif
