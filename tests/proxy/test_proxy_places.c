/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A proxy in hard places: corners, edges, slots and holes about as wide as the tool, notches, wedges, thin walls, a
 * sheet's border, between bodies, among many. It is led in and out again, and each tick is judged (place_visit.h).
 *
 *     test_proxy_places [PER CENT of the visits = 100]
 */
#include "proxy/place_meshes.h"
#include "proxy/place_visit.h"

#define RADIUS 0.002

static const dpt_segment ball[] = { { { 0, 0, 0 }, { 0, 0, 0 }, RADIUS } };
static const dpt_segment needle[] = { { { 0, 0, 0 }, { 0, 0, 0.06 }, RADIUS } };
static const dpt_segment line[] = { { { 0, 0, 0 }, { 0, 0, 0.06 }, 0 } };
static const dpt_segment lying[] = { { { 0, -0.015, 0 }, { 0, 0.015, 0 }, RADIUS } };
static const dpt_segment across[] = { { { -0.02, 0, 0 }, { 0.03, 0, 0.01 }, RADIUS } };
static const dpt_segment bent[] = { { { 0, 0, 0 }, { 0, 0, 0.04 }, RADIUS },
                                    { { 0, 0, 0 }, { 0.012, 0, -0.01 }, 0.001 },
                                    { { 0, 0, 0 }, { -0.012, 0.004, -0.01 }, 0.001 } };

struct instrument {
    const char *name;
    const dpt_segment *segments;
    uint32_t count;
};

static const struct instrument instruments[] = { { "ball", ball, 1 },   { "needle", needle, 1 }, { "line", line, 1 },
                                                 { "lying", lying, 1 }, { "across", across, 1 }, { "bent", bent, 3 } };
enum { INSTRUMENTS = sizeof instruments / sizeof *instruments };

/* Solids whose place is at the origin, below z = 0. */
enum { BLOCK, WIDE_SLOT, NARROW_SLOT, WIDE_HOLE, NARROW_HOLE, NOTCH, SHARP_NOTCH, WEDGE, WALL, SHEET, CUBE, SOLIDS };
static struct solid solids[SOLIDS];

/* A block of 80 x 40 x 60 mm with a slot of this half width, 30 mm deep. */
static int make_slot(struct solid *solid, const char *name, double half)
{
    const double outline[][2] = { { -0.04, -0.06 }, { 0.04, -0.06 },  { 0.04, 0 },  { half, 0 },
                                  { half, -0.03 },  { -half, -0.03 }, { -half, 0 }, { -0.04, 0 } };
    return solid_from_outline(solid, name, outline, 8, 0.02);
}

static int make_notch(struct solid *solid, const char *name, double half)
{
    const double outline[][2] = { { -0.04, -0.06 }, { 0.04, -0.06 }, { 0.04, 0 }, { half, 0 },
                                  { 0, -0.03 },     { -half, 0 },    { -0.04, 0 } };
    return solid_from_outline(solid, name, outline, 7, 0.02);
}

static void flat_sheet(double u, double v, double x[3])
{
    x[0] = 0.1 * v;
    x[1] = 0.1 * (u - 0.5);
    x[2] = 0;
}

static int make_solids(void)
{
    const double block[][2] = { { 0, -0.06 }, { 0.06, -0.06 }, { 0.06, 0 }, { 0, 0 } };
    const double wedge[][2] = { { -0.01, -0.06 }, { 0.01, -0.06 }, { 0, 0 } };
    const double wall[][2] = { { -0.04, -2e-4 }, { 0.04, -2e-4 }, { 0.04, 0 }, { -0.04, 0 } };
    const double cube[][2] = { { -0.003, -0.003 }, { 0.003, -0.003 }, { 0.003, 0.003 }, { -0.003, 0.003 } };
    const double of_slot = sqrt(0.08 * 0.08 + 0.04 * 0.04 + 0.06 * 0.06);
    const double of_hole = sqrt(2 * 0.08 * 0.08 + 0.02 * 0.02);
    return solid_from_outline(&solids[BLOCK], "block", block, 4, 0.03) &&
           make_slot(&solids[WIDE_SLOT], "wide slot", RADIUS + 2e-6 * of_slot) &&
           make_slot(&solids[NARROW_SLOT], "narrow slot", RADIUS - 2e-6 * of_slot) &&
           solid_with_hole(&solids[WIDE_HOLE], "wide hole", RADIUS + 1e-5 * of_hole, 0.04, 0.02) &&
           solid_with_hole(&solids[NARROW_HOLE], "narrow hole", RADIUS - 1e-5 * of_hole, 0.04, 0.02) &&
           make_notch(&solids[NOTCH], "notch", 0.017) && make_notch(&solids[SHARP_NOTCH], "sharp notch", 0.004) &&
           solid_from_outline(&solids[WEDGE], "wedge", wedge, 3, 0.02) &&
           solid_from_outline(&solids[WALL], "wall", wall, 4, 0.04) &&
           solid_from_net(&solids[SHEET], "sheet", 6, 6, 0, flat_sheet) &&
           solid_from_outline(&solids[CUBE], "cube", cube, 4, 0.003);
}

