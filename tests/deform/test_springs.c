/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Springs against closed forms: a mass on a spring, chains that hang, a membrane, a bar under its weight; momentum and
 * energy. Whether steps are stable is for test_springs_stable.
 */
#include "deform/made_net.h"
#include "oracle/spring_balance.h"

#define PI 3.14159265358979323846

static dpt_springs_def def_of(uint32_t integrator)
{
    dpt_springs_def def;
    dpt_springs_def_init(&def);
    def.integrator = integrator;
    def.sleep_speed = 0.0;
    return def;
}

/* A mass on a spring along x: a period takes 2 pi sqrt(m / k), and energy stays within h w / 2 of what it was. */
static void a_mass_swings(void)
{
    const double k = 40.0, m = 0.1, w = sqrt(k / m), h = 1e-4, away = 0.01;
    struct made_net net = { 0 };
    dpt_springs_def def = def_of(DPT_INTEGRATOR_SYMPLECTIC);
    net_fix(&net, net_node(&net, 0.0, 0.0, 0.0, 1.0));
    net_node(&net, 1.0, 0.0, 0.0, m);
    net_spring(&net, 0, 1, k, 1.0);
    CHECK(net_open(&net, &def) == DPT_OK, "not made");
    CHECK(fabs(dpt_springs_get_stable_step(net.made) - 2.0 / w) < 1e-7, "stable %g, not %g",
          dpt_springs_get_stable_step(net.made), 2.0 / w);
    const float start[3] = { (float)(1.0 + away), 0.0f, 0.0f };
    CHECK(dpt_springs_set_nodes(net.made, 1, 1, start, NULL) == DPT_OK, "not moved");
    double last = away, elastic, kinetic, least = 1e9, most = 0.0, first = -1.0, cross = 0.0;
    uint32_t crossings = 0;
    for (uint32_t i = 1; i <= 31416; i++) {
        net_steps(&net, h, 1);
        const double x = (double)net_positions(&net)[3] - 1.0;
        if (last > 0.0 && x <= 0.0) {
            cross = ((double)i - 1.0 + last / (last - x)) * h;
            first = crossings++ ? first : cross;
        }
        last = x;
        dpt_springs_get_energy(net.made, &elastic, &kinetic);
        least = elastic + kinetic < least ? elastic + kinetic : least;
        most = elastic + kinetic > most ? elastic + kinetic : most;
    }
    const double period = (cross - first) / (crossings - 1.0), true_period = 2.0 * PI / w;
    CHECK(fabs(period / true_period - 1.0) < w * w * h * h / 24.0 + 2e-6, "period %.9f, not %.9f", period, true_period);
    const double energy = 0.5 * k * away * away;
    /* The least viscosity, of h / 100, takes w^2 h / 100 of it in a second. */
    const double kept = exp(-0.01 * h * w * w * 31416.0 * h);
    CHECK(most < energy * (1.0 + 0.51 * h * w) && least > kept * energy * (1.0 - 0.51 * h * w), "energy %g to %g of %g",
          least, most, energy);
    net_close(&net);
}

/*
 * The same, beside each integrator's own formula in double. Energy fades or grows by what the formula's eigenvalues say:
 * w^2 (t + h) a second with IMPLICIT, w^2 (t - h) with EULER, where t is the viscosity.
 */
