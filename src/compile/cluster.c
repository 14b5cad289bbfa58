/* SPDX-License-Identifier: BSD-3-Clause */
#include "compile/cluster.h"

#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "nearest/segment_triangle.h"

#define LEAF  16u
#define WIDTH 4u

/* What a set may be wrong by; some hundred sets are asked at most, and most are wrong by far less. */
#define SET_ERROR 1e-3

void model_corners(const struct model *model, uint32_t triangle, vec3 corners[3])
{
    const uint32_t *corner = model->corners + 3 * (size_t)triangle;
    for (int k = 0; k < 3; k++)
        corners[k] = vec3_of_float(model->positions + 3 * (size_t)corner[k]);
}

static vec3 least_of(vec3 a, vec3 b)
{
    return (vec3){ min_of(a.x, b.x), min_of(a.y, b.y), min_of(a.z, b.z) };
}

static vec3 most_of(vec3 a, vec3 b)
{
    return (vec3){ max_of(a.x, b.x), max_of(a.y, b.y), max_of(a.z, b.z) };
}

struct bounds bounds_of_corners(const vec3 c[3])
{
    return (struct bounds){ least_of(least_of(c[0], c[1]), c[2]),
                            most_of(most_of(c[0], c[1]), c[2]) };
}

struct bounds bounds_join(struct bounds a, struct bounds b)
{
    return (struct bounds){ least_of(a.low, b.low), most_of(a.high, b.high) };
}

int bounds_meet(const struct bounds *a, const struct bounds *b, double reach)
{
    return a->low.x <= b->high.x + reach && b->low.x <= a->high.x + reach &&
           a->low.y <= b->high.y + reach && b->low.y <= a->high.y + reach &&
           a->low.z <= b->high.z + reach && b->low.z <= a->high.z + reach;
}

static uint32_t least_count(uint32_t count, uint32_t most)
{
    return count < most ? count : most;
}

static void fill_leaf(struct cluster *cluster, uint32_t leaf)
{
    struct winding_moment sets[LEAF];
    uint32_t first = leaf * LEAF, count = least_count(cluster->triangle_count - first, LEAF);
    for (uint32_t i = 0; i < count; i++) {
        vec3 c[3];
        uint32_t t = cluster->triangles[first + i];
        model_corners(cluster->model, t, c);
        struct bounds box = bounds_of_corners(c);
        cluster->boxes[leaf] = i ? bounds_join(cluster->boxes[leaf], box) : box;
        sets[i] = cluster->model->turn[t] ? moment_of_triangle(c[0], c[2], c[1])
                                          : moment_of_triangle(c[0], c[1], c[2]);
    }
    cluster->moments[leaf] = moment_of_sets(sets, count);
}

static void fill_level(struct cluster *cluster, uint32_t level)
{
    for (uint32_t set = 0; set < cluster->count[level]; set++) {
        uint32_t below = cluster->first[level - 1] + set * WIDTH;
        uint32_t count = least_count(cluster->count[level - 1] - set * WIDTH, WIDTH);
        uint32_t at = cluster->first[level] + set;
        cluster->moments[at] = moment_of_sets(cluster->moments + below, count);
        cluster->boxes[at] = cluster->boxes[below];
        for (uint32_t i = 1; i < count; i++)
            cluster->boxes[at] = bounds_join(cluster->boxes[at], cluster->boxes[below + i]);
    }
}

dpt_result cluster_build(struct cluster *cluster, const struct model *model,
                         const uint32_t *triangles, uint32_t count)
{
    *cluster = (struct cluster){ .model = model, .triangles = triangles, .triangle_count = count };
    cluster->count[0] = (count + LEAF - 1) / LEAF;
    uint32_t sets = cluster->count[0];
    for (cluster->levels = 1; cluster->count[cluster->levels - 1] > 1; cluster->levels++) {
        cluster->count[cluster->levels] = (cluster->count[cluster->levels - 1] + WIDTH - 1) / WIDTH;
        cluster->first[cluster->levels] = sets;
        sets += cluster->count[cluster->levels];
    }
    cluster->moments = model_array(NULL, sets, sizeof *cluster->moments);
    cluster->boxes = model_array(NULL, sets, sizeof *cluster->boxes);
    if (!cluster->moments || !cluster->boxes)
        return DPT_E_MEMORY;
    for (uint32_t leaf = 0; leaf < cluster->count[0]; leaf++)
        fill_leaf(cluster, leaf);
    for (uint32_t level = 1; level < cluster->levels; level++)
        fill_level(cluster, level);
    return DPT_OK;
}

