/* SPDX-License-Identifier: BSD-3-Clause */
/* The choice of a coupling for a device (coupling.h), against the growth of the whole sampled loop (loop_matrix.h). */
#include "dynpoint/coupling.h"

#include "force/loop_matrix.h"
#include "lib/check.h"
#include "lib/random.h"

static struct matrix_loop one_axis(double mass, double damping, double period, double delay, double stiffness,
                                   double virtual_damping)
{
    return (struct matrix_loop){ .axes = 1,
                                 .mass = { mass },
                                 .damping = { damping },
                                 .stiffness = { { stiffness } },
                                 .virtual_damping = { { virtual_damping } },
                                 .period = period,
                                 .delay = delay };
}

static void the_limit_is_where_motion_grows(void)
{
    const double masses[] = { 0.02, 0.1, 0.5 }, dampings[] = { 0.1, 0.5, 5, 20 };
    const double periods[] = { 1e-4, 1e-3, 4e-3 }, delays[] = { 0, 0.3, 1, 1.5, 3, 7.25 };
    const double virtual_dampings[] = { 0, 0.5, 2 };
    unsigned cases = 0;
    for (int i = 0; i < 3 * 4 * 3 * 6 * 3; i++) {
        const double m = masses[i % 3], b = dampings[i / 3 % 4], T = periods[i / 12 % 3];
        const double delay = delays[i / 36 % 6] * T, B = virtual_dampings[i / 216] * b;
        const double limit = dpt_stable_stiffness(m, b, T, delay, B);
        /* What the oracle can tell: growth of 1e-7 a period. */
        const double apart = fmax(1e-3, 1e-6 * m / (b * T));
        if (apart > 0.05)
            continue;
        if (B == 0)
            CHECK(limit > 0, "m %g, b %g, T %g, delay %g: no limit", m, b, T, delay);
        if (limit == 0) {
            const struct matrix_loop weak = one_axis(m, b, T, delay, 1e-6 * b / T, B);
            CHECK(loop_growth(&weak) > 0, "m %g, b %g, T %g, delay %g, B %g is stable", m, b, T, delay, B);
            continue;
        }
        const struct matrix_loop below = one_axis(m, b, T, delay, (1 - apart) * limit, B);
        const struct matrix_loop above = one_axis(m, b, T, delay, (1 + apart) * limit, B);
        CHECK(loop_growth(&below) < 0 && loop_growth(&above) > 0,
              "m %g, b %g, T %g, delay %g, B %g: %g N/m, growth %g below, %g above", m, b, T, delay, B, limit,
              loop_growth(&below), loop_growth(&above));
        cases++;
    }
    CHECK(cases > 500, "only %u cases", cases);
    printf("    %u limits, most within 0.1 %%\n", cases);
}

/* b / (T/2 + t_d), which holds for small b; and what was found for large virtual damping (docs/algorithms/coupling.md). */
static void the_limit_agrees_with_published_forms(void)
{
    for (int i = 0; i < 4; i++) {
        const double delay = i * 1e-3, simple = 0.5 / (0.5e-3 + delay);
        const double limit = dpt_stable_stiffness(0.2, 0.5, 1e-3, delay, 0);
        CHECK(fabs(limit / simple - 1) < 0.02, "delay %g: %g, not %g", delay, limit, simple);
    }
    const double table[][2] = { { 1, 2941 }, { 5, 9867 }, { 10, 16854 }, { 20, 26213 }, { 40, 31432 } };
    for (int i = 0; i < 5; i++) {
        const double limit = dpt_stable_stiffness(0.045, 0.5, 1e-3, 0, table[i][0]);
        CHECK(fabs(limit / table[i][1] - 1) < 1e-3, "B %g: %g, not %g", table[i][0], limit, table[i][1]);
    }
}

static void long_delays_are_modelled_by_longer_periods(void)
{
    for (double b = 0.5; b < 100; b *= 10) {
        const double before = dpt_stable_stiffness(0.1, b, 1e-3, 0.016, 0) * 0.0165;
        const double after = dpt_stable_stiffness(0.1, b, 1e-3, 0.01601, 0) * 0.01651;
        CHECK(fabs(after / before - 1) < 1e-3, "b %g: %g and %g", b, before, after);
        CHECK(dpt_stable_stiffness(0.1, b, 1e-3, 10, 0) > 0, "no limit for 10 s");
    }
}

