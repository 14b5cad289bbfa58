/* SPDX-License-Identifier: BSD-3-Clause */
#include "lab/hand_sway.h"

#include <math.h>
#include <string.h>

#include "identify_fit.h"

/* Step of the differences that linearise a law, m. */
#define DIFFERENCE 4e-6

/* Stiffness of a hand, N/m. */
#define GRIP 200.0

/* Of a bisection; from 0.5 to 1.5 of a limit that leaves 0.1 %. */
enum { HALVINGS = 10, SETTLING = 4 };

/* Shares of the first amplitude between which growth is fitted: beyond, the surface is another one. */
#define FIT_LEAST 1e-5
#define FIT_MOST  4.0

struct hand_device hand_device_even(double mass, double damping, double delay, double rho)
{
    return (struct hand_device){ .dofs = rho > 0.0 ? HAND_AXES : 3,
                                 .mass = mass,
                                 .damping = damping,
                                 .inertia = mass * rho * rho,
                                 .turn_damping = damping * rho * rho,
                                 .rate = 1000.0,
                                 .delay = delay,
                                 .force = 1000.0,
                                 .torque = 1000.0 };
}

static double unit_of(const struct hand_loop *loop, int axis)
{
    const double rho = hand_loop_rho(loop);
    return axis < 3 ? 1.0 : rho > 0.0 ? rho : 1.0;
}

void hand_law_find(struct hand_loop *loop, struct hand_law *law)
{
    double rate[HAND_AXES][HAND_AXES], even[HAND_AXES * HAND_AXES];
    double values[HAND_AXES], directions[HAND_AXES * HAND_AXES];
    memset(law, 0, sizeof *law);
    law->axes = loop->device.dofs;
    for (int j = 0; j < law->axes; j++) {
        double wrench[2][HAND_AXES], back[HAND_AXES];
        for (int side = 0; side < 2; side++) {
            double at[HAND_AXES] = { 0.0 };
            const double zero[HAND_AXES] = { 0.0 };
            at[j] = (side ? DIFFERENCE : -DIFFERENCE) / unit_of(loop, j);
            for (int i = 0; i < SETTLING; i++)
                hand_loop_ask(loop, at, 1e-3, wrench[side]);
            for (int i = 0; i < SETTLING; i++)
                hand_loop_ask(loop, zero, 1e-3, back);
        }
        for (int i = 0; i < law->axes; i++)
            rate[i][j] = (wrench[0][i] - wrench[1][i]) / (2.0 * DIFFERENCE) / unit_of(loop, i);
    }
    for (int i = 0; i < law->axes; i++)
        for (int j = 0; j < law->axes; j++) {
            even[law->axes * i + j] = 0.5 * (rate[i][j] + rate[j][i]);
            law->asymmetry = fmax(law->asymmetry, fabs(rate[i][j] - rate[j][i]));
        }
    identify_eigen(law->axes, even, values, directions);
    for (int n = 0; n < law->axes; n++) {
        const int from = law->axes - 1 - n;
        law->stiffness[n] = values[from];
        memcpy(law->direction[n], directions + law->axes * from, (size_t)law->axes * sizeof *directions);
    }
}

void hand_hold(struct hand_loop *loop, const struct hand_law *law, double felt)
{
    const double toppling = -felt * law->stiffness[law->axes - 1] / law->stiffness[0];
    const double rho = hand_loop_rho(loop);
    loop->device.script = "hold";
    loop->device.grip = fmax(GRIP, 2.0 * toppling);
    loop->device.turn_grip = loop->device.grip * rho * rho;
}

/* The middle of its motion over the last fifth: it may have come to rest beside where it began. */
static void find_centre(const struct hand_loop *loop, double centre[HAND_AXES])
{
    for (int k = 0; k < HAND_AXES; k++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (size_t i = loop->count - loop->count / 5; i < loop->count; i++) {
            low = fmin(low, loop->track[i].at[k]);
            high = fmax(high, loop->track[i].at[k]);
        }
        centre[k] = 0.5 * (low + high);
    }
}

/* How motion is measured: along a direction, about a middle, with its frequency in rad/s. */
struct measure {
    const struct hand_tap *tap;
    double centre[HAND_AXES], rate;
};

/* m: of the motion along the direction, and of all of it, speeds by the frequency of that motion. */
static void amplitudes(const struct hand_loop *loop, const struct measure *measure, const struct hand_moment *moment,
                       double *along, double *whole)
{
    double off = 0.0, speed = 0.0, sum = 0.0;
    for (int k = 0; k < HAND_AXES; k++) {
        const double x = unit_of(loop, k) * (moment->at[k] - measure->centre[k]);
        const double v = unit_of(loop, k) * moment->speed[k] / measure->rate;
        off += measure->tap->direction[k] * x;
        speed += measure->tap->direction[k] * v;
        sum += x * x + v * v;
    }
    *along = sqrt(off * off + speed * speed);
    *whole = sqrt(sum);
}

