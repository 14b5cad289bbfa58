/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A part by itself, for questions of the compiler: how often it goes round a point, and whether a triangle meets
 * it. A tree over the part's triangles in their order, which is that of the box tree and so keeps near ones
 * together: sets of 16 triangles, then of 4 sets.
 */
#ifndef DPT_COMPILE_CLUSTER_H
#define DPT_COMPILE_CLUSTER_H

#include "compile/model.h"
#include "compile/moments.h"

#define CLUSTER_LEVELS 16u /* 16 * 4^15 is more than 2^32 triangles */

struct bounds {
    vec3 low, high;
};

struct cluster {
    const struct model *model;
    const uint32_t *triangles; /* borrowed */
    uint32_t triangle_count;
    uint32_t level_count
        [CLUSTER_LEVELS]; /* sets of a level; level 0: of triangles; the last one has a single set */
    uint32_t level_first[CLUSTER_LEVELS];
    uint32_t levels;
    struct winding_moment *node_moments;
    struct bounds *node_boxes;
};

/*
 * Of triangles of the model, each turned where model->turn says so. DPT_OK or DPT_E_MEMORY, without a diag; free it
 * whatever is returned.
 */
dpt_result cluster_build(struct cluster *cluster, const struct model *model,
                         const uint32_t *triangles, uint32_t count);
void cluster_free(struct cluster *cluster);

/*
 * The winding number at x of all but one triangle, DPT_NONE for all; within about 0.01. `work` gets the triangles
 * that were asked one by one added.
 */
double cluster_winding(const struct cluster *cluster, vec3 x, uint32_t excluded, uint64_t *work);

/* A triangle of the model comes as near as `reach` to one of the cluster's. */
int cluster_touches(const struct cluster *cluster, uint32_t triangle, double distance);

void model_corners(const struct model *model, uint32_t triangle, vec3 corners[3]);

struct bounds bounds_of_corners(const vec3 corners[3]);
struct bounds bounds_join(struct bounds a, struct bounds b);
int bounds_meet(const struct bounds *a, const struct bounds *b, double distance);

#endif
