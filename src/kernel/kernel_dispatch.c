/* SPDX-License-Identifier: BSD-3-Clause */
#include "dynpoint/kernel.h"
#include "kernel/kernel_ops.h"

#if defined(__x86_64__) && !defined(DPT_SCALAR)
#define KERNELS_X86 1
#include <cpuid.h>
#elif defined(__aarch64__) && !defined(DPT_SCALAR)
#define KERNELS_ARM 1
#elif defined(__wasm_simd128__) && !defined(DPT_SCALAR)
#define KERNELS_WASM 1
#endif

const char *dpt_kernel_name(uint32_t id)
{
    switch (id) {
    case DPT_KERNEL_SCALAR:
        return "scalar";
    case DPT_KERNEL_SSE2:
        return "sse2";
    case DPT_KERNEL_AVX2:
        return "avx2";
    case DPT_KERNEL_AVX512:
        return "avx512";
    case DPT_KERNEL_NEON:
        return "neon";
    case DPT_KERNEL_WASM128:
        return "wasm128";
    default:
        return "none";
    }
}

#ifdef KERNELS_X86
/* The register sets that the operating system saves, read from the processor; the compiler's runtime is not used. */
static uint32_t saved_registers(void)
{
    uint32_t low, high;
    __asm__ volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    return low;
}

uint32_t dpt_kernel_best(void)
{
    enum { OSXSAVE = 1 << 27, YMM = 0x06, ZMM = 0xe6 };
    enum { AVX2 = 1 << 5, AVX512F = 1 << 16, AVX512DQ = 1 << 17 };
    const uint32_t avx512vl = 1u << 31;
    uint32_t a, b, c, d;
    if (!__get_cpuid(1, &a, &b, &c, &d) || !(c & OSXSAVE))
        return DPT_KERNEL_SSE2;
    uint32_t saved = saved_registers();
    if (!__get_cpuid_count(7, 0, &a, &b, &c, &d) || (saved & YMM) != YMM || !(b & AVX2))
        return DPT_KERNEL_SSE2;
    if ((saved & ZMM) == ZMM && (b & AVX512F) && (b & AVX512DQ) && (b & avx512vl))
        return DPT_KERNEL_AVX512;
    return DPT_KERNEL_AVX2;
}
#elif defined(KERNELS_ARM)
uint32_t dpt_kernel_best(void)
{
    return DPT_KERNEL_NEON;
}
#elif defined(KERNELS_WASM)
uint32_t dpt_kernel_best(void)
{
    return DPT_KERNEL_WASM128;
}
#else
uint32_t dpt_kernel_best(void)
{
    return DPT_KERNEL_SCALAR;
}
#endif

/* Objects, not literals: tuned for some processors, gcc keeps so large a literal in data that can be written. */
#define KERNEL_TABLE(set)                                                                                              \
    {                                                                                                                  \
        dpti_kernel_##set##_cached_boxes, dpti_kernel_##set##_cached_triangles, dpti_kernel_##set##_boxes,             \
            dpti_kernel_##set##_triangles, dpti_kernel_##set##_better, dpti_kernel_##set##_common_boxes,               \
            dpti_kernel_##set##_common_triangles, dpti_kernel_##set##_swept_boxes,                                     \
            dpti_kernel_##set##_swept_triangles, dpti_kernel_##set##_point_boxes, dpti_kernel_##set##_point_triangles, \
            dpti_kernel_##set##_moments, dpti_kernel_##set##_angles, dpti_kernel_##set##_move,                         \
            dpti_kernel_##set##_outside, dpti_kernel_##set##_spring_forces, dpti_kernel_##set##_spring_energy,         \
            dpti_kernel_##set##_spring_product, dpti_kernel_##set##_spring_move, dpti_kernel_##set##_spring_descend,   \
            dpti_kernel_##set##_spring_turn, dpti_kernel_##set##_spring_aim, dpti_kernel_##set##_spring_begin,         \
            dpti_kernel_##set##_spring_end, dpti_kernel_##set##_spring_points, dpti_kernel_##set##_spring_follow,      \
            dpti_kernel_##set##_cell_pulls, dpti_kernel_##set##_cell_energy, dpti_kernel_##set##_cell_forces           \
    }

static const struct kernel scalar_kernel = KERNEL_TABLE(scalar);
#ifdef KERNELS_X86
static const struct kernel sse2_kernel = KERNEL_TABLE(sse2);
static const struct kernel avx2_kernel = KERNEL_TABLE(avx2);
static const struct kernel avx512_kernel = KERNEL_TABLE(avx512);
#endif
#ifdef KERNELS_ARM
static const struct kernel neon_kernel = KERNEL_TABLE(neon);
#endif
#ifdef KERNELS_WASM
static const struct kernel wasm128_kernel = KERNEL_TABLE(wasm128);
#endif

int dpti_kernel_get(uint32_t id, struct kernel *kernel, uint32_t *chosen)
{
    *chosen = id == DPT_KERNEL_AUTO ? dpt_kernel_best() : id;
    switch (*chosen) {
    case DPT_KERNEL_SCALAR:
        *kernel = scalar_kernel;
        return 1;
#ifdef KERNELS_X86
    case DPT_KERNEL_SSE2:
        *kernel = sse2_kernel;
        return 1;
    case DPT_KERNEL_AVX2:
        *kernel = avx2_kernel;
        return id == DPT_KERNEL_AUTO || dpt_kernel_best() >= DPT_KERNEL_AVX2;
    case DPT_KERNEL_AVX512:
        *kernel = avx512_kernel;
        return id == DPT_KERNEL_AUTO || dpt_kernel_best() == DPT_KERNEL_AVX512;
#endif
#ifdef KERNELS_ARM
    case DPT_KERNEL_NEON:
        *kernel = neon_kernel;
        return 1;
#endif
#ifdef KERNELS_WASM
    case DPT_KERNEL_WASM128:
        *kernel = wasm128_kernel;
        return 1;
#endif
    default:
        return 0;
    }
}
