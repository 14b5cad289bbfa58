/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Recordings: what is written is read again, from any byte on and up to any other, and nothing that was not written. A
 * recorder counts what it was given.
 */
#include "dynpoint/record.h"

#include <unistd.h>

#include "dynpoint/recorder.h"
#include "fuzz/calls/calls.h"

/* The bytes of dpt_record in its first release. */
#define RECORD_FIRST ((uint32_t)offsetof(dpt_record, depth))

enum { RECORDS = 6, ROOM = 8192, STRUCT_SIZE_MAX = 4096 };

/* The last recording that was written, and what is in it. */
static unsigned char recording[ROOM];
static size_t recording_bytes, first_record;
static dpt_record records[RECORDS];
static uint32_t record_count;
static char text[64];

static dpt_record draw_record(void)
{
    dpt_record record;
    uint64_t bits[sizeof record / 8];
    for (size_t i = 0; i < sizeof bits / sizeof *bits; i++)
        bits[i] = draw_bits();
    memcpy(&record, bits, sizeof record);
    record.size = sizeof record;
    return record;
}

static dpt_record_header draw_header(struct codes *codes)
{
    dpt_record_header header = { .size = sizeof header, .rate = draw_in(0.0, 10000.0) };
    header.began_ns = draw_bits();
    header.text_bytes = draw_below(sizeof text);
    memset(text, 'a' + (int)draw_below(26), sizeof text);
    header.text = draw_one_in(10) ? NULL : text;
    if (draw_one_in(20))
        header.rate = draw_odd_number();
    if (draw_one_in(20) && header.text_bytes)
        text[draw_below((uint32_t)header.text_bytes)] = '\0';
    if (draw_one_in(30))
        header.text_bytes = DPT_RECORD_TEXT_MAX + 1;
    may_fail(codes, !(header.rate >= 0.0 && header.rate <= 1e9), DPT_E_FINITE);
    const int is_long = header.text_bytes > DPT_RECORD_TEXT_MAX;
    may_fail(codes, is_long, DPT_E_LIMIT);
    may_fail(codes, !is_long && header.text_bytes && (!header.text || memchr(text, 0, header.text_bytes) != NULL),
             DPT_E_ARGUMENT);
    return header;
}

/* A whole recording, of none to six records. */
static void write_all(void)
{
    struct codes codes = { .count = 0 };
    const int no_header = draw_one_in(40), no_bytes = draw_one_in(40), no_count = draw_one_in(40);
    const dpt_record_header header = draw_header(&codes);
    const void *given =
        draw_input(0, &header, draw_size(sizeof header, sizeof header), sizeof header, sizeof header, &codes);
    may_fail(&codes, no_header, DPT_E_ARGUMENT);
    size_t written = 77;
    const size_t bytes = CALL(dpt_record_header_bytes, no_header ? NULL : given);
    HOLDS((bytes > 0) == !codes.count && bytes % 8 == 0, "%zu bytes", bytes);
    const size_t capacity = draw_one_in(10) ? draw_below((uint32_t)bytes + 8) : bytes;
    unsigned char *to = output_of(1, capacity);
    may_fail(&codes, no_bytes || no_count, DPT_E_ARGUMENT);
    may_fail(&codes, !codes.count && capacity < bytes, DPT_E_MEMORY);
    const dpt_result result = RESULT(dpt_record_header_write, no_header ? NULL : given, no_bytes ? NULL : to, capacity,
                                     no_count ? NULL : &written);
    expect(result, &codes);
    outputs_are_guarded(0, 2);
    if (result != DPT_OK) {
        HOLDS(output_is_untouched(1, 0) && written == 77, "a header that was refused");
        return;
    }
    HOLDS(written == bytes, "%zu bytes, and not %zu", written, bytes);
    memcpy(recording, to, bytes);
    first_record = bytes;
    record_count = draw_below(RECORDS + 1);
    for (uint32_t i = 0; i < record_count; i++)
        records[i] = draw_record();
    HOLDS(RESULT(dpt_record_write, records, record_count, recording + bytes, ROOM - bytes, &written) == DPT_OK,
          "%u records", record_count);
    HOLDS(written == record_count * CALL(dpt_record_bytes), "%zu bytes", written);
    recording_bytes = bytes + written;
}

/* One record more, or not. */
static void write_one(void)
{
    struct codes codes = { .count = 0 };
    const int no_record = draw_one_in(20), no_bytes = draw_one_in(20), no_count = draw_one_in(20);
    const dpt_record record = draw_record();
    const uint32_t size = draw_size(RECORD_FIRST, sizeof record);
    const void *given = draw_input(0, &record, size, RECORD_FIRST, sizeof record, &codes);
    const size_t bytes = CALL(dpt_record_bytes);
    const size_t capacity = draw_one_in(4) ? draw_below(2 * (uint32_t)bytes) : bytes;
    unsigned char *to = output_of(1, capacity);
    size_t written = 77;
    size_codes_of_output(size, RECORD_FIRST, 1, &codes);
    may_fail(&codes, no_record || no_bytes || no_count, DPT_E_ARGUMENT);
    may_fail(&codes, capacity < bytes, DPT_E_MEMORY);
    const dpt_result result = RESULT(dpt_record_write, no_record ? NULL : given, 1, no_bytes ? NULL : to, capacity,
                                     no_count ? NULL : &written);
    expect(result, &codes);
    outputs_are_guarded(0, 2);
    if (result != DPT_OK) {
        HOLDS(output_is_untouched(1, 0) && written == 77, "a record that was refused");
        return;
    }
    dpt_record again = { .size = sizeof again }, kept = record;
    if (size < sizeof kept)
        memset((unsigned char *)&kept + size, 0, sizeof kept - size);
    size_t at = 0;
    uint32_t count = 0;
    HOLDS(RESULT(dpt_record_read, to, bytes, &at, &again, 1, &count) == DPT_OK && count == 1 && at == bytes &&
              !memcmp(&again, &kept, sizeof kept),
          "another record is read");
}

