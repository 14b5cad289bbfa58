/* SPDX-License-Identifier: BSD-3-Clause */
/* The numbers of a record one by one, each by its name: the columns of `record csv`, and what `replay` compares. */
#ifndef DPT_TOOLS_RECORD_FIELDS_H
#define DPT_TOOLS_RECORD_FIELDS_H

#include <stdio.h>

#include "dynpoint/record.h"

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
