/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The motor drives that an arm on CAN may have: a table, with one file a drive (odrive.c, damiao.c, robstride.c, moteus.c).
 * A drive's file says which frames its motors take and send, which ranges their numbers have, how their watchdog is set,
 * and what their faults mean. docs/motors.md names the vendors' documents that the facts are from.
 *
 * These files make no system call, allocate nothing, read no clock and do not depend on the byte order. Each encodes and
 * decodes both directions, so that a motor can be simulated by them.
 *
 * There are two kinds. A drive that reports by itself (ODrive) sends estimates and heartbeats cyclically; odrive.h decodes
 * them. All others answer: each command is answered by one status, with position, velocity, torque and faults.
 */
#ifndef DPT_DRIVERS_DRIVE_H
#define DPT_DRIVERS_DRIVE_H

#include <stddef.h>

#include "can/can_message.h"

/* What a message says. */
enum {
    DRIVE_OTHER = 0, /* nothing that is listed here */
    /* To a motor. */
    DRIVE_TORQUE, /* give this torque */
    DRIVE_MODE,   /* obey torques; for drives that have no such parameter below */
    DRIVE_ON,
    DRIVE_OFF,
    DRIVE_STOP,  /* emergency stop; DRIVE_OFF where a drive has none */
    DRIVE_CLEAR, /* forget faults */
    DRIVE_ASK,   /* send a status, or an estimate. A motor that is off stays so; one that is on may go off */
    DRIVE_READ,  /* send a parameter */
    DRIVE_WRITE, /* set a parameter */
    DRIVE_ORDER, /* any other order: a position, a speed, a new zero, a new number */
    /* From a motor. */
    DRIVE_STATUS,
    DRIVE_FAULT,  /* a fault alone, without a status */
    DRIVE_VALUE,  /* of a parameter */
    DRIVE_DAMAGED /* too short, or a number is not finite */
};

/* Parameters, in SI units. */
enum {
    DRIVE_VERSION,        /* of the registers or the firmware, as the motor counts them */
    DRIVE_CONTROL,        /* which commands it obeys, as the motor counts them */
    DRIVE_WATCHDOG,       /* s; 0: none */
    DRIVE_POSITION_RANGE, /* rad, rad/s, Nm: what the largest numbers in its frames mean, to either side */
    DRIVE_VELOCITY_RANGE,
    DRIVE_TORQUE_RANGE,
    DRIVE_TORQUE_LIMIT, /* Nm */
    DRIVE_HEAT_LIMIT,   /* degrees Celsius */
    DRIVE_PARAMETERS
};

struct drive_status {
    float position, velocity; /* of the motor's output: turns, turns/s */
    float torque;             /* Nm */
    float temperature;        /* of its hottest part that is measured, degrees Celsius */
    uint32_t fault;           /* the drive's own number or bits; 0: none */
    uint8_t is_on;
};

struct drive_message {
    uint8_t kind;      /* DRIVE_TORQUE... */
    uint8_t parameter; /* of DRIVE_READ, _WRITE and _VALUE */
    union {
        struct {
            float torque;          /* Nm */
            float watchdog, limit; /* moteus: s and Nm, in each command; others: 0 */
        } command;
        struct drive_status status;
        uint32_t fault;
        double value;
    } as;
};

struct can_drive;

/* A motor on the bus. */
struct drive_node {
    const struct can_drive *drive;
    uint16_t number;    /* its id */
    uint16_t answer;    /* Damiao: the id that its answers have; RobStride, moteus: the host's id */
    uint8_t generation; /* ODrive: ODRIVE_0_5 or ODRIVE_0_6 */
    double position_range, velocity_range, torque_range; /* rad, rad/s, Nm; 0: not known, or numbers are floats */
    double heat_limit;                                   /* degrees Celsius; 0: not known */
    double watchdog;                                     /* s; 0: none. moteus: sent in each command */
    double torque_limit;                                 /* Nm. moteus: sent in each command */
};

/* What is done with a parameter before a motor is switched on. */
enum {
    DRIVE_CHECK, /* read, and refused unless within `min` and `max` */
    DRIVE_LEARN, /* read, and used */
    DRIVE_SET    /* written, and read back */
};

/* A parameter's place in a motor. */
struct drive_parameter {
    uint8_t parameter; /* DRIVE_VERSION... */
    uint8_t action;    /* DRIVE_CHECK... */
    uint8_t bytes;     /* of an unsigned integer; 0: a float */
    uint16_t index;    /* the motor's number of it */
    double unit;       /* of an integer */
    double min, max;   /* DRIVE_CHECK; DRIVE_SET of DRIVE_CONTROL: `min` is set */
};

