/* SPDX-License-Identifier: BSD-3-Clause */
#include "fuzz/mutate.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lib/random.h"

void fuzz_set_free(struct fuzz_set *set)
{
    for (size_t i = 0; i < set->count; i++)
        free(set->inputs[i].bytes);
    free(set->inputs);
    *set = (struct fuzz_set){ NULL, 0, 0 };
}

static void add(struct fuzz_set *set, const char *name, const void *bytes, size_t size)
{
    if (set->count == set->room) {
        set->room = set->room ? 2 * set->room : 64;
        set->inputs = realloc(set->inputs, set->room * sizeof *set->inputs);
    }
    struct fuzz_input *input = &set->inputs[set->count++];
    input->bytes = malloc(size + 1);
    memcpy(input->bytes, bytes, size);
    input->size = size;
    snprintf(input->name, sizeof input->name, "%s", name);
}

static int by_name(const void *a, const void *b)
{
    return strcmp(((const struct fuzz_input *)a)->name, ((const struct fuzz_input *)b)->name);
}

static int ends_in(const char *name, const char *ending)
{
    size_t length = strlen(name), end = strlen(ending);
    return length >= end && !strcmp(name + length - end, ending);
}

int fuzz_set_add_folder(struct fuzz_set *set, const char *folder, const char *ending, size_t most)
{
    DIR *dir = opendir(folder);
    const size_t first = set->count;
    unsigned char *bytes = malloc(most + 1);
    for (struct dirent *entry; dir && (entry = readdir(dir)) != NULL;) {
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        FILE *file = entry->d_name[0] != '.' && ends_in(entry->d_name, ending) ? fopen(path, "rb") : NULL;
        size_t size = file ? fread(bytes, 1, most + 1, file) : 0;
        if (file && size <= most)
            add(set, entry->d_name, bytes, size);
        if (file)
            fclose(file);
    }
    free(bytes);
    if (!dir)
        return -1;
    closedir(dir);
    if (set->count > first)
        qsort(set->inputs + first, set->count - first, sizeof *set->inputs, by_name);
    return (int)(set->count - first);
}

int fuzz_set_add_words(struct fuzz_set *set, const char *path)
{
    FILE *file = fopen(path, "r");
    const size_t first = set->count;
    char line[256], word[256];
    while (file && fgets(line, sizeof line, file)) {
        size_t size = 0;
        if (line[0] != '"')
            continue;
        for (const char *at = line + 1; *at && *at != '"'; at++) {
            unsigned value;
            if (at[0] == '\\' && at[1] == 'x' && sscanf(at + 2, "%2x", &value) == 1) {
                word[size++] = (char)value;
                at += 3;
            } else {
                at += at[0] == '\\';
                word[size++] = *at;
            }
        }
        add(set, "word", word, size);
    }
    if (!file)
        return -1;
    fclose(file);
    return (int)(set->count - first);
}

/* Below `count`; 0 for 0. */
static size_t below(uint64_t *random, size_t count)
{
    return count ? (size_t)(random_bits(random) % count) : 0;
}

struct draft {
    unsigned char *bytes;
    size_t size, room;
};

/* Open a gap, as far as there is room. Returns its length. */
static size_t insert(struct draft *draft, size_t at, size_t size)
{
    size = size < draft->room - draft->size ? size : draft->room - draft->size;
    memmove(draft->bytes + at + size, draft->bytes + at, draft->size - at);
    draft->size += size;
    return size;
}

static void put(struct draft *draft, size_t at, const unsigned char *bytes, size_t size, int over)
{
    if (over)
        size = size < draft->size - at ? size : draft->size - at;
    else
        size = insert(draft, at, size);
    memcpy(draft->bytes + at, bytes, size);
}

