/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Encode and decode the frames that a host and a device with our firmware exchange over a serial line. docs/wire.md
 * documents them byte by byte.
 *
 * This file and wire.c make no system call, allocate nothing, read no clock and do not depend on the byte order. The
 * same two files are compiled into the driver and into firmware. wire_device.h is the device's side on top of them.
 *
 * A frame on the line is the body, byte-stuffed so that it has no zero (COBS); then the CRC-32C of the stuffed bytes,
 * in five bytes of seven bits each; then a zero. The checksum covers the bytes on the line, so up to five flipped bits
 * that leave the frame's zeros alone are never missed. A zero ends every frame and is nowhere else, so after any damage
 * the reader is in step again at the next zero.
 */
#ifndef DPT_DRIVERS_WIRE_H
#define DPT_DRIVERS_WIRE_H

#include <stddef.h>
#include <stdint.h>

#define WIRE_VERSION    1
#define WIRE_JOINTS_MAX 8
#define WIRE_NAME_MAX   48
#define WIRE_LOG_MAX    120
#define WIRE_BODY_MAX   160
#define WIRE_FRAME_MAX  (WIRE_BODY_MAX + 7) /* on the line, with what surrounds the body */

enum {
    WIRE_HELLO = 1,     /* to the device: begins a session */
    WIRE_INFO = 2,      /* its answer */
    WIRE_STATE = 3,     /* from the device, each sample of a session */
    WIRE_COMMAND = 4,   /* to the device */
    WIRE_ORDER = 5,     /* to the device */
    WIRE_HEARTBEAT = 6, /* in both directions, if nothing else is sent */
    WIRE_LOG = 7        /* from the device: a line for people */
};

enum {
    WIRE_ENABLE = 1, /* motors on */
    WIRE_CLEAR = 2,  /* end a fault whose cause is gone */
    WIRE_STOP = 3    /* motors off */
};

/* wire_state.status and .reasons are numbered as DPT_DEVICE_STATUS_... and DPT_REASON_... of dynpoint/device.h. */
enum { WIRE_STATUS_FAULT = 1, WIRE_STATUS_UNREADY = 2, WIRE_STATUS_READY = 3 };
enum {
    WIRE_REASON_WATCHDOG = 4,
    WIRE_REASON_OVERHEATED = 8,
    WIRE_REASON_OVERLOADED = 16,
    WIRE_REASON_UNCALIBRATED = 32,
    WIRE_REASON_ESTOP = 64,
    WIRE_REASON_DEVICE = 512
};

#define WIRE_TEMPERATURE_LIMIT   200 /* of wire_state: a motor at its limit; 0 is cold */
#define WIRE_TEMPERATURE_UNKNOWN 255

/* Units and words as in dpt_device_info. */
struct wire_info {
    uint8_t pose_dofs; /* 3 or 6 */
    uint8_t wrench_dofs;
    uint8_t joints;
    uint8_t buttons;
    uint32_t flags;
    float rate;
    float force_max;
    float force_continuous;
    float torque_max;
    float stiffness_max;
    float position_step;
    float watchdog;
    float workspace_min[3];
    float workspace_max[3];
    char name[WIRE_NAME_MAX];
    char serial[WIRE_NAME_MAX];
};

struct wire_state {
    uint8_t pose_dofs; /* 6: orientation and spin are sent, too */
    uint8_t joints;    /* number of joint coordinates that are sent */
    uint8_t status;
    uint8_t temperature;
    uint8_t reordered; /* commands of the session that came after a later one, modulo 2^8 */
    uint16_t reasons;
    uint16_t code;
    uint16_t buttons;
    uint16_t lost;     /* commands of the session that never came, modulo 2^16 */
    uint16_t late;     /* commands that answer a sample older than the watchdog's time, modulo 2^16 */
    uint32_t sequence; /* of the sample, from the device's start */
    uint32_t time;     /* us, from the device's start, modulo 2^32 */
    uint32_t echo;     /* sequence of the newest command that came; 0: none yet */
    float position[3];
    float velocity[3];
    float orientation[4];
    float spin[3];
    float joint[WIRE_JOINTS_MAX];
};

struct wire_command {
    uint32_t sequence; /* from 1 in each session */
    uint32_t answers;  /* sequence of the sample that it was computed from */
    float force[3];
    float torque[3];
};

struct wire_heartbeat {
    uint8_t status;
    uint16_t reasons;
    uint32_t sequence; /* of the last sample that the device took, or the host saw */
    uint32_t time;
};

struct wire_log {
    uint8_t size;
    char text[WIRE_LOG_MAX];
};

/* `session` is chosen by the host and not 0; a device without a session sends 0. */
struct wire_message {
    uint8_t type;
    uint16_t session;
    union {
        struct wire_info info;
        struct wire_state state;
        struct wire_command command;
        struct wire_heartbeat heartbeat;
        struct wire_log log;
        uint8_t order;
    } as;
};

/*
 * Encode a message as it goes over the line. Returns the number of bytes, or 0 for a message that must not be sent:
 * unknown type or order, a number that is not finite, a quaternion whose square is not within 1e-3 of 1, or too many
 * joints.
 */
size_t wire_encode(const struct wire_message *message, uint8_t frame[WIRE_FRAME_MAX]);

/* The number of bytes of a state on the line. */
size_t wire_state_bytes(unsigned pose_dofs, unsigned joints);

/* The bytes since the last zero, and counts since the start. Set all to zero before the first byte. */
struct wire_reader {
    uint32_t messages;
    uint32_t damaged; /* frames refused: checksum, length, unknown type, not finite */
    uint32_t foreign; /* whole frames of another version */
    uint16_t count;
    uint8_t version; /* of the last foreign one */
    uint8_t bytes[WIRE_FRAME_MAX];
};

enum { WIRE_MORE = 0, WIRE_MESSAGE = 1, WIRE_DAMAGED = 2, WIRE_FOREIGN = 3 };

/* Process one byte from the line. Only after WIRE_MESSAGE does `message` hold a message. */
int wire_read(struct wire_reader *reader, uint8_t byte, struct wire_message *message);

/*
 * Tracks numbered messages: which were lost, reordered or repeated. Of all that were sent up to the newest one,
 * `accepted` arrived in order, `lost` never, and `reordered` after a later one. One that comes 64 or more behind stays
 * lost.
 */
struct wire_sequence {
    uint64_t received_bits; /* bit k: number last - k has come */
    uint32_t last;
    uint32_t accepted;
    uint32_t lost;
    uint32_t reordered;
    uint32_t repeated; /* came before, or too old to tell */
};

/* Start; the next number is expected to be last + 1. */
void wire_sequence_start(struct wire_sequence *sequence, uint32_t last);

/* Count a message. Returns 1 if it is newer than all before; 0: do not use it. */
int wire_sequence_accept(struct wire_sequence *sequence, uint32_t number);

#endif
