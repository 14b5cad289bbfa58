/* SPDX-License-Identifier: BSD-3-Clause */
/* What was recorded of pushes along the axes of one space, positions or angles: samples and commands, in blocks. */
#ifndef DPT_DRIVERS_IDENTIFY_RECORD_H
#define DPT_DRIVERS_IDENTIFY_RECORD_H

#include <stdint.h>

/* A sample: time since its block began, s, and where the device was, m or rad from where the measurement began. */
struct identify_sample {
    double time, y[3];
};

/* A command that the device took: when, s since the block began, and its force along the axis, N or Nm. */
struct identify_command {
    double time, force;
};

/* One block: pushes along one axis without a pause. */
struct identify_block {
    const struct identify_sample *samples;
    const struct identify_command *commands;
    uint32_t sample_count, command_count;
    uint32_t axis, number;
};

enum { IDENTIFY_BLOCKS_MAX = 32 };

/* All blocks of a space: `numbers` of them along each axis. */
struct identify_record {
    struct identify_block blocks[3 * IDENTIFY_BLOCKS_MAX];
    uint32_t count, numbers;
};

#endif