static void a_mass_swings_by_its_formula(uint32_t integrator)
{
    const double k = 40.0, m = 0.1, w2 = k / m, h = 1e-3, away = 0.01, drag = 0.3;
    const uint32_t steps = 1000;
    struct made_net net = { 0 };
    dpt_springs_def def = def_of(integrator);
    def.iterations = 2;
    net_fix(&net, net_node(&net, 0.0, 0.0, 0.0, 1.0));
    net_node(&net, 1.0, 0.0, 0.0, m);
    net_spring(&net, 0, 1, k, 1.0);
    net_drag(&net, drag);
    net.viscosity = 3e-3;
    CHECK(net_open(&net, &def) == DPT_OK, "not made");
    const float start[3] = { (float)(1.0 + away), 0.0f, 0.0f };
    CHECK(dpt_springs_set_nodes(net.made, 1, 1, start, NULL) == DPT_OK, "not moved");
    double x = away, v = 0.0, worst = 0.0;
    for (uint32_t i = 0; i < steps; i++) {
        const double t = net.viscosity, pull = -h * w2 * (x + t * v), before = v;
        v = integrator == DPT_INTEGRATOR_IMPLICIT ? (v - h * w2 * x) / (1.0 + h * drag + h * w2 * (t + h))
                                                  : (v + pull) / (1.0 + h * drag);
        x += h * (integrator == DPT_INTEGRATOR_EULER ? before : v);
        net_steps(&net, h, 1);
        worst = fmax(worst, fabs((double)net_positions(&net)[3] - 1.0 - x));
    }
    /* Swings are as large as exp of half of that. */
    const double sign = integrator == DPT_INTEGRATOR_IMPLICIT ? h : integrator == DPT_INTEGRATOR_EULER ? -h : 0.0;
    const double kept = exp(-(w2 * (net.viscosity + sign) + drag) * steps * h);
    const double left = (x * x + v * v / w2) / (away * away);
    CHECK(worst < 2e-5 * away, "integrator %u: off its formula by %g m", integrator, worst);
    CHECK(fabs(log(left) / log(kept) - 1.0) < 0.03, "integrator %u keeps %g of energy, not %g", integrator, left, kept);
    net_close(&net);
}

static void masses_swing_by_their_formulas(void)
{
    a_mass_swings_by_its_formula(DPT_INTEGRATOR_SYMPLECTIC);
    a_mass_swings_by_its_formula(DPT_INTEGRATOR_EULER);
    a_mass_swings_by_its_formula(DPT_INTEGRATOR_IMPLICIT);
}

/* Step until it rests: drag slows it down. */
static void settle(struct made_net *net, double dt, uint32_t steps)
{
    double elastic, kinetic = 1.0;
    for (uint32_t i = 0; i < steps; i++)
        net_steps(net, dt, 1);
    dpt_springs_get_energy(net->made, &elastic, &kinetic);
    CHECK(kinetic < 1e-7 * (elastic + 1e-9), "still moves: %g of %g J", kinetic, elastic);
}

/*
 * A chain between two points. In the tension of each spring the horizontal part H is the same, and the vertical part
 * falls by m g at each mass: with H known, all places follow. H is what makes the span right.
 */
enum { LINKS = 24 };

static double chain_span(double pull, double k, double length, double weight, double place[LINKS + 1][2])
{
    place[0][0] = place[0][1] = 0.0;
    for (int i = 0; i < LINKS; i++) {
        const double up = weight * (0.5 * (LINKS - 1) - i), size = sqrt(pull * pull + up * up);
        place[i + 1][0] = place[i][0] + (length + size / k) * pull / size;
        place[i + 1][1] = place[i][1] - (length + size / k) * up / size;
    }
    return place[LINKS][0];
}

static void a_chain_hangs(uint32_t integrator)
{
    const double length = 0.05, span = 0.9, k = 50.0, m = 0.01, g = 9.81;
    double place[LINKS + 1][2], low = 1e-3, high = 1e3, worst = 0.0;
    struct made_net net = { 0 };
    dpt_springs_def def = def_of(integrator);
    def.gravity[1] = -g;
    for (int i = 0; i <= LINKS; i++)
        net_node(&net, span * i / LINKS, 0.0, 0.0, m);
    for (uint32_t i = 0; i < LINKS; i++)
        net_spring(&net, i, i + 1, k, length);
    net_drag(&net, 3.0);
    net.viscosity = integrator == DPT_INTEGRATOR_EULER ? 1e-3 : 0.0;
    net_fix(&net, 0);
    net_fix(&net, LINKS);
    CHECK(net_open(&net, &def) == DPT_OK, "not made");
    for (int i = 0; i < 200; i++) {
        const double middle = sqrt(low * high);
        *(chain_span(middle, k, length, m * g, place) < span ? &low : &high) = middle;
    }
    settle(&net, 2e-3, 12000);
    const float *at = net_positions(&net);
    for (int i = 0; i <= LINKS; i++)
        for (int row = 0; row < 2; row++) {
            const double off = fabs((double)at[3 * i + row] - place[i][row]);
            worst = off > worst ? off : worst;
        }
    CHECK(worst < 1e-6 * span, "chain off by %g m, integrator %u", worst, integrator);
    net_close(&net);
}

