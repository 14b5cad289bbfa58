/* SPDX-License-Identifier: BSD-3-Clause */
/* Motions that are tried: what they meet, and that the world stays as it is. */
#include "fuzz/calls/trial_rules.h"

enum { FIRST = 0, REACHED = 2, ROOM_USUAL = 1 << 17 };

struct question {
    struct trial trial;
    uint32_t id, count, size;
    int no_world, no_first, no_reached, in_place;
    struct codes codes;
};

/* Mostly of the size of a gap; often less than the radius. */
static double draw_clearance(void)
{
    if (draw_one_in(30))
        return draw_odd_number();
    const double most = draw_one_in(4) ? 0.03 : 0.003;
    return draw_one_in(4) ? 0.0 : draw_in(-most, most);
}

static int draw_question(struct question *of)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return 0;
    *of = (struct question){ .trial.scene = scene, .id = draw_tool_id(scene) };
    of->trial.tool = scene_tool(scene, of->id);
    of->trial.clearance = draw_clearance();
    of->no_world = draw_one_in(60);
    of->no_first = draw_one_in(10);
    of->no_reached = draw_one_in(10);
    of->size = draw_size(sizeof(dpt_sweep), sizeof(dpt_sweep));
    may_fail(&of->codes, of->no_world, DPT_E_ARGUMENT);
    may_fail(&of->codes, !of->trial.tool, DPT_E_HANDLE);
    may_fail(&of->codes, !(fabs(of->trial.clearance) <= DPT_COORDINATE_MAX), DPT_E_FINITE);
    if (!of->no_first)
        size_codes_of_output(of->size, sizeof(dpt_sweep), 0, &of->codes);
    return 1;
}

static void draw_end(struct question *of)
{
    struct trial *trial = &of->trial;
    const struct model_tool *tool = trial->tool;
    trial->by_pose = draw_one_in(2);
    if (trial->by_pose) {
        trial->pose = draw_pose(tool ? &tool->pose : NULL);
        pose_codes(&trial->pose, &of->codes);
        return;
    }
    of->count = tool && !draw_one_in(30) ? tool->count : draw_below(4);
    of->in_place = !of->no_reached && draw_one_in(3);
    const int is_near = tool && draw_one_in(2);
    for (uint32_t i = 0; i < of->count; i++) {
        dpt_segment *segment = &trial->segment[i];
        *segment = draw_segment();
        for (int k = 0; is_near && i < tool->count && k < 3; k++) {
            double a[3], b[3];
            to_world(&tool->pose, tool->segment[i].a, a);
            to_world(&tool->pose, tool->segment[i].b, b);
            segment->a[k] = a[k] + draw_in(-0.02, 0.02);
            segment->b[k] = b[k] + draw_in(-0.02, 0.02);
        }
        segment_codes(segment, &of->codes);
    }
    may_fail(&of->codes, tool && of->count != tool->count, DPT_E_ARGUMENT);
}

/* In world i, into the slots of that world; with that clearance. */
static dpt_result ask(const struct question *of, int i, double clearance, int is_null)
{
    const struct trial *trial = &of->trial;
    const dpt_world *world = world_or_null(trial->scene, i, of->no_world);
    dpt_sweep *first = output_sized(FIRST + i, of->size);
    first = of->no_first ? NULL : first;
    if (trial->by_pose) {
        dpt_pose *reached = output_of(REACHED + i, sizeof *reached);
        return RESULT(dpt_tool_try_pose, world, of->id, is_null ? NULL : &trial->pose, clearance, first,
                      of->no_reached ? NULL : reached);
    }
    const size_t bytes = of->count * sizeof *trial->segment;
    dpt_segment *reached = output_of(REACHED + i, bytes);
    dpt_segment *given = output_of(OUTPUTS - 1, bytes);
    memcpy(given, trial->segment, bytes);
    if (of->in_place)
        given = memcpy(reached, trial->segment, bytes);
    const dpt_result result = RESULT(dpt_tool_try_segments, world, of->id, is_null ? NULL : given, of->count, clearance,
                                     first, of->no_reached ? NULL : reached);
    outputs_are_guarded(OUTPUTS - 1, 1);
    return result;
}

