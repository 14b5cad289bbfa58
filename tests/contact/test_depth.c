/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Gap and depth, of stateless queries and of worlds with a history, against an oracle that closes the least signed
 * distance in from both sides (oracle/depth.h), and inside and outside against another library (oracle/inside_cgal.cpp,
 * if it is built).
 *
 *     test_depth           what make check runs
 *     test_depth TICKS     so many ticks and axes a mesh, 150 if not told
 *
 * Real meshes from DPT_DATA.
 */
#include <unistd.h>

#include "contact/depth_checks.h"
#include "lib/public_meshes.h"

static const char *data;
static char folder[1024]; /* where this program lies */
static uint64_t ticks = 150;

static struct tally {
    size_t axes, ticks, deep, crossing, points;
    double over, under;     /* gap above the deepest seen, below the deepest possible, in diagonals */
    double landed, stepped; /* off the surface after moving out; faster than the motion, in diagonals */
} tally;

static void report(const struct solid *solid)
{
    printf("    %-26s %6u  %5zu axes, %5zu ticks, %5zu deep, %5zu cross: %8.1e over, %8.1e under, lands %8.1e, "
           "jumps %8.1e; %zu a search\n",
           solid->name, solid->info.triangles, tally.axes, tally.ticks, tally.deep, tally.crossing, tally.over,
           tally.under, tally.landed, tally.stepped, tally.points / (tally.axes + tally.ticks + 1));
    tally = (struct tally){ 0 };
}

static uint64_t seed_of(const char *name)
{
    uint64_t seed = 5381;
    for (const char *c = name; *c; c++)
        seed = 33 * seed + (unsigned char)*c;
    return seed;
}

/* The gap of an axis against the oracle. */
static struct oracle_least check_depth(const struct solid *solid, const char *by, const double ends[6], double radius,
                                       const dpt_hit *hit)
{
    const double diagonal = solid->diagonal;
    const struct oracle_least least = oracle_least(&solid->oracle, ends, 2e-7 * diagonal);
    const char *text = answer_text(solid, by, ends, radius, hit);
    const double ours = hit->gap + radius;
    check_form(text, hit);
    CHECK(least.high - least.low <= 3e-7 * diagonal, "the oracle is not sure: %g to %g, %s", least.low, least.high,
          text);
    const double slack = 1e-12 * solid->oracle.extent + 1e-15 * radius;
    if (!least.inside && !least.crosses)
        CHECK(fabs(ours - least.high) <= hit->error_bound + slack, "%.12g not %.12g: %s", ours, least.high, text);
    CHECK(ours <= least.high + 1e-5 * diagonal + slack, "%.9g, but %.9g at s = %.9g: %s", ours, least.high, least.s,
          text);
    CHECK(ours >= least.low - 1e-5 * diagonal - slack, "%.9g, but not below %.9g: %s", ours, least.low, text);
    tally.over = fmax(tally.over, (ours - least.high) / diagonal);
    tally.under = fmax(tally.under, (least.low - ours) / diagonal);
    tally.deep += least.inside != 0;
    tally.crossing += least.crosses != 0;
    tally.points += least.points;
    return least;
}

/* Axes at random, some of them where it is delicate. */
static void random_axes(const struct solid *solid, uint64_t count)
{
    struct motion motion = { .count = 0 };
    uint64_t seed = seed_of(solid->name);
    motion_random(&motion, &solid->place, seed, 20 * (1 + count / 20));
    motion_small(&motion, &solid->place, seed, count / 2);
    for (size_t i = 0; i < motion.count; i += 1 + motion.count / count) {
        dpt_hit hit = DPT_HIT_INIT;
        const double radius = radius_of(solid, random_bits(&seed));
        /* A hundred diagonals away is for test_exactness. */
        dpt_query_segments(solid->mesh, NULL, motion.ends[i], &radius, 1, &hit, NULL);
        check_depth(solid, "query", motion.ends[i], radius, &hit);
        tally.axes++;
    }
    motion_free(&motion);
}

/* One motion of a tool in a world: `go` makes the next tick's ends. */
struct drive {
    const struct solid *solid;
    struct rig rig, depth_alone; /* the second without contacts */
    double margin, ends[6], radius;
    uint64_t every; /* of these ticks one is held against the oracle */
    dpt_hit last;
    double last_ends[6];
    uint64_t tick;
};

