/* SPDX-License-Identifier: BSD-3-Clause */
/* The run: counts by name, the trace of the last calls, what a failure prints. */
#include <stdarg.h>
#include <unistd.h>

#include "fuzz/calls/calls.h"

struct run run = { .seed = 1 };
uint64_t met[MET_COUNT];

#define MET_TEXT(name, text) text,
static const char *const met_texts[] = { MET(MET_TEXT) };

enum { REMEMBERED = 24, ARGUMENTS = 4 };

struct remembered {
    const struct site *site;
    const char *format;
    uint64_t argument[ARGUMENTS];
    uint64_t number; /* of the call in its game */
    int has_result;
    dpt_result result;
};

static struct remembered trace[REMEMBERED], next;
static struct site *sites;

static struct remembered *last_call(void)
{
    return &trace[run.game_calls % REMEMBERED];
}

static void print_call(const struct remembered *call)
{
    printf("    %6llu %s(", (unsigned long long)call->number, call->site->name);
    if (call->format)
        printf(call->format, (unsigned long long)call->argument[0], (unsigned long long)call->argument[1],
               (unsigned long long)call->argument[2], (unsigned long long)call->argument[3]);
    printf(")%s%s\n", call->has_result ? " = " : "", call->has_result ? dpt_result_name(call->result) : "");
}

void call_with(const char *format, uint64_t a, uint64_t b, uint64_t c, uint64_t d)
{
    next.format = format;
    next.argument[0] = a;
    next.argument[1] = b;
    next.argument[2] = c;
    next.argument[3] = d;
}

void call_begins(struct site *site)
{
    if (!site->is_listed) {
        site->is_listed = 1;
        site->next = sites;
        sites = site;
    }
    if (run.is_told && run.game_calls > 0)
        print_call(last_call());
    site->calls++;
    run.calls++;
    run.game_calls++;
    next.site = site;
    next.number = run.game_calls;
    *last_call() = next;
    next.format = NULL;
}

void call_ends(struct site *site, dpt_result result)
{
    *(result == DPT_OK ? &site->done : &site->refused) += 1;
    last_call()->has_result = 1;
    last_call()->result = result;
    game_digest(&result, sizeof result);
}

void game_digest(const void *bytes, size_t size)
{
    const unsigned char *at = bytes;
    uint64_t word, sum = run.digest;
    for (; size >= sizeof word; size -= sizeof word, at += sizeof word) {
        memcpy(&word, at, sizeof word);
        sum = (sum ^ word) * 0x9e3779b97f4a7c15u;
        sum ^= sum >> 29;
    }
    for (; size; size--)
        sum = (sum ^ *at++) * 0x100000001b3u;
    run.digest = sum;
}

static void print_trace(void)
{
    const uint64_t first = run.game_calls < REMEMBERED ? 1 : run.game_calls - REMEMBERED + 1;
    printf("    the last calls of game %llu:\n", (unsigned long long)run.game);
    for (uint64_t i = first; i <= run.game_calls; i++)
        print_call(&trace[i % REMEMBERED]);
    printf("    to play it again: test_calls --seed %llu --only %llu   (--tell prints every call)\n",
           (unsigned long long)run.seed, (unsigned long long)run.game);
}

void call_fails(const char *file, int line, const char *condition, const char *format, ...)
{
    va_list arguments;
    printf("    %s:%d: %s: ", file, line, condition);
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    printf("\n  FAIL seed %llu, game %llu, call %llu of it, %llu in all\n", (unsigned long long)run.seed,
           (unsigned long long)run.game, (unsigned long long)run.game_calls, (unsigned long long)run.calls);
    print_trace();
    unlink(trace_path);
    unlink(obj_path);
    printf("0 passed, 1 failed, 0 skipped\n");
    fflush(stdout);
    _exit(1);
}

void expect_at(const char *file, int line, dpt_result result, const struct codes *codes)
{
    char allowed[256] = "";
    if (result == DPT_OK && (!codes->count || codes->or_done))
        return;
    for (int i = 0; i < codes->count; i++)
        if (codes->code[i] == result)
            return;
    for (int i = 0; i < codes->count; i++)
        snprintf(allowed + strlen(allowed), sizeof allowed - strlen(allowed), " %s", dpt_result_name(codes->code[i]));
    call_fails(file, line, "a code that the arguments earn", "%s, and not%s%s", dpt_result_name(result), allowed,
               !codes->count || codes->or_done ? " DPT_OK" : "");
}

/* ---- coverage ---- */

/* Called by nothing here, and why. */
static const struct {
    const char *name, *reason;
} exceptions[] = {
    { "dpt_urdf_compile_file", "a library of its own, with C++: tests/urdf" },
    { "dpt_urdf_def_defaults", "likewise" },
    { "dpt_convex_corners", "a library of its own, with libccd: tests/convex" },
    { "dpt_convex_shape_wrench", "likewise" },
    { "dpt_convex_touch", "likewise" },
};

static int is_excepted(const char *name)
{
    for (size_t i = 0; i < sizeof exceptions / sizeof *exceptions; i++)
        if (!strcmp(exceptions[i].name, name))
            return 1;
    return 0;
}

static struct site sum_of(const char *name)
{
    struct site sum = { .name = name };
    for (const struct site *site = sites; site; site = site->next)
        if (!strcmp(site->name, name)) {
            sum.calls += site->calls;
            sum.done += site->done;
            sum.refused += site->refused;
            sum.has_result |= site->has_result;
        }
    return sum;
}

static int is_covered(const struct site *sum)
{
    return sum->calls > 0 && (!sum->has_result || (sum->done > 0 && sum->refused > 0));
}

void coverage_is_checked(int (*check)(int holds, const char *what))
{
    static const char *const lists[] = { "libdynpoint", "libdynpoint_compile", "libdynpoint_drivers",
                                         "libdynpoint_urdf", "libdynpoint_convex" };
    char path[64], name[128], what[256];
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        snprintf(path, sizeof path, "tests/abi/%s.symbols", lists[i]);
        FILE *file = fopen(path, "r");
        uint32_t symbols = 0;
        for (; file && fgets(name, sizeof name, file); symbols++) {
            name[strcspn(name, "\n")] = '\0';
            const struct site sum = sum_of(name);
            snprintf(what, sizeof what, "%s is called %llu times: %llu done, %llu refused", name,
                     (unsigned long long)sum.calls, (unsigned long long)sum.done, (unsigned long long)sum.refused);
            check(is_excepted(name) ? sum.calls == 0 : is_covered(&sum), what);
        }
        if (file)
            fclose(file);
        snprintf(what, sizeof what, "%s lists nothing", path);
        check(symbols > 0, what);
    }
}

void all_is_met(int (*check)(int holds, const char *what))
{
    char what[128];
    for (int i = 0; i < MET_COUNT; i++) {
        snprintf(what, sizeof what, "%s was not met", met_texts[i]);
        check(met[i] > 0, what);
    }
}

void coverage_is_printed(void)
{
    for (int i = 0; i < MET_COUNT; i++)
        printf("    %-48s %9llu\n", met_texts[i], (unsigned long long)met[i]);
    for (const struct site *site = sites; site; site = site->next) {
        const struct site *before = sites;
        while (before != site && strcmp(before->name, site->name))
            before = before->next;
        const struct site sum = sum_of(site->name);
        if (before == site)
            printf("    %-32s %9llu calls %9llu done %9llu refused\n", sum.name, (unsigned long long)sum.calls,
                   (unsigned long long)sum.done, (unsigned long long)sum.refused);
    }
}
