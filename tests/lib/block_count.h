/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The cost of a call as a count of basic blocks: the same in every run, on a loaded machine too.
 *
 * COUNTED_TESTS in tests.mk names the programs that include this. They are linked with the core, the compiler and
 * text/ built once more by -fsanitize-coverage=trace-pc, with which each basic block calls __sanitizer_cov_trace_pc.
 * Plain gcc and clang have it; a count of instructions would need a kernel that allows it, or valgrind. The library
 * that ships has none of it. What moves or compares memory counts a block for every 16 bytes (--wrap).
 *
 * The objects are built with -O2 whatever CFLAGS is, so the count depends on the compiler alone: bounds need half as
 * much again. The kernels are not counted: a call of theirs takes constant time, and each has loops of its own.
 *
 * It counts one thread. The code of the test itself is not counted, but for its calls of the functions below.
 */
#ifndef DPT_TESTS_BLOCK_COUNT_H
#define DPT_TESTS_BLOCK_COUNT_H

#include <stddef.h>
#include <stdint.h>

/* Since the program began; a cost is the difference of two readings. */
static uint64_t block_count;

void __sanitizer_cov_trace_pc(void);
void __sanitizer_cov_trace_pc(void)
{
    block_count++;
}

/* `bytes` is evaluated once. */
#define COUNT_BYTES(type, name, declared, given, bytes)                                                                \
    type __real_##name declared;                                                                                       \
    type __wrap_##name declared;                                                                                       \
    type __wrap_##name declared                                                                                        \
    {                                                                                                                  \
        block_count += (bytes) / 16;                                                                                   \
        return __real_##name given;                                                                                    \
    }

COUNT_BYTES(void *, memset, (void *to, int byte, size_t n), (to, byte, n), n)
COUNT_BYTES(void *, memcpy, (void *to, const void *from, size_t n), (to, from, n), n)
COUNT_BYTES(void *, memmove, (void *to, const void *from, size_t n), (to, from, n), n)
COUNT_BYTES(int, memcmp, (const void *a, const void *b, size_t n), (a, b, n), n)
COUNT_BYTES(void *, memchr, (const void *in, int byte, size_t n), (in, byte, n), n)
COUNT_BYTES(void *, calloc, (size_t n, size_t width), (n, width), n *width)
COUNT_BYTES(void *, realloc, (void *block, size_t n), (block, n), n)

#endif
