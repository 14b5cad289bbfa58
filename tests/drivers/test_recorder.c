/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The recorder: each record is in the file, or counted as dropped or lost; a push does nothing that could hold a servo
 * thread up; what the system refuses to write ends nothing.
 */
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "dynpoint/recorder.h"
#include "lib/check.h"

#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define CAN_FORBID_CALLS
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#endif

static const dpt_record_header header = {
    .size = sizeof header, .rate = 1000.0, .text = "scene=none", .text_bytes = 10
};

static char folder[] = "/tmp/dynpoint-recorder-XXXXXX";
static char path[64];

/* A record whose content follows from a number of the test's own. */
static dpt_record record_of(uint64_t k)
{
    dpt_record record = { .size = sizeof record, .sequence = k, .time_ns = 1000000 * k };
    uint64_t random = k;
    record.dt = random_in(&random, 0.0, 1.0);
    for (int i = 0; i < 3; i++) {
        record.asked.force[i] = random_in(&random, -5.0, 5.0);
        record.point[i] = random_in(&random, -1.0, 1.0);
    }
    return record;
}

static dpt_recorder *recorder_of(uint32_t capacity, uint32_t wait)
{
    dpt_recorder *recorder = NULL;
    dpt_recorder_def def;
    dpt_recorder_def_init(&def);
    def.capacity = capacity;
    def.wait = wait;
    const dpt_result result = dpt_recorder_open(path, &header, &def, &recorder);
    CHECK(result == DPT_OK && recorder, "%s", dpt_result_name(result));
    return recorder;
}

static void rest(long ns)
{
    const struct timespec time = { .tv_nsec = ns };
    nanosleep(&time, NULL);
}

/* What is in a recording. */
struct content {
    uint64_t records, wrong, gaps, missing, last;
    dpt_result end; /* what the last read said */
};

static struct content content_of(const unsigned char *bytes, size_t size)
{
    dpt_record_header told = { .size = sizeof told };
    dpt_record record = { .size = sizeof record };
    struct content content = { .records = 0 };
    uint64_t next = 0;
    uint32_t count = 1;
    size_t at = 0;
    content.end = dpt_record_header_read(bytes, size, &told, &at);
    while (content.end == DPT_OK && count) {
        content.end = dpt_record_read(bytes, size, &at, &record, 1, &count);
        if (content.end != DPT_OK || !count)
            break;
        dpt_record expected = record_of(record.sequence);
        expected.number = record.number;
        content.wrong +=
            memcmp(&record, &expected, sizeof record) != 0 || record.number < next || record.number != record.sequence;
        content.gaps += record.number != next;
        content.missing += record.number - next;
        content.records++;
        content.last = record.number;
        next = record.number + 1;
    }
    return content;
}

static struct content content_of_file(void)
{
    struct stat status;
    FILE *file = fopen(path, "rb");
    struct content content = { .end = DPT_E_OPEN };
    if (!file || fstat(fileno(file), &status) != 0)
        return content;
    unsigned char *bytes = malloc((size_t)status.st_size + 1);
    const size_t size = fread(bytes, 1, (size_t)status.st_size, file);
    content = content_of(bytes, size);
    free(bytes);
    fclose(file);
    return content;
}

static void check_counts(const dpt_recorder_counts *counts, uint64_t pushed)
{
    CHECK(counts->pushed == pushed && counts->written + counts->dropped + counts->lost == counts->pushed,
          "%llu pushed, %llu written, %llu dropped, %llu lost", (unsigned long long)counts->pushed,
          (unsigned long long)counts->written, (unsigned long long)counts->dropped, (unsigned long long)counts->lost);
}

static void a_ring_that_waits_loses_nothing(void)
{
    const uint64_t pushes = 50000;
    dpt_recorder_counts counts = { .size = sizeof counts };
    dpt_recorder *recorder = recorder_of(64, 1);
    for (uint64_t k = 0; k < pushes; k++) {
        const dpt_record record = record_of(k);
        CHECK(dpt_recorder_push(recorder, &record) == DPT_OK, "push");
    }
    CHECK(dpt_recorder_close(recorder, &counts) == DPT_OK, "close");
    check_counts(&counts, pushes);
    const struct content content = content_of_file();
    CHECK(content.end == DPT_OK && content.records == pushes && !content.wrong && !content.gaps,
          "%llu records, %llu wrong, %llu gaps", (unsigned long long)content.records, (unsigned long long)content.wrong,
          (unsigned long long)content.gaps);
    CHECK(counts.written == pushes && counts.bytes == dpt_record_header_bytes(&header) + pushes * dpt_record_bytes(),
          "%llu bytes", (unsigned long long)counts.bytes);
}

/* The other end of a pipe, which is read slowly. */
struct slow_reader {
    unsigned char *bytes;
    size_t size, room;
};

