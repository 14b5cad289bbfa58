/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * JSON with the place of what is wrong. The tree is jansson's; a value knows how it was reached. The first fault counts:
 * after it, every call finds nothing, so that a caller asks once, at the end.
 */
#ifndef DPT_SCENE_JSON_VALUE_H
#define DPT_SCENE_JSON_VALUE_H

#include <stddef.h>
#include <stdint.h>

#include "scene/host_error.h"

/* ASCII without control characters. */
struct json_fault {
    int line, column; /* of what is no JSON, from 1; line 0: see `place` */
    char place[128];  /* "bodies[2].material.young"; "": of the whole */
    char reason[200]; /* "": there is no fault */
};

/* Say in one line what is wrong with a file; returns DPT_E_SYNTAX. */
dpt_result json_fault_refuse(const struct json_fault *fault, const char *path, dpt_host_error *error);

struct json_reader {
    struct json_t *tree;
    struct json_fault fault;
};

/* A value and its place in the tree. `value` is NULL if it is missing, `up` is NULL at the root. */
struct json_value {
    const struct json_t *value;
    const struct json_value *up;
    const char *key; /* NULL: it is the item `index` of a list */
    size_t index;
};

/* Read a text. Free the reader also after a fault. */
struct json_value json_read(struct json_reader *reader, const char *text, size_t size);
void json_free(struct json_reader *reader);

int json_has_failed(const struct json_reader *reader);

/* Record what is wrong with a value, unless a fault was recorded before. */
void json_refuse(struct json_reader *reader, const struct json_value *at, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 3, 4)))
#endif
    ;

/* A member of an object, an item of a list. What is no object has no members. */
struct json_value json_member(const struct json_value *object, const char *key);
struct json_value json_item(const struct json_value *list, size_t index);

/* 1 if it is an object whose keys are all among `keys`, which ends with NULL; else 0, with a fault. */
int json_check_object(struct json_reader *reader, const struct json_value *at, const char *const *keys);

/* The length of a list; 0 with a fault if it is no list of `min` to `max` items. */
size_t json_check_list(struct json_reader *reader, const struct json_value *at, size_t min, size_t max);

/* A whole number. A value that is not there leaves `to` as it is. */
void json_whole(struct json_reader *reader, const struct json_value *at, uint64_t min, uint64_t max, uint64_t *to);

/*
 * Members of an object. A member that is missing leaves `to` as it is. json_take_above takes numbers above 0.
 * json_take_numbers takes a list of `count` numbers within -max..max.
 */
void json_take_number(struct json_reader *reader, const struct json_value *object, const char *key, double min,
                      double max, double *to);
void json_take_above(struct json_reader *reader, const struct json_value *object, const char *key, double max,
                     double *to);
void json_take_numbers(struct json_reader *reader, const struct json_value *object, const char *key, size_t count,
                       double max, double *to);
void json_take_count(struct json_reader *reader, const struct json_value *object, const char *key, uint64_t min,
                     uint64_t max, uint64_t *to);
void json_take_flag(struct json_reader *reader, const struct json_value *object, const char *key, int *to);

/* The index of a word in `words`, which ends with NULL, else `otherwise`. */
int json_take_word(struct json_reader *reader, const struct json_value *object, const char *key,
                   const char *const *words, int otherwise);

/* A text of 1 to JSON_TEXT_MAX bytes without control characters, else NULL. It lives as long as the reader. */
enum { JSON_TEXT_MAX = 4000 };
const char *json_take_text(struct json_reader *reader, const struct json_value *object, const char *key);

#endif
