/* SPDX-License-Identifier: BSD-3-Clause */
#include "lib/check.h"

#include <stdarg.h>

int check_passed, check_failed, check_skipped, check_bad;
unsigned check_percent = 100;

void take_percent(int argc, char **argv)
{
    if (argc > 1)
        check_percent = (unsigned)strtoul(argv[1], NULL, 10);
}

void take_count(int argc, char **argv, unsigned long *count, uint64_t *seed)
{
    if (argc > 1)
        *count = strtoul(argv[1], NULL, 10);
    if (argc > 2)
        *seed = strtoull(argv[2], NULL, 10);
}

int few_of(int cases)
{
    return check_percent < 10 ? 1 : cases;
}

uint64_t part_of(uint64_t cases)
{
    const uint64_t share = cases * check_percent / 100;
    return share ? share : 1;
}

uint64_t least_seen(uint64_t seen)
{
    return check_percent < 100 ? 0 : seen;
}

int check_report(void)
{
    printf("%d passed, %d failed, %d skipped\n", check_passed, check_failed, check_skipped);
    return check_failed ? 1 : 0;
}

void check_fail(const char *file, int line, const char *condition, const char *format, ...)
{
    va_list arguments;
    if (++check_bad > 10)
        return;
    printf("    %s:%d: %s: ", file, line, condition);
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    printf("\n");
}
