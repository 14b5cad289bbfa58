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
#include "plan/plan_trace.h"
#include "record/recording_embed.h"
#include "record/run_record.h"
#include "run/run_puts.h"
#include "run/run_settings.h"
#include "host/scene_trouble.h"
#include "view/run_view.h"

/* Deadlines that follow a device's samples come at most this much more often than its rate says. */
#define RATE_FACTOR_MAX (16.0 / 15.0)

/*
 * The default budget in units of work a second (docs/drivers.md has the time of a unit), and its minimum a tick: with
 * less, a tool at rest may stay undecided.
 */
#define BUDGET_RATE 3e6
#define BUDGET_MIN  200.0

/* What a tick needs, and what it counts. */
struct session {
    struct scene scene;
    uint64_t contacts, penetrating, unknown, clutched;
    struct scene_trouble trouble;
    char wrong[SCENE_TROUBLE_BYTES]; /* its text, after the run */
    struct run_puts puts;
    dpt_coupling coupling;
    uint32_t budget;
    uint32_t reasons; /* why the device was not ready */
    double depth_max, force_peak;
    struct run_record recording;
    struct run_trace trace;
    struct run_view *view;
    struct run_view_report viewed;
};

static dpt_result feel(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    struct session *session = user;
    dpt_hit hit = DPT_HIT_INIT;
    double square = 0.0;
    run_record_begin(&session->recording);
    run_view_begin(session->view);
    dpt_result result = scene_feel(&session->scene, sample, wrench);
    if (scene_trouble_note(&session->trouble, &session->scene, sample, result) || result == DPT_OK)
        run_view_tick(session->view, &session->scene, sample, result);
    run_record_tick(&session->recording, &session->scene, sample, result, wrench);
    session->clutched += (uint64_t)session->scene.is_clutched;
    if (result != DPT_OK)
        return result;
    run_trace_tick(&session->trace, &session->scene.stylus);
    run_puts_tick(&session->puts, &session->scene);
    scene_get_hit(&session->scene, &hit);
    session->reasons |= sample->state->reasons;
    session->contacts += hit.contact != DPT_CONTACT_SEPARATED;
    session->penetrating += hit.contact == DPT_CONTACT_PENETRATING;
    session->unknown += hit.contact == DPT_CONTACT_UNKNOWN;
    for (int k = 0; k < 3; k++)
        square += wrench->force[k] * wrench->force[k];
    const double depth = scene_depth(&session->scene, sqrt(square) / session->scene.force_scale, hit.depth);
    session->depth_max = fmax(session->depth_max, depth);
    session->force_peak = fmax(session->force_peak, sqrt(square));
    return DPT_OK;
}

static void idle(void *user, const dpt_loop_sample *sample)
{
    struct session *session = user;
    run_record_idle(&session->recording, sample);
}

static int open_record(const struct run_settings *settings, struct session *session)
{
    if (!run_is_traced(settings))
        return 0;
    if (!session->scene.has_stylus)
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
    const dpt_coupling *coupling = &session->coupling;
    const dpt_passivity_info seen = scene_passivity_info(&session->scene.passivity);
    printf(",\"stiffness\":%.17g,\"limit\":\"%s\",\"stable\":%.17g,\"delay\":%.17g,\"rotational_stiffness\":%.17g",
           coupling->stiffness, coupling_limit_word(coupling->limit), coupling->stable, coupling->delay,
           coupling->rotational_stiffness);
    if (session->scene.passivity.is_used)
        printf(",\"passivity\":{\"acted\":%" PRIu64
               ",\"taken\":%.17g,\"account_min\":%.17g,\"eps\":%.17g,\"body_work\":%.17g}",
               seen.acted, seen.taken, seen.account_min, seen.eps, seen.body_work);
}

