/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * From a nearest pair to contact: on which side the tool is, its gap, and where a force would push it.
 * docs/algorithms/sign.md.
 */
#ifndef DPT_CONTACT_H
#define DPT_CONTACT_H

#include "track.h"

struct push {
    vec3 direction; /* unit, in the body's frame, out of the mesh; zero where it is not known */
    double depth;   /* how far, >= 0 */
};

/* Fill contact, gap and depth of a hit that track_hit has written. The exact methods' contact. */
struct push contact_of(const struct tree *tree, const struct axis *axis,
                       const struct nearest *nearest, double radius, dpt_hit *hit);

/*
 * The paper's signed gap of one part of a segment and its push (docs/algorithms/paper.md): the sign is
 * that of the triangle's own plane; a part that crosses is as deep as its lower end is under it.
 */
double contact_paper(const struct tree *tree, const struct axis *part,
                     const struct nearest *nearest, double radius, struct push *push);

/* Fill contact, flags, gap and depth for a gap that is known. */
void contact_set_gap(dpt_hit *hit, double gap, double error);

#endif
