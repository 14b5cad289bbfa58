/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The frames that a host and a device of our own exchange over a serial line; docs/wire.md has them byte by byte.
 *
 * This file and wire.c know nothing but bytes: no system call, no allocation, no clock, no byte order. The same two are
 * compiled into the driver and into firmware. wire_device.h builds a device's side on top of it.
 *
 * On the line: the body, byte-stuffed so that it holds no zero (COBS); its CRC-32C, over the stuffed bytes, in five
 * bytes of seven bits each; a zero. As the checksum covers what is on the line, up to five flipped bits in a frame that
 * leave its zeros alone are never missed; and as a zero ends every frame and is nowhere else, whatever happened, the
 * frame that begins after the next zero is read.
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
#define WIRE_FRAME_MAX  (WIRE_BODY_MAX + 7) /* on the line, with all that is around the body */

enum {
    WIRE_HELLO = 1,     /* to the device: begins a session */
    WIRE_INFO = 2,      /* its answer */
    WIRE_STATE = 3,     /* from the device, each sample of a session */
    WIRE_COMMAND = 4,   /* to the device */
    WIRE_ORDER = 5,     /* to the device */
    WIRE_HEARTBEAT = 6, /* either way, where nothing else shows life */
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

#define WIRE_TEMPERATURE_LIMIT   200 /* wire_state.temperature that a motor may have, 0 is cold */
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
    uint8_t joints;    /* so many angles are sent */
    uint8_t status;
    uint8_t temperature;
    uint8_t reordered; /* commands since the hello, modulo 2^8: came after a later one */
    uint16_t reasons;
    uint16_t code;
    uint16_t buttons;
    uint16_t lost;     /* likewise, modulo 2^16: never came */
    uint16_t late;     /* came, but answer a sample older than the watchdog's time */
    uint32_t sequence; /* of the sample, from the device's start */
    uint32_t time;     /* us, from the device's start, modulo 2^32 */
    uint32_t echo;     /* sequence of the last command that was taken; 0: none yet */
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
    uint32_t sequence; /* of the last sample taken, or seen */
    uint32_t time;
};

struct wire_log {
    uint8_t size;
    char text[WIRE_LOG_MAX];
};

/* `session` is the host's choice, not 0; 0 is a device without a session. */
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
 * The bytes of a message as they go over the line; returns how many, 0 for one that must not be sent: no known type or
 * order, a number not finite, a quaternion whose square is not within 1e-3 of 1, more joints than there can be.
 */
size_t wire_encode(const struct wire_message *message, uint8_t frame[WIRE_FRAME_MAX]);

/* How many bytes on the line a state has. */
size_t wire_state_bytes(unsigned pose_dofs, unsigned joints);

/* What has come since the last zero, and counts since the start. Begin with zeros. */
struct wire_reader {
    uint32_t messages;
    uint32_t damaged; /* refused: checksum, length, unknown, not finite */
    uint32_t foreign; /* whole, but of another version */
    uint16_t count;
    uint8_t version; /* of the last foreign one */
    uint8_t bytes[WIRE_FRAME_MAX];
};

enum { WIRE_MORE = 0, WIRE_MESSAGE = 1, WIRE_DAMAGED = 2, WIRE_FOREIGN = 3 };

/* One byte from the line. WIRE_MESSAGE: `message` is filled; otherwise it is left as it was or holds nothing of use. */
int wire_read(struct wire_reader *reader, uint8_t byte, struct wire_message *message);

/*
 * Whether numbered messages arrive once and in order. Of all that were sent up to the last one, taken + lost +
 * reordered arrived in order, never, and after a later one. Those that come 64 or more behind stay lost.
 */
struct wire_sequence {
    uint64_t received_bits; /* bit k: last - k has come */
    uint32_t last;
    uint32_t accepted;
    uint32_t lost;
    uint32_t reordered;
    uint32_t repeated; /* came before, or is too old to tell */
};

/* Start after number `last`. */
void wire_sequence_start(struct wire_sequence *sequence, uint32_t last);

/* 1: newer than all before; 0: count it, and use it no more. */
int wire_sequence_accept(struct wire_sequence *sequence, uint32_t number);

#endif
