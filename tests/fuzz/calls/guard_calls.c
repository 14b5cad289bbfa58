/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Guards: whatever is commanded, whenever, what leaves is finite, within the limits, slewed, and zero when it must
 * be. The model keeps the times, the limits and what was sent last.
 */
#include "fuzz/calls/calls.h"

enum { GUARDS = 2 };

struct guard_model {
    int is_made, was_fresh, was_unseen; /* of what was sent last */
    dpt_guard guard;
    dpt_guard_def def;
    uint64_t now, fresh, hold, stop;
    dpt_wrench sent;
};

static struct guard_model guards[GUARDS];

static void draw_def(dpt_guard_def *def)
{
    CALL(dpt_guard_def_defaults, def, sizeof *def);
    double *numbers[] = { &def->force_max, &def->torque_max, &def->force_slew, &def->torque_slew,
                          &def->hold,      &def->stop,       &def->start };
    for (int i = 0; i < 7; i++)
        if (draw_one_in(4))
            *numbers[i] = draw_one_in(3) ? 0.0 : draw_in(0.0, i < 4 ? 900.0 : 0.05);
    if (draw_one_in(10))
        *numbers[draw_below(7)] = draw_odd_number();
    def->reserved = draw_one_in(40) ? 1u : 0u;
}

static int def_is_wrong(const dpt_guard_def *def)
{
    const double numbers[] = { def->force_max, def->torque_max, def->hold, def->stop, def->start };
    const double most[] = { 1000.0, 1000.0, 10.0, 10.0, 100.0 };
    int is_wrong = def->reserved != 0;
    for (int i = 0; i < 5; i++)
        is_wrong |= !(numbers[i] >= 0.0 && numbers[i] <= most[i]);
    return is_wrong || !(def->force_slew >= 0.0 && isfinite(def->force_slew)) ||
           !(def->torque_slew >= 0.0 && isfinite(def->torque_slew));
}

static void init(void)
{
    struct guard_model *of = &guards[draw_below(GUARDS)];
    const int no_def = draw_one_in(4), no_guard = draw_one_in(30);
    struct codes codes = { .count = 0 };
    const void *given = NULL;
    *of = (struct guard_model){ .guard = { .size = sizeof of->guard } };
    draw_def(&of->def);
    if (draw_one_in(20))
        of->guard.size = draw_below(sizeof of->guard);
    may_fail(&codes, of->guard.size < sizeof of->guard && !no_guard, DPT_E_SIZE);
    may_fail(&codes, no_guard, DPT_E_ARGUMENT);
    if (!no_def) {
        given = draw_input(0, &of->def, draw_size(sizeof of->def, sizeof of->def), sizeof of->def,
                           sizeof of->def, &codes);
        may_fail(&codes, def_is_wrong(&of->def), DPT_E_ARGUMENT);
    } else {
        CALL(dpt_guard_def_defaults, &of->def, sizeof of->def);
    }
    const dpt_result result = RESULT(dpt_guard_init, no_guard ? NULL : &of->guard, given);
    expect(result, &codes);
    outputs_are_guarded(0, 1);
    of->is_made = result == DPT_OK;
    of->hold = (uint64_t)(of->def.hold * 1e9 + 0.5);
    of->stop = (uint64_t)(of->def.stop * 1e9 + 0.5);
    if (!of->is_made && no_guard)
        of->guard.size = 0;
}

static double change_of(const double *a, const double *b)
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

static void must_be_within(const double *v, const double *before, double most, double slew,
                           double dt, int is_free)
{
    const double zero[3] = { 0.0, 0.0, 0.0 };
    HOLDS(change_of(v, zero) <= most * (1.0 + 1e-12), "%g, and %g at most", change_of(v, zero),
          most);
    HOLDS(is_free || slew == 0.0 ||
              change_of(v, before) <= slew * dt * (1.0 + 1e-9) + 1e-12 * (most + 1e-290),
          "it changed by %g in %g s, at %g a second", change_of(v, before), dt, slew);
}

