/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A back end of one's own, outside of the library: a device that rests at one place and prints nothing but the strongest
 * force that it was given. A host serves it for 200 ticks.
 *
 *     cc own_driver.c $(pkg-config --cflags --libs libdynpoint_drivers)
 */
#include <dynpoint/driver.h>
#include <dynpoint/loop.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct rest {
    dpt_device device; /* first */
    uint64_t sample;
    double strongest;
    uint64_t commands;
};

static dpt_result rest_open(const dpt_driver *driver, const char *where, dpt_device **device, dpt_device_error *error)
{
    struct rest *rest;
    (void)driver;
    if (where) {
        strcpy(error->text, "it is in one place only: leave the name's second part out");
        return DPT_E_SETTING;
    }
    rest = calloc(1, sizeof *rest);
    if (!rest)
        return DPT_E_MEMORY;
    *device = &rest->device;
    return DPT_OK;
}

static void rest_info(const dpt_device *device, dpt_device_info *info)
{
    (void)device;
    info->pose_dofs = info->wrench_dofs = 3;
    info->flags = DPT_DEVICE_FLAG_SIMULATED | DPT_DEVICE_FLAG_DETERMINISTIC;
    info->rate = 1000.0;
    info->force_max = 2.0;
    strcpy(info->name, "a thing at rest");
}

static dpt_result rest_read(dpt_device *device, dpt_device_state *state)
{
    struct rest *rest = (struct rest *)device;
    memset(state, 0, sizeof *state);
    state->status = DPT_DEVICE_STATUS_READY;
    state->fresh = 1;
    state->sequence = rest->sample;
    state->time_ns = 1000000 * rest->sample++;
    state->pose.position[1] = -0.01;
    state->pose.orientation[0] = 1.0;
    state->temperature = -1.0;
    return DPT_OK;
}

static dpt_result rest_write(dpt_device *device, const dpt_wrench *wrench)
{
    struct rest *rest = (struct rest *)device;
    rest->commands++;
    if (wrench->force[1] > rest->strongest)
        rest->strongest = wrench->force[1];
    return DPT_OK;
}

static dpt_result rest_clear(dpt_device *device)
{
    (void)device;
    return DPT_OK;
}

static void rest_counts(const dpt_device *device, dpt_device_counts *counts)
{
    const struct rest *rest = (const struct rest *)device;
    counts->samples = rest->sample;
    counts->commands = rest->commands;
}

static void rest_close(dpt_device *device)
{
    printf("strongest %.3g N\n", ((struct rest *)device)->strongest);
    free(device);
}

static const dpt_driver rest_driver = { .size = sizeof(dpt_driver),
                                        .version = DPT_DRIVER_VERSION,
                                        .name = "rest",
                                        .about = "rests at one place",
                                        .open = rest_open,
                                        .info = rest_info,
                                        .read = rest_read,
                                        .write = rest_write,
                                        .clear = rest_clear,
                                        .counts = rest_counts,
                                        .close = rest_close };

/* A wall of 500 N/m at the height 0, for whoever is below. */
static dpt_result feel(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    (void)user;
    if (sample->state->pose.position[1] < 0.0)
        wrench->force[1] = -500.0 * sample->state->pose.position[1];
    return DPT_OK;
}

int main(int argc, char **argv)
{
    dpt_device *device;
    dpt_device_error error = { sizeof error, 0, "" };
    dpt_loop_def def;
    dpt_loop *loop;
    dpt_loop_stats stats;
    dpt_result result = dpt_device_open_with(&rest_driver, argc > 1 ? argv[1] : NULL, &device, &error);
    if (result != DPT_OK) {
        fprintf(stderr, "%s\n", error.text);
        return 2;
    }
    dpt_loop_def_init(&def);
    def.tick = feel;
    def.ticks = 200;
    stats.size = sizeof stats;
    result = dpt_loop_open(device, &def, &loop);
    if (result == DPT_OK)
        result = dpt_loop_run(loop, &stats);
    if (result == DPT_OK)
        printf("ticks %d commands %d clamped %d\n", (int)stats.ticks, (int)stats.sent, (int)stats.clamped);
    dpt_loop_close(loop);
    dpt_device_close(device);
    return result == DPT_OK ? 0 : 1;
}
