/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A surface as searches see it: the positions of its vertices, the boxes and filter blocks that follow from them, and
 * the topology of its triangles. For a rigid body all of it lies in the bytes of its mesh. A body with positions of
 * its own also has its own boxes and blocks; its topology is still the mesh's.
 *
 * Triangles are numbered by their place: the index in the file's order, which is that of the box tree. `sources`
 * leads to the number that users know.
 */
#ifndef DPT_SURFACE_H
#define DPT_SURFACE_H

#include "base/vec3.h"
#include "base/work.h"
#include "mesh/surface_motion.h"

struct surface {
    /* Topology and the shape of the tree, from the file. */
    const struct dpt_mesh *mesh;         /* for topology only, never for geometry */
    const uint32_t *corners;             /* 3 vertices a triangle */
    const uint32_t *sources;             /* the source number of each triangle */
    uint32_t count[MESH_LEVELS_MAX + 1]; /* nodes of each level of the box tree; level 0: leaves */
    uint32_t first[MESH_LEVELS_MAX + 1]; /* number of each level's first node; leaves from 0 */
    uint32_t levels;
    /* Geometry, in the body's frame. */
    const float *positions; /* 3 a vertex */
    const float *normals;   /* 3 a vertex, as from mesh_normals; or NULL */
    const float *leaves;    /* of MESH_LEAF_WORDS */
    /* Nodes of MESH_BOX_WORDS for each level; level 1: the parents of the leaves. */
    const float *level[MESH_LEVELS_MAX + 1];
    const float *moments;      /* nodes of MESH_MOMENT_WORDS; or NULL */
    const struct holes *holes; /* src/contact/winding_number.h; NULL: not known */
    vec3 box_min, box_max;     /* hold all vertices; of a deformable body at all times */
    double diagonal;           /* m: of the mesh's own box */
    vec3 filter_centre;        /* boxes, leaves and moments hold (x - centre) * scale */
    double filter_scale;
    struct surface_motion *motion; /* of a deformable body; NULL: the vertices are at rest */
    /* A view (surface_view): the vertices are where they were at a time of the motion before `view_tick`; 0: now. */
    uint32_t view_tick;
    double view_time;
};

/* The surface of a rigid mesh. */
void dpti_surface_of_mesh(const struct dpt_mesh *mesh, struct surface *surface);

/* m: the diagonal of the mesh's own box. */
static inline double surface_diagonal(const struct surface *surface)
{
    return surface->diagonal;
}

/* m: its largest |coordinate|. */
double dpti_surface_extent(const struct surface *surface);

/* The longest edge of a leaf's box, m. On a deformable body the box may be outdated: not for bounds. */
double dpti_surface_leaf_length(const struct surface *surface, uint32_t leaf);

/* Where a vertex of a view is. */
vec3 dpti_surface_between(const struct surface *view, uint32_t vertex);

/* The position of a vertex, in the body's frame. */
static inline vec3 surface_vertex(const struct surface *surface, uint32_t vertex)
{
    return surface->view_tick ? dpti_surface_between(surface, vertex)
                              : vec3_of_float(surface->positions + 3 * (size_t)vertex);
}

/* 1 if vertices moved before this tick of the world. */
static inline int surface_has_moved(const struct surface *surface, uint32_t tick)
{
    return surface->motion && surface->motion->tick == tick;
}

/*
 * A view of a surface whose vertices moved before `tick`, at a time of that motion: 0 is the last tick, 1 is now. It
 * has positions and topology alone; boxes, leaves and stored normals are those of now.
 */
static inline struct surface surface_view(const struct surface *surface, uint32_t tick, double time)
{
    struct surface view = *surface;
    view.view_tick = surface_has_moved(surface, tick) && time < 1.0 ? tick : 0;
    view.view_time = time;
    return view;
}

/* The vertex at corner k of a triangle, 0..2. */
static inline uint32_t surface_corner(const struct surface *surface, uint32_t triangle, uint32_t k)
{
    return surface->corners[3 * (size_t)triangle + k];
}

/* The positions of a triangle's three corners. */
static inline void surface_corners(const struct surface *surface, uint32_t triangle, vec3 v[3])
{
    for (uint32_t k = 0; k < 3; k++)
        v[k] = surface_vertex(surface, surface_corner(surface, triangle, k));
}

/*
 * The block of a leaf, and that of a node's children, for searches: first the surface follows its vertices there. On a
 * deformable body that costs work.
 */
static inline const float *surface_leaf(const struct surface *surface, uint32_t leaf, struct work *work)
{
    struct surface_motion *motion = surface->motion;
    if (motion && motion->followed[leaf] != motion->travel[leaf])
        work_spend_between(work, dpti_surface_follow_leaf(motion, leaf));
    return surface->leaves + (size_t)leaf * MESH_LEAF_WORDS;
}

