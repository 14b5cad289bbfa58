/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * An arm: links that joints move, with a tool at one of them, compiled offline from a URDF (urdf.h) or from arrays
 * (dpt_compile_arm); the content of a .dpa file (docs/format.md), used where its bytes lie. The bytes must outlive the
 * arm and stay as they were when they were opened; mesh.h says why, and what to do with files that others can write.
 *
 * The root's frame is the frame of all answers. Joint coordinates are rad or m, in the order of dpt_arm_get_joint, and
 * may lie outside of their limits: what is asked is answered there too. Every function that takes them takes
 * `dpt_arm_info.joints` numbers, answers DPT_E_FINITE when one of its numbers, whatever it stands for, is not finite or
 * above DPT_COORDINATE_MAX, and then leaves its output alone. All are stateless and thread-safe, allocate nothing, and
 * give the same bits on every machine.
 */
#ifndef DYNPOINT_ARM_H
#define DYNPOINT_ARM_H

#include "dynpoint/mesh.h"

#define DPT_ARM_LINKS_MAX    64
#define DPT_ARM_SEGMENTS_MAX 64
#define DPT_ARM_BODIES_MAX   64
#define DPT_ARM_NAME         64 /* bytes of a name, its zero and the zeros behind it among them */

DPT_BEGIN

/* Opaque; a pointer into the bytes that were opened. */
typedef struct dpt_arm dpt_arm;

/* How a joint moves its link. */
enum {
    DPT_JOINT_REVOLUTE = 0,   /* about its axis, between its limits */
    DPT_JOINT_CONTINUOUS = 1, /* about its axis, without limits */
    DPT_JOINT_PRISMATIC = 2   /* along its axis, between its limits */
};

/* A coordinate of the arm. */
typedef struct dpt_arm_joint {
    uint32_t size; /* sizeof(dpt_arm_joint) */
    uint32_t kind; /* DPT_JOINT_... */
    double lower;  /* rad or m, lower <= upper; a continuous one has 0 and 0 */
    double upper;
    double velocity; /* limit, rad/s or m/s; 0: not known */
    double effort;   /* limit, Nm or N; 0: not known */
    double damping;  /* Nms/rad or Ns/m, not negative, as those above */
    double friction; /* Nm or N, not negative */
    char name[DPT_ARM_NAME];
} dpt_arm_joint;

/*
 * A link that moves against its parent, with all that is fixed to it:
 *     frame = parent's frame . pose . motion(axis, factor * joint + offset)
 * where motion turns about or shifts along the axis. Links that mimic a joint share its coordinate.
 */
typedef struct dpt_arm_link {
    uint32_t size;    /* sizeof(dpt_arm_link) */
    uint32_t parent;  /* of lower number than its own; DPT_NONE: the root */
    uint32_t joint;   /* the coordinate that moves it */
    uint32_t slides;  /* 0: about the axis, 1: along it */
    dpt_pose pose;    /* in the parent's frame, at factor * joint + offset = 0 */
    double axis[3];   /* unit, in the link's own frame */
    double factor;    /* 1, but for what mimics; not 0 */
    double offset;    /* rad or m */
    double mass;      /* kg, 0 where it is not known */
    double centre[3]; /* of mass, in the link's frame, m */
} dpt_arm_link;

/* A mesh of the scene, fixed to the root. */
typedef struct dpt_arm_body {
    uint32_t size; /* sizeof(dpt_arm_body) */
    uint32_t reserved;
    dpt_pose pose;        /* in the root's frame */
    const dpt_mesh *mesh; /* within the arm's bytes */
    size_t mesh_bytes;    /* its length */
    char name[DPT_ARM_NAME];
} dpt_arm_body;

typedef struct dpt_arm_info {
    uint32_t size;           /* sizeof(dpt_arm_info) */
    uint32_t format_version; /* of the file */
    uint32_t joints;         /* 1..8, DPT_JOINTS_MAX */
    uint32_t links;          /* that move, 1..DPT_ARM_LINKS_MAX */
    uint32_t segments;       /* of the tool, 0..DPT_ARM_SEGMENTS_MAX */
    uint32_t bodies;         /* 0..DPT_ARM_BODIES_MAX */
    uint32_t tool_link;      /* the link that the tool is fixed to */
    uint32_t reserved;
    double mass;           /* of all links, kg; 0: not known, and there is no gravity */
    dpt_pose tool;         /* in the frame of tool_link */
    uint64_t source_bytes; /* length of the source file; 0 when compiled from arrays */
    uint64_t source_hash;  /* its FNV-1a hash, 64 bits */
    uint64_t bytes;        /* length of the compiled file */
    char name[DPT_ARM_NAME];
    char root_name[DPT_ARM_NAME];
    char tool_name[DPT_ARM_NAME];
} dpt_arm_info;

/*
 * As dpt_mesh_open, dpt_mesh_verify and dpt_mesh_convert: check all of a file once, the meshes in it too; tell where one
 * is damaged (within a mesh, `section` is the mesh's); turn a copy into the host's byte order. A compiled mesh is
 * DPT_E_MAGIC here, as an arm is there.
 */
DPT_API dpt_result dpt_arm_open(const void *bytes, size_t size, const dpt_arm **arm);
DPT_API dpt_result dpt_arm_verify(const void *bytes, size_t size, dpt_mesh_fault *fault);
DPT_API dpt_result dpt_arm_convert(void *bytes, size_t size, dpt_mesh_fault *fault);

/* Each fills a struct whose size field is set; DPT_E_ARGUMENT for an index that there is not. */
DPT_API dpt_result dpt_arm_get_info(const dpt_arm *arm, dpt_arm_info *info);
DPT_API dpt_result dpt_arm_get_joint(const dpt_arm *arm, uint32_t index, dpt_arm_joint *joint);
DPT_API dpt_result dpt_arm_get_link(const dpt_arm *arm, uint32_t index, dpt_arm_link *link);
DPT_API dpt_result dpt_arm_get_body(const dpt_arm *arm, uint32_t index, dpt_arm_body *body);

/* A capsule of the tool, in its frame: what dpt_tool_add takes. */
DPT_API dpt_result dpt_arm_get_segment(const dpt_arm *arm, uint32_t index, dpt_segment *segment);

/* Where the tool's frame is. The quaternion is continuous in the joints: a full turn changes its sign. */
DPT_API dpt_result dpt_arm_forward(const dpt_arm *arm, const double *joints, dpt_pose *tool);

/*
 * How the tool's frame moves when the joints move at `rates` (rad/s or m/s): its origin, m/s, and its spin, rad/s.
 */
DPT_API dpt_result dpt_arm_velocity(const dpt_arm *arm, const double *joints, const double *rates,
                                    double velocity[3], double spin[3]);

/*
 * The matrix that does so: 6 rows, velocity above spin, of `joints` columns, row after row.
 */
DPT_API dpt_result dpt_arm_jacobian(const dpt_arm *arm, const double *joints, double *jacobian);

/*
 * What the joints' motors must give, Nm or N, so that the arm gives `wrench` on the hand, force and torque about the
 * tool's origin: the Jacobian's transpose (virtual work), at rest and without the arm's own weight.
 */
DPT_API dpt_result dpt_arm_efforts(const dpt_arm *arm, const double *joints,
                                   const dpt_wrench *wrench, double *efforts);

/*
 * What they must give to hold up the arm's own weight at rest.
 *   gravity   acceleration in the root's frame, m/s^2: { 0, 0, -9.81 } where z is up
 */
DPT_API dpt_result dpt_arm_weight(const dpt_arm *arm, const double *joints, const double gravity[3],
                                  double *efforts);

DPT_END

#endif
