/* SPDX-License-Identifier: BSD-3-Clause */
/* The loops for springs (docs/algorithms/springs.md): a part of kernel_body.h, for each instruction set. */

#ifndef KERNEL_TAKE
#define KERNEL_TAKE(points, at, x, y, z)                                                           \
    for (int i = 0; i < LANES; i++) {                                                              \
        const float *point = (points) + 4 * (size_t)(at)[i];                                       \
        (x)[i] = point[0];                                                                         \
        (y)[i] = point[1];                                                                         \
        (z)[i] = point[2];                                                                         \
    }
#endif

/* A slice's own points, in lanes. */
#define OWN_POINTS(points, slice)                                                                  \
    const float *own = (points) + SPRING_POINTS * (size_t)(slice);                                 \
    float ax[LANES], ay[LANES], az[LANES];                                                         \
    for (int i = 0; i < LANES; i++) {                                                              \
        ax[i] = own[4 * i];                                                                        \
        ay[i] = own[4 * i + 1];                                                                    \
        az[i] = own[4 * i + 2];                                                                    \
    }

KERNEL_TARGET static inline __attribute__((always_inline)) void
KERNEL(spring_sums)(const struct spring_rows *restrict rows, uint32_t slice,
                    const float *restrict points, float *restrict force, float *restrict energy)
{
    const uint32_t end = rows->first[slice + 1];
    float fx[LANES] = { 0 }, fy[LANES] = { 0 }, fz[LANES] = { 0 }, x[LANES], y[LANES], z[LANES];
    OWN_POINTS(points, slice)

    for (uint32_t entry = rows->first[slice]; entry < end; entry++) {
        const uint32_t *at = rows->neighbour + LANES * (size_t)entry;
        const float *stiffness = rows->stiffness + LANES * (size_t)entry;
        const float *length = rows->length + LANES * (size_t)entry;
        KERNEL_TAKE(points, at, x, y, z)
        for (int i = 0; i < LANES; i++) {
            const float dx = x[i] - ax[i], dy = y[i] - ay[i], dz = z[i] - az[i];
            const float distance = sqrtf((dx * dx + dy * dy) + dz * dz);
            const float from = AT_LEAST(distance, SPRING_SHORTEST * length[i]);
            const float pull = stiffness[i] * (1.0f - length[i] / from);
            fx[i] += pull * dx;
            fy[i] += pull * dy;
            fz[i] += pull * dz;
            if (energy) {
                const float longer = from - length[i], inside = from * from - distance * distance;
                energy[i] += stiffness[i] * (longer * longer + inside);
            }
        }
    }
    for (int i = 0; i < LANES; i++) {
        force[i] = fx[i];
        force[LANES + i] = fy[i];
        force[2 * LANES + i] = fz[i];
    }
}

KERNEL_TARGET void KERNEL(spring_forces)(const struct spring_rows *restrict rows, uint32_t slice,
                                         const float *restrict points, float *restrict force)
{
    KERNEL(spring_sums)(rows, slice, points, force, NULL);
}

KERNEL_TARGET void KERNEL(spring_energy)(const struct spring_rows *restrict rows, uint32_t slice,
                                         const float *restrict points, float *restrict force,
                                         double *restrict sum)
{
    float energy[LANES] = { 0 };
    KERNEL(spring_sums)(rows, slice, points, force, energy);
    for (int i = 0; i < LANES; i++)
        sum[i] += (double)energy[i];
}

KERNEL_TARGET void KERNEL(spring_product)(const struct spring_rows *restrict rows, uint32_t slice,
                                          float scale, const float *restrict diagonal,
                                          const float *restrict points, float *restrict out,
                                          double *restrict sum)
{
    const uint32_t end = rows->first[slice + 1];
    float px[LANES] = { 0 }, py[LANES] = { 0 }, pz[LANES] = { 0 }, x[LANES], y[LANES], z[LANES];
    OWN_POINTS(points, slice)

    for (uint32_t entry = rows->first[slice]; entry < end; entry++) {
        const uint32_t *at = rows->neighbour + LANES * (size_t)entry;
        const float *stiffness = rows->stiffness + LANES * (size_t)entry;
        KERNEL_TAKE(points, at, x, y, z)
        for (int i = 0; i < LANES; i++) {
            px[i] += stiffness[i] * (ax[i] - x[i]);
            py[i] += stiffness[i] * (ay[i] - y[i]);
            pz[i] += stiffness[i] * (az[i] - z[i]);
        }
    }
    for (int i = 0; i < LANES; i++) {
        px[i] = scale * px[i] + diagonal[i] * ax[i];
        py[i] = scale * py[i] + diagonal[i] * ay[i];
        pz[i] = scale * pz[i] + diagonal[i] * az[i];
        out[i] = px[i];
        out[LANES + i] = py[i];
        out[2 * LANES + i] = pz[i];
    }
    for (int i = 0; i < LANES; i++)
        sum[i] += (double)((ax[i] * px[i] + ay[i] * py[i]) + az[i] * pz[i]);
}

