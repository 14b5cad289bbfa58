/* SPDX-License-Identifier: BSD-3-Clause */
/* libHD, loaded at run time. */
#ifndef DPT_DRIVERS_OPENHAPTICS_LIBRARY_H
#define DPT_DRIVERS_OPENHAPTICS_LIBRARY_H

#include "dynpoint/device.h"
#include "openhaptics/hd_api.h"

/* Its functions. Those that are optional may be NULL. */
struct hd_library {
#define HD_FUNCTION(result, name, arguments) result(HD_CALL *name) arguments;
    HD_FUNCTIONS(HD_FUNCTION, HD_FUNCTION)
#undef HD_FUNCTION
};

/* The last error, the stack of them being empty then; those before it are dropped. */
hd_error hd_take_error(const struct hd_library *library);

/*
 * The library of that name; of "" the one that DPT_HD_LIBRARY names in the environment, else the first of libHD.so,
 * libHD.so.3.4 and libHD.so.3.0 that loads. A process loads one and keeps it, as it fails when it is loaded a second
 * time. Calls are not to overlap. DPT_E_UNSUPPORTED, and what to install in `error`.
 */
dpt_result hd_library_load(const char *name, const struct hd_library **library,
                           dpt_device_error *error);

#endif
