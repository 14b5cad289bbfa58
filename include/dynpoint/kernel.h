/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Kernels: the inner loops, compiled for each instruction set. All give the same bits. They differ only in speed.
 *
 * Threads: every function may be called from any thread.
 */
#ifndef DYNPOINT_KERNEL_H
#define DYNPOINT_KERNEL_H

#include "dynpoint/base.h"

DPT_BEGIN

/* Instruction sets. */
enum {
    DPT_KERNEL_AUTO = 0, /* the widest one that this machine has */
    DPT_KERNEL_SCALAR = 1,
    DPT_KERNEL_SSE2 = 2,
    DPT_KERNEL_AVX2 = 3,
    DPT_KERNEL_AVX512 = 4,
    DPT_KERNEL_NEON = 5,
    DPT_KERNEL_WASM128 = 6 /* WebAssembly's vectors of 128 bits */
};

/* The kernel's name, such as "avx2"; "none" for a number that is no kernel. */
DPT_API const char *dpt_kernel_name(uint32_t kernel);

/* The kernel that DPT_KERNEL_AUTO selects on this machine. */
DPT_API uint32_t dpt_kernel_best(void);

DPT_END

#endif
