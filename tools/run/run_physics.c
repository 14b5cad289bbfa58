/* SPDX-License-Identifier: BSD-3-Clause */
#include "run/run_physics.h"

#include <inttypes.h>
#include <math.h>

#include "cli/command_options.h"

int run_physics_check(const struct scene *scene, const dpt_device_info *device, int is_recorded)
{
    if (scene->physics_rate == 0.0)
        return 0;
    if (device->flags & DPT_DEVICE_FLAG_DETERMINISTIC)
        return scene_physics_check_loop(scene->command, scene->physics_rate, device->rate);
    if (is_recorded)
        return complain(scene->command, "--physics: with this device the clock decides when vertices move, which "
                                        "is not in a recording. Leave --record out, or --physics");
    return 0;
}

double run_physics_delay(const struct scene *scene)
{
    double delay = 0.0;
    for (uint32_t i = 0; scene->physics_rate > 0.0 && i < scene->bodies.count; i++)
        if (scene_body_is_soft(&scene->bodies.body[i]))
            delay = fmax(delay, scene->bodies.body[i].period);
    return delay;
}

double run_physics_step(const struct scene *scene, double loop_rate)
{
    return 1.0 / (scene->physics_rate > 0.0 ? scene->physics_rate : loop_rate);
}

int run_physics_start(struct scene *scene, double loop_rate)
{
    if (!scene->physics || scene->device.flags & DPT_DEVICE_FLAG_DETERMINISTIC)
        return 0;
    const dpt_result result = scene_physics_start(scene->physics, loop_rate);
    return result == DPT_OK ? 0 : complain(scene->command, "--physics: there is no thread for it");
}

void run_physics_print(const struct scene *scene, int is_json)
{
    if (!scene->physics)
        return;
    const struct scene_physics_report report = scene_physics_get_report(scene->physics);
    if (is_json)
        printf(",\"physics\":{\"rate\":%.17g,\"asked\":%.17g,\"steps\":%" PRIu64 ",\"late\":%" PRIu64 ",\"thread\":%s}",
               report.rate, report.asked, report.steps, report.late, report.has_thread ? "true" : "false");
    else
        printf("  physics %.4g Hz, %" PRIu64 " steps, %" PRIu64 " late, %s\n", report.rate, report.steps, report.late,
               report.has_thread ? "in a thread of its own" : "by the device's own time");
}