static void put_number(uint64_t *random, struct draft *draft, size_t at)
{
    static const uint64_t numbers[] = { 0,
                                        1,
                                        2,
                                        3,
                                        127,
                                        128,
                                        255,
                                        256,
                                        32767,
                                        65535,
                                        1000000,
                                        0x7fffffff,
                                        0x80000000,
                                        0xffffffff,
                                        0x100000000,
                                        0x7ff0000000000000,
                                        0x7fffffffffffffff,
                                        0xffffffffffffffff,
                                        0x7f800000,
                                        0x7fc00000,
                                        0x49742400,
                                        0x55555556 };
    uint64_t number = numbers[below(random, sizeof numbers / sizeof *numbers)];
    unsigned char bytes[24];
    const int text = (int)below(random, 4);
    if (text == 0) {
        const char *sign = below(random, 4) ? "" : "-";
        int size = snprintf((char *)bytes, sizeof bytes, "%s%llu", sign, (unsigned long long)number);
        put(draft, at, bytes, (size_t)size, below(random, 2) == 0);
        return;
    }
    const size_t width = (size_t)1 << text, reversed = below(random, 2);
    for (size_t i = 0; i < width; i++)
        bytes[i] = (unsigned char)(number >> 8 * (reversed ? width - 1 - i : i));
    put(draft, at, bytes, width, 1);
}

/* A piece of the draft again, once or often. */
static void repeat(uint64_t *random, struct draft *draft, size_t at)
{
    unsigned char piece[256];
    size_t size = 1 + below(random, below(random, 2) ? 16 : sizeof piece);
    size = size < draft->size - at ? size : draft->size - at;
    memcpy(piece, draft->bytes + at, size);
    size_t times = below(random, 8) ? 1 : 1 + below(random, 64);
    const size_t to = below(random, draft->size + 1);
    while (times--)
        put(draft, to, piece, size, 0);
}

static void leave_out(uint64_t *random, struct draft *draft, size_t at)
{
    size_t size = 1 + below(random, below(random, 2) ? 8 : draft->size);
    size = size < draft->size - at ? size : draft->size - at;
    memmove(draft->bytes + at, draft->bytes + at + size, draft->size - at - size);
    draft->size -= size;
}

static void splice(uint64_t *random, struct draft *draft, size_t at, const struct fuzz_set *set)
{
    const struct fuzz_input *other = &set->inputs[below(random, set->count)];
    const size_t from = below(random, other->size);
    const size_t size = other->size ? 1 + below(random, other->size - from) : 0;
    put(draft, at, other->bytes + from, size, below(random, 2) == 0);
}

/* The next digit: text that was a number still is one. */
static void change_digit(uint64_t *random, struct draft *draft, size_t at)
{
    while (at < draft->size && (draft->bytes[at] < '0' || draft->bytes[at] > '9'))
        at++;
    if (at < draft->size)
        draft->bytes[at] = (unsigned char)('0' + below(random, 10));
}

static void change(uint64_t *random, struct draft *draft, const struct fuzz_set *set, const struct fuzz_set *words)
{
    const size_t at = below(random, draft->size);
    unsigned char any = (unsigned char)random_bits(random);
    switch (draft->size ? below(random, 12) : 11) {
    case 0:
        draft->bytes[at] ^= (unsigned char)(1 << below(random, 8));
        break;
    case 1:
        draft->bytes[at] = any;
        break;
    case 2:
        draft->bytes[at] = (unsigned char)(draft->bytes[at] + below(random, 9) - 4);
        break;
    case 3:
        put(draft, at, &any, 1, 0);
        break;
    case 4:
        put_number(random, draft, at);
        break;
    case 5:
        repeat(random, draft, at);
        break;
    case 6:
        leave_out(random, draft, at);
        break;
    case 7:
        draft->size = below(random, 4) ? draft->size : at;
        break;
    case 8:
        if (words->count) {
            const struct fuzz_input *word = &words->inputs[below(random, words->count)];
            put(draft, at, word->bytes, word->size, below(random, 3) == 0);
        }
        break;
    case 9:
    case 10:
        change_digit(random, draft, at);
        break;
    default:
        splice(random, draft, at, set);
    }
}

size_t fuzz_mutate(uint64_t *random, const struct fuzz_set *set, const struct fuzz_set *words, unsigned char *out,
                   size_t room)
{
    const struct fuzz_input *input = &set->inputs[below(random, set->count)];
    struct draft draft = { out, input->size < room ? input->size : room, room };
    memcpy(out, input->bytes, draft.size);
    const int digits = below(random, 3) == 0;
    for (size_t changes = 1 + below(random, below(random, 2) ? 2 : 8); changes; changes--)
        if (digits)
            change_digit(random, &draft, below(random, draft.size));
        else
            change(random, &draft, set, words);
    return draft.size;
}
