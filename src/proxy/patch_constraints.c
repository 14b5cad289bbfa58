/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/patch_constraints.h"

#include "hull/hull_pass.h"
#include "proxy/patch_tips.h"
#include "proxy/proxy_constraints.h"

/* As shares of the clearance: a plane must leave that much between a ball and what is behind it, and beside a line. */
#define CERTIFIED      0.9
#define CERTIFIED_LINE 0.5

/* Unit normals that differ by no more, and gaps, as a share of the clearance, are the same. */
#define TWIN 1e-9

/* As a share of a motion: one that may meet too many triangles is made so much shorter. */
#define CROWDED_SHARE 0.5

/* As a share of the clearance: a sweep past a triangle may end so much earlier. */
#define SWEPT 0.05

/*
 * The plane of a triangle's own face, where the ball is in front of it by the clearance, and it leaves more at the end
 * of the motion than that across the pair. At a concave edge it lets the ball go to where it touches; the pair's plane
 * is that of the edge, and would hold it half way there.
 */
static int face_plane(const struct proxy_tick *tick, const struct patch_side *side,
                      const struct patch_triangle *triangle, vec3 motion, pair *plane, double *distance)
{
    const double *weight = triangle->found.weight, radius = side->radius;
    vec3 v[3];
    if (!triangle->has_face || (weight[0] > 0.0 && weight[1] > 0.0 && weight[2] > 0.0))
        return 0;
    surface_corners(&side->body->surface, triangle->triangle, v);
    const vec3 face = cross(sub(v[1], v[0]), sub(v[2], v[0]));
    const double size = length(face);
    if (!(size > 0.0))
        return 0;
    vec3 normal = scaled(face, 1.0 / size);
    double height = dot(normal, sub(side->a, v[0]));
    normal = scaled(normal, height < 0.0 ? -1.0 : 1.0);
    /* Rounding tilts the normal of a sliver: as far as that, its corners may be in front. */
    height = fabs(height) - fabs(dot(normal, sub(v[1], v[0]))) - fabs(dot(normal, sub(v[2], v[0])));
    if (height - radius < tick->clearance ||
        height + dot(normal, motion) <= *distance + dot(triangle->found.gap, motion) / *distance)
        return 0;
    *distance = height;
    plane->gap = scaled(normal, height);
    return 1;
}

/* Whether a constraint has the same plane. */
static int has_twin(const struct proxy_tick *tick, vec3 normal, double gap)
{
    for (uint32_t i = 0; i < tick->space_count; i++)
        if (fabs(tick->sources[i].gap - gap) <= TWIN * tick->clearance &&
            extent_of(sub(vec3_of(tick->spaces[i].normal), normal)) <= TWIN)
            return 1;
    return 0;
}

/* The constraint of a ball: one plane. */
static int hold_ball(struct proxy_tick *tick, const struct patch_side *side, struct patch_triangle *triangle,
                     vec3 motion)
{
    const struct frame *frame = &side->body->frame;
    pair plane = triangle->found;
    double distance = sqrt(plane.distance2);
    face_plane(tick, side, triangle, frame_turn_back(frame, motion), &plane, &distance);
    const double gap = distance - side->radius;
    if (has_twin(tick, frame_turn(frame, scaled(plane.gap, 1.0 / distance)), gap))
        return 1;
    if (tick->space_count == HALF_SPACES_MAX)
        return 0;
    triangle->space = (uint16_t)tick->space_count;
    tick->triangles[tick->triangle_count++] =
        (struct proxy_triangle){ .segment = side->number, .body_id = side->body->id, .triangle = triangle->triangle };
    dpti_proxy_add_plane(tick, tick->triangle_count - 1, side->body, side->a, &plane, distance);
    return 1;
}