KERNEL_TARGET uint32_t KERNEL(spring_move)(const struct spring_motion *restrict motion,
                                           const struct spring_nodes *restrict nodes,
                                           const float *restrict force, const float *restrict load,
                                           const struct spring_slice *from, struct spring_slice *to,
                                           float *restrict points, float *restrict square)
{
    const float step = motion->step, scale = motion->scale, lead = motion->lead;
    const float far = motion->far, fast = motion->fast;
    const float before = motion->is_euler ? 1.0f : 0.0f, after = 1.0f - before;
    float keep[LANES], speed[LANES] = { 0 }, place[SPRING_ROWS];
    uint32_t bad[LANES] = { 0 }, any = 0;

    for (int i = 0; i < LANES; i++)
        keep[i] = 1.0f / (1.0f + step * nodes->drag[i]);
    for (int row = 0; row < 3; row++) {
        const float gravity = motion->gravity[row];
        float x[LANES], rest[LANES], v[LANES];
        for (int i = 0; i < LANES; i++) {
            const int k = row * LANES + i;
            const float fall = nodes->per_mass[i] > 0.0f ? gravity : 0.0f;
            const float push = (scale * force[k] + load[k]) * nodes->per_mass[i] + fall;
            const float v0 = from->v[k], v1 = (v0 + step * push) * keep[i];
            const float way = step * (before * v0 + after * v1) + from->rest[k];
            const float x0 = from->x[k], x1 = x0 + way;
            x[i] = x1;
            rest[i] = way - (x1 - x0);
            v[i] = v1;
            place[k] = x1 + lead * v1;
            speed[i] += v1 * v1;
            bad[i] |= (uint32_t) !(fabsf(x1) <= far) | (uint32_t) !(fabsf(v1) <= fast);
        }
        for (int i = 0; i < LANES; i++) {
            to->x[row * LANES + i] = x[i];
            to->rest[row * LANES + i] = rest[i];
            to->v[row * LANES + i] = v[i];
        }
    }
    for (int i = 0; i < LANES; i++) {
        points[4 * i] = place[i];
        points[4 * i + 1] = place[LANES + i];
        points[4 * i + 2] = place[2 * LANES + i];
        points[4 * i + 3] = 0.0f;
    }
    for (int i = 0; i < 8; i++)
        speed[i] = AT_LEAST(speed[i], speed[i + 8]);
    for (int i = 0; i < 4; i++)
        speed[i] = AT_LEAST(speed[i], speed[i + 4]);
    for (int i = 0; i < LANES; i++)
        any |= bad[i];
    const float left = AT_LEAST(speed[0], speed[2]), right = AT_LEAST(speed[1], speed[3]);
    *square = AT_LEAST(left, right);
    return any;
}

KERNEL_TARGET void KERNEL(spring_descend)(float by, const float *restrict direction,
                                          const float *restrict product,
                                          const float *restrict per_diagonal,
                                          float *restrict change, float *restrict residual,
                                          double *restrict sum)
{
    float square[LANES] = { 0 };
    for (int row = 0; row < 3; row++)
        for (int i = 0; i < LANES; i++) {
            const int k = row * LANES + i;
            const float left = residual[k] - by * product[k];
            change[k] += by * direction[4 * i + row];
            residual[k] = left;
            square[i] += left * left;
        }
    for (int i = 0; i < LANES; i++)
        sum[i] += (double)(square[i] * per_diagonal[i]);
}

KERNEL_TARGET void KERNEL(spring_turn)(float by, const float *restrict residual,
                                       const float *restrict per_diagonal,
                                       float *restrict direction)
{
    for (int i = 0; i < LANES; i++)
        for (int row = 0; row < 3; row++)
            direction[4 * i + row] =
                per_diagonal[i] * residual[row * LANES + i] + by * direction[4 * i + row];
}
