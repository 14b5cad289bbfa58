/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The parts of a chart: axes with round marks, lines of any length in bounded memory that lose no peak, and labels that
 * cover nothing.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lib/check.h"
#include "plot/plot_axis.h"
#include "plot/plot_scatter.h"

enum { AXES = 20000, POINTS = 1000000 };

/* A step is 1, 2 or 5 times a power of ten if a decimal of one digit names it. */
static int is_round(double step)
{
    char digits[16];
    snprintf(digits, sizeof digits, "%.9e", step);
    return strchr("125", digits[0]) && strspn(digits + 2, "0") == 9;
}

static void one_axis(double low, double high, int is_whole)
{
    const struct plot_axis axis = plot_axis_make(low, high, 100.0, 700.0, 6, is_whole);
    const double from = low / axis.scale, to = high / axis.scale;
    const double slack = 1e-9 * (axis.high - axis.low) + 1e-12 * fmax(fabs(from), fabs(to));
    char before[PLOT_LABEL_ROOM] = "", label[PLOT_LABEL_ROOM];
    int marks = 0;
    CHECK(axis.low <= from + slack && axis.high >= to - slack, "%g to %g: outside the axis", low, high);
    CHECK(is_whole || axis.low == from, "%g to %g: begins at %g", low, high, axis.low);
    CHECK(is_round(axis.step), "%g to %g: step %.17g", low, high, axis.step);
    CHECK(fabs(plot_axis_at(&axis, axis.low * axis.scale) - 100.0) < 1e-6 &&
              fabs(plot_axis_at(&axis, axis.high * axis.scale) - 700.0) < 1e-6,
          "%g to %g: not on its pixels", low, high);
    for (double i = axis.first; i <= axis.last; i++) {
        marks++;
        CHECK(i * axis.step >= axis.low - slack && i * axis.step <= axis.high + slack, "%g to %g: mark %g is outside",
              low, high, i * axis.step);
        plot_axis_label(&axis, i, label);
        CHECK(strcmp(label, before) && fabs(atof(label) - i * axis.step) < 1e-3 * axis.step, "%g to %g: %s after %s",
              low, high, label, before);
        memcpy(before, label, sizeof before);
    }
    CHECK(marks >= 2 && marks <= 8, "%g to %g: %d marks", low, high, marks);
}

static void axes_have_round_marks(void)
{
    uint64_t seed = 1;
    for (int i = 0; i < AXES; i++) {
        const double size = pow(10.0, random_in(&seed, -9.0, 9.0));
        const double low = random_in(&seed, -size, size);
        const double length = pow(10.0, random_in(&seed, -3.0, 0.0)) * size;
        one_axis(low, low + length, i % 2);
    }
    one_axis(0.0, 1.0, 1);
    one_axis(-1.0, 0.0, 1);
    CHECK(!signbit(plot_axis_make(-1e-30, 8.0, 0.0, 1.0, 8, 0).first), "a mark at -0");
}

static void prefixes_follow_the_size(void)
{
    static const struct {
        double max;
        const char *prefix;
    } cases[] = { { 1.0, "" },    { 0.999, "m" }, { 1e-3, "m" }, { 0.999e-3, "u" }, { 1e-9, "n" },
                  { 1e-12, "p" }, { 1e-15, "p" }, { 1e6, "" },   { -0.05, "m" },    { 0.0, "m" } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double max = cases[i].max;
        const struct plot_axis axis = plot_axis_make(fmin(max, 0.0), fmax(max, 0.0), 0, 1, 4, 1);
        CHECK(!strcmp(axis.prefix, cases[i].prefix), "%g has prefix '%s'", max, axis.prefix);
    }
}

/* Steps of very different length, values with rare peaks; what is kept has all extremes of every block of points. */
/* Without exponents, and what is less than an atto is nothing. */
static void numbers_are_as_people_read_them(void)
{
    static const struct {
        double value;
        int digits;
        const char *unit, *text;
    } numbers[] = { { 4.3e-15, 2, NULL, "0" },      { 100.0, 2, NULL, "100" },     { 123.4, 2, NULL, "123" },
                    { 0.01234, 2, NULL, "0.012" },  { 0.5, 3, NULL, "0.5" },       { 9.996, 3, NULL, "10" },
                    { -1.234, 2, NULL, "-1.2" },    { 7.9e-3, 3, "s", "7.9 ms" },  { 4.3e-18, 3, "m", "4.3 am" },
                    { 4.3e-20, 3, "m", "0 m" },     { 0.0, 3, "N", "0 N" },        { 31.3, 3, "%", "31.3 %" },
                    { 0.0123, 3, "%", "0.0123 %" }, { 1.24e4, 3, "m", "12400 m" }, { 4.31e-7, 3, "s", "431 ns" },
                    { 0.00107, 3, "m", "1.07 mm" } };
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        char text[PLOT_NUMBER_ROOM];
        if (numbers[i].unit)
            plot_quantity(numbers[i].value, numbers[i].digits, numbers[i].unit, text);
        else
            plot_number(numbers[i].value, numbers[i].digits, text);
        CHECK(!strcmp(text, numbers[i].text), "%g is '%s', not '%s'", numbers[i].value, text, numbers[i].text);
    }
}