int dpti_patch_hold(struct proxy_tick *tick, struct patch_view *view, uint32_t i, double reach, vec3 motion)
{
    struct patch_triangle *triangle = &view->list[i];
    const struct patch_side *side = patch_side_of(view, triangle);
    triangle->is_held = 1;
    triangle->space = HALF_SPACES_MAX;
    if (!side->tip) {
        dpti_patch_find(tick->world, view, triangle);
        if (!(triangle->found.distance2 > 0.0))
            return 0;
    }
    if (view->is_ball)
        return hold_ball(tick, side, triangle, motion);
    /* A tip's pairs that are the nearest ones take the place of others, where there is no room. */
    if (tick->triangle_count == HALF_SPACES_MAX ||
        (!side->tip && tick->space_count + PROXY_GATHERED_MAX > HALF_SPACES_MAX))
        return 0;
    tick->triangles[tick->triangle_count++] =
        (struct proxy_triangle){ .segment = side->number, .body_id = side->body->id, .triangle = triangle->triangle };
    dpti_proxy_gather_triangle(tick, tick->triangle_count - 1, reach);
    return 1;
}

int dpti_patch_prefer_pairs(struct proxy_tick *tick, struct patch_view *view)
{
    const vec3 none = { 0.0, 0.0, 0.0 };
    int has_changed = 0;
    for (uint32_t k = 0; k < tick->solved.active_count; k++)
        for (uint32_t i = 0; i < view->count; i++) {
            struct patch_triangle *triangle = &view->list[i];
            if (!triangle->is_held || !triangle->has_face || triangle->space != tick->solved.active[k] ||
                !(triangle->gap > tick->sources[triangle->space].gap + 0.1 * tick->clearance))
                continue;
            triangle->has_face = 0;
            has_changed = 1;
        }
    if (!has_changed)
        return 0;
    tick->space_count = tick->triangle_count = 0;
    tick->is_begun = 0;
    for (uint32_t i = 0; i < view->count; i++)
        if (view->list[i].is_held && !dpti_patch_hold(tick, view, i, 0.0, none))
            return 0;
    return 1;
}

/* A motion that is to be proven, of one side. */
struct trial {
    const struct patch_side *side;
    struct patch_way way;
    double moved; /* m: no point of the axis goes farther */
    double kept;  /* m: so far the axis must stay in front of a plane */
    uint32_t plane_count;
    vec3 normal[HALF_SPACE_DIMENSIONS];           /* of the planes that hold */
    vec3 down[HALF_SPACE_DIMENSIONS];             /* the other way */
    struct hull_turn turn[HALF_SPACE_DIMENSIONS]; /* of a tip: these planes, which turn with what holds it */
    struct hull_pass pass;                        /* of a tip */
    struct frame to;                              /* of the tool, at the end */
    struct sweep sweep;                           /* if is_swept */
    int is_swept;
    double met; /* the time at which what was swept past last is met */
};

/* The normal of a tip's constraint at the end of the motion, in the body's frame; as at the start where there is none. */
static vec3 normal_at_end(const struct proxy_tick *tick, const struct trial *trial, uint32_t k)
{
    const struct patch_side *side = trial->side;
    const uint32_t space = tick->solved.active[k];
    const struct proxy_triangle *held = &tick->triangles[tick->sources[space].triangle];
    const uint32_t feature = (uint32_t)tick->sources[space].feature;
    struct hull_place place;
    struct hull_pair found;
    vec3 v[3];
    if (held->segment != side->number || held->body_id != side->body->id)
        return trial->normal[k];
    surface_corners(&side->body->surface, held->triangle, v);
    dpti_hull_place_feature(&place, side->part.tip->hull, feature, &trial->to, &side->body->frame);
    return dpti_hull_feature(&place, feature, v, &found) && found.pair.distance2 > 0.0 ? unit_of(found.pair.gap)
                                                                                       : trial->normal[k];
}

static void set_turns(const struct proxy_tick *tick, const struct patch_view *view, struct trial *trial)
{
    const struct patch_side *side = trial->side;
    trial->pass = (struct hull_pass){ .hull = side->part.tip->hull,
                                      .from = &view->placed,
                                      .to = &trial->to,
                                      .body = &side->body->frame,
                                      .corner = side->tip->corner,
                                      .moved = trial->moved,
                                      .apart = trial->kept };
    for (uint32_t k = 0; k < trial->plane_count; k++)
        trial->turn[k] = dpti_hull_turn_of(&trial->pass, trial->normal[k], normal_at_end(tick, trial, k));
}

