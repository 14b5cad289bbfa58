/* SPDX-License-Identifier: BSD-3-Clause */
#include "simulate/simulate_serial.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "platform/file.h"
#include "platform/serial_line.h"
#include "simulate/sim_clock.h"

void simulate_serial_info(struct wire_info *info)
{
    static const struct wire_info simulated = {
        .pose_dofs = 3,
        .wrench_dofs = 3,
        .buttons = 1,
        .flags = 1, /* DPT_DEVICE_FLAG_SIMULATED */
        .rate = 1000,
        .force_max = 5,
        .force_continuous = 2,
        .stiffness_max = 2000,
        .position_step = 1e-5f,
        .watchdog = 0.02f,
        .workspace_min = { -0.1f, -0.1f, -0.1f },
        .workspace_max = { 0.1f, 0.1f, 0.1f },
        .name = "simulated serial device",
        .serial = "0",
    };
    *info = simulated;
}

int simulate_serial_start(struct simulate_serial *simulated, const struct wire_info *info)
{
    struct wire_info default_info;
    memset(simulated, 0, sizeof *simulated);
    simulate_serial_info(&default_info);
    wire_device_init(&simulated->device, info ? info : &default_info);
    mechanism_init(&simulated->mechanism);
    simulated->swing_period = 4.0;
    simulated->master = serial_line_simulate(simulated->path, sizeof simulated->path);
    return simulated->master < 0 ? errno : 0;
}

static int send_pending(struct simulate_serial *simulated)
{
    while (simulated->pending_at < simulated->pending_size) {
        const long count = file_write(simulated->master, simulated->pending + simulated->pending_at,
                                      simulated->pending_size - simulated->pending_at);
        if (count <= 0)
            return 0;
        simulated->pending_at += (size_t)count;
    }
    return 1;
}

static void move_mechanism(struct simulate_serial *simulated)
{
    const struct wire_info *info = &simulated->device.info;
    if (simulated->swing > 0.0) {
        const double turns = (double)simulated->device.sequence / (double)info->rate / simulated->swing_period;
        const double phase = 4.0 * (turns - floor(turns));
        simulated->mechanism.hand[1] = simulated->swing * (fabs(phase - 2.0) - 1.0);
    }
    mechanism_step(&simulated->mechanism, simulated->device.force, 1.0 / info->rate, 10);
}

void simulate_serial_tick(struct simulate_serial *simulated)
{
    const struct mechanism *mechanism = &simulated->mechanism;
    struct wire_sample sample = { .temperature = WIRE_TEMPERATURE_UNKNOWN };
    uint8_t bytes[1024], out[WIRE_OUT_MAX];
    for (int i = 0; i < 16; i++) {
        const long count = file_read(simulated->master, bytes, sizeof bytes);
        for (long k = 0; k < count; k++)
            wire_device_take(&simulated->device, bytes[k]);
        /* Read on after a short read: the system may return more on the next call. */
        if (count <= 0)
            break;
    }
    move_mechanism(simulated);
    for (int i = 0; i < 3; i++) {
        sample.position[i] = (float)mechanism->position[i];
        sample.velocity[i] = (float)mechanism->velocity[i];
    }
    sample.orientation[0] = 1;
    sample.time = (uint32_t)(simulated->device.sequence * 1e6 / simulated->device.info.rate);
    sample.buttons = simulated->buttons;
    sample.causes = simulated->causes;
    const size_t size = wire_device_sample(&simulated->device, &sample, out);
    if (!send_pending(simulated)) {
        simulated->unsent++;
        return;
    }
    memcpy(simulated->pending, out, size);
    simulated->pending_at = 0;
    simulated->pending_size = size;
    send_pending(simulated);
}

static void tick(void *user)
{
    simulate_serial_tick(user);
}

void simulate_serial_run(struct simulate_serial *simulated, const volatile int *stop)
{
    sim_clock_run((double)simulated->device.info.rate, tick, simulated, stop);
}

void simulate_serial_end(struct simulate_serial *simulated)
{
    if (simulated->master >= 0)
        close(simulated->master);
    simulated->master = -1;
}
