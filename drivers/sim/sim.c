/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A simulated device: a mass with damping and friction for each degree of freedom, which a hand pulls by a spring or
 * pushes, with encoder steps, zero-order hold, delay, and a line that loses frames (docs/back_ends.md, "sim").
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "base/sincos.h"
#include "base/wrench_limit.h"
#include "dynpoint/driver.h"
#include "platform/clock.h"
#include "settings.h"
#include "sim/sim_axis.h"
#include "sim/sim_random.h"
#include "text/parse_number.h"

enum { DOFS = 6, DELAY_MAX = 15, CATCH_UP_MAX = 10000, PERIODS_TO_LOST = 10 };

/* Of commands: the next period's, this one's, and those that may still begin to act. */
enum { SLOTS = DELAY_MAX + 2 };

struct sim {
    dpt_device device;
    /* Index 0: of positions; 1: of angles. What the device has, and what the hand adds. */
    double mass[2], damping[2], grip[2], hand_mass[2], hand_damping[2], friction[2], stiction[2];
    double step[2], gravity, lag, rate, force_max, torque_max, watchdog;
    double delay, jitter, loss, doubled, seed, dofs, live, reach, cycle;
    char script[256], fault[32];
    struct sim_hand hand;
    struct sim_axis axes[2];                      /* with the hand */
    struct sim_transition transitions[2];         /* over a whole period */
    double duration;                              /* of a period, s */
    double weight;                                /* N */
    uint64_t period;                              /* number of the present period */
    struct sim_motion motion[DOFS];               /* from index 3 on the components of a rotation vector */
    double encoders[DOFS], encoders_before[DOFS]; /* readings now and a period before */
    double commands[SLOTS][DOFS];                 /* ring by period: N, from index 3 on Nm */
    double acting[DOFS];                          /* the command that acts */
    int has_begun, has_command, is_armed;
    uint64_t periods_without_command;
    uint64_t began_ns;
    uint32_t buttons;
    dpt_device_state sample; /* the newest that arrived */
    int has_sample, is_repeated;
    int was_read;
    uint64_t read_sequence;
    uint32_t fault_reason; /* DPT_REASON_... of the planned fault; 0: none is planned */
    double fault_time;     /* when it occurs, s */
    int has_fault;
    uint64_t fault_period;
    dpt_device_counts counts;
};

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

static double draw(const struct sim *sim, uint64_t period, enum sim_draw which)
{
    return sim_random((uint64_t)sim->seed, period, which);
}

/* The commands of the period that ends now. The next period begins with the same command. */
static void end_commands(struct sim *sim)
{
    if (sim->has_command || !sim->is_armed || sim->has_fault) {
        sim->periods_without_command = 0;
    } else {
        sim->counts.missed++;
        sim->periods_without_command++;
    }
    sim->has_command = 0;
    int is_off = sim->watchdog > 0.0 && (double)sim->periods_without_command / sim->rate >= sim->watchdog;
    if (is_off || sim->has_fault) {
        memset(sim->commands, 0, sizeof sim->commands);
        memset(sim->acting, 0, sizeof sim->acting);
    }
    memcpy(sim->commands[(sim->period + 1) % SLOTS], sim->commands[sim->period % SLOTS], sizeof sim->acting);
}

/*
 * When the command of the period `age` periods ago begins to act, s after the beginning of the present one, if its
 * delay has as many whole periods. It may be later than the period's end.
 */
static double moment_of(const struct sim *sim, uint64_t age)
{
    const double part = (sim->delay - floor(sim->delay)) * sim->duration;
    if (sim->jitter == 0.0 || sim->period < age)
        return part;
    return part + sim->jitter * draw(sim, sim->period - age, DRAW_JITTER);
}

/* Move the masses for a time under the acting command. */
static void advance(struct sim *sim, double time, const struct hand_target *target)
{
    struct sim_transition over[2];
    for (int kind = 0; kind < (int)sim->dofs / 3; kind++)
        over[kind] = time == sim->duration ? sim->transitions[kind] : sim_axis_transition(&sim->axes[kind], time);
    for (int i = 0; i < (int)sim->dofs; i++) {
        const double weight = i == 1 ? sim->weight : 0.0;
        const struct sim_load load = {
            .command = sim->acting[i],
            .push = (target->is_position ? 0.0 : target->value[i]) - weight,
            .centre = target->is_position ? target->value[i] : 0.0,
        };
        sim_axis_advance(&sim->axes[i / 3], &over[i / 3], &load, &sim->motion[i]);
    }
}

/*
 * Move the masses by one period. At most two commands begin to act in it: one whose delay is the whole periods, and the
 * one before, if its delay went beyond the period before.
 */
