/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The pair at the device's pose, of a tool that its proxy holds away from there, is searched for when it is read. Reading
 * changes nothing that comes later, and whatever was set since the step, the hit is that of the step. It does not judge
 * the pairs themselves.
 *
 *     test_late_hits [PER CENT of the ticks = 100]
 */
#include "lib/random.h"
#include "lib/rig.h"
#include "lib/solid.h"

enum { SEGMENTS = 2, SNAPSHOT_ROOM = 1 << 16 };

static const dpt_segment tools[2][SEGMENTS] = { { { { 0, 0, 0 }, { 0, 0, 0.05 }, 0.001 },
                                                  { { 0, 0, 0.05 }, { 0.02, 0, 0.07 }, 0 } },
                                                { { { 0, 0, 0 }, { 0, 0, 0 }, 0.001 } } };

/* How the hits of a world are read. */
enum how { BY_NOBODY, BY_GETTER, BY_REPORT, BY_SNAPSHOT, WAYS };

struct scene {
    struct rig rig;
    dpt_body mover;
    dpt_tool tool[2];
    enum how how;
};

static void open_scene(struct scene *scene, const struct solid *solid, enum how how, uint32_t budget)
{
    dpt_body_settings settings = { .size = sizeof settings };
    dpt_pose beside = DPT_POSE_IDENTITY;
    dpt_world_def def;
    dpt_world_def_init(&def);
    def.budget = budget;
    scene->how = how;
    rig_open(&scene->rig, &def, solid->mesh, tools[0], 2);
    scene->tool[0] = scene->rig.tool;
    scene->tool[1] = rig_add_tool(&scene->rig, tools[1], 1);
    beside.position[0] = 0.8 * (solid->info.box_max[0] - solid->info.box_min[0]);
    scene->mover = rig_add_body(&scene->rig, solid->mesh, &beside);
    dpt_body_get_settings(scene->rig.world, scene->mover, &settings);
    settings.static_friction = settings.kinetic_friction = 0.2;
    dpt_body_set_settings(scene->rig.world, scene->mover, &settings);
}

/* Two tools come down beside each other and wipe, while the second body moves now and then. */
static void set_scene(const struct scene *scene, const struct solid *solid, uint64_t t)
{
    const double phase = 0.01 * (double)t, down = fmin(0.03, 1e-4 * (double)t);
    for (int i = 0; i < 2; i++) {
        dpt_pose pose = DPT_POSE_IDENTITY;
        for (int k = 0; k < 2; k++)
            pose.position[k] =
                0.5 * (solid->info.box_min[k] + solid->info.box_max[k]) + 0.02 * sin((1 + i + k) * phase);
        pose.position[2] = solid->info.box_max[2] + 0.005 - down;
        pose_orient(&pose, (const double[3]){ 0.6, 0.8, 0 }, 0.2 * sin(phase));
        CHECK(dpt_tool_set_pose(scene->rig.world, scene->tool[i], &pose) == DPT_OK, "a pose");
    }
    dpt_pose moved = DPT_POSE_IDENTITY;
    moved.position[0] = 0.8 * (solid->info.box_max[0] - solid->info.box_min[0]) - 0.01 * sin(phase);
    if (t % 7 == 0)
        CHECK(dpt_body_set_pose(scene->rig.world, scene->mover, &moved) == DPT_OK, "a body's pose");
}

static void read_hits(const struct scene *scene, dpt_hit hits[5])
{
    memset(hits, 0, 5 * sizeof *hits);
    for (uint32_t i = 0; i < 5; i++) {
        hits[i].size = sizeof hits[i];
        CHECK((i < 3 ? dpt_tool_get_segment_hit(scene->rig.world, scene->tool[i / 2], i % 2, &hits[i])
                     : dpt_tool_get_hit(scene->rig.world, scene->tool[i - 3], &hits[i])) == DPT_OK,
              "hit %u", i);
    }
}