/* A fault's name and what it means, DPT_REASON_... */
struct drive_fault {
    uint32_t fault, reason;
    const char *name;
};

struct can_drive {
    const char *name;   /* as in the setting `drive` */
    const char *title;  /* for people */
    uint8_t is_fd;      /* it needs CAN-FD */
    uint8_t answers;    /* 1: each command is answered by a status; 0: it reports by itself */
    uint8_t has_models; /* 1: its ranges are a model's, by the setting `model` */
    uint16_t number_min, number_max;
    uint16_t answer;                    /* the default of drive_node.answer */
    uint8_t answer_has_number;          /* 1: the motor's number is added to it */
    uint16_t command_bits, answer_bits; /* a torque and its answer on the bus with most stuffing: at the bus's rate */
    uint16_t command_data_bits, answer_data_bits;                    /* and at CAN-FD's data rate */
    double position_range, velocity_range, torque_range, heat_limit; /* those of drive_node; 0: learnt, or a model's */
    double position_step, torque_step;     /* the smallest change on the wire: turns, Nm; 0: that of the ranges below */
    uint32_t position_steps, torque_steps; /* number of steps in the whole range; 0: floats */
    const struct drive_parameter *parameters;
    uint32_t parameter_count;
    const struct drive_fault *faults; /* the last has no name */
    uint8_t faults_are_bits;          /* 1: a fault is a set of bits; 0: a number */

    /* Encode a message to or from this motor. Returns 0 for a message that it does not have, or that must not be sent. */
    int (*encode)(const struct drive_node *node, const struct drive_message *message, struct can_message *frame);

    /* Decode a frame. Returns message->kind; DRIVE_OTHER if it is not of this motor. NULL: odrive.h decodes. */
    int (*decode)(const struct drive_node *node, const struct can_message *frame, struct drive_message *message);

    /* Fill in which frames are to this motor and from it. Returns how many entries, at most DRIVE_WANTED. */
    int (*wanted)(const struct drive_node *node, struct can_wanted *wanted);
};

enum { DRIVE_WANTED = 3 };

extern const struct can_drive odrive_drive, damiao_drive, robstride_drive, cybergear_drive, moteus_drive;

/* The drive of this name; NULL if there is none. And the drive of this index, from 0; NULL after the last. */
const struct can_drive *drive_find(const char *name, size_t length);
const struct can_drive *drive_get(uint32_t index);

/*
 * Set the ranges of a drive that has models: "rs-02", or "44:17", the ranges of velocity, rad/s, and torque, Nm. Returns 0 for
 * a name that is not known.
 */
int drive_set_model(struct drive_node *node, const char *name, size_t length);

/* The smallest changes of position, turns, and torque, Nm, that the motor's frames carry; 0: not known. */
double drive_position_step(const struct drive_node *node);
double drive_torque_step(const struct drive_node *node);

/* The parameter's place; NULL if the drive does not have it. */
const struct drive_parameter *drive_parameter_of(const struct can_drive *drive, unsigned parameter);

/* The name of the lowest fault, "unknown" for one without a name, NULL for 0; and the reasons of all, DPT_REASON_... */
const char *drive_fault_name(const struct can_drive *drive, uint32_t fault);
uint32_t drive_reasons(const struct can_drive *drive, uint32_t fault);

/*
 * The share of a bus that commands and answers at `rate`, Hz, of all `count` motors need with most stuffing: above 1 they do
 * not fit.
 *   request         1: ODrives are asked for each estimate
 *   bitrate         bit/s
 *   data_bitrate    of CAN-FD; 0: as bitrate
 */
double drive_bus_load(const struct drive_node *nodes, uint32_t count, double rate, int request, uint32_t bitrate,
                      uint32_t data_bitrate);

/* 1 if a frame could be of both motors, so that they cannot share a bus. */
int drive_nodes_collide(const struct drive_node *a, const struct drive_node *b);

/* For the drives' files: bits of a number in +-range, rounded to the nearest and limited, and back. */
uint32_t drive_quantise(double value, double range, unsigned bits);
double drive_value_of(uint32_t number, double range, unsigned bits);

/* Bytes of an integer or a float, little-endian. drive_get_value returns 0 for a float that is not finite. */
void drive_put_value(const struct drive_parameter *parameter, double value, uint8_t *at);
int drive_get_value(const struct drive_parameter *parameter, const uint8_t *at, double *value);

#endif
