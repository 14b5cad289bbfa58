/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A compiled mesh, the content of a .dpa file (docs/format.md), used where its bytes lie: nothing is
 * parsed, copied or allocated. The bytes may be held in memory, in an array or in flash, or be mapped from a file; they
 * must outlive the mesh.
 *
 * They must stay as they were when they were opened: the indices in them are checked then, and never again. So read a
 * file that another user or program can write into memory of your own, and open that. A mapped file that is changed
 * gives wild reads; one that is cut short ends the program with SIGBUS.
 *
 * Threads: an open mesh is read-only; every function that takes one may be called from several threads at once.
 * dpt_mesh_convert writes to its bytes, which no other thread may use meanwhile.
 */
#ifndef DYNPOINT_MESH_H
#define DYNPOINT_MESH_H

#include "dynpoint/types.h"

DPT_BEGIN

/* Opaque; a pointer into the bytes that were opened. */
typedef struct dpt_mesh dpt_mesh;

/* Where a file is damaged. */
typedef struct dpt_mesh_fault {
    uint32_t size; /* sizeof(dpt_mesh_fault) */
    int32_t code;  /* as returned */
    uint64_t byte; /* offset of the first wrong byte, section or entry */
    char section[16];
} dpt_mesh_fault;

/*
 * Check all of a file, once: magic, version, lengths, checksums, every index and coordinate. After
 * that the library indexes without checks. dpt_mesh_open gives the mesh; dpt_mesh_verify does the same checks and tells
 * where they failed.
 *
 *   bytes   aligned to 8; 64 is only faster
 *   mesh    written on success only
 *   fault   may be NULL; on an error of the file tells where
 *
 * DPT_E_BYTE_ORDER on a big-endian host: dpt_mesh_convert a copy first.
 */
DPT_API dpt_result dpt_mesh_open(const void *bytes, size_t size, const dpt_mesh **mesh);
DPT_API dpt_result dpt_mesh_verify(const void *bytes, size_t size, dpt_mesh_fault *fault);

/*
 * Turn a file into the host's byte order, in place. On a little-endian host only checks it. A file
 * that is converted already stays as it is.
 */
DPT_API dpt_result dpt_mesh_convert(void *bytes, size_t size, dpt_mesh_fault *fault);

/* What the compiler found in the source, what it mended, and what the file holds. */
typedef struct dpt_mesh_info {
    uint32_t size;             /* sizeof(dpt_mesh_info) */
    uint32_t format_version;   /* of the file */
    uint32_t triangles;        /* that count: dropped ones are not among them */
    uint32_t vertices;         /* distinct positions that a triangle uses */
    uint32_t source_triangles; /* polygons of n corners count as n - 2 */
    uint32_t source_vertices;
    uint32_t dropped_degenerate; /* two corners alike, or no area */
    uint32_t dropped_duplicate;  /* the same three corners as a triangle of lower number */
    uint32_t unused_vertices;    /* of the source, by no polygon used */
    uint32_t concave_polygons;   /* cut into a fan all the same */
    uint32_t open_edges;         /* with one triangle, after dropping */
    uint32_t nonmanifold_edges;  /* with three or more */
    uint32_t wrong_way_edges;    /* two triangles run through it in the same direction */
    uint32_t components;         /* sets of triangles connected by edges */
    uint32_t closed_components;  /* of them without open and non-manifold edges, wound one way */
    uint32_t inward_components;  /* closed, wound inward in the source, and turned */
    uint32_t turned_triangles;   /* whose corners the compiler swapped */
    uint32_t tree_levels;
    double scale;    /* vertex = (float)(scale * source) */
    double rounding; /* largest |vertex - scale * source| of a coordinate, in m */
    double box_min[3];
    double box_max[3];
    uint64_t source_bytes; /* length of the source file; 0 when compiled from arrays */
    uint64_t source_hash;  /* its FNV-1a hash, 64 bits */
    uint64_t bytes;        /* length of the compiled file */
    /* From here on since format 2; of an older file as far as it tells. */
    uint32_t solid_components;   /* that have an inside: closed ones, and some with defects */
    uint32_t cavities;           /* of them wound inward: walls of voids within others */
    uint32_t winding_components; /* of them whose inside only a winding number tells */
    uint32_t buried_components;  /* of them with both sides inside: within another one */
    /* From here on since format 3; 0 of an older file. */
    uint32_t crease_edges;        /* with two triangles that meet at more than `crease` */
    uint32_t normalless_vertices; /* where parts meet in a point, or face normals cancel */
    double crease;                /* between face normals, in rad */
    /* From here on since format 4; DPT_NONE, 0 and DPT_NONE of an older file: not known. */
    uint32_t self_intersections;      /* pairs of triangles that cut each other; 10,000 at most */
    uint32_t self_intersections_more; /* 1: the search stopped, there may be more */
    uint32_t self_intersection[2];    /* one such pair, by source numbers; DPT_NONE: none */
} dpt_mesh_info;