static void step_scene(struct scene *scene)
{
    static unsigned char block[SNAPSHOT_ROOM];
    dpt_step report = { .size = sizeof report };
    dpt_hit hits[5];
    size_t bytes;
    CHECK(dpt_world_step(scene->rig.world, 1e-3, scene->how == BY_REPORT ? &report : NULL) == DPT_OK, "a step");
    if (scene->how == BY_GETTER)
        read_hits(scene, hits);
    if (scene->how == BY_SNAPSHOT)
        CHECK(dpt_world_take_snapshot(scene->rig.world, NULL, block, sizeof block, &bytes) == DPT_OK, "a snapshot");
}

/* What is felt, bit for bit. Returns whether something acts. */
static int feel(const struct scene *scene, dpt_force_info force[2], dpt_pose proxy[2])
{
    for (int i = 0; i < 2; i++) {
        memset(&force[i], 0, sizeof force[i]);
        force[i].size = sizeof force[i];
        dpt_tool_get_force_info(scene->rig.world, scene->tool[i], &force[i]);
        dpt_tool_get_proxy(scene->rig.world, scene->tool[i], &proxy[i]);
    }
    return force[0].reason == DPT_FORCE_ACTS || force[1].reason == DPT_FORCE_ACTS;
}

static void reading_changes_nothing(void)
{
    struct solid liver;
    if (!solid_from_shape(&liver, "liver", 2000))
        return;
    for (uint32_t budget = 0; budget <= 100000; budget += 100000) {
        struct scene scenes[WAYS];
        uint64_t held = 0;
        for (int way = 0; way < WAYS; way++)
            open_scene(&scenes[way], &liver, (enum how)way, budget);
        for (uint64_t t = 0; t < part_of(1500); t++) {
            dpt_force_info force[WAYS][2];
            dpt_pose proxy[WAYS][2];
            dpt_hit hits[WAYS][5];
            for (int way = 0; way < WAYS; way++) {
                set_scene(&scenes[way], &liver, t);
                step_scene(&scenes[way]);
                held += feel(&scenes[way], force[way], proxy[way]) && !way;
                if (t % 20 == 19)
                    read_hits(&scenes[way], hits[way]);
            }
            for (int way = 1; way < WAYS; way++) {
                CHECK(!memcmp(force[0], force[way], sizeof force[0]), "tick %u: another force, way %d", (unsigned)t,
                      way);
                CHECK(!memcmp(proxy[0], proxy[way], sizeof proxy[0]), "tick %u: another proxy, way %d", (unsigned)t,
                      way);
                CHECK(t % 20 != 19 || !memcmp(hits[0], hits[way], sizeof hits[0]), "tick %u: another hit, way %d",
                      (unsigned)t, way);
            }
        }
        CHECK(held > part_of(1500) / 3, "%u ticks with a force", (unsigned)held);
        for (int way = 0; way < WAYS; way++)
            rig_close(&scenes[way].rig);
    }
    solid_close(&liver);
}

/* What is set after a step, and whether the hit of the step is known then. */
struct change {
    const char *name;
    int is_known;
};

static const struct change changes[] = { { "nothing", 1 },       { "the tool's pose", 1 }, { "a body's pose", 1 },
                                         { "a bad pose", 1 },    { "a new body", 0 },      { "no body", 0 },
                                         { "another place", 0 }, { "unfelt", 0 } };

