/* SPDX-License-Identifier: BSD-3-Clause */
/* Arms: what they tell, in and out of range; their kinematics, of numbers good and bad. */
#include "fuzz/calls/calls.h"

struct asked {
    const struct arm_subject *subject;
    const dpt_arm *arm;
    int no_out;
    struct codes codes;
};

static struct asked draw_arm(void)
{
    struct asked of = { .subject = &arm_subjects[draw_below(ARMS)], .no_out = draw_one_in(40) };
    const int no_arm = draw_one_in(40);
    of.arm = no_arm ? NULL : of.subject->arm;
    may_fail(&of.codes, no_arm || of.no_out, DPT_E_ARGUMENT);
    return of;
}

static void info(void)
{
    struct asked of = draw_arm();
    dpt_arm_info now;
    const size_t first = offsetof(dpt_arm_info, jaws);
    const uint32_t size = draw_size(first, sizeof now);
    void *out = output_sized(0, size);
    if (!of.no_out)
        size_codes_of_output(size, first, 0, &of.codes);
    const dpt_result result = RESULT(dpt_arm_get_info, of.arm, of.no_out ? NULL : out);
    expect(result, &of.codes);
    outputs_are_guarded(0, 1);
    if (result != DPT_OK || !output_read(0, size, sizeof now, sizeof now, &now))
        return;
    numbers_are_finite(&now.mass, 8, "mass and tool");
    HOLDS(now.joints == of.subject->joints && now.links == of.subject->links && now.segments == of.subject->segments &&
              now.bodies == of.subject->bodies && now.tool_link < now.links && memchr(now.name, 0, sizeof now.name),
          "%u joints, %u links", now.joints, now.links);
}

/* A joint, a link, a body or a segment by its number. */
static void item(void)
{
    struct asked of = draw_arm();
    const int kind = (int)draw_below(7);
    const uint32_t counts[] = { of.subject->joints, of.subject->links,     of.subject->bodies, of.subject->segments,
                                of.subject->jaws,   of.subject->jaw_links, of.subject->tips };
    const size_t todays[] = { sizeof(dpt_arm_joint), sizeof(dpt_arm_link), sizeof(dpt_arm_body), sizeof(dpt_segment),
                              sizeof(dpt_arm_joint), sizeof(dpt_arm_link), sizeof(dpt_arm_tip) };
    const uint32_t index = draw_one_in(8) ? (uint32_t)draw_bits() >> draw_below(32) : draw_below(counts[kind] + 1);
    const size_t today = todays[kind];
    const uint32_t size = draw_size(today, today);
    void *out = kind == 3 ? output_of(0, today) : output_sized(0, size);
    may_fail(&of.codes, index >= counts[kind], DPT_E_ARGUMENT);
    if (!of.no_out && kind != 3)
        size_codes_of_output(size, today, 0, &of.codes);
    call_with("number %llu of %llu, size %llu", index, counts[kind], size, 0);
    out = of.no_out ? NULL : out;
    const dpt_result result = kind == 0   ? RESULT(dpt_arm_get_joint, of.arm, index, out)
                              : kind == 1 ? RESULT(dpt_arm_get_link, of.arm, index, out)
                              : kind == 2 ? RESULT(dpt_arm_get_body, of.arm, index, out)
                              : kind == 4 ? RESULT(dpt_arm_get_jaw, of.arm, index, out)
                              : kind == 5 ? RESULT(dpt_arm_get_jaw_link, of.arm, index, out)
                              : kind == 6 ? RESULT(dpt_arm_get_tip, of.arm, index, out)
                                          : RESULT(dpt_arm_get_segment, of.arm, index, out);
    expect(result, &of.codes);
    outputs_are_guarded(0, 1);
    if (result != DPT_OK)
        HOLDS(output_is_untouched(0, kind == 3 ? 0 : sizeof size), "written on an error");
    else if (kind == 3)
        numbers_are_finite(out, 7, "a segment");
}

static void draw_numbers(double *numbers, uint32_t count, struct codes *codes)
{
    const double scale = draw_one_in(6) ? 1e6 : 3.0;
    for (uint32_t i = 0; i < count; i++)
        numbers[i] = draw_in(-scale, scale);
    if (draw_one_in(8) && count)
        numbers[draw_below(count)] = draw_odd_number();
    for (uint32_t i = 0; i < count; i++)
        may_fail(codes, !(fabs(numbers[i]) <= DPT_COORDINATE_MAX), DPT_E_FINITE);
}

/* Nothing is written on an error. */
static void answers(dpt_result result, const struct codes *codes, int slots)
{
    expect(result, codes);
    outputs_are_guarded(0, slots);
    for (int slot = 0; slot < slots; slot++)
        HOLDS(result == DPT_OK || output_is_untouched(slot, 0), "written on an error");
}

