/* SPDX-License-Identifier: BSD-3-Clause */
#include "track/sheet_ride.h"

void normal_of(const double c[9], double n[3])
{
    double e[3], f[3];
    add_scaled(e, c + 3, -1.0, c);
    add_scaled(f, c + 6, -1.0, c);
    cross3(e, f, n);
    unit_or_z(n);
}

double height_of(const struct sheet *sheet, const double x[3], double n[3], int *border)
{
    struct ends3 point;
    double q[3] = { 0.0, 0.0, 0.0 }, off[3], most = -1.0, height = 0.0;
    memcpy(point.end[0], x, sizeof point.end[0]);
    memcpy(point.end[1], x, sizeof point.end[1]);
    struct close close = closest_of_all(sheet, &point);
    uint32_t count = near_axis(sheet, &point, close.distance), edgy = 0;
    for (uint32_t i = 0; i < count; i++) {
        const double *c = sheet->corners + 9 * (size_t)sheet->near[i];
        double here[3], of[3];
        if (to_triangle(&point, c, NULL, here) > close.distance + 1e-12 * sheet->diagonal)
            continue;
        edgy |= sheet->edgy[sheet->near[i]];
        normal_of(c, of);
        add_scaled(off, x, -1.0, here);
        if (fabs(dot3(off, of)) <= most)
            continue;
        most = fabs(dot3(off, of));
        height = dot3(off, of) < 0.0 ? -close.distance : close.distance;
        memcpy(n, of, sizeof of);
        memcpy(q, here, sizeof q);
    }
    memcpy(point.end[0], q, sizeof q);
    memcpy(point.end[1], q, sizeof q);
    *border = edgy && border_distance(sheet, &point) < 1e-8 * sheet->diagonal;
    return height;
}

/*
 * A hit that is reported: near a touch, at a triangle and a point that are there, from the side that the tool came
 * from.
 */
static void check_hit(struct ride *ride, const struct state *now, const dpt_sweep *sweep, double radius)
{
    const struct sheet *sheet = ride->scene->sheet;
    struct ends3 at = ends_between(&ride->previous, now, sweep->time);
    double *c = NULL, q[3], x[3], tolerance = 1.0001e-6 * sheet->diagonal;
    for (uint32_t t = 0; t < sheet->count && !c; t++)
        if (sheet->numbers[t] == sweep->triangle)
            c = sheet->corners + 9 * (size_t)t;
    CHECK(c != NULL, "%s: triangle %u", sheet->name, sweep->triangle);
    if (!c)
        return;
    /* Ten halvings of a turn are the most: docs/algorithms/swept_motion.md. */
    double turn =
        (pose_angle(&ride->previous.tool, &now->tool) + pose_angle(&ride->previous.body, &now->body)) / 1024.0;
    double speed = most_speed(&ride->previous, now) / 1024.0;
    tolerance += turn > 0.0 ? 2.0 * turn * speed / 8.0 : 0.0;
    double off = to_triangle(&at, c, NULL, NULL) - radius;
    ride->sums->worst_off = fmax(ride->sums->worst_off, off / tolerance);
    CHECK(off <= tolerance, "%s: %.3g from a touch at %.17g%s", sheet->name, off, sweep->time,
          motion_text(&ride->previous, now));
    pose_local(&now->body, sweep->q, q);
    double twice[6] = { q[0], q[1], q[2], q[0], q[1], q[2] };
    double size = length3(q) + sheet->diagonal + length3(now->body.position);
    CHECK(dpt_segment_triangle(twice, c, NULL, NULL, NULL) <= 1e-12 * size, "%s: q is not on it", sheet->name);
    axis_point(x, &at, sweep->s);
    CHECK(apart(x, q) <= radius + tolerance, "%s: s is %g off%s", sheet->name, apart(x, q) - radius,
          motion_text(&ride->previous, now));
    CHECK(fabs(length3(sweep->normal) - 1.0) < 1e-9, "%s: normal", sheet->name);
    if (!sheet->info.open_edges || sheet->info.solid_components || sheet->info.nonmanifold_edges ||
        sheet->info.wrong_way_edges)
        return; /* no sides */
    double n[3], m[3];
    int border;
    at = ends_between(&ride->previous, now, 0.0);
    axis_point(x, &at, sweep->s);
    double height = height_of(sheet, x, n, &border);
    at = ends_between(&ride->previous, now, fmax(0.0, sweep->time - 1e-3));
    axis_point(x, &at, sweep->s);
    double short_before = height_of(sheet, x, n, &border);
    normal_of(c, n);
    turn3(now->body.orientation, n, m);
    double side = dot3(sweep->normal, m);
    if (height * short_before > 0.0 && fabs(short_before) > 2.0 * tolerance && !border)
        CHECK(side * short_before > 0.0, "%s: normal %g, height before %g, %g%s", sheet->name, side, height,
              short_before, motion_text(&ride->previous, now));
}

