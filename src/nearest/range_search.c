/* SPDX-License-Identifier: BSD-3-Clause */
#include "nearest/range_search.h"

#include "nearest/filter_segment.h"

/* All of a leaf is out of reach to one side or another: so it is with most that their boxes let through. */
static int is_beside(const struct range *range, const float *rows, uint32_t lanes)
{
    float low[LANES];
    for (int i = 0; i < 4 && lanes; i++)
        lanes &= range->kernel->common_triangles(rows, range->across[i], range->beyond[i], low);
    return !lanes;
}

static void look_at(struct range *range, uint32_t level, uint32_t node)
{
    const struct surface *surface = range->surface;
    uint32_t below = level ? surface->count[level - 1] : surface_triangles(surface);
    uint32_t all = lanes_of(below - node * LANES);
    const float *rows = level ? surface->level[level] + (size_t)node * MESH_BOX_WORDS
                              : surface->leaves + (size_t)node * MESH_LEAF_WORDS;
    kernel_new_planes *look = level ? range->kernel->boxes : range->kernel->triangles;
    struct planes planes;
    work_spend(range->work, 1);
    range->level = level;
    range->node[level] = node;
    range->lanes[level] = 0;
    if (level || !is_beside(range, rows, all))
        range->lanes[level] = all & look(rows, &range->segment, &planes, range->bound);
}

void dpti_range_begin(struct range *range, const struct surface *surface,
                      const struct kernel *kernel, vec3 a, vec3 u, double reach, struct work *work)
{
    range->surface = surface;
    range->kernel = kernel;
    range->work = work;
    vec3 x = filter_segment_set_axis(&range->segment, surface, a, u);
    filter_segment_set_frame(&range->segment, x);
    filter_segment_set_limit(&range->segment, surface, reach);
    for (int i = 0; i < 4; i++) {
        const float *way = i % 2 ? range->segment.z : range->segment.y;
        for (int k = 0; k < 3; k++)
            range->across[i][k] = i < 2 ? way[k] : -way[k];
        range->beyond[i] =
            filter_segment_support(&range->segment, range->across[i]) + range->segment.limit;
    }
    look_at(range, surface->levels, 0);
}

uint32_t dpti_range_next(struct range *range, int *meets)
{
    while (range->level <= range->surface->levels) {
        uint32_t level = range->level;
        if (!range->lanes[level]) {
            range->level++;
            continue;
        }
        uint32_t lane = first_lane(range->lanes[level]);
        range->lanes[level] &= range->lanes[level] - 1;
        uint32_t child = range->node[level] * LANES + lane;
        if (level && work_is_spent(range->work))
            return DPT_NONE;
        if (level) {
            look_at(range, level - 1, child);
            continue;
        }
        *meets = !(range->bound[lane] > range->segment.margin);
        return child;
    }
    return DPT_NONE;
}
