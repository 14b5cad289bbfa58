/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint run: feel a mesh live, with any device. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command_options.h"
#include "cli/commands.h"
#include "cli/open_device.h"
#include "cli/scene_command.h"
#include "dynpoint/driver.h"
#include "dynpoint/identify.h"
#include "host/host_session.h"
#include "plan/plan_trace.h"
#include "record/plan_text.h"
#include "record/run_trace.h"
#include "run/run_puts.h"
#include "run/run_settings.h"
#include "run/run_status.h"
#include "scene/scene_record.h"
#include "view/run_view.h"

/* Deadlines that follow a device's samples come at most this much more often than its rate says. */
#define RATE_FACTOR_MAX (16.0 / 15.0)

/* The scene, and what is written and shown of its ticks. */
struct session {
    struct host_session host;
    char wrong[SCENE_TROUBLE_BYTES]; /* the text of what went wrong, after the run */
    struct scene_record recording;
    struct run_trace trace;
    struct run_view *view;
    struct run_view_report viewed;
    struct run_status status;
    double seconds, late; /* since it began, by the device's time; the most so far */
};

/* Hand the numbers of a tick over to the line on the terminal. */
static void tell_status(struct session *session, const dpt_loop_sample *sample, const dpt_wrench *wrench,
                        uint64_t contacts)
{
    const struct host_counts *counts = &session->host.counts;
    session->seconds += sample->dt;
    session->late = fmax(session->late, sample->late);
    run_status_tell(&session->status, &(struct run_status_tick){ .seconds = session->seconds,
                                                                 .force = sqrt(wrench->force[0] * wrench->force[0] +
                                                                               wrench->force[1] * wrench->force[1] +
                                                                               wrench->force[2] * wrench->force[2]),
                                                                 .depth = counts->depth_max,
                                                                 .late = session->late,
                                                                 .touches = counts->contacts > contacts });
}

static dpt_result feel(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    struct session *session = user;
    struct scene *scene = &session->host.scene;
    const uint64_t failed = session->host.counts.trouble.failed, contacts = session->host.counts.contacts;
    scene_record_begin(&session->recording);
    run_view_begin(session->view);
    const dpt_result result = host_session_feel(&session->host, sample, wrench);
    if (result == DPT_OK || session->host.counts.trouble.failed > failed)
        run_view_tick(session->view, sample, result);
    scene_record_tick(&session->recording, scene, sample, result, wrench);
    tell_status(session, sample, wrench, contacts);
    if (result == DPT_OK)
        run_trace_tick(&session->trace, &scene->stylus);
    return result;
}

static void idle(void *user, const dpt_loop_sample *sample)
{
    struct session *session = user;
    scene_record_idle(&session->recording, sample);
}

static int open_record(const struct run_settings *settings, struct session *session)
{
    if (!run_is_traced(settings))
        return 0;
    if (!session->host.scene.has_stylus)
        return complain("run", "--record needs the stylus, without tips: a trace has one segment; "
                               "a recording, F.dpr, may have any");
    return run_trace_open(&session->trace, settings->record);
}

/*
 * Allocate the whole record, because a tick must not allocate: for --ticks, or for the ticks of --for. By the clock
 * there is room for one second more, because the timer ends the run before that.
 */
static int allocate_record(struct session *session, const struct run_settings *settings, const dpt_device_info *info)
{
    const double rate = settings->rate > 0.0 ? settings->rate : info->rate;
    const double ticks = info->flags & DPT_DEVICE_FLAG_DETERMINISTIC
                             ? ceil(settings->seconds * info->rate)
                             : ceil((settings->seconds * RATE_FACTOR_MAX + 1.0) * rate);
    if (!settings->ticks && !(ticks <= RUN_TRACE_MAX))
        return complain("run", "--record: at most %d ticks; --for %g has %.0f", RUN_TRACE_MAX, settings->seconds,
                        ticks);
    return run_trace_allocate(&session->trace, settings->ticks ? settings->ticks : (uint64_t)ticks);
}