static void chains_hang_as_computed(void)
{
    a_chain_hangs(DPT_INTEGRATOR_SYMPLECTIC);
    a_chain_hangs(DPT_INTEGRATOR_EULER);
    a_chain_hangs(DPT_INTEGRATOR_IMPLICIT);
}

/*
 * A square membrane under tension T a spring, with fixed edges. Its lowest mode across is sin sin, with the squared
 * frequency 8 T / (m s) sin^2(pi / 2n); a continuum has 2 pi^2 T / (m n^2 s).
 */
static void a_plucked_membrane_sounds(uint32_t integrator)
{
    enum { N = 16 };
    const double s = 0.01, k = 30.0, rest = 0.8 * s, tension = k * (s - rest), m = 1e-4, h = 1e-4;
    const double part = sin(0.5 * PI / N), w = sqrt(8.0 * tension / (m * s)) * part;
    const double continuum = sqrt(2.0 * PI * PI * tension / (m * N * N * s));
    struct made_net net = { 0 };
    dpt_springs_def def = def_of(integrator);
    net.viscosity = integrator == DPT_INTEGRATOR_EULER ? 2e-4 : 0.0;
    for (uint32_t y = 0; y <= N; y++)
        for (uint32_t x = 0; x <= N; x++)
            net_node(&net, s * x, s * y, 0.0, x % N && y % N ? m : 0.0);
    for (uint32_t y = 0; y <= N; y++)
        for (uint32_t x = 0; x <= N; x++) {
            const uint32_t node = x + (N + 1) * y;
            if (x < N)
                net_spring(&net, node, node + 1, k, rest);
            if (y < N)
                net_spring(&net, node, node + N + 1, k, rest);
        }
    CHECK(net_open(&net, &def) == DPT_OK, "not made");
    float plucked[3 * (N + 1) * (N + 1)];
    memcpy(plucked, net_positions(&net), sizeof plucked);
    for (uint32_t node = 0; node < net.nodes; node++)
        plucked[3 * node + 2] =
            (float)(1e-3 * s * sin(PI * (node % (N + 1)) / N) * sin(PI * (double)(node / (N + 1)) / N));
    CHECK(dpt_springs_set_nodes(net.made, 0, net.nodes, plucked, NULL) == DPT_OK, "not plucked");
    const uint32_t middle = N / 2 * (N + 1) + N / 2;
    double last = 1.0, first = -1.0, cross = 0.0;
    uint32_t crossings = 0;
    for (uint32_t i = 1; i <= 10000; i++) {
        net_steps(&net, h, 1);
        const double z = (double)net_positions(&net)[3 * middle + 2];
        if (last > 0.0 && z <= 0.0) {
            cross = ((double)i - 1.0 + last / (last - z)) * h;
            first = crossings++ ? first : cross;
        }
        last = z;
    }
    const double seen = 2.0 * PI * (crossings - 1.0) / (cross - first);
    CHECK(crossings > 5 && fabs(seen / w - 1.0) < 1e-3, "integrator %u: %g rad/s, not %g", integrator, seen, w);
    CHECK(fabs(seen / continuum - 1.0) < 3e-3, "integrator %u: %g rad/s, continuum %g", integrator, seen, continuum);
    net_close(&net);
}

static void plucked_membranes_sound(void)
{
    a_plucked_membrane_sounds(DPT_INTEGRATOR_SYMPLECTIC);
    a_plucked_membrane_sounds(DPT_INTEGRATOR_EULER);
    a_plucked_membrane_sounds(DPT_INTEGRATOR_IMPLICIT);
}

