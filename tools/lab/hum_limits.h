/* SPDX-License-Identifier: BSD-3-Clause */
/* How much the force of what gives way may hum (measure/hum.h), and jump from tick to tick, before a hand feels it. */
#ifndef DPT_TOOLS_HUM_LIMITS_H
#define DPT_TOOLS_HUM_LIMITS_H

/* Hum: this share of the mean force, or that many N. */
#define HUM_LIMIT_SHARE 1e-3
#define HUM_LIMIT_MIN   5e-4

/* N: 99 % of jumps while the device stands still. */
#define HUM_JUMP_STILL 1e-3

/* While it moves: so many times its motion and the coupling's stiffness, and beside it N, for 99 % and for all of them. */
#define HUM_JUMP_GAIN  1.5
#define HUM_JUMP_MOVED 2e-3
#define HUM_JUMP_MOST  2e-2

#endif
