/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A CAN interface of the kernel (SocketCAN), never blocking: a controller's, a serial adapter's behind slcan, or vcan.
 * Where there is no SocketCAN, opening is DPT_E_UNSUPPORTED.
 *
 * What is sent comes back, marked CAN_MESSAGE_OWN, when it was on the bus: acknowledged by another node, where the
 * interface's driver echoes by itself; with slcan and vcan when the kernel has handed it on.
 */
#ifndef DPT_DRIVERS_SOCKETCAN_H
#define DPT_DRIVERS_SOCKETCAN_H

#include "can/can_message.h"
#include "dynpoint/device.h"

#define SOCKETCAN_BATCH 64

struct socketcan {
    int fd;
    int index;                /* of the interface */
    uint32_t bitrate;         /* bit/s; 0: it has none, as vcan, or it is not known */
    uint8_t is_drained;       /* the last receive took all that had come */
    uint8_t is_down;          /* the interface was shut: stays so, open again */
    uint8_t is_gone;          /* it was unplugged, likewise */
    uint8_t is_bus_off;       /* bus-off: too many errors, the controller has left the bus */
    uint8_t is_error_passive; /* error-passive: on the way there */
    uint32_t dropped;  /* frames that the kernel had no room for, since the line was opened */
    uint32_t overruns; /* times that the controller had none */
};

/*
 * Open `name`, as "can0", for frames of the nodes whose bits are set (their ids are node << 5 and the 31 behind it)
 * and for errors. On failure fd is -1 and `error` says what to do.
 */
dpt_result socketcan_open(struct socketcan *socketcan, const char *name, uint64_t nodes,
                          dpt_device_error *error);

/*
 * Ask the kernel how the interface is, by rtnetlink; some milliseconds. Error frames that were dropped are made up for,
 * and a bus that was bad before the line was opened is found; where there is no answer all stays as it was.
 */
void socketcan_query(struct socketcan *socketcan);

/*
 * What has come, at most SOCKETCAN_BATCH: how many, 0 for none. One system call and two looks at the clock. Errors of
 * the bus change the fields above and are no messages.
 */
int socketcan_receive(struct socketcan *socketcan, struct can_message *messages);

/* How many of them went, in one system call; the others had no room, or the line is down. At most SOCKETCAN_BATCH. */
int socketcan_send(struct socketcan *socketcan, const struct can_message *messages, int count);

/* Until something can be received, or a time of clock_now; at most 20 ms. */
void socketcan_wait(const struct socketcan *socketcan, uint64_t deadline);

void socketcan_close(struct socketcan *socketcan);

/* The CAN interfaces that there are, each with a line about it. */
void socketcan_find(void (*found)(void *user, const char *name, const char *about), void *user);

#endif
