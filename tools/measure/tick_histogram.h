/* SPDX-License-Identifier: BSD-3-Clause */
/* How often a tick took how long, or how much work. Peers count their times in the same bins (tests/bench/peer.h). */
#ifndef DPT_TOOLS_TICK_HISTOGRAM_H
#define DPT_TOOLS_TICK_HISTOGRAM_H

#include <stddef.h>
#include <stdint.h>

enum tick_histogram_of { TICK_HISTOGRAM_NS, TICK_HISTOGRAM_WORK, TICK_HISTOGRAMS };

/* In files and in JSON: "ns" and "work". */
extern const char *const tick_histogram_words[TICK_HISTOGRAMS];

enum { TICK_HISTOGRAM_EDGES = 8 * 16 + 1 };

/* Bin 0 counts what is below the first edge, bin i what is at or above edge i - 1 and below edge i, the last all beyond. */
struct tick_histogram {
    uint32_t bin[TICK_HISTOGRAM_EDGES + 1];
};

/* The edges: whole numbers, 8 to a doubling from 16 ns on, or 4 from 1 unit on. Returns how many; there is one bin more. */
int tick_histogram_edges(enum tick_histogram_of of, double edges[TICK_HISTOGRAM_EDGES]);

/* Count sorted numbers. The bins add up to their count. */
struct tick_histogram tick_histogram_count(enum tick_histogram_of of, const double *sorted, size_t count);

#endif
