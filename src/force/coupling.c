/* SPDX-License-Identifier: BSD-3-Clause */
/* The stiffest coupling of a sampled device (coupling.h): docs/algorithms/coupling.md. */
#include <math.h>
#include <string.h>

#include "base/return_if_error.h"
#include "base/sized.h"
#include "base/vec3.h"
#include "dynpoint/coupling.h"

/* ---- sampled loops ---- */

/*
 * Is a sampled loop stable? A device of one or two coordinates, each a mass with viscous damping, is held by a spring and
 * a damper that a computer samples and whose force stands still in between: docs/algorithms/coupling.md.
 */

/* Delays of more periods are modelled by longer periods. */
enum { SAMPLED_PERIODS_MAX = 16 };

/* How a mass moves over one period, in units of the mass and the period. */
struct sampled_axis {
    double decay;       /* of its velocity */
    double gliding;     /* how far a velocity of 1 carries it */
    double position[2]; /* what the newer and the older command add to the position */
    double velocity[2]; /* and to the velocity */
    double unit;        /* period^2 / mass: a stiffness times that has no unit */
};

struct sampled_loop {
    struct sampled_axis axis[2];
    double period; /* s */
    int delay;     /* whole periods */
};

/* What holds two coordinates: a stiffness, symmetric and not negative, and a damper in proportion to it. */
struct sampled_spring {
    double along[2], between;
    double damping_time; /* s: damping / stiffness */
    int leaves_free;     /* 1: one direction is not held, so the stiffness' determinant is 0 */
};

/* Of one coordinate: (z - 1) (z - decay) z^(delay + 2). */
enum { AXIS_DEGREE_MAX = SAMPLED_PERIODS_MAX + 4, COEFFICIENTS_MAX = 2 * AXIS_DEGREE_MAX + 1 };

/*
 * The motion of a mass of 1 with damping c over a time t, by the functions (Hochbruck and Ostermann 2010) of y = c t
 *     e = exp(-y)      phi1 = (1 - e) / y      phi2 = (1 - phi1) / y
 * Velocity v and a constant force f change the position by phi1 t v + phi2 t^2 f, and the velocity to e v + phi1 t f.
 */
struct decay {
    double e, phi1, phi2;
};

/* From here on exp(-y) is 0 beside 1. */
#define FORGOTTEN 100.0

static struct decay decay_of(double y)
{
    struct decay of = { 1.0, 1.0, 0.5 };
    double part = y, term = 1.0;
    int doublings = 0;
    if (y > FORGOTTEN)
        return (struct decay){ 0.0, 1.0 / y, (1.0 - 1.0 / y) / y };
    for (; part > 0.1; part *= 0.5)
        doublings++;
    for (int n = 1; n <= 10; n++) {
        term *= -part / n;
        of.e += term;
        of.phi1 += term / (n + 1);
        of.phi2 += term / ((n + 1) * (n + 2));
    }
    for (; doublings > 0; doublings--)
        of.e *= of.e;
    if (y > 0.1) {
        of.phi1 = (1.0 - of.e) / y;
        of.phi2 = (1.0 - of.phi1) / y;
    }
    return of;
}

/* The newer command acts on the last `rest` of the period, the older one before. */
static struct sampled_axis axis_of(double mass, double damping, double period, double rest)
{
    const double y = damping * period / mass;
    const struct decay whole = decay_of(y), last = decay_of(y * rest);
    const double position = rest * rest * last.phi2, velocity = rest * last.phi1;
    return (struct sampled_axis){ .decay = whole.e,
                                  .gliding = whole.phi1,
                                  .position = { position, whole.phi2 - position },
                                  .velocity = { velocity, whole.phi1 - velocity },
                                  .unit = period * period / mass };
}

/* Masses above 0 and dampings of `axes` coordinates, 1 or 2; the period, above 0, and the delay, in s. */
static struct sampled_loop loop_of(const double *mass, const double *damping, int axes, double period, double delay)
{
    struct sampled_loop loop;
    if (delay > SAMPLED_PERIODS_MAX * period) {
        period = (0.5 * period + delay) / (SAMPLED_PERIODS_MAX + 0.5);
        delay = SAMPLED_PERIODS_MAX * period;
    }
    const double periods = floor(delay / period);
    memset(&loop, 0, sizeof loop);
    for (int i = 0; i < axes; i++)
        loop.axis[i] = axis_of(mass[i], damping[i], period, 1.0 - (delay / period - periods));
    loop.delay = (int)periods;
    loop.period = period;
    return loop;
}

