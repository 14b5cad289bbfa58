/* SPDX-License-Identifier: BSD-3-Clause */
#include "fuzz/calls/rules.h"

#include "fuzz/calls/deform_model.h"

static const uint32_t WHY_UNKNOWN = DPT_HIT_FLAG_BUDGET | DPT_HIT_FLAG_NO_SIDE | DPT_HIT_FLAG_CROSSINGS_FULL;
static const uint32_t NOT_WHY = DPT_HIT_FLAG_GAP | DPT_HIT_FLAG_CROSSING;

/* Roundings of the test's own sums, per metre of the largest coordinate. */
static const double ROUNDING = 1e-13;

double apart(const double a[3], const double b[3])
{
    const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return sqrt(x * x + y * y + z * z);
}

static double extent_of(const double x[3])
{
    return fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2])));
}

double slack_of(const struct scene *scene, const dpt_segment *segment)
{
    double extent = 1.0 + fmax(extent_of(segment->a), extent_of(segment->b));
    for (uint32_t i = 0; i < scene->then_count; i++)
        extent = fmax(extent, extent_of(scene->then[i].pose.position));
    return ROUNDING * extent;
}

void triangle_must_be_there(const struct subject *subject, uint32_t triangle)
{
    double corners[9];
    HOLDS(dpt_mesh_get_triangle(subject->mesh, triangle, corners) == DPT_OK, "the %s has no triangle %u", subject->name,
          triangle);
}

void hit_must_be_stale(const dpt_hit *hit)
{
    HOLDS(hit->status == DPT_STATUS_STALE && hit->contact == DPT_CONTACT_UNKNOWN && !hit->flags &&
              hit->triangle == DPT_NONE,
          "status %u, contact %u, flags %x, triangle %u", hit->status, hit->contact, hit->flags, hit->triangle);
}

/* Whether a hit may be of a segment that was left out, as it was far. */
static int may_be_far(const dpt_world_def *def, const struct model_tool *tool, const dpt_hit *hit)
{
    return tool->near_only_then && tool->count > 1 && def->method == DPT_METHOD_EXACT &&
           hit->status == DPT_STATUS_BOUNDED;
}

static void status_must_hold(const dpt_world_def *def, const struct model_tool *tool, const dpt_hit *hit)
{
    if (def->method == DPT_METHOD_PAPER)
        HOLDS(hit->status == DPT_STATUS_LOCAL && hit->lower_bound == 0.0, "status %u, bound %g", hit->status,
              hit->lower_bound);
    else
        HOLDS(hit->status == DPT_STATUS_EXACT || (hit->status == DPT_STATUS_BOUNDED && def->budget != 0) ||
                  may_be_far(def, tool, hit),
              "status %u of method %u, budget %u", hit->status, def->method, def->budget);
}

static void gap_must_hold(const dpt_world_def *def, const struct model_tool *tool, const dpt_hit *hit, double radius,
                          double slack, int has_proxy)
{
    const int is_paper = def->method == DPT_METHOD_PAPER;
    const uint32_t why = hit->flags & WHY_UNKNOWN;
    HOLDS(hit->contact <= DPT_CONTACT_PENETRATING && !(hit->flags & ~(WHY_UNKNOWN | NOT_WHY)), "contact %u, flags %x",
          hit->contact, hit->flags);
    HOLDS(!why || hit->contact == DPT_CONTACT_UNKNOWN, "contact %u, flags %x", hit->contact, hit->flags);
    HOLDS(why || hit->contact != DPT_CONTACT_UNKNOWN || is_paper || def->until == DPT_UNTIL_TRACK,
          "contact is unknown and nothing says why, flags %x", hit->flags);
    HOLDS(!(why & DPT_HIT_FLAG_BUDGET) || def->budget || def->sweep_budget,
          "a budget ended that there is not, flags %x", hit->flags);
    HOLDS(hit->depth == fmax(0.0, -hit->gap), "gap %g, depth %g", hit->gap, hit->depth);
    if (!(hit->flags & DPT_HIT_FLAG_GAP)) {
        /* A proxy that is held does not tell how deep the device is, and what is far not how far. */
        HOLDS(hit->gap == 0.0 &&
                  (hit->contact == DPT_CONTACT_UNKNOWN || (has_proxy && hit->contact == DPT_CONTACT_PENETRATING) ||
                   (may_be_far(def, tool, hit) && hit->contact == DPT_CONTACT_SEPARATED)),
              "contact %u, gap %g that is not known", hit->contact, hit->gap);
        return;
    }
    HOLDS(def->until != DPT_UNTIL_TRACK, "a gap, though the step goes no farther than the pair");
    HOLDS(is_paper || hit->gap <= hit->distance - radius + slack, "gap %g, distance %g, radius %g", hit->gap,
          hit->distance, radius);
    const uint32_t expected = fabs(hit->gap) <= hit->error_bound ? DPT_CONTACT_TOUCHING
                              : hit->gap > 0.0                   ? DPT_CONTACT_SEPARATED
                                                                 : DPT_CONTACT_PENETRATING;
    HOLDS(is_paper || hit->contact == expected, "contact %u of a gap of %g within %g", hit->contact, hit->gap,
          hit->error_bound);
}