static void long_line(uint64_t seed)
{
    struct plot_line line;
    double *x = malloc(POINTS * sizeof *x), *y = malloc(POINTS * sizeof *y);
    if (!x || !y || !plot_line_init(&line))
        abort();
    double now = random_in(&seed, 0.0, 10.0);
    uint64_t points = 0;
    for (int i = 0; i < POINTS; i++) {
        const int is_far = random_in(&seed, 0.0, 1.0) < 1e-5;
        const int is_peak = random_in(&seed, 0.0, 1.0) < 1e-4;
        now += is_far ? 50.0 : random_in(&seed, 0.0, 2e-3);
        x[i] = now;
        y[i] = random_in(&seed, -1.0, 1.0) * (is_peak ? 100.0 : 1.0);
        plot_line_add(&line, x[i], y[i]);
    }
    const double length = x[POINTS - 1] - x[0];
    CHECK(line.count <= PLOT_GROUPS_MAX, "%zu groups", line.count);
    for (size_t i = 0, at = 0; i < line.count; i++) {
        const struct plot_group *group = &line.groups[i];
        double low = INFINITY, high = -INFINITY;
        CHECK(group->first.x == x[at] && group->first.y == y[at], "group %zu begins elsewhere", i);
        for (uint64_t k = 0; k < group->points; k++, at++) {
            low = fmin(low, y[at]);
            high = fmax(high, y[at]);
        }
        CHECK(group->low.y == low && group->high.y == high, "group %zu: %g to %g, not %g to %g", i, group->low.y,
              group->high.y, low, high);
        CHECK(group->last.x == x[at - 1], "group %zu ends elsewhere", i);
        CHECK(group->points == 1 || group->last.x - group->first.x < length / 2000.0, "group %zu is %g wide", i,
              group->last.x - group->first.x);
        points += group->points;
    }
    CHECK(points == POINTS, "%llu points", (unsigned long long)points);
    plot_line_free(&line);
    free(x);
    free(y);
}

static void what_is_no_number_breaks_a_line(void)
{
    struct plot_line line;
    static const double values[] = { 1.0, NAN, 2.0, 3.0, INFINITY, -INFINITY, 2e30, 4.0, 1e30 };
    static const int starts[] = { 1, 1, 0, 1, 0 };
    if (!plot_line_init(&line))
        abort();
    for (int i = 0; i < 9; i++)
        plot_line_add(&line, i, values[i]);
    CHECK(line.count == 5, "%zu points", line.count);
    for (size_t i = 0; i < line.count && i < 5; i++)
        CHECK(line.groups[i].is_start == starts[i], "point %zu: %d", i, line.groups[i].is_start);
    plot_line_free(&line);
}

static void long_lines_lose_no_peak(void)
{
    for (uint64_t seed = 1; seed <= 3; seed++)
        long_line(seed);
}

/* What a label of a logarithmic axis says. */
static double label_value(const char *label, const char *unit)
{
    static const char prefixes[] = "munpfa";
    char *end;
    double value = strtod(label, &end);
    const size_t rest = strlen(end) - strlen(unit);
    const char *prefix = strchr(prefixes, end[1]);
    for (const char *p = prefixes; rest == 2 && p <= prefix; p++)
        value *= 1e-3;
    return end[0] == ' ' && atof(label) >= 1.0 && !strcmp(end + rest, unit) && rest <= 2 ? value : NAN;
}

