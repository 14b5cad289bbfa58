/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Encode and decode the frames of ODrive's CANSimple, between a host and motor controllers on a CAN bus. Two
 * generations are in use: firmware 0.5.x (ODrive 3.x) and 0.6.x (Pro, S1, Micro). docs/back_ends.md names the sources.
 *
 * This file and odrive.c make no system call, allocate nothing, read no clock and do not depend on the byte order.
 *
 * A frame's id is node << 5 | command. Numbers are little-endian, floats are IEEE. A controller sends its messages
 * cyclically, as it is configured, and as the answer to a remote frame with the same id. There are no sequence numbers,
 * no checksum but the bus's own, and nothing is acknowledged.
 */
#ifndef DPT_DRIVERS_ODRIVE_H
#define DPT_DRIVERS_ODRIVE_H

#include "can/can_message.h"

#define ODRIVE_NODES 64

/* The commands that a haptic device needs, with the protocol's numbers. Unless said, a controller sends them. */
enum {
    ODRIVE_VERSION = 0x00, /* 0.6; reserved on 0.5, which does not answer */
    ODRIVE_HEARTBEAT = 0x01,
    ODRIVE_ESTOP = 0x02,
    ODRIVE_ERROR = 0x03,            /* 0.6: all errors; 0.5: the motor's */
    ODRIVE_ENCODER_ERROR = 0x04,    /* 0.5 */
    ODRIVE_ADDRESS = 0x06,          /* 0.6. On 0.5 it SETS the node's number: never ask it there */
    ODRIVE_SET_STATE = 0x07,        /* to the controller */
    ODRIVE_ESTIMATES = 0x09,        /* of the encoder */
    ODRIVE_SET_MODE = 0x0b,         /* to the controller */
    ODRIVE_SET_TORQUE = 0x0e,       /* to the controller */
    ODRIVE_CLEAR_ERRORS = 0x18,     /* to the controller */
    ODRIVE_CONTROLLER_ERROR = 0x1d, /* 0.5 */
};

enum { ODRIVE_ANY = 0, ODRIVE_0_5 = 5, ODRIVE_0_6 = 6 }; /* generation */

/* States of an axis. All others are calibrations and searches in progress. */
enum { ODRIVE_STATE_UNDEFINED = 0, ODRIVE_STATE_IDLE = 1, ODRIVE_STATE_CLOSED_LOOP = 8 };

#define ODRIVE_CONTROL_TORQUE    1
#define ODRIVE_INPUT_PASSTHROUGH 1

struct odrive_heartbeat {
    uint32_t errors;  /* of the axis: ODRIVE_ERRORS_0_6 or ODRIVE_AXIS_ERRORS */
    uint8_t state;    /* ODRIVE_STATE_... */
    uint8_t result;   /* 0.6: of the last procedure */
    uint8_t is_done;  /* 1: a trajectory is done; not used */
    uint8_t failed;   /* 0.5: ODRIVE_FAILED_... */
    uint8_t reserved; /* 0.6: the last byte, 0 */
};

/* Parts of an axis that have errors of their own; bits of odrive_heartbeat.failed. */
enum { ODRIVE_FAILED_MOTOR = 1, ODRIVE_FAILED_ENCODER = 2, ODRIVE_FAILED_CONTROLLER = 4 };

struct odrive_message {
    uint8_t node;       /* 0..63 */
    uint8_t command;    /* ODRIVE_... */
    uint8_t is_request; /* 1: a remote frame, without data */
    union {
        struct {
            uint8_t protocol, hardware[3], firmware[3], is_unreleased;
        } version;
        struct odrive_heartbeat heartbeat;
        struct {
            uint64_t active; /* 0.5: of the part that the command names */
            uint32_t disarm; /* 0.6: why it stopped */
        } error;
        struct {
            uint64_t serial; /* 48 bits */
            uint8_t node;
        } address;
        struct {
            float position, velocity; /* turns of the motor, turns/s */
        } estimates;
        struct {
            uint32_t control, input;
        } mode;
        uint32_t state;
        float torque; /* Nm of the motor */
    } as;
};

/*
 * Encode a message. `generation` is that of the controller; heartbeats and errors depend on it. Returns 1, or 0 for a
 * message that must not be sent: unknown command or node, or a number that is not finite. A torque is sent with 4 bytes
 * of data: more bytes would carry nothing and cost a fifth of a bus.
 */
int odrive_encode(const struct odrive_message *message, unsigned generation, struct can_message *frame);

enum { ODRIVE_OTHER = 0, ODRIVE_MESSAGE = 1, ODRIVE_DAMAGED = 2 };

/*
 * Decode a frame. Returns ODRIVE_MESSAGE; ODRIVE_OTHER for a command that is not listed above or not of this
 * generation; ODRIVE_DAMAGED for a frame that is too short or has a number that is not finite. The generation
 * ODRIVE_ANY decodes what both have in common, and heartbeats as those of 0.6.
 */
int odrive_decode(const struct can_message *frame, unsigned generation, struct odrive_message *message);

/* The generation that a heartbeat's bytes prove; ODRIVE_ANY if both could have sent them. */
unsigned odrive_heartbeat_generation(const struct can_message *frame);

/* 1 if this command goes to a controller and moves, changes or stops it. */
int odrive_is_control(unsigned command);

/* Words of error bits. */
enum {
    ODRIVE_ERRORS_0_6,
    ODRIVE_AXIS_ERRORS, /* 0.5, as the rest */
    ODRIVE_MOTOR_ERRORS,
    ODRIVE_ENCODER_ERRORS,
    ODRIVE_CONTROLLER_ERRORS,
    ODRIVE_ERROR_WORDS
};

/*
 * The name of the lowest bit, as ODrive's documents spell it, "WATCHDOG_TIMER_EXPIRED"; "unknown" for a bit that has
 * none; NULL for 0.
 */
const char *odrive_error_name(unsigned word, uint64_t errors);

/* The reasons that error bits mean, DPT_REASON_... of dynpoint/device.h; DPT_REASON_DEVICE for a bit without a name. */
uint32_t odrive_reasons(unsigned word, uint64_t errors);

/* The name of a state, as "IDLE" or "CLOSED_LOOP_CONTROL"; "unknown" for any other number. */
const char *odrive_state_name(unsigned state);

#endif
