/* SPDX-License-Identifier: BSD-3-Clause */
#include "record/recording_embed.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command_options.h"
#include "platform/file.h"

const char *const embedded_names[EMBED_FILES] = { "scene", "tool" };

static uint64_t get(const unsigned char *from, int bytes)
{
    uint64_t value = 0;
    for (int i = 0; i < bytes; i++)
        value |= (uint64_t)from[i] << 8 * i;
    return value;
}

static void fault(struct embedded_file *file, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 2, 3)))
#endif
    ;

/* The first one is kept: others may follow from it. */
static void fault(struct embedded_file *file, const char *format, ...)
{
    va_list arguments;
    if (file->fault[0])
        return;
    va_start(arguments, format);
    vsnprintf(file->fault, sizeof file->fault, format, arguments);
    va_end(arguments);
}

void recording_embed_begin(struct recording_embed *embed, struct recording_file *recording)
{
    struct file_status status;
    recording->wants_pieces = 1;
    if (file_get_stream_status(recording->file, &status) == 0 && status.is_regular)
        embed->room = status.bytes;
}

/* Of the first piece: how long the file is, and a place for it. Returns 0 after a fault. */
static int begin_file(struct recording_embed *embed, struct embedded_file *file, uint64_t total, uint64_t byte,
                      const char *name)
{
    void *bytes = NULL;
    if (total > embed->room) {
        fault(file,
              "byte %" PRIu64 ": this piece says that the %s has %" PRIu64
              " bytes, and so many are not in the recording",
              byte, name, total);
        return 0;
    }
    if (embed->keeps_bytes && (total >= SIZE_MAX || !(bytes = file_memory((size_t)total + 1)))) {
        fault(file, "byte %" PRIu64 ": memory for the %s ran out", byte, name);
        return 0;
    }
    embed->room -= total;
    file->total = total;
    file->bytes = bytes;
    return 1;
}

/* Returns 0 after a fault: the piece cannot come behind what there is. */
static int check_place(const struct recording_embed *embed, struct embedded_file *file, uint64_t offset, uint64_t bytes,
                       uint64_t byte, const char *name)
{
    if (offset > file->held && embed->is_damaged)
        fault(file, "byte %" PRIu64 ": damaged, and bytes %" PRIu64 " to %" PRIu64 " of the %s are missing with it",
              embed->damage, file->held, offset - 1, name);
    else if (offset > file->held)
        fault(file, "byte %" PRIu64 ": before this piece, bytes %" PRIu64 " to %" PRIu64 " of the %s are missing", byte,
              file->held, offset - 1, name);
    else if (offset < file->held)
        fault(file,
              "byte %" PRIu64 ": this piece is of byte %" PRIu64 " of the %s and on, which was there up to %" PRIu64,
              byte, offset, name, file->held);
    else if (bytes > file->total - offset)
        fault(file, "byte %" PRIu64 ": this piece goes on to byte %" PRIu64 " of the %s, which has %" PRIu64, byte,
              offset + bytes, name, file->total);
    else
        return 1;
    return 0;
}

static void take_piece(struct recording_embed *embed, const struct recording_file *recording)
{
    const unsigned char *piece = recording->piece;
    const uint64_t byte = recording->byte;
    struct crc32 crc;
    const uint64_t which = recording->piece_bytes < EMBED_AT_PIECE ? EMBED_SCENE : get(piece + EMBED_AT_FILE, 4);
    if (which >= EMBED_FILES)
        return;
    const char *name = embedded_names[which];
    struct embedded_file *file = &embed->file[which];
    file->pieces++;
    const size_t bytes = recording->piece_bytes < EMBED_AT_PIECE ? 0 : (size_t)get(piece + EMBED_AT_PIECE_BYTES, 4);
    if (!bytes || embed_piece_size(bytes) != recording->piece_bytes) {
        fault(file, "byte %" PRIu64 ": this piece of the %s has a length that cannot be", byte, name);
        return;
    }
    const uint64_t offset = get(piece + EMBED_AT_OFFSET, 8), total = get(piece + EMBED_AT_TOTAL, 8);
    if (file->fault[0] || (!file->total && !begin_file(embed, file, total, byte, name)))
        return;
    if (total != file->total) {
        fault(file,
              "byte %" PRIu64 ": this piece says that the %s has %" PRIu64 " bytes, and the one before said %" PRIu64,
              byte, name, total, file->total);
        return;
    }
    if (!check_place(embed, file, offset, bytes, byte, name))
        return;
    if (file->bytes)
        memcpy(file->bytes + file->held, piece + EMBED_AT_PIECE, bytes);
    crc32_init(&crc);
    file->crc32 = crc32_more(&crc, file->crc32, piece + EMBED_AT_PIECE, bytes);
    file->held += bytes;
}

