/* SPDX-License-Identifier: BSD-3-Clause */
/* A serial line, raw and never blocking: a port of any kind that has a termios, a pty as well. */
#ifndef DPT_DRIVERS_SERIAL_LINE_H
#define DPT_DRIVERS_SERIAL_LINE_H

#include "dynpoint/device.h"

/*
 * Open for this program alone, at `speed` baud, 8 bits, no parity, one stop bit, no flow control; what waits in it is
 * thrown away. The settings are read back: a UART may answer a speed that it does not have with another one and no
 * error. *fd is set; on failure it is -1 and `error` says what to do.
 */
dpt_result serial_line_open(const char *path, uint32_t speed, int *fd, dpt_device_error *error);

/* Bytes moved, 0 when none could be, -1 when the line is gone. One system call, or two where nothing was there. */
long serial_line_read(int fd, void *bytes, size_t size);
long serial_line_write(int fd, const void *bytes, size_t size);

/* Until something can be read, or a time of clock_now; at most 20 ms. */
void serial_line_wait(int fd, uint64_t deadline);

/* Drops what was not sent yet, so that it does not wait for a line that is stuck. */
void serial_line_close(int fd);

/* The ports that there are; each with a line about it. */
void serial_line_find(void (*found)(void *user, const char *path, const char *about), void *user);

#endif
