/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a guard must do, told from guard.h alone: its states, counts and ramps, and what leaves. Where a comparison is
 * decided by a rounding, either answer will do.
 */
#ifndef DPT_TESTS_CALLS_GUARD_MODEL_H
#define DPT_TESTS_CALLS_GUARD_MODEL_H

#include "fuzz/calls/calls.h"

struct guard_model {
    int is_made;
    dpt_guard_def def;
    uint64_t hold, stop; /* ns */
    uint32_t state;
    uint64_t stops, not_finite, now, fresh;
    uint64_t clamped, clamped_most, slewed, slewed_most; /* from, to */
    double gain, stop_gain;                              /* of the ramp, and where it began to fall */
    dpt_wrench command, held, sent;
};

/* A new one, of a def that is good. */
void guard_model_init(struct guard_model *of, const dpt_guard_def *def);

/* A step, after what leaves was seen. `out` NULL: nobody saw. */
void guard_model_step(struct guard_model *of, uint64_t now, const dpt_wrench *command, int is_ready,
                      const dpt_wrench *out);

void guard_model_must_tell(const struct guard_model *of, const dpt_guard_info *info);

int wrench_is_usable(const dpt_wrench *wrench);

#endif
