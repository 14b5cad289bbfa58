/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Answers end with what they rest on: a step that fails leaves none of the last one's, and a reset world is a new one,
 * bit for bit. It cannot judge whether answers are right; others do.
 */
#include "lib/fixture.h"
#include "lib/rig.h"

enum { SEGMENTS = 2, TICKS = 60, CONTACTS = 8 };

struct scene {
    struct fixture torus, sheet;
    struct rig rig;
    dpt_body sheet_body;
};

static const dpt_pose identity = DPT_POSE_IDENTITY;

static dpt_world_def def_of(uint32_t budget, uint32_t strip)
{
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    def.max_bodies = 3;
    def.max_tools = 2;
    def.max_segments = 4;
    def.budget = budget;
    def.strip = strip;
    def.margin = 0.01;
    return def;
}

static void scene_open(struct scene *scene, uint32_t budget, uint32_t strip)
{
    const dpt_world_def def = def_of(budget, strip);
    const dpt_segment segments[SEGMENTS] = { { { 0, 0, 0 }, { 0, 0, 0.2 }, 0.01 },
                                             { { 0, 0, 0.2 }, { 0.1, 0, 0.3 }, 0.0 } };
    fixture_from_shape(&scene->torus, "torus", 512);
    fixture_from_shape(&scene->sheet, "membrane", 512);
    rig_open(&scene->rig, &def, scene->torus.mesh, segments, SEGMENTS);
    scene->sheet_body = rig_add_body(&scene->rig, scene->sheet.mesh, NULL);
}

static void scene_close(struct scene *scene)
{
    rig_close(&scene->rig);
    fixture_free(&scene->torus);
    fixture_free(&scene->sheet);
}

/* Into both bodies and out again; the sheet moves too. */
static void move(struct scene *scene, int tick)
{
    const double t = tick / (double)TICKS;
    dpt_pose pose = identity, moved = identity;
    pose.position[0] = 0.09 * sin(6.3 * t);
    pose.position[1] = 0.02 * cos(19.0 * t);
    pose.position[2] = 0.1 - 0.25 * t;
    moved.position[2] = 0.03 * sin(12.6 * t);
    dpt_tool_set_pose(scene->rig.world, scene->rig.tool, &pose);
    dpt_body_set_pose(scene->rig.world, scene->sheet_body, &moved);
}

/* All that a tick told of the tool. */
struct answers {
    dpt_step step;
    dpt_wrench wrench;
    dpt_hit hit[SEGMENTS];
    dpt_sweep sweep[SEGMENTS];
    dpt_contact contact[CONTACTS];
    uint32_t contacts;
    uint32_t triangles[SEGMENTS];
    dpt_overlap overlap[SEGMENTS];
};

static dpt_result step(struct scene *scene, double dt, struct answers *answers)
{
    memset(answers, 0, sizeof *answers);
    answers->step.size = sizeof answers->step;
    answers->contact[0].size = sizeof answers->contact[0];
    dpt_result result = dpt_world_step(scene->rig.world, dt, &answers->step);
    dpt_tool_get_wrench(scene->rig.world, scene->rig.tool, &answers->wrench);
    dpt_tool_get_contacts(scene->rig.world, scene->rig.tool, answers->contact, CONTACTS, &answers->contacts);
    for (uint32_t i = 0; i < SEGMENTS; i++) {
        answers->hit[i].size = sizeof answers->hit[i];
        answers->sweep[i].size = sizeof answers->sweep[i];
        answers->overlap[i].size = sizeof answers->overlap[i];
        dpt_tool_get_segment_hit(scene->rig.world, scene->rig.tool, i, &answers->hit[i]);
        dpt_tool_get_sweep(scene->rig.world, scene->rig.tool, i, &answers->sweep[i]);
        dpt_tool_get_strip(scene->rig.world, scene->rig.tool, i, &answers->overlap[i], 1, &answers->triangles[i], NULL);
    }
    return result;
}

/* Nothing is said of contact, motion, strips or force, and the nearest pairs are stale. */
static void expect_nothing(const struct answers *answers, const char *why)
{
    static const dpt_wrench zero;
    CHECK(!memcmp(&answers->wrench, &zero, sizeof zero), "%s: a force", why);
    CHECK(answers->contacts == 0 && answers->step.contacts == 0, "%s: %u regions, %u told", why, answers->contacts,
          answers->step.contacts);
    CHECK(answers->step.status == DPT_STATUS_STALE && !answers->step.flags, "%s: status %u", why, answers->step.status);
    for (uint32_t i = 0; i < SEGMENTS; i++)
        CHECK(answers->hit[i].status == DPT_STATUS_STALE && answers->triangles[i] == 0 &&
                  answers->sweep[i].status == DPT_SWEEP_NONE,
              "%s: segment %u: status %u, %u triangles, sweep %u", why, i, answers->hit[i].status,
              answers->triangles[i], answers->sweep[i].status);
}