static void what_is_no_loop_has_no_limit(void)
{
    const double bad[] = { -1, NAN, INFINITY };
    for (int i = 0; i < 3; i++) {
        CHECK(dpt_stable_stiffness(bad[i], 1, 1e-3, 0, 0) == 0, "mass %g", bad[i]);
        CHECK(dpt_stable_stiffness(0.1, bad[i], 1e-3, 0, 0) == 0, "damping %g", bad[i]);
        CHECK(dpt_stable_stiffness(0.1, 1, bad[i], 0, 0) == 0, "period %g", bad[i]);
        CHECK(dpt_stable_stiffness(0.1, 1, 1e-3, bad[i], 0) == 0, "delay %g", bad[i]);
        CHECK(dpt_stable_stiffness(0.1, 1, 1e-3, 0, bad[i]) == 0, "virtual damping %g", bad[i]);
    }
    CHECK(dpt_stable_stiffness(0, 1, 1e-3, 0, 0) == 0, "no mass");
    CHECK(dpt_stable_stiffness(0.1, 0, 1e-3, 0, 0) == 0, "no damping");
    CHECK(dpt_stable_stiffness(0.1, 0.01, 1e-3, 0, 1e6) == 0, "a damper that is unstable by itself");
}

static dpt_coupling_def omni(void)
{
    dpt_coupling_def def;
    dpt_coupling_def_init(&def);
    def.mass = 0.045;
    def.damping = 0.5;
    def.friction = 0.26;
    def.position_step = 5.5e-5;
    def.delay = 1e-3;
    def.force_max = 3.3;
    return def;
}

static dpt_coupling choose(const dpt_coupling_def *def)
{
    dpt_coupling coupling = { .size = sizeof coupling };
    const dpt_result result = dpt_coupling_for_device(def, &coupling);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    return coupling;
}

static int near(double a, double b, double part)
{
    return fabs(a - b) <= part * fabs(b);
}

static void it_is_as_stiff_as_the_margin_allows(void)
{
    dpt_coupling_def def = omni();
    const double limit = dpt_stable_stiffness(0.045, 0.5, 1e-3, 1e-3, 0);
    for (double margin = 1; margin < 5; margin += 0.5) {
        def.gain_margin = margin;
        const dpt_coupling coupling = choose(&def);
        CHECK(near(coupling.stiffness, limit / margin, 1e-6) && near(coupling.stable, limit, 1e-6),
              "margin %g: %g and %g", margin, coupling.stiffness, coupling.stable);
        CHECK(coupling.limit == DPT_COUPLING_STABILITY, "limit %u", coupling.limit);
        CHECK(near(coupling.delay, 1.5e-3, 1e-9), "%g", coupling.delay);
        CHECK(near(coupling.depth, 3.3 / coupling.stiffness, 1e-9), "depth %g", coupling.depth);
        CHECK(coupling.flags == DPT_COUPLING_FLAG_RESTS, "flags %u", coupling.flags);
    }
    for (int i = 0; i < 2; i++) {
        def.friction = (i ? 1.01 : 0.99) * 0.5 * choose(&def).stiffness * def.position_step;
        CHECK(choose(&def).flags == (i ? DPT_COUPLING_FLAG_RESTS : 0u), "%g N: flags %u", def.friction,
              choose(&def).flags);
    }
    def.friction = 1;
    def.has_torque = 1;
    def.inertia = 1e-4;
    def.spin_damping = 1e-3;
    def.angle_step = 1e-3;
    def.rho = def.lever = 0.02;
    for (int i = 0; i < 2; i++) {
        const double turn = choose(&def).stiffness * (0.02 * 0.02 + 0.02 * 0.02);
        def.spin_friction = (i ? 1.01 : 0.99) * 0.5 * turn * def.angle_step;
        CHECK(choose(&def).flags == (i ? DPT_COUPLING_FLAG_RESTS : 0u), "%g Nm: flags %u", def.spin_friction,
              choose(&def).flags);
    }
}

static void the_margin_counts_virtual_damping_too(void)
{
    dpt_coupling_def def = omni();
    def.tool_damping = 2;
    def.gain_margin = 2;
    const dpt_coupling coupling = choose(&def);
    const double limit = dpt_stable_stiffness(0.045, 0.5, 1e-3, 1e-3, 4);
    CHECK(near(coupling.stiffness, limit / 2, 1e-6) && coupling.damping == 2, "%g of %g", coupling.stiffness, limit);
}

/* "800 needs T/2 + t_d <= 0.4 ms; you have 1.5" */
static void it_says_what_a_wish_would_need(void)
{
    dpt_coupling_def def = omni();
    def.stiffness = 800;
    const dpt_coupling coupling = choose(&def);
    CHECK(coupling.stiffness < 800 && coupling.limit == DPT_COUPLING_STABILITY, "%g, limit %u", coupling.stiffness,
          coupling.limit);
    CHECK(coupling.delay_needed < coupling.delay && coupling.delay_needed > 0, "%g", coupling.delay_needed);
    const double faster = coupling.delay_needed / coupling.delay;
    def.rate /= faster;
    def.delay *= faster;
    CHECK(near(choose(&def).stiffness, 800, 1e-5), "with %g of the times %g", faster, choose(&def).stiffness);
    def = omni();
    def.stiffness = 100;
    CHECK(choose(&def).stiffness == 100 && choose(&def).limit == DPT_COUPLING_ASKED, "100: %g", choose(&def).stiffness);
    CHECK(choose(&def).delay_needed > choose(&def).delay, "100 needs %g", choose(&def).delay_needed);
}