/*
 * Whether all roots of a polynomial lie inside the unit circle, by the recursion of Schur and Cohn. The coefficients, the
 * highest power's last, are destroyed.
 */
static int is_stable(double *p, int degree)
{
    double q[COEFFICIENTS_MAX];
    for (; degree > 0; degree--) {
        const double reflection = p[0] / p[degree];
        if (!(fabs(reflection) < 1.0))
            return 0;
        for (int i = 0; i < degree; i++)
            q[i] = p[i + 1] - reflection * p[degree - 1 - i];
        memcpy(p, q, (size_t)degree * sizeof *p);
    }
    return 1;
}

static void multiply(const double *a, int a_degree, const double *b, int b_degree, double *product)
{
    memset(product, 0, (size_t)(a_degree + b_degree + 1) * sizeof *product);
    for (int i = 0; i <= a_degree; i++)
        for (int k = 0; k <= b_degree && a[i] != 0.0; k++)
            product[i + k] += a[i] * b[k];
}

/* The quotient by z - 1, for a polynomial that has this root. */
static void divide_by_root_of_one(double *p, int degree)
{
    for (int i = degree - 1; i >= 0; i--)
        p[i] += p[i + 1];
    memmove(p, p + 1, (size_t)degree * sizeof *p);
}

static void add_scaled(double *sum, double scale, const double *a, int degree)
{
    for (int i = 0; i <= degree; i++)
        sum[i] += scale * a[i];
}

/*
 * One coordinate by itself obeys D x = -N u with u = K c x, where
 *     D = (z - 1) (z - e) z^(d + 2)      N = (z - e) (g0 z + g1) + phi1 (h0 z + h1)      c = (1 + b) z - b
 * e is the decay and phi1 the gliding of the velocity, d the delay, g and h what two commands add to position and
 * velocity, and b the damping time in periods. `response` is N c.
 */
static void polynomials_of(const struct sampled_loop *loop, int i, double b, double *own, double *response)
{
    const struct sampled_axis *axis = &loop->axis[i];
    const double *g = axis->position, *h = axis->velocity;
    const double e = axis->decay;
    const double n[3] = { axis->gliding * h[1] - e * g[1], g[1] - e * g[0] + axis->gliding * h[0], g[0] };
    const double c[2] = { -b, 1.0 + b };
    const int d = loop->delay + 2;
    multiply(n, 2, c, 1, response);
    memset(own, 0, (AXIS_DEGREE_MAX + 1) * sizeof *own);
    own[d] = e;
    own[d + 1] = -1.0 - e;
    own[d + 2] = 1.0;
}

/*
 * 1 if all motion dies away, but for a drift in a direction that is left free. Of one coordinate along[0] alone counts;
 * for two it is the determinant of diag(D) + diag(N c) K.
 */
static int loop_is_stable(const struct sampled_loop *loop, int axes, const struct sampled_spring *spring)
{
    enum { RESPONSE_DEGREE = 3 };
    const int degree = loop->delay + 4;
    double own[2][AXIS_DEGREE_MAX + 1], response[2][RESPONSE_DEGREE + 1];
    double p[COEFFICIENTS_MAX], product[COEFFICIENTS_MAX], k[2];
    for (int i = 0; i < axes; i++) {
        polynomials_of(loop, i, spring->damping_time / loop->period, own[i], response[i]);
        k[i] = spring->along[i] * loop->axis[i].unit;
    }
    if (axes == 1) {
        memcpy(p, own[0], sizeof own[0]);
        add_scaled(p, k[0], response[0], RESPONSE_DEGREE);
        return is_stable(p, degree);
    }
    multiply(own[0], degree, own[1], degree, p);
    for (int i = 0; i < 2; i++) {
        multiply(response[i], RESPONSE_DEGREE, own[1 - i], degree, product);
        add_scaled(p, k[i], product, degree + RESPONSE_DEGREE);
    }
    if (spring->leaves_free) {
        divide_by_root_of_one(p, 2 * degree);
        return is_stable(p, 2 * degree - 1);
    }
    const double between = spring->between * spring->between * loop->axis[0].unit * loop->axis[1].unit;
    multiply(response[0], RESPONSE_DEGREE, response[1], RESPONSE_DEGREE, product);
    add_scaled(p, k[0] * k[1] - between, product, 2 * RESPONSE_DEGREE);
    return is_stable(p, 2 * degree);
}

/* ---- the stiffest coupling ---- */

