/* SPDX-License-Identifier: BSD-3-Clause */
#include "dynpoint/host.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "base/sized.h"
#include "dynpoint/driver.h"
#include "dynpoint/identify.h"
#include "host/host_embed.h"
#include "host/host_inside.h"
#include "host/host_session.h"
#include "loop_line.h"
#include "platform/clock.h"
#include "scene/host_error.h"
#include "scene/host_file.h"
#include "scene/scene_record.h"

/* The device of a loop that is the caller's: it has the sample of this tick, and takes its wrench. */
struct outside {
    dpt_device device;
    dpt_device_info info;
    dpt_device_state state;
    dpt_wrench wrench;
};

struct dpt_host {
    struct host_session session;
    struct scene_def scene; /* what a scene file says stays with it */
    int has_scene;
    dpt_host_felt_fn *felt;
    void *user;
    struct scene_record record;
    struct host_embed embed;
    char *embedding;    /* path of the recording that will carry it; NULL: none */
    dpt_device *device; /* NULL: ticks are the caller's */
    dpt_loop *loop;
    struct outside outside;
    struct loop_line_def line_def;
    struct loop_line line;
    uint64_t began_ns; /* host_tick_began */
};

/* What texts call a scene that is the caller's. */
#define OWN_SCENE "dpt_host_def"

void dpt_host_def_defaults(dpt_host_def *def, size_t size)
{
    const dpt_host_def defaults = { .law = DPT_NONE,
                                    .clutch = DPT_NONE,
                                    .origin = { NAN, NAN, NAN },
                                    .gain_margin = 1.5,
                                    .friction = NAN,
                                    .zoom = NAN,
                                    .force_scale = NAN,
                                    .length = NAN,
                                    .radius = NAN,
                                    .force_max = NAN };
    sized_defaults(def, size, &defaults, sizeof defaults);
}

const char *dpt_host_get_scene(uint32_t index)
{
    return scene_listed_name(index);
}

static void outside_info(const dpt_device *device, dpt_device_info *info)
{
    const struct outside *outside = (const void *)device;
    *info = outside->info;
}

static dpt_result outside_read(dpt_device *device, dpt_device_state *state)
{
    const struct outside *outside = (const void *)device;
    *state = outside->state;
    return state->status == DPT_DEVICE_STATUS_LOST ? DPT_E_LOST : DPT_OK;
}

static dpt_result outside_write(dpt_device *device, const dpt_wrench *wrench)
{
    struct outside *outside = (void *)device;
    outside->wrench = *wrench;
    return DPT_OK;
}

static dpt_result outside_clear(dpt_device *device)
{
    (void)device;
    return DPT_OK;
}

static const dpt_driver outside_driver = { .size = sizeof outside_driver,
                                           .version = DPT_DRIVER_VERSION,
                                           .name = "outside",
                                           .info = outside_info,
                                           .read = outside_read,
                                           .write = outside_write,
                                           .clear = outside_clear };

/* NAN is not given. */
static int is_within(double value, double min, double max)
{
    return isnan(value) || (value >= min && value <= max);
}

static int is_segment(const dpt_segment *segment)
{
    int is_good = segment->radius >= 0.0 && segment->radius <= DPT_COORDINATE_MAX;
    for (int k = 0; k < 3; k++)
        is_good &= fabs(segment->a[k]) <= DPT_COORDINATE_MAX && fabs(segment->b[k]) <= DPT_COORDINATE_MAX;
    return is_good;
}

/* What is the caller's own, in place of what a scene has. */
static dpt_result check_own(const dpt_host_def *def, dpt_host_error *error)
{
    if (!def->scene == !def->body_count)
        return host_refuse(error, DPT_E_ARGUMENT, "a scene is needed, or bodies, and not both");
    if (!def->bodies != !def->body_count || def->body_count > DPT_ARM_BODIES_MAX)
        return host_refuse(error, DPT_E_ARGUMENT, "bodies must be 1 to %d", DPT_ARM_BODIES_MAX);
    if (!def->segments != !def->segment_count || def->segment_count > DPT_ARM_SEGMENTS_MAX)
        return host_refuse(error, DPT_E_ARGUMENT, "segments must be 1 to %d", DPT_ARM_SEGMENTS_MAX);
    for (uint32_t i = 0; i < def->segment_count; i++)
        if (!is_segment(&def->segments[i]))
            return host_refuse(error, DPT_E_ARGUMENT, "segments[%u]: it is not within 1e6 m", (unsigned)i);
    if (def->segment_count && (def->tool || !isnan(def->length) || !isnan(def->radius)))
        return host_refuse(error, DPT_E_ARGUMENT,
                           "segments are in place of a tool, and of a stylus with length and radius");
    if (def->record && (def->body_count || def->segment_count))
        return host_refuse(error, DPT_E_UNSUPPORTED,
                           "record: a replay makes a scene by its name; bodies and segments have none");
    return !(def->flags & DPT_HOST_FLAG_EMBED) || def->record
               ? DPT_OK
               : host_refuse(error, DPT_E_ARGUMENT, "DPT_HOST_FLAG_EMBED needs record");
}

