/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A simulated device with our serial protocol: the other end of a pseudo-terminal, with the firmware's own code
 * (wire_device.h) and a mechanism that a hand holds. The driver opens simulate_serial.path like a port, so the loop
 * closes on one machine.
 *
 *     simulate_serial_start(&simulated, NULL);
 *     puts(simulated.path);
 *     simulate_serial_run(&simulated, &stop);
 *     simulate_serial_end(&simulated);
 */
#ifndef DPT_TOOLS_SIMULATE_SERIAL_H
#define DPT_TOOLS_SIMULATE_SERIAL_H

#include "serial/wire_device.h"
#include "simulate/mechanism.h"

struct simulate_serial {
    struct wire_device device;
    struct mechanism mechanism;
    double swing;        /* m, how far up and down the hand goes; 0: it stays where it is put */
    double swing_period; /* s */
    uint16_t causes;     /* WIRE_REASON_... that hold, as an emergency stop */
    uint16_t buttons;
    uint64_t unsent; /* samples for which the line had no room */
    int master;
    char path[64];
    uint8_t pending[WIRE_OUT_MAX];
    size_t pending_at, pending_size;
};

/* The default info: 3 degrees of freedom, 1 kHz, 5 N, a watchdog of 20 ms. */
void simulate_serial_info(struct wire_info *info);

/* Start the device. `info` NULL: the default. Returns 0, or an errno. */
int simulate_serial_start(struct simulate_serial *simulated, const struct wire_info *info);

/* Take one sample: receive, move the mechanism by one period, send. Reads no clock. */
void simulate_serial_tick(struct simulate_serial *simulated);

/* Take samples at the device's rate until *stop is not 0. */
void simulate_serial_run(struct simulate_serial *simulated, const volatile int *stop);

/* End the device, as if its plug were pulled. */
void simulate_serial_end(struct simulate_serial *simulated);

#endif