/* A limit is searched for from that share of what damping alone lets expect, up to so many times what any can be. */
#define LEAST     1e-3
#define MOST      8.0
#define PRECISION 1e-9

/* How much shorter rate and delays are looked at, for what was asked for. */
#define TIMES_MIN 1e-3

enum { HALVINGS = 100 };

/* A step of the encoder may change the force by this share of the largest force. */
#define STEP_SHARE 0.1

/* N/m, of a device of which nothing is known. */
#define UNKNOWN_STIFFNESS 100.0

/* An explicit rotational stiffness may use this share of the rotational limit; the rest is for the lever. */
#define TURN_SHARE 0.5

/* Whether a loop holds with this stiffness. */
typedef int holds_fn(const void *of, double stiffness);

/* The largest stiffness between two that holds; 0 if the least does not. */
static double largest(holds_fn *holds, const void *of, double min, double max)
{
    double low = min, high = max;
    if (!(low > 0.0) || !holds(of, low))
        return 0.0;
    for (int i = 0; i < HALVINGS && high > low * (1.0 + PRECISION); i++) {
        const double middle = sqrt(low * high);
        *(holds(of, middle) ? &low : &high) = middle;
    }
    return low;
}

/* One coordinate with a damper of its own. */
struct single {
    struct sampled_loop loop;
    double virtual_damping;
};

static int single_holds(const void *of, double stiffness)
{
    const struct single *single = of;
    const struct sampled_spring spring = { .along = { stiffness },
                                           .damping_time = single->virtual_damping / stiffness };
    return loop_is_stable(&single->loop, 1, &spring);
}

double dpt_stable_stiffness(double mass, double damping, double period, double delay, double virtual_damping)
{
    if (!(mass > 0.0 && period > 0.0 && damping >= 0.0 && delay >= 0.0 && virtual_damping >= 0.0 && mass <= DBL_MAX &&
          period <= DBL_MAX && damping <= DBL_MAX && delay <= DBL_MAX && virtual_damping <= DBL_MAX))
        return 0.0;
    const struct single single = { loop_of(&mass, &damping, 1, period, delay), virtual_damping };
    const double half = 0.5 * period + delay, all = damping + virtual_damping;
    return largest(single_holds, &single, LEAST * all / half, MOST * (mass / period / period + all / period));
}

void dpt_coupling_def_defaults(dpt_coupling_def *def, size_t size)
{
    const dpt_coupling_def defaults = { .rate = 1000.0, .zoom = 1.0, .force_scale = 1.0, .gain_margin = 1.5 };
    sized_defaults(def, size, &defaults, sizeof defaults);
}

static int in_range(double value, double min, double max)
{
    return value >= min && value <= max;
}

static dpt_result check(const dpt_coupling_def *def)
{
    const struct {
        double value, min, max;
    } ranges[] = {
        { def->mass, 0.0, 1e3 },
        { def->inertia, 0.0, 1e3 },
        { def->damping, 0.0, 1e6 },
        { def->spin_damping, 0.0, 1e6 },
        { def->friction, 0.0, DBL_MAX },
        { def->spin_friction, 0.0, DBL_MAX },
        { def->position_step, 0.0, 1.0 },
        { def->angle_step, 0.0, 1.0 },
        { def->delay, 0.0, 10.0 },
        { def->force_max, 0.0, DBL_MAX },
        { def->torque_max, 0.0, DBL_MAX },
        { def->stiffness_max, 0.0, DBL_MAX },
        { def->rate, 1.0, 1e5 },
        { def->loop_delay, 0.0, 10.0 },
        { def->zoom, 1e-6, 1e6 },
        { def->force_scale, 1e-6, 1e6 },
        { def->rho, 0.0, 1e6 },
        { def->lever, 0.0, 1e6 },
        { def->stiffness, 0.0, 1e9 },
        { def->rotational_stiffness, 0.0, 1e9 },
        { def->tool_damping, 0.0, 1e9 },
        { def->gain_margin, 1.0, 100.0 },
    };
    for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++)
        if (!(fabs(ranges[i].value) <= DBL_MAX))
            return DPT_E_FINITE;
    for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++)
        if (!in_range(ranges[i].value, ranges[i].min, ranges[i].max))
            return DPT_E_ARGUMENT;
    return def->has_torque > 1 ? DPT_E_ARGUMENT : DPT_OK;
}

/* What is asked for and what the device allows, all at the hand. */
struct wish {
    double period, delay, margin;
    double stiffness, turn_stiffness; /* asked for; 0: not */
    double damping;                   /* virtual */
    double rho, lever;
    double scale, turn_scale; /* a stiffness at the hand to that of the scene */
};

