/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * That a tick asks nothing of the system. A child makes worlds of every method and ticks them where
 * the kernel kills who calls it: seccomp's strict mode lets only read, write, exit and sigreturn
 * through, and on x86 shuts the clock too. Allocations, which may need no call, are counted, and so
 * are page faults. Each check is shown to fail: other children do the same with one call, one large
 * block or one look at the clock.
 *
 * A lock that is free makes no call: that the core imports none, tests/abi/check.sh says.
 */
#include <errno.h>

#include "lib/check.h"
#include "world/busy_world.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SANITIZED
#endif
#endif

#if defined(__linux__) && !defined(SANITIZED)
#define CAN_FORBID_CALLS
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#endif

/*
 * Allocations are counted where the C library lets its functions be replaced: its own calls too,
 * for which the replacements must be seen outside of this program.
 */
static uint64_t allocations;
#if defined(__GLIBC__) && defined(CAN_FORBID_CALLS)
#define CAN_COUNT_ALLOCATIONS
#define SEEN __attribute__((visibility("default")))
extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *block, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);
extern void __libc_free(void *block);

SEEN void *malloc(size_t size)
{
    allocations++;
    return __libc_malloc(size);
}

SEEN void *calloc(size_t count, size_t size)
{
    allocations++;
    return __libc_calloc(count, size);
}

SEEN void *realloc(void *block, size_t size)
{
    allocations++;
    return __libc_realloc(block, size);
}

SEEN void *aligned_alloc(size_t alignment, size_t size)
{
    allocations++;
    return __libc_memalign(alignment, size);
}

SEEN int posix_memalign(void **block, size_t alignment, size_t size)
{
    allocations++;
    *block = __libc_memalign(alignment, size);
    return *block ? 0 : ENOMEM;
}

SEEN void free(void *block)
{
    allocations++;
    __libc_free(block);
}
#endif

enum offence { NONE, A_CALL, A_LARGE_BLOCK, A_CLOCK, A_SMALL_BLOCK };
enum { OFFENCE_AT = 1234, LARGE = 1 << 28 };

static enum offence planned;
static int report_to; /* where the tally goes before the offence; -1: nowhere */

static void offend(const struct busy_tally *tally)
{
#ifdef CAN_FORBID_CALLS
    void *volatile block = NULL;
    struct timespec time;
    if (report_to >= 0 && write(report_to, tally, sizeof *tally) < 0)
        return;
    switch (planned) {
    case A_CALL:
        syscall(SYS_getpid);
        break;
    case A_LARGE_BLOCK: /* more than the heap keeps, so that it must ask */
        block = malloc(LARGE);
        break;
    case A_CLOCK:
        clock_gettime(CLOCK_MONOTONIC, &time);
        break;
    case A_SMALL_BLOCK:
        block = malloc(16);
        break;
    case NONE:
        break;
    }
    free(block);
#else
    (void)tally;
#endif
}

/* Every scene with every kernel that is here; with an offence, as far as it takes to commit it. */
static struct busy_tally run(enum offence offence, int report)
{
    struct busy_world busy = { .interrupt_at = OFFENCE_AT, .interrupt = offence == NONE ? NULL : offend };
    planned = offence;
    report_to = report;
    uint64_t before = allocations;
    for (uint32_t kernel = DPT_KERNEL_SCALAR; kernel <= DPT_KERNEL_WASM128; kernel++)
        for (int i = 0; i < BUSY_SCENES; i++)
            if ((offence == NONE || busy.tally.ticks <= OFFENCE_AT) && busy_world_open(&busy, &busy_scenes[i], kernel))
                busy_world_run(&busy, 0, (uint32_t)part_of(busy_scenes[i].ticks));
    busy.tally.allocations = allocations - before;
    return busy.tally;
}

static struct busy_tally usual; /* without an offence, calls allowed */