static int drive_begin(struct drive *drive, const struct solid *solid, double radius)
{
    *drive = (struct drive){ .solid = solid, .margin = 0.003 * solid->diagonal, .radius = radius };
    return depth_rig_open(&drive->rig, solid->mesh, drive->margin, 32) &&
           depth_rig_open(&drive->depth_alone, solid->mesh, drive->margin, 0);
}

static void drive_end(struct drive *drive)
{
    rig_close(&drive->rig);
    rig_close(&drive->depth_alone);
}

static void drive_tick(struct drive *drive)
{
    const struct solid *solid = drive->solid;
    const double *ends = drive->ends, radius = drive->radius, diagonal = solid->diagonal;
    dpt_hit plain = DPT_HIT_INIT;
    const dpt_hit hit = rig_step_ends(&drive->rig, ends, radius);
    const dpt_hit alone = rig_step_ends(&drive->depth_alone, ends, radius);
    dpt_query_segments(solid->mesh, NULL, ends, &radius, 1, &plain, NULL);
    check_form(answer_text(solid, "world", ends, radius, &hit), &hit);
    CHECK(fabs(plain.gap - hit.gap) <= 2e-5 * diagonal, "%.9g without history: %s", plain.gap,
          answer_text(solid, "world", ends, radius, &hit));
    CHECK(fabs(plain.gap - alone.gap) <= 2e-5 * diagonal, "%.9g without history: %s", plain.gap,
          answer_text(solid, "depth alone", ends, radius, &alone));
    if (drive->tick) {
        const double went = ends_moved(drive->last_ends, ends);
        const double jump = fabs(hit.gap - drive->last.gap) - went;
        CHECK(jump <= 2e-5 * diagonal, "from %.9g within %g: %s", drive->last.gap, went,
              answer_text(solid, "world", ends, radius, &hit));
        tally.stepped = fmax(tally.stepped, jump / diagonal);
    }
    if (drive->tick % drive->every == 0) {
        check_depth(solid, "world", ends, radius, &hit);
        check_depth(solid, "depth alone", ends, radius, &alone);
        const double off = check_way_out(solid, &drive->rig, drive->margin, ends, radius, &hit);
        tally.landed = fmax(tally.landed, off / diagonal);
    }
    drive->last = hit;
    memcpy(drive->last_ends, ends, sizeof drive->last_ends);
    memcpy(ends_before, ends, sizeof ends_before);
    drive->tick++;
    tally.ticks++;
}

/* A tool that goes right through, turning slowly: in from one side of the box, out at the other. */
static void push_through(const struct solid *solid, uint64_t seed, uint64_t count, uint64_t every)
{
    struct drive drive;
    double way[3], lie[3], axis[3], aim[3];
    const double length = random_in(&seed, 0, 1.2) * solid->diagonal;
    if (!drive_begin(&drive, solid, radius_of(solid, random_bits(&seed))))
        return;
    drive.every = every;
    random_unit(&seed, way);
    random_unit(&seed, lie);
    random_unit(&seed, axis);
    const double turn = random_in(&seed, 0, 3.0 / (double)count);
    const uint64_t t = random_bits(&seed) % solid->place.triangles;
    for (int k = 0; k < 3; k++) {
        aim[k] = 0.5 * (solid->place.low[k] + solid->place.high[k]);
        aim[k] = 0.5 * (aim[k] + (double)solid->corners[9 * t + (uint64_t)k]);
    }
    for (int k = 0; k < 3; k++) {
        drive.ends[k] = aim[k] - 0.3 * solid->diagonal * way[k] - 0.5 * length * lie[k];
        drive.ends[3 + k] = aim[k] - 0.3 * solid->diagonal * way[k] + 0.5 * length * lie[k];
    }
    for (uint64_t i = 0; i < count; i++) {
        drive_tick(&drive);
        for (int k = 0; k < 6; k++)
            drive.ends[k] += 0.6 * solid->diagonal / (double)count * way[k % 3];
        turn_about(drive.ends, 0.5, axis, turn);
    }
    drive_end(&drive);
}

