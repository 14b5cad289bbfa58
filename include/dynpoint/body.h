/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Bodies of a world: the objects that tools touch. A rigid body is a mesh at a pose. A deformable body is a mesh whose
 * vertices you move: it takes the topology from the mesh, and has its own positions, in float, in a block that you
 * supply. Nearest pairs, sweeps, contacts, strips and forces are as exact as on a rigid body, at the positions of that
 * tick. docs/algorithms/deform.md.
 *
 *     dpt_deformable_def def;
 *     dpt_deformable_def_init(&def);
 *     def.mesh = mesh;
 *     void *block = malloc(dpt_deformable_bytes(&def));
 *     dpt_body_add_deformable(world, block, dpt_deformable_bytes(&def), &def, &body);
 *     for each tick:
 *         if (there are new positions)
 *             dpt_body_set_vertices(world, body, 0, count, positions, -1.0);
 *         dpt_world_step(world, dt, &out);
 *
 * Threads: as for the world. Physics in a thread of its own hands over positions by a dpt_latest (exchange.h).
 */
#ifndef DYNPOINT_BODY_H
#define DYNPOINT_BODY_H

#include "dynpoint/world.h"

DPT_BEGIN

/*
 * A rigid body is a mesh at a pose; NULL is the identity. The world keeps the pointer: the mesh and its bytes must stay
 * where they are until the body is removed. To add a mesh takes microseconds; one with holes is looked through for them,
 * half a millisecond for 50,000 triangles.
 *
 * dpt_body_set_pose moves a body. The motion is swept, so a tool between the old and the new pose is not missed.
 * dpt_body_teleport jumps: nothing is swept, as if the body were removed and added, but it keeps its id. If the pose
 * cannot be used (NULL, not finite, quaternion not of unit length), the call fails, and every answer of the world is
 * stale until the body gets a valid pose or is removed.
 *
 * dpt_body_get_pose returns the last valid pose. `user` is a value of the caller's own, 0 at first.
 */
DPT_API dpt_result dpt_body_add(dpt_world *world, const dpt_mesh *mesh, const dpt_pose *pose, dpt_body *body);
DPT_API dpt_result dpt_body_remove(dpt_world *world, dpt_body body);
DPT_API dpt_result dpt_body_set_pose(dpt_world *world, dpt_body body, const dpt_pose *pose);
DPT_API dpt_result dpt_body_teleport(dpt_world *world, dpt_body body, const dpt_pose *pose);
DPT_API dpt_result dpt_body_get_pose(const dpt_world *world, dpt_body body, dpt_pose *pose);
DPT_API dpt_result dpt_body_set_user(dpt_world *world, dpt_body body, uint64_t user);
DPT_API dpt_result dpt_body_get_user(const dpt_world *world, dpt_body body, uint64_t *user);

/*
 * Settings of a body. They may change at any time and take effect at the next step. A new body has the settings of its
 * world's def. To change one field: get, change, set. A field that the caller's struct is too short for stays as it is.
 * A value out of range is DPT_E_ARGUMENT, and nothing changes.
 */
typedef struct dpt_body_settings {
    uint32_t size; /* sizeof(dpt_body_settings), set by the caller */
    /* 1: to tools it is as if the body were not there. A change is as if it were removed, or added; 0 */
    uint32_t unfelt;
    /*
     * How deep a tool may be behind an open sheet of the body. If it is deeper, the library forgets from which side the
     * tool came. m, 0..DPT_COORDINATE_MAX; 0: a quarter of the body's diagonal.
     */
    double side_limit;
    /*
     * Coulomb friction that a tool with DPT_LAW_PROXY feels: the force across the surface for one out of it, 0..10. Up
     * to `static_friction` a contact sticks. One that slips is held back by `kinetic_friction`, at most the static one;
     * 0, 0.
     */
    double static_friction;
    double kinetic_friction;
    /*
     * Of the surface, N/m, 0..1e9; 0: rigid. DPT_LAW_PROXY: it is in series with the tool's, for the force alone. The
     * proxy stays outside; 0
     */
    double stiffness;
    /*
     * What a piercing tool meets (insertion.h), in worlds with room for channels: elsewhere, and for deformable bodies
     * that have neither springs nor a compliance, or are displaced, a puncture force or toughness above 0 is
     * DPT_E_UNSUPPORTED. With both 0, nothing pierces the body.
     *   puncture_force   N, 0..1e6: a wall ruptures at this force of the tip along its axis. 0: by the toughness; 0
     *   toughness        J/m2, 0..1e9: what it takes to open the material. Without a puncture force, a wall ruptures
     *                    where the coupling holds as much as opens the tip's cross-section. To cut on takes it on a
     *                    width of the tool's diameter; 0
     *   cutting_force    N, 0..1e6, at the tip where it goes deeper than it has been, beside what the toughness gives; 0
     *   shaft_friction   N/m, 0..1e6: along the shaft, at most so much for each metre that is inside; 0
     *   shaft_viscosity  Ns/m2, 0..1e6: likewise, for each m/s; 0
     *   shaft_stiffness  N/m2, 0..1e12: a shaft that sticks gives by this, for each metre inside. 0: it slips beyond
     *                    10 um; 0
     */
    double puncture_force;
    double toughness;
    double cutting_force;
    double shaft_friction;
    double shaft_viscosity;
    double shaft_stiffness;
} dpt_body_settings;

