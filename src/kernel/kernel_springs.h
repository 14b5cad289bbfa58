/* SPDX-License-Identifier: BSD-3-Clause */
/* The loops for springs (docs/algorithms/springs.md): a part of kernel_body.h, for each instruction set. */

#ifndef KERNEL_TAKE
#define KERNEL_TAKE(points, at, x, y, z)                                                                               \
    for (int i = 0; i < LANES; i++) {                                                                                  \
        const float *point = (points) + 4 * (size_t)(at)[i];                                                           \
        (x)[i] = point[0];                                                                                             \
        (y)[i] = point[1];                                                                                             \
        (z)[i] = point[2];                                                                                             \
    }
#endif

#ifndef KERNEL_PUT
#define KERNEL_PUT(points, x, y, z)                                                                                    \
    for (int i = 0; i < LANES; i++) {                                                                                  \
        (points)[4 * i] = (x)[i];                                                                                      \
        (points)[4 * i + 1] = (y)[i];                                                                                  \
        (points)[4 * i + 2] = (z)[i];                                                                                  \
        (points)[4 * i + 3] = 0.0f;                                                                                    \
    }
#endif

/* The sum of four weighted points, in double, in their order. May write a fourth number. */
#ifndef KERNEL_WEIGH
#define KERNEL_WEIGH(points, nodes, weights, to)                                                                       \
    for (int row = 0; row < 3; row++) {                                                                                \
        double sum = 0.0;                                                                                              \
        for (int k = 0; k < 4; k++)                                                                                    \
            sum += (double)(weights)[k] * (double)(points)[4 * (size_t)(nodes)[k] + (size_t)row];                      \
        (to)[row] = (float)sum;                                                                                        \
    }
#endif

/* Nodes that follow each other. */
static const uint32_t KERNEL(in_turn)[LANES] = { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15 };

/* A slice's own points, in lanes. */
#define OWN_POINTS(points, slice)                                                                                      \
    const float *own = (points) + SPRING_POINTS * (size_t)(slice);                                                     \
    float ax[LANES], ay[LANES], az[LANES];                                                                             \
    KERNEL_TAKE(own, KERNEL(in_turn), ax, ay, az)

KERNEL_TARGET static inline __attribute__((always_inline)) void
KERNEL(spring_sums)(const struct spring_rows *restrict rows, uint32_t slice, const float *restrict points,
                    float *restrict force, float *restrict energy)
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
                                         const float *restrict points, float *restrict force, double *restrict sum)
{
    float energy[LANES] = { 0 };
    KERNEL(spring_sums)(rows, slice, points, force, energy);
    for (int i = 0; i < LANES; i++)
        sum[i] += (double)energy[i];
}

KERNEL_TARGET void KERNEL(spring_product)(const struct spring_rows *restrict rows, uint32_t slice, float scale,
                                          const float *restrict diagonal, const float *restrict points,
                                          float *restrict out, double *restrict sum)
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

KERNEL_TARGET static inline __attribute__((always_inline)) float KERNEL(largest)(const float *restrict of)
{
    float eight[8], four[4];
    for (int i = 0; i < 8; i++)
        eight[i] = AT_LEAST(of[i], of[i + 8]);
    for (int i = 0; i < 4; i++)
        four[i] = AT_LEAST(eight[i], eight[i + 4]);
    const float one = AT_LEAST(four[0], four[2]), other = AT_LEAST(four[1], four[3]);
    return AT_LEAST(one, other);
}

KERNEL_TARGET static inline __attribute__((always_inline)) uint32_t KERNEL(any)(const uint32_t *restrict of)
{
    uint32_t any = 0;
    for (int i = 0; i < LANES; i++)
        any |= of[i];
    return any;
}

