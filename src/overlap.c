/* SPDX-License-Identifier: BSD-3-Clause */
/* How a tool stands to each triangle of a strip. */
#include "check.h"
#include "pose.h"
#include "side.h"
#include "strip.h"

/* The paper's signed distance, of an axis that crosses by its deeper end. */
static double signed_distance(const pair *found, vec3 a, vec3 u, vec3 normal)
{
    if (found->distance2 > 0.0)
        return dot(found->gap, normal) < 0.0 ? -sqrt(found->distance2) : sqrt(found->distance2);
    vec3 q = sub(along(a, found->s, u), found->gap);
    return smaller(dot(sub(a, q), normal), dot(sub(add(a, u), q), normal));
}

static void overlap_of(const struct tree *tree, const struct frame *frame, vec3 a, vec3 u,
                       double radius, double side, uint32_t place, dpt_overlap *overlap)
{
    pair found = tree_pair(tree, place, a, u);
    vec3 normal = scaled(side_face_normal(tree, place), side);
    vec3 q = sub(along(a, found.s, u), found.gap);
    *overlap = (dpt_overlap){
        .size = overlap->size,
        .triangle = tree->sources[place],
        .flags = found.distance2 > 0.0 ? 0u : DPT_OVERLAP_CROSSING,
        .distance = sqrt(found.distance2),
        .s = found.s,
        .gap = signed_distance(&found, a, u, normal) - radius,
    };
    overlap->overlap = larger(0.0, -overlap->gap);
    vec3_store(frame_to_world(frame, q), overlap->q);
    for (int k = 0; k < 3; k++)
        overlap->weight[k] = found.weight[k];
}

void strip_overlaps(const struct dpt_strip *strip, const struct tree *tree,
                    const struct frame *frame, vec3 a, vec3 u, double radius, int32_t side,
                    dpt_overlap *overlaps, uint32_t capacity)
{
    uint32_t count = strip->count < capacity ? strip->count : capacity;
    const uint32_t size = count ? overlaps[0].size : 0;
    const uint32_t *places = count ? mesh_words(strip->mesh, MESH_PLACES) : NULL;
    for (uint32_t i = 0; i < count; i++) {
        dpt_overlap *overlap = (void *)((char *)overlaps + (size_t)i * size);
        overlap->size = size;
        overlap_of(tree, frame, a, u, radius, side, places[strip->triangles[i]], overlap);
    }
}

dpt_result dpt_strip_overlaps(const dpt_strip *strip, const dpt_mesh *mesh, const dpt_pose *pose,
                              const dpt_segment *segment, int32_t side, dpt_overlap *overlaps,
                              uint32_t capacity, uint32_t *count)
{
    if (count)
        *count = 0;
    if (!strip || !mesh || !segment || !count || (!overlaps && capacity) ||
        (side != 1 && side != -1) || (strip->count && strip->mesh != mesh))
        return DPT_E_ARGUMENT;
    if (capacity && (overlaps[0].size < sizeof *overlaps || overlaps[0].size % 8))
        return DPT_E_SIZE;
    if (!vec3_within(segment->a, DPT_COORDINATE_MAX) ||
        !vec3_within(segment->b, DPT_COORDINATE_MAX) ||
        !(segment->radius >= 0.0 && segment->radius <= DPT_COORDINATE_MAX))
        return DPT_E_FINITE;
    struct tree tree;
    struct frame frame;
    DPT_TRY(frame_of_pose(pose, &frame));
    tree_of_mesh(mesh, &tree);
    vec3 a = frame_to_local(&frame, vec3_of(segment->a));
    vec3 u = sub(frame_to_local(&frame, vec3_of(segment->b)), a);
    strip_overlaps(strip, &tree, &frame, a, u, segment->radius, side, overlaps, capacity);
    *count = strip->count;
    return DPT_OK;
}
