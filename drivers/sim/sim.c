/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A simulated device: a mass with viscous damping for each degree of freedom, which a hand pulls by a spring or pushes,
 * with encoder steps and zero-order hold (docs/drivers.md, "sim").
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "base/sincos.h"
#include "base/wrench_limit.h"
#include "clock.h"
#include "dynpoint/driver.h"
#include "settings.h"
#include "sim/sim_hand.h"
#include "text/parse_number.h"

enum { DOFS = 6, DELAY_MAX = 15, CATCH_UP_MAX = 10000, PERIODS_TO_LOST = 10 };

/*
 * The state transition over one period of a mass m with damping c, a spring k to h, and a constant force f. Position x
 * and velocity v become
 *     x' = h + xx (x - h) + xv v + xf f        v' = vx (x - h) + vv v + vf f
 */
struct transition {
    double xx, xv, xf, vx, vv, vf;
};

struct sim {
    dpt_device device;
    double mass, damping, grip, inertia, turn_damping, turn_grip;
    double step, turn_step, rate, force_max, torque_max, watchdog;
    double delay, dofs, live, reach, cycle;
    char script[256], fault[32];
    struct sim_hand hand;
    /* With and without the hand's spring; [0] of positions, [1] of angles. */
    struct transition with_spring[2], without_spring[2];
    uint64_t period; /* number of the present period */
    double x[DOFS],
        v[DOFS]; /* m, m/s; from index 3 on rad, rad/s: the components of a rotation vector */
    double encoders[DOFS], encoders_before[DOFS]; /* readings now and a period before */
    double commands[DELAY_MAX + 1][DOFS];         /* ring by period: N, from index 3 on Nm */
    int has_begun, has_command, is_armed;
    uint64_t periods_without_command;
    uint64_t began_ns;
    dpt_device_state sample;
    int has_sample, was_read;
    uint64_t read_period;
    uint32_t fault_reason; /* DPT_REASON_... of the planned fault; 0: none is planned */
    double fault_time;     /* when it occurs, s */
    int has_fault;
    uint64_t fault_period;
    dpt_device_counts counts;
};

/*
 * The matrix exponential over a period: a Taylor series over a fraction of the period, squared as often as it was
 * halved. Time is counted in periods and force in m per period^2.
 */
static struct transition transition_of(double mass, double damping, double spring, double period)
{
    double k = spring * period * period / mass, c = damping * period / mass;
    double sum[2][3] = { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 } };
    double term[2][3] = { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 } }, force[3] = { 0.0, 0.0, 1.0 };
    double part = 1.0;
    int halvings = 0;
    for (double norm = 1.0 + k + c; norm * part > 0.25; part *= 0.5)
        halvings++;
    /* Columns: position, velocity, force. The force's own row is (0, 0, 1). */
    for (int i = 1; i <= 14; i++) {
        for (int column = 0; column < 3; column++) {
            double x = term[0][column], v = term[1][column], scale = part / i;
            term[0][column] = v * scale;
            term[1][column] = (force[column] - k * x - c * v) * scale;
            sum[0][column] += term[0][column];
            sum[1][column] += term[1][column];
        }
        force[2] = 0.0;
    }
    for (; halvings > 0; halvings--) {
        double unsquared[2][3];
        memcpy(unsquared, sum, sizeof unsquared);
        for (int row = 0; row < 2; row++) {
            for (int column = 0; column < 3; column++)
                sum[row][column] = unsquared[row][0] * unsquared[0][column] +
                                   unsquared[row][1] * unsquared[1][column];
            sum[row][2] += unsquared[row][2];
        }
    }
    double push = period * period / mass;
    return (struct transition){ .xx = sum[0][0],
                                .xv = sum[0][1] * period,
                                .xf = sum[0][2] * push,
                                .vx = sum[1][0] / period,
                                .vv = sum[1][1],
                                .vf = sum[1][2] * push / period };
}

