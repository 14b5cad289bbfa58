/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which steps of springs are stable. Limits of one mode against the eigenvalues of its 2 x 2 matrix; of a lattice
 * against the largest eigenvalue of its own matrix; growth beyond the limit, and none within it.
 *
 *     test_springs_stable [PER CENT]   of the long runs
 */
#include "deform/made_net.h"

static dpt_springs_def def_of(uint32_t integrator)
{
    dpt_springs_def def;
    dpt_springs_def_init(&def);
    def.integrator = integrator;
    def.sleep_speed = 0.0;
    return def;
}

/* The larger size of the eigenvalues of a step of x'' = -w2 (x + t x') - c x', from the step's matrix. */
static double mode_growth(uint32_t integrator, double w2, double t, double c, double h)
{
    const int euler = integrator == DPT_INTEGRATOR_EULER;
    const double keep = 1.0 / (1.0 + h * c);
    const double vv = keep * (1.0 - h * w2 * t), vx = -keep * h * w2;
    const double xv = euler ? h : h * vv, xx = euler ? 1.0 : 1.0 + h * vx;
    const double trace = vv + xx, det = vv * xx - vx * xv, root = 0.25 * trace * trace - det;
    return root < 0.0 ? sqrt(det) : 0.5 * fabs(trace) + sqrt(root);
}

static void limits_of_one_mode_are_exact(void)
{
    uint32_t cut = 0, none = 0;
    for (uint32_t integrator = DPT_INTEGRATOR_SYMPLECTIC; integrator <= DPT_INTEGRATOR_EULER; integrator++)
        for (double w2 = 10.0; w2 < 1e9; w2 *= 7.0)
            for (double t = 0.0; t<0.1; t = t> 0.0 ? 3.0 * t : 1e-6)
                for (double c = 0.0; c<1e4; c = c> 0.0 ? 5.0 * c : 0.1) {
                    const double limit = dpti_springs_limit(integrator, w2, t, c);
                    none += limit == 0.0;
                    if (limit == 0.0)
                        CHECK(mode_growth(integrator, w2, t, c, 1e-7) > 1.0, "no limit");
                    for (int i = 1; i <= 20 && limit > 0.0; i++) {
                        const double growth = mode_growth(integrator, w2, t, c, 0.05 * i * limit * 0.9999);
                        CHECK(growth <= 1.0 + 1e-9, "integrator %u, w2 %g, t %g, c %g: %g at %g", integrator, w2, t, c,
                              growth, 0.05 * i * limit);
                    }
                    if (limit > 0.0 && limit < DPT_SPRINGS_STEP_MAX) {
                        cut++;
                        CHECK(mode_growth(integrator, w2, t, c, 1.001 * limit) > 1.0,
                              "integrator %u, w2 %g, t %g, c %g: no growth beyond %g", integrator, w2, t, c, limit);
                    }
                    /* Slower modes have no shorter limit, so the fastest one's holds for all. */
                    CHECK(dpti_springs_limit(integrator, 0.3 * w2, t, c) >= limit * (1.0 - 1e-12),
                          "integrator %u, w2 %g, t %g, c %g", integrator, w2, t, c);
                }
    CHECK(cut > 500 && none > 5, "%u limits, %u without one", cut, none);
}

/* One mass on a spring, stepped at shares of the limit. Returns how far it is away in the end, from 1 mm. */
static double swing(uint32_t integrator, double viscosity, double drag, double share, uint32_t steps)
{
    const double away = 1e-3;
    struct made_net net = { 0 };
    dpt_springs_def def = def_of(integrator);
    net_fix(&net, net_node(&net, 0.0, 0.0, 0.0, 1.0));
    net_node(&net, 1.0, 0.0, 0.0, 1e-3);
    net_spring(&net, 0, 1, 40.0, 1.0);
    net_drag(&net, drag);
    net.viscosity = viscosity;
    CHECK(net_open(&net, &def) == DPT_OK, "not made");
    const float start[3] = { (float)(1.0 + away), 0.0f, 0.0f };
    dpt_springs_set_nodes(net.made, 1, 1, start, NULL);
    double most = 0.0;
    for (uint32_t i = 0; i < steps; i++) {
        if (!dpti_springs_substeps(net.made, share * net.made->stable_step, 1)) {
            most = 1e12;
            break;
        }
        const double x = fabs((double)net_positions(&net)[3] - 1.0);
        most = i >= steps / 2 && x > most ? x : most;
    }
    net_close(&net);
    return most / away;
}