static void advance_period(struct sim *sim, const struct hand_target *target)
{
    const uint64_t whole = (uint64_t)sim->delay;
    double now = 0.0;
    for (uint64_t late = 2; late-- > 0;) {
        const uint64_t slot = (sim->period + SLOTS - whole - late) % SLOTS;
        const double moment = moment_of(sim, whole + late) - (late ? sim->duration : 0.0);
        if (!(moment >= 0.0 && moment < sim->duration))
            continue;
        if (moment > now)
            advance(sim, moment - now, target);
        now = moment;
        memcpy(sim->acting, sim->commands[slot], sizeof sim->acting);
    }
    advance(sim, sim->duration - now, target);
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
        return sim->period - sim->fault_period < PERIODS_TO_LOST ? DPT_DEVICE_STATUS_READY : DPT_DEVICE_STATUS_LOST;
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
        velocity[i] =
            sim->step[i / 3] > 0.0 ? (sim->encoders[i] - sim->encoders_before[i]) * sim->rate : sim->motion[i].v;
    }
    sample->sequence = sim->period;
    sample->time_ns = sim->began_ns + ns_of(sim, sim->period);
    memcpy(sample->pose.position, sim->encoders, sizeof sample->pose.position);
    rotation_to_quaternion(sim->encoders + 3, sample->pose.orientation);
    memcpy(sample->velocity, velocity, sizeof sample->velocity);
    memcpy(sample->spin, velocity + 3, sizeof sample->spin);
    memcpy(sample->joint, sim->encoders, sizeof sim->encoders);
    sample->temperature = -1.0;
    sample->buttons = sim->buttons;
}

static int is_silent(const struct sim *sim)
{
    return sim->has_fault && (status_of(sim) == DPT_DEVICE_STATUS_LOST || sim->fault_reason == DPT_REASON_SILENT);
}

/* The present period's sample goes through the line. */
static void send_sample(struct sim *sim)
{
    if (is_silent(sim))
        return;
    if (sim->loss > 0.0 && draw(sim, sim->period, DRAW_SAMPLE_LOST) < sim->loss) {
        sim->counts.lost++;
        return;
    }
    sim->is_repeated =
        sim->has_sample && sim->doubled > 0.0 && draw(sim, sim->period, DRAW_SAMPLE_DOUBLED) < sim->doubled;
    if (sim->is_repeated)
        return;
    sim->has_sample = 1;
    take_sample(sim);
}

static void read_encoders(struct sim *sim)
{
    for (int i = 0; i < (int)sim->dofs; i++)
        sim->encoders[i] = round_to_step(sim->motion[i].x, sim->step[i / 3]);
}

/* Move the masses by one period and take the sample at its end. */
static void step_period(struct sim *sim)
{
    struct hand_target target;
    sim_hand_at(&sim->hand, time_of(sim, sim->period), &target);
    end_commands(sim);
    advance_period(sim, &target);
    memcpy(sim->encoders_before, sim->encoders, sizeof sim->encoders);
    read_encoders(sim);
    sim->period++;
    sim_hand_at(&sim->hand, time_of(sim, sim->period), &target);
    sim->buttons = target.buttons;
    begin_fault(sim);
    send_sample(sim);
}

