/* SPDX-License-Identifier: BSD-3-Clause */
/* Ask a serial port to hand over each byte when it comes. Returns 0, or -1 and errno. */
#ifndef DPT_PLATFORM_SERIAL_LATENCY_H
#define DPT_PLATFORM_SERIAL_LATENCY_H

int serial_lower_latency(int line);

#endif
