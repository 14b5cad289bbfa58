/* SPDX-License-Identifier: BSD-3-Clause */
#include "compile/cluster.h"

#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "mesh/mesh_format.h"
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
    cluster->node_moments = compile_alloc(NULL, sets, sizeof *cluster->node_moments);
    cluster->node_boxes = compile_alloc(NULL, sets, sizeof *cluster->node_boxes);
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

/* ---- moments ---- */

#define PER_SPHERE (1.0 / (2.0 * ANGLE_TURN)) /* 1 / (4 pi) */

/* The axes of each component, and the component of a pair of axes. */
static const uint8_t quad_axes[6][2] = { { 0, 0 }, { 1, 1 }, { 2, 2 }, { 0, 1 }, { 0, 2 }, { 1, 2 } };
static const uint8_t oct_axes[10][3] = { { 0, 0, 0 }, { 1, 1, 1 }, { 2, 2, 2 }, { 0, 0, 1 }, { 0, 0, 2 },
                                         { 1, 1, 0 }, { 1, 1, 2 }, { 2, 2, 0 }, { 2, 2, 1 }, { 0, 1, 2 } };
static const uint8_t quad_at[3][3] = { { 0, 3, 4 }, { 3, 1, 5 }, { 4, 5, 2 } };

static double trace_of(const double tensor[6])
{
    return tensor[0] + tensor[1] + tensor[2];
}

/* At least the integral of |u|^3, by Cauchy and Schwarz. It scales the bound of the remainder. */
static double cubic_bound(const struct winding_moment *m)
{
    return sqrt(trace_of(m->second) * m->fourth);
}

struct winding_moment moment_of_triangle(vec3 a, vec3 b, vec3 c)
{
    struct winding_moment m = { .area = 0.0 };
    m.area_vector = scaled(cross(sub(b, a), sub(c, a)), 0.5);
    m.area = length(m.area_vector);
    m.centroid = scaled(add(add(a, b), c), 1.0 / 3.0);
    const double n[3] = { m.area_vector.x, m.area_vector.y, m.area_vector.z };
    const vec3 corners[3] = { sub(a, m.centroid), sub(b, m.centroid), sub(c, m.centroid) };
    double second[6] = { 0.0 }, largest_square = 0.0;
    for (int k = 0; k < 3; k++) {
        const double u[3] = { corners[k].x, corners[k].y, corners[k].z };
        for (int i = 0; i < 6; i++)
            second[i] += u[quad_axes[i][0]] * u[quad_axes[i][1]] / 12.0;
        double corner_square = dot(corners[k], corners[k]);
        for (int i = 0; i < 3; i++)
            m.third[i] += m.area * corner_square * u[i] / 30.0;
        largest_square = max_of(largest_square, corner_square);
    }
    for (int k = 0; k < 10; k++) {
        int x = oct_axes[k][0], y = oct_axes[k][1], z = oct_axes[k][2];
        m.oct[k] = (n[x] * second[quad_at[y][z]] + n[y] * second[quad_at[x][z]] + n[z] * second[quad_at[x][y]]) / 3.0;
    }
    for (int i = 0; i < 6; i++)
        m.second[i] = m.area * second[i];
    m.radius = sqrt(largest_square);
    m.fourth = largest_square * trace_of(m.second); /* an upper bound */
    return m;
}

/* Add a set. `shift` is its centroid less the common one; its tensors are moved to the common centroid. */
static void add_set(struct winding_moment *sum, const struct winding_moment *set, vec3 shift)
{
    const double n[3] = { set->area_vector.x, set->area_vector.y, set->area_vector.z };
    const double s[3] = { shift.x, shift.y, shift.z };
    const double shift_square = dot(shift, shift), spread = trace_of(set->second);
    for (int k = 0; k < 6; k++) {
        int x = quad_axes[k][0], y = quad_axes[k][1];
        sum->quad[k] += set->quad[k] + 0.5 * (n[x] * s[y] + n[y] * s[x]);
        sum->second[k] += set->second[k] + set->area * s[x] * s[y];
    }
    for (int k = 0; k < 10; k++) {
        int x = oct_axes[k][0], y = oct_axes[k][1], z = oct_axes[k][2];
        sum->oct[k] +=
            set->oct[k] +
            2.0 / 3.0 *
                (set->quad[quad_at[x][y]] * s[z] + set->quad[quad_at[x][z]] * s[y] + set->quad[quad_at[y][z]] * s[x]) +
            (n[x] * s[y] * s[z] + n[y] * s[x] * s[z] + n[z] * s[x] * s[y]) / 3.0;
    }
    double along_s = 0.0, third = 0.0;
    for (int i = 0; i < 3; i++) {
        double second_s = 0.0;
        for (int j = 0; j < 3; j++)
            second_s += set->second[quad_at[i][j]] * s[j];
        sum->third[i] += set->third[i] + 2.0 * second_s + (spread + set->area * shift_square) * s[i];
        along_s += second_s * s[i];
        third += set->third[i] * s[i];
    }
    sum->fourth += set->fourth + 4.0 * third + 4.0 * along_s + 2.0 * shift_square * spread +
                   set->area * shift_square * shift_square;
    sum->radius = max_of(sum->radius, sqrt(shift_square) + set->radius);
}