static struct wish wish_of(const dpt_coupling_def *def)
{
    const double scale = def->force_scale * def->zoom;
    const double turn_scale = def->force_scale / def->zoom;
    return (struct wish){ .period = 1.0 / def->rate,
                          .delay = def->delay + def->loop_delay,
                          .margin = def->gain_margin,
                          .stiffness = scale * def->stiffness,
                          .turn_stiffness = turn_scale * def->rotational_stiffness,
                          .damping = scale * def->tool_damping,
                          .rho = def->rho / def->zoom,
                          .lever = def->lever / def->zoom,
                          .scale = scale,
                          .turn_scale = turn_scale };
}

/* The limit with the margin: the stiffness that holds when it and the virtual damping are so many times higher. */
static double limit_of(const struct wish *wish, double mass, double damping, double virtual_damping, double time)
{
    return dpt_stable_stiffness(mass, damping, wish->period * time, wish->delay * time,
                                virtual_damping * wish->margin) /
           wish->margin;
}

/* A device that gives torque: translation across the tool, and the turn about the pose's origin. */
struct pair {
    struct sampled_loop loop;
    const struct wish *wish;
    double turn_stiffness; /* 0: with the stiffness, by rho^2 */
};

/*
 * Where a tool is held: by one contact at `place` of its half length from the centre, with a normal that is turned away
 * from the plane of lever and tool so that `share` of it is left there.
 */
static const double places[] = { -1.0, -0.5, 0.0, 0.5, 1.0 }, shares[] = { 0.0, 1.0 / 3, 2.0 / 3, 1.0 };

enum { PLACES = sizeof places / sizeof *places, SHARES = sizeof shares / sizeof *shares };

/* What one contact leaves of the coupling: stiffness k along the direction (1, lever). */
static struct sampled_spring spring_of(double k, double lever, double damping_time)
{
    return (struct sampled_spring){
        .along = { k, k * lever * lever }, .between = k * lever, .damping_time = damping_time, .leaves_free = 1
    };
}

/* The tool fixed altogether, or held by one contact anywhere. */
static int pair_holds(const void *of, double stiffness)
{
    const struct pair *held = of;
    const struct wish *wish = held->wish;
    const double k = stiffness * wish->margin, time = wish->damping / stiffness;
    const double half_length = sqrt(3.0) * wish->rho;
    const double turn = held->turn_stiffness > 0.0 ? held->turn_stiffness * wish->margin : k * wish->rho * wish->rho;
    struct sampled_spring spring = spring_of(k, wish->lever, time);
    spring.along[1] += turn;
    spring.leaves_free = 0;
    if (!loop_is_stable(&held->loop, 2, &spring))
        return 0;
    for (int i = 0; i < PLACES * SHARES; i++) {
        const double share = shares[i % SHARES], arm = places[i / SHARES] * half_length * share;
        const double soft = arm != 0.0 ? arm * arm / turn : 0.0;
        spring = spring_of(1.0 / (1.0 / k + soft), wish->lever * share + arm, time);
        if (!loop_is_stable(&held->loop, 2, &spring))
            return 0;
    }
    return 1;
}

/* An explicit rotational stiffness is kept below its own limit. */
static double turn_stiffness_of(const struct wish *wish, const dpt_coupling_def *def, double time)
{
    return min_of(wish->turn_stiffness, TURN_SHARE * limit_of(wish, def->inertia, def->spin_damping, 0.0, time));
}

/* N/m at the hand: what the device allows with all times so many times as long. */
static double allowed_at(const struct wish *wish, const dpt_coupling_def *def, double time)
{
    const double translation = limit_of(wish, def->mass, def->damping, wish->damping, time);
    if (!def->has_torque || translation == 0.0)
        return translation;
    const double mass[2] = { def->mass, def->inertia };
    const double damping[2] = { def->damping, def->spin_damping };
    const struct pair held = { loop_of(mass, damping, 2, wish->period * time, wish->delay * time), wish,
                               turn_stiffness_of(wish, def, time) };
    if (pair_holds(&held, (1.0 - 1e-6) * translation))
        return translation;
    return largest(pair_holds, &held, LEAST * translation, translation);
}

