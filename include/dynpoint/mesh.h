/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A compiled mesh: the content of a .dpa file (docs/format.md), used in place. Nothing is parsed, copied or allocated.
 * The bytes may lie in memory or in flash, or be mapped from a file. They must outlive the mesh.
 *
 * The bytes must not change while the mesh is open: the indices in them are checked once, when the mesh is opened. If
 * another user or program can write the file, read it into your own memory and open that. If a mapped file is changed,
 * the library reads wild addresses; if it is truncated, SIGBUS ends the program.
 *
 * Threads: an open mesh is read-only. Every function that takes one may be called from several threads at once.
 * dpt_mesh_convert writes to its bytes, which no other thread may use meanwhile.
 */
#ifndef DYNPOINT_MESH_H
#define DYNPOINT_MESH_H

#include "dynpoint/types.h"

DPT_BEGIN

/* Opaque: a pointer into the bytes that you opened. */
typedef struct dpt_mesh dpt_mesh;

/* Where a file is damaged. */
typedef struct dpt_mesh_fault {
    uint32_t size;    /* sizeof(dpt_mesh_fault) */
    int32_t code;     /* the result that the call returned */
    uint64_t byte;    /* offset of the first wrong byte, section or entry */
    char section[16]; /* its name, or "header" or "padding" */
} dpt_mesh_fault;

/*
 * Check a whole file: magic, version, lengths, checksums, every index and coordinate. Afterwards the library uses the
 * indices without checks. dpt_mesh_open gives the mesh. dpt_mesh_verify makes the same checks, and says where one
 * failed.
 *
 *   bytes   aligned to 8; an alignment of 64 is only faster
 *   mesh    written on success only
 *   fault   may be NULL; says where the file is damaged
 *
 * DPT_E_BYTE_ORDER on a big-endian host: convert a copy first, with dpt_mesh_convert.
 */
DPT_API dpt_result dpt_mesh_open(const void *bytes, size_t size, const dpt_mesh **mesh);
DPT_API dpt_result dpt_mesh_verify(const void *bytes, size_t size, dpt_mesh_fault *fault);

/*
 * Convert a file to the host's byte order, in place, and check it. A file that is already in that order, as every file
 * on a little-endian host, is only checked.
 */
DPT_API dpt_result dpt_mesh_convert(void *bytes, size_t size, dpt_mesh_fault *fault);

/* What the compiler found in the source, what it repaired, and what the file holds. */
typedef struct dpt_mesh_info {
    uint32_t size;             /* sizeof(dpt_mesh_info) */
    uint32_t format_version;   /* of the file */
    uint32_t triangles;        /* without those that were dropped */
    uint32_t vertices;         /* distinct positions that a triangle uses */
    uint32_t source_triangles; /* a polygon of n corners counts as n - 2 */
    uint32_t source_vertices;
    uint32_t dropped_degenerate; /* triangles with two equal corners, or without area */
    uint32_t dropped_duplicate;  /* triangles with the same three corners as one of lower number */
    uint32_t unused_vertices;    /* vertices of the source that no polygon uses */
    uint32_t concave_polygons;   /* polygons that are concave: cut by their ears */
    uint32_t open_edges;         /* edges with one triangle, counted after the dropping */
    uint32_t nonmanifold_edges;  /* edges with three triangles or more */
    uint32_t wrong_way_edges;    /* edges that two triangles run through in the same direction */
    uint32_t components;         /* parts: sets of triangles connected by edges */
    uint32_t closed_components;  /* parts without open and non-manifold edges, wound one way */
    uint32_t inward_components;  /* closed parts that were wound inward in the source, and turned */
    uint32_t turned_triangles;   /* triangles whose winding the compiler reversed */
    uint32_t tree_levels;        /* levels of boxes in the box tree */
    double scale;                /* vertex = (float)(scale * source) */
    double rounding;             /* largest |vertex - (scale * source - origin)| of a coordinate, m */
    double box_min[3];
    double box_max[3];
    uint64_t source_bytes; /* length of the source file; 0 if compiled from arrays */
    uint64_t source_hash;  /* its FNV-1a hash, 64 bits */
    uint64_t bytes;        /* length of the compiled file */
    /* Since format 2. For an older file, what follows from its other fields. */
    uint32_t solid_components;   /* parts that have an inside: closed ones, and some with defects */
    uint32_t cavities;           /* of these, parts wound inward: walls of voids in other parts */
    uint32_t winding_components; /* of these, parts whose inside only the winding number tells */
    uint32_t buried_components;  /* of these, parts that lie wholly within another one */
    /* Since format 3. 0 for an older file. */
    uint32_t crease_edges;        /* edges with two triangles whose normals differ by more than `crease` */
    uint32_t normalless_vertices; /* vertices where parts meet in a point, or face normals cancel */
    double crease;                /* limit of the angle between face normals, rad */
    /* Since format 4. DPT_NONE, 0 and DPT_NONE for an older file: not known. */
    uint32_t self_intersections;      /* pairs of triangles that cut each other; 10,000 at most */
    uint32_t self_intersections_more; /* 1: the search stopped early, and there may be more */
    uint32_t self_intersection[2];    /* one such pair, by source numbers; DPT_NONE: none */
    /* Since format 5. 0 for an older file. */
    uint32_t nodes;            /* of the mesh that the vertices are embedded in; 0: there is none */
    uint32_t outside_vertices; /* vertices outside of all its cells */
    double outside_distance;   /* largest distance of a vertex from all its cells, m */
    /* Since format 6. 0 for an older file, and without springs. */
    uint32_t spring_nodes;   /* nodes of the net: the vertices, or the nodes of the embedding */
    uint32_t springs;        /* each counted once */
    uint32_t spring_entries; /* dpt_mesh_springs.first[slices]: what a step reads, 192 bytes each */
    uint32_t fixed_nodes;    /* nodes that do not move */
    double viscosity;        /* s: the damping of a spring is that times its stiffness */
    double spring_mass;      /* of the body, kg: fixed nodes counted as if they were free */
    double poisson;          /* Poisson's ratio: 1/3 of a sheet, 0.1 to 0.45 of a volume */
    double stable_step;      /* largest stable step of symplectic Euler without damping, s; a bound */
    /* Since format 7. 0 for an older file, and for a mesh that was not moved. */
    double origin[3]; /* where the mesh's origin lies in the source's frame, m: vertex = scale * source - origin */
} dpt_mesh_info;

