/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Open sheets, thin bodies and soups, through the world's calls: tools that go through at any speed, in any way, are
 * told, kept to their side and pushed back to it; those that do not go through are left alone.
 *
 * Usage: test_sheets [crossings = 100000] [seed = 1]. DPT_DATA names the folder of public meshes.
 */
#include "sheet_truth.h"

static unsigned long crossing_count = 100000;
static uint64_t rng = 1;

static int one_in(unsigned n)
{
    return random_bits(&rng) % n == 0;
}

static double power_in(double low, double high)
{
    return pow(10.0, random_in(&rng, low, high));
}

static void any_unit(double v[3])
{
    do
        for (int k = 0; k < 3; k++)
            v[k] = random_in(&rng, -1.0, 1.0);
    while (length3(v) > 1.0 || length3(v) < 0.1);
    unit3(v);
}

static void any_across(double v[3], const double of[3])
{
    double any[3];
    any_unit(any);
    cross3(v, of, any);
    unit3(v);
}

/* A world of one sheet and one tool. */
struct scene {
    struct sheet *sheet;
    void *block;
    dpt_world *world;
    dpt_world_def def;
    dpt_body body;
    dpt_tool tool;
};

/* `like`: the same as that but for the budget, or NULL. */
static int scene_begin(struct scene *scene, struct sheet *sheet, uint32_t budget,
                       const struct scene *like)
{
    const dpt_segment any = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 }, 0.0 };
    static const double margins[3] = { 0.0, 0.001, 0.005 };
    *scene = (struct scene){ .sheet = sheet };
    dpt_world_def *def = &scene->def;
    dpt_world_def_init(def);
    def->margin = margins[random_bits(&rng) % 3] * sheet->unit;
    def->side_limit = one_in(3) ? 0.02 * sheet->unit : 0.0;
    def->smooth_normals = (uint32_t)one_in(2);
    def->certificate_bytes = 1 << 16;
    if (like)
        *def = like->def;
    def->budget = budget;
    scene->block = malloc(dpt_world_bytes(def));
    int made = scene->block &&
               dpt_world_create(scene->block, dpt_world_bytes(def), def, &scene->world) == DPT_OK &&
               dpt_body_add(scene->world, sheet->fixture.mesh, NULL, &scene->body) == DPT_OK &&
               dpt_tool_add(scene->world, &any, 1, &scene->tool) == DPT_OK;
    CHECK(made, "no world");
    return made;
}

static double side_limit(const struct scene *scene)
{
    return scene->def.side_limit > 0.0 ? scene->def.side_limit : 0.25 * scene->sheet->diagonal;
}

/* A rigid tool is made anew where its segment is another one. */
static void place(struct scene *scene, const struct state *state, int teleport)
{
    dpt_segment segment = { .radius = state->radius };
    memcpy(segment.a, state->end[0], sizeof segment.a);
    memcpy(segment.b, state->end[1], sizeof segment.b);
    dpt_result result = dpt_body_set_pose(scene->world, scene->body, &state->body);
    CHECK(result == DPT_OK, "body: %s", dpt_result_name(result));
    if (teleport && !state->free) {
        dpt_tool_remove(scene->world, scene->tool);
        result = dpt_tool_add(scene->world, &segment, 1, &scene->tool);
        CHECK(result == DPT_OK, "tool: %s", dpt_result_name(result));
    }
    if (teleport)
        dpt_tool_teleport(scene->world, scene->tool, &state->tool);
    result = state->free ? dpt_tool_set_segments(scene->world, scene->tool, &segment, 1)
                         : dpt_tool_set_pose(scene->world, scene->tool, &state->tool);
    CHECK(result == DPT_OK, "move: %s", dpt_result_name(result));
}

/* All that a tick says. */
struct said {
    dpt_step step;
    dpt_hit hit;
    dpt_sweep sweep;
    dpt_wrench wrench;
    dpt_contact contact[8];
    uint32_t contacts;
};

static int finite3(const double v[3])
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

/* What holds of every answer, on every mesh. */
static void check_said(const char *name, const struct said *said)
{
    const dpt_hit *hit = &said->hit;
    const dpt_sweep *sweep = &said->sweep;
    const dpt_wrench *wrench = &said->wrench;
    CHECK(isfinite(hit->distance) && isfinite(hit->gap) && isfinite(hit->depth) &&
              isfinite(hit->s) && finite3(hit->p) && finite3(hit->q) &&
              isfinite(hit->error_bound) && isfinite(hit->lower_bound),
          "%s: not finite", name);
    CHECK(hit->status == DPT_STATUS_EXACT || hit->status == DPT_STATUS_BOUNDED, "%s: status %u",
          name, hit->status);
    CHECK(hit->contact <= DPT_CONTACT_PENETRATING, "%s: contact %u", name, hit->contact);
    CHECK((hit->contact != DPT_CONTACT_UNKNOWN) == ((hit->flags & DPT_HIT_GAP) != 0),
          "%s: contact %u, flags %u", name, hit->contact, hit->flags);
    CHECK(hit->depth == fmax(0.0, -hit->gap) || hit->contact == DPT_CONTACT_UNKNOWN,
          "%s: depth %g of gap %g", name, hit->depth, hit->gap);
    CHECK(hit->contact != DPT_CONTACT_PENETRATING || hit->gap < 0.0, "%s: gap %g", name, hit->gap);
    CHECK(finite3(wrench->force) && finite3(wrench->torque), "%s: wrench", name);
    int still = hit->contact == DPT_CONTACT_UNKNOWN || hit->contact == DPT_CONTACT_SEPARATED;
    CHECK(!still || (length3(wrench->force) == 0.0 && length3(wrench->torque) == 0.0),
          "%s: contact %u, force %g", name, hit->contact, length3(wrench->force));
    CHECK(isfinite(sweep->time) && sweep->time >= 0.0 && sweep->time <= 1.0 && isfinite(sweep->s) &&
              finite3(sweep->q) && finite3(sweep->normal),
          "%s: sweep", name);
    CHECK(sweep->status <= DPT_SWEEP_UNFINISHED, "%s: sweep %u", name, sweep->status);
    CHECK(sweep->status != DPT_SWEEP_UNFINISHED || hit->contact == DPT_CONTACT_UNKNOWN,
          "%s: unfinished, contact %u", name, hit->contact);
    for (uint32_t i = 0; i < said->contacts && i < COUNT(said->contact); i++) {
        const dpt_contact *c = &said->contact[i];
        double size = length3(c->normal);
        CHECK(isfinite(c->gap) && isfinite(c->overlap) && isfinite(c->moment) &&
                  finite3(c->thrust) && finite3(c->thrust_moment) && finite3(c->p) &&
                  finite3(c->q) && finite3(c->weight) && isfinite(size),
              "%s: region", name);
        CHECK(c->id && c->s0 >= 0.0 && c->s1 <= 1.0 && c->s0 <= c->s1 && c->s >= c->s0 - 1e-9 &&
                  c->s <= c->s1 + 1e-9,
              "%s: region %u from %g to %g at %g", name, c->id, c->s0, c->s1, c->s);
        CHECK(size == 0.0 || fabs(size - 1.0) < 1e-9, "%s: normal of %g", name, size);
    }
}

static void tick(struct scene *scene, struct said *said)
{
    said->step = (dpt_step){ .size = sizeof said->step };
    said->hit = (dpt_hit)DPT_HIT_INIT;
    said->sweep = (dpt_sweep){ .size = sizeof said->sweep };
    said->contact[0].size = sizeof said->contact[0];
    dpt_result result = dpt_world_step(scene->world, 0.001, &said->step);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    dpt_tool_get_hit(scene->world, scene->tool, &said->hit);
    dpt_tool_get_sweep(scene->world, scene->tool, 0, &said->sweep);
    dpt_tool_get_wrench(scene->world, scene->tool, &said->wrench);
    dpt_tool_get_contacts(scene->world, scene->tool, said->contact, COUNT(said->contact),
                          &said->contacts);
    check_said(scene->sheet->name, said);
}

/* As numbers to paste. */
static const char *text_of(const struct state *from, const struct state *to)
{
    static char text[2][1400];
    static int at;
    const struct state *both[2] = { from, to };
    size_t n = 0;
    char *out = text[at = !at];
    for (int i = 0; i < 2; i++) {
        const struct state *s = both[i];
        n += (size_t)snprintf(out + n, 1400 - n, "%s%s radius %.17g",
                              i ? "\n      to   " : "\n      from ", s->free ? "free" : "rigid",
                              s->radius);
        for (int e = 0; e < 2; e++)
            n += (size_t)snprintf(out + n, 1400 - n, " {%.17g,%.17g,%.17g}", s->end[e][0],
                                  s->end[e][1], s->end[e][2]);
        const dpt_pose *pose[2] = { &s->tool, &s->body };
        for (int k = 0; k < 2; k++)
            n += (size_t)snprintf(
                out + n, 1400 - n, " %s {%.17g,%.17g,%.17g}{%.17g,%.17g,%.17g,%.17g}",
                k ? "body" : "tool", pose[k]->position[0], pose[k]->position[1],
                pose[k]->position[2], pose[k]->orientation[0], pose[k]->orientation[1],
                pose[k]->orientation[2], pose[k]->orientation[3]);
    }
    return out;
}

/* Sums over all ticks of a sheet. */
struct sums {
    unsigned long ticks, swept, met, clear, near, undecided, planned, free_near, late;
    unsigned long clean, sided, behind, doubtful, turned_back, unknown, lost;
    double worst_off, worst_gap, worst_late;
};

