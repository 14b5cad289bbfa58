/* SPDX-License-Identifier: BSD-3-Clause */
/* Strips against the sheets that the oracle finds, and against each other. */
#ifndef DPT_TESTS_STRIP_SHEET_H
#define DPT_TESTS_STRIP_SHEET_H

#include "dynpoint/strip.h"
#include "strip/strip_random.h"

/* Sums over all that a program has checked. */
extern struct tally {
    size_t meshes, shadows, empty, triangles, borders, nonmanifold, full;
    size_t clear, doubts; /* of shadows that are no mere line and whose e is told: triangles, and those in doubt */
} totals;

/* The oracle's flags in the library's bits. */
static inline uint32_t bits_of(uint32_t flags)
{
    return (flags & 1 ? (uint32_t)DPT_STRIP_FLAG_BORDER : 0u) | (flags & 2 ? (uint32_t)DPT_STRIP_FLAG_NONMANIFOLD : 0u);
}

/* A strip that is filled and not full, against the sheet that the oracle found. */
void check_sheet(const struct scene *scene, const dpt_shadow *shadow, const dpt_strip *strip);

/* Two strips hold the same triangles, in whatever order, and the same flags. */
int are_alike(const struct scene *scene, const dpt_strip *one, const dpt_strip *other);

static inline void ask_oracle(struct scene *scene, const dpt_shadow *shadow)
{
    oracle_shadow_of(scene, shadow, &scene->shadow);
    oracle_sheet_find(&scene->sheet, &scene->shadow, shadow->triangle);
}

/* Folds: a sheet that goes there and back, its layers `apart`. */

/* Row i of layer l lies at x = i along it, then turns back over the next one; the fold itself is flat. */
int subject_with_folds(struct subject *subject, double between);

#endif
