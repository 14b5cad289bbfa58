/* SPDX-License-Identifier: BSD-3-Clause */
/* The rates that a frame tells: of the loop, of physics wherever it is stepped, and of the view. */
#include "dynpoint.h"
#include "lib/check.h"
#include "view/server/view_server.h"
#include "view/view_feed.h"

/* Where a frame has them. */
enum { AT_HAPTIC = 40, AT_PHYSICS = 48, AT_VIEW = 56 };
enum { TICKS = 4000, TICKS_A_STEP = 4 };
#define TICK_NS 1000000u

struct feed_rig {
    void *block;
    dpt_world *world;
    struct view_feed *feed;
};

static int open_rig(struct feed_rig *rig)
{
    dpt_world_def def;
    dpt_world_def_init(&def);
    memset(rig, 0, sizeof *rig);
    rig->block = malloc(dpt_world_bytes(&def));
    const dpt_result result =
        dpt_world_create(rig->block, dpt_world_bytes(&def), &def, &rig->world);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    rig->feed = result == DPT_OK ? view_feed_open(rig->world, 0) : NULL;
    CHECK(rig->feed, "no feed");
    return rig->feed != NULL;
}

static void close_rig(struct feed_rig *rig)
{
    view_feed_close(rig->feed);
    free(rig->block);
}

static double number_at(const struct view_message *frame, size_t at)
{
    double number;
    memcpy(&number, (const unsigned char *)frame->bytes + at, sizeof number);
    return number;
}

/* The view takes every snapshot of a loop of 1 kHz. Returns the last frame's numbers. */
static void run(struct feed_rig *rig, int has_physics, double rates[3])
{
    const struct view_tick tick = { .time = 0.0 };
    struct view_message frame;
    for (uint64_t i = 0; i < TICKS; i++) {
        const struct view_physics physics = { .steps = has_physics ? i / TICKS_A_STEP : 0 };
        view_feed_tick(rig->feed, &tick, &physics, (i + 1) * TICK_NS);
        if (!view_feed_next(rig->feed, &frame))
            continue;
        rates[0] = number_at(&frame, AT_HAPTIC);
        rates[1] = number_at(&frame, AT_PHYSICS);
        rates[2] = number_at(&frame, AT_VIEW);
    }
}

static void rates_are_measured_apart(void)
{
    for (int has_physics = 0; has_physics < 2; has_physics++) {
        struct feed_rig rig;
        double rates[3] = { 0.0 };
        if (open_rig(&rig)) {
            run(&rig, has_physics, rates);
            CHECK(rates[0] > 999.0 && rates[0] < 1001.0, "the loop: %g Hz", rates[0]);
            CHECK(has_physics ? rates[1] > 245.0 && rates[1] < 255.0 : rates[1] == 0.0,
                  "physics: %g Hz", rates[1]);
            CHECK(rates[2] > 50.0 && rates[2] < 61.0, "the view: %g Hz", rates[2]);
        }
        close_rig(&rig);
    }
}

int main(void)
{
    TEST(rates_are_measured_apart);
    return check_report();
}