static double round_to_step(double value, double step)
{
    return step > 0.0 ? step * floor(value / step + 0.5) : value;
}

static double time_of(const struct sim *sim, uint64_t period)
{
    return (double)period / sim->rate;
}

static uint64_t ns_of(const struct sim *sim, uint64_t period)
{
    return (uint64_t)((double)period * 1e9 / sim->rate + 0.5);
}

/* The force of the commands in the period that ends now. The next period begins with the same command. */
static void take_acting_force(struct sim *sim, double *force)
{
    uint64_t slots = DELAY_MAX + 1, slot = sim->period % slots;
    if (sim->has_command || !sim->is_armed || sim->has_fault) {
        sim->periods_without_command = 0;
    } else {
        sim->counts.missed++;
        sim->periods_without_command++;
    }
    sim->has_command = 0;
    int is_off =
        sim->watchdog > 0.0 && (double)sim->periods_without_command / sim->rate >= sim->watchdog;
    if (is_off || sim->has_fault)
        memset(sim->commands, 0, sizeof sim->commands);
    memcpy(force, sim->commands[(slot + slots - (uint64_t)sim->delay) % slots],
           sizeof sim->commands[slot]);
    memcpy(sim->commands[(slot + 1) % slots], sim->commands[slot], sizeof sim->commands[slot]);
}

static void begin_fault(struct sim *sim)
{
    if (!sim->fault_reason || sim->has_fault || time_of(sim, sim->period) < sim->fault_time)
        return;
    sim->has_fault = 1;
    sim->fault_period = sim->period;
}

static uint32_t status_of(const struct sim *sim)
{
    if (!sim->has_fault)
        return DPT_DEVICE_STATUS_READY;
    switch (sim->fault_reason) {
    case DPT_REASON_UNPLUGGED:
        return DPT_DEVICE_STATUS_LOST;
    case DPT_REASON_SILENT:
        return sim->period - sim->fault_period < PERIODS_TO_LOST ? DPT_DEVICE_STATUS_READY
                                                                 : DPT_DEVICE_STATUS_LOST;
    case DPT_REASON_UNCALIBRATED:
    case DPT_REASON_VERSION:
    case DPT_REASON_DOCKED:
        return DPT_DEVICE_STATUS_UNREADY;
    default:
        return DPT_DEVICE_STATUS_FAULT;
    }
}

static void rotation_to_quaternion(const double *rotation, double *q)
{
    double angle = length(vec3_of(rotation)), sine, cosine;
    turn_sincos(angle * (0.5 / 6.283185307179586), &sine, &cosine);
    double scale = angle > 1e-8 ? sine / angle : 0.5;
    q[0] = cosine;
    vec3_store(scaled(vec3_of(rotation), scale), q + 1);
}

static void take_sample(struct sim *sim)
{
    dpt_device_state *sample = &sim->sample;
    double velocity[DOFS];
    for (int i = 0; i < DOFS; i++) {
        double step = i < 3 ? sim->step : sim->turn_step;
        velocity[i] =
            step > 0.0 ? (sim->encoders[i] - sim->encoders_before[i]) * sim->rate : sim->v[i];
    }
    sample->sequence = sim->period;
    sample->time_ns = sim->began_ns + ns_of(sim, sim->period);
    memcpy(sample->pose.position, sim->encoders, sizeof sample->pose.position);
    rotation_to_quaternion(sim->encoders + 3, sample->pose.orientation);
    memcpy(sample->velocity, velocity, sizeof sample->velocity);
    memcpy(sample->spin, velocity + 3, sizeof sample->spin);
    memcpy(sample->joint, sim->encoders, sizeof sim->encoders);
    sample->temperature = -1.0;
}

