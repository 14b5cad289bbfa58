/* SPDX-License-Identifier: BSD-3-Clause */
/* A frame of a CAN bus, without the headers of a system. */
#ifndef DPT_DRIVERS_CAN_MESSAGE_H
#define DPT_DRIVERS_CAN_MESSAGE_H

#include <stdint.h>

enum {
    CAN_MESSAGE_REMOTE = 1,   /* a remote frame: requests the frame of this id, has no data */
    CAN_MESSAGE_OWN = 2,      /* a frame that this socket sent; it comes back once it was on the bus */
    CAN_MESSAGE_EXTENDED = 4, /* the id has 29 bits, not 11 */
    CAN_MESSAGE_FD = 8        /* a frame of CAN-FD, whose data is sent at the interface's data rate */
};

enum { CAN_MESSAGE_BYTES = 64 };

struct can_message {
    uint64_t time_ns; /* when it came, on the host's monotonic clock */
    uint32_t id;
    uint8_t size;  /* bytes of data: 0..8; of CAN-FD also 12, 16, 20, 24, 32, 48, 64 */
    uint8_t flags; /* CAN_MESSAGE_... */
    uint8_t data[CAN_MESSAGE_BYTES];
};

/* Frames that a socket wants: those whose id is `id` in the bits of `mask`. */
struct can_wanted {
    uint32_t id, mask;
    uint8_t is_extended;
};

#endif
