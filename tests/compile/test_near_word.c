/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * "Did you mean": the oracle counts edits by trying all of them, letter by letter, as the definition says. Which word a
 * person meant is not judged but by the examples.
 */
#include <string.h>

#include "lib/check.h"
#include "text/near_word.h"

/* Optimal string alignment, by its recursion. */
static unsigned edits(const char *a, size_t a_length, const char *b, size_t b_length)
{
    if (!a_length || !b_length)
        return (unsigned)(a_length + b_length);
    unsigned least = edits(a, a_length - 1, b, b_length) + 1, other = edits(a, a_length, b, b_length - 1) + 1;
    least = other < least ? other : least;
    other = edits(a, a_length - 1, b, b_length - 1) + (a[a_length - 1] != b[b_length - 1]);
    least = other < least ? other : least;
    if (a_length > 1 && b_length > 1 && a[a_length - 1] == b[b_length - 2] && a[a_length - 2] == b[b_length - 1]) {
        other = edits(a, a_length - 2, b, b_length - 2) + 1;
        least = other < least ? other : least;
    }
    return least;
}

static void random_word(uint64_t *state, char word[8])
{
    const size_t length = 1 + random_bits(state) % 6;
    for (size_t i = 0; i < length; i++)
        word[i] = (char)('a' + random_bits(state) % 3);
    word[length] = '\0';
}

static void distances_are_those_of_the_definition(void)
{
    uint64_t state = 5;
    unsigned near_count = 0;
    for (int i = 0; i < 4000; i++) {
        char text[8], word[8];
        random_word(&state, text);
        random_word(&state, word);
        const size_t length = strlen(text);
        const unsigned wanted = edits(text, length, word, strlen(word)), limit = length <= 4 ? 1 : 2;
        struct near_word near = near_word_begin(text, length);
        near_word_try(&near, word);
        const int is_near = length > 1 && wanted <= limit;
        CHECK((near.word == word) == is_near, "'%s' and '%s': %u edits", text, word, wanted);
        CHECK(!is_near || near.distance == wanted, "'%s' and '%s': %u, not %u", text, word, near.distance, wanted);
        near_count += (unsigned)is_near;
    }
    CHECK(near_count > 300, "%u", near_count);
}

static const char *meant(const char *text, const char *const *words)
{
    struct near_word near = near_word_begin(text, strlen(text));
    for (; *words; words++)
        near_word_try(&near, *words);
    return near.word ? near.word : "";
}

static void the_nearest_is_told(void)
{
    static const char *const words[] = { "run", "record", "replay", "info", "plan", "plot", NULL };
    static const struct {
        const char *text, *word;
    } typed[] = { { "rnu", "run" },
                  { "recrod", "record" },
                  { "REPLAY", "replay" },
                  { "plam", "plan" },
                  { "pla", "plan" },
                  { "plaot", "plot" },
                  { "banana", "" },
                  { "r", "" },
                  { "", "" },
                  { "inof", "info" },
                  { "in", "" } };
    for (size_t i = 0; i < sizeof typed / sizeof *typed; i++)
        CHECK(!strcmp(meant(typed[i].text, words), typed[i].word), "'%s': '%s', not '%s'", typed[i].text,
              meant(typed[i].text, words), typed[i].word);
}

static void long_texts_are_near_to_nothing(void)
{
    char text[4096];
    memset(text, 'a', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    struct near_word near = near_word_begin(text, 40);
    near_word_try(&near, text);
    CHECK(!near.word, "a word that is too long is near");
    near_word_try(&near, text + sizeof text - 1 - 40);
    CHECK(near.word && !near.distance, "40 letters");
    near = near_word_begin(text, 41);
    near_word_try(&near, text + sizeof text - 1 - 40);
    CHECK(!near.word, "41 letters are near to something");
}

int main(void)
{
    TEST(distances_are_those_of_the_definition);
    TEST(the_nearest_is_told);
    TEST(long_texts_are_near_to_nothing);
    return check_report();
}