static void print_coupling(const struct session *session)
{
    const dpt_coupling *coupling = &session->coupling;
    const dpt_passivity_info seen = scene_passivity_info(&session->scene.passivity);
    printf("  coupling %.4g N/m", coupling->stiffness);
    if (coupling->rotational_stiffness > 0.0)
        printf(", %.3g Nm/rad", coupling->rotational_stiffness);
    if (coupling->stable > 0.0)
        printf("; at the hand the device is stable up to %.4g", coupling->stable);
    putchar('\n');
    if (seen.acted)
        printf("  passivity: took %.3g mJ away on %" PRIu64 " ticks; least account %.3g mJ\n", 1e3 * seen.taken,
               seen.acted, 1e3 * seen.account_min);
    if (session->clutched)
        printf("  the clutch was down on %" PRIu64 "\n", session->clutched);
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
                    { "clutched", session->clutched },
                    { "contacts", session->contacts },
                    { "penetrating", session->penetrating },
                    { "unknown", session->unknown } };
    putchar('{');
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        printf("%s\"%s\":%" PRIu64, i ? "," : "", numbers[i].name, numbers[i].value);
    printf(",\"deepest\":%.17g,\"strongest\":%.17g", session->depth_max, session->force_peak);
    print_coupling_json(session);
    run_puts_print(&session->puts, 1);
    printf(",\"tip_error\":%.17g,\"tips_unproven\":%" PRIu64, scene_tip_error(&session->scene),
           session->scene.curved.unproven);
    run_physics_print(&session->scene, 1);
    printf(",\"spring_nodes\":%" PRIu64 ",\"spring_nodes_awake\":%" PRIu64, session->scene.bodies.nodes,
           session->scene.bodies.active);
    const struct {
        const char *name;
        const uint64_t *bins;
        double max;
    } times[] = { { "late", s->late, s->late_max }, { "took", s->took, s->took_max } };
    for (int i = 0; i < 2; i++)
        printf(",\"%s_us\":{\"median\":%.1f,\"p99\":%.1f,\"max\":%.1f}", times[i].name,
               1e6 * dpt_loop_quantile(times[i].bins, 0.5), 1e6 * dpt_loop_quantile(times[i].bins, 0.99),
               1e6 * times[i].max);
    printf(",\"held\":%" PRIu64 ",\"trouble\":\"%s\"", session->scene.bodies.held, session->wrong);
    run_view_print(&session->viewed, 1);
    printf(",\"real_time\":%s,\"locked\":%s,\"budget\":%" PRIu32 "}\n",
           s->notes & DPT_LOOP_NOTE_NO_PRIORITY ? "false" : "true", s->notes & DPT_LOOP_NOTE_NO_LOCK ? "false" : "true",
           session->budget);
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
           s->ticks, s->fresh + s->failed - session->trouble.failed, s->stale, s->not_ready, s->lost);
    if (session->reasons) {
        fputs("  not ready:", stdout);
        for (uint32_t left = session->reasons; left; left &= left - 1)
            printf(" %s", dpt_device_reason_name(left));
        putchar('\n');
    }
    printf("  in contact on %" PRIu64 ", deepest %.2f mm, strongest %.2f N before the guard\n", session->contacts,
           1e3 * session->depth_max, session->force_peak);
    if (session->unknown)
        printf("  unknown on %" PRIu64 ", with --budget %" PRIu32 "\n", session->unknown, session->budget);
    run_puts_print(&session->puts, 0);
    print_coupling(session);
    curved_tips_print_error(stdout, &session->scene.curved, scene_tip_error(&session->scene));
    run_physics_print(&session->scene, 0);
    if (session->scene.bodies.nodes)
        printf("  springs: %.1f %% of the nodes were awake\n",
               100.0 * (double)session->scene.bodies.active / (double)session->scene.bodies.nodes);
    run_view_print(&session->viewed, 0);
    printf("  guard: %" PRIu64 " clamped, %" PRIu64 " slewed, %" PRIu64 " stops\n", s->clamped, s->slewed, s->stops);
    printf("  device: %" PRIu64 " samples, %" PRIu64 " lost, %" PRIu64 " damaged, %" PRIu64 " commands missed\n",
           counts->samples, counts->lost, counts->damaged, counts->missed);
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