/* What no later call looks at. */
static dpt_result check_def(const dpt_host_def *def, dpt_host_error *error)
{
    const uint32_t flags = DPT_HOST_FLAG_UNSTABLE | DPT_HOST_FLAG_ACTIVE | DPT_HOST_FLAG_CONTACTS |
                           DPT_HOST_FLAG_REOPEN | DPT_HOST_FLAG_AWAKE | DPT_HOST_FLAG_EMBED;
    const struct {
        const char *name;
        double value, min, max;
        int may_be_nan;
    } numbers[] = { { "stiffness", def->stiffness, 0.0, 1e9, 0 },
                    { "gain_margin", def->gain_margin, 1.0, 100.0, 0 },
                    { "friction", def->friction, 0.0, 10.0, 1 },
                    { "damping", def->damping, 0.0, 1e9, 0 },
                    { "force_scale", def->force_scale, 1e-3, 1000.0, 1 },
                    { "length", def->length, 0.0, 10.0, 1 },
                    { "radius", def->radius, 0.0, 1.0, 1 },
                    { "gravity", def->gravity, 0.0, 1000.0, 0 },
                    { "force_max", def->force_max, 0.0, 1000.0, 1 } };
    DPT_TRY(check_own(def, error));
    if (def->flags & ~flags || (def->law != DPT_NONE && def->law > DPT_LAW_PROXY) ||
        (def->clutch != DPT_NONE && def->clutch > 31))
        return host_refuse(error, DPT_E_ARGUMENT, "flags, law or clutch are none of those that there are");
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (!is_within(numbers[i].value, numbers[i].min, numbers[i].max) ||
            (isnan(numbers[i].value) && !numbers[i].may_be_nan))
            return host_refuse(error, DPT_E_ARGUMENT, "%s must be %g to %g", numbers[i].name, numbers[i].min,
                               numbers[i].max);
    if (!isnan(def->zoom) && !(def->zoom > 0.0 && def->zoom <= 1000.0))
        return host_refuse(error, DPT_E_ARGUMENT, "zoom must be above 0, at most 1000");
    if (def->rate != 0.0 && !(def->rate >= 1.0 && def->rate <= 1e5))
        return host_refuse(error, DPT_E_ARGUMENT, "rate must be 1 to 100000");
    for (int k = 0; k < 3; k++)
        if (!is_within(def->origin[k], -DPT_COORDINATE_MAX, DPT_COORDINATE_MAX))
            return host_refuse(error, DPT_E_ARGUMENT, "origin must be within 1e6 m");
    return DPT_OK;
}

static dpt_result read_tips(struct scene_def *def, const dpt_host_def *from, dpt_host_error *error)
{
    struct tip_shapes *tips = &def->tips;
    for (; from->tips && from->tips[tips->count]; tips->count++) {
        if (tips->count == TIP_SHAPES_MAX)
            return host_refuse(error, DPT_E_ARGUMENT, "tips must be %d at most", TIP_SHAPES_MAX);
        DPT_TRY(tip_shape_parse(&tips->shape[tips->count], "tips", from->tips[tips->count], error));
    }
    return from->jaw ? jaw_motion_read(&def->jaw, "jaw", from->jaw, error) : DPT_OK;
}

static dpt_result load_embedded(dpt_host *host, const dpt_host_def *from, dpt_host_error *error)
{
    const size_t size = strlen(from->record) + 1;
    host->embedding = malloc(size);
    if (!host->embedding)
        return host_refuse(error, DPT_E_MEMORY, "memory ran out");
    memcpy(host->embedding, from->record, size);
    return host_embed_load(&host->embed, &host->scene, from->record, error);
}

