/* SPDX-License-Identifier: BSD-3-Clause */
#include "view/view_stream.h"

#include <stdlib.h>
#include <string.h>

/* Where the page wants the data, once. */
static const char marker[] = "@DATA@";

int view_stream_add(struct view_stream *stream, void *bytes, size_t size)
{
    if (bytes && stream->count == stream->room) {
        const size_t room = stream->room ? 2 * stream->room : 256;
        struct view_message *larger = realloc(stream->message, room * sizeof *larger);
        if (larger) {
            stream->message = larger;
            stream->room = room;
        }
    }
    if (!bytes || stream->count == stream->room) {
        free(bytes);
        return 0;
    }
    stream->message[stream->count++] = (struct view_message){ bytes, size };
    stream->bytes += size;
    return 1;
}

static void put_word(unsigned char *to, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(value >> 8 * i);
}

int view_stream_add_end(struct view_stream *stream, const char *text)
{
    const size_t length = strlen(text);
    unsigned char *bytes = malloc(8 + length);
    if (bytes) {
        put_word(bytes, VIEW_MESSAGE_END);
        put_word(bytes + 4, (uint32_t)length);
        memcpy(bytes + 8, text, length);
    }
    return view_stream_add(stream, bytes, 8 + length);
}

/* Bytes on their way to base64, three at a time. */
struct encoder {
    FILE *file;
    unsigned char waiting[3];
    size_t count;
};

static void encode_waiting(struct encoder *to)
{
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const uint32_t bits = (uint32_t)to->waiting[0] << 16 | (uint32_t)to->waiting[1] << 8 | (uint32_t)to->waiting[2];
    char out[4];
    for (int i = 0; i < 4; i++)
        out[i] = letters[bits >> (18 - 6 * i) & 63];
    memset(out + to->count + 1, '=', 3 - to->count);
    fwrite(out, 1, sizeof out, to->file);
    memset(to->waiting, 0, sizeof to->waiting);
    to->count = 0;
}

static void encode(struct encoder *to, const void *bytes, size_t size)
{
    const unsigned char *from = bytes;
    for (size_t i = 0; i < size; i++) {
        to->waiting[to->count++] = from[i];
        if (to->count == sizeof to->waiting)
            encode_waiting(to);
    }
}

static void write_stream(const struct view_stream *stream, FILE *file)
{
    static const unsigned char zeros[8];
    struct encoder to = { .file = file };
    for (size_t i = 0; i < stream->count; i++) {
        const uint64_t size = stream->message[i].size;
        unsigned char length[8];
        put_word(length, (uint32_t)size);
        put_word(length + 4, (uint32_t)(size >> 32));
        encode(&to, length, sizeof length);
        encode(&to, stream->message[i].bytes, stream->message[i].size);
        encode(&to, zeros, (size_t)(-size & 7));
    }
    if (to.count)
        encode_waiting(&to);
}

int view_stream_write_page(const struct view_stream *stream, const struct view_page *page, FILE *file)
{
    const size_t length = sizeof marker - 1;
    for (size_t at = 0; at + length <= page->size; at++) {
        if (memcmp(page->html + at, marker, length) != 0)
            continue;
        fwrite(page->html, 1, at, file);
        write_stream(stream, file);
        fwrite(page->html + at + length, 1, page->size - at - length, file);
        return 1;
    }
    return 0;
}

void view_stream_free(struct view_stream *stream)
{
    for (size_t i = 0; i < stream->count; i++)
        free((void *)stream->message[i].bytes);
    free(stream->message);
}
