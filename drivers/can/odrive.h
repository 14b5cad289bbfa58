/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * ODrive's CANSimple: what motor controllers and a host say to each other on a CAN bus, in the two generations that are
 * in use, firmware 0.5.x (ODrive 3.x) and 0.6.x (Pro, S1, Micro). docs/drivers.md says where the facts come from.
 *
 * This file and odrive.c know nothing but frames: no system call, no allocation, no clock, no byte order.
 *
 * A frame's id is node << 5 | command; numbers are little-endian, floats IEEE. A command whose data come from the
 * controller comes cyclically, as the controller is configured, and as the answer to a remote frame of the same id.
 * There are no sequence numbers, no checksum but the bus's own, and nothing is acknowledged.
 */
#ifndef DPT_DRIVERS_ODRIVE_H
#define DPT_DRIVERS_ODRIVE_H

#include "can/can_message.h"

#define ODRIVE_NODES 64

/* Those that a haptic device needs. The numbers are the protocol's. */
enum {
    ODRIVE_VERSION = 0x00, /* 0.6; on 0.5 it is reserved and has no answer */
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

/* Of an axis; others are calibrations and searches that are under way. */
enum { ODRIVE_STATE_UNDEFINED = 0, ODRIVE_STATE_IDLE = 1, ODRIVE_STATE_CLOSED_LOOP = 8 };

#define ODRIVE_CONTROL_TORQUE    1
#define ODRIVE_INPUT_PASSTHROUGH 1

struct odrive_heartbeat {
    uint32_t errors;  /* of the axis: ODRIVE_ERRORS_0_6 or ODRIVE_AXIS_ERRORS */
    uint8_t state;    /* ODRIVE_STATE_... */
    uint8_t result;   /* 0.6: of the last procedure */
    uint8_t is_done;  /* a trajectory, which is nothing to us */
    uint8_t failed;   /* 0.5: ODRIVE_FAILED_... */
    uint8_t reserved; /* 0.6: what its last byte holds, 0 */
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
 * The frame of a message; `generation` is of the controller and matters to heartbeats and errors. 0 for what must not
 * be sent: no such command or node, a number that is not finite. A torque has 4 bytes: those behind them say nothing
 * and cost a fifth of a bus.
 */
int odrive_encode(const struct odrive_message *message, unsigned generation,
                  struct can_message *frame);

enum { ODRIVE_OTHER = 0, ODRIVE_MESSAGE = 1, ODRIVE_DAMAGED = 2 };

/*
 * ODRIVE_OTHER: a command that is none of the above, or not of this generation. ODRIVE_DAMAGED: too short, or not
 * finite. ODRIVE_ANY decodes what both generations have in common, heartbeats as if they were 0.6.
 */
int odrive_decode(const struct can_message *frame, unsigned generation,
                  struct odrive_message *message);

/* Which generation sent a heartbeat, as its bytes prove: ODRIVE_ANY when they could be either's. */
unsigned odrive_heartbeat_generation(const struct can_message *frame);

/* 1: what this command says goes to the controller and moves it, changes it or stops it. */
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

/* What they come to, DPT_REASON_... of dynpoint/device.h; DPT_REASON_DEVICE for a bit that has no name. */
uint32_t odrive_reasons(unsigned word, uint64_t errors);

/* "IDLE", "CLOSED_LOOP_CONTROL" ...; "unknown" for a number that is none. */
const char *odrive_state_name(unsigned state);

#endif
