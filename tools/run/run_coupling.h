/* SPDX-License-Identifier: BSD-3-Clause */
/* The coupling of a run: as stiff as its device can hold. */
#ifndef DPT_TOOLS_RUN_COUPLING_H
#define DPT_TOOLS_RUN_COUPLING_H

#include "dynpoint/coupling.h"
#include "scene/scene.h"

/* From a sample to its command, by the clock: the deadline's phase behind the sample, and the tick's own time. */
#define RUN_LOOP_DELAY_PERIODS 0.25

struct coupling_options {
    double stiffness; /* asked for, N/m; NAN: as stiff as the device can hold */
    double gain_margin;
    double rate;       /* of the loop, Hz */
    double loop_delay; /* s */
    int is_unstable;   /* the stiffness counts, whatever the device can hold */
};

/* The coupling that these options ask for, or the stiffest that holds. Returns 0, or 2 after a message. */
int run_coupling_find(const struct scene *scene, const dpt_device_info *device, const struct coupling_options *options,
                      dpt_coupling *coupling);

/*
 * Choose the coupling for a scene that was opened, into its force options. Says why where it is less stiff than was asked
 * for. Returns 0, or 2 after a message.
 */
int run_coupling_choose(struct scene *scene, const dpt_device_info *device, const struct coupling_options *options,
                        dpt_coupling *coupling);

/* The word for what limits a coupling, as "stability". */
const char *coupling_limit_word(uint32_t limit);

#endif