/* Move the masses by one period and read the encoders at its end. */
static void step_period(struct sim *sim)
{
    double force[DOFS];
    struct hand_target target;
    sim_hand_at(&sim->hand, time_of(sim, sim->period), &target);
    take_acting_force(sim, force);
    memcpy(sim->encoders_before, sim->encoders, sizeof sim->encoders);
    for (int i = 0; i < (int)sim->dofs; i++) {
        const struct transition *transition =
            target.is_position ? &sim->with_spring[i / 3] : &sim->without_spring[i / 3];
        double spring_centre = target.is_position ? target.value[i] : 0.0;
        double push = force[i] + (target.is_position ? 0.0 : target.value[i]);
        double x = sim->x[i] - spring_centre, v = sim->v[i];
        sim->x[i] =
            spring_centre + (transition->xx * x + transition->xv * v + transition->xf * push);
        sim->v[i] = transition->vx * x + transition->vv * v + transition->vf * push;
        sim->encoders[i] = round_to_step(sim->x[i], i < 3 ? sim->step : sim->turn_step);
    }
    sim->period++;
    sim_hand_at(&sim->hand, time_of(sim, sim->period), &target);
    sim->sample.buttons = target.buttons;
    begin_fault(sim);
}

/* Step a live device up to the clock. If it is too far behind, because the computer slept, the rest is skipped. */
static dpt_result catch_up(struct sim *sim)
{
    uint64_t now;
    DPT_TRY(clock_read(&now));
    if (!sim->has_begun) {
        sim->has_begun = 1;
        sim->began_ns = now;
    }
    uint64_t period = (uint64_t)((double)(now - sim->began_ns) * sim->rate * 1e-9);
    for (int i = 0; i < CATCH_UP_MAX && sim->period < period; i++)
        step_period(sim);
    if (sim->period < period) {
        sim->counts.lost += period - sim->period;
        sim->period = period;
    }
    return DPT_OK;
}

static dpt_result sim_read(dpt_device *device, dpt_device_state *state)
{
    struct sim *sim = (struct sim *)device;
    dpt_result result = DPT_OK;
    if (sim->live != 0.0)
        result = catch_up(sim);
    else if (sim->has_begun)
        step_period(sim);
    sim->has_begun = 1;
    uint32_t status = status_of(sim);
    int is_silent = sim->has_fault &&
                    (status == DPT_DEVICE_STATUS_LOST || sim->fault_reason == DPT_REASON_SILENT);
    uint32_t fresh = 0;
    if (result == DPT_OK && !is_silent) {
        uint64_t passed = sim->was_read ? sim->period - sim->read_period : 1;
        fresh = passed < UINT32_MAX ? (uint32_t)passed : UINT32_MAX;
        sim->was_read = 1;
        sim->read_period = sim->period;
        take_sample(sim);
    }
    *state = sim->sample;
    state->fresh = fresh;
    state->status = status;
    state->reasons = status == DPT_DEVICE_STATUS_READY ? 0 : sim->fault_reason;
    state->code = state->reasons == DPT_REASON_DEVICE ? 1 : 0;
    return status == DPT_DEVICE_STATUS_LOST ? DPT_E_LOST : result;
}

static dpt_result sim_write(dpt_device *device, const dpt_wrench *wrench)
{
    struct sim *sim = (struct sim *)device;
    dpt_result result = sim->live != 0.0 ? catch_up(sim) : DPT_OK;
    uint32_t status = status_of(sim);
    if (status != DPT_DEVICE_STATUS_READY)
        return status == DPT_DEVICE_STATUS_LOST ? DPT_E_LOST : DPT_E_NOT_READY;
    double *command = sim->commands[sim->period % (DELAY_MAX + 1)];
    memcpy(command, wrench->force, sizeof wrench->force);
    memcpy(command + 3, wrench->torque, sizeof wrench->torque);
    limit_length(command, sim->force_max);
    limit_length(command + 3, sim->torque_max);
    sim->has_command = sim->is_armed = 1;
    sim->counts.commands++;
    return result;
}