struct truth check_sweep(struct ride *ride, const struct state *now, const dpt_sweep *sweep, double planned)
{
    struct sums *sums = ride->sums;
    const struct sheet *sheet = ride->scene->sheet;
    double radius = now->radius, small = 1e-8 * sheet->diagonal;
    struct truth none = { .met = TRUTH_UNDECIDED };
    if (ride->started && ride->previous_distance > 0.0 && ride->previous_distance <= ride->previous_error)
        return none; /* whether it went through already is a matter of rounding */
    if (!ride->started || ride->previous_distance == 0.0) {
        CHECK(sweep->status == DPT_SWEEP_NONE, "%s: sweep %u of no motion", sheet->name, sweep->status);
        return none;
    }
    sums->swept++;
    CHECK(sweep->status == DPT_SWEEP_FREE || sweep->status == DPT_SWEEP_HIT, "%s: sweep %u%s", sheet->name,
          sweep->status, motion_text(&ride->previous, now));
    int hit = sweep->status == DPT_SWEEP_HIT;
    if (planned >= 0.0) {
        sums->planned++;
        CHECK(hit && sweep->time <= planned + 1e-9, "%s: planned at %.17g, sweep %u at %.17g, distance %g%s",
              sheet->name, planned, sweep->status, sweep->time, ride->previous_distance,
              motion_text(&ride->previous, now));
    }
    if (fabs(ride->previous_distance - radius) <= small && radius > 0.0)
        return truth_of(sheet, &ride->previous, now, 0.0); /* in contact before? A matter of rounding */
    double swept = ride->previous_distance > radius ? radius : 0.0;
    struct truth truth = truth_of(sheet, &ride->previous, now, swept), axis = truth;
    if (swept > 0.0 && truth.met != TRUTH_CLEAR)
        axis = truth_of(sheet, &ride->previous, now, 0.0);
    sums->met += truth.met == TRUTH_MET;
    sums->clear += truth.met == TRUTH_CLEAR;
    sums->near += truth.met == TRUTH_NEAR;
    sums->undecided += truth.met == TRUTH_UNDECIDED;
    if (truth.met == TRUTH_MET) {
        CHECK(hit && sweep->time <= truth.by + 1e-9, "%s: met by %.17g, sweep %u at %.17g%s", sheet->name, truth.by,
              sweep->status, sweep->time, motion_text(&ride->previous, now));
        sums->worst_late = fmax(sums->worst_late, sweep->time - truth.by);
    }
    if (hit)
        check_hit(ride, now, sweep, swept);
    else
        CHECK(sweep->time == 1.0 && sweep->triangle == DPT_NONE, "%s: free, %g", sheet->name, sweep->time);
    return axis;
}

/*
 * The least height of the axis over the sheet, counted from `side`, what is over the border being in front. Of the flat
 * square it is at the ends of what is over the square; else sampled, with what may lie between.
 */
struct depth {
    double least, spread;
    int sure;
    double s;
    double out[3]; /* towards the side */
};

