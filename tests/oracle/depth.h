/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How deep a segment's axis is in a closed mesh, closed in from both sides by brute.h and solid angles.
 *
 * Between two points of the axis the distance to one triangle is convex, so its chord is above it, and the distance to
 * the mesh is below the chords of both ends' nearest triangles: where they meet bounds the depth between. Pieces are
 * halved there until the bound and the deepest point that was seen are `tolerance` apart, so that nothing deeper can be
 * passed over and nothing needs to be sampled densely.
 *
 * Good within 1e-12 of the largest coordinate, as brute.h. It cannot judge meshes that are open, or that go round a
 * point the wrong way where they cut themselves, nor on which side a point within 1e-10 of the largest coordinate of
 * the surface is.
 */
#ifndef DPT_TESTS_ORACLE_DEPTH_H
#define DPT_TESTS_ORACLE_DEPTH_H

#include "oracle/brute.h"

/* The mesh for brute.h, and 9 floats a triangle, as many as it has; neither is kept. */
struct oracle_solid {
    const oracle_mesh *mesh;
    const float *corners;
    uint32_t triangles;
    double extent; /* the largest |coordinate| */
};

/* How often the mesh goes round x: the sum of solid angles (Van Oosterom, Strackee 1983). */
double oracle_winding(const struct oracle_solid *solid, const double x[3]);

/* Distance, negative inside. */
double oracle_signed(const struct oracle_solid *solid, const double x[3]);

/* low <= the least signed distance along the axis <= high, which it has at s. */
struct oracle_least {
    double low, high, s;
    uint32_t points; /* that were looked at */
    int inside;      /* part of it is */
    int crosses;     /* the axis is within 1e-13 of the largest coordinate of the mesh */
};
struct oracle_least oracle_least(const struct oracle_solid *solid, const double segment[6], double tolerance);

#endif