DPT_API dpt_result dpt_body_set_settings(dpt_world *world, dpt_body body, const dpt_body_settings *settings);
DPT_API dpt_result dpt_body_get_settings(const dpt_world *world, dpt_body body, dpt_body_settings *settings);

/* 1 if the world has a body with this id, else 0. Any number is allowed. */
DPT_API int dpt_body_is_valid(const dpt_world *world, dpt_body body);

/*
 * What all tools do to the body in the last step: the force, and the torque about the origin of the body's frame, where that
 * was in the step; in world axes. Zero where nothing touches it. It is the reaction to the wrenches of
 * dpt_tool_get_force_info, before any function of dpt_tool_set_shaper: those of all tools and these of all bodies, about
 * one point, sum up to zero within rounding. If a device is sent less than the wrench, scale it alike. Of one tool:
 * dpt_tool_get_body_wrench. Where a tool pushes: dpt_tool_get_loads. Zero on an error.
 */
DPT_API dpt_result dpt_body_get_wrench(const dpt_world *world, dpt_body body, dpt_wrench *wrench);

/* ---- Deformable bodies: all functions above apply to them too ---- */

/*
 * What a tool does to the body.
 *   LOAD      its force is handed to whoever owns the physics (dpt_body_get_loads); the body moves when its vertices
 *             are set
 *   DISPLACE  the paper's: at the end of a step, triangles that the tool penetrates are moved out of it, as
 *             dpt_body_get_vertices tells then; physics goes on from there. Forces are those of the penetration that
 *             the step began with. Only for tools with DPT_LAW_POINT or _BED, in worlds with DPT_STRIP_KIND_SHADOW: the
 *             strip says which triangles. There are loads as well
 */
enum { DPT_RESPONSE_LOAD = 0, DPT_RESPONSE_DISPLACE = 1 };

typedef struct dpt_deformable_def {
    uint32_t size; /* sizeof(dpt_deformable_def), set by dpt_deformable_def_init */
    /* Where tools push it at one time, for dpt_body_get_loads; torsion of a tool pushes at three more; 1..65535; 16 */
    uint32_t max_points;
    const dpt_mesh *mesh; /* its topology, and where the vertices are at first; it must stay open */
    const dpt_pose *pose; /* of the body; read during the call; NULL: the identity */
    /*
     * In the body's frame, m: vertices never leave this box. It holds the mesh, and its size costs nothing. Ends are rounded
     * to float. All zeros: it ends at DPT_COORDINATE_MAX
     */
    double box_min[3];
    double box_max[3];
    /*
     * s: new positions are where the vertices are to be after this time; in each step they move a part of the way. The
     * period of your physics is a good choice. It delays what is felt by as much; at most 1000. 0: they are there in
     * the next step; 0
     */
    double period;
    /*
     * m: the force at a point is spread over the vertices that are nearer than this, along the surface; at most 256 of
     * them. 0: over the corners of its triangle; 0
     */
    double load_radius;
    uint32_t response; /* DPT_RESPONSE_...; DPT_RESPONSE_LOAD */
    uint32_t passes;   /* of DPT_RESPONSE_DISPLACE, over the strip, 1..1024; 8 */
    /*
     * m/N, 0..DPT_COMPLIANCE_MAX: how far one step of your physics moves a vertex for a newton that acts on it in that step.
     * Above 0 dpt_body_step_springs, with NULL for springs, solves contact with it in each tick. Only for
     * DPT_RESPONSE_LOAD. New positions are then reached in the next step, or after the period; dpt_body_get_vertices tells
     * the surface that is felt, given way. Give it a load_radius of three edges: with 0 vertices take turns, and at 100
     * Hz and below a ball hums by 5 to 9 % of its force, unless physics looks ahead (dpt_body_set_foreseen_vertices).
     * dpt_springs_get_compliances tells that of springs.
     * docs/algorithms/deform.md, "Physics that tells how far it gives way"; 0
     */
    double compliance;
    /*
     * That of each vertex, m/N, where `compliance` is above 0. It stays yours, must stay where it is, and you may change its
     * numbers between calls; one that is out of range counts as 0. NULL: it is `compliance`; NULL
     */
    const float *compliances;
    const void *reserved_pointer; /* NULL */
} dpt_deformable_def;

