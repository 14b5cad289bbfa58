/* SPDX-License-Identifier: BSD-3-Clause */
/* Load libHD, the OpenHaptics library, at run time. */
#ifndef DPT_DRIVERS_OPENHAPTICS_LIBRARY_H
#define DPT_DRIVERS_OPENHAPTICS_LIBRARY_H

#include "dynpoint/device.h"
#include "openhaptics/hd_api.h"

/* The library's functions. Optional ones may be NULL. */
struct hd_library {
#define HD_FUNCTION(result, name, arguments) result(HD_CALL *name) arguments;
    HD_FUNCTIONS(HD_FUNCTION, HD_FUNCTION)
#undef HD_FUNCTION
};

/* Return the newest error and empty the library's stack of errors. */
hd_error hd_take_error(const struct hd_library *library);

/*
 * Load the library `name`. If it is "": the file that DPT_HD_LIBRARY names in the environment, else the first of
 * libHD.so, libHD.so.3.4 and libHD.so.3.0 that loads. A process loads one library and keeps it, because loading it a
 * second time fails. Calls must not overlap.
 *
 * DPT_E_UNSUPPORTED: it cannot be loaded; `error` says what to install. DPT_E_SETTING: another one is loaded already.
 */
dpt_result hd_library_load(const char *name, const struct hd_library **library, dpt_device_error *error);

#endif
