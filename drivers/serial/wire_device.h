/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The device's side of the protocol, for firmware and for simulated devices: session, watchdog, latched faults, and the
 * wrench that the motors may give.
 *
 * Firmware copies four files into one folder: wire.c, wire.h, wire_device.c and wire_device.h. They need no other file
 * of dynpoint, and of the C library only mem*, strlen and sqrt. They allocate nothing, make no system call and read no
 * clock: time is counted in samples. No library of dynpoint contains wire_device.c, because no host needs it.
 *
 *     wire_device_init(&device, &info);      once
 *     wire_device_log(&device, "hello");     when there is a message for people
 *     each received byte:     wire_device_take(&device, byte);
 *     each sample:            n = wire_device_sample(&device, &sample, out);
 *                             send out[0..n) as a whole or not at all; drive the motors with device.force and .torque
 *
 * The calls must not run at the same time: an interrupt puts bytes into a queue, the servo loop takes them.
 *
 * The wrench is zero unless the device is ready and the last command is younger than info.watchdog. The watchdog runs
 * from the first command on. When it trips, the fault stays until the host clears it. Then the host must enable the
 * motors again.
 */
#ifndef DPT_DRIVERS_WIRE_DEVICE_H
#define DPT_DRIVERS_WIRE_DEVICE_H

#include "wire.h"

#define WIRE_OUT_MAX (3 * WIRE_FRAME_MAX) /* INFO, LOG and STATE */

/* What the device has just measured, in the device's frame; units as in dpt_device_state. */
struct wire_sample {
    float position[3];
    float velocity[3];
    float orientation[4]; /* this and spin: only if pose_dofs is 6 */
    float spin[3];
    float joint[WIRE_JOINTS_MAX];
    uint32_t time; /* us */
    uint16_t buttons;
    /* WIRE_REASON_... that hold now. Each starts a fault; UNCALIBRATED only keeps the motors off. */
    uint16_t causes;
    uint16_t code; /* the device's own number of the fault WIRE_REASON_DEVICE */
    uint8_t temperature;
};

struct wire_device {
    struct wire_info info;
    struct wire_reader reader;
    struct wire_sequence commands; /* received in this session */
    uint32_t sequence;             /* of the last sample; the first is 1 */
    uint32_t late;
    uint32_t watchdog_samples;      /* info.watchdog in samples */
    uint32_t samples_since_command; /* counts while is_armed */
    uint32_t samples_since_frame;   /* since a frame of the session came */
    uint16_t session;
    uint16_t reasons; /* latched */
    uint16_t causes;  /* of the last sample */
    uint16_t code;
    uint8_t is_enabled;
    uint8_t is_armed;       /* a command came after the motors were enabled */
    uint8_t must_send_info; /* with the next sample */
    uint8_t log_size;
    float force[3];
    float torque[3];
    char log[WIRE_LOG_MAX];
};

/* Start without a session. `info` is what the device says of itself. */
void wire_device_init(struct wire_device *device, const struct wire_info *info);

/* Process one byte from the line. */
void wire_device_take(struct wire_device *device, uint8_t byte);

/* Send a line of text with the next sample. It replaces one that still waits. At most WIRE_LOG_MAX bytes are sent. */
void wire_device_log(struct wire_device *device, const char *text);

/* WIRE_STATUS_... */
uint8_t wire_device_status(const struct wire_device *device);

/*
 * Process a sample: run the watchdog, set device.force and device.torque, and write the bytes to send into `out`.
 * Returns their number. A device with a session sends its state with every sample; without a session it sends a
 * heartbeat ten times a second.
 */
size_t wire_device_sample(struct wire_device *device, const struct wire_sample *sample, uint8_t out[WIRE_OUT_MAX]);

#endif
