/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * "Did you mean ...": of some words, the one that was probably meant by a text that is none of them.
 *
 *     struct near_word near = near_word_begin(text, strlen(text));
 *     for (...)
 *         near_word_try(&near, word);
 *     if (near.word)
 *         ...
 */
#ifndef DPT_NEAR_WORD_H
#define DPT_NEAR_WORD_H

#include <stddef.h>

struct near_word {
    const char *text;
    size_t length;
    const char *word;  /* the nearest so far, the first of several; NULL: none is near enough */
    unsigned distance; /* of it; while there is none, one more than the most that is near enough */
};

/*
 * The distance of two words is the number of letters that are left out, added, changed, or swapped with their neighbour
 * (optimal string alignment), whatever their case. Near enough is one for up to four letters of the text, two for up to
 * eight, three beyond. A text of a single letter, or of more than 40, is near to nothing.
 */
struct near_word near_word_begin(const char *text, size_t length);

void near_word_try(struct near_word *near, const char *word);

#endif