/* Where a net is in balance under a load by mass (oracle/spring_balance.h). */
static void balance(const struct made_net *net, const double load[3], double *x)
{
    struct oracle_spring *list = malloc(net->springs * sizeof *list);
    double *force = malloc(3 * (size_t)net->nodes * sizeof *force);
    const struct oracle_springs springs = { net->nodes, net->springs, list, net->mass, force };
    for (uint32_t i = 0; i < net->springs; i++)
        list[i] = (struct oracle_spring){ net->list[i].a, net->list[i].b, net->list[i].stiffness, net->list[i].length };
    for (size_t i = 0; i < 3 * (size_t)net->nodes; i++) {
        force[i] = (double)net->mass[i / 3] * load[i % 3];
        x[i] = (double)net->rest[i];
    }
    const double left = oracle_spring_balance(&springs, 1.0, x);
    CHECK(left >= 0.0 && left < 1e-9, "the oracle's last step was %g m", left);
    free(list);
    free(force);
}

/* A bar that hangs from its top face, against what Newton's method finds. */
static void a_bar_hangs(uint32_t integrator)
{
    const double s = 0.01, g = 2.0, length = 8.0 * s, load[3] = { 0.0, 0.0, -g };
    const uint32_t layer = 9;
    struct made_net net = { 0 };
    dpt_springs_def def = def_of(integrator);
    double worst = 0.0;
    def.gravity[2] = -g;
    def.iterations = 8;
    net_block(&net, 3, 3, 9, s, 5000.0, 1000.0);
    net_drag(&net, 30.0);
    net.viscosity = integrator == DPT_INTEGRATOR_EULER ? 1e-3 : 0.0;
    for (uint32_t i = 0; i < layer; i++)
        net_fix(&net, net.nodes - 1 - i);
    CHECK(net_open(&net, &def) == DPT_OK, "not made");
    settle(&net, 1e-3, 4000);
    const float *at = net_positions(&net);
    double *x = malloc(3 * (size_t)net.nodes * sizeof *x);
    balance(&net, load, x);
    for (size_t i = 0; i < 3 * (size_t)net.nodes; i++)
        worst = fabs((double)at[i] - x[i]) > worst ? fabs((double)at[i] - x[i]) : worst;
    CHECK(fabs(x[2] + 1.0 * g * 1000.0 * length * length / (2.0 * 5000.0)) < 2e-4 && worst < 1e-6 * length,
          "bar off by %g m, integrator %u", worst, integrator);
    free(x);
    net_close(&net);
}

static void bars_hang_as_computed(void)
{
    a_bar_hangs(DPT_INTEGRATOR_SYMPLECTIC);
    a_bar_hangs(DPT_INTEGRATOR_EULER);
    a_bar_hangs(DPT_INTEGRATOR_IMPLICIT);
}

/*
 * A bar in the continuum: its two halves weigh away from its middle, where it is free to grow thinner. The axis of each
 * half is rho g L^2 / (2 E) longer. Returns by how much of that it is off: what is left is the bar's growing thinner,
 * which for strains of 0.3 % is the same at all densities; the lattice itself is exact here.
 */
static double stretch_bar(uint32_t cells)
{
    const double width = 0.02, e = 5000.0, density = 1000.0, g = 0.2, s = width / cells;
    const uint32_t across = cells + 1, along = 8 * cells + 1, layer = across * across;
    const double length = 4.0 * width, theory = density * g * length * length / (2.0 * e);
    struct made_net net = { 0 };
    dpt_springs_def def = def_of(DPT_INTEGRATOR_IMPLICIT);
    def.iterations = 8;
    net_block(&net, across, across, along, s, e, density);
    net_drag(&net, 30.0);
    CHECK(net_open(&net, &def) == DPT_OK, "not made");
    dpt_load *loads = calloc(net.nodes, sizeof *loads);
    for (uint32_t i = 0; i < net.nodes; i++) {
        const uint32_t level = i / layer, middle = along / 2;
        loads[i].vertex = i;
        if (level != middle)
            loads[i].force[2] = (double)net.mass[i] * (level < middle ? -g : g);
    }
    for (int i = 0; i < 4000; i++)
        CHECK(dpt_springs_step(net.made, 1e-3, loads, net.nodes, NULL) == DPT_OK, "no step");
    const float *at = net_positions(&net);
    const uint32_t axis = layer / 2, top = net.nodes - layer + axis;
    const double longer = (double)at[3 * top + 2] - (double)at[3 * axis + 2] - 2.0 * length;
    free(loads);
    net_close(&net);
    return 0.5 * longer / theory - 1.0;
}

