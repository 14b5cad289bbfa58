/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Physics of masses and springs for a deformable body: the net that the compiler put into its mesh, stepped over time.
 * docs/algorithms/springs.md.
 *
 *     dpt_springs_def def;
 *     dpt_springs_def_init(&def);
 *     def.mesh = mesh;
 *     void *block = malloc(dpt_springs_bytes(&def));
 *     dpt_springs_create(block, dpt_springs_bytes(&def), &def, &springs);
 *     for each tick:
 *         dpt_world_step(world, dt, &out);
 *         dpt_body_step_springs(world, body, springs, dt, NULL);
 *         dpt_tool_get_wrench(world, tool, &wrench);
 *
 * Nodes are the mesh's vertices, in the order of dpt_mesh_get_vertices, or those of the lattice in which the vertices
 * are embedded (dpt_mesh_get_embedding). In a thread of its own, physics gets loads and hands over nodes by exchange.h,
 * and calls dpt_springs_step; with the same loads the nodes are the same, bit for bit.
 *
 * Everything is in the body's frame, which counts as one that does not accelerate.
 *
 * Threads: springs belong to one thread at a time. Different springs may be stepped in different threads. They may
 * share a mesh.
 */
#ifndef DYNPOINT_SPRINGS_H
#define DYNPOINT_SPRINGS_H

#include "dynpoint/body.h"

DPT_BEGIN

typedef struct dpt_springs dpt_springs;

/*
 * How positions and speeds are carried from step to step.
 *   SYMPLECTIC  speeds first, then positions with the new speeds. Keeps momentum; energy neither grows nor falls over
 *               time, but for damping. A step that is too long for it is cut into equal substeps
 *   EULER       the paper's: positions with the old speeds. Gains energy where damping does not take it away. Cut into
 *               substeps as well
 *   IMPLICIT    stable for any stiffness and step, in one substep, or in min_substeps. Energy grows by no more than the
 *               work of loads and gravity. What is faster than the step is damped. It costs iterations + 2 times a
 *               substep of the others
 */
enum { DPT_INTEGRATOR_SYMPLECTIC = 0, DPT_INTEGRATOR_EULER = 1, DPT_INTEGRATOR_IMPLICIT = 2 };

/* s: the shortest step, and the longest. */
#define DPT_SPRINGS_STEP_MIN 1e-9
#define DPT_SPRINGS_STEP_MAX 1.0

/* dpt_springs_def_init fills in the defaults, which are given last. */
typedef struct dpt_springs_def {
    uint32_t size;                /* sizeof(dpt_springs_def), set by dpt_springs_def_init */
    uint32_t integrator;          /* DPT_INTEGRATOR_...; DPT_INTEGRATOR_SYMPLECTIC */
    const dpt_mesh *mesh;         /* with springs; it must stay open */
    const void *reserved_pointer; /* NULL */
    /* Loads that tools put on vertices at one time (dpt_body_step_springs), 1..2^24; 4096. */
    uint32_t max_loads;
    uint32_t reserved; /* 0 */
    double gravity[3]; /* m/s2, in the body's frame, at most 1e6; 0 */
    double stiffness;  /* what the mesh's stiffnesses are multiplied by, 1e-9..1e9; 1 */
    /*
     * N/m, 0..1e12: the stiffness of what touches a single node. The stable step of SYMPLECTIC and EULER is shortened
     * accordingly. A tool's whole stiffness is always enough; what one node has of it, if you spread loads; 0
     */
    double contact_stiffness;
    /*
     * m/s, 0..1e6: 16 nodes that follow each other fall asleep when all of them have been slower for sleep_steps steps;
     * far slower, where drag or viscosity hold them back. They wake when a neighbour has moved by a sixteenth of the way
     * at this speed in these steps, 4 um by default, or when their load has changed by 1/256. For bodies far smaller
     * than organs it should be less. docs/algorithms/springs.md, "What sleeps". 0: none falls asleep; 1e-3
     */
    double sleep_speed;
    uint32_t sleep_steps;  /* 2..65535; 64 */
    uint32_t iterations;   /* of IMPLICIT in a step, 1..1024; 2 */
    uint32_t max_substeps; /* of SYMPLECTIC and EULER in a step, 1..65535; 16 */
    uint32_t kernel;       /* DPT_KERNEL_...; DPT_KERNEL_AUTO */
    /*
     * Substeps of a step, 0..65535: of SYMPLECTIC and EULER at least so many, and no more than max_substeps; of IMPLICIT
     * just so many. Of a long step many substeps of few iterations are nearer to the truth than one of many, at the same
     * cost. 0: as few as are stable; 0
     */
    uint32_t min_substeps;
    uint32_t reserved_word; /* 0 */
} dpt_springs_def;

