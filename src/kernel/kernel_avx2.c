/* SPDX-License-Identifier: BSD-3-Clause */
#if defined(__x86_64__) && !defined(DPT_SCALAR)
#include <immintrin.h>

#define KERNEL(name)  dpti_kernel_avx2_##name
#define KERNEL_TARGET __attribute__((target("avx2")))
#define EIGHT(bound, limit)                                                                        \
    (uint32_t) _mm256_movemask_ps(                                                                 \
        _mm256_cmp_ps(_mm256_loadu_ps(bound), _mm256_set1_ps(limit), _CMP_NGT_UQ))
#define KERNEL_OPEN(bound, limit) (EIGHT(bound, limit) | EIGHT((bound) + 8, limit) << 8)
#include "kernel/kernel_body.h"
#else
typedef int kernel_avx2_is_for_another_machine;
#endif
