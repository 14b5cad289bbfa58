/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/gap.h"

#include "mesh/surface.h"

void dpti_segment_result_of_pair(const struct axis *axis, const pair *found, struct segment_result *result)
{
    const double distance = sqrt(found->distance2);
    *result = (struct segment_result){
        .p = along(axis->a, found->s, sub(axis->b, axis->a)),
        .s = found->s,
        .distance = distance,
        .lower_bound = max_of(0.0, distance - axis->error),
        .error_bound = axis->error,
        .status = DPT_STATUS_EXACT,
        .contact = DPT_CONTACT_UNKNOWN,
    };
}

uint32_t dpti_contact_of_gap(double gap, double error)
{
    if (fabs(gap) <= error)
        return DPT_CONTACT_TOUCHING;
    return gap > 0.0 ? DPT_CONTACT_SEPARATED : DPT_CONTACT_PENETRATING;
}

void dpti_segment_result_set_gap(struct segment_result *result, double gap, double error)
{
    result->has_gap = 1;
    result->gap = gap;
    result->contact = dpti_contact_of_gap(gap, error);
}

void dpti_segment_result_write(const struct segment_result *result, const struct surface *surface,
                               const struct frame *body, uint32_t id, const struct pair_search *nearest, dpt_hit *hit)
{
    hit->status = result->status;
    hit->contact = result->contact;
    hit->flags = (nearest->pair.distance2 == 0.0 ? DPT_HIT_FLAG_CROSSING : 0u) |
                 (result->has_gap ? DPT_HIT_FLAG_GAP : 0u) | result->unknown;
    hit->body = id;
    hit->triangle = surface->sources[nearest->triangle];
    hit->work = result->work;
    hit->distance = result->distance;
    hit->s = result->s;
    vec3_store(result->p, hit->p);
    vec3_store(sub(result->p, frame_turn(body, nearest->pair.gap)), hit->q);
    hit->error_bound = result->error_bound;
    hit->lower_bound = result->lower_bound;
    hit->gap = result->has_gap ? result->gap : 0.0;
    hit->depth = hit->gap < 0.0 ? -hit->gap : 0.0;
}

/* ---- the gap ---- */

int dpti_contact_find(struct distance_profile *profile, const struct pair_search *nearest,
                      const struct warm_start *warm_starts, uint32_t warm_start_count, double radius, double *gap)
{
    *gap = sqrt(nearest->pair.distance2) - radius;
    if (!dpti_profile_make(profile, nearest, warm_starts, warm_start_count))
        return CONTACT_NONE;
    if (profile->is_full || profile->is_cut || profile->is_sideless)
        return CONTACT_UNKNOWN;
    if (profile->sample[profile->deepest].height < 0.0)
        *gap = profile->sample[profile->deepest].height - radius;
    return CONTACT_PROFILE;
}

uint32_t dpti_contact_why_unknown(const struct distance_profile *profile)
{
    return (profile->is_cut ? DPT_HIT_FLAG_BUDGET : 0u) | (profile->is_sideless ? DPT_HIT_FLAG_NO_SIDE : 0u) |
           (profile->is_full ? DPT_HIT_FLAG_CROSSINGS_FULL : 0u);
}

vec3 dpti_contact_normal(const struct distance_profile *profile, const struct profile_sample *sample, uint32_t smooth)
{
    if (!smooth)
        return sample->normal;
    vec3 normal = dpti_surface_smooth_normal(profile->surface, sample->triangle, sample->weight);
    double agreement = dot(normal, sample->normal);
    return agreement != 0.0 ? scaled(normal, agreement < 0.0 ? -1.0 : 1.0) : sample->normal;
}

struct penetration dpti_contact_penetration(const struct distance_profile *profile, const struct frame *body,
                                            const struct profile_sample *sample, double depth, uint32_t smooth)
{
    const struct axis *axis = profile->axis;
    return (struct penetration){ frame_turn(body, dpti_contact_normal(profile, sample, smooth)),
                                 along(axis->a, sample->s, sub(axis->b, axis->a)), depth };
}

void dpti_contact_of(const struct surface *surface, const struct kernel *kernel, const struct axis *axis,
                     const struct pair_search *nearest, double radius, struct segment_result *result)
{
    const struct sides no_sides = { .count = 0 };
    struct distance_profile profile;
    double gap;
    profile.surface = surface;
    profile.kernel = kernel;
    profile.axis = axis;
    profile.sides = &no_sides;
    profile.point_cache = NULL;
    profile.contacts_wanted = profile.ends_wanted = 0;
    profile.reach = radius;
    profile.tolerance = PROFILE_DEPTH_SHARE * surface_diagonal(surface);
    profile.work = work_of(WORK_UNLIMITED);
    if (dpti_contact_find(&profile, nearest, NULL, 0, radius, &gap) != CONTACT_UNKNOWN)
        dpti_segment_result_set_gap(result, gap, result->error_bound);
    else
        result->unknown = dpti_contact_why_unknown(&profile);
}

/* ---- the paper's gap ---- */

/* The height of the axis' lower end over the triangle's plane, m. The axis crosses that plane at the nearest pair. */
static double lower_end_height(const struct axis *axis, const struct pair_search *nearest, vec3 normal)
{
    double height_a = -nearest->pair.s * dot(axis->u, normal);
    double height_b = (1.0 - nearest->pair.s) * dot(axis->u, normal);
    return min_of(height_a, height_b);
}

double dpti_contact_paper(const struct surface *surface, const struct frame *body, const struct axis *part,
                          const struct pair_search *nearest, double radius, struct penetration *penetration)
{
    vec3 normal = dpti_surface_face_normal(surface, nearest->triangle);
    double distance = sqrt(nearest->pair.distance2), gap;
    if (distance == 0.0) {
        gap = lower_end_height(part, nearest, normal) - radius;
        penetration->direction = normal;
    } else {
        double side = dot(nearest->pair.gap, normal) < 0.0 ? -1.0 : 1.0;
        gap = side * distance - radius;
        penetration->direction = scaled(nearest->pair.gap, side / distance);
    }
    penetration->direction = frame_turn(body, penetration->direction);
    penetration->at = along(part->a, nearest->pair.s, sub(part->b, part->a));
    penetration->depth = max_of(0.0, -gap);
    return gap;
}
