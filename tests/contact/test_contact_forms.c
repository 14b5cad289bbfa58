/* SPDX-License-Identifier: BSD-3-Clause */
/* Regions of contact in a world against closed forms: over a plane, a cylinder and a sphere. */
#include "contact/depth_checks.h"

/* Integrals of w = reach - height(x) where it is positive, for a height along the tool; dense, in double. */
static void integrate(double (*height)(const void *of, double s), const void *of, double length, double reach,
                      double *overlap, double *moment)
{
    enum { POINTS = 2000 };
    *overlap = *moment = 0;
    for (int i = 0; i < POINTS; i++) {
        const double s = (i + 0.5) / POINTS, w = fmax(0, reach - height(of, s)) * length / POINTS;
        *overlap += w;
        *moment += s * w;
    }
}

/* A sheet at z = 0, finely cut; what a tool over it, or pressed through it from above, must be told. */
static void integrate_flat(double w0, double w1, double length, double *overlap, double *moment, double *square)
{
    double from = 0, to = 1;
    if (w0 < 0)
        from = w1 > 0 ? w0 / (w0 - w1) : 1;
    if (w1 < 0)
        to = w0 > 0 ? w0 / (w0 - w1) : from;
    const double middle = 0.5 * (from + to), width = (to - from) * length;
    const double low = w0 + from * (w1 - w0), half = w0 + middle * (w1 - w0), high = w0 + to * (w1 - w0);
    /* Simpson's rule, exact for both. */
    *overlap = width / 6 * (low + 4 * half + high);
    *moment = width / 6 * (from * low + 4 * middle * half + to * high);
    *square = width / 6 * (low * low + 4 * half * half + high * high);
}

/* At its ends: the gap of the tool's surface over the plane, and the way out. */
static void check_ends(const dpt_contact *c, const char *how, const double flat[6], double radius, double up)
{
    for (int e = 0; e < 2; e++) {
        const double s = e ? c->s1 : c->s0, gap = flat[2] + s * (flat[5] - flat[2]) - radius;
        CHECK(fabs(c->end_gap[e] - gap) <= 1e-9, "%s: gap %.12g, not %.12g at %g", how, c->end_gap[e], gap, s);
        CHECK(fabs(c->end_normal[e][2] - up) <= 1e-9, "%s: normal %g at %g", how, c->end_normal[e][2], s);
    }
}

static void check_flat(const struct rig *rig, const char *how, const double ends[6], double radius,
                       const dpt_world_def *def, double up, const dpt_hit *hit)
{
    dpt_contact contacts[RIG_CONTACTS];
    const double flat[6] = { ends[0], ends[1], up * ends[2], ends[3], ends[4], up * ends[5] };
    const uint32_t count = rig_contacts(rig, contacts);
    const double gap = fmin(flat[2], flat[5]) - radius, length = apart(ends, ends + 3);
    const double margin = def->margin, onset = def->onset < 0 ? margin : def->onset;
    double overlap, moment, square;
    CHECK(fabs(hit->gap - gap) <= 1e-9, "%s: gap %.12g, not %.12g at %a %a %a", how, hit->gap, gap, ends[0], ends[1],
          ends[2]);
    CHECK(hit->contact == (gap > 1e-12    ? DPT_CONTACT_SEPARATED
                           : gap < -1e-12 ? DPT_CONTACT_PENETRATING
                                          : hit->contact),
          "%s: contact %u, gap %g", how, hit->contact, gap);
    CHECK(count == (gap <= margin), "%s: %u regions at a gap of %.9g", how, count, gap);
    if (count != 1)
        return;
    const dpt_contact *c = contacts;
    CHECK(fabs(c->gap - gap) <= 1e-9, "%s: gap %.12g, not %.12g", how, c->gap, gap);
    CHECK(fabs(c->normal[0]) <= 1e-9 && fabs(c->normal[1]) <= 1e-9 && fabs(c->normal[2] - up) <= 1e-9,
          "%s: normal %.12g %.12g %.12g at %a %a %a", how, c->normal[0], c->normal[1], c->normal[2], ends[0], ends[1],
          ends[2]);
    check_ends(c, how, flat, radius, up);
    integrate_flat(onset + radius - flat[2], onset + radius - flat[5], length, &overlap, &moment, &square);
    const double slack = 1e-9 * (margin + fabs(gap)) * length + 1e-15;
    CHECK(fabs(c->overlap - overlap) <= slack, "%s: overlap %.9g, not %.9g", how, c->overlap, overlap);
    CHECK(fabs(c->moment - moment) <= slack, "%s: moment %.9g, not %.9g", how, c->moment, moment);
    CHECK(fabs(c->square - square) <= slack * (margin + fabs(gap)) + 1e-18, "%s: square %.9g, not %.9g", how, c->square,
          square);
    CHECK(fabs(c->thrust[2] - up * overlap) <= slack && fabs(c->thrust[0]) <= slack, "%s: thrust %.9g, not %.9g", how,
          c->thrust[2], up * overlap);
}

