/* SPDX-License-Identifier: BSD-3-Clause */
#include "lib/sites.h"

int site;

static uint8_t reached[4096]; /* lines */

void site_note(void)
{
    CHECK(site > 0 && site < 4096, "line %d", site);
    reached[site % 4096] = 1;
}

void site_expect_all(const char *reader, int least)
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
        CHECK(number < 4096 && reached[number], "line %d: no damaged file for %s", number, line);
        checks++;
    }
    CHECK(checks >= least, "only %d checks", checks);
    if (stream)
        fclose(stream);
}