static void other_limits_are_named(void)
{
    dpt_coupling_def def = omni();
    def.stiffness_max = 50;
    CHECK(choose(&def).stiffness == 50 && choose(&def).limit == DPT_COUPLING_MAKER, "maker");
    def = omni();
    def.position_step = 0.01;
    CHECK(near(choose(&def).stiffness, 33, 1e-9) && choose(&def).limit == DPT_COUPLING_STEP, "steps of 1 cm: %g",
          choose(&def).stiffness);
    def = omni();
    def.damping = 0;
    CHECK(choose(&def).stiffness == 100 && choose(&def).limit == DPT_COUPLING_UNKNOWN, "unknown");
    def.stiffness_max = 700;
    CHECK(choose(&def).stiffness == 700 && choose(&def).limit == DPT_COUPLING_MAKER, "unknown, 700");
    def.stiffness = 20;
    CHECK(choose(&def).stiffness == 20 && choose(&def).limit == DPT_COUPLING_ASKED, "unknown, 20");
}

/* At the hand the scene's stiffness K is s Z K. */
static void zoom_and_force_scale_are_felt(void)
{
    const dpt_coupling plain = choose(&(dpt_coupling_def[]){ omni() }[0]);
    for (int i = 0; i < 4; i++) {
        dpt_coupling_def def = omni();
        def.zoom = i & 1 ? 4 : 0.5;
        def.force_scale = i & 2 ? 3 : 0.2;
        const dpt_coupling coupling = choose(&def);
        CHECK(near(coupling.stiffness * def.zoom * def.force_scale, plain.stiffness, 1e-9), "%g at zoom %g, force %g",
              coupling.stiffness, def.zoom, def.force_scale);
        CHECK(near(coupling.depth, def.zoom * plain.depth, 1e-9), "depth %g", coupling.depth);
    }
}

#define WEAK 1e-3

/* What rounding makes of a growth of 0, a period. */
#define RESOLVED 2e-7

/* What holds a tool: all of it, or one contact on the axis, `arm` m of the hand from the centre. */
struct hold {
    double arm, share; /* of the normal that is in the plane of tool and lever; 0 < share <= 1 */
    int is_all;
};

/* Translation across the tool and the turn about the pose's origin, with all gains so many times higher. */
static double growth_of(const dpt_coupling_def *def, const dpt_coupling *coupling, double gain, const struct hold *hold)
{
    const double lever = def->lever / def->zoom, rho = def->rho / def->zoom;
    const double k = gain * def->force_scale * def->zoom * coupling->stiffness;
    const double turn = coupling->rotational_stiffness > 0
                            ? gain * def->force_scale / def->zoom * coupling->rotational_stiffness
                            : k * rho * rho;
    const double part = coupling->stiffness > 0 ? coupling->damping / coupling->stiffness : 0;
    double matrix[2][2] = { { k, k * lever }, { k * lever, turn + k * lever * lever } };
    if (!hold->is_all) {
        const double arm = hold->arm * hold->share, at = lever * hold->share + arm;
        const double left = arm != 0 ? 1 / (1 / k + arm * arm / turn) : k;
        /* What one contact leaves free is held weakly, so that its drift does not count as growth. */
        const double one[2][2] = { { left + WEAK * k, left * at }, { left * at, left * at * at + WEAK * turn } };
        memcpy(matrix, one, sizeof matrix);
    }
    struct matrix_loop loop = { .axes = 2,
                                .mass = { def->mass, def->inertia },
                                .damping = { def->damping, def->spin_damping },
                                .period = 1 / def->rate,
                                .delay = def->delay + def->loop_delay };
    for (int i = 0; i < 4; i++) {
        loop.stiffness[i / 2][i % 2] = matrix[i / 2][i % 2];
        loop.virtual_damping[i / 2][i % 2] = part * matrix[i / 2][i % 2];
    }
    return loop_growth(&loop);
}

