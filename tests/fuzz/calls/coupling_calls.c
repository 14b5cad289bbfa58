/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Couplings of devices: what is chosen is finite and no stiffer than what was asked for or than the sampled device holds;
 * and devices that fill in a def.
 */
#include "dynpoint/device.h"
#include "fuzz/calls/calls.h"

/* The fields of a def from `mass` on, and the ranges that the header states. */
enum { FIELDS = 22 };

static const double least[FIELDS] = { [12] = 1.0, [14] = 1e-6, [15] = 1e-6, [21] = 1.0 };
static const double most[FIELDS] = { 1e3,   1e3, 1e6,  1e6, 1e300, 1e300, 1.0, 1.0, 10.0, 1e300, 1e300,
                                     1e300, 1e5, 10.0, 1e6, 1e6,   1e6,   1e6, 1e9, 1e9,  1e9,   100.0 };

static void draw_def(dpt_coupling_def *def)
{
    double *const fields = &def->mass;
    const double usual[FIELDS] = { 0.1,  1e-4, 0.5,  1e-3, 0.1, 1e-3, 1e-5, 1e-4, 1e-3, 5.0, 0.1,
                                   700., 1e3,  1e-4, 1.0,  1.0, 0.03, 0.05, 500., 0.3,  0.2, 1.5 };
    CALL(dpt_coupling_def_defaults, def, sizeof *def);
    for (int i = 0; i < FIELDS; i++)
        if (draw_one_in(2))
            fields[i] = fmax(least[i], usual[i] * draw_in(0.3, 3.0));
    if (draw_one_in(8))
        fields[draw_below(FIELDS)] = draw_odd_number();
    def->has_torque = draw_one_in(40) ? 2 : draw_below(2);
}

static void def_codes(const dpt_coupling_def *def, struct codes *codes)
{
    const double *const fields = &def->mass;
    int is_finite = 1, is_wrong = def->has_torque > 1;
    for (int i = 0; i < FIELDS; i++) {
        is_finite &= isfinite(fields[i]);
        is_wrong |= !(fields[i] >= least[i] && fields[i] <= most[i]);
    }
    may_fail(codes, !is_finite, DPT_E_FINITE);
    may_fail(codes, is_wrong && is_finite, DPT_E_ARGUMENT);
}

static int is_known(const dpt_coupling_def *def)
{
    return def->mass > 0.0 && def->damping > 0.0 &&
           (!def->has_torque || (def->inertia > 0.0 && def->spin_damping > 0.0));
}

static void must_be_held(const dpt_coupling_def *def, const dpt_coupling *coupling)
{
    const double at_hand = coupling->stiffness * def->force_scale * def->zoom;
    numbers_are_finite(&coupling->stiffness, 8, "a coupling");
    HOLDS(coupling->limit <= DPT_COUPLING_UNKNOWN && coupling->stiffness >= 0.0, "limit %u", coupling->limit);
    HOLDS(!(def->stiffness > 0.0) || coupling->stiffness <= def->stiffness * (1.0 + 1e-12), "%g N/m for %g",
          coupling->stiffness, def->stiffness);
    HOLDS(!is_known(def) || at_hand <= coupling->stable * (1.0 + 1e-9), "%g N/m at the hand, stable up to %g", at_hand,
          coupling->stable);
    met[MET_LIMITED] += def->stiffness > 0.0 && coupling->stiffness < def->stiffness;
}

static void choose(void)
{
    struct codes codes = { .count = 0 };
    const int no_def = draw_one_in(30), no_out = draw_one_in(30);
    dpt_coupling_def def;
    dpt_coupling now;
    const uint32_t size = draw_size(sizeof now, sizeof now);
    void *out = output_sized(0, size);
    const void *given = NULL;
    draw_def(&def);
    may_fail(&codes, no_def || no_out, DPT_E_ARGUMENT);
    if (!no_def) {
        given = draw_input(1, &def, draw_size(sizeof def, sizeof def), sizeof def, sizeof def, &codes);
        def_codes(&def, &codes);
    }
    if (!no_out)
        size_codes_of_output(size, sizeof now, 0, &codes);
    call_with("size %llu", size, 0, 0, 0);
    const dpt_result result = RESULT(dpt_coupling_for_device, given, no_out ? NULL : out);
    expect(result, &codes);
    outputs_are_guarded(0, 2);
    if (no_out || output_is_untouched(0, sizeof size))
        return;
    output_read(0, size, sizeof now, offsetof(dpt_coupling, stiffness), &now);
    if (result == DPT_OK && size >= sizeof now)
        must_be_held(&def, &now);
    game_digest(&now, sizeof now);
}

static void stable(void)
{
    double given[5] = { draw_in(0.01, 1.0), draw_in(0.01, 5.0), draw_in(1e-4, 1e-2), draw_in(0.0, 0.01),
                        draw_one_in(2) ? 0.0 : draw_in(0.0, 3.0) };
    if (draw_one_in(4))
        given[draw_below(5)] = draw_odd_number();
    const double limit = CALL(dpt_stable_stiffness, given[0], given[1], given[2], given[3], given[4]);
    HOLDS(limit >= 0.0 && limit <= 1e308, "limit %g", limit);
    game_digest(&limit, sizeof limit);
}

static void fill(void)
{
    struct codes codes = { .count = 0 };
    const int no_info = draw_one_in(20), no_def = draw_one_in(20);
    dpt_device_info info = { .size = sizeof info, .mass = draw_in(0.0, 1.0), .rate = 500.0 };
    dpt_coupling_def def;
    const void *given = NULL;
    CALL(dpt_coupling_def_defaults, &def, sizeof def);
    may_fail(&codes, no_info || no_def, DPT_E_ARGUMENT);
    if (!no_info)
        given = draw_input(1, &info, draw_size(sizeof info, sizeof info), sizeof info, sizeof info, &codes);
    const dpt_result result = RESULT(dpt_device_fill_coupling, given, no_def ? NULL : &def);
    expect(result, &codes);
    outputs_are_guarded(1, 1);
    HOLDS(result != DPT_OK || (def.mass == info.mass && def.rate == 500.0), "mass %g", def.mass);
}

static void defaults(void)
{
    dpt_coupling_def whole;
    const uint32_t size = draw_size(sizeof whole, sizeof whole);
    const int is_null = draw_one_in(20);
    void *out = output_of_defaults(0, size);
    CALL(dpt_coupling_def_defaults, is_null ? NULL : out, size);
    CALL(dpt_coupling_def_defaults, &whole, sizeof whole);
    defaults_must_hold(0, size, is_null, &whole, sizeof whole);
}

static const struct move moves[] = { { "choose", choose, 2 },
                                     { "stable", stable, 2 },
                                     { "fill", fill, 1 },
                                     { "defaults", defaults, 1 },
                                     { NULL, NULL, 0 } };

const struct noun coupling_noun = { "coupling", NULL, NULL, moves };
