/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint stability: the laboratory of force (lab/lab.h). */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cli/command_options.h"
#include "cli/commands.h"
#include "lab/lab.h"

static const char help[] =
    "usage: dynpoint stability [CASE...] [options]\n"
    "\n"
    "Breaks methods of force on purpose: the proxy and the bed of this library, the paper's push at one\n"
    "point, and a proxy of one point as other toolkits have it. Each case says what was measured and what\n"
    "is allowed. docs/stability.md has the results. Exit status 1 if the proxy breaks a limit.\n"
    "\n"
    "  CASE         some of them; default: 35 cases, all but hum, which runs only where it is named\n"
    "  --list       the cases' names and titles\n"
    "  --effort E   share of the places and ticks, above 0, at most 1; default 0.25, about a minute of\n"
    "               processor time; docs/stability.md is of 1, which takes four times as long\n"
    "  --json       one JSON object a line for each case, with the points of its charts\n";

enum { CASES_MAX = 64 };

#define EFFORT_USUAL 0.25

static const struct lab_case *find_case(const char *name)
{
    for (const struct lab_case *const *which = lab_cases; *which; which++)
        if (!strcmp((*which)->name, name))
            return *which;
    return NULL;
}

static int is_note(const struct lab_figure *figure)
{
    return fabs(figure->limit) == HUGE_VAL;
}

static const char *verdict_of(const struct lab_figure *figure)
{
    return is_note(figure) ? "" : lab_figure_holds(figure) ? "holds" : "fails";
}

static void print_cell(const struct lab_cell *cell, size_t width)
{
    if (cell->word)
        printf(" %-*s", (int)width, cell->word);
    else if (isnan(cell->number))
        printf(" %*s", (int)width, "-");
    else
        printf(" %*.4g", (int)width, cell->number);
}

/* Columns are as wide as their names, and words in them. */
static void print_rows(const struct lab *lab)
{
    size_t width[LAB_COLUMNS_MAX];
    for (size_t k = 0; lab->columns[k]; k++) {
        width[k] = strlen(lab->columns[k]) > 6 ? strlen(lab->columns[k]) : 6;
        for (size_t i = 0; i < lab->row_count; i++) {
            const char *word = lab->rows[i][k].word;
            if (word && strlen(word) > width[k])
                width[k] = strlen(word);
        }
        printf(" %-*s", (int)width[k], lab->columns[k]);
    }
    putchar('\n');
    for (size_t i = 0; i < lab->row_count; i++) {
        for (size_t k = 0; lab->columns[k]; k++)
            print_cell(&lab->rows[i][k], width[k]);
        putchar('\n');
    }
}

static void print_table(const struct lab *lab, const struct lab_case *which)
{
    printf("%s: %s\n", which->name, which->title);
    for (size_t i = 0; i < lab->figure_count; i++) {
        const struct lab_figure *figure = &lab->figures[i];
        printf("  %-10s %-62s %10.4g %-5s", figure->method, figure->what, figure->value, figure->unit);
        if (!is_note(figure))
            printf(" %s %8.4g  %s", figure->is_at_least ? ">=" : "<=", figure->limit, verdict_of(figure));
        putchar('\n');
    }
    if (lab->columns)
        print_rows(lab);
    putchar('\n');
}

static void print_number(const char *name, double value)
{
    if (isfinite(value))
        printf("\"%s\":%.9g", name, value);
    else
        printf("\"%s\":null", name);
}

static void print_json_rows(const struct lab *lab)
{
    printf("],\"rows\":[");
    for (size_t i = 0; i < lab->row_count; i++)
        for (size_t k = 0; lab->columns[k]; k++) {
            const struct lab_cell *cell = &lab->rows[i][k];
            fputs(k ? "," : i ? ",{" : "{", stdout);
            if (cell->word)
                printf("\"%s\":\"%s\"", lab->columns[k], cell->word);
            else
                print_number(lab->columns[k], cell->number);
            if (!lab->columns[k + 1])
                putchar('}');
        }
}