static void trial_set(const struct proxy_tick *tick, const struct patch_view *view, const struct patch_side *side,
                      const struct proxy_pose *to, struct trial *trial)
{
    const struct frame *body = &side->body->frame;
    const struct dpt_hull *hull = side->tip ? side->part.tip->hull : NULL;
    const vec3 a = frame_to_local(body, frame_to_world(&to->frame, hull ? hull->axis_a : side->part.segment->a));
    const vec3 b = view->is_ball
                       ? a
                       : frame_to_local(body, frame_to_world(&to->frame, hull ? hull->axis_b : side->part.segment->b));
    trial->side = side;
    trial->to = to->frame;
    trial->moved = max_of(length(sub(a, side->a)), length(sub(b, add(side->a, side->u))));
    if (hull)
        trial->moved = dpti_patch_tip_lead(side, &to->frame);
    trial->kept = side->radius + (view->is_ball ? CERTIFIED : CERTIFIED_LINE) * tick->clearance;
    trial->way = dpti_patch_way(side, view->is_ball, a, b, trial->moved + trial->kept + side->spread);
    trial->is_swept = 0;
    trial->met = 0.0;
    trial->plane_count = tick->solved.active_count;
    for (uint32_t k = 0; k < trial->plane_count; k++) {
        trial->normal[k] = frame_turn_back(body, vec3_of(tick->spaces[tick->solved.active[k]].normal));
        trial->down[k] = scaled(trial->normal[k], -1.0);
    }
    if (hull)
        set_turns(tick, view, trial);
}

/* Whether a ball stays in front of a triangle's own plane; looked at before the triangle's corners are. */
static int stays_in_front(const struct trial *trial, const struct patch_triangle *triangle)
{
    const vec3 normal = triangle->normal;
    return min_of(dot(normal, trial->way.a[0]), dot(normal, trial->way.a[1])) - triangle->height >= trial->kept;
}

/* The same of a tip. */
static int tip_is_in_front(const struct trial *trial, const struct patch_triangle *triangle)
{
    const struct patch_side *side = trial->side;
    vec3 v[3];
    surface_corners(&side->body->surface, triangle->triangle, v);
    for (uint32_t k = 0; k < trial->plane_count; k++)
        if (dpti_hull_turn_parts(&trial->turn[k], v, trial->kept))
            return 1;
    return hull_height(side->tip->corner, 2 * side->part.tip->hull->corner_count, triangle->normal, v) >= trial->kept;
}

/* Whether planes that hold, or the triangle's own, prove that it is in nobody's way. */
static int is_behind_plane(const struct trial *trial, const struct patch_triangle *triangle)
{
    vec3 v[3];
    double part[2];
    if (trial->side->tip)
        return tip_is_in_front(trial, triangle);
    surface_corners(&trial->side->body->surface, triangle->triangle, v);
    if (!patch_part_beside(&trial->way, v, part) || patch_height(&trial->way, triangle->normal, part, v) >= trial->kept)
        return 1;
    for (uint32_t k = 0; k < trial->plane_count; k++)
        if (patch_height(&trial->way, trial->normal[k], part, v) >= trial->kept)
            return 1;
    return 0;
}

/* Prepare to sweep past triangles. */
static void begin_sweep(const struct proxy_tick *tick, struct trial *trial)
{
    const struct patch_way *way = &trial->way;
    const struct motion motion = { way->a[0], way->b[0], sub(way->a[1], way->a[0]), sub(way->b[1], way->b[0]) };
    if (trial->is_swept)
        return;
    dpti_sweep_begin(&trial->sweep, &motion, trial->kept, SWEPT * tick->clearance,
                     dpti_surface_extent(&trial->side->body->surface));
    trial->sweep.directions = trial->down;
    trial->sweep.direction_count = trial->plane_count;
    trial->is_swept = 1;
}

