/* SPDX-License-Identifier: BSD-3-Clause */
/* The loops for vertices that move (docs/algorithms/deform.md): a part of kernel_body.h, for each instruction set. */

enum { KERNEL(group_floats) = 3 * KERNEL_GROUP, KERNEL(groups_at_once) = 4 };

/*
 * Some groups; `groups` is a constant. The largest of each is found in halves of all groups at once: compilers make
 * vectors of loops that are so long, and would take the lanes of one group apart.
 */
KERNEL_TARGET static inline __attribute__((always_inline)) void KERNEL(move_groups)(const float *restrict next,
                                                                                    const float *restrict last,
                                                                                    float *restrict to, int groups,
                                                                                    float *restrict square)
{
    enum { VERTICES = KERNEL_GROUP * KERNEL(groups_at_once) };
    float moved[3 * VERTICES], largest[VERTICES];

    for (int i = 0; i < KERNEL(group_floats) * groups; i++) {
        const float by = next[i] - last[i];
        moved[i] = by * by;
        to[i] = next[i];
    }
    for (int i = 0; i < 16 * groups; i++)
        largest[i] = (moved[3 * i] + moved[3 * i + 1]) + moved[3 * i + 2];
    for (int i = 0; i < 8 * groups; i++)
        moved[i] = AT_LEAST(largest[2 * i], largest[2 * i + 1]);
    for (int i = 0; i < 4 * groups; i++)
        largest[i] = AT_LEAST(moved[2 * i], moved[2 * i + 1]);
    for (int i = 0; i < 2 * groups; i++)
        moved[i] = AT_LEAST(largest[2 * i], largest[2 * i + 1]);
    for (int i = 0; i < groups; i++)
        square[i] = AT_LEAST(moved[2 * i], moved[2 * i + 1]);
}

KERNEL_TARGET void KERNEL(move)(const float *restrict next, const float *restrict last, float *restrict to,
                                uint32_t groups, float *restrict square)
{
    enum { AT_ONCE = KERNEL(groups_at_once), FLOATS = KERNEL(group_floats) };

    for (; groups >= AT_ONCE; groups -= AT_ONCE) {
        KERNEL(move_groups)(next, last, to, AT_ONCE, square);
        next += FLOATS * AT_ONCE;
        last += FLOATS * AT_ONCE;
        to += FLOATS * AT_ONCE;
        square += AT_ONCE;
    }
    for (; groups; groups--) {
        KERNEL(move_groups)(next, last, to, 1, square);
        next += FLOATS;
        last += FLOATS;
        to += FLOATS;
        square++;
    }
}

/* NaN becomes the lower end, so it differs from itself, and counts as outside. */
KERNEL_TARGET uint32_t KERNEL(outside)(const float *restrict positions, uint32_t groups, const float *restrict low,
                                       const float *restrict high)
{
    enum { FLOATS = KERNEL(group_floats) };
    uint32_t bad[FLOATS] = { 0 }, any = 0;

    for (uint32_t group = 0; group < groups; group++, positions += FLOATS)
        for (int i = 0; i < FLOATS; i++) {
            const float inside = AT_MOST(AT_LEAST(positions[i], low[i]), high[i]);
            bad[i] |= (uint32_t)(inside != positions[i]);
        }
    for (int i = 0; i < FLOATS; i++)
        any |= bad[i];
    return any;
}
