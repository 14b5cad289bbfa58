/* SPDX-License-Identifier: BSD-3-Clause */
#include "record/recording_file.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command_options.h"
#include "host/host_embed.h"
#include "platform/file.h"
#include "text/open_file.h"

/* Of a record of any kind: where its length is, and the least that has one. */
enum { AT_BYTES = 4, RECORD_BYTES_MIN = 24 };

/* The rest of a record of any kind, and as much again, so that the buffer is seldom filled. */
enum { BUFFER_BYTES = 2 * DPT_RECORD_BYTES_MAX };

int is_recording(const char *path)
{
    unsigned char bytes[16];
    struct file_status status;
    dpt_record_header header = { .size = sizeof header };
    size_t at;
    if (file_get_status(path, &status) != 0 || !status.is_regular)
        return 0;
    FILE *file = open_file(path, "rb");
    if (!file)
        return 0;
    const size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    return size >= 8 && dpt_record_header_read(bytes, size, &header, &at) != DPT_E_MAGIC;
}

/* Move what is left to the front, and read on. Returns 0 if there is nothing more, or no room. */
static int fill(struct recording_file *recording)
{
    if (recording->is_end || recording->size - recording->at == BUFFER_BYTES)
        return 0;
    recording->size -= recording->at;
    recording->base += recording->at;
    memmove(recording->buffer, recording->buffer + recording->at, recording->size);
    recording->at = 0;
    const size_t got = fread(recording->buffer + recording->size, 1, BUFFER_BYTES - recording->size, recording->file);
    recording->size += got;
    recording->is_end = recording->size < BUFFER_BYTES;
    return got > 0;
}

int recording_open(struct recording_file *recording, const char *command, const char *path)
{
    *recording =
        (struct recording_file){ .header.size = sizeof recording->header, .batch[0].size = sizeof *recording->batch };
    recording->buffer = malloc(BUFFER_BYTES);
    recording->text = malloc(DPT_RECORD_TEXT_MAX + 1);
    if (!recording->buffer || !recording->text)
        return complain(command, "memory ran out");
    recording->file = open_file(path, "rb");
    if (!recording->file)
        return complain(command, "%s: cannot be opened: %s", path, strerror(errno));
    fill(recording);
    if (ferror(recording->file))
        return complain(command, "%s: cannot be read: %s", path, strerror(errno));
    const dpt_result result =
        dpt_record_header_read(recording->buffer, recording->size, &recording->header, &recording->at);
    if (result != DPT_OK)
        return complain(command, "%s: byte 0 (header): %s", path, dpt_result_text(result));
    memcpy(recording->text, recording->header.text, recording->header.text_bytes + 1);
    recording->header.text = recording->text;
    return 0;
}

/* Try each byte from the next one on. Returns 1 with a sound record at `at`, 0 at the file's end. */
static int find_sound_record(struct recording_file *recording)
{
    dpt_record record = { .size = sizeof record };
    uint32_t count;
    for (recording->at++;; recording->at++) {
        if (recording->size - recording->at < DPT_RECORD_BYTES_MAX)
            fill(recording);
        if (recording->at >= recording->size)
            return 0;
        size_t at = recording->at;
        const size_t begin = at;
        dpt_record_read(recording->buffer, recording->size, &at, &record, 1, &count);
        if (at > begin)
            return 1;
    }
}

static uint32_t word_at(const unsigned char *from)
{
    return (uint32_t)from[0] | (uint32_t)from[1] << 8 | (uint32_t)from[2] << 16 | (uint32_t)from[3] << 24;
}

static int is_piece(const struct recording_file *recording, size_t at)
{
    return word_at(recording->buffer + at) == EMBED_KIND_PIECE;
}

/*
 * Where to stop, so that no piece is passed over: before the next one, or behind it if it is first. A wrong length leads
 * astray, but not before its own record was read and found damaged.
 */
static size_t end_of_run(const struct recording_file *recording)
{
    size_t at = recording->at;
    for (int i = 0; recording->wants_pieces && i < RECORDING_BATCH; i++) {
        const size_t left = recording->size - at;
        const size_t bytes = left >= RECORD_BYTES_MIN ? word_at(recording->buffer + at + AT_BYTES) : 0;
        if (bytes < RECORD_BYTES_MIN || bytes > left)
            return recording->size;
        if (is_piece(recording, at))
            return i ? at : at + bytes;
        at += bytes;
    }
    return recording->wants_pieces ? at : recording->size;
}

enum recording_item recording_next(struct recording_file *recording, dpt_record *record)
{
    while (recording->next == recording->count) {
        const size_t begin = recording->at, end = end_of_run(recording);
        recording->next = 0;
        const dpt_result result = dpt_record_read(recording->buffer, end, &recording->at, recording->batch,
                                                  RECORDING_BATCH, &recording->count);
        if (recording->count)
            break;
        if (recording->wants_pieces && recording->at > begin && is_piece(recording, begin)) {
            recording->byte = recording->base + begin;
            recording->piece = recording->buffer + begin;
            recording->piece_bytes = recording->at - begin;
            return RECORDING_PIECE;
        }
        if (recording->at > begin && end < recording->size)
            continue;
        if ((result == DPT_OK || result == DPT_E_TRUNCATED) && fill(recording))
            continue;
        recording->byte = recording->base + recording->at;
        if (result == DPT_OK)
            return RECORDING_END;
        const int is_found = find_sound_record(recording);
        recording->damaged = recording->base + recording->at - recording->byte;
        return result == DPT_E_TRUNCATED && !is_found ? RECORDING_CUT : RECORDING_DAMAGED;
    }
    *record = recording->batch[recording->next++];
    return RECORDING_RECORD;
}