/* Of a recording that may be cut, or damaged in one bit. */
static void read_header(void)
{
    struct codes codes = { .count = 0 };
    const int no_bytes = draw_one_in(30), no_header = draw_one_in(30), no_at = draw_one_in(30);
    const int is_damaged = draw_one_in(4);
    dpt_record_header now;
    const uint32_t size = draw_size(sizeof now, sizeof now);
    if (!first_record)
        return;
    const size_t cut = draw_one_in(3) ? draw_below((uint32_t)recording_bytes) : recording_bytes;
    const size_t bit = draw_below(8 * (uint32_t)first_record);
    unsigned char *bytes = output_of(1, cut);
    void *out = output_sized(0, size);
    size_t at = 77;
    memcpy(bytes, recording, cut);
    if (is_damaged && bit / 8 < cut)
        bytes[bit / 8] ^= (unsigned char)(1u << bit % 8);
    if (!no_header)
        size_codes_of_output(size, sizeof now, 0, &codes);
    may_fail(&codes, no_bytes || no_header || no_at, DPT_E_ARGUMENT);
    may_fail(&codes, cut < first_record, DPT_E_TRUNCATED);
    const dpt_result of_damage[] = { DPT_E_MAGIC,  DPT_E_VERSION,  DPT_E_LAYOUT,
                                     DPT_E_FINITE, DPT_E_CHECKSUM, DPT_E_TRUNCATED };
    for (int i = 0; i < 6; i++)
        may_fail(&codes, is_damaged && bit / 8 < cut, of_damage[i]);
    const dpt_result result =
        RESULT(dpt_record_header_read, no_bytes ? NULL : bytes, cut, no_header ? NULL : out, no_at ? NULL : &at);
    expect(result, &codes);
    outputs_are_guarded(0, 2);
    if (result != DPT_OK) {
        HOLDS((no_header || output_is_untouched(0, sizeof size)) && at == 77, "a refused header");
        return;
    }
    /* The pointer is none of the game's. */
    const uint64_t digest = run.digest;
    output_read(0, size, sizeof now, sizeof now, &now);
    run.digest = digest;
    HOLDS(at == first_record && now.text == (const char *)bytes + 48 && strlen(now.text) == now.text_bytes,
          "%zu bytes, a text of %zu", at, now.text_bytes);
}

static void read_some(void)
{
    struct codes codes = { .count = 0 };
    const int no_bytes = draw_one_in(30), no_out = draw_one_in(30), no_at = draw_one_in(30), no_count = draw_one_in(30);
    const uint32_t size = draw_size(RECORD_FIRST, sizeof(dpt_record));
    const int is_size = size >= RECORD_FIRST && size <= STRUCT_SIZE_MAX && size % 8 == 0;
    const uint32_t capacity = draw_below(RECORDS + 2);
    const size_t bytes = CALL(dpt_record_bytes);
    if (!first_record)
        return;
    const uint32_t from = draw_below(record_count + 1);
    const size_t begin = first_record + from * bytes;
    const size_t cut = draw_one_in(3) ? begin + draw_below((uint32_t)(recording_bytes - begin) + 1) : recording_bytes;
    const int is_behind = draw_one_in(20);
    size_t at = is_behind ? cut + 1 : begin;
    uint32_t count = 77, whole = (uint32_t)((cut - begin) / bytes);
    unsigned char *given = output_of(1, cut);
    unsigned char *out = output_of(0, is_size ? (size_t)size * (capacity + 1) : 8);
    memcpy(given, recording, cut);
    memcpy(out, &size, sizeof size);
    whole = whole < capacity ? whole : capacity;
    if (!no_out)
        size_codes_of_output(size, RECORD_FIRST, 1, &codes);
    may_fail(&codes, no_bytes || no_out || no_at || no_count || is_behind, DPT_E_ARGUMENT);
    const int is_wrong = codes.count > 0;
    may_fail(&codes, !is_wrong && !whole && capacity && cut > begin, DPT_E_TRUNCATED);
    call_with("record %llu of %llu, capacity %llu", from, record_count, capacity, 0);
    const dpt_result result = RESULT(dpt_record_read, no_bytes ? NULL : given, cut, no_at ? NULL : &at,
                                     no_out ? NULL : (dpt_record *)(void *)out, capacity, no_count ? NULL : &count);
    expect(result, &codes);
    outputs_are_guarded(0, 2);
    if (is_wrong) {
        HOLDS(output_is_untouched(0, sizeof size) && count == 77, "records that were refused");
        return;
    }
    HOLDS(count == whole && at == begin + whole * bytes, "%u records, up to %zu", count, at);
    for (uint32_t i = 0; i < count; i++)
        HOLDS(!memcmp(out + (size_t)i * size + sizeof size, (const unsigned char *)&records[from + i] + sizeof size,
                      (size < sizeof(dpt_record) ? size : sizeof(dpt_record)) - sizeof size),
              "record %u is another", from + i);
    HOLDS(output_is_untouched(0, count ? (size_t)count * size : sizeof size), "more was written");
}

