/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A CAN interface of the kernel (SocketCAN): a CAN controller, a serial adapter behind slcan, or vcan. No call blocks
 * but socketcan_wait and, for some milliseconds, socketcan_query. On systems without SocketCAN opening is
 * DPT_E_UNSUPPORTED.
 *
 * A frame that was sent comes back marked CAN_MESSAGE_OWN. If the interface's driver echoes by itself, this means that
 * the frame was on the bus and another node acknowledged it. With slcan and vcan it means only that the kernel passed
 * it on.
 */
#ifndef DPT_DRIVERS_SOCKETCAN_H
#define DPT_DRIVERS_SOCKETCAN_H

#include "can/can_message.h"
#include "dynpoint/device.h"

#define SOCKETCAN_BATCH  64
#define SOCKETCAN_WANTED 64

struct socketcan {
    int fd;
    int index;                /* of the interface */
    uint32_t bitrate;         /* bit/s; 0: unknown, or none, as for vcan */
    uint32_t data_bitrate;    /* of the data of CAN-FD; 0: unknown, or none */
    uint8_t is_drained;       /* the last receive took all that had come */
    uint8_t is_down;          /* the interface was set down; stays set, open it again */
    uint8_t is_gone;          /* the interface was removed; stays set, open it again */
    uint8_t is_bus_off;       /* too many errors: the controller has left the bus */
    uint8_t is_error_passive; /* many errors, on the way to bus-off */
    uint32_t dropped;         /* frames that the kernel had no room for, since the open */
    uint32_t overruns;        /* times that the controller had no room */
};

/*
 * Open the interface `name`, as "can0", for error frames and for the frames that are wanted.
 *   count   of `wanted`, at most SOCKETCAN_WANTED
 *   is_fd   1: frames of CAN-FD are sent and received, too. DPT_E_DEVICE if the interface has none
 *
 * After a failure fd is -1 and `error` says what to do.
 */
dpt_result socketcan_open(struct socketcan *socketcan, const char *name, const struct can_wanted *wanted, int count,
                          int is_fd, dpt_device_error *error);

/*
 * Query the interface's state and bit rate from the kernel by rtnetlink. This finds what error frames did not tell
 * because they were dropped, or came before the socket was open. Without an answer the fields stay as they were.
 */
void socketcan_query(struct socketcan *socketcan);

/*
 * Receive messages, at most SOCKETCAN_BATCH; returns how many. Makes one system call and reads the clock twice. Error
 * frames change the fields above and are not returned.
 */
int socketcan_receive(struct socketcan *socketcan, struct can_message *messages);

/*
 * Send at most SOCKETCAN_BATCH messages in one system call. Returns how many were sent; the line had no room for the
 * others.
 */
int socketcan_send(struct socketcan *socketcan, const struct can_message *messages, int count);

/* Wait until something can be received, until `deadline` (a time of clock_now), or for 20 ms. */
void socketcan_wait(const struct socketcan *socketcan, uint64_t deadline);

void socketcan_close(struct socketcan *socketcan);

/* Call `found` for each CAN interface, with a line about it. */
void socketcan_find(void (*found)(void *user, const char *name, const char *about), void *user);

#endif
