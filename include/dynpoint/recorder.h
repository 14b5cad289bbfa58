/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A recorder writes records (record.h) to a file while a loop runs, without holding the loop up. The servo thread
 * pushes records into a ring; a thread of the recorder takes them out and writes them.
 *
 *     dpt_recorder_open("run.dpr", &header, NULL, &recorder);
 *     in each tick:    dpt_recorder_push(recorder, &record);
 *     dpt_recorder_counts counts = { .size = sizeof counts };
 *     dpt_recorder_close(recorder, &counts);
 *
 * The file is written in place, at the path, so that it can be read while it grows and if the program is killed. Then
 * the records of the last milliseconds are missing, and the last one may be cut off. A file that was there is
 * overwritten.
 *
 * Threads: dpt_recorder_push belongs to one thread at a time. Open and close may be called from any thread, not during a
 * push. Different recorders may be used by different threads.
 */
#ifndef DYNPOINT_RECORDER_H
#define DYNPOINT_RECORDER_H

#include "dynpoint/record.h"

DPT_BEGIN

typedef struct dpt_recorder dpt_recorder;

/* dpt_recorder_def_init fills in the defaults, which are given last below. */
typedef struct dpt_recorder_def {
    uint32_t size;     /* sizeof(dpt_recorder_def), set by dpt_recorder_def_init */
    uint32_t capacity; /* records that the ring holds, a power of two, 2..2^20; 4096: 4 s at 1 kHz, 2 MB */
    /* 1: a push waits until there is room. For a device with a time of its own, to which nothing is late; 0 */
    uint32_t wait;
    uint32_t reserved; /* 0 */
} dpt_recorder_def;

/* What became of the records. Each pushed record is in exactly one of `written`, `dropped` and `lost`. */
typedef struct dpt_recorder_counts {
    uint32_t size;    /* sizeof(dpt_recorder_counts), set by the caller */
    uint32_t error;   /* the system's number (errno) of the first write that failed; 0: none did */
    uint64_t pushed;  /* records that were pushed */
    uint64_t written; /* records in the file */
    uint64_t dropped; /* records for which the ring had no room */
    uint64_t lost;    /* records that the system did not write, as on a full disk */
    uint64_t bytes;   /* length of the file */
} dpt_recorder_counts;

/* Fill in the first `size` bytes; what dpt_recorder_def_init calls with its own caller's sizeof. */
DPT_API void dpt_recorder_def_defaults(dpt_recorder_def *def, size_t size);

static inline void dpt_recorder_def_init(dpt_recorder_def *def)
{
    dpt_recorder_def_defaults(def, sizeof *def);
}

/*
 * Create or overwrite a file, write the header, and start the thread that writes. That thread blocks all signals.
 *   def        NULL: the defaults
 *   recorder   NULL after a failure
 *
 * DPT_E_OPEN: the file cannot be opened. DPT_E_WRITE: the header cannot be written; a new file is removed. For both,
 * errno says why. DPT_E_SYSTEM: there is no thread. Those of dpt_record_header_write.
 */
DPT_API dpt_result dpt_recorder_open(const char *path, const dpt_record_header *header, const dpt_recorder_def *def,
                                     dpt_recorder **recorder);

/*
 * Hand over a record. The recorder sets its running number. It never blocks, allocates or calls the system, unless
 * def->wait is 1 and the ring is full.
 *
 * DPT_E_FULL: the ring is full. The record is dropped, and the running number shows the gap.
 */
DPT_API dpt_result dpt_recorder_push(dpt_recorder *recorder, const dpt_record *record);

/*
 * Write what is in the ring, end the thread and close the file. The recorder is freed, also after an error of the
 * system. NULL is allowed.
 *   counts   may be NULL
 *
 * DPT_E_WRITE: some records could not be written; counts->error says why, counts->lost how many. A gap in the running
 * numbers shows them, unless they are the last ones. After an error the recorder goes on to try: what can be written
 * later is written.
 * DPT_E_SIZE: counts->size is wrong. The recorder is still open then.
 */
DPT_API dpt_result dpt_recorder_close(dpt_recorder *recorder, dpt_recorder_counts *counts);

DPT_END

#endif
