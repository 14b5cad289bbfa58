/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which triangles meet the shadow of a segment, and which of them hang together with the first one, by looking at every
 * triangle and edge in long double.
 *
 * A shadow is convex: the sum of the axis and of the segments -reach..reach along e and w and -depth..depth along d.
 * Its faces are orthogonal to d, w, e or, in the plane of e and d, to the axis; so it is what four slabs have in
 * common, each as wide as the sum is along its normal. A triangle or an edge is cut by them, and what is left of it
 * is a witness.
 *
 * A verdict is "surely" where it stays so when the shadow is moved by `eps` along e, w or d, and "maybe" where some
 * point is within eps of all slabs. Where e may be any unit vector across d, surely and maybe are for all of them and
 * for some.
 */
#ifndef DPT_TESTS_ORACLE_SHADOW_H
#define DPT_TESTS_ORACLE_SHADOW_H

#include "oracle/surface.h"

struct oracle_shadow {
    long double a[3], u[3]; /* A, B - A */
    long double e[3], w[3], d[3];
    long double across[3];               /* in the plane of e and d, orthogonal to u; e where there is no u */
    long double sure_reach, maybe_reach; /* radius + width; less and more where e may be any */
    long double depth;
    long double eps;
    int any; /* e may be any */
};

/* `extent` is the largest coordinate about; eps 1e-9 of `scene`, more where e is hard to tell. */
void oracle_shadow_make(struct oracle_shadow *shadow, const double ends[6], double reach, const double direction[3],
                        double depth, double scene, double extent);

/* How far x is from being a point A + t u + x e + y w + z d, by the least excess over all t; <= 0 is within. */
long double oracle_shadow_excess(const struct oracle_shadow *shadow, const long double x[3]);

enum { ORACLE_OUT, ORACLE_MAYBE, ORACLE_SURE };

/* Of a polygon of 1 to 3 corners; `witness`, which may be NULL, gets a point of it that surely or maybe is within. */
int oracle_shadow_meets(const struct oracle_shadow *shadow, const long double (*corners)[3], int count,
                        long double witness[3]);

/* Triangles as they lie in the world, and what is found of them; arrays of the caller's. */
struct oracle_sheet {
    const struct oracle_surface *surface;
    const long double (*place)[3];    /* of a vertex, in the world */
    unsigned char *in;                /* of a triangle: ORACLE_... it is of the sheet */
    uint32_t *queue;                  /* room for twice all triangles */
    uint32_t sure, maybe;             /* how many; those that are sure are maybe */
    uint32_t sure_flags, maybe_flags; /* 1: ends at an open edge, 2: goes over an edge of three or more */
};

/* The sheet of the first triangle, over edges. */
void oracle_sheet_find(struct oracle_sheet *sheet, const struct oracle_shadow *shadow, uint32_t first);

/* The sheet over common vertices, of all triangles that surely meet the shadow; flags 0, maybe as sure. */
void oracle_sheet_loose(struct oracle_sheet *sheet, const struct oracle_shadow *shadow, uint32_t first);

#endif
