/* SPDX-License-Identifier: BSD-3-Clause */
#if defined(__x86_64__) && !defined(DPT_SCALAR)
#include <immintrin.h>

#define KERNEL(name) dpti_kernel_avx512_##name
#define KERNEL_OPEN(bound, limit)                                                                  \
    (uint32_t) _mm512_cmp_ps_mask(_mm512_loadu_ps(bound), _mm512_set1_ps(limit), _CMP_NGT_UQ)
#if defined(__clang__)
#define KERNEL_TARGET __attribute__((target("avx512f,avx512vl,avx512dq")))
#else /* without prefer-vector-width gcc uses half the width */
#define KERNEL_TARGET __attribute__((target("avx512f,avx512vl,avx512dq,prefer-vector-width=512")))
#endif
#include "kernel/kernel_body.h"
#else
typedef int kernel_avx512_is_for_another_machine;
#endif