/*
 * Fill in `info`. Set its size field first.
 *
 * Two triangles cut each other if their interiors have a point in common: they cross, or they overlap in one plane.
 * Triangles that only touch, along edges or at corners, do not cut each other. winding_components counts a closed part
 * that cuts itself, and one in which the search stopped early; then self_intersections_more is 1.
 */
DPT_API dpt_result dpt_mesh_get_info(const dpt_mesh *mesh, dpt_mesh_info *info);

/* A section of the file. */
typedef struct dpt_mesh_section {
    uint32_t size; /* sizeof(dpt_mesh_section) */
    uint32_t crc32;
    uint64_t offset;
    uint64_t bytes;
    char name[16];
} dpt_mesh_section;

/* Get section `index`, from 0. DPT_E_ARGUMENT if there is no such section. */
DPT_API dpt_result dpt_mesh_get_section(const dpt_mesh *mesh, uint32_t index, dpt_mesh_section *section);

/*
 * Get the three corners of a triangle, x, y, z each, in the mesh's frame, m. `number` is its source number. It is wound
 * as the compiler left it. DPT_E_ARGUMENT if there is no such number, or the triangle was dropped.
 */
DPT_API dpt_result dpt_mesh_get_triangle(const dpt_mesh *mesh, uint32_t number, double corners[9]);

/*
 * Get all vertices and all triangles, for a viewer or a copy. The arrays lie in the mesh's bytes.
 *
 *   xyz       *count vertices, 3 floats each, in the mesh's frame, m
 *   corners   *count triangles, 3 indices of vertices each, in no stated order; wound as above
 *   numbers   the source number of each of these triangles; NULL if you do not need them
 */
DPT_API dpt_result dpt_mesh_get_vertices(const dpt_mesh *mesh, const float **xyz, uint32_t *count);
DPT_API dpt_result dpt_mesh_get_triangles(const dpt_mesh *mesh, const uint32_t **corners, const uint32_t **numbers,
                                          uint32_t *count);

/*
 * Get the number in the source of each vertex, for a program that moves its own array of the source's vertices:
 * xyz[v] = mine[sources[v]]. The array lies in the mesh's bytes.
 *
 *   sources   one number for each of dpt_mesh_get_vertices, from 0; no two are alike
 *
 * Vertices of the source at one position, after scaling and rounding, are one vertex here. It has the lowest number of
 * those that a polygon uses. A vertex that no polygon uses has none here. An STL has three vertices for each triangle,
 * in the order of the file. DPT_E_UNSUPPORTED for a file before format 5.
 */
DPT_API dpt_result dpt_mesh_get_vertex_sources(const dpt_mesh *mesh, const uint32_t **sources, uint32_t *count);