/* Step a live device up to the clock. If it is too far behind, because the computer slept, the rest is skipped. */
static dpt_result catch_up(struct sim *sim)
{
    uint64_t now;
    DPT_TRY(clock_read(&now));
    if (!sim->has_begun) {
        sim->has_begun = 1;
        sim->began_ns = sim->sample.time_ns = now;
    }
    uint64_t period = (uint64_t)((double)(now - sim->began_ns) * sim->rate * 1e-9);
    for (int i = 0; i < CATCH_UP_MAX && sim->period < period; i++)
        step_period(sim);
    if (sim->period < period) {
        sim->counts.lost += period - sim->period;
        sim->period = period;
        send_sample(sim);
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
    uint64_t fresh = 0;
    if (result == DPT_OK && sim->has_sample && !is_silent(sim)) {
        fresh = sim->was_read ? sim->sample.sequence - sim->read_sequence : 1;
        if (fresh == 0 && sim->is_repeated)
            fresh = 1;
        sim->is_repeated = 0;
        sim->was_read = 1;
        sim->read_sequence = sim->sample.sequence;
    }
    *state = sim->sample;
    state->fresh = fresh < UINT32_MAX ? (uint32_t)fresh : UINT32_MAX;
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
    sim->counts.commands++;
    if (sim->loss > 0.0 && draw(sim, sim->period, DRAW_COMMAND_LOST) < sim->loss)
        return result;
    double *command = sim->commands[sim->period % SLOTS];
    memcpy(command, wrench->force, sizeof wrench->force);
    memcpy(command + 3, wrench->torque, sizeof wrench->torque);
    limit_length(command, sim->force_max);
    limit_length(command + 3, sim->torque_max);
    sim->has_command = sim->is_armed = 1;
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
    memset(sim->acting, 0, sizeof sim->acting);
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
    *info =
        (dpt_device_info){ .pose_dofs = (uint32_t)sim->dofs,
                           .wrench_dofs = (uint32_t)sim->dofs,
                           .joints = (uint32_t)sim->dofs,
                           .buttons = 32,
                           .flags = DPT_DEVICE_FLAG_SIMULATED | (sim->live != 0.0 ? 0 : DPT_DEVICE_FLAG_DETERMINISTIC),
                           .rate = sim->rate,
                           .force_max = sim->force_max,
                           .force_continuous = sim->force_max,
                           .torque_max = has_orientation ? sim->torque_max : 0.0,
                           .position_step = sim->step[0],
                           .angle_step = has_orientation ? sim->step[1] : 0.0,
                           .mass = sim->mass[0],
                           .inertia = has_orientation ? sim->mass[1] : 0.0,
                           .damping = sim->damping[0],
                           .spin_damping = has_orientation ? sim->damping[1] : 0.0,
                           .friction = sim->friction[0],
                           .spin_friction = has_orientation ? sim->friction[1] : 0.0,
                           .delay = sim->delay / sim->rate + sim->lag + 0.5 * sim->jitter,
                           .watchdog = sim->watchdog,
                           .workspace_min = { -0.2, -0.2, -0.2 },
                           .workspace_max = { 0.2, 0.2, 0.2 },
                           .name = "simulated device" };
}

static dpt_result sim_steer(dpt_device *device, const double position[3])
{
    struct sim *sim = (struct sim *)device;
    return sim_hand_steer(&sim->hand, position) ? DPT_OK : DPT_E_UNSUPPORTED;
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
        if (sim->fault_reason && parse_double(at, end, &sim->fault_time) == end && sim->fault_time >= 0.0)
            return DPT_OK;
    }
    return device_error(error, DPT_E_SETTING, "fault is not a reason and a time, as estop@1.5");
}

static dpt_result check(const struct sim *sim, dpt_device_error *error)
{
    if ((sim->dofs != 3.0 && sim->dofs != 6.0) || sim->live != floor(sim->live) || sim->seed != floor(sim->seed))
        return device_error(error, DPT_E_SETTING, "dofs is 3 or 6, live 0 or 1, seed an integer");
    if (sim->jitter * sim->rate >= 1.0)
        return device_error(error, DPT_E_SETTING, "jitter is not below a period");
    if (sim->lag > 0.0 && sim->lag < 1e-5)
        return device_error(error, DPT_E_SETTING, "lag is neither 0 nor within 1e-5 and 1");
    for (int kind = 0; kind < 2; kind++)
        if (sim->stiction[kind] < sim->friction[kind])
            return device_error(error, DPT_E_SETTING, "%sstiction is below %sfriction", kind ? "turn_" : "",
                                kind ? "turn_" : "");
    return DPT_OK;
}

/* The axes with what the hand adds to them. */
static void prepare_axes(struct sim *sim, int is_held, int is_pulled)
{
    sim->duration = 1.0 / sim->rate;
    for (int kind = 0; kind < 2; kind++) {
        sim->axes[kind] = (struct sim_axis){
            .mass = sim->mass[kind] + (is_held ? sim->hand_mass[kind] : 0.0),
            .damping = sim->damping[kind] + (is_held ? sim->hand_damping[kind] : 0.0),
            .spring = is_pulled ? sim->grip[kind] : 0.0,
            .lag = sim->lag,
            .friction = sim->friction[kind],
            .stiction = sim->stiction[kind],
        };
        sim->transitions[kind] = sim_axis_transition(&sim->axes[kind], sim->duration);
    }
    sim->weight = sim->gravity * sim->axes[0].mass;
}

static dpt_result prepare(struct sim *sim, dpt_device_error *error)
{
    for (int kind = 0; kind < 2; kind++)
        if (sim->stiction[kind] < 0.0)
            sim->stiction[kind] = sim->friction[kind];
    DPT_TRY(check(sim, error));
    DPT_TRY(plan_fault(sim, error));
    DPT_TRY(sim_hand_open(&sim->hand, sim->script, sim->reach, sim->cycle, error));
    struct hand_target target;
    sim_hand_at(&sim->hand, 0.0, &target);
    prepare_axes(sim, sim->hand.kind != HAND_NONE, target.is_position);
    for (int i = 0; i < (int)sim->dofs; i++)
        sim->motion[i].x = target.is_position ? target.value[i] : 0.0;
    read_encoders(sim);
    memcpy(sim->encoders_before, sim->encoders, sizeof sim->encoders);
    sim->buttons = target.buttons;
    take_sample(sim);
    begin_fault(sim);
    send_sample(sim);
    return DPT_OK;
}

