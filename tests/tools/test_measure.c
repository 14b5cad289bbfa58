/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Runs of a setting over a scene, and their judge: counts against a loop of the test's own, errors that were put in on
 * purpose, a soft scene against brute force, and a tool that is led as a whole.
 */
#define _GNU_SOURCE
#include <math.h>
#include <pthread.h>
#include <sched.h>

#include "dynpoint/compile.h"
#include "lib/rig.h"
#include "measure/judgement.h"
#include "measure/measure_setting.h"
#include "scene/shape.h"

enum { TICKS = 3000, SOFT_TICKS = 600 };
#define RADIUS 0.002

struct subject {
    struct scene scene;
    struct csv_table trace;
    dpt_compiled compiled;
    struct measure_setting setting; /* the scene's default */
};

static int open_scene(struct subject *subject, const char *path, uint32_t law, size_t ticks)
{
    struct scene_def def = { .command = "test",
                             .path = path,
                             .scene_bytes = { subject->compiled.bytes, subject->compiled.size },
                             .zoom = 1.0,
                             .force_scale = 1.0,
                             .clutch = -1,
                             .length = 0.1,
                             .radius = RADIUS,
                             .force = { .law = law, .friction = 0.0 } };
    const struct measure_hand hand = { .seed = 1, .ticks = ticks, .length = 0.1 };
    dpt_host_error error = { .size = sizeof error };
    const int is_open = scene_open(&subject->scene, &def, &error) == DPT_OK &&
                        !measure_trace_make(&subject->trace, &subject->scene, &hand);
    CHECK(is_open, "%s does not open: %s", path, error.text);
    measure_setting_init(&subject->setting, &subject->scene);
    return is_open;
}

/* A star, whose spikes the paper's descent does not get out of. */
static int open_subject(struct subject *subject, uint32_t law)
{
    struct shape shape;
    shape_reason reason;
    dpt_compile_def def;
    dpt_diag diag = { .size = sizeof diag };
    memset(subject, 0, sizeof *subject);
    dpt_compile_def_init(&def);
    if (shape_make("star", 2000, 0, &shape, reason))
        return 0;
    const dpt_result result = dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners,
                                                 shape.triangle_count, &def, &subject->compiled, &diag);
    shape_free(&shape);
    CHECK(result == DPT_OK, "%s", diag.text);
    return result == DPT_OK && open_scene(subject, "star", law, TICKS);
}

static void close_subject(struct subject *subject)
{
    csv_table_free(&subject->trace);
    scene_close(&subject->scene);
    dpt_compiled_free(&subject->compiled);
}

static void measure(struct measure_run *run, const struct subject *subject, const struct measure_setting *setting,
                    size_t every)
{
    const struct measure_effort effort = { .passes = 1, .every = every };
    CHECK(measure_run(run, &subject->scene, &subject->trace, setting, &effort) == 0, "it does not run");
}

static struct judgement judge(const struct measure_run *run, const struct measure_run *reference)
{
    struct judgement judged;
    CHECK(!measure_judge(&judged, run, reference), "it is not judged");
    return judged;
}

/* The distance in every tick, by a world of the test's own. */
static void find_distances(const struct subject *subject, uint32_t method, double *distance)
{
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    struct rig rig;
    def.method = method;
    def.until = DPT_UNTIL_CONTACT;
    def.max_contacts = 0;
    rig_open(&rig, &def, subject->scene.bodies.body[0].mesh, &rig_point, 1);
    for (size_t i = 0; i < subject->trace.rows; i++) {
        const double *row = csv_table_row(&subject->trace, i);
        if (i == 0)
            dpt_tool_teleport(rig.world, rig.tool, &rig.device);
        distance[i] = rig_step_ends(&rig, row + 1, RADIUS).distance;
    }
    rig_close(&rig);
}

