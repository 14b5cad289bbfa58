/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What the readers share: lines, words and numbers of a text that is not zero-terminated. A line ends in LF, CR LF or CR; words are separated by blanks, tabs and form
 * feeds.
 */
#ifndef DPT_COMPILE_TEXT_H
#define DPT_COMPILE_TEXT_H

#include "compile/soup.h"

typedef struct source_text {
    const char *at; /* the next byte to read */
    const char *end;
    uint64_t line;
    int has_comments; /* a word that begins with # ends its line */
    int joins_lines;  /* a backslash before the end of a line joins the next one */
    soup *source;     /* whose diag is filled */
} source_text;

typedef struct source_word {
    const char *begin;
    const char *end;
} source_word;

/* Begin before the first byte, or after a UTF-8 byte order mark. */
void text_begin(source_text *text, soup *source, const unsigned char *bytes, size_t size);

/* DPT_E_FORMAT when the bytes are UTF-16. Asked right after text_begin. */
dpt_result text_refuse_utf16(const source_text *text);

/* The next word of this line; false when there is none. */
int text_next_word(source_text *text, source_word *word);

/* Go to the beginning of the next line; false when nothing follows. */
int text_next_line(source_text *text);

/* Go to the next word, over as many lines as it takes; false when there is none. */
int text_seek_word(source_text *text);

source_location text_location(const source_text *text);

/* The next word of this line as a number. `what` it should be is for the diag. */
dpt_result text_read_double(source_text *text, const char *what, double *value);
dpt_result text_read_int(source_text *text, const char *what, int64_t *value);

/* x, y and z on this line: a vertex of the soup. */
dpt_result text_read_vertex(source_text *text);

int word_is(const source_word *word, const char *name);
int word_is_any_case(const source_word *word, const char *name);

/* The word for a message: cut, and without bytes that are not printable ASCII. */
enum { WORD_SHOWN = 32 };
const char *word_printable(const source_word *word, char printable[WORD_SHOWN]);

/* The corners of one polygon while it is read. */
typedef struct corner_list {
    uint32_t *numbers;
    size_t count, capacity;
} corner_list;

dpt_result corner_list_add(corner_list *list, soup *source, uint32_t number);
void corner_list_free(corner_list *list);

/* Readers report progress once in so many items. */
enum { PROGRESS_STRIDE = 65536 };

#endif
