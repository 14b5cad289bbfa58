/* SPDX-License-Identifier: BSD-3-Clause */
#include "tissue/touch_vertices.h"

#include <string.h>

/* Touches that a patch has at most, and with how many of finer ones these are taken. */
enum { TOUCHES_MOST = 128, TOUCHES_FEW = 96 };

/* With so few vertices twice as many count in the next step; and how often they are halved at most. */
enum { PATCH_FEW = TOUCH_PATCH_MAX / 4, THIN_MAX = 16 };

/* The finest cubes by the tool's radius, and by how much the next ones are wider. */
#define CUBE_MIN (1.0 / 64.0)
#define WIDER    1.189207115002721

/*
 * Over a touch as wide as a cube w the surface falls back from a round tool by about w^2 / R. A vertex that is farther than
 * the nearest one of the patch by FADES times that counts for next to nothing, and gradually so: if one that comes into reach
 * changed its touch, a tool that stands still would hum. FAR is the share of those, for touches that have no other.
 */
#define FADES     2.0
#define FADES_MAX (1.0 / 16.0) /* of the radius: else more vertices make wider cubes, and these more vertices */
#define FAR       1e-6

/* The factor, of the golden ratio, scatters neighbours. */
static uint32_t scattered(uint32_t number)
{
    return number * 2654435769u;
}

static uint32_t first_slot(uint32_t scattered_number)
{
    return scattered_number >> (32 - TOUCH_TABLE_BITS);
}

static uint32_t next_slot(uint32_t slot)
{
    return (slot + 1) % (1 << TOUCH_TABLE_BITS);
}

/* Where a vertex is in the table, or would be. */
static uint32_t slot_of(const struct touch_vertices *all, uint32_t vertex)
{
    uint32_t slot = first_slot(scattered(vertex));
    while (all->table[slot] && all->vertex[all->table[slot] - 1].vertex != vertex)
        slot = next_slot(slot);
    return slot;
}

/* Where the touch of a vertex is in the table, or would be. */
static uint32_t slot_of_touch(const struct touch_vertices *all, uint64_t cube)
{
    uint32_t slot = first_slot(scattered((uint32_t)cube ^ scattered((uint32_t)(cube >> 32))));
    while (all->table[slot] && all->vertex[all->table[slot] - 1].cube != cube)
        slot = next_slot(slot);
    return slot;
}

static void clear_table(struct touch_vertices *all)
{
    memset(all->table, 0, sizeof all->table);
}

struct touch_patch *dpti_touch_patch_of(struct touch_vertices *all, uint32_t tool_slot, uint32_t part, uint32_t body_id)
{
    for (uint32_t i = 0; i < all->patch_count; i++) {
        struct touch_patch *patch = &all->patches[i];
        if (patch->tool_slot == tool_slot && patch->part == part && patch->body_id == body_id)
            return patch;
    }
    const uint32_t free = all->patch_count < TOUCH_PATCHES_MAX ? all->patch_count++ : 0;
    all->patches[free] = (struct touch_patch){ .tool_slot = tool_slot, .part = part, .body_id = body_id };
    return &all->patches[free];
}

void dpti_touch_patch_begin(struct touch_vertices *all, struct touch_patch *patch)
{
    patch->first = all->count;
}

int dpti_touch_vertex_is_new(const struct touch_vertices *all, const struct touch_patch *patch, uint32_t vertex)
{
    if (scattered(vertex) >> 8 & ((1u << patch->thin) - 1))
        return 0;
    return all->count == patch->first || !all->table[slot_of(all, vertex)];
}

int dpti_touch_vertex_add(struct touch_vertices *all, const struct touch_patch *patch,
                          const struct touch_vertex *vertex)
{
    if (all->count == TOUCH_VERTICES_MAX || all->count - patch->first == TOUCH_PATCH_MAX)
        return 0;
    if (all->count == patch->first)
        clear_table(all);
    const uint32_t slot = slot_of(all, vertex->vertex);
    all->vertex[all->count++] = *vertex;
    all->table[slot] = (uint16_t)all->count;
    return 1;
}

