/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Observers of passivity: whatever moves and is asked, the wrench is what was asked for or zero, and the account stays
 * above -2 eps while what is sent is what was allowed and within the limits.
 */
#include "fuzz/calls/calls.h"

/* One observer, and what the game knows of it. */
static struct {
    dpt_passivity at;
    int is_made;
    int is_bounded; /* no slew behind it and no delay, and all that was sent was allowed */
    dpt_passivity_def def;
    dpt_pose pose;
    dpt_wrench allowed;
} own;

static void draw_def(dpt_passivity_def *def)
{
    CALL(dpt_passivity_def_defaults, def, sizeof *def);
    double *const fields = &def->damping;
    const double usual[] = { 1.0, 0.01, 5.0, 0.2, 1e3, 10.0, 2e-3, 0.01, 1.0 };
    for (int i = 0; i < 9; i++)
        if (draw_one_in(3))
            fields[i] = draw_one_in(2) ? 0.0 : draw_in(0.0, usual[i]);
    if (draw_one_in(2))
        def->force_slew = def->torque_slew = def->delay = 0.0;
    if (draw_one_in(12))
        fields[draw_below(9)] = draw_odd_number();
    def->observe_only = draw_one_in(30) ? 2u : (uint32_t)draw_one_in(5);
}

static int def_is_wrong(const dpt_passivity_def *def)
{
    const double *const fields = &def->damping;
    const double most[] = { 1e6, 1e6, 1e3, 1e3, 1.79e308, 1.79e308, 10.0, 1.0, 1e3 };
    int is_wrong = def->observe_only > 1;
    for (int i = 0; i < 9; i++)
        is_wrong |= !(fields[i] >= 0.0 && fields[i] <= most[i]);
    return is_wrong;
}

static void init(void)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    struct codes codes = { .count = 0 };
    const int no_def = draw_one_in(4), no_one = draw_one_in(30);
    const void *given = NULL;
    dpt_passivity_def def;
    draw_def(&def);
    if (!no_one)
        own.at.size = draw_one_in(20) ? draw_below(sizeof own.at) : sizeof own.at;
    may_fail(&codes, no_one, DPT_E_ARGUMENT);
    may_fail(&codes, !no_one && own.at.size < sizeof own.at, DPT_E_SIZE);
    if (!no_def) {
        given = draw_input(1, &def, draw_size(sizeof def, sizeof def), sizeof def, sizeof def, &codes);
        may_fail(&codes, def_is_wrong(&def), DPT_E_ARGUMENT);
    } else {
        CALL(dpt_passivity_def_defaults, &def, sizeof def);
    }
    const dpt_result result = RESULT(dpt_passivity_init, no_one ? NULL : &own.at, given);
    expect(result, &codes);
    outputs_are_guarded(1, 1);
    if (no_one)
        return;
    own.def = def;
    own.is_made = result == DPT_OK;
    own.is_bounded = own.is_made && own.def.force_slew == 0.0 && own.def.torque_slew == 0.0 && own.def.delay < 1e-4 &&
                     !own.def.observe_only;
    own.pose = identity;
    memset(&own.allowed, 0, sizeof own.allowed);
}

static void draw_wrench(dpt_wrench *wrench)
{
    for (int k = 0; k < 3; k++) {
        wrench->force[k] = draw_in(-0.57, 0.57) * own.def.force_max;
        wrench->torque[k] = draw_in(-0.57, 0.57) * own.def.torque_max;
    }
    if (draw_one_in(20))
        wrench->force[draw_below(3)] = draw_odd_number();
}

static int wrench_is_sound(const dpt_wrench *wrench)
{
    int is_sound = 1;
    for (int k = 0; k < 3; k++)
        is_sound &= fabs(wrench->force[k]) <= 1e9 && fabs(wrench->torque[k]) <= 1e9;
    return is_sound;
}

static double size_of(const double *v)
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* The account's promise, as long as the game kept its part. */
static void must_be_bounded(void)
{
    dpt_passivity_info info = { .size = sizeof info };
    HOLDS(RESULT(dpt_passivity_get_info, &own.at, &info) == DPT_OK, "info");
    numbers_are_finite(&info.account, 6, "an observer");
    HOLDS(!own.is_bounded || info.account_min >= -2.0 * info.eps - 1e-8, "%g J, eps %g", info.account_min, info.eps);
    game_digest(&info, sizeof info);
}