/* With a copy of the world's whole memory, now and then: not one byte of it may change. */
static dpt_result ask_and_compare(const struct question *of, int i, int is_null)
{
    const struct scene *scene = of->trial.scene;
    unsigned char *copy = NULL;
    if (draw_one_in(scene->room < ROOM_USUAL ? 4 : 40))
        copy = malloc(scene->room);
    if (copy)
        memcpy(copy, scene_block(scene, i), scene->room);
    const dpt_result result = ask(of, i, of->trial.clearance, is_null);
    HOLDS(!copy || !memcmp(copy, scene_block(scene, i), scene->room), "a trial changed the world");
    free(copy);
    return result;
}

static void nothing_was_written(const struct question *of)
{
    EACH_WORLD(of->trial.scene, i)
    {
        HOLDS(output_is_untouched(FIRST + i, sizeof of->size), "a sweep on an error");
        if (of->in_place && of->count)
            HOLDS(!memcmp(output_at(REACHED + i), of->trial.segment, of->count * sizeof *of->trial.segment),
                  "segments were changed on an error");
        else
            HOLDS(output_is_untouched(REACHED + i, 0), "a place on an error");
    }
}

/* Where each radius and the clearance come to less than nothing, less does not count. */
static void less_must_be_the_same(const struct question *of, const dpt_sweep *first)
{
    dpt_sweep less;
    met[MET_TRIED_AXIS]++;
    HOLDS(ask(of, 0, of->trial.clearance - draw_in(0.001, 10.0), 0) == DPT_OK, "less is refused");
    output_read(FIRST, of->size, sizeof less, offsetof(dpt_sweep, time), &less);
    HOLDS(!memcmp(first, &less, sizeof less), "status %u at %g of the axis, and %u at %g", first->status, first->time,
          less.status, less.time);
}

static void try_it(void)
{
    struct question of;
    dpt_result result = DPT_OK;
    dpt_sweep first;
    if (!draw_question(&of))
        return;
    draw_end(&of);
    const int is_null = !of.in_place && draw_one_in(60);
    may_fail(&of.codes, is_null, DPT_E_ARGUMENT);
    const struct scene *scene = of.trial.scene;
    call_with("scene %llu, id %llx, size %llu, %llu segments", (uint64_t)(scene - scenes), of.id, of.size, of.count);
    EACH_WORLD(scene, i)
    SAME_RESULT(i, result, ask_and_compare(&of, i, is_null));
    expect(result, &of.codes);
    outputs_are_guarded(FIRST, scene->world_count);
    outputs_are_guarded(REACHED, scene->world_count);
    if (scene->world_count == 2)
        outputs_agree(2);
    if (result != DPT_OK) {
        nothing_was_written(&of);
        return;
    }
    if (of.no_reached)
        HOLDS(output_is_untouched(REACHED, 0), "a place of nobody");
    else
        game_digest(output_at(REACHED), of.trial.by_pose ? sizeof(dpt_pose) : of.count * sizeof(dpt_segment));
    if (of.no_first)
        return;
    output_read(FIRST, of.size, sizeof first, offsetof(dpt_sweep, time), &first);
    const void *reached = of.no_reached ? NULL : output_at(REACHED);
    const dpt_pose *pose = of.trial.by_pose ? reached : NULL;
    const dpt_segment *segments = of.trial.by_pose ? NULL : reached;
    trial_must_hold(&of.trial, &first, pose, segments);
    if (draw_one_in(3))
        trial_must_be_true(&of.trial, &first, pose, segments);
    if (trial_is_of_axes(&of.trial) && of.trial.clearance > -1e5)
        less_must_be_the_same(&of, &first);
}

static const struct move moves[] = { { "try", try_it, 40 }, { NULL, NULL, 0 } };

const struct noun trial_noun = { "trial", NULL, NULL, moves };
