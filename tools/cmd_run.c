/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint run: feel a mesh live, with any device. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "command_options.h"
#include "commands.h"
#include "dynpoint/driver.h"
#include "dynpoint/identify.h"
#include "open_device.h"
#include "recording_embed.h"
#include "run_coupling.h"
#include "run_physics.h"
#include "run_record.h"
#include "run_trace.h"
#include "run_view.h"
#include "scene.h"
#include "stop.h"

static const char help[] =
    "usage: dynpoint run SCENE|SCENE.json|MESH.dpa|ARM.dpa --device NAME [options]\n"
    "\n"
    "Feel a scene by name (membrane, cloth, laparoscopy, liver, soft-liver, tori), a scene file\n"
    "(docs/scene.md), a mesh, or the scene of an arm, with a haptic device: DRIVER or\n"
    "DRIVER:WHERE, as sim or serial:/dev/ttyACM0. The tool is a stylus, a capsule from the\n"
    "device's point along its z axis, or that of an arm, or of the file. What a file says of tool\n"
    "and device, an option overrides. Ends on an interrupt, after --for or --ticks, or when the\n"
    "device is lost; always with zero force. Then says how it went.\n"
    "\n"
    "  --device NAME    which one; default the scene file's\n"
    "  --at X,Y,Z       where the device's origin lies in the mesh's frame, m; default: 5 mm above "
    "the\n"
    "                   middle of the top of its box, y being up. Of an arm's scene, whose z is "
    "up, in the\n"
    "                   root's frame; default: where the tool is in the middle of the joints' "
    "limits. A\n"
    "                   device that is the arm needs neither this nor --zoom: its joints tell\n"
    "  --tool ARM.dpa   the tool is that of an arm\n"
    "  --zoom Z         metres of the mesh for one of the hand; default 1\n"
    "  --force-scale S  newtons at the hand for one of the mesh; default 1. The hand feels S Z "
    "times the "
    "stiffness\n"
    "  --clutch N       while button N is down, from 0, the tool stands still and gives no force: "
    "move "
    "the hand\n"
    "                   to a better place\n"
    "  --length L       of the stylus, m of the mesh; default the scene's, or 0.1\n"
    "  --radius R       of it; default the scene's, or 0.002\n"
    "  --law LAW        of the force: proxy (default) pulls to where the tool would be if it went "
    "through\n"
    "                   nothing; bed: along the tool and at its ends; point: at the deepest point\n"
    "  --stiffness K    of the force, N/m, at most what the device can hold; default just that\n"
    "  --gain-margin G  how much stiffer the loop could be before it shakes; default 1.5\n"
    "  --unstable       take --stiffness even if the device cannot hold it\n"
    "  --active         do not take away force where the scene gives the hand energy\n"
    "  --friction MU    of all bodies, with a proxy; default the scene's, or 0\n"
    "  --damping B      of the proxy's spring, Ns/m; default 0\n"
    "  --identified F   the device's dynamics are those of a file that device identify wrote\n"
    "  --force-max F    N; default the guard's, 5, or the device's if that is less\n"
    "  --rate HZ        of the loop; default the device's\n"
    "  --cpu N          the loop runs on this processor alone, from 0\n"
    "  --awake          keep processors from deep sleep while it runs; needs the right to do so\n"
    "  --budget N       at most N units of work a tick, 0: unlimited; what is not decided then is\n"
    "                   unknown, without force; default 3000 at 1 kHz, in proportion to the "
    "period,\n"
    "                   so that a tick keeps within one\n"
    "  --physics HZ     what gives way is stepped in a thread of its own, 1 to 5000 times a "
    "second;\n"
    "                   default in each tick. With a device that has a time of its own, by that\n"
    "  --for S          seconds of the clock\n"
    "  --ticks N        or so many ticks\n"
    "  --reopen         while the device is lost, try once a second to open it again\n"
    "  --record F.dpr   every tick: what the device told, what was asked and what acted, contact,\n"
    "                   proxy, energy. Written while it lasts, for dynpoint record and replay. "
    "With\n"
    "                   --for, a device with a time of its own, as sim, runs for S of that\n"
    "  --embed          the recording carries MESH.dpa or ARM.dpa, and --tool: it needs no other "
    "file\n"
    "  --record F.csv   only how the tool moved, a trace; needs --ticks or --for\n"
    "  --view           show it in a browser: prints the address of a page on this machine\n"
    "  --open           and open it there\n"
    "  --port N         of the page; default a free one\n"
    "  --address A      serve the page on this address instead, to other machines, unencrypted\n"
    "  --control        a simulated hand stands still until the page moves it\n"
    "  --json           what is said at the end as one JSON object\n";

