/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a haptic loop hands to its viewers: the ticks in their order, each once; the newest snapshot, whole, at most 60 a
 * second by the loop's clock; vertices while they move. A reader that stops holds nothing up, and what it missed is
 * counted. Frames are read here by docs/view.md alone.
 */
#include <math.h>
#include <pthread.h>

#include "lib/fixture.h"
#include "lib/rig.h"
#include "view/server/view_server.h"
#include "view/view_stream.h"

enum { HEADER = 80, TICK = 40 };

/* Physics takes a step every so many ticks. */
enum { TICKS_A_STEP = 4, TICKS_UNREAD = 200000 };

struct stage {
    struct fixture fixture;
    struct rig rig;
    uint32_t vertices;
    struct view_feed *feed;
    uint64_t tick;
};

static void stage_open(struct stage *stage)
{
    const dpt_segment segment = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.05 }, 0.002 };
    dpt_deformable_def deform;
    const float *positions;
    memset(stage, 0, sizeof *stage);
    fixture_from_shape(&stage->fixture, "torus", 800);
    rig_open(&stage->rig, NULL, NULL, &segment, 1);
    dpt_deformable_def_init(&deform);
    deform.mesh = stage->fixture.mesh;
    rig_add_deformable(&stage->rig, &deform);
    dpt_body_get_vertices(stage->rig.world, stage->rig.body, &positions, &stage->vertices);
    stage->feed = view_feed_open(stage->rig.world, stage->vertices);
    CHECK(stage->feed != NULL && stage->vertices > 100, "no feed");
}

static void stage_close(struct stage *stage)
{
    view_feed_close(stage->feed);
    rig_close(&stage->rig);
    fixture_free(&stage->fixture);
}

/* The numbers of a tick follow from its index. */
static struct view_tick tick_of(uint64_t i)
{
    return (struct view_tick){ .time = 1e-3 * (double)i,
                               .force = (float)(i % 1000),
                               .depth = (float)(i % 77),
                               .energy = (float)(i % 13),
                               .late = (float)(i % 100) * 1e-6f,
                               .took = (float)(i % 50) * 1e-6f,
                               .contact = (uint32_t)(i % 4),
                               .reason = (uint32_t)(i % 6) };
}

/* A tick of a millisecond. */
static void tick(struct stage *stage, int has_moved)
{
    const uint64_t i = stage->tick++;
    const struct view_tick numbers = tick_of(i);
    const struct view_physics physics = { .has_moved = has_moved, .steps = i / TICKS_A_STEP };
    dpt_pose pose = DPT_POSE_IDENTITY;
    pose.position[0] = 1e-5 * (double)(i % 10000);
    pose.position[1] = 1.0; /* far away, and so cheap */
    rig_step_to(&stage->rig, &pose);
    view_feed_tick(stage->feed, &numbers, &physics, 1000000 * i + 1);
}

/* ---- a reader ---- */

static uint32_t word(const unsigned char *from)
{
    return (uint32_t)from[0] | (uint32_t)from[1] << 8 | (uint32_t)from[2] << 16 | (uint32_t)from[3] << 24;
}

static uint64_t wide(const unsigned char *from)
{
    return word(from) | (uint64_t)word(from + 4) << 32;
}

