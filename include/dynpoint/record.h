/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Recordings of a haptic loop, tick by tick: the state that the device reported, the wrench that the scene asked for, the
 * wrench that acted, and what the tool touched. This header has the format (docs/format.md): a file header, then records,
 * each with a running number and a checksum. An incomplete recording can be read up to its end, and damage is reported
 * with its byte.
 *
 * These functions turn structs into bytes and back, in the caller's memory. recorder.h has a thread that writes a file.
 *
 *     dpt_record_header header = { .size = sizeof header };
 *     dpt_record records[64] = { { .size = sizeof *records } };
 *     size_t at;
 *     uint32_t count;
 *     dpt_record_header_read(bytes, size, &header, &at);
 *     while (dpt_record_read(bytes, size, &at, records, 64, &count) == DPT_OK && count > 0)
 *         ... records[0] to records[count - 1] ...
 *
 * Threads: every function may be called from any thread.
 */
#ifndef DYNPOINT_RECORD_H
#define DYNPOINT_RECORD_H

#include "dynpoint/types.h"

DPT_BEGIN

/* The longest text of a header. */
#define DPT_RECORD_TEXT_MAX 65536

/* The longest record of any kind and version. A reader that holds as many bytes can tell damage from a cut. */
#define DPT_RECORD_BYTES_MAX 1048576

/*
 * How a recording begins.
 *
 *   text   What the writer tells of the scene, in UTF-8; `dynpoint run` writes lines "key=value" (docs/format.md). It
 *          has no zero. NULL is no text. Of a header that was read it points into the recording, and a zero follows it
 */
typedef struct dpt_record_header {
    uint32_t size;           /* sizeof(dpt_record_header), set by the caller */
    uint32_t writer_version; /* DPT_VERSION_NUMBER of the library that wrote it; not used for writing */
    double rate;             /* ticks a second, Hz, 0..1e9; 0: not known */
    uint64_t began_ns;       /* time of day of its beginning, ns since 1970, UTC; 0: not known */
    const char *text;
    size_t text_bytes; /* length of the text, at most DPT_RECORD_TEXT_MAX */
} dpt_record_header;

/* Bits of dpt_record.flags. */
enum {
    /* The tool was moved to this sample. Without it the fields from `result` to `point` that are answers are 0. */
    DPT_RECORD_FLAG_FELT = 1,
    /* A body that gives way was held where it was (springs.h), because it could not be moved. */
    DPT_RECORD_FLAG_BODY_HELD = 2
};

/*
 * One tick. All numbers come back as they were written, bit for bit. So those of a broken device may be NaN.
 *
 * Which wrench is which: `asked` is the answer to this record's sample, before the guard. `sent` is what acted since
 * the sample before: the device took it after an earlier record's answer, and the guard had changed it.
 *
 *   device     number of the device and of its tool, from 0
 *   number     running number. It also counts records that were dropped, so a gap shows what is missing
 *   time_ns    when the sample was taken, as in dpt_device_state
 *   sent_ns    when the device took `sent`, on the same clock; 0 if there is none
 *   late_ns    from the deadline to the tick; 0 for a device with a time of its own
 *   took_ns    how long the step took; 0: not measured
 *   dt         the step's length, s
 *   result     of the host's tick, a dpt_result
 *   status     to `fresh`: as in dpt_device_state
 *   commands   how many commands the device took since the record before that was felt
 *   joint      as in dpt_device_state
 *   proxy      of the tool, in the world, as dpt_tool_get_proxy
 *   gap        valid if hit_flags has DPT_HIT_FLAG_GAP
 *   energy     that the law stores, J
 *   lag        of the proxy, m
 *   point      the nearest point of the mesh, in the world, m
 *   depth      of a needle's tip beyond the entry of its first channel, m; 0: it is in none (insertion.h)
 *   inside     length of its shaft inside of all bodies, m
 *   ruptures   walls that are open in the channels that it is in
 *   layers     of these bodies, that its tip has gone into and not come back from
 */