/* T/2 + t_d with which the stiffness that was asked for would be allowed, s. */
static double delay_needed(const struct wish *wish, const dpt_coupling_def *def)
{
    double low = 1.0, high = 1.0;
    while (allowed_at(wish, def, low) < wish->stiffness)
        if ((low *= 0.5) < TIMES_MIN)
            return 0.0;
    while (allowed_at(wish, def, high) >= wish->stiffness && high < 1.0 / TIMES_MIN)
        high *= 2.0;
    for (int i = 0; i < HALVINGS && high > low * (1.0 + 1e-6); i++) {
        const double middle = sqrt(low * high);
        *(allowed_at(wish, def, middle) >= wish->stiffness ? &low : &high) = middle;
    }
    return low * (0.5 * wish->period + wish->delay);
}

static void limit_to(dpt_coupling *out, double stiffness, uint32_t limit)
{
    if (!(stiffness < out->stiffness))
        return;
    out->stiffness = stiffness;
    out->limit = limit;
}

static int is_known(const dpt_coupling_def *def)
{
    return def->mass > 0.0 && def->damping > 0.0 &&
           (!def->has_torque || (def->inertia > 0.0 && def->spin_damping > 0.0));
}

/* By what stops the device: translation and, if there is torque, rotation, K rho^2 and the lever's part together. */
static int comes_to_rest(const dpt_coupling_def *def, const struct wish *wish, double stiffness, double turn_stiffness)
{
    const double turn = turn_stiffness + stiffness * wish->lever * wish->lever;
    return def->friction >= 0.5 * stiffness * def->position_step &&
           (!def->has_torque || def->spin_friction >= 0.5 * turn * def->angle_step);
}

/* At the hand at first; `out` is turned to the scene at the end. */
static void choose(const dpt_coupling_def *def, const struct wish *wish, dpt_coupling *out)
{
    out->delay = 0.5 * wish->period + wish->delay;
    out->stiffness = wish->stiffness > 0.0 ? wish->stiffness : HUGE_VAL;
    double turn_stiffness = wish->turn_stiffness;
    if (is_known(def)) {
        out->stable = dpt_stable_stiffness(def->mass, def->damping, wish->period, wish->delay, wish->damping);
        limit_to(out, limit_of(wish, def->mass, def->damping, wish->damping, 1.0), DPT_COUPLING_STABILITY);
        if (def->has_torque) {
            turn_stiffness = turn_stiffness_of(wish, def, 1.0);
            out->stable_turn = dpt_stable_stiffness(def->inertia, def->spin_damping, wish->period, wish->delay,
                                                    wish->damping * wish->rho * wish->rho);
            limit_to(out, allowed_at(wish, def, 1.0), DPT_COUPLING_ROTATION);
        }
        if (wish->stiffness > 0.0)
            out->delay_needed = delay_needed(wish, def);
    } else {
        limit_to(out, def->stiffness_max > 0.0 ? def->stiffness_max : UNKNOWN_STIFFNESS,
                 def->stiffness_max > 0.0 ? DPT_COUPLING_MAKER : DPT_COUPLING_UNKNOWN);
    }
    if (def->stiffness_max > 0.0)
        limit_to(out, def->stiffness_max, DPT_COUPLING_MAKER);
    if (def->force_max > 0.0 && def->position_step > 0.0)
        limit_to(out, STEP_SHARE * def->force_max / def->position_step, DPT_COUPLING_STEP);
    const double felt_turn = turn_stiffness > 0.0 ? turn_stiffness : out->stiffness * wish->rho * wish->rho;
    if (comes_to_rest(def, wish, out->stiffness, felt_turn))
        out->flags |= DPT_COUPLING_FLAG_RESTS;
    out->stiffness = min_of(out->stiffness / wish->scale, 1e9);
    out->rotational_stiffness = turn_stiffness / wish->turn_scale;
    out->damping = def->tool_damping;
    if (def->force_max > 0.0 && out->stiffness > 0.0)
        out->depth = min_of(def->force_max / (def->force_scale * out->stiffness), DPT_COORDINATE_MAX);
}

dpt_result dpt_coupling_for_device(const dpt_coupling_def *given, dpt_coupling *coupling)
{
    dpt_coupling_def def;
    dpt_coupling out = { .size = sizeof out };
    if (!given || !coupling)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(coupling, sizeof *coupling, 0));
    dpt_coupling_def_init(&def);
    dpt_result result = sized_read(given, sizeof def, &def, sizeof def);
    if (result == DPT_OK)
        result = check(&def);
    if (result == DPT_OK) {
        const struct wish wish = wish_of(&def);
        choose(&def, &wish, &out);
    }
    sized_write(coupling, coupling->size, &out, sizeof out);
    return result;
}