/*
 * Slides over a sheet, its height going from the margin down and through: `ends` at height 0, moved by `step` a tick.
 * Exact: the mesh is the plane.
 */
static void slide_flat(const struct solid *solid, const char *how, const double ends[6], const double step[2],
                       double radius, double up, double top, double bottom, double onset)
{
    struct rig rig;
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    const double fall = (bottom - top) * 1.2 / 400;
    const int count = 400;
    def.onset = onset;
    if (!rig_open(&rig, &def, solid->mesh, &rig_point, 1))
        return;
    for (int i = 0; i < count; i++) {
        double now[6];
        double height = fmax(bottom, top + fall * i);
        const double low = fmin(ends[2], ends[5]) + height - radius;
        if (fabs(low) < -1.5 * fall) /* for some ticks it just touches */
            height = radius - fmin(ends[2], ends[5]);
        for (int e = 0; e < 2; e++) {
            now[3 * e] = ends[3 * e] + i * step[0];
            now[3 * e + 1] = ends[3 * e + 1] + i * step[1];
            now[3 * e + 2] = up * (ends[3 * e + 2] + height);
        }
        const dpt_hit hit = rig_step_ends(&rig, now, radius);
        check_flat(&rig, how, now, radius, &def, up, &hit);
    }
    rig_close(&rig);
}

/* Cells of 10 mm: along a grid line with its vertices, along the cells' diagonals, across all. */
static void flat_sheet(void)
{
    const double steps[3][2] = { { 0.0003, 0 }, { 0.0003, 0.0003 }, { 0.00027, 0.00021 } };
    struct solid solid;
    const double grid = (double)-0.08f; /* where vertices are */
    if (!solid_from_shape(&solid, "membrane", 800))
        return;
    for (int way = 0; way < 3; way++)
        for (int side = 0; side < 2; side++) {
            const double up = side ? -1 : 1;
            /* The integrals begin at the margin, between it and the surface, at the surface. */
            const double onset = way == 0 ? -1 : way == 1 ? 4e-4 : 0;
            const double ball[6] = { grid, grid, 0, grid, grid, 0 };
            const double lying[6] = { grid, grid, 0, -0.03, -0.06, 0 };
            const double tilted[6] = { grid, grid, 0, -0.04, -0.07, 0.01 };
            const double steep[6] = { -0.079, grid, 0.15, grid, grid, 0 };
            slide_flat(&solid, "ball", ball, steps[way], 0.005, up, 0.0065, -0.004, onset);
            slide_flat(&solid, "point", ball, steps[way], 0, up, 0.0015, -0.004, onset);
            slide_flat(&solid, "lying", lying, steps[way], 0.003, up, 0.0045, -0.003, onset);
            slide_flat(&solid, "tilted", tilted, steps[way], 0.002, up, 0.0035, -0.006, onset);
            slide_flat(&solid, "tilted line", tilted, steps[way], 0, up, 0.0015, -0.006, onset);
            slide_flat(&solid, "steep line", steep, steps[way], 0, up, 0.0015, -0.02, onset);
        }
    solid_close(&solid);
}

