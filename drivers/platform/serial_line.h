/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A raw serial line that never blocks: of Linux and macOS any port with a termios, also a pseudo-terminal; of Windows a
 * COM port. A line is a number: a descriptor, or on Windows one of this file's own.
 */
#ifndef DPT_PLATFORM_SERIAL_LINE_H
#define DPT_PLATFORM_SERIAL_LINE_H

#include <stddef.h>

#include "dynpoint/device.h"

/*
 * Open the port for this program alone: `speed` baud, 8 bits, no parity, one stop bit, no flow control. Waiting bytes
 * are dropped. The settings are read back, because a UART may answer a speed that it does not have with another speed
 * and no error. After a failure *fd is -1 and `error` says what to do.
 */
dpt_result serial_line_open(const char *path, uint32_t speed, int *fd, dpt_device_error *error);

/*
 * Read or write without blocking. Returns the number of bytes, 0 if none could be moved, -1 if the line is gone. Makes
 * one system call, or two if there was nothing to read.
 */
long serial_line_read(int fd, void *bytes, size_t size);
long serial_line_write(int fd, const void *bytes, size_t size);

/* Wait until something can be read, until `deadline` (a time of clock_now), or for 20 ms. */
void serial_line_wait(int fd, uint64_t deadline);

/* Close the port. Drops what was not sent yet, so that it does not wait for a stuck line. */
void serial_line_close(int fd);

/* Call `found` for each port, with a line about it. */
void serial_line_find(void (*found)(void *user, const char *path, const char *about), void *user);

/*
 * The other end of a line that a host can open by the name that goes to `path`: a descriptor for read, write and close,
 * which do not wait. -1, and errno, if the system has none.
 */
int serial_line_simulate(char *path, size_t room);

#endif
