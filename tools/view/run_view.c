/* SPDX-License-Identifier: BSD-3-Clause */
#include "view/run_view.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "cli/command_options.h"
#include "platform/clock.h"
#include "view/view_scene.h"
#include "view/view_serve.h"
#include "view/view_stream.h"

struct run_view {
    struct view_feed *feed;
    struct view_serving *serving;
    struct view_message first; /* the scene, for free() */
    const struct scene *scene;
    dpt_device *device;
    uint64_t began_ns, moves_before;
    double time; /* s, of the scene */
};

int run_view_check(const char *command, const struct run_view_options *options)
{
    if (options->port > 65535)
        return complain(command, "--port must be 0 to 65535");
    if (!options->is_on && (options->open || options->port || options->address || options->control))
        return complain(command, "--open, --port, --address and --control need --view");
    return 0;
}

static int next(void *user, struct view_message *frame)
{
    const struct run_view *view = user;
    return view_feed_next(view->feed, frame);
}

/* In the serving thread. Where a device cannot be steered any more, nothing happens. */
static void steer(void *user, const double position[3])
{
    const struct run_view *view = user;
    double point[3];
    scene_to_device(view->scene, position, point);
    dpt_device_steer(view->device, point);
}

/* A hand that is steered to where it is stays there. */
static int check_control(const struct scene *scene, dpt_device *device)
{
    static const double origin[3];
    if (!(scene->device.flags & DPT_DEVICE_FLAG_SIMULATED) || dpt_device_steer(device, origin) != DPT_OK)
        return complain("run", "--control: only a simulated hand can be steered, as that of "
                               "--device 'sim:?hand=hold&live=1'");
    return 0;
}

int run_view_open(struct run_view **made, const struct run_view_options *options, const struct scene *scene,
                  const char *title, const struct scene_hand *hand)
{
    *made = NULL;
    if (!options->is_on)
        return 0;
    if (options->control && check_control(scene, hand->device))
        return 2;
    struct run_view *view = calloc(1, sizeof *view);
    const struct scene_picture picture = { .title = title,
                                           .mode = "live",
                                           .device = hand->name,
                                           .rate = hand->rate,
                                           .force_max = hand->force_max,
                                           .has_control = options->control };
    if (view) {
        view->scene = scene;
        view->device = hand->device;
        view->first.bytes = scene_picture_message(scene, &picture, &view->first.size);
        view->feed = view_feed_open(scene->stage.world, scene_picture_vertices(scene));
    }
    const struct view_source source = { .first = view ? &view->first : NULL,
                                        .first_count = 1,
                                        .next = next,
                                        .heard_hand = options->control ? steer : NULL,
                                        .user = view };
    int status = view && view->first.bytes && view->feed ? 0 : complain("run", "memory ran out");
    if (status == 0)
        status = view_serve("run", options, &source, &view->serving);
    if (status)
        run_view_close(view, "", NULL);
    else
        *made = view;
    return status;
}

void run_view_print(const struct run_view_report *report, int json)
{
    if (report->made)
        printf(json ? ",\"view\":{\"made\":%" PRIu64 ",\"taken\":%" PRIu64 ",\"sent\":%" PRIu64 "}"
                    : "  viewers: %" PRIu64 " snapshots made, %" PRIu64 " taken, %" PRIu64 " sent\n",
               report->made, report->taken, report->sent);
}

void run_view_begin(struct run_view *view)
{
    if (view)
        view->began_ns = clock_now();
}

void run_view_tick(struct run_view *view, const struct scene *scene, const dpt_loop_sample *sample, dpt_result result)
{
    if (!view)
        return;
    const uint64_t now = clock_now();
    const struct view_physics physics = { .has_moved = scene->bodies.moves != view->moves_before,
                                          .steps = scene_soft_steps(scene) };
    view->moves_before = scene->bodies.moves;
    view->time += sample->dt;
    struct view_tick tick = scene_picture_tick(scene, sample, view->time, 1e-9 * (double)(now - view->began_ns));
    view_tick_set_result(&tick, result);
    view_feed_tick(view->feed, &tick, &physics, now);
}

void run_view_close(struct run_view *view, const char *why, struct run_view_report *report)
{
    if (!view)
        return;
    const struct view_served served = view_serve_end(view->serving, why);
    if (report) {
        view_feed_counts(view->feed, &report->made, &report->taken);
        report->sent = served.sent;
    }
    view_feed_close(view->feed);
    free((void *)view->first.bytes);
    free(view);
}
