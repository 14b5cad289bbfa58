/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Proxies that a budget makes wait (docs/algorithms/force.md, Budgets): a tool slides fast over a mesh, in and out, once in
 * a world with a budget and once in one without. No force jumps, whatever the budget; what is felt is that of the other
 * world, near enough, or the tick says that it is not; nothing is entered; and what comes to rest is where it would be.
 * Norms are worked out here, from the tool's ends.
 *
 *     test_proxy_waits [PER CENT of the ticks = 100]
 */
#include "lib/rig.h"
#include "lib/solid.h"
#include "proxy/swept_rig.h"

#define LENGTH 0.2
#define RADIUS 0.004

static const dpt_segment rod = { { 0, 0, 0 }, { 0, 0, LENGTH }, RADIUS };

/* m^2: of a straight tool, about its middle. */
static const double rho2 = LENGTH * LENGTH / 12;

/* m/s: how fast a proxy may move beside its device, in a fold. */
#define FOLD_SPEED 1.0

/* A tool in a world of its own, and what it felt in the last tick: the force, and the torque about its middle over rho. */
struct hand {
    struct rig rig;
    double felt[6], before[6];
    int faded; /* a fade was under way, or is */
};

/* Units of a step, and of its sweeps; 0: all that it needs. */
struct limits {
    uint32_t budget, sweep;
};

static const struct {
    const char *name;
    uint64_t triangles;
} meshes[] = { { "liver", 20000 },  { "torus", 20000 }, { "star", 8000 },
               { "sphere", 20000 }, { "cloth", 5000 },  { "box", 12 } };

enum { MESHES = sizeof meshes / sizeof *meshes, SLIDES = 4 };

static void open_hand(struct hand *hand, const struct solid *solid, struct limits limits)
{
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    def.budget = limits.budget;
    def.sweep_budget = limits.sweep;
    def.max_contacts = 0;
    memset(hand, 0, sizeof *hand);
    rig_open(&hand->rig, &def, solid->mesh, &rod, 1);
}

/* The pose of the rod at two ends: least turned from z. */
static void pose_of(const double ends[6], dpt_pose *pose)
{
    double u[3], axis[3];
    for (int k = 0; k < 3; k++)
        u[k] = ends[3 + k] - ends[k];
    unit3(u);
    const double across[3] = { -u[1], u[0], 0 };
    memcpy(axis, across, sizeof axis);
    if (unit3(axis) == 0)
        axis[0] = 1;
    pose_orient(pose, axis, acos(fmax(-1, fmin(1, u[2]))));
    memcpy(pose->position, ends, sizeof pose->position);
}

/* |motion|_M of a straight tool from one pair of ends to another, m. */
static double norm_of(const double from[6], const double to[6])
{
    double shift[3], u[3], v[3];
    for (int k = 0; k < 3; k++) {
        shift[k] = 0.5 * (to[k] + to[k + 3] - from[k] - from[k + 3]);
        u[k] = from[k + 3] - from[k];
        v[k] = to[k + 3] - to[k];
    }
    unit3(u);
    unit3(v);
    const double turn = 2 * asin(fmin(1, 0.5 * apart(u, v)));
    return sqrt(dot3(shift, shift) + rho2 * turn * turn);
}

static double difference(const double a[6], const double b[6])
{
    return sqrt(pow(apart(a, b), 2) + pow(apart(a + 3, b + 3), 2));
}

/* A wrench about end a. */
static void weigh(const dpt_wrench *wrench, const double ends[6], double felt[6])
{
    const double *F = wrench->force;
    double arm[3];
    for (int k = 0; k < 3; k++)
        arm[k] = 0.5 * (ends[k] - ends[k + 3]);
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        felt[k] = F[k];
        felt[k + 3] = (wrench->torque[k] + arm[i] * F[j] - arm[j] * F[i]) / sqrt(rho2);
    }
}

