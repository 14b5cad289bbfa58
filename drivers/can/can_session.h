/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A host on the bus: an arm's nodes, the line to them, what is said and heard, and how they get acquainted. What may
 * wait is said to.
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
    uint64_t requested_ns; /* when estimates were asked for */
    uint32_t dropped;
    uint8_t was_connected; /* connected before: motors may still give what they were told last */
    int out_count;         /* of `out`: said, not sent yet */
    struct can_message out[SOCKETCAN_BATCH];
    struct can_message in[SOCKETCAN_BATCH];
};

extern const struct odrive_message can_no_torque, can_estop, can_idle, can_request_estimates;

/* One message to the node of this index, or to all; the node's number is filled in. */
void can_session_put(struct can_session *session, uint32_t index, struct odrive_message message);
void can_session_put_all(struct can_session *session, struct odrive_message message);

/* What was said, in one system call. 1: all of it went. Torques that went are remembered until they come back. */
int can_session_send(struct can_session *session);

/* Take what has come, in four system calls at most. 1: that was all. */
int can_session_receive(struct can_session *session);

/* Blame the nodes' status on what the line says of itself. */
void can_session_check_line(struct can_session *session);

/* The line takes nothing any more: gone, shut, or off the bus. */
int can_session_is_dead(const struct can_session *session);

/* Take what comes until a time of clock_now. */
void can_session_wait(struct can_session *session, uint64_t deadline);

/*
 * Open the line, hear all nodes, tell their firmware, see that they say where they are often enough and only once,
 * switch them on, and wait for a sample: some seconds at most.
 */
dpt_result can_session_connect(struct can_session *session, dpt_device_error *error);

/* Errors cleared, torque control, closed loop, and each node's own word for it: two seconds at most. */
dpt_result can_session_switch_on(struct can_session *session, dpt_device_error *error);

/* Until all have said where they are; motors are off again when they do not. */
dpt_result can_session_first_sample(struct can_session *session, dpt_device_error *error);

#endif
