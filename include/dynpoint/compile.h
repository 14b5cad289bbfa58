/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * libdynpoint_compile: the offline compiler. It turns a mesh, from a file or from arrays, into the bytes of a .dpa
 * file. dpt_mesh_open uses these bytes in place. The compiler allocates from the heap. It takes time n log n in the
 * triangles, with a small factor, and linear memory; this holds for hubs too.
 *
 * Threads: every function may be called from any thread. The compiler starts threads of its own only if the def allows
 * it, and none outlives the call. The bytes are the same for any number of threads. If the system refuses a thread, the
 * calling thread does its work. The progress callback is called from the calling thread.
 *
 * Formats: OBJ (faces with v, v/vt, v//vn, v/vt/vn, negative indices, polygons), STL (ASCII and binary), PLY (ASCII,
 * little- and big-endian) and OFF. Reading numbers does not depend on the locale.
 *
 * Repairs: the compiler repairs only what follows, and reports it in dpt_mesh_info. It joins equal vertices. It drops
 * degenerate and duplicate triangles. It winds each part that has an inside one way: outward, or inward for the wall of
 * a cavity. All other defects stay: the distance to any set of triangles is well defined.
 *
 * Vertices keep the number that they have in the source (dpt_mesh_get_vertex_sources), for programs that move them.
 */
#ifndef DYNPOINT_COMPILE_H
#define DYNPOINT_COMPILE_H

#include "dynpoint/arm.h"

DPT_BEGIN

enum {
    DPT_FORMAT_AUTO = 0, /* found by the content, else by the file name extension */
    DPT_FORMAT_OBJ = 1,
    DPT_FORMAT_STL = 2,
    DPT_FORMAT_PLY = 3,
    DPT_FORMAT_OFF = 4
};

/* What is wrong with an input, in words for a person. */
typedef struct dpt_diag {
    uint32_t size;  /* sizeof(dpt_diag) */
    int32_t code;   /* as returned: DPT_OK or DPT_E_... */
    uint64_t line;  /* of the source, from 1; 0 if the location is not a line */
    uint64_t byte;  /* offset in the source, from 0, if line is 0 */
    char text[160]; /* the reason, without the file's name */
} dpt_diag;

/*
 * The compiler calls this now and then. `step` names what it does, `done` is the share of the step that is done, 0..1.
 * Return 0 to go on. Any other value stops the compiler with DPT_E_CANCELLED.
 */
typedef int dpt_progress_fn(void *user, const char *step, double done);

/* Settings. Apart from the size, 0 means the default. dpt_compile_def_init fills in the defaults as numbers. */
typedef struct dpt_compile_def {
    uint32_t size;             /* sizeof(dpt_compile_def) */
    uint32_t format;           /* DPT_FORMAT_... */
    double scale;              /* metres per unit of the source, positive; 0 means 1 */
    dpt_progress_fn *progress; /* NULL: none */
    void *user;                /* handed to `progress` */
    /* A def whose size ends here is accepted too. */

    /* An edge is a crease if the normals of its triangles differ by more than this; rad; 0: pi / 3; pi: no creases. */
    double crease;
    uint32_t threads; /* the most threads to use, the calling one included; at most 64; 0 means 1 */
    uint32_t reserved; /* 0 */

    /*
     * Embed the vertices in a mesh of tetrahedra that somebody's physics moves (dpt_mesh_get_embedding). Both counts
     * 0: no embedding.
     *
     *   nodes   node_count times x, y, z, in units of the source: multiplied by `scale`
     *   cells   cell_count times four node numbers, from 0; wound either way
     *
     * A vertex takes the lowest-numbered cell that holds it. Outside of all cells it takes the nearest one, whose
     * weights are continued beyond it: so the nodes at rest give the vertex itself, and any affine motion of them moves
     * it alike. Cells that would give it a weight of more than 100 in size, as thin ones do, are passed over for the
     * next nearest.
     *
     * DPT_E_FINITE for a node that is not finite or beyond DPT_COORDINATE_MAX after scaling, for a cell whose volume is
     * zero within rounding, and for a vertex that no cell gives weights of at most 100: it is too far away. DPT_E_INDEX
     * for a cell that names a node that is not there. DPT_E_LIMIT for more than 2^31 - 1 of either. The diag's text
     * names the node, the cell or the vertex of the source, from 0.
     */
    const double *nodes;
    const uint32_t *cells;
    uint32_t node_count;
    uint32_t cell_count;
} dpt_compile_def;

/* Fill in the defaults of the first `size` bytes. Call dpt_compile_def_init, which passes your sizeof. */
DPT_API void dpt_compile_def_defaults(dpt_compile_def *def, size_t size);

static inline void dpt_compile_def_init(dpt_compile_def *def)
{
    dpt_compile_def_defaults(def, sizeof *def);
}

/* The bytes of a .dpa file. The caller owns them, and frees them with dpt_compiled_free. */
typedef struct dpt_compiled {
    void *bytes; /* aligned to 64 */
    size_t size;
} dpt_compiled;

/*
 * Compile a file, the bytes of a file, or arrays.
 *
 *   path      opened and read once, so it may be a pipe; NULL is DPT_E_ARGUMENT
 *   def       NULL: the defaults
 *   out       the compiled bytes; {NULL, 0} on error
 *   diag      may be NULL; on error says where and why; on success its code is DPT_OK
 *   vertices  vertex_count times x, y, z
 *   corners   triangle_count times three vertex numbers, from 0
 */
DPT_API dpt_result dpt_compile_file(const char *path, const dpt_compile_def *def, dpt_compiled *out,
                                    dpt_diag *diag);
DPT_API dpt_result dpt_compile_bytes(const void *source, size_t size, const dpt_compile_def *def,
                                     dpt_compiled *out, dpt_diag *diag);
DPT_API dpt_result dpt_compile_arrays(const double *vertices, size_t vertex_count,
                                      const uint32_t *corners, size_t triangle_count,
                                      const dpt_compile_def *def, dpt_compiled *out,
                                      dpt_diag *diag);

/*
 * An arm as arrays. The structs are those of arm.h; set their size fields.
 *
 * - A link comes after its parent.
 * - Each joint moves at least one link in the way of its kind.
 * - The joints that lead to the tool come first, in their order from the root.
 * - Quaternions and axes are of unit length within 1e-6; the compiler normalises them.
 * - Lengths, limits of position, factors and masses are at most DPT_COORDINATE_MAX.
 * - `mesh` of a body is an open mesh. It is copied. `mesh_bytes` is not read.
 */
typedef struct dpt_arm_def {
    uint32_t size; /* sizeof(dpt_arm_def) */
    uint32_t joint_count;
    uint32_t link_count;
    uint32_t segment_count;
    uint32_t body_count;
    uint32_t tool_link;
    dpt_pose tool;
    const dpt_arm_joint *joints;
    const dpt_arm_link *links;
    const dpt_segment *segments;
    const dpt_arm_body *bodies;
    const char *name; /* of the robot; this and the next two: NULL for none */
    const char *root_name;
    const char *tool_name;
    const void *reserved; /* NULL */
    uint64_t source_bytes;
    uint64_t source_hash;
} dpt_arm_def;

/* Compile an arm. As the functions above; the diag's text names a joint, link, segment or body by its index, from 0. */
DPT_API dpt_result dpt_compile_arm(const dpt_arm_def *def, dpt_compiled *out, dpt_diag *diag);

/* Free the bytes, and set the struct to {NULL, 0}. NULL and {NULL, 0} are allowed. */
DPT_API void dpt_compiled_free(dpt_compiled *compiled);

DPT_END

#endif
