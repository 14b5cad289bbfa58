/* SPDX-License-Identifier: BSD-3-Clause */
/* QEMU with firmware in it, and the pty of its UART. */
#ifndef DPT_TESTS_EMULATOR_H
#define DPT_TESTS_EMULATOR_H

#include <sys/types.h>

struct emulator {
    pid_t process; /* 0: it does not run */
    char line[64]; /* the pty's name */
};

/* Start it by its command; 0 if it says no "redirected to /dev/pts/N". */
int emulator_start(struct emulator *emulator, char *const *command);

/* As if its power were cut. */
void emulator_kill(struct emulator *emulator);

#endif
