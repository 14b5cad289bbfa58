/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The exactness of the tree on real meshes under real motion: every public mesh (DPT_DATA) and the shapes of dynpoint
 * make, 2,000 ticks each, recorded and slid and random. The oracle is a brute force that shares nothing with the
 * library; of inside and outside, winding numbers. Whether the recorded motions are like those of other tools it cannot
 * judge.
 *
 *     test_exactness [PER CENT]   of the ticks
 *     test_exactness soak [NAME]  every tick of every recording on every mesh, half an hour
 *
 * Runs the program dynpoint, which lies one folder above the test.
 */
#include <math.h>
#include <unistd.h>

#include "data/motion.h"
#include "dynpoint/compile.h"
#include "lib/public_meshes.h"
#include "lib/rig.h"
#include "oracle/brute.h"
#include "scene/shape.h"

static const char *data;
static int soaking;
static const char *only; /* soak this mesh alone */
static struct recording recordings[MOTION_RECORDINGS];
static char dynpoint[1024], scratch[1024];

/* A mesh, as the library sees it and as the oracle does. */
struct subject {
    const char *name;
    int signs; /* closed, and no triangle cuts another: inside and outside are what they seem */
    dpt_compiled compiled;
    const dpt_mesh *mesh;
    dpt_mesh_info info;
    float *corners; /* 9 a triangle that was kept */
    oracle_mesh *oracle;
    struct motion_place place;
    double diagonal, extent;
};

static struct tally {
    size_t meshes, ticks, crossing, inside, outside, files_read;
    double worst, worst_bound; /* in diagonals, and in error_bound */
} all;

/* The oracle's triangles have the source's numbers; it leaves out those that were dropped. */
static int open_oracle(struct subject *subject)
{
    const uint32_t count = subject->info.source_triangles;
    uint32_t *numbers = malloc(3 * (size_t)count * sizeof *numbers), kept = 0;
    subject->corners = malloc(9 * (size_t)subject->info.triangles * sizeof *subject->corners);
    for (uint32_t i = 0; numbers && subject->corners && i < count; i++) {
        double corners[9];
        const int there = dpt_mesh_get_triangle(subject->mesh, i, corners) == DPT_OK;
        for (uint32_t k = 0; k < 3; k++)
            numbers[3 * (size_t)i + k] = there ? 3 * kept + k : UINT32_MAX;
        CHECK(!there || kept < subject->info.triangles, "%s: too many", subject->name);
        if (!there || kept >= subject->info.triangles)
            continue;
        for (int k = 0; k < 9; k++) {
            subject->corners[9 * (size_t)kept + (size_t)k] = (float)corners[k];
            CHECK((double)(float)corners[k] == corners[k], "%s %u: %a", subject->name, i, corners[k]);
        }
        kept++;
    }
    CHECK(kept == subject->info.triangles, "%s: %u of %u", subject->name, kept, subject->info.triangles);
    if (numbers && subject->corners)
        subject->oracle = oracle_brute_open(subject->corners, 3 * kept, numbers, count);
    subject->place.corners = subject->corners;
    subject->place.triangles = kept;
    free(numbers);
    return subject->oracle ? 0 : -1;
}

static int open_subject(struct subject *subject)
{
    subject->info.size = sizeof subject->info;
    if (dpt_mesh_open(subject->compiled.bytes, subject->compiled.size, &subject->mesh) != DPT_OK ||
        dpt_mesh_get_info(subject->mesh, &subject->info) != DPT_OK || open_oracle(subject)) {
        CHECK(0, "%s cannot be opened", subject->name);
        return -1;
    }
    memcpy(subject->place.low, subject->info.box_min, sizeof subject->place.low);
    memcpy(subject->place.high, subject->info.box_max, sizeof subject->place.high);
    subject->place.tool = MOTION_TOOL;
    subject->diagonal = motion_diagonal(&subject->place);
    for (int k = 0; k < 3; k++)
        subject->extent = fmax(subject->extent, fmax(fabs(subject->place.low[k]), fabs(subject->place.high[k])));
    return 0;
}

/* The same three corners, whichever way round. */
static int same_corners(const float *a, const double *b)
{
    static const int orders[6][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 0, 2, 1 }, { 2, 1, 0 }, { 1, 0, 2 } };
    for (int o = 0; o < 6; o++) {
        int same = 1;
        for (int k = 0; k < 9; k++)
            same &= (double)a[3 * orders[o][k / 3] + k % 3] == b[k];
        if (same)
            return 1;
    }
    return 0;
}