typedef struct dpt_record {
    uint32_t size; /* sizeof(dpt_record), set by the caller; of an array, in the first item */
    uint32_t device;
    uint64_t number;
    uint64_t sequence;
    uint64_t time_ns;
    uint64_t sent_ns;
    uint64_t late_ns;
    uint64_t took_ns;
    double dt;
    uint32_t flags; /* DPT_RECORD_FLAG_... */
    int32_t result;
    uint32_t status;  /* DPT_DEVICE_STATUS_... */
    uint32_t reasons; /* DPT_REASON_... */
    uint32_t code;
    uint32_t buttons;
    uint32_t fresh;
    uint32_t commands;
    uint32_t force_reason; /* DPT_FORCE_... */
    uint32_t force_flags;  /* DPT_FORCE_FLAG_... */
    uint32_t hit_status;   /* DPT_STATUS_... */
    uint32_t contact;      /* DPT_CONTACT_... */
    uint32_t hit_flags;    /* DPT_HIT_FLAG_... */
    uint32_t triangle;
    dpt_pose pose;      /* of the device, in its frame */
    double velocity[3]; /* of the device, m/s */
    double spin[3];     /* of the device, rad/s */
    double joint[DPT_JOINTS_MAX];
    dpt_wrench asked; /* in the device's frame */
    dpt_wrench sent;  /* in the device's frame */
    dpt_pose proxy;
    double distance; /* m */
    double gap;      /* m */
    double energy;
    double lag;
    double point[3];
    double depth;
    double inside;
    uint32_t ruptures;
    uint32_t layers;
} dpt_record;

/* The bytes of a header, a multiple of 8; 0 for one that cannot be written. */
DPT_API size_t dpt_record_header_bytes(const dpt_record_header *header);

/*
 * Write a header.
 *   written   dpt_record_header_bytes(header)
 *
 * DPT_E_FINITE: the rate is out of range. DPT_E_LIMIT: the text is too long. DPT_E_ARGUMENT: it has a zero in it.
 * DPT_E_MEMORY: it does not fit into `capacity` bytes.
 */
DPT_API dpt_result dpt_record_header_write(const dpt_record_header *header, void *bytes, size_t capacity,
                                           size_t *written);

/*
 * Read a header. The bytes may be aligned anyhow, and go on with records or not.
 *   at   where the first record begins
 *
 * DPT_E_MAGIC: this is no recording. DPT_E_VERSION: it is newer than this library. DPT_E_TRUNCATED: it is cut off within
 * the header. DPT_E_LAYOUT, DPT_E_CHECKSUM, DPT_E_FINITE: it is damaged.
 */
DPT_API dpt_result dpt_record_header_read(const void *bytes, size_t size, dpt_record_header *header, size_t *at);

/* The bytes of one record as this release writes it, a multiple of 8. */
DPT_API size_t dpt_record_bytes(void);

/*
 * Write `count` records, one after the other. It takes 8 KiB of stack, and some microseconds beside the records' own
 * time, so write several at once where you can.
 *   written   count times dpt_record_bytes()
 *
 * DPT_E_MEMORY: they do not fit into `capacity` bytes; nothing was written.
 */
DPT_API dpt_result dpt_record_write(const dpt_record *records, uint32_t count, void *bytes, size_t capacity,
                                    size_t *written);

/*
 * Read records from byte *at on, until `capacity` are read or one is not sound. Records of kinds that this release does
 * not know are skipped. Of a newer release's records this one reads what it knows; what an older one's lack is 0.
 *   at      moved behind what was read: to the next record, or to the one that is not sound
 *   count   how many were read. 0 with DPT_OK: *at is the end of the bytes
 *
 * If no record was read because the one at *at is not sound:
 *   DPT_E_TRUNCATED   it is cut off; with more bytes it may be whole
 *   DPT_E_LAYOUT, DPT_E_CHECKSUM   it is damaged. To find those behind it, try from each next byte on
 * A damaged length can look like a cut. It is damage if a sound record follows.
 */
DPT_API dpt_result dpt_record_read(const void *bytes, size_t size, size_t *at, dpt_record *records, uint32_t capacity,
                                   uint32_t *count);

DPT_END

#endif