/* A capsule that slides and spins in contact; its target goes from outside to pressed in. */
static void slide_along(const struct solid *solid, uint64_t seed, uint64_t count, uint64_t every)
{
    struct drive drive;
    struct slide slide;
    const double radius = radius_of(solid, 2);
    if (!drive_begin(&drive, solid, radius))
        return;
    drive.every = every;
    slide_begin(&slide, solid, seed, random_in(&seed, 0, 0.8) * solid->diagonal, radius);
    slide.step = 3e-4 * solid->diagonal;
    slide.spin = random_in(&seed, -0.02, 0.02);
    for (uint64_t i = 0; i < count; i++) {
        slide.gap = radius * (0.2 - 0.8 * (double)(i % 100) / 100);
        memcpy(drive.ends, slide.ends, sizeof drive.ends);
        drive_tick(&drive);
        slide_step(&slide);
    }
    drive_end(&drive);
}

static void try_closed(const struct solid *solid)
{
    const uint64_t seed = seed_of(solid->name);
    /* The oracle's time grows with the mesh. */
    const uint64_t asked = solid->info.triangles > 6000 && ticks < 1000 ? ticks / 5 : ticks;
    CHECK(solid->info.components == 1 && solid->info.closed_components == 1, "%s is not closed", solid->name);
    random_axes(solid, asked);
    for (uint64_t i = 0; i < 3; i++) {
        const uint64_t every = 1 + 3 * ticks / asked;
        push_through(solid, seed + i, ticks, every);
        slide_along(solid, seed + i, ticks / 2, every);
    }
    report(solid);
}

