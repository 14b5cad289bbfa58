/* SPDX-License-Identifier: BSD-3-Clause */
#if defined(__x86_64__) && !defined(DPT_SCALAR)
#include <immintrin.h>

#define KERNEL(name)  dpti_kernel_avx2_##name
#define KERNEL_TARGET __attribute__((target("avx2")))
#define EIGHT(bound, limit)                                                                        \
    (uint32_t) _mm256_movemask_ps(                                                                 \
        _mm256_cmp_ps(_mm256_loadu_ps(bound), _mm256_set1_ps(limit), _CMP_NGT_UQ))
#define KERNEL_OPEN(bound, limit) (EIGHT(bound, limit) | EIGHT((bound) + 8, limit) << 8)

/* Two nodes, each in a half of a register. A half is then the same four lanes of x, y or z. */
#define HALF(points, at, lane) _mm_loadu_ps((points) + 4 * (size_t)(at)[lane])
#define HALVES(points, at, i)                                                                      \
    _mm256_insertf128_ps(_mm256_castps128_ps256(HALF(points, at, i)), HALF(points, at, (i) + 4), 1)
#define TAKE_EIGHT(points, at, x, y, z, from)                                                      \
    {                                                                                              \
        const __m256 take0 = HALVES(points, at, from), take1 = HALVES(points, at, (from) + 1);     \
        const __m256 take2 = HALVES(points, at, (from) + 2);                                       \
        const __m256 take3 = HALVES(points, at, (from) + 3);                                       \
        const __m256 low01 = _mm256_unpacklo_ps(take0, take1);                                     \
        const __m256 low23 = _mm256_unpacklo_ps(take2, take3);                                     \
        const __m256 high01 = _mm256_unpackhi_ps(take0, take1);                                    \
        const __m256 high23 = _mm256_unpackhi_ps(take2, take3);                                    \
        _mm256_storeu_ps((x) + (from), _mm256_shuffle_ps(low01, low23, 0x44));                     \
        _mm256_storeu_ps((y) + (from), _mm256_shuffle_ps(low01, low23, 0xee));                     \
        _mm256_storeu_ps((z) + (from), _mm256_shuffle_ps(high01, high23, 0x44));                   \
    }
#define KERNEL_TAKE(points, at, x, y, z)                                                           \
    TAKE_EIGHT(points, at, x, y, z, 0)                                                             \
    TAKE_EIGHT(points, at, x, y, z, 8)
#include "kernel/kernel_body.h"
#else
typedef int kernel_avx2_is_for_another_machine;
#endif
