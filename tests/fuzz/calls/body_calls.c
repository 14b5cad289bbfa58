/* SPDX-License-Identifier: BSD-3-Clause */
/* Bodies: added, removed, moved, asked, in every order and beyond every capacity. */
#include "fuzz/calls/world_model.h"

enum { CHURN_MAX = 4200 };

static void add_one(struct scene *scene, const struct subject *subject, const dpt_pose *pose, int no_world, int no_out)
{
    struct codes codes = { .count = 0 };
    dpt_body id[2] = { 0x5a5a5a5a, 0x5a5a5a5a };
    dpt_result result = DPT_OK;
    may_fail(&codes, no_world || !subject || no_out, DPT_E_ARGUMENT);
    if (pose)
        pose_codes(pose, &codes);
    if (!no_world)
        may_fail(&codes, scene->body_count == scene->def.max_bodies, DPT_E_FULL);
    call_with("scene %llu, %llu bodies of %llu", (uint64_t)(scene - scenes), scene->body_count, scene->def.max_bodies,
              0);
    EACH_WORLD(scene, i)
    SAME_RESULT(i, result,
                RESULT(dpt_body_add, world_or_null(scene, i, no_world), subject ? subject->mesh : NULL, pose,
                       no_out ? NULL : &id[i]));
    expect(result, &codes);
    if (result != DPT_OK) {
        HOLDS(id[0] == 0x5a5a5a5a || id[0] == 0, "an id %x on an error", id[0]);
        return;
    }
    HOLDS(scene->world_count < 2 || id[0] == id[1], "the twin has id %x, and not %x", id[1], id[0]);
    HOLDS(scene->body_count < BODIES_MAX, "more than the model holds");
    scene_takes_id(scene, &scene->removed_bodies, id[0]);
    const dpt_pose identity = DPT_POSE_IDENTITY;
    scene->body[scene->body_count++] = (struct model_body){ .id = id[0],
                                                            .is_usable = 1,
                                                            .pose = pose ? *pose : identity,
                                                            .side_limit = scene->def.side_limit,
                                                            .subject = subject };
    if (scene->least.bodies < scene->body_count)
        scene->least.bodies = scene->body_count;
    scene->is_as_stepped = 0;
}

static void add(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const dpt_pose pose = draw_pose(NULL);
    add_one(scene, draw_one_in(60) ? NULL : draw_subject(), draw_one_in(4) ? NULL : &pose, draw_one_in(60),
            draw_one_in(60));
}

static void remove_one(struct scene *scene, uint32_t id, int no_world)
{
    struct codes codes = { .count = 0 };
    struct model_body *body = scene_body(scene, id);
    dpt_result result = DPT_OK;
    may_fail(&codes, no_world, DPT_E_ARGUMENT);
    may_fail(&codes, !body, DPT_E_HANDLE);
    call_with("scene %llu, id %llx", (uint64_t)(scene - scenes), id, 0, 0);
    EACH_WORLD(scene, i)
    SAME_RESULT(i, result, RESULT(dpt_body_remove, world_or_null(scene, i, no_world), id));
    expect(result, &codes);
    if (result == DPT_OK)
        scene_remove_body(scene, body);
}

static void remove_any(void)
{
    struct scene *scene = draw_scene();
    if (scene)
        remove_one(scene, draw_body_id(scene), draw_one_in(60));
}

/* In and out, until ids come round; the first one removed is asked about all the way. */
static void churn(void)
{
    struct scene *scene = draw_scene();
    if (!scene || scene->body_count == scene->def.max_bodies)
        return;
    const uint32_t times = draw_one_in(20) ? CHURN_MAX : 1 + draw_below(20);
    const struct subject *subject = draw_subject();
    for (uint32_t i = 0; i < times; i++) {
        add_one(scene, subject, NULL, 0, 0);
        const uint32_t id = scene->body[scene->body_count - 1].id;
        remove_one(scene, id, 0);
        HOLDS(!CALL(dpt_body_is_valid, scene->world[0], id), "id %x is still there", id);
    }
}

/* dpt_body_set_pose and dpt_body_teleport. */
static void move(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const uint32_t id = draw_body_id(scene);
    struct model_body *body = scene_body(scene, id);
    const dpt_pose pose = draw_pose(body ? &body->pose : NULL);
    const int no_world = draw_one_in(60), no_pose = draw_one_in(60), jumps = draw_one_in(3);
    struct codes codes = { .count = 0 };
    dpt_result result = DPT_OK;
    may_fail(&codes, no_world || no_pose, DPT_E_ARGUMENT);
    may_fail(&codes, !body, DPT_E_HANDLE);
    if (!no_pose)
        pose_codes(&pose, &codes);
    call_with("scene %llu, id %llx", (uint64_t)(scene - scenes), id, 0, 0);
    EACH_WORLD(scene, i)
    {
        dpt_world *world = world_or_null(scene, i, no_world);
        const dpt_pose *given = no_pose ? NULL : &pose;
        SAME_RESULT(i, result,
                    jumps ? RESULT(dpt_body_teleport, world, id, given) : RESULT(dpt_body_set_pose, world, id, given));
    }
    expect(result, &codes);
    if (no_world || !body)
        return;
    body->is_usable = result == DPT_OK;
    if (body->is_usable)
        body->pose = pose;
    scene->is_as_stepped = 0;
}

