/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/patch_tips.h"

#include "hull/hull_pass.h"

static uint32_t corners_of(const struct patch_side *side)
{
    return side->part.tip->hull->corner_count;
}

double dpti_patch_tip_moved(const struct tip *tip, const struct frame *from, const struct frame *to)
{
    double square = 0.0;
    for (uint32_t i = 0; i < tip->hull->corner_count; i++) {
        const vec3 corner = tip->hull->corner[i], way = sub(frame_to_world(to, corner), frame_to_world(from, corner));
        square = max_of(square, dot(way, way));
    }
    return sqrt(square);
}

double dpti_patch_tip_place(struct patch_side *side, const struct frame *tool)
{
    double square = 0.0;
    for (uint32_t i = 0; i < corners_of(side); i++) {
        const vec3 corner = hull_corner_at(side->part.tip->hull, i, tool, &side->body->frame);
        const vec3 way = sub(corner, side->tip->corner[i]);
        square = max_of(square, dot(way, way));
        side->tip->corner[i] = corner;
    }
    return sqrt(square);
}

double dpti_patch_tip_lead(const struct patch_side *side, const struct frame *to)
{
    const uint32_t count = corners_of(side);
    vec3 *corner = side->tip->corner;
    double square = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        corner[count + i] = hull_corner_at(side->part.tip->hull, i, to, &side->body->frame);
        const vec3 way = sub(corner[count + i], corner[i]);
        square = max_of(square, dot(way, way));
    }
    return sqrt(square);
}

/* From the tip to the body, where it was last nearest; of any length. */
static vec3 direction_of(const struct patch_side *side)
{
    const struct tip_answer *answer = &side->part.tip->answer;
    if (answer->body == side->body && answer->nearest.distance > 0.0)
        return scaled(answer->nearest.found.pair.gap, -1.0);
    return sub(side->body->surface.filter_centre, along(side->a, 0.5, side->u));
}

void dpti_patch_tip_planes(struct patch_side *side, const struct frame *tool)
{
    struct hull_place place;
    hull_place_set(&place, side->part.tip->hull, tool, &side->body->frame);
    dpti_hull_planes(&place, direction_of(side), side->tip->plane, side->tip->support);
}

/* The plane of a triangle's own face, if the tip is in front of it by more than `most`, m. */
static void try_face(const struct patch_side *side, const vec3 v[3], double *most, vec3 *normal)
{
    const vec3 face = cross(sub(v[1], v[0]), sub(v[2], v[0]));
    if (!(dot(face, face) > 0.0))
        return;
    const vec3 up = unit_of(face), n = dot(up, sub(side->tip->corner[0], v[0])) > 0.0 ? up : scaled(up, -1.0);
    const double height = hull_height(side->tip->corner, corners_of(side), n, v);
    if (height > *most) {
        *most = height;
        *normal = n;
    }
}

int dpti_patch_tip_list(const struct patch_side *side, struct patch_triangle *triangle, double within)
{
    vec3 v[3];
    double most = -HUGE_VAL;
    surface_corners(&side->body->surface, triangle->triangle, v);
    for (int i = 0; i < HULL_PLANES; i++) {
        const vec3 back = scaled(side->tip->plane[i], -1.0);
        const double height = -support_of(v, 3, back) - side->tip->support[i];
        if (height > most) {
            most = height;
            triangle->normal = back;
        }
    }
    try_face(side, v, &most, &triangle->normal);
    triangle->gap = max_of(triangle->gap, most - side->radius);
    return triangle->gap <= within;
}

/* Planes across pairs of this look: most of what is near lies behind one of them. */
enum { PAIR_PLANES = 8 };

struct pair_planes {
    uint32_t count;
    vec3 normal[PAIR_PLANES];  /* unit, to the tip */
    double least[PAIR_PLANES]; /* m: no corner is lower */
};

static void add_pair_plane(struct pair_planes *planes, const struct patch_side *side, vec3 normal)
{
    if (planes->count == PAIR_PLANES)
        return;
    planes->normal[planes->count] = normal;
    planes->least[planes->count++] = -support_of(side->tip->corner, corners_of(side), scaled(normal, -1.0));
}