static dpt_result sim_clear(dpt_device *device)
{
    struct sim *sim = (struct sim *)device;
    if (!sim->has_fault)
        return DPT_OK;
    sim->counts.resets += status_of(sim) == DPT_DEVICE_STATUS_LOST;
    sim->has_fault = sim->is_armed = 0;
    sim->fault_reason = 0;
    memset(sim->commands, 0, sizeof sim->commands);
    return DPT_OK;
}

static void sim_counts(const dpt_device *device, dpt_device_counts *counts)
{
    const struct sim *sim = (const struct sim *)device;
    *counts = sim->counts;
    counts->samples = sim->has_begun ? sim->period + 1 : 0;
}

static void sim_info(const dpt_device *device, dpt_device_info *info)
{
    const struct sim *sim = (const struct sim *)device;
    const int has_orientation = sim->dofs > 3.0;
    *info = (dpt_device_info){ .pose_dofs = (uint32_t)sim->dofs,
                               .wrench_dofs = (uint32_t)sim->dofs,
                               .joints = (uint32_t)sim->dofs,
                               .buttons = 32,
                               .flags = DPT_DEVICE_FLAG_SIMULATED |
                                        (sim->live != 0.0 ? 0 : DPT_DEVICE_FLAG_DETERMINISTIC),
                               .rate = sim->rate,
                               .force_max = sim->force_max,
                               .force_continuous = sim->force_max,
                               .torque_max = has_orientation ? sim->torque_max : 0.0,
                               .position_step = sim->step,
                               .angle_step = has_orientation ? sim->turn_step : 0.0,
                               .mass = sim->mass,
                               .inertia = has_orientation ? sim->inertia : 0.0,
                               .damping = sim->damping,
                               .spin_damping = has_orientation ? sim->turn_damping : 0.0,
                               .delay = sim->delay / sim->rate,
                               .watchdog = sim->watchdog,
                               .workspace_min = { -0.2, -0.2, -0.2 },
                               .workspace_max = { 0.2, 0.2, 0.2 },
                               .name = "simulated device" };
}

static void sim_close(dpt_device *device)
{
    struct sim *sim = (struct sim *)device;
    sim_hand_close(&sim->hand);
    free(sim);
}

/* Read the planned fault and its time, as in "overheated@2.5". */
static dpt_result plan_fault(struct sim *sim, dpt_device_error *error)
{
    char *at = strchr(sim->fault, '@');
    if (!sim->fault[0])
        return DPT_OK;
    if (at) {
        *at++ = '\0';
        const char *end = at + strlen(at);
        for (uint32_t bit = 1; dpt_device_reason_name(bit); bit <<= 1)
            if (!strcmp(dpt_device_reason_name(bit), sim->fault))
                sim->fault_reason = bit;
        if (sim->fault_reason && parse_double(at, end, &sim->fault_time) == end &&
            sim->fault_time >= 0.0)
            return DPT_OK;
    }
    return device_error(error, DPT_E_SETTING, "fault is not a reason and a time, as estop@1.5");
}

static dpt_result prepare(struct sim *sim, dpt_device_error *error)
{
    if ((sim->dofs != 3.0 && sim->dofs != 6.0) || sim->live != floor(sim->live) ||
        sim->delay != floor(sim->delay))
        return device_error(error, DPT_E_SETTING, "dofs is 3 or 6, live 0 or 1, delay an integer");
    double period = 1.0 / sim->rate;
    sim->with_spring[0] = transition_of(sim->mass, sim->damping, sim->grip, period);
    sim->without_spring[0] = transition_of(sim->mass, sim->damping, 0.0, period);
    sim->with_spring[1] = transition_of(sim->inertia, sim->turn_damping, sim->turn_grip, period);
    sim->without_spring[1] = transition_of(sim->inertia, sim->turn_damping, 0.0, period);
    dpt_result result = plan_fault(sim, error);
    if (result == DPT_OK)
        result = sim_hand_open(&sim->hand, sim->script, sim->reach, sim->cycle, error);
    if (result != DPT_OK)
        return result;
    struct hand_target target;
    sim_hand_at(&sim->hand, 0.0, &target);
    for (int i = 0; i < (int)sim->dofs; i++)
        sim->x[i] = target.is_position ? target.value[i] : 0.0;
    for (int i = 0; i < DOFS; i++)
        sim->encoders[i] = sim->encoders_before[i] =
            round_to_step(sim->x[i], i < 3 ? sim->step : sim->turn_step);
    sim->sample.buttons = target.buttons;
    take_sample(sim);
    begin_fault(sim);
    return DPT_OK;
}

