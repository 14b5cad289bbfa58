/* SPDX-License-Identifier: BSD-3-Clause */
/* How the jaws of a tool move: from one share of their range to another. */
#ifndef DPT_TOOLS_JAW_MOTION_H
#define DPT_TOOLS_JAW_MOTION_H

#include <stdint.h>

/* A share is 0 at the lower limit, 1 at the upper one. */
struct jaw_motion {
    int is_given; /* 0: the jaws stand at 0, or at their limit nearest to 0 */
    double from, to;
    double seconds; /* of the loop's time, for the way */
    double button;  /* while it is down they go there, else back; -1: they go when the loop begins */
};

/* Read "SHARE", "FROM:TO:SECONDS" or "FROM:TO:SECONDS:BUTTON". 0: it is none. */
int jaw_motion_parse(struct jaw_motion *motion, const char *text, const char *end);

/* Why there is no such motion, for the end of a message; NULL: there is one. */
const char *jaw_motion_fault(const struct jaw_motion *motion);

/* So long they have been on their way after a tick of dt, s, with these of the device's buttons down. */
double jaw_motion_time(const struct jaw_motion *motion, double time, double dt, uint32_t buttons);

/* Where the jaws are after so many seconds on their way. */
double jaw_motion_share(const struct jaw_motion *motion, double time);

#endif