static void step_once(void)
{
    static const dpt_wrench zero;
    struct codes codes = { .count = 0 };
    const int no_wrench = draw_one_in(40), no_one = draw_one_in(40);
    const dpt_pose pose = draw_pose(&own.pose);
    dpt_passivity_sample sample = { .size = sizeof sample,
                                    .dt = draw_one_in(30) ? draw_odd_number() : 1e-3,
                                    .energy = draw_in(0.0, 0.01),
                                    .body_work = draw_in(-1e-3, 1e-3),
                                    .pose = pose,
                                    .sent = own.allowed };
    if (draw_one_in(20))
        draw_wrench(&sample.sent);
    dpt_wrench asked, wrench;
    draw_wrench(&asked);
    wrench = asked;
    const void *given =
        draw_input(1, &sample, draw_size(sizeof sample, sizeof sample), sizeof sample, sizeof sample, &codes);
    const int is_taken = codes.count == 0;
    may_fail(&codes, no_wrench || no_one || !own.is_made, DPT_E_ARGUMENT);
    may_fail(&codes, !(sample.dt >= 1e-9 && sample.dt <= 1e6), DPT_E_ARGUMENT);
    may_fail(&codes, !wrench_is_sound(&sample.sent) || !wrench_is_sound(&asked), DPT_E_FINITE);
    pose_codes(&pose, &codes);
    const dpt_result result = RESULT(dpt_passivity_step, no_one ? NULL : &own.at, given, no_wrench ? NULL : &wrench);
    expect(result, &codes);
    outputs_are_guarded(1, 1);
    const int is_zero = !memcmp(&wrench, &zero, sizeof zero);
    HOLDS(no_wrench || is_zero || (result == DPT_OK && !memcmp(&wrench, &asked, sizeof asked)),
          "another wrench than was asked for");
    if (result != DPT_OK)
        return;
    /* Whoever sends what was not allowed, or more than the limits, has no promise. */
    own.is_bounded &= is_taken && !memcmp(&sample.sent, &own.allowed, sizeof zero) &&
                      size_of(asked.force) <= own.def.force_max && size_of(asked.torque) <= own.def.torque_max &&
                      sample.dt == 1e-3;
    met[MET_WITHHELD] += (uint64_t)is_zero;
    own.pose = pose;
    own.allowed = wrench;
    must_be_bounded();
}

static void step(void)
{
    for (uint32_t left = 1 + draw_below(20); left; left--)
        step_once();
}

static void info(void)
{
    struct codes codes = { .count = 0 };
    const int no_out = draw_one_in(20), no_one = draw_one_in(20);
    dpt_passivity_info now;
    const uint32_t size = draw_size(sizeof now, sizeof now);
    void *out = output_sized(0, size);
    may_fail(&codes, no_out || no_one || !own.is_made, DPT_E_ARGUMENT);
    if (!no_out)
        size_codes_of_output(size, sizeof now, 0, &codes);
    expect(RESULT(dpt_passivity_get_info, no_one ? NULL : &own.at, no_out ? NULL : out), &codes);
    outputs_are_guarded(0, 1);
    if (!no_out && !output_is_untouched(0, sizeof size))
        output_read(0, size, sizeof now, offsetof(dpt_passivity_info, account), &now);
}

static void defaults(void)
{
    dpt_passivity_def whole;
    const uint32_t size = draw_size(sizeof whole, sizeof whole);
    const int is_null = draw_one_in(20);
    void *out = output_of_defaults(0, size);
    CALL(dpt_passivity_def_defaults, is_null ? NULL : out, size);
    CALL(dpt_passivity_def_defaults, &whole, sizeof whole);
    defaults_must_hold(0, size, is_null, &whole, sizeof whole);
}

static void begin(void)
{
    memset(&own, 0, sizeof own);
    own.at.size = sizeof own.at;
}

static const struct move moves[] = {
    { "init", init, 2 }, { "step", step, 12 }, { "info", info, 2 }, { "defaults", defaults, 1 }, { NULL, NULL, 0 }
};

const struct noun passivity_noun = { "passivity", begin, NULL, moves };
