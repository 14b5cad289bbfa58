/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The bed over organs: its wrench jumps no more than that of a quadrature at the same poses, and closed paths yield no
 * work. The quadrature's signed distances and ways out are those of the library's query, some of them held against brute
 * force and solid angles; it cannot judge open sheets.
 *
 *     test_bed_organs            1,000 closed paths and 80 traces a mesh, an hour
 *     test_bed_organs PERCENT    so much of it
 *
 * Real meshes from DPT_DATA.
 */
#include "world/bed_lead.h"

#define STEP    5e-5
#define DEEP    0.01  /* m: bounds of jumps are for tools up to here */
#define SHALLOW 0.002 /* what does not come as deep has no peak to speak of */

enum { TRACES = 80, PATHS = 1000 };

enum { JUMPS = 1, WORK = 2 };

struct subject {
    const char *name;   /* of a shape, or of a file below meshes */
    uint64_t triangles; /* of a shape */
    double scale;       /* of a file */
    /*
     * Of all traces, those with a wall that no sample shows (contacts.md, "Hidden walls"). They jump by more: by up to
     * 5.6 % of the peak on the pancreas, 2.0 % on liver_sks and 1.5 % on the gallbladder. Finer tolerances do not help.
     */
    uint32_t hidden;
    uint32_t unjudged; /* what is told, but not judged */
};

static const struct subject shapes[] = {
    { "liver", 8000, 0, 0, 0 },
    { "torus", 5568, 0, 0, 0 },
    { "stomach", 6000, 0, 0, 0 },
    { "spleen", 4000, 0, 0, 0 },
};

static const struct subject organs[] = {
    { "organs/openhelp_liver.stl", 0, 0.001, 0, 0 },    { "organs/openhelp_stomach.stl", 0, 0.001, 0, 0 },
    { "organs/openhelp_spleen.stl", 0, 0.001, 0, 0 },   { "organs/openhelp_kidney_left.stl", 0, 0.001, 0, 0 },
    { "organs/openhelp_duodenum.stl", 0, 0.001, 0, 0 }, { "organs/openhelp_pancreas.stl", 0, 0.001, 2, 0 },
    { "organs/liver_patient_sks.obj", 0, 0.001, 1, 0 }, /* a torque that nearly cancels all along */
    { "organs/liver_sks.ply", 0, 0.001, 2, 0 },         { "organs/gallbladder_low.stl", 0, 0.001, 0, 0 },
    { "organs/gallbladder_fine.stl", 0, 0.001, 2, 0 },  { "organs/pelvis_sofa.obj", 0, 0.13, 0, 0 },
};

/*
 * Their inside is told by the winding number. On two the samples do not suffice, and work is told, not judged: up to
 * 0.4 % on liver_metres, 2.5 % on the skull with its teeth, whose wrenches are up to 36 % off and jump by up to 39 %. The
 * quadrature's energy takes no step there.
 */
static const struct subject badly_closed[] = {
    { "organs/liver_dirty_low.stl", 0, 0.001, 0, 0 },
    { "organs/liver_dirty_fine.stl", 0, 0.001, 0, 0 },
    { "organs/liver_metres.stl", 0, 1, 0, WORK },
    { "organs/liver_smooth_sofa.obj", 0, 0.03, 0, 0 },
    { "organs/skull_and_teeth_sofa.obj", 0, 0.025, 0, JUMPS | WORK },
};

enum { FORCE, TORQUE, ENERGY, KINDS };
static const char *const kind_names[KINDS] = { "force", "torque", "energy" };

/* Of the peak: of a jump beyond the quadrature's own, and of the difference from it. */
struct bounds {
    double jump[KINDS], off[KINDS];
};
static const struct bounds of_closed = { { 0.005, 0.025, 0.005 }, { 0.02, 0.05, 0.01 } };
static const struct bounds of_winding = { { 0.08, 0.08, 0.08 }, { 0.1, 0.1, 0.1 } };