/* Deadlines that follow a device's samples come at most this much more often than its rate says. */
#define RATE_FACTOR_MAX (16.0 / 15.0)

/* From a sample to its command, by the clock: the deadline's phase behind the sample, and the tick's own time. */
#define LOOP_DELAY_PERIODS 0.25

#define NO_NUMBER UINT64_MAX

/*
 * The default budget in units of work a second (docs/drivers.md has the time of a unit), and its minimum a tick: with
 * less, a tool at rest may stay undecided.
 */
#define BUDGET_RATE    3e6
#define BUDGET_MIN     200.0
#define BUDGET_BY_RATE UINT64_MAX

struct run_settings {
    struct scene_def scene;
    const char *device, *record, *identified;
    struct coupling_options coupling;
    double force_max, rate, seconds; /* force_max NAN, rate 0: not given */
    uint64_t ticks, budget;          /* BUDGET_BY_RATE: not given */
    uint64_t clutch, cpu;            /* NO_NUMBER: not given */
    struct run_view_options view;
    struct recording_embed embed;
    int json, reopen, is_active, awake, embeds;
};

/* What a tick needs, and what it counts. */
struct session {
    struct scene scene;
    uint64_t contacts, penetrating, unknown, clutched;
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
    if (result == DPT_OK)
        run_view_tick(session->view, &session->scene, sample);
    run_record_tick(&session->recording, &session->scene, sample, result, wrench);
    session->clutched += (uint64_t)session->scene.is_clutched;
    if (result != DPT_OK)
        return result;
    run_trace_tick(&session->trace, &session->scene.stylus);
    dpt_tool_get_hit(session->scene.world, session->scene.tool, &hit);
    session->reasons |= sample->state->reasons;
    session->contacts += hit.contact != DPT_CONTACT_SEPARATED;
    session->penetrating += hit.contact == DPT_CONTACT_PENETRATING;
    session->unknown += hit.contact == DPT_CONTACT_UNKNOWN;
    for (int k = 0; k < 3; k++)
        square += wrench->force[k] * wrench->force[k];
    const double depth =
        scene_depth(&session->scene, sqrt(square) / session->scene.force_scale, hit.depth);
    session->depth_max = fmax(session->depth_max, depth);
    session->force_peak = fmax(session->force_peak, sqrt(square));
    return DPT_OK;
}

static void idle(void *user, const dpt_loop_sample *sample)
{
    struct session *session = user;
    run_record_idle(&session->recording, sample);
}

static int is_traced(const struct run_settings *settings)
{
    return settings->record && is_trace_name(settings->record);
}

static int open_record(const struct run_settings *settings, struct session *session)
{
    if (!is_traced(settings))
        return 0;
    if (!session->scene.has_stylus)
        return complain(
            "run",
            "--record needs the stylus: a trace has one segment; a recording, F.dpr, may have any");
    return run_trace_open(&session->trace, settings->record);
}

/*
 * Allocate the whole record, because a tick must not allocate: for --ticks, or for the ticks of --for. By the clock
 * there is room for one second more, because the timer ends the run before that.
 */