/* The same by planes of pairs on the way, of a part of the axis at a time; of one that is held by a sweep past it. */
static int is_swept_free(const struct proxy_tick *tick, struct trial *trial, const struct patch_triangle *triangle)
{
    const struct surface *surface = &trial->side->body->surface;
    struct moving_triangle still = { .is_moving = 0 };
    uint32_t evaluations = 1;
    begin_sweep(tick, trial);
    surface_corners(surface, triangle->triangle, still.corner);
    const int is_free = dpti_sweep_triangle(&trial->sweep, &still, 1.0, &trial->met, &evaluations) == SWEEP_FREE;
    work_spend(&tick->world->work, evaluations);
    return is_free;
}

/* Whether what is known of a triangle of the list tells that it is in nobody's way. */
static int is_known_clear(const struct proxy_tick *tick, const struct patch_view *view, const struct trial *trial,
                          const struct patch_triangle *triangle)
{
    return triangle->gap - trial->moved > tick->clearance || (view->is_ball && stays_in_front(trial, triangle)) ||
           is_behind_plane(trial, triangle);
}

/*
 * Whether a plane that turns parts a line from a triangle all the time: from that across their nearest pair at the start
 * of the motion, or at the end of one that was tried before, to a normal at its end. A height over it is a polynomial of
 * the second degree in time, and these are what remains of Bernstein's coefficients.
 */
static int stays_in_front_of_turn(const struct trial *trial, const struct patch_triangle *triangle, vec3 end)
{
    const struct patch_way *way = &trial->way;
    const vec3 normal[2] = { triangle->normal, end };
    double part[2], over[2][2];
    vec3 v[3];
    surface_corners(&trial->side->body->surface, triangle->triangle, v);
    if (!patch_part_beside(way, v, part))
        return 1;
    double least[3] = { HUGE_VAL, HUGE_VAL, HUGE_VAL }, most[3] = { -HUGE_VAL, -HUGE_VAL, -HUGE_VAL };
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < 2; i++)
            for (int time = 0; time < 2; time++)
                over[i][time] = dot(normal[i], add(way->a[time], scaled(sub(way->b[time], way->a[time]), part[k])));
        least[0] = min_of(least[0], over[0][0]);
        least[1] = min_of(least[1], 0.5 * (over[0][1] + over[1][0]));
        least[2] = min_of(least[2], over[1][1]);
    }
    for (int k = 0; k < 3; k++) {
        const double first = dot(normal[0], v[k]), last = dot(normal[1], v[k]);
        most[0] = max_of(most[0], first);
        most[1] = max_of(most[1], 0.5 * (first + last));
        most[2] = max_of(most[2], last);
    }
    return least[0] - most[0] >= trial->kept && least[1] - most[1] >= trial->kept && least[2] - most[2] >= trial->kept;
}

/* How a line is to a triangle at the end of the motion. */
enum { END_MET, END_CLEAR, END_UNKNOWN };

static int look_at_end(const struct proxy_tick *tick, const struct trial *trial, struct patch_triangle *triangle,
                       vec3 *normal)
{
    const struct patch_way *way = &trial->way;
    double part[2];
    vec3 v[3];
    surface_corners(&trial->side->body->surface, triangle->triangle, v);
    const pair end = segment_triangle(way->a[1], sub(way->b[1], way->a[1]), v[0], v[1], v[2]);
    work_spend(&tick->world->work, 1);
    if (!(end.distance2 > trial->kept * trial->kept))
        return END_MET;
    *normal = scaled(end.gap, 1.0 / sqrt(end.distance2));
    if (patch_part_beside(way, v, part) && patch_height(way, *normal, part, v) < trial->kept)
        return END_UNKNOWN;
    /* It may do for the next motion that is tried as well. */
    triangle->normal = *normal;
    return END_CLEAR;
}