/* Fill in the first `size` bytes; what dpt_springs_def_init calls with its own caller's sizeof. */
DPT_API void dpt_springs_def_defaults(dpt_springs_def *def, size_t size);

static inline void dpt_springs_def_init(dpt_springs_def *def)
{
    dpt_springs_def_defaults(def, sizeof *def);
}

/*
 * The bytes that springs of this def need, in this version: about 190 a node, 160 more where cells have a term for their
 * volume, 120 more with IMPLICIT, 20 a vertex, and 32 for each of max_loads. 0: the def is not valid, or its mesh has no
 * springs. It takes time in proportion to the mesh.
 */
DPT_API size_t dpt_springs_bytes(const dpt_springs_def *def);

/*
 * Make springs, at rest where the mesh has them, in a block that is aligned to 8 and of at least dpt_springs_bytes(def)
 * bytes. It belongs to the springs as long as they are used.
 *
 * DPT_E_UNSUPPORTED: the mesh has no springs, or this machine does not have the kernel.
 */
DPT_API dpt_result dpt_springs_create(void *block, size_t bytes, const dpt_springs_def *def, dpt_springs **springs);

/* How many nodes there are; 0 for NULL. */
DPT_API uint32_t dpt_springs_get_count(const dpt_springs *springs);

/*
 * s: the longest substep that is stable in every configuration, at most DPT_SPRINGS_STEP_MAX. 0: none is, which is so
 * for EULER without damping. For IMPLICIT DPT_SPRINGS_STEP_MAX; for NULL 0. dpt_springs_step takes at most 0.9 of it.
 */
DPT_API double dpt_springs_get_stable_step(const dpt_springs *springs);

/* Bits of dpt_springs_info.flags. */
enum {
    /*
     * IMPLICIT: the step in which nodes fly on first could have gained energy. It was taken once more from where nodes
     * were; that damps more, and costs as much again.
     */
    DPT_SPRINGS_FLAG_HELD = 1,
    /*
     * With a world: the surface would have gone through a tool that touches it. The body went as far as it goes in a half,
     * a quarter or less of the step: as if time was slower.
     */
    DPT_SPRINGS_FLAG_CUT = 2
};

/* What a step did. */
typedef struct dpt_springs_info {
    uint32_t size; /* sizeof(dpt_springs_info), set by the caller */
    uint32_t flags;
    uint32_t substeps;
    uint32_t nodes;  /* all of them */
    uint32_t active; /* those that were not asleep */
    /*
     * Units that contact solved together with the tissue took (dpt_world_def.budget); of bodies that were solved together
     * they are told of the first one, and 0 of the others
     */
    uint32_t work;
    double stable_step; /* s: dpt_springs_get_stable_step */
    int32_t result;     /* of dpt_bodies_step_springs: DPT_OK, or why the body was held where it was */
    uint32_t reserved_word;
} dpt_springs_info;

/*
 * Go on by dt, DPT_SPRINGS_STEP_MIN to DPT_SPRINGS_STEP_MAX, s.
 *
 *   loads   `count` forces on nodes, N, at most 1e9 each way; they are constant during the step. A node may occur more
 *           than once: they are added up. NULL if count is 0
 *   info    may be NULL
 *
 * After an error nothing has moved:
 *   DPT_E_UNSTABLE  more than max_substeps are needed, or no substep is stable. Choose IMPLICIT, a shorter dt, more
 *                   substeps; for EULER, a mesh with damping
 *   DPT_E_FINITE    a load is not finite or too large; or a coordinate would exceed DPT_COORDINATE_MAX, or a speed 1e9
 *   DPT_E_ARGUMENT  dt or a node is out of range
 */
DPT_API dpt_result dpt_springs_step(dpt_springs *springs, double dt, const dpt_load *loads, uint32_t count,
                                    dpt_springs_info *info);

/*
 * Where the nodes are and how fast: 3 floats each, m and m/s; `count` is dpt_springs_get_count. `speeds` may be NULL.
 * DPT_E_ARGUMENT: another count.
 */
DPT_API dpt_result dpt_springs_get_nodes(const dpt_springs *springs, uint32_t count, float *positions, float *speeds);

/*
 * Put `count` nodes, from `first` on, somewhere else, and wake them and their neighbours. Nodes that are fixed are fixed
 * there from now on.
 *
 *   positions  3 floats a node, m, at most DPT_COORDINATE_MAX each way
 *   speeds     3 floats a node, m/s, at most 1e9 each way; NULL: they rest. Those of fixed nodes are not used
 *
 * DPT_E_FINITE, DPT_E_ARGUMENT: nothing has changed.
 */
DPT_API dpt_result dpt_springs_set_nodes(dpt_springs *springs, uint32_t first, uint32_t count, const float *positions,
                                         const float *speeds);