/* Before anything is concluded from its silence: the run does what it says. */
static void the_run_walks_every_path(void)
{
    uint64_t answers = BUSY_TOOLS * usual.ticks;
    CHECK(usual.ticks >= part_of(5000), "%llu ticks", (unsigned long long)usual.ticks);
    CHECK(usual.unmade == 0, "%llu worlds not made", (unsigned long long)usual.unmade);
    CHECK(usual.stale > answers / 100 && usual.stale < answers / 5, "%llu of %llu stale",
          (unsigned long long)usual.stale, (unsigned long long)answers);
    CHECK(usual.local > answers / 20, "%llu local", (unsigned long long)usual.local);
    CHECK(usual.exact > answers / 2, "%llu exact", (unsigned long long)usual.exact);
    CHECK(usual.crossing > answers / 20 && usual.crossing < answers * 9 / 10, "%llu of %llu cross",
          (unsigned long long)usual.crossing, (unsigned long long)answers);
    CHECK(usual.strips > answers / 20, "%llu strips", (unsigned long long)usual.strips);
    CHECK(usual.forces > answers / 20, "%llu forces", (unsigned long long)usual.forces);
    CHECK(usual.refused > usual.ticks / 20, "%llu refused", (unsigned long long)usual.refused);
    printf("    %llu ticks; of the answers %.0f %% cross, %.0f %% stale; %llu codes\n", (unsigned long long)usual.ticks,
           100.0 * (double)usual.crossing / (double)answers, 100.0 * (double)usual.stale / (double)answers,
           (unsigned long long)usual.refused);
}

#ifdef CAN_COUNT_ALLOCATIONS
static void ticks_allocate_nothing(void)
{
    CHECK(usual.allocations == 0, "%llu calls", (unsigned long long)usual.allocations);
    struct busy_tally tally = run(A_SMALL_BLOCK, -1);
    CHECK(tally.allocations == 2, "of a malloc and a free %llu are counted", (unsigned long long)tally.allocations);
}
#endif

#ifdef CAN_FORBID_CALLS
/* How a child ended, and what it wrote. */
struct ending {
    int status;
    size_t bytes;
    struct busy_tally report[2];
};

enum { REFUSED = 77 };

/* In a container's filter strict mode is refused; a filter that lets less through is not. */
static int forbid_calls(void)
{
    struct sock_filter rules[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_write, 2, 0),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit, 1, 0),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    };
    struct sock_fprog filter = { sizeof rules / sizeof *rules, rules };
    if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT) == 0)
        return 1;
#if defined(__x86_64__)
    prctl(PR_SET_TSC, PR_TSC_SIGSEGV); /* as strict mode does */
#endif
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

static void be_the_child(enum offence offence, int report)
{
    const struct rlimit no_core = { 0, 0 };
    setrlimit(RLIMIT_CORE, &no_core);
    dup2(report, STDOUT_FILENO); /* a write is let through: what is printed is seen in the report */
    dup2(report, STDERR_FILENO);
    if (!forbid_calls())
        syscall(SYS_exit, REFUSED);
    struct busy_tally tally = run(offence, report);
    int written = write(report, &tally, sizeof tally) == sizeof tally;
    syscall(SYS_exit, written ? 0 : 1); /* _exit is another call, which strict mode kills */
}

static struct ending run_child(enum offence offence)
{
    struct ending ending = { .status = -1 };
    int ends[2];
    pid_t child = pipe(ends) == 0 ? fork() : -1;
    CHECK(child >= 0, "no pipe or no child: %s", strerror(errno));
    if (child < 0)
        return ending;
    if (child == 0)
        be_the_child(offence, ends[1]);
    close(ends[1]);
    while (ending.bytes < sizeof ending.report) {
        ssize_t got = read(ends[0], (char *)ending.report + ending.bytes, sizeof ending.report - ending.bytes);
        if (got <= 0)
            break;
        ending.bytes += (size_t)got;
    }
    close(ends[0]);
    waitpid(child, &ending.status, 0);
    return ending;
}

static struct ending quiet; /* the child without an offence */

static void ticks_call_nothing(void)
{
    CHECK(WIFEXITED(quiet.status) && WEXITSTATUS(quiet.status) == 0, "status %x", quiet.status);
    CHECK(quiet.bytes == sizeof usual, "%zu bytes written", quiet.bytes);
    CHECK(memcmp(&quiet.report[0], &usual, sizeof usual) == 0, "%llu of %llu ticks, other answers",
          (unsigned long long)quiet.report[0].ticks, (unsigned long long)usual.ticks);
}