static double number(const unsigned char *from)
{
    const uint64_t bits = wide(from);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static float small(const unsigned char *from)
{
    const uint32_t bits = word(from);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* What a reader has seen. */
struct seen {
    uint64_t frames, ticks, next_tick, with_vertices, number, dropped, lost;
    double late, took, haptic, view, physics;
    double steps;
};

static void read_tick(struct seen *seen, const unsigned char *from, int may_skip)
{
    const uint64_t i = (uint64_t)(number(from) * 1e3 + 0.5);
    const struct view_tick expected = tick_of(i);
    CHECK(i == seen->next_tick || (may_skip && i > seen->next_tick), "tick %llu after %llu", (unsigned long long)i,
          (unsigned long long)seen->next_tick - 1);
    CHECK(small(from + 8) == expected.force && small(from + 12) == expected.depth &&
              small(from + 16) == expected.energy && small(from + 20) == expected.late &&
              small(from + 24) == expected.took && word(from + 28) == expected.contact &&
              word(from + 32) == expected.reason && word(from + 36) == 0,
          "tick %llu", (unsigned long long)i);
    seen->next_tick = i + 1;
    seen->ticks++;
}

static void read_frame(struct seen *seen, const struct view_message *frame, int may_skip)
{
    const unsigned char *bytes = frame->bytes;
    const uint32_t snapshot = word(bytes + 4), ticks = word(bytes + 8);
    dpt_snapshot_info info = { .size = sizeof info };
    CHECK(word(bytes) == 2 && word(bytes + 12) == 0 && frame->size == HEADER + snapshot + TICK * (size_t)ticks,
          "%zu bytes", frame->size);
    CHECK(dpt_snapshot_get_info(bytes + HEADER, snapshot, &info) == DPT_OK, "a broken snapshot");
    CHECK(info.tools == 1 && info.bodies == 1, "%u tools", (unsigned)info.tools);
    CHECK(!seen->frames || wide(bytes + 16) > seen->number, "frame %llu twice", (unsigned long long)seen->number);
    seen->number = wide(bytes + 16);
    seen->dropped = wide(bytes + 24);
    seen->lost = wide(bytes + 32);
    seen->haptic = number(bytes + 40);
    seen->physics = number(bytes + 48);
    seen->view = number(bytes + 56);
    seen->late = number(bytes + 64);
    seen->took = number(bytes + 72);
    seen->steps = (double)info.steps;
    seen->with_vertices += info.vertices > 0;
    seen->frames++;
    for (uint32_t i = 0; i < ticks; i++)
        read_tick(seen, bytes + HEADER + snapshot + TICK * (size_t)i, may_skip);
    CHECK(may_skip || !ticks || seen->steps == (double)seen->next_tick, "a snapshot of step %.0f with ticks up to %llu",
          seen->steps, (unsigned long long)seen->next_tick);
}

/* ---- the tests ---- */

static void each_tick_comes_once_and_in_order(void)
{
    struct stage stage;
    struct seen seen = { .frames = 0 };
    struct view_message frame;
    stage_open(&stage);
    for (int i = 0; i < 5000; i++) {
        tick(&stage, 0);
        if (view_feed_next(stage.feed, &frame))
            read_frame(&seen, &frame, 0);
    }
    CHECK(seen.frames >= 290 && seen.frames <= 300, "%llu frames in 5 s", (unsigned long long)seen.frames);
    CHECK(seen.dropped == 0 && seen.lost == 0 && seen.ticks + 17 >= 5000, "%llu ticks", (unsigned long long)seen.ticks);
    CHECK(fabs(seen.haptic - 1000.0) < 1.0 && fabs(seen.view - 59.0) < 2.0, "%g and %g Hz", seen.haptic, seen.view);
    CHECK(fabs(seen.physics - 1000.0 / TICKS_A_STEP) < 5.0, "physics: %g Hz", seen.physics);
    CHECK(fabs(seen.late - 98e-6) < 2e-6 && fabs(seen.took - 49e-6) < 1e-6, "%g s late, %g s took", seen.late,
          seen.took);
    stage_close(&stage);
}

/* Three frames at rest have vertices in 5 s: for those who come later; all while they move and half a second more. */
static void vertices_go_while_they_move(void)
{
    struct stage stage;
    struct seen rest = { .frames = 0 }, moving = rest, after = rest;
    struct view_message frame;
    stage_open(&stage);
    for (int i = 0; i < 15000; i++) {
        struct seen *now = i < 5000 ? &rest : i < 10000 ? &moving : &after;
        tick(&stage, i >= 5000 && i < 10000);
        if (view_feed_next(stage.feed, &frame))
            read_frame(now, &frame, 1);
    }
    CHECK(rest.with_vertices >= 2 && rest.with_vertices <= 4, "%llu at rest", (unsigned long long)rest.with_vertices);
    CHECK(moving.with_vertices + 1 >= moving.frames, "%llu of %llu while they move",
          (unsigned long long)moving.with_vertices, (unsigned long long)moving.frames);
    CHECK(after.with_vertices >= 29 && after.with_vertices <= 36, "%llu afterwards",
          (unsigned long long)after.with_vertices);
    stage_close(&stage);
}

static void a_reader_that_stops_holds_nothing_up(void)
{
    struct stage stage;
    struct seen seen = { .frames = 0 };
    struct view_message frame;
    uint64_t made, taken;
    stage_open(&stage);
    for (int i = 0; i < TICKS_UNREAD; i++)
        tick(&stage, 0);
    view_feed_counts(stage.feed, &made, &taken);
    CHECK(made >= 11760 && made <= 12000 && taken == 0, "%llu made, %llu taken", (unsigned long long)made,
          (unsigned long long)taken);
    CHECK(view_feed_next(stage.feed, &frame) == 1, "nothing there");
    read_frame(&seen, &frame, 1);
    CHECK(seen.number == made - 1 && seen.dropped == made - 1 && seen.steps > TICKS_UNREAD - 20.0,
          "number %llu, step %.0f", (unsigned long long)seen.number, seen.steps);
    CHECK(seen.ticks == VIEW_FEED_TICKS && seen.lost == TICKS_UNREAD - VIEW_FEED_TICKS, "%llu ticks, %llu lost",
          (unsigned long long)seen.ticks, (unsigned long long)seen.lost);
    CHECK(view_feed_next(stage.feed, &frame) == 0, "the same twice");
    for (int i = 0; i < 100; i++)
        tick(&stage, 0);
    CHECK(view_feed_next(stage.feed, &frame) == 1, "it does not go on");
    read_frame(&seen, &frame, 1);
    CHECK(seen.next_tick > TICKS_UNREAD + 80 && seen.next_tick <= TICKS_UNREAD + 100, "up to tick %llu",
          (unsigned long long)seen.next_tick);
    stage_close(&stage);
}

/* Two threads: the reader takes as fast as it can. */
static void *loop(void *of)
{
    struct stage *stage = of;
    for (int i = 0; i < 200000; i++)
        tick(stage, i % 1000 < 500);
    return NULL;
}

static void two_threads_see_whole_frames(void)
{
    struct stage stage;
    struct seen seen = { .frames = 0 };
    struct view_message frame;
    pthread_t thread;
    stage_open(&stage);
    CHECK(pthread_create(&thread, NULL, loop, &stage) == 0, "no thread");
    uint64_t made = 0, taken = 0, before;
    do {
        before = made;
        while (view_feed_next(stage.feed, &frame))
            read_frame(&seen, &frame, 1);
        view_feed_counts(stage.feed, &made, &taken);
    } while (made < 11700 || before != made);
    pthread_join(thread, NULL);
    while (view_feed_next(stage.feed, &frame))
        read_frame(&seen, &frame, 1);
    CHECK(seen.ticks + seen.lost + 17 >= 200000 && seen.ticks > 1000, "%llu ticks, %llu lost",
          (unsigned long long)seen.ticks, (unsigned long long)seen.lost);
    CHECK(seen.frames > 100 && seen.frames + seen.dropped == seen.number + 1, "%llu frames, %llu dropped",
          (unsigned long long)seen.frames, (unsigned long long)seen.dropped);
    stage_close(&stage);
}

int main(void)
{
    TEST(each_tick_comes_once_and_in_order);
    TEST(vertices_go_while_they_move);
    TEST(a_reader_that_stops_holds_nothing_up);
    TEST(two_threads_see_whole_frames);
    return check_report();
}
