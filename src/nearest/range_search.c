/* SPDX-License-Identifier: BSD-3-Clause */
#include "nearest/range_search.h"

#include "nearest/filter_segment.h"

/*
 * 1 if each triangle of a leaf is out of reach along at least one of the four directions. That holds for most leaves
 * whose boxes are within reach.
 */
static int is_out_of_reach(const struct range *range, const float *rows, uint32_t lanes)
{
    float support[LANES];
    for (int i = 0; i < 4 && lanes; i++)
        lanes &= range->kernel->common_triangles(rows, range->directions[i], range->limits[i], support);
    return !lanes;
}

static void visit(struct range *range, uint32_t level, uint32_t node)
{
    const struct surface *surface = range->surface;
    uint32_t children = level ? surface->count[level - 1] : surface_triangles(surface);
    uint32_t lanes = lanes_of(children - node * LANES);
    const float *rows =
        level ? surface_node(surface, level, node, range->work) : surface_leaf(surface, node, range->work);
    kernel_new_planes *loop = level ? range->kernel->boxes : range->kernel->triangles;
    struct planes planes;
    work_spend(range->work, 1);
    range->level = level;
    range->node[level] = node;
    range->lanes[level] = 0;
    if (level || !is_out_of_reach(range, rows, lanes))
        range->lanes[level] = lanes & loop(rows, &range->segment, &planes, range->bound);
}

void dpti_range_begin(struct range *range, const struct surface *surface, const struct kernel *kernel, vec3 a, vec3 u,
                      double reach, struct work *work)
{
    range->surface = surface;
    range->kernel = kernel;
    range->work = work;
    vec3 x = filter_segment_set_axis(&range->segment, surface, a, u);
    filter_segment_set_frame(&range->segment, x);
    filter_segment_set_limit(&range->segment, surface, reach);
    for (int i = 0; i < 4; i++) {
        const float *direction = i % 2 ? range->segment.z : range->segment.y;
        for (int k = 0; k < 3; k++)
            range->directions[i][k] = i < 2 ? direction[k] : -direction[k];
        range->limits[i] = filter_segment_support(&range->segment, range->directions[i]) + range->segment.limit;
    }
    visit(range, surface->levels, 0);
}

uint32_t dpti_range_next(struct range *range, int *may_touch)
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
            visit(range, level - 1, child);
            continue;
        }
        *may_touch = !(range->bound[lane] > range->segment.margin);
        return child;
    }
    return DPT_NONE;
}
