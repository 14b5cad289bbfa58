/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What is known of a deformable body: where its vertices are and will be, and its blocks. Rules about triangles ask
 * here for their corners, as of now or as of the last step.
 */
#ifndef DPT_TESTS_CALLS_DEFORM_MODEL_H
#define DPT_TESTS_CALLS_DEFORM_MODEL_H

#include "fuzz/calls/world_model.h"

struct soft {
    dpt_deformable_def def;          /* as the library must understand it, but for the box */
    unsigned char *block[2];         /* as it was taken from the heap */
    size_t room;                     /* bytes for the body in it */
    size_t offset;                   /* of these in the block */
    float low[3], high[3];           /* where the game moves vertices */
    float wall_low[3], wall_high[3]; /* the box that they never leave: that, or all that coordinates may be */
    float now[3 * VERTICES_MOST];
    /* With a period: where they began, where they are to be, and for how long they have been on their way. */
    float begin[3 * VERTICES_MOST], end[3 * VERTICES_MOST];
    double way;
    int is_on_its_way;
    int is_affine; /* they are an image of the mesh by an affine map that mirrors nothing */
};

/* Its block of world i, of soft->room bytes. */
static inline unsigned char *soft_block(const struct soft *soft, int i)
{
    return soft->block[i] + soft->offset;
}

/* Filled with something else in each world, and guarded; `off` bytes from where it is aligned. */
void soft_takes_blocks(struct soft *soft, size_t room, size_t off, int count);

/* It is gone: nothing wrote about its blocks, and they are given back at once. NULL: nothing. */
void soft_is_gone(struct soft *soft);

/* A step of dt was done, or failed with 0: where each deformable body's vertices were in it. */
void softs_have_stepped(struct scene *scene, double dt);

/* The vertices of the worlds' body are those of the model, as get_vertices tells them. */
void soft_must_be_there(const struct scene *scene, const struct model_body *body);

/* The corners of a triangle by its source number, in the body's frame; 0 if it was dropped. */
int corners_now(const struct model_body *body, uint32_t triangle, double corners[9]);
int corners_then(const struct body_then *body, uint32_t triangle, double corners[9]);

/* A body whose vertices are anywhere may be flat, or folded flat along an edge: there is no normal there. */
static inline int may_lack_normals(const float *positions, int is_affine)
{
    return positions && !is_affine;
}

/* It is closed, and does not cut itself. */
int is_solid_then(const struct body_then *body);

/* Where the vertices of all bodies were at the last step is known. */
int all_are_known(const struct scene *scene);

/* The tools' wrenches of a step that was just done: where all loads are known, they are due. */
void loads_are_due(struct scene *scene);

/* The loads of all deformable bodies, as the first world tells them. */
void loads_must_hold(const struct scene *scene);

#endif