/* How far a point of the world is from a triangle, as that was in the last step. */
static double off_triangle(const struct body_then *body, uint32_t triangle, const double x[3])
{
    double point[6], corners[9];
    to_frame(&body->pose, x, point);
    memcpy(point + 3, point, 3 * sizeof *point);
    corners_then(body, triangle, corners);
    return dpt_segment_triangle(point, corners, NULL, NULL, NULL);
}

void strip_must_be_true(const struct scene *scene, const struct body_then *body, const dpt_segment *at,
                        const dpt_overlap *overlaps, uint32_t count)
{
    const double slack = slack_of(scene, at);
    double axis[6], corners[9];
    to_frame(&body->pose, at->a, axis);
    to_frame(&body->pose, at->b, axis + 3);
    for (uint32_t i = 0; i < count && !body->is_vague; i++) {
        const dpt_overlap *o = &overlaps[i];
        HOLDS(corners_then(body, o->triangle, corners), "there is no triangle %u", o->triangle);
        const double distance = dpt_segment_triangle(axis, corners, NULL, NULL, NULL);
        HOLDS(fabs(o->distance - distance) <= slack && off_triangle(body, o->triangle, o->q) <= slack,
              "triangle %u is %.17g m away, and not %.17g; q is %g m from it", o->triangle, distance, o->distance,
              off_triangle(body, o->triangle, o->q));
    }
}

/* Its own calls are not counted. */
/* p is on the axis, q on the triangle, and they are as far apart as is said. */
static void pair_must_hold(const struct scene *scene, const dpt_segment *at, const dpt_hit *hit, double slack)
{
    const struct body_then *body = scene_body_then(scene, hit->body);
    HOLDS(body, "body %x was not there at the last step", hit->body);
    HOLDS(hit->s >= 0.0 && hit->s <= 1.0, "s = %g", hit->s);
    HOLDS(hit->distance >= 0.0 && hit->lower_bound >= 0.0 && hit->error_bound >= 0.0 &&
              hit->lower_bound <= hit->distance,
          "distance %g, lower_bound %g, error_bound %g", hit->distance, hit->lower_bound, hit->error_bound);
    HOLDS(!(hit->flags & DPT_HIT_FLAG_CROSSING) == (hit->distance > 0.0), "flags %x, distance %g", hit->flags,
          hit->distance);
    double p[3];
    for (int k = 0; k < 3; k++)
        p[k] = at->a[k] + hit->s * (at->b[k] - at->a[k]);
    HOLDS(apart(p, hit->p) <= slack, "p is %g m from the axis at s", apart(p, hit->p));
    HOLDS(fabs(apart(hit->p, hit->q) - hit->distance) <= slack, "p and q are %g apart, and not %g",
          apart(hit->p, hit->q), hit->distance);
    triangle_must_be_there(body->subject, hit->triangle);
    const double off = body->is_vague ? 0.0 : off_triangle(body, hit->triangle, hit->q);
    HOLDS(off <= slack, "q is %g m from triangle %u", off, hit->triangle);
}

