/* SPDX-License-Identifier: BSD-3-Clause */
/* Strips against the sheets that the oracle finds, and against each other. */
#ifndef DPT_TESTS_STRIP_SHEET_H
#define DPT_TESTS_STRIP_SHEET_H

#include "dynpoint/strip.h"
#include "strip/strip_random.h"

/* Sums over all that a program has checked. */
static struct tally {
    size_t meshes, shadows, empty, triangles, borders, nonmanifold, full;
    size_t clear,
        doubts; /* of shadows that are no mere line and whose e is told: triangles, and those in doubt */
} all;

/* The oracle's flags in the library's bits. */
static inline uint32_t bits_of(uint32_t flags)
{
    return (flags & 1 ? (uint32_t)DPT_STRIP_FLAG_BORDER : 0u) |
           (flags & 2 ? (uint32_t)DPT_STRIP_FLAG_NONMANIFOLD : 0u);
}

/* A strip that is filled and not full, against the sheet that the oracle found. */
static inline void check_sheet(const struct scene *scene, const dpt_shadow *shadow,
                               const dpt_strip *strip)
{
    const struct oracle_sheet *sheet = &scene->sheet;
    const int clear = !scene->shadow.any && shadow->depth + scene->shadow.sure_reach > 0;
    uint32_t count = 0, flags = 0, sure = 0;
    const uint32_t *triangles = dpt_strip_get_triangles(strip, &count, &flags);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t t = triangles[i];
        CHECK(t < sheet->surface->triangles && sheet->in[t] != ORACLE_OUT, "%u is not of it: %s", t,
              text_of(scene, shadow));
        if (t >= sheet->surface->triangles)
            continue;
        CHECK(!scene->mark[t], "%u is twice: %s", t, text_of(scene, shadow));
        scene->mark[t] = 1;
        sure += sheet->in[t] == ORACLE_SURE;
    }
    for (uint32_t t = 0; sure < sheet->sure && t < sheet->surface->triangles; t++)
        if (sheet->in[t] == ORACLE_SURE && !scene->mark[t]) {
            CHECK(0, "%u is missing, %u of %u are there: %s", t, sure, sheet->sure,
                  text_of(scene, shadow));
            break;
        }
    for (uint32_t i = 0; i < count; i++)
        if (triangles[i] < sheet->surface->triangles)
            scene->mark[triangles[i]] = 0;
    const uint32_t must = bits_of(sheet->sure_flags), may = bits_of(sheet->maybe_flags);
    CHECK((flags & must) == must && (flags & ~may) == 0, "flags %u, not %u to %u: %s", flags, must,
          may, text_of(scene, shadow));
    all.shadows++;
    all.empty += count == 0;
    all.triangles += count;
    all.clear += clear ? count : 0;
    all.doubts += clear ? sheet->maybe - sheet->sure : 0;
    all.borders += (flags & DPT_STRIP_FLAG_BORDER) != 0;
    all.nonmanifold += (flags & DPT_STRIP_FLAG_NONMANIFOLD) != 0;
}

/* Two strips hold the same triangles, in whatever order, and the same flags. */
static inline int are_alike(const struct scene *scene, const dpt_strip *one, const dpt_strip *other)
{
    uint32_t m = 0, n = 0, m_flags = 0, n_flags = 0, found = 0;
    const uint32_t *a = dpt_strip_get_triangles(one, &m, &m_flags);
    const uint32_t *b = dpt_strip_get_triangles(other, &n, &n_flags);
    for (uint32_t i = 0; i < m; i++)
        scene->mark[a[i]] = 1;
    for (uint32_t i = 0; i < n; i++)
        found += scene->mark[b[i]];
    for (uint32_t i = 0; i < m; i++)
        scene->mark[a[i]] = 0;
    return m == n && found == n && m_flags == n_flags;
}

static inline void ask_oracle(struct scene *scene, const dpt_shadow *shadow)
{
    oracle_shadow_of(scene, shadow, &scene->shadow);
    oracle_sheet_find(&scene->sheet, &scene->shadow, shadow->triangle);
}

/* Folds: a sheet that goes there and back, its layers `apart`. */

enum { FOLD_ROWS = 20, FOLD_LAYERS = 3, FOLD_ROW = FOLD_ROWS + 1 };

/* Row i of layer l lies at x = i along it, then turns back over the next one; the fold itself is flat. */
static inline int subject_with_folds(struct subject *subject, double between)
{
    enum { ROWS = FOLD_LAYERS * FOLD_ROW };
    static double vertices[3 * ROWS * FOLD_ROW];
    static uint32_t corners[6 * (ROWS - 1) * FOLD_ROWS];
    uint32_t *c = corners;
    for (uint32_t r = 0; r < ROWS; r++)
        for (uint32_t j = 0; j < FOLD_ROW; j++) {
            const uint32_t layer = r / FOLD_ROW, i = r % FOLD_ROW;
            double *v = vertices + 3 * (r * FOLD_ROW + j);
            v[0] = 0.01 * (layer % 2 ? FOLD_ROWS - i : i);
            v[1] = 0.01 * j;
            v[2] = -between * layer;
        }
    for (uint32_t r = 0; r + 1 < ROWS; r++)
        for (uint32_t j = 0; j < FOLD_ROWS; j++) {
            const uint32_t a = r * FOLD_ROW + j;
            const uint32_t square[6] = { a,     a + FOLD_ROW, a + 1,
                                         a + 1, a + FOLD_ROW, a + FOLD_ROW + 1 };
            memcpy(c, square, sizeof square);
            c += 6;
        }
    return subject_from_arrays(subject, "folds", vertices, ROWS * FOLD_ROW, corners,
                               2 * (ROWS - 1) * FOLD_ROWS);
}

#endif