static void make_change(struct scene *scene, size_t change, const struct solid *solid)
{
    dpt_body_settings settings = { .size = sizeof settings };
    dpt_pose pose = { { 0.1, 0.2, 0.3 }, { 1, 0, 0, 0 } };
    const dpt_pose bad = { { 0, 0, 0 }, { 0, 0, 0, 0 } };
    switch (change) {
    case 1:
        dpt_tool_set_pose(scene->rig.world, scene->tool[0], &pose);
        break;
    case 2:
        for (int k = 0; k < 2; k++) {
            pose_orient(&pose, (const double[3]){ 0, 0, 1 }, 0.1 * k);
            dpt_body_set_pose(scene->rig.world, k ? scene->mover : scene->rig.body, &pose);
            dpt_body_set_pose(scene->rig.world, k ? scene->mover : scene->rig.body, &pose);
        }
        break;
    case 3:
        dpt_tool_set_pose(scene->rig.world, scene->tool[0], &bad);
        dpt_body_set_pose(scene->rig.world, scene->mover, &bad);
        break;
    case 4:
        rig_add_body(&scene->rig, solid->mesh, &pose);
        break;
    case 5:
        dpt_body_remove(scene->rig.world, scene->rig.body);
        break;
    case 6:
        dpt_body_teleport(scene->rig.world, scene->mover, &pose);
        break;
    case 7:
        dpt_body_get_settings(scene->rig.world, scene->mover, &settings);
        settings.unfelt = 1;
        dpt_body_set_settings(scene->rig.world, scene->mover, &settings);
        break;
    default:
        break;
    }
}

static void a_hit_is_that_of_the_step(void)
{
    struct solid liver;
    if (!solid_from_shape(&liver, "liver", 2000))
        return;
    for (size_t change = 0; change < sizeof changes / sizeof *changes; change++) {
        dpt_hit before[5], after[5], again[5];
        struct scene early, late;
        open_scene(&early, &liver, BY_NOBODY, 0);
        open_scene(&late, &liver, BY_NOBODY, 0);
        for (uint64_t t = 0; t < 400; t++) {
            set_scene(&early, &liver, t);
            set_scene(&late, &liver, t);
            step_scene(&early);
            step_scene(&late);
        }
        read_hits(&early, before);
        CHECK(before[0].contact == DPT_CONTACT_PENETRATING && before[0].status == DPT_STATUS_EXACT, "it is not held");
        make_change(&early, change, &liver);
        make_change(&late, change, &liver);
        read_hits(&early, again);
        read_hits(&late, after);
        CHECK(!memcmp(before, again, sizeof before), "%s: a hit that was read has changed", changes[change].name);
        /* Where a body has moved, its box then is not known any more, which saves some work. */
        for (int i = 0; i < 5; i++)
            after[i].work = before[i].work;
        if (changes[change].is_known)
            CHECK(!memcmp(before, after, sizeof before), "%s: another hit", changes[change].name);
        else
            CHECK(after[0].status == DPT_STATUS_STALE && after[0].triangle == DPT_NONE, "%s: status %u",
                  changes[change].name, after[0].status);
        rig_close(&early.rig);
        rig_close(&late.rig);
    }
    solid_close(&liver);
}

/* The most work of a step, of which the search at the device is a third here. */
static void nobody_asks_and_nothing_is_searched(void)
{
    uint32_t work[WAYS] = { 0 };
    struct solid liver;
    if (!solid_from_shape(&liver, "liver", 20000))
        return;
    for (int way = 0; way < WAYS; way++) {
        dpt_world_info info = { .size = sizeof info };
        struct scene scene;
        open_scene(&scene, &liver, (enum how)way, 0);
        for (uint64_t t = 0; t < 400; t++) {
            set_scene(&scene, &liver, t);
            step_scene(&scene);
        }
        dpt_world_get_info(scene.rig.world, &info);
        work[way] = info.work;
        rig_close(&scene.rig);
    }
    printf("    most units of a step: %u, with a report %u\n", work[BY_NOBODY], work[BY_REPORT]);
    CHECK(work[BY_GETTER] == work[BY_NOBODY] && work[BY_SNAPSHOT] == work[BY_NOBODY], "%u and %u units, not %u",
          work[BY_GETTER], work[BY_SNAPSHOT], work[BY_NOBODY]);
    CHECK(work[BY_NOBODY] < work[BY_REPORT], "%u units, with a report %u", work[BY_NOBODY], work[BY_REPORT]);
    solid_close(&liver);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(reading_changes_nothing);
    TEST(a_hit_is_that_of_the_step);
    TEST(nobody_asks_and_nothing_is_searched);
    return check_report();
}