static void closed_shapes(void)
{
    static const struct {
        const char *name;
        uint64_t count;
    } cases[] = { { "torus", 32 },   { "torus", 2000 },  { "liver", 4000 }, { "star", 2000 },
                  { "star", 20480 }, { "sphere", 1280 }, { "box", 192 },    { "spleen", 1000 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct solid solid;
        if (solid_from_shape(&solid, cases[i].name, cases[i].count))
            try_closed(&solid);
        solid_close(&solid);
    }
    struct solid slab;
    if (box_of(&slab, (const double[3]){ 0.0625, 0.0625, 0x1p-12 }))
        try_closed(&slab);
    solid_close(&slab);
}

/*
 * With the samples of the last tick the depth alone takes 0.08 of the work that contacts take, without them 0.36. A reset
 * forgets them: the gap is that of a new world, bit for bit.
 */
static void depth_goes_on_from_the_last_tick(void)
{
    enum { TICKS = 1000, RESETS = 20 };
    uint64_t work[2] = { 0, 0 };
    struct solid liver;
    struct drive drive;
    if (!solid_from_shape(&liver, "liver", 20000) || !drive_begin(&drive, &liver, 0.002))
        return;
    for (int k = 0; k < 6; k++)
        drive.ends[k] = 0.5 * (liver.place.low[k % 3] + liver.place.high[k % 3]);
    drive.ends[0] -= 0.15;
    drive.ends[3] += 0.15;
    for (uint64_t i = 0; i < TICKS; i++) {
        const double gap = rig_step_ends(&drive.depth_alone, drive.ends, drive.radius).gap;
        rig_step_ends(&drive.rig, drive.ends, drive.radius);
        work[0] += drive.rig.step.work;
        work[1] += drive.depth_alone.step.work;
        turn_about(drive.ends, 0.5, (const double[3]){ 0.6, 0.64, 0.48 }, 1e-3);
        if (i % (TICKS / RESETS))
            continue;
        struct rig new;
        dpt_world_reset(drive.depth_alone.world);
        const double again = rig_step_ends(&drive.depth_alone, drive.ends, drive.radius).gap;
        depth_rig_open(&new, liver.mesh, drive.margin, 0);
        const double anew = rig_step_ends(&new, drive.ends, drive.radius).gap;
        CHECK(gap < 0 && again == anew, "%.17g after a reset, %.17g in a new world", again, anew);
        rig_close(&new);
    }
    const double ratio = (double)work[1] / (double)work[0];
    printf("    %.3f of the work with contacts\n", ratio);
    CHECK(ratio < 0.16, "%g", ratio);
    drive_end(&drive);
    solid_close(&liver);
}

/* Two bodies, each with a pose, and a tool of two segments: a segment's gap is the least of both bodies. */
static void try_two_bodies(uint32_t max_contacts, uint64_t liver_triangles)
{
    const dpt_pose poses[2] = { { { 0.02, 0, 0 }, { 1, 0, 0, 0 } },
                                { { -0.03, 0.05, 0.06 }, { 0.5, 0.5, -0.5, 0.5 } } };
    const dpt_segment none[2] = { { { 0, 0, 0 }, { 0, 0, 0 }, 0 }, { { 0, 0, 0 }, { 0, 0, 0 }, 0 } };
    struct solid solid[2];
    struct rig rig;
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    uint64_t seed = 17;
    if (!solid_from_shape(&solid[0], "torus", 2000) || !solid_from_shape(&solid[1], "liver", liver_triangles))
        return;
    def.max_contacts = max_contacts;
    int made = rig_open(&rig, &def, NULL, none, 2);
    for (int b = 0; b < 2; b++)
        made = made && rig_add_body(&rig, solid[b].mesh, &poses[b]);
    for (uint64_t i = 0; i < 10 * ticks && made; i++) {
        dpt_segment segments[2];
        double ends[12], radii[2];
        dpt_hit hits[2][2], hit = DPT_HIT_INIT;
        if (i % 20 == 0)
            ends_about(&seed, 0.12, i / 20, ends);
        if (i % 20 == 0)
            ends_about(&seed, 0.12, i / 20 + 3, ends + 6);
        for (int e = 0; e < 2; e++) {
            turn_about(ends + 6 * e, 0.3, (const double[3]){ 0.6, 0, 0.8 }, 0.02);
            segments[e].radius = radii[e] = radius_of(&solid[0], i / 20 + (uint64_t)e);
            memcpy(segments[e].a, ends + 6 * e, sizeof segments[e].a);
            memcpy(segments[e].b, ends + 6 * e + 3, sizeof segments[e].b);
        }
        CHECK(dpt_tool_set_segments(rig.world, rig.tool, segments, 2) == DPT_OK, "no segments");
        rig_tick(&rig);
        for (int b = 0; b < 2; b++) {
            hits[b][0].size = sizeof hit;
            dpt_query_segments(solid[b].mesh, &poses[b], ends, radii, 2, hits[b], NULL);
        }
        for (uint32_t e = 0; e < 2; e++) {
            dpt_tool_get_segment_hit(rig.world, rig.tool, e, &hit);
            const double gap = fmin(hits[0][e].gap, hits[1][e].gap);
            CHECK((hit.flags & DPT_HIT_FLAG_GAP) && fabs(hit.gap - gap) <= 2e-5 * solid[1].diagonal,
                  "gap %.9g, not the less of %.9g and %.9g: %s", hit.gap, hits[0][e].gap, hits[1][e].gap,
                  answer_text(&solid[0], "query", ends + 6 * e, radii[e], &hit));
        }
    }
    rig_close(&rig);
    solid_close(&solid[0]);
    solid_close(&solid[1]);
}

static void two_bodies(void)
{
    try_two_bodies(32, 2000);
    try_two_bodies(0, 400);
}

/* Public meshes that are closed and do not cut themselves. */
static const char *const closed[] = { "organs/openhelp_liver.stl",       "organs/openhelp_spleen.stl",
                                      "organs/openhelp_kidney_left.stl", "organs/gallbladder_low.stl",
                                      "sheets_tori/torus_1600.obj",      "hard/spot.obj",
                                      "sheets_tori/salad_bowl.obj",      "tools/suture_needle_40mm.obj",
                                      "tools/maryland_jaw.stl",          "sheets_tori/gauze.obj" };
enum { CLOSED = sizeof closed / sizeof *closed };

static int open_public(struct solid *solid, const char *name)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/meshes/%s", data, name);
    return solid_from_file(solid, name, path, 1);
}

static void closed_organs(void)
{
    for (int i = 0; i < CLOSED; i++) {
        struct solid solid;
        if (open_public(&solid, closed[i]))
            try_closed(&solid);
        solid_close(&solid);
    }
}