/* Whether the last tenth has less motion than tick `begin`, of all coordinates. */
static int has_less_left(const struct hand_loop *loop, const struct measure *measure, size_t begin)
{
    double along, first, last = 0.0;
    amplitudes(loop, measure, &loop->track[begin], &along, &first);
    for (size_t i = loop->count - loop->count / 10; i < loop->count; i++) {
        double whole;
        amplitudes(loop, measure, &loop->track[i], &along, &whole);
        last = fmax(last, whole);
    }
    return last < first;
}

/* The slope of log(amplitude) by least squares, from tick `begin` on to where it leaves what is fitted. */
static double fit(const struct hand_loop *loop, const struct measure *measure, size_t begin)
{
    double first = 0.0, n = 0.0, t = 0.0, y = 0.0, tt = 0.0, ty = 0.0;
    for (size_t i = begin; i < loop->count; i++) {
        const struct hand_moment *moment = &loop->track[i];
        double along, whole;
        amplitudes(loop, measure, moment, &along, &whole);
        if (i == begin)
            first = along;
        if (!(along > FIT_LEAST * first && along < FIT_MOST * first))
            break;
        const double time = moment->time - loop->track[begin].time, log_along = log(along / first);
        n += 1.0;
        t += time;
        y += log_along;
        tt += time * time;
        ty += time * log_along;
    }
    const double spread = tt - t * t / n;
    return spread > 0.0 ? (ty - t * y / n) / spread : HUGE_VAL;
}

struct hand_sway hand_sway(struct hand_loop *loop, const struct hand_tap *tap)
{
    struct hand_sway sway = { .growth = NAN };
    const struct hand_device *device = &loop->device;
    const double mass = device->mass;
    const double stiffness = fmax(tap->stiffness, 1.0) + (device->script ? device->grip : 0.0);
    const double rate = sqrt(stiffness / mass), begun = mass * rate * tap->reach;
    hand_loop_return(loop);
    for (int k = 0; k < HAND_AXES; k++) {
        loop->push[k] = loop->place ? -loop->first[k] : 0.0;
        loop->tap[k] = tap->direction[k] * begun * unit_of(loop, k);
    }
    const uint64_t ticks = (uint64_t)(tap->seconds * device->rate);
    if (!hand_loop_run(loop, ticks))
        return sway;
    const size_t begin = (size_t)(device->delay + 5.0);
    if (loop->count < begin + 20)
        return sway;
    struct measure measure = { .tap = tap, .rate = rate };
    find_centre(loop, measure.centre);
    const int is_less = loop->count == ticks && has_less_left(loop, &measure, begin);
    /* What grows may leave the surface, and then has another centre than at first. */
    if (!is_less)
        memset(measure.centre, 0, sizeof measure.centre);
    sway.growth = fit(loop, &measure, begin);
    sway.is_stable = is_less && sway.growth < 0.0;
    return sway;
}

double hand_stiffest(struct hand_loop *loop, const struct hand_search *search)
{
    const double other = search->is_turn ? loop->stiffness : loop->rotational_stiffness;
    double low = search->low, high = search->high;
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = sqrt(low * high);
        struct hand_tap tap = search->tap;
        tap.stiffness = search->felt * middle;
        if (search->is_turn)
            hand_loop_stiffen(loop, other, middle, search->turn_damping * other / middle);
        else
            hand_loop_stiffen(loop, middle, other, loop->damping);
        *(hand_sway(loop, &tap).is_stable ? &low : &high) = middle;
    }
    return low;
}

struct hand_search hand_search_about(double limit, double seconds)
{
    return (struct hand_search){ .low = 0.5 * limit,
                                 .high = 1.5 * limit,
                                 .felt = 1.0,
                                 .tap = { .direction = { 0.0, 1.0 }, .reach = 5e-5, .seconds = seconds } };
}

struct hand_search hand_search_for_law(const struct hand_loop *loop, const struct hand_law *law, double limit,
                                       double seconds)
{
    struct hand_search search = { .low = 0.01 * limit,
                                  .high = 3.0 * limit,
                                  .tap = { .reach = 5e-5, .seconds = seconds } };
    /* Where the force jumps, differences show no stiffness that motion has. */
    search.felt = fmax(0.1, fmin(law->stiffness[0] / loop->stiffness, 5.0));
    memcpy(search.tap.direction, law->direction[0], sizeof search.tap.direction);
    return search;
}
