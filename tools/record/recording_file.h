/* SPDX-License-Identifier: BSD-3-Clause */
/* Read a recording record by record, whatever its length, up to where it ends and past what is damaged. */
#ifndef DPT_TOOLS_RECORDING_FILE_H
#define DPT_TOOLS_RECORDING_FILE_H

#include <stdio.h>

#include "dynpoint/record.h"

enum { RECORDING_BATCH = 64 };

struct recording_file {
    FILE *file;
    dpt_record_header header; /* its text ends in a zero */
    char *text;
    unsigned char *buffer;
    size_t size, at; /* of the buffer: bytes in it, and the next one */
    uint64_t base;   /* byte of the file that is first in the buffer */
    int is_end;      /* the file has no more bytes than those in the buffer */
    dpt_record batch[RECORDING_BATCH];
    uint32_t count, next;       /* of the batch */
    int wants_pieces;           /* recording_next also gives pieces of files (recording_embed.h) */
    const unsigned char *piece; /* the last one, a whole record, until the next call */
    size_t piece_bytes;
    uint64_t byte;    /* of the last end, cut, damage or piece */
    uint64_t damaged; /* bytes of that damage */
};

/* What comes next. */
enum recording_item {
    RECORDING_RECORD,
    RECORDING_END,    /* the file ends with a whole record */
    RECORDING_PIECE,  /* `piece`, at `byte` */
    RECORDING_CUT,    /* the file ends within a record, which begins at `byte` */
    RECORDING_DAMAGED /* `damaged` bytes from `byte` on are no sound records; what follows comes next */
};

/* 1 if this is a regular file that begins as a recording does. */
int is_recording(const char *path);

/* Returns 0, or 2 after a message. Call recording_close also after a failure. */
int recording_open(struct recording_file *recording, const char *command, const char *path);

enum recording_item recording_next(struct recording_file *recording, dpt_record *record);

void recording_close(struct recording_file *recording);

/* The numbers of a record one by one, each by its name: the columns of `record csv`, and what `replay` compares. */

enum record_word { WORD_U32, WORD_I32, WORD_U64, WORD_F64 };

struct record_field {
    const char *name;
    size_t at; /* in dpt_record */
    enum record_word word;
    int is_answer; /* it follows from the samples and the scene */
};

extern const struct record_field record_fields[];
extern const size_t record_field_count;

/* Whether the field has the same bits in both. */
int record_field_is_same(const struct record_field *field, const dpt_record *a, const dpt_record *b);

/* Print it, as exactly as needed to read the same number. In JSON what is not finite is null. */
void record_field_print(FILE *file, const struct record_field *field, const dpt_record *record, int is_json);

#endif
