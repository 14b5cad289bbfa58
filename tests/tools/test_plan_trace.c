/* SPDX-License-Identifier: BSD-3-Clause */
/* Traces of plans: played faster, slower and backwards, with their jumps, and how fast they are. */
#include <math.h>

#include "lib/check.h"
#include "plan/plan_trace.h"

enum { COLUMNS = 7, ROWS = 40 };

/* End a goes along x by 1 mm a row, end b by 2 mm, from 7 and 9 on; row 25 is a jump by 1 m. */
static struct csv_table motion(double values[ROWS * COLUMNS])
{
    for (int i = 0; i < ROWS; i++) {
        double *row = values + COLUMNS * i;
        row[0] = i < 25 ? i : i + 3;
        for (int k = 1; k < COLUMNS; k++)
            row[k] = k == 1 ? 7.0 : k == 4 ? 9.0 : 0.25 * k;
        row[1] += 0.001 * i + (i < 25 ? 0.0 : 1.0);
        row[4] += 0.002 * i + (i < 25 ? 0.0 : 1.0);
    }
    return (struct csv_table){ .values = values, .rows = ROWS, .columns = COLUMNS };
}

/* Where row i of a stretch that begins at `first` is at this pace. */
static void check_stretch(const struct csv_table *played, size_t from, size_t count, double first, double pace,
                          double jump)
{
    for (size_t i = 0; i < count; i++) {
        const double *row = csv_table_row(played, from + i);
        const double place = first + pace * (double)i;
        CHECK(fabs(row[1] - (7.0 + jump + 0.001 * place)) < 1e-12, "row %zu: %.17g", from + i, row[1]);
        CHECK(fabs(row[4] - (9.0 + jump + 0.002 * place)) < 1e-12, "row %zu: %.17g", from + i, row[4]);
        CHECK(row[2] == 0.5 && row[6] == 1.5, "row %zu is elsewhere", from + i);
        CHECK(trace_is_jump(played, from + i) == (i == 0), "row %zu: a jump or none", from + i);
    }
}

static void plays_at_any_pace(void)
{
    static const struct {
        double pace;
        size_t rows[2]; /* of the two stretches, of 25 and 15 rows */
    } cases[] = {
        { 1.0, { 25, 15 } }, { 1.5, { 17, 10 } }, { -1.5, { 17, 10 } }, { 0.25, { 97, 57 } }, { -1.0, { 25, 15 } }
    };
    double values[ROWS * COLUMNS];
    const struct csv_table trace = motion(values);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double pace = cases[i].pace;
        const size_t *rows = cases[i].rows;
        struct csv_table played;
        CHECK(!plan_trace_play(&played, "test", &trace, pace), "%g does not play", pace);
        CHECK(played.rows == rows[0] + rows[1], "%g: %zu rows", pace, played.rows);
        check_stretch(&played, 0, rows[0], pace > 0.0 ? 0.0 : 24.0, pace, 0.0);
        check_stretch(&played, rows[0], rows[1], pace > 0.0 ? 25.0 : 39.0, pace, 1.0);
        csv_table_free(&played);
    }
}

static void speed_is_of_the_faster_end(void)
{
    double values[ROWS * COLUMNS];
    const struct csv_table trace = motion(values);
    CHECK(fabs(plan_trace_speed(&trace, 0.001) - 2.0) < 1e-9, "%g m/s", plan_trace_speed(&trace, 0.001));
    const struct csv_table part = plan_trace_part(&trace, 10, 30);
    CHECK(part.rows == 20 && csv_table_row(&part, 0)[0] == 10.0 && trace_is_jump(&part, 0) && trace_is_jump(&part, 15),
          "the part is another one");
}

int main(void)
{
    TEST(plays_at_any_pace);
    TEST(speed_is_of_the_faster_end);
    return check_report();
}
