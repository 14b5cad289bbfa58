/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The mechanism of a simulated device: a mass with damping in three directions, held by a hand (a spring and a damper
 * to where the hand wants to be), and perhaps a wall. Motors and hand push the mass, so the loop closes.
 */
#ifndef DPT_TOOLS_MECHANISM_H
#define DPT_TOOLS_MECHANISM_H

struct mechanism {
    double mass;           /* kg */
    double damping;        /* N s/m */
    double hand_stiffness; /* N/m; 0: nobody holds it */
    double hand_damping;   /* N s/m */
    double wall_stiffness; /* N/m; 0: there is no wall */
    double wall_height;    /* m: below it the wall pushes up */
    double hand[3];        /* where the hand wants to be, m */
    double position[3];
    double velocity[3];
};

/* Start with 0.1 kg, held by a hand of 150 N/m, without a wall. */
static inline void mechanism_init(struct mechanism *mechanism)
{
    const struct mechanism start = { .mass = 0.1, .damping = 0.5, .hand_stiffness = 150, .hand_damping = 5 };
    *mechanism = start;
}

/*
 * Apply `force`, N, for `dt` seconds, in `parts` steps of equal length. Semi-implicit Euler: stable while
 * sqrt(stiffness / mass) times a step is below 2.
 */
static inline void mechanism_step(struct mechanism *mechanism, const float force[3], double dt, int parts)
{
    const double h = dt / parts;
    for (int part = 0; part < parts; part++)
        for (int i = 0; i < 3; i++) {
            double sum = force[i] - mechanism->damping * mechanism->velocity[i];
            sum += mechanism->hand_stiffness * (mechanism->hand[i] - mechanism->position[i]);
            sum -= mechanism->hand_damping * mechanism->velocity[i];
            if (i == 1 && mechanism->position[1] < mechanism->wall_height)
                sum += mechanism->wall_stiffness * (mechanism->wall_height - mechanism->position[1]);
            mechanism->velocity[i] += sum / mechanism->mass * h;
            mechanism->position[i] += mechanism->velocity[i] * h;
        }
}

#endif
