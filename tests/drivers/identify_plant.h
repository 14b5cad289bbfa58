/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A device of the test's own for identification: another integrator than the simulated device's, with coupled masses,
 * Coulomb friction, gravity, a motor's lag and delays of fractions of a period. It fails as a plan says, and remembers
 * what it was told.
 */
#ifndef DPT_TESTS_IDENTIFY_PLANT_H
#define DPT_TESTS_IDENTIFY_PLANT_H

#include <math.h>

#include "dynpoint/driver.h"
#include "lib/check.h"

enum { PLANT_SUBSTEPS = 40, PLANT_RING = 64 };

enum plant_fault {
    PLANT_SOUND,
    PLANT_LOSES,   /* samples, for 10 periods: their numbers and times jump */
    PLANT_IS_LATE, /* no new sample in 30 reads */
    PLANT_REFUSES, /* commands, with DPT_E_BUSY, for 10 periods */
    PLANT_UNREADY,
    PLANT_UNPLUGGED,
    PLANT_RELEASED, /* button 3 */
    PLANT_BAD_POSE  /* not a number, for 10 periods */
};

struct plant_plan {
    double inverse_mass[9]; /* 1/kg, symmetric */
    double damping[9];      /* Ns/m */
    double friction, stiction, gravity, step, delay, lag, force_max, watchdog;
    double spring; /* of a hand, N/m */
    double tremor; /* of a hand, m, at 9 Hz */
    double push;   /* of something else, N along y from fault_time on */
    enum plant_fault fault;
    double fault_time;
    uint32_t flags;
    int is_locked;
    int is_linkage; /* its encoders count along axes that are turned against x, y and z */
};

struct plant {
    dpt_device device;
    struct plant_plan plan;
    double x[3], v[3], motor[3];
    double ring[PLANT_RING][3]; /* commands by period */
    uint64_t period, number, jumped_ns;
    int has_begun, faulty_reads;
    dpt_device_state last;
    /* What it was told. */
    double strongest, strongest_turn;
    uint64_t writes, nonzero;
    dpt_wrench written;
};

/* The plan of the next device that is opened, and what the last one that was closed remembers. */
static struct plant_plan plant_plan;
static struct plant plant_after;

static inline struct plant_plan plant_of(double mass, double damping)
{
    struct plant_plan plan = { .force_max = 8.0,
                               .watchdog = 0.01,
                               .flags = DPT_DEVICE_FLAG_SIMULATED | DPT_DEVICE_FLAG_DETERMINISTIC };
    for (int k = 0; k < 3; k++) {
        plan.inverse_mass[4 * k] = 1.0 / mass;
        plan.damping[4 * k] = damping;
    }
    return plan;
}

static inline dpt_result plant_open(const dpt_driver *driver, const char *where, dpt_device **device,
                                    dpt_device_error *error)
{
    (void)driver, (void)where, (void)error;
    struct plant *plant = calloc(1, sizeof *plant);
    plant->plan = plant_plan;
    *device = &plant->device;
    return DPT_OK;
}

static inline void plant_info(const dpt_device *device, dpt_device_info *info)
{
    const struct plant *plant = (const struct plant *)device;
    info->pose_dofs = info->wrench_dofs = 3;
    info->buttons = 4;
    info->flags = plant->plan.flags;
    info->rate = 1000.0;
    info->force_max = plant->plan.force_max;
    info->watchdog = plant->plan.watchdog;
}

static inline int plant_is_faulty(const struct plant *plant, double seconds)
{
    const double time = 1e-3 * (double)plant->period;
    return time >= plant->plan.fault_time && time < plant->plan.fault_time + seconds;
}

/* Move by one sub-step: the velocity by all forces but friction, then friction, which ends at rest. */
static inline void plant_substep(struct plant *plant, const double *command, double time)
{
    const struct plant_plan *plan = &plant->plan;
    const double h = 1e-3 / PLANT_SUBSTEPS;
    double force[3];
    for (int k = 0; k < 3; k++) {
        plant->motor[k] +=
            plan->lag > 0.0 ? h / (plan->lag + h) * (command[k] - plant->motor[k]) : command[k] - plant->motor[k];
        force[k] = plant->motor[k] - plan->spring * plant->x[k];
        for (int j = 0; j < 3; j++)
            force[k] -= plan->damping[3 * k + j] * plant->v[j];
    }
    force[1] -= plan->gravity;
    force[0] += plan->spring * plan->tremor * sin(6.2832 * 9.0 * time);
    if (plan->push != 0.0 && time >= plan->fault_time)
        force[1] += plan->push;
    for (int k = 0; k < 3; k++) {
        const double *inverse = plan->inverse_mass + 3 * k;
        const int sticks = plant->v[k] == 0.0;
        double v = plant->v[k];
        for (int j = 0; j < 3; j++)
            v += h * inverse[j] * force[j];
        const double stop = h * inverse[k] * plan->friction;
        const double hold = h * inverse[k] * fmax(plan->friction, sticks ? plan->stiction : 0.0);
        plant->v[k] = fabs(v) <= hold ? 0.0 : v > 0.0 ? v - stop : v + stop;
    }
    for (int k = 0; k < 3 && !plan->is_locked; k++)
        plant->x[k] += h * plant->v[k];
    if (plan->is_locked)
        memset(plant->v, 0, sizeof plant->v);
}