static int has_area(const float *c)
{
    double u[3], v[3];
    int area = 0;
    for (int k = 0; k < 3; k++) {
        u[k] = (double)c[3 + k] - (double)c[k];
        v[k] = (double)c[6 + k] - (double)c[k];
    }
    for (int k = 0; k < 3; k++)
        area |= u[k] * v[(k + 1) % 3] != u[(k + 1) % 3] * v[k];
    return area;
}

/* A triangle of lower number has the same corners. */
static int is_repeated(const struct subject *subject, const float *corners, uint32_t number)
{
    double earlier[9];
    for (uint32_t i = 0; i < number; i++) {
        if (dpt_mesh_get_triangle(subject->mesh, i, earlier) == DPT_OK && same_corners(corners, earlier))
            return 1;
    }
    return 0;
}

/* A little-endian float, scaled as SPEC says that vertices are. */
static float float_at(const unsigned char *bytes, double scale)
{
    const uint32_t bits =
        (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
    float value;
    memcpy(&value, &bits, sizeof value);
    return (float)(scale * (double)value);
}

/* Binary STL read once more, so that the oracle does not rest on the compiler's word alone. */
static void compare_with_file(const struct subject *subject, const char *path, double scale)
{
    unsigned char bytes[84];
    FILE *file = fopen(path, "rb");
    if (!file)
        return;
    size_t count = 0;
    if (fread(bytes, 1, 84, file) == 84 && fseek(file, 0, SEEK_END) == 0) {
        count = (size_t)bytes[80] | (size_t)bytes[81] << 8 | (size_t)bytes[82] << 16;
        count = ftell(file) == (long)(84 + 50 * count) ? count : 0;
        fseek(file, 84, SEEK_SET);
    }
    for (uint32_t i = 0; i < count && fread(bytes, 1, 50, file) == 50; i++) {
        float corners[9];
        double ours[9];
        for (int k = 0; k < 9; k++)
            corners[k] = float_at(bytes + 12 + 4 * k, scale);
        if (dpt_mesh_get_triangle(subject->mesh, i, ours) == DPT_OK)
            CHECK(same_corners(corners, ours), "%s: triangle %u", subject->name, i);
        else
            CHECK(!has_area(corners) || is_repeated(subject, corners, i), "%s: %u was dropped", subject->name, i);
    }
    if (count) {
        CHECK(count == subject->info.source_triangles, "%s: %zu", subject->name, count);
        all.files_read++;
    }
    fclose(file);
}

struct question {
    const struct subject *subject;
    const char *by;
    size_t tick;
    const double *ends;
};

/* What it takes to see it again. */
static const char *text_of(const struct question *question, const dpt_hit *hit)
{
    static char text[512];
    const double *e = question->ends;
    snprintf(text, sizeof text, "%s, %s, tick %zu: %a %a %a  %a %a %a: %.17g to triangle %u", question->subject->name,
             question->by, question->tick, e[0], e[1], e[2], e[3], e[4], e[5], hit->distance, hit->triangle);
    return text;
}

static double reach_of(const struct question *question)
{
    double reach = question->subject->extent;
    for (int k = 0; k < 6; k++)
        reach = fmax(reach, fabs(question->ends[k]));
    return reach;
}

/* What an answer owes whatever the truth is. */
static void check_form(const struct question *question, const dpt_hit *hit)
{
    const double reach = reach_of(question);
    /* A NaN or an infinity stays in a sum. */
    const double sum = hit->distance + hit->gap + hit->depth + hit->s + hit->error_bound + hit->lower_bound +
                       hit->p[0] + hit->p[1] + hit->p[2] + hit->q[0] + hit->q[1] + hit->q[2];
    CHECK(isfinite(sum), "%g %s", sum, text_of(question, hit));
    CHECK(hit->status == DPT_STATUS_EXACT, "%u %s", hit->status, text_of(question, hit));
    CHECK(hit->s >= 0 && hit->s <= 1, "%g %s", hit->s, text_of(question, hit));
    double square = 0;
    for (int k = 0; k < 3; k++) {
        square += (hit->p[k] - hit->q[k]) * (hit->p[k] - hit->q[k]);
        const double p = question->ends[k] + hit->s * (question->ends[3 + k] - question->ends[k]);
        CHECK(fabs(hit->p[k] - p) <= 1e-12 * reach, "p %s", text_of(question, hit));
    }
    const double apart = sqrt(square);
    CHECK(fabs(apart - hit->distance) <= hit->error_bound, "%.17g %s", apart, text_of(question, hit));
    CHECK(hit->error_bound > 0 && hit->error_bound <= 1e-9 * question->subject->diagonal, "%g %s", hit->error_bound,
          text_of(question, hit));
    const int crosses = (hit->flags & DPT_HIT_FLAG_CROSSING) != 0;
    CHECK(crosses == (hit->distance == 0), "flags %s", text_of(question, hit));
    CHECK(!crosses || memcmp(hit->p, hit->q, sizeof hit->p) == 0, "p, q %s", text_of(question, hit));
    /* How deep an axis inside is, is for test_depth; here, that it is as deep as its nearest point at least. */
    CHECK(crosses || ((hit->flags & DPT_HIT_FLAG_GAP) &&
                      (hit->gap == hit->distance || hit->gap <= hit->error_bound - hit->distance)),
          "gap %.17g, flags %x: %s", hit->gap, hit->flags, text_of(question, hit));
    CHECK(!(hit->flags & DPT_HIT_FLAG_GAP) || hit->depth == fmax(0, -hit->gap), "depth %s", text_of(question, hit));
}

/* Against the truth; returns how wrong it is. */
static double check_truth(const struct question *question, const dpt_hit *hit, double truth)
{
    const struct subject *subject = question->subject;
    /* The oracle's own error; of 1e-14, which brute.h grants it, a tenth on these meshes. */
    const double doubt = 1e-15 * reach_of(question);
    const double error = fabs(hit->distance - truth);
    CHECK(error <= 1e-9 * subject->diagonal && error <= hit->error_bound + doubt, "%.17g not %s", truth,
          text_of(question, hit));
    CHECK(hit->lower_bound <= truth + doubt, "%.17g not %s", truth, text_of(question, hit));
    const double q[6] = { hit->q[0], hit->q[1], hit->q[2], hit->q[0], hit->q[1], hit->q[2] };
    const double off = oracle_brute_triangle(subject->oracle, hit->triangle, q);
    CHECK(off <= 1e-9 * subject->diagonal, "q is %g off %s", off, text_of(question, hit));
    return error;
}

/* How often the mesh goes round a point: the sum of solid angles (Van Oosterom, Strackee 1983). */
static double winding_number(const struct subject *subject, const double x[3])
{
    double sum = 0;
    for (uint32_t t = 0; t < subject->place.triangles; t++) {
        const float *corner = subject->corners + 9 * (size_t)t;
        double v[3][3], r[3], product[3];
        for (int i = 0; i < 3; i++) {
            for (int k = 0; k < 3; k++)
                v[i][k] = (double)corner[3 * i + k] - x[k];
            r[i] = sqrt(v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2]);
        }
        for (int i = 0; i < 3; i++) {
            const double *a = v[i], *b = v[(i + 1) % 3];
            product[i] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        }
        const double volume = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) +
                              v[0][1] * (v[1][2] * v[2][0] - v[1][0] * v[2][2]) +
                              v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
        const double sides = r[0] * r[1] * r[2] + product[0] * r[2] + product[1] * r[0] + product[2] * r[1];
        sum += 2 * atan2(volume, sides);
    }
    return sum / (4 * 3.14159265358979323846);
}

