/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * libdynpoint_compile: the offline compiler. Turns a mesh, from a file or from arrays, into the bytes
 * of a .dpa file that dpt_mesh_open uses in place. Allocates from the heap; may be called from any
 * thread. Time n log n in the triangles with a small factor, memory linear, hubs included. Starts threads only
 * where the def allows it, and none outlives the call; the bytes are the same for any number of them, and where
 * the system refuses one, its work is done without. The progress callback is called from the calling thread.
 *
 * Reads OBJ (faces with v, v/vt, v//vn, v/vt/vn, negative indices, polygons), STL (ASCII and binary),
 * PLY (ASCII, little- and big-endian), OFF. Numbers are read without regard to the locale.
 *
 * Mends only this, and reports it (dpt_mesh_info): equal vertices are joined, degenerate and duplicate
 * triangles dropped, parts with an inside wound one way and outward, but walls of cavities inward. Anything
 * else compiles as it is: the distance to a soup is well defined.
 */
#ifndef DYNPOINT_COMPILE_H
#define DYNPOINT_COMPILE_H

#include "dynpoint/arm.h"

DPT_BEGIN

enum {
    DPT_FORMAT_AUTO = 0, /* by content, then by the file's ending */
    DPT_FORMAT_OBJ = 1,
    DPT_FORMAT_STL = 2,
    DPT_FORMAT_PLY = 3,
    DPT_FORMAT_OFF = 4
};

/* What is wrong with an input, for a person. */
typedef struct dpt_diag {
    uint32_t size; /* sizeof(dpt_diag) */
    int32_t code;
    uint64_t line;  /* from 1; 0 when the place is not a line */
    uint64_t byte;  /* offset from 0, where line is 0 */
    char text[160]; /* the reason, without the file's name */
} dpt_diag;

/*
 * Called now and then from within the compiler: which step, and how much of it is done (0..1).
 * Return 0 to go on; anything else stops it with DPT_E_CANCELLED.
 */
typedef int dpt_progress_fn(void *user, const char *step, double done);

/* Zeros are the defaults, but for the size; dpt_compile_def_init says them in numbers. */
typedef struct dpt_compile_def {
    uint32_t size;   /* sizeof(dpt_compile_def) */
    uint32_t format; /* DPT_FORMAT_... */
    double scale;    /* metres per unit of the source; 0 means 1; must be positive */
    dpt_progress_fn *progress;
    void *user;
    /* A def that ends here is taken too. */
    double
        crease; /* normals of two triangles that differ by more make a crease; rad, 0 means pi / 3; pi: none is */
    uint32_t threads;  /* at most so many, the calling one among them, and 64; 0 means 1 */
    uint32_t reserved; /* 0 */
} dpt_compile_def;

/* Fill in the first `size` bytes; what dpt_compile_def_init calls with its own caller's sizeof. */
DPT_API void dpt_compile_def_defaults(dpt_compile_def *def, size_t size);

static inline void dpt_compile_def_init(dpt_compile_def *def)
{
    dpt_compile_def_defaults(def, sizeof *def);
}

/* The bytes of a .dpa file, owned by whoever asked; give them back with dpt_compiled_free. */
typedef struct dpt_compiled {
    void *bytes; /* aligned to 64 */
    size_t size;
} dpt_compiled;

/*
 * Compile a file, the bytes of a file, or arrays.
 *
 *   path      opened and read once, so it may be a pipe; NULL is DPT_E_ARGUMENT
 *   def       NULL for the defaults
 *   out       written on success; {NULL, 0} on error
 *   diag      may be NULL; on error tells where and why, else its code is DPT_OK
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
 * An arm from arrays; the fields are those of arm.h, and their sizes are set. A link comes after its parent, each
 * joint moves a link (one at least in the way that its kind says), and the joints that lead to the tool come first, in
 * their order from the root on. Quaternions and axes are of unit length within 1e-6, and made so; lengths, limits of position,
 * factors and masses are at most DPT_COORDINATE_MAX. `mesh` of a body is an open mesh, and is copied; its `mesh_bytes`
 * is not read.
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
    const char *name; /* NULL: none */
    const char *root_name;
    const char *tool_name;
    const void *reserved; /* NULL */
    uint64_t source_bytes;
    uint64_t source_hash;
} dpt_arm_def;

/* As the calls above; the diag's text names the joint, link, segment or body by its number from 0. */
DPT_API dpt_result dpt_compile_arm(const dpt_arm_def *def, dpt_compiled *out, dpt_diag *diag);

DPT_API void dpt_compiled_free(dpt_compiled *compiled);

DPT_END

#endif