static inline void plant_step(struct plant *plant)
{
    for (int i = 0; i < PLANT_SUBSTEPS; i++) {
        const double at = (double)plant->period + ((double)i + 0.5) / PLANT_SUBSTEPS;
        const double sent = floor(at - 1e3 * plant->plan.delay);
        const double none[3] = { 0.0 };
        plant_substep(plant, sent >= 0.0 ? plant->ring[(uint64_t)sent % PLANT_RING] : none, 1e-3 * at);
    }
    plant->period++;
    plant->number++;
    memcpy(plant->ring[plant->period % PLANT_RING], plant->ring[(plant->period - 1) % PLANT_RING],
           sizeof plant->ring[0]);
}

/* Turn the first two of three numbers by an angle of this sine and cosine. */
static inline void plant_turn(double *a, double *b, double sine, double cosine)
{
    const double x = *a, y = *b;
    *a = cosine * x - sine * y;
    *b = sine * x + cosine * y;
}

/* The position as the encoders tell it. */
static inline void plant_measure(const struct plant *plant, double *position)
{
    const double step = plant->plan.step, s = 0.479425538604203, c = 0.877582561890373;
    memcpy(position, plant->x, sizeof plant->x);
    if (!(step > 0.0))
        return;
    if (plant->plan.is_linkage) {
        plant_turn(&position[0], &position[1], s, c);
        plant_turn(&position[1], &position[2], s, c);
    }
    for (int k = 0; k < 3; k++)
        position[k] = step * floor(position[k] / step + 0.5);
    if (plant->plan.is_linkage) {
        plant_turn(&position[1], &position[2], -s, c);
        plant_turn(&position[0], &position[1], -s, c);
    }
}

static inline dpt_result plant_read(dpt_device *device, dpt_device_state *state)
{
    struct plant *plant = (struct plant *)device;
    const struct plant_plan *plan = &plant->plan;
    const int is_faulty = plan->fault && plant_is_faulty(plant, HUGE_VAL);
    if (plan->fault == PLANT_IS_LATE && is_faulty && plant->faulty_reads++ < 30) {
        *state = plant->last;
        state->fresh = 0;
        if (plant->faulty_reads > 5)
            memset(plant->ring, 0, sizeof plant->ring); /* its watchdog */
        return DPT_OK;
    }
    if (plant->has_begun)
        plant_step(plant);
    plant->has_begun = 1;
    memset(state, 0, sizeof *state);
    state->fresh = 1;
    if (plan->fault == PLANT_LOSES && is_faulty && !plant->jumped_ns) {
        for (int i = 0; i < 10; i++)
            plant_step(plant);
        plant->jumped_ns = 1;
        state->fresh = 11;
    }
    state->status = DPT_DEVICE_STATUS_READY;
    if (plan->fault == PLANT_UNREADY && is_faulty)
        state->status = DPT_DEVICE_STATUS_UNREADY;
    state->buttons = plan->fault == PLANT_RELEASED && is_faulty ? 0 : 8;
    state->sequence = plant->number;
    state->time_ns = 1000000000u + plant->period * 1000000u;
    state->pose.orientation[0] = 1.0;
    state->temperature = -1.0;
    plant_measure(plant, state->pose.position);
    if (plan->fault == PLANT_BAD_POSE && plan->fault_time > 0.0 && plant_is_faulty(plant, 0.01))
        state->pose.position[1] = NAN;
    plant->last = *state;
    return plan->fault == PLANT_UNPLUGGED && is_faulty ? DPT_E_LOST : DPT_OK;
}

static inline dpt_result plant_write(dpt_device *device, const dpt_wrench *wrench)
{
    struct plant *plant = (struct plant *)device;
    const double *f = wrench->force, *t = wrench->torque;
    plant->strongest = fmax(plant->strongest, sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]));
    plant->strongest_turn = fmax(plant->strongest_turn, fabs(t[0]) + fabs(t[1]) + fabs(t[2]));
    plant->writes++;
    plant->nonzero += f[0] != 0.0 || f[1] != 0.0 || f[2] != 0.0;
    if (plant->plan.fault == PLANT_REFUSES && plant_is_faulty(plant, 0.01))
        return DPT_E_BUSY;
    plant->written = *wrench;
    memcpy(plant->ring[plant->period % PLANT_RING], f, sizeof plant->ring[0]);
    return DPT_OK;
}

static inline dpt_result plant_clear(dpt_device *device)
{
    (void)device;
    return DPT_OK;
}

static inline void plant_counts(const dpt_device *device, dpt_device_counts *counts)
{
    counts->samples = ((const struct plant *)device)->period;
}

static inline void plant_close(dpt_device *device)
{
    plant_after = *(struct plant *)device;
    free(device);
}

static const dpt_driver plant_driver = {
    .size = sizeof(dpt_driver),
    .version = DPT_DRIVER_VERSION,
    .name = "plant",
    .about = "a test's own",
    .open = plant_open,
    .info = plant_info,
    .read = plant_read,
    .write = plant_write,
    .clear = plant_clear,
    .counts = plant_counts,
    .close = plant_close,
};

#endif
