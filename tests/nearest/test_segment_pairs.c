/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * dpt_segment_triangle_pairs against oracle/pair.h: each pair is the nearest of its own two features, the oracle being
 * asked for an end as a point, and for an edge as a triangle of two equal corners. Where long double is no wider than
 * double, nothing is judged.
 */
#include <math.h>
#include <string.h>

#include "dynpoint/query.h"
#include "lib/check.h"
#include "oracle/pair.h"

/* Of the largest coordinate; edges that are nearly parallel are as far apart all along. */
#define BOUND (64 * 0x1p-53)

static double away(const double *a, const double *b)
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* The distance of a feature, 0..4, by the oracle; *inside: the segment's nearest point to an edge is none of its ends. */
static double truth_of(int feature, const double segment[6], const double triangle[9], int *inside)
{
    double edge[9];
    *inside = 1;
    if (feature < 2)
        return (double)oracle_point(segment + 3 * feature, triangle);
    const int from = feature - 2, to = (feature - 1) % 3;
    memcpy(edge, triangle + 3 * from, 3 * sizeof *edge);
    memcpy(edge + 3, triangle + 3 * to, 3 * sizeof *edge);
    memcpy(edge + 6, triangle + 3 * to, 3 * sizeof *edge);
    const double least = (double)oracle_pair(segment, edge);
    *inside = least < (double)fminl(oracle_point(segment, edge), oracle_point(segment + 3, edge)) - BOUND;
    return least;
}

static void draw(uint64_t *seed, int kind, double segment[6], double triangle[9])
{
    for (int k = 0; k < 9; k++)
        triangle[k] = random_in(seed, -1, 1);
    for (int k = 0; k < 6; k++)
        segment[k] = random_in(seed, -1, 1);
    if (kind == 1) /* parallel to an edge */
        for (int k = 0; k < 3; k++)
            segment[3 + k] = segment[k] + 0.7 * (triangle[3 + k] - triangle[k]);
    if (kind == 2)
        memcpy(triangle + 3, triangle, 3 * sizeof *triangle);
    if (kind == 3)
        memcpy(segment + 3, segment, 3 * sizeof *segment);
}

static void each_is_the_nearest_of_its_features(void)
{
    uint64_t seed = 2, met = 0;
    for (int i = 0; i < 20000 && ORACLE_PAIR_JUDGES; i++) {
        double segment[6], triangle[9];
        dpt_segment_pair pairs[DPT_SEGMENT_PAIRS_MAX];
        draw(&seed, i % 4, segment, triangle);
        const uint32_t count = dpt_segment_triangle_pairs(segment, triangle, pairs);
        CHECK(i % 4 == 3 ? count == 1 : count >= 2, "case %d: %u pairs", i, count);
        uint32_t told = 0; /* bits of pairs that are of a feature */
        for (int feature = 0; feature < (i % 4 == 3 ? 1 : 5); feature++) {
            int inside, is_there = 0;
            const double truth = truth_of(feature, segment, triangle, &inside);
            for (uint32_t at = 0; at < count; at++) {
                if (!(fabs(pairs[at].distance - truth) <= BOUND) || (feature < 2 && pairs[at].s != feature))
                    continue;
                is_there = 1;
                told |= 1u << at;
                CHECK(fabs(away(pairs[at].p, pairs[at].q) - truth) <= BOUND, "case %d: points", i);
            }
            CHECK(is_there || !inside, "case %d: feature %d, %g apart, is missing", i, feature, truth);
            met += feature >= 2 && is_there;
        }
        CHECK(told == (1u << count) - 1, "case %d: pairs %x of %u are of a feature", i, told, count);
    }
    CHECK(met > 10000 || !ORACLE_PAIR_JUDGES, "%llu edges", (unsigned long long)met);
}

int main(void)
{
    TEST(each_is_the_nearest_of_its_features);
    return check_report();
}
