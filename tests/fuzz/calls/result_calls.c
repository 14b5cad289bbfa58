/* SPDX-License-Identifier: BSD-3-Clause */
/* What a world answers, asked at any moment, with any id, size and capacity. */
#include "fuzz/calls/rules.h"

enum { FIRST_ARRAY = 2 }; /* slots of arrays, behind those of counts */

/* What all getters of a tool share. */
struct question {
    struct scene *scene;
    const struct model_tool *tool;
    uint32_t id, segment;
    int no_world, no_out;
    struct codes codes;
};

static int draw_question(struct question *of)
{
    *of = (struct question){ .scene = draw_scene() };
    if (!of->scene)
        return 0;
    of->id = draw_tool_id(of->scene);
    of->tool = scene_tool(of->scene, of->id);
    of->segment = of->tool ? draw_below(of->tool->count) : 0;
    if (draw_one_in(20))
        of->segment = draw_one_in(2) ? draw_below(SEGMENTS_MAX) : (uint32_t)draw_bits();
    of->no_world = draw_one_in(60);
    of->no_out = draw_one_in(60);
    may_fail(&of->codes, of->no_world || of->no_out, DPT_E_ARGUMENT);
    may_fail(&of->codes, !of->tool, DPT_E_HANDLE);
    return 1;
}

static void trace(const struct question *of, uint64_t size)
{
    call_with("scene %llu, id %llx, segment %llu, size %llu", (uint64_t)(of->scene - scenes), of->id, of->segment,
              size);
}

static void segment_is_asked(struct question *of)
{
    may_fail(&of->codes, of->tool && of->segment >= of->tool->count, DPT_E_ARGUMENT);
}

static void twins_agree(const struct question *of, int pairs)
{
    for (int pair = 0; pair < pairs; pair++)
        outputs_are_guarded(2 * pair, of->scene->world_count);
    if (of->scene->world_count == 2)
        outputs_agree(pairs);
}

static void hit(void)
{
    struct question of;
    dpt_hit now;
    if (!draw_question(&of))
        return;
    const uint32_t size = draw_size(sizeof now, sizeof now);
    const int of_segment = draw_one_in(2);
    dpt_result result = DPT_OK;
    if (!of.no_out)
        size_codes_of_output(size, sizeof now, 0, &of.codes);
    if (of_segment)
        segment_is_asked(&of);
    trace(&of, size);
    EACH_WORLD(of.scene, i)
    {
        const dpt_world *world = world_or_null(of.scene, i, of.no_world);
        dpt_hit *out = output_sized(i, size);
        out = of.no_out ? NULL : out;
        SAME_RESULT(i, result,
                    of_segment ? RESULT(dpt_tool_get_segment_hit, world, of.id, of.segment, out)
                               : RESULT(dpt_tool_get_hit, world, of.id, out));
    }
    expect(result, &of.codes);
    twins_agree(&of, 1);
    if (of.no_out || output_is_untouched(0, sizeof size)) {
        HOLDS(result != DPT_OK, "nothing was told");
        return;
    }
    const int is_whole = output_read(0, size, sizeof now, offsetof(dpt_hit, distance), &now);
    if (is_whole && result == DPT_OK)
        hit_must_hold(of.scene, of.tool, of_segment ? of.segment : now.segment, &now);
    else if (is_whole)
        hit_must_be_stale(&now);
}

/* What a tool has a list of, its contacts or its loads. */
static void list(size_t today, int is_loads)
{
    struct question of;
    if (!draw_question(&of))
        return;
    const uint32_t size = draw_size(today, today);
    const uint32_t capacity = draw_below(10), room = size > 4096 || size < 8 ? 8 : size;
    const int no_count = draw_one_in(60), no_array = of.no_out || draw_one_in(8);
    uint32_t told[2] = { 77, 77 };
    dpt_result result = DPT_OK;
    of.codes.count = 0;
    may_fail(&of.codes, of.no_world || no_count || (no_array && capacity), DPT_E_ARGUMENT);
    may_fail(&of.codes, !of.tool, DPT_E_HANDLE);
    if (capacity && !no_array)
        size_codes_of_output(size, today, 1, &of.codes);
    may_fail(&of.codes, !is_loads && !of.scene->def.max_contacts, DPT_E_FULL);
    trace(&of, size);
    EACH_WORLD(of.scene, i)
    {
        unsigned char *out = output_of(FIRST_ARRAY + i, (size_t)room * capacity);
        if (capacity)
            memcpy(out, &size, sizeof size);
        const dpt_world *world = world_or_null(of.scene, i, of.no_world);
        uint32_t *count = no_count ? NULL : &told[i];
        void *items = no_array ? NULL : out;
        SAME_RESULT(i, result,
                    is_loads ? RESULT(dpt_tool_get_loads, world, of.id, items, capacity, count)
                             : RESULT(dpt_tool_get_contacts, world, of.id, items, capacity, count));
    }
    expect(result, &of.codes);
    outputs_are_guarded(FIRST_ARRAY, of.scene->world_count);
    HOLDS(of.scene->world_count < 2 || told[0] == told[1], "%u and %u", told[0], told[1]);
    if (result != DPT_OK) {
        HOLDS(told[0] == 77 || told[0] == 0, "%u on an error", told[0]);
        return;
    }
    HOLDS(is_loads || told[0] <= of.scene->contacts_then, "%u of %u in all", told[0], of.scene->contacts_then);
    HOLDS(of.tool->answers != ANSWERS_NONE || told[0] == 0, "%u without a step", told[0]);
    uint32_t all = 77;
    if (is_loads)
        dpt_tool_get_loads(of.scene->world[0], of.id, NULL, 0, &all);
    else
        dpt_tool_get_contacts(of.scene->world[0], of.id, NULL, 0, &all);
    HOLDS(told[0] == all, "%u with room for %u, and there are %u", told[0], capacity, all);
    const uint32_t given = told[0] < capacity ? told[0] : capacity;
    HOLDS(output_is_untouched(FIRST_ARRAY, capacity && !given ? sizeof size : (size_t)given * size),
          "written behind the last of %u", given);
    game_digest(told, sizeof *told);
}