/* Of a tip: whether a plane, which may turn, keeps it away from a triangle in doubt. */
static int tip_passes(const struct proxy_tick *tick, const struct trial *trial, struct patch_triangle *triangle)
{
    vec3 v[3], n = scaled(triangle->normal, -1.0);
    surface_corners(&trial->side->body->surface, triangle->triangle, v);
    work_spend(&tick->world->work, 1);
    if (!(triangle->is_held || dpti_hull_ends_apart(&trial->pass, v, &n)) || !dpti_hull_passes(&trial->pass, v, &n))
        return 0;
    if (dot(n, n) > 0.0)
        triangle->normal = scaled(n, -1.0);
    return 1;
}

/* The same of one in doubt: beside a line by where it is at the end; by its nearest pair; beside a line by a sweep. */
static int is_proven_clear(const struct proxy_tick *tick, const struct patch_view *view, struct trial *trial,
                           struct patch_triangle *triangle)
{
    if (trial->side->tip)
        return tip_passes(tick, trial, triangle);
    vec3 normal = { 0.0, 0.0, 0.0 };
    int end = END_MET;
    if (!view->is_ball) {
        end = look_at_end(tick, trial, triangle, &normal);
        /* Of one that is held already, a sweep tells when it is met. */
        if (end == END_CLEAR || (end == END_MET && !triangle->is_held))
            return end == END_CLEAR;
    }
    if (!triangle->is_found) {
        dpti_patch_find(tick->world, view, triangle);
        if (triangle->gap - trial->moved > tick->clearance || is_behind_plane(trial, triangle))
            return 1;
    }
    return !view->is_ball && ((end == END_UNKNOWN && stays_in_front_of_turn(trial, triangle, normal)) ||
                              is_swept_free(tick, trial, triangle));
}

/* Whether a triangle of the list is one of a side, and no constraint. */
static int is_open(const struct patch_view *view, uint32_t i, uint32_t side)
{
    return view->list[i].side == side && !view->list[i].is_held;
}

/* Beside a ball: what is in the way joins. It stays in front of the planes that are its constraints. */
static enum patch_proof prove_ball(struct proxy_tick *tick, struct patch_view *view, uint32_t side, struct trial *trial,
                                   double reach, vec3 motion)
{
    enum patch_proof proof = PATCH_FREE;
    for (uint32_t i = 0; i < view->count; i++) {
        struct patch_triangle *triangle = &view->list[i];
        if (!is_open(view, i, side) || is_known_clear(tick, view, trial, triangle) ||
            is_proven_clear(tick, view, trial, triangle))
            continue;
        if (!dpti_patch_hold(tick, view, i, reach, motion))
            return PATCH_CROWDED;
        proof = PATCH_ADDED;
    }
    return proof;
}

/* A triangle in doubt beside a line. What comes first by each measure is looked at first. */
enum { FROM_A, FROM_B, LEAST_HEIGHT, MEASURES };
struct doubt {
    uint32_t triangle;   /* in the list */
    double by[MEASURES]; /* the share of the line from its end a to it, from b; m: the line's height over its plane */
};

static struct doubt doubt_of(const struct patch_view *view, const struct trial *trial, uint32_t i)
{
    double part[2];
    vec3 v[3];
    surface_corners(&trial->side->body->surface, view->list[i].triangle, v);
    patch_part_beside(&trial->way, v, part);
    const double height =
        trial->side->tip ? view->list[i].gap : patch_height(&trial->way, view->list[i].normal, part, v);
    return (struct doubt){ i, { part[1], 1.0 - part[0], height } };
}

/*
 * Of what is in the way of a line, the first by a measure: held by these, it may be clear of the others, which need not
 * be looked at. Of those that are in doubt, *count, the clear ones are taken out. PATCH_TRIANGLES_MAX: there is none.
 */
