/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * An arm: links that joints move, with a tool at one of the links. It is compiled offline from a URDF (urdf.h) or from
 * arrays (dpt_compile_arm) into a .dpa file (docs/format.md), and is used in place in the bytes of that file. The bytes
 * must outlive the arm and must not change while it is open. mesh.h says why, and how to open a file that others can
 * write.
 *
 * All answers are in the root's frame. `joints` of a function are the joint coordinates: `dpt_arm_info.joints` numbers,
 * in rad or m, in the order of dpt_arm_get_joint. They may lie outside of their limits. If any number of a call is not
 * finite or beyond DPT_COORDINATE_MAX, the call returns DPT_E_FINITE and writes nothing.
 *
 * Threads: an open arm is read-only. Every function that takes one may be called from several threads at once. All
 * functions are stateless, allocate nothing, and give the same bits on every machine. dpt_arm_convert writes to its
 * bytes, which no other thread may use meanwhile.
 */
#ifndef DYNPOINT_ARM_H
#define DYNPOINT_ARM_H

#include "dynpoint/hull.h"
#include "dynpoint/mesh.h"

#define DPT_ARM_LINKS_MAX    64
#define DPT_ARM_SEGMENTS_MAX 64
#define DPT_ARM_BODIES_MAX   64
#define DPT_ARM_TIPS_MAX     64
#define DPT_ARM_NAME         64 /* bytes of a name, including the zeros after it; at least one */

DPT_BEGIN

/* Opaque: a pointer into the bytes that you opened. */
typedef struct dpt_arm dpt_arm;

/* How a joint moves its link. */
enum {
    DPT_JOINT_REVOLUTE = 0,   /* about its axis, between its limits */
    DPT_JOINT_CONTINUOUS = 1, /* about its axis, without limits */
    DPT_JOINT_PRISMATIC = 2   /* along its axis, between its limits */
};

/* A joint, and so a coordinate of the arm. */
typedef struct dpt_arm_joint {
    uint32_t size; /* sizeof(dpt_arm_joint) */
    uint32_t kind; /* DPT_JOINT_... */
    double lower;  /* limit, rad or m; lower <= upper; both are 0 for a continuous joint */
    double upper;
    double velocity; /* limit, rad/s or m/s, >= 0; 0: not known */
    double effort;   /* limit, Nm or N, >= 0; 0: not known */
    double damping;  /* Nms/rad or Ns/m, >= 0 */
    double friction; /* Nm or N, >= 0 */
    char name[DPT_ARM_NAME];
} dpt_arm_joint;

/*
 * A link that moves relative to its parent, with everything that is fixed to it:
 *     frame = parent's frame . pose . motion(axis, factor * joint + offset)
 * Here `motion` turns about the axis or shifts along it, and `joint` is the coordinate of the link's joint. Links that
 * mimic a joint share its coordinate.
 */
typedef struct dpt_arm_link {
    uint32_t size;    /* sizeof(dpt_arm_link) */
    uint32_t parent;  /* index of a link before this one; DPT_NONE: the root */
    uint32_t joint;   /* index of the joint that moves it */
    uint32_t slides;  /* 0: it turns about the axis, 1: it slides along it */
    dpt_pose pose;    /* in the parent's frame, at factor * joint + offset = 0 */
    double axis[3];   /* unit, in the link's own frame */
    double factor;    /* not 0; 1 unless the link mimics */
    double offset;    /* rad or m */
    double mass;      /* kg; 0: not known */
    double centre[3]; /* of mass, in the link's frame, m */
} dpt_arm_link;

/* A mesh of the scene, fixed to the root. */
typedef struct dpt_arm_body {
    uint32_t size;        /* sizeof(dpt_arm_body) */
    uint32_t reserved;    /* 0 */
    dpt_pose pose;        /* in the root's frame */
    const dpt_mesh *mesh; /* in the arm's bytes, and valid as long as they are */
    size_t mesh_bytes;    /* length of the mesh */
    char name[DPT_ARM_NAME];
} dpt_arm_body;

/*
 * A convex part of the tool (hull.h, tip.h): a box, a wide cylinder or a mesh's hull. It is fixed to the tool, or to a jaw
 * link, which a jaw moves in the tool.
 */
typedef struct dpt_arm_tip {
    uint32_t size;                /* sizeof(dpt_arm_tip) */
    uint32_t link;                /* index of the jaw link that it is fixed to; DPT_NONE: the tool */
    uint32_t corner_count;        /* 3..DPT_HULL_CORNERS_MAX */
    uint32_t reserved;            /* 0 */
    const double *corners;        /* 3 coordinates each, m, in the frame of `link` or of the tool; in the arm's bytes */
    const void *reserved_pointer; /* NULL */
    double radius;                /* m, >= 0: as that of a dpt_hull_def */
    char name[DPT_ARM_NAME];      /* of its link in the URDF */
} dpt_arm_tip;