/* The fastest growth over many ways to hold it. */
static double worst_growth(const dpt_coupling_def *def, const dpt_coupling *coupling, double gain, uint64_t seed)
{
    const struct hold all = { .is_all = 1 };
    const double half = sqrt(3) * def->rho / def->zoom;
    double worst = growth_of(def, coupling, gain, &all);
    for (int i = 0; i < 30; i++) {
        struct hold hold = { .arm = random_in(&seed, -half, half), .share = random_in(&seed, 0.02, 1) };
        if (i < 4)
            hold = (struct hold){ .arm = i & 1 ? half : -half, .share = i & 2 ? 1 : 0.05 };
        worst = fmax(worst, growth_of(def, coupling, gain, &hold));
    }
    return worst;
}

static dpt_coupling_def with_torque(uint64_t *seed, int i)
{
    dpt_coupling_def def = omni();
    def.has_torque = 1;
    def.mass = 0.03 * pow(10, random_in(seed, 0, 1));
    def.damping = 0.2 * pow(20, random_in(seed, 0, 1));
    def.inertia = 1e-5 * pow(30, random_in(seed, 0, 1));
    def.spin_damping = 1e-4 * pow(50, random_in(seed, 0, 1));
    def.rho = 0.03 * random_in(seed, 0, 1);
    def.lever = 0.08 * random_in(seed, 0, 1);
    def.delay = 1e-3 * floor(3 * random_in(seed, 0, 1));
    def.zoom = 0.5 + 2 * random_in(seed, 0, 1);
    def.tool_damping = i % 3 ? 0 : 0.1 * def.damping / def.zoom;
    def.rotational_stiffness = i % 4 ? 0 : 0.1 * def.spin_damping / 1e-3;
    return def;
}

static void rotation_and_its_lever_count(void)
{
    uint64_t seed = 7;
    unsigned by_rotation = 0, too_stiff = 0;
    for (int i = 0; i < 200; i++) {
        const dpt_coupling_def def = with_torque(&seed, i);
        const dpt_coupling coupling = choose(&def);
        const double growth = worst_growth(&def, &coupling, 0.98 * def.gain_margin, (uint64_t)i);
        CHECK(growth < RESOLVED, "%d: m %g, I %g, lever %g, rho %g: grows by %g at the margin", i, def.mass,
              def.inertia, def.lever, def.rho, growth);
        by_rotation += coupling.limit == DPT_COUPLING_ROTATION;
        too_stiff += worst_growth(&def, &coupling, 1.02 * def.gain_margin, (uint64_t)i) > RESOLVED;
    }
    printf("    200 devices with torque, %u limited by rotation: %u are at their limit\n", by_rotation, too_stiff);
    CHECK(by_rotation > 100, "only %u are limited by rotation", by_rotation);
    CHECK(too_stiff > 180, "only %u are at their limit", too_stiff);
}

static void what_is_wrong_is_refused(void)
{
    dpt_coupling coupling = { .size = sizeof coupling };
    double *fields[22];
    dpt_coupling_def def = omni();
    int count = 0;
    for (double *field = &def.mass; field <= &def.gain_margin; field++)
        fields[count++] = field;
    CHECK(count == 22, "%d fields", count);
    for (int i = 0; i < count; i++) {
        const double wrong[] = { -1, NAN, INFINITY };
        for (int k = 0; k < 3; k++) {
            const double kept = *fields[i];
            *fields[i] = wrong[k];
            memset(&coupling.limit, 0xff, sizeof coupling - sizeof coupling.size);
            const dpt_result result = dpt_coupling_for_device(&def, &coupling);
            CHECK(result == (k ? DPT_E_FINITE : DPT_E_ARGUMENT), "field %d, %g: %s", i, wrong[k],
                  dpt_result_name(result));
            CHECK(coupling.stiffness == 0 && coupling.limit == 0, "field %d: not zero", i);
            *fields[i] = kept;
        }
    }
    def.has_torque = 2;
    CHECK(dpt_coupling_for_device(&def, &coupling) == DPT_E_ARGUMENT, "torque 2");
    CHECK(dpt_coupling_for_device(NULL, &coupling) == DPT_E_ARGUMENT, "no def");
    CHECK(dpt_coupling_for_device(&def, NULL) == DPT_E_ARGUMENT, "no coupling");
}

int main(void)
{
    TEST(the_limit_is_where_motion_grows);
    TEST(the_limit_agrees_with_published_forms);
    TEST(long_delays_are_modelled_by_longer_periods);
    TEST(what_is_no_loop_has_no_limit);
    TEST(it_is_as_stiff_as_the_margin_allows);
    TEST(the_margin_counts_virtual_damping_too);
    TEST(it_says_what_a_wish_would_need);
    TEST(other_limits_are_named);
    TEST(zoom_and_force_scale_are_felt);
    TEST(rotation_and_its_lever_count);
    TEST(what_is_wrong_is_refused);
    return check_report();
}
