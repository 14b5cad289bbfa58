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
 * little- and big-endian) and OFF. Reading numbers does not depend on the locale. Files of VTK, glTF, 3MF, COLLADA, Gmsh
 * and gzip are recognised by their content and refused; the error names the format (DPT_E_FORMAT;
 * docs/algorithms/compile.md#other-formats).
 *
 * Polygons: a polygon with n corners becomes n - 2 triangles, at its place in the order. A convex polygon becomes a fan
 * around its first corner; a concave one is divided by ear clipping. A polygon that crosses itself, or has a corner
 * farther from its best plane than a tenth of the diagonal of its box, becomes a fan, and a note says so.
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

/*
 * Receives a note: what you should know of a source that compiles, in words for a person. The line, byte and text are as
 * of an error, the code is DPT_OK. It is called from the calling thread, and is valid during the call only. A source that
 * is refused may have got notes before.
 */
typedef void dpt_compile_note_fn(void *user, const dpt_diag *note);

enum {
    DPT_NET_SHEET = 1, /* nodes are the vertices, springs lie in the surface */
    DPT_NET_VOLUME = 2 /* a cubic lattice fills the closed parts; the vertices are embedded in it */
};
enum { DPT_REGION_BOX = 1, DPT_REGION_SPHERE = 2 };

/*
 * Where the body is of another material, or fixed. Lengths in m, in the compiled mesh's frame, moved if that is. Its size is
 * final.
 */
typedef struct dpt_spring_region {
    uint32_t kind;  /* DPT_REGION_... */
    uint32_t fixed; /* 1: nodes in it do not move, and young, density and drag are not read; else 0 */
    double box[6];  /* a box: lowest x, y, z, highest x, y, z. A sphere: x, y, z, its radius, 0, 0 */
    double young;   /* Pa */
    double density; /* kg/m^3 */
    double drag;    /* 1/s */
} dpt_spring_region;

/*
 * Masses and springs (docs/algorithms/springs.md). Set the size and the kind. Of the numbers, 0 means the default.
 * Lengths are in m, in the compiled mesh's frame: after scaling.
 *
 * Springs of a sheet: every edge; the other diagonal across an edge that is the longest of both its triangles (shear);
 * with `bending`, also between the corners opposite any other edge of two triangles. A triangle of area A gives each of
 * its springs young * thickness * A / length^2, and 3/4 of that if it has four of them. Springs of a volume: the edges
 * and face diagonals of the lattice's cells, each cell counted by the share of it that is inside, at least 1/16.
 * Poisson's ratio is 1/3 in a sheet, and 1/4 in a volume of springs alone. With another one, cells of a volume have a
 * term for their volume beside the springs; that also turns back cells that were turned inside out, makes the stable
 * step shorter, and the file of format 7.
 *
 * Where regions overlap, the last one counts. A triangle or cell has the material at its centroid, a node the drag at
 * its own place. In a volume, a vertex is fixed by fixing the nodes that it follows.
 */
typedef struct dpt_spring_net_def {
    uint32_t size;                    /* sizeof(dpt_spring_net_def) */
    uint32_t kind;                    /* DPT_NET_... */
    double young;                     /* Young's modulus, Pa, at most 1e12; default 5000 */
    double density;                   /* kg/m^3, at most 1e9; default 1000 */
    double drag;                      /* 1/s, at most 1e9: damps motion against the body's frame; default none */
    double viscosity;                 /* s, at most 1e9: a spring's damping is that times its stiffness; default none */
    double thickness;                 /* of a sheet, at most 1e6; default 0.001 */
    double bending;                   /* of a sheet: Young's modulus of the bending springs, Pa; default none */
    double spacing;                   /* of the lattice; default: the box of the closed parts holds 20,000 cells */
    const dpt_spring_region *regions; /* region_count of them */
    const uint32_t *fixed;            /* fixed_count vertices, by their number in the source */
    uint32_t region_count;
    uint32_t fixed_count;
    double poisson; /* Poisson's ratio of a volume, 0.1 to 0.45; default 0.25: springs alone. Not for a sheet */
} dpt_spring_net_def;

/* Fill in the defaults of the first `size` bytes; the kind stays 0. Call dpt_spring_net_def_init. */
DPT_API void dpt_spring_net_def_defaults(dpt_spring_net_def *def, size_t size);

static inline void dpt_spring_net_def_init(dpt_spring_net_def *def)
{
    dpt_spring_net_def_defaults(def, sizeof *def);
}

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
    /*
     * 1: move the mesh, so that its box's centre comes near the origin: floats are fine there. dpt_mesh_info.origin says
     * by how much, in few digits; coordinates are at most 1e9 m before. 0: the mesh stays in the source's frame. It does
     * not go with cells.
     *
     * A mesh that lies so far from the origin that floats are too coarse for it is noted, where vertices are rounded by
     * more than a thousandth of the triangles' median edge. It is refused beyond a tenth, as DPT_E_FINITE, unless it is
     * moved. The texts name `dynpoint compile --recentre`, which sets this.
     */
    uint32_t recentre;

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

    /*
     * Make masses and springs, for physics of the library's own; NULL: none. It excludes cells.
     *
     * DPT_E_ARGUMENT for numbers outside of their ranges, for a region that holds nothing of the body, for a fixed
     * vertex that no triangle uses, for a volume without a closed part, and if all nodes are fixed. DPT_E_INDEX for a
     * vertex that is not there. DPT_E_LIMIT for more than 2^22 cells in the box of the closed parts, and for a vertex
     * with more than 1024 springs. DPT_E_FINITE for masses, stiffnesses and lengths outside of 1e-15..1e15. The diag's
     * text names the region, from 1, or the vertex of the source, from 0.
     */
    const dpt_spring_net_def *springs;
    /*
     * Of dpt_compile_bytes, the name that the bytes have as a file, as "liver.obj": its extension tells the format where
     * the content does not, as for dpt_compile_file, which goes by its path. Nothing is opened. NULL: there is none
     */
    const char *name;
    dpt_compile_note_fn *note; /* NULL: none */
    void *note_user;           /* handed to `note` */
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
 *   path      opened and read once, so it may be a pipe; NULL is DPT_E_ARGUMENT. DPT_E_LIMIT: it has no length, as a
 *             pipe, and more than 2^30 bytes come
 *   def       NULL: the defaults
 *   out       the compiled bytes; {NULL, 0} on error
 *   diag      may be NULL; on error says where and why; on success its code is DPT_OK
 *   vertices  vertex_count times x, y, z
 *   corners   triangle_count times three vertex numbers, from 0. DPT_E_LIMIT, before anything is read: more than
 *             2^31 - 1 vertices, or than 2^32 / 3 triangles
 */
DPT_API dpt_result dpt_compile_file(const char *path, const dpt_compile_def *def, dpt_compiled *out, dpt_diag *diag);
DPT_API dpt_result dpt_compile_bytes(const void *source, size_t size, const dpt_compile_def *def, dpt_compiled *out,
                                     dpt_diag *diag);
DPT_API dpt_result dpt_compile_arrays(const double *vertices, size_t vertex_count, const uint32_t *corners,
                                      size_t triangle_count, const dpt_compile_def *def, dpt_compiled *out,
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
 * - Jaws and their links are as joints and links. Without a tip there are none.
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
    uint32_t jaw_count;
    uint32_t jaw_link_count;
    uint32_t tip_count;
    uint32_t reserved_word; /* 0 */
    const dpt_arm_joint *jaws;
    const dpt_arm_link *jaw_links;
    const dpt_arm_tip *tips;
    const void *reserved_pointer; /* NULL */
} dpt_arm_def;

/* Compile an arm. As the functions above; the diag's text names a joint, link, segment or body by its index, from 0. */
DPT_API dpt_result dpt_compile_arm(const dpt_arm_def *def, dpt_compiled *out, dpt_diag *diag);

/*
 * The corners of a hull (hull.h) that holds many points, as those of a mesh: what becomes a tool's tip (tip.h).
 *   points    3 coordinates each, m, at most DPT_COORDINATE_MAX; 3 points to 2^31 - 1
 *   corners   room for `capacity` corners, 4..DPT_HULL_CORNERS_MAX; each is one of the points, or near one of them where
 *             they are thinner than 1e-3 of their size: such a set becomes flat
 *   radius    m, for the hull's def. 0: the corners are those of the points' hull, within 1e-8 of its size. Else points
 *             stand out of the corners' hull by so much: they are flat but for that, or their hull has more corners
 *
 * It takes up to a second for 10^5 points. DPT_E_ARGUMENT: the points lie on one line, or nearly. DPT_E_FINITE.
 * DPT_E_MEMORY.
 */
DPT_API dpt_result dpt_compile_hull(const double *points, size_t point_count, double *corners, uint32_t capacity,
                                    uint32_t *corner_count, double *radius);

/* Free the bytes, and set the struct to {NULL, 0}. NULL and {NULL, 0} are allowed. */
DPT_API void dpt_compiled_free(dpt_compiled *compiled);

DPT_END

#endif
