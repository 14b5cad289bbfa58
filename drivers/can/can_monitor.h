/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Monitors the motor controllers (nodes) of one arm by their frames: the last message of each kind, faults (too few,
 * too many or wrong messages), and which sent torques came back from the bus. It makes no system call and reads no
 * clock: times are arguments, of clock_now.
 *
 * CANSimple has no sequence numbers, so faults are found by time and content. A sample is one estimate of each node.
 * Lost samples are counted by the periods that passed without one. A torque is missed if it does not come back from the
 * bus in time, in order, or at all. Equal torques cannot be told apart.
 *
 * A node's index is that of its joint; its number is its id on the bus.
 */
#ifndef DPT_DRIVERS_CAN_MONITOR_H
#define DPT_DRIVERS_CAN_MONITOR_H

#include "can/can_arm.h"
#include "can/odrive.h"

#define CAN_SENT_MAX 32

/*
 * Faults that the host finds, in dpt_device_state.code: the bytes 0xca, 0, the node's number (0xff: the bus), and one
 * of these. Other codes are a controller's error bits.
 */
enum {
    CAN_CODE_OFF = 1,           /* bus-off */
    CAN_CODE_PASSIVE = 2,       /* error-passive */
    CAN_CODE_DOWN = 3,          /* the interface was shut */
    CAN_CODE_GONE = 4,          /* it was unplugged */
    CAN_CODE_STUCK = 5,         /* commands do not get out */
    CAN_CODE_DROPPED = 6,       /* the kernel or the adapter dropped received frames */
    CAN_CODE_BABBLING = 7,      /* far more frames than it is to send, of any kind */
    CAN_CODE_DUPLICATE = 8,     /* its cyclic messages come too often: two nodes of one number */
    CAN_CODE_FOREIGN_ORDER = 9, /* someone else gives our nodes orders */
    CAN_CODE_RESTARTED = 10,    /* it left closed loop without an error: rebooted, or was told to */
    CAN_CODE_NO_ESTIMATE = 11,  /* no estimate */
    CAN_CODE_NO_HEARTBEAT = 12, /* no heartbeat */
    CAN_CODE_JUMPED = 13,       /* further than it can have moved: its encoder lost count */
    CAN_CODE_HOT = 14           /* a motor is as hot as it may be */
};
#define CAN_CODE(kind, node) (0xca000000u | (uint32_t)(node) << 8 | (uint32_t)(kind))
#define CAN_CODE_BUS         0xff

/* A torque that was sent and has not come back yet. */
struct can_sent {
    uint64_t time_ns;      /* when it was sent */
    uint32_t frame;        /* a number made of its id and data */
    uint32_t is_overtaken; /* 1: a later torque came back first */
};

struct can_node {
    const struct drive_node *end; /* how it is reached; of the arm */
    uint8_t node, generation;     /* its number; of an ODrive ODRIVE_0_5 or ODRIVE_0_6, ODRIVE_ANY: not known yet */
    uint8_t proven_generation;    /* what a heartbeat or an answer proved; ODRIVE_ANY: nothing */
    uint8_t has_heartbeat, has_estimate, is_fresh, is_duplicate;
    struct odrive_heartbeat heartbeat;
    uint64_t errors[ODRIVE_ERROR_WORDS];
    uint64_t serial; /* 0: not reported */
    uint64_t heartbeat_ns, estimate_ns;
    float position, velocity; /* of the motor: turns, turns/s */
    double speed_allowance;   /* turns/s by which its motor may move faster than its velocity says */
    /* By how much its estimates and heartbeats are ahead of their periods, see check_rate. */
    int64_t estimates_ahead_ns;
    int64_t heartbeats_ahead_ns;
    uint64_t window_ns; /* when `frames` was last 0 */
    uint32_t frames;
    uint64_t first_ns;              /* when the first estimate since can_monitor_restart_counts came */
    uint32_t estimates, heartbeats; /* number of them since then */
    /* Of a drive that answers each command, as its last status said; has_heartbeat: there was one. */
    uint8_t is_on;
    uint32_t fault;
    float temperature;             /* degrees Celsius */
    int32_t surplus;               /* answers beyond commands; two motors of one number answer twice */
    uint8_t setup_at, setup_tries; /* which parameter is next, and how often it was asked for */
    uint8_t is_refused;            /* 1: that parameter has a value that it must not have */
    uint64_t setup_ns;             /* when it is to be asked for again */
    uint32_t known_values;         /* bit k: the parameter k has come */
    double value[DRIVE_PARAMETERS];
    uint32_t sent_count;
    struct can_sent sent[CAN_SENT_MAX]; /* the oldest first */
};