void hit_must_hold(const struct scene *scene, const struct model_tool *tool, uint32_t segment, const dpt_hit *hit)
{
    HOLDS(segment < tool->count && hit->segment == segment, "segment %u, and not %u", hit->segment, segment);
    if (tool->answers == ANSWERS_NONE || (tool->answers == ANSWERS_EITHER && hit->status == DPT_STATUS_STALE)) {
        hit_must_be_stale(hit);
        met[MET_STALE]++;
        return;
    }
    const dpt_segment *at = &tool->at[segment];
    const double slack = slack_of(scene, at);
    met[hit->status == DPT_STATUS_EXACT ? MET_EXACT : hit->status == DPT_STATUS_BOUNDED ? MET_BOUNDED : MET_LOCAL]++;
    met[MET_CROSSING] += hit->flags & DPT_HIT_FLAG_CROSSING ? 1 : 0;
    met[MET_TOUCHING] += hit->contact == DPT_CONTACT_TOUCHING;
    met[MET_PENETRATING] += hit->contact == DPT_CONTACT_PENETRATING;
    met[MET_UNKNOWN] += hit->contact == DPT_CONTACT_UNKNOWN;
    status_must_hold(&scene->def, tool, hit);
    pair_must_hold(scene, at, hit, slack);
    gap_must_hold(&scene->def, tool, hit, at->radius, slack, has_proxy(scene, tool->law_then));
}

double true_distance(const struct scene *scene, const dpt_segment *at)
{
    double least = INFINITY, corners[9];
    for (uint32_t i = 0; i < scene->then_count; i++) {
        const struct body_then *body = &scene->then[i];
        double local[6];
        to_frame(&body->pose, at->a, local);
        to_frame(&body->pose, at->b, local + 3);
        for (uint32_t t = 0; t < body->subject->source_triangles; t++)
            if (corners_then(body, t, corners))
                least = fmin(least, dpt_segment_triangle(local, corners, NULL, NULL, NULL));
    }
    return least;
}

void hit_must_be_true(const struct scene *scene, const struct model_tool *tool, const dpt_hit *hit)
{
    if (hit->status == DPT_STATUS_STALE || !all_are_known(scene))
        return;
    met[MET_TRUE]++;
    met[MET_TRUE_DEFORMED] += scene_body_then(scene, hit->body)->positions != NULL;
    const dpt_segment *at = &tool->at[hit->segment];
    const double slack = slack_of(scene, at), distance = true_distance(scene, at);
    HOLDS(hit->lower_bound <= distance + slack, "lower_bound %.17g, and the distance is %.17g", hit->lower_bound,
          distance);
    HOLDS(hit->distance >= distance - slack, "distance %.17g, and it is %.17g", hit->distance, distance);
    if (hit->status != DPT_STATUS_BOUNDED)
        HOLDS(fabs(hit->distance - distance) <= hit->error_bound + slack, "distance %.17g within %g, and it is %.17g",
              hit->distance, hit->error_bound, distance);
}

int all_are_solid(const struct scene *scene)
{
    int solid = 1;
    for (uint32_t i = 0; i < scene->then_count; i++)
        solid &= is_solid_then(&scene->then[i]);
    return solid;
}

/* The solid angle of a triangle seen from the origin, signed (van Oosterom and Strackee). */
static double solid_angle(const double a[3], const double b[3], const double c[3])
{
    const double zero[3] = { 0.0, 0.0, 0.0 };
    const double la = apart(a, zero), lb = apart(b, zero), lc = apart(c, zero);
    const double det =
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    double ab = 0.0, bc = 0.0, ca = 0.0;
    for (int k = 0; k < 3; k++) {
        ab += a[k] * b[k];
        bc += b[k] * c[k];
        ca += c[k] * a[k];
    }
    return 2.0 * atan2(det, la * lb * lc + ab * lc + bc * la + ca * lb);
}

double times_inside(const struct body_then *body, const double x[3])
{
    double local[3], corners[9], sum = 0.0;
    to_frame(&body->pose, x, local);
    for (uint32_t t = 0; t < body->subject->source_triangles; t++) {
        if (!corners_then(body, t, corners))
            continue;
        for (int k = 0; k < 9; k++)
            corners[k] -= local[k % 3];
        sum += solid_angle(corners, corners + 3, corners + 6);
    }
    return sum / 12.566370614359172;
}

void gap_must_be_true(const struct scene *scene, const struct model_tool *tool, const dpt_hit *hit)
{
    const dpt_segment *at = &tool->at[hit->segment];
    const double slack = slack_of(scene, at);
    double inside = 0.0;
    if (hit->status == DPT_STATUS_STALE || scene->def.method == DPT_METHOD_PAPER || !(hit->flags & DPT_HIT_FLAG_GAP) ||
        !all_are_solid(scene) || !all_are_known(scene) || hit->distance < 1e-6)
        return;
    for (uint32_t i = 0; i < scene->then_count; i++)
        inside = fmax(inside, fabs(times_inside(&scene->then[i], at->a)));
    met[MET_INSIDE] += inside > 0.5;
    if (inside > 0.5)
        HOLDS(hit->gap <= -hit->distance - at->radius + slack, "gap %g, inside, %g from the surface, radius %g",
              hit->gap, hit->distance, at->radius);
    else
        HOLDS(fabs(hit->gap - (hit->distance - at->radius)) <= hit->error_bound + slack,
              "gap %g, outside, %g from the surface, radius %g", hit->gap, hit->distance, at->radius);
}

