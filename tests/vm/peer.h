/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * tests/vm/peer.py, for the length of a test: controllers by someone else's code. $DPT_PEER is the command that runs it
 * (tests/vm/check.sh sets it where python-can is to be had). Starting it takes seconds: let one serve a whole program.
 *
 *     struct peer peer;
 *     if (peer_start(&peer, "--axis 0:0.6 --axis 1:0.6 --rate 500") == 0) {
 *         ...
 *         peer_stop(&peer);
 *         peer_number(&peer, "0.Set_Input_Torque.count");
 *     }
 */
#ifndef DPT_TESTS_VM_PEER_H
#define DPT_TESTS_VM_PEER_H

#include <sys/types.h>

struct peer {
    pid_t process;
    int said;
    char report[16384];
};

/* Returns when it is ready: 0; ENOENT without $DPT_PEER; ETIMEDOUT after a minute; EPIPE if it ends at once. */
int peer_start(struct peer *peer, const char *arguments);

/* Ends it and takes its report. 0, or EPIPE if it gave none. */
int peer_stop(struct peer *peer);

/* A number of the report; not a number if it has none of this name. */
double peer_number(const struct peer *peer, const char *name);

#endif