static void paper_is_wrong_as_counted(void)
{
    struct subject subject;
    struct measure_setting setting;
    struct measure_run exact, paper;
    struct judgement judged, own;
    static double truth[TICKS], found[TICKS];
    if (!open_subject(&subject, DPT_LAW_POINT))
        return;
    setting = subject.setting;
    const struct measure_setting richest = measure_setting_richest(&setting, &subject.scene);
    setting.world.method = DPT_METHOD_PAPER;
    measure(&exact, &subject, &richest, 7);
    measure(&paper, &subject, &setting, 0);
    judged = judge(&paper, &exact);
    own = judge(&exact, &exact);
    find_distances(&subject, DPT_METHOD_BRUTE, truth);
    find_distances(&subject, DPT_METHOD_PAPER, found);
    size_t wrong = 0, missed = 0;
    double error = 0.0;
    for (size_t i = 0; i < TICKS; i++) {
        const double by = fabs(found[i] - truth[i]);
        wrong += by > 1e-9 * exact.diagonal;
        missed += by > 1e-9 * exact.diagonal && truth[i] == 0.0;
        error = fmax(error, by);
        CHECK(fabs(exact.tick[i].distance - truth[i]) <= 1e-9 * exact.diagonal, "tick %zu", i);
    }
    CHECK(wrong > 100 && missed > 10, "the star is too easy: %zu, %zu", wrong, missed);
    CHECK(judged.wrong == wrong, "%zu of %zu", judged.wrong, wrong);
    CHECK(judged.missed_crossings == missed, "%zu of %zu", judged.missed_crossings, missed);
    CHECK(fabs(judged.distance_error - error) <= 1e-12, "%g, not %g", judged.distance_error, error);
    CHECK(judged.local == TICKS && own.exact == TICKS, "%zu, %zu", judged.local, own.exact);
    CHECK(judged.missed > 0 && judged.wrench.max > 0.1, "%zu, %g N", judged.missed, judged.wrench.max);
    CHECK(own.wrong + own.missed + own.invented + own.unknown == 0 && own.wrench.max == 0.0, "a run is not as itself");
    CHECK(own.wrench_ticks > 100 && own.wrench_peak > 0.1 && own.jump > 0.0, "no force");
    CHECK(exact.check.ticks == (TICKS + 6) / 7 && exact.check.wrong == 0, "%zu, %zu", exact.check.ticks,
          exact.check.wrong);
    measure_run_free(&exact);
    measure_run_free(&paper);
    close_subject(&subject);
}

