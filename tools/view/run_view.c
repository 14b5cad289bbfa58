/* SPDX-License-Identifier: BSD-3-Clause */
#include "view/run_view.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "cli/command_options.h"
#include "platform/clock.h"
#include "view/scene_view.h"
#include "view/view_serve.h"

struct run_view {
    struct scene_view *view;
    struct view_serving *serving;
    struct view_message first; /* the scene */
    uint64_t began_ns;
};

int run_view_check(const char *command, const struct run_view_options *options)
{
    if (options->port > 65535)
        return complain(command, "--port must be 0 to 65535");
    if (!options->is_on && (options->open || options->port || options->address || options->control))
        return complain(command, "--open, --port, --address and --control need --view");
    return 0;
}

int run_view_open(struct run_view **made, const struct run_view_options *options, const struct scene *scene,
                  const char *title, const struct scene_hand *hand)
{
    *made = NULL;
    if (!options->is_on)
        return 0;
    if (options->control && !scene_view_can_steer(scene, hand))
        return complain("run", "--control: only a simulated hand can be steered, as that of "
                               "--device 'sim:?hand=hold&live=1'");
    struct run_view *view = calloc(1, sizeof *view);
    if (view)
        view->view = scene_view_open(scene, title, hand, options->control);
    int status = view && view->view ? 0 : complain("run", "memory ran out");
    if (status == 0) {
        view->first = scene_view_first(view->view);
        const struct view_source source = { .first = &view->first,
                                            .first_count = 1,
                                            .next = scene_view_next,
                                            .heard_hand = options->control ? scene_view_steer : NULL,
                                            .user = view->view };
        status = view_serve("run", options, &source, &view->serving);
    }
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

void run_view_tick(struct run_view *view, const dpt_loop_sample *sample, dpt_result result)
{
    if (view)
        scene_view_tick(view->view, sample, result, view->began_ns);
}

void run_view_close(struct run_view *view, const char *why, struct run_view_report *report)
{
    if (!view)
        return;
    const struct view_served served = view_serve_end(view->serving, why);
    if (report) {
        scene_view_counts(view->view, &report->made, &report->taken);
        report->sent = served.sent;
    }
    scene_view_close(view->view);
    free(view);
}
