/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * CAN interfaces from within a test: made, taken away, up, down, and what the kernel says of them, by rtnetlink. Needs root,
 * but for net_query. Every function gives 0, or what errno would say: EEXIST, ENODEV, EPERM, EOPNOTSUPP ...
 *
 *     net_add("vcan1");  net_up("vcan1");  ...  net_down("vcan1");  net_remove("vcan1");
 */
#ifndef DPT_TESTS_VM_NET_H
#define DPT_TESTS_VM_NET_H

#include <stdint.h>

struct net_state {
    int up;           /* IFF_UP: as it was set */
    int carrier;      /* there is a bus; not after bus-off */
    int running;      /* the same, within a second: from then on what is written is dropped */
    int echo;         /* MSG_CONFIRM is the driver's, for a frame that was sent; else it was queued */
    int error_state;  /* enum can_state of linux/can/netlink.h; -1: it is no real bus (vcan) */
    uint32_t bitrate; /* bit/s; 0: not set */
    uint32_t queue;   /* frames that it holds before a write gives ENOBUFS; vcan holds none */
    uint32_t mtu;     /* CAN_MTU or CANFD_MTU */
};

/* A virtual CAN interface, down. */
int net_add(const char *name);

/* What unplugging does: gone for good, with a new index when it comes again under the same name. */
int net_remove(const char *name);

int net_up(const char *name);
int net_down(const char *name);

/* Only while it is down. */
int net_set_bitrate(const char *name, uint32_t bitrate);

/* After bus-off, what `ip link set NAME type can restart` does; EOPNOTSUPP from a driver that cannot. */
int net_restart(const char *name);

int net_set_queue(const char *name, uint32_t frames);

int net_query(const char *name, struct net_state *state);

#endif
