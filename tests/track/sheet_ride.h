/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A tool that is moved from tick to tick over a sheet. Each tick's sweep, gap, force and contacts are held against the
 * truth (sheet_truth.h) and against what is known of the tool's side. Where the truth is in doubt, the tick is counted
 * and not judged.
 */
#ifndef DPT_TESTS_SHEET_RIDE_H
#define DPT_TESTS_SHEET_RIDE_H

#include "track/sheet_scene.h"

/* Sums over all ticks of a sheet. */
struct sums {
    unsigned long ticks, swept, met, clear, near, undecided, planned;
    unsigned long clean, sided, behind, away, doubtful, turned_back, unknown, lost;
    double worst_off, worst_gap, worst_late;
};

/*
 * What is known of the axis since it was teleported. UNCROSSED: it has not gone through the sheet. CROSSED: it has,
 * coming from `side`. SIDE_LOST: the side is to be forgotten this tick. SIDE_UNKNOWN: the truth cannot tell.
 */
enum { UNCROSSED, CROSSED, SIDE_LOST, SIDE_UNKNOWN };

/* One such tool, and its last tick. */
struct ride {
    struct scene *scene;
    struct sums *sums;
    struct state previous;
    double previous_distance, previous_error, reported_distance; /* by the library */
    int knowledge;
    int side; /* in front, as the mesh is wound: +1 */
    int started;
};

/* The unit normal of a triangle. */
void normal_of(const double c[9], double n[3]);

/*
 * How far in front of its nearest point a point is, and whether that is on the border. Of the triangles that have the
 * nearest point the one decides that faces the point most; n is its normal.
 */
double height_of(const struct sheet *sheet, const double x[3], double n[3], int *border);

/* Check the sweep of this tick; returns what the axis itself, without its radius, truly met. */
struct truth check_sweep(struct ride *ride, const struct state *now, const dpt_sweep *sweep, double planned);

/* Which side the axis came from, where it first goes through; 0 where it was on both, or that is not clear. */
int side_of(const struct ride *ride, const struct state *now, const struct truth *axis);

/* Gap, force and regions against what is known. */
void check_contact(struct ride *ride, const struct state *now, const struct tick_answer *answer,
                   const struct close *close);

/*
 * An axis that meets the sheet at s is on different sides of it before and after, or ends there. On a border one that
 * stays on its side is no crossing either.
 */
int goes_through(const struct sheet *sheet, const struct ends3 *at, double s);

/* One tick and all checks of it. `planned`: the time of a crossing that must be found, or -1. Returns the contact. */
uint32_t ride_tick(struct ride *ride, const struct state *now, int teleport, double planned);

#endif