/* What an arm holds. */
typedef struct dpt_arm_info {
    uint32_t size;                /* sizeof(dpt_arm_info) */
    uint32_t format_version;      /* of the file */
    uint32_t joints;              /* 1..DPT_JOINTS_MAX, which is 8 */
    uint32_t links;               /* moving links, 1..DPT_ARM_LINKS_MAX */
    uint32_t segments;            /* of the tool, 0..DPT_ARM_SEGMENTS_MAX */
    uint32_t bodies;              /* 0..DPT_ARM_BODIES_MAX */
    uint32_t tool_link;           /* index of the link that the tool is fixed to */
    uint32_t reserved;            /* 0 */
    double mass;                  /* of all links, kg; 0: not known, and dpt_arm_weight gives 0 */
    dpt_pose tool;                /* the tool's frame, in the frame of tool_link */
    uint64_t source_bytes;        /* length of the source file; 0 if compiled from arrays */
    uint64_t source_hash;         /* its FNV-1a hash, 64 bits */
    uint64_t bytes;               /* length of the compiled file */
    char name[DPT_ARM_NAME];      /* of the robot */
    char root_name[DPT_ARM_NAME]; /* of the root link */
    char tool_name[DPT_ARM_NAME]; /* of the tool's link */
    uint32_t jaws;                /* joints that move parts of the tool, 0..DPT_JOINTS_MAX */
    uint32_t jaw_links;           /* 0..DPT_ARM_LINKS_MAX */
    uint32_t tips;                /* of the tool, 0..DPT_ARM_TIPS_MAX */
    uint32_t reserved_word;       /* 0 */
} dpt_arm_info;

/*
 * Open, verify or convert an arm, as dpt_mesh_open, dpt_mesh_verify and dpt_mesh_convert do a mesh. The meshes in the
 * file are checked and converted too. If one of these is damaged, `section` of the fault is a section of that mesh, and
 * `byte` counts from the beginning of the arm's file. A compiled mesh gives DPT_E_MAGIC here, and an arm gives it
 * there.
 */
DPT_API dpt_result dpt_arm_open(const void *bytes, size_t size, const dpt_arm **arm);
DPT_API dpt_result dpt_arm_verify(const void *bytes, size_t size, dpt_mesh_fault *fault);
DPT_API dpt_result dpt_arm_convert(void *bytes, size_t size, dpt_mesh_fault *fault);

/* Getters. Set the size field of the struct to be filled. An index out of range is DPT_E_ARGUMENT. */
DPT_API dpt_result dpt_arm_get_info(const dpt_arm *arm, dpt_arm_info *info);
DPT_API dpt_result dpt_arm_get_joint(const dpt_arm *arm, uint32_t index, dpt_arm_joint *joint);
DPT_API dpt_result dpt_arm_get_link(const dpt_arm *arm, uint32_t index, dpt_arm_link *link);
DPT_API dpt_result dpt_arm_get_body(const dpt_arm *arm, uint32_t index, dpt_arm_body *body);

/* Get a capsule of the tool, in the tool's frame, as dpt_tool_add takes it. */
DPT_API dpt_result dpt_arm_get_segment(const dpt_arm *arm, uint32_t index, dpt_segment *segment);

/*
 * What the tool has beside its capsules: tips, and the jaws that move some of them. A jaw is a joint, and a jaw link a link
 * whose parent is a jaw link, or DPT_NONE: the tool. Jaws are no coordinates of the arm, and do not move the tool's frame.
 * A tip becomes a hull by its corners and radius.
 */
DPT_API dpt_result dpt_arm_get_jaw(const dpt_arm *arm, uint32_t index, dpt_arm_joint *jaw);
DPT_API dpt_result dpt_arm_get_jaw_link(const dpt_arm *arm, uint32_t index, dpt_arm_link *link);
DPT_API dpt_result dpt_arm_get_tip(const dpt_arm *arm, uint32_t index, dpt_arm_tip *tip);

/*
 * Compute where a tip's corners are, for dpt_tool_set_tip_pose: the pose of their frame in the tool's frame.
 *   jaws   the jaws' coordinates, rad or m: dpt_arm_info.jaws numbers, in the order of dpt_arm_get_jaw; NULL if there are
 *          none. They may lie outside of their limits
 */
DPT_API dpt_result dpt_arm_tip_pose(const dpt_arm *arm, uint32_t index, const double *jaws, dpt_pose *pose);

/*
 * Compute the pose of the tool's frame. Its quaternion is continuous in the joints: a full turn of a joint changes the
 * quaternion's sign.
 */
DPT_API dpt_result dpt_arm_forward(const dpt_arm *arm, const double *joints, dpt_pose *tool);

/*
 * Compute how the tool's frame moves when the joints move at `rates` (rad/s or m/s): the velocity of its origin, m/s,
 * and its spin, rad/s.
 */
DPT_API dpt_result dpt_arm_velocity(const dpt_arm *arm, const double *joints, const double *rates, double velocity[3],
                                    double spin[3]);

/*
 * Compute the Jacobian, which maps rates to velocity and spin: 6 rows, first velocity x, y, z, then spin x, y, z, with
 * a column for each joint. It is stored row after row.
 */
DPT_API dpt_result dpt_arm_jacobian(const dpt_arm *arm, const double *joints, double *jacobian);

/*
 * Compute the efforts of the joints' motors, Nm or N, with which the tool exerts `wrench` on the hand; its torque is
 * about the tool's origin. This is the Jacobian's transpose (virtual work), at rest and without the arm's own weight.
 */
DPT_API dpt_result dpt_arm_efforts(const dpt_arm *arm, const double *joints, const dpt_wrench *wrench, double *efforts);

/*
 * Compute the efforts of the joints' motors, Nm or N, that hold up the arm's own weight at rest.
 *   gravity   acceleration in the root's frame, m/s^2: { 0, 0, -9.81 } if z is up
 */
DPT_API dpt_result dpt_arm_weight(const dpt_arm *arm, const double *joints, const double gravity[3], double *efforts);

DPT_END

#endif
