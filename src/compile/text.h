/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Lines, words and numbers of a text, for all readers. The text need not end in a zero. A line ends in LF, CR LF or CR.
 * Blanks, tabs and form feeds separate words.
 */
#ifndef DPT_COMPILE_TEXT_H
#define DPT_COMPILE_TEXT_H

#include "compile/soup.h"

typedef struct source_text {
    const char *at; /* the next byte to read */
    const char *end;
    uint64_t line;                         /* of `at`, from 1 */
    int has_comments;                      /* 1: a word that begins with # ends its line */
    int joins_lines;                       /* 1: a backslash before the end of a line joins the next line to it */
    const struct compile_context *context; /* receives the diag */
} source_text;

/* The bytes of a word, within the text. */
typedef struct source_word {
    const char *begin;
    const char *end;
} source_word;

/* Begin at the first byte, or after a UTF-8 byte order mark. */
void text_begin(source_text *text, const struct compile_context *context, const unsigned char *bytes, size_t size);

/* DPT_E_FORMAT if the bytes are UTF-16. Call it right after text_begin. */
dpt_result text_refuse_utf16(const source_text *text);

/* Read the next word of this line. Returns 0 if there is none. */
int text_next_word(source_text *text, source_word *word);

/* Go to the beginning of the next line. Returns 0 if no text follows. */
int text_next_line(source_text *text);

/* Go to the next word, in this line or a later one, without reading it. Returns 0 if there is none. */
int text_seek_word(source_text *text);

source_location text_location(const source_text *text);

/* Read the next word of this line as a number. `what` says in the diag what the number means. */
dpt_result text_read_double(source_text *text, const char *what, double *value);
dpt_result text_read_int(source_text *text, const char *what, int64_t *value);

/* Read x, y and z from this line, and add the vertex to the soup. */
dpt_result text_read_vertex(source_text *text, soup *source);

/* Is the word `name`? With _any_case, `name` is in lower case and the word in any. */
int word_is(const source_word *word, const char *name);
int word_is_any_case(const source_word *word, const char *name);

/* Copy a word for a message: cut to fit, bytes that are not printable ASCII replaced. Returns `printable`. */
enum { WORD_SHOWN = 32 };
const char *word_printable(const source_word *word, char printable[WORD_SHOWN]);

/* The corners of one polygon while it is read. */
typedef struct corner_list {
    uint32_t *numbers;
    size_t count, capacity;
} corner_list;

dpt_result corner_list_add(corner_list *list, const struct compile_context *context, uint32_t number);
void corner_list_free(corner_list *list);

/* Readers report progress once in this many items. */
enum { PROGRESS_STRIDE = 65536 };

#endif