static dpt_pose at(double x, double y, double z)
{
    const dpt_pose pose = { { x, y, z }, { 1, 0, 0, 0 } };
    return pose;
}

static void add_one(struct visit *visit, int solid, double x, double y, double z)
{
    const dpt_pose pose = at(x, y, z);
    visit_add(visit, &solids[solid], &pose);
}

/* Two blocks beside each other: a slot that is wide enough by 1e-5 of their diagonal. */
static void add_pair(struct visit *visit)
{
    const double gap = RADIUS + 1e-5 * solids[BLOCK].diagonal;
    add_one(visit, BLOCK, gap, 0, 0);
    add_one(visit, BLOCK, -0.06 - gap, 0, 0);
}

/* A floor and two walls. */
static void add_inner_corner(struct visit *visit)
{
    add_one(visit, BLOCK, -0.02, 0, -0.01);
    add_one(visit, BLOCK, 0.035, 0, 0.03);
    add_one(visit, BLOCK, -0.02, 0.05, 0.03);
}

static void add_crowd(struct visit *visit)
{
    for (int i = 0; i < VISIT_BODIES; i++) {
        const double axis[3] = { 0.6, 0, 0.8 };
        dpt_pose pose = at(0.0095 * (i % 5 - 2), 0.0105 * (i / 5 % 5 - 2), -0.005 - 0.011 * (i / 25));
        pose_orient(&pose, axis, 0.37 * i);
        visit_add(visit, &solids[CUBE], &pose);
    }
}

struct hard_place {
    const char *name;
    int solid; /* or -1 */
    double x, y;
    void (*add)(struct visit *visit);
    double slope; /* of the lead: so much aside for each metre down */
};

static const struct hard_place hard_places[] = {
    { "corner", BLOCK, 0, 0.03, NULL, 0.3 },
    { "edge", BLOCK, 0, 0, NULL, 0.3 },
    { "wide slot", WIDE_SLOT, 0, 0, NULL, 0 },
    { "narrow slot", NARROW_SLOT, 0, 0, NULL, 0 },
    { "wide hole", WIDE_HOLE, 0, 0, NULL, 0 },
    { "narrow hole", NARROW_HOLE, 0, 0, NULL, 0 },
    { "notch", NOTCH, 0, 0, NULL, 0.1 },
    { "sharp notch", SHARP_NOTCH, 0, 0, NULL, 0 },
    { "wedge", WEDGE, 0, 0, NULL, 0.1 },
    { "wall", WALL, 0, 0, NULL, 0.5 },
    { "border", SHEET, -0.002, 0, NULL, -0.3 },
    { "two bodies", -1, 0, 0, add_pair, 0 },
    { "inner corner", -1, 0, 0, add_inner_corner, 1.1 },
    { "crowd", -1, 0, 0, add_crowd, 0.2 },
};
enum { HARD_PLACES = sizeof hard_places / sizeof *hard_places };

/* A closed path: down by `depth` and up again, wandering; it begins and ends `above` z = 0. */
struct path {
    double above, depth, slope, wander, tilt, phase;
    double way[3], spin[3];
    double start[3];
};

static void pose_on(const struct path *path, double t, dpt_pose *pose)
{
    const double angle = 2 * 3.14159265358979323846 * t;
    const double down = 0.5 * (1 - cos(angle)) * (path->above + path->depth);
    const double x[3] = { path->slope * down, 0.3 * path->slope * down, path->above - down };
    for (int k = 0; k < 3; k++)
        pose->position[k] =
            path->start[k] + x[k] + path->wander * path->way[k] * (sin(2 * angle) + 0.3 * sin(3 * angle));
    pose_orient(pose, path->spin, path->tilt * (sin(angle + path->phase) - sin(path->phase)));
}

