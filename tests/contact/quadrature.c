/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/quadrature.h"

void add_overlap(struct integrals *sum, double overlap, double s, const double way[3])
{
    sum->overlap += overlap;
    sum->moment += s * overlap;
    for (int k = 0; k < 3; k++) {
        sum->thrust[k] += overlap * way[k];
        sum->thrust_moment[k] += s * overlap * way[k];
    }
}

static void heights_at(const dpt_mesh *mesh, const dpt_pose *pose, const double ends[6], const double *s, size_t count,
                       dpt_hit *hits)
{
    static double points[FINE + COARSE][6];
    for (size_t i = 0; i < count; i++) {
        point_at(ends, s[i], points[i]);
        memcpy(points[i] + 3, points[i], 3 * sizeof *points[i]);
    }
    hits[0].size = sizeof *hits;
    const dpt_result result = dpt_query_segments(mesh, pose, points[0], NULL, count, hits, NULL);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
}

void take_quadrature(struct quadrature *q, const dpt_mesh *mesh, const dpt_pose *pose, const double ends[6],
                     double reach)
{
    static dpt_hit hits[FINE + COARSE];
    const double length = apart(ends, ends + 3);
    double coarse[COARSE];
    size_t kept = 0;
    q->sum = q->half = (struct integrals){ .overlap = 0 };
    q->count = 0;
    for (int i = 0; i < COARSE; i++)
        coarse[i] = (i + 0.5) / COARSE;
    heights_at(mesh, pose, ends, coarse, COARSE, hits);
    for (int i = 0; i < COARSE; i++)
        if (hits[i].gap - reach <= 0.5 * length / COARSE)
            coarse[kept++] = coarse[i];
    if (!kept)
        return;
    const size_t each = FINE / kept;
    for (size_t i = 0; i < kept; i++)
        for (size_t k = 0; k < each; k++) {
            const double part = ((double)k + 0.5) / (double)each - 0.5;
            q->s[q->count] = coarse[i] + part / COARSE;
            q->width[q->count++] = 1.0 / COARSE / (double)each;
        }
    heights_at(mesh, pose, ends, q->s, q->count, hits);
    for (size_t i = 0; i < q->count; i++) {
        for (int k = 0; k < 3; k++)
            q->way[i][k] = (hits[i].gap < 0 ? -1 : 1) * (hits[i].p[k] - hits[i].q[k]);
        unit3(q->way[i]);
        q->height[i] = hits[i].gap;
        const double deep = fmax(0, reach - hits[i].gap), w = deep * q->width[i] * length;
        add_overlap(&q->sum, w, q->s[i], q->way[i]);
        q->sum.square += deep * w;
        if (i % 2) {
            add_overlap(&q->half, 2 * w, q->s[i], q->way[i]);
            q->half.square += 2 * deep * w;
        }
    }
}
