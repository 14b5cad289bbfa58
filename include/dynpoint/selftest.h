/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The self-test checks whether a device and its driver keep the contract of driver.h, as far as this shows from
 * outside. It is for those who write a driver or firmware. The command `dynpoint device selftest` runs it.
 * docs/drivers.md, "Self-test", says what each line checks and what the test cannot find.
 *
 *     dpt_selftest_def def;
 *     dpt_selftest_counts counts = { .size = sizeof counts };
 *     dpt_selftest_def_init(&def);
 *     def.may_move = 1;
 *     def.report = print_line;
 *     result = dpt_driver_selftest(&my_driver, "/dev/mine", &def, &counts);
 *     passed = result == DPT_OK && counts.failed == 0;
 *
 * Threads: the device belongs to the thread that tests it, as in a loop (loop.h). The report function is called in that
 * thread.
 */
#ifndef DYNPOINT_SELFTEST_H
#define DYNPOINT_SELFTEST_H

#include "dynpoint/driver.h"

DPT_BEGIN

/* dpt_selftest_line.verdict */
enum {
    DPT_SELFTEST_FAILED = 0,
    DPT_SELFTEST_PASSED = 1,
    /* Something that could not be tested, or that a person must judge; `measured` is 0 and `unit` is "". */
    DPT_SELFTEST_NOTE = 2
};

/* A line of the report. The library fills it in; `size` is that of the library that runs. */
typedef struct dpt_selftest_line {
    uint32_t size;
    uint32_t verdict; /* DPT_SELFTEST_... */
    double measured;  /* the measured value */
    const char *what; /* what was checked, as "samples at its rate"; valid during the call */
    const char *unit; /* unit of `measured`, as "Hz", or ""; valid during the call */
} dpt_selftest_line;

/* Called for each line as soon as its result is known. Return 0 to go on; any other value ends the test. */
typedef int dpt_selftest_fn(void *user, const dpt_selftest_line *line);

/* How to test. dpt_selftest_def_init fills in the defaults, which are given last below. */
typedef struct dpt_selftest_def {
    uint32_t size;           /* sizeof(dpt_selftest_def), set by dpt_selftest_def_init */
    uint32_t may_move;       /* 1: the test may push the hand; 0: it tests no force; 0 */
    double seconds;          /* how long to watch the device, s, 0.1..3600; 1 */
    double rate;             /* of reads, Hz, 1..1e6; 0: twice the device's rate; 0 */
    double push;             /* strength of a push, as a fraction of force_max, 0.001..1; 0.05 */
    double push_seconds;     /* duration of each push, s, 0.01..1; 0.05 */
    dpt_selftest_fn *report; /* called for each line; may be NULL */
    void *user;              /* first argument of `report`; NULL */
} dpt_selftest_def;

/* How many lines had each verdict. The test is passed if `failed` is 0. */
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
 * Test an open, ready device. It stays open, without force. Takes def->seconds, and 2 s more if may_move is 1.
 *   def      NULL: the defaults
 *   counts   the result
 *
 * DPT_OK           the test ran to its end
 * DPT_E_CANCELLED  the report function ended the test; there is no force
 * DPT_E_SYSTEM     there is no usable clock
 */
DPT_API dpt_result dpt_device_selftest(dpt_device *device, const dpt_selftest_def *def, dpt_selftest_counts *counts);

/*
 * The same from open to close, by a driver. It also tests that the device opens again and, if may_move is 1, that close
 * ends a force.
 *   where   may be NULL
 *
 * If the device does not open, the last line is that failure, and the result is that of dpt_device_open_with.
 */
DPT_API dpt_result dpt_driver_selftest(const dpt_driver *driver, const char *where, const dpt_selftest_def *def,
                                       dpt_selftest_counts *counts);

DPT_END

#endif
