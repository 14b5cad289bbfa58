/* SPDX-License-Identifier: BSD-3-Clause */
#include "compile/cluster.h"

#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "nearest/segment_triangle.h"

#define LEAF  16u
#define WIDTH 4u

/*
 * A node's far field is used where its error bound is below this. A query sums some hundred nodes at most, and the
 * error of most of them is far smaller.
 */
#define NODE_ERROR 1e-3

void model_corners(const struct model *model, uint32_t triangle, vec3 corners[3])
{
    const uint32_t *corner = model->corners + 3 * (size_t)triangle;
    for (int k = 0; k < 3; k++)
        corners[k] = vec3_of_float(model->positions + 3 * (size_t)corner[k]);
}

static vec3 min_coordinates(vec3 a, vec3 b)
{
    return (vec3){ min_of(a.x, b.x), min_of(a.y, b.y), min_of(a.z, b.z) };
}

static vec3 max_coordinates(vec3 a, vec3 b)
{
    return (vec3){ max_of(a.x, b.x), max_of(a.y, b.y), max_of(a.z, b.z) };
}

struct bounds bounds_of_corners(const vec3 c[3])
{
    return (struct bounds){ min_coordinates(min_coordinates(c[0], c[1]), c[2]),
                            max_coordinates(max_coordinates(c[0], c[1]), c[2]) };
}

struct bounds bounds_join(struct bounds a, struct bounds b)
{
    return (struct bounds){ min_coordinates(a.low, b.low), max_coordinates(a.high, b.high) };
}

int bounds_meet(const struct bounds *a, const struct bounds *b, double distance)
{
    return a->low.x <= b->high.x + distance && b->low.x <= a->high.x + distance && a->low.y <= b->high.y + distance &&
           b->low.y <= a->high.y + distance && a->low.z <= b->high.z + distance && b->low.z <= a->high.z + distance;
}

static uint32_t min_count(uint32_t count, uint32_t limit)
{
    return count < limit ? count : limit;
}

static void fill_leaf(struct cluster *cluster, uint32_t leaf)
{
    struct winding_moment sets[LEAF];
    uint32_t first = leaf * LEAF, count = min_count(cluster->triangle_count - first, LEAF);
    for (uint32_t i = 0; i < count; i++) {
        vec3 c[3];
        uint32_t t = cluster->triangles[first + i];
        model_corners(cluster->model, t, c);
        struct bounds box = bounds_of_corners(c);
        cluster->node_boxes[leaf] = i ? bounds_join(cluster->node_boxes[leaf], box) : box;
        sets[i] =
            cluster->model->is_turned[t] ? moment_of_triangle(c[0], c[2], c[1]) : moment_of_triangle(c[0], c[1], c[2]);
    }
    cluster->node_moments[leaf] = moment_of_sets(sets, count);
}

static void fill_level(struct cluster *cluster, uint32_t level)
{
    for (uint32_t node = 0; node < cluster->level_count[level]; node++) {
        uint32_t below = cluster->level_first[level - 1] + node * WIDTH;
        uint32_t count = min_count(cluster->level_count[level - 1] - node * WIDTH, WIDTH);
        uint32_t at = cluster->level_first[level] + node;
        cluster->node_moments[at] = moment_of_sets(cluster->node_moments + below, count);
        cluster->node_boxes[at] = cluster->node_boxes[below];
        for (uint32_t i = 1; i < count; i++)
            cluster->node_boxes[at] = bounds_join(cluster->node_boxes[at], cluster->node_boxes[below + i]);
    }
}

dpt_result cluster_build(struct cluster *cluster, const struct model *model, const uint32_t *triangles, uint32_t count)
{
    *cluster = (struct cluster){ .model = model, .triangles = triangles, .triangle_count = count };
    cluster->level_count[0] = (count + LEAF - 1) / LEAF;
    uint32_t sets = cluster->level_count[0];
    for (cluster->levels = 1; cluster->level_count[cluster->levels - 1] > 1; cluster->levels++) {
        cluster->level_count[cluster->levels] = (cluster->level_count[cluster->levels - 1] + WIDTH - 1) / WIDTH;
        cluster->level_first[cluster->levels] = sets;
        sets += cluster->level_count[cluster->levels];
    }
    cluster->node_moments = model_alloc(NULL, sets, sizeof *cluster->node_moments);
    cluster->node_boxes = model_alloc(NULL, sets, sizeof *cluster->node_boxes);
    if (!cluster->node_moments || !cluster->node_boxes)
        return DPT_E_MEMORY;
    for (uint32_t leaf = 0; leaf < cluster->level_count[0]; leaf++)
        fill_leaf(cluster, leaf);
    for (uint32_t level = 1; level < cluster->levels; level++)
        fill_level(cluster, level);
    return DPT_OK;
}

