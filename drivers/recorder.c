/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The recorder (recorder.h): a ring with one producer, the servo thread, and one consumer, the thread that writes. Each
 * advances an index of its own. The consumer looks for records every few milliseconds, so that the producer need not
 * wake it, which would be a call of the system.
 */
#include "dynpoint/recorder.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/return_if_error.h"
#include "base/sized.h"
#include "platform/clock.h"
#include "platform/file.h"
#include "platform/thread.h"

enum { CAPACITY_MAX = 1 << 20, BLOCK_RECORDS = 128 };

/* State of the thread. */
enum { STARTING, RUNNING, FAILED };

enum { WRITER_PAUSE = 4000000, PUSH_PAUSE = 100000 }; /* ns */

struct dpt_recorder {
    dpt_recorder_def def;
    int file;
    int is_broken;        /* the end of the file is no longer that of a record, and cannot be made so */
    unsigned char *block; /* bytes to write */
    size_t block_bytes;   /* of the header at first, then of some records */
    dpt_record *ring;     /* def.capacity places */
    uint32_t must_end;    /* set by close, read atomically */
    uint32_t state;       /* set by the thread, read atomically */
    pthread_t thread;
    dpt_recorder_counts counts; /* pushed, dropped: of the producer; the others: of the thread */
    unsigned char apart_from_head[64];
    uint32_t head; /* records pushed, modulo 2^32; of the producer, read atomically */
    unsigned char apart_from_tail[64];
    uint32_t tail; /* records taken, modulo 2^32; of the thread, read atomically */
    unsigned char apart_from_end[64];
};

void dpt_recorder_def_defaults(dpt_recorder_def *def, size_t size)
{
    const dpt_recorder_def defaults = { .capacity = 4096 };
    sized_defaults(def, size, &defaults, sizeof defaults);
}

/* Write all bytes. Returns 0, or errno. */
static int write_all(int file, const unsigned char *bytes, size_t size)
{
    while (size > 0) {
        const long written = file_write(file, bytes, size);
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0)
            return written < 0 ? errno : EIO;
        bytes += written;
        size -= (size_t)written;
    }
    return 0;
}

/* Write the block, which has `records` records. After an error the file is cut back to what was whole. */
static void write_block(dpt_recorder *recorder, uint32_t records)
{
    dpt_recorder_counts *counts = &recorder->counts;
    int error = recorder->is_broken ? EPIPE : write_all(recorder->file, recorder->block, recorder->block_bytes);
    if (!error) {
        counts->written += records;
        counts->bytes += recorder->block_bytes;
        return;
    }
    counts->lost += records;
    if (!counts->error)
        counts->error = (uint32_t)error;
    if (file_cut(recorder->file, counts->bytes) != 0)
        recorder->is_broken = 1;
}

/* Write some of the records that are in the ring. Returns 0 if there were none. */
static int drain(dpt_recorder *recorder)
{
    const uint32_t head = __atomic_load_n(&recorder->head, __ATOMIC_ACQUIRE);
    const uint32_t tail = recorder->tail, begin = tail & (recorder->def.capacity - 1);
    uint32_t count = head - tail;
    if (count > recorder->def.capacity - begin)
        count = recorder->def.capacity - begin;
    if (count > BLOCK_RECORDS)
        count = BLOCK_RECORDS;
    if (count == 0)
        return 0;
    dpt_record_write(recorder->ring + begin, count, recorder->block, BLOCK_RECORDS * dpt_record_bytes(),
                     &recorder->block_bytes);
    __atomic_store_n(&recorder->tail, tail + count, __ATOMIC_RELEASE);
    write_block(recorder, count);
    return 1;
}

static void *write_records(void *given)
{
    dpt_recorder *recorder = given;
    write_block(recorder, 0);
    const int has_failed = recorder->counts.error != 0;
    __atomic_store_n(&recorder->state, has_failed ? FAILED : RUNNING, __ATOMIC_RELEASE);
    while (!has_failed) {
        /* Read before the ring: what was pushed before close is drained. */
        const uint32_t must_end = __atomic_load_n(&recorder->must_end, __ATOMIC_ACQUIRE);
        if (drain(recorder))
            continue;
        if (must_end)
            break;
        clock_sleep(WRITER_PAUSE);
    }
    return NULL;
}

/* Start the thread, and wait until it runs. */
static dpt_result start(dpt_recorder *recorder)
{
    if (thread_start(&recorder->thread, write_records, recorder))
        return DPT_E_SYSTEM;
    uint32_t state;
    while ((state = __atomic_load_n(&recorder->state, __ATOMIC_ACQUIRE)) == STARTING)
        clock_sleep(PUSH_PAUSE);
    if (state == RUNNING)
        return DPT_OK;
    pthread_join(recorder->thread, NULL);
    return DPT_E_WRITE;
}