/* A mesh, with what its runs gave. */
struct run {
    const struct subject *subject;
    struct solid solid;
    struct rig lead;
    const struct bounds *bounds;
    int winds;
    uint64_t traces, judged, traces_beyond;
    double off[KINDS], jump[KINDS];
    uint64_t paths, paths_beyond, paths_above, undecided;
    double most_work;
};

struct tick {
    double t, ends[6];
    struct bed_felt felt;
    struct bed_truth truth;
    int is_judged;
};

struct trace {
    struct bed_path path;
    struct tick *ticks;
    uint32_t count; /* ticks 0..count */
};

static struct bed_felt minus(const struct bed_felt *a, const struct bed_felt *b)
{
    struct bed_felt d = { .energy = a->energy - b->energy };
    for (int k = 0; k < 3; k++) {
        d.force[k] = a->force[k] - b->force[k];
        d.torque[k] = a->torque[k] - b->torque[k];
    }
    return d;
}

static double size_of(const struct bed_felt *felt, int kind)
{
    const double *v = kind == FORCE ? felt->force : felt->torque;
    return kind == ENERGY ? fabs(felt->energy) : sqrt(dot3(v, v));
}

static double size_of_difference(const struct bed_felt *a, const struct bed_felt *b, int kind)
{
    const struct bed_felt d = minus(a, b);
    return size_of(&d, kind);
}

/* Lead the tool once round. Returns 0 if there is nothing to judge. */
static int lead_round(struct run *run, struct trace *trace)
{
    int felt = 0;
    if (!bed_lead_begin(&run->lead, &run->solid, &trace->path))
        return 0;
    trace->count = bed_path_ticks(&trace->path, STEP);
    trace->ticks = calloc(trace->count + 1, sizeof *trace->ticks);
    for (uint32_t i = 0; trace->ticks && i <= trace->count; i++) {
        struct tick *tick = &trace->ticks[i];
        dpt_pose pose;
        tick->t = (double)i / trace->count;
        bed_path_at(&trace->path, tick->t, &pose, tick->ends);
        tick->felt = bed_lead_to(&run->lead, &trace->path, tick->t);
        run->undecided += run->lead.force.reason == DPT_FORCE_UNDECIDED;
        felt |= run->lead.force.reason == DPT_FORCE_ACTS;
    }
    if (!felt)
        free(trace->ticks);
    return felt;
}

/* Those with the largest changes of a change, which are likely jumps; and blocks all along the contact. */
static void choose_ticks(struct trace *trace)
{
    enum { BLOCKS = 5, BLOCK = 10, SUSPECTS = 8 };
    struct tick *tick = trace->ticks;
    uint32_t from = 0, to = trace->count;
    while (!(tick[from].felt.energy > 0))
        from++;
    while (!(tick[to].felt.energy > 0))
        to--;
    for (uint32_t b = 0; b < BLOCKS; b++) {
        const uint32_t begin = from + (2 * b + 1) * (to - from) / (2 * BLOCKS);
        for (uint32_t i = begin; i < begin + BLOCK && i <= to; i++)
            tick[i].is_judged = 1;
    }
    for (int s = 0; s < SUSPECTS; s++) {
        double most = 0;
        uint32_t at = 0;
        for (uint32_t i = 2; i <= trace->count; i++) {
            const struct bed_felt now = minus(&tick[i].felt, &tick[i - 1].felt);
            const struct bed_felt before = minus(&tick[i - 1].felt, &tick[i - 2].felt);
            const double change = size_of_difference(&now, &before, s % 2 ? FORCE : TORQUE);
            if (change > most && !(tick[i].is_judged && tick[i - 1].is_judged)) {
                most = change;
                at = i;
            }
        }
        if (at)
            tick[at].is_judged = tick[at - 1].is_judged = 1;
    }
}

