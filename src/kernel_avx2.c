/* SPDX-License-Identifier: BSD-3-Clause */
#if defined(__x86_64__) && !defined(DPT_SCALAR)
#define KERNEL(name)  kernel_avx2_##name
#define KERNEL_TARGET __attribute__((target("avx2")))
#include "kernel_body.h"
#else
typedef int kernel_avx2_is_for_another_machine;
#endif
