/* SPDX-License-Identifier: BSD-3-Clause */
/* The loops for the winding number (docs/algorithms/winding.md): a part of kernel_body.h, for each instruction set. */

/*
 * The winding of sets of triangles, by a multipole series: area vector, quadrupole, octupole. The octupole is
 * traceless, so 7 numbers hold it. e is the unit direction to a set, `per` is 1 / distance; the rows contain all
 * factors.
 */
KERNEL_TARGET uint32_t KERNEL(moments)(const float *restrict block, const float *restrict at, float max_error,
                                       float *restrict winding, float *restrict error_sum)
{
    const float ax = at[0], ay = at[1], az = at[2], limit = -max_error;
    float bound[LANES];

    for (int i = 0; i < LANES; i++) {
        const float *row = block + i;
        float dx = row[3 * LANES] - ax, dy = row[4 * LANES] - ay, dz = row[5 * LANES] - az;
        float square = AT_LEAST(dx * dx + dy * dy + dz * dz, 0x1p-50f);
        float distance = sqrtf(square), per = 1.0f / distance;
        float ex = dx * per, ey = dy * per, ez = dz * per;
        float xx = ex * ex, yy = ey * ey, zz = ez * ez;
        float area = row[0] * ex + row[LANES] * ey + row[2 * LANES] * ez;
        float quad = row[6 * LANES] * (xx - zz) + row[7 * LANES] * (yy - zz) + row[8 * LANES] * (ex * ey) +
                     row[9 * LANES] * (ex * ez) + row[10 * LANES] * (ey * ez);
        float along_x = row[11 * LANES] * (xx - 3.0f * zz) + row[14 * LANES] * (yy - zz);
        float along_y = row[12 * LANES] * (yy - 3.0f * zz) + row[13 * LANES] * (xx - zz);
        float along_z = row[15 * LANES] * (3.0f * xx - zz) + row[16 * LANES] * (3.0f * yy - zz);
        float oct = along_x * ex + along_y * ey + along_z * ez + row[17 * LANES] * (ex * ey * ez);
        float turns = (per * per) * (area + per * (quad + per * oct));

        float radius = row[19 * LANES], gap = AT_LEAST(distance - radius, 0.0f);
        float error = row[18 * LANES] * (distance + 3.0f * gap) * (per * per) * (per * per) / (gap * gap);
        float counts = error < max_error ? 1.0f : 0.0f;
        winding[i] += counts * turns;
        error_sum[i] += counts * AT_MOST(error, max_error);
        bound[i] = -error;
    }
    return KERNEL_OPEN(bound, limit);
}

/* Coefficients of atan(t) / (2 pi t) in powers of t^2, fitted at the Chebyshev points of 0..1. */
#define ATAN_0 0.159154817f
#define ATAN_1 -0.0530394651f
#define ATAN_2 0.0316273347f
#define ATAN_3 -0.0214029402f
#define ATAN_4 0.0132299857f
#define ATAN_5 -0.00578694232f
#define ATAN_6 0.0012172733f

/*
 * Van Oosterom and Strackee 1983: the tangent of half the solid angle is a.(b x c) over |a||b||c| (1 + cos ab + cos bc
 * + cos ca). While the denominator is not small, an arctangent of 0..1 suffices. The polynomial for it is off by at
 * most 1e-7 turns.
 */
KERNEL_TARGET uint32_t KERNEL(angles)(const float *restrict block, const float *restrict at, uint32_t lanes,
                                      float *restrict winding)
{
    const float x = at[0], y = at[1], z = at[2];
    float bound[LANES], counts[LANES];

    for (int i = 0; i < LANES; i++)
        counts[i] = lanes & KERNEL(bit)[i] ? 1.0f : 0.0f;
    for (int i = 0; i < LANES; i++) {
        const float *row = block + i;
        float ax = row[0] - x, ay = row[LANES] - y, az = row[2 * LANES] - z;
        float bx = row[3 * LANES] - x, by = row[4 * LANES] - y, bz = row[5 * LANES] - z;
        float cx = row[6 * LANES] - x, cy = row[7 * LANES] - y, cz = row[8 * LANES] - z;
        float aa = ax * ax + ay * ay + az * az, bb = bx * bx + by * by + bz * bz;
        float cc = cx * cx + cy * cy + cz * cz, nearest = AT_MOST(AT_MOST(aa, bb), cc);
        float a = sqrtf(aa), b = sqrtf(bb), c = sqrtf(cc);
        float volume = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
        float size = a * b * c;
        float sides = size + (ax * bx + ay * by + az * bz) * c + (bx * cx + by * cy + bz * cz) * a +
                      (cx * ax + cy * ay + cz * az) * b;
        float excess = sides - KERNEL_ANGLE_OPEN * size;
        excess = nearest > KERNEL_ANGLE_NEAR ? excess : 0.0f;
        float height = fabsf(volume);
        float low = AT_MOST(height, sides), high = AT_LEAST(height, sides);
        float t = low / high, w = t * t;
        float angle =
            t * (ATAN_0 + w * (ATAN_1 + w * (ATAN_2 + w * (ATAN_3 + w * (ATAN_4 + w * (ATAN_5 + w * ATAN_6))))));
        angle = height > sides ? 0.25f - angle : angle;
        angle = volume < 0.0f ? -angle : angle;
        winding[i] += excess > 0.0f ? counts[i] * angle : 0.0f;
        bound[i] = excess;
    }
    return KERNEL_OPEN(bound, 0.0f) & lanes;
}
