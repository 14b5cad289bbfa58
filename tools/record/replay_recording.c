/* SPDX-License-Identifier: BSD-3-Clause */
#include "record/replay_recording.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command_options.h"
#include "cli/force_check.h"
#include "cli/scene_command.h"
#include "measure/measure_setting.h"
#include "record/plan_text.h"
#include "record/recording_file.h"
#include "scene/scene_list.h"
#include "scene/scene_record.h"
#include "scene/scene_trouble.h"

static const char help[] =
    "usage: dynpoint replay FILE.dpr [SCENE.json|MESH.dpa|ARM.dpa] [--tool ARM.dpa] [--json]\n"
    "\n"
    "Makes the scene of a recording again, moves the tool as it was moved, and compares every\n"
    "answer with the recorded one, bit for bit: the wrench, the proxy, contact, distance, energy.\n"
    "Exit status 1 if one differs, or if records are missing or damaged: what follows those cannot\n"
    "be compared. A recording that is cut off is compared up to there.\n"
    "\n"
    "  SCENE.json, MESH.dpa, --tool   where the files of the scene are now; default: those that the\n"
    "                     recording carries, or where they were\n"
    "  --json             the summary as one JSON object on standard output\n";

/* Why the comparison ended. */
enum ending { WHOLE, CUT, DIFFERS, MISSING, DAMAGED };
static const char *const ending_words[] = { "whole", "cut", "differs", "missing", "damaged" };

struct comparison_of_records {
    const char *path;
    uint64_t records, ticks; /* that were read, and compared */
    enum ending ending;
    uint64_t byte;                    /* where it is cut or damaged */
    uint64_t first_missing, next;     /* the first record that is missing, and the next one */
    const struct record_field *field; /* the first that differs */
    uint64_t failed;                  /* ticks */
    char wrong[SCENE_TROUBLE_BYTES];  /* the text of what went wrong */
    dpt_record recorded, replayed;
};

/* Returns the first field that differs, or NULL. */
static const struct record_field *compare(const dpt_record *a, const dpt_record *b)
{
    for (size_t i = 0; i < record_field_count; i++)
        if (record_fields[i].is_answer && !record_field_is_same(&record_fields[i], a, b))
            return &record_fields[i];
    return NULL;
}

/* Replay one record. Returns 0 where it differs. */
static int replay_tick(struct host_session *session, struct comparison_of_records *compared)
{
    const struct scene *scene = &session->scene;
    dpt_device_state state;
    dpt_wrench wrench = { { 0.0 }, { 0.0 } };
    const dpt_loop_sample sample = sample_of_record(&compared->recorded, &state, &scene->device);
    const dpt_result result = host_session_feel(session, &sample, &wrench);
    compared->replayed = record_of_sample(&sample);
    record_answers(&compared->replayed, scene, result, &wrench);
    compared->field = compare(&compared->recorded, &compared->replayed);
    return !compared->field;
}

static enum ending replay_all(struct recording_file *recording, struct host_session *session,
                              struct comparison_of_records *compared)
{
    for (;;) {
        const enum recording_item item = recording_next(recording, &compared->recorded);
        compared->byte = recording->byte;
        if (item != RECORDING_RECORD)
            return item == RECORDING_END ? WHOLE : item == RECORDING_CUT ? CUT : DAMAGED;
        compared->first_missing = compared->records;
        compared->next = compared->recorded.number;
        if (compared->next != compared->records)
            return MISSING;
        compared->records++;
        if (!(compared->recorded.flags & DPT_RECORD_FLAG_FELT))
            continue;
        if (!replay_tick(session, compared))
            return DIFFERS;
        compared->ticks++;
    }
}

static void print_text(const struct comparison_of_records *c)
{
    if (c->wrong[0])
        puts(c->wrong);
    printf("%s: %" PRIu64 " ticks, all the same bits", c->path, c->ticks);
    switch (c->ending) {
    case WHOLE:
        break;
    case CUT:
        printf("; it is cut off at byte %" PRIu64, c->byte);
        break;
    case DIFFERS:
        printf("; then record %" PRIu64 " differs: %s was ", c->recorded.number, c->field->name);
        record_field_print(stdout, c->field, &c->recorded, 0);
        printf(" and is ");
        record_field_print(stdout, c->field, &c->replayed, 0);
        break;
    case MISSING:
        printf("; then %" PRIu64 " records are missing from number %" PRIu64 " on, and what follows cannot be compared",
               c->next - c->first_missing, c->first_missing);
        break;
    case DAMAGED:
        printf("; it is damaged at byte %" PRIu64 ", and what follows cannot be compared", c->byte);
        break;
    }
    putchar('\n');
}

