/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/surface.h"

/* Units of work: a leaf is gathered from vertices that lie apart. */
enum { LEAF_UNITS = 4, NODE_UNITS = 1, REMADE_UNITS = 12 };

/* Rounding up by factors: of one operation, and of a few. */
#define ROUND_UP     (1.0f + 0x1p-23f)
#define ROUND_UP_FEW (1.0f + 0x1p-21f)

static uint32_t rounded_up(uint32_t count)
{
    return (count + LANES - 1) / LANES * LANES;
}

/* Set the numbers of nodes; returns the length of an array by node. */
static uint32_t set_levels(const struct dpt_mesh *mesh, struct surface_motion *motion)
{
    uint64_t nodes;
    uint32_t first = 0;
    motion->levels = mesh_levels(mesh->leaves, motion->count, &nodes);
    for (uint32_t level = 0; level <= motion->levels; level++) {
        motion->first[level] = first;
        first += rounded_up(motion->count[level]);
    }
    motion->first[motion->levels + 1] = first;
    return first;
}

/* List the groups of each leaf, or with leaf_groups = NULL only count. Returns how many are in more_groups. */
static uint64_t list_groups(const struct dpt_mesh *mesh, uint32_t *leaf_groups, uint32_t *more_groups)
{
    const uint32_t *corners = mesh_words(mesh, MESH_TRIANGLES);
    uint64_t more = 0;
    for (uint32_t leaf = 0; leaf < mesh->leaves; leaf++) {
        uint32_t seen[3 * LANES] = { 0 }, count = 0;
        const uint32_t begin = leaf * LANES, end = begin + LANES;
        for (uint32_t t = begin; t < end && t < mesh->triangles; t++)
            for (uint32_t k = 0; k < 3; k++) {
                const uint32_t group = corners[3 * (size_t)t + k] / MOTION_GROUP;
                uint32_t i = 0;
                while (i < count && seen[i] != group)
                    i++;
                if (i == count)
                    seen[count++] = group;
            }
        for (uint32_t i = 0; i < MOTION_LEAF_GROUPS && leaf_groups; i++)
            leaf_groups[MOTION_LEAF_GROUPS * (size_t)leaf + i] = seen[i < count ? i : 0];
        for (uint32_t i = MOTION_LEAF_GROUPS; i < count; i++, more++)
            if (more_groups) {
                more_groups[2 * more] = leaf;
                more_groups[2 * more + 1] = seen[i];
            }
    }
    return more;
}

/* List the vertices of each leaf, or with first = NULL only count them. Returns how many there are in all. */
static uint64_t list_vertices(const struct dpt_mesh *mesh, uint32_t *first, uint32_t *list)
{
    const uint32_t *corners = mesh_words(mesh, MESH_TRIANGLES);
    uint64_t sum = 0;
    for (uint32_t leaf = 0; leaf < mesh->leaves; leaf++) {
        uint32_t seen[3 * LANES], count = 0;
        const uint64_t begin = 3 * (uint64_t)LANES * leaf, end = begin + 3 * LANES;
        for (uint64_t c = begin; c < end && c < 3 * (uint64_t)mesh->triangles; c++) {
            uint32_t i = 0;
            while (i < count && seen[i] != corners[c])
                i++;
            if (i == count)
                seen[count++] = corners[c];
        }
        if (first) {
            first[leaf] = (uint32_t)sum;
            memcpy(list + sum, seen, count * sizeof *list);
        }
        sum += count;
    }
    if (first)
        first[mesh->leaves] = (uint32_t)sum;
    return sum;
}

static uint32_t group_count(const struct dpt_mesh *mesh)
{
    return (mesh->vertices + MOTION_GROUP - 1) / MOTION_GROUP;
}

/* Take `count` items of 4 bytes from *end on, aligned. Without a base only *end moves. */
static void *take(char *base, uint64_t *end, uint64_t count)
{
    void *taken = base ? base + *end : NULL;
    *end += mesh_aligned(4 * count);
    return taken;
}