/* The texts of cases are the program's own: they have no quotes and no backslashes. */
static void print_json(const struct lab *lab, const struct lab_case *which)
{
    printf("{\"case\":\"%s\",\"title\":\"%s\",\"method\":\"%s\",\"advice\":\"%s\",\"figures\":[", which->name,
           which->title, which->method, which->advice);
    for (size_t i = 0; i < lab->figure_count; i++) {
        const struct lab_figure *figure = &lab->figures[i];
        printf("%s{\"method\":\"%s\",\"what\":\"%s\",", i ? "," : "", figure->method, figure->what);
        print_number("value", figure->value);
        printf(",\"unit\":\"%s\"", figure->unit);
        if (!is_note(figure)) {
            putchar(',');
            print_number(figure->is_at_least ? "at_least" : "at_most", figure->limit);
            printf(",\"verdict\":\"%s\"", verdict_of(figure));
        }
        putchar('}');
    }
    printf("],\"points\":[");
    for (size_t i = 0; i < lab->point_count; i++) {
        const struct lab_point *point = &lab->points[i];
        printf("%s{\"chart\":\"%s\",\"series\":\"%s\",", i ? "," : "", point->chart, point->series);
        print_number("x", point->x);
        putchar(',');
        print_number("y", point->y);
        putchar('}');
    }
    if (lab->columns)
        print_json_rows(lab);
    puts("]}");
}

/* Figures of baselines may fail: that is what they are for. */
static int breaks_a_limit(const struct lab *lab)
{
    for (size_t i = 0; i < lab->figure_count; i++) {
        const char *method = lab->figures[i].method;
        const int is_baseline = !strcmp(method, lab_method_name(LAB_POINT)) ||
                                !strcmp(method, lab_method_name(LAB_BED)) || !strcmp(method, lab_method_name(LAB_BALL));
        if (!is_baseline && !lab_figure_holds(&lab->figures[i]))
            return 1;
    }
    return 0;
}

static int run_cases(const struct lab_case *const *cases, double effort, int json)
{
    struct meter meter = { .began = 0 };
    int is_broken = 0, count = 0;
    while (cases[count])
        count++;
    for (int i = 0; i < count; i++) {
        struct lab lab;
        meter_show(&meter, cases[i]->name, (double)i / count);
        lab_run(&lab, cases[i], effort);
        const int ran_out = lab.is_out_of_memory;
        if (!ran_out)
            (json ? print_json : print_table)(&lab, cases[i]);
        is_broken |= breaks_a_limit(&lab);
        lab_free(&lab);
        if (ran_out)
            return complain("stability", "memory ran out");
        fflush(stdout);
    }
    meter_show(&meter, "", 1.0);
    return is_broken;
}

static int list_cases(void)
{
    for (const struct lab_case *const *which = lab_cases; *which; which++)
        printf("%-14s %s%s\n", (*which)->name, (*which)->title, (*which)->is_named_only ? " (only where named)" : "");
    return 0;
}

static void list_names(const char *names[CASES_MAX + 1])
{
    size_t count = 0;
    for (const struct lab_case *const *which = lab_cases; *which; which++)
        names[count++] = (*which)->name;
    names[count] = NULL;
}

/* All that need not be named. */
static size_t choose_default(const struct lab_case **chosen)
{
    size_t count = 0;
    for (const struct lab_case *const *which = lab_cases; *which; which++)
        if (!(*which)->is_named_only)
            chosen[count++] = *which;
    return count;
}

int command_stability(int argc, char **argv)
{
    const char *names[CASES_MAX];
    const struct lab_case *chosen[CASES_MAX + 1];
    double effort = EFFORT_USUAL;
    int json = 0, lists = 0;
    size_t count;
    const struct option_def options[] = { { .name = "--list", .flag = &lists },
                                          { .name = "--effort", .number = &effort },
                                          { .name = "--json", .flag = &json } };
    const char *known[CASES_MAX + 1];
    list_names(known);
    const struct operand_def cases = { .words = known };
    const int status = parse_options(
        argc, argv,
        &(struct command_syntax){ options, sizeof options / sizeof *options, help, &cases, 1, .repeats = 1 }, names,
        CASES_MAX, &count);
    if (status >= 0)
        return status;
    if (lists)
        return list_cases();
    if (!(effort > 0.0 && effort <= 1.0))
        return complain("stability", "--effort must be above 0, at most 1");
    for (size_t i = 0; i < count; i++) {
        chosen[i] = find_case(names[i]);
        if (!chosen[i])
            return complain_of_word("stability", "case", names[i], known);
    }
    if (!count)
        count = choose_default(chosen);
    chosen[count] = NULL;
    return run_cases(chosen, effort, json);
}