static void log_axes_have_round_marks(void)
{
    uint64_t seed = 1;
    for (int i = 0; i < AXES; i++) {
        const double low = pow(10.0, random_in(&seed, -14.0, 2.0));
        const double high = low * pow(10.0, random_in(&seed, 0.0, 9.0));
        const double room = random_in(&seed, 20.0, 60.0);
        const struct plot_log_axis axis = plot_log_axis_make(low, high, 600.0, 50.0, room);
        double before = 0.0, at_before = NAN;
        int marks = 0;
        CHECK(axis.low <= low * (1.0 + 1e-8) && axis.high >= high * (1.0 - 1e-8) && axis.high >= 9.99 * axis.low,
              "%g to %g: the axis is %g to %g", low, high, axis.low, axis.high);
        CHECK(fabs(plot_log_axis_at(&axis, axis.low) - 600.0) < 1e-6 &&
                  fabs(plot_log_axis_at(&axis, axis.high) - 50.0) < 1e-6 &&
                  fabs(plot_log_axis_at(&axis, sqrt(axis.low * axis.high)) - 325.0) < 1e-6,
              "%g to %g: not on its pixels", low, high);
        for (double mark = 0.0; (mark = plot_log_axis_next(&axis, mark)) > 0.0; before = mark) {
            char label[PLOT_MARK_ROOM];
            const double at = plot_log_axis_at(&axis, mark);
            marks++;
            CHECK(is_round(mark) && mark > before && at <= 600.0 + 1e-6 && at >= 50.0 - 1e-6, "%g to %g: a mark at %g",
                  low, high, mark);
            /* 1 to 2, of 1, 2 and 5, is the least step. */
            CHECK(isnan(at_before) || at_before - at > 0.9 * room, "%g px for %g", at_before - at, room);
            at_before = at;
            plot_log_axis_label(mark, "m", label);
            CHECK(fabs(label_value(label, "m") - mark) < 1e-6 * mark, "%g is '%s'", mark, label);
        }
        CHECK(marks >= 1, "%g to %g: no mark", low, high);
    }
}

static int boxes_meet(const struct label_box *a, const struct label_box *b)
{
    return a->left < b->right && b->left < a->right && a->top < b->bottom && b->top < a->bottom;
}

/* Marks here and there, and a line: what is placed covers nothing, and most is placed. */
static void labels_cover_nothing(void)
{
    enum { PICTURES = 300, MARKS = 20, LINE_Y = 100 };
    uint64_t seed = 7;
    int placed = 0;
    struct label_places *places = malloc(sizeof *places);
    for (int i = 0; places && i < PICTURES; i++) {
        struct label_box marks[MARKS], boxes[MARKS];
        const struct label_box line = { 0.0, LINE_Y, 600.0, LINE_Y };
        int count = 0;
        *places = (struct label_places){ .room = { 0.0, 0.0, 600.0, 200.0 } };
        label_places_take_line(places, line.left, line.top, line.right, line.bottom);
        for (int k = 0; k < MARKS; k++) {
            const double x = random_in(&seed, 10.0, 590.0), y = random_in(&seed, 10.0, 190.0);
            marks[k] = (struct label_box){ x - 5.0, y - 5.0, x + 5.0, y + 5.0 };
            label_places_take(places, marks[k]);
        }
        for (int k = 0; k < MARKS; k++) {
            double leader[2];
            const double x = marks[k].left + 5.0, y = marks[k].top + 5.0;
            const struct label_mark mark = { x, y, 5.0, random_in(&seed, 20.0, 90.0), 13.0 };
            if (!label_places_find(places, &mark, &boxes[count], leader))
                continue;
            const struct label_box *box = &boxes[count++];
            CHECK(box->left >= 0.0 && box->right <= 600.0 && box->top >= 0.0 && box->bottom <= 200.0,
                  "a label outside");
            CHECK(!(box->top < LINE_Y && box->bottom > LINE_Y), "a label on the line");
            CHECK((leader[0] == x && leader[1] == y) || (leader[0] >= box->left && leader[0] <= box->right &&
                                                         leader[1] >= box->top && leader[1] <= box->bottom),
                  "a leader that ends nowhere");
            for (int j = 0; j < MARKS; j++)
                CHECK(!boxes_meet(box, &marks[j]), "a label on a mark");
            for (int j = 0; j + 1 < count; j++)
                CHECK(!boxes_meet(box, &boxes[j]), "a label on a label");
        }
        placed += count;
    }
    CHECK(placed > PICTURES * MARKS * 9 / 10, "%d of %d labels found room", placed, PICTURES * MARKS);
    free(places);
}

int main(void)
{
    TEST(axes_have_round_marks);
    TEST(prefixes_follow_the_size);
    TEST(numbers_are_as_people_read_them);
    TEST(what_is_no_number_breaks_a_line);
    TEST(long_lines_lose_no_peak);
    TEST(log_axes_have_round_marks);
    TEST(labels_cover_nothing);
    return check_report();
}
