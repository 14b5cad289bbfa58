/* SPDX-License-Identifier: BSD-3-Clause */
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
#ifndef DPT_TOOLS_VIEW_FEED_H
#define DPT_TOOLS_VIEW_FEED_H

#include "dynpoint/snapshot.h"
#include "view/view_frame.h"

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