/* An exact run with errors put in by hand is judged with just those. */
static void errors_are_found(void)
{
    struct subject subject;
    struct measure_setting setting;
    struct measure_run run, truth;
    struct judgement judged;
    if (!open_subject(&subject, DPT_LAW_PROXY))
        return;
    setting = subject.setting;
    measure(&truth, &subject, &setting, 0);
    measure(&run, &subject, &setting, 0);
    size_t calm = 0, crossing = 0, free_at = 0, held = 0, held_before = 0;
    for (size_t i = 10; i + 10 < TICKS; i++) {
        const struct measure_tick *tick = &truth.tick[i];
        truth.tick[i].force_flags = run.tick[i].force_flags = 0;
        if (tick->distance == 0.0)
            crossing = i;
        if (tick->contact == DPT_CONTACT_SEPARATED)
            free_at = i;
        if (tick->contact == DPT_CONTACT_PENETRATING && measure_wrench_size(tick->wrench) > 0.0) {
            calm = held_before;
            held_before = held;
            held = i;
        }
    }
    CHECK(crossing && free_at && held && calm > 20 && calm + 1 < TICKS, "the trace is too tame");
    judged = judge(&run, &truth);
    CHECK(judged.wrong == 0 && judged.wrench.max == 0.0, "two runs differ");
    const size_t force_ticks = judged.wrench_ticks;
    run.tick[5].distance += 3e-4;
    run.tick[6].distance -= 1e-4;
    run.tick[6].status = DPT_STATUS_BOUNDED;
    run.tick[crossing].distance += 2e-4;
    run.tick[free_at].contact = DPT_CONTACT_PENETRATING;
    run.tick[held].contact = run.tick[held_before].contact = DPT_CONTACT_SEPARATED;
    run.tick[8].contact = DPT_CONTACT_UNKNOWN;
    run.tick[calm].wrench[1] += 0.3;
    run.tick[calm].wrench[4] -= 0.4;
    judged = judge(&run, &truth);
    CHECK(judged.wrong == 3 && judged.missed_crossings == 1, "%zu, %zu", judged.wrong, judged.missed_crossings);
    CHECK(judged.wrong_exact == 2, "%zu said to be exact", judged.wrong_exact);
    CHECK(fabs(judged.distance_error - 3e-4) < 1e-12 && judged.distance_tick == 5, "%g at %zu", judged.distance_error,
          judged.distance_tick);
    CHECK(judged.missed == 2 && judged.invented == 1 && judged.unknown == 1, "%zu, %zu, %zu", judged.missed,
          judged.invented, judged.unknown);
    CHECK(fabs(judged.wrench.max - 0.5) < 1e-12 && judged.wrench_tick == calm, "%g N", judged.wrench.max);
    CHECK(judged.wrench.median == 0.0 && judged.wrench_ticks == force_ticks, "%zu ticks", judged.wrench_ticks);
    /* The same near a fold, of which the reference alone tells. */
    truth.tick[calm + JUDGEMENT_FOLD_TICKS].force_flags = DPT_FORCE_FLAG_FOLD;
    judged = judge(&run, &truth);
    CHECK(judged.wrench.max == 0.0 && fabs(judged.near_fold_error - 0.5) < 1e-12, "%g and %g N", judged.wrench.max,
          judged.near_fold_error);
    CHECK(judged.near_fold_ticks > 0 && judged.near_fold_ticks <= 2 * JUDGEMENT_FOLD_TICKS + 1 &&
              judged.wrench_ticks + judged.near_fold_ticks == force_ticks,
          "%zu and %zu of %zu", judged.wrench_ticks, judged.near_fold_ticks, force_ticks);
    truth.tick[calm + JUDGEMENT_FOLD_TICKS].force_flags = 0;
    for (int side = -1; side <= 1; side += 2)
        for (int by = JUDGEMENT_FOLD_TICKS; by <= JUDGEMENT_FOLD_TICKS + 1; by++) {
            struct measure_tick *fold = &run.tick[(int)calm + side * by];
            fold->force_flags = DPT_FORCE_FLAG_FOLD;
            judged = judge(&run, &truth);
            CHECK((judged.wrench.max > 0.49) == (by > JUDGEMENT_FOLD_TICKS), "%d ticks from a fold: %g N", side * by,
                  judged.wrench.max);
            CHECK(judged.folds == 1, "%zu folds", judged.folds);
            fold->force_flags = 0;
        }
    /* Jumps are a run's own; where the trace jumps there is none. */
    for (size_t i = 0; i < TICKS; i++)
        memset(run.tick[i].wrench, 0, sizeof run.tick[i].wrench);
    run.tick[50].wrench[2] = 2.0;
    run.tick[60].wrench[2] = 3.0;
    run.tick[60].is_jump = run.tick[61].is_jump = 1;
    judged = judge(&run, &run);
    CHECK(judged.jump == 2.0, "%g N", judged.jump);
    run.tick[50].status = DPT_STATUS_STALE;
    run.tick[50].distance = 1.0;
    run.tick[50].contact = DPT_CONTACT_UNKNOWN;
    judged = judge(&run, &truth);
    CHECK(judged.stale == 1 && judged.unknown == 1 && judged.distance_error < 1e-3, "a stale tick was judged");
    measure_run_free(&run);
    measure_run_free(&truth);
    close_subject(&subject);
}