static void one_mass_is_stable_up_to_its_limit(void)
{
    const double cases[][2] = { { 1e-4, 0.0 }, { 0.0, 5.0 }, { 2e-3, 2.0 }, { 0.03, 0.0 } };
    for (uint32_t integrator = DPT_INTEGRATOR_SYMPLECTIC; integrator <= DPT_INTEGRATOR_EULER; integrator++)
        for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
            const double within = swing(integrator, cases[i][0], cases[i][1], 0.97, 4000);
            const double beyond = swing(integrator, cases[i][0], cases[i][1], 1.3, 20000);
            CHECK(within < 1.0, "integrator %u, case %zu: %g", integrator, i, within);
            CHECK(beyond > 1.5, "integrator %u, case %zu: %g", integrator, i, beyond);
        }
}

/* The fastest mode of a net by power iteration: 1/s2. mode: of unit size. */
static double fastest_mode(const struct made_net *net, double *mode)
{
    const size_t n = 3 * (size_t)net->nodes;
    double *matrix = net_matrix(net), *next = malloc(n * sizeof *next), value = 0.0;
    uint64_t seed = 5;
    for (size_t i = 0; i < n; i++)
        mode[i] = net->mass[i / 3] > 0.0f ? random_in(&seed, -1.0, 1.0) : 0.0;
    for (int round = 0; round < 20000; round++) {
        double size = 0.0;
        for (size_t i = 0; i < n; i++) {
            next[i] = 0.0;
            for (size_t j = 0; j < n; j++)
                next[i] += matrix[i * n + j] * mode[j];
            next[i] = net->mass[i / 3] > 0.0f ? next[i] / (double)net->mass[i / 3] : 0.0;
            size += next[i] * next[i];
        }
        value = sqrt(size);
        for (size_t i = 0; i < n; i++)
            mode[i] = next[i] / value;
    }
    free(matrix);
    free(next);
    return value;
}

/* Of a cell by itself, s wide: a spring is 0.4 E s, a corner weighs an eighth of it, and 3 k / m is its largest. */
#define CELL_SQUARE (24.0 * 0.4 * 5000.0 / (1000.0 * 0.01 * 0.01))

/* told: 1/s^2, what the net says of its frequencies; 0: nothing. */
static void make_told_lattice(struct made_net *net, double viscosity, double told)
{
    dpt_springs_def def = def_of(DPT_INTEGRATOR_SYMPLECTIC);
    net_block(net, 3, 3, 3, 0.01, 5000.0, 1000.0);
    for (uint32_t i = 0; i < 9; i++)
        net_fix(net, i);
    net->viscosity = viscosity;
    CHECK(net_open(net, &def) == DPT_OK, "not made");
    net->rows.square = told;
    CHECK(net_reopen(net, &def) == DPT_OK, "not made");
}

static void make_lattice(struct made_net *net, double viscosity)
{
    make_told_lattice(net, viscosity, 0.0);
}

/* How far along a mode the nodes are. */
static double along(const struct made_net *net, const double *mode)
{
    const float *x = net_positions(net);
    double sum = 0.0;
    for (size_t i = 0; i < 3 * (size_t)net->nodes; i++)
        sum += ((double)x[i] - (double)net->rest[i]) * mode[i];
    return sum;
}

/*
 * By what factor a small motion along the fastest mode grows in a step of h; 1 if it does not grow in 400 steps. Springs
 * are taken where nodes will be after the viscosity's time, so that they see more of the motion than nodes do.
 */
static double growth_at(const struct made_net *net, const double *mode, double h)
{
    const double far = 3e-4 / (1.0 + 2.0 * net->viscosity / h);
    float start[81];
    for (size_t i = 0; i < 81; i++)
        start[i] = net->rest[i] + (float)(far / 150.0 * mode[i]);
    CHECK(dpt_springs_set_nodes(net->made, 0, net->nodes, start, NULL) == DPT_OK, "not moved");
    double last = fabs(along(net, mode)), growth = 1.0;
    for (int i = 0; i < 400; i++) {
        CHECK(dpti_springs_substeps(net->made, h, 1), "refused");
        const double now = fabs(along(net, mode));
        if (now > far)
            return growth;
        growth = now > far / 15.0 ? now / last : growth;
        last = now;
    }
    return 1.0;
}

/*
 * By what factor a small motion along a mode changes in a step, if it swings: of a(n) = r^n cos(n p + q), the numbers
 * a(n)^2 - a(n - 1) a(n + 1) are r^2n sin(p)^2. A swing that fades is followed to a thirtieth: then others are left.
 */