/* m/N */
#define DPT_COMPLIANCE_MAX 1e6

/* Fill in the first `size` bytes; what dpt_deformable_def_init calls with its own caller's sizeof. */
DPT_API void dpt_deformable_def_defaults(dpt_deformable_def *def, size_t size);

static inline void dpt_deformable_def_init(dpt_deformable_def *def)
{
    dpt_deformable_def_defaults(def, sizeof *def);
}

/*
 * The bytes that a body of this def needs, in this version of the library: about 57 a triangle; with a compliance 1.1 MB
 * more, 14 a triangle, and 370 a vertex up to 256 times max_points. 0 for a def that is not valid. It takes time in
 * proportion to the mesh's triangles.
 */
DPT_API size_t dpt_deformable_bytes(const dpt_deformable_def *def);

/*
 * Add a deformable body. `block` is aligned to 8 and of at least dpt_deformable_bytes(def) bytes; it belongs to the body
 * until that is removed. Takes time in proportion to the mesh's triangles.
 *
 * DPT_E_ARGUMENT: the box does not hold the mesh, or a value is out of its range. DPT_E_FINITE: the box is not finite, or
 * beyond DPT_COORDINATE_MAX.
 *
 * Where the inside of a part can be told by winding number alone (dpt_mesh_info.winding_components), contact looks at
 * all triangles of the mesh for each point in doubt: some 100 us for 50,000 triangles. A budget counts that.
 */
DPT_API dpt_result dpt_body_add_deformable(dpt_world *world, void *block, size_t bytes, const dpt_deformable_def *def,
                                           dpt_body *body);

/*
 * Move `count` vertices from vertex `first` on, or those of a list, before the next step. In the step they move in
 * straight lines from where they were in the last one; what they meet on the way is found.
 *
 *   positions  3 floats a vertex, in the body's frame, m; in the order of dpt_mesh_get_vertices
 *   vertices   indices in that order; one that occurs twice moves twice
 *   bound      m: you know that none of them moves farther, in this call. Below 0: it is measured, which costs little. A
 *              bound that is too small makes answers wrong
 *
 * DPT_E_FINITE: a position is no number or outside of the def's box. DPT_E_ARGUMENT: an index is too large. Nothing has
 * moved then: the body is held where it was, which dpt_step.flags tells after DPT_E_FINITE, and all else goes on.
 * DPT_E_HANDLE: no deformable body has this id.
 *
 * A call on all vertices takes time in proportion to their number. One on a few takes time in proportion to the leaves
 * of the mesh's tree too, which is a hundredth of it. A body that has come half of its diagonal away from where it was has
 * its boxes made anew, which takes as long as ten calls on all vertices.
 */
DPT_API dpt_result dpt_body_set_vertices(dpt_world *world, dpt_body body, uint32_t first, uint32_t count,
                                         const float *positions, double bound);
DPT_API dpt_result dpt_body_set_vertex_list(dpt_world *world, dpt_body body, const uint32_t *vertices, uint32_t count,
                                            const float *positions, double bound);

/*
 * Move the vertices with the nodes of a coarser mesh, in which they are embedded (dpt_mesh_get_embedding): the nodes
 * that your physics moves.
 *
 *   nodes   3 floats for each of its nodes, in the body's frame, m; not NULL
 *
 * DPT_E_UNSUPPORTED: the mesh was compiled without an embedding. Else as dpt_body_set_vertices on all vertices.
 */
DPT_API dpt_result dpt_body_set_nodes(dpt_world *world, dpt_body body, const float *nodes);

/*
 * Where the vertices are: *count of them, 3 floats each, in the body's frame, m. The array is the body's own, and valid
 * until vertices move.
 */
DPT_API dpt_result dpt_body_get_vertices(const dpt_world *world, dpt_body body, const float **positions,
                                         uint32_t *count);

/* A force on a vertex, N, in the body's frame. This struct never changes. */
typedef struct dpt_load {
    uint32_t vertex; /* in the order of dpt_mesh_get_vertices; or a node */
    uint32_t reserved;
    double force[3];
} dpt_load;

