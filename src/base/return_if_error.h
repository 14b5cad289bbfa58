/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef DPT_RETURN_IF_ERROR_H
#define DPT_RETURN_IF_ERROR_H

#include "dynpoint/result.h"

/* Return the code of a call that failed. */
#define DPT_TRY(call)                                                                                                  \
    do {                                                                                                               \
        dpt_result try_result = (call);                                                                                \
        if (try_result != DPT_OK)                                                                                      \
            return try_result;                                                                                         \
    } while (0)

#endif