static dpt_result sim_open(const dpt_driver *driver, const char *where, dpt_device **device,
                           dpt_device_error *error)
{
    (void)driver;
    struct sim *sim = calloc(1, sizeof *sim);
    if (!sim)
        return device_error(error, DPT_E_MEMORY, "memory ran out");
    sim->mass = 0.1;
    sim->damping = 0.5;
    sim->grip = 200.0;
    sim->inertia = 1e-4;
    sim->turn_damping = 1e-3;
    sim->turn_grip = 0.2;
    sim->rate = 1000.0;
    sim->dofs = 3.0;
    sim->force_max = 8.0;
    sim->torque_max = 0.2;
    sim->watchdog = 0.01;
    sim->reach = 0.03;
    sim->cycle = 4.0;
    const struct setting settings[] = {
        { .name = "mass", .number = &sim->mass, .min = 1e-4, .max = 100.0 },
        { .name = "damping", .number = &sim->damping, .max = 1e3 },
        { .name = "grip", .number = &sim->grip, .max = 1e5 },
        { .name = "inertia", .number = &sim->inertia, .min = 1e-8, .max = 10.0 },
        { .name = "turn_damping", .number = &sim->turn_damping, .max = 10.0 },
        { .name = "turn_grip", .number = &sim->turn_grip, .max = 1e3 },
        { .name = "step", .number = &sim->step, .max = 0.01 },
        { .name = "turn_step", .number = &sim->turn_step, .max = 0.1 },
        { .name = "rate", .number = &sim->rate, .min = 1.0, .max = 1e5 },
        { .name = "dofs", .number = &sim->dofs, .min = 3.0, .max = 6.0 },
        { .name = "force", .number = &sim->force_max, .max = 1e3 },
        { .name = "torque", .number = &sim->torque_max, .max = 1e3 },
        { .name = "watchdog", .number = &sim->watchdog, .max = 10.0 },
        { .name = "delay", .number = &sim->delay, .max = DELAY_MAX },
        { .name = "live", .number = &sim->live, .max = 1.0 },
        { .name = "hand", .text = sim->script, .text_bytes = sizeof sim->script },
        { .name = "reach", .number = &sim->reach, .max = 1.0 },
        { .name = "cycle", .number = &sim->cycle, .min = 0.01, .max = 1e3 },
        { .name = "fault", .text = sim->fault, .text_bytes = sizeof sim->fault },
    };
    char address[64];
    dpt_result result = settings_read(where, address, sizeof address, settings,
                                      sizeof settings / sizeof *settings, NULL, error);
    if (result == DPT_OK && address[0])
        result = device_error(error, DPT_E_SETTING, "only settings, as in sim:?live=1");
    if (result == DPT_OK)
        result = prepare(sim, error);
    if (result != DPT_OK) {
        sim_close(&sim->device);
        return result;
    }
    *device = &sim->device;
    return DPT_OK;
}

static void sim_find(const dpt_driver *driver, dpt_device_found_fn *found, void *user)
{
    found(user, driver, "?live=1&hand=press", "simulated: a hand presses down and lets go");
}

const dpt_driver sim_driver = {
    .size = sizeof(dpt_driver),
    .version = DPT_DRIVER_VERSION,
    .name = "sim",
    .about = "simulated masses in a scripted hand",
    .open = sim_open,
    .info = sim_info,
    .read = sim_read,
    .write = sim_write,
    .clear = sim_clear,
    .counts = sim_counts,
    .close = sim_close,
    .find = sim_find,
};