static void get_pose(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const uint32_t id = draw_body_id(scene);
    const struct model_body *body = scene_body(scene, id);
    const int no_world = draw_one_in(60), no_out = draw_one_in(60);
    struct codes codes = { .count = 0 };
    dpt_result result = DPT_OK;
    may_fail(&codes, no_world || no_out, DPT_E_ARGUMENT);
    may_fail(&codes, !body, DPT_E_HANDLE);
    call_with("scene %llu, id %llx", (uint64_t)(scene - scenes), id, 0, 0);
    EACH_WORLD(scene, i)
    {
        dpt_pose *out = output_of(i, sizeof *out);
        SAME_RESULT(i, result, RESULT(dpt_body_get_pose, world_or_null(scene, i, no_world), id, no_out ? NULL : out));
        const dpt_pose identity = DPT_POSE_IDENTITY;
        const dpt_pose *expected = result == DPT_OK ? &body->pose : &identity;
        HOLDS((result != DPT_OK && output_is_untouched(i, 0)) || !memcmp(out, expected, sizeof *out),
              "not the last pose that could be used");
    }
    expect(result, &codes);
    outputs_are_guarded(0, scene->world_count);
}

static void user(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const uint32_t id = draw_body_id(scene);
    struct model_body *body = scene_body(scene, id);
    const int no_world = draw_one_in(60), sets = draw_one_in(2), no_out = !sets && draw_one_in(60);
    const uint64_t value = draw_bits();
    struct codes codes = { .count = 0 };
    dpt_result result = DPT_OK;
    may_fail(&codes, no_world || no_out, DPT_E_ARGUMENT);
    may_fail(&codes, !body, DPT_E_HANDLE);
    call_with("scene %llu, id %llx, %llx", (uint64_t)(scene - scenes), id, value, 0);
    EACH_WORLD(scene, i)
    {
        dpt_world *world = world_or_null(scene, i, no_world);
        uint64_t *out = output_of(i, sizeof *out);
        SAME_RESULT(i, result,
                    sets ? RESULT(dpt_body_set_user, world, id, value)
                         : RESULT(dpt_body_get_user, world, id, no_out ? NULL : out));
        HOLDS(sets || no_out || output_is_untouched(i, 0) || *out == (result == DPT_OK ? body->user : 0), "user %llx",
              (unsigned long long)*out);
        HOLDS(sets || result != DPT_OK || !output_is_untouched(i, 0), "nothing was told");
    }
    expect(result, &codes);
    outputs_are_guarded(0, scene->world_count);
    if (sets && result == DPT_OK)
        body->user = value;
}

static void set_settings(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const uint32_t id = draw_body_id(scene);
    struct model_body *body = scene_body(scene, id);
    const int no_world = draw_one_in(60), no_settings = draw_one_in(60);
    dpt_body_settings settings = { .unfelt = draw_one_in(30)  ? 2u
                                             : draw_one_in(8) ? 1u
                                                              : 0u,
                                   .side_limit = draw_one_in(8) ? draw_odd_number() : draw_in(0.0, 0.2) };
    if (draw_one_in(2)) {
        settings.static_friction = draw_one_in(16) ? draw_odd_number() : draw_in(0.0, 1.2);
        settings.kinetic_friction = draw_one_in(16) ? draw_odd_number() : draw_in(0.0, 1.0) * settings.static_friction;
    }
    if (draw_one_in(4))
        settings.stiffness = draw_one_in(8) ? draw_odd_number() : draw_in(0.0, 3000.0);
    /* These worlds have no room for channels: no body of theirs can be pierced. */
    if (draw_one_in(8))
        settings.shaft_friction = draw_in(0.0, 100.0);
    if (draw_one_in(16))
        settings.puncture_force = draw_one_in(2) ? draw_odd_number() : draw_in(0.1, 3.0);
    const uint32_t size = draw_size(offsetof(dpt_body_settings, puncture_force), sizeof settings);
    const int has_puncture = size >= offsetof(dpt_body_settings, toughness) && settings.puncture_force != 0.0;
    struct codes codes = { .count = 0 };
    dpt_result result = DPT_OK;
    may_fail(&codes, no_world || no_settings, DPT_E_ARGUMENT);
    may_fail(&codes, !body, DPT_E_HANDLE);
    const void *given = NULL;
    if (!no_settings) {
        given = draw_input(0, &settings, size, offsetof(dpt_body_settings, puncture_force), sizeof settings, &codes);
        may_fail(&codes,
                 (has_puncture && !(settings.puncture_force >= 0.0 && settings.puncture_force <= 1e6)) ||
                     settings.unfelt > 1 || !(settings.stiffness >= 0.0 && settings.stiffness <= 1e9) ||
                     !(settings.side_limit >= 0.0 && settings.side_limit <= DPT_COORDINATE_MAX) ||
                     !(settings.kinetic_friction >= 0.0 && settings.static_friction <= 10.0 &&
                       settings.kinetic_friction <= settings.static_friction),
                 DPT_E_ARGUMENT);
        may_fail(&codes, has_puncture, DPT_E_UNSUPPORTED);
    }
    call_with("scene %llu, id %llx", (uint64_t)(scene - scenes), id, 0, 0);
    EACH_WORLD(scene, i)
    SAME_RESULT(i, result, RESULT(dpt_body_set_settings, world_or_null(scene, i, no_world), id, given));
    expect(result, &codes);
    if (result != DPT_OK)
        return;
    body->side_limit = settings.side_limit;
    body->static_friction = settings.static_friction;
    body->kinetic_friction = settings.kinetic_friction;
    body->stiffness = settings.stiffness;
    body->unfelt = settings.unfelt;
    scene->is_as_stepped = 0;
}