/* The upper face of a box, z = 0.04: the same, as long as no other face is nearer. */
static void flat_face(void)
{
    struct solid solid;
    struct rig rig;
    if (!solid_from_shape(&solid, "box", 768) || !depth_rig_open(&rig, solid.mesh, 0.001, 32))
        return;
    const double top = solid.info.box_max[2];
    for (int i = 0; i < 400; i++) {
        const double x = -0.03 + 0.0001 * i, y = i < 200 ? 0 : 0.00007 * (i - 200);
        const double height = 0.004 - 0.00002 * i;
        const double ends[6] = { x, y, top + height, x + 0.02, y + 0.005, top + height + 0.003 };
        const dpt_hit hit = rig_step_ends(&rig, ends, 0.002);
        dpt_contact contacts[RIG_CONTACTS];
        const uint32_t count = rig_contacts(&rig, contacts);
        const double gap = ends[2] - top - 0.002;
        CHECK(fabs(hit.gap - gap) <= 1e-5 * solid.diagonal, "gap %.9g, not %.9g", hit.gap, gap);
        CHECK(count == (gap <= 0.001), "%u regions at %g", count, gap);
        if (count == 1)
            CHECK(fabs(contacts[0].normal[2] - 1) <= 1e-9 && fabs(contacts[0].normal[0]) <= 1e-9, "normal %g %g %g",
                  contacts[0].normal[0], contacts[0].normal[1], contacts[0].normal[2]);
    }
    rig_close(&rig);
    solid_close(&solid);
}

enum { ROUND = 96 };

static void place_cylinder(double u, double v, double x[3])
{
    const double angle = 2 * 3.14159265358979323846 * v;
    x[0] = 0.05 * cos(angle);
    x[1] = 0.05 * sin(angle);
    x[2] = 0.3 * u - 0.15;
}

/* The axis of a straight tool over a round body: sqrt(least^2 + (length (s - middle))^2) - body's radius. */
struct round_height {
    double least, length, middle, radius;
};

static double height_of_round(const void *of, double s)
{
    const struct round_height *r = of;
    const double along_it = r->length * (s - r->middle);
    return sqrt(r->least * r->least + along_it * along_it) - r->radius;
}

/*
 * A mesh inscribed in a round body of radius R holds that of radius R - sag: heights are above those over the body by 0
 * to sag, so gap is too, and the overlap is between those of both. To that 2 % of the largest overlap, what the
 * integrals are allowed. Its faces are tilted by at most `tilt` against the sphere or cylinder.
 */
static void check_round(const struct rig *rig, const char *how, const struct round_height *r, double sag, double tilt,
                        double tool_radius, double margin, double peak, const double way[3], const dpt_hit *hit)
{
    dpt_contact contacts[RIG_CONTACTS];
    const uint32_t count = rig_contacts(rig, contacts);
    const double gap = r->least - r->radius - tool_radius, bound = 1e-7;
    double most, least, most_moment, least_moment, overlap = 0, moment = 0;
    CHECK(hit->gap >= gap - bound && hit->gap <= gap + sag + bound, "%s: gap %.9g, not %.9g", how, hit->gap, gap);
    integrate(height_of_round, r, r->length, margin + tool_radius, &most, &most_moment);
    integrate(height_of_round, r, r->length, margin + tool_radius - sag, &least, &least_moment);
    for (uint32_t i = 0; i < count; i++) {
        overlap += contacts[i].overlap;
        moment += contacts[i].moment;
        CHECK(contacts[i].gap > gap + sag + bound || dot3(contacts[i].normal, way) >= cos(tilt),
              "%s: normal %g off, not %g", how, acos(dot3(contacts[i].normal, way)), tilt);
    }
    CHECK(count == 1 || gap > margin - sag, "%s: %u regions", how, count);
    CHECK(overlap <= most + 0.02 * peak && overlap >= least - 0.02 * peak, "%s: overlap %.9g, not %.9g to %.9g", how,
          overlap, least, most);
    CHECK(moment <= most_moment + 0.02 * peak && moment >= least_moment - 0.02 * peak,
          "%s: moment %.9g, not %.9g to %.9g", how, moment, least_moment, most_moment);
}

