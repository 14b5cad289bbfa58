/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Fuzz targets: any bytes go in, and no harm is done. A target is a function of bytes; with FUZZ_ENGINE it
 * is the entry that libFuzzer and AFL++ look for, without it tests/fuzz/test_fuzz.c calls it by its name.
 *
 *     FUZZ_TARGET(obj) { fuzz_reader(DPT_FORMAT_OBJ, bytes, size); return 0; }
 *
 * `bytes` is a block of exactly `size` bytes, aligned to 8, at most FUZZ_BYTES_MAX long.
 */
#ifndef DPT_TESTS_FUZZ_TARGET_H
#define DPT_TESTS_FUZZ_TARGET_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "dynpoint.h"

#define FUZZ_BYTES_MAX 4096u

#ifdef FUZZ_ENGINE
#define FUZZ_TARGET(name)                                                                                              \
    int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);                                                     \
    int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
#else
#define FUZZ_TARGET(name)                                                                                              \
    int fuzz_##name(const uint8_t *bytes, size_t size);                                                                \
    int fuzz_##name(const uint8_t *bytes, size_t size)
#endif

/* What does not hold ends the program, as a wrong read does under the sanitizers. */
#define MUST(condition)                                                                                                \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);                                            \
            abort();                                                                                                   \
        }                                                                                                              \
    } while (0)

/*
 * Compile the bytes as a file of one format. What is refused has a reason and a place; what is accepted gives the
 * same bytes twice, opens, and is consistent in itself.
 */
void fuzz_reader(uint32_t format, const uint8_t *bytes, size_t size);

/* How the mesh came about, and so what may be asked of its answers. */
enum {
    FUZZ_FORGED,  /* finite numbers and codes, no more */
    FUZZ_COMPILED /* exact ones */
};

/*
 * What to ask, as bits: queries; a few ticks of a world, of one with a budget and shadows, of the paper's method with
 * routes; strips without a world.
 */
enum { FUZZ_QUERY = 1, FUZZ_TICK = 2, FUZZ_BUDGET = 4, FUZZ_PAPER = 8, FUZZ_STRIP = 16, FUZZ_ALL = 31, FUZZ_KINDS = 5 };

/* Ask an open mesh for information, sections and triangles, and for what `asked` says. */
void fuzz_use_mesh(const dpt_mesh *mesh, int origin, int asked);

/* How many inputs of this process were accepted: compiled, opened, read. */
extern uint64_t fuzz_accepted;

#endif