static inline const float *surface_node(const struct surface *surface, uint32_t level, uint32_t node, struct work *work)
{
    struct surface_motion *motion = surface->motion;
    const uint32_t number = motion ? motion->first[level] + node : 0;
    if (motion && motion->followed[number] != motion->travel[number])
        work_spend_between(work, dpti_surface_follow_node(motion, level, node));
    return surface->level[level] + (size_t)node * MESH_BOX_WORDS;
}

/* The point of a triangle with these weights. */
static inline vec3 surface_point(const struct surface *surface, uint32_t triangle, const double weight[3])
{
    vec3 v[3];
    surface_corners(surface, triangle, v);
    return along(along(scaled(v[0], weight[0]), weight[1], v[1]), weight[2], v[2]);
}

/* What the margins of filters need on a deformable body, in the filter's frame. */
static inline double surface_margin(const struct surface *surface)
{
    return surface->motion ? MOTION_MARGIN : 0.0;
}

/* Whether x, in the body's frame, lies in the box of all vertices. */
static inline int surface_box_holds(const struct surface *surface, vec3 x)
{
    return x.x >= surface->box_min.x && x.y >= surface->box_min.y && x.z >= surface->box_min.z &&
           x.x <= surface->box_max.x && x.y <= surface->box_max.y && x.z <= surface->box_max.z;
}

static inline uint32_t surface_triangles(const struct surface *surface)
{
    return surface->mesh->triangles;
}

/* Neighbours, 3 a triangle: the one over the edge from corner k to k + 1; or MESH_EDGE_... */
static inline const uint32_t *surface_neighbours(const struct surface *surface)
{
    return mesh_words(surface->mesh, MESH_NEIGHBOURS);
}

/* The triangles at vertex v: fans[first[v]] up to, not including, fans[first[v + 1]]. */
static inline const uint32_t *surface_fans(const struct surface *surface, const uint32_t **first)
{
    *first = mesh_words(surface->mesh, MESH_FAN_FIRST);
    return mesh_words(surface->mesh, MESH_FANS);
}

/* A triangle's part. */
static inline uint32_t surface_part(const struct surface *surface, uint32_t triangle)
{
    return mesh_words(surface->mesh, MESH_PARTS)[triangle];
}

/* The MESH_PART_... bits of a part. */
static inline uint32_t surface_part_flags(const struct surface *surface, uint32_t part)
{
    return mesh_part_flags(surface->mesh, part);
}

/* The moments, or NULL; `lanes` gets a word for each leaf, with a bit for each triangle of a solid part. */
static inline const float *surface_moments(const struct surface *surface, const uint32_t **lanes)
{
    mesh_moments(surface->mesh, lanes);
    return surface->moments;
}

/* The DPT_EDGE_... and DPT_CORNER_... bits of each triangle; or NULL. */
static inline const uint32_t *surface_flags(const struct surface *surface)
{
    return mesh_flags(surface->mesh);
}

/* ---- normals of faces, edges and vertices, as triangles are wound: docs/algorithms/sign.md ---- */

/* The unit normal of a triangle, as it is wound; zero for one without area. */
vec3 dpti_surface_face_normal(const struct surface *surface, uint32_t triangle);

/*
 * The normal of the feature (face, edge or vertex) that holds the point of a triangle with these weights; not of
 * length 1. For every x whose nearest point is that point q, the sign of (x - q).normal tells whether x is in front
 * or behind (Baerentzen and Aanaes 2005).
 */
vec3 dpti_surface_feature_normal(const struct surface *surface, uint32_t triangle, const double weight[3]);

/*
 * The angle-weighted normal of the vertex at corner k, over the triangle's part: the file's unit normal in float, or
 * else the sum over the fan, which has any length.
 */
vec3 dpti_surface_vertex_normal(const struct surface *surface, uint32_t triangle, int k);

/*
 * The unit normal at the point of a triangle with these weights, interpolated between those of the corners; zero
 * where they cancel. At a crease the normal of a corner is that of its own side (docs/algorithms/sign.md).
 */
vec3 dpti_surface_smooth_normal(const struct surface *surface, uint32_t triangle, const double weight[3]);

/*
 * The angle-weighted normal of the vertex at corner k, of any length and in double, computed from the triangles at
 * the vertex (Baerentzen and Aanaes 2005).
 */
vec3 dpti_surface_fan_normal(const struct surface *surface, uint32_t triangle, int k);

/* The corner at which the point with these weights lies, or -1 if it lies at none. */
static inline int surface_lone_corner(const double weight[3])
{
    for (int k = 0; k < 3; k++)
        if (!(weight[(k + 1) % 3] > 0.0) && !(weight[(k + 2) % 3] > 0.0))
            return k;
    return -1;
}

/* The position of corner k, modulo 3, for any k >= 0. */
static inline vec3 surface_corner_point(const struct surface *surface, uint32_t triangle, int k)
{
    return surface_vertex(surface, surface_corner(surface, triangle, (uint32_t)(k % 3)));
}

#endif