/* In this step the proxy has left the place of its contacts for the device. */
static int starts_again(const struct scene *scene, const struct model_tool *tool)
{
    dpt_force_info report = { .size = sizeof report };
    dpt_tool_get_force_info(scene->world[0], tool->id, &report);
    return (report.flags & (DPT_FORCE_FLAG_SQUEEZED | DPT_FORCE_FLAG_REPLACED)) != 0;
}

static void contact_must_hold(const struct scene *scene, const struct model_tool *tool, const dpt_contact *contact)
{
    const struct body_then *body = scene_body_then(scene, contact->body);
    HOLDS(contact->id != 0, "a contact without a number");
    HOLDS(body, "body %x was not there at the last step", contact->body);
    HOLDS(contact->segment < tool->count, "segment %u of %u", contact->segment, tool->count);
    triangle_must_be_there(body->subject, contact->triangle);
    HOLDS(contact->contact <= DPT_CONTACT_PENETRATING && contact->flags <= 7 && !contact->reserved,
          "contact %u, flags %x", contact->contact, contact->flags);
    HOLDS(contact->s0 >= 0.0 && contact->s0 <= contact->s1 && contact->s1 <= 1.0 && contact->s >= contact->s0 &&
              contact->s <= contact->s1,
          "s %.17g in %.17g to %.17g", contact->s, contact->s0, contact->s1);
    const int is_felt = has_proxy(scene, tool->law_then);
    const dpt_segment *at = &(is_felt ? tool->proxy_at : tool->at)[contact->segment];
    const double slack = slack_of(scene, at), *weight = contact->weight;
    double p[3];
    const double zero[3] = { 0.0, 0.0, 0.0 };
    for (int k = 0; k < 3; k++)
        p[k] = at->a[k] + contact->s * (at->b[k] - at->a[k]);
    HOLDS(apart(p, contact->p) <= slack || (is_felt && (tool->has_grown || starts_again(scene, tool))),
          "p is %g m from the axis at s", apart(p, contact->p));
    const double off = body->is_vague ? 0.0 : off_triangle(body, contact->triangle, contact->q);
    HOLDS(off <= slack, "q is %g m from triangle %u", off, contact->triangle);
    HOLDS(fabs(weight[0] + weight[1] + weight[2] - 1.0) <= 1e-9 && weight[0] >= -1e-9 && weight[1] >= -1e-9 &&
              weight[2] >= -1e-9,
          "weights %g, %g, %g", weight[0], weight[1], weight[2]);
    const double normal = apart(contact->normal, zero);
    HOLDS(normal == 0.0 || fabs(normal - 1.0) <= 1e-6, "a normal of length %g", normal);
    /* By Cauchy and Schwarz, a square is at least that of the overlap over the length. */
    const double length = apart(at->a, at->b) * (contact->s1 - contact->s0);
    HOLDS(contact->overlap >= 0.0 && contact->square >= 0.0 &&
              ((is_felt && tool->has_grown) ||
               contact->overlap * contact->overlap <= contact->square * length * (1.0 + 1e-6) + 1e-30 + slack * slack),
          "overlap %g, square %g over %g m", contact->overlap, contact->square, length);
    for (int e = 0; e < 2; e++)
        HOLDS(contact->end_gap[e] >= contact->gap &&
                  contact->end_gap[e] <= fmax(contact->gap, scene->def.margin * (1.0 + 1e-12) + slack),
              "gap %g at an end, %g at least", contact->end_gap[e], contact->gap);
    HOLDS(contact->gap <= scene->def.margin + 1e-5 + slack, "gap %g beyond the margin of %g", contact->gap,
          scene->def.margin);
    HOLDS(contact->contact == DPT_CONTACT_TOUCHING ||
              (contact->contact == DPT_CONTACT_PENETRATING) == (contact->gap < 0.0),
          "contact %u of a gap of %g", contact->contact, contact->gap);
}