static int allocate_record(struct session *session, const struct run_settings *settings,
                           const dpt_device_info *info)
{
    const double rate = settings->rate > 0.0 ? settings->rate : info->rate;
    const double ticks = info->flags & DPT_DEVICE_FLAG_DETERMINISTIC
                             ? ceil(settings->seconds * info->rate)
                             : ceil((settings->seconds * RATE_FACTOR_MAX + 1.0) * rate);
    if (!settings->ticks && !(ticks <= RUN_TRACE_MAX))
        return complain("run", "--record: at most %d ticks; --for %g has %.0f", RUN_TRACE_MAX,
                        settings->seconds, ticks);
    return run_trace_allocate(&session->trace, settings->ticks ? settings->ticks : (uint64_t)ticks);
}

static void print_coupling_json(const struct session *session)
{
    const dpt_coupling *coupling = &session->coupling;
    const dpt_passivity_info seen = scene_passivity_info(&session->scene.passivity);
    printf(",\"stiffness\":%.17g,\"limit\":\"%s\",\"stable\":%.17g,\"delay\":%.17g",
           coupling->stiffness, coupling_limit_word(coupling->limit), coupling->stable,
           coupling->delay);
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
    if (coupling->stable > 0.0)
        printf("; at the hand the device is stable up to %.4g", coupling->stable);
    putchar('\n');
    if (seen.acted)
        printf("  passivity: took %.3g mJ away on %" PRIu64 " ticks; least account %.3g mJ\n",
               1e3 * seen.taken, seen.acted, 1e3 * seen.account_min);
    if (session->clutched)
        printf("  the clutch was down on %" PRIu64 "\n", session->clutched);
}

static void print_json(const struct session *session, const dpt_loop_stats *s,
                       const dpt_device_counts *counts)
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
    run_physics_print(&session->scene, 1);
    printf(",\"spring_nodes\":%" PRIu64 ",\"spring_nodes_awake\":%" PRIu64,
           session->scene.bodies.nodes, session->scene.bodies.active);
    const struct {
        const char *name;
        const uint64_t *bins;
        double max;
    } times[] = { { "late", s->late, s->late_max }, { "took", s->took, s->took_max } };
    for (int i = 0; i < 2; i++)
        printf(",\"%s_us\":{\"median\":%.1f,\"p99\":%.1f,\"max\":%.1f}", times[i].name,
               1e6 * dpt_loop_quantile(times[i].bins, 0.5),
               1e6 * dpt_loop_quantile(times[i].bins, 0.99), 1e6 * times[i].max);
    run_view_print(&session->viewed, 1);
    printf(",\"real_time\":%s,\"locked\":%s,\"budget\":%" PRIu32 "}\n",
           s->notes & DPT_LOOP_NOTE_NO_PRIORITY ? "false" : "true",
           s->notes & DPT_LOOP_NOTE_NO_LOCK ? "false" : "true", session->budget);
}

static void print_times(const char *what, const uint64_t *bins, double max)
{
    printf("  %-28s %9.1f %9.1f %9.1f\n", what, 1e6 * dpt_loop_quantile(bins, 0.5),
           1e6 * dpt_loop_quantile(bins, 0.99), 1e6 * max);
}

