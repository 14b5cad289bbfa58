/* SPDX-License-Identifier: BSD-3-Clause */
#include "compile/moments.h"

#include <string.h>

#include "base/angle.h"
#include "mesh/mesh_format.h"

#define PER_SPHERE (1.0 / (2.0 * ANGLE_TURN)) /* 1 / (4 pi) */

/* The axes of each component, and the component of a pair of axes. */
static const uint8_t quad_axes[6][2] = { { 0, 0 }, { 1, 1 }, { 2, 2 }, { 0, 1 }, { 0, 2 }, { 1, 2 } };
static const uint8_t oct_axes[10][3] = { { 0, 0, 0 }, { 1, 1, 1 }, { 2, 2, 2 }, { 0, 0, 1 }, { 0, 0, 2 },
                                         { 1, 1, 0 }, { 1, 1, 2 }, { 2, 2, 0 }, { 2, 2, 1 }, { 0, 1, 2 } };
static const uint8_t quad_at[3][3] = { { 0, 3, 4 }, { 3, 1, 5 }, { 4, 5, 2 } };

static double trace_of(const double tensor[6])
{
    return tensor[0] + tensor[1] + tensor[2];
}

/* At least the integral of |u|^3, by Cauchy and Schwarz. It scales the bound of the remainder. */
static double cubic_bound(const struct winding_moment *m)
{
    return sqrt(trace_of(m->second) * m->fourth);
}

struct winding_moment moment_of_triangle(vec3 a, vec3 b, vec3 c)
{
    struct winding_moment m = { .area = 0.0 };
    m.area_vector = scaled(cross(sub(b, a), sub(c, a)), 0.5);
    m.area = length(m.area_vector);
    m.centroid = scaled(add(add(a, b), c), 1.0 / 3.0);
    const double n[3] = { m.area_vector.x, m.area_vector.y, m.area_vector.z };
    const vec3 corners[3] = { sub(a, m.centroid), sub(b, m.centroid), sub(c, m.centroid) };
    double second[6] = { 0.0 }, largest_square = 0.0;
    for (int k = 0; k < 3; k++) {
        const double u[3] = { corners[k].x, corners[k].y, corners[k].z };
        for (int i = 0; i < 6; i++)
            second[i] += u[quad_axes[i][0]] * u[quad_axes[i][1]] / 12.0;
        double corner_square = dot(corners[k], corners[k]);
        for (int i = 0; i < 3; i++)
            m.third[i] += m.area * corner_square * u[i] / 30.0;
        largest_square = max_of(largest_square, corner_square);
    }
    for (int k = 0; k < 10; k++) {
        int x = oct_axes[k][0], y = oct_axes[k][1], z = oct_axes[k][2];
        m.oct[k] = (n[x] * second[quad_at[y][z]] + n[y] * second[quad_at[x][z]] + n[z] * second[quad_at[x][y]]) / 3.0;
    }
    for (int i = 0; i < 6; i++)
        m.second[i] = m.area * second[i];
    m.radius = sqrt(largest_square);
    m.fourth = largest_square * trace_of(m.second); /* an upper bound */
    return m;
}

/* Add a set. `shift` is its centroid less the common one; its tensors are moved to the common centroid. */
static void add_set(struct winding_moment *sum, const struct winding_moment *set, vec3 shift)
{
    const double n[3] = { set->area_vector.x, set->area_vector.y, set->area_vector.z };
    const double s[3] = { shift.x, shift.y, shift.z };
    const double shift_square = dot(shift, shift), spread = trace_of(set->second);
    for (int k = 0; k < 6; k++) {
        int x = quad_axes[k][0], y = quad_axes[k][1];
        sum->quad[k] += set->quad[k] + 0.5 * (n[x] * s[y] + n[y] * s[x]);
        sum->second[k] += set->second[k] + set->area * s[x] * s[y];
    }
    for (int k = 0; k < 10; k++) {
        int x = oct_axes[k][0], y = oct_axes[k][1], z = oct_axes[k][2];
        sum->oct[k] +=
            set->oct[k] +
            2.0 / 3.0 *
                (set->quad[quad_at[x][y]] * s[z] + set->quad[quad_at[x][z]] * s[y] + set->quad[quad_at[y][z]] * s[x]) +
            (n[x] * s[y] * s[z] + n[y] * s[x] * s[z] + n[z] * s[x] * s[y]) / 3.0;
    }
    double along_s = 0.0, third = 0.0;
    for (int i = 0; i < 3; i++) {
        double second_s = 0.0;
        for (int j = 0; j < 3; j++)
            second_s += set->second[quad_at[i][j]] * s[j];
        sum->third[i] += set->third[i] + 2.0 * second_s + (spread + set->area * shift_square) * s[i];
        along_s += second_s * s[i];
        third += set->third[i] * s[i];
    }
    sum->fourth += set->fourth + 4.0 * third + 4.0 * along_s + 2.0 * shift_square * spread +
                   set->area * shift_square * shift_square;
    sum->radius = max_of(sum->radius, sqrt(shift_square) + set->radius);
}

