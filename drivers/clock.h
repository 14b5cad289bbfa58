/* SPDX-License-Identifier: BSD-3-Clause */
/* The system's clocks, in ns. */
#ifndef DPT_DRIVERS_CLOCK_H
#define DPT_DRIVERS_CLOCK_H

#include <stdint.h>

#include "dynpoint/result.h"

/* The monotonic clock, by which loop and back ends go. DPT_E_SYSTEM: there is none, and *now stays as it was. */
dpt_result clock_read(uint64_t *now);

/* Likewise; 0 where there is none. */
uint64_t clock_now(void);

/*
 * The monotonic clock, which stands still while the machine is suspended, and how far a clock that goes on then is ahead
 * of it. Time that passes between the two readings makes `ahead` less, never more; 0 on systems without such a clock.
 */
dpt_result clock_read_suspended(uint64_t *now, int64_t *suspended);

/* The time of day, which may be set at any time; 0 where there is none. */
uint64_t clock_wall(void);

#endif
