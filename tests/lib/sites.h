/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which checks of a reader were reached. A program is linked with a copy of the reader's source in which each check that
 * refuses notes its line in `site` (tests.mk), the first one of a call; a check that no damaged file reaches is found by
 * reading the source.
 */
#ifndef DPT_TESTS_SITES_H
#define DPT_TESTS_SITES_H

#include "lib/check.h"

int site;

static uint8_t site_reached[4096]; /* lines */

/* After a call that refused. */
static inline void site_note(void)
{
    CHECK(site > 0 && site < 4096, "line %d", site);
    site_reached[site % 4096] = 1;
}

/* Every line of `reader` that refuses was noted; there are at least so many. */
static inline void site_expect_all(const char *reader, int least)
{
    char line[1024];
    int number = 0, checks = 0;
    FILE *stream = fopen(reader, "r");
    CHECK(stream != NULL, "%s cannot be read", reader);
    while (stream && fgets(line, sizeof line, stream)) {
        number++;
        if (!strstr(line, "fail(") && !strstr(line, "fail_at("))
            continue;
        if (!strncmp(line, "static", 6) || strstr(line, "fail(fault, code, "))
            continue; /* the two functions themselves */
        CHECK(strstr(line, "return fail"), "line %d refuses in a way of its own", number);
        CHECK(number < 4096 && site_reached[number], "line %d: no damaged file for %s", number,
              line);
        checks++;
    }
    CHECK(checks >= least, "only %d checks", checks);
    if (stream)
        fclose(stream);
}

#endif