static double swing_at(const struct made_net *net, const double *mode, double h, double amount)
{
    float start[81];
    double a[3] = { amount, amount, amount }, first = 0.0, count = 0.0;
    double n = 0.0, nn = 0.0, y = 0.0, ny = 0.0; /* sums, for the line through log(size) */
    for (size_t i = 0; i < 81; i++)
        start[i] = net->rest[i] + (float)(amount * mode[i]);
    CHECK(dpt_springs_set_nodes(net->made, 0, net->nodes, start, NULL) == DPT_OK, "not moved");
    for (int i = 0; i < 4000; i++) {
        const int is_free = net->made->def.integrator == DPT_INTEGRATOR_IMPLICIT
                                ? dpt_springs_step(net->made, h, NULL, 0, NULL) == DPT_OK
                                : dpti_springs_substeps(net->made, h, 1);
        CHECK(is_free, "refused");
        a[0] = a[1], a[1] = a[2], a[2] = along(net, mode);
        const double size = a[1] * a[1] - a[0] * a[2];
        if (i < 2 || !(size > 0.0))
            continue;
        if (size > 1e-7 || size < 1e-3 * first)
            break;
        first = count > 0.0 ? first : size;
        count += 1.0;
        n += i;
        nn += (double)i * i;
        y += log(size);
        ny += i * log(size);
    }
    return count > 3.0 ? exp(0.5 * (count * ny - n * y) / (count * nn - n * n)) : 0.0;
}

/* Undamped; damped, and still swinging; damped so that it does not. The fastest mode has about 518 rad/s. */
static void lattices_grow_as_their_matrix_says(void)
{
    const double dampings[] = { 0.0, 0.2, 4.0 }, about = 518.0;
    for (int i = 0; i < 3; i++) {
        double mode[81];
        struct made_net net = { 0 };
        make_lattice(&net, dampings[i] / about);
        const double square = fastest_mode(&net, mode), t = net.viscosity;
        const double limit = dpti_springs_limit(DPT_INTEGRATOR_SYMPLECTIC, square, t, 0.0);
        CHECK(square <= net.made->square, "%g is beyond the bound %g", square, net.made->square);
        printf("    t w = %.2f: a step of %.6f s at most, %.6f computed\n", t * sqrt(square), limit,
               net.made->stable_step);
        CHECK(i != 2 || t * sqrt(square) > 2.0, "not overdamped");
        CHECK(growth_at(&net, mode, 0.99 * limit) == 1.0, "grows at 0.99 of the limit");
        CHECK(growth_at(&net, mode, 1.02 * limit) > 1.02, "does not grow at 1.02 of the limit");
        for (double share = 1.05; share < 1.35; share += 0.05) {
            const double seen = growth_at(&net, mode, share * limit);
            const double expected = mode_growth(DPT_INTEGRATOR_SYMPLECTIC, square, t, 0.0, share * limit);
            CHECK(fabs(seen / expected - 1.0) < 0.01, "t %g: grows by %g, not %g, at %g", t, seen, expected, share);
        }
        net_close(&net);
    }
}

/* 1/s2: how stiff springs would be along a mode if they were as stiff across as along. */
static double stiffest(const struct made_net *net, const double *mode)
{
    double sum = 0.0, mass = 0.0;
    for (uint32_t i = 0; i < net->springs; i++)
        for (size_t k = 0; k < 3; k++) {
            const struct net_spring *spring = &net->list[i];
            const double d = mode[3 * spring->b + k] - mode[3 * spring->a + k];
            sum += spring->stiffness * d * d;
        }
    for (size_t i = 0; i < 3 * (size_t)net->nodes; i++)
        mass += (double)net->mass[i / 3] * mode[i] * mode[i];
    return sum / mass;
}

/*
 * EULER gains what its matrix says. IMPLICIT takes springs as stiff across as along: of a mode with w^2, which then would
 * have l, g = h^2 w^2 / (1 + h^2 l) is lost in a step, and r^2 = 1 - g. Backward Euler has l = w^2.
 */
