/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Numbers in text, as the mesh readers take them: the nearest double for any count of digits, whatever the locale. The
 * oracle is strtod of the C library. What readers do with the numbers is for test_read.
 */
#include <inttypes.h>
#include <locale.h>
#include <math.h>

#include "compile/reading.h"
#include "text/parse_number.h"

static void same_as_strtod(const char *text)
{
    double ours = -1.0, theirs = strtod(text, NULL);
    size_t length = strlen(text);
    char *copy = malloc(length + 1);
    memcpy(copy, text, length); /* without the zero */
    copy[length] = 'x';
    const char *after = parse_double(copy, copy + length, &ours);
    CHECK(after == copy + length, "%.60s stops early", text);
    CHECK(memcmp(&ours, &theirs, sizeof ours) == 0, "%.60s: %a, not %a", text, ours, theirs);
    free(copy);
}

static void numbers_are_rounded_correctly(void)
{
    char texts[] = "0 -0 +0.0e5 1 1. .5 -.5e1 +2.E1 1e-001 1e22 1e23 1e-22 8.5e-23 0.1e-6 123456789012345678 "
                   "9007199254740992 9007199254740993 9007199254740993.0000000000000000000000000000001 "
                   "9007199254740994.99999999999999999999999999999999999 18446744073709551615 5e-324 "
                   "99999999999999999999 2.4703282292062327e-324 2.4703282292062328e-324 "
                   "2.2250738585072011e-308 1.7976931348623157e308 1.7976931348623158e308 "
                   "1.7976931348623159e308 1e400 -1e400 1e-400 0e99999999999999999999 "
                   "1e99999999999999999999 1e-99999999999999999999 10000000000000000000000000e-25 "
                   "0.000000000000000000000000000000000000000000000000000001e60";
    for (char *text = strtok(texts, " "); text != NULL; text = strtok(NULL, " "))
        same_as_strtod(text);
}

/* Half-way between two doubles by all digits but the last, which is far away. */
static void numbers_of_many_digits(void)
{
    static char text[5000];
    for (size_t zeros = 700; zeros < 900; zeros++) {
        strcpy(text, "9007199254740993.");
        fill_text(text + 17, '0', zeros);
        same_as_strtod(text);
        strcat(text, "1");
        same_as_strtod(text);
        strcat(text, "e-300");
        same_as_strtod(text);
        fill_text(text, '7', zeros);
        strcat(text, ".5e-700");
        same_as_strtod(text);
    }
    uint64_t seed = 3;
    for (int i = 0; i < 300; i++) {
        double a = random_in(&seed, 0.0, 1.0) * (i % 2 ? 0x1p-1022 : 0x1p-900), b;
        uint64_t bits;
        memcpy(&bits, &a, sizeof bits);
        bits++;
        memcpy(&b, &bits, sizeof b);
        long double half = ((long double)a + (long double)b) / 2.0L;
        snprintf(text, sizeof text, "%.*Lf", 1080 + i, half);
        same_as_strtod(text);
        strcat(text, "1");
        same_as_strtod(text);
    }
}

static void numbers_round_trip(void)
{
    uint64_t seed = 7;
    char text[400];
    for (int i = 0; i < 100000; i++) {
        uint64_t bits = random_bits(&seed);
        double number;
        memcpy(&number, &bits, sizeof number);
        if (i % 2)
            number = random_in(&seed, -1000.0, 1000.0);
        if (!isfinite(number))
            continue;
        snprintf(text, sizeof text, "%.17g", number);
        same_as_strtod(text);
        snprintf(text, sizeof text, "%.25g", number);
        same_as_strtod(text);
        snprintf(text, sizeof text, "%.*g", 1 + i % 12, number);
        same_as_strtod(text);
    }
}

static void numbers_end_where_they_end(void)
{
    static const struct {
        const char *text;
        int length; /* of the number; -1 when it is none */
    } cases[] = { { "1e", 1 },     { "1e+", 1 },  { "1e-x", 1 }, { "1.5.5", 3 }, { "0x10", 1 },  { "1,5", 1 },
                  { "3.1+e2", 3 }, { "", -1 },    { "-", -1 },   { ".", -1 },    { "-.e5", -1 }, { "e5", -1 },
                  { "nan", -1 },   { "inf", -1 }, { " 1", -1 },  { "+-1", -1 },  { "1e5", 3 } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double value;
        const char *text = cases[i].text, *after = parse_double(text, text + strlen(text), &value);
        CHECK((after == NULL ? -1 : (int)(after - text)) == cases[i].length, "'%s'", text);
    }
    double value = 0.0;
    const char *text = "12345";
    CHECK(parse_double(text, text + 3, &value) == text + 3 && value == 123.0, "%g", value);
}

static void integers(void)
{
    static const struct {
        const char *text;
        int64_t value;
        int length;
    } cases[] = { { "-17", -17, 3 },
                  { "+8/2", 8, 2 },
                  { "007x", 7, 3 },
                  { "", 0, -1 },
                  { "9223372036854775807", INT64_MAX, 19 },
                  { "x", 0, -1 },
                  { "-", 0, -1 },
                  { "9223372036854775808", 0, -1 },
                  { "-9223372036854775807", -INT64_MAX, 20 } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        int64_t value = 0;
        const char *text = cases[i].text, *after = parse_int(text, text + strlen(text), &value);
        CHECK((after == NULL ? -1 : (int)(after - text)) == cases[i].length, "'%s'", text);
        CHECK(value == cases[i].value, "'%s' is %" PRId64, text, value);
    }
}

static void numbers_in_a_comma_locale(void)
{
    double value = 0.0;
    reading r;
    const char *text = "0.1234567890123456789012345e1";
    CHECK(parse_double(text, text + strlen(text), &value) != NULL && value == 0x1.3c0ca428c59fbp+0, "%a", value);
    read_string(&r, DPT_FORMAT_OBJ, "v 0.5 -1234.56789012345678901234 1.5\n");
    CHECK(r.result == DPT_OK && r.soup.positions[0] == 0.5f && r.soup.positions[1] == -1234.56789012345678901234f, "%g",
          (double)r.soup.positions[1]);
    soup_free(&r.soup);
}

static int set_comma_locale(void)
{
    char names[] = "de_DE.UTF-8 de_DE.utf8 de_DE fr_FR.UTF-8 fr_FR.utf8 nl_NL.UTF-8 es_ES.UTF-8";
    for (char *name = strtok(names, " "); name != NULL; name = strtok(NULL, " ")) {
        if (setlocale(LC_NUMERIC, name) != NULL && localeconv()->decimal_point[0] == ',')
            return 1;
    }
    return 0;
}

int main(void)
{
    TEST(numbers_are_rounded_correctly);
    TEST(numbers_of_many_digits);
    TEST(numbers_round_trip);
    TEST(numbers_end_where_they_end);
    TEST(integers);
    if (set_comma_locale())
        TEST(numbers_in_a_comma_locale);
    else
        SKIP("numbers_in_a_comma_locale", "no locale with a decimal comma is installed");
    return check_report();
}
