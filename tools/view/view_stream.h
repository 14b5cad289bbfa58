/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Messages for a viewer in order: a scene, frames, an end. Served one after the other, or written into a page that plays by
 * itself: the stream of docs/view.md, in base64, at the page's place for data.
 */
#ifndef DPT_TOOLS_VIEW_STREAM_H
#define DPT_TOOLS_VIEW_STREAM_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "dynpoint/snapshot.h"
#include "view/server/view_server.h"
#include "view/view_serve.h"

/* Begin with zeros. */
struct view_stream {
    struct view_message *message; /* their bytes are the stream's */
    size_t count, room;
    uint64_t bytes;
};

/* Takes bytes of malloc, also if it fails. Returns 0 if memory ran out, also for NULL. */
int view_stream_add(struct view_stream *stream, void *bytes, size_t size);

/* The end: a text in UTF-8 that says why. */
int view_stream_add_end(struct view_stream *stream, const char *text);

/* Write the page with the stream in it. Errors are left in the file's error flag. Returns 0 if the page has no place for it. */
int view_stream_write_page(const struct view_stream *stream, const struct view_page *page, FILE *file);

void view_stream_free(struct view_stream *stream);

/*
 * A frame: what the viewer's page draws at one moment (docs/view.md, "Messages"). A header, a snapshot of the world, and
 * what the plots show of the ticks since the frame before. Little-endian.
 */

enum { VIEW_HEADER_BYTES = 80, VIEW_TICK_BYTES = 40 };

struct view_frame_header {
    uint32_t snapshot_bytes, ticks; /* what follows */
    uint64_t number;                /* of the snapshots made, from 0 */
    uint64_t dropped;               /* snapshots that were not sent */
    uint64_t ticks_lost;            /* ticks of which the plots know nothing */
    double haptic_hz, physics_hz, view_hz;
    double late_p99, took_p99; /* of the last ticks, s */
};

/* One tick, for the plots. */
struct view_tick {
    double time;      /* of the world, s */
    float force;      /* N */
    float depth;      /* m: how far the device is in the surface */
    float energy;     /* J: that the law stores */
    float late, took; /* s */
    uint32_t contact; /* DPT_CONTACT_... */
    uint32_t reason;  /* DPT_FORCE_..., or VIEW_TICK_FAILED */
    float opening;    /* of the tool's jaws: 0 closed, 1 wholly open */
};

/* The reason of a tick that failed: it has no force. */
enum { VIEW_TICK_FAILED = 6 };

static inline void view_tick_set_result(struct view_tick *tick, dpt_result result)
{
    if (result == DPT_OK)
        return;
    tick->reason = VIEW_TICK_FAILED;
    tick->force = 0.0f;
}

/* The bytes of a frame with so much behind its header. */
size_t view_frame_bytes(size_t snapshot_bytes, size_t ticks);

/* Write VIEW_HEADER_BYTES, and VIEW_TICK_BYTES. */
void view_frame_put_header(const struct view_frame_header *header, unsigned char *to);
void view_frame_put_tick(const struct view_tick *tick, unsigned char *to);

/*
 * What a haptic loop hands to the thread that serves its viewers: a snapshot at most 60 times a second, and each tick's
 * numbers for the plots. Neither thread waits for the other. The loop's side allocates nothing and calls the system for
 * nothing but the time.
 *
 *     feed = view_feed_open(world, vertices);
 *     haptic thread:   after each step:   view_feed_tick(feed, &tick, &physics, now);
 *     view thread:     if (view_feed_next(feed, &frame)) send(frame);
 *     view_feed_close(feed);                       when both are done
 *
 * If the view thread is slow or stands still, the newest snapshot counts, and what was not taken is counted. Of the ticks
 * VIEW_FEED_TICKS wait; more are lost, and counted.
 */

enum { VIEW_FEED_TICKS = 8192, VIEW_FEED_HZ = 60 };

struct view_message;

/*
 * A feed of a world that gets no more bodies or tools. NULL: memory ran out.
 *   max_vertices   of bodies that deform
 */
struct view_feed *view_feed_open(const dpt_world *world, uint32_t max_vertices);
void view_feed_close(struct view_feed *feed);

/* What physics did until a tick. */
struct view_physics {
    int has_moved;  /* vertices have, in this step of the world */
    uint64_t steps; /* of physics so far, wherever it is stepped */
};

/* After a step of the world. `now_ns` is of a clock that does not go back. */
void view_feed_tick(struct view_feed *feed, const struct view_tick *tick, const struct view_physics *physics,
                    uint64_t now_ns);

/*
 * 1 and a frame, which stays valid until the next call; 0: there is no newer one. `user` is the feed (view_server_def).
 */
int view_feed_next(void *user, struct view_message *frame);

/* How many snapshots were made so far, and how many of them the view thread took. From any thread. */
void view_feed_counts(const struct view_feed *feed, uint64_t *made, uint64_t *taken);

#endif