/* Whether one of these planes, or that of its last pair, proves that a triangle's gap is more than `within`, m. */
static int is_farther(const struct pair_planes *planes, const struct patch_side *side, struct patch_triangle *triangle,
                      double within)
{
    vec3 v[3];
    surface_corners(&side->body->surface, triangle->triangle, v);
    if (hull_height(side->tip->corner, corners_of(side), triangle->normal, v) > within + side->radius)
        return 1;
    for (uint32_t k = 0; k < planes->count; k++) {
        if (!(planes->least[k] - support_of(v, 3, planes->normal[k]) > within + side->radius))
            continue;
        triangle->normal = planes->normal[k];
        triangle->gap = max_of(triangle->gap, within);
        return 1;
    }
    return 0;
}

/* Find a triangle's pair, and the plane across it, if its gap is at most `within`, m. */
static void find_pair(struct dpt_world *world, const struct patch_side *side, const struct hull_place *place,
                      struct patch_triangle *triangle, double within)
{
    struct hull_pair found;
    vec3 v[3];
    surface_corners(&side->body->surface, triangle->triangle, v);
    work_spend(&world->work, 1);
    if (!dpti_hull_triangle_apart(place, v, within + side->radius, &found)) {
        triangle->gap = max_of(triangle->gap, within);
        return;
    }
    const double distance = sqrt(found.pair.distance2);
    triangle->found = found.pair;
    triangle->feature = found.feature;
    triangle->gap = distance - side->radius;
    triangle->is_found = 1;
    if (distance > 0.0)
        triangle->normal = scaled(found.pair.gap, 1.0 / distance);
}

void dpti_patch_tip_find_near(struct proxy_tick *tick, struct patch_view *view, uint32_t number)
{
    struct patch_side *side = &view->sides[number];
    struct pair_planes planes = { .count = 0 };
    struct hull_place place;
    hull_place_set(&place, side->part.tip->hull, &view->placed, &side->body->frame);
    /* What the proxy remembers comes first, as it may hold the tip. */
    for (int is_late = 0; is_late < 2; is_late++)
        for (uint32_t i = 0; i < view->count; i++) {
            struct patch_triangle *triangle = &view->list[i];
            if (triangle->side != number || triangle->gap > view->near ||
                is_late == patch_is_remembered(tick->proxy, side, triangle->triangle))
                continue;
            if (!triangle->is_found && !is_farther(&planes, side, triangle, view->near))
                find_pair(tick->world, side, &place, triangle, view->near);
            if (!triangle->is_found)
                continue;
            add_pair_plane(&planes, side, triangle->normal);
            if (side->nearest == PATCH_TRIANGLES_MAX ||
                patch_is_nearer(&side->body->surface, triangle, &view->list[side->nearest]))
                side->nearest = i;
        }
}

void dpti_patch_tip_answer(const struct dpt_world *world, const struct patch_side *side, const struct frame *tool,
                           const struct patch_triangle *nearest)
{
    const struct body *body = side->body;
    struct hull_place place;
    struct tip_answer answer;
    hull_place_set(&place, side->part.tip->hull, tool, &body->frame);
    memset(&answer, 0, sizeof answer);
    answer.body = body;
    answer.is_exact = 1;
    answer.nearest =
        (struct hull_nearest){ .found = { nearest->found, nearest->feature },
                               .triangle = nearest->triangle,
                               .distance = sqrt(nearest->found.distance2),
                               .error_bound = dpti_hull_error(&place, &body->surface, tool, &body->frame) };
    const vec3 q = surface_point(&body->surface, nearest->triangle, nearest->found.weight);
    answer.q = frame_to_world(&body->frame, q);
    answer.p = frame_to_world(&body->frame, add(q, nearest->found.gap));
    answer.lower_bound = max_of(0.0, answer.nearest.distance - answer.nearest.error_bound);
    dpti_tip_know(world, side->part.tip, tool, &answer);
}
