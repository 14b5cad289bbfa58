/* SPDX-License-Identifier: BSD-3-Clause */
#include "strip/strip_sheet.h"

struct tally totals;

void check_sheet(const struct scene *scene, const dpt_shadow *shadow, const dpt_strip *strip)
{
    const struct oracle_sheet *sheet = &scene->sheet;
    const int clear = !scene->shadow.any && shadow->depth + scene->shadow.sure_reach > 0;
    uint32_t count = 0, flags = 0, sure = 0;
    const uint32_t *triangles = dpt_strip_get_triangles(strip, &count, &flags);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t t = triangles[i];
        CHECK(t < sheet->surface->triangles && sheet->in[t] != ORACLE_OUT, "%u is not of it: %s", t,
              shadow_text(scene, shadow));
        if (t >= sheet->surface->triangles)
            continue;
        CHECK(!scene->mark[t], "%u is twice: %s", t, shadow_text(scene, shadow));
        scene->mark[t] = 1;
        sure += sheet->in[t] == ORACLE_SURE;
    }
    for (uint32_t t = 0; sure < sheet->sure && t < sheet->surface->triangles; t++)
        if (sheet->in[t] == ORACLE_SURE && !scene->mark[t]) {
            CHECK(0, "%u is missing, %u of %u are there: %s", t, sure, sheet->sure, shadow_text(scene, shadow));
            break;
        }
    for (uint32_t i = 0; i < count; i++)
        if (triangles[i] < sheet->surface->triangles)
            scene->mark[triangles[i]] = 0;
    const uint32_t must = bits_of(sheet->sure_flags), may = bits_of(sheet->maybe_flags);
    CHECK((flags & must) == must && (flags & ~may) == 0, "flags %u, not %u to %u: %s", flags, must, may,
          shadow_text(scene, shadow));
    totals.shadows++;
    totals.empty += count == 0;
    totals.triangles += count;
    totals.clear += clear ? count : 0;
    totals.doubts += clear ? sheet->maybe - sheet->sure : 0;
    totals.borders += (flags & DPT_STRIP_FLAG_BORDER) != 0;
    totals.nonmanifold += (flags & DPT_STRIP_FLAG_NONMANIFOLD) != 0;
}

int are_alike(const struct scene *scene, const dpt_strip *one, const dpt_strip *other)
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

enum { FOLD_ROWS = 20, FOLD_LAYERS = 3, FOLD_ROW = FOLD_ROWS + 1 };

int subject_with_folds(struct subject *subject, double between)
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
            const uint32_t square[6] = { a, a + FOLD_ROW, a + 1, a + 1, a + FOLD_ROW, a + FOLD_ROW + 1 };
            memcpy(c, square, sizeof square);
            c += 6;
        }
    return subject_from_arrays(subject, "folds", vertices, ROWS * FOLD_ROW, corners, 2 * (ROWS - 1) * FOLD_ROWS);
}
