/* SPDX-License-Identifier: BSD-3-Clause */
#if defined(__aarch64__) && !defined(DPT_SCALAR)
#define KERNEL(name) dpti_kernel_neon_##name
#define KERNEL_TARGET
#include "kernel/kernel_body.h"
#else
typedef int kernel_neon_is_for_another_machine;
#endif
