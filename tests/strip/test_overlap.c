/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How a segment stands to each triangle of a strip. The overlap by search: the distance to the triangle, moved against
 * its normal by m, is convex in m, so its least is found by thirds, and where it last is as small as the radius by
 * halving.
 *
 *     test_overlap [PER CENT]   of the shadows; a real mesh from DPT_DATA
 */
#include "strip/strip_random.h"

static const char *data;

struct descent {
    const double *ends;
    double corners[9], normal[3];
};

static double moved_apart(const struct descent *d, double m)
{
    double corners[9];
    for (int k = 0; k < 9; k++)
        corners[k] = d->corners[k] - m * d->normal[k % 3];
    return dpt_segment_triangle(d->ends, corners, NULL, NULL, NULL);
}

/* The largest m of 0..most where the distance is at most `reach`; 0 when there is none. */
static double last_touch(const struct descent *d, double reach, double most)
{
    double low = 0, high = most;
    /* Any that is as near. */
    for (int i = 0; i < 120 && moved_apart(d, low) > reach; i++) {
        const double third = (high - low) / 3;
        const double one = moved_apart(d, low + third), other = moved_apart(d, high - third);
        if (one > reach && one < other)
            high -= third;
        else
            low += third;
    }
    if (moved_apart(d, low) > reach)
        return 0;
    high = most;
    for (int i = 0; i < 100; i++) {
        const double middle = 0.5 * (low + high);
        if (moved_apart(d, middle) <= reach)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static double most_of(const double *numbers, int count)
{
    double most = 0;
    for (int k = 0; k < count; k++)
        most = fmax(most, fabs(numbers[k]));
    return most;
}

static void check_overlap(const struct scene *scene, const dpt_shadow *shadow, int32_t side, const dpt_overlap *o,
                          size_t seen[4])
{
    const double radius = shadow->segment.radius;
    double ends[6], c[9], n[3], way[3], s, p[3], q[3], sum = 0;
    ends_of(&shadow->segment, ends);
    scene_triangle(scene, o->triangle, c);
    const double truth = dpt_segment_triangle(ends, c, &s, p, q);
    const double near = 1e-12 * (most_of(ends, 6) + most_of(c, 9) + 4 * scene->subject->diagonal);
    const int crosses = (o->flags & DPT_OVERLAP_FLAG_CROSSING) != 0;
    CHECK(fabs(o->distance - truth) <= near, "%u: %.17g, not %.17g: %s", o->triangle, o->distance, truth,
          shadow_text(scene, shadow));
    CHECK(crosses == (o->distance == 0) && (o->flags & ~1u) == 0 && o->reserved == 0, "%u: flags %u, distance %g: %s",
          o->triangle, o->flags, o->distance, shadow_text(scene, shadow));
    CHECK(o->s >= 0 && o->s <= 1, "%u: s %g", o->triangle, o->s);
    /* The points exist, and are as far apart. */
    for (int k = 0; k < 3; k++) {
        const double by = o->weight[0] * c[k] + o->weight[1] * c[3 + k] + o->weight[2] * c[6 + k];
        CHECK(fabs(by - o->q[k]) <= near, "%u: q is not where its weights say: %s", o->triangle,
              shadow_text(scene, shadow));
        CHECK(o->weight[k] >= 0 && o->weight[k] <= 1, "%u: weight %g", o->triangle, o->weight[k]);
        sum += o->weight[k];
        p[k] = ends[k] + o->s * (ends[3 + k] - ends[k]);
        way[k] = p[k] - o->q[k];
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = side * ((c[3 + i] - c[i]) * (c[6 + j] - c[j]) - (c[3 + j] - c[j]) * (c[6 + i] - c[i]));
    }
    CHECK(fabs(sum - 1) <= 1e-14, "%u: weights %.17g", o->triangle, sum);
    CHECK(fabs(sqrt(dot3(way, way)) - o->distance) <= near, "%u: p and q are %g apart, not %g: %s", o->triangle,
          sqrt(dot3(way, way)), o->distance, shadow_text(scene, shadow));
    /* Slivers have no normal to speak of. */
    const double edge[3] = { c[3] - c[0], c[4] - c[1], c[5] - c[2] };
    const double other[3] = { c[6] - c[0], c[7] - c[1], c[8] - c[2] };
    const double area = sqrt(dot3(n, n)), longest = fmax(dot3(edge, edge), dot3(other, other));
    if (area < 1e-5 * longest || longest < 1e-16 * scene->subject->diagonal)
        return;
    unit3(n);
    struct descent d = { .ends = ends };
    memcpy(d.corners, c, sizeof c);
    memcpy(d.normal, n, sizeof n);
    const double most = 2 * (apart(ends, ends + 3) + o->distance + sqrt(longest) + radius);
    const double loose = 10 * near * fmax(1, 100 * longest / area);
    const double least = last_touch(&d, radius > loose ? radius - loose : 0, most) - 1e-9 * most;
    const double highest = last_touch(&d, radius + loose, most) + 1e-9 * most;
    CHECK(o->overlap >= least && o->overlap <= highest, "%u: overlap %.17g, not %.17g to %.17g: %s", o->triangle,
          o->overlap, least, highest, shadow_text(scene, shadow));
    const double due = o->overlap > 0 ? -o->overlap : o->distance - radius;
    CHECK(fabs(o->gap - due) <= near, "%u: gap %g, not %g, overlap %g, distance %g: %s", o->triangle, o->gap, due,
          o->overlap, o->distance, shadow_text(scene, shadow));
    seen[crosses]++;
    seen[2 + (o->overlap > 0)]++;
}

static void try_overlaps(const struct subject *subject, int count, uint64_t seed, size_t seen[4])
{
    struct scene scene;
    struct guarded_strip guarded;
    dpt_overlap *overlaps = malloc((subject->info.triangles + 1) * sizeof *overlaps);
    scene_open(&scene, subject);
    dpt_strip *strip = guarded_strip_open(&guarded, room_for(subject), 0);
    for (int i = 0; i < (int)part_of((uint64_t)count); i++) {
        dpt_shadow shadow;
        uint32_t n = 0, told = 0;
        const int32_t side = i % 2 ? 1 : -1;
        if (i == (int)part_of((uint64_t)count) / 2) {
            dpt_pose pose;
            random_pose(&scene, &seed, &pose);
            scene_place(&scene, &pose);
        }
        random_shadow(&scene, &seed, &shadow);
        fill_strip(&scene, &shadow, strip);
        const uint32_t *triangles = dpt_strip_get_triangles(strip, &n, NULL);
        memset(overlaps, 0x5a, (n + 1) * sizeof *overlaps);
        overlaps[0].size = sizeof *overlaps;
        const dpt_result result =
            dpt_strip_overlaps(strip, subject->mesh, scene.pose, &shadow.segment, side, overlaps, n + 1, &told);
        CHECK(result == DPT_OK && told == n, "%s, %u of %u: %s", dpt_result_name(result), told, n,
              shadow_text(&scene, &shadow));
        for (uint32_t k = 0; k < n; k++) {
            CHECK(overlaps[k].triangle == triangles[k] && overlaps[k].size == sizeof *overlaps, "%u: %u, not %u", k,
                  overlaps[k].triangle, triangles[k]);
            if (overlaps[k].triangle == triangles[k])
                check_overlap(&scene, &shadow, side, &overlaps[k], seen);
        }
        CHECK(overlaps[n].triangle == 0x5a5a5a5a, "wrote beyond");
    }
    guarded_strip_close(&guarded);
    scene_close(&scene);
    free(overlaps);
}

static void overlaps_by_search(void)
{
    static const struct {
        const char *name;
        uint64_t count;
    } shapes[] = { { "torus", 1600 }, { "cloth", 2048 }, { "star", 2000 }, { "box", 12 }, { "hub", 300 } };
    size_t seen[4] = { 0, 0, 0, 0 };
    struct subject subject;
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        if (subject_from_shape(&subject, shapes[i].name, shapes[i].count))
            try_overlaps(&subject, 120, i, seen);
        subject_close(&subject);
    }
    for (uint64_t i = 0; i < 4; i++) {
        if (subject_from_lattice(&subject, 4, 200, i))
            try_overlaps(&subject, 60, i, seen);
        subject_close(&subject);
    }
    if (data && subject_from_file(&subject, data, "organs", "openhelp_liver.stl")) {
        try_overlaps(&subject, 60, 9, seen);
        subject_close(&subject);
    }
    CHECK(seen[0] > part_of(1000) && seen[1] > part_of(300) && seen[2] > part_of(1000) && seen[3] > part_of(1000),
          "%zu free, %zu crossing, %zu without overlap, %zu with", seen[0], seen[1], seen[2], seen[3]);
}

/* The caller's room and stride. */
static void bad_overlap_arguments(const dpt_strip *strip, const dpt_mesh *mesh, const dpt_segment *segment)
{
    dpt_overlap two[2] = { { .size = sizeof *two } };
    uint32_t told = 0;
    const dpt_segment nan = { { NAN, 0, 0 }, { 0, 0, 0 }, 0 };
    const dpt_segment far = { { 2e6, 0, 0 }, { 0, 0, 0 }, 0 };
    const dpt_segment thin = { { 0, 0, 0 }, { 0, 0, 0 }, -1 };
    CHECK(dpt_strip_overlaps(strip, mesh, NULL, &thin, 1, two, 2, &told) != DPT_OK, "radius -1");
    const dpt_pose bent = { { 0, 0, 0 }, { 1, 1, 0, 0 } };
    const struct {
        dpt_result result;
        const dpt_strip *strip;
        const dpt_mesh *mesh;
        const dpt_pose *pose;
        const dpt_segment *segment;
        int32_t side;
        dpt_overlap *overlaps;
    } bad[] = {
        { DPT_E_ARGUMENT, NULL, mesh, NULL, segment, 1, two },  { DPT_E_ARGUMENT, strip, NULL, NULL, segment, 1, two },
        { DPT_E_ARGUMENT, strip, mesh, NULL, NULL, 1, two },    { DPT_E_ARGUMENT, strip, mesh, NULL, segment, 0, two },
        { DPT_E_ARGUMENT, strip, mesh, NULL, segment, 2, two }, { DPT_E_ARGUMENT, strip, mesh, NULL, segment, 1, NULL },
        { DPT_E_FINITE, strip, mesh, NULL, &nan, 1, two },      { DPT_E_FINITE, strip, mesh, NULL, &far, 1, two },
        { DPT_E_POSE, strip, mesh, &bent, segment, 1, two }
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const dpt_result result = dpt_strip_overlaps(bad[i].strip, bad[i].mesh, bad[i].pose, bad[i].segment,
                                                     bad[i].side, bad[i].overlaps, 2, &told);
        CHECK(result == bad[i].result, "bad %zu: %s, not %s", i, dpt_result_name(result),
              dpt_result_name(bad[i].result));
    }
}

/* Structs of a newer library: what this one does not know becomes zero. */
static void longer_overlaps(const dpt_strip *strip, const dpt_mesh *mesh, const dpt_segment *segment,
                            const dpt_overlap *all_of_it)
{
    struct {
        dpt_overlap overlap;
        double newer[2];
    } longer[4];
    static const double zeros[2];
    uint32_t told = 0;
    memset(longer, 0x5a, sizeof longer);
    longer[0].overlap.size = sizeof *longer;
    CHECK(dpt_strip_overlaps(strip, mesh, NULL, segment, 1, &longer[0].overlap, 3, &told) == DPT_OK, "longer");
    for (int i = 0; i < 3; i++)
        CHECK(longer[i].overlap.triangle == all_of_it[i].triangle && longer[i].overlap.gap == all_of_it[i].gap &&
                  longer[i].overlap.size == sizeof *longer && memcmp(longer[i].newer, zeros, sizeof zeros) == 0,
              "longer %d", i);
    CHECK(longer[3].overlap.size == 0x5a5a5a5a, "wrote beyond");
}

static void room_for_overlaps(void)
{
    struct subject subject;
    struct scene scene;
    struct guarded_strip guarded;
    dpt_overlap two[3], all_of_it[64];
    uint32_t n = 0, told = 77;
    if (!subject_from_shape(&subject, "membrane", 200))
        return;
    scene_open(&scene, &subject);
    dpt_strip *strip = guarded_strip_open(&guarded, 64, 0);
    const double ends[6] = { -0.03, 0.004, 0.001, 0.03, 0.004, 0.001 };
    dpt_shadow shadow;
    shadow_below(&scene, ends, 0.002, &shadow);
    shadow.depth = 0.01;
    fill_strip(&scene, &shadow, strip);
    dpt_strip_get_triangles(strip, &n, NULL);
    CHECK(n > 4 && n < 64, "%u", n);
    const dpt_mesh *mesh = subject.mesh;
    const dpt_segment *segment = &shadow.segment;
    all_of_it[0].size = two[0].size = sizeof *two;
    CHECK(dpt_strip_overlaps(strip, mesh, NULL, segment, 1, all_of_it, 64, &told) == DPT_OK && told == n, "%u", told);
    CHECK(dpt_strip_overlaps(strip, mesh, NULL, segment, 1, NULL, 0, &told) == DPT_OK && told == n, "%u", told);
    memset(two, 0x5a, sizeof two);
    two[0].size = sizeof *two;
    CHECK(dpt_strip_overlaps(strip, mesh, NULL, segment, 1, two, 2, &told) == DPT_OK && told == n, "%u", told);
    CHECK(memcmp(two, all_of_it, 2 * sizeof *two) == 0 && two[2].size == 0x5a5a5a5a, "room for two");
    longer_overlaps(strip, mesh, segment, all_of_it);
    two[0].size = 8;
    CHECK(dpt_strip_overlaps(strip, mesh, NULL, segment, 1, two, 2, &told) == DPT_E_SIZE, "size 8");
    two[0].size = 0;
    CHECK(dpt_strip_overlaps(strip, mesh, NULL, segment, 1, two, 2, &told) == DPT_E_SIZE, "size 0");
    two[0].size = sizeof *two;
    bad_overlap_arguments(strip, mesh, segment);
    guarded_strip_close(&guarded);
    scene_close(&scene);
    subject_close(&subject);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    data = getenv("DPT_DATA");
    TEST(overlaps_by_search);
    TEST(room_for_overlaps);
    return check_report();
}
