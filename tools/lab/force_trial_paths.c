/* SPDX-License-Identifier: BSD-3-Clause */
#include <math.h>

#include "base/vec3.h"
#include "lab/force_lead.h"

#define TURN 6.283185307179586

/* Force on the device where it ends, N: less is none. What a low-pass leaves behind never quite ends. */
#define FORCE_OVER 1e-9

/* A closed path at a place. */
struct loop {
    struct place place;
    double depth, tilt, phase;
};

/* Where the device is at the angle t of the loop: out, in by up to the depth, along, tilting, and back. */
static void go_to(struct force_lead *lead, const struct loop *loop, double t)
{
    const struct place *place = &loop->place;
    const double wide = 0.006, out = 0.002;
    const double height = lead->def->radius + out - 0.5 * (loop->depth + out) * (1.0 - cos(t));
    double axis[3];
    for (int k = 0; k < 3; k++)
        axis[k] =
            place->normal[k] + loop->tilt * (sin(t + loop->phase) * place->side[k] + sin(2.0 * t) * place->across[k]);
    vec3_normalise(axis);
    lead->before = lead->device;
    point_along(axis, lead->device.orientation);
    for (int k = 0; k < 3; k++)
        lead->device.position[k] = place->x[k] + height * place->normal[k] + 0.5 * lead->def->length * axis[k] +
                                   wide * (sin(t) * place->side[k] + sin(2.0 * t) * place->across[k]);
}

/* What the last tick's motion did, by the mean of the two wrenches. */
static double work_of(const struct force_lead *lead)
{
    const dpt_wrench *now = &lead->force.wrench, *was = &lead->last.wrench;
    double shift[3], turn[3], work = 0.0;
    force_lead_motion(lead, shift, turn);
    for (int k = 0; k < 3; k++)
        work += 0.5 * (now->force[k] + was->force[k]) * shift[k] + 0.5 * (now->torque[k] + was->torque[k]) * turn[k];
    return work;
}

static double energy_of(const struct force_lead *lead)
{
    const double force = vec3_length(lead->force.wrench.force);
    return lead->def->law == DPT_LAW_POINT ? 0.5 * force * force / lead->def->stiffness : lead->force.energy;
}

/* In steps of at most 0.05 mm. */
static int path_at(struct force_lead *lead, struct path_result *result)
{
    enum { STEPS = 8000 };
    struct loop loop;
    double work = 0.0, high = 0.0;
    int folds = 0;
    if (!force_lead_place(lead, &loop.place))
        return 0;
    loop.depth = uniform(&lead->seed, 0.2, 1.0) * lead->def->depth;
    loop.tilt = uniform(&lead->seed, 0.0, 0.6);
    loop.phase = uniform(&lead->seed, 0.0, TURN);
    go_to(lead, &loop, 0.0);
    if (!(force_lead_gap(lead, &lead->device) > 0.0))
        return 1;
    force_lead_start(lead);
    if (lead->force.reason != DPT_FORCE_FREE)
        return 1;
    for (int i = 1; i <= STEPS; i++) {
        go_to(lead, &loop, TURN * i / STEPS);
        force_lead_step(lead);
        work += work_of(lead);
        high = fmax(high, energy_of(lead));
        folds += (lead->force.flags & DPT_FORCE_FLAG_FOLD) != 0;
    }
    /* What is not worth a force, or has not come back to the open, tells nothing. */
    if (!(high > 1e-6) || vec3_length(lead->force.wrench.force) > FORCE_OVER)
        return 1;
    result->paths++;
    result->emitting += work > 1e-3 * high;
    result->most_emitted = fmax(result->most_emitted, work / high);
    if (!folds)
        result->most_lost = fmax(result->most_lost, -work / high);
    return 1;
}

int force_trial_paths(const struct force_trial_def *def, struct path_result *result)
{
    struct force_lead lead;
    int is_done = force_lead_open(&lead, def);
    *result = (struct path_result){ .paths = 0 };
    for (uint64_t i = 0; i < def->paths && is_done; i++)
        is_done = path_at(&lead, result);
    force_lead_close(&lead);
    return is_done;
}
