/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Decimal numbers (parse_number.h). Most numbers of a mesh file have few digits and a small exponent. They take one
 * multiplication or division of two exact doubles, which rounds once and so correctly. The others are rewritten as an
 * integer with an exponent and go through strtod: such a text means the same in every locale.
 */
#include <stdio.h>
#include <stdlib.h>

#include "text/parse_number.h"

/* All powers of ten that a double holds exactly. */
static const double powers_of_ten[23] = { 1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                          1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22 };

enum {
    MANTISSA_DIGITS = 19, /* so many always fit in 64 bits */
    /* A point half-way between two doubles has at most 767 significant digits. Of all later digits it only matters
     * whether they are all zero. */
    DECIDING_DIGITS = 800
};

/* Beyond this exponent, any number of DECIDING_DIGITS digits is zero or infinity. */
#define EXPONENT_FAR 20000

/* A number in the text, and what scanning its digits found. */
typedef struct decimal {
    const char *digits, *digits_end; /* including the point, if any */
    uint64_t mantissa;               /* the first MANTISSA_DIGITS significant digits */
    int64_t exponent;                /* the number is all digits, read as an integer, times 10^exponent */
    size_t significant_digits;
} decimal;

static int is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static const char *parse_sign(const char *text, const char *end, int *is_negative)
{
    *is_negative = text < end && *text == '-';
    return text < end && (*text == '-' || *text == '+') ? text + 1 : text;
}

/* Read the digits before the exponent. Returns their end, or NULL if there is none. */
static const char *scan_digits(const char *at, const char *end, decimal *number)
{
    int has_point = 0, has_digit = 0;
    number->digits = at;
    for (; at < end; at++) {
        if (*at == '.' && !has_point) {
            has_point = 1;
            continue;
        }
        if (!is_digit(*at))
            break;
        has_digit = 1;
        number->exponent -= has_point;
        if (*at == '0' && number->significant_digits == 0)
            continue;
        if (number->significant_digits++ < MANTISSA_DIGITS)
            number->mantissa = number->mantissa * 10 + (uint64_t)(*at - '0');
    }
    number->digits_end = at;
    return has_digit ? at : NULL;
}

/* Read the exponent, if any. An e without a digit after it is not part of the number. Returns the end. */
static const char *scan_exponent(const char *at, const char *end, decimal *number)
{
    if (at == end || (*at != 'e' && *at != 'E'))
        return at;
    int is_negative;
    const char *digit = parse_sign(at + 1, end, &is_negative);
    if (digit == end || !is_digit(*digit))
        return at;
    int64_t exponent = 0;
    for (; digit < end && is_digit(*digit); digit++) {
        if (exponent < INT64_MAX / 100)
            exponent = exponent * 10 + (*digit - '0');
    }
    number->exponent += is_negative ? -exponent : exponent;
    return digit;
}

/* Convert with one rounding. Returns 0 if the number has too many digits or too large an exponent for that. */
static int convert_exact(const decimal *number, double *value)
{
    if (number->mantissa == 0) {
        *value = 0.0;
        return 1;
    }
    if (number->significant_digits > MANTISSA_DIGITS || number->mantissa > (UINT64_C(1) << 53) ||
        number->exponent < -22 || number->exponent > 22)
        return 0;
    if (number->exponent < 0)
        *value = (double)number->mantissa / powers_of_ten[-number->exponent];
    else
        *value = (double)number->mantissa * powers_of_ten[number->exponent];
    return 1;
}

/* Convert any number by strtod. Digits after DECIDING_DIGITS become one digit 1, unless all of them are zero. */
static double convert_any(const decimal *number)
{
    char buffer[DECIDING_DIGITS + 32];
    size_t length = 0;
    int64_t dropped = 0;
    int has_remainder = 0;
    for (const char *at = number->digits; at < number->digits_end; at++) {
        if (*at == '.' || (*at == '0' && length == 0))
            continue;
        if (length < DECIDING_DIGITS) {
            buffer[length++] = *at;
            continue;
        }
        dropped++;
        has_remainder = has_remainder || *at != '0';
    }
    if (has_remainder) {
        buffer[length++] = '1';
        dropped--;
    }
    int64_t exponent = number->exponent + dropped;
    if (exponent > EXPONENT_FAR)
        exponent = EXPONENT_FAR;
    if (exponent < -EXPONENT_FAR)
        exponent = -EXPONENT_FAR;
    snprintf(buffer + length, sizeof buffer - length, "e%d", (int)exponent);
    return strtod(buffer, NULL);
}

const char *parse_double(const char *text, const char *end, double *value)
{
    decimal number = { NULL, NULL, 0, 0, 0 };
    int is_negative;
    const char *at = scan_digits(parse_sign(text, end, &is_negative), end, &number);
    if (!at)
        return NULL;
    at = scan_exponent(at, end, &number);
    if (!convert_exact(&number, value))
        *value = convert_any(&number);
    if (is_negative)
        *value = -*value;
    return at;
}

const char *parse_int(const char *text, const char *end, int64_t *value)
{
    int is_negative;
    int64_t number = 0;
    const char *at = parse_sign(text, end, &is_negative);
    if (at == end || !is_digit(*at))
        return NULL;
    for (; at < end && is_digit(*at); at++) {
        int digit = *at - '0';
        if (number > (INT64_MAX - digit) / 10)
            return NULL;
        number = number * 10 + digit;
    }
    *value = is_negative ? -number : number;
    return at;
}
