/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A search for walls along a line that goes on from tick to tick while the surface and the line move: what it finds at
 * its end is bit for bit what one finds that has all the work it likes.
 *
 *     test_needle_near [RUNS = 12 [SEED = 1]]
 */
#include "insertion/world_channels.h"
#include "world/deform_scene.h"

enum { TICKS = 1500 };

static unsigned long runs = 12;
static uint64_t first_seed = 1;

/* Searches that ended, those of them that took more than a tick, and walls that they found. */
static struct {
    unsigned long ended, long_ones, walls, begun_anew;
} seen;

struct searched {
    struct deform_scene scene;
    uint64_t seed;
    struct channel line;
};

static int open_searched(struct searched *searched, uint64_t seed)
{
    static const char *const shapes[] = { "sphere", "torus", "liver" };
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    *searched = (struct searched){ .seed = seed };
    if (!deform_scene_open(&searched->scene, shapes[seed % 3], 3000, &def, NULL))
        return 0;
    searched->scene.kind = (enum deform_kind)(seed % DEFORM_KINDS);
    searched->scene.step = seed % 5 ? 1e-7 * pow(10.0, random_in(&searched->seed, 0.0, 2.5)) : 2e-3;
    searched->line.body_id = searched->scene.rig.body;
    searched->line.radius = random_in(&searched->seed, 2e-4, 2e-3);
    searched->line.length = 0.1;
    searched->line.mouth = (vec3){ 0.01, 0.02, 0.15 };
    searched->line.axis = unit_of((vec3){ 0.3, 0.0, -1.0 });
    return 1;
}

static vec3 random_point(uint64_t *seed, double size)
{
    return (vec3){ random_in(seed, -size, size), random_in(seed, -size, size), random_in(seed, -size, size) };
}

/* By a little, and now and then elsewhere. */
static void move_line(struct searched *searched)
{
    struct channel *line = &searched->line;
    line->mouth = add(line->mouth, random_point(&searched->seed, 2e-5));
    line->axis = unit_of(add(line->axis, random_point(&searched->seed, 2e-5)));
    if (random_bits(&searched->seed) % 200)
        return;
    line->mouth = random_point(&searched->seed, 0.15);
    line->axis = unit_of(sub(random_point(&searched->seed, 0.06), line->mouth));
}

static void check_as_from_nothing(const struct searched *searched, const struct channel_search *found)
{
    static struct channel_search whole;
    const struct dpt_world *world = searched->scene.rig.world;
    struct channel line = searched->line, one = found->channel;
    struct work work = work_of(WORK_UNLIMITED);
    memset(&line.near, 0, sizeof line.near);
    dpti_channel_search_begin(&whole, &line, &world->bodies[0].surface, NULL, &world->kernel, &work);
    CHECK(dpti_channel_search_on(&whole) == 1, "no end");
    memset(&one.near, 0, sizeof one.near);
    CHECK(!memcmp(&one, &whole.channel, sizeof one), "%u walls, %u layers; %u and %u from nothing", one.wall_count,
          one.layer_count, whole.channel.wall_count, whole.channel.layer_count);
    seen.walls += one.wall_count;
}

static void it_finds_what_is_there_now(void)
{
    for (unsigned long run = 0; run < runs; run++) {
        struct searched searched;
        int ticks = 0;
        if (!open_searched(&searched, first_seed + run))
            return;
        static struct channel_search search;
        static struct work work;
        struct channel_near near = { .margin = 0.0 };
        struct dpt_world *world = searched.scene.rig.world;
        for (int tick = 0; tick < TICKS; tick++) {
            const vec3 from = near.from;
            work = work_of(1 + (uint32_t)(random_bits(&searched.seed) % 12));
            deform_scene_advance(&searched.scene);
            deform_scene_set(&searched.scene, (enum deform_form)(tick % DEFORM_FORMS));
            CHECK(dpt_world_step(world, 1e-3, NULL) == DPT_OK, "no step");
            move_line(&searched);
            const int is_found = dpti_channel_search_near(&search, &searched.line, &world->bodies[0].surface, NULL,
                                                          &world->kernel, &work, &near);
            seen.begun_anew += ticks > 0 && memcmp(&from, &near.from, sizeof from) != 0;
            ticks++;
            if (!is_found)
                continue;
            check_as_from_nothing(&searched, &search);
            seen.ended++;
            seen.long_ones += ticks > 1;
            ticks = 0;
            if (random_bits(&searched.seed) % 4 == 0)
                near.margin = 0.0;
        }
        deform_scene_close(&searched.scene);
    }
    printf("    %lu searches, %lu of several ticks, %lu walls, begun anew %lu times\n", seen.ended, seen.long_ones,
           seen.walls, seen.begun_anew);
    CHECK(seen.long_ones > 100 * runs && seen.walls > seen.ended / 4 && seen.begun_anew > 20 * runs,
          "too little was looked at");
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &runs, &first_seed);
    TEST(it_finds_what_is_there_now);
    return check_report();
}
