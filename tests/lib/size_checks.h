/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The rule of base.h for structs that begin with their size, asked of one function: with the first release's size,
 * today's, and 8 bytes more. What the fields mean is for other tests.
 */
#ifndef DPT_TESTS_SIZE_CHECKS_H
#define DPT_TESTS_SIZE_CHECKS_H

#include <stddef.h>

#include "dynpoint/result.h"
#include "lib/check.h"

enum { SIZED_ROOM = 2048, FAR_TOO_LARGE = 4104 };

struct sized {
    const char *name;
    size_t first, today;
    dpt_result (*call)(void *given);
};

/* What the library fills: the same twice, as far as it goes. */
void check_output(const struct sized *of);

/* What the library takes; `good` is one of today's. */
void check_input(const struct sized *of, const void *good);

/* A def's _defaults: of a size that is none nothing is written; one that is whole or larger is then taken. */
void check_defaults(const struct sized *of, void (*fill_in)(void *, size_t), const void *whole);

#endif