static void print_coupling_json(const struct session *session)
{
    const dpt_coupling *coupling = &session->host.coupling;
    const dpt_passivity_info seen = scene_passivity_info(&session->host.scene.passivity);
    printf(",\"stiffness\":%.17g,\"limit\":\"%s\",\"stable\":%.17g,\"delay\":%.17g,\"rotational_stiffness\":%.17g",
           coupling->stiffness, coupling_limit_word(coupling->limit), coupling->stable, coupling->delay,
           coupling->rotational_stiffness);
    if (session->host.scene.passivity.is_used)
        printf(",\"passivity\":{\"acted\":%" PRIu64
               ",\"taken\":%.17g,\"account_min\":%.17g,\"eps\":%.17g,\"body_work\":%.17g}",
               seen.acted, seen.taken, seen.account_min, seen.eps, seen.body_work);
}

static void print_coupling(const struct session *session)
{
    const dpt_coupling *coupling = &session->host.coupling;
    const dpt_passivity_info seen = scene_passivity_info(&session->host.scene.passivity);
    printf("  coupling %.4g N/m", coupling->stiffness);
    if (coupling->rotational_stiffness > 0.0)
        printf(", %.3g Nm/rad", coupling->rotational_stiffness);
    if (coupling->stable > 0.0)
        printf("; at the hand the device is stable up to %.4g", coupling->stable);
    putchar('\n');
    if (seen.acted)
        printf("  passivity: took %.3g mJ away on %" PRIu64 " ticks; least account %.3g mJ\n", 1e3 * seen.taken,
               seen.acted, 1e3 * seen.account_min);
    if (session->host.counts.clutched)
        printf("  the clutch was down on %" PRIu64 "\n", session->host.counts.clutched);
}

static void print_json(const struct session *session, const dpt_loop_stats *s, const dpt_device_counts *counts)
{
    const struct {
        const char *name;
        uint64_t value;
    } numbers[] = { { "ticks", s->ticks },
                    { "fresh", s->fresh },
                    { "stale", s->stale },
                    { "failed", s->failed },
                    { "not_ready", s->not_ready },
                    { "lost", s->lost },
                    { "skipped", s->skipped },
                    { "reordered", s->reordered },
                    { "sent", s->sent },
                    { "refused", s->refused },
                    { "missed", s->missed },
                    { "losses", s->losses },
                    { "stops", s->stops },
                    { "clamped", s->clamped },
                    { "slewed", s->slewed },
                    { "not_finite", s->not_finite },
                    { "recorded", session->recording.counts.written },
                    { "record_dropped", session->recording.counts.dropped },
                    { "record_lost", session->recording.counts.lost },
                    { "device_samples", counts->samples },
                    { "device_lost", counts->lost },
                    { "device_damaged", counts->damaged },
                    { "device_missed", counts->missed },
                    { "clutched", session->host.counts.clutched },
                    { "contacts", session->host.counts.contacts },
                    { "penetrating", session->host.counts.penetrating },
                    { "unknown", session->host.counts.unknown } };
    putchar('{');
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        printf("%s\"%s\":%" PRIu64, i ? "," : "", numbers[i].name, numbers[i].value);
    printf(",\"deepest\":%.17g,\"strongest\":%.17g", session->host.counts.depth_max, session->host.counts.force_max);
    if (session->host.scene.piercing)
        printf(",\"ruptures\":%" PRIu64 ",\"needle_depth\":%.17g", session->host.counts.ruptures,
               session->host.counts.needle_depth_max);
    print_coupling_json(session);
    run_puts_print(&session->host.counts.puts, 1);
    printf(",\"tip_error\":%.17g,\"tips_unproven\":%" PRIu64, scene_tip_error(&session->host.scene),
           session->host.scene.curved.unproven);
    run_physics_print(&session->host.scene, 1);
    printf(",\"spring_nodes\":%" PRIu64 ",\"spring_nodes_awake\":%" PRIu64, session->host.scene.bodies.nodes,
           session->host.scene.bodies.active);
    const struct {
        const char *name;
        const uint64_t *bins;
        double max;
    } times[] = { { "late", s->late, s->late_max }, { "took", s->took, s->took_max } };
    for (int i = 0; i < 2; i++)
        printf(",\"%s_us\":{\"median\":%.1f,\"p99\":%.1f,\"max\":%.1f}", times[i].name,
               1e6 * dpt_loop_quantile(times[i].bins, 0.5), 1e6 * dpt_loop_quantile(times[i].bins, 0.99),
               1e6 * times[i].max);
    printf(",\"held\":%" PRIu64 ",\"trouble\":\"%s\"", session->host.scene.bodies.held, session->wrong);
    run_view_print(&session->viewed, 1);
    printf(",\"real_time\":%s,\"locked\":%s,\"budget\":%" PRIu32 "}\n",
           s->notes & DPT_LOOP_NOTE_NO_PRIORITY ? "false" : "true", s->notes & DPT_LOOP_NOTE_NO_LOCK ? "false" : "true",
           session->host.budget);
}