static void a_bar_is_a_continuum(void)
{
    const double coarse = stretch_bar(2), fine = stretch_bar(4);
    printf("    a bar of 2 cells across is off by %.2f %%, of 4 by %.2f %%\n", 100.0 * coarse, 100.0 * fine);
    CHECK(fabs(coarse) < 2e-3 && fabs(fine) < 2e-3, "off by %g, then by %g", coarse, fine);
}

/* A bar that hangs from a face which cannot grow thinner: how much longer it is, of rho g L^2 / (2 E). */
static double hang_bar(uint32_t cells)
{
    const double width = 0.02, e = 5000.0, density = 1000.0, g = 0.2, s = width / cells;
    const uint32_t across = cells + 1, along = 4 * cells + 1, layer = across * across;
    const double length = 4.0 * width, theory = density * g * length * length / (2.0 * e);
    struct made_net net = { 0 };
    dpt_springs_def def = def_of(DPT_INTEGRATOR_IMPLICIT);
    def.iterations = 16;
    def.gravity[2] = -g;
    net_block(&net, across, across, along, s, e, density);
    net_drag(&net, 30.0);
    for (uint32_t i = 0; i < layer; i++)
        net_fix(&net, net.nodes - 1 - i);
    CHECK(net_open(&net, &def) == DPT_OK, "not made");
    settle(&net, 2e-3, 1500);
    const double longer = -(double)net_positions(&net)[3 * (layer / 2) + 2];
    net_close(&net);
    return longer / theory;
}

/* Its error falls with density: by more than two as cells are halved. Smooth strains would give four; here they have no
 * bound at the edge of the face that is held. */
static void a_held_bar_nears_a_continuum(void)
{
    const double found[] = { hang_bar(2), hang_bar(4), hang_bar(8) };
    const double first = found[1] - found[0], second = found[2] - found[1];
    const double limit = found[2] + second * second / (first - second);
    printf("    2, 4, 8 cells across: off by %.2f, %.2f, %.2f %% of their limit, %.4f\n",
           100.0 * (found[0] / limit - 1.0), 100.0 * (found[1] / limit - 1.0), 100.0 * (found[2] / limit - 1.0), limit);
    CHECK(second / first > 0.2 && second / first < 0.45, "%g, then %g", first, second);
    CHECK(fabs(found[0] / limit - 1.0) < 0.02 && fabs(found[2] / limit - 1.0) < 0.003, "off by %g, %g",
          found[0] / limit - 1.0, found[2] / limit - 1.0);
    CHECK(limit > 0.95 && limit < 1.0, "%g of a slender bar", limit);
}