struct winding_moment moment_of_sets(const struct winding_moment *sets, uint32_t count)
{
    struct winding_moment sum = { .area = 0.0 };
    for (uint32_t i = 0; i < count; i++) {
        sum.area_vector = add(sum.area_vector, sets[i].area_vector);
        sum.area += sets[i].area;
        sum.centroid = along(sum.centroid, sets[i].area, sets[i].centroid);
    }
    if (!(sum.area > 0.0))
        return (struct winding_moment){ .area = 0.0 };
    sum.centroid = scaled(sum.centroid, 1.0 / sum.area);
    for (uint32_t i = 0; i < count; i++)
        if (sets[i].area > 0.0)
            add_set(&sum, &sets[i], sub(sets[i].centroid, sum.centroid));
    return sum;
}

/*
 * The bound of the remainder. The term of degree l is the gradient of a solid harmonic. For a unit of area at distance
 * r from the centroid it is at most l r^(l-1) / d^(l+1) (Bernstein's inequality). From l = 4 on the terms add up to r^3
 * (4 - 3 t) / (d^5 (1 - t)^2) with t = r / d, and r^3 is at most radius r^2.
 */
double moment_winding(const struct winding_moment *m, vec3 x, double *error)
{
    vec3 d = sub(m->centroid, x);
    double distance = length(d), gap = distance - m->radius;
    *error = m->area > 0.0 ? HUGE_VAL : 0.0;
    if (!(gap > 0.0) || !(m->area > 0.0))
        return 0.0;
    double inverse = 1.0 / distance;
    *error = PER_SPHERE * cubic_bound(m) * (distance + 3.0 * gap) * inverse * inverse * inverse * inverse / (gap * gap);
    const double e[3] = { d.x * inverse, d.y * inverse, d.z * inverse };
    const double *q = m->quad, *o = m->oct;
    double area = dot(m->area_vector, d) * inverse;
    double quad = -3.0 * (q[0] * e[0] * e[0] + q[1] * e[1] * e[1] + q[2] * e[2] * e[2] +
                          2.0 * (q[3] * e[0] * e[1] + q[4] * e[0] * e[2] + q[5] * e[1] * e[2])) +
                  q[0] + q[1] + q[2];
    double cubic = 6.0 * o[9] * e[0] * e[1] * e[2];
    for (int k = 0; k < 9; k++) {
        const uint8_t *axis = oct_axes[k];
        cubic += (k < 3 ? 1.0 : 3.0) * o[k] * e[axis[0]] * e[axis[1]] * e[axis[2]];
    }
    double trace = (o[0] + o[5] + o[7]) * e[0] + (o[1] + o[3] + o[8]) * e[1] + (o[2] + o[4] + o[6]) * e[2];
    double oct = 7.5 * cubic - 4.5 * trace;
    return PER_SPHERE * inverse * inverse * (area + inverse * (quad + inverse * oct));
}

/* The trace of a tensor adds nothing to a harmonic field. Without it, one component less is stored for each axis. */
void moment_store(const struct winding_moment *m, float *block)
{
    const double *q = m->quad, *o = m->oct;
    const double third = (q[0] + q[1] + q[2]) / 3.0;
    const double tx = (o[0] + o[5] + o[7]) / 5.0, ty = (o[1] + o[3] + o[8]) / 5.0, tz = (o[2] + o[4] + o[6]) / 5.0;
    const double rows[MESH_MOMENT_ROWS] = {
        PER_SPHERE * m->area_vector.x,
        PER_SPHERE * m->area_vector.y,
        PER_SPHERE * m->area_vector.z,
        m->centroid.x,
        m->centroid.y,
        m->centroid.z,
        PER_SPHERE * -3.0 * (q[0] - third),
        PER_SPHERE * -3.0 * (q[1] - third),
        PER_SPHERE * -6.0 * q[3],
        PER_SPHERE * -6.0 * q[4],
        PER_SPHERE * -6.0 * q[5],
        PER_SPHERE * 7.5 * (o[0] - 3.0 * tx),
        PER_SPHERE * 7.5 * (o[1] - 3.0 * ty),
        PER_SPHERE * 22.5 * (o[3] - ty),
        PER_SPHERE * 22.5 * (o[5] - tx),
        PER_SPHERE * 7.5 * (o[4] - tz),
        PER_SPHERE * 7.5 * (o[6] - tz),
        PER_SPHERE * 45.0 * o[9],
        PER_SPHERE * cubic_bound(m),
        m->area > 0.0 ? m->radius : -1.0,
    };
    for (int k = 0; k < MESH_MOMENT_ROWS; k++)
        block[k * LANES] = (float)rows[k];
}
