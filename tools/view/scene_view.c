/* SPDX-License-Identifier: BSD-3-Clause */
#include "view/scene_view.h"

#include <stdlib.h>

#include "host/host_inside.h"
#include "platform/clock.h"
#include "view/view_scene.h"
#include "view/view_stream.h"

struct scene_view {
    struct view_feed *feed;
    struct view_message first; /* for free() */
    const struct scene *scene;
    dpt_device *device;
    uint64_t moves_before;
    double time; /* s, of the scene */
};

int scene_view_can_steer(const struct scene *scene, const struct scene_hand *hand)
{
    static const double origin[3];
    return hand->device && (scene->device.flags & DPT_DEVICE_FLAG_SIMULATED) &&
           dpt_device_steer(hand->device, origin) == DPT_OK;
}

struct scene_view *scene_view_open(const struct scene *scene, const char *title, const struct scene_hand *hand,
                                   int control)
{
    const struct scene_picture picture = { .title = title,
                                           .mode = "live",
                                           .device = hand->name,
                                           .rate = hand->rate,
                                           .force_max = hand->force_max,
                                           .has_control = control };
    struct scene_view *view = calloc(1, sizeof *view);
    if (!view)
        return NULL;
    view->scene = scene;
    view->device = hand->device;
    view->first.bytes = scene_picture_message(scene, &picture, &view->first.size);
    view->feed = view_feed_open(scene->stage.world, scene_picture_vertices(scene));
    if (view->first.bytes && view->feed)
        return view;
    scene_view_close(view);
    return NULL;
}

int scene_view_can_steer_host(const dpt_host *host)
{
    const struct scene_hand hand = host_hand(host);
    return scene_view_can_steer(host_scene(host), &hand);
}

struct scene_view *scene_view_open_host(const dpt_host *host, const char *title, const char *device, int control)
{
    struct scene_hand hand = host_hand(host);
    hand.name = device;
    return scene_view_open(host_scene(host), title, &hand, control);
}

void scene_view_close(struct scene_view *view)
{
    if (!view)
        return;
    view_feed_close(view->feed);
    free((void *)view->first.bytes);
    free(view);
}

struct view_message scene_view_first(const struct scene_view *view)
{
    return view->first;
}

void scene_view_tick(struct scene_view *view, const dpt_loop_sample *sample, dpt_result result, uint64_t began_ns)
{
    const struct scene *scene = view->scene;
    const uint64_t now = clock_now();
    const struct view_physics physics = { .has_moved = scene->bodies.moves != view->moves_before,
                                          .steps = scene_soft_steps(scene) };
    view->moves_before = scene->bodies.moves;
    view->time += sample->dt;
    struct view_tick tick = scene_picture_tick(scene, sample, view->time, 1e-9 * (double)(now - began_ns));
    view_tick_set_result(&tick, result);
    view_feed_tick(view->feed, &tick, &physics, now);
}

void scene_view_felt(struct scene_view *view, const dpt_host *host, const dpt_loop_sample *sample, dpt_result result)
{
    scene_view_tick(view, sample, result, host_tick_began(host));
}

int scene_view_next(void *user, struct view_message *frame)
{
    const struct scene_view *view = user;
    return view_feed_next(view->feed, frame);
}

/* Where a device cannot be steered any more, nothing happens. */
void scene_view_steer(void *user, const double position[3])
{
    const struct scene_view *view = user;
    double point[3];
    scene_to_device(view->scene, position, point);
    dpt_device_steer(view->device, point);
}

void scene_view_counts(const struct scene_view *view, uint64_t *made, uint64_t *taken)
{
    view_feed_counts(view->feed, made, taken);
}