/*
 * What tools do to the body, from the last step: forces on vertices, for whoever owns the physics. They are the reaction
 * to the wrenches of dpt_tool_get_force_info, before any function of dpt_tool_set_shaper: the forces and moments of a
 * tool's loads and of its wrench sum up to zero. Where other bodies touch the tool too, this body has its own share. If
 * a device is sent less than the wrench, scale the loads alike.
 *
 *   loads   at most `capacity`; a vertex may occur more than once: add them up
 *   count   how many there are, at most 256 for each of max_points. If that is more than `capacity`, the call returns
 *           DPT_E_FULL, and `loads` is not valid
 *
 * DPT_E_FULL also if max_points left no room for any point of a tool: its loads are missing then. With DPT_LAW_BED
 * they are at the nearest pair alone where the world lists no contacts (dpt_world_def.max_contacts).
 *
 * Loads and wrench may not sum up to zero where the step's budget ended before it was known what holds the tool, and
 * where all the triangles at a point have collapsed: then no forces there have the wrench's moment. A tool that was
 * removed or teleported has its loads until the next step.
 */
DPT_API dpt_result dpt_body_get_loads(const dpt_world *world, dpt_body body, dpt_load *loads, uint32_t capacity,
                                      uint32_t *count);

/*
 * Physics at a rate of its own, of a body with a compliance. Before a step of yours: the mean of the loads of all ticks since
 * the last answer; each tick counts with its dt. *seconds: how long that is, in s.
 *
 *     dpt_body_get_mean_loads(world, body, loads, LOADS_MAX, &count, &seconds);
 *     a step of your physics with these loads
 *     dpt_body_set_answered_loads(world, body, loads, count);
 *     dpt_body_set_vertices(world, body, 0, vertices, positions, -1.0);
 *     for each tick of the step:
 *         dpt_world_step(world, dt, &out);
 *         dpt_body_step_springs(world, body, NULL, dt, NULL);
 *         dpt_tool_get_wrench(world, tool, &wrench);
 *
 *   loads    at most `capacity`, each vertex once. If there are more, the call returns DPT_E_FULL, and they are not valid
 *   count    how many there are
 *
 * DPT_E_UNSUPPORTED: the body has no compliance.
 */
DPT_API dpt_result dpt_body_get_mean_loads(const dpt_world *world, dpt_body body, dpt_load *loads, uint32_t capacity,
                                           uint32_t *count, double *seconds);

/*
 * An answer of physics: the positions that are set before the next step, or those that stand if none are, hold what these
 * loads do. They are the ones that physics got for this step of its; a thread hands them back with its positions. So the
 * library knows how old positions are, and what the tool's load has given way by already. A new mean of loads begins.
 *
 * DPT_E_FINITE: a load is no number, or above 1e9 N. DPT_E_ARGUMENT: a vertex is too large. Nothing has changed then.
 * DPT_E_FULL: more vertices than max_points have room for were loaded of late. DPT_E_UNSUPPORTED: as above.
 */
DPT_API dpt_result dpt_body_set_answered_loads(dpt_world *world, dpt_body body, const dpt_load *loads, uint32_t count);

/*
 * Physics that looks a step ahead, of a body with a compliance: where vertices will be at the end of the next step of
 * physics, if its loads stay those of the answer. After dpt_body_set_vertices has told where they are, in the same tick.
 * The surface then goes there within the period, and what the tool changes of the loads moves it on the way. What is
 * light goes far in a step by its speed alone: without this a tool on a sheet of springs hums. A step that physics makes
 * and takes back tells it, as dpt_springs_foresee does.
 *
 *   first, count, positions   as for dpt_body_set_vertices; vertices that are left out stay where the answer has them
 *
 * An answer whose vertices are set without this foresees nothing. One that sets none keeps what was foreseen before.
 * Errors: as for dpt_body_set_vertices. DPT_E_UNSUPPORTED: the body has no compliance.
 */
DPT_API dpt_result dpt_body_set_foreseen_vertices(dpt_world *world, dpt_body body, uint32_t first, uint32_t count,
                                                  const float *positions);

/*
 * The loads of dpt_body_get_loads on the nodes in which the vertices are embedded: four for each load on a vertex, as it
 * is weighted. `vertex` is a node then. Their moments are as exact as the vertices follow the nodes, in float.
 *
 * DPT_E_UNSUPPORTED: the mesh was compiled without an embedding.
 */
DPT_API dpt_result dpt_body_get_node_loads(const dpt_world *world, dpt_body body, dpt_load *loads, uint32_t capacity,
                                           uint32_t *count);

DPT_END

#endif