/* Place the arrays in the memory at `base`; returns their bytes. With base = NULL it only counts. */
static uint64_t place(const struct dpt_mesh *mesh, char *base, struct surface_motion *motion)
{
    const uint32_t nodes = set_levels(mesh, motion);
    const uint64_t floats = (uint64_t)MOTION_GROUP_FLOATS * group_count(mesh);
    uint64_t end = 0;
    motion->mesh = mesh;
    motion->groups = group_count(mesh);
    motion->positions = take(base, &end, floats);
    motion->previous = take(base, &end, floats);
    motion->group_tick = take(base, &end, motion->groups);
    motion->group_moved = take(base, &end, motion->groups);
    motion->leaves = take(base, &end, (uint64_t)MESH_LEAF_WORDS * mesh->leaves);
    motion->level[0] = NULL;
    for (uint32_t level = 1; level <= motion->levels; level++)
        motion->level[level] = take(base, &end, (uint64_t)MESH_BOX_WORDS * motion->count[level]);
    motion->travel = take(base, &end, nodes);
    motion->followed = take(base, &end, nodes);
    motion->boxed = take(base, &end, nodes);
    motion->has_tighter = take(base, &end, nodes);
    motion->remade = take(base, &end, motion->count[1]);
    motion->leaf_width = take(base, &end, motion->count[1]);
    motion->moved = take(base, &end, nodes);
    motion->step = take(base, &end, nodes);
    motion->leaf_groups = take(base, &end, (uint64_t)MOTION_LEAF_GROUPS * mesh->leaves);
    motion->more_count = list_groups(mesh, NULL, NULL);
    motion->more_groups = take(base, &end, 2 * motion->more_count);
    motion->vertex_first = take(base, &end, (uint64_t)mesh->leaves + 1);
    motion->leaf_vertices = take(base, &end, list_vertices(mesh, NULL, NULL));
    return end;
}

uint64_t dpti_surface_motion_bytes(const struct dpt_mesh *mesh)
{
    struct surface_motion motion;
    return place(mesh, NULL, &motion);
}

/* A box in the filter's frame. */
struct filter_box {
    float low[3], high[3];
};

static void put_box(float *block, uint32_t lane, const struct filter_box *box)
{
    for (int k = 0; k < 3; k++) {
        const float centre = 0.5f * (box->low[k] + box->high[k]);
        const float up = box->high[k] - centre, down = centre - box->low[k];
        block[k * LANES + (int)lane] = centre;
        block[(3 + k) * LANES + (int)lane] = ROUND_UP_FEW * (up > down ? up : down);
    }
}

/* The place of a node's box in its parent; NULL for the root. `level` is the node's, 0 for a leaf. */
static float *parent_block(const struct surface_motion *motion, uint32_t level, uint32_t node)
{
    return level < motion->levels ? motion->level[level + 1] + (size_t)(node / LANES) * MESH_BOX_WORDS : NULL;
}

/*
 * The rows low x, y, z and minus high x, y, z of 16 boxes. All are reduced to their least at once: so compilers make
 * vectors of them.
 */
struct box_rows {
    float row[6][LANES];
};

static struct filter_box box_of_rows(struct box_rows *rows)
{
    for (int width = LANES / 2; width; width /= 2)
        for (int k = 0; k < 6; k++)
            for (int i = 0; i < width; i++)
                rows->row[k][i] = rows->row[k][i] < rows->row[k][i + width] ? rows->row[k][i] : rows->row[k][i + width];
    return (struct filter_box){ { rows->row[0][0], rows->row[1][0], rows->row[2][0] },
                                { -rows->row[3][0], -rows->row[4][0], -rows->row[5][0] } };
}

