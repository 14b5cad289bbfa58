/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A hand must not get more energy out of a scene than it put in. An observer adds up the energy that flows through a
 * device, and a controller reduces the force when more has come out than went in (docs/algorithms/passivity.md). It
 * stands between the force law and the guard:
 *
 *     couple -> passivity -> clamp -> slew -> device
 *
 *     dpt_passivity passivity = { .size = sizeof passivity };
 *     dpt_passivity_init(&passivity, &def);
 *     each tick:    dpt_passivity_step(&passivity, &sample, &wrench);
 *
 * All quantities are measured at the hand: its motion in metres, and the wrench that the device gives. Translation and
 * rotation share one account, because they exchange energy; with two accounts each would be wrong.
 *
 * Pure: no device, no clock, the memory is the caller's. Threads: one belongs to one thread at a time.
 */
#ifndef DYNPOINT_PASSIVITY_H
#define DYNPOINT_PASSIVITY_H

#include "dynpoint/types.h"

DPT_BEGIN

/* What is known of the device. dpt_passivity_def_init fills in the defaults, which are given last below. */
typedef struct dpt_passivity_def {
    uint32_t size;         /* sizeof(dpt_passivity_def), set by dpt_passivity_def_init */
    uint32_t observe_only; /* 1: the wrench stays as it is; 0 */
    double damping;        /* of the device, Ns/m, 0..1e6; 0.8 of what it takes away is credited; 0 */
    double spin_damping;   /* likewise, Nms/rad; 0 */
    double force_max;      /* of the guard, N, 0..1000; 5 */
    double torque_max;     /* of the guard, Nm, 0..1000; 0.2 */
    double force_slew;     /* of the guard, N/s; 0: unlimited; 2000 */
    double torque_slew;    /* of the guard, Nm/s; 0: unlimited; 80 */
    double delay;          /* s: from a command to its effect; counted in whole samples, at most 7; 0 */
    double reserve;        /* J, 0..1: what the account holds at most above the law's energy; 0.01 */
    double body_power;     /* W, 0..1000: what moving bodies are credited at most; 1 */
} dpt_passivity_def;

/* The memory of an observer, used like dpt_guard. dpt_passivity_get_info reports what it saw. */
typedef struct dpt_passivity {
    uint32_t size; /* sizeof(dpt_passivity), set by the caller */
    uint32_t reserved;
    uint64_t opaque[127];
} dpt_passivity;

/*
 * One sample.
 *   dt         s since the sample before, 1e-9..1e6
 *   energy     J, that the law stores now (dpt_force_info.energy)
 *   body_work  J, that moving bodies did on the tool since the sample before (dpt_force_info.body_work)
 *   pose       that was read, of the device
 *   sent       the wrench that the device took after the sample before this one (dpt_loop_sample.sent), about the
 *              pose's position
 * Wrenches and energies are at most 1e9 in each number. With a zoom Z and a force scale s, energies of the scene are s / Z
 * times as large at the hand.
 */
typedef struct dpt_passivity_sample {
    uint32_t size; /* sizeof(dpt_passivity_sample), set by the caller */
    uint32_t reserved;
    double dt;
    double energy;
    double body_work;
    dpt_pose pose;
    dpt_wrench sent;
} dpt_passivity_sample;

/*
 * What an observer has seen since dpt_passivity_init.
 *   account      J: what the hand put in and has not got back, credits included, at most the law's energy + reserve
 *   account_min  J: the least it was; at least -2 eps with the controller
 *   eps          J: the force limit times the largest motion between two samples, plus the same of torque: what one
 *                sample can be off by
 *   damped, body_work   J: what was credited
 *   taken        J: what the wrench that was asked for would have given beside the one that was allowed
 *   acted        steps in which the controller changed the wrench
 */
typedef struct dpt_passivity_info {
    uint32_t size; /* sizeof(dpt_passivity_info), set by the caller */
    uint32_t reserved;
    uint64_t steps;
    uint64_t acted;
    double account;
    double account_min;
    double eps;
    double damped;
    double body_work;
    double taken;
} dpt_passivity_info;

/* Fill in the first `size` bytes; what dpt_passivity_def_init calls with its own caller's sizeof. */
DPT_API void dpt_passivity_def_defaults(dpt_passivity_def *def, size_t size);

static inline void dpt_passivity_def_init(dpt_passivity_def *def)
{
    dpt_passivity_def_defaults(def, sizeof *def);
}

/*
 * Start with an empty account. Do so again after the device was lost or the pose jumped.
 *   def   NULL: the defaults
 */
DPT_API dpt_result dpt_passivity_init(dpt_passivity *passivity, const dpt_passivity_def *def);

/* For one that was not initialised this is DPT_E_ARGUMENT, and all of `info` is zero. */
DPT_API dpt_result dpt_passivity_get_info(const dpt_passivity *passivity, dpt_passivity_info *info);

/*
 * Book the motion since the sample before, and take away what must be.
 *   wrench   in: what the law asks for; out: the same, or zero
 *
 * While the account is below zero, the wrench is zero unless it opposes the last motion; below -eps it is zero. It is
 * zero a little earlier if the guard's slew could not bring it down in time.
 *
 * DPT_E_ARGUMENT, DPT_E_FINITE, DPT_E_POSE: the wrench is zero, and the sample is not booked.
 */
DPT_API dpt_result dpt_passivity_step(dpt_passivity *passivity, const dpt_passivity_sample *sample, dpt_wrench *wrench);

DPT_END

#endif
