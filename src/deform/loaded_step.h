/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A step of springs whose loads are found substep by substep, as contact with the tissue is (docs/algorithms/tissue.md).
 * In spring_step.c, implicit_step.c and springs.c.
 */
#ifndef DPT_LOADED_STEP_H
#define DPT_LOADED_STEP_H

#include "base/vec3.h"
#include "deform/local_yield.h"
#include "deform/spring_state.h"

/* Where a node is, m, with what its floats have lost. */
static inline vec3 spring_place(const struct spring_slice *state, uint32_t node)
{
    const struct spring_slice *slice = state + node / LANES;
    const uint32_t lane = node % LANES;
    return (vec3){ (double)slice->x[lane] + (double)slice->rest[lane],
                   (double)slice->x[LANES + lane] + (double)slice->rest[LANES + lane],
                   (double)slice->x[2 * LANES + lane] + (double)slice->rest[2 * LANES + lane] };
}

/* A step with SYMPLECTIC or EULER, of the slices that are awake, substep by substep. */
struct explicit_step {
    struct dpt_springs *springs;
    struct spring_motion motion;
    uint32_t done;   /* substeps */
    uint32_t pulled; /* slices that were awake when cells were asked what they pull in this substep; 0: not yet */
    uint32_t forced; /* likewise when forces were found that this substep is foreseen by */
};

/* Begin a step of substeps of h seconds, however long they are. */
void dpti_explicit_begin(struct explicit_step *step, struct dpt_springs *springs, double h);

/* Make a substep with the loads that are set. Returns 0 if it would leave the finite range. */
int dpti_explicit_substep(struct explicit_step *step);

/* Take the state that was reached. Or go back to where the step began, also if what was reached had been taken. */
void dpti_explicit_take(struct explicit_step *step);
void dpti_explicit_undo(struct explicit_step *step, int is_taken);

/*
 * Where a substep would take a slice's nodes with the loads that are set: how far from where they are, m, in rows of 16 x,
 * y, z, of the lanes that are set as bits, and no others. With EULER it is where the speeds of this substep lead in the
 * next one, as loads move nothing before. `slid` is
 * the part of it by which the loads of the substep before had not moved them yet. Of a slice that sleeps: where it would
 * go if the load that it fell asleep with were gone.
 */
void dpti_explicit_foresee(struct explicit_step *step, uint32_t slice, uint32_t lanes, double moved[SPRING_ROWS],
                           double slid[SPRING_ROWS]);

/* Where a node is in the step so far, m, with what its floats have lost. */
vec3 dpti_explicit_place(const struct explicit_step *step, uint32_t node);

/* m/N: how far a load moves a node by the end of a substep (with EULER, of the next one). */
double dpti_explicit_response(const struct explicit_step *step, uint32_t node);

/*
 * A step with IMPLICIT. What it does with the loads of the step before is solved for once; a change of the loads then moves
 * the loaded nodes and their neighbours, by a matrix that is near to the inverse. What that leaves is taken up by the next
 * step.
 */
struct implicit_step {
    struct dpt_springs *springs;
    double h;
    struct spring_trial trial;
    int is_foreseen; /* the change with the loads before is known */
    uint32_t active; /* slices that were awake then */
    uint32_t done;   /* substeps */
};

/* These are as those above. */
void dpti_implicit_step_begin(struct implicit_step *step, struct dpt_springs *springs, double h, uint32_t substeps);
int dpti_implicit_substep(struct implicit_step *step, uint32_t *flags);
void dpti_implicit_undo(struct implicit_step *step, uint32_t substeps);
void dpti_implicit_foresee(struct implicit_step *step, uint32_t slice, uint32_t lanes, double moved[SPRING_ROWS]);
vec3 dpti_implicit_place(const struct implicit_step *step, uint32_t node);
double dpti_implicit_response(const struct implicit_step *step, uint32_t node);
int dpti_implicit_neighbour(const struct implicit_step *step, uint32_t node, uint32_t *entry, uint32_t *other,
                            double *response);

/* A step whose loads are set anew for each substep. */
struct loaded_step {
    struct dpt_springs *springs; /* NULL: physics is somebody else's */
    struct local_yield *yield;   /* then: how the body gives way to it; its nodes are the vertices */
    double share;                /* of the tick that is stepped */
    double dt;                   /* s; of a yield the tick's */
    uint32_t load_count;         /* on vertices, in springs->vertices.loads: those of all substeps */
    dpt_springs_info info;
    int has_failed;                /* a substep would have left the finite range */
    int is_taken;                  /* the state that was reached is that of the springs */
    struct explicit_step explicit; /* of SYMPLECTIC and EULER */
    struct implicit_step implicit; /* of IMPLICIT */
};

/* How many substeps of a stable length dt has; 0 if they are too many. */
uint32_t dpti_springs_substeps_of(const struct dpt_springs *springs, double dt);

/* The same where tools touch: with SYMPLECTIC tissue then has a viscosity of three quarters of a substep at least. */
uint32_t dpti_springs_touched_substeps(const struct dpt_springs *springs, double dt);

/* Begin a step; dt and the loads on vertices are valid. is_touched: it is solved together with tools that touch. */
void dpti_loaded_step_begin(struct loaded_step *step, struct dpt_springs *springs, double dt, uint32_t substeps,
                            uint32_t load_count, int is_touched);

/* The same for a body whose physics is somebody else's, of which a share of the tick is stepped. */
void dpti_loaded_step_begin_yield(struct loaded_step *step, struct local_yield *yield, double dt, double share,
                                  uint32_t substeps);

/* Begin a substep: the loads on vertices, and no others, are set. */
void dpti_loaded_step_set(struct loaded_step *step);

/* Add a force on a node, N. */
void dpti_loaded_step_add(struct loaded_step *step, uint32_t node, vec3 force);

/* What an integrator foresees, as above; with IMPLICIT all of it is `slid`. */
void dpti_loaded_step_foresee(struct loaded_step *step, uint32_t slice, uint32_t lanes, double moved[SPRING_ROWS],
                              double slid[SPRING_ROWS]);
vec3 dpti_loaded_step_place(const struct loaded_step *step, uint32_t node);
double dpti_loaded_step_response(const struct loaded_step *step, uint32_t node);

/* Whether a load on a node moves others, too. */
static inline int loaded_step_has_neighbours(const struct loaded_step *step)
{
    return step->springs && step->springs->def.integrator == DPT_INTEGRATOR_IMPLICIT;
}

/*
 * The nodes that a load on a node moves beside it, one a call: the other one, and how far, m/N. *entry is 0 at first.
 * Returns 0 if there is no more.
 */
int dpti_loaded_step_neighbour(const struct loaded_step *step, uint32_t node, uint32_t *entry, uint32_t *other,
                               double *response);

/* Make the substep. Returns 0 if it would leave the finite range. */
int dpti_loaded_step_go(struct loaded_step *step);

/*
 * End the step, after all of its substeps: take the state that was reached, which may still be undone, and then keep it;
 * both of springs alone (dpti_yield_keep). Or, at any time before, undo it: nothing has moved then.
 */
void dpti_loaded_step_take(struct loaded_step *step);
void dpti_loaded_step_keep(struct loaded_step *step);
void dpti_loaded_step_undo(struct loaded_step *step);

/* A step with loads on those vertices alone; NULL: on nodes. They are valid. Returns 0 if it would leave the finite range. */
int dpti_loaded_step_make(struct loaded_step *step, struct dpt_springs *springs, double dt, const dpt_load *loads,
                          uint32_t count, const struct spring_vertices *vertices);

#endif
