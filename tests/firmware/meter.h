/* SPDX-License-Identifier: BSD-3-Clause */
/* What the motors of tests/firmware/device.c get, once a sample, as the firmware and who reads it have it in memory. */
#ifndef DPT_TESTS_METER_H
#define DPT_TESTS_METER_H

#include <stdint.h>

struct meter_reading {
    uint32_t ms;       /* of the firmware's clock */
    uint32_t commands; /* taken so far in this session */
    uint32_t status;   /* WIRE_STATUS_... */
    float force[3];    /* N */
};

#endif
