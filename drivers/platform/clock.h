/* SPDX-License-Identifier: BSD-3-Clause */
/* The system's clocks, in ns, and waits. */
#ifndef DPT_PLATFORM_CLOCK_H
#define DPT_PLATFORM_CLOCK_H

#include <stdint.h>

#include "dynpoint/result.h"

/* Read the monotonic clock, which the loop and the back ends use. DPT_E_SYSTEM: there is none; *now is unchanged. */
dpt_result clock_read(uint64_t *now);

/* The time of the monotonic clock; 0 if there is none. */
uint64_t clock_now(void);

/*
 * Read the monotonic clock, which stands still while the machine is suspended, and for how long the machine has been
 * suspended since it booted. *suspended is the difference to the boot-time clock, which is read first: time between the
 * two readings makes it smaller, never larger. 0 on systems without a boot-time clock. DPT_E_SYSTEM as clock_read.
 */
dpt_result clock_read_suspended(uint64_t *now, int64_t *suspended);

/* The processor time of the calling thread: it stands still while other programs run. 0 if it is not told. */
uint64_t clock_thread(void);

/* The time of day, which may be set at any time; 0 if there is none. */
uint64_t clock_wall(void);

/* Wait for so many ns. A signal may end it early. */
void clock_sleep(uint64_t ns);

/* Waits of one thread until times of the monotonic clock. */
struct clock_timer {
    void *handle; /* NULL where the system needs none */
};

/* Returns 0 if the system gives none; then clock_timer_wait waits less exactly. Close it all the same. */
int clock_timer_open(struct clock_timer *timer);

/* Wait until `deadline`. Returns 0; 1 if a signal ended it early; -1 if the system cannot wait. */
int clock_timer_wait(const struct clock_timer *timer, uint64_t deadline);

void clock_timer_close(struct clock_timer *timer);

#endif
