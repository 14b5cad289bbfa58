/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/json_value.h"

#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* What a file says may be anything; a message is one line. */
static void make_printable(char *text)
{
    for (; *text; text++)
        if (*text < ' ' || *text > '~')
            *text = '?';
}

struct json_value json_read(struct json_reader *reader, const char *text, size_t size)
{
    struct json_fault *fault = &reader->fault;
    json_error_t error;
    memset(reader, 0, sizeof *reader);
    const size_t mark = size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    reader->tree = json_loadb(text + mark, size - mark, JSON_REJECT_DUPLICATES, &error);
    if (!reader->tree) {
        fault->line = error.line > 0 ? error.line : 1;
        fault->column = error.column > 0 ? error.column : 1;
        snprintf(fault->reason, sizeof fault->reason, "%s", error.text[0] ? error.text : "memory ran out");
        make_printable(fault->reason);
    }
    return (struct json_value){ .value = reader->tree };
}

void json_free(struct json_reader *reader)
{
    json_decref(reader->tree);
    reader->tree = NULL;
}

dpt_result json_fault_refuse(const struct json_fault *fault, const char *path, dpt_host_error *error)
{
    if (fault->line)
        return host_refuse(error, DPT_E_SYNTAX, "%s:%d:%d: %s", path, fault->line, fault->column, fault->reason);
    return host_refuse(error, DPT_E_SYNTAX, "%s: %s%s%s", path, fault->place, fault->place[0] ? ": " : "",
                       fault->reason);
}

int json_has_failed(const struct json_reader *reader)
{
    return reader->fault.reason[0] != '\0';
}

/* Write the place into the room that is left of it; returns its length. */
static size_t write_place(char *place, size_t room, const struct json_value *at)
{
    if (!at->up)
        return 0;
    const size_t length = write_place(place, room, at->up);
    const int more = at->key ? snprintf(place + length, room - length, "%s%s", length ? "." : "", at->key)
                             : snprintf(place + length, room - length, "[%zu]", at->index);
    const size_t end = length + (size_t)(more > 0 ? more : 0);
    return end < room ? end : room - 1;
}

void json_refuse(struct json_reader *reader, const struct json_value *at, const char *format, ...)
{
    struct json_fault *fault = &reader->fault;
    va_list arguments;
    if (json_has_failed(reader))
        return;
    write_place(fault->place, sizeof fault->place, at);
    va_start(arguments, format);
    vsnprintf(fault->reason, sizeof fault->reason, format, arguments);
    va_end(arguments);
    make_printable(fault->reason);
}

struct json_value json_member(const struct json_value *object, const char *key)
{
    return (struct json_value){ json_object_get(object->value, key), object, key, 0 };
}

struct json_value json_item(const struct json_value *list, size_t index)
{
    return (struct json_value){ json_array_get(list->value, index), list, NULL, index };
}

static const char *kind_of(const json_t *value)
{
    switch (json_typeof(value)) {
    case JSON_OBJECT:
        return "an object";
    case JSON_ARRAY:
        return "a list";
    case JSON_STRING:
        return "a text";
    case JSON_INTEGER:
    case JSON_REAL:
        return "a number";
    case JSON_TRUE:
        return "true";
    case JSON_FALSE:
        return "false";
    default:
        return "null";
    }
}

/* 1 if there is a value to be looked at, and nothing has failed. */
static int is_there(const struct json_reader *reader, const struct json_value *at)
{
    return at->value && !json_has_failed(reader);
}

static int is_kind(struct json_reader *reader, const struct json_value *at, int is_good, const char *wanted)
{
    if (!is_good)
        json_refuse(reader, at, "must be %s; it is %s", wanted, kind_of(at->value));
    return is_good;
}

int json_check_object(struct json_reader *reader, const struct json_value *at, const char *const *keys)
{
    if (!is_there(reader, at) || !is_kind(reader, at, json_is_object(at->value), "an object"))
        return 0;
    /* jansson's iterator does not change an object, but takes one that could be. */
    json_t *object = (json_t *)(uintptr_t)at->value;
    for (void *i = json_object_iter(object); i; i = json_object_iter_next(object, i)) {
        const char *const *known = keys;
        while (*known && strcmp(*known, json_object_iter_key(i)))
            known++;
        if (!*known)
            json_refuse(reader, at, "there is no key '%.40s'", json_object_iter_key(i));
    }
    return !json_has_failed(reader);
}