static dpt_result open_scene_of(dpt_host *host, const dpt_host_def *from, dpt_host_error *error)
{
    struct scene_def *def = &host->scene;
    scene_def_init(def, "");
    def->path = from->scene ? from->scene : OWN_SCENE;
    def->bodies = from->bodies;
    def->body_count = from->body_count;
    def->gravity = from->gravity;
    def->segments = from->segments;
    def->segment_count = from->segment_count;
    def->tool = from->tool;
    memcpy(def->origin, from->origin, sizeof def->origin);
    def->has_origin = !isnan(from->origin[0]) && !isnan(from->origin[1]) && !isnan(from->origin[2]);
    def->zoom = from->zoom;
    def->force_scale = from->force_scale;
    def->clutch = from->clutch == DPT_NONE ? -1 : (int)from->clutch;
    def->length = from->length;
    def->radius = from->radius;
    def->physics = from->physics;
    def->force.friction = from->friction;
    def->force.damping = from->damping;
    DPT_TRY(read_tips(def, from, error));
    DPT_TRY(scene_def_read(def, error));
    DPT_TRY(scene_def_complete(def, from->law == DPT_NONE ? NULL : &from->law, error));
    if ((def->force.friction > 0.0 || def->force.damping > 0.0) && def->force.law != DPT_LAW_PROXY)
        return host_refuse(error, DPT_E_ARGUMENT, "friction and damping are for the law proxy");
    if (from->flags & DPT_HOST_FLAG_EMBED)
        DPT_TRY(load_embedded(host, from, error));
    host->has_scene = 1;
    return scene_open(&host->session.scene, def, error);
}

/* NULL: there is none, and the loop is the caller's. */
static const char *device_name(const dpt_host *host, const dpt_host_def *def)
{
    if (def->device || def->info)
        return def->device;
    return host->scene.file ? host->scene.file->device : NULL;
}

/* The device, or that of the caller's loop, and what is known of it. */
static dpt_result open_device_of(dpt_host *host, const dpt_host_def *def, dpt_device_info *info, dpt_host_error *error)
{
    const char *name = device_name(host, def);
    dpt_device_error why = { .size = sizeof why };
    info->size = sizeof *info;
    if (def->info && !def->device) {
        DPT_TRY(sized_read(def->info, sizeof *info, info, sizeof *info));
    } else if (name) {
        if (dpt_device_open(name, &host->device, &why) != DPT_OK)
            return host_refuse(error, why.code, "%s: %s", name, why.text);
        if (why.text[0])
            host_note(error, "%s: %s", name, why.text);
        DPT_TRY(host_device_end_fault(host->device, name, error));
        DPT_TRY(dpt_device_get_info(host->device, info));
    } else {
        return host_refuse(error, DPT_E_ARGUMENT, "a device is needed, or the info of one");
    }
    if (def->identified && dpt_device_dynamics_read(def->identified, info, &why) != DPT_OK)
        return host_refuse(error, why.code, "%s", why.text);
    return DPT_OK;
}

static dpt_result feel(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    dpt_host *host = user;
    scene_record_begin(&host->record);
    if (host->felt)
        host->began_ns = clock_now();
    const dpt_result result = host_session_feel(&host->session, sample, wrench);
    scene_record_tick(&host->record, &host->session.scene, sample, result, wrench);
    if (host->felt)
        host->felt(host->user, host, sample, result, wrench);
    return result;
}

static void idle(void *user, const dpt_loop_sample *sample)
{
    dpt_host *host = user;
    scene_record_idle(&host->record, sample);
}

static dpt_result open_recording(dpt_host *host, const dpt_host_def *def, const char *device, dpt_host_error *error)
{
    const struct scene *scene = &host->session.scene;
    const int waits = (scene->device.flags & DPT_DEVICE_FLAG_DETERMINISTIC) != 0;
    if (scene_def_has_file(&host->scene, def->record) || host_file_is_same(def->identified, def->record) ||
        (device && host_file_is_of_device(def->record, device)))
        return host_refuse(error, DPT_E_ARGUMENT, "%s: it is read here, so no recording may be written there",
                           def->record);
    struct scene_text *text = malloc(sizeof *text);
    if (!text)
        return host_refuse(error, DPT_E_MEMORY, "memory ran out");
    host_session_text(&host->session, &host->scene, device ? device : "", text);
    const dpt_result result =
        scene_record_open(&host->record, def->record, scene, text, host->session.rate, waits, error);
    free(text);
    return result;
}

static dpt_result open_loop(dpt_host *host, const dpt_host_def *from)
{
    dpt_loop_def def;
    dpt_loop_def_init(&def);
    def.tick = feel;
    def.idle = idle;
    def.user = host;
    def.rate = from->rate;
    def.ticks = from->ticks;
    def.guard = &host->session.guard;
    def.cpu = from->cpu;
    def.reopen = (from->flags & DPT_HOST_FLAG_REOPEN) != 0;
    def.awake = (from->flags & DPT_HOST_FLAG_AWAKE) != 0;
    return dpt_loop_open(host->device, &def, &host->loop);
}

