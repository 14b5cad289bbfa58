/* SPDX-License-Identifier: BSD-3-Clause */
/* Small meshes of hard places: prisms of any outline, and a plate with a hole. */
#ifndef DPT_TESTS_PLACE_MESHES_H
#define DPT_TESTS_PLACE_MESHES_H

#include "lib/solid.h"

enum { OUTLINE_MAX = 16 };

static inline double turn_of(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Is left[at] an ear: convex, and no other corner within? */
static inline int is_ear(const double (*outline)[2], const uint32_t *left, uint32_t count, uint32_t at)
{
    const double *a = outline[left[(at + count - 1) % count]], *b = outline[left[at]];
    const double *c = outline[left[(at + 1) % count]];
    if (!(turn_of(a, b, c) > 0))
        return 0;
    for (uint32_t i = 0; i < count; i++) {
        const double *x = outline[left[i]];
        if (x != a && x != b && x != c && turn_of(a, b, x) >= 0 && turn_of(b, c, x) >= 0 && turn_of(c, a, x) >= 0)
            return 0;
    }
    return 1;
}

/* A closed prism: an outline in x and z, counter-clockwise with y away, from y = -half to half. */
static inline int solid_from_outline(struct solid *solid, const char *name, const double (*outline)[2], uint32_t count,
                                     double half)
{
    double vertices[2 * OUTLINE_MAX][3];
    uint32_t corners[4 * OUTLINE_MAX][3], triangles = 0, left[OUTLINE_MAX], remaining = count;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t j = (i + 1) % count;
        const double near[3] = { outline[i][0], -half, outline[i][1] };
        const double far[3] = { outline[i][0], half, outline[i][1] };
        const uint32_t sides[2][3] = { { i, j, count + j }, { i, count + j, count + i } };
        memcpy(vertices[i], near, sizeof near);
        memcpy(vertices[count + i], far, sizeof far);
        memcpy(corners[triangles], sides, sizeof sides);
        triangles += 2;
        left[i] = i;
    }
    while (remaining > 2) {
        uint32_t at = 0;
        while (at < remaining && !is_ear(outline, left, remaining, at))
            at++;
        CHECK(at < remaining, "%s: no ear", name);
        if (at == remaining)
            return 0;
        const uint32_t a = left[(at + remaining - 1) % remaining], b = left[at];
        const uint32_t c = left[(at + 1) % remaining];
        const uint32_t caps[2][3] = { { a, c, b }, { count + a, count + b, count + c } };
        memcpy(corners[triangles], caps, sizeof caps);
        triangles += 2;
        memmove(left + at, left + at + 1, (remaining - at - 1) * sizeof *left);
        remaining--;
    }
    return solid_from_arrays(solid, name, vertices[0], 2 * count, corners[0], triangles);
}

/* A round plate with a hole about the z axis, of facets whose middles are at `hole`, from z = -thick to 0. */
static inline int solid_with_hole(struct solid *solid, const char *name, double hole, double outer, double thick)
{
    enum { SIDES = 24 };
    double vertices[4 * SIDES][3];
    uint32_t corners[8 * SIDES][3], triangles = 0;
    const double pi = 3.14159265358979323846, corner = 1 / cos(pi / SIDES);
    for (uint32_t i = 0; i < SIDES; i++) {
        const uint32_t j = (i + 1) % SIDES;
        const double angle = 2 * pi * i / SIDES, c = corner * cos(angle), s = corner * sin(angle);
        const double ring[4][3] = { { hole * c, hole * s, 0 },
                                    { outer * c, outer * s, 0 },
                                    { outer * c, outer * s, -thick },
                                    { hole * c, hole * s, -thick } };
        for (uint32_t k = 0; k < 4; k++) {
            const uint32_t a = 4 * i + k, b = 4 * i + (k + 1) % 4;
            const uint32_t d = 4 * j + k, e = 4 * j + (k + 1) % 4;
            const uint32_t cell[2][3] = { { a, b, e }, { a, e, d } };
            memcpy(vertices[a], ring[k], sizeof ring[k]);
            memcpy(corners[triangles], cell, sizeof cell);
            triangles += 2;
        }
    }
    return solid_from_arrays(solid, name, vertices[0], 4 * SIDES, corners[0], triangles);
}

#endif
