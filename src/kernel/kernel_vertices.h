/* SPDX-License-Identifier: BSD-3-Clause */
/* The loops for vertices that move (docs/algorithms/deform.md): a part of kernel_body.h, for each instruction set. */

enum { KERNEL(group_floats) = 3 * KERNEL_GROUP };

/* The square of the distance of the vertex that begins at float i; at two of three floats none begins: 0. */
#define MOVED_SQUARE(i)                                                                            \
    (begins[i] * (((next[i] - last[i]) * (next[i] - last[i]) +                                     \
                   (next[(i) + 1] - last[(i) + 1]) * (next[(i) + 1] - last[(i) + 1])) +            \
                  (next[(i) + 2] - last[(i) + 2]) * (next[(i) + 2] - last[(i) + 2])))

KERNEL_TARGET void KERNEL(move)(const float *restrict next, const float *restrict last,
                                float *restrict to, uint32_t groups, float *restrict square)
{
    enum { FLOATS = KERNEL(group_floats) };
    static const float begins[FLOATS] = { 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1,
                                          0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0,
                                          0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0 };

    for (uint32_t group = 0; group < groups; group++) {
        float largest[LANES];
        for (int i = 0; i < FLOATS; i++)
            to[i] = next[i];
        for (int i = 0; i < LANES; i++)
            largest[i] = AT_LEAST(AT_LEAST(MOVED_SQUARE(i), MOVED_SQUARE(LANES + i)),
                                  MOVED_SQUARE(2 * LANES + i));
        for (int i = 0; i < 8; i++)
            largest[i] = AT_LEAST(largest[i], largest[i + 8]);
        for (int i = 0; i < 4; i++)
            largest[i] = AT_LEAST(largest[i], largest[i + 4]);
        largest[0] = AT_LEAST(largest[0], largest[2]);
        largest[1] = AT_LEAST(largest[1], largest[3]);
        square[group] = AT_LEAST(largest[0], largest[1]);
        next += FLOATS;
        last += FLOATS;
        to += FLOATS;
    }
}

KERNEL_TARGET uint32_t KERNEL(outside)(const float *restrict positions, uint32_t groups,
                                       const float *restrict low, const float *restrict high)
{
    enum { FLOATS = KERNEL(group_floats) };
    uint32_t bad[FLOATS] = { 0 }, any = 0;

    for (uint32_t group = 0; group < groups; group++, positions += FLOATS)
        for (int i = 0; i < FLOATS; i++)
            bad[i] |= !(positions[i] >= low[i] && positions[i] <= high[i]);
    for (int i = 0; i < FLOATS; i++)
        any |= bad[i];
    return any;
}
