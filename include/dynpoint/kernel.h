/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Kernels: the inner loops for each instruction set of a processor. All give the same bits; they differ in speed alone.
 * Every function may be called from any thread.
 */
#ifndef DYNPOINT_KERNEL_H
#define DYNPOINT_KERNEL_H

#include "dynpoint/base.h"

DPT_BEGIN

/* Instruction sets. */
enum {
    DPT_KERNEL_AUTO = 0, /* the widest that this machine has */
    DPT_KERNEL_SCALAR = 1,
    DPT_KERNEL_SSE2 = 2,
    DPT_KERNEL_AVX2 = 3,
    DPT_KERNEL_AVX512 = 4,
    DPT_KERNEL_NEON = 5
};

/* The kernel's name, "avx2"; "none" for a number that is no kernel. */
DPT_API const char *dpt_kernel_name(uint32_t kernel);

/* What DPT_KERNEL_AUTO comes to on this machine. */
DPT_API uint32_t dpt_kernel_best(void);

DPT_END

#endif
