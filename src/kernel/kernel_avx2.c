/* SPDX-License-Identifier: BSD-3-Clause */
#if defined(__x86_64__) && !defined(DPT_SCALAR)
#include <immintrin.h>

#define KERNEL(name)  dpti_kernel_avx2_##name
#define KERNEL_TARGET __attribute__((target("avx2")))
#define EIGHT(bound, limit)                                                                                            \
    (uint32_t) _mm256_movemask_ps(_mm256_cmp_ps(_mm256_loadu_ps(bound), _mm256_set1_ps(limit), _CMP_NGT_UQ))
#define KERNEL_OPEN(bound, limit) (EIGHT(bound, limit) | EIGHT((bound) + 8, limit) << 8)

/* Two nodes, each in a half of a register. A half is then the same four lanes of x, y or z. */
#define HALF(points, at, lane) _mm_loadu_ps((points) + 4 * (size_t)(at)[lane])
#define HALVES(points, at, i)                                                                                          \
    _mm256_insertf128_ps(_mm256_castps128_ps256(HALF(points, at, i)), HALF(points, at, (i) + 4), 1)
#define TAKE_EIGHT(points, at, x, y, z, from)                                                                          \
    {                                                                                                                  \
        const __m256 take0 = HALVES(points, at, from), take1 = HALVES(points, at, (from) + 1);                         \
        const __m256 take2 = HALVES(points, at, (from) + 2);                                                           \
        const __m256 take3 = HALVES(points, at, (from) + 3);                                                           \
        const __m256 low01 = _mm256_unpacklo_ps(take0, take1);                                                         \
        const __m256 low23 = _mm256_unpacklo_ps(take2, take3);                                                         \
        const __m256 high01 = _mm256_unpackhi_ps(take0, take1);                                                        \
        const __m256 high23 = _mm256_unpackhi_ps(take2, take3);                                                        \
        _mm256_storeu_ps((x) + (from), _mm256_shuffle_ps(low01, low23, 0x44));                                         \
        _mm256_storeu_ps((y) + (from), _mm256_shuffle_ps(low01, low23, 0xee));                                         \
        _mm256_storeu_ps((z) + (from), _mm256_shuffle_ps(high01, high23, 0x44));                                       \
    }
#define KERNEL_TAKE(points, at, x, y, z)                                                                               \
    TAKE_EIGHT(points, at, x, y, z, 0)                                                                                 \
    TAKE_EIGHT(points, at, x, y, z, 8)
#define PUT_HALVES(points, i, from)                                                                                    \
    {                                                                                                                  \
        _mm_storeu_ps((points) + 4 * (i), _mm256_castps256_ps128(from));                                               \
        _mm_storeu_ps((points) + 4 * ((i) + 4), _mm256_extractf128_ps(from, 1));                                       \
    }
#define PUT_EIGHT(points, x, y, z, from)                                                                               \
    {                                                                                                                  \
        const __m256 put_x = _mm256_loadu_ps((x) + (from)), put_y = _mm256_loadu_ps((y) + (from));                     \
        const __m256 put_z = _mm256_loadu_ps((z) + (from)), zero = _mm256_setzero_ps();                                \
        const __m256 low_xy = _mm256_unpacklo_ps(put_x, put_y);                                                        \
        const __m256 low_z = _mm256_unpacklo_ps(put_z, zero);                                                          \
        const __m256 high_xy = _mm256_unpackhi_ps(put_x, put_y);                                                       \
        const __m256 high_z = _mm256_unpackhi_ps(put_z, zero);                                                         \
        PUT_HALVES(points, from, _mm256_shuffle_ps(low_xy, low_z, 0x44))                                               \
        PUT_HALVES(points, (from) + 1, _mm256_shuffle_ps(low_xy, low_z, 0xee))                                         \
        PUT_HALVES(points, (from) + 2, _mm256_shuffle_ps(high_xy, high_z, 0x44))                                       \
        PUT_HALVES(points, (from) + 3, _mm256_shuffle_ps(high_xy, high_z, 0xee))                                       \
    }
#define KERNEL_PUT(points, x, y, z)                                                                                    \
    PUT_EIGHT(points, x, y, z, 0)                                                                                      \
    PUT_EIGHT(points, x, y, z, 8)
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
typedef int kernel_avx2_is_for_another_machine;
#endif
