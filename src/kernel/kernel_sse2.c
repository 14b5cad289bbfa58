/* SPDX-License-Identifier: BSD-3-Clause */
#if defined(__x86_64__) && !defined(DPT_SCALAR)
#include <emmintrin.h>

#define KERNEL(name) dpti_kernel_sse2_##name
#define KERNEL_TARGET
#define FOUR(bound, limit)                                                                         \
    (uint32_t) _mm_movemask_ps(_mm_cmpngt_ps(_mm_loadu_ps(bound), _mm_set1_ps(limit)))
#define KERNEL_OPEN(bound, limit)                                                                  \
    (FOUR(bound, limit) | FOUR((bound) + 4, limit) << 4 | FOUR((bound) + 8, limit) << 8 |          \
     FOUR((bound) + 12, limit) << 12)
#include "kernel/kernel_body.h"
#else
typedef int kernel_sse2_is_for_another_machine;
#endif