/* What is poorer is judged so: a budget leaves ticks unknown, and stopping early gives neither force nor contact. */
static void settings_are_applied(void)
{
    struct subject subject;
    struct measure_setting setting, changed;
    struct measure_run run, truth;
    struct judgement judged, of_truth;
    if (!open_subject(&subject, DPT_LAW_PROXY))
        return;
    setting = subject.setting;
    measure(&truth, &subject, &setting, 0);
    of_truth = judge(&truth, &truth);
    changed = setting;
    changed.world.budget = (uint32_t)of_truth.work.median + 1;
    measure(&run, &subject, &changed, 0);
    judged = judge(&run, &truth);
    CHECK(judged.work.max <= changed.world.budget && of_truth.work.max > changed.world.budget, "%g units of %u",
          judged.work.max, (unsigned)changed.world.budget);
    CHECK(judged.unknown > 0 && judged.bounded > 0, "%zu, %zu", judged.unknown, judged.bounded);
    measure_run_free(&run);
    changed = setting;
    changed.world.until = DPT_UNTIL_TRACK;
    measure(&run, &subject, &changed, 0);
    judged = judge(&run, &truth);
    CHECK(!judged.has_contact && !judged.has_wrench && judged.wrong == 0 && judged.unknown == 0, "track: %zu wrong",
          judged.wrong);
    measure_run_free(&run);
    changed = setting;
    changed.world.stiffness *= 2.0;
    measure(&run, &subject, &changed, 0);
    judged = judge(&run, &truth);
    CHECK(fabs(judged.wrench.max - of_truth.wrench_peak) < 0.05 * of_truth.wrench_peak,
          "twice as stiff: %g N beside %g", judged.wrench.max, of_truth.wrench_peak);
    measure_run_free(&run);
    changed = setting;
    changed.world.method = DPT_METHOD_PAPER;
    CHECK(measure_setting_fault(&changed, &subject.scene), "a proxy of the paper's");
    changed = setting;
    changed.world.method = DPT_METHOD_TREE;
    changed.world.budget = 100;
    CHECK(measure_setting_fault(&changed, &subject.scene), "a budget of the tree's");
    CHECK(!measure_setting_fault(&setting, &subject.scene), "the default");
    measure_run_free(&truth);
    close_subject(&subject);
}

static int same_answers(const struct measure_run *a, const struct measure_run *b)
{
    int same = a->ticks == b->ticks;
    for (size_t i = 0; same && i < a->ticks; i++) {
        const struct measure_tick *x = &a->tick[i], *y = &b->tick[i];
        same =
            x->distance == y->distance && x->contact == y->contact && !memcmp(x->wrench, y->wrench, sizeof x->wrench);
    }
    return same;
}

/* Springs are at rest again in every run, and what is searched is where the vertices are. */
static void soft_bodies_are_true(void)
{
    struct subject subject;
    struct measure_setting setting;
    struct measure_run soft, again, rigid, failed;
    struct judgement judged;
    const struct measure_effort twice = { .passes = 2 };
    memset(&subject, 0, sizeof subject);
    if (!open_scene(&subject, "membrane", DPT_LAW_PROXY, SOFT_TICKS))
        return;
    setting = subject.setting;
    measure(&soft, &subject, &setting, 3);
    CHECK(soft.failure == DPT_OK, "tick %zu", soft.failed_tick);
    CHECK(soft.check.ticks == SOFT_TICKS / 3 && soft.check.wrong == 0, "%zu of %zu wrong, by %g m", soft.check.wrong,
          soft.check.ticks, soft.check.error);
    CHECK(measure_run(&again, &subject.scene, &subject.trace, &setting, &twice) == 0, "it does not run");
    CHECK(same_answers(&soft, &again), "another run gives other answers");
    setting.rigid = 1;
    measure(&rigid, &subject, &setting, 3);
    CHECK(rigid.body_bytes == 0 && soft.body_bytes > 0 && rigid.check.wrong == 0, "%zu, %zu bytes", rigid.body_bytes,
          soft.body_bytes);
    judged = judge(&rigid, &soft);
    CHECK(judged.distance_error > 1e-4 && judged.soft_ns.max == 0.0, "it gave way by %g m", judged.distance_error);
    judged = judge(&soft, &soft);
    CHECK(judged.soft_ns.median > 0.0, "no time for it");
    setting.rigid = 0;
    setting.integrator = DPT_INTEGRATOR_EULER;
    setting.dt = 0.5;
    measure(&failed, &subject, &setting, 0);
    CHECK(failed.failure == DPT_E_UNSTABLE && failed.tick[failed.failed_tick].status == 0, "%s",
          dpt_result_name(failed.failure));
    measure_run_free(&failed);
    measure_run_free(&rigid);
    measure_run_free(&again);
    measure_run_free(&soft);
    close_subject(&subject);
}

