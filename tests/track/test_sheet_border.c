/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A tool that is behind a sheet slides over its border, or a hole's: its push falls as penalty.md has it, with no
 * jump above the stiffness times the motion, and away from the border it is the depth's. The oracle takes thousands
 * of points of the axis.
 *
 * Usage: test_sheet_border [slides = 40] [seed = 1]
 */
#include "lib/fixture.h"
#include "lib/rig.h"

#define HALF      0.1
#define HOLE      0.0125 /* half of the hole's side */
#define STIFFNESS 500.0
/*
 * Of a depth: 1e-5 of the diagonal, and what the oracle leaves. A hill beside the highest one may be missed, where it
 * is narrower than a step of the search: in value, not in jumps.
 */
#define TOLERANCE 4e-6
#define MISSED    1e-4

enum { CELLS = 16, VERTICES = (CELLS + 1) * (CELLS + 1) };

static struct fixture sheet;
static unsigned long slide_count = 40;
static uint64_t sheet_random = 1;

static double any(double low, double high)
{
    return random_in(&sheet_random, low, high);
}

/* A flat square at z = 0, front upward, with a square hole in its middle. */
static int make_sheet(void)
{
    static double vertices[VERTICES * 3];
    static uint32_t corners[CELLS * CELLS * 6];
    size_t count = 0;
    for (int i = 0; i < VERTICES; i++) {
        vertices[3 * i] = HALF * (2.0 * (i % (CELLS + 1)) / CELLS - 1.0);
        vertices[3 * i + 1] = HALF * (2.0 * (i / (CELLS + 1)) / CELLS - 1.0);
    }
    for (uint32_t i = 0; i < CELLS * CELLS; i++) {
        uint32_t x = i % CELLS, y = i / CELLS, v = y * (CELLS + 1) + x;
        const uint32_t quad[6] = { v, v + 1, v + CELLS + 2, v, v + CELLS + 2, v + CELLS + 1 };
        if ((x == CELLS / 2 || x == CELLS / 2 - 1) && (y == CELLS / 2 || y == CELLS / 2 - 1))
            continue;
        memcpy(corners + 3 * count, quad, sizeof quad);
        count += 2;
    }
    return fixture_from_arrays(&sheet, vertices, VERTICES, corners, count);
}

/* How far within the sheet's outline a point lies, seen from above; below 0 it is beside. */
static double within_sheet(const double x[3])
{
    double across = fmax(fabs(x[0]), fabs(x[1]));
    if (across >= HALF)
        return HALF - across;
    double hole = across < HOLE ? across - HOLE : hypot(fmax(0.0, fabs(x[0]) - HOLE), fmax(0.0, fabs(x[1]) - HOLE));
    return fmin(HALF - across, hole);
}

struct truth {
    double deepest; /* the largest depth of the axis behind the sheet */
    double counts;  /* the largest by the rule */
    double border;  /* of the deepest point */
};

/* What penalty.md says of a point, with `through`: how far the axis has come through the plane. */
static double rule(const double x[3], double radius, double through)
{
    const double inside = within_sheet(x), h = fabs(x[2]);
    if (inside <= 0.0)
        return -HUGE_VAL;
    const double b = hypot(inside, h);
    const double room = fmax(0.0, fmin(b - h, h + 0.8 * (b - 2.0 * h)));
    return fmin(radius - x[2], room * fmax(1.0, radius / through));
}

static void take(const double a[3], const double b[3], double radius, double through, double s, struct truth *truth)
{
    double x[3];
    for (int k = 0; k < 3; k++)
        x[k] = a[k] + s * (b[k] - a[k]);
    if (through > 0.0)
        truth->counts = fmax(truth->counts, rule(x, radius, through));
    if (-x[2] > truth->deepest && within_sheet(x) > 0.0) {
        truth->deepest = -x[2];
        truth->border = hypot(within_sheet(x), x[2]);
    }
}

