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
#include <math.h>

#include "dynpoint/baseline.h"
#include "lib/fixture.h"

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

enum { BODIES = 3, TOOLS = 3, RIGID = 3, SEGMENTS = RIGID + 2, QUERIES = 4 };

/* Made before the ticks, as an application would: the bytes of the meshes and room for a world. */
static struct fixture meshes[BODIES];
static void *room;
static size_t room_bytes;

static const struct scene {
    uint32_t method, until, parts, one_step;
    uint64_t certificate_bytes;
    uint32_t ticks, strip;
} scenes[] = {
    { DPT_METHOD_EXACT, DPT_UNTIL_RESPOND, 1, 0, 1 << 20, 2000, DPT_STRIP_KIND_SHADOW },
    { DPT_METHOD_EXACT, DPT_UNTIL_CONTACT, 1, 0, 3 * 264, 1000,
      0 }, /* planes push each other out */
    { DPT_METHOD_EXACT, DPT_UNTIL_TRACK, 1, 0, 0, 1000, 0 },
    { DPT_METHOD_TREE, DPT_UNTIL_RESPOND, 1, 0, 0, 1000, DPT_STRIP_KIND_ROUTES },
    { DPT_METHOD_PAPER, DPT_UNTIL_RESPOND, 1, 1, 0, 1000, DPT_STRIP_KIND_ROUTES },
    { DPT_METHOD_PAPER, DPT_UNTIL_CONTACT, 7, 0, 0, 200, DPT_STRIP_KIND_SHADOW },
    { DPT_METHOD_BRUTE, DPT_UNTIL_RESPOND, 1, 0, 0, 20, 0 },
};
enum { SCENES = sizeof scenes / sizeof *scenes };

/* What came out: that all paths were walked, and the same where calls are forbidden. */
struct tally {
    uint64_t ticks, unmade, refused, stale, local, exact, crossing, forces, strips, answers;
    uint64_t allocations;
};

enum offence { NONE, A_CALL, A_LARGE_BLOCK, A_CLOCK, A_SMALL_BLOCK };
enum { OFFENCE_AT = 1234, LARGE = 1 << 28 };

struct lab {
    const struct scene *scene;
    dpt_world *world;
    dpt_body body[BODIES];
    dpt_tool tool[TOOLS];
    uint64_t random;
    double centre[3], way[3], turn[4];
    enum offence offence;
    int report; /* where the tally goes before an offence; -1: nowhere */
    struct tally tally;
};

static double one(struct lab *lab)
{
    return random_in(&lab->random, -1.0, 1.0);
}

/* A code that is not DPT_OK: some are asked for, and the tally tells how many. */
static void result_is(struct lab *lab, dpt_result result)
{
    lab->tally.refused += result != DPT_OK && dpt_result_text(result) != NULL;
}

static void answer_is(struct lab *lab, const void *answer, size_t size)
{
    for (size_t i = 0; i < size; i++)
        lab->tally.answers =
            (lab->tally.answers ^ ((const unsigned char *)answer)[i]) * 0x100000001b3u;
}

static dpt_pose pose_now(struct lab *lab)
{
    dpt_pose pose;
    double size = 0.0;
    for (int k = 0; k < 4; k++)
        size += lab->turn[k] * lab->turn[k];
    for (int k = 0; k < 4; k++)
        pose.orientation[k] = lab->turn[k] / sqrt(size);
    memcpy(pose.position, lab->centre, sizeof pose.position);
    return pose;
}

static dpt_segment segment_now(struct lab *lab, double length)
{
    dpt_segment segment = { .radius = 0.002 };
    for (int k = 0; k < 3; k++) {
        segment.a[k] = lab->centre[k] - length * lab->turn[k];
        segment.b[k] = lab->centre[k] + length * lab->turn[k];
    }
    return segment;
}

/* A rigid tool of three parts, a free line, a ball. */
static void add_tool(struct lab *lab, int which)
{
    static const dpt_segment rigid[RIGID] = { { { -0.08, 0, 0 }, { 0.08, 0, 0 }, 0.004 },
                                              { { 0.08, 0, 0 }, { 0.1, 0.02, 0 }, 0.002 },
                                              { { 0.08, 0, 0 }, { 0.1, -0.02, 0 }, 0 } };
    static const dpt_segment line = { { -0.1, 0, 0 }, { 0.1, 0, 0 }, 0 };
    static const dpt_segment ball = { { 0, 0, 0.03 }, { 0, 0, 0.03 }, 0.01 };
    const dpt_segment *segments = which == 0 ? rigid : which == 1 ? &line : &ball;
    result_is(lab, dpt_tool_add(lab->world, segments, which == 0 ? RIGID : 1, &lab->tool[which]));
}