KERNEL_TARGET uint32_t KERNEL(spring_move)(const struct spring_motion *restrict motion,
                                           const struct spring_nodes *restrict nodes, const float *restrict force,
                                           const float *restrict load, const struct spring_slice *from,
                                           struct spring_slice *to, float *restrict points, float *restrict square)
{
    const float step = motion->step, scale = motion->scale, lead = motion->lead;
    const float far = motion->far, fast = motion->fast;
    const float before = motion->is_euler ? 1.0f : 0.0f, after = 1.0f - before;
    float keep[LANES], speed[LANES] = { 0 }, place[SPRING_ROWS];
    uint32_t bad[LANES] = { 0 };

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
            const float displacement = step * (before * v0 + after * v1) + from->rest[k];
            const float x0 = from->x[k], x1 = x0 + displacement;
            x[i] = x1;
            rest[i] = displacement - (x1 - x0);
            v[i] = v1;
            place[k] = x1 + lead * v1;
            speed[i] += v1 * v1;
            bad[i] |= (uint32_t) !(fabsf(x1) <= far) | (uint32_t) !(fabsf(v1) <= fast);
        }
        memcpy(to->x + row * LANES, x, sizeof x);
        memcpy(to->rest + row * LANES, rest, sizeof rest);
        memcpy(to->v + row * LANES, v, sizeof v);
    }
    KERNEL_PUT(points, place, place + LANES, place + 2 * LANES)
    *square = KERNEL(largest)(speed);
    return KERNEL(any)(bad);
}

/* How far coordinate k of lane i flies, m. */
#define SPRING_FLIGHT(k, i, common)                                                                                    \
    (trial->flies * system->glide[i] * (trial->step * (state->v[k] + trial->step * (common))))

/* The right-hand side of coordinate k of lane i. The node's flight is not a part of it. */
#define SPRING_RIGHT(k, i, gravity, common)                                                                            \
    (scale * force[k] + load[k] + system->mass[i] * (((gravity)-trial->flies * (common)) + rests * state->v[k]))

KERNEL_TARGET void KERNEL(spring_aim)(const struct spring_trial *restrict trial,
                                      const struct spring_slice *restrict state,
                                      const struct spring_system *restrict system, float *restrict points)
{
    float place[SPRING_ROWS];
    for (int row = 0; row < 3; row++) {
        const float common = trial->common[row];
        for (int i = 0; i < LANES; i++) {
            const int k = LANES * row + i;
            const float flown = SPRING_FLIGHT(k, i, common);
            place[k] = state->x[k] + (flown + trial->back * (flown * trial->per_step));
        }
    }
    KERNEL_PUT(points, place, place + LANES, place + 2 * LANES)
}

KERNEL_TARGET void KERNEL(spring_begin)(const struct spring_trial *restrict trial,
                                        const struct spring_slice *restrict state, const float *restrict force,
                                        const float *restrict load, struct spring_system *restrict system,
                                        float *restrict direction, double *restrict sum)
{
    const float scale = trial->scale, rests = (1.0f - trial->flies) * trial->per_step;
    float square[LANES] = { 0 }, first[SPRING_ROWS];

    for (int row = 0; row < 3; row++) {
        const float gravity = trial->gravity[row], common = trial->common[row];
        for (int i = 0; i < LANES; i++) {
            const int k = LANES * row + i;
            const float right = SPRING_RIGHT(k, i, gravity, common);
            system->residual[k] = right;
            system->change[k] = 0.0f;
            first[k] = system->per_diagonal[i] * right;
            square[i] += right * right;
        }
    }
    KERNEL_PUT(direction, first, first + LANES, first + 2 * LANES)
    for (int i = 0; i < LANES; i++)
        sum[i] += (double)(square[i] * system->per_diagonal[i]);
}

/*
 * Without lead, change . L change comes from change . A change, where A = diagonal + L. A change is known from the
 * solution: the right-hand side minus the residual.
 */