/* `most` of the ticks begin..end whose tool does not cross. */
static void check_signs(const struct subject *subject, const struct motion *motion, const dpt_hit *hits, size_t begin,
                        size_t end, size_t most, struct tally *tally)
{
    size_t free_ticks = 0, seen = 0;
    for (size_t i = begin; i < end; i++)
        free_ticks += hits[i].distance > 1e-9 * subject->diagonal;
    for (size_t i = begin; i < end; i++) {
        if (!(hits[i].distance > 1e-9 * subject->diagonal))
            continue;
        const size_t step = free_ticks > most ? free_ticks / most : 1;
        if (seen++ % step)
            continue;
        const struct question question = { subject, "sign", i, motion->ends[i] };
        const double winding = winding_number(subject, hits[i].p);
        const int inside = fabs(winding) > 0.5;
        CHECK(fabs(fabs(winding) - inside) < 1e-6, "winding %g %s", winding, text_of(&question, &hits[i]));
        CHECK((hits[i].gap < 0) == inside, "winding %g, gap %g %s", winding, hits[i].gap, text_of(&question, &hits[i]));
        tally->inside += (size_t)inside;
        tally->outside += (size_t)!inside;
    }
}

static struct motion motion_of(const struct subject *subject, uint64_t seed)
{
    static const size_t shares[MOTION_RECORDINGS] = {
        [MOTION_GEOMAGIC] = 400, [MOTION_MOCAP] = 400, [MOTION_LANDMARKS] = 100, [MOTION_WATERTANK] = 100
    };
    struct motion motion = { .count = 0 };
    /* Two places, as a hand stays for long where it is. */
    for (uint64_t i = 0; i < (soaking ? 1 : 2); i++) {
        const int slid = motion_slide(&motion, dynpoint, scratch, subject->compiled.bytes, subject->compiled.size,
                                      seed + i, soaking ? 20000 : part_of(350));
        CHECK(slid == 0, "%s: no slide; is there a program %s?", subject->name, dynpoint);
    }
    for (int i = 0; i < MOTION_RECORDINGS && data; i++)
        for (size_t done = 0; done < (soaking ? 1 : shares[i]); done += 100)
            motion_recorded(&motion, &recordings[i], &subject->place, seed + done, soaking ? 0 : 100);
    if (soaking || motion.count < part_of(2000))
        motion_random(&motion, &subject->place, seed, soaking ? 5000 : part_of(2000) - motion.count);
    return motion;
}