void contacts_must_hold(const struct scene *scene, const struct model_tool *tool, const dpt_contact *contacts,
                        uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        contact_must_hold(scene, tool, &contacts[i]);
        met[MET_CONTACT]++;
        met[MET_SIDED] += contacts[i].flags & DPT_CONTACT_FLAG_SIDED ? 1 : 0;
        for (uint32_t k = 0; k < i; k++)
            HOLDS(contacts[k].id != contacts[i].id, "two contacts of number %u", contacts[i].id);
        for (uint32_t k = 0; k < i; k++)
            HOLDS(contacts[k].segment < contacts[i].segment ||
                      (contacts[k].segment == contacts[i].segment &&
                       (contacts[k].body != contacts[i].body ||
                        (contacts[k].s0 <= contacts[i].s0 && contacts[k].body == contacts[i - 1].body))),
                  "contact %u of segment %u and body %x from %g on comes behind that of segment %u "
                  "and body %x from %g on",
                  i, contacts[i].segment, contacts[i].body, contacts[i].s0, contacts[k].segment, contacts[k].body,
                  contacts[k].s0);
    }
}

void sweep_must_hold(const struct scene *scene, const struct model_tool *tool, uint32_t segment, const dpt_sweep *sweep)
{
    const double zero[3] = { 0.0, 0.0, 0.0 };
    HOLDS(sweep->segment == segment && sweep->status <= DPT_SWEEP_UNFINISHED, "segment %u, status %u", sweep->segment,
          sweep->status);
    if (tool->answers == ANSWERS_NONE || has_proxy(scene, tool->law_then))
        HOLDS(sweep->status == DPT_SWEEP_NONE, "status %u without a step, or of a proxy", sweep->status);
    HOLDS(scene->def.budget || scene->def.sweep_budget || (sweep->status != DPT_SWEEP_UNFINISHED && sweep->age == 0),
          "status %u, age %u without a budget", sweep->status, sweep->age);
    met[MET_UNFINISHED] += sweep->status == DPT_SWEEP_UNFINISHED;
    if (sweep->status != DPT_SWEEP_HIT)
        return;
    met[MET_SWEEP_HIT]++;
    const struct body_then *body = scene_body_then(scene, sweep->body);
    HOLDS(body, "body %x was not there at the last step", sweep->body);
    triangle_must_be_there(body->subject, sweep->triangle);
    HOLDS(sweep->time >= 0.0 && sweep->time <= 1.0 && sweep->s >= 0.0 && sweep->s <= 1.0, "time %g, s %g", sweep->time,
          sweep->s);
    HOLDS(fabs(apart(sweep->normal, zero) - 1.0) <= 1e-6 ||
              (apart(sweep->normal, zero) == 0.0 && may_lack_normals(body->positions, body->is_affine)),
          "a normal of length %g", apart(sweep->normal, zero));
}

void overlaps_must_hold(const dpt_overlap *overlaps, uint32_t count, double radius)
{
    for (uint32_t i = 0; i < count; i++) {
        const dpt_overlap *o = &overlaps[i];
        met[MET_OVERLAP] += o->overlap > 0.0;
        HOLDS(o->s >= 0.0 && o->s <= 1.0 && o->distance >= 0.0 && o->overlap >= 0.0 && !o->reserved,
              "s %g, distance %g, overlap %g", o->s, o->distance, o->overlap);
        HOLDS(fabs(o->weight[0] + o->weight[1] + o->weight[2] - 1.0) <= 1e-9, "weights %g, %g, %g", o->weight[0],
              o->weight[1], o->weight[2]);
        HOLDS(o->flags == (o->distance > 0.0 ? 0u : DPT_OVERLAP_FLAG_CROSSING), "flags %x, %g m", o->flags,
              o->distance);
        HOLDS(o->gap == (o->overlap > 0.0 ? -o->overlap : fmax(0.0, o->distance - radius)),
              "gap %g, overlap %g, distance %g", o->gap, o->overlap, o->distance);
        for (uint32_t k = 0; k < i; k++)
            HOLDS(overlaps[k].triangle != o->triangle, "triangle %u is there twice", o->triangle);
    }
}

void twin_finds_hits(const struct scene *scene, uint32_t tool_id)
{
    dpt_hit hit = DPT_HIT_INIT;
    if (scene->world_count == 2)
        HOLDS(dpt_tool_get_hit(scene->world[1], tool_id, &hit) == DPT_OK, "no hit");
}