/* 0 where the machine does not have the kernel. */
static int open_lab(struct lab *lab, const struct scene *scene, uint32_t kernel)
{
    dpt_world_def def;
    dpt_baseline_def baseline;
    dpt_world_def_init(&def);
    dpt_baseline_def_init(&baseline);
    def.max_bodies = BODIES;
    def.max_tools = TOOLS;
    def.max_segments = SEGMENTS;
    def.method = scene->method;
    def.kernel = kernel;
    def.until = scene->until;
    baseline.parts = scene->parts;
    baseline.one_step = scene->one_step;
    def.baseline = &baseline;
    def.certificate_bytes = scene->certificate_bytes;
    def.strip = scene->strip;
    def.margin = 0.01;
    lab->scene = scene;
    dpt_result result = dpt_world_create(room, room_bytes, &def, &lab->world);
    lab->tally.unmade += result != DPT_OK && result != DPT_E_UNSUPPORTED;
    if (result != DPT_OK)
        return 0;
    lab->random = 1;
    for (int k = 0; k < 3; k++)
        lab->centre[k] = lab->way[k] = 0.1 * one(lab);
    for (int k = 0; k < 4; k++)
        lab->turn[k] = one(lab);
    for (int i = 0; i < BODIES; i++) {
        dpt_pose pose = { { 0.1 * i, 0.03 * i, 0.0 }, { 1.0, 0.0, 0.0, 0.0 } };
        const dpt_mesh *mesh = NULL;
        result_is(lab, dpt_mesh_open(meshes[i].compiled.bytes, meshes[i].compiled.size, &mesh));
        result_is(lab, dpt_body_add(lab->world, mesh, &pose, &lab->body[i]));
    }
    for (int i = 0; i < TOOLS; i++)
        add_tool(lab, i);
    return 1;
}

/* Through the meshes, which stand about the origin, and out on the other side. */
static void move(struct lab *lab, uint32_t tick)
{
    for (int k = 0; k < 3; k++) {
        lab->way[k] += 0.2 * one(lab) - 0.02 * lab->way[k] - 0.3 * lab->centre[k];
        lab->centre[k] += 1e-3 * lab->way[k];
    }
    for (int k = 0; k < 4; k++)
        lab->turn[k] = 0.999 * lab->turn[k] + 0.03 * one(lab);
    dpt_pose pose = pose_now(lab), body_pose = { { 0.2, 0.06, 0.0 }, { 1.0, 0.0, 0.0, 0.0 } };
    dpt_segment line = segment_now(lab, 0.2);
    body_pose.position[2] = 1e-4 * (double)(tick % 500);
    result_is(lab, dpt_body_set_pose(lab->world, lab->body[2], &body_pose));
    result_is(lab, dpt_tool_set_pose(lab->world, lab->tool[0], &pose));
    result_is(lab, dpt_tool_set_segments(lab->world, lab->tool[1], &line, 1));
    result_is(lab, dpt_tool_set_pose(lab->world, lab->tool[2], &pose));
}

/* What does not happen each tick, or should not. */
static void disturb(struct lab *lab, uint32_t tick)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    dpt_pose bad = identity;
    dpt_segment line = segment_now(lab, 0.1);
    bad.position[1] = NAN;
    line.b[2] = INFINITY;
    if (tick % 61 == 1)
        result_is(lab, dpt_tool_set_pose(lab->world, lab->tool[0], &bad));
    if (tick % 61 == 2)
        result_is(lab, dpt_tool_set_segments(lab->world, lab->tool[1], &line, 1));
    if (tick % 61 == 3)
        result_is(lab, dpt_body_set_pose(lab->world, lab->body[2], tick % 2 ? &bad : NULL));
    if (tick % 61 == 4)
        result_is(lab, dpt_body_set_pose(lab->world, lab->tool[0], &identity));
    if (tick % 97 == 50)
        result_is(lab, dpt_tool_teleport(lab->world, lab->tool[tick % TOOLS], &identity));
    if (tick % 101 == 50) {
        dpt_body *body = &lab->body[tick % BODIES];
        result_is(lab, dpt_body_remove(lab->world, *body));
        result_is(lab, dpt_body_set_pose(lab->world, *body, &identity));
        result_is(lab, dpt_body_add(lab->world, meshes[tick % BODIES].mesh, &identity, body));
    }
    if (tick % 103 == 50) {
        int which = (int)(tick % TOOLS);
        result_is(lab, dpt_tool_remove(lab->world, lab->tool[which]));
        add_tool(lab, which);
    }
    if (tick % 301 == 300)
        result_is(lab, dpt_world_reset(lab->world));
}

