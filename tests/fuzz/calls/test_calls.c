/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Random calls of everything public against a model (calls.h).
 *
 *     test_calls [CALLS] [--seed S] [--only GAME] [--tell] [--list]
 *
 * CALLS in all, 10^6 if not given, in games of some 2,000. What fails prints the last calls, and the seed and game
 * that --only plays again alone; --tell prints every call of it, --list how often each function was called. Every
 * 16th game is played twice, and must answer the same. A game that takes a minute hangs.
 */
#include <signal.h>
#include <unistd.h>

#include "fuzz/calls/calls.h"
#include "lib/check.h"

enum { GAME_CALLS = 2000, MOVES_MAX = 180, TWICE_IN = 16 };

static const struct noun *const nouns[] = {
    &world_noun,     &body_noun,     &tool_noun,     &step_noun,    &result_noun, &strip_noun,
    &query_noun,     &mesh_noun,     &arm_noun,      &compile_noun, &guard_noun,  &coupling_noun,
    &passivity_noun, &device_noun,   &loop_noun,     &name_noun,    &trial_noun,  &selftest_noun,
    &proxy_noun,     &record_noun,   &identify_noun, &deform_noun,  &node_noun,   &spring_noun,
    &exchange_noun,  &snapshot_noun, &hull_noun,     &yield_noun,   &needle_noun
};
enum { NOUNS = sizeof nouns / sizeof *nouns };

static const struct move *all_moves[MOVES_MAX];
static uint32_t all_weights;

static const struct move *draw_move(void)
{
    uint32_t left = draw_below(all_weights);
    const struct move *const *move = all_moves;
    for (; left >= (*move)->weight; move++)
        left -= (*move)->weight;
    return *move;
}

static void list_moves(void)
{
    size_t count = 0;
    for (size_t i = 0; i < NOUNS; i++)
        for (const struct move *move = nouns[i]->moves; move->make; move++) {
            HOLDS(count < MOVES_MAX, "%zu moves", count);
            all_moves[count++] = move;
            all_weights += move->weight;
        }
}

/* All that a game does follows from the seed and its number. */
static void play(uint64_t game)
{
    const int64_t blocks = blocks_alive;
    run.game = game;
    run.random = run.seed * 0x9e3779b97f4a7c15u ^ game;
    run.random = draw_bits();
    run.digest = 0;
    run.game_calls = 0;
    alarm(60);
    for (size_t i = 0; i < NOUNS; i++)
        if (nouns[i]->begin)
            nouns[i]->begin();
    while (run.game_calls < GAME_CALLS)
        draw_move()->make();
    for (size_t i = 0; i < NOUNS; i++)
        if (nouns[i]->end)
            nouns[i]->end();
    HOLDS(blocks_alive == blocks, "%lld blocks leak", (long long)(blocks_alive - blocks));
}

static void play_twice(uint64_t game)
{
    play(game);
    const uint64_t digest = run.digest, calls = run.calls;
    run.is_told = 0;
    play(game);
    HOLDS(run.digest == digest, "the same calls, and other answers");
    run.calls = calls;
}

/* Of a crash, or of what takes a minute. */
static void found(int signal_number)
{
    call_fails(__FILE__, __LINE__, "no signal", "signal %d", signal_number);
}

static int covers(int holds, const char *what)
{
    CHECK(holds, "%s", what);
    return holds;
}

static uint64_t wanted = 1000000, only;
static int has_only, lists;

static void calls_are_as_the_model_says(void)
{
    if (has_only)
        play_twice(only);
    for (uint64_t game = 0; !has_only && run.calls < wanted; game++)
        (game % TWICE_IN ? play : play_twice)(game);
    alarm(0);
}

static void every_function_is_called(void)
{
    coverage_is_checked(covers);
}

static void the_run_met_all_there_is(void)
{
    all_is_met(covers);
}

static int take_arguments(int argc, char **argv)
{
    for (int i = 1; i < argc; i++) {
        const char *value = i + 1 < argc ? argv[i + 1] : NULL;
        if (!strcmp(argv[i], "--tell")) {
            run.is_told = 1;
        } else if (!strcmp(argv[i], "--list")) {
            lists = 1;
        } else if (!strcmp(argv[i], "--seed") && value) {
            run.seed = strtoull(argv[++i], NULL, 10);
        } else if (!strcmp(argv[i], "--only") && value) {
            only = strtoull(argv[++i], NULL, 10);
            has_only = 1;
        } else if (argv[i][0] >= '0' && argv[i][0] <= '9') {
            wanted = strtoull(argv[i], NULL, 10);
        } else {
            return 0;
        }
    }
    return 1;
}

int main(int argc, char **argv)
{
    const int signals[] = { SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGALRM };
    if (!take_arguments(argc, argv)) {
        puts("test_calls [CALLS] [--seed S] [--only GAME] [--tell] [--list]");
        return 2;
    }
    if (!subjects_open()) {
        puts("  FAIL nothing to ask");
        return 2;
    }
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
        signal(signals[i], found);
    list_moves();
    printf("  seed %llu\n", (unsigned long long)run.seed);
    fflush(stdout);
    TEST(calls_are_as_the_model_says);
    if (!has_only && wanted >= 100000) {
        TEST(every_function_is_called);
        TEST(the_run_met_all_there_is);
    }
    if (lists)
        coverage_is_printed();
    printf("    %llu calls\n", (unsigned long long)run.calls);
    subjects_close();
    return check_report();
}

#ifdef __SANITIZE_ADDRESS__
__attribute__((visibility("default"))) const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
    return "abort_on_error=1:handle_segv=0";
}

__attribute__((visibility("default"))) const char *__ubsan_default_options(void);
const char *__ubsan_default_options(void)
{
    return "abort_on_error=1:print_stacktrace=1";
}
#endif