/* The lanes beyond a mesh's last triangle repeat it. */
static void fill_leaf(const struct surface_motion *motion, uint32_t leaf, float *rows)
{
    const struct dpt_mesh *mesh = motion->mesh;
    const uint32_t begin = leaf * LANES, left = mesh->triangles - begin;
    const uint32_t *corners = mesh_words(mesh, MESH_TRIANGLES) + 3 * (size_t)begin;
    const float x = motion->centre[0], y = motion->centre[1], z = motion->centre[2];
    const float scale = motion->scale;
    for (uint32_t i = 0; i < LANES; i++) {
        const uint32_t *corner = corners + 3 * (size_t)(i < left ? i : left - 1);
        for (uint32_t k = 0; k < 3; k++) {
            const float *at = motion->positions + 3 * (size_t)corner[k];
            rows[(3 * k) * LANES + i] = (at[0] - x) * scale;
            rows[(3 * k + 1) * LANES + i] = (at[1] - y) * scale;
            rows[(3 * k + 2) * LANES + i] = (at[2] - z) * scale;
        }
    }
}

static struct filter_box box_of_leaf(const float *block)
{
    struct box_rows rows;
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < LANES; i++) {
            const float a = block[axis * LANES + i], b = block[(3 + axis) * LANES + i];
            const float c = block[(6 + axis) * LANES + i];
            const float ab_low = a < b ? a : b, ab_high = a > b ? a : b;
            rows.row[axis][i] = ab_low < c ? ab_low : c;
            rows.row[3 + axis][i] = -(ab_high > c ? ab_high : c);
        }
    return box_of_rows(&rows);
}

uint32_t dpti_surface_follow_leaf(struct surface_motion *motion, uint32_t leaf)
{
    float *rows = motion->leaves + (size_t)leaf * MESH_LEAF_WORDS;
    fill_leaf(motion, leaf, rows);
    const struct filter_box box = box_of_leaf(rows);
    put_box(parent_block(motion, 0, leaf), leaf % LANES, &box);
    motion->has_tighter[motion->first[1] + leaf / LANES] = 1;
    motion->followed[leaf] = motion->boxed[leaf] = motion->travel[leaf];
    return LEAF_UNITS;
}

/* Widen the boxes of 16 children by their travel since they were made. Lanes without a child repeat the last one. */
static void widen_boxes(float *block, const float *travel, float *boxed, uint32_t children)
{
    for (int i = 0; i < LANES; i++) {
        const float wider = ROUND_UP_FEW * (travel[i] - boxed[i]);
        block[3 * LANES + i] = ROUND_UP * (block[3 * LANES + i] + wider);
        block[4 * LANES + i] = ROUND_UP * (block[4 * LANES + i] + wider);
        block[5 * LANES + i] = ROUND_UP * (block[5 * LANES + i] + wider);
        boxed[i] = travel[i];
    }
    for (uint32_t row = 0; row < 6 && children < LANES; row++)
        for (uint32_t i = children; i < LANES; i++)
            block[row * LANES + i] = block[row * LANES + children - 1];
}

static struct filter_box box_of_boxes(const float *block)
{
    struct box_rows rows;
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < LANES; i++) {
            const float centre = block[axis * LANES + i], half = block[(3 + axis) * LANES + i];
            rows.row[axis][i] = centre - half;
            rows.row[3 + axis][i] = -(centre + half);
        }
    return box_of_rows(&rows);
}

/* Hand a node's box to its parent if it is tighter than the one there. */
static void tighten_parent(struct surface_motion *motion, uint32_t level, uint32_t node, const struct filter_box *box)
{
    float *block = parent_block(motion, level, node);
    const uint32_t number = motion->first[level] + node, lane = node % LANES;
    if (!block) {
        motion->boxed[number] = motion->travel[number];
        return;
    }
    float size = 0.0f, old = 3.0f * (motion->travel[number] - motion->boxed[number]);
    for (uint32_t k = 0; k < 3; k++) {
        size += 0.5f * (box->high[k] - box->low[k]);
        old += block[(3 + k) * LANES + lane];
    }
    if (!(size < old))
        return;
    put_box(block, lane, box);
    motion->has_tighter[motion->first[level + 1] + node / LANES] = 1;
    motion->boxed[number] = motion->travel[number];
}