static void print_report(const struct session *session, const dpt_loop_stats *s,
                         const dpt_device_counts *counts)
{
    printf("%" PRIu64 " ticks: %" PRIu64 " with a fresh sample, %" PRIu64 " without, %" PRIu64
           " not ready, %" PRIu64 " lost\n",
           s->ticks, s->fresh + s->failed, s->stale, s->not_ready, s->lost);
    if (session->reasons) {
        fputs("  not ready:", stdout);
        for (uint32_t left = session->reasons; left; left &= left - 1)
            printf(" %s", dpt_device_reason_name(left));
        putchar('\n');
    }
    printf("  in contact on %" PRIu64 ", deepest %.2f mm, strongest %.2f N before the guard\n",
           session->contacts, 1e3 * session->depth_max, session->force_peak);
    if (session->unknown)
        printf("  unknown on %" PRIu64 ", with --budget %" PRIu32 "\n", session->unknown,
               session->budget);
    print_coupling(session);
    run_physics_print(&session->scene, 0);
    if (session->scene.bodies.nodes)
        printf("  springs: %.1f %% of the nodes were awake\n",
               100.0 * (double)session->scene.bodies.active / (double)session->scene.bodies.nodes);
    run_view_print(&session->viewed, 0);
    printf("  guard: %" PRIu64 " clamped, %" PRIu64 " slewed, %" PRIu64 " stops\n", s->clamped,
           s->slewed, s->stops);
    printf("  device: %" PRIu64 " samples, %" PRIu64 " lost, %" PRIu64 " damaged, %" PRIu64
           " commands missed\n",
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
static void observe(struct session *session, const dpt_device_info *info,
                    const dpt_guard_def *guard)
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

static int serve(dpt_device *device, struct session *session, const struct run_settings *settings)
{
    dpt_loop_def def;
    dpt_guard_def guard;
    dpt_loop *loop;
    dpt_loop_stats stats = { .size = sizeof stats };
    dpt_device_counts counts = { .size = sizeof counts };
    dpt_device_info info = { .size = sizeof info };
    dpt_device_get_info(device, &info);
    if (settings->identified) {
        dpt_device_error error = { .size = sizeof error };
        if (dpt_device_dynamics_read(settings->identified, &info, &error) != DPT_OK)
            return complain("run", "%s", error.text);
    }
    const double rate = settings->rate > 0.0 ? settings->rate : info.rate;
    session->budget = settings->budget == BUDGET_BY_RATE
                          ? (uint32_t)fmax(BUDGET_RATE / rate, BUDGET_MIN)
                          : (uint32_t)settings->budget;
    struct coupling_options coupling = settings->coupling;
    coupling.rate = rate;
    coupling.loop_delay =
        info.flags & DPT_DEVICE_FLAG_DETERMINISTIC ? 0.0 : LOOP_DELAY_PERIODS / rate;
    coupling.loop_delay += run_physics_delay(&session->scene);
    if (run_physics_check(&session->scene, &info, settings->record && !is_traced(settings)) ||
        run_coupling_choose(&session->scene, &info, &coupling, &session->coupling) ||
        scene_make_world(&session->scene, &info, session->budget) ||
        scene_bodies_check_step(&session->scene.bodies, "run", settings->scene.path,
                                run_physics_step(&session->scene, rate)))
        return 2;
    dpt_loop_def_init(&def);
    def.tick = feel;
    def.user = session;
    def.idle = idle;
    def.rate = settings->rate;
    def.reopen = (uint32_t)settings->reopen;
    def.cpu = settings->cpu == NO_NUMBER ? 0 : (uint32_t)settings->cpu + 1;
    def.awake = (uint32_t)settings->awake;
    if (is_traced(settings) && allocate_record(session, settings, &info))
        return 2;
    def.ticks = is_traced(settings) ? session->trace.capacity : settings->ticks;
    double seconds = settings->seconds;
    if (settings->record && !def.ticks && is_by_own_time(settings, &info)) {
        def.ticks = (uint64_t)ceil(settings->seconds * info.rate);
        seconds = HUGE_VAL;
    }
    if (!def.ticks)
        hint_at_clock(device, &info);
    dpt_guard_def_init(&guard);
    guard.hold = fmax(guard.hold, 3.0 / rate);
    if (!isnan(settings->force_max))
        guard.force_max = settings->force_max;
    def.guard = &guard;
    if (!settings->is_active)
        observe(session, &info, &guard);
    dpt_result result = dpt_loop_create(device, &def, &loop);
    if (result != DPT_OK)
        return complain("run", "%s", dpt_result_text(result));
    int status =
        run_view_open(&session->view, &settings->view, &session->scene, settings->scene.path,
                      device, settings->device, rate, guard.force_max);
    if (status == 0 && settings->record && !is_traced(settings))
        status = run_record_open(&session->recording, settings->record, &session->scene,
                                 &settings->scene, settings->device, rate, guard.force_max,
                                 session->budget);
    if (status == 0)
        status = run_physics_start(&session->scene, rate);
    if (status == 0) {
        stop_watch(loop, seconds);
        result = dpt_loop_run(loop, &stats);
        stop_watch(NULL, HUGE_VAL);
    }
    scene_physics_stop(session->scene.physics);
    run_view_close(session->view, result == DPT_OK ? "The run ended." : dpt_result_text(result),
                   &session->viewed);
    dpt_loop_free(loop);
    const int closed = run_record_close(&session->recording);
    if (status)
        return status;
    if ((status = closed) == 0 && settings->embeds)
        status = recording_embed_write(&settings->embed, settings->record);
    dpt_device_get_counts(device, &counts);
    (settings->json ? print_json : print_report)(session, &stats, &counts);
    if (result != DPT_OK)
        return complain("run", "%s", dpt_result_text(result));
    return is_traced(settings) ? run_trace_write(&session->trace) : status;
}

/* Check the record against all inputs. The device's name contains files, too. */
static int check_record(const struct run_settings *settings)
{
    const char *const inputs[] = { settings->identified, NULL };
    if (!strcmp(settings->record, "-"))
        return complain("run",
                        "--record needs a file: what is said at the end is on standard output");
    if (scene_def_check_output(&settings->scene, settings->record) ||
        output_check("run", settings->record, inputs))
        return 2;
    return device_output_check("run", settings->record, settings->device);
}

static int read_settings(int argc, char **argv, struct run_settings *settings)
{
    const char *law = NULL;
    size_t operands = 0;
    const struct option_def options[] = {
        { .name = "--device", .text = &settings->device },
        { .name = "--at", .text = &settings->scene.origin },
        { .name = "--tool", .text = &settings->scene.tool },
        { .name = "--identified", .text = &settings->identified },
        { .name = "--zoom", .number = &settings->scene.zoom },
        { .name = "--length", .number = &settings->scene.length },
        { .name = "--radius", .number = &settings->scene.radius },
        { .name = "--law", .text = &law },
        { .name = "--stiffness", .number = &settings->coupling.stiffness },
        { .name = "--gain-margin", .number = &settings->coupling.gain_margin },
        { .name = "--unstable", .flag = &settings->coupling.is_unstable },
        { .name = "--active", .flag = &settings->is_active },
        { .name = "--force-scale", .number = &settings->scene.force_scale },
        { .name = "--clutch", .count = &settings->clutch },
        { .name = "--friction", .number = &settings->scene.force.friction },
        { .name = "--damping", .number = &settings->scene.force.damping },
        { .name = "--force-max", .number = &settings->force_max },
        { .name = "--rate", .number = &settings->rate },
        { .name = "--cpu", .count = &settings->cpu },
        { .name = "--awake", .flag = &settings->awake },
        { .name = "--budget", .count = &settings->budget },
        { .name = "--physics", .number = &settings->scene.physics },
        { .name = "--for", .number = &settings->seconds },
        { .name = "--ticks", .count = &settings->ticks },
        { .name = "--record", .text = &settings->record },
        { .name = "--embed", .flag = &settings->embeds },
        { .name = "--reopen", .flag = &settings->reopen },
        { .name = "--view", .flag = &settings->view.is_on },
        { .name = "--open", .flag = &settings->view.open },
        { .name = "--port", .count = &settings->view.port },
        { .name = "--address", .text = &settings->view.address },
        { .name = "--control", .flag = &settings->view.control },
        { .name = "--json", .flag = &settings->json },
    };
    int status = parse_options(argc, argv, options, sizeof options / sizeof *options, help,
                               &settings->scene.path, 1, &operands);
    if (status >= 0)
        return status;
    if (operands == 1 && scene_def_read(&settings->scene))
        return 2;
    if (!settings->device && settings->scene.file)
        settings->device = settings->scene.file->device;
    if (operands != 1 || !settings->device)
        return complain("run", "a scene, SCENE.json, MESH.dpa or ARM.dpa, and --device NAME are "
                               "needed (see --help)");
    status = scene_def_complete(&settings->scene, law);
    settings->scene.force.stiffness =
        isnan(settings->coupling.stiffness) ? 0.0 : settings->coupling.stiffness;
    if (status == 0)
        status = force_options_check("run", &settings->scene.force);
    if (status)
        return status;
    if (settings->record && check_record(settings))
        return 2;
    if (settings->embeds && (!settings->record || is_traced(settings)))
        return complain("run", "--embed needs --record F.dpr");
    if (run_view_check("run", &settings->view))
        return 2;
    if (!(settings->scene.zoom > 0.0 && settings->scene.zoom <= 1000.0))
        return complain("run", "--zoom must be positive, at most 1000");
    if (!(settings->scene.force_scale >= 1e-3 && settings->scene.force_scale <= 1000.0))
        return complain("run", "--force-scale must be 0.001 to 1000");
    if (!(settings->coupling.gain_margin >= 1.0 && settings->coupling.gain_margin <= 100.0))
        return complain("run", "--gain-margin must be 1 to 100");
    if (settings->coupling.is_unstable && isnan(settings->coupling.stiffness))
        return complain("run", "--unstable needs --stiffness");
    if (settings->cpu > 65535 && settings->cpu != NO_NUMBER)
        return complain("run", "--cpu must be 0 to 65535");
    if (settings->clutch > 31 && settings->clutch != NO_NUMBER)
        return complain("run", "--clutch must be 0 to 31");
    if (settings->clutch != NO_NUMBER)
        settings->scene.clutch = (int)settings->clutch;
    if (!(settings->scene.length >= 0.0 && settings->scene.length <= 10.0) ||
        !(settings->scene.radius >= 0.0 && settings->scene.radius <= 1.0))
        return complain("run", "--length must be 0 to 10, --radius 0 to 1");
    if (settings->force_max < 0.0 || settings->force_max > 1000.0)
        return complain("run", "--force-max must be 0 to 1000");
    if (settings->rate != 0.0 && !(settings->rate >= 1.0 && settings->rate <= 1e5))
        return complain("run", "--rate must be 1 to 100000");
    if (settings->budget > UINT32_MAX && settings->budget != BUDGET_BY_RATE)
        return complain("run", "--budget must be 0 to %u", (unsigned)UINT32_MAX);
    if (!(settings->seconds > 0.0))
        return complain("run", "--for must be positive");
    if (is_traced(settings) && settings->ticks > RUN_TRACE_MAX)
        return complain("run", "--record: at most %d --ticks", RUN_TRACE_MAX);
    if (is_traced(settings) && !settings->ticks && !(settings->seconds < HUGE_VAL))
        return complain("run", "--record needs --ticks or --for");
    return -1;
}

static int run(const struct run_settings *settings)
{
    struct session session = { .contacts = 0 };
    int status = scene_open(&session.scene, &settings->scene);
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
    struct run_settings settings = { .scene = { .command = "run",
                                                .zoom = NAN,
                                                .force_scale = NAN,
                                                .clutch = -1,
                                                .length = NAN,
                                                .radius = NAN,
                                                .force = { .friction = NAN } },
                                     .coupling = { .stiffness = NAN, .gain_margin = 1.5 },
                                     .clutch = NO_NUMBER,
                                     .cpu = NO_NUMBER,
                                     .force_max = NAN,
                                     .seconds = HUGE_VAL,
                                     .budget = BUDGET_BY_RATE };
    int status = read_settings(argc, argv, &settings);
    if (status < 0 && settings.embeds &&
        recording_embed_load(&settings.embed, &settings.scene, settings.record))
        status = 2;
    if (status < 0)
        status = run(&settings);
    recording_embed_free(&settings.embed);
    scene_def_free(&settings.scene);
    return status;
}