/* A stylus that is led as a whole is felt as one that is the trace's own segment. */
static void whole_tools_are_led(void)
{
    struct subject subject;
    struct measure_run segment, whole;
    struct judgement judged;
    if (!open_subject(&subject, DPT_LAW_BED))
        return;
    measure(&segment, &subject, &subject.setting, 0);
    subject.scene.has_stylus = 0;
    subject.scene.segments[0] = (dpt_segment){ { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.1 }, RADIUS };
    measure(&whole, &subject, &subject.setting, 11);
    judged = judge(&whole, &segment);
    CHECK(judged.wrong == 0 && whole.check.wrong == 0, "%zu, by %g m", judged.wrong, judged.distance_error);
    /* Integrals along the axis are good to half a per cent, and sampled by what was found before. */
    CHECK(judged.wrench_peak > 0.1 && judged.wrench.max < 0.005 * judged.wrench_peak &&
              judged.wrench.median < 1e-6 * judged.wrench_peak,
          "%g and %g N beside %g", judged.wrench.median, judged.wrench.max, judged.wrench_peak);
    /* In two halves it is the same tool: centre and rho are those of the whole. */
    measure_run_free(&whole);
    subject.scene.segments[0].b[2] = 0.05;
    subject.scene.segments[1] = (dpt_segment){ { 0.0, 0.0, 0.05 }, { 0.0, 0.0, 0.1 }, RADIUS };
    subject.scene.segment_count = 2;
    measure(&whole, &subject, &subject.setting, 11);
    judged = judge(&whole, &segment);
    CHECK(judged.wrong == 0 && whole.check.wrong == 0, "halves: %zu, by %g m", judged.wrong, judged.distance_error);
    CHECK(judged.wrench.median < 0.02 * judged.wrench_peak, "halves: %g N beside %g", judged.wrench.median,
          judged.wrench_peak);
    measure_run_free(&segment);
    measure_run_free(&whole);
    close_subject(&subject);
}

/* Behind a jump of the trace all is as in a trace that begins there. */
static void a_jump_begins_anew(void)
{
    struct subject subject;
    struct measure_run whole, rest;
    const size_t from = TICKS / 2;
    if (!open_subject(&subject, DPT_LAW_PROXY))
        return;
    for (size_t i = from; i < TICKS; i++)
        subject.trace.values[i * subject.trace.columns] += 7.0;
    measure(&whole, &subject, &subject.setting, 0);
    subject.trace.rows -= from;
    memmove(subject.trace.values, subject.trace.values + from * subject.trace.columns,
            subject.trace.rows * subject.trace.columns * sizeof *subject.trace.values);
    measure(&rest, &subject, &subject.setting, 0);
    const struct measure_run behind = { .tick = whole.tick + from, .ticks = TICKS - from };
    CHECK(whole.tick[from].is_jump && !whole.tick[from + 1].is_jump, "no jump");
    CHECK(same_answers(&behind, &rest), "it remembers what was before the jump");
    measure_run_free(&whole);
    measure_run_free(&rest);
    close_subject(&subject);
}