static void step_once(struct guard_model *of)
{
    const uint64_t steps[] = { 1000000, 1000000, 1000000, 100000, 0, 5000000, 50000000, 1 };
    uint64_t now = of->now + steps[draw_below(8)];
    if (draw_one_in(40))
        now = draw_one_in(2) ? draw_bits() >> (20 + draw_below(40)) : of->now / 2;
    const int is_ready = !draw_one_in(12), no_out = draw_one_in(40), no_guard = draw_one_in(40);
    dpt_wrench command;
    double *numbers = (double *)(void *)&command;
    const double scale = draw_one_in(6) ? 1e300 : draw_one_in(3) ? 100.0 : 1.0;
    int is_finite = 1;
    for (int k = 0; k < 6; k++)
        numbers[k] = draw_in(-scale, scale);
    if (draw_one_in(10))
        numbers[draw_below(6)] = draw_odd_number();
    for (int k = 0; k < 6; k++)
        is_finite &= isfinite(numbers[k]) != 0;
    const int has_command = !draw_one_in(4);
    dpt_wrench *out = output_of(1, sizeof *out);
    call_with("%llu ns, command %llu, ready %llu", now, (uint64_t)has_command, (uint64_t)is_ready,
              0);
    CALL(dpt_guard_step, no_guard ? NULL : &of->guard, now, has_command ? &command : NULL, is_ready,
         no_out ? NULL : out);
    outputs_are_guarded(1, 1);
    if (!no_out)
        numbers_are_finite(out->force, 6, "what a guard sends");
    const int is_off = no_guard || !of->is_made;
    double dt = 0.0;
    if (!is_off && now > of->now) {
        dt = (double)(now - of->now) * 1e-9;
        of->now = now;
    }
    /* A command after a silence finds the ramp to zero where it has come to. */
    const int is_stopping = of->now - of->fresh > of->hold;
    const int is_refused = !is_ready || (has_command && !is_finite);
    if (!is_off && is_stopping && of->now - of->fresh >= of->hold + of->stop)
        of->was_fresh = 0;
    if (!is_off && is_refused)
        of->was_fresh = 0;
    if (!is_off && has_command && !is_refused) {
        of->fresh = of->now;
        of->was_fresh = 1;
    }
    const int must_be_zero = is_off || !of->was_fresh;
    const double *sent = (const double *)(const void *)out;
    for (int k = 0; k < 6 && !no_out; k++)
        HOLDS(!must_be_zero || sent[k] == 0.0, "%g N or Nm where it must be zero", sent[k]);
    const int may_jump = is_stopping || must_be_zero || of->was_unseen;
    if (is_off)
        return;
    of->was_unseen = no_out;
    if (no_out)
        return;
    must_be_within(out->force, of->sent.force, of->def.force_max, of->def.force_slew, dt, may_jump);
    must_be_within(out->torque, of->sent.torque, of->def.torque_max, of->def.torque_slew, dt,
                   may_jump);
    game_digest(out, sizeof *out);
    of->sent = *out;
}

static void step(void)
{
    struct guard_model *of = &guards[draw_below(GUARDS)];
    for (uint32_t left = 1 + draw_below(12); left; left--)
        step_once(of);
}

static void defaults(void)
{
    dpt_guard_def def;
    const uint32_t size = draw_size(sizeof def, sizeof def);
    void *out = output_of(0, size > 4096 ? 8 : size);
    CALL(dpt_guard_def_defaults, draw_one_in(20) ? NULL : out, size);
    outputs_are_guarded(0, 1);
    HOLDS((size >= 4 && size <= 4096) || output_is_untouched(0, 0), "size %u", size);
}

static void end(void)
{
    memset(guards, 0, sizeof guards);
}

static const struct move moves[] = {
    { "init", init, 1 }, { "step", step, 8 }, { "defaults", defaults, 1 }, { NULL, NULL, 0 }
};

const struct noun guard_noun = { "guard", NULL, end, moves };