/* Some of the quadrature's points against brute force. */
static void check_points(const struct run *run, const double ends[6])
{
    const struct solid *solid = &run->solid;
    for (int i = 0; i <= 4; i++) {
        double x[6], q[6], way;
        dpt_hit hit = DPT_HIT_INIT;
        point_at(ends, i / 4.0, x);
        memcpy(x + 3, x, 3 * sizeof *x);
        dpt_query_segments(solid->mesh, NULL, x, NULL, 1, &hit, NULL);
        memcpy(q, hit.q, 3 * sizeof *q);
        memcpy(q + 3, hit.q, 3 * sizeof *q);
        const double distance = oracle_brute(solid->brute, x, NULL);
        const double winding = oracle_winding(&solid->oracle, x);
        way = apart(x, hit.q);
        CHECK(fabs(fabs(hit.gap) - distance) < 1e-9 * solid->diagonal &&
                  fabs(way - distance) < 1e-9 * solid->diagonal &&
                  oracle_brute(solid->brute, q, NULL) < 1e-9 * solid->diagonal,
              "%s: %.12g m, not %.12g", solid->name, hit.gap, distance);
        CHECK(fabs(winding - 0.5) < 0.01 || distance < 1e-9 * solid->diagonal || (hit.gap < 0) == (winding > 0.5),
              "%s: gap %g where the winding number is %g", solid->name, hit.gap, winding);
    }
}

/* The quadrature, and its peaks. Returns how deep the tool comes. */
static double take_truth(struct run *run, struct trace *trace, double peak[KINDS])
{
    const uint32_t points = run->winds ? 256 : BED_POINTS;
    double deepest = 0;
    memset(peak, 0, KINDS * sizeof *peak);
    for (uint32_t i = 0; i <= trace->count; i++) {
        struct tick *tick = &trace->ticks[i];
        if (!tick->is_judged)
            continue;
        bed_truth_at(run->solid.mesh, tick->ends, points, !run->winds, &tick->truth);
        tick->is_judged = tick->truth.is_known && tick->truth.deepest <= DEEP;
        deepest = fmax(deepest, tick->truth.deepest);
        for (int k = 0; k < KINDS; k++)
            peak[k] = fmax(peak[k], size_of(&tick->truth.felt, k));
        if (i % 16 == 0)
            check_points(run, tick->ends);
    }
    return deepest;
}

/* Is one of its ticks beyond the bounds? */
static int is_beyond(struct run *run, uint64_t seed, const struct trace *trace, const double peak[KINDS])
{
    double jump[KINDS] = { 0 }, most[KINDS] = { 0 };
    int beyond = 0;
    for (uint32_t i = 1; i <= trace->count; i++) {
        const struct tick *now = &trace->ticks[i], *before = now - 1;
        const struct bed_felt off = minus(&now->felt, &now->truth.felt);
        const struct bed_felt was = minus(&before->felt, &before->truth.felt);
        run->judged += (uint64_t)now->is_judged;
        for (int k = 0; k < KINDS && now->is_judged; k++) {
            most[k] = fmax(most[k], size_of(&off, k) / peak[k]);
            if (before->is_judged)
                jump[k] = fmax(jump[k], size_of_difference(&off, &was, k) / peak[k]);
        }
    }
    for (int k = 0; k < KINDS; k++) {
        run->jump[k] = fmax(run->jump[k], jump[k]);
        run->off[k] = fmax(run->off[k], most[k]);
        if (jump[k] <= run->bounds->jump[k] && most[k] <= run->bounds->off[k])
            continue;
        beyond = 1;
        printf("    %s, trace %u: %s jumps by %.2f %% more, off by %.2f %%, of %g\n", run->subject->name,
               (unsigned)seed, kind_names[k], 100 * jump[k], 100 * most[k], peak[k]);
    }
    return beyond;
}

static void trace_over(struct run *run)
{
    for (uint64_t seed = 1; run->traces < part_of(TRACES) && seed < 40 * TRACES; seed++) {
        struct trace trace = { .count = 0 };
        double peak[KINDS];
        bed_path_make(&trace.path, &run->solid, seed);
        if (!lead_round(run, &trace))
            continue;
        choose_ticks(&trace);
        if (take_truth(run, &trace, peak) >= SHALLOW) {
            run->traces++;
            run->traces_beyond += (uint64_t)is_beyond(run, seed, &trace, peak);
        }
        free(trace.ticks);
    }
    CHECK(run->traces == part_of(TRACES), "%s: %u traces", run->subject->name, (unsigned)run->traces);
    CHECK(run->subject->unjudged & JUMPS || run->traces_beyond <= run->subject->hidden, "%s: %u traces jump",
          run->subject->name, (unsigned)run->traces_beyond);
}