static void world_open(struct rig *rig, const struct subject *subject)
{
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    def.max_bodies = def.max_tools = def.max_segments = 1;
    def.method = DPT_METHOD_TREE;
    def.until = DPT_UNTIL_CONTACT;
    /* Random poses are jumps past all triangles of a hub: a budget would leave their contact to later ticks. */
    def.sweep_budget = 0;
    rig_open(rig, &def, subject->mesh, &rig_point, 1);
}

static dpt_hit world_tick(struct rig *rig, const struct motion *motion, size_t tick)
{
    if (motion->jumps[tick])
        dpt_tool_teleport(rig->world, rig->tool, &rig->device);
    return rig_step_ends(rig, motion->ends[tick], 0);
}

/* A segment's answer has nothing to do with its neighbours; only the work may be less. */
static void check_alone(const struct question *question, const dpt_hit *batch)
{
    const dpt_query_def tree = { .size = sizeof tree, .method = DPT_METHOD_TREE };
    dpt_hit alone = DPT_HIT_INIT;
    dpt_query_segments(question->subject->mesh, NULL, question->ends, NULL, 1, &alone, &tree);
    alone.work = batch->work;
    CHECK(memcmp(&alone, batch, sizeof alone) == 0, "%.17g %u alone: %s", alone.distance, alone.triangle,
          text_of(question, batch));
}

static void run(const struct subject *subject, const struct motion *motion, dpt_hit *hits, struct tally *tally)
{
    const dpt_query_def tree = { .size = sizeof tree, .method = DPT_METHOD_TREE };
    struct rig rig;
    hits[0].size = sizeof *hits;
    const dpt_result result =
        dpt_query_segments(subject->mesh, NULL, motion->ends[0], NULL, motion->count, hits, &tree);
    CHECK(result == DPT_OK, "%s: %s", subject->name, dpt_result_text(result));
    world_open(&rig, subject);
    for (size_t i = 0; i < motion->count; i++) {
        const struct question stateless = { subject, "stateless", i, motion->ends[i] };
        const struct question moved = { subject, "world", i, motion->ends[i] };
        const dpt_hit hit = world_tick(&rig, motion, i);
        check_form(&stateless, &hits[i]);
        check_form(&moved, &hit);
        CHECK(fabs(hit.distance - hits[i].distance) <= hit.error_bound, "%.17g in a world: %s", hit.distance,
              text_of(&stateless, &hits[i]));
        tally->crossing += hits[i].distance == 0;
        const double truth = oracle_brute(subject->oracle, motion->ends[i], NULL);
        const double error = fmax(check_truth(&stateless, &hits[i], truth), check_truth(&moved, &hit, truth));
        tally->worst = fmax(tally->worst, error / subject->diagonal);
        tally->worst_bound = fmax(tally->worst_bound, error / hit.error_bound);
        if (i % 16 == 0)
            check_alone(&stateless, &hits[i]);
    }
    tally->ticks = motion->count;
    rig_close(&rig);
}

