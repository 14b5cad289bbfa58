/* SPDX-License-Identifier: BSD-3-Clause */
/* Lines, words and numbers (text.h), in one pass that never reads beyond the end. */
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "compile/soup.h"
#include "compile/text.h"
#include "text/parse_number.h"

static int is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

static int is_line_end(char c)
{
    return c == '\n' || c == '\r';
}

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

void text_begin(source_text *text, const struct compile_context *context, const unsigned char *bytes, size_t size)
{
    memset(text, 0, sizeof *text);
    text->at = (const char *)bytes;
    text->end = text->at + size;
    text->line = 1;
    text->context = context;
    if (size >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0)
        text->at += 3;
}

/* UTF-16 without a byte order mark shows a zero byte beside an ASCII letter. */
dpt_result text_refuse_utf16(const source_text *text)
{
    if (text->end - text->at < 2)
        return DPT_OK;
    unsigned char a = (unsigned char)text->at[0], b = (unsigned char)text->at[1];
    int has_mark = (a == 0xfe && b == 0xff) || (a == 0xff && b == 0xfe);
    if (!has_mark && (a == 0) == (b == 0))
        return DPT_OK;
    return compile_fail(text->context, DPT_E_FORMAT, (source_location){ 0, 0 },
                        "this is UTF-16 text: save it as UTF-8 or ASCII");
}

static const char *after_line_end(const char *at, const char *end)
{
    if (*at == '\r' && end - at > 1 && at[1] == '\n')
        return at + 2;
    return at + 1;
}

static int is_line_join(const source_text *text, const char *at)
{
    return *at == '\\' && text->joins_lines && text->end - at > 1 && is_line_end(at[1]);
}

static void skip_blanks(source_text *text)
{
    for (;;) {
        while (text->at < text->end && is_blank(*text->at))
            text->at++;
        if (text->at == text->end || !is_line_join(text, text->at))
            return;
        text->at = after_line_end(text->at + 1, text->end);
        text->line++;
    }
}

int text_next_word(source_text *text, source_word *word)
{
    skip_blanks(text);
    const char *at = text->at;
    if (at == text->end || is_line_end(*at) || (text->has_comments && *at == '#'))
        return 0;
    word->begin = at;
    while (at < text->end && !is_blank(*at) && !is_line_end(*at) && !is_line_join(text, at))
        at++;
    word->end = text->at = at;
    return 1;
}

int text_next_line(source_text *text)
{
    while (text->at < text->end && !is_line_end(*text->at))
        text->at++;
    if (text->at == text->end)
        return 0;
    text->at = after_line_end(text->at, text->end);
    text->line++;
    return text->at < text->end;
}

int text_seek_word(source_text *text)
{
    source_word word;
    while (!text_next_word(text, &word)) {
        if (!text_next_line(text))
            return 0;
    }
    text->at = word.begin;
    return 1;
}

source_location text_location(const source_text *text)
{
    return (source_location){ text->line, 0 };
}

int word_is(const source_word *word, const char *name)
{
    size_t length = (size_t)(word->end - word->begin);
    return strlen(name) == length && memcmp(word->begin, name, length) == 0;
}

static int begins_any_case(const char *at, const char *end, const char *name)
{
    for (; *name != 0; at++, name++) {
        if (at == end || lower(*at) != *name)
            return 0;
    }
    return 1;
}

int word_is_any_case(const source_word *word, const char *name)
{
    return (size_t)(word->end - word->begin) == strlen(name) && begins_any_case(word->begin, word->end, name);
}

const char *word_printable(const source_word *word, char printable[WORD_SHOWN])
{
    size_t length = (size_t)(word->end - word->begin), n = 0;
    for (; n < length && n < WORD_SHOWN - 1; n++) {
        char c = word->begin[n];
        printable[n] = c >= ' ' && c <= '~' ? c : '?';
    }
    printable[n] = 0;
    if (n < length)
        memcpy(printable + WORD_SHOWN - 4, "...", 4);
    return printable;
}

/* As the printf of some library writes them: nan, -nan(ind), inf, infinity; and 1.#IND, 1.#INF, 1.#QNAN. */
static int is_not_finite_word(const source_word *word)
{
    const char *at = word->begin;
    if (at < word->end && (*at == '-' || *at == '+'))
        at++;
    return begins_any_case(at, word->end, "nan") || begins_any_case(at, word->end, "inf") ||
           begins_any_case(at, word->end, "1.#");
}

static dpt_result fail_no_word(source_text *text, const char *what)
{
    return compile_fail(text->context, DPT_E_SYNTAX, text_location(text), "the line ends where %s should be", what);
}

dpt_result text_read_double(source_text *text, const char *what, double *value)
{
    source_word word;
    char printable[WORD_SHOWN];
    if (!text_next_word(text, &word))
        return fail_no_word(text, what);
    if (parse_double(word.begin, word.end, value) == word.end)
        return DPT_OK;
    if (is_not_finite_word(&word))
        return compile_fail(text->context, DPT_E_FINITE, text_location(text), "%s is %s: not a finite number", what,
                            word_printable(&word, printable));
    return compile_fail(text->context, DPT_E_SYNTAX, text_location(text), "%s is '%s': not a number", what,
                        word_printable(&word, printable));
}

dpt_result text_read_int(source_text *text, const char *what, int64_t *value)
{
    source_word word;
    char printable[WORD_SHOWN];
    if (!text_next_word(text, &word))
        return fail_no_word(text, what);
    if (parse_int(word.begin, word.end, value) == word.end)
        return DPT_OK;
    return compile_fail(text->context, DPT_E_SYNTAX, text_location(text), "%s is '%s': not an integer", what,
                        word_printable(&word, printable));
}

dpt_result text_read_vertex(source_text *text, soup *source)
{
    static const char *const names[3] = { "x", "y", "z" };
    double position[3];
    for (int i = 0; i < 3; i++)
        DPT_TRY(text_read_double(text, names[i], &position[i]));
    return soup_add_vertex(source, position[0], position[1], position[2], text_location(text));
}

dpt_result corner_list_add(corner_list *list, const struct compile_context *context, uint32_t number)
{
    if (list->count == list->capacity) {
        uint32_t *bigger = grow_array(list->numbers, &list->capacity, list->count + 1, sizeof *bigger);
        if (!bigger)
            return compile_fail(context, DPT_E_MEMORY, (source_location){ 0, 0 },
                                "no memory for a polygon of %zu corners", list->count + 1);
        list->numbers = bigger;
    }
    list->numbers[list->count++] = number;
    return DPT_OK;
}

void corner_list_free(corner_list *list)
{
    free(list->numbers);
    memset(list, 0, sizeof *list);
}