/*
 * Get the embedding of the vertices in a mesh of tetrahedra, usually a coarser one that somebody's physics moves. It is
 * there if the mesh was compiled with dpt_compile_def.cells, or with springs of a volume (dpt_spring_net_def), whose lattice
 * it is then. A vertex goes where its four nodes go:
 *
 *     vertex v = the sum over k = 0..3 of weights[4 v + k] * node[nodes[4 v + k]]
 *
 *   nodes        four for each of dpt_mesh_get_vertices, below *node_count; numbered as they were given
 *   weights      four for each vertex; their sum is 1; at most 128 in size
 *   node_count   all nodes, also those that no vertex uses
 *
 * Nodes are in the mesh's frame, in m: as they were given, times dpt_mesh_info.scale. As long as they stay there, the
 * sum is the vertex but for rounding: 2^-22 of the size of its cell, if it is within. A vertex within a cell has
 * weights of 0..1, but for rounding. One outside of all cells has some below 0. The arrays lie in the mesh's bytes.
 * Without an embedding, also in a file before format 5, both are NULL and *node_count is 0.
 */
DPT_API dpt_result dpt_mesh_get_embedding(const dpt_mesh *mesh, const uint32_t **nodes, const float **weights,
                                          uint32_t *node_count);

/* Masses and springs of a mesh that was compiled with dpt_compile_def.springs. The arrays lie in the mesh's bytes. */
typedef struct dpt_mesh_springs {
    uint32_t size;              /* sizeof(dpt_mesh_springs) */
    uint32_t nodes;             /* 0: the mesh has no springs, and all pointers are NULL */
    uint32_t slices;            /* of 16 nodes: (nodes + 15) / 16 */
    uint32_t springs;           /* each counted once */
    double viscosity;           /* s: the damping of a spring, N s/m, is that times its stiffness */
    const float *rest;          /* 3 a node: x, y, z at rest, in the mesh's frame, m */
    const float *mass;          /* 1 a node, kg; 0: the node is fixed */
    const float *drag;          /* 1 a node, 1/s: a force of -drag * mass * velocity */
    const uint32_t *first;      /* 1 a slice and one more: its first entry */
    const uint32_t *neighbours; /* 16 an entry: the other ends of 16 springs */
    const float *stiffness;     /* 16 an entry, N/m */
    const float *length;        /* 16 an entry: of the springs at rest, m */
    const void *reserved;       /* NULL */
} dpt_mesh_springs;

/*
 * Get the masses and springs. Set the size field first.
 *
 * Nodes are the vertices, if dpt_mesh_get_embedding has no nodes; else those that the vertices are embedded in. Entries
 * first[s] .. first[s + 1] - 1 belong to slice s. Word 16 e + k of an entry e is for node 16 s + k: a spring between
 * that node and neighbours[16 e + k]. Each spring stands in the rows of both its nodes. The neighbours of a node ascend
 * with e. A node that has no spring in an entry, and a lane beyond the last node, has itself as neighbour there, with
 * stiffness 0 and length 1. DPT_E_ARGUMENT for NULL, DPT_E_SIZE for a size below today's.
 */
DPT_API dpt_result dpt_mesh_get_springs(const dpt_mesh *mesh, dpt_mesh_springs *springs);

/*
 * Get the normals at the three corners of a triangle, by its source number. The normal at a vertex is the
 * angle-weighted mean over all triangles of the same part there. It is unit and points outside, or to the front of an
 * open sheet. It is zero if the triangles' normals cancel. The normals are those of the mesh as it was compiled.
 *
 * The file holds the normals, in float. Where it holds none (an older file, loose triangles, a vertex that several
 * parts share), the call computes them, in time linear in the triangles at the vertex.
 */
DPT_API dpt_result dpt_mesh_get_vertex_normals(const dpt_mesh *mesh, uint32_t number, double normals[9]);

/*
 * Flags of edge and corner k = 0, 1, 2 of a triangle: a bit below, shifted left by k. Edge k runs from corner k to the
 * next corner, as dpt_mesh_get_triangle gives them. A corner has a bit if any edge at its vertex has that bit.
 */
enum {
    DPT_EDGE_BORDER = 0x1,      /* one triangle */
    DPT_EDGE_NONMANIFOLD = 0x8, /* three triangles or more */
    DPT_EDGE_CREASE = 0x40      /* two triangles; normals differ by more than dpt_mesh_info.crease */
};
enum { DPT_CORNER_BORDER = 0x200, DPT_CORNER_NONMANIFOLD = 0x1000, DPT_CORNER_CREASE = 0x8000 };

/* Get the flags of a triangle by its source number. DPT_E_UNSUPPORTED for a file before format 3. */
DPT_API dpt_result dpt_mesh_get_triangle_flags(const dpt_mesh *mesh, uint32_t number, uint32_t *flags);

DPT_END

#endif
