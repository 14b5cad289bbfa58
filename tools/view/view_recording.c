/* SPDX-License-Identifier: BSD-3-Clause */
#include "view/view_recording.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command_options.h"
#include "dynpoint/snapshot.h"
#include "platform/file.h"
#include "record/recording_file.h"
#include "record/replay_recording.h"
#include "scene/scene_list.h"
#include "scene/scene_record.h"
#include "scene/scene_trouble.h"
#include "view/view_scene.h"

#define FRAME_SECONDS (1.0 / 60.0)

/* Vertices that move go with ten frames a second, until they fill this much. */
#define VERTICES_EVERY 6u
#define VERTICES_BYTES ((uint64_t)256 << 20)
#define ALL_BYTES      ((uint64_t)1 << 30)
enum { TICKS_ROOM = 4096 };

/* The frames of a recording as they are made. */
struct filming {
    struct view_stream *stream;
    struct host_session *session;
    dpt_snapshot_def def;
    uint32_t vertices; /* of the scene */
    uint64_t vertices_sent;
    void *snapshot;
    size_t capacity;
    struct view_tick tick[TICKS_ROOM];
    uint32_t ticks;
    uint64_t number, ticks_lost, moves_before;
    int has_moved;
    double time, next_time;
    uint64_t missing;
};

/* Returns 0 if memory ran out. */
static int add_frame(struct filming *filming)
{
    size_t size;
    const int has_room = filming->vertices_sent < VERTICES_BYTES;
    const int is_due = filming->number % VERTICES_EVERY == 0;
    filming->def.max_vertices = filming->has_moved && has_room && is_due ? filming->vertices : 0;
    if (dpt_world_take_snapshot(filming->session->scene.stage.world, &filming->def, filming->snapshot,
                                filming->capacity, &size) != DPT_OK)
        return 0;
    if (filming->def.max_vertices) {
        filming->has_moved = 0;
        filming->vertices_sent += 12 * (uint64_t)filming->vertices;
    }
    const struct view_frame_header header = { .snapshot_bytes = (uint32_t)size,
                                              .ticks = filming->ticks,
                                              .number = filming->number++,
                                              .ticks_lost = filming->ticks_lost };
    const size_t bytes = view_frame_bytes(size, filming->ticks);
    unsigned char *frame = malloc(bytes);
    if (!frame)
        return 0;
    view_frame_put_header(&header, frame);
    memcpy(frame + VIEW_HEADER_BYTES, filming->snapshot, size);
    for (uint32_t i = 0; i < filming->ticks; i++)
        view_frame_put_tick(&filming->tick[i], frame + VIEW_HEADER_BYTES + size + (size_t)i * VIEW_TICK_BYTES);
    filming->ticks = 0;
    return view_stream_add(filming->stream, frame, bytes);
}

/* Feel what a record says, once more. Returns 0 if memory ran out. */
static int film_tick(struct filming *filming, const dpt_record *record)
{
    dpt_device_state state;
    dpt_wrench wrench = { { 0.0 }, { 0.0 } };
    struct scene *scene = &filming->session->scene;
    const uint64_t failed = filming->session->counts.trouble.failed;
    const dpt_loop_sample sample = sample_of_record(record, &state, &scene->device);
    const dpt_result result = host_session_feel(filming->session, &sample, &wrench);
    if (result != DPT_OK && filming->session->counts.trouble.failed == failed)
        return 1;
    filming->time += sample.dt;
    filming->has_moved |= scene->bodies.moves != filming->moves_before;
    filming->moves_before = scene->bodies.moves;
    struct view_tick tick = scene_picture_tick(scene, &sample, filming->time, 1e-9 * (double)record->took_ns);
    tick.late = (float)(1e-9 * (double)record->late_ns);
    view_tick_set_result(&tick, result);
    if (filming->ticks < TICKS_ROOM)
        filming->tick[filming->ticks++] = tick;
    else
        filming->ticks_lost++;
    if (filming->time < filming->next_time)
        return 1;
    filming->next_time += FRAME_SECONDS;
    if (filming->next_time < filming->time) /* a step was longer than a frame */
        filming->next_time = filming->time + FRAME_SECONDS;
    return add_frame(filming);
}