static void release(dpt_recorder *recorder)
{
    free(recorder->ring);
    free(recorder->block);
    free(recorder);
}

/* Allocate all memory and write to each page of it, so that no push waits for one. */
static dpt_recorder *allocate(const dpt_recorder_def *def, const dpt_record_header *header)
{
    const size_t header_bytes = dpt_record_header_bytes(header);
    const size_t records_bytes = BLOCK_RECORDS * dpt_record_bytes();
    const size_t block_bytes = header_bytes > records_bytes ? header_bytes : records_bytes;
    dpt_recorder *recorder = calloc(1, sizeof *recorder);
    if (!recorder)
        return NULL;
    recorder->def = *def;
    recorder->file = -1;
    recorder->block = malloc(block_bytes);
    recorder->ring = malloc(def->capacity * sizeof *recorder->ring);
    if (!recorder->block || !recorder->ring) {
        release(recorder);
        return NULL;
    }
    memset(recorder->ring, 0xff, def->capacity * sizeof *recorder->ring);
    dpt_record_header_write(header, recorder->block, block_bytes, &recorder->block_bytes);
    return recorder;
}

/* Open the file and start. */
static dpt_result begin(dpt_recorder *recorder, const char *path)
{
    struct file_status status;
    const int is_new = file_get_status(path, &status) != 0;
    recorder->file = file_open_write(path);
    if (recorder->file < 0)
        return DPT_E_OPEN;
    const dpt_result result = start(recorder);
    if (result == DPT_OK)
        return DPT_OK;
    close(recorder->file);
    if (is_new)
        file_remove(path);
    errno = (int)recorder->counts.error;
    return result;
}

dpt_result dpt_recorder_open(const char *path, const dpt_record_header *header, const dpt_recorder_def *given,
                             dpt_recorder **out)
{
    dpt_recorder_def def;
    size_t ignored;
    unsigned char none;
    if (out)
        *out = NULL;
    if (!path || !out)
        return DPT_E_ARGUMENT;
    dpt_recorder_def_init(&def);
    if (given)
        DPT_TRY(sized_read(given, sizeof def, &def, sizeof def));
    if (def.capacity < 2 || def.capacity > CAPACITY_MAX || (def.capacity & (def.capacity - 1)) || def.wait > 1 ||
        def.reserved)
        return DPT_E_ARGUMENT;
    /* There is no room, so this only says what is wrong with the header. */
    const dpt_result of_header = dpt_record_header_write(header, &none, 0, &ignored);
    if (of_header != DPT_E_MEMORY)
        return of_header;
    dpt_recorder *recorder = allocate(&def, header);
    if (!recorder)
        return DPT_E_MEMORY;
    const dpt_result result = begin(recorder, path);
    if (result != DPT_OK) {
        const int error = errno;
        release(recorder);
        errno = error;
        return result;
    }
    *out = recorder;
    return DPT_OK;
}

dpt_result dpt_recorder_push(dpt_recorder *recorder, const dpt_record *given)
{
    dpt_record record = { .size = sizeof record };
    if (!recorder || !given)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_read(given, sizeof record, &record, sizeof record));
    const uint32_t head = recorder->head, capacity = recorder->def.capacity;
    record.number = recorder->counts.pushed++;
    while (head - __atomic_load_n(&recorder->tail, __ATOMIC_ACQUIRE) == capacity) {
        if (!recorder->def.wait) {
            recorder->counts.dropped++;
            return DPT_E_FULL;
        }
        clock_sleep(PUSH_PAUSE);
    }
    recorder->ring[head & (capacity - 1)] = record;
    __atomic_store_n(&recorder->head, head + 1, __ATOMIC_RELEASE);
    return DPT_OK;
}

dpt_result dpt_recorder_close(dpt_recorder *recorder, dpt_recorder_counts *counts)
{
    if (counts)
        DPT_TRY(sized_check(counts, sizeof *counts, 0));
    if (!recorder) {
        if (counts)
            sized_write(counts, counts->size, &(dpt_recorder_counts){ 0 }, sizeof *counts);
        return DPT_OK;
    }
    __atomic_store_n(&recorder->must_end, 1, __ATOMIC_RELEASE);
    pthread_join(recorder->thread, NULL);
    if (close(recorder->file) != 0 && !recorder->counts.error)
        recorder->counts.error = (uint32_t)errno;
    const dpt_result result = recorder->counts.error ? DPT_E_WRITE : DPT_OK;
    if (counts)
        sized_write(counts, counts->size, &recorder->counts, sizeof recorder->counts);
    release(recorder);
    return result;
}