static void contacts(void)
{
    list(sizeof(dpt_contact), 0);
}

static void loads(void)
{
    list(sizeof(dpt_tool_load), 1);
}

/* These worlds have no room for channels. */
static void channels(void)
{
    struct question of;
    if (!draw_question(&of))
        return;
    const int no_count = draw_one_in(60);
    uint32_t told[2] = { 77, 77 };
    dpt_result result = DPT_OK;
    of.codes.count = 0;
    may_fail(&of.codes, of.no_world || no_count, DPT_E_ARGUMENT);
    may_fail(&of.codes, !of.tool, DPT_E_HANDLE);
    may_fail(&of.codes, 1, DPT_E_UNSUPPORTED);
    trace(&of, 0);
    EACH_WORLD(of.scene, i)
    SAME_RESULT(i, result,
                RESULT(dpt_tool_get_channels, world_or_null(of.scene, i, of.no_world), of.id, NULL, 0,
                       no_count ? NULL : &told[i]));
    expect(result, &of.codes);
    HOLDS(told[0] == 77 || told[0] == 0, "%u channels", told[0]);
    EACH_WORLD(of.scene, i)
    SAME_RESULT(i, result, RESULT(dpt_tool_insert, (dpt_world *)world_or_null(of.scene, i, of.no_world), of.id));
    of.codes.count = 0;
    may_fail(&of.codes, of.no_world, DPT_E_ARGUMENT);
    may_fail(&of.codes, !of.tool, DPT_E_HANDLE);
    may_fail(&of.codes, 1, DPT_E_UNSUPPORTED);
    expect(result, &of.codes);
}

static void sweep(void)
{
    struct question of;
    dpt_sweep now;
    if (!draw_question(&of))
        return;
    const uint32_t size = draw_size(sizeof now, sizeof now);
    dpt_result result = DPT_OK;
    segment_is_asked(&of);
    if (!of.no_out)
        size_codes_of_output(size, sizeof now, 0, &of.codes);
    trace(&of, size);
    EACH_WORLD(of.scene, i)
    {
        dpt_sweep *out = output_sized(i, size);
        SAME_RESULT(i, result,
                    RESULT(dpt_tool_get_sweep, world_or_null(of.scene, i, of.no_world), of.id, of.segment,
                           of.no_out ? NULL : out));
    }
    expect(result, &of.codes);
    twins_agree(&of, 1);
    if (of.no_out || output_is_untouched(0, sizeof size)) {
        HOLDS(result != DPT_OK, "nothing was told");
        return;
    }
    if (output_read(0, size, sizeof now, offsetof(dpt_sweep, time), &now) && result == DPT_OK)
        sweep_must_hold(of.scene, of.tool, of.segment, &now);
    HOLDS(result == DPT_OK || size < sizeof now || now.status == DPT_SWEEP_NONE, "status %u", now.status);
}