static struct depth flat_depth(const struct sheet *sheet, const struct ends3 *at, int side)
{
    double from = 0.0, to = 1.0;
    for (int k = 0; k < 2; k++) {
        double a = at->end[0][k], u = at->end[1][k] - a;
        double s0 = (-sheet->flat - a) / u, s1 = (sheet->flat - a) / u;
        if (fabs(u) > 0.0) {
            from = fmax(from, fmin(s0, s1));
            to = fmin(to, fmax(s0, s1));
        } else if (fabs(a) > sheet->flat) {
            to = -1.0;
        }
    }
    struct depth depth = { .least = HUGE_VAL, .sure = 1, .out = { 0.0, 0.0, side } };
    for (int e = 0; e < 2 && from <= to; e++) {
        double x[3], s = e ? to : from;
        axis_point(x, at, s);
        if (side * x[2] >= depth.least)
            continue;
        depth.least = side * x[2];
        depth.s = s;
        depth.sure = (s == 0.0 || s == 1.0) && fmax(fabs(x[0]), fabs(x[1])) < sheet->flat * (1.0 - 1e-6);
    }
    depth.sure |= depth.least >= 0.0;
    return depth;
}

enum { SAMPLES = 9, SAMPLES_FINE = 129 };

static struct depth sampled_depth(const struct sheet *sheet, const struct ends3 *at, int side, int samples)
{
    struct depth depth = { .least = HUGE_VAL, .sure = 1 };
    int borders[SAMPLES_FINE], least = 0;
    depth.spread = apart(at->end[0], at->end[1]) / (samples - 1);
    for (int i = 0; i < samples; i++) {
        double x[3], n[3], s = (double)i / (samples - 1);
        axis_point(x, at, s);
        double height = side * height_of(sheet, x, n, &borders[i]);
        height = borders[i] ? fabs(height) : height;
        if (height < depth.least) {
            depth.least = height;
            depth.s = s;
            least = i;
            for (int k = 0; k < 3; k++)
                depth.out[k] = side * n[k];
        }
    }
    for (int i = least - 1; i <= least + 1; i++)
        depth.sure &= i < 0 || i >= samples || !borders[i];
    return depth;
}

static struct depth depth_of(const struct sheet *sheet, const struct ends3 *at, int side)
{
    return sheet->flat > 0.0 ? flat_depth(sheet, at, side) : sampled_depth(sheet, at, side, SAMPLES);
}

int side_of(const struct ride *ride, const struct state *now, const struct truth *axis)
{
    const struct sheet *sheet = ride->scene->sheet;
    struct ends3 at = ends_between(&ride->previous, now, axis->clear);
    double x[3], n[3];
    int border;
    /* A touch on the border tells no side, and a touch may be told that is as near as the tolerance. */
    double tolerance = 1e-6 * sheet->diagonal;
    struct truth early = truth_of(sheet, &ride->previous, now, fmin(tolerance, ride->previous_distance));
    struct ends3 then = ends_between(&ride->previous, now, early.clear);
    if (!axis->sure || border_distance(sheet, &at) < 3.0 * tolerance || border_distance(sheet, &then) < 3.0 * tolerance)
        return 0;
    axis_point(x, &at, axis->s);
    double height = height_of(sheet, x, n, &border);
    if (border || fabs(height) > 1e-5 * sheet->diagonal || height == 0.0 || sheet->info.components > 1)
        return 0;
    at = ends_between(&ride->previous, now, 0.0);
    struct depth depth = depth_of(sheet, &at, height < 0.0 ? -1 : 1);
    return depth.least < -1e-6 * sheet->diagonal ? 0 : height < 0.0 ? -1 : 1;
}

