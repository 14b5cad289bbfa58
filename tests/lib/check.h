/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The test runner: one program a noun. A test is a function; CHECK counts a failure, says where, and
 * goes on. The last line of a program is "N passed, M failed, K skipped", which tests/run.sh adds up.
 *
 *     static void welds_equal_vertices(void) { CHECK(count == 8, "%u vertices", count); }
 *     int main(int argc, char **argv)
 *     {
 *         TEST(welds_equal_vertices);
 *         return check_report();
 *     }
 */
#ifndef DPT_TESTS_CHECK_H
#define DPT_TESTS_CHECK_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lib/random.h"

static int check_passed, check_failed, check_skipped, check_bad;

/* In a test: assert `condition`, and print the rest, a printf format with arguments, if it fails. */
#define CHECK(condition, ...)                                                                      \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            check_bad++;                                                                           \
            if (check_bad <= 10) {                                                                 \
                printf("    %s:%d: %s: ", __FILE__, __LINE__, #condition);                         \
                printf(__VA_ARGS__);                                                               \
                printf("\n");                                                                      \
            }                                                                                      \
        }                                                                                          \
    } while (0)

#define TEST(function)                                                                             \
    do {                                                                                           \
        check_bad = 0;                                                                             \
        function();                                                                                \
        printf("  %s %s\n", check_bad ? "FAIL" : "ok  ", #function);                               \
        fflush(stdout);                                                                            \
        if (check_bad)                                                                             \
            check_failed++;                                                                        \
        else                                                                                       \
            check_passed++;                                                                        \
    } while (0)

/*
 * How much of its random cases a program runs, in per cent: its first argument. A program that takes one asks part_of of
 * each count that may be cut.
 */
static unsigned check_percent = 100;

static inline void take_percent(int argc, char **argv)
{
    if (argc > 1)
        check_percent = (unsigned)strtoul(argv[1], NULL, 10);
}

static inline uint64_t part_of(uint64_t cases)
{
    const uint64_t share = cases * check_percent / 100;
    return share ? share : 1;
}

/* That so many were seen is asked of a whole run; of a part, that there was one. */
static inline uint64_t least_seen(uint64_t seen)
{
    return check_percent < 100 ? 0 : seen;
}

/* Name what could not be tested here, and why. */
#define SKIP(what, why)                                                                            \
    do {                                                                                           \
        printf("  skip %s: %s\n", what, why);                                                      \
        check_skipped++;                                                                           \
    } while (0)

static inline int check_report(void)
{
    printf("%d passed, %d failed, %d skipped\n", check_passed, check_failed, check_skipped);
    return check_failed ? 1 : 0;
}

#endif
