/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/tissue_patch.h"

#include "world/tissue_triangle.h"

/* The vertices that are nearer than the radius and can be reached over such, each with its share of the load. */
static uint32_t find_patch(const struct tissue_body *body, const uint32_t *corners, struct patch_vertex *patch,
                           uint32_t vertices)
{
    const double r2 = body->load_radius * body->load_radius;
    uint32_t triangles, count = 0, last;
    const uint32_t *all = tissue_corners(body, &triangles);
    for (int k = 0; k < 3; k++)
        count += (uint32_t)(patch[corners[k]].is_in = dot3(patch[corners[k]].at, patch[corners[k]].at) < r2);
    do {
        last = count;
        for (uint32_t i = 0; i < 3 * triangles; i++)
            for (uint32_t k = 0; k < 3 && patch[all[i]].is_in; k++) {
                struct patch_vertex *other = &patch[all[i - i % 3 + k]];
                if (!other->is_in && dot3(other->at, other->at) < r2) {
                    other->is_in = 1;
                    count++;
                }
            }
    } while (count > last);
    for (uint32_t i = 0; i < triangles; i++) {
        double area[3];
        area_of(patch[all[3 * i]].at, patch[all[3 * i + 1]].at, patch[all[3 * i + 2]].at, area);
        for (int k = 0; k < 3; k++)
            patch[all[3 * i + (uint32_t)k]].weight += length3(area);
    }
    for (uint32_t i = 0; i < vertices; i++) {
        const double share = 1.0 - dot3(patch[i].at, patch[i].at) / r2;
        patch[i].weight *= patch[i].is_in ? share * share : 0.0;
    }
    return count;
}

/*
 * Weights times 1 + c x, where x is across the normal: the three numbers of which their sum is 1, and the sums of weight times
 * x are 0, by Cramer's rule. Returns 0 where there are none.
 */
static int keep_moment(struct patch_vertex *patch, uint32_t vertices)
{
    double m[6] = { 0.0 };
    for (uint32_t i = 0; i < vertices; i++) {
        const double w = patch[i].weight, x = patch[i].across[0], y = patch[i].across[1];
        const double of[6] = { w, w * x, w * y, w * x * x, w * x * y, w * y * y };
        for (int k = 0; k < 6; k++)
            m[k] += of[k];
    }
    const double c[3] = { m[3] * m[5] - m[4] * m[4], m[2] * m[4] - m[1] * m[5], m[1] * m[4] - m[2] * m[3] };
    const double determinant = m[0] * c[0] + m[1] * c[1] + m[2] * c[2];
    if (!(m[0] > 0.0) || !(fabs(determinant) > 1e-12 * m[0] * (m[3] + m[5]) * (m[3] + m[5])))
        return 0;
    for (uint32_t i = 0; i < vertices; i++)
        patch[i].weight *= (c[0] + c[1] * patch[i].across[0] + c[2] * patch[i].across[1]) / determinant;
    return 1;
}

const struct patch_vertex *patch_at(const struct tissue_rig *tissue, const struct tissue_body *body, const double q[3],
                                    const double n[3], const uint32_t *corners)
{
    static struct patch_vertex patch[PATCH_VERTICES];
    uint32_t vertices = 0;
    const float *position = tissue_vertices(tissue, body, &vertices);
    const double least = fmin(fabs(n[0]), fmin(fabs(n[1]), fabs(n[2])));
    double axis[3], x[3], y[3];
    CHECK(vertices <= PATCH_VERTICES, "%u vertices", vertices);
    if (vertices > PATCH_VERTICES)
        return NULL;
    for (int k = 0; k < 3; k++)
        axis[k] = fabs(n[k]) <= least;
    cross3(n, axis, x);
    cross3(n, x, y);
    memset(patch, 0, vertices * sizeof *patch);
    for (uint32_t i = 0; i < vertices; i++) {
        for (int k = 0; k < 3; k++)
            patch[i].at[k] = (double)position[3 * i + (uint32_t)k] + body->place[k] - q[k];
        patch[i].across[0] = dot3(patch[i].at, x);
        patch[i].across[1] = dot3(patch[i].at, y);
    }
    return find_patch(body, corners, patch, vertices) < 3 || !keep_moment(patch, vertices) ? NULL : patch;
}
