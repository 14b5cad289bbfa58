/* SPDX-License-Identifier: BSD-3-Clause */
#include "text/near_word.h"

#include <string.h>

enum { LETTERS_MIN = 2, LETTERS_MAX = 40 };

static char lower(char letter)
{
    return (char)(letter >= 'A' && letter <= 'Z' ? letter - 'A' + 'a' : letter);
}

static unsigned least(unsigned a, unsigned b)
{
    return a < b ? a : b;
}

/* Row by row of the table of distances between the beginnings of both; two rows back for a swap. */
static unsigned distance_of(const char *a, size_t a_length, const char *b, size_t b_length)
{
    unsigned rows[3][LETTERS_MAX + 1];
    unsigned *row = rows[0], *above = rows[1], *two_above = rows[2];
    for (size_t k = 0; k <= b_length; k++)
        row[k] = (unsigned)k;
    for (size_t i = 1; i <= a_length; i++) {
        unsigned *const spare = two_above;
        two_above = above;
        above = row;
        row = spare;
        row[0] = (unsigned)i;
        for (size_t k = 1; k <= b_length; k++) {
            const char at_a = lower(a[i - 1]), at_b = lower(b[k - 1]);
            row[k] = least(least(above[k] + 1, row[k - 1] + 1), above[k - 1] + (at_a != at_b));
            if (i > 1 && k > 1 && at_a == lower(b[k - 2]) && lower(a[i - 2]) == at_b)
                row[k] = least(row[k], two_above[k - 2] + 1);
        }
    }
    return row[b_length];
}

struct near_word near_word_begin(const char *text, size_t length)
{
    return (struct near_word){ .text = text, .length = length, .distance = length <= 4 ? 2 : length <= 8 ? 3 : 4 };
}

void near_word_try(struct near_word *near, const char *word)
{
    const size_t length = strlen(word);
    if (near->length < LETTERS_MIN || near->length > LETTERS_MAX || length > LETTERS_MAX)
        return;
    const unsigned distance = distance_of(near->text, near->length, word, length);
    if (distance < near->distance) {
        near->distance = distance;
        near->word = word;
    }
}