static void print_times(const char *what, const uint64_t *bins, double max)
{
    printf("  %-28s %9.1f %9.1f %9.1f\n", what, 1e6 * dpt_loop_quantile(bins, 0.5), 1e6 * dpt_loop_quantile(bins, 0.99),
           1e6 * max);
}

static void print_report(const struct session *session, const dpt_loop_stats *s, const dpt_device_counts *counts)
{
    if (session->wrong[0])
        puts(session->wrong);
    printf("%" PRIu64 " ticks: %" PRIu64 " with a fresh sample, %" PRIu64 " without, %" PRIu64 " not ready, %" PRIu64
           " lost\n",
           s->ticks, s->fresh + s->failed - session->host.counts.trouble.failed, s->stale, s->not_ready, s->lost);
    if (session->host.counts.reasons) {
        fputs("  not ready:", stdout);
        for (uint32_t left = session->host.counts.reasons; left; left &= left - 1)
            printf(" %s", dpt_device_reason_name(left));
        putchar('\n');
    }
    printf("  in contact on %" PRIu64 ", deepest %.2f mm, strongest %.2f N before the guard\n",
           session->host.counts.contacts, 1e3 * session->host.counts.depth_max, session->host.counts.force_max);
    if (session->host.scene.piercing)
        printf("  the needle: %" PRIu64 " rupture%s, at most %.2f mm in\n", session->host.counts.ruptures,
               session->host.counts.ruptures == 1 ? "" : "s", 1e3 * session->host.counts.needle_depth_max);
    if (session->host.counts.unknown)
        printf("  unknown on %" PRIu64 ", with --budget %" PRIu32 "\n", session->host.counts.unknown,
               session->host.budget);
    run_puts_print(&session->host.counts.puts, 0);
    print_coupling(session);
    curved_tips_print_error(stdout, &session->host.scene.curved, scene_tip_error(&session->host.scene));
    run_physics_print(&session->host.scene, 0);
    if (session->host.scene.bodies.nodes)
        printf("  springs: %.1f %% of the nodes were awake\n",
               100.0 * (double)session->host.scene.bodies.active / (double)session->host.scene.bodies.nodes);
    run_view_print(&session->viewed, 0);
    printf("  guard: %" PRIu64 " clamped, %" PRIu64 " slewed, %" PRIu64 " stops\n", s->clamped, s->slewed, s->stops);
    printf("  device: %" PRIu64 " samples, %" PRIu64 " lost, %" PRIu64 " damaged, %" PRIu64 " commands missed\n",
           counts->samples, counts->lost, counts->damaged, counts->missed);
    if (session->host.scene.device.flags & DPT_DEVICE_FLAG_DETERMINISTIC) {
        puts("  by the device's own time, as fast as this machine can: no tick has a deadline");
        return;
    }
    printf("  %-28s %9s %9s %9s\n", "microseconds", "median", "99 %", "worst");
    print_times("late", s->late, s->late_max);
    print_times("a tick's work", s->took, s->took_max);
    printf("  %" PRIu64 " deadlines missed\n", s->missed);
    if (s->notes & DPT_LOOP_NOTE_NO_PRIORITY)
        puts("  without real-time priority, which was not permitted");
    if (s->notes & DPT_LOOP_NOTE_NO_LOCK)
        puts("  without locked memory, which was not permitted");
    if (s->notes & DPT_LOOP_NOTE_NO_CPU)
        puts("  on any processor: it could not be chosen");
    if (s->notes & DPT_LOOP_NOTE_NO_AWAKE)
        puts("  processors may have slept: to keep them awake was not permitted");
}

/* A user who runs sim without an end probably wants real time. */
static void hint_at_clock(const dpt_device *device, const dpt_device_info *info)
{
    if (info->flags & DPT_DEVICE_FLAG_DETERMINISTIC && !strcmp(device->driver->name, "sim"))
        complain("run", "sim: its time passes as fast as this machine can. By the clock, with a "
                        "hand: --device 'sim:?hand=press&live=1'; or give --ticks");
}

