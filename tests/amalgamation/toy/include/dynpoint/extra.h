/* SPDX-License-Identifier: BSD-3-Clause */
/* Not in dynpoint.h, and still of the library: it defines what stands here. */
#ifndef DYNPOINT_EXTRA_H
#define DYNPOINT_EXTRA_H

#include "dynpoint/base.h"

DPT_API int dpt_extra(int x);

#endif
