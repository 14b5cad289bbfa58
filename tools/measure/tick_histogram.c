/* SPDX-License-Identifier: BSD-3-Clause */
#include "measure/tick_histogram.h"

#include <math.h>

const char *const tick_histogram_words[TICK_HISTOGRAMS] = { "ns", "work" };

/* `steps` to a doubling, rounded to whole numbers, each of them once. */
static const struct {
    double first;
    int steps, doublings;
} bins[TICK_HISTOGRAMS] = { { 16.0, 8, 16 }, { 1.0, 4, 16 } };

int tick_histogram_edges(enum tick_histogram_of of, double edges[TICK_HISTOGRAM_EDGES])
{
    int count = 0;
    for (int i = 0; i <= bins[of].steps * bins[of].doublings; i++) {
        const double edge = floor(bins[of].first * pow(2.0, (double)i / bins[of].steps) + 0.5);
        if (!count || edge > edges[count - 1])
            edges[count++] = edge;
    }
    return count;
}

struct tick_histogram tick_histogram_count(enum tick_histogram_of of, const double *sorted, size_t count)
{
    double edges[TICK_HISTOGRAM_EDGES];
    struct tick_histogram histogram = { .bin = { 0 } };
    const int edge_count = tick_histogram_edges(of, edges);
    int bin = 0;
    for (size_t i = 0; i < count; i++) {
        while (bin < edge_count && sorted[i] >= edges[bin])
            bin++;
        histogram.bin[bin]++;
    }
    return histogram;
}
