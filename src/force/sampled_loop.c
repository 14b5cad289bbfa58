/* SPDX-License-Identifier: BSD-3-Clause */
#include "force/sampled_loop.h"

#include <math.h>
#include <string.h>

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

struct sampled_loop dpti_sampled_loop(const double *mass, const double *damping, int axes, double period, double delay)
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

/* Two coordinates: the determinant of diag(D) + diag(N c) K. */
int dpti_sampled_loop_holds(const struct sampled_loop *loop, int axes, const struct sampled_spring *spring)
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