static void read_answers(struct lab *lab)
{
    for (uint32_t i = 0; i < TOOLS; i++) {
        dpt_hit hit = DPT_HIT_INIT, part = DPT_HIT_INIT;
        dpt_wrench wrench;
        dpt_overlap overlaps[4] = { { .size = sizeof *overlaps } };
        uint32_t count;
        result_is(lab, dpt_tool_get_hit(lab->world, lab->tool[i], &hit));
        result_is(lab, dpt_tool_get_segment_hit(lab->world, lab->tool[i], i == 0 ? 2 : 0, &part));
        result_is(lab, dpt_tool_get_wrench(lab->world, lab->tool[i], &wrench));
        answer_is(lab, &hit, sizeof hit);
        answer_is(lab, &part, sizeof part);
        result_is(lab, dpt_tool_get_strip(lab->world, lab->tool[i], 0, overlaps, 4, &count, NULL));
        answer_is(lab, &wrench, sizeof wrench);
        answer_is(lab, overlaps, sizeof overlaps);
        lab->tally.strips += count > 4;
        lab->tally.stale += hit.status == DPT_STATUS_STALE;
        lab->tally.local += hit.status == DPT_STATUS_LOCAL;
        lab->tally.exact += hit.status == DPT_STATUS_EXACT;
        lab->tally.crossing += (hit.flags & DPT_HIT_FLAG_CROSSING) != 0;
        lab->tally.forces += wrench.force[0] != 0.0;
    }
}

/* The calls without a world: of every method, the last of which they refuse. */
static void query(struct lab *lab, uint32_t tick)
{
    static const double radii[QUERIES] = { 0.0, 0.001, 0.01, 0.1 };
    const dpt_query_def def = { .size = sizeof def, .method = tick / 8 % 4 };
    const dpt_mesh *mesh = meshes[tick / 32 % BODIES].mesh;
    dpt_pose pose = pose_now(lab);
    dpt_hit hits[QUERIES] = { DPT_HIT_INIT };
    double ends[6 * QUERIES], corners[9], s, p[3], q[3];
    for (int i = 0; i < 6 * QUERIES; i++)
        ends[i] = 0.3 * one(lab);
    ends[7] = tick % 3 ? ends[7] : NAN;
    result_is(lab, dpt_query_segments(mesh, tick % 5 ? &pose : NULL, ends, tick % 7 ? radii : NULL,
                                      QUERIES, hits, &def));
    answer_is(lab, hits, sizeof hits);
    result_is(lab, dpt_mesh_get_triangle(mesh, tick, corners));
    double distance = dpt_segment_triangle(ends, ends + 9, &s, p, q);
    answer_is(lab, &distance, sizeof distance);
}

