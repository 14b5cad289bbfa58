/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Decimal numbers from text. They are correctly rounded and do not depend on the locale.
 *
 * These functions accept the decimal numbers that strtod accepts in the C locale: a sign, digits with or without a
 * point, an exponent (1, 1., .5, +2.E1, 1e-001). They accept neither hexadecimal numbers nor "inf" or "nan".
 */
#ifndef DPT_PARSE_NUMBER_H
#define DPT_PARSE_NUMBER_H

#include <stddef.h>
#include <stdint.h>

/*
 * Parse a number at `text`, reading no further than `end`. Returns the first byte after it, or NULL if there is none.
 */
const char *parse_double(const char *text, const char *end, double *value);

/* Parse an integer of either sign. Returns the first byte after it, or NULL if there is none or it does not fit. */
const char *parse_int(const char *text, const char *end, int64_t *value);

#endif
