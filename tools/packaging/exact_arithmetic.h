/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Single files are compiled without the Makefile's flags. Here stands what keeps their arithmetic exact and the same on
 * every machine; a compiler that cannot keep it stops.
 */
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) ||                               \
    defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) || defined(__NO_SIGNED_ZEROS__)
#error "dynpoint needs exact arithmetic: compile this file without -ffast-math, -Ofast and their parts"
#endif
/* Compilers before gcc 12 say only this. Where doubles are not in hardware it is always 0. */
#if defined(__GCC_IEC_559) && __GCC_IEC_559 == 0 && (defined(__x86_64__) || defined(__aarch64__))
#error "dynpoint needs exact arithmetic: compile this file without -funsafe-math-optimizations and its parts"
#endif
#if defined(__clang__)
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wignored-pragmas" /* not every machine has the next one */
#pragma float_control(precise, on)                   /* nothing is reordered */
#pragma clang diagnostic pop
#pragma STDC FP_CONTRACT OFF /* no multiply is fused with an add */
#pragma clang diagnostic ignored "-Wunused-function"
#elif defined(__GNUC__)
#pragma GCC diagnostic error "-Wpragmas" /* an option that is not known is an error */
#pragma GCC optimize("fp-contract=off", "no-tree-slp-vectorize", "no-math-errno", "no-trapping-math")
#pragma GCC optimize("tree-loop-vectorize", "vect-cost-model=dynamic") /* at -O2 too */
#pragma GCC diagnostic ignored "-Wunused-function"
#else
#error "dynpoint: this file is for gcc and clang"
#endif

#include <math.h>
/* Roots are instructions: without errno they need no call. */
__attribute__((const)) double sqrt(double);
__attribute__((const)) float sqrtf(float);
