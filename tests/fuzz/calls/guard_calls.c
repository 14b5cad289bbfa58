/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Guards: whatever is commanded, whenever, what leaves is finite, within the limits, slewed, and zero when it must be;
 * and what a guard tells is what the model (guard_model.h) counted.
 */
#include "fuzz/calls/guard_model.h"

enum { GUARDS = 2, STRUCT_SIZE_MAX = 4096 };

/* A guard in a block of the very size that it says; of none that could be made, a whole dpt_guard's. */
struct own_guard {
    dpt_guard *at;
    size_t room;
    int was_unseen; /* what was sent last */
    dpt_wrench sent;
    struct guard_model model;
};

static struct own_guard guards[GUARDS];

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

/* Anew, or once more in its memory: then only a size that its block has room for. */
static dpt_guard *draw_block(struct own_guard *of)
{
    uint32_t size = draw_size(sizeof(dpt_guard), sizeof(dpt_guard));
    if (!of->at || draw_one_in(2)) {
        const int is_size = size >= sizeof(dpt_guard) && size <= STRUCT_SIZE_MAX;
        free(of->at);
        of->room = is_size || size < sizeof(dpt_guard) ? size : sizeof(dpt_guard);
        of->room = of->room < sizeof size ? sizeof size : of->room;
        of->at = malloc(of->room);
        HOLDS(of->at, "memory ran out");
        memset(of->at, draw_one_in(2) ? 0x5c : 0, of->room);
    } else if (size > of->room && (size <= STRUCT_SIZE_MAX || of->room < sizeof(dpt_guard))) {
        size = (uint32_t)of->room;
    }
    memcpy(of->at, &size, sizeof size);
    return of->at;
}

static void init(void)
{
    struct own_guard *of = &guards[draw_below(GUARDS)];
    const int no_def = draw_one_in(4), no_guard = draw_one_in(30);
    struct codes codes = { .count = 0 };
    const void *given = NULL;
    dpt_guard_def def;
    dpt_guard *at = draw_block(of);
    draw_def(&def);
    may_fail(&codes, no_guard, DPT_E_ARGUMENT);
    if (!no_guard)
        size_codes_of_output(at->size, sizeof *at, 0, &codes);
    if (!no_def) {
        given = draw_input(0, &def, draw_size(sizeof def, sizeof def), sizeof def, sizeof def, &codes);
        may_fail(&codes, def_is_wrong(&def), DPT_E_ARGUMENT);
    } else {
        CALL(dpt_guard_def_defaults, &def, sizeof def);
    }
    call_with("size %llu, of %llu bytes", at->size, of->room, 0, 0);
    const dpt_result result = RESULT(dpt_guard_init, no_guard ? NULL : at, given);
    expect(result, &codes);
    outputs_are_guarded(0, 1);
    if (no_guard)
        at->size = 0;
    of->model.is_made = 0;
    of->was_unseen = 0;
    memset(&of->sent, 0, sizeof of->sent);
    if (result == DPT_OK)
        guard_model_init(&of->model, &def);
}

/* Copied, it is another guard. */
static void copy(void)
{
    const struct own_guard *from = &guards[0];
    struct own_guard *to = &guards[1];
    if (!from->model.is_made)
        return;
    free(to->at);
    *to = *from;
    to->at = malloc(to->room);
    HOLDS(to->at, "memory ran out");
    memcpy(to->at, from->at, to->room);
}

static double change_of(const double *a, const double *b)
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static void must_be_within(const double *v, const double *before, double most, double slew, double dt, int is_free)
{
    const double zero[3] = { 0.0, 0.0, 0.0 };
    HOLDS(change_of(v, zero) <= most * (1.0 + 1e-12), "%g, and %g at most", change_of(v, zero), most);
    HOLDS(is_free || slew == 0.0 || change_of(v, before) <= slew * dt * (1.0 + 1e-9) + 1e-12 * (most + 1e-290),
          "it changed by %g in %g s, at %g a second", change_of(v, before), dt, slew);
}

static void draw_command(dpt_wrench *command)
{
    double *numbers = (double *)(void *)command;
    const double scale = draw_one_in(6) ? 1e300 : draw_one_in(3) ? 100.0 : 1.0;
    for (int k = 0; k < 6; k++)
        numbers[k] = draw_in(-scale, scale);
    if (draw_one_in(10))
        numbers[draw_below(6)] = draw_odd_number();
}

/* What was promised of what leaves, whatever the model says. */
static void out_must_be_safe(struct own_guard *of, const dpt_wrench *out, double dt)
{
    const struct guard_model *model = &of->model;
    const int may_jump = model->state == DPT_GUARD_OFF || model->state == DPT_GUARD_STOPPING || of->was_unseen;
    must_be_within(out->force, of->sent.force, model->def.force_max, model->def.force_slew, dt, may_jump);
    must_be_within(out->torque, of->sent.torque, model->def.torque_max, model->def.torque_slew, dt, may_jump);
    of->sent = *out;
}