/* Of all points first those that are well apart, then what is between two of which one may be beaten. */
static struct truth truth_of(const double a[3], const double b[3], double radius)
{
    enum { POINTS = 400, BETWEEN = 100 };
    const double through = fmax(-a[2], -b[2]), length = 0.12 / POINTS;
    struct truth truth = { 0.0, 0.0, HUGE_VAL }, one[POINTS + 1];
    for (int i = 0; i <= POINTS; i++) {
        one[i] = (struct truth){ 0.0, 0.0, HUGE_VAL };
        take(a, b, radius, through, (double)i / POINTS, &one[i]);
        truth.counts = fmax(truth.counts, one[i].counts);
        if (one[i].deepest > truth.deepest) {
            truth.deepest = one[i].deepest;
            truth.border = one[i].border;
        }
    }
    const double best = truth.counts, deepest = truth.deepest;
    for (int i = 0; i < POINTS; i++) {
        int flat = fabs(one[i].counts - one[i + 1].counts) < 1e-12 && fabs(one[i].deepest - one[i + 1].deepest) < 1e-12;
        if (flat)
            continue;
        if (fmax(one[i].counts, one[i + 1].counts) > best - 2.0 * length ||
            fmax(one[i].deepest, one[i + 1].deepest) > deepest - length)
            for (int k = 1; k < BETWEEN; k++)
                take(a, b, radius, through, (i + (double)k / BETWEEN) / POINTS, &truth);
    }
    return truth;
}

struct sums {
    unsigned long ticks, judged, weighed, full, hidden;
    double worst_jump, worst_off;
};

struct slide {
    struct rig rig;
    double radius, half, speed, way, turn, tilt, height, low; /* half the tool's length */
    double at[3];
    dpt_force_info last;
    double end[2][3];
    int was_judged;
};

static void turned(const struct slide *slide, double heading, double u[3])
{
    u[0] = sin(slide->tilt) * cos(heading);
    u[1] = sin(slide->tilt) * sin(heading);
    u[2] = cos(slide->tilt);
}

static void judge(struct slide *slide, const double end[2][3], double motion, struct sums *sums)
{
    const dpt_hit hit = slide->rig.hit;
    const dpt_force_info report = slide->rig.force;
    const double *f = report.wrench.force, *g = slide->last.wrench.force;
    const double force = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    const double jump =
        sqrt((f[0] - g[0]) * (f[0] - g[0]) + (f[1] - g[1]) * (f[1] - g[1]) + (f[2] - g[2]) * (f[2] - g[2]));
    const struct truth truth = truth_of(end[0], end[1], slide->radius);
    int judged = truth.deepest > 1e-5;
    sums->ticks++;
    /* It came behind past a border, that of the hole say: then there is no side, and no push. */
    if (judged && !(hit.flags & DPT_HIT_FLAG_GAP && hit.gap <= 2e-5 - slide->radius)) {
        sums->hidden++;
        judged = 0;
    }
    if (judged) {
        const double off = fabs(f[2] / STIFFNESS - truth.counts);
        sums->judged++;
        sums->worst_off = fmax(sums->worst_off, off);
        CHECK(off <= MISSED && fabs(f[0]) + fabs(f[1]) <= 1e-3 * force,
              "radius %g, depth %g, border %g: counts %g for %g", slide->radius, truth.deepest, truth.border,
              f[2] / STIFFNESS, truth.counts);
        if (truth.border > 2.0 * truth.deepest + 1.25 * slide->radius + 1e-5) {
            sums->full++;
            CHECK(fabs(force - STIFFNESS * hit.depth) <= 1e-14 * force, "away from the border %g N at %g", force,
                  hit.depth);
        } else {
            sums->weighed += force < 0.999 * STIFFNESS * hit.depth;
        }
    }
    if ((judged && slide->was_judged) || slide->radius == 0.0) {
        const double rate = (jump - 2.0 * TOLERANCE * STIFFNESS) / (STIFFNESS * motion);
        const double most = slide->radius > slide->low ? 1.0 + 2.0 * slide->radius / slide->low : 1.0;
        sums->worst_jump = fmax(sums->worst_jump, rate / most);
        CHECK(rate <= 1.001 * most, "radius %g, depth %g: %g N in a motion of %g", slide->radius, truth.deepest, jump,
              motion);
    }
    slide->was_judged = judged || truth.deepest <= 0.0;
    slide->last = report;
}