static void round_cylinder(void)
{
    const double pi = 3.14159265358979323846, radius = 0.05, margin = 0.001, tool = 0.004;
    const double sag = radius * (1 - cos(pi / ROUND)) + 1e-8, tilt = pi / ROUND + 1e-6;
    struct solid solid;
    if (!solid_from_net(&solid, "cylinder", 30, ROUND, 1, place_cylinder))
        return;
    for (int kind = 0; kind < 3; kind++) {
        struct rig rig;
        if (!depth_rig_open(&rig, solid.mesh, margin, 32))
            return;
        const double length = kind == 2 ? 0 : 0.06;
        struct round_height r = { radius + tool - 0.002, length, 0.4, radius };
        double peak, moment;
        if (kind == 1) /* along the axis: a height everywhere the same */
            r.length = 0;
        integrate(height_of_round, &r, length, margin + tool, &peak, &moment);
        for (int i = 0; i < 500; i++) {
            const double angle = 0.003 * i, d = r.least = radius + tool + 0.0015 - 0.000007 * i;
            const double way[3] = { cos(angle), sin(angle), 0 };
            const double side[3] = { kind ? 0 : -sin(angle), kind ? 0 : cos(angle), kind ? 1 : 0 };
            double ends[6];
            for (int k = 0; k < 3; k++) {
                const double foot = d * way[k] + (k == 2 ? -0.05 + 0.0002 * i : 0);
                ends[k] = foot - 0.4 * length * side[k];
                ends[3 + k] = foot + 0.6 * length * side[k];
            }
            const dpt_hit hit = rig_step_ends(&rig, ends, tool);
            if (kind == 0) {
                check_round(&rig, "across", &r, sag, tilt, tool, margin, peak, way, &hit);
            } else {
                dpt_contact contacts[RIG_CONTACTS];
                const uint32_t count = rig_contacts(&rig, contacts);
                const double gap = d - radius - tool, most = fmax(0, margin - gap) * length;
                const char *how = kind == 1 ? "along" : "ball";
                CHECK(hit.gap >= gap - 1e-7 && hit.gap <= gap + sag, "%s: gap %.9g, not %.9g", how, hit.gap, gap);
                CHECK(count == 1 || gap > margin - sag, "%s: %u regions", how, count);
                for (uint32_t k = 0; k < count; k++) {
                    CHECK(dot3(contacts[k].normal, way) >= cos(tilt), "%s: normal %g off", how,
                          acos(dot3(contacts[k].normal, way)));
                    CHECK(contacts[k].overlap <= most + 1e-9 && contacts[k].overlap >= most - sag * length - 1e-9,
                          "%s: overlap %.9g, not %.9g", how, contacts[k].overlap, most);
                    CHECK(fabs(contacts[k].moment - 0.5 * contacts[k].overlap) <= 0.02 * peak + 1e-12,
                          "%s: moment %.9g, overlap %.9g", how, contacts[k].moment, contacts[k].overlap);
                }
            }
        }
        rig_close(&rig);
    }
    solid_close(&solid);
}

static void round_sphere(void)
{
    const double margin = 0.001, tool = 0.004;
    double outer, inner, tilt, peak, moment;
    struct solid solid;
    struct rig rig;
    if (!solid_from_shape(&solid, "sphere", 5120) || !depth_rig_open(&rig, solid.mesh, margin, 32))
        return;
    solid_balls(&solid, &inner, &outer, &tilt);
    struct round_height r = { outer + tool - 0.002, 0.08, 0.3, outer };
    integrate(height_of_round, &r, r.length, margin + tool, &peak, &moment);
    for (int i = 0; i < 500; i++) {
        const double a = 0.004 * i, b = 0.0017 * i;
        const double way[3] = { cos(a) * cos(b), sin(a) * cos(b), sin(b) };
        const double side[3] = { -sin(a), cos(a), 0 };
        double ends[6];
        r.least = outer + tool + 0.0015 - 0.000007 * i;
        for (int k = 0; k < 3; k++) {
            ends[k] = r.least * way[k] - 0.3 * r.length * side[k];
            ends[3 + k] = r.least * way[k] + 0.7 * r.length * side[k];
        }
        const dpt_hit hit = rig_step_ends(&rig, ends, tool);
        check_round(&rig, "sphere", &r, outer - inner, 2 * tilt, tool, margin, peak, way, &hit);
    }
    rig_close(&rig);
    solid_close(&solid);
}

int main(void)
{
    TEST(flat_sheet);
    TEST(flat_face);
    TEST(round_cylinder);
    TEST(round_sphere);
    return check_report();
}