KERNEL_TARGET uint32_t KERNEL(spring_end)(const struct spring_trial *restrict trial,
                                          const struct spring_slice *restrict state, const float *restrict force,
                                          const float *restrict load, const struct spring_system *restrict system,
                                          struct spring_slice *restrict to, double *restrict bound,
                                          double *restrict work, float *restrict square)
{
    const float scale = trial->scale, per_step = trial->per_step;
    const float rests = (1.0f - trial->flies) * per_step;
    const float back = trial->back, curved = trial->has_lead ? 0.0f : 0.5f;
    const float far = trial->far, fast = trial->fast;
    float energy[LANES] = { 0 }, done[LANES] = { 0 }, speed[LANES] = { 0 };
    uint32_t bad[LANES] = { 0 };

    for (int row = 0; row < 3; row++) {
        const float gravity = trial->gravity[row], common = trial->common[row];
        for (int i = 0; i < LANES; i++) {
            const int k = LANES * row + i;
            const float change = system->change[k], x0 = state->x[k];
            const float flown = SPRING_FLIGHT(k, i, common);
            const float moved = flown + change, v1 = moved * per_step;
            const float displacement = moved + state->rest[k], x1 = x0 + displacement;
            const float right = SPRING_RIGHT(k, i, gravity, common);
            const float bend = change * (right - system->residual[k]) - change * change * system->diagonal[i];
            to->x[k] = x1;
            to->rest[k] = displacement - (x1 - x0);
            to->v[k] = v1;
            energy[i] += curved * bend - scale * force[k] * (change - back * (flown * per_step)) +
                         0.5f * system->mass[i] * (v1 * v1);
            done[i] += (load[k] + system->mass[i] * gravity) * moved;
            speed[i] += v1 * v1;
            bad[i] |= (uint32_t) !(fabsf(x1) <= far) | (uint32_t) !(fabsf(v1) <= fast);
        }
    }
    for (int i = 0; i < LANES; i++) {
        const float counts = system->mass[i] > 0.0f ? 1.0f : 0.0f;
        bound[i] += (double)(counts * energy[i]);
        work[i] += (double)(counts * done[i]);
    }
    *square = KERNEL(largest)(speed);
    return KERNEL(any)(bad);
}

KERNEL_TARGET void KERNEL(spring_descend)(float by, const float *restrict direction, const float *restrict product,
                                          struct spring_system *restrict system, double *restrict sum)
{
    float square[LANES] = { 0 }, along[SPRING_ROWS];
    KERNEL_TAKE(direction, KERNEL(in_turn), along, along + LANES, along + 2 * LANES)
    for (int k = 0; k < SPRING_ROWS; k++) {
        system->change[k] += by * along[k];
        system->residual[k] -= by * product[k];
    }
    for (int row = 0; row < 3; row++)
        for (int i = 0; i < LANES; i++)
            square[i] += system->residual[row * LANES + i] * system->residual[row * LANES + i];
    for (int i = 0; i < LANES; i++)
        sum[i] += (double)(square[i] * system->per_diagonal[i]);
}

KERNEL_TARGET void KERNEL(spring_turn)(float by, const struct spring_system *restrict system, float *restrict direction)
{
    float last[SPRING_ROWS], next[SPRING_ROWS];
    KERNEL_TAKE(direction, KERNEL(in_turn), last, last + LANES, last + 2 * LANES)
    for (int row = 0; row < 3; row++)
        for (int i = 0; i < LANES; i++) {
            const int k = row * LANES + i;
            next[k] = system->per_diagonal[i] * system->residual[k] + by * last[k];
        }
    KERNEL_PUT(direction, next, next + LANES, next + 2 * LANES)
}

KERNEL_TARGET void KERNEL(spring_points)(const struct spring_slice *restrict slice, float lead, float *restrict points)
{
    float place[SPRING_ROWS];
    for (int k = 0; k < SPRING_ROWS; k++)
        place[k] = slice->x[k] + lead * slice->v[k];
    KERNEL_PUT(points, place, place + LANES, place + 2 * LANES)
}

KERNEL_TARGET void KERNEL(spring_follow)(const float *restrict points, const uint32_t *restrict nodes,
                                         const float *restrict weights, float *restrict to)
{
    for (int i = 0; i < LANES; i++)
        KERNEL_WEIGH(points, nodes + 4 * i, weights + 4 * i, to + 3 * i)
    to[3 * LANES] = 0.0f;
}