static void add_scaled(struct slide *slide, const double at[3], double heading, struct sums *sums)
{
    double u[3], end[2][3], ends[6], motion = 0.0;
    turned(slide, heading, u);
    for (int e = 0; e < 2; e++) {
        double way = 0.0;
        for (int k = 0; k < 3; k++) {
            end[e][k] = at[k] + (e ? 1.0 : -1.0) * slide->half * u[k];
            way += (end[e][k] - slide->end[e][k]) * (end[e][k] - slide->end[e][k]);
        }
        motion = fmax(motion, sqrt(way));
    }
    memcpy(ends, end, sizeof end);
    memcpy(slide->end, end, sizeof end);
    rig_step_ends(&slide->rig, ends, slide->radius);
    if (sums)
        judge(slide, (const double(*)[3])end, motion, sums);
}

/* From above, through the sheet, and then over a border: its ends are never both beside it. */
static void one_slide(double radius_most, struct sums *sums)
{
    const dpt_segment none = { { 0.0, 0.0, 1.0 }, { 0.0, 0.0, 1.0 }, 0.0 };
    struct slide slide = { .radius = any(0.0, radius_most),
                           .half = any(0.005, 0.06),
                           .speed = any(5e-5, 3e-4),
                           .way = any(0.0, 6.2831853),
                           .low = any(0.004, 0.025) };
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    const int kind = (int)(random_bits(&sheet_random) % 4);
    if (random_bits(&sheet_random) % 4 == 0)
        slide.low = any(0.1, 1.0) * radius_most + 1e-4; /* through by less than its radius, say */
    slide.tilt = kind == 0 ? 0.0 : kind == 1 ? 1.5707963267948966 : acos(any(0.0, 1.0));
    slide.turn = kind == 2 ? any(-2e-3, 2e-3) : 0.0;
    def.side_limit = 0.05;
    def.fade = 0.0;
    def.certificate_bytes = 1 << 16;
    rig_open(&slide.rig, &def, sheet.mesh, &none, 1);
    double heading = any(0.0, 6.2831853), down = slide.half * cos(slide.tilt);
    double at[3] = { 0.055 * (random_bits(&sheet_random) % 2 ? 1.0 : -1.0), any(-0.055, 0.055), 0.0 };
    for (at[2] = down + slide.radius + 0.002; at[2] > down - slide.low; at[2] -= 5e-4)
        add_scaled(&slide, at, heading, NULL);
    slide.last = slide.rig.force;
    const double to[2] = { cos(slide.way), sin(slide.way) };
    for (int n = 0; n < 1500 && fmax(fabs(at[0]), fabs(at[1])) < 0.15; n++) {
        at[0] += slide.speed * to[0];
        at[1] += slide.speed * to[1];
        heading += slide.turn * slide.speed * 1e3;
        add_scaled(&slide, at, heading, sums);
    }
    rig_close(&slide.rig);
}

static void slides(double radius_most)
{
    struct sums sums = { .worst_jump = -HUGE_VAL };
    for (unsigned long i = 0; i < slide_count / 2; i++)
        one_slide(radius_most, &sums);
    printf("    %lu ticks, %lu behind, of these %lu weighed, %lu away from borders; hidden %lu\n", sums.ticks,
           sums.judged, sums.weighed, sums.full, sums.hidden);
    printf("    worst jump %.4f of what the motion allows, force off by %.2g m\n", sums.worst_jump, sums.worst_off);
    CHECK(sums.weighed > sums.ticks / 20 && sums.full > sums.ticks / 20, "too few of a kind");
}

static void a_line_slides_off_without_a_jump(void)
{
    slides(0.0);
}

static void a_capsule_slides_off_without_a_jump(void)
{
    slides(0.003);
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &slide_count, &sheet_random);
    if (!make_sheet())
        return check_report();
    TEST(a_line_slides_off_without_a_jump);
    TEST(a_capsule_slides_off_without_a_jump);
    fixture_free(&sheet);
    return check_report();
}