/* So many ticks that none moves the tool by more than 0.05 mm. */
static int ticks_of(const struct visit *visit, const struct path *path)
{
    enum { PARTS = 400 };
    double farthest = 0;
    dpt_pose last, pose;
    pose_on(path, 0, &last);
    for (int i = 1; i <= PARTS; i++) {
        pose_on(path, (double)i / PARTS, &pose);
        farthest = fmax(farthest, poses_apart(visit, &last, &pose));
        last = pose;
    }
    return (int)(PARTS * farthest / 4.8e-5) + 1;
}

/* The device rests: so does the proxy, after some ticks, as near to it as the place allows. */
static void hold(struct visit *visit)
{
    enum { SETTLING = 30, TICKS = 50 };
    dpt_pose before = visit->proxy;
    for (int i = 0; i < TICKS && !visit->is_replaced; i++) {
        visit_tick(visit);
        if (i == SETTLING)
            before = visit->proxy;
    }
    if (visit->is_replaced)
        return;
    const double off = poses_apart(visit, &visit->proxy, &visit->device);
    const double moved = poses_apart(visit, &visit->proxy, &before);
    CHECK(moved <= 0.01 * off + visit->clearance, "%s: at rest it moves by %g of %g m", visit->name, moved, off);
    CHECK(visit->rig.force.lag <= 0.01 * off + visit->clearance, "%s: at rest it lags by %g of %g m", visit->name,
          visit->rig.force.lag, off);
}

static void lead(struct visit *visit, const struct path *path)
{
    const int ticks = ticks_of(visit, path);
    pose_on(path, 0, &visit->rig.device);
    visit_begin(visit);
    for (int i = 1; i <= ticks && !visit->is_replaced; i++) {
        pose_on(path, (double)i / ticks, &visit->rig.device);
        visit_tick(visit);
        if (i % (ticks / 5) == ticks / 10)
            hold(visit);
    }
    if (!visit->is_replaced)
        visit_end(visit);
}

static uint64_t acts, folds, lagging, replaced;

static void visit_place(const struct hard_place *place, const struct instrument *instrument, uint64_t seed)
{
    struct visit visit;
    char name[64];
    snprintf(name, sizeof name, "%s, %s, %u", place->name, instrument->name, (unsigned)seed);
    visit_open(&visit, name, instrument->segments, instrument->count);
    if (place->add)
        place->add(&visit);
    else
        add_one(&visit, place->solid, place->x, place->y, 0);
    seed = 1 + 100 * seed;
    struct path path = { .above = 0.015,
                         .depth = random_in(&seed, 0.003, 0.012),
                         .slope = place->slope,
                         .wander = random_in(&seed, 0, 0.004),
                         .tilt = random_in(&seed, 0, 0.4),
                         .phase = random_in(&seed, 0, 6) };
    random_unit(&seed, path.way);
    random_unit(&seed, path.spin);
    path.start[0] = random_in(&seed, -0.001, 0.001);
    path.start[1] = random_in(&seed, -0.001, 0.001);
    lead(&visit, &path);
    acts += visit.acts;
    folds += visit.folds;
    lagging += visit.lagging;
    replaced += (uint64_t)visit.is_replaced;
    visit_close(&visit);
}

/* Each place with each instrument. */
static void no_trap_and_no_throw(void)
{
    enum { SEEDS = 2 };
    for (uint64_t i = 0; i < HARD_PLACES * INSTRUMENTS * SEEDS; i++)
        if ((i + 1) * check_percent / 100 > i * check_percent / 100)
            visit_place(&hard_places[i / SEEDS / INSTRUMENTS], &instruments[i / SEEDS % INSTRUMENTS], i % SEEDS);
    printf("    %llu ticks with a force, %llu folds, %llu lag by more than 1 %%\n", (unsigned long long)acts,
           (unsigned long long)folds, (unsigned long long)lagging);
    CHECK(100 * replaced <= HARD_PLACES * INSTRUMENTS * SEEDS, "%llu visits end 1 rad off",
          (unsigned long long)replaced);
    CHECK(200 * lagging <= acts, "%llu of %llu ticks lag", (unsigned long long)lagging, (unsigned long long)acts);
}