/* The child says how far it came, offends, and is gone. */
static void expect_death(enum offence offence)
{
    struct ending ending = run_child(offence);
    int signal = WIFSIGNALED(ending.status) ? WTERMSIG(ending.status) : 0;
    /* A clock that is read in place traps. */
    CHECK(signal == SIGKILL || signal == SIGSYS || (offence == A_CLOCK && signal == SIGSEGV), "offence %d: status %x",
          offence, ending.status);
    CHECK(ending.bytes == sizeof usual && ending.report[0].ticks == OFFENCE_AT,
          "offence %d: %zu bytes written, after %llu ticks", offence, ending.bytes,
          (unsigned long long)ending.report[0].ticks);
}

static void a_call_would_be_seen(void)
{
    expect_death(A_CALL);
    expect_death(A_LARGE_BLOCK);
#if defined(__x86_64__) /* elsewhere it stays open */
    expect_death(A_CLOCK);
#endif
}

static long faults_until_now(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? usage.ru_minflt + usage.ru_majflt : 0;
}

static int faults_are_counted(void)
{
    enum { BYTES = 1 << 20 };
    long before = faults_until_now();
    unsigned char *fresh = mmap(NULL, BYTES, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (fresh == MAP_FAILED)
        return 0;
    for (size_t i = 0; i < BYTES; i += 4096)
        *(volatile unsigned char *)&fresh[i] = 1;
    munmap(fresh, BYTES);
    return faults_until_now() > before;
}

/*
 * Of some rounds the quietest counts: the kernel may take a page away and give it back at any time,
 * but a fault of ours would come in every round.
 */
static void steady_ticks_touch_no_new_page(void)
{
    enum { ROUNDS = 5, TICKS = 500, FIRST = 20 };
    for (int i = 0; i < BUSY_SCENES; i++) {
        struct busy_world busy = { .interrupt = NULL };
        uint32_t ticks = busy_scenes[i].ticks < TICKS ? busy_scenes[i].ticks : TICKS;
        ticks = (uint32_t)part_of(ticks);
        long least = -1, all = 0, begin = faults_until_now();
        if (!busy_world_open(&busy, &busy_scenes[i], DPT_KERNEL_AUTO))
            continue;
        busy_world_run(&busy, 0, FIRST);
        long first = faults_until_now() - begin;
        for (uint32_t round = 0; round < ROUNDS; round++) {
            long before = faults_until_now();
            busy_world_run(&busy, round * ticks, (round + 1) * ticks);
            long faults = faults_until_now() - before;
            least = least < 0 || faults < least ? faults : least;
            all += faults;
        }
        CHECK(least == 0, "scene %d: at least %ld in %u ticks", i, least, ticks);
        printf("    page faults, scene %d: %ld to make it and for %d ticks, %ld in %u more\n", i, first, FIRST, all,
               ROUNDS * ticks);
    }
}
#endif

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    int ready = busy_worlds_prepare();
    CHECK(ready, "no meshes or no memory");
    if (!ready) {
        check_failed++;
        return check_report();
    }
#ifdef CAN_FORBID_CALLS
    quiet = run_child(NONE); /* before any tick here: a call of the first tick alone is one too */
    if (faults_are_counted())
        TEST(steady_ticks_touch_no_new_page);
    else
        SKIP("steady_ticks_touch_no_new_page", "page faults are not counted here");
#else
    SKIP("steady_ticks_touch_no_new_page", "not Linux, or the sanitizer's own would be seen");
#endif
    usual = run(NONE, -1);
    TEST(the_run_walks_every_path);
#ifdef CAN_COUNT_ALLOCATIONS
    TEST(ticks_allocate_nothing);
#else
    SKIP("ticks_allocate_nothing", "the allocator cannot be replaced in this build");
#endif
#ifdef CAN_FORBID_CALLS
    if (WIFEXITED(quiet.status) && WEXITSTATUS(quiet.status) == REFUSED) {
        SKIP("ticks_call_nothing", "the kernel grants no seccomp");
        SKIP("a_call_would_be_seen", "the kernel grants no seccomp");
    } else {
        TEST(ticks_call_nothing);
        TEST(a_call_would_be_seen);
    }
#else
    SKIP("ticks_call_nothing", "not Linux, or the sanitizer makes calls of its own");
    SKIP("a_call_would_be_seen", "not Linux, or the sanitizer makes calls of its own");
#endif
    busy_worlds_free();
    return check_report();
}