/* The controller stands before the guard, and knows what that will let through. */
static void observe(struct session *session, const dpt_device_info *info, const dpt_guard_def *guard)
{
    dpt_passivity_def def;
    dpt_passivity_def_init(&def);
    def.damping = info->damping;
    def.spin_damping = info->spin_damping;
    def.force_max = fmin(guard->force_max, info->force_max);
    def.torque_max = fmin(guard->torque_max, info->torque_max);
    def.force_slew = guard->force_slew;
    def.torque_slew = guard->torque_slew;
    def.delay = info->delay;
    scene_passivity_begin(&session->scene.passivity, &def);
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

/* As stiff as the device can hold; says why where that is less than was asked for. Returns 0, or 2 after a message. */
static int choose_coupling(struct scene *scene, const dpt_device_info *info, const struct coupling_options *options,
                           dpt_coupling *coupling)
{
    dpt_host_error error = { .size = sizeof error };
    const dpt_result result = host_coupling_choose(scene, info, options, coupling, &error);
    if (error.text[0])
        complain("run", "%s", error.text);
    return result == DPT_OK ? 0 : 2;
}

/* Returns 0, or 2 after a message. */
static int check_step(const struct scene *scene, const char *path, double rate)
{
    dpt_host_error error = { .size = sizeof error };
    const dpt_result result =
        scene_bodies_check_step(&scene->bodies, path, run_physics_step(scene, rate), &error);
    return complain_of("run", result, &error);
}

/* The coupling that this device can hold, and a world for it. Returns 0, or 2 after a message. */
static int couple(struct session *session, const struct run_settings *settings, const dpt_device_info *info,
                  double rate)
{
    struct scene *scene = &session->scene;
    struct coupling_options coupling = settings->coupling;
    coupling.rate = rate;
    coupling.loop_delay = info->flags & DPT_DEVICE_FLAG_DETERMINISTIC ? 0.0 : HOST_LOOP_DELAY_PERIODS / rate;
    coupling.loop_delay += run_physics_delay(scene);
    session->budget = settings->budget == RUN_BUDGET_BY_RATE ? (uint32_t)fmax(BUDGET_RATE / rate, BUDGET_MIN)
                                                             : (uint32_t)settings->budget;
    if (settings->plan_path && fabs(rate - settings->plan.asked.rate) > 1e-3 * rate)
        complain("run", "%s is for %g Hz, and the loop runs at %g: what it promises does not count",
                 settings->plan_path, settings->plan.asked.rate, rate);
    const int is_recorded = settings->record && !run_is_traced(settings);
    scene->shows_contacts = settings->view.is_on || is_recorded || scene->force.law != DPT_LAW_PROXY;
    return run_physics_check(scene, info, is_recorded) ||
                   choose_coupling(scene, info, &coupling, &session->coupling) ||
                   make_scene_world(scene, info, session->budget) || check_step(scene, settings->scene.path, rate)
               ? 2
               : 0;
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
    if (settings->record && !def->ticks && is_by_own_time(settings, info)) {
        def->ticks = (uint64_t)ceil(settings->seconds * info->rate);
        *seconds = HUGE_VAL;
    }
    return 0;
}

/* Run the loop beside its viewers, its recording and its physics. Returns 0, or 2 after a message. */
static int run_loop(struct session *session, const struct run_settings *settings, const struct scene_hand *hand,
                    dpt_loop *loop, double seconds, dpt_loop_stats *stats, dpt_result *result)
{
    int status = run_view_open(&session->view, &settings->view, &session->scene, settings->scene.path, hand);
    if (status == 0 && settings->record && !run_is_traced(settings))
        status = run_record_open(&session->recording, settings->record, &session->scene, &settings->scene,
                                 settings->plan_path ? &settings->plan.setting : NULL, hand, session->budget);
    if (status == 0)
        status = run_physics_start(&session->scene, hand->rate);
    if (status == 0) {
        stop_watch(loop, seconds);
        *result = dpt_loop_run(loop, stats);
        stop_watch(NULL, HUGE_VAL);
    }
    scene_physics_stop(session->scene.physics);
    run_view_close(session->view, *result == DPT_OK ? "The run ended." : dpt_result_text(*result), &session->viewed);
    return status;
}

static int serve(dpt_device *device, struct session *session, const struct run_settings *settings)
{
    dpt_loop_def def;
    dpt_guard_def guard;
    dpt_loop *loop;
    double seconds;
    dpt_loop_stats stats = { .size = sizeof stats };
    dpt_device_counts counts = { .size = sizeof counts };
    dpt_device_info info = { .size = sizeof info };
    if (know_device(device, settings->identified, &info))
        return 2;
    struct scene_hand hand = { .device = device, .name = settings->device };
    hand.rate = settings->rate > 0.0 ? settings->rate : info.rate;
    if (couple(session, settings, &info, hand.rate) || define_loop(session, settings, &info, &def, &seconds))
        return 2;
    if (!def.ticks)
        hint_at_clock(device, &info);
    dpt_guard_def_init(&guard);
    guard.hold = fmax(guard.hold, 3.0 / hand.rate);
    if (!isnan(settings->force_max))
        guard.force_max = settings->force_max;
    hand.force_max = guard.force_max;
    def.guard = &guard;
    if (!settings->is_active)
        observe(session, &info, &guard);
    dpt_result result = dpt_loop_open(device, &def, &loop);
    if (result != DPT_OK)
        return complain("run", "%s", dpt_result_text(result));
    int status = run_loop(session, settings, &hand, loop, seconds, &stats, &result);
    dpt_loop_close(loop);
    const int closed = run_record_close(&session->recording);
    if (status)
        return status;
    if ((status = closed) == 0 && settings->embeds)
        status = recording_embed_write(&settings->embed, settings->record);
    dpt_device_get_counts(device, &counts);
    const int is_wrong = scene_trouble_text(&session->trouble, &session->scene, session->wrong);
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
    struct session session = { .contacts = 0 };
    int status = open_scene(&session.scene, &settings->scene);
    if (status == 0 && settings->plan_path)
        status = take_plan(&session.scene, settings);
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
    scene_close(&session.scene);
    return status;
}

int command_run(int argc, char **argv)
{
    struct run_settings settings;
    int status = run_settings_read(&settings, argc, argv);
    if (status < 0 && settings.embeds && recording_embed_load(&settings.embed, &settings.scene, settings.record))
        status = 2;
    if (status < 0)
        status = run(&settings);
    recording_embed_free(&settings.embed);
    plan_free(&settings.plan);
    scene_def_free(&settings.scene);
    return status;
}