/* With --for and a device whose own time can be counted in ticks. */
static int is_by_own_time(const struct run_settings *settings, const dpt_device_info *info)
{
    return settings->seconds * info->rate < 0x1p53 && info->flags & DPT_DEVICE_FLAG_DETERMINISTIC;
}

/* What the device is, and how it was measured. Returns 0, or 2 after a message. */
static int know_device(dpt_device *device, const char *identified, dpt_device_info *info)
{
    dpt_device_error error = { .size = sizeof error };
    dpt_device_get_info(device, info);
    if (identified && dpt_device_dynamics_read(identified, info, &error) != DPT_OK)
        return complain("run", "%s", error.text);
    return 0;
}

/* The coupling that this device can hold, a world for it, and its guard. Returns 0, or 2 after a message. */
static int couple(struct session *session, const struct run_settings *settings, const dpt_device_info *info)
{
    const int is_recorded = settings->record && !run_is_traced(settings);
    const struct host_settings how = { .coupling = settings->coupling,
                                       .force_max = settings->force_max,
                                       .rate = settings->rate,
                                       .budget = settings->budget,
                                       .is_active = settings->is_active,
                                       .shows_contacts = settings->view.is_on || is_recorded };
    dpt_host_error error = { .size = sizeof error };
    const double rate = settings->rate > 0.0 ? settings->rate : info->rate;
    if (settings->plan_path && fabs(rate - settings->plan.asked.rate) > 1e-3 * rate)
        complain("run", "%s is for %g Hz, and the loop runs at %g: what it promises does not count",
                 settings->plan_path, settings->plan.asked.rate, rate);
    if (run_physics_check(&session->host.scene, info, is_recorded))
        return 2;
    const dpt_result result = host_session_couple(&session->host, &how, info, settings->scene.path, &error);
    if (error.text[0])
        complain("run", "%s", error.text);
    return result == DPT_OK ? 0 : 2;
}

/* The loop's def; `seconds` is when the clock ends the run. Returns 0, or 2 after a message. */
static int define_loop(struct session *session, const struct run_settings *settings, const dpt_device_info *info,
                       dpt_loop_def *def, double *seconds)
{
    dpt_loop_def_init(def);
    def->tick = feel;
    def->user = session;
    def->idle = idle;
    def->rate = settings->rate;
    def->reopen = (uint32_t)settings->reopen;
    def->cpu = settings->cpu == RUN_NO_NUMBER ? 0 : (uint32_t)settings->cpu + 1;
    def->awake = (uint32_t)settings->awake;
    if (run_is_traced(settings) && allocate_record(session, settings, info))
        return 2;
    def->ticks = run_is_traced(settings) ? session->trace.capacity : settings->ticks;
    *seconds = settings->seconds;
    if (!def->ticks && is_by_own_time(settings, info)) {
        def->ticks = (uint64_t)ceil(settings->seconds * info->rate);
        *seconds = HUGE_VAL;
    }
    return 0;
}

/* Returns 0, or 2 after a message. */
static int open_recording(struct session *session, const struct run_settings *settings)
{
    const struct scene *scene = &session->host.scene;
    const int waits = (scene->device.flags & DPT_DEVICE_FLAG_DETERMINISTIC) != 0;
    dpt_host_error error = { .size = sizeof error };
    struct scene_text *text = malloc(sizeof *text);
    if (!text)
        return complain("run", "memory ran out");
    host_session_text(&session->host, &settings->scene, settings->device, text);
    if (settings->plan_path)
        plan_text_note(text, &settings->plan.setting);
    const dpt_result result =
        scene_record_open(&session->recording, settings->record, scene, text, session->host.rate, waits, &error);
    free(text);
    return complain_of("run", result, &error);
}

/* Returns 0, or 2 after a message. */
static int close_recording(struct scene_record *recording)
{
    dpt_host_error error = { .size = sizeof error };
    const dpt_result result = scene_record_close(recording, &error);
    if (error.text[0])
        complain("run", "%s", error.text);
    return result == DPT_OK ? 0 : 2;
}