static void print_json(const struct comparison_of_records *c)
{
    printf("{\"records\":%" PRIu64 ",\"ticks\":%" PRIu64 ",\"same\":%s,\"end\":\"%s\"", c->records, c->ticks,
           c->ending == DIFFERS ? "false" : "true", ending_words[c->ending]);
    if (c->ending == CUT || c->ending == DAMAGED)
        printf(",\"byte\":%" PRIu64, c->byte);
    if (c->ending == MISSING)
        printf(",\"missing_from\":%" PRIu64 ",\"missing\":%" PRIu64, c->first_missing, c->next - c->first_missing);
    if (c->ending == DIFFERS) {
        printf(",\"record\":%" PRIu64 ",\"field\":\"%s\",\"recorded\":", c->recorded.number, c->field->name);
        record_field_print(stdout, c->field, &c->recorded, 1);
        fputs(",\"replayed\":", stdout);
        record_field_print(stdout, c->field, &c->replayed, 1);
    }
    printf(",\"failed\":%" PRIu64 ",\"trouble\":\"%s\"}\n", c->failed, c->wrong);
}

static void note_version(const struct recording_file *recording, const char *path)
{
    const uint32_t version = recording->header.writer_version;
    if (version != dpt_version_number())
        fprintf(stderr,
                "%s: note: recorded by release %" PRIu32 ".%" PRIu32 ".%" PRIu32
                ", this is %s: other bits are no fault\n",
                path, version >> 16, version >> 8 & 255, version & 255, dpt_version());
}

int replay_recording(int argc, char **argv)
{
    const char *operand[2] = { NULL, NULL }, *tool = NULL;
    int json = 0;
    size_t operands;
    const struct option_def options[] = { { .name = "--tool", .text = &tool, .kind = VALUE_FILE },
                                          { .name = "--json", .flag = &json } };
    static const struct operand_def taken[] = { { .kind = VALUE_FILE }, { .kind = VALUE_FILE } };
    int status = parse_options(argc, argv, COMMAND_SYNTAX(options, help, taken), operand, 2, &operands);
    if (status >= 0)
        return status;
    struct recording_file recording;
    struct host_session session = { .budget = 0 };
    struct scene_text *text = malloc(sizeof *text);
    dpt_host_error error = { .size = sizeof error };
    struct comparison_of_records compared = { .path = operand[0] };
    status = recording_open(&recording, "replay", operand[0]);
    if (status == 0)
        status = text ? complain_of("replay", scene_text_read(text, operand[0], recording.text, &error), &error)
                      : complain("replay", "memory ran out");
    if (status == 0)
        status = recording_session_open(&session, "replay", operand[0], text, operands > 1 ? operand[1] : NULL, tool);
    if (status == 0) {
        note_version(&recording, operand[0]);
        compared.ending = replay_all(&recording, &session, &compared);
        compared.failed = session.counts.trouble.failed;
        const int is_wrong = scene_trouble_text(&session.counts.trouble, &session.scene, compared.wrong);
        (json ? print_json : print_text)(&compared);
        status = compared.ending == WHOLE || compared.ending == CUT ? 0 : 1;
        if (is_wrong)
            status = complain("replay", "%s: %s", operand[0], compared.wrong);
    }
    recording_close(&recording);
    scene_close(&session.scene);
    free(text);
    return status;
}

static int check_identity(const char *command, const char *path, const char *what, const struct file_identity *file,
                          uint64_t bytes, uint64_t crc32)
{
    if (file->bytes == bytes && file->crc32 == crc32)
        return 0;
    return complain(
        command, "%s: this is another %s than the recording's, which has %" PRIu64 " bytes and the CRC-32 %08" PRIx64,
        path, what, bytes, crc32);
}

void recording_scene_embedded(const struct scene_text *text, const char *scene_path, const char *tool_path,
                              int embedded[EMBED_FILES])
{
    embedded[EMBED_SCENE] = text->embedded && !scene_path && !scene_listed(text->scene);
    embedded[EMBED_TOOL] = text->embedded && !tool_path && text->tool[0];
}

