/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a strip remembers from one shadow to the next: it must not show, at rest, in motion, over one mesh after the
 * other and where another one was.
 *
 *     test_strip_memory           what make check runs
 *     test_strip_memory FACTOR    so many times as many ticks of sliding
 *
 * Real meshes and recorded motions from DPT_DATA.
 */
#include "strip/strip_sheet.h"

static const char *data;
static uint64_t factor = 1;

struct course {
    struct scene scene;
    struct guarded_strip kept;
    size_t ticks, triangles;
};

static void course_tick(struct course *course, const double ends[6], double radius, double width, double depth,
                        int judged)
{
    dpt_shadow shadow;
    struct guarded_strip fresh;
    uint32_t count = 0;
    shadow_below(&course->scene, ends, radius, &shadow);
    shadow.width = width;
    shadow.depth = depth;
    fill_strip(&course->scene, &shadow, course->kept.strip);
    fill_strip(&course->scene, &shadow, guarded_strip_open(&fresh, room_for(course->scene.subject), 0));
    CHECK(are_alike(&course->scene, course->kept.strip, fresh.strip), "tick %zu: a fresh strip has others: %s",
          course->ticks, shadow_text(&course->scene, &shadow));
    dpt_strip_get_triangles(fresh.strip, &count, NULL);
    guarded_strip_close(&fresh);
    course->ticks++;
    course->triangles += count;
    if (!judged)
        return;
    ask_oracle(&course->scene, &shadow);
    check_sheet(&course->scene, &shadow, course->kept.strip);
}

/* Sliding, by steps of 0.1 to 5 mm of a mesh of 0.35 m, and turning. */
static void slide_over(struct course *course, uint64_t seed, size_t ticks)
{
    const double size = course->scene.subject->diagonal, mm = size / 350;
    for (int run = 0; run < 6; run++) {
        static const double steps[6] = { 0.1, 0.3, 1, 2, 5, 0.1 };
        static const double lengths[6] = { 0.05, 0.2, 0.5, 0.01, 0.1, 1 };
        const double radius = run % 2 ? 0.01 * size : 0;
        struct slide slide = { .mesh = course->scene.subject->mesh,
                               .radius = radius,
                               .gap = mm,
                               .step = steps[run] * mm,
                               .spin = 0.004 * run,
                               .seed = seed + (uint64_t)run };
        tool_at(&course->scene, &slide.seed, lengths[run] * size, radius + mm, 1, slide.ends);
        random_unit(&slide.seed, slide.axis);
        random_unit(&slide.seed, slide.course);
        for (size_t i = 0; i < factor * ticks; i++) {
            course_tick(course, slide.ends, radius, run % 3 ? 0.005 * size : 0, run % 2 ? 0.02 * size : 0.1 * size,
                        i % 16 == 0);
            slide_step(&slide);
        }
    }
}

static void record_over(struct course *course, uint64_t seed)
{
    const struct subject *subject = course->scene.subject;
    struct motion motion = { .count = 0 };
    struct motion_place place = { .tool = MOTION_TOOL };
    memcpy(place.low, subject->info.box_min, sizeof place.low);
    memcpy(place.high, subject->info.box_max, sizeof place.high);
    for (int i = 0; i < MOTION_RECORDINGS; i++) {
        struct recording recording;
        const int failed = recording_read(&recording, data, i);
        CHECK(!failed, "no recording %s", motion_names[i]);
        if (!failed)
            motion_recorded(&motion, &recording, &place, seed, 150);
        recording_free(&recording);
    }
    for (size_t i = 0; i < motion.count; i++)
        course_tick(course, motion.ends[i], 0.01 * subject->diagonal, 0,
                    i % 40 < 20 ? 0.05 * subject->diagonal : 0.3 * subject->diagonal, i % 16 == 0);
    motion_free(&motion);
}

static void go_over(const struct subject *subject, uint64_t seed, size_t ticks)
{
    struct course course = { .ticks = 0 };
    scene_open(&course.scene, subject);
    guarded_strip_open(&course.kept, room_for(subject), 0);
    slide_over(&course, seed, ticks);
    if (data)
        record_over(&course, seed);
    /* The body moves too. */
    dpt_pose pose;
    random_pose(&course.scene, &seed, &pose);
    for (int i = 0; i < 40; i++) {
        double ends[6];
        uint64_t same = seed;
        pose.position[i % 3] += 0.003 * subject->diagonal;
        scene_place(&course.scene, &pose);
        tool_at(&course.scene, &same, 0.2 * subject->diagonal, 0.01 * subject->diagonal, 1, ends);
        course_tick(&course, ends, 0, 0.01 * subject->diagonal, 0.05 * subject->diagonal, 1);
    }
    printf("    %-30s %zu ticks of %.1f triangles\n", subject->name, course.ticks,
           (double)course.triangles / (double)course.ticks);
    guarded_strip_close(&course.kept);
    scene_close(&course.scene);
}