static void others_grow_and_fade_as_their_matrix_says(void)
{
    const double shares[] = { 0.3, 0.6, 0.05, 0.2, 0.8 };
    for (int i = 0; i < 5; i++) {
        const int implicit = i >= 2;
        double mode[81];
        struct made_net net = { 0 };
        dpt_springs_def def = def_of(implicit ? DPT_INTEGRATOR_IMPLICIT : DPT_INTEGRATOR_EULER);
        def.iterations = 64;
        make_lattice(&net, 0.0);
        const double square = fastest_mode(&net, mode), h = shares[i] / sqrt(square);
        CHECK(net_reopen(&net, &def) == DPT_OK, "not made");
        const double seen = swing_at(&net, mode, h, implicit ? 3e-4 : 1e-5);
        const double g = h * h * square / (1.0 + h * h * stiffest(&net, mode));
        const double expected = implicit ? sqrt(1.0 - g) : mode_growth(DPT_INTEGRATOR_EULER, square, 0.0, 0.0, h);
        printf("    integrator %u, h w = %.2f: %.5f a step, expected %.5f\n", def.integrator, shares[i], seen,
               expected);
        CHECK(fabs(log(seen) / log(expected) - 1.0) < 0.04 && fabs(seen / expected - 1.0) < 0.01,
              "integrator %u, h %g: %g a step, not %g", def.integrator, h, seen, expected);
        net_close(&net);
    }
}

/* The largest energy of a lattice over many steps, of what it had. amount: m, by which nodes are thrown about. */
static double highest_energy(double squeeze, double amount, double share, int is_public, double told)
{
    const uint64_t steps = part_of(told > 0.0 ? 30000 : 100000);
    uint64_t seed = 11;
    struct made_net net = { 0 };
    float start[81];
    double elastic, kinetic, first, highest = 0.0;
    make_told_lattice(&net, told > 0.0 ? 4e-4 : 0.0, told);
    for (size_t i = 0; i < 81; i++)
        start[i] = i < 27 ? net.rest[i] : (float)(squeeze * (double)net.rest[i] + random_in(&seed, -amount, amount));
    CHECK(dpt_springs_set_nodes(net.made, 0, net.nodes, start, NULL) == DPT_OK, "not moved");
    dpt_springs_get_energy(net.made, &elastic, &kinetic);
    first = elastic + kinetic;
    const double h = share * net.made->stable_step;
    for (uint64_t i = 0; i < steps; i++) {
        if (is_public ? dpt_springs_step(net.made, h, NULL, 0, NULL) != DPT_OK
                      : !dpti_springs_substeps(net.made, h, 1)) {
            highest = HUGE_VAL;
            break;
        }
        dpt_springs_get_energy(net.made, &elastic, &kinetic);
        highest = elastic + kinetic > highest ? elastic + kinetic : highest;
    }
    net_close(&net);
    return highest / first;
}

/*
 * The computed step holds. Of the integrator alone that is asked for strains of up to a tenth, where it keeps its energy;
 * of a body as it is stepped, wherever its nodes may be.
 */
static void nothing_grows_within(double told)
{
    const double small = highest_energy(1.0, 1e-5, 0.95, 0, told);
    const double large = highest_energy(1.0, 1e-3, 0.95, 0, told);
    CHECK(small < 2.0 && large < 2.0, "energy grows %g and %g times", small, large);
    for (double squeeze = 0.2; squeeze < 1.5; squeeze += 0.2)
        for (double amount = 1e-4; amount < 0.02; amount *= 5.0) {
            const double thrown = highest_energy(squeeze, amount, 0.899, 1, told);
            CHECK(thrown < 5.0, "squeezed to %g, thrown by %g: energy grows %g times", squeeze, amount, thrown);
        }
}

static void nothing_grows_within_the_computed_step(void)
{
    nothing_grows_within(0.0);
}

static void nothing_grows_within_the_step_of_a_cell(void)
{
    nothing_grows_within(CELL_SQUARE);
}

/* A frequency that the net tells is taken if it is lower than what rows say, and nothing is seen to swing faster. */
static void what_a_net_tells_is_looked_into(void)
{
    static const double shares[] = { 1.0, 1.2, 2.0, 0.7, 0.1, 1e-9 };
    double mode[81];
    struct made_net net = { 0 };
    make_lattice(&net, 0.0);
    const double rows = net.made->square, fastest = fastest_mode(&net, mode);
    net_close(&net);
    for (size_t i = 0; i < sizeof shares / sizeof *shares; i++) {
        const double told = shares[i] * CELL_SQUARE;
        make_told_lattice(&net, 4e-4, told);
        const double expected = shares[i] >= 1.0 && told < rows ? told : rows;
        CHECK(fabs(net.made->square / expected - 1.0) < 1e-6, "told %g: %g, not %g", told, net.made->square, expected);
        CHECK(fastest <= net.made->square, "%g is beyond %g", fastest, net.made->square);
        net_close(&net);
    }
    make_told_lattice(&net, 2e-4, CELL_SQUARE);
    CHECK(fabs(net.made->square / rows - 1.0) < 1e-6, "%g with little viscosity", net.made->square);
    net_close(&net);
}