static void get_settings(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const uint32_t id = draw_body_id(scene);
    const struct model_body *body = scene_body(scene, id);
    const int no_world = draw_one_in(60), no_out = draw_one_in(60);
    dpt_body_settings now;
    const uint32_t size = draw_size(offsetof(dpt_body_settings, puncture_force), sizeof now);
    struct codes codes = { .count = 0 };
    dpt_result result = DPT_OK;
    may_fail(&codes, no_world || no_out, DPT_E_ARGUMENT);
    may_fail(&codes, !body, DPT_E_HANDLE);
    if (!no_out)
        size_codes_of_output(size, offsetof(dpt_body_settings, puncture_force), 0, &codes);
    call_with("scene %llu, id %llx, size %llu", (uint64_t)(scene - scenes), id, size, 0);
    EACH_WORLD(scene, i)
    {
        void *out = output_sized(i, size);
        SAME_RESULT(i, result,
                    RESULT(dpt_body_get_settings, world_or_null(scene, i, no_world), id, no_out ? NULL : out));
    }
    expect(result, &codes);
    outputs_are_guarded(0, scene->world_count);
    if (result == DPT_OK && output_read(0, size, sizeof now, 8, &now))
        HOLDS(now.side_limit == body->side_limit && now.unfelt == body->unfelt && now.stiffness == body->stiffness &&
                  now.static_friction == body->static_friction && now.kinetic_friction == body->kinetic_friction,
              "side_limit %g, friction %g, %g, and not %g, %g, %g", now.side_limit, now.static_friction,
              now.kinetic_friction, body->side_limit, body->static_friction, body->kinetic_friction);
}

static void is_valid(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    for (int k = 0; k < 4; k++) {
        const uint32_t id = draw_body_id(scene);
        const int no_world = draw_one_in(60);
        call_with("scene %llu, id %llx", (uint64_t)(scene - scenes), id, 0, 0);
        EACH_WORLD(scene, i)
        HOLDS(CALL(dpt_body_is_valid, world_or_null(scene, i, no_world), id) == (!no_world && scene_body(scene, id)),
              "id %x", id);
    }
}

/* Half of the scenes are of solid bodies alone: the gap's sign is known there. */
void scene_gets_bodies(struct scene *scene)
{
    const int is_solid = draw_one_in(2);
    for (uint32_t k = 1 + draw_below(3); k; k--) {
        const dpt_pose pose = draw_pose(NULL);
        const struct subject *subject = draw_subject();
        while (is_solid && !subject->is_solid)
            subject = draw_subject();
        if (draw_one_in(3))
            scene_gets_soft(scene, subject);
        else
            add_one(scene, subject, &pose, 0, 0);
    }
}

static const struct move moves[] = { { "add", add, 12 },
                                     { "remove", remove_any, 4 },
                                     { "churn", churn, 1 },
                                     { "move", move, 20 },
                                     { "get pose", get_pose, 4 },
                                     { "user", user, 6 },
                                     { "set settings", set_settings, 4 },
                                     { "get settings", get_settings, 4 },
                                     { "is valid", is_valid, 3 },
                                     { NULL, NULL, 0 } };

const struct noun body_noun = { "body", NULL, NULL, moves };