static void strip(void)
{
    struct question of;
    dpt_overlap now;
    if (!draw_question(&of))
        return;
    const uint32_t size = draw_size(sizeof now, sizeof now);
    const uint32_t capacity = draw_below(12), room = size > 4096 || size < 8 ? 8 : size;
    const int no_count = draw_one_in(60), no_array = of.no_out || draw_one_in(8);
    const int no_flags = draw_one_in(4);
    uint32_t told[2] = { 77, 77 }, flags[2] = { 77, 77 };
    dpt_result result = DPT_OK;
    of.codes.count = 0;
    may_fail(&of.codes, of.no_world || no_count || (no_array && capacity), DPT_E_ARGUMENT);
    may_fail(&of.codes, !of.tool, DPT_E_HANDLE);
    segment_is_asked(&of);
    if (capacity && !no_array)
        size_codes_of_output(size, sizeof now, 1, &of.codes);
    trace(&of, size);
    EACH_WORLD(of.scene, i)
    {
        unsigned char *out = output_of(FIRST_ARRAY + i, (size_t)room * capacity);
        if (capacity)
            memcpy(out, &size, sizeof size);
        SAME_RESULT(i, result,
                    RESULT(dpt_tool_get_strip, world_or_null(of.scene, i, of.no_world), of.id, of.segment,
                           no_array ? NULL : (void *)out, capacity, no_count ? NULL : &told[i],
                           no_flags ? NULL : &flags[i]));
    }
    expect(result, &of.codes);
    outputs_are_guarded(FIRST_ARRAY, of.scene->world_count);
    HOLDS(of.scene->world_count < 2 || (told[0] == told[1] && flags[0] == flags[1]), "%u and %u", told[0], told[1]);
    if (result != DPT_OK) {
        HOLDS((told[0] == 77 || told[0] == 0) && (flags[0] == 77 || flags[0] == 0), "%u, flags %x on an error", told[0],
              flags[0]);
        return;
    }
    HOLDS(told[0] <= (of.scene->def.strip ? of.scene->def.strip_capacity : 0), "%u", told[0]);
    HOLDS(of.tool->answers != ANSWERS_NONE || told[0] == 0, "%u without a step", told[0]);
    HOLDS(no_flags || flags[0] <= 7, "flags %x", flags[0]);
    uint32_t all = 77;
    dpt_tool_get_strip(of.scene->world[0], of.id, of.segment, NULL, 0, &all, NULL);
    HOLDS(told[0] == all, "%u with room for %u, and there are %u", told[0], capacity, all);
    const uint32_t given = told[0] < capacity ? told[0] : capacity;
    HOLDS(output_is_untouched(FIRST_ARRAY, capacity && !given ? sizeof size : (size_t)given * size),
          "written behind the last of %u", given);
    game_digest(told, sizeof *told);
}

static void wrench(void)
{
    struct question of;
    if (!draw_question(&of))
        return;
    dpt_result result = DPT_OK;
    trace(&of, 0);
    EACH_WORLD(of.scene, i)
    {
        dpt_wrench *out = output_of(i, sizeof *out);
        SAME_RESULT(
            i, result,
            RESULT(dpt_tool_get_wrench, world_or_null(of.scene, i, of.no_world), of.id, of.no_out ? NULL : out));
        if (of.no_out)
            continue;
        numbers_are_finite(out->force, 6, "a wrench");
        const double *numbers = (const double *)(const void *)out;
        for (int k = 0; k < 6; k++)
            HOLDS((result == DPT_OK && of.tool->answers != ANSWERS_NONE) || numbers[k] == 0.0,
                  "a wrench on an error, or without an answer: %g", numbers[k]);
    }
    expect(result, &of.codes);
    twins_agree(&of, 1);
}

/* On a body, by all tools or by one. */
static void body_wrench(void)
{
    struct question of;
    if (!draw_question(&of))
        return;
    const int by_tool = draw_one_in(2);
    const uint32_t body = draw_body_id(of.scene);
    dpt_result result = DPT_OK;
    of.codes.count = 0;
    may_fail(&of.codes, of.no_world || of.no_out, DPT_E_ARGUMENT);
    may_fail(&of.codes, (by_tool && !of.tool) || !scene_body(of.scene, body), DPT_E_HANDLE);
    trace(&of, body);
    EACH_WORLD(of.scene, i)
    {
        dpt_world *world = world_or_null(of.scene, i, of.no_world);
        dpt_wrench *out = output_of(i, sizeof *out), *given = of.no_out ? NULL : out;
        SAME_RESULT(i, result,
                    by_tool ? RESULT(dpt_tool_get_body_wrench, world, of.id, body, given)
                            : RESULT(dpt_body_get_wrench, world, body, given));
        if (of.no_out)
            continue;
        numbers_are_finite(out->force, 6, "a wrench on a body");
        for (int k = 0; k < 3 && result != DPT_OK; k++)
            HOLDS(out->force[k] == 0.0 && out->torque[k] == 0.0, "a wrench on an error");
    }
    expect(result, &of.codes);
    twins_agree(&of, 1);
}

static void force_report(void)
{
    struct question of;
    dpt_force_info now;
    if (!draw_question(&of))
        return;
    const uint32_t size = draw_size(sizeof now, sizeof now);
    dpt_result result = DPT_OK;
    if (!of.no_out)
        size_codes_of_output(size, sizeof now, 0, &of.codes);
    trace(&of, size);
    EACH_WORLD(of.scene, i)
    {
        void *out = output_sized(i, size);
        SAME_RESULT(
            i, result,
            RESULT(dpt_tool_get_force_info, world_or_null(of.scene, i, of.no_world), of.id, of.no_out ? NULL : out));
    }
    expect(result, &of.codes);
    twins_agree(&of, 1);
    if (result != DPT_OK || !output_read(0, size, sizeof now, 16, &now))
        return;
    report_must_hold(of.scene, of.tool, &now);
}

static const struct move moves[] = { { "hit", hit, 14 },          { "contacts", contacts, 8 },
                                     { "sweep", sweep, 6 },       { "strip", strip, 8 },
                                     { "wrench", wrench, 8 },     { "force report", force_report, 4 },
                                     { "loads", loads, 6 },       { "body wrench", body_wrench, 6 },
                                     { "channels", channels, 3 }, { NULL, NULL, 0 } };

const struct noun result_noun = { "result", NULL, NULL, moves };
