/* SPDX-License-Identifier: BSD-3-Clause */
#include "view/view_stream.h"

#include <stdlib.h>
#include <string.h>

#include "dynpoint/exchange.h"
#include "view/server/view_server.h"

/* Where the page wants the data, once. */
static const char marker[] = "@DATA@";

int view_stream_add(struct view_stream *stream, void *bytes, size_t size)
{
    if (bytes && stream->count == stream->room) {
        const size_t room = stream->room ? 2 * stream->room : 256;
        struct view_message *grown = realloc(stream->message, room * sizeof *grown);
        if (grown) {
            stream->message = grown;
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

static unsigned char *put4(unsigned char *to, uint32_t value)
{
    for (uint32_t i = 0; i < 4; i++)
        to[i] = (unsigned char)(value >> 8 * i);
    return to + 4;
}

static unsigned char *put8(unsigned char *to, uint64_t value)
{
    for (uint32_t i = 0; i < 8; i++)
        to[i] = (unsigned char)(value >> 8 * i);
    return to + 8;
}

static unsigned char *put_double(unsigned char *to, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return put8(to, bits);
}

static unsigned char *put_float(unsigned char *to, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return put4(to, bits);
}

size_t view_frame_bytes(size_t snapshot_bytes, size_t ticks)
{
    return VIEW_HEADER_BYTES + snapshot_bytes + ticks * VIEW_TICK_BYTES;
}

void view_frame_put_header(const struct view_frame_header *header, unsigned char *to)
{
    to = put4(to, 2); /* the kind: a frame */
    to = put4(to, header->snapshot_bytes);
    to = put4(to, header->ticks);
    to = put4(to, 0);
    to = put8(to, header->number);
    to = put8(to, header->dropped);
    to = put8(to, header->ticks_lost);
    to = put_double(to, header->haptic_hz);
    to = put_double(to, header->physics_hz);
    to = put_double(to, header->view_hz);
    to = put_double(to, header->late_p99);
    put_double(to, header->took_p99);
}

void view_frame_put_tick(const struct view_tick *tick, unsigned char *to)
{
    to = put_double(to, tick->time);
    to = put_float(to, tick->force);
    to = put_float(to, tick->depth);
    to = put_float(to, tick->energy);
    to = put_float(to, tick->late);
    to = put_float(to, tick->took);
    to = put4(to, tick->contact);
    to = put4(to, tick->reason);
    put_float(to, tick->opening);
}

enum { PERCENTILE_TICKS = 1024 };

/*
 * Vertices go with a snapshot while they move and for a while after, so that the last ones arrive even if a snapshot is
 * dropped; and now and then, for viewers who come later.
 */
#define MOVED_FOR_NS   500000000u
#define VERTICES_EVERY 120u

/* A snapshot on its way. */
struct place {
    unsigned char *bytes;
    size_t size;
    uint64_t number, ns, steps, physics_steps;
};

struct view_feed {
    const dpt_world *world;
    dpt_snapshot_def def;
    uint32_t max_vertices;
    size_t capacity;
    dpt_latest latest;
    struct place place[DPT_LATEST_PLACES];
    /* A ring of ticks; each index is written by one thread. */
    struct view_tick tick[VIEW_FEED_TICKS];
    uint64_t ticks_written, ticks_read, ticks_lost;
    /* Of the haptic thread. */
    uint64_t made, steps, next_ns, moved_ns;
    int has_moved;
    /* Of the view thread. */
    uint64_t taken, rate_ns, rate_steps, rate_physics_steps, rate_taken;
    double haptic_hz, physics_hz, view_hz;
    float late[PERCENTILE_TICKS], took[PERCENTILE_TICKS], sorted[PERCENTILE_TICKS];
    uint64_t heard;
    unsigned char *frame;
};

struct view_feed *view_feed_open(const dpt_world *world, uint32_t max_vertices)
{
    struct view_feed *feed = calloc(1, sizeof *feed);
    if (!feed)
        return NULL;
    feed->world = world;
    feed->max_vertices = max_vertices;
    dpt_snapshot_def_init(&feed->def);
    feed->def.max_vertices = max_vertices;
    feed->capacity = dpt_snapshot_bytes(world, &feed->def);
    dpt_latest_init(&feed->latest);
    feed->frame = malloc(view_frame_bytes(feed->capacity, VIEW_FEED_TICKS));
    int is_whole = feed->frame != NULL && feed->capacity > 0;
    for (int i = 0; i < DPT_LATEST_PLACES; i++) {
        feed->place[i].bytes = calloc(1, feed->capacity);
        is_whole &= feed->place[i].bytes != NULL;
    }
    if (is_whole)
        return feed;
    view_feed_close(feed);
    return NULL;
}

void view_feed_close(struct view_feed *feed)
{
    if (!feed)
        return;
    for (int i = 0; i < DPT_LATEST_PLACES; i++)
        free(feed->place[i].bytes);
    free(feed->frame);
    free(feed);
}

static void push_tick(struct view_feed *feed, const struct view_tick *tick)
{
    const uint64_t read = __atomic_load_n(&feed->ticks_read, __ATOMIC_ACQUIRE);
    const uint64_t at = feed->ticks_written;
    if (at - read == VIEW_FEED_TICKS) {
        __atomic_store_n(&feed->ticks_lost, feed->ticks_lost + 1, __ATOMIC_RELAXED);
        return;
    }
    feed->tick[at % VIEW_FEED_TICKS] = *tick;
    __atomic_store_n(&feed->ticks_written, at + 1, __ATOMIC_RELEASE);
}

void view_feed_tick(struct view_feed *feed, const struct view_tick *tick, const struct view_physics *physics,
                    uint64_t now_ns)
{
    feed->steps++;
    push_tick(feed, tick);
    if (physics->has_moved) {
        feed->has_moved = 1;
        feed->moved_ns = now_ns;
    }
    if (now_ns < feed->next_ns)
        return;
    feed->next_ns = now_ns + 1000000000u / VIEW_FEED_HZ;
    struct place *place = &feed->place[feed->latest.writing];
    const int is_moving = feed->has_moved && now_ns - feed->moved_ns < MOVED_FOR_NS;
    feed->def.max_vertices = is_moving || feed->made % VERTICES_EVERY == 0 ? feed->max_vertices : 0;
    if (dpt_world_take_snapshot(feed->world, &feed->def, place->bytes, feed->capacity, &place->size) != DPT_OK)
        return;
    place->number = feed->made;
    place->ns = now_ns;
    place->steps = feed->steps;
    place->physics_steps = physics->steps;
    dpt_latest_publish(&feed->latest);
    __atomic_store_n(&feed->made, feed->made + 1, __ATOMIC_RELAXED);
}

static int by_size(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static double percentile_99(struct view_feed *feed, const float *values)
{
    const size_t count = feed->heard < PERCENTILE_TICKS ? (size_t)feed->heard : PERCENTILE_TICKS;
    if (!count)
        return 0.0;
    memcpy(feed->sorted, values, count * sizeof *values);
    qsort(feed->sorted, count, sizeof *feed->sorted, by_size);
    return (double)feed->sorted[(count * 99 - 1) / 100];
}

static uint32_t take_ticks(struct view_feed *feed, unsigned char *to)
{
    const uint64_t end = __atomic_load_n(&feed->ticks_written, __ATOMIC_ACQUIRE);
    const uint64_t begin = feed->ticks_read;
    for (uint64_t i = begin; i < end; i++) {
        const struct view_tick *tick = &feed->tick[i % VIEW_FEED_TICKS];
        feed->late[feed->heard % PERCENTILE_TICKS] = tick->late;
        feed->took[feed->heard % PERCENTILE_TICKS] = tick->took;
        feed->heard++;
        view_frame_put_tick(tick, to + (i - begin) * VIEW_TICK_BYTES);
    }
    __atomic_store_n(&feed->ticks_read, end, __ATOMIC_RELEASE);
    return (uint32_t)(end - begin);
}

/* The rates of the last half second or more. */
static void measure_rates(struct view_feed *feed, const struct place *place)
{
    if (feed->rate_ns && place->ns - feed->rate_ns < 500000000u)
        return;
    const double seconds = 1e-9 * (double)(place->ns - feed->rate_ns);
    if (feed->rate_ns && seconds > 0.0) {
        feed->haptic_hz = (double)(place->steps - feed->rate_steps) / seconds;
        feed->physics_hz = (double)(place->physics_steps - feed->rate_physics_steps) / seconds;
        feed->view_hz = (double)(feed->taken - feed->rate_taken) / seconds;
    }
    feed->rate_ns = place->ns;
    feed->rate_steps = place->steps;
    feed->rate_physics_steps = place->physics_steps;
    feed->rate_taken = feed->taken;
}

int view_feed_next(void *user, struct view_message *frame)
{
    struct view_feed *feed = user;
    if (!dpt_latest_take(&feed->latest))
        return 0;
    const struct place *place = &feed->place[feed->latest.reading];
    __atomic_store_n(&feed->taken, feed->taken + 1, __ATOMIC_RELAXED);
    measure_rates(feed, place);
    struct view_frame_header header = { .snapshot_bytes = (uint32_t)place->size,
                                        .number = place->number,
                                        .dropped = place->number + 1 - feed->taken,
                                        .haptic_hz = feed->haptic_hz,
                                        .physics_hz = feed->physics_hz,
                                        .view_hz = feed->view_hz };
    memcpy(feed->frame + VIEW_HEADER_BYTES, place->bytes, place->size);
    header.ticks = take_ticks(feed, feed->frame + VIEW_HEADER_BYTES + place->size);
    header.ticks_lost = __atomic_load_n(&feed->ticks_lost, __ATOMIC_RELAXED);
    header.late_p99 = percentile_99(feed, feed->late);
    header.took_p99 = percentile_99(feed, feed->took);
    view_frame_put_header(&header, feed->frame);
    *frame = (struct view_message){ feed->frame, view_frame_bytes(place->size, header.ticks) };
    return 1;
}

void view_feed_counts(const struct view_feed *feed, uint64_t *made, uint64_t *taken)
{
    *made = __atomic_load_n(&feed->made, __ATOMIC_RELAXED);
    *taken = __atomic_load_n(&feed->taken, __ATOMIC_RELAXED);
}