/* Straight down over the middle of an opening: what is wide enough is entered, what is too narrow never. */
static void openings_are_entered_if_wide_enough(void)
{
    static const struct {
        int solid, is_wide;
    } openings[] = { { WIDE_SLOT, 1 }, { NARROW_SLOT, 0 }, { WIDE_HOLE, 1 }, { NARROW_HOLE, 0 } };
    for (size_t i = 0; i < sizeof openings / sizeof *openings; i++)
        for (int k = 0; k < 2; k++) {
            struct visit visit;
            const struct solid *solid = &solids[openings[i].solid];
            const struct path path = { .above = 0.005,
                                       .depth = 0.012,
                                       .way = { 0, 1, 0 },
                                       .spin = { 1, 0, 0 },
                                       .start = { 0, openings[i].solid < WIDE_HOLE ? 0.003 : 0, 0 } };
            double ends[6];
            visit_open(&visit, solid->name, instruments[k].segments, 1);
            add_one(&visit, openings[i].solid, 0, 0, 0);
            const int ticks = ticks_of(&visit, &path);
            pose_on(&path, 0, &visit.rig.device);
            visit_begin(&visit);
            for (int t = 1; t <= ticks; t++) {
                pose_on(&path, (double)t / ticks, &visit.rig.device);
                visit_tick(&visit);
                rig_proxy_ends(&visit.rig, 0, ends);
                CHECK(openings[i].is_wide || ends[2] > 0, "%s is entered, %g", solid->name, ends[2]);
                CHECK(!openings[i].is_wide || fabs(ends[2] - visit.rig.device.position[2]) < 1e-5,
                      "%s, %s: at %g, not %g", solid->name, instruments[k].name, ends[2], visit.rig.device.position[2]);
            }
            visit_end(&visit);
            visit_close(&visit);
        }
}

/* Lying in a slot that just fits it, off its middle, a tool comes out again. */
static void a_slot_that_fits_is_no_trap(void)
{
    const uint64_t lying_one = 3;
    for (uint64_t seed = 0; seed < part_of(16); seed++)
        visit_place(&hard_places[2], &instruments[lying_one], seed);
}

/* Bodies of a slot move by `shift` from where they were put, and the last one nearer to the first. */
static void shift_bodies(struct visit *visit, const dpt_pose *first, double shift, double nearer)
{
    for (uint32_t b = 0; b < visit->body_count; b++) {
        dpt_pose pose = first[b];
        pose.position[0] += b > 0 ? shift + nearer : shift;
        pose.position[1] += 0.5 * shift;
        visit_move(visit, &visit->bodies[b], &pose);
    }
}

/* A slot moves, and the tool in it with it, the device held where it was. */
static void move_slot(struct visit *visit, const char *name, double nearer)
{
    const struct path path = { .above = 0.005, .depth = 0.012, .way = { 0, 1, 0 }, .spin = { 1, 0, 0 } };
    const dpt_pose first[2] = { visit->bodies[0].pose, visit->bodies[1].pose };
    pose_on(&path, 0, &visit->rig.device);
    visit_begin(visit);
    for (int t = 1; t <= 1000; t++) {
        const double shift = t < 500 ? 0 : 0.004 * sin(0.0126 * (t - 500));
        double ends[6];
        pose_on(&path, fmin(0.5, t / 1000.0), &visit->rig.device);
        if (t >= 500)
            shift_bodies(visit, first, shift, nearer);
        visit_tick(visit);
        rig_proxy_ends(&visit->rig, 0, ends);
        CHECK(fabs(ends[0] - shift) < 2e-5, "%s, %s, tick %d: at %g, not %g", visit->name, name, t, ends[0], shift);
        CHECK(!(visit->rig.force.flags & DPT_FORCE_FLAG_SQUEEZED), "%s, %s, tick %d: squeezed", visit->name, name, t);
    }
}

static void a_slot_that_moves_takes_the_tool_with_it(void)
{
    for (int k = 0; k < 5; k++) {
        const char *names[] = { "two that move", "slot that moves", "two that close" };
        const struct instrument *instrument = &instruments[k % 2];
        struct visit visit;
        visit_open(&visit, names[k / 2], instrument->segments, 1);
        if (k / 2 == 1)
            add_one(&visit, WIDE_SLOT, 0, 0, 0);
        else
            add_pair(&visit);
        /* The pair leaves 5 clearances on either side; those that close leave 0.8, to the ball alone. */
        move_slot(&visit, instrument->name, k / 2 == 2 ? 8.4 * visit.clearance : 0);
        visit_close(&visit);
    }
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    if (!make_solids())
        return 1;
    TEST(no_trap_and_no_throw);
    TEST(openings_are_entered_if_wide_enough);
    TEST(a_slot_that_fits_is_no_trap);
    TEST(a_slot_that_moves_takes_the_tool_with_it);
    for (int i = 0; i < SOLIDS; i++)
        solid_close(&solids[i]);
    return check_report();
}
