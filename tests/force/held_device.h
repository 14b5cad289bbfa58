/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A hand-held device for tests of closed loops: a mass with damping and Coulomb friction, pulled by a hand to where it
 * rests, that reads its pose in quanta and holds each wrench for one sample.
 *
 * It has six coordinates in m: where the tool's centre is, and rho times the rotation vector from a frame of reference.
 * Mass, damping, friction and hand are the same in each, so that the linear part has a closed solution. Its
 * generalised forces are those of virtual work, exact for turns of any size.
 */
#ifndef DPT_TESTS_HELD_DEVICE_H
#define DPT_TESTS_HELD_DEVICE_H

#include "force/exact_step.h"
#include "lib/rig.h"
#include "lib/solid.h"

enum { HELD_AXES = 6, HELD_PARTS = 4 };

struct held_device {
    double mass;     /* kg */
    double damping;  /* N s/m */
    double friction; /* N, Coulomb's, of each coordinate */
    double quantum;  /* m; 0: none */
    double hand;     /* N/m */
    double rho;      /* m */
    int delay;       /* samples, 0 or 1 */
    double origin[3], orientation[4];
    double rest[HELD_AXES]; /* of the hand */
    double push[HELD_AXES]; /* N, constant */
    double at[HELD_AXES], speed[HELD_AXES], wrench[HELD_AXES], late[HELD_AXES];
    /* Over 1 / HELD_PARTS of a sample: (at - rest, speed) becomes step . (at - rest, speed) + gain * force. */
    double step[2][2], gain[2];
};

/* After its numbers are set. */
static inline void held_prepare(struct held_device *held)
{
    exact_step(held->mass, held->damping, held->hand, RIG_DT / HELD_PARTS, held->step, held->gain);
}

/* The pose at coordinates. */
static inline void held_pose(const struct held_device *held, const double at[HELD_AXES], dpt_pose *pose)
{
    const double turn[3] = { at[3] / held->rho, at[4] / held->rho, at[5] / held->rho };
    const double angle = sqrt(dot3(turn, turn)), *p = held->orientation;
    const double share = angle > 1e-9 ? sin(angle / 2) / angle : 0.5, w = cos(angle / 2);
    const double v[3] = { share * turn[0], share * turn[1], share * turn[2] };
    double *q = pose->orientation, size = 0;
    q[0] = w * p[0] - dot3(v, p + 1);
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        q[1 + k] = w * p[1 + k] + p[0] * v[k] + v[i] * p[1 + j] - v[j] * p[1 + i];
        pose->position[k] = held->origin[k] + at[k];
    }
    for (int k = 0; k < 4; k++)
        size += q[k] * q[k];
    for (int k = 0; k < 4; k++)
        q[k] /= sqrt(size);
}

/* The wrench, about the centre, as forces on the coordinates: a turn's rate is J(turn) times that of the vector. */
static inline void held_force_of(const struct held_device *held, const double at[HELD_AXES], const dpt_wrench *wrench,
                                 double force[HELD_AXES])
{
    const double turn[3] = { at[3] / held->rho, at[4] / held->rho, at[5] / held->rho };
    const double angle = sqrt(dot3(turn, turn)), *t = wrench->torque;
    const double f = angle > 1e-4 ? (1 - cos(angle)) / (angle * angle) : 0.5;
    const double g = angle > 1e-4 ? (angle - sin(angle)) / (angle * angle * angle) : 1.0 / 6;
    double once[3], twice[3];
    for (int k = 0; k < 3; k++)
        once[k] = t[(k + 1) % 3] * turn[(k + 2) % 3] - t[(k + 2) % 3] * turn[(k + 1) % 3];
    for (int k = 0; k < 3; k++)
        twice[k] = once[(k + 1) % 3] * turn[(k + 2) % 3] - once[(k + 2) % 3] * turn[(k + 1) % 3];
    for (int k = 0; k < 3; k++) {
        force[k] = wrench->force[k];
        force[3 + k] = (t[k] + f * once[k] + g * twice[k]) / held->rho;
    }
}

/* What the law answers at coordinates, which are read in quanta. */
static inline void held_ask(struct held_device *held, struct rig *rig, const double at[HELD_AXES],
                            double force[HELD_AXES])
{
    double read[HELD_AXES];
    for (int k = 0; k < HELD_AXES; k++)
        read[k] = held->quantum > 0 ? held->quantum * floor(at[k] / held->quantum + 0.5) : at[k];
    held_pose(held, read, &rig->device);
    rig_step(rig);
    held_force_of(held, read, &rig->force.wrench, force);
}

/* A part of a sample of one coordinate. Where it turns round, friction stops it, and holds it if it can. */
static inline void held_move(struct held_device *held, int k, double force)
{
    double *at = &held->at[k], *speed = &held->speed[k];
    const double off = *at - held->rest[k], pull = force - held->hand * off;
    if (held->friction > 0 && *speed == 0 && fabs(pull) <= held->friction)
        return;
    const double sign = *speed != 0 ? *speed : pull;
    const double sum = force - (sign > 0 ? held->friction : -held->friction);
    const double was = *speed;
    *at = held->rest[k] + held->step[0][0] * off + held->step[0][1] * was + held->gain[0] * sum;
    *speed = held->step[1][0] * off + held->step[1][1] * was + held->gain[1] * sum;
    if (held->friction > 0 && *speed * sign < 0)
        *speed = 0;
}

/* One sample: read, answer, move. */
static inline void held_tick(struct held_device *held, struct rig *rig)
{
    double force[HELD_AXES];
    held_ask(held, rig, held->at, held->wrench);
    memcpy(force, held->delay ? held->late : held->wrench, sizeof force);
    memcpy(held->late, held->wrench, sizeof held->late);
    for (int part = 0; part < HELD_PARTS; part++)
        for (int k = 0; k < HELD_AXES; k++)
            held_move(held, k, force[k] + held->push[k]);
}

/* Lead it, without inertia, to where law, hand and push balance; returns what is left, N. */
static inline double held_settle(struct held_device *held, struct rig *rig, double stiffness, int ticks)
{
    const double quantum = held->quantum;
    double left = 0;
    held->quantum = 0;
    for (int i = 0; i < ticks; i++) {
        held_ask(held, rig, held->at, held->wrench);
        left = 0;
        for (int k = 0; k < HELD_AXES; k++) {
            const double sum = held->wrench[k] + held->push[k] + held->hand * (held->rest[k] - held->at[k]);
            held->at[k] += 0.8 * sum / (stiffness + held->hand);
            left = fmax(left, fabs(sum));
        }
        if (left < 1e-6 * stiffness * 1e-3)
            break;
    }
    memcpy(held->late, held->wrench, sizeof held->late);
    memset(held->speed, 0, sizeof held->speed);
    held->quantum = quantum;
    return left;
}

#endif