static int film(struct filming *filming, struct recording_file *recording, char *why, size_t room, int *is_wrong)
{
    dpt_record record;
    uint64_t next = 0, records = 0;
    for (;;) {
        const enum recording_item item = recording_next(recording, &record);
        if (item == RECORDING_END)
            snprintf(why, room, "The recording is whole: %" PRIu64 " records.", records);
        else if (item == RECORDING_CUT)
            snprintf(why, room, "The recording is cut off at byte %" PRIu64 ".", recording->byte);
        else if (item == RECORDING_DAMAGED)
            snprintf(why, room, "The recording is damaged at byte %" PRIu64 ".", recording->byte);
        if (item != RECORDING_RECORD)
            break;
        filming->missing += record.number - next;
        next = record.number + 1;
        records++;
        if (!(record.flags & DPT_RECORD_FLAG_FELT))
            continue;
        if (!film_tick(filming, &record))
            return complain("view", "memory ran out");
        if (filming->stream->bytes > ALL_BYTES) {
            snprintf(why, room, "The recording is longer; this is what fits into 1 GB.");
            break;
        }
    }
    char wrong[SCENE_TROUBLE_BYTES];
    size_t used = strlen(why);
    if (filming->missing)
        snprintf(why + used, room - used, " %" PRIu64 " records are missing in it.", filming->missing);
    *is_wrong = scene_trouble_text(&filming->session->counts.trouble, &filming->session->scene, wrong);
    used = strlen(why);
    if (*is_wrong)
        snprintf(why + used, room - used, " %s", wrong);
    if (*is_wrong)
        complain("view", "%s", wrong);
    if (filming->ticks && !add_frame(filming))
        return complain("view", "memory ran out");
    return 0;
}

/* A file, and none that could keep its reader waiting. */
static int is_there(const char *path)
{
    struct file_status status;
    return file_get_status(path, &status) == 0 && status.is_regular;
}

/* As replay does, the scene's file is taken where it was; its bytes are compared with the recording's. */
static int check_mesh(const struct view_recording_files *files, const struct scene_text *text)
{
    if (files->mesh || scene_listed(text->scene) || text->embedded || is_there(text->scene))
        return 0;
    return complain("view",
                    "%s: its scene is not where it was, so --mesh FILE is needed: it was '%s', of %" PRIu64
                    " bytes and the CRC-32 %08" PRIx64,
                    files->recording, text->scene, text->scene_bytes, text->scene_crc32);
}

static int check_tool(const struct view_recording_files *files, const struct scene_text *text)
{
    if (files->tool || !text->tool[0] || text->embedded || is_there(text->tool))
        return 0;
    return complain("view", "%s: its tool is not where it was, so --tool ARM.dpa is needed: it was '%s'",
                    files->recording, text->tool);
}

/* Returns 0, or 2 after a message. */
static int begin(struct filming *filming, const struct view_recording_files *files, const struct scene_text *text,
                 double rate)
{
    const struct scene_picture picture = { .title = files->recording,
                                           .mode = "recording",
                                           .device = text->device,
                                           .rate = rate,
                                           .force_max = text->force_max };
    size_t size = 0;
    void *scene = scene_picture_message(&filming->session->scene, &picture, &size);
    filming->vertices = scene_picture_vertices(&filming->session->scene);
    dpt_snapshot_def_init(&filming->def);
    filming->def.max_vertices = filming->vertices;
    filming->capacity = dpt_snapshot_bytes(filming->session->scene.stage.world, &filming->def);
    filming->snapshot = malloc(filming->capacity);
    if (!view_stream_add(filming->stream, scene, size) || !filming->snapshot)
        return complain("view", "memory ran out");
    return 0;
}

int view_recording(struct view_stream *stream, const struct view_recording_files *files, int *is_wrong)
{
    struct recording_file recording;
    struct host_session session = { .budget = 0 };
    struct scene_text *text = malloc(sizeof *text);
    dpt_host_error error = { .size = sizeof error };
    struct filming *filming = calloc(1, sizeof *filming);
    char why[256 + SCENE_TROUBLE_BYTES] = "";
    int status = recording_open(&recording, "view", files->recording);
    if (status == 0)
        status = text && filming
                     ? complain_of("view", scene_text_read(text, files->recording, recording.text, &error), &error)
                     : complain("view", "memory ran out");
    if (status == 0)
        status = check_mesh(files, text);
    if (status == 0)
        status = check_tool(files, text);
    if (status == 0)
        status = recording_session_open(&session, "view", files->recording, text, files->mesh, files->tool);
    if (status == 0) {
        filming->stream = stream;
        filming->session = &session;
        status = begin(filming, files, text, recording.header.rate);
    }
    if (status == 0)
        status = film(filming, &recording, why, sizeof why, is_wrong);
    if (status == 0 && !view_stream_add_end(stream, why))
        status = complain("view", "memory ran out");
    recording_close(&recording);
    scene_close(&session.scene);
    if (filming)
        free(filming->snapshot);
    free(filming);
    free(text);
    return status;
}