/*
 * Fill `info`, whose size field is set.
 *
 * Two triangles cut each other when their interiors have a point in common: they cross, or overlap in one plane. What
 * touches along edges or at corners does not cut. A closed part that cuts itself is one of winding_components; so is
 * one that was not searched to the end, which adds self_intersections_more.
 */
DPT_API dpt_result dpt_mesh_get_info(const dpt_mesh *mesh, dpt_mesh_info *info);

/* One section of the file, from 0 until the call returns DPT_E_ARGUMENT. */
typedef struct dpt_mesh_section {
    uint32_t size; /* sizeof(dpt_mesh_section) */
    uint32_t crc32;
    uint64_t offset;
    uint64_t bytes;
    char name[16];
} dpt_mesh_section;

DPT_API dpt_result dpt_mesh_get_section(const dpt_mesh *mesh, uint32_t index,
                                        dpt_mesh_section *section);

/*
 * The three corners (x, y, z each, 9 numbers) of a triangle by its source number, wound as the
 * compiler left it. DPT_E_ARGUMENT when there is no such number or it was dropped.
 */
DPT_API dpt_result dpt_mesh_get_triangle(const dpt_mesh *mesh, uint32_t number, double corners[9]);

/*
 * All of them at once, where they lie in the mesh's bytes: for a viewer, or a copy of one's own.
 *
 *   xyz       *count vertices, 3 floats each, in m
 *   corners   *count triangles, 3 vertices each, in no stated order; wound as above
 *   numbers   of each its source number; NULL: not asked for
 */
DPT_API dpt_result dpt_mesh_get_vertices(const dpt_mesh *mesh, const float **xyz, uint32_t *count);
DPT_API dpt_result dpt_mesh_get_triangles(const dpt_mesh *mesh, const uint32_t **corners,
                                          const uint32_t **numbers, uint32_t *count);

/*
 * The angle-weighted normals of those three corners' vertices, over all triangles of the same part there: unit, along
 * the side that is outside or in front; zero where they cancel. As the file holds them, in float; where it holds none
 * (an older file, loose triangles, a vertex that parts share) worked out, in time with the vertex's triangles. Of the
 * mesh as it was compiled.
 */
DPT_API dpt_result dpt_mesh_get_vertex_normals(const dpt_mesh *mesh, uint32_t number,
                                               double normals[9]);

/*
 * What is special about edge and corner k of a triangle: the bit below shifted left by k = 0, 1, 2. Edge k runs from
 * corner k to the next one, as dpt_mesh_get_triangle gives them; a corner has a bit when any edge at its vertex has it.
 */
enum {
    DPT_EDGE_BORDER = 0x1,      /* no second triangle */
    DPT_EDGE_NONMANIFOLD = 0x8, /* three triangles or more */
    DPT_EDGE_CREASE = 0x40      /* two, whose normals differ by more than dpt_mesh_info's crease */
};
enum { DPT_CORNER_BORDER = 0x200, DPT_CORNER_NONMANIFOLD = 0x1000, DPT_CORNER_CREASE = 0x8000 };

/* Those bits. DPT_E_UNSUPPORTED of a file before format 3. */
DPT_API dpt_result dpt_mesh_get_triangle_flags(const dpt_mesh *mesh, uint32_t number,
                                               uint32_t *flags);

DPT_END

#endif