static void *read_slowly(void *given)
{
    struct slow_reader *reader = given;
    const int file = open(path, O_RDONLY);
    ssize_t got = file < 0 ? 0 : 1;
    while (got > 0 && reader->size < reader->room) {
        rest(300000);
        const size_t most = reader->room - reader->size;
        got = read(file, reader->bytes + reader->size, most < 16384 ? most : 16384);
        reader->size += got > 0 ? (size_t)got : 0;
    }
    if (file >= 0)
        close(file);
    return NULL;
}

/* In order, with gaps that are as large as what was dropped. */
static void a_slow_file_drops_and_counts(void)
{
    enum { PUSHES = 20000 };
    struct slow_reader reader = { .room = (size_t)32 << 20 };
    dpt_recorder_counts counts = { .size = sizeof counts };
    pthread_t thread;
    uint64_t refused = 0, last_taken = 0;
    unlink(path);
    reader.bytes = malloc(reader.room);
    CHECK(mkfifo(path, 0600) == 0 && pthread_create(&thread, NULL, read_slowly, &reader) == 0, "a pipe");
    dpt_recorder *recorder = recorder_of(32, 0);
    for (uint64_t k = 0; k < PUSHES; k++) {
        const dpt_record record = record_of(k);
        const dpt_result result = dpt_recorder_push(recorder, &record);
        CHECK(result == DPT_OK || result == DPT_E_FULL, "%s", dpt_result_name(result));
        refused += result == DPT_E_FULL;
        last_taken = result == DPT_OK ? k : last_taken;
        if (k % 200 == 0)
            rest(1000000);
    }
    CHECK(dpt_recorder_close(recorder, &counts) == DPT_OK, "close");
    pthread_join(thread, NULL);
    unlink(path);
    check_counts(&counts, PUSHES);
    const struct content content = content_of(reader.bytes, reader.size);
    CHECK(content.end == DPT_OK && content.records == counts.written && !content.wrong, "%llu records, %llu wrong",
          (unsigned long long)content.records, (unsigned long long)content.wrong);
    CHECK(refused == counts.dropped && refused > 0 && !counts.lost && content.last == last_taken,
          "%llu refused, %llu dropped", (unsigned long long)refused, (unsigned long long)counts.dropped);
    CHECK(content.missing + (PUSHES - 1 - last_taken) == refused && content.gaps > 1, "%llu missing in %llu gaps",
          (unsigned long long)content.missing, (unsigned long long)content.gaps);
    free(reader.bytes);
}

static off_t size_of_file(void)
{
    struct stat status;
    return stat(path, &status) == 0 ? status.st_size : -1;
}

/* Push until the file has grown; returns the number of the next record. */
static uint64_t push_until_it_grows(dpt_recorder *recorder, uint64_t next)
{
    const off_t before = size_of_file();
    for (int tries = 0; size_of_file() == before && tries < 20000; tries++) {
        const dpt_record record = record_of(next++);
        dpt_recorder_push(recorder, &record);
        rest(1000000);
    }
    CHECK(size_of_file() > before, "the file does not grow");
    return next;
}

static void a_file_can_be_read_while_it_grows(void)
{
    dpt_recorder *recorder = recorder_of(4096, 0);
    uint64_t next = push_until_it_grows(recorder, 0);
    const struct content content = content_of_file();
    CHECK((content.end == DPT_OK || content.end == DPT_E_TRUNCATED) && content.records > 0 && !content.wrong &&
              !content.gaps,
          "%llu records", (unsigned long long)content.records);
    CHECK(dpt_recorder_close(recorder, NULL) == DPT_OK, "close");
    CHECK(content_of_file().records == next, "%llu records at the end", (unsigned long long)content_of_file().records);
}

static void set_file_limit(rlim_t bytes)
{
    struct rlimit limit;
    getrlimit(RLIMIT_FSIZE, &limit);
    limit.rlim_cur = bytes;
    CHECK(setrlimit(RLIMIT_FSIZE, &limit) == 0, "no limit of files");
}

/*
 * A limit of files is a disk that is full: pushes go on, what is in the file stays readable, and what has room later is
 * written again.
 */