void cluster_free(struct cluster *cluster)
{
    free(cluster->moments);
    free(cluster->boxes);
    cluster->moments = NULL;
    cluster->boxes = NULL;
}

static double leaf_winding(const struct cluster *cluster, uint32_t leaf, vec3 x, uint32_t but)
{
    double sum = 0.0;
    uint32_t first = leaf * LEAF, count = least_count(cluster->triangle_count - first, LEAF);
    for (uint32_t i = 0; i < count; i++) {
        vec3 c[3];
        uint32_t t = cluster->triangles[first + i];
        if (t == but)
            continue;
        model_corners(cluster->model, t, c);
        double turns = solid_turns(sub(c[0], x), sub(c[1], x), sub(c[2], x));
        sum += cluster->model->turn[t] ? -turns : turns;
    }
    return sum;
}

static double set_winding(const struct cluster *cluster, uint32_t level, uint32_t set, vec3 x,
                          uint32_t but, uint64_t *work)
{
    double error, far = moment_winding(&cluster->moments[cluster->first[level] + set], x, &error);
    if (error < SET_ERROR)
        return far;
    if (level == 0) {
        *work += LEAF;
        return leaf_winding(cluster, set, x, but);
    }
    double sum = 0.0;
    uint32_t count = least_count(cluster->count[level - 1] - set * WIDTH, WIDTH);
    for (uint32_t i = 0; i < count; i++)
        sum += set_winding(cluster, level - 1, set * WIDTH + i, x, but, work);
    return sum;
}

double cluster_winding(const struct cluster *cluster, vec3 x, uint32_t but, uint64_t *work)
{
    return set_winding(cluster, cluster->levels - 1, 0, x, but, work);
}

/* An edge of the one comes near the other. */
static int triangles_meet(const vec3 a[3], const vec3 b[3], double reach)
{
    for (int k = 0; k < 3; k++) {
        pair one = segment_triangle(a[k], sub(a[(k + 1) % 3], a[k]), b[0], b[1], b[2]);
        pair two = segment_triangle(b[k], sub(b[(k + 1) % 3], b[k]), a[0], a[1], a[2]);
        if (one.distance2 <= reach * reach || two.distance2 <= reach * reach)
            return 1;
    }
    return 0;
}

static int set_meets(const struct cluster *cluster, uint32_t level, uint32_t set, const vec3 c[3],
                     const struct bounds *box, double reach)
{
    if (!bounds_meet(&cluster->boxes[cluster->first[level] + set], box, reach))
        return 0;
    if (level > 0) {
        uint32_t count = least_count(cluster->count[level - 1] - set * WIDTH, WIDTH);
        for (uint32_t i = 0; i < count; i++)
            if (set_meets(cluster, level - 1, set * WIDTH + i, c, box, reach))
                return 1;
        return 0;
    }
    uint32_t count = least_count(cluster->triangle_count - set * LEAF, LEAF);
    for (uint32_t i = 0; i < count; i++) {
        vec3 other[3];
        model_corners(cluster->model, cluster->triangles[set * LEAF + i], other);
        struct bounds its = bounds_of_corners(other);
        if (bounds_meet(&its, box, reach) && triangles_meet(c, other, reach))
            return 1;
    }
    return 0;
}

int cluster_meets(const struct cluster *cluster, uint32_t triangle, double reach)
{
    vec3 c[3];
    model_corners(cluster->model, triangle, c);
    struct bounds box = bounds_of_corners(c);
    return set_meets(cluster, cluster->levels - 1, 0, c, &box, reach);
}
