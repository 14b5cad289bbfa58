/* SPDX-License-Identifier: BSD-3-Clause */
#if defined(__x86_64__) && !defined(DPT_SCALAR)
#include <emmintrin.h>

#define KERNEL(name) dpti_kernel_sse2_##name
#define KERNEL_TARGET
#define FOUR(bound, limit) (uint32_t) _mm_movemask_ps(_mm_cmpngt_ps(_mm_loadu_ps(bound), _mm_set1_ps(limit)))
#define KERNEL_OPEN(bound, limit)                                                                                      \
    (FOUR(bound, limit) | FOUR((bound) + 4, limit) << 4 | FOUR((bound) + 8, limit) << 8 |                              \
     FOUR((bound) + 12, limit) << 12)

#define TAKE_FOUR(points, at, x, y, z, from)                                                                           \
    {                                                                                                                  \
        __m128 take0 = _mm_loadu_ps((points) + 4 * (size_t)(at)[from]);                                                \
        __m128 take1 = _mm_loadu_ps((points) + 4 * (size_t)(at)[(from) + 1]);                                          \
        __m128 take2 = _mm_loadu_ps((points) + 4 * (size_t)(at)[(from) + 2]);                                          \
        __m128 take3 = _mm_loadu_ps((points) + 4 * (size_t)(at)[(from) + 3]);                                          \
        _MM_TRANSPOSE4_PS(take0, take1, take2, take3);                                                                 \
        _mm_storeu_ps((x) + (from), take0);                                                                            \
        _mm_storeu_ps((y) + (from), take1);                                                                            \
        _mm_storeu_ps((z) + (from), take2);                                                                            \
    }
#define KERNEL_TAKE(points, at, x, y, z)                                                                               \
    TAKE_FOUR(points, at, x, y, z, 0)                                                                                  \
    TAKE_FOUR(points, at, x, y, z, 4)                                                                                  \
    TAKE_FOUR(points, at, x, y, z, 8)                                                                                  \
    TAKE_FOUR(points, at, x, y, z, 12)
#define PUT_FOUR(points, x, y, z, from)                                                                                \
    {                                                                                                                  \
        __m128 put0 = _mm_loadu_ps((x) + (from)), put1 = _mm_loadu_ps((y) + (from));                                   \
        __m128 put2 = _mm_loadu_ps((z) + (from)), put3 = _mm_setzero_ps();                                             \
        _MM_TRANSPOSE4_PS(put0, put1, put2, put3);                                                                     \
        _mm_storeu_ps((points) + 4 * (from), put0);                                                                    \
        _mm_storeu_ps((points) + 4 * (from) + 4, put1);                                                                \
        _mm_storeu_ps((points) + 4 * (from) + 8, put2);                                                                \
        _mm_storeu_ps((points) + 4 * (from) + 12, put3);                                                               \
    }
#define KERNEL_PUT(points, x, y, z)                                                                                    \
    PUT_FOUR(points, x, y, z, 0)                                                                                       \
    PUT_FOUR(points, x, y, z, 4)                                                                                       \
    PUT_FOUR(points, x, y, z, 8)                                                                                       \
    PUT_FOUR(points, x, y, z, 12)
/* Two corners of opposite cells at a node, as lanes x, y, z and 0. */
#define CORNERS(pulls, at, i, k)                                                                                       \
    _mm_sub_ps(_mm_loadu_ps((pulls) + (size_t)(at)[LANES * (k) + (i)]),                                                \
               _mm_loadu_ps((pulls) + (size_t)(at)[LANES * (7 - (k)) + (i)]))
#define KERNEL_CORNERS(pulls, at, i, to)                                                                               \
    _mm_storeu_ps(to, _mm_add_ps(_mm_add_ps(CORNERS(pulls, at, i, 0), CORNERS(pulls, at, i, 1)),                       \
                                 _mm_add_ps(CORNERS(pulls, at, i, 2), CORNERS(pulls, at, i, 3))));
#include "kernel/kernel_body.h"
#else
typedef int kernel_sse2_is_for_another_machine;
#endif