/*
 * What is known of the axis since it was teleported. CLEAN: it has not gone through the sheet. SIDED: it has, coming
 * from `side`. LOST: the side is to be forgotten this tick. DOUBT: the truth cannot tell.
 */
enum { CLEAN, SIDED, LOST, DOUBT };

struct ride {
    struct scene *scene;
    struct sums *sums;
    struct state was;
    double was_distance, was_error, told; /* by the library */
    int knows;
    int side; /* in front, as the mesh is wound: +1 */
    int started;
};

static void normal_of(const double c[9], double n[3])
{
    double e[3], f[3];
    go(e, c + 3, -1.0, c);
    go(f, c + 6, -1.0, c);
    cross3(n, e, f);
    unit3(n);
}

/*
 * How far in front of its nearest point a point is, and whether that is on the border. Of the triangles that have the
 * nearest point the one decides that faces the point most; n is its normal.
 */
static double height_of(const struct sheet *sheet, const double x[3], double n[3], int *border)
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
        go(off, x, -1.0, here);
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

/* Told: near a touch, at a triangle and a point that are there, from the side that it came from. */
static void check_hit(struct ride *ride, const struct state *now, const dpt_sweep *sweep,
                      double radius)
{
    const struct sheet *sheet = ride->scene->sheet;
    struct ends3 at = ends_between(&ride->was, now, sweep->time);
    double *c = NULL, q[3], x[3], tolerance = 1.0001e-6 * sheet->diagonal;
    for (uint32_t t = 0; t < sheet->count && !c; t++)
        if (sheet->numbers[t] == sweep->triangle)
            c = sheet->corners + 9 * (size_t)t;
    CHECK(c != NULL, "%s: triangle %u", sheet->name, sweep->triangle);
    if (!c)
        return;
    /* Ten halvings of a turn are the most: docs/algorithms/travel.md. */
    double turn =
        (pose_angle(&ride->was.tool, &now->tool) + pose_angle(&ride->was.body, &now->body)) /
        1024.0;
    double speed = most_speed(&ride->was, now) / 1024.0;
    tolerance += turn > 0.0 ? 2.0 * turn * speed / 8.0 : 0.0;
    double off = to_triangle(&at, c, NULL, NULL) - radius;
    ride->sums->worst_off = fmax(ride->sums->worst_off, off / tolerance);
    CHECK(off <= tolerance, "%s: %.3g from a touch at %.17g%s", sheet->name, off, sweep->time,
          text_of(&ride->was, now));
    pose_undo(q, &now->body, sweep->q);
    double twice[6] = { q[0], q[1], q[2], q[0], q[1], q[2] };
    double size = length3(q) + sheet->diagonal + length3(now->body.position);
    CHECK(dpt_segment_triangle(twice, c, NULL, NULL, NULL) <= 1e-12 * size, "%s: q is not on it",
          sheet->name);
    point_at(x, &at, sweep->s);
    CHECK(apart(x, q) <= radius + tolerance, "%s: s is %g off%s", sheet->name, apart(x, q) - radius,
          text_of(&ride->was, now));
    CHECK(fabs(length3(sweep->normal) - 1.0) < 1e-9, "%s: normal", sheet->name);
    if (!sheet->info.open_edges || sheet->info.solid_components || sheet->info.nonmanifold_edges ||
        sheet->info.wrong_way_edges)
        return; /* no sides */
    double n[3], m[3];
    int border;
    at = ends_between(&ride->was, now, 0.0);
    point_at(x, &at, sweep->s);
    double height = height_of(sheet, x, n, &border);
    at = ends_between(&ride->was, now, fmax(0.0, sweep->time - 1e-3));
    point_at(x, &at, sweep->s);
    double short_before = height_of(sheet, x, n, &border);
    normal_of(c, n);
    quat_turn(m, now->body.orientation, 0, n);
    double side = dot3(sweep->normal, m);
    if (height * short_before > 0.0 && fabs(short_before) > 2.0 * tolerance && !border)
        CHECK(side * short_before > 0.0, "%s: normal %g, height before %g, %g%s", sheet->name, side,
              height, short_before, text_of(&ride->was, now));
}

/* The motion of this tick; the axis' own truth. */
static struct truth check_sweep(struct ride *ride, const struct state *now, const dpt_sweep *sweep,
                                double planned)
{
    struct sums *sums = ride->sums;
    const struct sheet *sheet = ride->scene->sheet;
    double radius = now->radius, small = 1e-8 * sheet->diagonal;
    struct truth none = { .met = TRUTH_UNDECIDED };
    if (ride->started && ride->was_distance > 0.0 && ride->was_distance <= ride->was_error)
        return none; /* whether it went through already is a matter of rounding */
    if (!ride->started || ride->was_distance == 0.0) {
        CHECK(sweep->status == DPT_SWEEP_NONE, "%s: sweep %u of no motion", sheet->name,
              sweep->status);
        return none;
    }
    sums->swept++;
    CHECK(sweep->status == DPT_SWEEP_FREE || sweep->status == DPT_SWEEP_HIT, "%s: sweep %u%s",
          sheet->name, sweep->status, text_of(&ride->was, now));
    int hit = sweep->status == DPT_SWEEP_HIT;
    if (planned >= 0.0) {
        sums->planned++;
        CHECK(hit && sweep->time <= planned + 1e-9,
              "%s: planned at %.17g, sweep %u at %.17g, distance %g%s", sheet->name, planned,
              sweep->status, sweep->time, ride->was_distance, text_of(&ride->was, now));
    }
    if (fabs(ride->was_distance - radius) <= small && radius > 0.0)
        return truth_of(sheet, &ride->was, now, 0.0); /* in contact before? A matter of rounding */
    double swept = ride->was_distance > radius ? radius : 0.0;
    struct truth truth = truth_of(sheet, &ride->was, now, swept), axis = truth;
    if (swept > 0.0 && truth.met != TRUTH_CLEAR)
        axis = truth_of(sheet, &ride->was, now, 0.0);
    sums->met += truth.met == TRUTH_MET;
    sums->clear += truth.met == TRUTH_CLEAR;
    sums->near += truth.met == TRUTH_NEAR;
    sums->undecided += truth.met == TRUTH_UNDECIDED;
    if (truth.met == TRUTH_MET) {
        CHECK(hit && sweep->time <= truth.by + 1e-9, "%s: met by %.17g, sweep %u at %.17g%s",
              sheet->name, truth.by, sweep->status, sweep->time, text_of(&ride->was, now));
        sums->worst_late = fmax(sums->worst_late, sweep->time - truth.by);
    }
    if (hit)
        check_hit(ride, now, sweep, swept);
    else
        CHECK(sweep->time == 1.0 && sweep->triangle == DPT_NONE, "%s: free, %g", sheet->name,
              sweep->time);
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
        point_at(x, at, s);
        if (side * x[2] >= depth.least)
            continue;
        depth.least = side * x[2];
        depth.s = s;
        depth.sure =
            (s == 0.0 || s == 1.0) && fmax(fabs(x[0]), fabs(x[1])) < sheet->flat * (1.0 - 1e-6);
    }
    depth.sure |= depth.least >= 0.0;
    return depth;
}

enum { SAMPLES = 9, SAMPLES_FINE = 129 };

