/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A host's session with the nodes of an arm on a CAN bus: queue, send and receive messages, connect, switch motors on.
 * A function may block only if its comment says so.
 */
#ifndef DPT_DRIVERS_CAN_SESSION_H
#define DPT_DRIVERS_CAN_SESSION_H

#include "can/can_monitor.h"
#include "can/socketcan.h"

struct can_session {
    struct can_settings settings;
    struct can_arm arm;
    struct socketcan socketcan;
    struct can_monitor monitor;
    uint64_t requested_ns;                   /* when estimates were requested last */
    uint32_t dropped;                        /* frames dropped by kernel or adapter, at the last check */
    uint8_t was_connected;                   /* 1: motors may still give the torque of an earlier connection */
    int out_count;                           /* messages in `out` */
    struct can_message out[SOCKETCAN_BATCH]; /* queued, not sent yet */
    struct can_message in[SOCKETCAN_BATCH];  /* of the last receive */
};

extern const struct drive_message can_no_torque, can_estop, can_idle, can_ask;

/* Queue a message to the node of this index (that of its joint); to all nodes; to those that report by themselves. */
void can_session_put(struct can_session *session, uint32_t index, struct drive_message message);
void can_session_put_all(struct can_session *session, struct drive_message message);
void can_session_put_reporters(struct can_session *session, struct drive_message message);

/* Queue a message of ODrive's, if the node is one. Its number is filled in. */
void can_session_put_odrive(struct can_session *session, uint32_t index, struct odrive_message message);

/* Send the queue, in one system call, and empty it. Returns 1 if all was sent. Notes sent torques for confirmation. */
int can_session_send(struct can_session *session);

/* Pass what has come to the monitor, in at most four receiving system calls. Returns 1 if nothing is left. */
int can_session_receive(struct can_session *session);

/* Turn the line's state (down, unplugged, bus-off, error-passive, dropped frames) into the device's status. */
void can_session_check_line(struct can_session *session);

/* 1 if nothing can be sent any more: the interface is unplugged or down, or the bus is off. */
int can_session_is_dead(const struct can_session *session);

/* Receive until `deadline`, a time of clock_now. Blocks. */
void can_session_wait(struct can_session *session, uint64_t deadline);

/*
 * Connect: open the line, wait for all nodes, find their firmware, check the rates of their messages, switch them on,
 * and wait for a sample. Blocks for some seconds at most.
 */
dpt_result can_session_connect(struct can_session *session, dpt_device_error *error);

/*
 * Switch the motors on: set their watchdogs and other parameters and read them back (can_setup.h), clear errors, set torque
 * control and closed loop, and wait until each node's heartbeat or status confirms it. Blocks for two seconds at most, and for
 * the setting `answer`. After a failure it has sent idle to all.
 */
dpt_result can_session_switch_on(struct can_session *session, dpt_device_error *error);

/* Wait for a first sample: an estimate of each node. Blocks. Switches the motors off if none comes. */
dpt_result can_session_first_sample(struct can_session *session, dpt_device_error *error);

#endif