int dpti_touch_patch_thin(struct touch_vertices *all, struct touch_patch *patch)
{
    all->count = patch->first;
    return patch->thin++ < THIN_MAX;
}

/* m: 0 for touches of one vertex. */
static double width_of(double radius, uint32_t coarse)
{
    double width = coarse ? CUBE_MIN * radius : 0.0;
    for (uint32_t k = 1; k < coarse; k++)
        width *= WIDER;
    return width;
}

/* Cubes are numbered from far below 0, so that a cast rounds down; of each number as many bits count. */
#define CUBE_ZERO 1073741824.0
enum { CUBE_BITS = 21 };

static void set_cubes(struct touch_vertices *all, const struct touch_patch *patch, const struct touch_shape *shape,
                      double width)
{
    for (uint32_t i = patch->first; i < all->count; i++) {
        struct touch_vertex *vertex = &all->vertex[i];
        const float *rest = shape->rest + 3 * (size_t)vertex->vertex;
        vertex->cube = width > 0.0 ? 0 : vertex->vertex;
        for (uint32_t k = 0; k < 3 && width > 0.0; k++) {
            const uint32_t number = (uint32_t)(CUBE_ZERO + (double)rest[k] / width) % (1u << CUBE_BITS);
            vertex->cube |= (uint64_t)number << CUBE_BITS * k;
        }
    }
}

/* Lists of those that lie in one cube. Returns how many there are. */
static uint32_t make_lists(struct touch_vertices *all, const struct touch_patch *patch)
{
    uint32_t lists = 0;
    clear_table(all);
    for (uint32_t i = patch->first; i < all->count; i++) {
        const uint32_t slot = slot_of_touch(all, all->vertex[i].cube), last = all->table[slot];
        if (last)
            all->vertex[last - 1].is_first = 0;
        lists += !last;
        all->vertex[i].next = last;
        all->vertex[i].is_first = 1;
        all->table[slot] = (uint16_t)(i + 1);
    }
    return lists;
}

static uint32_t touches_of(struct touch_vertices *all, const struct touch_patch *patch, const struct touch_shape *shape,
                           uint32_t coarse)
{
    set_cubes(all, patch, shape, width_of(shape->radius, coarse));
    return make_lists(all, patch);
}

static double share_of(double farther, double fades)
{
    const double near = max_of(1.0 - farther / fades, 0.0), far = fades / (fades + farther);
    return near * near + FAR * far * far;
}

static void set_shares(struct touch_vertices *all, uint32_t first, double least, double fades)
{
    double sum = 0.0;
    for (uint32_t i = first + 1; i; i = all->vertex[i - 1].next) {
        all->vertex[i - 1].share = fades > 0.0 ? share_of(all->vertex[i - 1].gap - least, fades) : 1.0;
        sum += all->vertex[i - 1].share;
    }
    for (uint32_t i = first + 1; i; i = all->vertex[i - 1].next)
        all->vertex[i - 1].share /= sum;
}

void dpti_touch_patch_group(struct touch_vertices *all, struct touch_patch *patch, const struct touch_shape *shape)
{
    const uint32_t count = all->count - patch->first;
    double least = HUGE_VAL;
    if (!count) {
        patch->coarse = patch->thin = 0;
        patch->near = 0.0;
        return;
    }
    patch->thin -= patch->thin && count <= PATCH_FEW;
    while (patch->coarse && touches_of(all, patch, shape, patch->coarse - 1) <= TOUCHES_FEW)
        patch->coarse--;
    while (touches_of(all, patch, shape, patch->coarse) > TOUCHES_MOST)
        patch->coarse++;
    const double width = width_of(shape->radius, patch->coarse);
    const double near = min_of(FADES * width * width / shape->radius, FADES_MAX * shape->radius);
    for (uint32_t i = patch->first; i < all->count; i++)
        least = min_of(least, all->vertex[i].gap);
    for (uint32_t i = patch->first; i < all->count; i++)
        if (all->vertex[i].is_first)
            set_shares(all, i, least, min_of(near, max_of(shape->reach, patch->near)));
    patch->near = near;
}
