/* SPDX-License-Identifier: BSD-3-Clause */
/* A frame of a CAN bus, without the headers of a system. */
#ifndef DPT_DRIVERS_CAN_MESSAGE_H
#define DPT_DRIVERS_CAN_MESSAGE_H

#include <stdint.h>

enum {
    CAN_MESSAGE_REMOTE = 1, /* a remote frame: requests the frame of this id, has no data */
    CAN_MESSAGE_OWN = 2     /* a frame that this socket sent; it comes back once it was on the bus */
};

struct can_message {
    uint64_t time_ns; /* when it came, on the host's monotonic clock */
    uint16_t id;      /* 11 bits */
    uint8_t size;     /* bytes of data, 0..8 */
    uint8_t flags;    /* CAN_MESSAGE_... */
    uint8_t data[8];
};

#endif
