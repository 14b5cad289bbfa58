/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Firmware of a device with a mechanism that is only computed: a servo loop of 1 kHz, the protocol over the UART. What
 * a real one does beside this is to read its encoders where mechanism_step is, and to drive its motors.
 *
 * PERIOD is of a sample, in ms, and WATCHDOG in s: run.sh sets them for QEMU, whose UART passes few bytes in a millisecond
 * where the machine is busy, and which may then stand still for longer than a good watchdog waits.
 */
#include "firmware/board.h"
#include "firmware/meter.h"
#include "serial/wire_device.h"
#include "simulate/mechanism.h"

#include <string.h>

#ifndef PERIOD
#define PERIOD 1
#endif
#ifndef WATCHDOG
#define WATCHDOG 0.02f
#endif
/* m: how deep the hand presses, each 0.6 s; and whether the motors' force goes to the second UART (meter.h). */
#ifndef PRESS
#define PRESS 0.0
#endif
#ifndef METER
#define METER 0
#endif

static const struct wire_info info = {
    .pose_dofs = 3,
    .wrench_dofs = 3,
    .flags = 1,
    .rate = 1000.0f / PERIOD,
    .force_max = 5,
    .force_continuous = 2,
    .stiffness_max = 2000,
    .position_step = 1e-5f,
    .watchdog = WATCHDOG,
    .workspace_min = { -0.1f, -0.1f, -0.1f },
    .workspace_max = { 0.1f, 0.1f, 0.1f },
    .name = "emulated Cortex-M7",
    .serial = "an500",
};

static struct wire_device device;
static struct mechanism mechanism;

/* Down to PRESS, and up to a fifth of it above the middle. */
static void press(uint32_t now)
{
    const uint32_t phase = now % 600;
    mechanism.hand[1] = PRESS * (0.2 - (phase < 300 ? phase : 600 - phase) / 250.0);
}

static void servo(uint32_t now)
{
    struct wire_sample sample = { .time = 1000 * now, .temperature = WIRE_TEMPERATURE_UNKNOWN };
    uint8_t out[WIRE_OUT_MAX];
    press(now);
    mechanism_step(&mechanism, device.force, 0.001 * PERIOD, 2 * PERIOD);
    for (int i = 0; i < 3; i++) {
        sample.position[i] = (float)mechanism.position[i];
        sample.velocity[i] = (float)mechanism.velocity[i];
    }
    /* A sample that does not fit is dropped: the host counts the gap. */
    uart_put(out, wire_device_sample(&device, &sample, out));
    if (METER) {
        struct meter_reading reading = { .ms = now, .status = wire_device_status(&device) };
        reading.commands = device.commands.accepted;
        memcpy(reading.force, device.force, sizeof reading.force);
        meter_put(&reading, sizeof reading);
    }
}

int main(void)
{
    wire_device_init(&device, &info);
    wire_device_log(&device, "firmware of tests/firmware");
    mechanism_init(&mechanism);
    uart_start();
    clock_start();
    for (uint32_t last = 0;;) {
        for (int byte; (byte = uart_get()) >= 0;)
            wire_device_take(&device, (uint8_t)byte);
        const uint32_t now = clock_ms();
        if (now - last >= PERIOD) {
            last = now;
            servo(now);
        }
        board_idle();
    }
}
