/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A device that bears witness: it passes another one on, and writes down what was read and what was written, so that
 * what a loop says of it can be held against it. Sometimes it has no room for a command, or fails, and its samples are
 * old, late or lame.
 */
#ifndef DPT_TESTS_CALLS_WITNESS_H
#define DPT_TESTS_CALLS_WITNESS_H

#include "dynpoint/driver.h"
#include "fuzz/calls/calls.h"

struct witness {
    dpt_device device; /* the first, as driver.h has it */
    dpt_device *inner;
    int is_clumsy;                /* it drops a command now and then, and gives samples that are none */
    int is_deaf;                  /* it never has room for zero force */
    double force_max, torque_max; /* what may be written */
    /* The last sample, as it was passed on, and whether a tick may see it. */
    dpt_device_state state;
    dpt_result read;
    int is_to_be_seen;
    uint64_t sequence; /* of the last one that was not old */
    int has_sequence;
    /* What acts since the device took it, and how many it took since the last tick. */
    dpt_wrench acts;
    uint64_t acts_ns;
    uint32_t taken;
    /* Over all. */
    uint64_t reads, lost, writes, written;
    uint64_t unseen;        /* samples that a tick should have been shown */
    dpt_wrench last;        /* that was written */
    dpt_result last_result; /* and what came of it */
    int has_ticked;         /* since the device was lost */
    uint64_t ticked_ns;
};

extern struct witness witness;
extern const dpt_driver witness_driver;

#endif