static void add_to_all(const struct subject *subject, const struct tally *tally)
{
    printf("    %-28s %6u %7zu %6.1f %% %9.1e %6.3f", subject->name, subject->info.triangles, tally->ticks,
           100.0 * (double)tally->crossing / (double)tally->ticks, tally->worst, tally->worst_bound);
    if (subject->signs)
        printf("  %zu inside, %zu outside", tally->inside, tally->outside);
    printf("\n");
    all.meshes++;
    all.ticks += tally->ticks;
    all.crossing += tally->crossing;
    all.worst = fmax(all.worst, tally->worst);
    all.worst_bound = fmax(all.worst_bound, tally->worst_bound);
}

static void try_motions(const struct subject *subject)
{
    uint64_t seed = 5381;
    for (const char *c = subject->name; *c; c++)
        seed = 33 * seed + (unsigned char)*c;
    struct tally tally = { .ticks = 0 };
    struct motion motion = motion_of(subject, seed);
    const size_t small = motion.count;
    if (subject->signs)
        motion_small(&motion, &subject->place, seed, part_of(1000));
    dpt_hit *hits = calloc(motion.count, sizeof *hits);
    CHECK(hits, "memory");
    if (hits)
        run(subject, &motion, hits, &tally);
    if (hits && subject->signs) {
        CHECK(subject->info.components == 1 && subject->info.closed_components == 1, "%s is not closed", subject->name);
        check_signs(subject, &motion, hits, 0, small, part_of(200), &tally);
        check_signs(subject, &motion, hits, small, motion.count, part_of(400), &tally);
        CHECK(tally.inside >= part_of(40) && tally.outside >= part_of(40), "%s: %zu inside, %zu outside", subject->name,
              tally.inside, tally.outside);
    }
    add_to_all(subject, &tally);
    free(hits);
    motion_free(&motion);
}

/* A subject that is compiled and named, from a file if `path` is not NULL; closes it. */
static void put_to_test(struct subject *subject, const char *path, double scale)
{
    const int wanted = !only || strncmp(subject->name, only, strlen(only)) == 0;
    if (open_subject(subject) == 0) {
        if (path)
            compare_with_file(subject, path, scale);
        if (wanted)
            try_motions(subject);
    }
    oracle_brute_close(subject->oracle);
    free(subject->corners);
    dpt_compiled_free(&subject->compiled);
}

static void test_file(const char *folder, const char *file, double scale)
{
    static const char *const closed[] = { "openhelp_liver.stl",       "openhelp_spleen.stl",
                                          "openhelp_kidney_left.stl", "gallbladder_low.stl",
                                          "torus_1600.obj",           "spot.obj",
                                          "salad_bowl.obj",           "suture_needle_40mm.obj",
                                          "maryland_jaw.stl",         "gauze.obj" };
    char path[1024], name[256];
    const dpt_compile_def def = { .size = sizeof def, .scale = scale };
    dpt_diag diag = { .size = sizeof diag };
    struct subject subject = { .name = name };
    snprintf(path, sizeof path, "%s/meshes/%s/%s", data, folder, file);
    snprintf(name, sizeof name, scale == 1 ? "%s" : "%s * %g", file, scale);
    for (size_t i = 0; i < sizeof closed / sizeof *closed; i++)
        subject.signs |= strcmp(closed[i], file) == 0;
    const dpt_result result = dpt_compile_file(path, scale == 1 ? NULL : &def, &subject.compiled, &diag);
    CHECK(result == DPT_OK, "%s: %s", file, diag.text);
    if (result == DPT_OK)
        put_to_test(&subject, path, scale);
}

static void test_public_mesh(const char *folder, const char *file, void *unused)
{
    (void)unused;
    test_file(folder, file, 1);
}

static void public_meshes(void)
{
    for_each_public_mesh(data, test_public_mesh, NULL);
}

