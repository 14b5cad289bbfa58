/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Tissue that gives way: a deformable body whose vertices are tied to their rest by springs per area (an elastic
 * foundation), and to each other by a tension in the surface. Vertices on the border of an open mesh stand still.
 * It stands for a user's physics: it has a rate of its own, gets loads, and hands over positions.
 *
 *     struct tissue tissue = { .mesh = mesh, .matter = tissue_soft, .ticks = 4, .load_radius = 0.03 };
 *     tissue_open(&tissue, world);
 *     for each tick: tissue_advance(&tissue); dpt_world_step(world, TISSUE_TICK, NULL); tissue_yield(&tissue);
 *     tissue_close(&tissue);
 *
 * The law is linear, and integrated by the implicit Euler method, solved by conjugate gradients until nothing is left.
 */
#ifndef DPT_TOOLS_TISSUE_H
#define DPT_TOOLS_TISSUE_H

#include "dynpoint/body.h"
#include "dynpoint/springs.h"

/*
 * A deformable body of a laboratory's loop that masses and springs of the library move, in every tick.
 *
 *     struct spring_body springs = { .mesh = mesh, .integrator = DPT_INTEGRATOR_SYMPLECTIC, .load_radius = 0.02 };
 *     spring_body_open(&springs, world);
 *     for each tick: dpt_world_step(world, dt, NULL); spring_body_step(&springs, dt);
 *     spring_body_close(&springs);
 */

struct spring_body {
    /* Given. The mesh has springs. */
    const dpt_mesh *mesh;
    uint32_t integrator; /* DPT_INTEGRATOR_... */
    double load_radius;  /* m */

    /* Made. */
    dpt_world *world;
    dpt_body body;
    void *block, *springs_block;
    dpt_springs *springs;
    int is_free;            /* until it is set, the body stands still */
    int has_failed;         /* a step was refused */
    uint64_t held;          /* steps with DPT_SPRINGS_FLAG_HELD */
    uint64_t nodes, active; /* sums over steps */
};

/* Add the body to a world. Returns 0 if memory runs out or the library refuses it; spring_body_close is due in any case. */
int spring_body_open(struct spring_body *body, dpt_world *world);
void spring_body_close(struct spring_body *body);

/* After a step of the world. */
void spring_body_step(struct spring_body *body, double dt);

/* J: what springs hold, and what moves. */
double spring_body_energy(const struct spring_body *body);

#define TISSUE_TICK 1e-3 /* s: of the loop */

/* Constants per area of the surface, except for the tension. */
struct tissue_matter {
    double foundation; /* N/m^3 */
    double tension;    /* N/m */
    double damping;    /* Ns/m^3 */
    double mass;       /* kg/m^2 */
};

/* About a liver's 10 kPa and 100 mm of depth; it comes to rest within 0.1 s, and does not swing. */
extern const struct tissue_matter tissue_soft;

/* A bump that goes out and comes back, about a place of the mesh. */
struct tissue_beat {
    double at[3], out[3];
    double travel, rate, reach; /* m, Hz, m */
};

struct tissue {
    /* Given. */
    const dpt_mesh *mesh;
    struct tissue_matter matter; /* all zero: it does not give way, and only beats */
    uint32_t ticks;              /* of the loop, from one step of physics to the next */
    int is_interpolated;
    double
        compliance; /* it tells how far vertices give way, so many times as far as each does by itself; 0: it does not */
    int foresees;   /* with a compliance: it makes a step ahead, and tells where that leads */
    uint32_t late;  /* ticks of the loop, up to `ticks`, after which an answer is handed over */
    uint32_t drops;     /* of so many answers one is never handed over; 0: each one is */
    double load_radius; /* m */
    uint32_t response;  /* DPT_RESPONSE_... */
    int is_led;         /* physics gets no loads, and goes on from where vertices were put */
    struct tissue_beat beat;
    int is_held; /* it stands still */

    /* Made. Vectors have 3 numbers a vertex: m from the mesh, m/s, N. */
    dpt_world *world;
    dpt_body body;
    void *block;
    uint32_t vertices;
    const float *rest;
    double *off, *speed, *load;
    double *area, *pull; /* of a vertex: a third of its triangles, and the sum of its links */
    double *scratch[6];
    double *kept;             /* where they are, and how fast, while it looks ahead */
    float *positions, *ahead; /* of the answer, and of the step ahead */
    dpt_load *answered;       /* with which it was made */
    uint32_t answered_count;
    int is_pending; /* it is handed over in a later tick */
    uint64_t due, steps;
    float *answers;            /* m/N: what it tells */
    struct tissue_link *links; /* of each vertex with its neighbours: N/m by unit of tension */
    uint32_t *first;
    unsigned char *is_fixed;
    dpt_load *loads, *last; /* of a step of physics, and of the last call of tissue_work */
    uint32_t last_count;
    float *last_positions;
    uint64_t tick;
    int is_watched; /* tissue_work was called since it was at rest */
    int has_failed; /* the library refused positions or loads */
};

/* Add the body to a world. Returns 0 if memory runs out or the world refuses it; tissue_close is due in any case. */
int tissue_open(struct tissue *tissue, dpt_world *world);
void tissue_close(struct tissue *tissue);

/* Before a tick of the loop. In every so many of them physics takes a step with the loads of the last tick. */
void tissue_advance(struct tissue *tissue);

/* After a tick of the loop: contact is solved with what it has told. */
void tissue_yield(struct tissue *tissue);

/* Put a vertex elsewhere, by so many m, before the next step of physics. */
void tissue_move(struct tissue *tissue, uint32_t vertex, const double by[3]);

/* J: what the tissue did on tools since the last call, by its loads and how their vertices moved. */
double tissue_work(struct tissue *tissue);

/* Back to rest at time 0. It is there after tissue->ticks ticks of a world without a tool in it. */
void tissue_rest(struct tissue *tissue);

/* s: from one step of physics to the next. */
static inline double tissue_period(const struct tissue *tissue)
{
    return TISSUE_TICK * tissue->ticks;
}

#endif