static int is_zero(const dpt_wrench *wrench)
{
    const double *numbers = wrench->force;
    for (int k = 0; k < 3; k++)
        if (numbers[k] != 0.0 || wrench->torque[k] != 0.0)
            return 0;
    return 1;
}

static void step_once(struct own_guard *of)
{
    struct guard_model *model = &of->model;
    const uint64_t steps[] = { 1000000, 1000000, 1000000, 100000, 0, 5000000, 50000000, 1 };
    const uint64_t before = model->now, fresh_before = model->fresh;
    uint64_t now = before + steps[draw_below(8)];
    if (draw_one_in(40))
        now = draw_one_in(2) ? draw_bits() >> (20 + draw_below(40)) : before / 2;
    const int is_ready = !draw_one_in(12), no_out = draw_one_in(40), no_guard = draw_one_in(40);
    const int has_command = !draw_one_in(4);
    dpt_wrench command;
    draw_command(&command);
    dpt_wrench *out = output_of(1, sizeof *out);
    call_with("%llu ns, command %llu, ready %llu", now, (uint64_t)has_command, (uint64_t)is_ready, 0);
    CALL(dpt_guard_step, no_guard ? NULL : of->at, now, has_command ? &command : NULL, is_ready, no_out ? NULL : out);
    outputs_are_guarded(1, 1);
    if (!no_out)
        numbers_are_finite(out->force, 6, "what a guard sends");
    if (no_guard || !model->is_made) {
        HOLDS(no_out || is_zero(out), "a force of a guard that there is not");
        return;
    }
    guard_model_step(model, now, has_command ? &command : NULL, is_ready, no_out ? NULL : out);
    const uint64_t passed = model->now - before, silence = model->now - fresh_before;
    if (!no_out && silence > model->hold + model->stop && model->fresh == fresh_before)
        HOLDS(is_zero(out), "a force %llu ns after the last command", (unsigned long long)silence);
    if (!no_out) {
        /* A command after a silence finds the ramp to zero where it has come to. */
        of->was_unseen |= silence > model->hold;
        out_must_be_safe(of, out, (double)passed * 1e-9);
        game_digest(out, sizeof *out);
    }
    of->was_unseen = no_out;
}

static void step(void)
{
    struct own_guard *of = &guards[draw_below(GUARDS)];
    if (!of->at)
        return;
    for (uint32_t left = 1 + draw_below(12); left; left--)
        step_once(of);
}

static void info(void)
{
    const struct own_guard *of = &guards[draw_below(GUARDS)];
    const int no_out = draw_one_in(30), no_guard = !of->at || draw_one_in(30);
    const int is_made = !no_guard && of->model.is_made;
    dpt_guard_info now;
    const uint32_t size = draw_size(sizeof now, sizeof now);
    struct codes codes = { .count = 0 };
    void *out = output_sized(0, size);
    may_fail(&codes, no_out || !is_made, DPT_E_ARGUMENT);
    if (!no_out)
        size_codes_of_output(size, sizeof now, 0, &codes);
    call_with("size %llu", size, 0, 0, 0);
    const dpt_result result = RESULT(dpt_guard_get_info, no_guard ? NULL : of->at, no_out ? NULL : out);
    expect(result, &codes);
    outputs_are_guarded(0, 1);
    if (no_out || output_is_untouched(0, sizeof size)) {
        HOLDS(result != DPT_OK && (no_out || size < sizeof now || size > STRUCT_SIZE_MAX), "nothing was told");
        return;
    }
    output_read(0, size, sizeof now, offsetof(dpt_guard_info, gain), &now);
    if (is_made) {
        guard_model_must_tell(&of->model, &now);
        return;
    }
    const dpt_guard_info nothing = { .size = now.size };
    HOLDS(!memcmp(&now, &nothing, sizeof now), "of a guard that was not initialised");
}

static void defaults(void)
{
    dpt_guard_def whole;
    const uint32_t size = draw_size(sizeof whole, sizeof whole);
    const int is_null = draw_one_in(20);
    void *out = output_of_defaults(0, size);
    CALL(dpt_guard_def_defaults, is_null ? NULL : out, size);
    CALL(dpt_guard_def_defaults, &whole, sizeof whole);
    defaults_must_hold(0, size, is_null, &whole, sizeof whole);
}

static void end(void)
{
    for (int i = 0; i < GUARDS; i++)
        free(guards[i].at);
    memset(guards, 0, sizeof guards);
}

static const struct move moves[] = { { "init", init, 4 }, { "copy", copy, 1 },         { "step", step, 16 },
                                     { "info", info, 8 }, { "defaults", defaults, 1 }, { NULL, NULL, 0 } };

const struct noun guard_noun = { "guard", NULL, end, moves };
