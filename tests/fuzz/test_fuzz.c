/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The fuzz targets without a fuzzing engine: every file of the corpora, then mutations of them. A seed names a run, so
 * what fails here fails again.
 *
 *     test_fuzz [EXECUTIONS [TARGET [FILE]]]
 *
 * EXECUTIONS is the sum over all targets; with TARGET it is alone; with FILE that input alone. What ends the program,
 * or takes a minute, is left in build/fuzz/TARGET.found.
 */
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "built_with.h"
#include "fuzz/mutate.h"
#include "fuzz/target.h"
#include "lib/check.h"

/* Of this process, where no sanitizer takes more: what a header announces must not be taken. */
#define MEMORY_MAX ((rlim_t)256 << 20)

#ifdef DPT_HAS_JANSSON
#define SCENE(X) X(scene, 2, 20) X(plan, 1, 20)
#else
#define SCENE(X)
#endif

/*      name    share  accepted, at least one in */
#define TARGETS(X)                                                                                                     \
    X(obj, 17, 20)                                                                                                     \
    X(stl, 12, 20)                                                                                                     \
    X(ply, 18, 100)                                                                                                    \
    X(off, 11, 40)                                                                                                     \
    X(tetgen, 2, 40)                                                                                                   \
    X(regions, 2, 40)                                                                                                  \
    X(trace, 5, 40)                                                                                                    \
    SCENE(X)                                                                                                           \
    X(mesh, 10, 100)                                                                                                   \
    X(forged, 2, 2)                                                                                                    \
    X(arm, 4, 10)                                                                                                      \
    X(wire, 8, 10)                                                                                                     \
    X(motor, 2, 10)                                                                                                    \
    X(record, 4, 10)                                                                                                   \
    X(snapshot, 3, 20)                                                                                                 \
    X(request, 1, 20)

#define DECLARE(name, share, least) int fuzz_##name(const uint8_t *bytes, size_t size);
TARGETS(DECLARE)

struct target {
    const char *name;
    int (*run)(const uint8_t *bytes, size_t size);
    uint64_t share, least;
};

static uint64_t executions = 1000000;
static const char *only, *replayed;

/* What runs now, for the handler of signals. */
static const char *current;
static const unsigned char *current_bytes;
static size_t current_size;

static void found(int signal_number)
{
    char path[128];
    snprintf(path, sizeof path, "build/fuzz/%s.found", current);
    mkdir("build", 0777);
    mkdir("build/fuzz", 0777);
    int file = open(path, O_CREAT | O_TRUNC | O_WRONLY, 0666);
    ssize_t written = file < 0 ? -1 : write(file, current_bytes, current_size);
    printf("  FAIL %s: signal %d, %zd bytes in %s\n", current, signal_number, written, path);
    fflush(stdout);
    _exit(1);
}

/* In a block of its exact length, so that the sanitizer sees a read beyond it. */
static void run_once(const struct target *target, const unsigned char *bytes, size_t size)
{
    unsigned char *block = malloc(size ? size : 1);
    if (size)
        memcpy(block, bytes, size);
    current_bytes = block;
    current_size = size;
    target->run(block, size);
    free(block);
}

static void load(struct fuzz_set *set, struct fuzz_set *words, const char *name)
{
    char path[128], ending[16];
    snprintf(path, sizeof path, "tests/fuzz/corpus/%s", name);
    int files = fuzz_set_add_folder(set, path, "", FUZZ_BYTES_MAX);
    CHECK(files > 0, "%s: %d files", path, files);
    snprintf(ending, sizeof ending, ".%s", name);
    CHECK(fuzz_set_add_folder(set, "tests/golden-bad", ending, FUZZ_BYTES_MAX) >= 0, "no tests/golden-bad");
    snprintf(path, sizeof path, "tests/fuzz/%s.dict", name);
    fuzz_set_add_words(words, path);
}

static void run(const struct target *target)
{
    struct fuzz_set set = { NULL, 0, 0 }, words = { NULL, 0, 0 };
    unsigned char mutated[FUZZ_BYTES_MAX];
    uint64_t random = 1, runs = only ? executions : executions * target->share / 100;
    if (only && strcmp(only, target->name))
        return;
    load(&set, &words, target->name);
    current = target->name;
    fuzz_accepted = 0;
    for (size_t i = 0; i < set.count; i++)
        run_once(target, set.inputs[i].bytes, set.inputs[i].size);
    uint64_t replay_accepted = fuzz_accepted;
    for (uint64_t i = 0; i < runs && set.count; i++) {
        if (i % 256 == 0)
            alarm(60);
        run_once(target, mutated, fuzz_mutate(&random, &set, &words, mutated, sizeof mutated));
    }
    alarm(0);
    uint64_t accepted = fuzz_accepted - replay_accepted;
    CHECK(accepted * target->least >= runs && accepted <= runs, "%llu of %llu accepted: the test tests little",
          (unsigned long long)accepted, (unsigned long long)runs);
    printf("    %s: %zu files, %llu accepted; %llu mutations, %llu accepted\n", target->name, set.count,
           (unsigned long long)replay_accepted, (unsigned long long)runs, (unsigned long long)accepted);
    fuzz_set_free(&set);
    fuzz_set_free(&words);
}

static void replay(const struct target *target)
{
    unsigned char bytes[FUZZ_BYTES_MAX];
    FILE *file = strcmp(only, target->name) ? NULL : fopen(replayed, "rb");
    if (!file)
        return;
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    current = target->name;
    run_once(target, bytes, size);
}

#define DEFINE(name, share, least)                                                                                     \
    static void name(void)                                                                                             \
    {                                                                                                                  \
        const struct target target = { #name, fuzz_##name, share, least };                                             \
        replayed ? replay(&target) : run(&target);                                                                     \
    }
TARGETS(DEFINE)

int main(int argc, char **argv)
{
    const int signals[] = { SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGALRM };
    if (argc > 1)
        executions = strtoull(argv[1], NULL, 10);
    only = argc > 2 ? argv[2] : NULL;
    replayed = argc > 3 ? argv[3] : NULL;
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
        signal(signals[i], found);
#ifndef __SANITIZE_ADDRESS__
    const struct rlimit limit = { MEMORY_MAX, MEMORY_MAX };
    CHECK(setrlimit(RLIMIT_AS, &limit) == 0, "no limit of memory");
#endif
#define RUN(name, share, least)                                                                                        \
    if (!only || !strcmp(only, #name))                                                                                 \
        TEST(name);
    TARGETS(RUN)
    return check_report();
}

#ifdef __SANITIZE_ADDRESS__
__attribute__((visibility("default"))) const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
    return "abort_on_error=1:allocator_may_return_null=1:max_allocation_size_mb=64:handle_segv=0";
}

__attribute__((visibility("default"))) const char *__ubsan_default_options(void);
const char *__ubsan_default_options(void)
{
    return "abort_on_error=1:print_stacktrace=1";
}
#endif