struct can_monitor {
    struct can_node nodes[DPT_JOINTS_MAX];
    uint8_t index[ODRIVE_NODES]; /* by an ODrive's number, its index in `nodes`; 0xff: none of ours */
    uint32_t count;
    uint64_t period_ns, heartbeat_period_ns, silent_ns;
    uint8_t is_armed; /* 1: all nodes are in closed loop, and whatever ends that is a fault */
    uint8_t has_confirmed;
    uint32_t failed_nodes;          /* bit k: parts of node k have errors that are to be requested */
    uint32_t foreign_orders;        /* control messages that someone else sent to our nodes */
    uint32_t status, reasons, code; /* of the device */
    uint64_t unconfirmed_ns;        /* since when nothing that we send comes back; 0: it does */
    uint32_t dropped;
    float position[DPT_JOINTS_MAX]; /* the newest complete sample, of the motors: turns */
    float velocity[DPT_JOINTS_MAX]; /* turns/s */
    uint64_t sample_ns;             /* when it was complete; 0: none yet */
    uint64_t expected_ns;           /* when it was expected */
    uint64_t sequence;              /* its number */
    dpt_device_counts counts;
};

/* Start to monitor the nodes of `arm`, with nothing known. */
void can_monitor_init(struct can_monitor *monitor, const struct can_arm *arm, const struct can_settings *settings);

/* Forget all messages, but not the counts and the nodes' generations: the line was opened again. */
void can_monitor_forget(struct can_monitor *monitor);

/* Count `seen` and `pulses` anew. */
void can_monitor_restart_counts(struct can_monitor *monitor);

/* Process a frame that came: of a node of ours, or one of our own that comes back. Ignores all others. */
void can_monitor_take(struct can_monitor *monitor, const struct can_message *message);

/* Note that a frame of ours was sent: a torque is expected back from the bus, a command to be answered. */
void can_monitor_note_sent(struct can_monitor *monitor, const struct can_message *frame, uint64_t now);

/* Note that sending was attempted, whether or not anything was sent. */
void can_monitor_note_attempt(struct can_monitor *monitor, uint64_t now);

/*
 * Check what has not happened in time: silent nodes, missing heartbeats, torques that did not come back.
 *   is_drained   1: all that had come by `now` was processed; 0: nothing is checked
 */
void can_monitor_check(struct can_monitor *monitor, uint64_t now, int is_drained);

/*
 * Lower the device's status to this one, unless it is lower already, and add the reasons. Does nothing while not
 * armed.
 */
void can_monitor_set_status(struct can_monitor *monitor, uint32_t status, uint32_t reasons, uint32_t code);

/* 1 if the node's last heartbeat or status says that its motor is on; and 1 if it also says that there is no error. */
int can_node_is_on(const struct can_node *node);
int can_node_is_active(const struct can_node *node);

/* How hot the motors are whose limit is known: 0 is 20 degrees, 1 their limit; -1: none is known. */
double can_monitor_temperature(const struct can_monitor *monitor);

/* Write the node's state and errors, as in "node 3: IDLE, UNKNOWN_POSITION, motor DRV_FAULT". */
void can_node_describe(const struct can_node *node, char *text, size_t size);

#endif
