/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Tissue on springs, fixed below, and a tool that comes down on it. z is up.
 *
 *     struct tissue tissue;
 *     tissue_begin(&tissue, 500.0, 1.2);
 *     if (tissue_add(&tissue, DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC, 0.0, 0.0))
 *         tissue_press_and_hold(&tissue, 0.005, &mean);
 *     tissue_close(&tissue);
 */
#ifndef DPT_TESTS_TISSUE_SCENE_H
#define DPT_TESTS_TISSUE_SCENE_H

#include "lib/fixture.h"
#include "lib/rig.h"

enum { TISSUES_MAX = 2 };

/* m: a tick's press. */
#define TISSUE_PRESS 2e-5

struct tissue {
    struct rig rig;
    struct fixture mesh[TISSUES_MAX];
    dpt_body body[TISSUES_MAX];
    dpt_springs *springs[TISSUES_MAX];
    dpt_springs_info info[TISSUES_MAX];
    uint32_t count;
    double top;                    /* of the bodies at rest, along z */
    double radius;                 /* of the tool */
    int is_sleepless, is_undamped; /* set before bodies are added */
    uint64_t triangles;            /* of bodies, likewise; 0: 512 */
    double young;                  /* Pa, likewise; 0: as soft as a liver, or a sheet of rubber */
    double period;                 /* s, of the bodies, likewise: above 0 the forces of the step before move them */
    dpt_wrench wrench;             /* of the last tick */
    dpt_force_info force;
};

/* A world without bodies, and a tool of 60 mm that leans: 0 is upright on its tip, pi / 2 lies across. */
void tissue_begin(struct tissue *tissue, double stiffness, double lean);
void tissue_begin_thin(struct tissue *tissue, double stiffness, double lean, double radius);

/*
 * A ball of springs of 0.1 m, or a membrane, whose lower part or border is fixed, at x. Returns 0 after a failed
 * check.
 */
int tissue_add(struct tissue *tissue, uint32_t kind, uint32_t integrator, double load_radius, double x);

/* Bodies are rough from now on. */
void tissue_roughen(struct tissue *tissue, double static_friction, double kinetic_friction);

/* Their own surfaces yield by so many N/m from now on. */
void tissue_soften(struct tissue *tissue, double stiffness);

void tissue_close(struct tissue *tissue);

/* The device, so deep below the top. */
void tissue_place(struct tissue *tissue, double depth);

/* A tick: the world, the tissue, and what is felt then. Returns |force|. */
double tissue_tick(struct tissue *tissue);

/* Press down to a depth, and hold. Returns the largest jump of the last ticks, and in *mean the force. */
double tissue_press_and_hold(struct tissue *tissue, double depth, double *mean);

#endif