/* On whatever mesh: the distance changes by no more than the tool moves, with history and without. */
static void try_distance(const struct solid *solid)
{
    struct motion motion = { .count = 0 };
    struct rig rig;
    motion_random(&motion, &solid->place, seed_of(solid->name), 4 * ticks);
    double last[2] = { 0, 0 }, bound = 0;
    if (!depth_rig_open(&rig, solid->mesh, 0.003 * solid->diagonal, 32))
        return;
    for (size_t i = 0; i < motion.count; i++) {
        dpt_hit hits[2] = { DPT_HIT_INIT, DPT_HIT_INIT };
        const double radius = radius_of(solid, i / 20);
        if (motion.jumps[i])
            dpt_tool_teleport(rig.world, rig.tool, &rig.device);
        dpt_query_segments(solid->mesh, NULL, motion.ends[i], &radius, 1, &hits[0], NULL);
        hits[1] = rig_step_ends(&rig, motion.ends[i], radius);
        const double went = i ? ends_moved(motion.ends[i - 1], motion.ends[i]) : 0;
        for (int w = 0; w < 2; w++) {
            const char *text = answer_text(solid, w ? "world" : "query", motion.ends[i], radius, &hits[w]);
            CHECK(!i || fabs(hits[w].distance - last[w]) <= went * (1 + 1e-12) + bound + hits[w].error_bound,
                  "from %.9g within %g: %s", last[w], went, text);
            CHECK(isfinite(hits[w].gap + hits[w].depth), "%s", text);
            CHECK(!(hits[w].flags & DPT_HIT_FLAG_GAP) || hits[w].depth == fmax(0, -hits[w].gap), "%s", text);
            CHECK((hits[w].flags & DPT_HIT_FLAG_GAP) || hits[w].contact == DPT_CONTACT_UNKNOWN,
                  "contact %u without a gap: %s", hits[w].contact, text);
            /* No axis is nearer, or deeper, than its distance: but for the radius, gap is within it. */
            CHECK(!(hits[w].flags & DPT_HIT_FLAG_GAP) || hits[w].gap + radius <= hits[w].distance + hits[w].error_bound,
                  "%s", text);
            last[w] = hits[w].distance;
        }
        bound = hits[0].error_bound + hits[1].error_bound;
        tally.ticks++;
    }
    rig_close(&rig);
    motion_free(&motion);
}

static void distance_on_mesh(const char *folder_of_it, const char *file, void *meshes)
{
    struct solid solid;
    char name[512];
    snprintf(name, sizeof name, "%s/%s", folder_of_it, file);
    if (open_public(&solid, name))
        try_distance(&solid);
    solid_close(&solid);
    ++*(size_t *)meshes;
}

static void distance_on_all_meshes(void)
{
    size_t meshes = 0;
    for_each_public_mesh(data, distance_on_mesh, &meshes);
    printf("    %zu meshes, %zu ticks\n", meshes, tally.ticks);
    tally = (struct tally){ 0 };
}

static void put_word(FILE *file, uint32_t word)
{
    for (int i = 0; i < 4; i++)
        fputc((int)(word >> (8 * i) & 255), file);
}

static void put_floats(FILE *file, const float *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        put_word(file, bits);
    }
}

/* The mesh as tests/bench/dump_mesh.c writes it. */
static int write_triangles(const struct solid *solid, const char *path)
{
    FILE *file = fopen(path, "wb");
    if (!file)
        return -1;
    put_word(file, 3 * solid->place.triangles);
    put_word(file, solid->place.triangles);
    put_floats(file, solid->corners, 9 * (size_t)solid->place.triangles);
    for (uint32_t i = 0; i < 3 * solid->place.triangles; i++)
        put_word(file, i);
    return fclose(file);
}

/* Points in the box and close to the surface. */
static double (*points_about(const struct solid *solid, size_t count))[3]
{
    double(*points)[3] = malloc(count * sizeof *points);
    uint64_t seed = seed_of(solid->name);
    for (size_t i = 0; i < count; i++) {
        const float *c = solid->corners + 9 * (random_bits(&seed) % solid->place.triangles);
        double share = random_in(&seed, 0, 1), away[3];
        random_unit(&seed, away);
        const double off = pow(10, random_in(&seed, -7, -1)) * solid->diagonal;
        if (i % 4 == 0) /* about an edge; else a vertex */
            share = 0;
        for (int k = 0; k < 3; k++)
            points[i][k] = i % 3 == 0 ? random_in(&seed, solid->place.low[k], solid->place.high[k])
                                      : (1 - share) * (double)c[k] + share * (double)c[3 + k] + off * away[k];
    }
    return points;
}