void cluster_free(struct cluster *cluster)
{
    free(cluster->node_moments);
    free(cluster->node_boxes);
    cluster->node_moments = NULL;
    cluster->node_boxes = NULL;
}

static double leaf_winding(const struct cluster *cluster, uint32_t leaf, vec3 x, uint32_t excluded)
{
    double sum = 0.0;
    uint32_t first = leaf * LEAF, count = min_count(cluster->triangle_count - first, LEAF);
    for (uint32_t i = 0; i < count; i++) {
        vec3 c[3];
        uint32_t t = cluster->triangles[first + i];
        if (t == excluded)
            continue;
        model_corners(cluster->model, t, c);
        double winding = solid_turns(sub(c[0], x), sub(c[1], x), sub(c[2], x));
        sum += cluster->model->is_turned[t] ? -winding : winding;
    }
    return sum;
}

static double node_winding(const struct cluster *cluster, uint32_t level, uint32_t node, vec3 x, uint32_t excluded,
                           uint64_t *work)
{
    const uint32_t at = cluster->level_first[level] + node;
    double error, far_field = moment_winding(&cluster->node_moments[at], x, &error);
    if (error < NODE_ERROR)
        return far_field;
    if (level == 0) {
        *work += LEAF;
        return leaf_winding(cluster, node, x, excluded);
    }
    double sum = 0.0;
    uint32_t count = min_count(cluster->level_count[level - 1] - node * WIDTH, WIDTH);
    for (uint32_t i = 0; i < count; i++)
        sum += node_winding(cluster, level - 1, node * WIDTH + i, x, excluded, work);
    return sum;
}

double cluster_winding(const struct cluster *cluster, vec3 x, uint32_t excluded, uint64_t *work)
{
    return node_winding(cluster, cluster->levels - 1, 0, x, excluded, work);
}

/* Does an edge of either triangle come within `distance` of the other triangle? */
static int triangles_touch(const vec3 a[3], const vec3 b[3], double distance)
{
    for (int k = 0; k < 3; k++) {
        pair one = segment_triangle(a[k], sub(a[(k + 1) % 3], a[k]), b[0], b[1], b[2]);
        pair two = segment_triangle(b[k], sub(b[(k + 1) % 3], b[k]), a[0], a[1], a[2]);
        if (one.distance2 <= distance * distance || two.distance2 <= distance * distance)
            return 1;
    }
    return 0;
}

static int node_touches(const struct cluster *cluster, uint32_t level, uint32_t node, const vec3 c[3],
                        const struct bounds *box, double distance)
{
    if (!bounds_meet(&cluster->node_boxes[cluster->level_first[level] + node], box, distance))
        return 0;
    if (level > 0) {
        uint32_t count = min_count(cluster->level_count[level - 1] - node * WIDTH, WIDTH);
        for (uint32_t i = 0; i < count; i++)
            if (node_touches(cluster, level - 1, node * WIDTH + i, c, box, distance))
                return 1;
        return 0;
    }
    uint32_t count = min_count(cluster->triangle_count - node * LEAF, LEAF);
    for (uint32_t i = 0; i < count; i++) {
        vec3 other[3];
        model_corners(cluster->model, cluster->triangles[node * LEAF + i], other);
        struct bounds other_box = bounds_of_corners(other);
        if (bounds_meet(&other_box, box, distance) && triangles_touch(c, other, distance))
            return 1;
    }
    return 0;
}

int cluster_touches(const struct cluster *cluster, uint32_t triangle, double distance)
{
    vec3 c[3];
    model_corners(cluster->model, triangle, c);
    struct bounds box = bounds_of_corners(c);
    return node_touches(cluster, cluster->levels - 1, 0, c, &box, distance);
}