/* Millimetres that are made metres, and the largest floats made to fit. */
static void scaled_meshes(void)
{
    char path[1024];
    dpt_compiled compiled;
    test_file("organs", "openhelp_stomach.stl", 1e-3);
    test_file("tools", "instrument_shaft.stl", 1e-3);
    snprintf(path, sizeof path, "%s/meshes/hard/%s", data, TOO_LARGE_MESH);
    CHECK(dpt_compile_file(path, NULL, &compiled, NULL) == DPT_E_FINITE, "%s fits", TOO_LARGE_MESH);
    test_file("hard", TOO_LARGE_MESH, 1e-33);
    CHECK(all.files_read >= 20, "%zu binary STL files", all.files_read);
}

static void test_shape(const char *name, struct shape *shape, int signs)
{
    dpt_diag diag = { .size = sizeof diag };
    struct subject subject = { .name = name, .signs = signs };
    const dpt_result result = dpt_compile_arrays(shape->vertices, shape->vertex_count, shape->corners,
                                                 shape->triangle_count, NULL, &subject.compiled, &diag);
    CHECK(result == DPT_OK, "%s: %s", name, diag.text);
    shape_free(shape);
    if (result == DPT_OK)
        put_to_test(&subject, NULL, 1);
}

static void shapes(void)
{
    static const struct {
        const char *name;
        uint64_t count;
        int signs;
    } cases[] = { { "torus", 5568, 1 }, { "torus", 32, 1 },   { "liver", 50332, 1 }, { "membrane", 512, 0 },
                  { "cloth", 2048, 0 }, { "star", 20480, 1 }, { "star", 2000, 1 },   { "hub", 5000, 0 } };
    struct shape shape, bodies[LAPAROSCOPIC_BODIES];
    shape_reason reason = "";
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const int failed = shape_make(cases[i].name, cases[i].count, 0, &shape, reason);
        CHECK(!failed, "%s: %s", cases[i].name, reason);
        if (!failed)
            test_shape(cases[i].name, &shape, cases[i].signs);
    }
    const int failed = shape_make_laparoscopic(LAPAROSCOPIC_TRIANGLES, 0, bodies, reason);
    CHECK(!failed, "laparoscopic: %s", reason);
    for (int i = 0; i < LAPAROSCOPIC_BODIES && !failed; i++) {
        char name[64];
        snprintf(name, sizeof name, "laparoscopic %s", laparoscopic_names[i]);
        test_shape(name, &bodies[i], 0);
    }
}

static void tools_cross_and_do_not(void)
{
    const double share = (double)all.crossing / (double)all.ticks;
    printf("    %zu meshes, %zu ticks, %.1f %% crossing; off by %.1e of the "
           "diagonal and %.3f of error_bound at worst\n",
           all.meshes, all.ticks, 100 * share, all.worst, all.worst_bound);
    CHECK(only ? all.meshes > 0 : share > 0.1 && share < 0.8, "%g", share);
}

int main(int argc, char **argv)
{
    setvbuf(stdout, NULL, _IOLBF, 0); /* what failed is told even if a crash follows */
    const char *slash = strrchr(argv[0], '/');
    const int folder = slash ? (int)(slash - argv[0]) : 1;
    const char *start = slash ? argv[0] : ".";
    data = getenv("DPT_DATA");
    soaking = argc > 1 && strcmp(argv[1], "soak") == 0;
    if (!soaking)
        take_percent(argc, argv);
    only = argc > 2 ? argv[2] : NULL;
    snprintf(dynpoint, sizeof dynpoint, "%.*s/../dynpoint", folder, start);
    snprintf(scratch, sizeof scratch, "%.*s/organs-%ld", folder, start, (long)getpid());
    for (int i = 0; i < MOTION_RECORDINGS && data; i++)
        data = recording_read(&recordings[i], data, i) ? NULL : data;
    printf("    %-25s triangles   ticks    cross     worst of diagonal, bound\n", "mesh");
    if (data) {
        TEST(public_meshes);
        TEST(scaled_meshes);
    } else {
        SKIP("the public meshes", "DPT_DATA does not name the data folder");
    }
    TEST(shapes);
    TEST(tools_cross_and_do_not);
    for (int i = 0; i < MOTION_RECORDINGS; i++)
        recording_free(&recordings[i]);
    return check_report();
}
