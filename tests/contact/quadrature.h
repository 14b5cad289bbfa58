/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The integrals of a contact by a quadrature of 4,096 points, whose signed distances are those of zero-length queries
 * (test_depth has them).
 */
#ifndef DPT_TESTS_QUADRATURE_H
#define DPT_TESTS_QUADRATURE_H

#include "lib/solid.h"

/* What a step tells of a tool of one segment, as the quadrature does. */
struct integrals {
    double overlap, moment, thrust[3], thrust_moment[3], square;
};

/* So much overlap at s, with this way out. */
void add_overlap(struct integrals *sum, double overlap, double s, const double way[3]);

/* They as vectors, so that one loop serves all. */
enum { INTEGRALS = 5 };
static const char *const integral_names[INTEGRALS] = { "overlap", "moment", "thrust", "thrust_moment", "square" };

static inline void integral_of(const struct integrals *i, int which, double v[3])
{
    const double scalar[3] = { which == 0 ? i->overlap : which == 1 ? i->moment : i->square, 0, 0 };
    memcpy(v, which == 2 ? i->thrust : which == 3 ? i->thrust_moment : scalar, 3 * sizeof *v);
}

static inline double integral_apart(const struct integrals *a, const struct integrals *b, int which)
{
    double va[3], vb[3];
    integral_of(a, which, va);
    integral_of(b, which, vb);
    return apart(va, vb);
}

enum { COARSE = 512, FINE = 4096 };

/* Points of the axis in order, each for a piece of it, with the signed distance and the way out. */
struct quadrature {
    size_t count;
    double s[FINE + COARSE], height[FINE + COARSE], width[FINE + COARSE]; /* width in s */
    double way[FINE + COARSE][3];
    struct integrals sum, half; /* of all, and of every second */
};

/* Pieces that are beyond reach as a whole, as the distance is 1-Lipschitz, get no points. */
void take_quadrature(struct quadrature *q, const dpt_mesh *mesh, const dpt_pose *pose, const double ends[6],
                     double reach);

#endif