/* The caller's loop: one line, whose device is outside. */
static dpt_result open_line(dpt_host *host, const dpt_device_info *info)
{
    struct outside *outside = &host->outside;
    outside->device.driver = &outside_driver;
    outside->info = *info;
    outside->state.size = sizeof outside->state;
    DPT_TRY(loop_line_open(&host->line_def, &outside->device, &host->session.guard,
                           (uint64_t)(1e9 / host->session.rate + 0.5)));
    loop_line_begin(&host->line, &host->line_def);
    return DPT_OK;
}

static dpt_result open_host(dpt_host *host, const dpt_host_def *def, dpt_host_error *error)
{
    dpt_device_info info;
    const struct host_settings settings = { .coupling = { .stiffness = def->stiffness > 0.0 ? def->stiffness : NAN,
                                                          .gain_margin = def->gain_margin,
                                                          .is_unstable = (def->flags & DPT_HOST_FLAG_UNSTABLE) &&
                                                                         def->stiffness > 0.0 },
                                            .force_max = def->force_max,
                                            .rate = def->rate,
                                            .budget = def->budget ? def->budget : HOST_BUDGET_BY_RATE,
                                            .is_active = (def->flags & DPT_HOST_FLAG_ACTIVE) != 0,
                                            .shows_contacts = (def->flags & DPT_HOST_FLAG_CONTACTS) != 0 };
    host->felt = def->felt;
    host->user = def->user;
    DPT_TRY(check_def(def, error));
    DPT_TRY(open_scene_of(host, def, error));
    DPT_TRY(open_device_of(host, def, &info, error));
    if (def->rate == 0.0 && !(info.rate >= 1.0 && info.rate <= 1e5))
        return host_refuse(error, DPT_E_ARGUMENT, "the device's rate must be 1 to 100000 Hz");
    DPT_TRY(host_session_couple(&host->session, &settings, &info, host->scene.path, error));
    DPT_TRY(host->device ? open_loop(host, def) : open_line(host, &info));
    return def->record ? open_recording(host, def, device_name(host, def), error) : DPT_OK;
}

dpt_result dpt_host_open(const dpt_host_def *given, dpt_host **out, dpt_host_error *error)
{
    dpt_host_def def;
    dpt_host_error own = { .size = sizeof own };
    if (out)
        *out = NULL;
    if (error)
        DPT_TRY(sized_check(error, sizeof *error, 0));
    dpt_host_def_init(&def);
    dpt_result result =
        given && out ? sized_read(given, SIZED_FIRST(dpt_host_def, tips), &def, sizeof def) : DPT_E_ARGUMENT;
    dpt_host *host = result == DPT_OK ? calloc(1, sizeof *host) : NULL;
    if (result == DPT_OK)
        result = host ? open_host(host, &def, &own) : DPT_E_MEMORY;
    if (result != DPT_OK && !own.code)
        host_refuse(&own, result, "%s", dpt_result_text(result));
    if (result == DPT_OK)
        *out = host;
    else
        dpt_host_close(host, NULL);
    if (error)
        sized_write(error, sized_of(error), &own, sizeof own);
    return result;
}

dpt_result dpt_host_close(dpt_host *host, dpt_host_error *error)
{
    dpt_host_error own = { .size = sizeof own };
    const dpt_result room = error ? sized_check(error, sizeof *error, 0) : DPT_OK;
    const int is_recorded = host && host->record.recorder;
    dpt_result result = host ? scene_record_close(&host->record, &own) : DPT_OK;
    if (result == DPT_OK && is_recorded && host->embedding)
        result = host_embed_write(&host->embed, host->embedding, &own);
    if (error && room == DPT_OK)
        sized_write(error, sized_of(error), &own, sizeof own);
    if (!host)
        return room;
    dpt_loop_close(host->loop);
    dpt_device_close(host->device);
    if (host->has_scene)
        scene_close(&host->session.scene);
    scene_def_free(&host->scene);
    host_embed_free(&host->embed);
    free(host->embedding);
    free(host);
    return result == DPT_OK ? room : result;
}

dpt_result dpt_host_run(dpt_host *host, dpt_loop_stats *stats, dpt_host_error *error)
{
    dpt_host_error own = { .size = sizeof own };
    if (error)
        DPT_TRY(sized_check(error, sizeof *error, 0));
    dpt_result result = host && host->loop ? host_session_start(&host->session, &own)
                                           : host_refuse(&own, DPT_E_ARGUMENT, "the host has no device");
    if (result == DPT_OK) {
        result = dpt_loop_run(host->loop, stats);
        host_session_stop(&host->session);
        if (result != DPT_OK)
            host_refuse(&own, result, "%s", dpt_result_text(result));
    }
    if (error)
        sized_write(error, sized_of(error), &own, sizeof own);
    return result;
}

