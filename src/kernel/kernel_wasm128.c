/* SPDX-License-Identifier: BSD-3-Clause */
#if defined(__wasm_simd128__) && !defined(DPT_SCALAR)
#include <wasm_simd128.h>

#define KERNEL(name) dpti_kernel_wasm128_##name
#define KERNEL_TARGET
#define FOUR(bound, limit)                                                                                             \
    (uint32_t) wasm_i32x4_bitmask(wasm_v128_not(wasm_f32x4_gt(wasm_v128_load(bound), wasm_f32x4_splat(limit))))
#define KERNEL_OPEN(bound, limit)                                                                                      \
    (FOUR(bound, limit) | FOUR((bound) + 4, limit) << 4 | FOUR((bound) + 8, limit) << 8 |                              \
     FOUR((bound) + 12, limit) << 12)
#include "kernel/kernel_body.h"
#else
typedef int kernel_wasm128_is_for_another_machine;
#endif
