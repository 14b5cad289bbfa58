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

/* Of the whole program. check_bad: failures of the test that runs. */
extern int check_passed, check_failed, check_skipped, check_bad;

/* How much of its random cases a program runs, in per cent; 100 until take_percent was called. */
extern unsigned check_percent;

/* In a test: assert `condition`, and print the rest, a printf format with arguments, if it fails. */
#define CHECK(condition, ...)                                                                                          \
    do {                                                                                                               \
        if (!(condition))                                                                                              \
            check_fail(__FILE__, __LINE__, #condition, __VA_ARGS__);                                                   \
    } while (0)

/* A failure at a line. */
void check_fail(const char *file, int line, const char *condition, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

#define TEST(function)                                                                                                 \
    do {                                                                                                               \
        check_bad = 0;                                                                                                 \
        function();                                                                                                    \
        printf("  %s %s\n", check_bad ? "FAIL" : "ok  ", #function);                                                   \
        fflush(stdout);                                                                                                \
        if (check_bad)                                                                                                 \
            check_failed++;                                                                                            \
        else                                                                                                           \
            check_passed++;                                                                                            \
    } while (0)

/*
 * Take the share of random cases from the first argument. A program that has one asks part_of of each count that may
 * be cut.
 */
void take_percent(int argc, char **argv);

/* Take how many cases from the first argument, and the seed from the second; what is not given stays. */
void take_count(int argc, char **argv, unsigned long *count, uint64_t *seed);

/* `cases`, or that share of them; 1 at least. */
uint64_t part_of(uint64_t cases);

/*
 * Of a few cases that are not random all; one where less than a tenth of the random ones is asked for, as under
 * sanitizers, which look at what memory and arithmetic do: answers are for the release build.
 */
int few_of(int cases);

/* That so many were seen is asked of a whole run; of a part, that there was one. */
uint64_t least_seen(uint64_t seen);

/* Name what could not be tested here, and why. */
#define SKIP(what, why)                                                                                                \
    do {                                                                                                               \
        printf("  skip %s: %s\n", what, why);                                                                          \
        check_skipped++;                                                                                               \
    } while (0)

/* Print the last line; what main returns. */
int check_report(void);

#endif