/* An axis that is behind by -least: gap, force and normals. `depth` and `at` are of this tick. */
static void check_behind(struct ride *ride, const struct state *now, const struct tick_answer *answer,
                         const struct depth *depth, const struct ends3 *at, double tolerance)
{
    const struct scene *scene = ride->scene;
    const struct sheet *sheet = scene->sheet;
    const dpt_hit *hit = &answer->hit;
    struct sums *sums = ride->sums;
    const double radius = now->radius, least = depth->least;
    sums->behind++;
    double off = fmax(hit->gap - (least - radius), least - depth->spread - radius - hit->gap);
    CHECK(hit->contact == DPT_CONTACT_PENETRATING && off <= tolerance,
          "%s: behind by %g, radius %g, contact %u, gap %g, sweep %u, %g before, side %d%s", sheet->name, -least,
          radius, hit->contact, hit->gap, answer->sweep.status, ride->previous_distance, ride->side,
          motion_text(&ride->previous, now));
    sums->worst_gap = fmax(sums->worst_gap, off / tolerance);
    double out[3], force = length3(answer->wrench.force);
    const double stiffness = scene->def.stiffness, whole = stiffness * hit->depth;
    turn3(now->body.orientation, depth->out, out);
    double cosine = force > 0.0 ? dot3(out, answer->wrench.force) / force : 1.0;
    /* So far a border takes nothing from any point's depth-> */
    const int away = border_distance(sheet, at) > 2.0 * -least + 1.25 * radius + tolerance;
    /*
     * Where it is curved, the deepest sample and the deepest point may differ; near a border the push is at another
     * point.
     */
    double least_cosine = sheet->flat > 0.0 ? 0.999999 : depth->spread == 0.0 && away ? 0.5 : -1.1;
    sums->away += (unsigned long)away;
    CHECK(cosine > least_cosine, "%s: force %g, cosine %g%s", sheet->name, force, cosine,
          motion_text(&ride->previous, now));
    CHECK(away ? fabs(force - whole) <= 1e-9 * force : force <= whole + stiffness * 2.0 * tolerance,
          "%s: force %g, depth %g, away %d%s", sheet->name, force, hit->depth, away, motion_text(&ride->previous, now));
    for (uint32_t i = 0; i < answer->contacts && i < COUNT(answer->contact) && sheet->flat > 0.0; i++) {
        const dpt_contact *c = &answer->contact[i];
        double q[3];
        pose_local(&now->body, c->q, q);
        int inner = fmax(fabs(q[0]), fabs(q[1])) < sheet->flat * (1.0 - 1e-6);
        CHECK(!inner || c->gap > -radius || dot3(out, c->normal) > 0.999999, "%s: normal %g%s", sheet->name,
              dot3(out, c->normal), motion_text(&ride->previous, now));
    }
}

void check_contact(struct ride *ride, const struct state *now, const struct tick_answer *answer,
                   const struct close *close)
{
    const struct scene *scene = ride->scene;
    const struct sheet *sheet = scene->sheet;
    const dpt_hit *hit = &answer->hit;
    struct sums *sums = ride->sums;
    double radius = now->radius, small = 2e-9 * sheet->diagonal + 1e-12 * length3(hit->p);
    sums->unknown += hit->contact == DPT_CONTACT_UNKNOWN;
    if (ride->knowledge == SIDE_LOST || ride->knowledge == SIDE_UNKNOWN) {
        sums->doubtful++;
        return;
    }
    if (ride->knowledge == UNCROSSED) {
        if (close->distance == 0.0)
            return;
        sums->clean++;
        CHECK(hit->contact != DPT_CONTACT_UNKNOWN && hit->gap >= close->distance - radius - small &&
                  hit->gap <= close->distance - radius + small,
              "%s: did not cross, contact %u, gap %g, distance %g, radius %g, sweep %u%s", sheet->name, hit->contact,
              hit->gap, close->distance, radius, answer->sweep.status, motion_text(&ride->previous, now));
        return;
    }
    struct ends3 at = ends_between(now, now, 0.0);
    struct depth depth = depth_of(sheet, &at, ride->side);
    double least = fmin(depth.least, HUGE_VAL), tolerance = 1e-5 * sheet->diagonal + small;
    sums->sided++;
    if (!depth.sure) {
        ride->knowledge = SIDE_UNKNOWN;
        sums->lost++;
        return;
    }
    if (radius - least > 0.99 * side_limit(scene) - depth.spread) {
        ride->knowledge = radius - least > 1.01 * side_limit(scene) + depth.spread ? SIDE_LOST : SIDE_UNKNOWN;
        sums->lost++;
        return;
    }
    if (least > depth.spread + tolerance && close->distance > 0.0) {
        sums->turned_back++;
        CHECK(fabs(hit->gap - (close->distance - radius)) <= small,
              "%s: back in front, gap %g, distance %g, radius %g, sweep %u, side %d%s", sheet->name, hit->gap,
              close->distance, radius, answer->sweep.status, ride->side, motion_text(&ride->previous, now));
        ride->knowledge = UNCROSSED;
        return;
    }
    if (least > -depth.spread - tolerance) {
        /*
         * In front, if by little, or beyond the border: what lies between two samples and is behind without a crossing
         * would have a border on either side.
         */
        if (least > -depth.spread && depth.spread > 0.0)
            least = sampled_depth(sheet, &at, ride->side, SAMPLES_FINE).least;
        if (least > 0.0 && close->distance > 0.0)
            ride->knowledge = UNCROSSED;
        return;
    }
    check_behind(ride, now, answer, &depth, &at, tolerance);
}

