/* SPDX-License-Identifier: BSD-3-Clause */
#if defined(__x86_64__) && !defined(DPT_SCALAR)
#define KERNEL(name) kernel_sse2_##name
#define KERNEL_TARGET
#include "kernel_body.h"
#else
typedef int kernel_sse2_is_for_another_machine;
#endif
