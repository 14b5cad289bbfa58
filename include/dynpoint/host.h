/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef DYNPOINT_HOST_H
#define DYNPOINT_HOST_H

#include "dynpoint/device.h"

DPT_BEGIN

/*
 * What a call has to say to a person, in one line.
 *   code   what the call returned
 *   text   after a failure, the file, its place and the reason. After a success, what a person should know, as that the
 *          coupling is softer than was asked for, and why; or "" for nothing
 */
typedef struct dpt_host_error {
    uint32_t size; /* sizeof(dpt_host_error), set by the caller */
    int32_t code;
    char text[1000];
} dpt_host_error;

DPT_END

#endif