void recording_close(struct recording_file *recording)
{
    if (recording->file)
        fclose(recording->file);
    free(recording->buffer);
    free(recording->text);
}

#define AT(field) offsetof(dpt_record, field)
#define U32(name, field)                                                                                               \
    {                                                                                                                  \
        name, AT(field), WORD_U32, 0                                                                                   \
    }
#define U64(name, field)                                                                                               \
    {                                                                                                                  \
        name, AT(field), WORD_U64, 0                                                                                   \
    }
#define F64(name, field)                                                                                               \
    {                                                                                                                  \
        name, AT(field), WORD_F64, 0                                                                                   \
    }
#define ITEM(name, field, i)                                                                                           \
    {                                                                                                                  \
        name, AT(field) + 8 * (i), WORD_F64, 0                                                                         \
    }
#define ANSWER(name, field, w)                                                                                         \
    {                                                                                                                  \
        name, AT(field), w, 1                                                                                          \
    }
#define PART(name, field, i)                                                                                           \
    {                                                                                                                  \
        name, AT(field) + 8 * (i), WORD_F64, 1                                                                         \
    }

/* clang-format off */
const struct record_field record_fields[] = {
    U64("number", number), U32("device", device), U64("sequence", sequence), U64("time_ns", time_ns), F64("dt", dt),
    U32("flags", flags), U32("status", status), U32("reasons", reasons), U32("code", code), U32("buttons", buttons),
    U32("fresh", fresh), U32("commands", commands),
    ITEM("x", pose, 0), ITEM("y", pose, 1), ITEM("z", pose, 2),
    ITEM("qw", pose, 3), ITEM("qx", pose, 4), ITEM("qy", pose, 5), ITEM("qz", pose, 6),
    ITEM("vx", velocity, 0), ITEM("vy", velocity, 1), ITEM("vz", velocity, 2),
    ITEM("wx", spin, 0), ITEM("wy", spin, 1), ITEM("wz", spin, 2),
    ITEM("joint0", joint, 0), ITEM("joint1", joint, 1), ITEM("joint2", joint, 2), ITEM("joint3", joint, 3),
    ITEM("joint4", joint, 4), ITEM("joint5", joint, 5), ITEM("joint6", joint, 6), ITEM("joint7", joint, 7),
    ANSWER("result", result, WORD_I32),
    PART("asked_fx", asked, 0), PART("asked_fy", asked, 1), PART("asked_fz", asked, 2),
    PART("asked_tx", asked, 3), PART("asked_ty", asked, 4), PART("asked_tz", asked, 5),
    ITEM("sent_fx", sent, 0), ITEM("sent_fy", sent, 1), ITEM("sent_fz", sent, 2),
    ITEM("sent_tx", sent, 3), ITEM("sent_ty", sent, 4), ITEM("sent_tz", sent, 5), U64("sent_ns", sent_ns),
    ANSWER("force_reason", force_reason, WORD_U32), ANSWER("force_flags", force_flags, WORD_U32),
    ANSWER("energy", energy, WORD_F64), ANSWER("lag", lag, WORD_F64),
    ANSWER("hit_status", hit_status, WORD_U32), ANSWER("contact", contact, WORD_U32),
    ANSWER("hit_flags", hit_flags, WORD_U32), ANSWER("triangle", triangle, WORD_U32),
    ANSWER("distance", distance, WORD_F64), ANSWER("gap", gap, WORD_F64),
    PART("point_x", point, 0), PART("point_y", point, 1), PART("point_z", point, 2),
    ANSWER("depth", depth, WORD_F64), ANSWER("inside", inside, WORD_F64),
    ANSWER("ruptures", ruptures, WORD_U32), ANSWER("layers", layers, WORD_U32),
    PART("proxy_x", proxy, 0), PART("proxy_y", proxy, 1), PART("proxy_z", proxy, 2),
    PART("proxy_qw", proxy, 3), PART("proxy_qx", proxy, 4), PART("proxy_qy", proxy, 5), PART("proxy_qz", proxy, 6),
    U64("late_ns", late_ns), U64("took_ns", took_ns)
};
/* clang-format on */

const size_t record_field_count = sizeof record_fields / sizeof *record_fields;

int record_field_is_same(const struct record_field *field, const dpt_record *a, const dpt_record *b)
{
    const size_t bytes = field->word == WORD_U32 || field->word == WORD_I32 ? 4 : 8;
    return !memcmp((const unsigned char *)a + field->at, (const unsigned char *)b + field->at, bytes);
}

void record_field_print(FILE *file, const struct record_field *field, const dpt_record *record, int is_json)
{
    const unsigned char *from = (const unsigned char *)record + field->at;
    uint32_t narrow;
    uint64_t wide;
    double number;
    switch (field->word) {
    case WORD_U32:
        memcpy(&narrow, from, sizeof narrow);
        fprintf(file, "%" PRIu32, narrow);
        break;
    case WORD_I32:
        memcpy(&narrow, from, sizeof narrow);
        fprintf(file, "%" PRId32, (int32_t)narrow);
        break;
    case WORD_U64:
        memcpy(&wide, from, sizeof wide);
        fprintf(file, "%" PRIu64, wide);
        break;
    case WORD_F64:
        memcpy(&number, from, sizeof number);
        if (is_json && !isfinite(number))
            fputs("null", file);
        else
            fprintf(file, "%.17g", number);
        break;
    }
}