static void offend(struct lab *lab)
{
#ifdef CAN_FORBID_CALLS
    void *volatile block = NULL;
    struct timespec time;
    if (lab->report >= 0 && write(lab->report, &lab->tally, sizeof lab->tally) < 0)
        return;
    switch (lab->offence) {
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
    (void)lab;
#endif
}

static void run_ticks(struct lab *lab, uint32_t begin, uint32_t end)
{
    for (uint32_t tick = begin; tick < end; tick++) {
        dpt_step step = { .size = tick % 59 == 58 ? 4 : sizeof step };
        move(lab, tick);
        disturb(lab, tick);
        if (lab->offence != NONE && lab->tally.ticks == OFFENCE_AT)
            offend(lab);
        result_is(lab, dpt_world_step(lab->world, tick % 53 == 52 ? NAN : 1e-3, &step));
        read_answers(lab);
        if (tick % 8 == 0)
            query(lab, tick);
        lab->tally.ticks++;
    }
}

/* Every scene with every kernel that is here; with an offence, as far as it takes to commit it. */
static struct tally run(enum offence offence, int report)
{
    struct lab lab = { .offence = offence, .report = report };
    uint64_t before = allocations;
    for (uint32_t kernel = DPT_KERNEL_SCALAR; kernel <= DPT_KERNEL_NEON; kernel++)
        for (int i = 0; i < SCENES; i++)
            if ((offence == NONE || lab.tally.ticks <= OFFENCE_AT) &&
                open_lab(&lab, &scenes[i], kernel))
                run_ticks(&lab, 0, (uint32_t)part_of(scenes[i].ticks));
    lab.tally.allocations = allocations - before;
    return lab.tally;
}

static struct tally usual; /* without an offence, calls allowed */

/* Before anything is concluded from its silence: the run does what it says. */
static void the_run_walks_every_path(void)
{
    uint64_t answers = TOOLS * usual.ticks;
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
    printf("    %llu ticks; of the answers %.0f %% cross, %.0f %% stale; %llu codes\n",
           (unsigned long long)usual.ticks, 100.0 * (double)usual.crossing / (double)answers,
           100.0 * (double)usual.stale / (double)answers, (unsigned long long)usual.refused);
}

#ifdef CAN_COUNT_ALLOCATIONS
static void ticks_allocate_nothing(void)
{
    CHECK(usual.allocations == 0, "%llu calls", (unsigned long long)usual.allocations);
    struct tally tally = run(A_SMALL_BLOCK, -1);
    CHECK(tally.allocations == 2, "of a malloc and a free %llu are counted",
          (unsigned long long)tally.allocations);
}
#endif

#ifdef CAN_FORBID_CALLS
/* How a child ended, and what it wrote. */
struct ending {
    int status;
    size_t bytes;
    struct tally report[2];
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
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
           prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

static void be_the_child(enum offence offence, int report)
{
    const struct rlimit no_core = { 0, 0 };
    setrlimit(RLIMIT_CORE, &no_core);
    dup2(report, STDOUT_FILENO); /* a write is let through: what is printed is seen in the report */
    dup2(report, STDERR_FILENO);
    if (!forbid_calls())
        syscall(SYS_exit, REFUSED);
    struct tally tally = run(offence, report);
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
        ssize_t got = read(ends[0], (char *)ending.report + ending.bytes,
                           sizeof ending.report - ending.bytes);
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
    CHECK(signal == SIGKILL || signal == SIGSYS || (offence == A_CLOCK && signal == SIGSEGV),
          "offence %d: status %x", offence, ending.status);
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
    unsigned char *fresh =
        mmap(NULL, BYTES, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
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
    for (int i = 0; i < SCENES; i++) {
        struct lab lab = { .report = -1 };
        uint32_t ticks = scenes[i].ticks < TICKS ? scenes[i].ticks : TICKS;
        long least = -1, all = 0, begin = faults_until_now();
        if (!open_lab(&lab, &scenes[i], DPT_KERNEL_AUTO))
            continue;
        run_ticks(&lab, 0, FIRST);
        long first = faults_until_now() - begin;
        for (uint32_t round = 0; round < ROUNDS; round++) {
            long before = faults_until_now();
            run_ticks(&lab, round * ticks, (round + 1) * ticks);
            long faults = faults_until_now() - before;
            least = least < 0 || faults < least ? faults : least;
            all += faults;
        }
        CHECK(least == 0, "scene %d: at least %ld in %u ticks", i, least, ticks);
        printf("    page faults, scene %d: %ld to make it and for %d ticks, %ld in %u more\n", i,
               first, FIRST, all, ROUNDS * ticks);
    }
}
#endif

static int prepare(void)
{
    static const struct {
        const char *name;
        uint64_t triangles;
    } shapes[BODIES] = { { "torus", 1000 }, { "liver", 2000 }, { "membrane", 0 } };
    dpt_world_def def;
    dpt_baseline_def baseline;
    dpt_world_def_init(&def); /* larger in all but the parts */
    dpt_baseline_def_init(&baseline);
    def.method = DPT_METHOD_PAPER;
    def.baseline = &baseline;
    baseline.parts = 16;
    def.strip = DPT_STRIP_KIND_ROUTES;
    room_bytes = dpt_world_bytes(&def);
    room = malloc(room_bytes);
    for (int i = 0; i < BODIES; i++)
        if (!fixture_from_shape(&meshes[i], shapes[i].name, shapes[i].triangles))
            return 0;
    return room != NULL;
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    int ready = prepare();
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
    for (int i = 0; i < BODIES; i++)
        fixture_free(&meshes[i]);
    free(room);
    return check_report();
}
