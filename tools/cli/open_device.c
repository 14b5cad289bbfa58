/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/open_device.h"

#include <stdio.h>
#include <string.h>

#include "cli/command_options.h"

int open_device(const char *command, const char *name, dpt_device **device)
{
    dpt_device_error error = { .size = sizeof error };
    dpt_result result = dpt_device_open(name, device, &error);
    if (result != DPT_OK)
        return complain(command, "%s: %s", name, error.text[0] ? error.text : dpt_result_text(result));
    if (error.text[0])
        complain(command, "%s: %s", name, error.text);
    return 0;
}

int end_fault(const char *command, const char *name, dpt_device *device)
{
    dpt_device_info info = { .size = sizeof info };
    dpt_device_state state = { .size = sizeof state };
    dpt_device_get_info(device, &info);
    if (info.flags & DPT_DEVICE_FLAG_DETERMINISTIC || dpt_device_read(device, &state) != DPT_OK ||
        state.status != DPT_DEVICE_STATUS_FAULT)
        return 0;
    const char *reason = dpt_device_reason_name(state.reasons);
    reason = reason ? reason : "no reason";
    if (dpt_device_clear(device) != DPT_OK)
        return complain(command, "%s: it has stopped itself (%s): end the cause first", name, reason);
    complain(command, "%s: it had stopped itself (%s): that is over", name, reason);
    return 0;
}

int device_output_check(const char *command, const char *path, const char *name)
{
    char piece[1024];
    int status = 0;
    for (const char *at = strchr(name, ':'); at && *at && !status;) {
        const size_t length = strcspn(++at, "?&=");
        snprintf(piece, sizeof piece, "%.*s", (int)length, at);
        status = output_check(command, path, (const char *const[]){ piece, NULL });
        at += length;
    }
    return status;
}