/* A leaf's box from its vertices. It is the one that filling the leaf gives, as rounding keeps an order. */
static struct filter_box box_of_vertices(const struct surface_motion *motion, uint32_t leaf)
{
    const uint32_t *vertex = motion->leaf_vertices + motion->vertex_first[leaf];
    const uint32_t *end = motion->leaf_vertices + motion->vertex_first[leaf + 1];
    const float *at = motion->positions + 3 * (size_t)*vertex;
    float low[3] = { at[0], at[1], at[2] }, high[3] = { at[0], at[1], at[2] };
    while (++vertex < end) {
        at = motion->positions + 3 * (size_t)*vertex;
        for (int k = 0; k < 3; k++) {
            low[k] = at[k] < low[k] ? at[k] : low[k];
            high[k] = at[k] > high[k] ? at[k] : high[k];
        }
    }
    struct filter_box box;
    for (int k = 0; k < 3; k++) {
        box.low[k] = (low[k] - motion->centre[k]) * motion->scale;
        box.high[k] = (high[k] - motion->centre[k]) * motion->scale;
    }
    return box;
}

/* Make the boxes of all leaves of a node anew. */
static void remake_boxes(struct surface_motion *motion, uint32_t node, float *block)
{
    const uint32_t begin = node * LANES, left = motion->count[0] - begin;
    const uint32_t leaves = left < LANES ? left : LANES;
    float width = 0.0f;
    for (uint32_t i = 0; i < leaves; i++) {
        const struct filter_box box = box_of_vertices(motion, begin + i);
        put_box(block, i, &box);
        motion->boxed[begin + i] = motion->travel[begin + i];
        for (int k = 0; k < 3; k++)
            width += box.high[k] - box.low[k];
    }
    const uint32_t number = motion->first[1] + node;
    motion->has_tighter[number] = 1;
    motion->remade[node] = motion->travel[number];
    motion->leaf_width[node] = width / (float)(3 * leaves);
}

uint32_t dpti_surface_follow_node(struct surface_motion *motion, uint32_t level, uint32_t node)
{
    const int remakes =
        level == 1 && motion->travel[motion->first[1] + node] - motion->remade[node] > motion->leaf_width[node];
    float *block = motion->level[level] + (size_t)node * MESH_BOX_WORDS;
    const uint32_t child = motion->first[level - 1] + node * LANES;
    const uint32_t children = motion->count[level - 1] - node * LANES;
    if (remakes)
        remake_boxes(motion, node, block);
    widen_boxes(block, motion->travel + child, motion->boxed + child, children);
    const uint32_t number = motion->first[level] + node;
    if (motion->has_tighter[number]) {
        const struct filter_box box = box_of_boxes(block);
        tighten_parent(motion, level, node, &box);
        motion->has_tighter[number] = 0;
    }
    motion->followed[number] = motion->travel[number];
    return remakes ? REMADE_UNITS : NODE_UNITS;
}

/* The filter's frame: a centre in float, and the power of two that scales the largest half width into 0.5..1. */
static void set_frame(struct surface *surface, struct surface_motion *motion)
{
    const vec3 middle = scaled(add(surface->box_min, surface->box_max), 0.5);
    motion->centre[0] = (float)middle.x;
    motion->centre[1] = (float)middle.y;
    motion->centre[2] = (float)middle.z;
    surface->filter_centre = vec3_of_float(motion->centre);
    const double half = max_of(extent_of(sub(surface->box_max, surface->filter_centre)),
                               extent_of(sub(surface->filter_centre, surface->box_min)));
    surface->filter_scale = 1.0;
    while (surface->filter_scale * half > 1.0)
        surface->filter_scale *= 0.5;
    while (surface->filter_scale * half <= 0.5)
        surface->filter_scale *= 2.0;
    motion->scale = (float)surface->filter_scale;
}

