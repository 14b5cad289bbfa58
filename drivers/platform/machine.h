/* SPDX-License-Identifier: BSD-3-Clause */
/* What the system tells and gives: its names, random bytes. */
#ifndef DPT_PLATFORM_MACHINE_H
#define DPT_PLATFORM_MACHINE_H

#include <stddef.h>

/* "Linux 6.1.0"; "x86_64", or the processor's name where it is told; this machine's name, "" if it has none. */
void machine_system(char *text, size_t room);
void machine_processor(char *text, size_t room);
void machine_host(char *text, size_t room);

/* Random bytes from the kernel, for secrets. Returns 0, or -1. */
int machine_random(void *bytes, size_t size);

#endif
