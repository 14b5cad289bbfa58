/* SPDX-License-Identifier: BSD-3-Clause */
/* What times were measured on: they hold for no other machine. */
#ifndef DPT_TOOLS_MEASURE_MACHINE_H
#define DPT_TOOLS_MEASURE_MACHINE_H

#include <stdint.h>

/* ASCII without quotes, backslashes, asterisks and slashes: it stands in JSON, in CSV and in a comment as it is. */
struct measure_machine {
    char processor[80]; /* its name, or its architecture */
    char system[64];    /* of the operating system: name and release */
    char compiler[80];
    char version[24]; /* of dynpoint */
    char kernel[16];  /* of the library's search: avx512, ... */
};

/* This one; `kernel` is DPT_KERNEL_... as a world tells it. */
void measure_machine_read(struct measure_machine *machine, uint32_t kernel);

#endif
