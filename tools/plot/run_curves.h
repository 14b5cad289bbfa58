/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a plot shows of a run: its curves against time, read tick by tick from a file of any length and kept in bounded
 * memory. The file is what `replay -o` or `record csv` wrote, or a recording.
 */
#ifndef DPT_TOOLS_RUN_CURVES_H
#define DPT_TOOLS_RUN_CURVES_H

#include <stdint.h>

#include "cli/csv_rows.h"
#include "dynpoint/record.h"
#include "plot/plot_axis.h"

enum run_curve { CURVE_FORCE, CURVE_DEPTH, CURVE_GAP, CURVE_ENERGY, CURVE_LATENESS, CURVES };

/* A tick as a file tells it. */
struct curve_tick {
    uint64_t number;      /* where it does not follow the tick before, the curves are broken */
    double time;          /* s from the first tick of the file on; does not go back */
    double value[CURVES]; /* N, m, m, J, s; NaN: not known */
};

struct run_curves {
    const char *command, *path;
    double tick;     /* length of a tick of `replay -o`, s */
    double from, to; /* s from the first tick on: what lies outside is not kept */
    struct plot_line line[CURVES];
    uint64_t ticks;              /* within, and with a time */
    uint64_t gaps;               /* places within where numbers are missing */
    double first, last;          /* time of the first and the last of these ticks */
    uint64_t damages, damaged;   /* of a recording: places and bytes that are no records */
    uint64_t first_damage;       /* byte */
    uint64_t of_others;          /* records of other devices than the first one */
    uint64_t number, begin_ns;   /* of the tick before; of the first one */
    double now;                  /* time of the tick before */
    uint32_t device;             /* of the first record */
    int has_begun, has_a_device; /* there was a tick, a record */
    int is_timed;                /* the loop had a clock, and so a lateness */
};

/*
 * Read the file. The caller sets `command`, `path`, `tick`, `from` and `to`, zeros the rest, and calls run_curves_free in
 * any case. Returns 0, or 2 after a message: the file has an error, or no tick within.
 */
int run_curves_read(struct run_curves *curves);
void run_curves_free(struct run_curves *curves);

/*
 * Take a tick, or a record. What a record does not tell is NaN, or 0 in whole numbers. Returns NULL, or what is wrong
 * with it.
 */
const char *run_curves_take(struct run_curves *curves, const struct curve_tick *tick);
const char *run_curves_take_record(struct run_curves *curves, const dpt_record *record);

/* The length of a vector, without overflow. */
double run_curves_length(const double v[3]);

/* Read all rows of a CSV file (run_csv.c). Returns 0, or 2 after a message. */
int run_curves_read_csv(struct run_curves *curves, struct csv_rows *rows);

#endif
