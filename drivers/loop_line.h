/* SPDX-License-Identifier: BSD-3-Clause */
/* One device of a servo loop: its samples, its guard and its counts. */
#ifndef DPT_DRIVERS_LOOP_LINE_H
#define DPT_DRIVERS_LOOP_LINE_H

#include "dynpoint/loop.h"

/* What does not change while the loop exists. */
struct loop_line_def {
    dpt_device *device;
    dpt_device_info info;
    dpt_guard_def guard; /* within what the device can do */
};

/* The state of a run. */
struct loop_line {
    const struct loop_line_def *def;
    dpt_loop_stats stats;
    dpt_guard guard;
    dpt_device_state state;
    dpt_loop_sample sample;
    int has_sequence;
    uint64_t sequence; /* of the newest sample that was accepted */
    int has_host_sample;
    uint64_t host_sample_ns; /* time_ns of the last sample that the host saw */
    int is_lost;
    uint64_t retry_ns; /* when to try dpt_device_clear again */
    /* Of the present tick: */
    int is_fresh;  /* a sample came that is newer than all before */
    int is_ready;  /* the device takes commands, and its pose is sound */
    int is_served; /* the host saw the sample and gave a command */
};

/* Set the guard: the host's, with limits lowered to the device's. DPT_E_ARGUMENT: its hold time is too short. */
dpt_result loop_line_open(struct loop_line_def *def, dpt_device *device, const dpt_guard_def *guard,
                          uint64_t period_ns);

void loop_line_begin(struct loop_line *line, const struct loop_line_def *def);

/* Read the device. Times in ns. */
void loop_line_read(struct loop_line *line);

/* After reading: find out whether the device is lost in this tick. A device that can reopen is tried once a second. */
int loop_line_check_loss(struct loop_line *line, uint64_t now, int reopens);

/* 1 if there is a sample for the host; its dt is set then, and is 0 else. */
int loop_line_has_sample(struct loop_line *line, double period);

/* Note that the host has answered, or was not asked. */
void loop_line_count(struct loop_line *line, int is_answered);

/*
 * Let the guard decide, and send.
 *   command   of the host; not used if it is not served
 *   time_ns   of what is sent, as the host is told it
 */
void loop_line_send(struct loop_line *line, const dpt_wrench *command, uint64_t now, uint64_t time_ns);

/* Stop the guard at once: the machine was suspended. */
void loop_line_stop(struct loop_line *line, uint64_t now);

/* Add the guard's counts to the stats. */
void loop_line_end(struct loop_line *line);

#endif
