/* SPDX-License-Identifier: BSD-3-Clause */
/* What a refusal of JSON must look like. */
#ifndef DPT_TESTS_FUZZ_FAULT_CHECK_H
#define DPT_TESTS_FUZZ_FAULT_CHECK_H

#include <string.h>

#include "fuzz/target.h"
#include "scene/json_value.h"

static inline void check_line(const char *text, size_t room)
{
    MUST(memchr(text, 0, room) != NULL);
    for (; *text; text++)
        MUST(*text >= ' ' && *text <= '~');
}

static inline void check_fault(const struct json_fault *fault, const uint8_t *bytes, size_t size)
{
    int lines = 1;
    for (size_t i = 0; i < size; i++)
        lines += bytes[i] == '\n';
    check_line(fault->place, sizeof fault->place);
    check_line(fault->reason, sizeof fault->reason);
    MUST(fault->reason[0] != '\0');
    MUST(fault->line >= 0 && fault->line <= lines);
    MUST(fault->line ? fault->column > 0 && !fault->place[0] : fault->column == 0);
}

#endif
