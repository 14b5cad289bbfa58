/* SPDX-License-Identifier: BSD-3-Clause */
/* What a viewer gets of a scene that is felt: the message that comes first, and frames while a loop goes on. */
#ifndef DPT_TOOLS_SCENE_VIEW_H
#define DPT_TOOLS_SCENE_VIEW_H

#include "dynpoint/host.h"
#include "dynpoint/loop.h"
#include "view/server/view_server.h"

struct scene;
struct scene_hand;
struct scene_view;

/* Whether `hand` is a simulated one, which goes where it is steered; from now on it is steered to its origin. */
int scene_view_can_steer(const struct scene *scene, const struct scene_hand *hand);

/*
 * Of a scene whose world was made, which gets no more bodies or tools; it and the device stay until scene_view_close.
 *   control   the page may steer the hand: scene_view_can_steer
 * NULL: memory ran out.
 */
struct scene_view *scene_view_open(const struct scene *scene, const char *title, const struct scene_hand *hand,
                                   int control);

/* The same of a host, between its ticks. `device` is how its device was named; NULL: it has none that was. */
int scene_view_can_steer_host(const dpt_host *host);
struct scene_view *scene_view_open_host(const dpt_host *host, const char *title, const char *device, int control);

void scene_view_close(struct scene_view *view);

/* The scene, valid until scene_view_close. */
struct view_message scene_view_first(const struct scene_view *view);

/*
 * In the loop's thread, after a step which returned `result`. They neither wait nor allocate.
 *   began_ns   when the step began, of the clock of clock_now
 */
void scene_view_tick(struct scene_view *view, const dpt_loop_sample *sample, dpt_result result, uint64_t began_ns);
/* Of a host: in dpt_host_felt_fn. */
void scene_view_felt(struct scene_view *view, const dpt_host *host, const dpt_loop_sample *sample, dpt_result result);

/* In one other thread: as view_server_def wants them; `user` is the view. */
int scene_view_next(void *user, struct view_message *frame);
void scene_view_steer(void *user, const double position[3]);

/* As view_feed_counts. From any thread. */
void scene_view_counts(const struct scene_view *view, uint64_t *made, uint64_t *taken);

#endif
