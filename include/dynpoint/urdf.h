/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * libdynpoint_urdf: a robot's description (URDF) compiled to the bytes of an arm (arm.h); docs/urdf.md. Reads
 * through urdfdom; needs libdynpoint_compile. Allocates from the heap, prints nothing, may be called from any thread: one
 * reads at a time. What urdfdom complains of is an error here; numbers are read without regard to the locale.
 *
 * The arm is what lies between the root and the tool's link: revolute, continuous and prismatic joints, 1 to 8, those
 * that they mimic among them; fixed joints join links. Floating and planar joints on that way are refused. Off that way
 * a link counts when it moves with the arm: its mass is held up too. A joint there that mimics nothing of the arm is
 * held at 0, or at the limit nearest to it, and noted.
 *
 * Tool: the cylinders, capsules and spheres among the collision shapes of links that fixed joints join to the tool's
 * link, as capsules in its frame. A cylinder's ends are flat, the capsule's lie within them; one that is wider than long
 * becomes the ball in it, and is noted. Scene: collision meshes and boxes of links that fixed joints join to the root,
 * as bodies with the link's name. Any other collision shape is left out, and noted.
 */
#ifndef DYNPOINT_URDF_H
#define DYNPOINT_URDF_H

#include "dynpoint/compile.h"

DPT_BEGIN

/*
 * What was left out or held still: text for people, without the file's name. `line` is the URDF's, from 1; 0 where the
 * place is not a line. Called from within dpt_urdf_compile_file, in the order of lines, before it returns DPT_OK; what is
 * refused has no notes.
 */
typedef void dpt_urdf_note_fn(void *user, uint64_t line, const char *text);

/* Zeros are the defaults, but for the size. */
typedef struct dpt_urdf_def {
    uint32_t size; /* sizeof(dpt_urdf_def) */
    uint32_t reserved;
    const char *tool; /* the link that is the tool; NULL: the only one without children */
    /*
     * Where package://NAME/... is: directories that hold one called NAME, ':' between them. Then, and with NULL alone,
     * the file's own and those above it; last its own, in which what comes behind NAME is looked for.
     */
    const char *packages;
    const dpt_compile_def *mesh; /* for collision meshes; NULL: the defaults. Scales multiply */
    dpt_urdf_note_fn *note;
    void *user;                   /* of note */
    const void *reserved_pointer; /* NULL */
} dpt_urdf_def;

/* Fill in the first `size` bytes; what dpt_urdf_def_init calls with its own caller's sizeof. */
DPT_API void dpt_urdf_def_defaults(dpt_urdf_def *def, size_t size);

static inline void dpt_urdf_def_init(dpt_urdf_def *def)
{
    dpt_urdf_def_defaults(def, sizeof *def);
}

/*
 * def   NULL for the defaults
 * out   written on success; {NULL, 0} on error. dpt_compiled_free gives it back
 * diag  may be NULL; on error tells which link or joint, or which mesh file, and why; `line` is the URDF's; else its
 *       code is DPT_OK
 *
 * DPT_E_OPEN     the file, or a mesh of the scene, cannot be read
 * DPT_E_FORMAT   no XML, no URDF, or xacro
 * DPT_E_SYNTAX, DPT_E_TRUNCATED, DPT_E_FINITE   it breaks the rules of XML or of URDF
 * DPT_E_UNSUPPORTED   it is a URDF, and no arm: a floating joint, nothing that moves, COLLADA
 * DPT_E_LIMIT    too many joints, links, capsules, bodies or bytes, or a name too long
 * DPT_E_ARGUMENT   no such tool, or none among several; def is out of range
 */
DPT_API dpt_result dpt_urdf_compile_file(const char *path, const dpt_urdf_def *def,
                                         dpt_compiled *out, dpt_diag *diag);

DPT_END

#endif
