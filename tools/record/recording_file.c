/* SPDX-License-Identifier: BSD-3-Clause */
#include "record/recording_file.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "cli/command_options.h"

/* Of a record of any kind: where its length is, and the least that has one. */
enum { AT_BYTES = 4, RECORD_BYTES_MIN = 24 };

/* The rest of a record of any kind, and as much again, so that the buffer is seldom filled. */
enum { BUFFER_BYTES = 2 * DPT_RECORD_BYTES_MAX };

int is_recording(const char *path)
{
    unsigned char bytes[16];
    struct stat status;
    dpt_record_header header = { .size = sizeof header };
    size_t at;
    if (stat(path, &status) != 0 || !S_ISREG(status.st_mode))
        return 0;
    FILE *file = fopen(path, "rb");
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
    recording->file = fopen(path, "rb");
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
    return word_at(recording->buffer + at) == RECORDING_KIND_PIECE;
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