static void set_defaults(struct sim *sim)
{
    sim->mass[0] = 0.1;
    sim->damping[0] = 0.5;
    sim->grip[0] = 200.0;
    sim->mass[1] = 1e-4;
    sim->damping[1] = 1e-3;
    sim->grip[1] = 0.2;
    sim->stiction[0] = sim->stiction[1] = -1.0; /* not given */
    sim->rate = 1000.0;
    sim->dofs = 3.0;
    sim->force_max = 8.0;
    sim->torque_max = 0.2;
    sim->watchdog = 0.01;
    sim->reach = 0.03;
    sim->cycle = 4.0;
}

static dpt_result read_settings(struct sim *sim, const char *where, dpt_device_error *error)
{
    const struct setting settings[] = {
        { .name = "mass", .number = &sim->mass[0], .min = 1e-4, .max = 100.0 },
        { .name = "damping", .number = &sim->damping[0], .max = 1e3 },
        { .name = "friction", .number = &sim->friction[0], .max = 100.0 },
        { .name = "stiction", .number = &sim->stiction[0], .max = 100.0 },
        { .name = "inertia", .number = &sim->mass[1], .min = 1e-8, .max = 10.0 },
        { .name = "turn_damping", .number = &sim->damping[1], .max = 10.0 },
        { .name = "turn_friction", .number = &sim->friction[1], .max = 10.0 },
        { .name = "turn_stiction", .number = &sim->stiction[1], .max = 10.0 },
        { .name = "gravity", .number = &sim->gravity, .max = 100.0 },
        { .name = "grip", .number = &sim->grip[0], .max = 1e5 },
        { .name = "turn_grip", .number = &sim->grip[1], .max = 1e3 },
        { .name = "hand_mass", .number = &sim->hand_mass[0], .max = 100.0 },
        { .name = "hand_damping", .number = &sim->hand_damping[0], .max = 1e3 },
        { .name = "hand_inertia", .number = &sim->hand_mass[1], .max = 10.0 },
        { .name = "hand_turn_damping", .number = &sim->hand_damping[1], .max = 10.0 },
        { .name = "step", .number = &sim->step[0], .max = 0.01 },
        { .name = "turn_step", .number = &sim->step[1], .max = 0.1 },
        { .name = "rate", .number = &sim->rate, .min = 1.0, .max = 1e5 },
        { .name = "dofs", .number = &sim->dofs, .min = 3.0, .max = 6.0 },
        { .name = "force", .number = &sim->force_max, .max = 1e3 },
        { .name = "torque", .number = &sim->torque_max, .max = 1e3 },
        { .name = "watchdog", .number = &sim->watchdog, .max = 10.0 },
        { .name = "delay", .number = &sim->delay, .max = DELAY_MAX },
        { .name = "lag", .number = &sim->lag, .max = 1.0 },
        { .name = "jitter", .number = &sim->jitter, .max = 1.0 },
        { .name = "loss", .number = &sim->loss, .max = 1.0 },
        { .name = "double", .number = &sim->doubled, .max = 1.0 },
        { .name = "seed", .number = &sim->seed, .max = 0x1p53 },
        { .name = "live", .number = &sim->live, .max = 1.0 },
        { .name = "hand", .text = sim->script, .text_bytes = sizeof sim->script },
        { .name = "reach", .number = &sim->reach, .max = 1.0 },
        { .name = "cycle", .number = &sim->cycle, .min = 0.01, .max = 1e3 },
        { .name = "fault", .text = sim->fault, .text_bytes = sizeof sim->fault },
    };
    char address[64];
    DPT_TRY(settings_read(where, address, sizeof address, settings, sizeof settings / sizeof *settings, NULL, error));
    return address[0] ? device_error(error, DPT_E_SETTING, "only settings, as in sim:?live=1") : DPT_OK;
}

static dpt_result sim_open(const dpt_driver *driver, const char *where, dpt_device **device, dpt_device_error *error)
{
    (void)driver;
    struct sim *sim = calloc(1, sizeof *sim);
    if (!sim)
        return device_error(error, DPT_E_MEMORY, "memory ran out");
    set_defaults(sim);
    dpt_result result = read_settings(sim, where, error);
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
    .steer = sim_steer,
};