/*
 * J: what the springs hold, and what moves. Neither may be NULL. It costs as much as a substep.
 */
DPT_API dpt_result dpt_springs_get_energy(const dpt_springs *springs, double *elastic, double *kinetic);

/*
 * For springs that are stepped apart from a world: where dpt_springs_step with dt and these loads would take the nodes.
 * They stay where they are. It is what dpt_body_set_foreseen_vertices asks for, with the loads of the step before, and
 * takes as long as a step does.
 *
 *   count      dpt_springs_get_count; else DPT_E_ARGUMENT
 *   positions  3 floats a node, m; not valid after an error
 *
 * Errors are those of dpt_springs_step. Nodes that these loads would wake are awake afterwards.
 */
DPT_API dpt_result dpt_springs_foresee(dpt_springs *springs, double dt, const dpt_load *loads, uint32_t load_count,
                                       uint32_t count, float *positions);

/*
 * For springs that are stepped apart from a world, by steps of dt: how far a newton that acts on a vertex in such a
 * step has moved it by the end, m/N, while all other nodes stand still. It is what dpt_deformable_def.compliances asks
 * for (docs/algorithms/deform.md, "Physics that tells how far it gives way").
 *
 *   count        of the mesh's vertices
 *   compliances  a number a vertex, at most DPT_COMPLIANCE_MAX; 0: it is fixed
 *
 * DPT_E_ARGUMENT: another count, or dt is out of the range of dpt_springs_step.
 */
DPT_API dpt_result dpt_springs_get_compliances(const dpt_springs *springs, double dt, uint32_t count,
                                               float *compliances);

/*
 * After a step of the world: springs go on by dt, and the body's vertices are where the nodes have carried them in the next
 * step. Only those are moved that follow nodes which are awake. docs/algorithms/tissue.md.
 *
 * With DPT_RESPONSE_LOAD a tool with a proxy and the tissue are solved together: no point of the tool is in the tissue
 * after the step, and what moves the tissue is what is felt. From then on the tool's wrench, loads and energy are those of
 * this answer: read and send them after this call, in the same tick. Friction sticks to where the tool was after the last
 * step, so what lies on a tool weighs on it what it weighs. All of this holds for bodies without
 * a period. With a load_radius a touch loads and feels the same patch of the surface. Elsewhere the wrench is that of the
 * world's step, and its loads act on the nodes.
 *
 * With DPT_RESPONSE_DISPLACE, which is for nodes that are the vertices, nodes are where tools have moved them, and no longer
 * go into the tool; the body's friction acts on what goes along it (dpt_body_settings). It is the paper's, for the laws
 * `point` and `bed`. On a tool that does not move a sheet comes to rest and sleeps, and is felt as before, but it is not
 * felt by its weight.
 *
 *   springs  made with the body's mesh. NULL: the body has a compliance (dpt_deformable_def), and physics of somebody else's
 *            moves it. Between two steps of that physics contact is solved with the compliance; what gives way is in the
 *            vertices, and what of it later positions hold goes again (docs/algorithms/deform.md). A period is no matter
 *
 * DPT_E_ARGUMENT: of another mesh, or none for a body without a compliance, or some for one that has it, or dt is out of
 * range; DPT_E_HANDLE: no deformable body has this id. Nothing has moved
 * then. After any other error the body is held: its springs and vertices are where they were before the call, it is felt
 * as a rigid body that does not move, and dpt_step.flags tells it. The next step tries again.
 *
 *   DPT_E_FINITE       as for dpt_springs_step; or a vertex would leave the body's box (dpt_deformable_def)
 *   DPT_E_UNSTABLE     as for dpt_springs_step
 *   DPT_E_FULL         more loads than max_loads or dpt_deformable_def.max_points have room for
 *   DPT_E_UNSUPPORTED  DISPLACE with an embedding or a period
 */
DPT_API dpt_result dpt_body_step_springs(dpt_world *world, dpt_body body, dpt_springs *springs, double dt,
                                         dpt_springs_info *info);

/*
 * The same for several bodies. A tool that touches more than one of them is solved for together with all that it touches;
 * stepped one after the other, each of them would take the tool's whole compliance. Bodies that tools touch make as many
 * substeps as the one that needs most.
 *
 *   bodies, springs  `count` of them, each once; springs may be NULL, as above
 *   infos            `count`, with the size of each set, or NULL
 *
 * Errors are those of dpt_body_step_springs. The trouble of one body is not that of the others: it is held, and they go on,
 * as if it were rigid. The call returns the error of the first body that is held; `result` of infos tells which ones are.
 */
DPT_API dpt_result dpt_bodies_step_springs(dpt_world *world, const dpt_body *bodies, dpt_springs *const *springs,
                                           uint32_t count, double dt, dpt_springs_info *infos);

DPT_END

#endif