static struct depth sampled_depth(const struct sheet *sheet, const struct ends3 *at, int side,
                                  int samples)
{
    struct depth depth = { .least = HUGE_VAL, .sure = 1 };
    int borders[SAMPLES_FINE], least = 0;
    depth.spread = apart(at->end[0], at->end[1]) / (samples - 1);
    for (int i = 0; i < samples; i++) {
        double x[3], n[3], s = (double)i / (samples - 1);
        point_at(x, at, s);
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
    return sheet->flat > 0.0 ? flat_depth(sheet, at, side)
                             : sampled_depth(sheet, at, side, SAMPLES);
}

/* Which side the axis came from, where it first goes through; 0 where it was on both, or that is not clear. */
static int side_of(const struct ride *ride, const struct state *now, const struct truth *axis)
{
    const struct sheet *sheet = ride->scene->sheet;
    struct ends3 at = ends_between(&ride->was, now, axis->clear);
    double x[3], n[3];
    int border;
    /* A touch on the border tells no side, and a touch may be told that is as near as the tolerance. */
    double tolerance = 1e-6 * sheet->diagonal;
    struct truth early = truth_of(sheet, &ride->was, now, fmin(tolerance, ride->was_distance));
    struct ends3 then = ends_between(&ride->was, now, early.clear);
    if (!axis->sure || border_distance(sheet, &at) < 3.0 * tolerance ||
        border_distance(sheet, &then) < 3.0 * tolerance)
        return 0;
    point_at(x, &at, axis->s);
    double height = height_of(sheet, x, n, &border);
    if (border || fabs(height) > 1e-5 * sheet->diagonal || height == 0.0 ||
        sheet->info.components > 1)
        return 0;
    at = ends_between(&ride->was, now, 0.0);
    struct depth depth = depth_of(sheet, &at, height < 0.0 ? -1 : 1);
    return depth.least < -1e-6 * sheet->diagonal ? 0 : height < 0.0 ? -1 : 1;
}

/* Gap, force and regions against what is known. */
static void check_contact(struct ride *ride, const struct state *now, const struct said *said,
                          const struct close *close)
{
    const struct scene *scene = ride->scene;
    const struct sheet *sheet = scene->sheet;
    const dpt_hit *hit = &said->hit;
    struct sums *sums = ride->sums;
    double radius = now->radius, small = 2e-9 * sheet->diagonal + 1e-12 * length3(hit->p);
    sums->unknown += hit->contact == DPT_CONTACT_UNKNOWN;
    if (ride->knows == LOST || ride->knows == DOUBT) {
        sums->doubtful++;
        return;
    }
    if (ride->knows == CLEAN) {
        if (close->distance == 0.0)
            return;
        sums->clean++;
        CHECK(hit->contact != DPT_CONTACT_UNKNOWN && hit->gap >= close->distance - radius - small &&
                  hit->gap <= close->distance - radius + small,
              "%s: did not cross, contact %u, gap %g, distance %g, radius %g, sweep %u%s",
              sheet->name, hit->contact, hit->gap, close->distance, radius, said->sweep.status,
              text_of(&ride->was, now));
        return;
    }
    struct ends3 at = ends_between(now, now, 0.0);
    struct depth depth = depth_of(sheet, &at, ride->side);
    double least = fmin(depth.least, HUGE_VAL), tolerance = 1e-5 * sheet->diagonal + small;
    sums->sided++;
    if (!depth.sure) {
        ride->knows = DOUBT;
        sums->lost++;
        return;
    }
    if (radius - least > 0.99 * side_limit(scene) - depth.spread) {
        ride->knows = radius - least > 1.01 * side_limit(scene) + depth.spread ? LOST : DOUBT;
        sums->lost++;
        return;
    }
    if (least > depth.spread + tolerance && close->distance > 0.0) {
        sums->turned_back++;
        CHECK(fabs(hit->gap - (close->distance - radius)) <= small,
              "%s: back in front, gap %g, distance %g, radius %g, sweep %u, side %d%s", sheet->name,
              hit->gap, close->distance, radius, said->sweep.status, ride->side,
              text_of(&ride->was, now));
        ride->knows = CLEAN;
        return;
    }
    if (least > -depth.spread - tolerance) {
        /*
         * In front, if by little, or beyond the border: what lies between two samples and is behind without a crossing would
         * have a border on either side.
         */
        if (least > -depth.spread && depth.spread > 0.0)
            least = sampled_depth(sheet, &at, ride->side, SAMPLES_FINE).least;
        if (least > 0.0 && close->distance > 0.0)
            ride->knows = CLEAN;
        return;
    }
    sums->behind++;
    double off = fmax(hit->gap - (least - radius), least - depth.spread - radius - hit->gap);
    CHECK(hit->contact == DPT_CONTACT_PENETRATING && off <= tolerance,
          "%s: behind by %g, radius %g, contact %u, gap %g, sweep %u, %g before, side %d%s",
          sheet->name, -least, radius, hit->contact, hit->gap, said->sweep.status,
          ride->was_distance, ride->side, text_of(&ride->was, now));
    sums->worst_gap = fmax(sums->worst_gap, off / tolerance);
    double out[3], force = length3(said->wrench.force);
    quat_turn(out, now->body.orientation, 0, depth.out);
    double cosine = dot3(out, said->wrench.force) / force;
    /* Where it is curved, the deepest sample and the deepest point may differ. */
    double least_cosine = sheet->flat > 0.0 ? 0.999999 : depth.spread == 0.0 ? 0.5 : -1.1;
    CHECK(cosine > least_cosine, "%s: force %g, cosine %g%s", sheet->name, force, cosine,
          text_of(&ride->was, now));
    CHECK(fabs(force - scene->def.stiffness * hit->depth) <= 1e-9 * force, "%s: force %g, depth %g",
          sheet->name, force, hit->depth);
    for (uint32_t i = 0; i < said->contacts && i < COUNT(said->contact) && sheet->flat > 0.0; i++) {
        const dpt_contact *c = &said->contact[i];
        double q[3];
        pose_undo(q, &now->body, c->q);
        int inner = fmax(fabs(q[0]), fabs(q[1])) < sheet->flat * (1.0 - 1e-6);
        CHECK(!inner || c->gap > -radius || dot3(out, c->normal) > 0.999999, "%s: normal %g%s",
              sheet->name, dot3(out, c->normal), text_of(&ride->was, now));
    }
}

/* An axis that meets the sheet at s is on different sides of it before and after, or on a border, or ends there. */
static int goes_through(const struct sheet *sheet, const struct ends3 *at, double s)
{
    double length = apart(at->end[0], at->end[1]), by = 1e-5 * sheet->diagonal;
    double height[2];
    for (int k = 0; k < 2; k++) {
        double x[3], n[3], beside = s + (k ? by : -by) / length;
        int border;
        if (!(beside >= 0.0 && beside <= 1.0))
            return 1;
        point_at(x, at, beside);
        height[k] = height_of(sheet, x, n, &border);
        if (border)
            return 1;
    }
    return height[0] * height[1] <= 0.0;
}

/* One tick, and all that must be true of it. `planned`: of a crossing, or -1. Returns the contact. */
static uint32_t ride_tick(struct ride *ride, const struct state *now, int teleport, double planned)
{
    struct said said;
    struct scene *scene = ride->scene;
    const struct sheet *sheet = scene->sheet;
    place(scene, now, teleport);
    tick(scene, &said);
    ride->sums->ticks++;
    ride->started &= !teleport;
    if (!ride->started)
        ride->was = *now;
    struct ends3 at = ends_between(now, now, 0.0);
    struct close close = closest_of_all(sheet, &at);
    CHECK(said.hit.status == DPT_STATUS_EXACT &&
              fabs(said.hit.distance - close.distance) <= said.hit.error_bound + 1e-15,
          "%s: distance %.17g, not %.17g", sheet->name, said.hit.distance, close.distance);
    struct truth axis = check_sweep(ride, now, &said.sweep, planned);
    if (ride->knows == LOST)
        ride->knows = close.distance > 0.0 ? CLEAN : DOUBT;
    if (!ride->started)
        ride->knows = close.distance > 0.0 ? CLEAN : DOUBT;
    else if (ride->was_distance == 0.0)
        ride->knows = ride->knows == CLEAN ? DOUBT : ride->knows;
    else if (axis.met == TRUTH_NEAR || axis.met == TRUTH_UNDECIDED)
        ride->knows = DOUBT;
    else if (axis.met == TRUTH_MET && ride->knows == CLEAN) {
        ride->side = side_of(ride, now, &axis);
        ride->knows = ride->side ? SIDED : DOUBT;
    }
    if (!ride->started && close.distance == 0.0 && goes_through(sheet, &at, close.s))
        CHECK(said.hit.distance > 0.0 || said.hit.contact == DPT_CONTACT_UNKNOWN ||
                  !sheet->info.open_edges,
              "%s: contact %u of a first tick that crosses", sheet->name, said.hit.contact);
    struct ends3 touch = ends_between(&ride->was, now, said.sweep.time);
    if (ride->knows == CLEAN && said.sweep.status == DPT_SWEEP_HIT &&
        border_distance(sheet, &touch) < 3e-6 * sheet->diagonal)
        ride->knows = DOUBT; /* told within the tolerance of the border: past it, or through */
    check_contact(ride, now, &said, &close);
    ride->was = *now;
    ride->was_distance = close.distance;
    ride->was_error = said.hit.error_bound;
    ride->told = said.hit.distance;
    ride->started = 1;
    return said.hit.contact;
}

/*
 * A flight: a tool and a body, each at an even pace, that meet at the time `star`: the point `share` of the axis and
 * the target on the mesh.
 */
struct flight {
    int free;
    double end[2][3],
        rate[2][3];      /* of a free tool at the star, in the world; else in its frame, at rest */
    dpt_pose tool, body; /* at the star */
    double tool_pace[3], body_pace[3], tool_axis[3], body_axis[3], tool_turn, body_turn;
    double radius, star;
};

static dpt_pose pose_moved(const dpt_pose *pose, const double pace[3], const double axis[3],
                           double turn, double t)
{
    dpt_pose moved;
    double by[4];
    go(moved.position, pose->position, t, pace);
    quat_about(by, axis, turn * t);
    quat_times(moved.orientation, by, pose->orientation);
    return moved;
}

static struct state flight_at(const struct flight *flight, double time)
{
    double t = time - flight->star;
    struct state at = { .free = flight->free, .radius = flight->radius };
    at.tool = pose_moved(&flight->tool, flight->tool_pace, flight->tool_axis, flight->tool_turn, t);
    at.body = pose_moved(&flight->body, flight->body_pace, flight->body_axis, flight->body_turn, t);
    for (int e = 0; e < 2; e++)
        go(at.end[e], flight->end[e], flight->free ? t : 0.0, flight->rate[e]);
    return at;
}

/* The velocity of a frame's origin with which the point x, off it by `arm`, goes at `pace`. */
static void pace_of_origin(double out[3], const double pace[3], const double axis[3], double turn,
                           const double arm[3])
{
    double around[3];
    cross3(around, axis, arm);
    go(out, pace, -turn, around);
}

static double any_turn(double length)
{
    if (one_in(8))
        return random_in(&rng, -3.0, 3.0);
    return one_in(2) ? 0.0 : random_in(&rng, -1.0, 1.0) * 0.02 / fmax(length, 0.02);
}

/* A point of the mesh: in a face, on an edge, a vertex; or beside. Returns 1 where it is on the mesh. */
static int any_target(const struct sheet *sheet, double target[3], double normal[3])
{
    const double *c = sheet->corners + 9 * (size_t)(random_bits(&rng) % sheet->count);
    double u = random_in(&rng, 0.0, 1.0), v = random_in(&rng, 0.0, 1.0 - u), off[3];
    int where = (int)(random_bits(&rng) % 8);
    if (where == 0)
        u = v = 0.0;
    else if (where == 1)
        v = 0.0;
    for (int k = 0; k < 3; k++)
        target[k] = where == 0 ? c[k] : (1.0 - u - v) * c[k] + u * c[3 + k] + v * c[6 + k];
    normal_of(c, normal);
    if (where != 2)
        return 1;
    any_unit(off); /* beside, and over the border where that is near */
    if (sheet->borders) {
        const double *edge = sheet->border + 9 * (size_t)(random_bits(&rng) % sheet->borders);
        for (int k = 0; k < 3; k++)
            target[k] = edge[k] + u * (edge[3 + k] - edge[k]);
        go(target, target, power_in(-5.0, -1.0) * sheet->unit, off);
    }
    return sheet->borders == 0;
}

/* Direction of the tool: across the sheet, nearly in it, along its own motion, sideways, any. */
static void any_direction(double u[3], const double normal[3], const double way[3])
{
    double across[3];
    any_across(across, normal);
    switch (random_bits(&rng) % 5) {
    case 0:
        memcpy(u, normal, 3 * sizeof *u);
        break;
    case 1:
        go(u, across, random_in(&rng, -1.0, 1.0) * power_in(-7.0, -1.0), normal);
        break;
    case 2:
        memcpy(u, way, 3 * sizeof *u);
        break;
    case 3:
        cross3(u, normal, way);
        break;
    default:
        any_unit(u);
    }
    unit3(u);
}

/* Returns 1 where a crossing at the star is certain, if the tool gets so far. */
static int any_flight(const struct sheet *sheet, struct flight *f)
{
    double target[3], normal[3], way[3], u[3], world[3], arm[3],
        share = one_in(2) ? one_in(2) : 0.5;
    int on = any_target(sheet, target, normal);
    memset(f, 0, sizeof *f);
    f->star = (double)(random_bits(&rng) % 3) + random_in(&rng, 0.001, 0.999);
    f->tool.orientation[0] = f->body.orientation[0] = 1.0;
    any_unit(way);
    if (one_in(3)) { /* almost in the sheet */
        double rise = dot3(way, normal);
        go(way, way, -rise * (1.0 - power_in(-4.0, 0.0)), normal);
        unit3(way);
    } else if (one_in(3)) {
        memcpy(way, normal, sizeof way);
    }
    any_direction(u, normal, way);
    double pace = 0.02 * power_in(-3.3, 0.0) * sheet->unit, ahead = one_in(2) ? -1.0 : 1.0;
    double length = one_in(8) ? 0.0 : power_in(-3.0, -0.30103) * sheet->unit;
    for (int k = 0; k < 3; k++)
        way[k] *= pace * ahead;
    if (one_in(3))
        share = random_in(&rng, 0.0, 1.0);
    else if (share != 0.5) /* the rest of it stays behind */
        share = dot3(u, normal) * dot3(way, normal) > 0.0 ? 1.0 : 0.0;
    f->radius = one_in(2) ? 0.0 : power_in(-4.0, -2.0) * sheet->unit;
    int mode = (int)(random_bits(&rng) % 6); /* who moves: free, free, rigid, body, both, both */
    f->free = mode < 2 || (mode >= 3 && one_in(2));
    int body_moves = mode >= 3, tool_moves = mode != 3;
    memcpy(world, target, sizeof world);
    if (body_moves) {
        double axis[3], rest[3] = { 0.0, 0.0, 0.0 };
        any_unit(axis);
        any_unit(f->body_axis);
        any_unit(f->body.position);
        quat_about(f->body.orientation, axis, random_in(&rng, -3.0, 3.0));
        for (int k = 0; k < 3; k++) {
            f->body.position[k] *= 0.3 * sheet->unit;
            rest[k] = -way[k];
        }
        quat_turn(arm, f->body.orientation, 0, target);
        quat_turn(rest, f->body.orientation, 0, rest);
        f->body_turn = any_turn(length3(arm) / sheet->unit);
        pace_of_origin(f->body_pace, rest, f->body_axis, f->body_turn, arm);
        pose_apply(world, &f->body, target);
        quat_turn(u, f->body.orientation, 0, u);
        quat_turn(way, f->body.orientation, 0, way);
    }
    if (!tool_moves || mode >= 4)
        for (int k = 0; k < 3; k++)
            way[k] *= tool_moves ? random_in(&rng, -0.5, 1.0) : 0.0;
    if (f->free) {
        double bend[3];
        any_unit(bend);
        double by = tool_moves && one_in(2) ? 0.02 * sheet->unit * power_in(-3.0, 0.0) : 0.0;
        for (int e = 0; e < 2; e++) {
            go(f->end[e], world, (e - share) * length, u);
            go(f->rate[e], way, (e - share) * by, bend);
        }
        return on;
    }
    double axis[3], spot[3];
    any_unit(axis);
    any_unit(f->tool_axis);
    any_unit(arm);
    quat_about(f->tool.orientation, axis, random_in(&rng, -3.0, 3.0));
    double reach = one_in(2) ? 0.0 : 0.1 * sheet->unit;
    quat_turn(u, f->tool.orientation, 1, u);
    for (int k = 0; k < 3; k++)
        spot[k] = reach * arm[k] + (one_in(2) ? 0.0 : share * length * u[k]);
    for (int e = 0; e < 2; e++)
        go(f->end[e], spot, (e - share) * length, u);
    quat_turn(arm, f->tool.orientation, 0, spot);
    go(f->tool.position, world, -1.0, arm);
    f->tool_turn = tool_moves ? any_turn(length / sheet->unit) : 0.0;
    pace_of_origin(f->tool_pace, way, f->tool_axis, f->tool_turn, arm);
    return on;
}

/* Takes a flight to its end, on, and sometimes back; returns 1 if it began free. */
static int fly(struct scene *scene, struct sums *sums)
{
    struct flight flight;
    struct ride ride = { .scene = scene, .sums = sums };
    int on = any_flight(scene->sheet, &flight), at = 0;
    struct state now = flight_at(&flight, 0.0);
    struct ends3 ends = ends_between(&now, &now, 0.0);
    struct close close = closest_of_all(scene->sheet, &ends);
    if (close.distance <= now.radius + 1e-9 * scene->sheet->diagonal && !one_in(20))
        return 0;
    int began = close.distance > 0.0;
    uint32_t contact = ride_tick(&ride, &now, 1, -1.0);
    int last = (int)flight.star + 1 + (int)(random_bits(&rng) % 5), back = one_in(2);
    while (at < last) {
        now = flight_at(&flight, ++at);
        int here = on && at == (int)flight.star + 1 && ride.was_distance > 0.0;
        contact = ride_tick(&ride, &now, 0, here ? flight.star - (at - 1) : -1.0);
    }
    if (one_in(8)) { /* all is forgotten */
        ride_tick(&ride, &now, 1, -1.0);
        if (ride.was_distance == 0.0 && at) { /* and not known until it was free */
            now = flight_at(&flight, --at);
            contact = ride_tick(&ride, &now, 0, -1.0);
            ends = ends_between(&now, &now, 0.0);
            close = closest_of_all(scene->sheet, &ends);
            CHECK(ride.told > 0.0 || contact == DPT_CONTACT_UNKNOWN ||
                      !scene->sheet->info.open_edges || !goes_through(scene->sheet, &ends, close.s),
                  "%s: contact %u", scene->sheet->name, contact);
        }
    }
    while (back && at > 0) {
        now = flight_at(&flight, --at);
        ride_tick(&ride, &now, 0, -1.0);
    }
    return began;
}

static void print_sums(const struct sheet *sheet, const struct sums *s)
{
    printf("    %-22s %7lu ticks: swept %lu, met %lu (planned %lu), clear %lu, near %lu, undecided "
           "%lu\n"
           "      gap: did not cross %lu, behind %lu, back %lu, side lost %lu, not judged %lu, "
           "unknown %lu; "
           "worst touch %.3f, gap %.3f of the tolerance, %.1e late\n",
           sheet->name, s->ticks, s->swept, s->met, s->planned, s->clear, s->near, s->undecided,
           s->clean, s->behind, s->turned_back, s->lost, s->doubtful, s->unknown, s->worst_off,
           s->worst_gap, s->worst_late);
}

static void fly_through(struct sheet *sheet, unsigned long crossings)
{
    struct sums sums = { .worst_off = -HUGE_VAL, .worst_late = -HUGE_VAL };
    unsigned long tries = 0;
    struct scene scene = { NULL };
    while (sums.planned < crossings && tries < 20 * crossings + 1000) {
        if (tries++ % 1000 == 0) {
            free(scene.block);
            if (!scene_begin(&scene, sheet, 0, NULL))
                break;
        }
        fly(&scene, &sums);
    }
    free(scene.block);
    print_sums(sheet, &sums);
    CHECK(sums.planned >= crossings, "%s: %lu crossings", sheet->name, sums.planned);
}

static int sheet_from_shape(struct sheet *sheet, const char *name, uint32_t count, double flat)
{
    memset(sheet, 0, sizeof *sheet);
    sheet->flat = flat;
    return fixture_from_shape(&sheet->fixture, name, count) && sheet_of(sheet, name);
}

/* A square of 0.3 m, bent to a bowl, or with a square hole in the middle. */
static int sheet_from_grid(struct sheet *sheet, const char *name, double bend, int hole)
{
    enum { N = 16 };
    static double vertices[3 * (N + 1) * (N + 1)];
    static uint32_t corners[6 * N * N];
    size_t count = 0;
    memset(sheet, 0, sizeof *sheet);
    for (int i = 0; i <= N; i++)
        for (int k = 0; k <= N; k++) {
            double *v = vertices + 3 * (i * (N + 1) + k);
            v[0] = 0.3 * ((double)i / N - 0.5);
            v[1] = 0.3 * ((double)k / N - 0.5);
            v[2] = bend * (v[0] * v[0] + v[1] * v[1]);
        }
    for (uint32_t i = 0; i < N; i++)
        for (uint32_t k = 0; k < N; k++) {
            uint32_t a = i * (N + 1) + k, b = a + N + 1;
            const uint32_t two[6] = { a, b, b + 1, a, b + 1, a + 1 };
            if (hole && i >= N / 2 - 1 && i <= N / 2 && k >= N / 2 - 1 && k <= N / 2)
                continue;
            memcpy(corners + 3 * count, two, sizeof two);
            count += 2;
        }
    return fixture_from_arrays(&sheet->fixture, vertices, COUNT(vertices) / 3, corners, count) &&
           sheet_of(sheet, name);
}

/*
 * The flat square once more, a tick each, with its truth in closed form: an end that comes to z = 0, or to the radius,
 * over the square, while no other point can have met anything.
 */
static void flat_crossing(struct ride *ride, double *late)
{
    struct scene *scene = ride->scene;
    const struct sheet *sheet = scene->sheet;
    const double normal[3] = { 0.0, 0.0, 1.0 };
    double way[3], u[3],
        x[3] = { random_in(&rng, -0.099, 0.099), random_in(&rng, -0.099, 0.099), 0.0 };
    double length = one_in(8) ? 0.0 : power_in(-3.0, -0.30103), side = one_in(2) ? 1.0 : -1.0;
    double radius = one_in(2) ? 0.0 : power_in(-4.0, -2.0), star = random_in(&rng, 1e-3, 1.0);
    double pace = 0.02 * power_in(-3.3, 0.0), bend[3];
    struct state from = { .free = 1, .tool = DPT_POSE_IDENTITY, .body = DPT_POSE_IDENTITY }, to;
    any_unit(way);
    way[2] *= one_in(3) ? power_in(-3.0, 0.0) : 1.0;
    unit3(way);
    any_direction(u, normal, way);
    /* It begins free: what is nearer than rounding touches already. */
    way[2] = -side * fmax(fabs(way[2]) * pace, 1e-10 / star);
    way[0] *= pace;
    way[1] *= pace;
    u[2] = side * fabs(u[2]);
    int crosses = !one_in(4), e = one_in(2);
    x[2] = side * radius; /* where the lower end's axis is at the star */
    if (!crosses)
        x[2] += side * (fabs(way[2]) * (1.0 - star) + 2e-6 * sheet->diagonal);
    from.radius = radius;
    go(from.end[e], x, -star, way);
    go(from.end[!e], from.end[e], length, u);
    to = from;
    go(to.end[e], from.end[e], 1.0, way);
    go(to.end[!e], from.end[!e], 1.0, way);
    if (one_in(2)) { /* the other end turns away */
        any_unit(bend);
        bend[2] = side * fabs(bend[2]);
        go(to.end[!e], to.end[!e], pace, bend);
    }
    struct said said;
    place(scene, &from, 1);
    tick(scene, &said);
    CHECK(said.sweep.status == DPT_SWEEP_NONE && said.hit.contact == DPT_CONTACT_SEPARATED,
          "a first tick: sweep %u, contact %u%s", said.sweep.status, said.hit.contact,
          text_of(&from, &from));
    place(scene, &to, 0);
    tick(scene, &said);
    ride->was = from;
    ride->was_distance = 1.0;
    ride->side = (int)side;
    ride->knows = crosses && to.end[e][2] * side < 0.0 ? SIDED : CLEAN;
    ride->sums->ticks++;
    struct close close = { .distance = said.hit.distance };
    int hit = said.sweep.status == DPT_SWEEP_HIT;
    double slow = fabs(to.end[e][2] - from.end[e][2]);
    struct ends3 at = ends_between(&from, &to, fmin(1.0, star + radius / slow));
    if (!crosses) {
        CHECK(said.sweep.status == DPT_SWEEP_FREE && said.sweep.time == 1.0,
              "invented: %u at %.17g%s", said.sweep.status, said.sweep.time, text_of(&from, &to));
    } else {
        double early = 1.0001e-6 * sheet->diagonal / fabs(way[2]);
        ride->sums->met++;
        CHECK(hit && said.sweep.time <= star + 1e-9 && said.sweep.time >= star - early - 1e-9,
              "met at %.17g: sweep %u at %.17g%s", star, said.sweep.status, said.sweep.time,
              text_of(&from, &to));
        CHECK(!hit || side * said.sweep.normal[2] > 0.999999, "normal %g%s", said.sweep.normal[2],
              text_of(&from, &to));
        *late = fmax(*late, said.sweep.time - star);
    }
    /* Where the axis comes through at the border it tells no side. */
    struct ends3 early = ends_between(&from, &to, said.sweep.time);
    if (ride->knows == CLEAN ||
        fmin(border_distance(sheet, &at), border_distance(sheet, &early)) > 3e-6 * sheet->diagonal)
        check_contact(ride, &to, &said, &close);
}

/* An axis alone, from a first tick on. */
static uint32_t first_contact(struct sheet *sheet, const struct state *state)
{
    struct scene scene;
    struct said said = { .hit.contact = UINT32_MAX };
    if (scene_begin(&scene, sheet, 0, NULL)) {
        place(&scene, state, 1);
        tick(&scene, &said);
        CHECK(said.hit.contact == DPT_CONTACT_UNKNOWN || fabs(said.hit.gap) <= said.hit.error_bound,
              "%s: gap %g", sheet->name, said.hit.gap);
    }
    free(scene.block);
    return said.hit.contact;
}

/* An axis that comes to a vertex or an edge, and stays on its side of the sheet, is known from the first tick on. */
static void a_touch_does_not_go_through(void)
{
    /* A tent of four walls, its ridge from the apex at 0 to 0.02 m along y. */
    static const double tent[18] = { 0,    0,    0,     0,     0.02, 0,     0.03,  -0.03, -0.02,
                                     0.03, 0.05, -0.02, -0.03, 0.05, -0.02, -0.03, -0.03, -0.02 };
    static const uint32_t walls[18] = { 0, 2, 3, 0, 3, 1, 1, 3, 4, 1, 4, 5, 1, 5, 0, 0, 5, 2 };
    static const struct {
        double end[2][3];
        int touches;
    } c[] = { { { { -0.01, 0, 0 }, { 0.01, 0, 0 } }, 1 },
              { { { -0.01, 0.01, 0 }, { 0.01, 0.01, 0 } }, 1 },
              { { { -0.01, -0.001, 0 }, { 0.01, 0.001, 0 } }, 1 },
              { { { 0, 0, -0.01 }, { 0, 0, 0.01 } }, 0 },
              { { { -0.01, 0, 0.01 }, { 0.01, 0, -0.01 } }, 0 },
              { { { -0.01, 0.01, 0.01 }, { 0.01, 0.01, -0.01 } }, 0 } };
    /* It comes as near to a vertex as rounding, from behind. */
    static const struct state cloth_touch = {
        .end = { { 0.04384709555593512, 0.0096923861485569748, -0.13278427512575422 },
                 { 0.049037606084691279, -0.019501429469810615, -0.13398297305075171 } },
        .tool = { { 0.09342690058767833, -0.01147897853946369, 0.12916807205450256 },
                  { 0.99933759947247791, -0.0044584696808080719, 0.019177805994699263,
                    0.030605491107319756 } },
        .body = DPT_POSE_IDENTITY
    };
    struct sheet sheet;
    memset(&sheet, 0, sizeof sheet);
    if (fixture_from_arrays(&sheet.fixture, tent, 6, walls, 6) && sheet_of(&sheet, "tent"))
        for (size_t i = 0; i < COUNT(c); i++) {
            struct state state = { .free = 1,
                                   .tool = DPT_POSE_IDENTITY,
                                   .body = DPT_POSE_IDENTITY };
            memcpy(state.end, c[i].end, sizeof state.end);
            uint32_t contact = first_contact(&sheet, &state);
            CHECK(contact == (c[i].touches ? DPT_CONTACT_TOUCHING : DPT_CONTACT_UNKNOWN),
                  "tent: contact %u%s", contact, text_of(&state, &state));
        }
    sheet_free(&sheet);
    if (sheet_from_shape(&sheet, "cloth", 800, 0.0))
        CHECK(first_contact(&sheet, &cloth_touch) == DPT_CONTACT_TOUCHING, "cloth: not a touch");
    sheet_free(&sheet);
}

/*
 * Through a bowl, back in front of it, and then round its border without meeting anything: what is behind then is not deep. A
 * tick each, of a body that turns by half a radian.
 */
static void round_the_border_is_in_front(void)
{
    static const struct state way[3] = {
        { .free = 1,
          .end = { { 0.13080753548749791, 0.28318087946392223, -0.52958259624064252 },
                   { 0.065984316638362919, 0.42866825625259553, -0.32020446871249603 } },
          .tool = DPT_POSE_IDENTITY,
          .body = { { 0.025456113910777435, 0.27664843194865074, -0.3181290908967811 },
                    { 0.40320882652670709, -0.49801638120538311, -0.7509378120029836,
                      0.15967068850049404 } } },
        { .free = 1,
          .end = { { 0.13168499489278465, 0.28164539791522764, -0.53252254398530274 },
                   { 0.066822172068389807, 0.42709252117053831, -0.32313072799521098 } },
          .tool = DPT_POSE_IDENTITY,
          .body = { { 0.016889857235161641, 0.2530918785994597, -0.34728792999160685 },
                    { 0.51678298505520215, -0.44970095414917943, -0.7284823019813218,
                      -0.0042348429423418217 } } },
        { .free = 1,
          .end = { { 0.1325624542980714, 0.2801099163665331, -0.53546249172996307 },
                   { 0.067660027498416708, 0.42551678608848104, -0.32605698727792587 } },
          .tool = DPT_POSE_IDENTITY,
          .body = { { 0.0083236005595458493, 0.2295353252502686, -0.3764467690864326 },
                    { 0.60834077080969928, -0.38222703285131016, -0.67499144756269303,
                      -0.16795995845904579 } } }
    };
    static const int order[4] = { 1, 0, 1, 2 };
    struct sheet sheet;
    struct scene scene;
    struct sums sums = { .worst_off = -HUGE_VAL };
    if (sheet_from_grid(&sheet, "bowl", 1.0, 0) && scene_begin(&scene, &sheet, 0, NULL)) {
        struct scene like = scene;
        like.def.margin = 0.0014;
        like.def.side_limit = 0.0;
        free(scene.block);
        if (scene_begin(&scene, &sheet, 0, &like)) {
            struct ride ride = { .scene = &scene, .sums = &sums };
            for (int i = 0; i < 4; i++)
                ride_tick(&ride, &way[order[i]], i == 0, -1.0);
            CHECK(sums.sided == 2 && sums.clean == 2 && ride.knows == CLEAN,
                  "through in %lu ticks, free in %lu, then %d", sums.sided, sums.clean, ride.knows);
        }
        free(scene.block);
    }
    sheet_free(&sheet);
}

/* Through a corner of a bowl within one tick, its ends passing beside: then what is behind lies between points that are not. */
static void through_a_corner_is_behind(void)
{
    static const double from[2][3] = { { -0.026655499654475, -0.20307381662083, 0.0011775914167 },
                                       { -0.21666300190435, -0.07832561418408, 0.0121932122627 } };
    static const double pace[3] = { 0.00486645292, 0.00585813891, 0.02103877755 };
    struct sheet sheet;
    struct scene scene = { NULL };
    struct sums sums = { .worst_off = -HUGE_VAL };
    if (sheet_from_grid(&sheet, "bowl", 1.0, 0) && scene_begin(&scene, &sheet, 0, NULL)) {
        struct scene like = scene;
        like.def.margin = 0.001;
        like.def.side_limit = 0.0;
        free(scene.block);
        if (scene_begin(&scene, &sheet, 0, &like)) {
            struct ride ride = { .scene = &scene, .sums = &sums };
            for (int i = 0; i < 5; i++) {
                struct state now = { .free = 1,
                                     .radius = 0.0003,
                                     .tool = DPT_POSE_IDENTITY,
                                     .body = DPT_POSE_IDENTITY };
                for (int e = 0; e < 2; e++)
                    go(now.end[e], from[e], i, pace);
                ride_tick(&ride, &now, i == 0, -1.0);
            }
            CHECK(sums.behind == 2, "behind in %lu ticks", sums.behind);
        }
        free(scene.block);
    }
    sheet_free(&sheet);
}

static void a_flat_sheet_is_crossed_in_one_tick(void)
{
    struct sheet sheet;
    struct sums sums = { .worst_off = -HUGE_VAL };
    struct scene scene = { NULL };
    double late = -HUGE_VAL;
    if (!sheet_from_shape(&sheet, "membrane", 512, 0.1))
        return;
    for (unsigned long i = 0; sums.met < crossing_count; i++) {
        struct ride ride = { .scene = &scene, .sums = &sums };
        if (i % 1000 == 0) {
            free(scene.block);
            if (!scene_begin(&scene, &sheet, 0, NULL))
                return;
        }
        flat_crossing(&ride, &late);
    }
    free(scene.block);
    printf("    %lu ticks, %lu crossings, %.1e late at most; behind %lu, did not cross %lu\n",
           sums.ticks, sums.met, late, sums.behind, sums.clean);
    sheet_free(&sheet);
}

static void generated_sheets_are_crossed(void)
{
    struct sheet sheet;
    if (sheet_from_shape(&sheet, "membrane", 512, 0.1))
        fly_through(&sheet, crossing_count * 5 / 100);
    sheet_free(&sheet);
    if (sheet_from_shape(&sheet, "cloth", 800, 0.0))
        fly_through(&sheet, crossing_count / 100);
    sheet_free(&sheet);
    if (sheet_from_grid(&sheet, "bowl", 1.0, 0))
        fly_through(&sheet, crossing_count * 2 / 100);
    sheet_free(&sheet);
    if (sheet_from_grid(&sheet, "hole", 0.0, 1))
        fly_through(&sheet, crossing_count / 100);
    sheet_free(&sheet);
}

/*
 * From above the sheet to below it through a corner of the hole, in one tick and back, at times with the surface at its
 * border: nothing is crossed, and so nothing is deep.
 */
static void a_way_through_a_hole_is_free(void)
{
    struct sheet sheet;
    struct sums sums = { .worst_off = -HUGE_VAL };
    struct scene scene = { NULL };
    if (!sheet_from_grid(&sheet, "hole", 0.0, 1))
        return;
    for (unsigned long i = 0; i < crossing_count / 100; i++) {
        if (i % 100 == 0) {
            free(scene.block);
            if (!scene_begin(&scene, &sheet, 0, NULL))
                return;
        }
        struct ride ride = { .scene = &scene, .sums = &sums };
        struct state state[2];
        double over = power_in(-4.0, -2.7), height = power_in(-4.0, -2.3), w = 0.3 / 16.0;
        double beside = over * random_in(&rng, 1.2, 4.0), u[3];
        double length = one_in(2) ? 0.0 : 0.3 * over,
               radius = one_in(2) ? 0.0 : power_in(-4.0, -2.5);
        any_unit(u);
        for (int k = 0; k < 2; k++) {
            const double at[3] = { -w + (k ? beside : -over), -w + (k ? -over : beside),
                                   k ? -height : height };
            state[k] = (struct state){
                .free = 1, .radius = radius, .tool = DPT_POSE_IDENTITY, .body = DPT_POSE_IDENTITY
            };
            memcpy(state[k].end[0], at, sizeof at);
            go(state[k].end[1], at, fmin(length, 0.5 * height), u);
        }
        for (int k = 0; k < 4; k++)
            ride_tick(&ride, &state[k % 2], k == 0, -1.0);
    }
    free(scene.block);
    printf("    %lu ticks, did not cross %lu, met %lu, clear %lu, undecided %lu, not judged %lu\n",
           sums.ticks, sums.clean, sums.met, sums.clear, sums.undecided, sums.doubtful);
    sheet_free(&sheet);
}

/*
 * A body that turns past a moving tool: seen from it, the way bends to one side and back, so that it is on its chord at
 * the ends and in the middle. The sheet is where it is not.
 */
static void ways_that_bend_twice_are_swept(void)
{
    struct sums sums = { .worst_off = -HUGE_VAL };
    for (unsigned long i = 0; i < 20 + crossing_count / 500; i++) {
        double turn = power_in(-1.0, 0.477), v = power_in(-3.0, -1.7), half = 0.5 * turn;
        double c = -0.5 * v * sin(half) / (1.0 - cos(half));
        double end = -0.5 * v * sin(half) + c * cos(half), quarter = 0.25 * turn;
        double off = -0.25 * v * sin(quarter) + c * cos(quarter) - end,
               wide = 0.6 * v + 1.1 * fabs(c * sin(half));
        double z = end + random_in(&rng, 0.3, 0.9) * off;
        const double corners[12] = { -wide, -0.025, z, wide,  -0.025, z,
                                     wide,  0.025,  z, -wide, 0.025,  z };
        const uint32_t two[6] = { 0, 1, 2, 0, 2, 3 };
        struct sheet sheet;
        struct scene scene = { NULL };
        memset(&sheet, 0, sizeof sheet);
        if (!fixture_from_arrays(&sheet.fixture, corners, 4, two, 2) ||
            !sheet_of(&sheet, "turned") || !scene_begin(&scene, &sheet, 0, NULL))
            return;
        struct flight flight = { .free = 1, .tool = DPT_POSE_IDENTITY, .body = DPT_POSE_IDENTITY };
        flight.star = 0.5;
        flight.body_axis[1] = 1.0;
        flight.body_turn = -turn;
        double y = random_in(&rng, -0.01, 0.01), length = one_in(2) ? 0.0 : 0.01;
        for (int e = 0; e < 2; e++) {
            const double at[3] = { 0.0, y + e * length, c }, rate[3] = { v, 0.0, 0.0 };
            memcpy(flight.end[e], at, sizeof at);
            memcpy(flight.rate[e], rate, sizeof rate);
        }
        struct ride ride = { .scene = &scene, .sums = &sums };
        struct state from = flight_at(&flight, 0.0), to = flight_at(&flight, 1.0);
        ride_tick(&ride, &from, 1, -1.0);
        ride_tick(&ride, &to, 0, 0.25); /* there it is on the other side */
        free(scene.block);
        sheet_free(&sheet);
    }
    printf("    %lu ticks, met %lu, near %lu, undecided %lu, clear %lu\n", sums.swept, sums.met,
           sums.near, sums.undecided, sums.clear);
    CHECK(sums.planned > 10, "%lu met", sums.planned);
}

/* Thin closed bodies, passed completely in one tick. */
static void thin_bodies_are_not_missed(void)
{
    static const double slab[24] = { -0.1, -0.1, 0,   0.1, -0.1, 0,    0.1,  0.1,
                                     0,    -0.1, 0.1, 0,   -0.1, -0.1, 1e-4, 0.1,
                                     -0.1, 1e-4, 0.1, 0.1, 1e-4, -0.1, 0.1,  1e-4 };
    static const uint32_t sides[36] = { 0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                        1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7 };
    struct sheet sheet;
    struct sums sums = { .worst_off = -HUGE_VAL };
    unsigned long passed = 0;
    for (int body = 0; body < 2; body++) {
        memset(&sheet, 0, sizeof sheet);
        struct shape shape;
        shape_reason reason;
        if (body == 1 && shape_make("sphere", 320, 0, &shape, reason) == 0) {
            for (size_t i = 0; i < 3 * shape.vertex_count; i++)
                shape.vertices[i] *= 0.01; /* a bead of 1 mm */
            fixture_from_arrays(&sheet.fixture, shape.vertices, shape.vertex_count, shape.corners,
                                shape.triangle_count);
            shape_free(&shape);
        } else {
            fixture_from_arrays(&sheet.fixture, slab, 8, sides, 12);
        }
        struct scene scene = { NULL };
        if (!sheet.fixture.mesh || !sheet_of(&sheet, body ? "bead" : "slab") ||
            !scene_begin(&scene, &sheet, 0, NULL))
            return;
        for (unsigned long i = 0; i < crossing_count / 20; i++) {
            double target[3], normal[3], way[3], u[3], pace = power_in(-2.5, -1.7);
            struct ride ride = { .scene = &scene, .sums = &sums };
            struct state from = { .free = 1, .tool = DPT_POSE_IDENTITY, .body = DPT_POSE_IDENTITY };
            struct state to;
            any_target(&sheet, target, normal);
            any_unit(way);
            if (!body)
                way[2] += way[2] < 0.0 ? -0.3 : 0.3;
            unit3(way);
            any_across(u, way); /* sideways, in its own line, or a point */
            if (one_in(3))
                memcpy(u, way, sizeof u);
            double length = one_in(4) ? 0.0 : power_in(-3.0, -1.7),
                   star = random_in(&rng, 0.1, 0.9);
            from.radius = one_in(2) ? 0.0 : power_in(-5.0, -3.5);
            double share = dot3(u, way) > 0.5 ? 1.0 : random_in(&rng, 0.0, 1.0);
            for (int e = 0; e < 2; e++) {
                go(from.end[e], target, (e - share) * length, u);
                go(from.end[e], from.end[e], -star * pace, way);
            }
            to = from;
            for (int e = 0; e < 2; e++)
                go(to.end[e], from.end[e], pace, way);
            struct ends3 at = ends_between(&from, &from, 0.0), then = ends_between(&to, &to, 0.0);
            struct close close = closest_of_all(&sheet, &at);
            if (close.distance <= fmax(1.001 * from.radius, 1e-9))
                continue;
            passed += closest_of_all(&sheet, &then).distance > from.radius;
            if (height_of(&sheet, at.end[0], normal, &(int){ 0 }) < 0.0)
                continue; /* inside */
            ride_tick(&ride, &from, 1, -1.0);
            struct truth truth = truth_of(&sheet, &from, &to, from.radius);
            ride.knows = DOUBT;
            ride_tick(&ride, &to, 0, truth.met == TRUTH_MET ? truth.by : -1.0);
        }
        free(scene.block);
        sheet_free(&sheet);
    }
    printf("    %lu ticks, met %lu, free at both ends %lu, undecided %lu; worst touch %.3f of the "
           "tolerance\n",
           sums.swept, sums.met, passed, sums.undecided, sums.worst_off);
    CHECK(passed > crossing_count / 100, "%lu passed", passed);
}

/*
 * A small budget may leave the sweep unfinished: then nothing is felt. At rest it is finished, and truly, where the budget
 * is what it takes; with less it may stay unfinished, which is counted.
 */
static void a_small_budget_only_delays(void)
{
    struct sheet sheet;
    struct sums sums = { .worst_off = -HUGE_VAL };
    unsigned long unfinished = 0, never = 0, flights = crossing_count / 25;
    uint32_t longest = 0, largest = 0;
    unsigned long never_here = 0;
    enum { MOST = 300 };
    for (int mesh = 0; mesh < 2; mesh++) {
        if (!sheet_from_shape(&sheet, mesh ? "cloth" : "membrane", mesh ? 3200 : 512,
                              mesh ? 0.0 : 0.1))
            return;
        struct scene scene = { NULL };
        struct scene ample = { NULL };
        for (unsigned long i = 0; i < flights / 2; i++) {
            struct flight flight;
            struct said said;
            if (i % 20 == 0) {
                free(scene.block);
                free(ample.block);
                ample.block = NULL;
                uint32_t most = i % 40 ? 16 : 200;
                if (!scene_begin(&scene, &sheet, 1 + (uint32_t)(random_bits(&rng) % most), NULL) ||
                    !scene_begin(&ample, &sheet, 0, &scene))
                    return;
            }
            any_flight(&sheet, &flight);
            flight.body_turn = 0.0;
            memset(flight.body_pace, 0, sizeof flight.body_pace);
            flight.star = random_in(&rng, 0.001, 0.999);
            struct state from = flight_at(&flight, 0.0), to = flight_at(&flight, 1.0);
            struct ends3 at = ends_between(&from, &from, 0.0);
            struct close close = closest_of_all(&sheet, &at);
            if (close.distance <= fmax(1.001 * from.radius, 1e-9))
                continue;
            place(&ample, &from, 1);
            tick(&ample, &said);
            uint32_t need = said.step.work;
            place(&ample, &to, 0);
            tick(&ample, &said);
            need = 2 * (need > said.step.work ? need : said.step.work);
            place(&scene, &from, 1);
            for (int ticks = 0; ticks < MOST; ticks++) {
                tick(&scene, &said);
                if (said.hit.contact != DPT_CONTACT_UNKNOWN)
                    break;
            }
            int known = said.hit.contact != DPT_CONTACT_UNKNOWN;
            CHECK(known || scene.def.budget < need, "%s: budget %u, %u would do", sheet.name,
                  scene.def.budget, need);
            if (!known) {
                never_here++;
                continue;
            }
            struct ride ride = { .scene = &scene, .sums = &sums, .was = from, .started = 1 };
            ride.was_distance = close.distance;
            ride.was_error = said.hit.error_bound;
            uint32_t ticks = 0;
            place(&scene, &to, 0);
            for (tick(&scene, &said); said.sweep.status == DPT_SWEEP_UNFINISHED && ticks < MOST;
                 ticks++)
                tick(&scene, &said);
            unfinished += ticks;
            if (ticks < MOST) {
                longest = ticks > longest ? ticks : longest;
                check_sweep(&ride, &to, &said.sweep, -1.0);
                continue;
            }
            never++;
            largest = scene.def.budget > largest ? scene.def.budget : largest;
            CHECK(scene.def.budget < need, "%s: budget %u, %u would do%s", sheet.name,
                  scene.def.budget, need, text_of(&from, &to));
        }
        free(scene.block);
        free(ample.block);
        sheet_free(&sheet);
    }
    printf(
        "    %lu sweeps, %lu ticks unfinished, at most %u before an end; met %lu, undecided %lu\n"
        "      without end: %lu contacts, %lu sweeps, of budgets up to %u\n",
        sums.swept, unfinished, longest, sums.met, sums.undecided, never_here, never, largest);
}

/* Any motion near a mesh: what is so on every one, whatever its defects. */
struct walk_sums {
    unsigned long ticks, hits, crossing, unknown, near_gap, flips_in, flips_out;
    double worst_distance, worst_gap;
    struct sums truth;
};

static void walk_from(const struct sheet *sheet, struct state *state, double length)
{
    double at[3], u[3], normal[3];
    any_target(sheet, at, normal);
    any_unit(u);
    go(at, at, (one_in(2) ? 1.0 : -1.0) * power_in(-5.0, -1.0) * sheet->unit, normal);
    double share = random_in(&rng, 0.0, 1.0);
    for (int e = 0; e < 2; e++)
        go(state->end[e], at, (e - share) * length, u);
}

static void walk_on(const struct sheet *sheet, const double drift[3], struct state *state)
{
    double u[3], turn[3], length = apart(state->end[0], state->end[1]);
    double by = 0.02 * sheet->unit * power_in(-3.0, 0.0);
    any_unit(u);
    any_unit(turn);
    for (int e = 0; e < 2; e++) {
        go(state->end[e], state->end[e], by, u);
        go(state->end[e], state->end[e], by, drift);
        go(state->end[e], state->end[e], e && length > 0.0 ? by * random_in(&rng, 0.0, 1.0) : 0.0,
           turn);
    }
}

/*
 * `closed`: the gap is bound to the motion as the distance is, and its sign to a crossing; elsewhere what changes its
 * sign without one is counted. Sheets that are not crossed never go from in front to behind.
 */
static void walk_tick(struct scene *scene, const struct state *was, const struct said *before,
                      const struct state *now, const struct said *said, int closed,
                      struct walk_sums *sums)
{
    const struct sheet *sheet = scene->sheet;
    double size = sheet->diagonal + length3(now->end[0]);
    double motion = fmax(apart(was->end[0], now->end[0]), apart(was->end[1], now->end[1]));
    double small = before->hit.error_bound + said->hit.error_bound + 1e-14 * size;
    double by = fabs(said->hit.distance - before->hit.distance) - motion;
    sums->worst_distance = fmax(sums->worst_distance, by / small);
    CHECK(by <= small, "%s: the distance changes by %g more than the motion%s", sheet->name, by,
          text_of(was, now));
    if (before->hit.contact == DPT_CONTACT_UNKNOWN || said->hit.contact == DPT_CONTACT_UNKNOWN)
        return;
    double tolerance = 2e-5 * sheet->diagonal;
    by = fabs(said->hit.gap - before->hit.gap) - motion;
    sums->near_gap++;
    if (closed) {
        sums->worst_gap = fmax(sums->worst_gap, by / tolerance);
        CHECK(by <= tolerance, "%s: the gap changes by %g more than the motion%s", sheet->name, by,
              text_of(was, now));
    }
    /* Of the axis, wholly on one side at both ticks, and not through anything in between. */
    if (before->hit.distance <= small || said->hit.distance <= small ||
        said->sweep.status != DPT_SWEEP_FREE)
        return;
    int in_before = before->hit.gap + was->radius < 0.0, in_now = said->hit.gap + now->radius < 0.0;
    sums->flips_in += !in_before && in_now;
    sums->flips_out += in_before && !in_now;
    CHECK(!closed || in_before == in_now, "%s: gap from %g to %g, not crossed%s", sheet->name,
          before->hit.gap, said->hit.gap, text_of(was, now));
}

static void walk(struct sheet *sheet, unsigned long ticks, unsigned long judged, int closed)
{
    struct walk_sums sums = { .worst_distance = -HUGE_VAL, .worst_gap = -HUGE_VAL };
    struct scene scene = { NULL };
    struct said said, before = { .contacts = 0 };
    sums.truth.worst_off = -HUGE_VAL;
    while (sums.ticks < ticks) {
        if (sums.ticks % 1000 < 20) {
            free(scene.block);
            if (!scene_begin(&scene, sheet, 0, NULL))
                return;
        }
        struct state state = { .free = 1, .tool = DPT_POSE_IDENTITY, .body = DPT_POSE_IDENTITY };
        struct state was;
        double drift[3];
        any_unit(drift);
        state.radius = one_in(2) ? 0.0 : power_in(-4.0, -1.5) * sheet->unit;
        walk_from(sheet, &state, one_in(6) ? 0.0 : power_in(-3.0, -0.30103) * sheet->unit);
        struct ride ride = { .scene = &scene, .sums = &sums.truth };
        for (int i = 0; i < 20; i++, was = state, before = said) {
            if (i)
                walk_on(sheet, drift, &state);
            place(&scene, &state, i == 0);
            tick(&scene, &said);
            sums.ticks++;
            sums.hits += said.sweep.status == DPT_SWEEP_HIT;
            sums.crossing += said.hit.distance == 0.0;
            sums.unknown += said.hit.contact == DPT_CONTACT_UNKNOWN;
            if (!i)
                continue;
            walk_tick(&scene, &was, &before, &state, &said, closed, &sums);
            if (sums.truth.swept >= judged || before.hit.distance <= before.hit.error_bound)
                continue;
            ride.was = was;
            ride.started = 1;
            ride.was_distance = before.hit.distance;
            ride.was_error = before.hit.error_bound;
            check_sweep(&ride, &state, &said.sweep, -1.0);
        }
    }
    const dpt_mesh_info *info = &sheet->info;
    int sided = info->open_edges && !info->solid_components && !info->nonmanifold_edges &&
                !info->wrong_way_edges && info->components == 1;
    CHECK(!sided || sums.flips_in == 0, "%s: behind, not crossed, %lu times", sheet->name,
          sums.flips_in);
    free(scene.block);
    printf("    %-30s %6u triangles, %6lu ticks: %lu hits, %lu crossing, %lu unknown; sign of the "
           "gap changed "
           "%lu in, %lu out; judged %lu, met %lu, undecided %lu\n",
           sheet->name, sheet->count, sums.ticks, sums.hits, sums.crossing, sums.unknown,
           sums.flips_in, sums.flips_out, sums.truth.swept, sums.truth.met, sums.truth.undecided);
}

static unsigned long walk_ticks(void)
{
    return 1000 + crossing_count / 50;
}

static void generated_bodies_are_continuous(void)
{
    static const struct {
        const char *name;
        uint32_t count;
        int closed;
    } c[] = { { "liver", 5000, 1 }, { "stomach", 2000, 1 }, { "spleen", 1000, 1 },
              { "star", 2400, 1 },  { "sphere", 320, 1 },   { "box", 48, 1 },
              { "torus", 1000, 1 }, { "stomach", 2001, 0 }, { "hub", 300, 0 },
              { "cloth", 800, 0 } };
    for (size_t i = 0; i < COUNT(c); i++) {
        struct sheet sheet;
        if (sheet_from_shape(&sheet, c[i].name, c[i].count, 0.0))
            walk(&sheet, walk_ticks(), 200, c[i].closed);
        sheet_free(&sheet);
    }
}

/* Triangles of all sizes, through each other. */
static void soups_are_answered(void)
{
    enum { TRIANGLES = 300 };
    static double vertices[9 * TRIANGLES];
    static uint32_t corners[3 * TRIANGLES];
    for (int kind = 0; kind < 3; kind++) {
        struct sheet sheet;
        memset(&sheet, 0, sizeof sheet);
        for (uint32_t i = 0; i < TRIANGLES; i++) {
            double at[3], size = kind == 1 ? power_in(-6.0, -0.5) : 0.1;
            any_unit(at);
            for (uint32_t k = 0; k < 3; k++) {
                double off[3];
                any_unit(off);
                go(vertices + 9 * i + 3 * k, at, size, off);
                corners[3 * i + k] = 3 * i + k;
            }
            if (kind == 2 && i) /* fans with edges of many triangles */
                memcpy(vertices + 9 * i, vertices + 9 * (i - i % 10), 6 * sizeof *vertices);
        }
        if (fixture_from_arrays(&sheet.fixture, vertices, 3 * TRIANGLES, corners, TRIANGLES) &&
            sheet_of(&sheet, kind == 2 ? "fans"
                             : kind    ? "soup of all sizes"
                                       : "soup"))
            walk(&sheet, walk_ticks(), 1000, 0);
        sheet_free(&sheet);
    }
}

/* The public meshes of the table; `sheets` of them are crossed too. */
static void public_meshes_are_answered(void)
{
    char line[1000], path[1400], name[300];
    FILE *table = fopen("tests/data-meshes.txt", "r");
    CHECK(table != NULL, "no table");
    unsigned long meshes = 0;
    while (table && fgets(line, sizeof line, table)) {
        struct sheet sheet;
        if (line[0] == '#' || sscanf(line, "%299s", name) != 1)
            continue;
        snprintf(path, sizeof path, "%s/%s", getenv("DPT_DATA"), name);
        const char *hard = strstr(name, "hard/");
        if (sheet_from_file(&sheet, path, name)) {
            const dpt_mesh_info *info = &sheet.info;
            meshes++;
            walk(&sheet, hard ? 2 * walk_ticks() / 3 : walk_ticks() / 3, 100, 0);
            if (info->open_edges && !info->solid_components && !info->nonmanifold_edges &&
                !info->wrong_way_edges && info->triangles < 5000 && info->components < 3 && !hard)
                fly_through(&sheet, crossing_count / 500);
        }
        sheet_free(&sheet);
    }
    if (table)
        fclose(table);
    printf("    %lu meshes\n", meshes);
    CHECK(meshes > 0, "none in %s", getenv("DPT_DATA"));
}

int main(int argc, char **argv)
{
    if (argc > 1)
        crossing_count = strtoul(argv[1], NULL, 10);
    if (argc > 2)
        rng = strtoull(argv[2], NULL, 10);
    TEST(a_touch_does_not_go_through);
    TEST(round_the_border_is_in_front);
    TEST(through_a_corner_is_behind);
    TEST(a_flat_sheet_is_crossed_in_one_tick);
    TEST(generated_sheets_are_crossed);
    TEST(a_way_through_a_hole_is_free);
    TEST(ways_that_bend_twice_are_swept);
    TEST(thin_bodies_are_not_missed);
    TEST(a_small_budget_only_delays);
    TEST(generated_bodies_are_continuous);
    TEST(soups_are_answered);
    if (getenv("DPT_DATA"))
        TEST(public_meshes_are_answered);
    else
        SKIP("the public meshes", "DPT_DATA does not name the data folder");
    return check_report();
}