/* A walk along a path. */
struct walk {
    struct run *run;
    struct bed_path path;
    double range; /* of the energy */
    double work;
};

struct place {
    double t, ends[6];
    struct bed_felt felt;
};

static struct place go_to(struct walk *walk, double t)
{
    struct place place = { .t = t };
    dpt_pose pose;
    bed_path_at(&walk->path, t, &pose, place.ends);
    place.felt = bed_lead_to(&walk->run->lead, &walk->path, t);
    walk->run->undecided += walk->run->lead.force.reason == DPT_FORCE_UNDECIDED;
    return place;
}

/* Of the middle, and the least turn of the axis, which is small. */
static void twist_between(const double from[6], const double to[6], double shift[3], double turn[3])
{
    double a[3], b[3];
    for (int k = 0; k < 3; k++) {
        shift[k] = 0.5 * (to[k] + to[3 + k] - from[k] - from[3 + k]);
        a[k] = (from[3 + k] - from[k]) / BED_LENGTH;
        b[k] = (to[3 + k] - to[k]) / BED_LENGTH;
    }
    for (int k = 0; k < 3; k++)
        turn[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/*
 * Add the work of a step by the trapezoidal rule; where the wrench changes so much that the rule could be off by 1e-5 of
 * the range, as where the nearest wall of an end changes, by halves.
 */
static struct place step_to(struct walk *walk, const struct place *from, double t, int halvings)
{
    double shift[3], turn[3];
    const struct place to = go_to(walk, t);
    const struct bed_felt change = minus(&to.felt, &from->felt);
    twist_between(from->ends, to.ends, shift, turn);
    const double doubt =
        size_of(&change, FORCE) * sqrt(dot3(shift, shift)) + size_of(&change, TORQUE) * sqrt(dot3(turn, turn));
    if (0.5 * doubt > 1e-5 * walk->range && halvings > 0) {
        const struct place middle = step_to(walk, from, 0.5 * (from->t + t), halvings - 1);
        return step_to(walk, &middle, t, halvings - 1);
    }
    walk->work += 0.5 * (dot3(from->felt.force, shift) + dot3(to.felt.force, shift) + dot3(from->felt.torque, turn) +
                         dot3(to.felt.torque, turn));
    return to;
}

/* Returns 0 if the path begins in something, or comes to nothing. */
static int walk_round(struct walk *walk)
{
    const uint32_t steps = bed_path_ticks(&walk->path, STEP);
    if (!bed_lead_begin(&walk->run->lead, &walk->run->solid, &walk->path))
        return 0;
    walk->work = walk->range = 0;
    for (uint32_t i = 1; i <= steps; i++)
        walk->range = fmax(walk->range, go_to(walk, (double)i / steps).felt.energy);
    if (!(walk->range > 0.25 * BED_STIFFNESS * SHALLOW * SHALLOW))
        return 0;
    bed_lead_begin(&walk->run->lead, &walk->run->solid, &walk->path);
    struct place at = go_to(walk, 0);
    for (uint32_t i = 1; i <= steps; i++)
        at = step_to(walk, &at, (double)i / steps, 8);
    CHECK(!(at.felt.energy > 0), "%s: no way back", walk->run->subject->name);
    return 1;
}

static void walk_over(struct run *run)
{
    const uint64_t wanted = part_of(run->winds ? PATHS / 10 : PATHS);
    for (uint64_t seed = 1; run->paths < wanted && seed < 40 * PATHS; seed++) {
        struct walk walk = { .run = run };
        bed_path_make(&walk.path, &run->solid, 1000000 + seed);
        if (!walk_round(&walk))
            continue;
        const double share = fabs(walk.work) / walk.range;
        run->paths++;
        run->paths_above += share > 0.001;
        run->paths_beyond += share > 0.003;
        run->most_work = fmax(run->most_work, share);
        if (share > 0.001)
            printf("    %s, path %u: work %.2f %% of %g J\n", run->subject->name, (unsigned)seed,
                   100 * walk.work / walk.range, walk.range);
    }
    CHECK(run->paths == wanted, "%s: %u paths", run->subject->name, (unsigned)run->paths);
    if (run->subject->unjudged & WORK)
        return;
    CHECK(run->paths_above <= (run->paths + 99) / 100, "%s: %u of %u paths with work", run->subject->name,
          (unsigned)run->paths_above, (unsigned)run->paths);
    CHECK(run->paths_beyond == 0, "%s: %.2f %% at worst", run->subject->name, 100 * run->most_work);
}

static void try_subject(const struct subject *subject, int from_file, void (*over)(struct run *run))
{
    struct run run = { .subject = subject };
    char path[4096];
    snprintf(path, sizeof path, "%s/meshes/%s", from_file ? getenv("DPT_DATA") : "", subject->name);
    const int made = from_file ? solid_from_file(&run.solid, subject->name, path, subject->scale)
                               : solid_from_shape(&run.solid, subject->name, subject->triangles);
    if (!made)
        return;
    run.winds = run.solid.info.winding_components > 0;
    run.bounds = run.winds ? &of_winding : &of_closed;
    if (bed_lead_open(&run.lead, run.solid.mesh))
        over(&run);
    if (run.traces)
        printf("    %-32s %3u traces, %4u ticks: off %5.2f %5.2f %5.2f %%, jumps %5.2f %5.2f %%\n", subject->name,
               (unsigned)run.traces, (unsigned)run.judged, 100 * run.off[FORCE], 100 * run.off[TORQUE],
               100 * run.off[ENERGY], 100 * run.jump[FORCE], 100 * run.jump[TORQUE]);
    if (run.paths)
        printf("    %-32s %4u paths, work %.3f %% at worst, above 0.1 %% on %u, 0.3 %% on %u\n", subject->name,
               (unsigned)run.paths, 100 * run.most_work, (unsigned)run.paths_above, (unsigned)run.paths_beyond);
    CHECK(run.undecided == 0, "%s: %u ticks undecided", subject->name, (unsigned)run.undecided);
    rig_close(&run.lead);
    solid_close(&run.solid);
}

static void try_all(const struct subject *subjects, size_t count, int from_file, void (*over)(struct run *run))
{
    for (size_t i = 0; i < count; i++)
        try_subject(&subjects[i], from_file, over);
}

#define COUNT(list) (sizeof(list) / sizeof *(list))

static void shapes_jump_as_the_quadrature(void)
{
    try_all(shapes, COUNT(shapes), 0, trace_over);
}

static void organs_jump_as_the_quadrature(void)
{
    try_all(organs, COUNT(organs), 1, trace_over);
}

static void badly_closed_organs_jump_little_more(void)
{
    try_all(badly_closed, COUNT(badly_closed), 1, trace_over);
}

static void closed_paths_in_shapes_yield_no_work(void)
{
    try_all(shapes, COUNT(shapes), 0, walk_over);
}

static void closed_paths_in_organs_yield_no_work(void)
{
    try_all(organs, COUNT(organs), 1, walk_over);
}

static void closed_paths_in_badly_closed_organs_yield_no_work(void)
{
    try_all(badly_closed, COUNT(badly_closed), 1, walk_over);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(shapes_jump_as_the_quadrature);
    TEST(closed_paths_in_shapes_yield_no_work);
    if (getenv("DPT_DATA")) {
        TEST(organs_jump_as_the_quadrature);
        TEST(closed_paths_in_organs_yield_no_work);
        TEST(badly_closed_organs_jump_little_more);
        TEST(closed_paths_in_badly_closed_organs_yield_no_work);
    } else
        SKIP("the bed over organs", "DPT_DATA does not name the data folder");
    return check_report();
}
