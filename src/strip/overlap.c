/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Overlap and nearest pair of a tool with each triangle of a strip. The axis is a + s u, s in 0..1, in the mesh's
 * frame.
 */
#include "base/frame.h"
#include "base/return_if_error.h"
#include "base/sized.h"
#include "nearest/nearest_pair.h"
#include "strip/strip_state.h"

/*
 * The distance, m, from the axis to a triangle, a place, that has been moved against its normal by `displacement`, m.
 * *slope gets the derivative by the displacement.
 */
static double distance_when_moved(const struct surface *surface, uint32_t place, vec3 a, vec3 u, vec3 normal,
                                  double displacement, double *slope)
{
    pair found = dpti_triangle_pair(surface, place, along(a, displacement, normal), u);
    double distance = sqrt(found.distance2);
    *slope = dot(found.gap, normal) / distance;
    return distance;
}

/*
 * The least displacement of a triangle, a place, against its normal that frees it of the tool, m; 0 if it is free. The
 * distance is a convex function of the displacement. Newton's method starts where the triangle is wholly below the
 * tool and comes down to the last touch without passing it. If there is no touch, the distance grows again on the way
 * down, or the displacement reaches 0.
 *
 *   normal  unit, on the tool's side
 *   height  of the axis' lower end above the triangle's plane, m
 */
static double exit_distance(const struct surface *surface, uint32_t place, vec3 a, vec3 u, double radius, vec3 normal,
                            double height)
{
    double displacement = radius - height;
    double tolerance = 1e-12 * (fabs(displacement) + radius + length(u));
    for (int i = 0; i < 64 && displacement > 0.0; i++) {
        double slope;
        double clearance = distance_when_moved(surface, place, a, u, normal, displacement, &slope) - radius;
        if (!(clearance > tolerance))
            return displacement;
        if (!(slope > 0.0))
            return 0.0;
        displacement -= clearance / slope;
    }
    return max_of(0.0, displacement);
}

void dpti_strip_overlap(const struct surface *surface, const struct frame *frame, vec3 a, vec3 u, double radius,
                        double side, uint32_t place, dpt_overlap *overlap)
{
    pair found = dpti_triangle_pair(surface, place, a, u);
    vec3 normal = scaled(dpti_surface_face_normal(surface, place), side);
    vec3 q = sub(along(a, found.s, u), found.gap);
    vec3 corner = surface_vertex(surface, surface_corner(surface, place, 0));
    double height = min_of(dot(sub(a, corner), normal), dot(sub(add(a, u), corner), normal));
    double distance = sqrt(found.distance2);
    double displacement = exit_distance(surface, place, a, u, radius, normal, height);
    *overlap = (dpt_overlap){
        .triangle = surface->sources[place],
        .flags = distance > 0.0 ? 0u : DPT_OVERLAP_FLAG_CROSSING,
        .distance = distance,
        .s = found.s,
        .gap = displacement > 0.0 ? -displacement : max_of(0.0, distance - radius),
        .overlap = displacement,
    };
    vec3_store(frame_to_world(frame, q), overlap->q);
    for (int k = 0; k < 3; k++)
        overlap->weight[k] = found.weight[k];
}

void dpti_strip_overlaps(const struct dpt_strip *strip, const struct surface *surface, const struct frame *frame,
                         vec3 a, vec3 u, double radius, int32_t side, dpt_overlap *overlaps, uint32_t capacity)
{
    uint32_t count = strip->count < capacity ? strip->count : capacity;
    const uint32_t size = count ? overlaps[0].size : 0;
    const uint32_t *places = count ? mesh_words(strip->mesh, MESH_PLACES) : NULL;
    for (uint32_t i = 0; i < count; i++) {
        dpt_overlap overlap;
        dpti_strip_overlap(surface, frame, a, u, radius, side, places[strip->triangles[i]], &overlap);
        sized_write((char *)overlaps + (size_t)i * size, size, &overlap, sizeof overlap);
    }
}

dpt_result dpt_strip_overlaps(const dpt_strip *strip, const dpt_mesh *mesh, const dpt_pose *pose,
                              const dpt_segment *segment, int32_t side, dpt_overlap *overlaps, uint32_t capacity,
                              uint32_t *count)
{
    if (count)
        *count = 0;
    if (!strip || !mesh || !segment || !count || (!overlaps && capacity) || (side != 1 && side != -1) ||
        (strip->count && strip->mesh != mesh))
        return DPT_E_ARGUMENT;
    if (capacity)
        DPT_TRY(sized_check(overlaps, sizeof *overlaps, 1));
    if (!vec3_within(segment->a, DPT_COORDINATE_MAX) || !vec3_within(segment->b, DPT_COORDINATE_MAX) ||
        !(segment->radius >= 0.0 && segment->radius <= DPT_COORDINATE_MAX))
        return DPT_E_FINITE;
    struct surface surface;
    struct frame frame;
    DPT_TRY(frame_of_pose(pose, &frame));
    dpti_surface_of_mesh(mesh, &surface);
    vec3 a = frame_to_local(&frame, vec3_of(segment->a));
    vec3 u = sub(frame_to_local(&frame, vec3_of(segment->b)), a);
    dpti_strip_overlaps(strip, &surface, &frame, a, u, segment->radius, side, overlaps, capacity);
    *count = strip->count;
    return DPT_OK;
}
