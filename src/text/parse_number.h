/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Decimal numbers from text, without regard to the locale. Correctly rounded.
 *
 * Accepts what C's strtod accepts in the C locale for decimal numbers: sign, digits with or without a
 * point (1, 1., .5, +2.E1, 1e-001). Not hexadecimal, not "inf" or "nan": those are refused as any
 * other word is.
 */
#ifndef DPT_PARSE_NUMBER_H
#define DPT_PARSE_NUMBER_H

#include <stddef.h>
#include <stdint.h>

/* Parse at `text`, not beyond `end`. Returns the first byte after the number, or NULL. */
const char *parse_double(const char *text, const char *end, double *value);

/* An integer of any sign; NULL when there is none or it does not fit. */
const char *parse_int(const char *text, const char *end, int64_t *value);

#endif
