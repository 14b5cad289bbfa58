/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How a body whose physics is somebody else's gives way between two steps of that physics: docs/algorithms/deform.md,
 * "Physics that tells how far it gives way". Everything is in the body's frame.
 *
 *     surface = base + yield,   yield = stretch compliance (load - known)
 *
 * base: where physics has the vertex by now. known: the loads whose answer is in there, followed with a time of its own.
 *
 * Where physics foresees a step, base is on its way to where that leads with the loads of the answer, and the yield grows
 * by (load - answer) compliance dt / period in each tick.
 */
#ifndef DPT_LOCAL_YIELD_H
#define DPT_LOCAL_YIELD_H

#include "base/vec3.h"
#include "deform/spring_state.h"
#include "dynpoint/body.h"

/* A vertex that is loaded, or was so lately. */
struct yielding_vertex {
    uint32_t vertex;
    vec3 sum;       /* Ns: of the loads since the last answer */
    vec3 answered;  /* N: the loads of the answer that was handed over last */
    vec3 bound;     /* N: those of the positions for which it is bound */
    vec3 contained; /* N: those of where it is by now */
    vec3 known;     /* N */
    vec3 base;      /* m */
    vec3 last[2];   /* m: the last two positions that were handed over */
    vec3 foreseen;  /* m: where it is bound for, as it was foreseen */
    vec3 reached;   /* m: where that step led */
    vec3 load;      /* N: of the step */
    vec3 yield;     /* m */
    vec3 before;    /* m: before the step */
};

struct local_yield {
    uint32_t count, capacity;
    uint32_t vertex_count;
    uint32_t has_arrived;     /* an answer was handed over since the last step of the world */
    double compliance;        /* m/N */
    const float *compliances; /* the caller's: of each vertex; NULL: they have that one */
    double stretch;           /* so many times as far the body gives way as it says */
    double answers[3];        /* J: from which that is found */
    double period;            /* s: of a step of physics */
    double part;              /* of a step of physics that this step is; 1: nothing is foreseen */
    double held;              /* the share of the yield that stays in this step, likewise */
    uint32_t foresees;        /* the positions that were handed over last are foreseen */
    uint32_t is_foreseen;     /* and those for which it is bound */
    const float *target;      /* those, 3 floats a vertex */
    double seconds;           /* of the loads since the last answer */
    dpt_result result;        /* of its last step */
    uint32_t *places;         /* 1 a vertex: one more than its place in the list; 0: it has none */
    struct yielding_vertex *list;
    dpt_load *loads; /* what tools do to the body in a tick */
    uint32_t load_room;
    struct spring_vertices moved; /* its list and its positions, of vertices that a step has moved */
};

/* The memory that one needs, and one in it, of a body that is bound for `target`. The block is aligned to 8. */
size_t dpti_yield_bytes(const dpt_deformable_def *def, uint32_t vertices);
void dpti_yield_make(struct local_yield *yield, void *block, const dpt_deformable_def *def, uint32_t vertices,
                     const float *target);

/* Nothing has been loaded. */
void dpti_yield_forget_loads(struct local_yield *yield);

/* That of a vertex, which is made if there is none and `position` is not NULL; NULL: there is none, or no room. */
struct yielding_vertex *dpti_yield_of(struct local_yield *yield, uint32_t vertex, const float *position);

/* An answer is handed over: its positions hold what these loads do. 0: there is no room for all of them. */
int dpti_yield_set_answered(struct local_yield *yield, const float *positions, const dpt_load *loads, uint32_t count);

/* Before foreseen positions replace those of the answer. */
void dpti_yield_note_reached(struct local_yield *yield);

/* Before a step of the world: if there is a new answer, it begins. */
void dpti_yield_arrive(struct local_yield *yield);

/* Bases go a share of the way to where they are bound for; 1: they arrive. Where the surface is then is put into `next`. */
void dpti_yield_move_on(struct local_yield *yield, double share, float *next);

/* Begin a step of a tick of dt, of which there are so many. */
void dpti_yield_begin(struct local_yield *yield, double dt, uint32_t substeps);

/* m/N: how far a load moves a vertex in it. */
double dpti_yield_compliance(const struct local_yield *yield, uint32_t vertex);

/* Add the loads of a tick of dt to the sums. 0: there is no room for all of them. */
int dpti_yield_note(struct local_yield *yield, const float *positions, uint32_t count, double dt);

/* The mean of the loads since the last answer. Returns how many there are, which may be more than there is room for. */
uint32_t dpti_yield_mean(const struct local_yield *yield, dpt_load *loads, uint32_t capacity);

/* ---- a step of a tick: loaded_step.h ---- */

/*
 * Those of a tool, N: none, and one more. Without them the vertices of 16 that follow each other go so far from where they
 * are: in rows of x, y, z.
 */
void dpti_yield_unload(struct local_yield *yield);
void dpti_yield_load(struct local_yield *yield, uint32_t vertex, vec3 force);
void dpti_yield_foresee(const struct local_yield *yield, uint32_t slice, double dt, double share,
                        double moved[SPRING_ROWS]);

/* Where a vertex is that is in the list, in the step so far. */
vec3 dpti_yield_place(const struct local_yield *yield, uint32_t vertex);

/* Where the loads that are set take all, a share of the way. */
void dpti_yield_go(struct local_yield *yield, double dt, double share);

/* Loads that are not solved for act: what has given way goes back. */
void dpti_yield_return(struct local_yield *yield, double dt);

/* End the step; or undo it. */
void dpti_yield_keep(struct local_yield *yield, double dt);
void dpti_yield_undo(struct local_yield *yield);

/* List where all of them are, in `moved`. Returns how many there are. */
uint32_t dpti_yield_gather(struct local_yield *yield);

#endif
