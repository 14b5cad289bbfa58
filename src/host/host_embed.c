/* SPDX-License-Identifier: BSD-3-Clause */
#include "host/host_embed.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/crc32.h"
#include "base/return_if_error.h"
#include "platform/file.h"
#include "scene/host_file.h"
#include "scene/scene_list.h"
#include "scene/setting_words.h"
#include "text/open_file.h"

/* Small, so that damage leaves most of a file, and is found soon. */
enum { PIECE_BYTES = 65536 };

static void put(unsigned char *to, uint64_t value, int bytes)
{
    for (int i = 0; i < bytes; i++)
        to[i] = (unsigned char)(value >> 8 * i);
}

static dpt_result load_one(struct host_embed *embed, int which, const char *path, struct scene_bytes *bytes,
                           dpt_host_error *error)
{
    size_t size = 0;
    embed->file[which].bytes = host_file_load(path, &size, error);
    if (!embed->file[which].bytes)
        return error->code;
    embed->file[which].size = size;
    *bytes = (struct scene_bytes){ embed->file[which].bytes, size };
    return DPT_OK;
}

dpt_result host_embed_load(struct host_embed *embed, struct scene_def *def, const char *record, dpt_host_error *error)
{
    const char *name = setting_names_for(def->command)->embed;
    const int is_listed = scene_listed(def->path) != NULL;
    struct file_status status;
    if (file_get_status(record, &status) == 0 && !status.is_regular)
        return host_refuse(error, DPT_E_ARGUMENT, "%s: %s is no file to which a scene can be added", name, record);
    if (def->file)
        return host_refuse(error, DPT_E_UNSUPPORTED,
                           "%s: %s is a scene file, which names others: only a scene of one "
                           "compiled file, MESH.dpa or ARM.dpa, can be carried",
                           name, def->path);
    if (is_listed && !def->tool)
        host_note(error, "%s: note: %s: a scene by name needs none: the program makes it", def->path, name);
    if (!is_listed)
        DPT_TRY(load_one(embed, EMBED_SCENE, def->path, &def->scene_bytes, error));
    return def->tool ? load_one(embed, EMBED_TOOL, def->tool, &def->tool_bytes, error) : DPT_OK;
}

static int write_pieces(const struct host_embed *embed, unsigned char *piece, FILE *out)
{
    struct crc32 crc;
    uint64_t number = 0;
    crc32_init(&crc);
    for (uint32_t i = 0; i < EMBED_FILES; i++) {
        const unsigned char *from = embed->file[i].bytes;
        const size_t total = from ? embed->file[i].size : 0;
        for (size_t at = 0; at < total; at += PIECE_BYTES) {
            const size_t bytes = total - at < PIECE_BYTES ? total - at : PIECE_BYTES, size = embed_piece_size(bytes);
            memset(piece, 0, size);
            put(piece + EMBED_AT_KIND, EMBED_KIND_PIECE, 4);
            put(piece + EMBED_AT_BYTES, size, 4);
            put(piece + EMBED_AT_NUMBER, number++, 8);
            put(piece + EMBED_AT_FILE, i, 4);
            put(piece + EMBED_AT_PIECE_BYTES, bytes, 4);
            put(piece + EMBED_AT_OFFSET, at, 8);
            put(piece + EMBED_AT_TOTAL, total, 8);
            memcpy(piece + EMBED_AT_PIECE, from + at, bytes);
            put(piece + EMBED_AT_CRC, crc32_of(&crc, piece, size), 4);
            if (fwrite(piece, 1, size, out) != size)
                return 0;
        }
    }
    return fflush(out) == 0;
}

dpt_result host_embed_write(const struct host_embed *embed, const char *record, dpt_host_error *error)
{
    unsigned char *piece = malloc(embed_piece_size(PIECE_BYTES));
    FILE *out = piece ? open_file(record, "ab") : NULL;
    int reason = piece ? errno : ENOMEM, is_written = 0;
    struct file_status before;
    if (out && file_get_stream_status(out, &before) == 0) {
        is_written = write_pieces(embed, piece, out);
        reason = errno;
        if (!is_written)
            file_cut_stream(out, before.bytes);
    }
    if (out && fclose(out) != 0 && is_written) {
        is_written = 0;
        reason = errno;
    }
    free(piece);
    return is_written
               ? DPT_OK
               : host_refuse(error, DPT_E_WRITE, "%s: its scene could not be added: %s", record, strerror(reason));
}

void host_embed_free(struct host_embed *embed)
{
    for (int i = 0; i < EMBED_FILES; i++) {
        free(embed->file[i].bytes);
        embed->file[i].bytes = NULL;
    }
}