/* Returns why the end came before that of a file. */
static const char *word_of_end(const struct recording_embed *embed, enum recording_item item)
{
    return embed->is_damaged ? "damaged" : item == RECORDING_CUT ? "it is cut off" : "it ends";
}

static void take_end(struct recording_embed *embed, const struct recording_file *recording, enum recording_item item)
{
    const uint64_t byte = embed->is_damaged ? embed->damage : recording->byte;
    for (int i = 0; i < EMBED_FILES; i++) {
        struct embedded_file *file = &embed->file[i];
        if (file->pieces && file->held < file->total)
            fault(file, "byte %" PRIu64 ": %s, and only %" PRIu64 " of %" PRIu64 " bytes of the %s are there", byte,
                  word_of_end(embed, item), file->held, file->total, embedded_names[i]);
    }
}

void recording_embed_take(struct recording_embed *embed, const struct recording_file *recording,
                          enum recording_item item)
{
    if (item == RECORDING_PIECE)
        take_piece(embed, recording);
    if (item == RECORDING_END || item == RECORDING_CUT)
        take_end(embed, recording, item);
    embed->is_damaged = item == RECORDING_DAMAGED;
    embed->damage = recording->byte;
}

static int check_file(struct embedded_file *file, const char *command, const char *path, const char *name,
                      uint64_t total, uint64_t crc32)
{
    if (file->fault[0])
        return complain(command, "%s: %s", path, file->fault);
    if (!file->pieces)
        return complain(command,
                        "%s: the %s that it should carry is not in it: its run did not end, or the end is lost", path,
                        name);
    if (file->total != total || file->crc32 != crc32)
        return complain(command,
                        "%s: the %s that it carries has %" PRIu64 " bytes and the CRC-32 %08" PRIx32
                        ", and by its header %" PRIu64 " and %08" PRIx64,
                        path, name, file->total, file->crc32, total, crc32);
    file->bytes[file->total] = 0;
    return 0;
}

int recording_embed_read(struct recording_embed *embed, const char *command, const char *path,
                         const struct scene_text *text, const int wanted[EMBED_FILES])
{
    const uint64_t totals[EMBED_FILES] = { text->scene_bytes, text->tool_bytes };
    const uint64_t crcs[EMBED_FILES] = { text->scene_crc32, text->tool_crc32 };
    struct recording_file recording;
    dpt_record record;
    enum recording_item item;
    int status = recording_open(&recording, command, path);
    if (status == 0) {
        embed->keeps_bytes = 1;
        recording_embed_begin(embed, &recording);
        do {
            item = recording_next(&recording, &record);
            recording_embed_take(embed, &recording, item);
        } while (item != RECORDING_END && item != RECORDING_CUT);
    }
    for (int i = 0; status == 0 && i < EMBED_FILES; i++)
        if (wanted[i])
            status = check_file(&embed->file[i], command, path, embedded_names[i], totals[i], crcs[i]);
    recording_close(&recording);
    return status;
}

void recording_embed_free(struct recording_embed *embed)
{
    for (int i = 0; i < EMBED_FILES; i++)
        free(embed->file[i].bytes);
}
