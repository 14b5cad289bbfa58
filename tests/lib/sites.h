/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which checks of a reader were reached. A program is linked with a copy of the reader's source in which each check
 * that refuses notes its line in `site` (tests.mk), the first one of a call; a check that no damaged file reaches is
 * found by reading the source.
 */
#ifndef DPT_TESTS_SITES_H
#define DPT_TESTS_SITES_H

#include "lib/check.h"

/* The line of the first check that refused in this call; 0 before. */
extern int site;

/* After a call that refused. */
void site_note(void);

/* Every line of `reader` that refuses was noted; there are at least so many. */
void site_expect_all(const char *reader, int least);

#endif
