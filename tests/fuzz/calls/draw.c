/* SPDX-License-Identifier: BSD-3-Clause */
/* Random arguments, and what headers say of them. */
#include "fuzz/calls/calls.h"

uint64_t draw_bits(void)
{
    return random_bits(&run.random);
}

uint32_t draw_below(uint32_t count)
{
    return (uint32_t)((draw_bits() >> 32) * count >> 32);
}

int draw_one_in(uint32_t count)
{
    return draw_below(count) == 0;
}

double draw_in(double low, double high)
{
    return random_in(&run.random, low, high);
}

double draw_odd_number(void)
{
    const double numbers[] = { NAN, -NAN, INFINITY, -INFINITY, 1e300,  -1e300, 1e60, -1e7, 2e6,  1.000001e6,
                               1e6, -1e6, 0.0,      -0.0,      1e-310, 1e-200, -1.0, 1e-9, 1e30, -1e-9 };
    return numbers[draw_below(sizeof numbers / sizeof *numbers)];
}

static void draw_turn(double q[4])
{
    double square;
    do {
        square = 0.0;
        for (int k = 0; k < 4; k++) {
            q[k] = draw_in(-1.0, 1.0);
            square += q[k] * q[k];
        }
    } while (square < 0.01 || square > 1.0);
    for (int k = 0; k < 4; k++)
        q[k] /= sqrt(square);
}

/* A small turn of what is of unit length. */
static void turn_a_little(double q[4], double angle)
{
    double square = 0.0;
    for (int k = 0; k < 4; k++) {
        q[k] += angle * draw_in(-1.0, 1.0);
        square += q[k] * q[k];
    }
    for (int k = 0; k < 4 && square > 0.0; k++)
        q[k] /= sqrt(square);
}

static void spoil_pose(dpt_pose *pose)
{
    switch (draw_below(5)) {
    case 0:
        pose->position[draw_below(3)] = draw_odd_number();
        break;
    case 1:
        pose->orientation[draw_below(4)] = draw_odd_number();
        break;
    case 2: /* of unit length within 1e-6, and not */
        for (int k = 0; k < 4; k++)
            pose->orientation[k] *= 1.0 + 4e-7;
        break;
    case 3:
        for (int k = 0; k < 4; k++)
            pose->orientation[k] *= 1.0 + 1e-5;
        break;
    default:
        memset(pose->orientation, 0, sizeof pose->orientation);
    }
}

dpt_pose draw_pose(const dpt_pose *near)
{
    dpt_pose pose = DPT_POSE_IDENTITY;
    const uint32_t kind = draw_below(16);
    if (near && kind < 12) {
        const double step = kind < 4 ? 0.0005 : kind < 9 ? 0.005 : 0.05;
        pose = *near;
        for (int k = 0; k < 3; k++)
            pose.position[k] += draw_in(-step, step);
        if (kind % 2)
            turn_a_little(pose.orientation, 4.0 * step);
    } else {
        const double far = kind == 15 ? 1e5 : 0.12;
        for (int k = 0; k < 3; k++)
            pose.position[k] = draw_in(-far, far);
        if (kind % 2)
            draw_turn(pose.orientation);
    }
    if (draw_one_in(24))
        spoil_pose(&pose);
    return pose;
}

static int is_coordinate(double x)
{
    return fabs(x) <= DPT_COORDINATE_MAX; /* no NaN is */
}

void pose_codes(const dpt_pose *pose, struct codes *codes)
{
    const double *q = pose->orientation;
    const double size = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int k = 0; k < 3; k++)
        if (!is_coordinate(pose->position[k])) {
            may_fail(codes, 1, DPT_E_FINITE);
            break;
        }
    may_fail(codes, !(fabs(size - 1.0) <= 1e-6), DPT_E_POSE);
    may_fail(codes, !isfinite(size), DPT_E_FINITE);
}

dpt_segment draw_segment(void)
{
    dpt_segment segment = { .radius = 0.0 };
    const uint32_t kind = draw_below(16);
    const double reach = kind == 15 ? 1e3 : 0.1;
    const double length = kind == 14 ? 2.0 : kind < 5 ? 0.01 : 0.08;
    for (int k = 0; k < 3; k++) {
        segment.a[k] = draw_in(-reach, reach);
        segment.b[k] = segment.a[k] + (kind == 13 ? 0.0 : draw_in(-length, length));
    }
    if (kind % 3)
        segment.radius = draw_in(0.0, kind == 12 ? 0.2 : 0.01);
    if (draw_one_in(40)) {
        double *numbers[] = { segment.a, segment.b, &segment.radius };
        numbers[draw_below(3)][0] = draw_odd_number();
    }
    return segment;
}

void segment_codes(const dpt_segment *segment, struct codes *codes)
{
    int is_wrong = !(segment->radius >= 0.0 && is_coordinate(segment->radius));
    for (int k = 0; k < 3; k++)
        is_wrong |= !is_coordinate(segment->a[k]) || !is_coordinate(segment->b[k]);
    may_fail(codes, is_wrong, DPT_E_FINITE);
}

uint32_t draw_size(size_t first, size_t today)
{
    const uint32_t low = (uint32_t)first, high = (uint32_t)today;
    const uint32_t odd[] = { low,
                             high + 8,
                             high + 8,
                             high + 64,
                             0,
                             4,
                             low - 8,
                             low - 4,
                             high + 4,
                             high + 1,
                             4096,
                             4104,
                             4097,
                             low - 1,
                             UINT32_MAX,
                             (uint32_t)draw_bits(),
                             draw_below(high + 32) };
    return draw_one_in(8) ? odd[draw_below(sizeof odd / sizeof *odd)] : high;
}

enum { STRUCT_SIZE_MAX = 4096 };

void size_codes_of_output(uint32_t size, size_t first, int stride, struct codes *codes)
{
    may_fail(codes, size < first || size > STRUCT_SIZE_MAX || (stride && size % 8), DPT_E_SIZE);
}

const void *draw_input(int slot, const void *good, uint32_t size, size_t first, size_t today, struct codes *codes)
{
    const int is_size = size >= first && size <= STRUCT_SIZE_MAX;
    const int is_zero = size <= today || draw_one_in(2);
    may_fail(codes, !is_size, DPT_E_SIZE);
    may_fail(codes, is_size && !is_zero, DPT_E_UNSUPPORTED);
    unsigned char *given = output_sized(slot, size);
    const size_t own = size < sizeof size ? sizeof size : size > STRUCT_SIZE_MAX ? 8 : size;
    const size_t known = own < today ? own : today;
    if (known > sizeof size)
        memcpy(given + sizeof size, (const unsigned char *)good + sizeof size, known - sizeof size);
    if (is_size && size > today) {
        memset(given + today, 0, size - today);
        if (!is_zero)
            given[today + draw_below((uint32_t)(size - today))] = 1;
    }
    return given;
}
