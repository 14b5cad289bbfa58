/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Asked once more at the same pose a world says what it said the first time, and so does a stateless query: on closed
 * parts, on sheets, and on parts with holes, through which an axis comes and goes without a crossing. Whether it is
 * right, where all say the same, other tests tell (test_depth, test_winding).
 *
 * Real meshes from DPT_DATA.
 */
#include "lib/rig.h"
#include "lib/strip_subject.h"

static const char *data;

struct tally {
    size_t poses, inside, differ, queries;
    double largest; /* of the diagonal */
};

static void random_axis(const struct subject *subject, uint64_t *seed, double size, dpt_segment *axis)
{
    double way[3], at = random_in(seed, 0.0, 1.0);
    random_unit(seed, way);
    for (int k = 0; k < 3; k++) {
        double x = random_in(seed, subject->info.box_min[k], subject->info.box_max[k]);
        axis->a[k] = x - at * size * way[k];
        axis->b[k] = x + (1.0 - at) * size * way[k];
    }
}

static void try_poses(const struct subject *subject, uint32_t poses, struct tally *tally)
{
    const dpt_world_def def = rig_def(DPT_LAW_POINT);
    struct rig rig;
    uint64_t seed = 5;
    rig_open(&rig, &def, subject->mesh, NULL, 0);
    *tally = (struct tally){ .poses = poses };
    for (uint32_t i = 0; i < poses; i++) {
        dpt_hit hits[2] = { DPT_HIT_INIT, DPT_HIT_INIT }, alone = DPT_HIT_INIT;
        dpt_segment axis = { .radius = 0.005 * subject->diagonal };
        random_axis(subject, &seed, (i % 3 + 1) * 0.2 * subject->diagonal, &axis);
        const dpt_tool tool = rig_add_tool(&rig, &axis, 1);
        for (int again = 0; again < 2; again++) {
            rig_tick(&rig);
            dpt_tool_get_hit(rig.world, tool, &hits[again]);
        }
        dpt_tool_remove(rig.world, tool);
        const double ends[6] = { axis.a[0], axis.a[1], axis.a[2], axis.b[0], axis.b[1], axis.b[2] };
        dpt_query_segments(subject->mesh, NULL, ends, &axis.radius, 1, &alone, NULL);
        const double off = fabs(hits[0].gap - hits[1].gap) / subject->diagonal;
        tally->inside += hits[1].gap < -axis.radius;
        tally->differ += hits[0].contact != hits[1].contact || off > 1e-5;
        tally->queries += alone.contact != hits[1].contact || fabs(alone.gap - hits[1].gap) > 1e-5 * subject->diagonal;
        tally->largest = off > tally->largest ? off : tally->largest;
    }
    printf("    %-28s %4zu poses, %4zu inside; again %zu say something else, by %.1e of the "
           "diagonal at most; %zu queries\n",
           subject->name, tally->poses, tally->inside, tally->differ, tally->largest, tally->queries);
    rig_close(&rig);
}

/* A tube of `sides` sides and so many rings, open at both ends. */
static int open_tube(struct subject *subject, uint32_t sides, uint32_t rings)
{
    double *vertices = malloc((size_t)sides * (rings + 1) * 3 * sizeof *vertices);
    uint32_t *corners = malloc((size_t)sides * rings * 6 * sizeof *corners);
    size_t v = 0, c = 0;
    for (uint32_t i = 0; i <= rings; i++)
        for (uint32_t k = 0; k < sides; k++) {
            const double angle = 2.0 * acos(-1.0) * k / sides;
            vertices[v++] = 0.008 * cos(angle);
            vertices[v++] = 0.008 * sin(angle);
            vertices[v++] = 0.1 * i / rings;
        }
    for (uint32_t i = 0; i < rings; i++)
        for (uint32_t k = 0; k < sides; k++) {
            const uint32_t a = i * sides + k, b = i * sides + (k + 1) % sides;
            const uint32_t two[6] = { a, b, b + sides, a, b + sides, a + sides };
            memcpy(corners + c, two, sizeof two);
            c += 6;
        }
    const int opened = subject_from_arrays(subject, "open tube", vertices, v / 3, corners, c / 3);
    free(vertices);
    free(corners);
    return opened;
}

static void generated_shapes(void)
{
    static const char *const names[] = { "torus", "liver", "star", "sphere", "box", "membrane" };
    struct subject subject;
    struct tally tally;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (subject_from_shape(&subject, names[i], i < 4 ? 2000 : 0)) {
            try_poses(&subject, 300, &tally);
            CHECK(!tally.differ && !tally.queries, "%s: %zu, %zu", names[i], tally.differ, tally.queries);
            CHECK(tally.inside > 50 || i == 5, "%s: %zu", names[i], tally.inside);
        }
        subject_close(&subject);
    }
}

/* An inside that begins and ends between two samples is not seen at once: rare, and counted. */
static void with_holes(void)
{
    static const char *const files[][2] = { { "organs", "vessel_open_ends.stl" },
                                            { "organs", "skin_arm_oss.ply" },
                                            { "organs", "liver_dirty_low.stl" },
                                            { "hard", "bunny_dirty.ply" } };
    struct subject subject;
    struct tally tally;
    if (open_tube(&subject, 24, 20)) {
        CHECK(subject.info.winding_components == 1, "%u", subject.info.winding_components);
        try_poses(&subject, 1000, &tally);
        CHECK(tally.inside > 200 && tally.differ <= tally.poses / 100 && tally.queries <= tally.poses / 50,
              "open tube: %zu, %zu, %zu", tally.inside, tally.differ, tally.queries);
    }
    subject_close(&subject);
    for (size_t i = 0; data && i < sizeof files / sizeof *files; i++) {
        if (subject_from_file(&subject, data, files[i][0], files[i][1])) {
            try_poses(&subject, 300, &tally);
            CHECK(tally.inside > 20 && tally.differ <= tally.poses / 100 && tally.queries <= tally.poses / 50,
                  "%s: %zu, %zu, %zu", files[i][1], tally.inside, tally.differ, tally.queries);
        }
        subject_close(&subject);
    }
}

