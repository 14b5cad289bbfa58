/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The self-test: whether a device, and the driver behind it, keep the contract of driver.h as far as that shows from
 * outside. For those who write a driver or firmware; `dynpoint device selftest` is this. docs/drivers.md, "Self-test",
 * has what each line asks and what it cannot find.
 *
 *     dpt_selftest_def def;
 *     dpt_selftest_counts counts = { .size = sizeof counts };
 *     dpt_selftest_def_init(&def);
 *     def.may_move = 1;
 *     def.report = print_line;
 *     result = dpt_driver_selftest(&my_driver, "/dev/mine", &def, &counts);
 *     passed = result == DPT_OK && counts.failed == 0;
 *
 * Threads: as a loop's (loop.h): the device belongs to the thread that tests it, which is that of the report too.
 */
#ifndef DYNPOINT_SELFTEST_H
#define DYNPOINT_SELFTEST_H

#include "dynpoint/driver.h"

DPT_BEGIN

/* What is said of a line. */
enum {
    DPT_SELFTEST_FAILED = 0,
    DPT_SELFTEST_PASSED = 1,
    DPT_SELFTEST_NOTE =
        2 /* what could not be tested, or a person has to judge: `measured` is 0, `unit` "" */
};

/* A line of the report. The library fills it in; its size is that of the library that runs. */
typedef struct dpt_selftest_line {
    uint32_t size;
    uint32_t verdict; /* DPT_SELFTEST_PASSED ... */
    double measured;
    const char *what; /* was asked, "samples at its rate"; for the time of the call */
    const char *unit; /* of what was measured, "Hz", or "" */
} dpt_selftest_line;

/* Called for each line as soon as it is known. Return 0 to go on; anything else ends the test with DPT_E_CANCELLED. */
typedef int dpt_selftest_fn(void *user, const dpt_selftest_line *line);

/* dpt_selftest_def_init fills in the defaults, given last. */
typedef struct dpt_selftest_def {
    uint32_t size;       /* sizeof(dpt_selftest_def), set by dpt_selftest_def_init */
    uint32_t may_move;   /* 1: it may push the hand; 0: nothing is moved, and no force tested; 0 */
    double seconds;      /* to watch the device, 0.1..3600; 1 */
    double rate;         /* of reads, Hz, 1..1e6; 0: twice the device's; 0 */
    double push;         /* of the greatest force, 0.001..1; 0.05 */
    double push_seconds; /* of each push, 0.01..1; 0.05 */
    dpt_selftest_fn *report; /* may be NULL */
    void *user;              /* its first argument; NULL */
} dpt_selftest_def;

/* How many lines said what. */
typedef struct dpt_selftest_counts {
    uint32_t size; /* sizeof(dpt_selftest_counts), set by the caller */
    uint32_t passed;
    uint32_t failed;
    uint32_t notes;
} dpt_selftest_counts;

/* Fill in the first `size` bytes; what dpt_selftest_def_init calls with its own caller's sizeof. */
DPT_API void dpt_selftest_def_defaults(dpt_selftest_def *def, size_t size);

static inline void dpt_selftest_def_init(dpt_selftest_def *def)
{
    dpt_selftest_def_defaults(def, sizeof *def);
}

/*
 * Test a device that is open, and ready; it stays open, without force. Takes def->seconds, and 2 s more where it may
 * move.
 *   def     NULL: the defaults
 *   counts  what the test came to: it is passed when none failed
 *
 * DPT_OK          it ran to its end
 * DPT_E_CANCELLED the report asked to stop; there is no force
 * DPT_E_SYSTEM    there is no clock to go by
 */
DPT_API dpt_result dpt_device_selftest(dpt_device *device, const dpt_selftest_def *def,
                                       dpt_selftest_counts *counts);

/*
 * The same from open to close, by the driver: also that it opens again, and where it may move, that a close ends a
 * force that is given.
 *   where   may be NULL
 *
 * What dpt_device_open_with answered, when the device does not open: then that is the last line, as failed.
 */
DPT_API dpt_result dpt_driver_selftest(const dpt_driver *driver, const char *where,
                                       const dpt_selftest_def *def, dpt_selftest_counts *counts);

DPT_END

#endif
