/* SPDX-License-Identifier: BSD-3-Clause */
/* The smallest change of position, or of angle, that a device measures. */
#ifndef DPT_DRIVERS_IDENTIFY_STEP_H
#define DPT_DRIVERS_IDENTIFY_STEP_H

#include "identify_record.h"

/* The step that the samples show; 0 if they show none. */
double identify_step(const struct identify_sample *samples, uint32_t count);

#endif