int goes_through(const struct sheet *sheet, const struct ends3 *at, double s)
{
    double length = apart(at->end[0], at->end[1]), by = 1e-5 * sheet->diagonal;
    double height[2];
    for (int k = 0; k < 2; k++) {
        double x[3], n[3], beside = s + (k ? by : -by) / length;
        int border;
        if (!(beside >= 0.0 && beside <= 1.0))
            return 1;
        axis_point(x, at, beside);
        height[k] = height_of(sheet, x, n, &border);
    }
    return height[0] * height[1] <= 0.0;
}

uint32_t ride_tick(struct ride *ride, const struct state *now, int teleport, double planned)
{
    struct tick_answer answer;
    struct scene *scene = ride->scene;
    const struct sheet *sheet = scene->sheet;
    scene_place(scene, now, teleport);
    scene_tick(scene, &answer);
    ride->sums->ticks++;
    ride->started &= !teleport;
    if (!ride->started)
        ride->previous = *now;
    struct ends3 at = ends_between(now, now, 0.0);
    struct close close = closest_of_all(sheet, &at);
    CHECK(answer.hit.status == DPT_STATUS_EXACT &&
              fabs(answer.hit.distance - close.distance) <= answer.hit.error_bound + 1e-15,
          "%s: distance %.17g, not %.17g", sheet->name, answer.hit.distance, close.distance);
    struct truth axis = check_sweep(ride, now, &answer.sweep, planned);
    if (ride->knowledge == SIDE_LOST)
        ride->knowledge = close.distance > 0.0 ? UNCROSSED : SIDE_UNKNOWN;
    if (!ride->started)
        ride->knowledge = close.distance > 0.0 ? UNCROSSED : SIDE_UNKNOWN;
    else if (ride->previous_distance == 0.0)
        ride->knowledge = ride->knowledge == UNCROSSED ? SIDE_UNKNOWN : ride->knowledge;
    else if (axis.met == TRUTH_NEAR || axis.met == TRUTH_UNDECIDED)
        ride->knowledge = SIDE_UNKNOWN;
    else if (axis.met == TRUTH_MET && ride->knowledge == UNCROSSED) {
        ride->side = side_of(ride, now, &axis);
        ride->knowledge = ride->side ? CROSSED : SIDE_UNKNOWN;
    }
    if (!ride->started && close.distance == 0.0 && goes_through(sheet, &at, close.s))
        CHECK(answer.hit.distance > 0.0 || answer.hit.contact == DPT_CONTACT_UNKNOWN || !sheet->info.open_edges,
              "%s: contact %u of a first tick that crosses", sheet->name, answer.hit.contact);
    struct ends3 touch = ends_between(&ride->previous, now, answer.sweep.time);
    if (ride->knowledge == UNCROSSED && answer.sweep.status == DPT_SWEEP_HIT &&
        border_distance(sheet, &touch) < 3e-6 * sheet->diagonal)
        ride->knowledge = SIDE_UNKNOWN; /* told within the tolerance of the border: past it, or through */
    check_contact(ride, now, &answer, &close);
    ride->previous = *now;
    ride->previous_distance = close.distance;
    ride->previous_error = answer.hit.error_bound;
    ride->reported_distance = answer.hit.distance;
    ride->started = 1;
    return answer.hit.contact;
}
