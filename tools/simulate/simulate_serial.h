/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A device of our own protocol that is not there: the other end of a pty, with the firmware's own code (wire_device.h)
 * and a mechanism that a hand holds. The driver opens simulate_serial.path as it opens a port; the loop is closed on
 * one machine.
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

/* What it says of itself unless told otherwise: 3 freedoms, 1 kHz, 5 N, a watchdog of 20 ms. */
void simulate_serial_info(struct wire_info *info);

/* `info` NULL: the above. 0, or an errno. */
int simulate_serial_start(struct simulate_serial *simulated, const struct wire_info *info);

/* One sample, now: takes what has come, moves the mechanism, sends. No clock. */
void simulate_serial_tick(struct simulate_serial *simulated);

/* Samples at its rate, until *stop is not 0. */
void simulate_serial_run(struct simulate_serial *simulated, const volatile int *stop);

/* As pulling the plug. */
void simulate_serial_end(struct simulate_serial *simulated);

#endif
