/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A test as a serial CAN adapter: the kernel's slcan has one end of a pty and makes an interface of it, a thread here has the
 * other and speaks LAWICEL's protocol. So an interface has a real bus's states, errors and full queue, and can be unplugged.
 * Needs root, and a kernel with slcan's states (6.0 or later).
 *
 *     struct slcan adapter;
 *     slcan_plug(&adapter, -1);                    up, 1 Mbit/s; its name is adapter.name
 *     read(adapter.bus, &frame, sizeof frame);     what the kernel has put on the bus
 *     write(adapter.bus, &frame, sizeof frame);    what someone else has
 *     slcan_say(&adapter, "sb256000");             it is bus-off
 *     slcan_unplug(&adapter);
 */
#ifndef DPT_TESTS_VM_SLCAN_H
#define DPT_TESTS_VM_SLCAN_H

#include <pthread.h>
#include <stdint.h>

#define SLCAN_COMMANDS 64
#define SLCAN_LINE     32 /* the longest is T, 8 digits, a length, 16 digits, \r */

struct slcan {
    char name[16];
    int bus;          /* of struct can_frame, both ways, does not block; -1 if the bus is another interface */
    unsigned lost;    /* frames that the bus had no room for; good after slcan_unplug */
    int master, line; /* the pty's ends: the thread's, the kernel's */
    int far, control[2];
    char commands[SLCAN_COMMANDS];
    pthread_t thread;
    pthread_mutex_t saying;
};

/*
 * Plugs it in and sets the interface up. `bus` is -1 for one that is adapter->bus, or a bound CAN_RAW socket, closed by
 * slcan_unplug: then frames go to and fro between it and the adapter, whose bus is that interface. 0, or an errno: ENXIO or
 * EINVAL without slcan, EPERM without rights.
 */
int slcan_plug(struct slcan *adapter, int bus);

/* Hangs up, as a pulled plug does. The interface is gone when it returns. */
void slcan_unplug(struct slcan *adapter);

/*
 * A line to the kernel, without its end. "s", then a (active), w (warning), p (passive) or b (bus-off), then three digits each
 * of errors received and sent: the adapter's state. "e", a digit and as many letters: errors. a no acknowledgement, b and B a
 * bit (dominant, recessive), c checksum, f form, s stuffing, o and O the adapter lost frames (received, to be sent).
 */
void slcan_say(struct slcan *adapter, const char *line);

/* What the kernel has said besides frames since the last call, as "C S8 O ". */
void slcan_commands(struct slcan *adapter, char commands[SLCAN_COMMANDS]);

/* With 1 the thread reads no more of what the kernel says, as an adapter that hangs; with 0 it does again. */
void slcan_hang(struct slcan *adapter, int hang);

#endif