static void step_hand(struct hand *hand, const double ends[6])
{
    const uint32_t fades = DPT_FORCE_FLAG_FADING | DPT_FORCE_FLAG_REPLACED;
    const int faded = (hand->rig.force.flags & fades) != 0;
    memcpy(hand->before, hand->felt, sizeof hand->before);
    pose_of(ends, &hand->rig.device);
    rig_step(&hand->rig);
    hand->faded = faded || (hand->rig.force.flags & fades) != 0;
    weigh(&hand->rig.force.wrench, ends, hand->felt);
}

static int is_behind(const struct hand *hand)
{
    return (hand->rig.force.flags & DPT_FORCE_FLAG_BEHIND) != 0;
}

static double gap_of(const struct hand *hand, const struct solid *solid)
{
    double ends[6];
    rig_proxy_ends(&hand->rig, 0, ends);
    return oracle_brute(solid->brute, ends, NULL) - RADIUS;
}

static double size_of(const double felt[6])
{
    static const double none[6] = { 0 };
    return difference(felt, none);
}

/* The spring from the device to where the proxy is. */
static void pull_of(const struct hand *hand, const double device[6], double pull[6])
{
    double proxy[6], u[3], v[3], turn[3];
    rig_proxy_ends(&hand->rig, 0, proxy);
    for (int k = 0; k < 3; k++) {
        pull[k] = RIG_STIFFNESS * 0.5 * (proxy[k] + proxy[k + 3] - device[k] - device[k + 3]);
        u[k] = device[k + 3] - device[k];
        v[k] = proxy[k + 3] - proxy[k];
    }
    unit3(u);
    unit3(v);
    for (int k = 0; k < 3; k++)
        turn[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    const double sine = unit3(turn), angle = atan2(sine, dot3(u, v));
    for (int k = 0; k < 3; k++)
        pull[k + 3] = RIG_STIFFNESS * sqrt(rho2) * angle * turn[k];
}

struct tally {
    unsigned ticks, behind, rested, elsewhere;
    double jump;       /* of what is allowed, the largest */
    double error, off; /* N, sums of the ticks that are behind: of what is felt, and of the spring */
    double growth;     /* N, the largest of a tick that leaves a longer way than one tick's */
    double gap;        /* m, the least */
};

/* One tick of a world with a budget and of one without. */
static void judge_tick(const struct solid *solid, struct hand *hand, struct hand *whole, const double from[6],
                       const double to[6], struct tally *tally)
{
    const double allowed = RIG_STIFFNESS * (3 * norm_of(from, to) + FOLD_SPEED * RIG_DT);
    step_hand(hand, to);
    step_hand(whole, to);
    tally->ticks++;
    if (!hand->faded)
        tally->jump = fmax(tally->jump, difference(hand->felt, hand->before) / allowed);
    if (is_behind(hand)) {
        double pull[6];
        pull_of(hand, to, pull);
        tally->behind++;
        if (hand->rig.force.lag > allowed / RIG_STIFFNESS && !hand->faded)
            tally->growth = fmax(tally->growth, size_of(hand->felt) - size_of(hand->before));
        tally->error += difference(hand->felt, whole->felt);
        tally->off += difference(pull, whole->felt);
    }
    CHECK(!is_behind(whole), "%s: behind without a budget", solid->name);
    if (tally->ticks % 8 == 0 && hand->rig.force.reason <= DPT_FORCE_FREE)
        tally->gap = fmin(tally->gap, gap_of(hand, solid));
}

static void step_both(struct hand *hand, struct hand *whole, const double ends[6])
{
    step_hand(hand, ends);
    step_hand(whole, ends);
}

/* With less than that a proxy crawls, for longer than a test may last. */
static int arrives(struct limits limits)
{
    return limits.sweep >= 150 || limits.budget >= 200;
}

/* At 1.5 m/s and 10 rad/s along the mesh, in and out of it; then the device rests. */
static void slide_with(const struct solid *solid, struct limits limits, uint64_t seed, struct tally *tally)
{
    enum { TICKS = 730, RESTS = 3000, SURE = 200 };
    struct hand hand, whole;
    struct slide slide;
    open_hand(&hand, solid, limits);
    open_hand(&whole, solid, (struct limits){ 0, 0 });
    slide_begin(&slide, solid, seed, LENGTH, RADIUS);
    slide.step = 1.5e-3;
    slide.spin = 0.01;
    for (int i = 0; i < 20; i++)
        step_both(&hand, &whole, slide.ends);
    for (int i = 0; i < TICKS; i++) {
        double from[6];
        memcpy(from, slide.ends, sizeof from);
        slide.gap = -0.75 * RADIUS * sin(0.02 * i);
        slide_step(&slide);
        judge_tick(solid, &hand, &whole, from, slide.ends, tally);
    }
    for (int i = 0; i < RESTS && (is_behind(&hand) || i < SURE); i++)
        step_both(&hand, &whole, slide.ends);
    for (int i = 0; i < SURE; i++)
        step_both(&hand, &whole, slide.ends);
    CHECK(!is_behind(&hand) || !arrives(limits), "%s, %u and %u units: behind at rest, lag %g", solid->name,
          limits.budget, limits.sweep, hand.rig.force.lag);
    CHECK(!arrives(limits) || hand.rig.step.work == whole.rig.step.work,
          "%s, %u and %u units: at rest it takes %u units, and not %u", solid->name, limits.budget, limits.sweep,
          hand.rig.step.work, whole.rig.step.work);
    tally->rested += arrives(limits) ? 1 : 0;
    tally->elsewhere += arrives(limits) && difference(hand.felt, whole.felt) > 0.02;
    rig_close(&hand.rig);
    rig_close(&whole.rig);
}

static struct tally tally_of(const struct solid *solid, struct limits limits)
{
    struct tally tally = { .gap = INFINITY };
    for (uint64_t seed = 1; seed <= part_of(SLIDES); seed++)
        slide_with(solid, limits, seed, &tally);
    printf("    %s, %u and %u units: %u of %u ticks behind, jump %.3f of what is allowed, off by "
           "%.3g N, and not %.3g; %u rest elsewhere\n",
           solid->name, limits.budget, limits.sweep, tally.behind, tally.ticks, tally.jump,
           tally.behind ? tally.error / tally.behind : 0, tally.behind ? tally.off / tally.behind : 0, tally.elsewhere);
    return tally;
}

/* Slide over all meshes with each of the limits. */
static void slide_over_all(const struct limits *limits, size_t count,
                           void (*judge)(const struct solid *solid, const struct tally *tally))
{
    for (size_t m = 0; m < MESHES; m++) {
        struct solid solid;
        if (!solid_from_shape(&solid, meshes[m].name, meshes[m].triangles))
            continue;
        for (size_t i = 0; i < count; i++) {
            const struct tally tally = tally_of(&solid, limits[i]);
            judge(&solid, &tally);
        }
        solid_close(&solid);
    }
}

static unsigned rested, rested_elsewhere;
static double error, off; /* N, sums over all ticks that are behind */

static void judge_few(const struct solid *solid, const struct tally *tally)
{
    CHECK(tally->jump <= 1 + 1e-6, "%s: jumps by %.3f of what is allowed", solid->name, tally->jump);
    CHECK(tally->growth <= 1e-9, "%s: grows by %g N", solid->name, tally->growth);
    CHECK(tally->gap > 0, "%s: gap %g", solid->name, tally->gap);
    error += tally->error;
    off += tally->off;
    rested += tally->rested;
    rested_elsewhere += tally->elsewhere;
}

static void no_budget_makes_the_force_jump(void)
{
    static const struct limits few[] = { { 0, 20 }, { 0, 60 }, { 0, 150 }, { 60, 0 }, { 200, 0 } };
    slide_over_all(few, sizeof few / sizeof *few, judge_few);
    CHECK(error < 0.2 * off, "off by %g N in all, where the spring is by %g", error, off);
    CHECK(rested > 0 && rested_elsewhere * 20 <= rested, "%u of %u rest elsewhere", rested_elsewhere, rested);
}

static void judge_ample(const struct solid *solid, const struct tally *tally)
{
    CHECK(!tally->behind && !tally->elsewhere && tally->rested, "%s: %u ticks behind, %u elsewhere", solid->name,
          tally->behind, tally->elsewhere);
}

/* A budget that no tick needs changes nothing. */
static void an_ample_budget_is_none(void)
{
    static const struct limits ample[] = { { 0, 1000000 }, { 1000000, 0 } };
    slide_over_all(ample, sizeof ample / sizeof *ample, judge_ample);
}

/* What a free way leads to is not felt, however late the proxy comes there. */
static void nothing_pulls_in_the_open(void)
{
    enum { JUMPS = 400, TICKS = 40 };
    struct solid torus;
    uint64_t seed = 5;
    unsigned late = 0;
    if (!solid_from_shape(&torus, "torus", 60000))
        return;
    struct hand hand, whole;
    open_hand(&hand, &torus, (struct limits){ 0, 20 });
    open_hand(&whole, &torus, (struct limits){ 0, 0 });
    rig_use_sweeps(&hand.rig);
    for (uint64_t i = 0; i < part_of(JUMPS); i++) {
        double ends[6], direction[3];
        random_unit(&seed, direction);
        for (int k = 0; k < 3; k++) {
            ends[k] = random_in(&seed, -0.2, 0.2);
            ends[k + 3] = ends[k] + LENGTH * direction[k];
        }
        pose_of(ends, &hand.rig.device);
        whole.rig.device = hand.rig.device;
        rig_place(&hand.rig);
        rig_place(&whole.rig);
        if (whole.rig.force.reason != DPT_FORCE_FREE)
            continue;
        for (int k = 0; k < 6; k++)
            ends[k] += (k % 3 == 2 ? 0.1 : 0.05) * (i % 2 ? 1 : -1);
        step_both(&hand, &whole, ends);
        if (whole.rig.force.reason != DPT_FORCE_FREE)
            continue;
        late += hand.rig.force.reason != DPT_FORCE_FREE;
        for (int t = 0; t < TICKS; t++) {
            CHECK(rig_force(&hand.rig) <= 1e-6, "jump %u, tick %d: %g N in the open", (unsigned)i, t,
                  rig_force(&hand.rig));
            step_hand(&hand, ends);
        }
    }
    printf("    %u came later\n", late);
    CHECK(late >= least_seen(4), "%u", late);
    rig_close(&hand.rig);
    rig_close(&whole.rig);
    solid_close(&torus);
}

/*
 * The device is pressed into the top of a box, and jumps off its edge; the proxy is swept. What is felt when the proxy,
 * late, has come round the edge to the device ends no faster than at the speed of a fold.
 */
static void a_push_ends_in_pace(void)
{
    struct solid box;
    unsigned later = 0;
    if (!solid_from_shape(&box, "box", 20172))
        return;
    const double side = box.info.box_max[0], top = box.info.box_max[2] + RADIUS;
    for (uint32_t sweep = 20; sweep <= 140; sweep += 5) {
        double ends[6] = { 0.5 * side, -0.5 * LENGTH, top + 0.003, 0.5 * side, 0.5 * LENGTH, top + 0.003 };
        struct hand hand;
        open_hand(&hand, &box, (struct limits){ 0, sweep });
        rig_use_sweeps(&hand.rig);
        pose_of(ends, &hand.rig.device);
        rig_place(&hand.rig);
        for (int i = 0; i < 100; i++) {
            ends[2] -= 8e-5;
            ends[5] -= 8e-5;
            step_hand(&hand, ends);
        }
        CHECK(hand.rig.force.reason == DPT_FORCE_ACTS, "reason %u", hand.rig.force.reason);
        ends[0] = ends[3] = side + RADIUS + 0.001;
        step_hand(&hand, ends);
        for (int i = 0; i < 2000; i++) {
            step_hand(&hand, ends);
            const int is_there = !memcmp(&hand.rig.proxy, &hand.rig.device, sizeof hand.rig.proxy);
            const double jump = difference(hand.felt, hand.before);
            CHECK(jump <= RIG_STIFFNESS * FOLD_SPEED * RIG_DT * (1 + 1e-6), "%u units: %g N", sweep, jump);
            later += is_there && size_of(hand.felt) > 0;
            CHECK(!is_there || is_behind(&hand) || size_of(hand.felt) == 0, "%u units: %g N", sweep,
                  size_of(hand.felt));
        }
        CHECK(hand.rig.force.reason == DPT_FORCE_FREE ? hand.rig.step.work == 0 : is_behind(&hand),
              "%u units: reason %u, %u units at rest", sweep, hand.rig.force.reason, hand.rig.step.work);
        rig_close(&hand.rig);
    }
    printf("    a push ended %u ticks after the proxy was there\n", later);
    CHECK(later > 0, "none ended later");
    solid_close(&box);
}

/* m: of a wall's waves. No plane of one triangle keeps a tool in front of them all. */
#define WAVE 0.02

static void place_wall(double u, double v, double x[3])
{
    x[0] = u - 0.5;
    x[1] = v - 0.5;
    x[2] = WAVE * sin(60 * u) * sin(60 * v);
}

/* The device jumps through a wall and shakes behind it; the proxy is swept. What no sweep has ended is no way. */
static void no_wall_is_passed(void)
{
    enum { JUMPS = 400, TICKS = 30 };
    struct solid wall;
    uint64_t seed = 11;
    unsigned behind = 0, replaced = 0;
    if (!solid_from_net(&wall, "wall", 120, 120, 0, place_wall))
        return;
    for (uint64_t i = 0; i < part_of(JUMPS); i++) {
        double ends[6], at[6], lowest = INFINITY;
        int is_replaced = 0;
        struct hand hand;
        open_hand(&hand, &wall, (struct limits){ 0, 10 + 10 * (uint32_t)(i % 8) });
        rig_use_sweeps(&hand.rig);
        for (int k = 0; k < 3; k++) {
            ends[k] = random_in(&seed, k < 2 ? -0.1 : 0.03, k < 2 ? 0.1 : 0.05);
            ends[k + 3] = ends[k] + random_in(&seed, k == 0 ? 0.06 : 0.0, k == 2 ? 0.05 : 0.1);
        }
        pose_of(ends, &hand.rig.device);
        rig_place(&hand.rig);
        const double deep = random_in(&seed, 0.15, 0.3);
        for (int t = 0; t < TICKS; t++) {
            for (int k = 0; k < 3; k++) {
                const double shift = random_in(&seed, -0.002, 0.002) - (k == 2 ? deep : 0);
                at[k] = ends[k] + shift;
                at[k + 3] = ends[k + 3] + shift;
            }
            step_hand(&hand, at);
            behind += (unsigned)is_behind(&hand);
            rig_proxy_ends(&hand.rig, 0, at);
            is_replaced |= (hand.rig.force.flags & DPT_FORCE_FLAG_REPLACED) != 0;
            if (!is_replaced && hand.rig.force.reason <= DPT_FORCE_FREE)
                lowest = fmin(lowest, fmin(at[2], at[5]));
        }
        replaced += (unsigned)is_replaced;
        CHECK(lowest > -WAVE, "jump %u: an end of the proxy is at %g", (unsigned)i, lowest);
        rig_close(&hand.rig);
    }
    printf("    %u ticks behind, %u jumps end 1 rad off\n", behind, replaced);
    CHECK(behind >= part_of(JUMPS) && replaced * 20 <= part_of(JUMPS), "%u, %u", behind, replaced);
    solid_close(&wall);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(no_budget_makes_the_force_jump);
    TEST(an_ample_budget_is_none);
    TEST(nothing_pulls_in_the_open);
    TEST(a_push_ends_in_pace);
    TEST(no_wall_is_passed);
    return check_report();
}