static void a_full_disk_ends_nothing(void)
{
    enum { FIRST = 1000, ROOM = 100, RING = 16 };
    struct rlimit before;
    dpt_recorder_counts counts = { .size = sizeof counts };
    getrlimit(RLIMIT_FSIZE, &before);
    dpt_recorder *recorder = recorder_of(RING, 1);
    set_file_limit(dpt_record_header_bytes(&header) + ROOM * dpt_record_bytes() + 77);
    for (uint64_t k = 0; k < FIRST; k++) {
        const dpt_record record = record_of(k);
        CHECK(dpt_recorder_push(recorder, &record) == DPT_OK, "push");
    }
    struct content content = content_of_file();
    CHECK(content.records > 0 && content.records <= ROOM && !content.wrong, "%llu records",
          (unsigned long long)content.records);
    set_file_limit(before.rlim_cur);
    const uint64_t pushes = push_until_it_grows(recorder, FIRST);
    CHECK(dpt_recorder_close(recorder, &counts) == DPT_E_WRITE && counts.error == EFBIG, "error %u", counts.error);
    check_counts(&counts, pushes);
    content = content_of_file();
    CHECK(content.end == DPT_OK && content.records == counts.written && !content.wrong && content.gaps > 0 &&
              content.missing == counts.lost && content.last == pushes - 1,
          "%llu records, %llu gaps, %llu missing, %llu lost", (unsigned long long)content.records,
          (unsigned long long)content.gaps, (unsigned long long)content.missing, (unsigned long long)counts.lost);
    /* When there is room again, a ring may wait to be taken, and as many may be on their way to the file. */
    CHECK(counts.lost >= FIRST - ROOM - 2 * RING && counts.dropped == 0, "%llu lost", (unsigned long long)counts.lost);
}

/* Half a record is not left at the end. */
static void a_disk_that_stays_full_leaves_whole_records(void)
{
    enum { PUSHES = 1000, ROOM = 10 };
    struct rlimit before;
    dpt_recorder_counts counts = { .size = sizeof counts };
    getrlimit(RLIMIT_FSIZE, &before);
    dpt_recorder *recorder = recorder_of(16, 1);
    set_file_limit(dpt_record_header_bytes(&header) + ROOM * dpt_record_bytes() + 77);
    for (uint64_t k = 0; k < PUSHES; k++) {
        const dpt_record record = record_of(k);
        CHECK(dpt_recorder_push(recorder, &record) == DPT_OK, "push");
    }
    CHECK(dpt_recorder_close(recorder, &counts) == DPT_E_WRITE && counts.error == EFBIG, "error %u", counts.error);
    set_file_limit(before.rlim_cur);
    check_counts(&counts, PUSHES);
    const struct content content = content_of_file();
    CHECK(content.end == DPT_OK && content.records == counts.written && (uint64_t)size_of_file() == counts.bytes,
          "%llu records, %llu written, %lld bytes", (unsigned long long)content.records,
          (unsigned long long)counts.written, (long long)size_of_file());
}

/* A device without an end of a record to go back to: nothing more is written behind half a record. */
static void a_pipe_that_breaks_ends_nothing(void)
{
    dpt_recorder_counts counts = { .size = sizeof counts };
    struct slow_reader reader = { .room = 16000 };
    pthread_t thread;
    reader.bytes = malloc(reader.room);
    CHECK(mkfifo(path, 0600) == 0 && pthread_create(&thread, NULL, read_slowly, &reader) == 0, "a pipe");
    dpt_recorder *recorder = recorder_of(64, 1);
    for (uint64_t k = 0; k < 2000; k++) {
        const dpt_record record = record_of(k);
        CHECK(dpt_recorder_push(recorder, &record) == DPT_OK, "push");
    }
    pthread_join(thread, NULL);
    CHECK(dpt_recorder_close(recorder, &counts) == DPT_E_WRITE && counts.error == EPIPE, "error %u", counts.error);
    check_counts(&counts, 2000);
    CHECK(counts.lost > 0, "%llu lost", (unsigned long long)counts.lost);
    const struct content content = content_of(reader.bytes, reader.size);
    CHECK(content.records > 0 && !content.wrong && content.end == DPT_E_TRUNCATED, "%llu records",
          (unsigned long long)content.records);
    unlink(path);
    free(reader.bytes);
}