/* Each starts a thread and ends it, so they are few. */
static void record_some(void)
{
    struct codes codes = { .count = 0 };
    char path[80];
    dpt_recorder *recorder = (dpt_recorder *)(void *)path;
    dpt_recorder_def def;
    dpt_recorder_counts now;
    if (!draw_one_in(8))
        return;
    snprintf(path, sizeof path, "%s.dpr", trace_path);
    const int no_path = draw_one_in(20), no_recorder = draw_one_in(20), no_def = draw_one_in(3);
    const dpt_record_header header = draw_header(&codes);
    CALL(dpt_recorder_def_defaults, &def, sizeof def);
    def.capacity = 2u << draw_below(8);
    def.wait = draw_below(2);
    if (draw_one_in(10))
        def.capacity += 1 + draw_below(100000000);
    if (draw_one_in(20))
        def.wait = 2;
    if (draw_one_in(20))
        def.reserved = 1;
    const void *given = NULL;
    if (!no_def) {
        given = draw_input(0, &def, draw_size(sizeof def, sizeof def), sizeof def, sizeof def, &codes);
        may_fail(&codes, def.capacity > 1u << 20 || (def.capacity & (def.capacity - 1)) || def.wait > 1 || def.reserved,
                 DPT_E_ARGUMENT);
    }
    may_fail(&codes, no_path || no_recorder, DPT_E_ARGUMENT);
    const dpt_result opened =
        RESULT(dpt_recorder_open, no_path ? NULL : path, &header, given, no_recorder ? NULL : &recorder);
    expect(opened, &codes);
    unlink(path);
    if (opened != DPT_OK) {
        HOLDS(no_recorder || !recorder, "a recorder that was refused");
        return;
    }
    uint64_t pushed = 0, dropped = 0;
    for (uint32_t left = draw_below(300); left; left--) {
        const dpt_record record = draw_record();
        const int no_record = draw_one_in(50);
        /* How fast the thread is, is no part of the game. */
        const uint64_t digest = run.digest;
        const dpt_result result = RESULT(dpt_recorder_push, recorder, no_record ? NULL : &record);
        run.digest = digest;
        HOLDS(result == (no_record ? DPT_E_ARGUMENT : DPT_OK) ||
                  (result == DPT_E_FULL && !no_record && (no_def || !def.wait)),
              "%s", dpt_result_name(result));
        pushed += !no_record;
        dropped += result == DPT_E_FULL;
    }
    const uint32_t size = draw_one_in(4) ? 4u : draw_size(sizeof now, sizeof now);
    void *out = output_sized(0, size);
    struct codes of_close = { .count = 0 };
    size_codes_of_output(size, sizeof now, 0, &of_close);
    const dpt_result closed = RESULT(dpt_recorder_close, recorder, out);
    expect(closed, &of_close);
    outputs_are_guarded(0, 1);
    if (closed != DPT_OK) {
        HOLDS(RESULT(dpt_recorder_close, recorder, NULL) == DPT_OK, "it is open still");
        return;
    }
    const uint64_t digest = run.digest;
    output_read(0, size, sizeof now, sizeof now, &now);
    run.digest = digest;
    HOLDS(now.pushed == pushed && now.dropped == dropped && now.written == pushed - dropped && !now.lost && !now.error,
          "%llu pushed, %llu written", (unsigned long long)now.pushed, (unsigned long long)now.written);
    met[MET_RECORDED] += now.written > 0;
}

static void defaults(void)
{
    dpt_recorder_def whole;
    const uint32_t size = draw_size(sizeof whole, sizeof whole);
    const int is_null = draw_one_in(20);
    void *out = output_of_defaults(0, size);
    CALL(dpt_recorder_def_defaults, is_null ? NULL : out, size);
    CALL(dpt_recorder_def_defaults, &whole, sizeof whole);
    defaults_must_hold(0, size, is_null, &whole, sizeof whole);
}

static void end(void)
{
    recording_bytes = first_record = 0;
    record_count = 0;
}

static const struct move moves[] = { { "write all", write_all, 2 },
                                     { "write one", write_one, 2 },
                                     { "read header", read_header, 2 },
                                     { "read some", read_some, 4 },
                                     { "record some", record_some, 2 },
                                     { "defaults", defaults, 1 },
                                     { NULL, NULL, 0 } };

const struct noun record_noun = { "record", NULL, end, moves };