/* 2 N across end b of 0.12 m: half of the arm, over rho, which is 1 / sqrt(12) of the length. */
static void wrenches_are_weighed(void)
{
    double row[7] = { 0.0, 1.0, 2.0, 3.0, 1.12, 2.0, 3.0 }, weighed[6];
    const struct csv_table trace = { .values = row, .rows = 1, .columns = 7 };
    const dpt_wrench wrench = { { 0.0, 2.0, 0.0 }, { 0.0, 0.0, 0.24 } };
    struct scene scene = { .has_stylus = 1, .segment_count = 1 };
    struct measure_tool tool;
    measure_tool_begin(&tool, &scene);
    measure_tool_lead(&tool, &trace, 0);
    measure_tool_weigh(&tool, &wrench, weighed);
    CHECK(weighed[1] == 2.0 && fabs(weighed[5] - sqrt(12.0)) < 1e-12, "%g N, %g N", weighed[1], weighed[5]);
    CHECK(fabs(measure_wrench_size(weighed) - 4.0) < 1e-12, "%g N", measure_wrench_size(weighed));
    /* An L of two lines of 0.3 and 0.1 m: the centre is where their lengths balance. */
    scene.has_stylus = 0;
    scene.segment_count = 2;
    scene.segments[0] = (dpt_segment){ { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.3 }, 0.0 };
    scene.segments[1] = (dpt_segment){ { 0.0, 0.0, 0.3 }, { 0.1, 0.0, 0.3 }, 0.0 };
    measure_tool_begin(&tool, &scene);
    measure_tool_lead(&tool, &trace, 0);
    /* z lies along the world's x; x across it. */
    CHECK(fabs(tool.centre[0] - 1.1875) < 1e-12, "centre %g", tool.centre[0]);
    CHECK(fabs(hypot(tool.centre[1] - 2.0, tool.centre[2] - 3.0) - 0.0125) < 1e-12, "centre");
    double square = 0.0;
    for (int i = 0; i < 4000; i++) {
        const double at = 0.4 * (i + 0.5) / 4000;
        const double x = at > 0.3 ? at - 0.3 : 0.0, z = at > 0.3 ? 0.3 : at;
        square += ((x - 0.0125) * (x - 0.0125) + (z - 0.1875) * (z - 0.1875)) / 4000;
    }
    CHECK(fabs(tool.rho - sqrt(square)) < 1e-6, "rho %g, not %g", tool.rho, sqrt(square));
}

static volatile int spins;

static void *spin(void *unused)
{
    while (spins)
        continue;
    return unused;
}

/* On one processor with three threads that only compute: what those take is in the clock's times and not in the others. */
static void other_programs_do_not_count(void)
{
    enum { SPINNING = 3 };
    struct subject subject;
    struct measure_run by_clock, by_processor;
    const struct measure_effort processor = { .passes = 1, .by_processor = 1 };
    pthread_t thread[SPINNING];
    cpu_set_t before, one;
    double sum[2] = { 0.0, 0.0 };
    if (sched_getaffinity(0, sizeof before, &before) || !open_subject(&subject, DPT_LAW_PROXY))
        return;
    CPU_ZERO(&one);
    CPU_SET((size_t)sched_getcpu(), &one);
    CHECK(sched_setaffinity(0, sizeof one, &one) == 0, "no processor of its own");
    spins = 1;
    for (int i = 0; i < SPINNING; i++)
        CHECK(pthread_create(&thread[i], NULL, spin, NULL) == 0, "no thread");
    measure(&by_clock, &subject, &subject.setting, 0);
    CHECK(measure_run(&by_processor, &subject.scene, &subject.trace, &subject.setting, &processor) == 0, "no run");
    spins = 0;
    for (int i = 0; i < SPINNING; i++)
        pthread_join(thread[i], NULL);
    sched_setaffinity(0, sizeof before, &before);
    for (size_t i = 0; i < TICKS; i++) {
        sum[0] += by_clock.tick[i].ns;
        sum[1] += by_processor.tick[i].ns;
    }
    CHECK(same_answers(&by_clock, &by_processor), "other answers");
    CHECK(by_clock.busy > 1.5 && by_processor.busy > 1.5, "busy %g and %g", by_clock.busy, by_processor.busy);
    CHECK(sum[0] > 1.5 * sum[1] && sum[1] > 0.0, "%g ns by the clock, %g of the processor", sum[0], sum[1]);
    measure_run_free(&by_clock);
    measure_run_free(&by_processor);
    close_subject(&subject);
}

int main(void)
{
    TEST(paper_is_wrong_as_counted);
    TEST(errors_are_found);
    TEST(settings_are_applied);
    TEST(soft_bodies_are_true);
    TEST(whole_tools_are_led);
    TEST(a_jump_begins_anew);
    TEST(wrenches_are_weighed);
    TEST(other_programs_do_not_count);
    return check_report();
}