static void what_cannot_be_opened_is_told(void)
{
    dpt_recorder *recorder = (dpt_recorder *)&header;
    dpt_recorder_counts counts = { .size = sizeof counts, .pushed = 5 };
    dpt_recorder_def def;
    dpt_record_header wrong = header;
    dpt_record record = record_of(0);
    struct rlimit before;
    CHECK(dpt_recorder_open("/nowhere/run.dpr", &header, NULL, &recorder) == DPT_E_OPEN && errno == ENOENT && !recorder,
          "no folder: %s", strerror(errno));
    if (access("/dev/full", W_OK) == 0)
        CHECK(dpt_recorder_open("/dev/full", &header, NULL, &recorder) == DPT_E_WRITE && errno == ENOSPC &&
                  access("/dev/full", W_OK) == 0,
              "a full device: %s", strerror(errno));
    getrlimit(RLIMIT_FSIZE, &before);
    set_file_limit(10);
    CHECK(dpt_recorder_open(path, &header, NULL, &recorder) == DPT_E_WRITE && errno == EFBIG && size_of_file() < 0,
          "half a header: %s", strerror(errno));
    set_file_limit(before.rlim_cur);
    wrong.rate = -1.0;
    CHECK(dpt_recorder_open(path, &wrong, NULL, &recorder) == DPT_E_FINITE && size_of_file() < 0, "a wrong header");
    for (uint32_t capacity = 0; capacity < 5000; capacity = capacity < 9 ? capacity + 1 : 5000) {
        dpt_recorder_def_init(&def);
        def.capacity = capacity;
        if (capacity == 2 || capacity == 4 || capacity == 8)
            continue;
        CHECK(dpt_recorder_open(path, &header, &def, &recorder) == DPT_E_ARGUMENT, "%u records", capacity);
    }
    CHECK(dpt_recorder_push(NULL, &record) == DPT_E_ARGUMENT, "no recorder");
    CHECK(dpt_recorder_close(NULL, &counts) == DPT_OK && counts.pushed == 0, "close nothing");
    recorder = recorder_of(4, 0);
    CHECK(dpt_recorder_push(recorder, NULL) == DPT_E_ARGUMENT, "no record");
    counts.size = 8;
    CHECK(dpt_recorder_close(recorder, &counts) == DPT_E_SIZE, "a wrong size");
    counts.size = sizeof counts;
    CHECK(dpt_recorder_close(recorder, &counts) == DPT_OK && counts.pushed == 0, "close");
}

/* A signal to the process must end the host's sleep, not the writer's: with the host's blocked, it waits. */
static volatile sig_atomic_t caught;

static void catch_it(int number)
{
    caught = number;
}

static void the_writer_takes_no_signal(void)
{
    sigset_t mine, before, pending;
    signal(SIGUSR1, catch_it);
    dpt_recorder *recorder = recorder_of(16, 0);
    sigemptyset(&mine);
    sigaddset(&mine, SIGUSR1);
    pthread_sigmask(SIG_BLOCK, &mine, &before);
    kill(getpid(), SIGUSR1);
    rest(20000000);
    sigpending(&pending);
    CHECK(!caught && sigismember(&pending, SIGUSR1), "the writer took it");
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    CHECK(caught == SIGUSR1, "it is lost");
    dpt_recorder_close(recorder, NULL);
}

#ifdef CAN_FORBID_CALLS
enum { FORBIDDEN_PUSHES = 20000 };

struct confined {
    dpt_recorder *recorder;
    int with_call;
    uint32_t is_done;
};

/* Push where the kernel ends a thread that calls it, but for read, write and exit. */
static void *push_confined(void *given)
{
    struct confined *confined = given;
    if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT) != 0)
        syscall(SYS_exit, 0);
    for (uint64_t k = 0; k < FORBIDDEN_PUSHES; k++) {
        const dpt_record record = record_of(k);
        dpt_recorder_push(confined->recorder, &record);
    }
    if (confined->with_call)
        syscall(SYS_getpid);
    __atomic_store_n(&confined->is_done, 1, __ATOMIC_RELEASE);
    syscall(SYS_exit, 0);
    return NULL;
}

static int is_done(int with_call)
{
    struct confined confined = { .recorder = recorder_of(256, 0), .with_call = with_call };
    dpt_recorder_counts counts = { .size = sizeof counts };
    pthread_t thread;
    CHECK(pthread_create(&thread, NULL, push_confined, &confined) == 0, "no thread");
    pthread_join(thread, NULL);
    CHECK(dpt_recorder_close(confined.recorder, &counts) == DPT_OK, "close");
    check_counts(&counts, counts.pushed);
    CHECK(content_of_file().records == counts.written && !content_of_file().wrong, "other records");
    return (int)__atomic_load_n(&confined.is_done, __ATOMIC_ACQUIRE);
}

static void a_push_calls_nobody(void)
{
    CHECK(is_done(0), "a push called the system, or it cannot be forbidden here");
    CHECK(!is_done(1), "a call is not noticed");
}
#endif

int main(void)
{
    if (!mkdtemp(folder))
        return 2;
    snprintf(path, sizeof path, "%s/run.dpr", folder);
    signal(SIGPIPE, SIG_DFL);
    TEST(what_cannot_be_opened_is_told);
    unlink(path);
    TEST(a_pipe_that_breaks_ends_nothing);
    TEST(a_ring_that_waits_loses_nothing);
    TEST(a_slow_file_drops_and_counts);
    TEST(a_file_can_be_read_while_it_grows);
    TEST(a_full_disk_ends_nothing);
    TEST(a_disk_that_stays_full_leaves_whole_records);
    TEST(the_writer_takes_no_signal);
#ifdef CAN_FORBID_CALLS
    TEST(a_push_calls_nobody);
#else
    SKIP("a_push_calls_nobody", "not on this system, or under a sanitizer");
#endif
    unlink(path);
    rmdir(folder);
    return check_report();
}