/* Run the loop beside its viewers, its recording and its physics. Returns 0, or 2 after a message. */
static int run_loop(struct session *session, const struct run_settings *settings, const struct scene_hand *hand,
                    dpt_loop *loop, double seconds, dpt_loop_stats *stats, dpt_result *result)
{
    dpt_host_error error = { .size = sizeof error };
    int status = run_view_open(&session->view, &settings->view, &session->host.scene, settings->scene.path, hand);
    if (status == 0 && settings->record && !run_is_traced(settings))
        status = open_recording(session, settings);
    if (status == 0)
        status = complain_of("run", host_session_start(&session->host, &error), &error);
    if (status == 0) {
        stop_watch(loop, seconds);
        run_status_open(&session->status);
        *result = dpt_loop_run(loop, stats);
        run_status_close(&session->status);
        stop_watch(NULL, HUGE_VAL);
    }
    host_session_stop(&session->host);
    run_view_close(session->view, *result == DPT_OK ? "The run ended." : dpt_result_text(*result), &session->viewed);
    return status;
}

static int serve(dpt_device *device, struct session *session, const struct run_settings *settings)
{
    dpt_host_error error = { .size = sizeof error };
    dpt_loop_def def;
    dpt_loop *loop;
    double seconds;
    dpt_loop_stats stats = { .size = sizeof stats };
    dpt_device_counts counts = { .size = sizeof counts };
    dpt_device_info info = { .size = sizeof info };
    if (know_device(device, settings->identified, &info))
        return 2;
    if (couple(session, settings, &info) || define_loop(session, settings, &info, &def, &seconds))
        return 2;
    const struct scene_hand hand = { .device = device,
                                     .name = settings->device,
                                     .rate = session->host.rate,
                                     .force_max = session->host.guard.force_max };
    if (!def.ticks)
        hint_at_clock(device, &info);
    def.guard = &session->host.guard;
    dpt_result result = dpt_loop_open(device, &def, &loop);
    if (result != DPT_OK)
        return complain("run", "%s", dpt_result_text(result));
    int status = run_loop(session, settings, &hand, loop, seconds, &stats, &result);
    dpt_loop_close(loop);
    const int closed = close_recording(&session->recording);
    if (status)
        return status;
    if ((status = closed) == 0 && settings->embeds)
        status = complain_of("run", host_embed_write(&settings->embed, settings->record, &error), &error);
    dpt_device_get_counts(device, &counts);
    const int is_wrong = scene_trouble_text(&session->host.counts.trouble, &session->host.scene, session->wrong);
    (settings->json ? print_json : print_report)(session, &stats, &counts);
    if (is_wrong)
        status = complain("run", "%s", session->wrong);
    if (result != DPT_OK)
        return complain("run", "%s", dpt_result_text(result));
    return run_is_traced(settings) && run_trace_write(&session->trace) ? 2 : status;
}

/* Returns 0, or 2 after a message. */
static int take_plan(struct scene *scene, const struct run_settings *settings)
{
    scene->planned = &settings->plan.setting.world;
    measure_setting_change(&settings->plan.setting, &scene->bodies);
    return plan_scene_check(&settings->plan, scene, settings->plan_path);
}

static int run(const struct run_settings *settings)
{
    struct session session = { .view = NULL };
    int status = open_scene(&session.host.scene, &settings->scene);
    if (status == 0 && settings->plan_path)
        status = take_plan(&session.host.scene, settings);
    if (status == 0)
        status = open_record(settings, &session);
    if (status == 0) {
        dpt_device *device;
        status = open_device("run", settings->device, &device);
        if (status == 0) {
            status = end_fault("run", settings->device, device);
            status = status ? status : serve(device, &session, settings);
            dpt_device_close(device);
        }
    }
    run_trace_close(&session.trace);
    scene_close(&session.host.scene);
    return status;
}

int command_run(int argc, char **argv)
{
    struct run_settings settings;
    dpt_host_error error = { .size = sizeof error };
    int status = run_settings_read(&settings, argc, argv);
    if (status < 0 && settings.embeds &&
        complain_of("run", host_embed_load(&settings.embed, &settings.scene, settings.record, &error), &error))
        status = 2;
    if (status < 0)
        status = run(&settings);
    host_embed_free(&settings.embed);
    plan_free(&settings.plan);
    scene_def_free(&settings.scene);
    return status;
}
