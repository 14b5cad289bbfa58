/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * libdynpoint_urdf: compiles a robot's description (URDF) to the bytes of an arm (arm.h). docs/urdf.md says how. It
 * reads through urdfdom and needs libdynpoint_compile. It allocates from the heap and prints nothing. What urdfdom logs
 * as a warning or an error is an error here. Reading numbers does not depend on the locale.
 *
 * Threads: every function may be called from any thread. Only one call reads a file at a time; other calls wait.
 *
 * Arm: the revolute, continuous and prismatic joints between the root and the tool's link, and the joints that these
 * mimic: 1 to 8 in all. Fixed joints make one link of two. A floating or planar joint between root and tool is an error.
 * The arm also contains other links that move with it, because the motors must carry their weight. Any other joint is
 * held still and noted: at 0, or at its limit nearest to 0; so is a joint below the tool, if no collision shape is behind
 * it.
 *
 * Tool: the collision cylinders, capsules and spheres of all links that fixed joints join to the tool's link, as
 * capsules in its frame. A cylinder has flat ends; it becomes the capsule of the same radius within it. Boxes, meshes and
 * cylinders that are wider than long become tips: convex bodies. Joints below the tool's link with collision shapes behind
 * them are jaws; all of these shapes become tips, which the jaws move in the tool's frame.
 *
 * Scene: the collision meshes and boxes of all links that fixed joints join to the root, as bodies with the link's
 * name. All other collision shapes are left out, and noted. A mesh that `mesh->recentre` moves is a body at its place all
 * the same. What the compiler notes of a mesh is a note of its link.
 */
#ifndef DYNPOINT_URDF_H
#define DYNPOINT_URDF_H

#include "dynpoint/compile.h"

DPT_BEGIN

/*
 * Receives a note: what was left out or held still, in words for a person, without the file's name. `line` is that of
 * the URDF, from 1; 0 if the location is not a line. dpt_urdf_compile_file calls this in the order of lines before it
 * returns DPT_OK. A URDF that is refused gets no notes.
 */
typedef void dpt_urdf_note_fn(void *user, uint64_t line, const char *text);

/* Settings. Apart from the size, 0 and NULL mean the defaults. */
typedef struct dpt_urdf_def {
    uint32_t size;          /* sizeof(dpt_urdf_def) */
    uint32_t without_scene; /* 1: leave the scene's meshes and boxes out, and do not look for them; else 0 */
    const char *tool;       /* name of the link that is the tool; NULL: the only link without children */
    /*
     * Folders in which package://NAME/rest is looked for, with ':' between them, or ';' on Windows. The first of these
     * files that exists is taken:
     *   1. NAME/rest in each of these folders, or rest where the folder's own name is NAME; none if NULL
     *   2. NAME/rest in the folder of the URDF, then in each folder above it
     *   3. rest in the folder of the URDF
     */
    const char *packages;
    /* For collision meshes: the scales multiply, and there are no cells. NULL: the defaults. */
    const dpt_compile_def *mesh;
    dpt_urdf_note_fn *note; /* NULL: none */
    void *user;             /* handed to `note` */
    /*
     * Names of links whose collision shapes are left out, of the scene and of the tool; the last one is followed by NULL.
     * Their masses stay. NULL: none.
     */
    const char *const *skip;
} dpt_urdf_def;

/* Fill in the defaults of the first `size` bytes. Call dpt_urdf_def_init, which passes your sizeof. */
DPT_API void dpt_urdf_def_defaults(dpt_urdf_def *def, size_t size);

static inline void dpt_urdf_def_init(dpt_urdf_def *def)
{
    dpt_urdf_def_defaults(def, sizeof *def);
}

/*
 * Compile a URDF.
 *
 *   path  of the URDF
 *   def   NULL: the defaults
 *   out   the compiled bytes, to be freed with dpt_compiled_free; {NULL, 0} on error
 *   diag  may be NULL; on error it names the link or joint, or the mesh file, and says why; its line is that of the
 *         URDF; on success its code is DPT_OK
 *
 * Errors:
 *
 *   DPT_E_OPEN         the URDF, or a mesh of the scene, cannot be read
 *   DPT_E_FORMAT       the file is not XML, not a URDF, or xacro
 *   DPT_E_SYNTAX, DPT_E_TRUNCATED, DPT_E_FINITE
 *                      the file breaks the rules of XML or of URDF
 *   DPT_E_UNSUPPORTED  the URDF describes no arm: a floating joint, nothing that moves; COLLADA or glTF in the scene
 *   DPT_E_LIMIT        too many joints, links, capsules, bodies or bytes, or a name that is too long
 *   DPT_E_ARGUMENT     the tool or a link to skip is not in the file; the tool is one of several links and was not named;
 *                      def is out of range
 */
DPT_API dpt_result dpt_urdf_compile_file(const char *path, const dpt_urdf_def *def, dpt_compiled *out, dpt_diag *diag);

DPT_END

#endif
