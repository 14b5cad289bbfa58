/* SPDX-License-Identifier: BSD-3-Clause */
#if defined(__x86_64__) && !defined(DPT_SCALAR)
#include <immintrin.h>

#define KERNEL(name) dpti_kernel_avx512_##name
#define KERNEL_OPEN(bound, limit)                                                                                      \
    (uint32_t) _mm512_cmp_ps_mask(_mm512_loadu_ps(bound), _mm512_set1_ps(limit), _CMP_NGT_UQ)
#if defined(__clang__)
#define KERNEL_TARGET __attribute__((target("avx512f,avx512vl,avx512dq")))
#else /* without prefer-vector-width gcc uses half the width */
#define KERNEL_TARGET __attribute__((target("avx512f,avx512vl,avx512dq,prefer-vector-width=512")))
#endif

/* Four nodes, each in a quarter of a register. A quarter is then the same four lanes of x, y or z. */
#define QUARTER(points, at, lane) _mm_loadu_ps((points) + 4 * (size_t)(at)[lane])
#define QUARTERS(points, at, i)                                                                                        \
    _mm512_insertf32x4(_mm512_insertf32x4(_mm512_insertf32x4(_mm512_castps128_ps512(QUARTER(points, at, i)),           \
                                                             QUARTER(points, at, (i) + 4), 1),                         \
                                          QUARTER(points, at, (i) + 8), 2),                                            \
                       QUARTER(points, at, (i) + 12), 3)
#define KERNEL_TAKE(points, at, x, y, z)                                                                               \
    {                                                                                                                  \
        const __m512 take0 = QUARTERS(points, at, 0), take1 = QUARTERS(points, at, 1);                                 \
        const __m512 take2 = QUARTERS(points, at, 2), take3 = QUARTERS(points, at, 3);                                 \
        const __m512 low01 = _mm512_unpacklo_ps(take0, take1);                                                         \
        const __m512 low23 = _mm512_unpacklo_ps(take2, take3);                                                         \
        const __m512 high01 = _mm512_unpackhi_ps(take0, take1);                                                        \
        const __m512 high23 = _mm512_unpackhi_ps(take2, take3);                                                        \
        _mm512_storeu_ps(x, _mm512_shuffle_ps(low01, low23, 0x44));                                                    \
        _mm512_storeu_ps(y, _mm512_shuffle_ps(low01, low23, 0xee));                                                    \
        _mm512_storeu_ps(z, _mm512_shuffle_ps(high01, high23, 0x44));                                                  \
    }
#define PUT_QUARTERS(points, i, from)                                                                                  \
    {                                                                                                                  \
        _mm_storeu_ps((points) + 4 * (i), _mm512_castps512_ps128(from));                                               \
        _mm_storeu_ps((points) + 4 * ((i) + 4), _mm512_extractf32x4_ps(from, 1));                                      \
        _mm_storeu_ps((points) + 4 * ((i) + 8), _mm512_extractf32x4_ps(from, 2));                                      \
        _mm_storeu_ps((points) + 4 * ((i) + 12), _mm512_extractf32x4_ps(from, 3));                                     \
    }
#define KERNEL_PUT(points, x, y, z)                                                                                    \
    {                                                                                                                  \
        const __m512 put_x = _mm512_loadu_ps(x), put_y = _mm512_loadu_ps(y);                                           \
        const __m512 put_z = _mm512_loadu_ps(z), zero = _mm512_setzero_ps();                                           \
        const __m512 low_xy = _mm512_unpacklo_ps(put_x, put_y);                                                        \
        const __m512 low_z = _mm512_unpacklo_ps(put_z, zero);                                                          \
        const __m512 high_xy = _mm512_unpackhi_ps(put_x, put_y);                                                       \
        const __m512 high_z = _mm512_unpackhi_ps(put_z, zero);                                                         \
        PUT_QUARTERS(points, 0, _mm512_shuffle_ps(low_xy, low_z, 0x44))                                                \
        PUT_QUARTERS(points, 1, _mm512_shuffle_ps(low_xy, low_z, 0xee))                                                \
        PUT_QUARTERS(points, 2, _mm512_shuffle_ps(high_xy, high_z, 0x44))                                              \
        PUT_QUARTERS(points, 3, _mm512_shuffle_ps(high_xy, high_z, 0xee))                                              \
    }
/* x, y, z and 0 of a point in the four lanes of one register. */
#define WEIGHED(points, node, weights, k)                                                                              \
    _mm256_mul_pd(_mm256_permute4x64_pd(weights, (k)*0x55),                                                            \
                  _mm256_cvtps_pd(_mm_loadu_ps((points) + 4 * (size_t)(node)[k])))
#define KERNEL_WEIGH(points, nodes, weights, to)                                                                       \
    {                                                                                                                  \
        const __m256d four = _mm256_cvtps_pd(_mm_loadu_ps(weights));                                                   \
        __m256d sum = _mm256_add_pd(_mm256_setzero_pd(), WEIGHED(points, nodes, four, 0));                             \
        sum = _mm256_add_pd(sum, WEIGHED(points, nodes, four, 1));                                                     \
        sum = _mm256_add_pd(sum, WEIGHED(points, nodes, four, 2));                                                     \
        sum = _mm256_add_pd(sum, WEIGHED(points, nodes, four, 3));                                                     \
        _mm_storeu_ps(to, _mm256_cvtpd_ps(sum));                                                                       \
    }
/* Two corners of opposite cells at a node, as lanes x, y, z and 0. */
#define CORNERS(pulls, at, i, k)                                                                                       \
    _mm_sub_ps(_mm_loadu_ps((pulls) + (size_t)(at)[LANES * (k) + (i)]),                                                \
               _mm_loadu_ps((pulls) + (size_t)(at)[LANES * (7 - (k)) + (i)]))
#define KERNEL_CORNERS(pulls, at, i, to)                                                                               \
    _mm_storeu_ps(to, _mm_add_ps(_mm_add_ps(CORNERS(pulls, at, i, 0), CORNERS(pulls, at, i, 1)),                       \
                                 _mm_add_ps(CORNERS(pulls, at, i, 2), CORNERS(pulls, at, i, 3))));
#include "kernel/kernel_body.h"
#else
typedef int kernel_avx512_is_for_another_machine;
#endif
