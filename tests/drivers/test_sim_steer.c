/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A simulated hand that is steered: it goes in a straight line, at 0.5 m/s at most, from where its script had it, and
 * stays; also while another thread steers and this one reads. Hands that push, and devices that have none, refuse.
 */
#include <math.h>
#include <pthread.h>

#include "drivers/open_device.h"

#define SPEED 0.5 /* m/s, as device.h says */

/* A stiff hand on a damped mass: the device is behind the hand by speed times damping over grip, once it moves evenly. */
#define STIFF "sim:?mass=0.1&damping=20&grip=5000&hand=%s"
#define LAG   (SPEED * 20.0 / 5000.0)

static dpt_device_state read_after(dpt_device *device, int reads)
{
    dpt_device_state state = { .size = sizeof state };
    for (int i = 0; i < reads; i++)
        CHECK(dpt_device_read(device, &state) == DPT_OK, "no sample");
    return state;
}

static void it_goes_at_its_speed_and_stays(void)
{
    static const double wanted[3] = { 0.06, 0.0, 0.08 };
    dpt_device *device = device_named(STIFF, "hold");
    read_after(device, 10);
    CHECK(dpt_device_steer(device, wanted) == DPT_OK, "not steered");
    double worst = 0.0, aside = 0.0;
    for (int i = 1; i <= 190; i++) {
        const dpt_device_state state = read_after(device, 1);
        const double *x = state.pose.position, along = 0.6 * x[0] + 0.8 * x[2];
        if (i > 60)
            worst = fmax(worst, fabs(along - (SPEED * 1e-3 * i - LAG)));
        aside = fmax(aside, fmax(fabs(x[1]), fabs(0.8 * x[0] - 0.6 * x[2])));
    }
    CHECK(worst < 6e-4, "%g m from where it is to be", worst);
    CHECK(aside < 1e-12, "%g m from the line", aside);
    const dpt_device_state state = read_after(device, 1000);
    for (int k = 0; k < 3; k++)
        CHECK(fabs(state.pose.position[k] - wanted[k]) < 1e-9, "%d: %g m", k, state.pose.position[k]);
    dpt_device_close(device);
}

/* A hand in the middle of its press begins there; a second place is gone to from the first. */
static void it_begins_where_the_script_is(void)
{
    static const double up[3] = { 0.0, 0.02, 0.0 }, down[3] = { 0.0, -0.02, 0.0 };
    dpt_device *device = device_named(STIFF "&reach=0.03&cycle=2", "press");
    const double before = read_after(device, 1000).pose.position[1];
    CHECK(fabs(before + 0.03) < 1e-3, "pressed to %g m", before);
    dpt_device_steer(device, up);
    const double soon = read_after(device, 10).pose.position[1];
    CHECK(fabs(soon - before) < 10 * 1e-3 * SPEED + 1e-3, "a jump by %g m", soon - before);
    CHECK(fabs(read_after(device, 500).pose.position[1] - 0.02) < 1e-6, "not there");
    dpt_device_steer(device, down);
    CHECK(fabs(read_after(device, 500).pose.position[1] + 0.02) < 1e-6, "not there");
    dpt_device_close(device);
}

static void others_refuse(void)
{
    static const double wanted[3] = { 0.01, 0.0, 0.0 };
    const double wrong[3] = { 0.0, NAN, 0.0 }, far[3] = { 0.0, 0.0, 1.1e6 };
    dpt_device *device = device_named("sim:");
    CHECK(dpt_device_steer(device, wanted) == DPT_E_UNSUPPORTED, "a device without a hand");
    dpt_device_close(device);
    struct small_file forces = file_with("t,fx,fy,fz\n0,0.5,0,0\n");
    device = device_named("sim:?hand=%s", forces.path);
    CHECK(dpt_device_steer(device, wanted) == DPT_E_UNSUPPORTED, "a hand that pushes");
    dpt_device_close(device);
    unlink(forces.path);
    device = device_named("sim:?hand=hold");
    CHECK(dpt_device_steer(device, wrong) == DPT_E_FINITE, "not a number");
    CHECK(dpt_device_steer(device, far) == DPT_E_FINITE, "too far");
    CHECK(dpt_device_steer(device, NULL) == DPT_E_ARGUMENT, "nowhere");
    CHECK(dpt_device_steer(NULL, wanted) == DPT_E_ARGUMENT, "nothing");
    CHECK(fabs(read_after(device, 100).pose.position[0]) < 1e-12, "it moved all the same");
    dpt_device_close(device);
}

/* Steered from another thread, as fast as that can: every place is one that was asked for, or between two. */
static void *steer_often(void *of)
{
    for (int i = 0; i < 200000; i++) {
        const double side = i % 2 ? 0.01 : -0.01;
        const double wanted[3] = { side, side, side };
        dpt_device_steer(of, wanted);
    }
    return NULL;
}

static void two_threads_agree(void)
{
    dpt_device *device = device_named(STIFF, "hold");
    pthread_t thread;
    double apart = 0.0;
    CHECK(pthread_create(&thread, NULL, steer_often, device) == 0, "no thread");
    for (int i = 0; i < 20000; i++) {
        const dpt_device_state state = read_after(device, 1);
        const double *x = state.pose.position;
        apart = fmax(apart, fmax(fabs(x[0] - x[1]), fabs(x[0] - x[2])));
    }
    pthread_join(thread, NULL);
    CHECK(apart < 1e-12, "half a place: %g m", apart);
    dpt_device_close(device);
}

int main(void)
{
    TEST(it_goes_at_its_speed_and_stays);
    TEST(it_begins_where_the_script_is);
    TEST(others_refuse);
    TEST(two_threads_agree);
    return check_report();
}