static void kinematics(void)
{
    struct asked of = draw_arm();
    const uint32_t n = of.subject->joints;
    double joints[DPT_JOINTS_MAX], other[6 + DPT_JOINTS_MAX];
    const int kind = (int)draw_below(5), no_joints = draw_one_in(40), no_other = draw_one_in(40);
    may_fail(&of.codes, no_joints, DPT_E_ARGUMENT);
    draw_numbers(joints, n, &of.codes);
    const double *given = no_joints ? NULL : joints;
    if (kind == 0) {
        dpt_pose *out = output_of(0, sizeof *out);
        answers(RESULT(dpt_arm_forward, of.arm, given, of.no_out ? NULL : out), &of.codes, 1);
        if (!of.codes.count) {
            double square = 0.0;
            numbers_are_finite(out->position, 7, "a pose");
            for (int k = 0; k < 4; k++)
                square += out->orientation[k] * out->orientation[k];
            HOLDS(fabs(square - 1.0) < 1e-9, "an orientation of length %g", sqrt(square));
        }
    } else if (kind == 1) {
        double *velocity = output_of(0, 24), *spin = output_of(1, 24);
        may_fail(&of.codes, no_other, DPT_E_ARGUMENT);
        draw_numbers(other, n, &of.codes);
        answers(RESULT(dpt_arm_velocity, of.arm, given, no_other ? NULL : other, of.no_out ? NULL : velocity, spin),
                &of.codes, 2);
        if (!of.codes.count) {
            numbers_are_finite(velocity, 3, "a velocity");
            numbers_are_finite(spin, 3, "a spin");
        }
    } else if (kind == 2) {
        double *out = output_of(0, 6 * n * sizeof *out);
        answers(RESULT(dpt_arm_jacobian, of.arm, given, of.no_out ? NULL : out), &of.codes, 1);
        if (!of.codes.count)
            numbers_are_finite(out, 6 * n, "a Jacobian");
    } else if (kind == 3) {
        dpt_wrench wrench;
        double *out = output_of(0, n * sizeof *out);
        may_fail(&of.codes, no_other, DPT_E_ARGUMENT);
        draw_numbers(wrench.force, 3, &of.codes);
        draw_numbers(wrench.torque, 3, &of.codes);
        answers(RESULT(dpt_arm_efforts, of.arm, given, no_other ? NULL : &wrench, of.no_out ? NULL : out), &of.codes,
                1);
        if (!of.codes.count)
            numbers_are_finite(out, n, "efforts");
    } else {
        double *out = output_of(0, n * sizeof *out);
        may_fail(&of.codes, no_other, DPT_E_ARGUMENT);
        draw_numbers(other, 3, &of.codes);
        answers(RESULT(dpt_arm_weight, of.arm, given, no_other ? NULL : other, of.no_out ? NULL : out), &of.codes, 1);
        if (!of.codes.count)
            numbers_are_finite(out, n, "efforts");
    }
}

/* Where a tip is, by its jaws. */
static void tip_pose(void)
{
    struct asked of = draw_arm();
    const uint32_t index = draw_below(of.subject->tips + 1), n = of.subject->jaws;
    double jaws[DPT_JOINTS_MAX];
    const int no_jaws = draw_one_in(40);
    may_fail(&of.codes, index >= of.subject->tips || (no_jaws && n), DPT_E_ARGUMENT);
    draw_numbers(jaws, n, &of.codes);
    dpt_pose *out = output_of(0, sizeof *out);
    answers(RESULT(dpt_arm_tip_pose, of.arm, index, no_jaws ? NULL : jaws, of.no_out ? NULL : out), &of.codes, 1);
    if (!of.codes.count)
        numbers_are_finite(out->position, 7, "a tip's pose");
}

static void refuse_null(void)
{
    const dpt_arm *arm;
    const struct arm_subject *subject = &arm_subjects[draw_below(ARMS)];
    HOLDS(RESULT(dpt_arm_open, subject->bytes, subject->size, NULL) == DPT_E_ARGUMENT, "nowhere");
    HOLDS(RESULT(dpt_arm_open, subjects[0].bytes, subjects[0].size, &arm) == DPT_E_MAGIC, "a mesh is no arm");
    HOLDS(RESULT(dpt_arm_open, subject->bytes, subject->size, &arm) == DPT_OK && arm == subject->arm,
          "a pointer into the bytes");
}

static const struct move moves[] = { { "info", info, 2 },
                                     { "item", item, 5 },
                                     { "kinematics", kinematics, 8 },
                                     { "tip pose", tip_pose, 4 },
                                     { "refuse NULL", refuse_null, 1 },
                                     { NULL, NULL, 0 } };

const struct noun arm_noun = { "arm", NULL, NULL, moves };