size_t json_check_list(struct json_reader *reader, const struct json_value *at, size_t min, size_t max)
{
    if (!is_there(reader, at) || !is_kind(reader, at, json_is_array(at->value), "a list"))
        return 0;
    const size_t count = json_array_size(at->value);
    if (count >= min && count <= max)
        return count;
    if (min == max)
        json_refuse(reader, at, "has %zu items; there must be %zu", count, max);
    else
        json_refuse(reader, at, "has %zu items; there must be %zu to %zu", count, min, max);
    return 0;
}

/* The number, or NAN after a fault. */
static double number_of(struct json_reader *reader, const struct json_value *at)
{
    if (!is_kind(reader, at, json_is_number(at->value), "a number"))
        return NAN;
    return json_number_value(at->value);
}

void json_take_number(struct json_reader *reader, const struct json_value *object, const char *key, double min,
                      double max, double *to)
{
    const struct json_value at = json_member(object, key);
    if (!is_there(reader, &at))
        return;
    const double number = number_of(reader, &at);
    if (number >= min && number <= max)
        *to = number;
    else
        json_refuse(reader, &at, "must be %g to %g; it is %g", min, max, number);
}

void json_take_above(struct json_reader *reader, const struct json_value *object, const char *key, double max,
                     double *to)
{
    const struct json_value at = json_member(object, key);
    if (!is_there(reader, &at))
        return;
    const double number = number_of(reader, &at);
    if (number > 0.0 && number <= max)
        *to = number;
    else
        json_refuse(reader, &at, "must be above 0, at most %g; it is %g", max, number);
}

void json_take_numbers(struct json_reader *reader, const struct json_value *object, const char *key, size_t count,
                       double max, double *to)
{
    const struct json_value list = json_member(object, key);
    if (!json_check_list(reader, &list, count, count))
        return;
    for (size_t i = 0; i < count; i++) {
        const struct json_value at = json_item(&list, i);
        const double number = number_of(reader, &at);
        if (fabs(number) <= max)
            to[i] = number;
        else
            json_refuse(reader, &at, "must be %g to %g; it is %g", -max, max, number);
    }
}

void json_whole(struct json_reader *reader, const struct json_value *at, uint64_t min, uint64_t max, uint64_t *to)
{
    if (!is_there(reader, at))
        return;
    if (!json_is_integer(at->value))
        json_refuse(reader, at, "must be a whole number, without a point or an exponent");
    const json_int_t number = json_integer_value(at->value);
    if (number >= 0 && (uint64_t)number >= min && (uint64_t)number <= max)
        *to = (uint64_t)number;
    else
        json_refuse(reader, at, "must be %llu to %llu; it is %lld", (unsigned long long)min, (unsigned long long)max,
                    (long long)number);
}

void json_take_count(struct json_reader *reader, const struct json_value *object, const char *key, uint64_t min,
                     uint64_t max, uint64_t *to)
{
    const struct json_value at = json_member(object, key);
    json_whole(reader, &at, min, max, to);
}

void json_take_flag(struct json_reader *reader, const struct json_value *object, const char *key, int *to)
{
    const struct json_value at = json_member(object, key);
    if (is_there(reader, &at) && is_kind(reader, &at, json_is_boolean(at.value), "true or false"))
        *to = json_is_true(at.value);
}

int json_take_word(struct json_reader *reader, const struct json_value *object, const char *key,
                   const char *const *words, int otherwise)
{
    const struct json_value at = json_member(object, key);
    char known[120] = "";
    if (!is_there(reader, &at) || !is_kind(reader, &at, json_is_string(at.value), "a text"))
        return otherwise;
    for (int i = 0; words[i]; i++) {
        const size_t length = strlen(known);
        if (!strcmp(words[i], json_string_value(at.value)))
            return i;
        snprintf(known + length, sizeof known - length, "%s%s", i ? ", " : "", words[i]);
    }
    json_refuse(reader, &at, "'%.40s' is none of: %s", json_string_value(at.value), known);
    return otherwise;
}

const char *json_take_text(struct json_reader *reader, const struct json_value *object, const char *key)
{
    const struct json_value at = json_member(object, key);
    if (!is_there(reader, &at) || !is_kind(reader, &at, json_is_string(at.value), "a text"))
        return NULL;
    const char *text = json_string_value(at.value);
    const size_t length = json_string_length(at.value);
    if (length < 1 || length > JSON_TEXT_MAX)
        json_refuse(reader, &at, "has %zu bytes; there must be 1 to %d", length, JSON_TEXT_MAX);
    for (const char *c = text; *c; c++)
        if ((unsigned char)*c < ' ' || *c == 0x7f)
            json_refuse(reader, &at, "has a control character");
    return json_has_failed(reader) ? NULL : text;
}