static uint32_t first_met(struct proxy_tick *tick, struct patch_view *view, struct trial *trial, int measure,
                          struct doubt *doubts, uint32_t *count)
{
    while (*count) {
        uint32_t first = 0;
        for (uint32_t k = 1; k < *count; k++)
            if (doubts[k].by[measure] < doubts[first].by[measure])
                first = k;
        const uint32_t i = doubts[first].triangle;
        if (view->list[i].is_held || !is_proven_clear(tick, view, trial, &view->list[i]))
            return i;
        --*count;
        memmove(&doubts[first], &doubts[first + 1], (*count - first) * sizeof *doubts);
    }
    return PATCH_TRIANGLES_MAX;
}

/* Beside a line, of a side's triangles of the list from one on: what is in the way joins, a few at a time. */
static enum patch_proof hold_met(struct proxy_tick *tick, struct patch_view *view, uint32_t side, struct trial *trial,
                                 uint32_t from, double reach, vec3 motion)
{
    struct doubt doubts[PATCH_TRIANGLES_MAX];
    uint32_t count = 0;
    enum patch_proof proof = PATCH_FREE;
    for (uint32_t i = from; i < view->count; i++)
        if (is_open(view, i, side) && !is_known_clear(tick, view, trial, &view->list[i]))
            doubts[count++] = doubt_of(view, trial, i);
    for (int k = MEASURES - 1; k >= 0; k--) {
        const uint32_t i = first_met(tick, view, trial, k, doubts, &count);
        if (i == PATCH_TRIANGLES_MAX || view->list[i].is_held)
            continue;
        if (!dpti_patch_hold(tick, view, i, reach, motion))
            return PATCH_CROWDED;
        proof = PATCH_ADDED;
    }
    return proof;
}

/* Beside a line. Where nothing that is listed is in the way, the rest of the patch is looked at. */
static enum patch_proof prove_line(struct proxy_tick *tick, struct patch_view *view, uint32_t side, struct trial *trial,
                                   double reach, vec3 motion)
{
    const uint32_t listed = view->count;
    const enum patch_proof proof = hold_met(tick, view, side, trial, 0, reach, motion);
    if (proof != PATCH_FREE || trial->moved + tick->clearance <= view->reach)
        return proof;
    begin_sweep(tick, trial);
    if (!dpti_patch_list_met(tick->world, view, side, &trial->sweep)) {
        trial->met = CROWDED_SHARE;
        return PATCH_UNPROVEN;
    }
    return hold_met(tick, view, side, trial, listed, reach, motion);
}

/* Beside a line, where nothing else is in the way: whether what is held already is not. */
static enum patch_proof prove_held(struct proxy_tick *tick, struct patch_view *view, uint32_t side, struct trial *trial)
{
    trial->met = 0.0;
    for (uint32_t i = 0; i < view->count; i++)
        if (view->list[i].side == side && view->list[i].is_held && !is_known_clear(tick, view, trial, &view->list[i]) &&
            !is_proven_clear(tick, view, trial, &view->list[i]))
            return PATCH_UNPROVEN;
    return PATCH_FREE;
}

enum patch_proof dpti_patch_prove(struct proxy_tick *tick, struct patch_view *view, const struct proxy_pose *to,
                                  double reach, double *met)
{
    const vec3 motion = sub(to->centre, tick->at.centre);
    enum patch_proof proof = PATCH_FREE;
    struct trial trials[PATCH_SIDES_MAX];
    *met = 0.0;
    if (dpti_patch_moved(view, to) + tick->clearance > view->covered)
        return PATCH_UNPROVEN;
    for (uint32_t i = 0; i < view->side_count; i++) {
        struct trial *trial = &trials[i];
        trial_set(tick, view, &view->sides[i], to, trial);
        const enum patch_proof one = view->is_ball ? prove_ball(tick, view, i, trial, reach, motion)
                                                   : prove_line(tick, view, i, trial, reach, motion);
        *met = trial->met;
        if (one == PATCH_CROWDED || one == PATCH_UNPROVEN)
            return one;
        if (one == PATCH_ADDED)
            proof = one;
    }
    for (uint32_t i = 0; i < view->side_count && proof == PATCH_FREE && !view->is_ball; i++) {
        proof = prove_held(tick, view, i, &trials[i]);
        *met = trials[i].met;
    }
    return proof;
}
