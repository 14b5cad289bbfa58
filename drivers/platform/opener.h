/* SPDX-License-Identifier: BSD-3-Clause */
/* The program of the desktop that opens a file as the user set it up; and what is said if it cannot be started. */
#ifndef DPT_PLATFORM_OPENER_H
#define DPT_PLATFORM_OPENER_H

extern const char opener_name[], opener_is_missing[];

#endif