/* Deeper behind a sheet than the limit, it is not behind it: on the tick that brings it there as on the next. */
static void too_deep_behind_a_sheet(void)
{
    struct subject subject;
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    def.side_limit = 0.02;
    if (!subject_from_shape(&subject, "membrane", 512))
        return;
    for (int deep = 0; deep < 2; deep++)
        for (int crosses = 0; crosses < 2; crosses++) {
            struct rig rig;
            dpt_hit hits[3];
            const double low = deep ? -0.03 : -0.01;
            const dpt_segment before = { { 0.01, 0.02, 0.005 }, { 0.01, 0.02, 0.04 }, 0.001 };
            const dpt_segment after = { { 0.01, 0.02, low }, { 0.01, 0.02, crosses ? 0.01 : low - 0.005 }, 0.001 };
            rig_open(&rig, &def, subject.mesh, &before, 1);
            for (int tick = 0; tick < 3; tick++) {
                if (tick == 1)
                    dpt_tool_set_segments(rig.world, rig.tool, &after, 1);
                rig_tick(&rig);
                hits[tick] = rig.hit;
            }
            rig_close(&rig);
            const uint32_t due = !deep     ? DPT_CONTACT_PENETRATING
                                 : crosses ? DPT_CONTACT_UNKNOWN
                                           : DPT_CONTACT_SEPARATED;
            CHECK(hits[1].contact == due && hits[2].contact == due && hits[1].gap == hits[2].gap,
                  "%d, %d: %u and %u, not %u; gaps %g, %g", deep, crosses, hits[1].contact, hits[2].contact, due,
                  hits[1].gap, hits[2].gap);
        }
    subject_close(&subject);
}

/* What a segment tells is no less deep than any of its regions, as a tool presses on a sheet, over its borders too. */
static void as_deep_as_its_regions(void)
{
    struct subject subject;
    const dpt_world_def def = rig_def(DPT_LAW_POINT);
    size_t pressed = 0;
    uint64_t seed = 11;
    if (!subject_from_shape(&subject, "membrane", 512))
        return;
    for (int run = 0; run < 40; run++) {
        struct rig rig;
        const double x = random_in(&seed, -0.1, 0.1), y = random_in(&seed, -0.1, 0.1);
        const double turn = random_in(&seed, 0.0, 6.3), tilt = random_in(&seed, -0.01, 0.01);
        rig_open(&rig, &def, subject.mesh, &rig_point, 1);
        for (int tick = 0; tick < 400; tick++) {
            /* Down, then along. */
            const double middle = 0.02 - 4e-4 * (tick < 60 ? tick : 60), slid = 3e-4 * (tick - 60);
            const double way[2] = { 0.12 * cos(turn), 0.12 * sin(turn) };
            const double by = tick > 60 ? slid : 0.0;
            const double ends[6] = { x + by - way[0], y - way[1], middle - tilt,
                                     x + by + way[0], y + way[1], middle + tilt };
            dpt_contact contacts[RIG_CONTACTS];
            const dpt_hit hit = rig_step_ends(&rig, ends, 0.001);
            const uint32_t count = rig_contacts(&rig, contacts);
            for (uint32_t i = 0; i < count && hit.flags & DPT_HIT_FLAG_GAP; i++)
                CHECK(hit.gap <= contacts[i].gap + hit.error_bound, "%d, %d: %.9g, a region %.9g", run, tick, hit.gap,
                      contacts[i].gap);
            pressed += hit.contact == DPT_CONTACT_PENETRATING;
        }
        rig_close(&rig);
    }
    CHECK(pressed > 1000, "%zu", pressed);
    subject_close(&subject);
}

/* A budget is kept also where sides take winding numbers. */
static void windings_within_the_budget(void)
{
    struct subject subject;
    uint64_t seed = 3;
    size_t unknown = 0, known = 0;
    if (!open_tube(&subject, 24, 20))
        return;
    for (uint32_t budget = 1; budget < 3000; budget *= 3) {
        dpt_world_def def;
        dpt_world_def_init(&def);
        def.max_contacts = 32;
        def.law = DPT_LAW_POINT;
        def.budget = budget;
        struct rig rig;
        rig_open(&rig, &def, subject.mesh, NULL, 0);
        for (int i = 0; i < 30; i++) {
            dpt_segment axis = { .radius = 0.002 };
            random_axis(&subject, &seed, 0.05, &axis);
            const dpt_tool tool = rig_add_tool(&rig, &axis, 1);
            for (int tick = 0; tick < 5; tick++) {
                rig_tick(&rig);
                CHECK(rig.step.work <= budget, "%u of %u", rig.step.work, budget);
                unknown += rig.step.contact == DPT_CONTACT_UNKNOWN;
                known += rig.step.contact == DPT_CONTACT_PENETRATING;
            }
            dpt_tool_remove(rig.world, tool);
        }
        rig_close(&rig);
    }
    CHECK(unknown > 100 && known > 100, "%zu unknown, %zu known", unknown, known);
    subject_close(&subject);
}

int main(void)
{
    data = getenv("DPT_DATA");
    TEST(generated_shapes);
    TEST(with_holes);
    TEST(too_deep_behind_a_sheet);
    TEST(as_deep_as_its_regions);
    TEST(windings_within_the_budget);
    if (!data)
        SKIP("organs with holes", "DPT_DATA does not name the data folder");
    return check_report();
}
