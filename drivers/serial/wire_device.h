/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A device's side of the protocol, for firmware and for what pretends to be a device: session, watchdog, latched
 * faults, and what the motors may do.
 *
 * Firmware copies four files into one folder: wire.c, wire.h, wire_device.c and wire_device.h. They need no other file
 * of dynpoint, and of the C library only mem*, strlen and sqrt. They allocate nothing, make no system call and read no
 * clock: time passes by samples. No library of dynpoint contains wire_device.c, as no host needs it.
 *
 *     wire_device_init(&device, &info);      once
 *     wire_device_log(&device, "hello");     where there is something to say to people
 *     each byte that comes:   wire_device_take(&device, byte);
 *     each sample:            n = wire_device_sample(&device, &sample, out);
 *                             send out[0..n), all or nothing; the motors do device.force and device.torque
 *
 * The calls must not run at the same time: an interrupt puts bytes into a queue, the servo loop takes them.
 *
 * The wrench is zero unless the device is ready and the last command is younger than info.watchdog. The watchdog runs
 * from the first command on; when it finds none, the fault stays until the host clears it, and then the host must
 * enable the motors again.
 */
#ifndef DPT_DRIVERS_WIRE_DEVICE_H
#define DPT_DRIVERS_WIRE_DEVICE_H

#include "wire.h"

#define WIRE_OUT_MAX (3 * WIRE_FRAME_MAX) /* the longest that a sample has to say */

/* What the device has just measured. */
struct wire_sample {
    float position[3];
    float velocity[3];
    float orientation[4]; /* these two with 6 pose_dofs alone */
    float spin[3];
    float joint[WIRE_JOINTS_MAX];
    uint32_t time; /* us */
    uint16_t buttons;
    uint16_t
        causes; /* WIRE_REASON_... that hold now: each begins a fault, UNCALIBRATED alone keeps the motors off */
    uint16_t code; /* of WIRE_REASON_DEVICE */
    uint8_t temperature;
};

struct wire_device {
    struct wire_info info;
    struct wire_reader reader;
    struct wire_sequence commands; /* of the commands */
    uint32_t sequence;             /* of the last sample; the first is 1 */
    uint32_t late;
    uint32_t watchdog_samples;      /* info.watchdog in samples */
    uint32_t samples_since_command; /* samples since the last command; counts while armed */
    uint32_t samples_since_frame;   /* samples since anything of the session came */
    uint16_t session;
    uint16_t reasons; /* latched */
    uint16_t causes;  /* of the last sample */
    uint16_t code;
    uint8_t is_enabled;
    uint8_t is_armed; /* a command came since the motors are on */
    uint8_t must_send_info;
    uint8_t log_size;
    float force[3];
    float torque[3];
    char log[WIRE_LOG_MAX];
};

void wire_device_init(struct wire_device *device, const struct wire_info *info);

void wire_device_take(struct wire_device *device, uint8_t byte);

/* A line that goes out with the next sample; one that still waits is replaced. */
void wire_device_log(struct wire_device *device, const char *text);

uint8_t wire_device_status(const struct wire_device *device);

/*
 * A sample was taken: looks after the watchdog, and writes what is to be sent; returns how many bytes. A device with a
 * session says its state; without one it shows life ten times a second.
 */
size_t wire_device_sample(struct wire_device *device, const struct wire_sample *sample,
                          uint8_t out[WIRE_OUT_MAX]);

#endif
