/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A body whose physics is somebody else's and tells how far it gives way: mean loads, answers, steps, well and badly, in a
 * world of its own. What must hold: codes; loads and vertices that are finite; the time that a mean is over. How it yields
 * is for test_own_compliance.
 */
#include "fuzz/calls/rules.h"

enum { LOADS_MOST = 4096, ACTIONS = 24 };

static struct {
    const struct subject *subject;
    dpt_world *world;
    unsigned char *world_block, *body_block;
    dpt_body body;
    dpt_tool tool;
    double seconds;   /* of the mean */
    int has_answered; /* the next step of the world begins a new mean */
} yielding;

/* Open it, if it is not: a ball beside a body that gives way. */
static int is_there(void)
{
    dpt_world_def def;
    dpt_deformable_def soft;
    const dpt_segment ball = { .radius = 0.3 };
    if (yielding.world)
        return 1;
    yielding.subject = draw_subject();
    dpt_world_def_init(&def);
    def.max_bodies = def.max_tools = def.max_segments = 1;
    def.max_tips = 0;
    dpt_deformable_def_init(&soft);
    soft.mesh = yielding.subject->mesh;
    soft.compliance = draw_in(1e-6, 1e-3);
    for (int k = 0; k < 3; k++) {
        soft.box_min[k] = -100.0;
        soft.box_max[k] = 100.0;
    }
    const size_t bytes = dpt_deformable_bytes(&soft), room = dpt_world_bytes(&def);
    if (!bytes)
        return 0;
    yielding.world_block = malloc(room);
    yielding.body_block = malloc(bytes);
    HOLDS(dpt_world_create(yielding.world_block, room, &def, &yielding.world) == DPT_OK, "no world");
    HOLDS(dpt_body_add_deformable(yielding.world, yielding.body_block, bytes, &soft, &yielding.body) == DPT_OK,
          "it is not added");
    HOLDS(dpt_tool_add(yielding.world, &ball, 1, &yielding.tool) == DPT_OK, "no tool");
    return 1;
}

static void step(void)
{
    dpt_wrench wrench;
    dpt_pose pose = DPT_POSE_IDENTITY;
    const double dt = draw_one_in(20) ? draw_odd_number() : 1e-3;
    if (!is_there())
        return;
    for (int k = 0; k < 3; k++)
        pose.position[k] = draw_in(-1.0, 1.0);
    (draw_one_in(20) ? dpt_tool_teleport : dpt_tool_set_pose)(yielding.world, yielding.tool, &pose);
    HOLDS(dpt_world_step(yielding.world, 1e-3, NULL) == DPT_OK, "no tick");
    const int is_valid = dt >= DPT_SPRINGS_STEP_MIN && dt <= DPT_SPRINGS_STEP_MAX;
    const dpt_result result = RESULT(dpt_body_step_springs, yielding.world, yielding.body, NULL, dt, NULL);
    HOLDS((result == DPT_OK) == is_valid, "dt %g: %s", dt, dpt_result_name(result));
    yielding.seconds = (yielding.has_answered ? 0.0 : yielding.seconds) + (is_valid ? dt : 0.0);
    yielding.has_answered = 0;
    dpt_tool_get_wrench(yielding.world, yielding.tool, &wrench);
    for (int k = 0; k < 3; k++)
        HOLDS(isfinite(wrench.force[k]) && isfinite(wrench.torque[k]), "a wrench of %g N", wrench.force[k]);
}

static uint32_t mean_of(dpt_load loads[LOADS_MOST])
{
    const uint32_t capacity = draw_one_in(4) ? draw_below(4) : LOADS_MOST;
    const int no_world = draw_one_in(20), no_count = draw_one_in(20);
    uint32_t count = 77;
    double seconds = -1.0;
    struct codes codes = { .count = 0 };
    const dpt_result result = RESULT(dpt_body_get_mean_loads, no_world ? NULL : yielding.world, yielding.body, loads,
                                     capacity, no_count ? NULL : &count, &seconds);
    may_fail(&codes, no_world || no_count, DPT_E_ARGUMENT);
    may_fail(&codes, !no_world && !no_count && count > capacity, DPT_E_FULL);
    expect(result, &codes);
    if (result != DPT_OK)
        return 0;
    HOLDS(fabs(seconds - yielding.seconds) <= 1e-9 * yielding.seconds, "%.17g s, not %.17g", seconds, yielding.seconds);
    for (uint32_t i = 0; i < count; i++) {
        HOLDS(loads[i].vertex < yielding.subject->vertices, "vertex %u", loads[i].vertex);
        for (int k = 0; k < 3; k++)
            HOLDS(isfinite(loads[i].force[k]), "a load of %g N", loads[i].force[k]);
    }
    game_digest(loads, count * sizeof *loads);
    return count;
}

static void answer(void)
{
    static dpt_load loads[LOADS_MOST];
    if (!is_there())
        return;
    uint32_t count = mean_of(loads);
    struct codes codes = { .count = 0 };
    const int is_far = count && draw_one_in(6), is_odd = count && !is_far && draw_one_in(6), no_world = draw_one_in(20);
    if (is_far)
        loads[count - 1].vertex = yielding.subject->vertices + draw_below(3);
    if (is_odd)
        loads[0].force[draw_below(3)] = NAN;
    may_fail(&codes, is_far || no_world, DPT_E_ARGUMENT);
    may_fail(&codes, is_odd, DPT_E_FINITE);
    const dpt_result result =
        RESULT(dpt_body_set_answered_loads, no_world ? NULL : yielding.world, yielding.body, loads, count);
    expect(result, &codes);
    yielding.has_answered |= result == DPT_OK;
}

/* Where all vertices stand, a little lower. */
static void foresee(void)
{
    static float foreseen[3 * VERTICES_MOST];
    const float *now;
    uint32_t count;
    if (!is_there() || dpt_body_get_vertices(yielding.world, yielding.body, &now, &count) != DPT_OK ||
        count > VERTICES_MOST)
        return;
    struct codes codes = { .count = 0 };
    const int is_far = draw_one_in(6), is_odd = !is_far && draw_one_in(6), no_world = draw_one_in(20);
    for (uint32_t i = 0; i < 3 * count; i++)
        foreseen[i] = now[i] - (i % 3 == 2 ? 1e-4f : 0.0f);
    if (is_odd)
        foreseen[draw_below(3 * count)] = NAN;
    may_fail(&codes, is_far || no_world, DPT_E_ARGUMENT);
    may_fail(&codes, is_odd, DPT_E_FINITE);
    expect(RESULT(dpt_body_set_foreseen_vertices, no_world ? NULL : yielding.world, yielding.body, (uint32_t)is_far,
                  count, foreseen),
           &codes);
}

/* As a game ends, on a world that lives no longer. */
static void end(void)
{
    for (int i = 0; i < ACTIONS; i++)
        (draw_one_in(3) ? answer : draw_one_in(4) ? foresee : step)();
    free(yielding.world_block);
    free(yielding.body_block);
    memset(&yielding, 0, sizeof yielding);
}

static const struct move moves[] = { { NULL, NULL, 0 } };

const struct noun yield_noun = { "yield", NULL, end, moves };