static void remembered_in_motion(void)
{
    static const struct {
        const char *name;
        uint64_t count;
    } shapes[] = { { "torus", 5568 }, { "liver", 20000 }, { "cloth", 2048 }, { "star", 20480 }, { "hub", 2000 } };
    static const char *const files[] = { "openhelp_liver.stl", "gallbladder_low.stl", "liver_metres.stl",
                                         "vessel_open_ends.stl" };
    struct subject subject;
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        if (subject_from_shape(&subject, shapes[i].name, shapes[i].count))
            go_over(&subject, i, 50);
        subject_close(&subject);
    }
    for (size_t i = 0; data && i < sizeof files / sizeof *files; i++) {
        if (subject_from_file(&subject, data, "organs", files[i]))
            go_over(&subject, i, 30);
        subject_close(&subject);
    }
    if (!data)
        SKIP("motions over organs", "DPT_DATA does not name the data folder");
}

/* One strip for one mesh after the other does not take one for the other, nor what a route left. */
static void meshes_in_turn(void)
{
    struct subject subjects[2];
    struct scene scenes[2];
    struct guarded_strip guarded;
    uint64_t seed = 3;
    if (!subject_from_shape(&subjects[0], "torus", 2000) || !subject_from_shape(&subjects[1], "sphere", 2000))
        return;
    dpt_strip *strip = guarded_strip_open(&guarded, 2000, 2000);
    for (int s = 0; s < 2; s++)
        scene_open(&scenes[s], &subjects[s]);
    for (int i = 0; i < 200; i++) {
        const struct scene *scene = &scenes[i % 2];
        dpt_shadow shadow;
        random_shadow(scene, &seed, &shadow);
        ask_oracle(&scenes[i % 2], &shadow);
        fill_strip(scene, &shadow, strip);
        check_sheet(scene, &shadow, strip);
        if (i % 3 == 0)
            CHECK(dpt_strip_route(strip, scene->subject->mesh, 1, 1000) == DPT_OK, "a route");
    }
    guarded_strip_close(&guarded);
    for (int s = 0; s < 2; s++) {
        scene_close(&scenes[s]);
        subject_close(&subjects[s]);
    }
}

/* The same shadow again is the same strip, from another triangle that of this one. */
static void the_same_shadow_again(void)
{
    struct subject subject;
    struct scene scene;
    struct guarded_strip guarded;
    uint64_t seed = 11;
    size_t others = 0;
    if (!subject_with_folds(&subject, 0.002))
        return;
    scene_open(&scene, &subject);
    dpt_strip *strip = guarded_strip_open(&guarded, subject.info.triangles, 0);
    for (int i = 0; i < 200; i++) {
        dpt_shadow shadow;
        random_shadow(&scene, &seed, &shadow);
        for (int k = 0; k < 4; k++) {
            const uint32_t before = scene.sheet.sure;
            ask_oracle(&scene, &shadow);
            fill_strip(&scene, &shadow, strip);
            check_sheet(&scene, &shadow, strip);
            others += k && before != scene.sheet.sure;
            if (k % 2)
                shadow.triangle = (uint32_t)(random_bits(&seed) % subject.info.triangles);
        }
    }
    CHECK(others > 50, "%zu", others);
    guarded_strip_close(&guarded);
    scene_close(&scene);
    subject_close(&subject);
}

/* A mesh that is opened where another one was is not taken for that: one triangle under the tool, and one aside. */
static void in_anothers_place(void)
{
    static const double vertices[2][9] = { { 0, 0, 0, 1, 0, 0, 0, 1, 0 }, { 5, 0, 0, 6, 0, 0, 5, 1, 0 } };
    static const uint32_t corners[3] = { 0, 1, 2 };
    static uint64_t place[1024];
    const dpt_shadow shadow = { .size = sizeof shadow,
                                .segment = { { 0.1, 0.2, 0.1 }, { 0.4, 0.3, 0.1 }, 0.01 },
                                .direction = { 0, 0, -1 },
                                .depth = 0.5 };
    struct subject subjects[2];
    struct guarded_strip guarded;
    dpt_strip *strip = guarded_strip_open(&guarded, 4, 0);
    for (int s = 0; s < 2; s++)
        if (!subject_from_arrays(&subjects[s], "triangle", vertices[s], 3, corners, 1))
            return;
    for (int i = 0; i < 4; i++) {
        const dpt_compiled *compiled = &subjects[i % 2].compiled;
        const dpt_mesh *mesh = NULL;
        uint32_t count = 0;
        CHECK(compiled->size <= sizeof place, "%zu bytes", compiled->size);
        memcpy(place, compiled->bytes, compiled->size);
        CHECK(dpt_mesh_open(place, compiled->size, &mesh) == DPT_OK &&
                  dpt_strip_shadow(strip, mesh, NULL, &shadow) == DPT_OK,
              "%d", i);
        dpt_strip_get_triangles(strip, &count, NULL);
        CHECK(count == !(i % 2), "%u triangles of mesh %d", count, i % 2);
    }
    guarded_strip_close(&guarded);
    for (int s = 0; s < 2; s++)
        subject_close(&subjects[s]);
}

int main(int argc, char **argv)
{
    setvbuf(stdout, NULL, _IOLBF, 0);
    data = getenv("DPT_DATA");
    if (argc > 1)
        factor = strtoull(argv[1], NULL, 10);
    if (factor < 1 || factor > 10000) {
        printf("test_strip_memory: from 1 to 10000 times as many ticks\n");
        return 2;
    }
    TEST(remembered_in_motion);
    TEST(meshes_in_turn);
    TEST(the_same_shadow_again);
    TEST(in_anothers_place);
    return check_report();
}