/* Our side of points, that of another library, and of some that of the solid angles. */
static void compare_sides(const struct solid *solid, const char *program)
{
    enum { POINTS = 3000 };
    char mesh[1200], asked[1200], told[1200], command[8192], line[64];
    snprintf(mesh, sizeof mesh, "%s/depth-%ld.tri", folder, (long)getpid());
    snprintf(asked, sizeof asked, "%s/depth-%ld.csv", folder, (long)getpid());
    snprintf(told, sizeof told, "%s/depth-%ld.out", folder, (long)getpid());
    snprintf(command, sizeof command, "'%s' '%s' '%s' '%s'", program, mesh, asked, told);
    double(*points)[3] = points_about(solid, POINTS);
    FILE *file = fopen(asked, "w");
    for (int i = 0; i < POINTS && file; i++)
        fprintf(file, "%.17g,%.17g,%.17g\n", points[i][0], points[i][1], points[i][2]);
    int failed = !file || fclose(file) != 0 || write_triangles(solid, mesh) != 0 || system(command) != 0 ||
                 !(file = fopen(told, "r"));
    CHECK(!failed, "%s: no answer from %s", solid->name, program);
    int inside = 0;
    for (int i = 0; i < POINTS && !failed; i++) {
        double ends[6];
        dpt_hit hit = DPT_HIT_INIT;
        CHECK(fgets(line, sizeof line, file), "%s: %d answers", solid->name, i);
        const int side = atoi(line);
        memcpy(ends, points[i], sizeof points[i]);
        memcpy(ends + 3, points[i], sizeof points[i]);
        dpt_query_segments(solid->mesh, NULL, ends, NULL, 1, &hit, NULL);
        inside += side < 0;
        CHECK(side && (hit.gap < 0) == (side < 0), "side %d: %s", side, answer_text(solid, "point", ends, 0, &hit));
        if (i % (POINTS / 100) == 0)
            CHECK((oracle_signed(&solid->oracle, ends) < 0) == (side < 0), "solid angle: %s",
                  answer_text(solid, "point", ends, 0, &hit));
    }
    printf("    %-26s %d of %d inside\n", solid->name, inside, POINTS);
    if (!failed)
        fclose(file);
    free(points);
    remove(mesh);
    remove(asked);
    remove(told);
}

static char inside_cgal[1200];

static void sides_as_another_library_has_them(void)
{
    static const struct {
        const char *name;
        uint64_t count;
    } cases[] = { { "torus", 2000 }, { "liver", 4000 }, { "star", 2000 }, { "box", 12 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct solid solid;
        if (solid_from_shape(&solid, cases[i].name, cases[i].count))
            compare_sides(&solid, inside_cgal);
        solid_close(&solid);
    }
    for (int i = 0; i < CLOSED && data; i++) {
        struct solid solid;
        if (open_public(&solid, closed[i]))
            compare_sides(&solid, inside_cgal);
        solid_close(&solid);
    }
}

int main(int argc, char **argv)
{
    setvbuf(stdout, NULL, _IOLBF, 0);
    const char *slash = strrchr(argv[0], '/');
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - argv[0]) : 1, slash ? argv[0] : ".");
    snprintf(inside_cgal, sizeof inside_cgal, "%s/inside_cgal", folder);
    if (access(inside_cgal, X_OK) != 0) /* of the release, for the other configurations */
        snprintf(inside_cgal, sizeof inside_cgal, "%s/../../tests/inside_cgal", folder);
    data = getenv("DPT_DATA");
    if (argc > 1)
        ticks = strtoull(argv[1], NULL, 10);
    if (ticks < 20 || ticks > 100000000) {
        printf("test_depth: from 20 ticks a mesh to 100000000\n");
        return 2;
    }
    TEST(closed_shapes);
    TEST(two_bodies);
    TEST(depth_goes_on_from_the_last_tick);
    if (data) {
        TEST(closed_organs);
        TEST(distance_on_all_meshes);
    } else {
        SKIP("depth on public meshes", "DPT_DATA does not name the data folder");
    }
    if (access(inside_cgal, X_OK) == 0)
        TEST(sides_as_another_library_has_them);
    else
        SKIP("sides against another library", "libcgal-dev or g++ is not here");
    return check_report();
}