/* Let what comes from the recording be the scene's. Returns 0, or 2 after a message. */
static int read_embedded(struct scene_def *def, struct recording_embed *embed, const char *path,
                         const struct scene_text *text, const int embedded[EMBED_FILES])
{
    if (!embedded[EMBED_SCENE] && !embedded[EMBED_TOOL])
        return 0;
    const int status = recording_embed_read(embed, def->command, path, text, embedded);
    const struct embedded_file *scene = &embed->file[EMBED_SCENE], *tool = &embed->file[EMBED_TOOL];
    if (status == 0 && embedded[EMBED_SCENE]) {
        def->path = path;
        def->scene_bytes = (struct scene_bytes){ scene->bytes, (size_t)scene->total };
    }
    if (status == 0 && embedded[EMBED_TOOL]) {
        def->tool = path;
        def->tool_bytes = (struct scene_bytes){ tool->bytes, (size_t)tool->total };
    }
    return status;
}

/* What a plan left, before the world is made of it. Returns 0, or 2 after a message. */
static int take_plan(struct scene *scene, const struct scene_text *text, const char *path,
                     struct measure_setting *setting)
{
    const uint64_t max = UINT32_MAX;
    if (text->sweep_budget > max)
        return complain(scene->command, "%s: its header has a sweep_budget that is none", path);
    if (!text->planned)
        return 0;
    if (text->plan_until > DPT_UNTIL_CONTACT || text->plan_integrator > 1 + DPT_INTEGRATOR_IMPLICIT ||
        text->plan_iterations > max || text->plan_max_contacts > max || text->plan_smooth_normals > 1 ||
        text->plan_sweep_budget > max || text->plan_strip_capacity > max || text->plan_rigid_low > max ||
        text->plan_rigid_high > max)
        return complain(scene->command, "%s: its header has a plan's setting that is none", path);
    *setting = plan_text_setting(text);
    measure_setting_change(setting, &scene->bodies);
    scene->planned = &setting->world;
    return 0;
}

int recording_session_open(struct host_session *session, const char *command, const char *path,
                           const struct scene_text *text, const char *scene_path, const char *tool_path)
{
    struct scene *scene = &session->scene;
    dpt_host_error error = { .size = sizeof error };
    struct recording_embed embed = { .room = 0 };
    int embedded[EMBED_FILES];
    struct measure_setting setting;
    const int has_own_friction = text->friction == SCENE_TEXT_OWN_FRICTION;
    struct scene_def def = { .command = command,
                             .path = scene_path ? scene_path : text->scene,
                             .tool = tool_path       ? tool_path
                                     : text->tool[0] ? text->tool
                                                     : NULL,
                             .origin = { text->origin_x, text->origin_y, text->origin_z },
                             .has_origin = 1,
                             .zoom = text->zoom,
                             .force_scale = text->force_scale,
                             .clutch = text->clutch < SCENE_TEXT_NO_CLUTCH ? (int)text->clutch : -1,
                             .length = text->length,
                             .radius = text->radius,
                             .tips = text->tips,
                             .jaw = text->jaw,
                             .piercing = text->piercing,
                             .physics = text->physics,
                             .force = { .stiffness = text->stiffness,
                                        .friction = has_own_friction ? NAN : text->friction,
                                        .damping = text->damping,
                                        .rotational_stiffness = text->rotational_stiffness } };
    recording_scene_embedded(text, scene_path, tool_path, embedded);
    int status = read_embedded(&def, &embed, path, text, embedded);
    if (status == 0)
        status = law_by_name(command, text->law, &def.force.law);
    if (status == 0)
        status = force_options_check(command, &def.force);
    if (status == 0 && def.force.law != DPT_LAW_PROXY && !tip_shapes_are_curved(&def.tips))
        status = complain(command, "%s: its header has tips, and another law than proxy", path);
    if (status == 0)
        status = read_scene_def(&def);
    if (status == 0)
        status = open_scene(scene, &def);
    recording_embed_free(&embed);
    if (status == 0)
        status = check_identity(command, def.path, "scene", &scene->file, text->scene_bytes, text->scene_crc32);
    if (status == 0)
        status = check_identity(command, def.tool ? def.tool : "", "tool", &scene->tool_file, text->tool_bytes,
                                text->tool_crc32);
    if (status == 0)
        status = take_plan(scene, text, path, &setting);
    if (status == 0)
        status = complain_of(command, host_session_restore(session, text, &error), &error);
    scene->planned = NULL;
    scene_def_free(&def);
    return status;
}