void dpt_host_stop(dpt_host *host)
{
    if (host)
        dpt_loop_stop(host->loop);
}

dpt_result dpt_host_tick(dpt_host *host, const dpt_device_state *state, uint64_t now_ns, dpt_wrench *wrench)
{
    static const dpt_wrench zero;
    dpt_wrench command = zero;
    dpt_result result = DPT_OK;
    if (wrench)
        *wrench = zero;
    if (!host || !state || !wrench || host->device)
        return DPT_E_ARGUMENT;
    struct loop_line *line = &host->line;
    struct outside *outside = &host->outside;
    outside->wrench = zero;
    outside->state.fresh = 0;
    const dpt_result taken = sized_read(state, sizeof *state, &outside->state, sizeof outside->state);
    loop_line_read(line);
    loop_line_check_loss(line, now_ns, 0);
    if (loop_line_has_sample(line, 1.0 / host->session.rate))
        result = feel(host, &line->sample, &command);
    else
        idle(host, &line->sample);
    loop_line_count(line, result == DPT_OK);
    loop_line_send(line, &command, now_ns, now_ns);
    *wrench = outside->wrench;
    return taken == DPT_OK ? result : taken;
}

/* Add to `text` that the device had stopped itself, and why. */
static void add_stop(const struct host_counts *counts, uint64_t ticks, char *text, size_t room)
{
    size_t used = strlen(text);
    const char *between = " (";
    if (!counts->stopped)
        return;
    used += (size_t)snprintf(text + used, room - used,
                             "%sthe device had stopped itself on %" PRIu64 " of %" PRIu64 " ticks", used ? "; " : "",
                             counts->stopped, ticks);
    for (uint32_t left = counts->reasons; left && used < room; left &= left - 1, between = ", ")
        used += (size_t)snprintf(text + used, room - used, "%s%s", between, dpt_device_reason_name(left));
    if (used < room)
        snprintf(text + used, room - used, "%s, and gave no force", counts->reasons ? ")" : "");
}

dpt_result dpt_host_get_info(const dpt_host *host, dpt_host_info *out)
{
    dpt_host_info info = { .size = sizeof info };
    if (!out)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(out, sizeof *out, 0));
    if (host) {
        const struct host_session *session = &host->session;
        const struct host_counts *counts = &session->counts;
        const dpt_passivity_info passivity = scene_passivity_info(&session->scene.passivity);
        info.limit = session->coupling.limit;
        info.budget = session->budget;
        info.reasons = counts->reasons;
        info.stiffness = session->coupling.stiffness;
        info.rotational_stiffness = session->coupling.rotational_stiffness;
        info.stable = session->coupling.stable;
        info.rate = session->rate;
        info.ticks = session->scene.ticks;
        info.failed = counts->trouble.failed;
        info.held = session->scene.bodies.held;
        info.clutched = counts->clutched;
        info.contacts = counts->contacts;
        info.penetrating = counts->penetrating;
        info.unknown = counts->unknown;
        info.put = counts->puts.squeezed + counts->puts.turned;
        info.inside = counts->puts.inside;
        info.limited = passivity.acted;
        info.taken = passivity.taken;
        info.account_min = passivity.account_min;
        info.depth_max = counts->depth_max;
        info.force_max = counts->force_max;
        scene_trouble_text(&counts->trouble, &session->scene, info.trouble);
        add_stop(counts, session->scene.ticks, info.trouble, sizeof info.trouble);
    }
    sized_write(out, sized_of(out), &info, sizeof info);
    return host ? DPT_OK : DPT_E_ARGUMENT;
}

dpt_world *dpt_host_get_world(const dpt_host *host)
{
    return host ? host->session.scene.stage.world : NULL;
}

const struct scene *host_scene(const dpt_host *host)
{
    return &host->session.scene;
}

struct scene_hand host_hand(const dpt_host *host)
{
    return (struct scene_hand){ .device = host->device,
                                .rate = host->session.rate,
                                .force_max = host->session.guard.force_max };
}

uint64_t host_tick_began(const dpt_host *host)
{
    return host->began_ns;
}

dpt_tool dpt_host_get_tool(const dpt_host *host)
{
    return host ? host->session.scene.stage.tool : 0;
}

dpt_body dpt_host_get_body(const dpt_host *host, uint32_t index)
{
    const struct scene_bodies *bodies = host ? &host->session.scene.bodies : NULL;
    return bodies && index < bodies->count ? bodies->body[index].id : 0;
}
