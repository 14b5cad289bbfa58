/* SPDX-License-Identifier: BSD-3-Clause */
/* The loops for the volumes of cells (docs/algorithms/springs.md): a part of kernel_body.h, for each instruction set. */

/* What a node's cells pull: those of which it is corner 0 to 3 one way, those of which it is corner 7 to 4 the other. */
#ifndef KERNEL_CORNERS
#define CORNER(pulls, at, i, k) ((pulls) + (size_t)(at)[LANES * (k) + (i)])
#define KERNEL_CORNERS(pulls, at, i, to)                                                                               \
    for (int k = 0; k < 4; k++)                                                                                        \
        (to)[k] = ((CORNER(pulls, at, i, 0)[k] - CORNER(pulls, at, i, 7)[k]) +                                         \
                   (CORNER(pulls, at, i, 1)[k] - CORNER(pulls, at, i, 6)[k])) +                                        \
                  ((CORNER(pulls, at, i, 2)[k] - CORNER(pulls, at, i, 5)[k]) +                                         \
                   (CORNER(pulls, at, i, 3)[k] - CORNER(pulls, at, i, 4)[k]));
#endif

/*
 * A coordinate of the sums of a cell's four edges along each of its axes, lane i. Differences from the first corner come
 * first: they are exact or nearly so, wherever the cell is.
 */
#define CELL_EDGES(x, a, b, c)                                                                                         \
    const float x##1 = x[1][i] - x[0][i], x##2 = x[2][i] - x[0][i], x##3 = x[3][i] - x[0][i];                          \
    const float x##4 = x[4][i] - x[0][i], x##5 = x[5][i] - x[0][i], x##6 = x[6][i] - x[0][i];                          \
    const float x##7 = x[7][i] - x[0][i];                                                                              \
    const float x##23 = x##2 + x##3, x##45 = x##4 + x##5, x##67 = x##6 + x##7;                                         \
    const float a = per * ((x##1 + (x##3 - x##2)) + ((x##5 - x##4) + (x##7 - x##6)));                                  \
    const float b = per * ((x##23 - x##1) + (x##67 - x##45));                                                          \
    const float c = per * ((x##45 - x##1) + (x##67 - x##23));

/* What a cell pulls with, of a coordinate and lane i, from what its mean edges do. */
#define CELL_PULL(to, a, b, c)                                                                                         \
    {                                                                                                                  \
        const float both = (b) + (c), apart = (c) - (b);                                                               \
        to[0][i] = (a) + both;                                                                                         \
        to[1][i] = both - (a);                                                                                         \
        to[2][i] = (a) + apart;                                                                                        \
        to[3][i] = apart - (a);                                                                                        \
    }

KERNEL_TARGET static inline __attribute__((always_inline)) void
KERNEL(cell_terms)(const struct spring_cells *restrict cells, uint32_t slice, const float *restrict points,
                   float *restrict pulls, float *restrict energy)
{
    const uint32_t *at = cells->nodes + CELL_CORNERS * (size_t)slice;
    const float *stiffness = cells->stiffness + LANES * (size_t)slice;
    const float per = cells->per_edges, quarter = cells->quarter;
    const float slope = cells->slope, turn_slope = cells->turn_slope;
    const float turn = cells->turn, before = turn - 1.0f;
    const float smallest = cells->smallest, largest = cells->largest;
    const float slack = CELL_MOST - CELL_EXACT;
    float x[8][LANES], y[8][LANES], z[8][LANES], px[4][LANES], py[4][LANES], pz[4][LANES];

    for (int corner = 0; corner < 8; corner++) {
        KERNEL_TAKE(points, at + LANES * corner, x[corner], y[corner], z[corner])
    }
    for (int i = 0; i < LANES; i++) {
        CELL_EDGES(x, ax, bx, cx)
        CELL_EDGES(y, ay, by, cy)
        CELL_EDGES(z, az, bz, cz)
        const float ux = by * cz - bz * cy, uy = bz * cx - bx * cz, uz = bx * cy - by * cx;
        const float vx = cy * az - cz * ay, vy = cz * ax - cx * az, vz = cx * ay - cy * ax;
        const float wx = ay * bz - az * by, wy = az * bx - ax * bz, wz = ax * by - ay * bx;
        const float whole = (ax * ux + ay * uy) + az * uz;
        const float size =
            ((ax * ax + ay * ay) + az * az) + ((bx * bx + by * by) + bz * bz) + ((cx * cx + cy * cy) + cz * cz);
        const float reach = AT_LEAST(size, CELL_EXACT);
        const float less = slack / (reach - (CELL_EXACT - slack));
        const float share = (CELL_MOST - slack * less) / reach;
        const float inward = 2.0f * whole * ((less * less - share) / reach);
        const float volume = share * whole, within = AT_MOST(AT_LEAST(volume, smallest), largest);
        const float above = AT_LEAST(within - turn, 0.0f), below = AT_MOST(within - turn, 0.0f);
        const float pressure = slope * (before + above) + turn_slope * below;
        const float pull = stiffness[i] * quarter * pressure;
        const float along = pull * share, back = pull * inward;
        CELL_PULL(px, along * ux + back * ax, along * vx + back * bx, along * wx + back * cx)
        CELL_PULL(py, along * uy + back * ay, along * vy + back * by, along * wy + back * cy)
        CELL_PULL(pz, along * uz + back * az, along * vz + back * bz, along * wz + back * cz)
        if (energy) {
            const float grown =
                0.5f * slope * (before + above) * (before + above) + (slope * before + 0.5f * turn_slope * below) * below;
            energy[i] = 16.0f * stiffness[i] * quarter * quarter * (grown + pressure * (volume - within));
        }
    }
    for (int k = 0; k < 4; k++) {
        KERNEL_PUT(pulls + SPRING_POINTS * k, px[k], py[k], pz[k])
    }
}

KERNEL_TARGET void KERNEL(cell_pulls)(const struct spring_cells *restrict cells, uint32_t slice,
                                      const float *restrict points, float *restrict pulls)
{
    KERNEL(cell_terms)(cells, slice, points, pulls, NULL);
}

KERNEL_TARGET void KERNEL(cell_energy)(const struct spring_cells *restrict cells, uint32_t slice,
                                       const float *restrict points, float *restrict pulls, double *restrict sum)
{
    float energy[LANES] = { 0 };
    KERNEL(cell_terms)(cells, slice, points, pulls, energy);
    for (int i = 0; i < LANES; i++)
        sum[i] += (double)energy[i];
}

KERNEL_TARGET void KERNEL(cell_forces)(const uint32_t *restrict at, const float *restrict pulls, float *restrict force)
{
    float sum[SPRING_POINTS], x[LANES], y[LANES], z[LANES];
    for (int i = 0; i < LANES; i++)
        KERNEL_CORNERS(pulls, at, i, sum + 4 * i)
    KERNEL_TAKE(sum, KERNEL(in_turn), x, y, z)
    for (int i = 0; i < LANES; i++) {
        force[i] += x[i];
        force[LANES + i] += y[i];
        force[2 * LANES + i] += z[i];
    }
}
