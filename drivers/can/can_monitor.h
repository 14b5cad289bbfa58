/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The motor controllers of one arm as their frames show them: what each last said, whether it says too little, too much
 * or something wrong, and what became of the torques that were sent. No system call and no clock: time comes in.
 *
 * CANSimple numbers nothing, so all of this is by time and content. A sample is an estimate of each node; those that
 * were lost are counted by the periods that passed without one. A torque is missed when it does not come back from the
 * bus in time, in order, or at all; the same number sent twice is the same torque, whichever comes back.
 */
#ifndef DPT_DRIVERS_CAN_MONITOR_H
#define DPT_DRIVERS_CAN_MONITOR_H

#include "can/can_arm.h"
#include "can/odrive.h"

#define CAN_SENT_MAX 32

/*
 * What the host itself finds wrong, in dpt_device_state.code: 0xca, a zero, the node (0xff: the bus), and one of these.
 * Other codes are a controller's error bits.
 */
enum {
    CAN_CODE_OFF = 1,           /* bus-off */
    CAN_CODE_PASSIVE = 2,       /* error-passive */
    CAN_CODE_DOWN = 3,          /* the interface was shut */
    CAN_CODE_GONE = 4,          /* it was unplugged */
    CAN_CODE_STUCK = 5,         /* commands do not get out */
    CAN_CODE_DROPPED = 6,       /* the kernel or the controller lost frames that had come */
    CAN_CODE_BABBLING = 7,      /* far more frames than it is to send, of any kind */
    CAN_CODE_DUPLICATE = 8,     /* its cyclic messages come too often: two nodes of one number */
    CAN_CODE_FOREIGN_ORDER = 9, /* someone else gives our nodes orders */
    CAN_CODE_RESTARTED = 10,    /* it left closed loop without an error: rebooted, or was told to */
    CAN_CODE_NO_ESTIMATE = 11,  /* no estimate */
    CAN_CODE_NO_HEARTBEAT = 12, /* no heartbeat */
    CAN_CODE_JUMPED = 13        /* further than it can have moved: its encoder lost count */
};
#define CAN_CODE(kind, node) (0xca000000u | (uint32_t)(node) << 8 | (uint32_t)(kind))
#define CAN_CODE_BUS         0xff

/* A torque that is under way. */
struct can_sent {
    uint64_t time_ns;
    uint32_t bits;
    uint32_t is_overtaken; /* by a later one that came back first */
};

struct can_node {
    uint8_t node, generation;  /* ODRIVE_ANY: not known yet */
    uint8_t proven_generation; /* the same, as its heartbeats or an answer prove */
    uint8_t has_heartbeat, has_estimate, is_fresh, is_duplicate;
    struct odrive_heartbeat heartbeat;
    uint64_t errors[ODRIVE_ERROR_WORDS];
    uint64_t serial; /* 0: not told */
    uint64_t heartbeat_ns, estimate_ns;
    float position, velocity;
    double
        speed_allowance; /* turns/s at which a joint may move, whatever it says of its velocity */
    int64_t estimates_ahead_ns; /* of the clock, ns: its estimates and its heartbeats */
    int64_t heartbeats_ahead_ns;
    uint64_t window_ns; /* when `frames` was last 0 */
    uint32_t frames;
    uint64_t first_ns; /* since can_monitor_restart_counts: when the first estimate came */
    uint32_t estimates, heartbeats; /* estimates and heartbeats */
    uint32_t sent_count;
    struct can_sent sent[CAN_SENT_MAX];
};

struct can_monitor {
    struct can_node nodes[DPT_JOINTS_MAX];
    uint8_t index[ODRIVE_NODES]; /* into `at`; 0xff: none of ours */
    uint32_t count;
    uint64_t period_ns, heartbeat_period_ns, silent_ns;
    uint8_t is_armed; /* all are in closed loop: whatever ends that is a fault */
    uint8_t has_confirmed;
    uint32_t failed_nodes; /* bit k: node k has errors in parts that are to be asked */
    uint32_t foreign_orders;
    uint32_t status, reasons, code; /* of the device */
    uint64_t unconfirmed_ns;        /* since when nothing of what we send comes back; 0: not so */
    uint32_t dropped;
    float position[DPT_JOINTS_MAX]; /* the newest whole sample, in turns, and when it was whole */
    float velocity[DPT_JOINTS_MAX];
    uint64_t sample_ns, expected_ns;
    uint64_t sequence;
    dpt_device_counts counts;
};

void can_monitor_init(struct can_monitor *monitor, const struct can_arm *arm,
                      const struct can_settings *settings);

/* Forget what was said, but not the counts: the line was opened again. */
void can_monitor_forget(struct can_monitor *monitor);

/* Count `seen` and `pulses` anew. */
void can_monitor_restart_counts(struct can_monitor *monitor);

void can_monitor_take(struct can_monitor *monitor, const struct can_message *message);

/* A torque went out to node `index` of `at`; and a batch was tried, whether it went or not. */
void can_monitor_note_sent(struct can_monitor *monitor, uint32_t index, float torque, uint64_t now);
void can_monitor_note_attempt(struct can_monitor *monitor, uint64_t now);

/* What has not happened in time. `is_all`: all that had come by `now` was taken. */
void can_monitor_check(struct can_monitor *monitor, uint64_t now, int is_drained);

/* Worse than before, unless it is worse already: status, and why. Nothing while not armed. */
void can_monitor_set_status(struct can_monitor *monitor, uint32_t status, uint32_t reasons,
                            uint32_t code);

/* In closed loop and without an error, as far as heartbeats tell. */
int can_node_is_active(const struct can_node *node);

/* "node 3: IDLE, UNKNOWN_POSITION, motor: DRV_FAULT". */
void can_node_describe(const struct can_node *node, char *text, size_t size);

#endif