/* Substeps are as many as are needed, or the step is refused and nothing moves. */
static void long_steps_are_cut_or_refused(void)
{
    struct made_net net = { 0 };
    dpt_springs_def def = def_of(DPT_INTEGRATOR_SYMPLECTIC);
    dpt_springs_info report = { .size = sizeof report };
    make_lattice(&net, 0.0);
    const double stable = net.made->stable_step;
    for (uint32_t n = 1; n <= 16; n++) {
        CHECK(dpt_springs_step(net.made, 0.8999 * stable * n, NULL, 0, &report) == DPT_OK && report.substeps == n,
              "%u substeps, not %u", report.substeps, n);
        CHECK(dpt_springs_step(net.made, 0.9001 * stable * n, NULL, 0, &report) == (n < 16 ? DPT_OK : DPT_E_UNSTABLE),
              "with %u", n);
    }
    def.integrator = DPT_INTEGRATOR_EULER;
    CHECK(net_reopen(&net, &def) == DPT_OK && net.made->stable_step == 0.0, "a stable step");
    CHECK(dpt_springs_step(net.made, 1e-9, NULL, 0, &report) == DPT_E_UNSTABLE, "Euler steps");
    /* What touches a node makes the step shorter, by as much as one node's row says. */
    def.integrator = DPT_INTEGRATOR_SYMPLECTIC;
    def.contact_stiffness = 1e5;
    CHECK(net_reopen(&net, &def) == DPT_OK, "not made");
    const double lightest = 1000.0 * 1e-6 / 8.0, bound = 2.0 * sqrt(lightest / 1e5);
    CHECK(net.made->stable_step < bound && net.made->stable_step > 0.98 * bound, "%g, not %g", net.made->stable_step,
          bound);
    net_close(&net);
}

/* Any stiffness, any step: energy does not grow, and the block comes to rest where it began. */
static void implicit_steps_never_explode(void)
{
    const double scales[] = { 1.0, 1e2, 1e4, 1e6 }, steps[] = { 1e-4, 1e-3, 1e-2, 0.3 };
    const uint32_t passes[] = { 1, 2, 4, 1024 }, counts[] = { 500, 500, 500, 50 };
    uint64_t seed = 23;
    uint32_t held = 0, all = 0;
    for (int i = 0; i < 4 * 4 * 4 * 2; i++) {
        const double scale = scales[i % 4], dt = steps[i / 4 % 4];
        dpt_springs_def def = def_of(DPT_INTEGRATOR_IMPLICIT);
        dpt_springs_info report = { .size = sizeof report };
        struct made_net net = { 0 };
        float start[81], speed[81];
        double elastic, kinetic, first, highest = 0.0;
        make_lattice(&net, i / 64 ? 1e-3 : 0.0);
        def.stiffness = scale;
        def.iterations = passes[i / 16 % 4];
        CHECK(net_reopen(&net, &def) == DPT_OK, "not made");
        for (size_t k = 0; k < 81; k++) {
            start[k] = net.rest[k] + (float)random_in(&seed, -3e-3, 3e-3);
            start[k] = k < 27 ? net.rest[k] : start[k];
            speed[k] = (float)random_in(&seed, -3.0, 3.0);
        }
        CHECK(dpt_springs_set_nodes(net.made, 0, net.nodes, start, speed) == DPT_OK, "not moved");
        dpt_springs_get_energy(net.made, &elastic, &kinetic);
        first = elastic + kinetic;
        for (uint32_t n = 0; n < counts[i / 16 % 4]; n++) {
            CHECK(dpt_springs_step(net.made, dt, NULL, 0, &report) == DPT_OK, "refused");
            held += report.flags & DPT_SPRINGS_FLAG_HELD;
            all++;
            dpt_springs_get_energy(net.made, &elastic, &kinetic);
            highest = elastic + kinetic > highest ? elastic + kinetic : highest;
        }
        CHECK(highest <= first * (1.0 + 1e-5) + 1e-9, "scale %g, dt %g, %u passes: energy up to %g of %g", scale, dt,
              def.iterations, highest, first);
        net_close(&net);
    }
    printf("    %u of %u steps were held\n", held, all);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(limits_of_one_mode_are_exact);
    TEST(one_mass_is_stable_up_to_its_limit);
    TEST(lattices_grow_as_their_matrix_says);
    TEST(others_grow_and_fade_as_their_matrix_says);
    TEST(nothing_grows_within_the_computed_step);
    TEST(nothing_grows_within_the_step_of_a_cell);
    TEST(what_a_net_tells_is_looked_into);
    TEST(long_steps_are_cut_or_refused);
    TEST(implicit_steps_never_explode);
    return check_report();
}
