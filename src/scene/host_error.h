/* SPDX-License-Identifier: BSD-3-Clause */
/* What is said where something cannot be had. An error begins with zeros behind its size. */
#ifndef DPT_HOST_ERROR_H
#define DPT_HOST_ERROR_H

#include "dynpoint/host.h"

#ifdef __GNUC__
#define HOST_FORMAT(text, first) __attribute__((format(printf, text, first)))
#else
#define HOST_FORMAT(text, first)
#endif

/* Fill in an error; returns the code. */
dpt_result host_refuse(dpt_host_error *error, dpt_result code, const char *format, ...) HOST_FORMAT(3, 4);

/* Say something that is no error; behind what was said before, after "; ". */
void host_note(dpt_host_error *error, const char *format, ...) HOST_FORMAT(2, 3);

#endif