/* Of the mesh's diagonal: how much wider than what it is to hold a box is on every side. */
#define ROOM_SHARE 0.5

/* The box of what it is to hold, with room about it where the limit leaves any; its ends are rounded to float. */
static void set_box(struct surface *surface, const double low[3], const double high[3])
{
    const struct surface_motion *motion = surface->motion;
    const double wider = surface->diagonal > 0.0 ? ROOM_SHARE * surface->diagonal : 1.0;
    double box_min[3], box_max[3];
    for (int k = 0; k < 3; k++) {
        box_min[k] = (double)(float)max_of(low[k] - wider, motion->limit_min[k]);
        box_max[k] = (double)(float)min_of(high[k] + wider, motion->limit_max[k]);
    }
    surface->box_min = vec3_of(box_min);
    surface->box_max = vec3_of(box_max);
}

/* Hand all boxes of leaves on to their parents, and so on up. */
static void fill_nodes(struct surface_motion *motion)
{
    for (uint32_t level = 1; level <= motion->levels; level++)
        for (uint32_t node = 0; node < motion->count[level]; node++) {
            float *block = parent_block(motion, level, node);
            for (uint32_t k = 3; block && k < 6; k++)
                block[k * LANES + node % LANES] = HUGE_VALF;
            dpti_surface_follow_node(motion, level, node);
        }
}

void dpti_surface_of_motion(const struct dpt_mesh *mesh, const double limit_min[3], const double limit_max[3], char *at,
                            struct surface_motion *motion, struct surface *surface)
{
    memset(at, 0, (size_t)place(mesh, at, motion));
    list_groups(mesh, motion->leaf_groups, motion->more_groups);
    list_vertices(mesh, motion->vertex_first, motion->leaf_vertices);
    dpti_surface_of_mesh(mesh, surface);
    memcpy(motion->limit_min, limit_min, sizeof motion->limit_min);
    memcpy(motion->limit_max, limit_max, sizeof motion->limit_max);
    surface->motion = motion;
    set_box(surface, mesh->box_min, mesh->box_max);
    set_frame(surface, motion);
    memcpy(motion->positions, mesh_floats(mesh, MESH_VERTICES), 3 * (size_t)mesh->vertices * sizeof(float));
    motion->tick = 0;
    for (uint32_t leaf = 0; leaf < motion->count[0]; leaf++)
        dpti_surface_follow_leaf(motion, leaf);
    fill_nodes(motion);
    surface->positions = motion->positions;
    surface->normals = NULL;
    surface->leaves = motion->leaves;
    for (uint32_t level = 1; level <= motion->levels; level++)
        surface->level[level] = motion->level[level];
}

void dpti_surface_move_box(struct surface *surface, const double low[3], const double high[3])
{
    struct surface_motion *motion = surface->motion;
    const uint32_t nodes = motion->first[motion->levels + 1];
    const double before = surface->filter_scale;
    set_box(surface, low, high);
    set_frame(surface, motion);
    const float scale = (float)(surface->filter_scale / before);
    motion->begun++;
    for (uint32_t i = 0; i < nodes; i++) {
        motion->travel[i] = motion->boxed[i] = 0.0f;
        motion->followed[i] = -1.0f; /* blocks of leaves are filled again when a search looks at them */
        motion->step[i] *= scale;
    }
    for (uint32_t node = 0; node < motion->count[1]; node++)
        remake_boxes(motion, node, motion->level[1] + (size_t)node * MESH_BOX_WORDS);
    fill_nodes(motion);
}

void dpti_surface_motion_forget(struct surface_motion *motion)
{
    motion->tick = 0;
    memset(motion->group_tick, 0, motion->groups * sizeof *motion->group_tick);
}
