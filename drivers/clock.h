/* SPDX-License-Identifier: BSD-3-Clause */
/* The system's clocks, in ns. */
#ifndef DPT_DRIVERS_CLOCK_H
#define DPT_DRIVERS_CLOCK_H

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

#endif