static void a_step_that_fails_leaves_no_answer(void)
{
    static const double wrong[] = { 0.0, -0.001, NAN, INFINITY };
    struct scene scene;
    struct answers before, answers;
    int felt = 0;
    scene_open(&scene, 0, DPT_STRIP_KIND_SHADOW);
    for (int tick = 0; tick < TICKS; tick++) {
        move(&scene, tick);
        CHECK(step(&scene, 0.001, &before) == DPT_OK, "tick %d", tick);
        felt += before.contacts > 0;
        CHECK(step(&scene, wrong[tick % 4], &answers) == DPT_E_ARGUMENT, "tick %d", tick);
        expect_nothing(&answers, "a wrong dt");
        dpt_step old = { .size = 4 };
        CHECK(dpt_world_step(scene.rig.world, 0.001, &old) == DPT_E_SIZE, "tick %d", tick);
        uint32_t count = 1;
        CHECK(dpt_tool_get_contacts(scene.rig.world, scene.rig.tool, NULL, 0, &count) == DPT_OK && count == 0,
              "%u regions after a wrong size", count);
        /* At the same place again: what lived before the failure lives on, by its number. */
        CHECK(step(&scene, 0.001, &answers) == DPT_OK && answers.contacts == before.contacts,
              "tick %d: %u regions, then %u", tick, before.contacts, answers.contacts);
        for (uint32_t i = 0; i < answers.contacts && i < CONTACTS; i++)
            CHECK(answers.contact[i].id == before.contact[i].id, "region %u is %u, not %u", i, answers.contact[i].id,
                  before.contact[i].id);
    }
    CHECK(felt > TICKS / 4, "%d ticks in contact", felt);
    scene_close(&scene);
}

static void a_reset_world_is_a_new_one(void)
{
    static const uint32_t budgets[] = { 0, 40, 300 };
    for (uint32_t i = 0; i < 3; i++) {
        struct scene used, fresh;
        struct answers one, other;
        scene_open(&used, budgets[i], DPT_STRIP_KIND_ROUTES);
        scene_open(&fresh, budgets[i], DPT_STRIP_KIND_ROUTES);
        for (int tick = 0; tick < TICKS - 7; tick++) {
            move(&used, tick);
            step(&used, 0.001, &one);
        }
        CHECK(dpt_world_reset(used.rig.world) == DPT_OK, "reset");
        for (int tick = 0; tick < TICKS; tick++) {
            move(&used, tick);
            move(&fresh, tick);
            step(&used, 0.001, &one);
            step(&fresh, 0.001, &other);
            CHECK(!memcmp(&one, &other, sizeof one), "budget %u, tick %d", budgets[i], tick);
        }
        scene_close(&used);
        scene_close(&fresh);
    }
}

/* A proxy that is held back has its hits found when they are read, unless a body was put since the step. */
static void hits_are_found_after_a_reset(void)
{
    struct fixture torus, sheet;
    struct rig rig;
    const dpt_segment segment = { { -0.02, 0, 0 }, { 0.02, 0, 0 }, 0.001 };
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    dpt_pose pose = identity;
    dpt_hit hit = { .size = sizeof hit };
    int stale = 0;
    def.max_bodies = 2;
    pose.position[0] = 0.1;
    fixture_from_shape(&torus, "torus", 512);
    fixture_from_shape(&sheet, "membrane", 512);
    rig_open(&rig, &def, torus.mesh, &segment, 1);
    for (int tick = 0; tick < TICKS; tick++) {
        if (tick == TICKS - 10)
            rig_add_body(&rig, sheet.mesh, &(dpt_pose){ { 0, 0, -0.5 }, { 1, 0, 0, 0 } });
        dpt_tool_set_pose(rig.world, rig.tool, &pose);
        CHECK(dpt_world_step(rig.world, 0.001, NULL) == DPT_OK, "tick %d", tick);
    }
    CHECK(dpt_world_reset(rig.world) == DPT_OK, "reset");
    for (int tick = 0; tick < TICKS; tick++) {
        pose.position[2] = 0.06 - 0.0005 * tick;
        dpt_tool_set_pose(rig.world, rig.tool, &pose);
        CHECK(dpt_world_step(rig.world, 0.001, NULL) == DPT_OK, "tick %d", tick);
        CHECK(dpt_tool_get_hit(rig.world, rig.tool, &hit) == DPT_OK, "hit");
        stale += hit.status == DPT_STATUS_STALE;
    }
    CHECK(hit.contact == DPT_CONTACT_PENETRATING && stale == 0, "%d of %d hits are stale", stale, TICKS);
    rig_close(&rig);
    fixture_free(&torus);
    fixture_free(&sheet);
}

int main(void)
{
    TEST(a_step_that_fails_leaves_no_answer);
    TEST(a_reset_world_is_a_new_one);
    TEST(hits_are_found_after_a_reset);
    return check_report();
}