/* A free block that turns and swings: momentum, moment of momentum, energy. */
static void a_free_block_keeps_what_it_has(uint32_t integrator, double moment_share, double energy_share)
{
    struct made_net net = { 0 };
    dpt_springs_def def = def_of(integrator);
    float speed[3 * 64];
    double before[6] = { 0 }, after[6] = { 0 }, elastic, kinetic;
    net_block(&net, 4, 4, 4, 0.01, 5000.0, 1000.0);
    net.viscosity = integrator == DPT_INTEGRATOR_EULER ? 3e-3 : 0.0;
    CHECK(net_open(&net, &def) == DPT_OK, "not made");
    for (uint32_t i = 0; i < net.nodes; i++) {
        const float x = net.rest[3 * i] - 0.015f, y = net.rest[3 * i + 1] - 0.015f;
        speed[3 * i] = 0.1f - 5.0f * y + 2.0f * x;
        speed[3 * i + 1] = 0.02f + 5.0f * x;
        speed[3 * i + 2] = -0.03f;
    }
    CHECK(dpt_springs_set_nodes(net.made, 0, net.nodes, net.rest, speed) == DPT_OK, "no speed");
    dpt_springs_get_energy(net.made, &elastic, &kinetic);
    const double start = elastic + kinetic;
    double size = 0.0, spin = 0.0, highest = 0.0;
    for (int pass = 0; pass < 2; pass++) {
        const float *v = net_speeds(&net), *x = net_positions(&net);
        double *sum = pass ? after : before;
        for (uint32_t i = 0; i < net.nodes; i++) {
            const double m = (double)net.mass[i];
            for (uint32_t k = 0; k < 3; k++) {
                const uint32_t a = 3 * i + (k + 1) % 3, b = 3 * i + (k + 2) % 3;
                sum[k] += m * (double)v[3 * i + k];
                sum[3 + k] += m * ((double)x[a] * (double)v[b] - (double)x[b] * (double)v[a]);
            }
        }
        for (int i = 0; i < 1000 && !pass; i++) {
            net_steps(&net, 1e-3, 1);
            dpt_springs_get_energy(net.made, &elastic, &kinetic);
            highest = elastic + kinetic > highest ? elastic + kinetic : highest;
        }
    }
    for (int k = 0; k < 3; k++) {
        size += fabs(before[k]);
        spin += fabs(before[3 + k]);
    }
    for (int k = 0; k < 3; k++) {
        CHECK(fabs(after[k] - before[k]) < 1e-5 * size, "momentum %d: %g, was %g", k, after[k], before[k]);
        CHECK(fabs(after[3 + k] - before[3 + k]) < moment_share * spin, "moment %d: %g, was %g", k, after[3 + k],
              before[3 + k]);
    }
    CHECK(highest <= start * (1.0 + energy_share), "energy up to %g, was %g", highest, start);
    printf("    integrator %u: moment %.2g of %.2g, energy %.4f of %.4f, highest %.4f mJ\n", integrator,
           after[5] - before[5], spin, 1e3 * (elastic + kinetic), 1e3 * start, 1e3 * highest);
    net_close(&net);
}

static void free_blocks_keep_what_they_have(void)
{
    a_free_block_keeps_what_it_has(DPT_INTEGRATOR_SYMPLECTIC, 1e-4, 0.02);
    a_free_block_keeps_what_it_has(DPT_INTEGRATOR_EULER, 0.2, 1e-6);
    a_free_block_keeps_what_it_has(DPT_INTEGRATOR_IMPLICIT, 0.2, 1e-6);
}

/*
 * A free body under its weight, with drag d: v = (v + h g) / (1 + h d) in each step of h, however stiff it is and however
 * few passes IMPLICIT has. IMPLICIT has to learn of it: a few steps are allowed.
 */
static void what_falls_falls_freely(void)
{
    const double stiff[] = { 1.0, 1e3, 1e6 }, drag = 2.0, h = 1e-3, g = -9.81;
    for (uint32_t of = 0; of < 6; of++) {
        struct made_net net;
        double z = 0.0, v = 0.0, middle = 0.0, mass = 0.0;
        dpt_springs_def def;
        dpt_springs_def_init(&def);
        def.integrator = of < 3 ? DPT_INTEGRATOR_IMPLICIT : DPT_INTEGRATOR_SYMPLECTIC;
        def.stiffness = stiff[of % 3];
        def.gravity[2] = g;
        def.max_substeps = 65535;
        memset(&net, 0, sizeof net);
        net_block(&net, 5, 4, 7, 0.01, 5000.0, 1000.0);
        net_drag(&net, drag);
        CHECK(net_open(&net, &def) == DPT_OK, "not made");
        for (int i = 0; i < 100; i++) {
            CHECK(dpt_springs_step(net.made, h, NULL, 0, NULL) == DPT_OK, "no step");
            v = (v + h * g) / (1.0 + h * drag);
            z += h * v;
        }
        for (uint32_t i = 0; i < net.nodes; i++) {
            mass += (double)net.mass[i];
            middle += (double)net.mass[i] * (double)(net_positions(&net)[3 * i + 2] - net.rest[3 * i + 2]);
        }
        CHECK(fabs(middle / mass / z - 1.0) < 0.01, "integrator %u, stiffness %g: %g m, not %g", def.integrator,
              def.stiffness, middle / mass, z);
        net_close(&net);
    }
}

