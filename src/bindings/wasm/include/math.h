/* SPDX-License-Identifier: BSD-3-Clause */
/* What the core needs of <math.h>, for a machine without a C library: each is an instruction of WebAssembly. */
#ifndef DPT_WASM_MATH_H
#define DPT_WASM_MATH_H

#define NAN         __builtin_nanf("")
#define INFINITY    __builtin_inff()
#define HUGE_VAL    __builtin_huge_val()
#define HUGE_VALF   __builtin_huge_valf()
#define isfinite(x) __builtin_isfinite(x)
#define isnan(x)    __builtin_isnan(x)
#define sqrt(x)     __builtin_sqrt(x)
#define sqrtf(x)    __builtin_sqrtf(x)
#define fabs(x)     __builtin_fabs(x)
#define fabsf(x)    __builtin_fabsf(x)
#define floor(x)    __builtin_floor(x)

#endif
