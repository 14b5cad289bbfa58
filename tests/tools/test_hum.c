/* SPDX-License-Identifier: BSD-3-Clause */
/* The hum of forces that are known in closed form: sines, a sway, lines, a step, and what a mixture has of them. */
#include "measure/hum.h"

#include <math.h>

#include "lib/check.h"

#define PI 3.14159265358979323846

enum { TICKS_MAX = 2400 };

static double size[TICKS_MAX];

static struct hum measured(size_t count)
{
    struct hum hum;
    CHECK(hum_measure(&hum, size, count), "no memory");
    return hum;
}

static void fill_sine(size_t count, double mean, double amplitude, double hertz, double phase)
{
    for (size_t i = 0; i < count; i++)
        size[i] = mean + amplitude * sin(2.0 * PI * hertz * HUM_TICK * (double)i + phase);
}

/* What all lines leave of a sine: the sums over a window in closed form. */
static double gain(double hertz)
{
    const double n = HUM_WINDOW, half = PI * hertz * HUM_TICK;
    const double mean = sin(n * half) / (n * sin(half));
    /* The derivative of sin(n half) / sin(half) is that of the sum of cosines. */
    const double moment = 0.5 * (sin(n * half) * cos(half) / sin(half) - n * cos(n * half)) / sin(half);
    return 1.0 - mean * mean - moment * moment / (n * n * (n * n - 1.0) / 12.0);
}

/* A sine has amplitude / sqrt(2): less 6 % at 30 Hz, 2 % at 50 Hz, 0.2 % at 250 Hz, at any phase, length and mean. */
static void sines_are_told(void)
{
    static const double hertz[] = { 30.0, 50.0, 250.0 }, lost[] = { 0.06, 0.021, 0.002 };
    static const size_t counts[] = { 500, 701, 1000, 2400 };
    for (size_t f = 0; f < 3; f++)
        for (size_t c = 0; c < 4; c++)
            for (int phase = 0; phase < 8; phase++) {
                fill_sine(counts[c], 0.6, 0.02, hertz[f], 0.7 * phase);
                const struct hum hum = measured(counts[c]);
                const double share = hum.rms / (0.02 / sqrt(2.0)), left = gain(hertz[f]);
                CHECK(share > 1.0 - lost[f] - 0.01 && share < 1.01, "%g Hz, %zu ticks: %g", hertz[f], counts[c], share);
                CHECK(fabs(share - left) < 0.01, "%g Hz, %zu ticks: %g, not %g", hertz[f], counts[c], share, left);
                CHECK(left > 1.0 - lost[f] && left <= 1.0, "%g Hz: %g", hertz[f], left);
                CHECK(fabs(hum.strongest - hertz[f]) < 1.1e3 / (double)counts[c], "%g Hz: %g", hertz[f], hum.strongest);
                CHECK(fabs(hum.mean - 0.6) < 0.002, "%g N", hum.mean);
            }
}

/* A sway of 2 Hz, lines, and a constant: less than 1 % of their amplitude. */
static void sways_and_lines_are_none(void)
{
    for (int phase = 0; phase < 8; phase++) {
        fill_sine(600, 0.6, 0.1, 2.0, 0.8 * phase);
        CHECK(measured(600).rms < 0.01 * 0.1, "2 Hz: %g", measured(600).rms / 0.1);
        fill_sine(2000, 0.6, 0.1, 2.0, 0.8 * phase);
        CHECK(measured(2000).rms < 0.003 * 0.1, "2 Hz: %g", measured(2000).rms / 0.1);
    }
    for (size_t i = 0; i < 1000; i++)
        size[i] = 3.0 - 2.5e-3 * (double)i;
    CHECK(measured(1000).rms < 1e-12, "a ramp: %g", measured(1000).rms);
    for (size_t i = 0; i < 1000; i++)
        size[i] = 0.7;
    CHECK(measured(1000).rms < 1e-13, "a constant: %g", measured(1000).rms);
}

/*
 * A step of 1 N in the middle: its square, summed, is the integral of |gain|^2 / (4 sin^2(pi f)) over frequencies from 20 Hz
 * up, both signs. A single tick that is off has the integral of |gain|^2.
 */
static void a_step_is_its_integral(void)
{
    enum { PARTS = 200000 };
    double step = 0.0, tick = 0.0;
    for (int i = 0; i < PARTS; i++) {
        const double hertz = HUM_CUT + (500.0 - HUM_CUT) * (i + 0.5) / PARTS, wide = (500.0 - HUM_CUT) / PARTS;
        const double left = gain(hertz) * gain(hertz), sine = sin(PI * hertz * HUM_TICK);
        step += 2.0 * wide * HUM_TICK * left / (4.0 * sine * sine);
        tick += 2.0 * wide * HUM_TICK * left;
    }
    for (size_t i = 0; i < 1000; i++)
        size[i] = i < 500 ? 1.0 : 2.0;
    double found = measured(1000).rms;
    CHECK(fabs(found - sqrt(step / 1000.0)) < 0.02 * found, "%g, not %g N", found, sqrt(step / 1000.0));
    CHECK(found > 0.04 && found < 0.06, "%g N", found);
    for (size_t i = 0; i < 1000; i++)
        size[i] = i == 400 ? 2.0 : 1.0;
    found = measured(1000).rms;
    CHECK(fabs(found - sqrt(tick / 1000.0)) < 0.01 * found, "%g, not %g N", found, sqrt(tick / 1000.0));
}

/* A quiet hum is seen beside a sway that is a hundred times as large, and of two the stronger one is named. */
static void a_mixture_has_its_parts(void)
{
    for (size_t i = 0; i < 1500; i++) {
        const double t = HUM_TICK * (double)i;
        size[i] = 1.0 + 0.3 * t + 0.1 * sin(2.0 * PI * 1.5 * t) + 1e-3 * sin(2.0 * PI * 157.0 * t) +
                  5e-4 * sin(2.0 * PI * 287.0 * t);
    }
    const struct hum hum = measured(1500);
    CHECK(fabs(hum.rms - sqrt(0.5 * (1e-6 + 2.5e-7))) < 0.02 * hum.rms, "%g N", hum.rms);
    CHECK(fabs(hum.strongest - 157.0) < 0.7, "%g Hz", hum.strongest);
}

/* Of a noise of all frequencies 4 % of the power are below 20 Hz, and 1 % more is taken by lines. */
static void noise_stays(void)
{
    uint64_t seed = 3;
    double square = 0.0;
    for (size_t i = 0; i < TICKS_MAX; i++) {
        const double draw = random_in(&seed, -0.5, 0.5);
        size[i] = 5.0 + draw;
        square += draw * draw / TICKS_MAX;
    }
    const double share = measured(TICKS_MAX).rms / sqrt(square);
    CHECK(share > 0.95 && share < 1.0, "%g", share);
}

static void what_is_too_short_has_none(void)
{
    fill_sine(HUM_WINDOW, 1.0, 0.1, 100.0, 0.0);
    CHECK(isnan(measured(HUM_WINDOW - 1).rms) && isnan(measured(0).mean), "a hum of nothing");
    CHECK(measured(HUM_WINDOW).rms > 0.05, "%g", measured(HUM_WINDOW).rms);
    size[7] = NAN;
    CHECK(isnan(measured(HUM_WINDOW).rms), "a number of no number");
}

int main(void)
{
    TEST(sines_are_told);
    TEST(sways_and_lines_are_none);
    TEST(a_step_is_its_integral);
    TEST(a_mixture_has_its_parts);
    TEST(noise_stays);
    TEST(what_is_too_short_has_none);
    return check_report();
}