/* IMPLICIT: energy is never more than it was and what loads and gravity did, at any stiffness and step. */
static void implicit_energy_grows_by_work_alone(void)
{
    const double scales[] = { 1.0, 1e2, 1e4 }, steps[] = { 1e-3, 1e-2, 0.1 };
    uint64_t seed = 41;
    for (int i = 0; i < 9; i++) {
        const double scale = scales[i % 3], dt = steps[i / 3], push = 0.3 * scale;
        struct made_net net = { 0 };
        dpt_springs_def def = def_of(DPT_INTEGRATOR_IMPLICIT);
        double work = 0.0, gained = 0.0, over = -HUGE_VAL, elastic, kinetic;
        def.stiffness = scale;
        def.gravity[2] = -9.81;
        net_block(&net, 4, 4, 4, 0.01, 5000.0, 1000.0);
        for (uint32_t k = 0; k < 16; k++)
            net_fix(&net, k);
        CHECK(net_open(&net, &def) == DPT_OK, "not made");
        float start[3 * 64], speed[3 * 64];
        for (uint32_t k = 0; k < 3 * 64; k++) {
            start[k] = net.rest[k] + (k < 48 ? 0.0f : (float)random_in(&seed, -4e-3, 4e-3));
            speed[k] = (float)random_in(&seed, -3.0, 3.0);
        }
        CHECK(dpt_springs_set_nodes(net.made, 0, 64, start, speed) == DPT_OK, "not thrown");
        dpt_springs_get_energy(net.made, &elastic, &kinetic);
        const double first = elastic + kinetic;
        for (int n = 0; n < 300; n++) {
            float before[3 * 64];
            dpt_load loads[4] = { { .vertex = 0 } };
            memcpy(before, net_positions(&net), sizeof before);
            for (uint32_t k = 0; k < 4; k++) {
                loads[k].vertex = 16 + (uint32_t)random_in(&seed, 0.0, 47.99);
                for (int row = 0; row < 3; row++)
                    loads[k].force[row] = random_in(&seed, -push, push);
            }
            CHECK(dpt_springs_step(net.made, dt, loads, 4, NULL) == DPT_OK, "refused");
            const float *after = net_positions(&net);
            for (uint32_t k = 0; k < 4; k++)
                for (uint32_t row = 0; row < 3; row++) {
                    const uint32_t at = 3 * loads[k].vertex + row;
                    work += loads[k].force[row] * ((double)after[at] - (double)before[at]);
                }
            for (uint32_t k = 0; k < net.nodes; k++)
                work -= 9.81 * (double)net.mass[k] * ((double)after[3 * k + 2] - (double)before[3 * k + 2]);
            dpt_springs_get_energy(net.made, &elastic, &kinetic);
            gained = fmax(gained, elastic + kinetic);
            over = fmax(over, elastic + kinetic - first - work);
        }
        CHECK(gained > 0.0 && over <= 1e-5 * fmax(first, gained) + 1e-8,
              "stiffness %g, dt %g: %g J beyond the work, of %g", scale, dt, over, gained);
        net_close(&net);
    }
}

int main(void)
{
    TEST(a_mass_swings);
    TEST(masses_swing_by_their_formulas);
    TEST(chains_hang_as_computed);
    TEST(plucked_membranes_sound);
    TEST(bars_hang_as_computed);
    TEST(a_bar_is_a_continuum);
    TEST(a_held_bar_nears_a_continuum);
    TEST(free_blocks_keep_what_they_have);
    TEST(what_falls_falls_freely);
    TEST(implicit_energy_grows_by_work_alone);
    return check_report();
}