struct winding_moment moment_of_sets(const struct winding_moment *sets, uint32_t count)
{
    struct winding_moment sum = { .area = 0.0 };
    for (uint32_t i = 0; i < count; i++) {
        sum.area_vector = add(sum.area_vector, sets[i].area_vector);
        sum.area += sets[i].area;
        sum.centroid = along(sum.centroid, sets[i].area, sets[i].centroid);
    }
    if (!(sum.area > 0.0))
        return (struct winding_moment){ .area = 0.0 };
    sum.centroid = scaled(sum.centroid, 1.0 / sum.area);
    for (uint32_t i = 0; i < count; i++)
        if (sets[i].area > 0.0)
            add_set(&sum, &sets[i], sub(sets[i].centroid, sum.centroid));
    return sum;
}

/*
 * The bound of the remainder. The term of degree l is the gradient of a solid harmonic. For a unit of area at distance
 * r from the centroid it is at most l r^(l-1) / d^(l+1) (Bernstein's inequality). From l = 4 on the terms add up to r^3
 * (4 - 3 t) / (d^5 (1 - t)^2) with t = r / d, and r^3 is at most radius r^2.
 */
double moment_winding(const struct winding_moment *m, vec3 x, double *error)
{
    vec3 d = sub(m->centroid, x);
    double distance = length(d), gap = distance - m->radius;
    *error = m->area > 0.0 ? HUGE_VAL : 0.0;
    if (!(gap > 0.0) || !(m->area > 0.0))
        return 0.0;
    double inverse = 1.0 / distance;
    *error = PER_SPHERE * cubic_bound(m) * (distance + 3.0 * gap) * inverse * inverse * inverse * inverse / (gap * gap);
    const double e[3] = { d.x * inverse, d.y * inverse, d.z * inverse };
    const double *q = m->quad, *o = m->oct;
    double area = dot(m->area_vector, d) * inverse;
    double quad = -3.0 * (q[0] * e[0] * e[0] + q[1] * e[1] * e[1] + q[2] * e[2] * e[2] +
                          2.0 * (q[3] * e[0] * e[1] + q[4] * e[0] * e[2] + q[5] * e[1] * e[2])) +
                  q[0] + q[1] + q[2];
    double cubic = 6.0 * o[9] * e[0] * e[1] * e[2];
    for (int k = 0; k < 9; k++) {
        const uint8_t *axis = oct_axes[k];
        cubic += (k < 3 ? 1.0 : 3.0) * o[k] * e[axis[0]] * e[axis[1]] * e[axis[2]];
    }
    double trace = (o[0] + o[5] + o[7]) * e[0] + (o[1] + o[3] + o[8]) * e[1] + (o[2] + o[4] + o[6]) * e[2];
    double oct = 7.5 * cubic - 4.5 * trace;
    return PER_SPHERE * inverse * inverse * (area + inverse * (quad + inverse * oct));
}

/* The trace of a tensor adds nothing to a harmonic field. Without it, one component less is stored for each axis. */
void moment_store(const struct winding_moment *m, float *block)
{
    const double *q = m->quad, *o = m->oct;
    const double third = (q[0] + q[1] + q[2]) / 3.0;
    const double tx = (o[0] + o[5] + o[7]) / 5.0, ty = (o[1] + o[3] + o[8]) / 5.0, tz = (o[2] + o[4] + o[6]) / 5.0;
    const double rows[MESH_MOMENT_ROWS] = {
        PER_SPHERE * m->area_vector.x,
        PER_SPHERE * m->area_vector.y,
        PER_SPHERE * m->area_vector.z,
        m->centroid.x,
        m->centroid.y,
        m->centroid.z,
        PER_SPHERE * -3.0 * (q[0] - third),
        PER_SPHERE * -3.0 * (q[1] - third),
        PER_SPHERE * -6.0 * q[3],
        PER_SPHERE * -6.0 * q[4],
        PER_SPHERE * -6.0 * q[5],
        PER_SPHERE * 7.5 * (o[0] - 3.0 * tx),
        PER_SPHERE * 7.5 * (o[1] - 3.0 * ty),
        PER_SPHERE * 22.5 * (o[3] - ty),
        PER_SPHERE * 22.5 * (o[5] - tx),
        PER_SPHERE * 7.5 * (o[4] - tz),
        PER_SPHERE * 7.5 * (o[6] - tz),
        PER_SPHERE * 45.0 * o[9],
        PER_SPHERE * cubic_bound(m),
        m->area > 0.0 ? m->radius : -1.0,
    };
    for (int k = 0; k < MESH_MOMENT_ROWS; k++)
        block[k * LANES] = (float)rows[k];
}
