/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Inputs from inputs, the same on every machine: a seed names a run. For where no fuzzing engine is.
 */
#ifndef DPT_TESTS_FUZZ_MUTATE_H
#define DPT_TESTS_FUZZ_MUTATE_H

#include <stddef.h>
#include <stdint.h>

struct fuzz_input {
    unsigned char *bytes;
    size_t size;
    char name[64];
};

/* Inputs, and the words of a dictionary, which are bytes too. Begin with zeros. */
struct fuzz_set {
    struct fuzz_input *inputs;
    size_t count, room;
};

void fuzz_set_free(struct fuzz_set *set);

/*
 * Add all files of `folder` that are no longer than `most` and end in `ending` ("" all), in the order of their names.
 * Returns how many; -1 when there is no such folder.
 */
int fuzz_set_add_folder(struct fuzz_set *set, const char *folder, const char *ending, size_t most);

/* Add the words of a dictionary of libFuzzer: lines "word", with \\, \" and \xAB. Returns how many, or -1. */
int fuzz_set_add_words(struct fuzz_set *set, const char *path);

/*
 * One input of `set` into `out`, changed one to eight times: bits, bytes, numbers in binary and as text, words, pieces
 * of others; cut, repeated, left out. Of every third one digits alone, so that text keeps its form. Returns its length,
 * at most `room`.
 */
size_t fuzz_mutate(uint64_t *random, const struct fuzz_set *set, const struct fuzz_set *words, unsigned char *out,
                   size_t room);

#endif
