/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * When a device by OpenHaptics is calibrated, on a stand-in for the vendor's library (tests/drivers/hd): in its inkwell, by
 * itself, in a reset position; never under force.
 */
#include "drivers/hd/host.h"

/* The inkwell: a person's turn, then ours. */
static void the_inkwell_calibrates(void)
{
    there->calibration = HD_CALIBRATION_NEEDS_MANUAL_INPUT;
    start("");
    CHECK(strstr(error.text, "put the stylus into the inkwell") && error.code == DPT_OK, "%s", error.text);
    CHECK(state.status == DPT_DEVICE_STATUS_UNREADY && state.reasons == DPT_REASON_UNCALIBRATED, "%u", state.reasons);
    CHECK(push(device, 1.0) == DPT_E_NOT_READY, "it takes force");
    there->in_inkwell = 1;
    tick(60);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.reasons == DPT_REASON_DOCKED && there->updates == 1,
          "%u, %lu updates", state.reasons, there->updates);
    there->in_inkwell = 0;
    tick(1);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_READY, "%u", state.reasons);
    finish();
}

/* By itself, at open; later, but never under force. The best style is chosen. */
static void calibration_comes_without_force(void)
{
    there->styles = HD_CALIBRATION_AUTO | HD_CALIBRATION_INKWELL | HD_CALIBRATION_ENCODER_RESET;
    there->calibration = HD_CALIBRATION_NEEDS_UPDATE;
    start("");
    CHECK(error.text[0] == '\0' && state.status == DPT_DEVICE_STATUS_READY && there->updates == 1, "%s", error.text);
    serve(150, 1.0);
    there->calibration = HD_CALIBRATION_NEEDS_UPDATE;
    serve(200, 1.0);
    CHECK(there->updates == 1 && state.status == DPT_DEVICE_STATUS_READY && force_of(there) == 1.0, "%lu updates, %g N",
          there->updates, force_of(there));
    serve(60, 0.0);
    CHECK(there->updates == 2 && state.status == DPT_DEVICE_STATUS_READY, "%lu updates", there->updates);
    serve(1, 1.0);
    CHECK(force_of(there) < 0.7, "the ramp goes on as if nothing had been: %g", force_of(there));
    serve(100, 1.0);
    there->calibration = HD_CALIBRATION_NEEDS_MANUAL_INPUT;
    for (int n = 0; n < 60 && push(device, 1.0) == DPT_OK; n++) {
        tick(1);
        dpt_device_read(device, &state);
    }
    tick(1);
    CHECK(state.reasons == DPT_REASON_UNCALIBRATED && force_of(there) == 0.0, "%u, %g N", state.reasons,
          force_of(there));
    finish();
}

/* The first sample that is said to be good is of the place that was found. */
static void a_good_sample_is_of_the_new_place(void)
{
    there->styles = HD_CALIBRATION_AUTO;
    there->calibration = HD_CALIBRATION_NEEDS_MANUAL_INPUT;
    there->transform[12] = 5.0;
    start("");
    there->calibration = HD_CALIBRATION_NEEDS_UPDATE;
    for (int n = 0; n < 60 && state.status != DPT_DEVICE_STATUS_READY; n++) {
        tick(1);
        dpt_device_read(device, &state);
    }
    CHECK(state.status == DPT_DEVICE_STATUS_READY && state.pose.position[0] == 0.005 && state.pose.position[1] == 0.0,
          "%s at %g, %g m", dpt_device_status_name(state.status), state.pose.position[0], state.pose.position[1]);
    finish();
}

/* In a reset position: before the scheduler starts, once. */
static void encoders_are_reset_once(void)
{
    there->styles = HD_CALIBRATION_ENCODER_RESET;
    there->calibration = HD_CALIBRATION_NEEDS_MANUAL_INPUT;
    start("");
    CHECK(there->updates == 1 && state.status == DPT_DEVICE_STATUS_READY, "%lu updates", there->updates);
    finish();
    there->styles = HD_CALIBRATION_ENCODER_RESET;
    start("");
    CHECK(there->updates == 0 && state.status == DPT_DEVICE_STATUS_READY, "%lu updates", there->updates);
    finish();
}

int main(int argc, char **argv)
{
    (void)argc;
    take_stand_in(argv[0], "libHD-stand-in.so");
    renew();
    TEST(the_inkwell_calibrates);
    TEST(calibration_comes_without_force);
    TEST(a_good_sample_is_of_the_new_place);
    TEST(encoders_are_reset_once);
    return check_report();
}
