/* SPDX-License-Identifier: BSD-3-Clause */
#include "run/run_settings.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/vec3.h"
#include "cli/command_options.h"
#include "cli/force_check.h"
#include "cli/open_device.h"
#include "cli/scene_command.h"
#include "measure/measure_setting.h"
#include "plan/plan_file.h"
#include "plan/plan_trace.h"
#include "record/run_trace.h"

const char *coupling_limit_word(uint32_t limit)
{
    static const char *const words[] = { "asked", "stability", "rotation", "step", "maker", "unknown" };
    return limit < sizeof words / sizeof *words ? words[limit] : "?";
}

int run_physics_check(const struct scene *scene, const dpt_device_info *device, int is_recorded)
{
    if (scene->physics_rate > 0.0 && is_recorded && !(device->flags & DPT_DEVICE_FLAG_DETERMINISTIC))
        return complain(scene->command, "--physics: with this device the clock decides when vertices move, which "
                                        "is not in a recording. Leave --record out, or --physics");
    return 0;
}

void run_physics_print(const struct scene *scene, int is_json)
{
    if (!scene->stage.physics)
        return;
    const struct scene_physics_report report = scene_physics_get_report(scene->stage.physics);
    if (is_json)
        printf(",\"physics\":{\"rate\":%.17g,\"asked\":%.17g,\"steps\":%" PRIu64 ",\"late\":%" PRIu64 ",\"thread\":%s}",
               report.rate, report.asked, report.steps, report.late, report.has_thread ? "true" : "false");
    else
        printf("  physics %.4g Hz, %" PRIu64 " steps, %" PRIu64 " late, %s\n", report.rate, report.steps, report.late,
               report.has_thread ? "in a thread of its own" : "by the device's own time");
}

static const char help[] =
    "usage: dynpoint run SCENE|SCENE.json|MESH.dpa|ARM.dpa --device NAME [options]\n"
    "       dynpoint run --plan PLAN.json --device NAME [options]\n"
    "\n"
    "Feel a scene by name (membrane, cloth, laparoscopy, liver, soft-liver, needle, biopsy, tori),\n"
    "a scene file (docs/scene.md), a mesh, or the scene of an arm, with a haptic device: DRIVER or\n"
    "DRIVER:WHERE, as sim or serial:/dev/ttyACM0. The tool is a stylus, a capsule from the\n"
    "device's point along its z axis, or that of an arm, or of the file. What a file says of tool\n"
    "and device, an option overrides. Ends on an interrupt, after --for or --ticks, or when the\n"
    "device is lost; always with zero force. Then says how it went.\n"
    "\n"
    "  --device NAME    which one; default the scene file's\n"
    "  --plan F         scene and setting are those of a plan (dynpoint plan -o)\n"
    "  --at X,Y,Z       where the device's origin lies in the mesh's frame, m; default: 5 mm above the\n"
    "                   middle of the top of its box, y being up. Of an arm's scene, whose z is up, in the\n"
    "                   root's frame; default: where the tool is in the middle of the joints' limits. A\n"
    "                   device that is the arm needs neither this nor --zoom: its joints tell\n"
    "  --tool ARM.dpa   the tool is that of an arm, with its tips and jaws\n"
    "  --tip SHAPE:X,Y,Z[,RADIUS]\n"
    "                   a tip at the tool's origin, beside the tool: box, wedge, cylinder or cone of these\n"
    "                   lengths, m, its edges rounded by the radius. A wedge's edge lies along x, at\n"
    "                   z = -Z / 2; a cone's point lies there too. Up to 16 tips; with the law proxy;\n"
    "                   they replace those of the file. With any law, curved ones, without a radius:\n"
    "                   ellipsoid, capsule, curved-cylinder, curved-cone (docs/scene.md)\n"
    "  --jaw SHARE      where the jaws of an arm's tool stand: 0 at their lower limits, 1 at their upper\n"
    "                   ones. FROM:TO:SECONDS: they go from one to the other in that time of the loop;\n"
    "                   FROM:TO:SECONDS:N: while the device's button N is down, and else back\n"
    "  --zoom Z         metres of the mesh for one of the hand; default 1\n"
    "  --force-scale S  newtons at the hand for one of the mesh; default 1. The hand feels S Z times the stiffness\n"
    "  --clutch N       while button N is down, from 0, the tool stands still and gives no force: move the hand\n"
    "                   to a better place\n"
    "  --length L       of the stylus, m of the mesh; default the scene's, or 0.1\n"
    "  --radius R       of it; default the scene's, or 0.002\n"
    "  --law LAW        of the force: proxy (default) pulls to where the tool would be if it went through\n"
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
    "                   unknown, without force; default 3000 at 1 kHz, in proportion to the period,\n"
    "                   so that a tick keeps within one\n"
    "  --physics HZ     what gives way is stepped in a thread of its own, 1 to 5000 times a second;\n"
    "                   default in each tick. With a device that has a time of its own, by that\n"
    "  --for S          seconds of the clock; of a device with a time of its own, as sim without live=1,\n"
    "                   seconds of that\n"
    "  --ticks N        or so many ticks\n"
    "  --reopen         while the device is lost, try once a second to open it again\n"
    "  --record F.dpr   every tick: what the device told, what was asked and what acted, contact,\n"
    "                   proxy, energy. Written while it lasts, for dynpoint record and replay\n"
    "  --embed          the recording carries MESH.dpa or ARM.dpa, and --tool: it needs no other file\n"
    "  --record F.csv   only how the tool moved, a trace; needs --ticks or --for\n"
    "  --view           show it in a browser: prints the address of a page on this machine\n"
    "  --open           and open it there\n"
    "  --port N         of the page; default a free one\n"
    "  --address A      serve the page on this address instead, to other machines, unencrypted\n"
    "  --control        a simulated hand stands still until the page moves it\n"
    "  --json           what is said at the end as one JSON object; with --view the address before it,\n"
    "                   as another one, in a line of its own\n";

int run_is_traced(const struct run_settings *settings)
{
    return settings->record && is_trace_name(settings->record);
}

/* Check the record against all inputs. The device's name contains files, too. */
static int check_record(const struct run_settings *settings)
{
    const char *const inputs[] = { settings->identified, NULL };
    if (!strcmp(settings->record, "-"))
        return complain("run", "--record needs a file: what is said at the end is on standard output");
    if (check_scene_output(&settings->scene, settings->record) || output_check("run", settings->record, inputs) ||
        device_output_check("run", settings->record, settings->device))
        return 2;
    return output_check_name("run", settings->record, ".dpr .csv", "a recording, or a trace");
}

/* The plan's scene, and what the options do not say. Returns 0, or 2 after a message. */
static int read_plan(struct run_settings *settings, size_t operands, const char **law)
{
    const struct measure_setting *planned = &settings->plan.setting;
    if (operands || settings->scene.tool)
        return complain("run", "--plan names a scene and its tool: give no other");
    if (plan_file_read(&settings->plan, "run", settings->plan_path))
        return 2;
    if (*law && strcmp(*law, law_name(planned->world.law)))
        return complain("run", "--law: the plan %s is of the law %s", settings->plan_path,
                        law_name(planned->world.law));
    *law = law_name(planned->world.law);
    plan_scene_def(&settings->plan, &settings->scene);
    if (isnan(settings->coupling.stiffness))
        settings->coupling.stiffness = planned->world.stiffness;
    if (settings->budget == HOST_BUDGET_BY_RATE)
        settings->budget = planned->world.budget;
    return 0;
}

static int read_jaw(struct jaw_motion *motion, const char *text)
{
    dpt_host_error error = { .size = sizeof error };
    return complain_of("run", jaw_motion_read(motion, "--jaw", text, &error), &error);
}

/* What shapes the scene's feel: ranges, and options that need each other. Returns 0, or 2 after a message. */
static int check_feel(struct run_settings *settings)
{
    if (!(settings->scene.zoom > 0.0 && settings->scene.zoom <= 1000.0))
        return complain("run", "--zoom must be positive, at most 1000");
    if (!(settings->scene.force_scale >= 1e-3 && settings->scene.force_scale <= 1000.0))
        return complain("run", "--force-scale must be 0.001 to 1000");
    if (!(settings->coupling.gain_margin >= 1.0 && settings->coupling.gain_margin <= 100.0))
        return complain("run", "--gain-margin must be 1 to 100");
    if (settings->coupling.is_unstable && isnan(settings->coupling.stiffness))
        return complain("run", "--unstable needs --stiffness");
    if (settings->clutch > 31 && settings->clutch != RUN_NO_NUMBER)
        return complain("run", "--clutch must be 0 to 31");
    if (settings->clutch != RUN_NO_NUMBER)
        settings->scene.clutch = (int)settings->clutch;
    if (!(settings->scene.length >= 0.0 && settings->scene.length <= 10.0) ||
        !(settings->scene.radius >= 0.0 && settings->scene.radius <= 1.0))
        return complain("run", "--length must be 0 to 10, --radius 0 to 1");
    return 0;
}

/* The loop, its recording and its viewers, likewise. */
static int check_loop(const struct run_settings *settings)
{
    if (settings->force_max < 0.0 || settings->force_max > 1000.0)
        return complain("run", "--force-max must be 0 to 1000");
    if (settings->rate != 0.0 && !(settings->rate >= 1.0 && settings->rate <= 1e5))
        return complain("run", "--rate must be 1 to 100000");
    if (settings->cpu > 65535 && settings->cpu != RUN_NO_NUMBER)
        return complain("run", "--cpu must be 0 to 65535");
    if (settings->budget > UINT32_MAX && settings->budget != HOST_BUDGET_BY_RATE)
        return complain("run", "--budget must be 0 to %u", (unsigned)UINT32_MAX);
    if (!(settings->seconds > 0.0))
        return complain("run", "--for must be positive");
    if (settings->ticks == 0)
        return complain("run", "--ticks must be positive: without it, and without --for, the run goes on");
    if (run_is_traced(settings) && settings->ticks > RUN_TRACE_MAX && settings->ticks != RUN_NO_NUMBER)
        return complain("run", "--record: at most %d --ticks", RUN_TRACE_MAX);
    if (run_is_traced(settings) && settings->ticks == RUN_NO_NUMBER && !(settings->seconds < HUGE_VAL))
        return complain("run", "--record needs --ticks or --for");
    return 0;
}

/* Options that are read further on. */
struct run_words {
    const char *at, *law, *jaw;
    struct option_texts tips;
    size_t operands;
};

/* Returns -1 to go on, else the exit status. */
static int parse_settings(struct run_settings *settings, struct run_words *words, int argc, char **argv)
{
    const struct option_def options[] = {
        { .name = "--device", .text = &settings->device, .kind = VALUE_DEVICE },
        { .name = "--plan", .text = &settings->plan_path, .kind = VALUE_FILE },
        { .name = "--at", .text = &words->at },
        { .name = "--tool", .text = &settings->scene.tool, .kind = VALUE_FILE },
        { .name = "--tip", .texts = &words->tips },
        { .name = "--jaw", .text = &words->jaw },
        { .name = "--identified", .text = &settings->identified, .kind = VALUE_FILE },
        { .name = "--zoom", .number = &settings->scene.zoom },
        { .name = "--length", .number = &settings->scene.length },
        { .name = "--radius", .number = &settings->scene.radius },
        { .name = "--law", .text = &words->law, .words = law_names },
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
        { .name = "--record", .text = &settings->record, .kind = VALUE_FILE },
        { .name = "--embed", .flag = &settings->embeds },
        { .name = "--reopen", .flag = &settings->reopen },
        { .name = "--view", .flag = &settings->view.is_on },
        { .name = "--open", .flag = &settings->view.open },
        { .name = "--port", .count = &settings->view.port },
        { .name = "--address", .text = &settings->view.address },
        { .name = "--control", .flag = &settings->view.control },
        { .name = "--json", .flag = &settings->json },
    };
    *settings = (struct run_settings){ .coupling = { .stiffness = NAN, .gain_margin = 1.5 },
                                       .clutch = RUN_NO_NUMBER,
                                       .cpu = RUN_NO_NUMBER,
                                       .ticks = RUN_NO_NUMBER,
                                       .force_max = NAN,
                                       .seconds = HUGE_VAL,
                                       .budget = HOST_BUDGET_BY_RATE };
    scene_def_init(&settings->scene, "run");
    static const struct operand_def taken[] = { { .kind = VALUE_SCENE } };
    return parse_options(argc, argv, COMMAND_SYNTAX(options, help, taken), &settings->scene.path, 1, &words->operands);
}

int run_settings_read(struct run_settings *settings, int argc, char **argv)
{
    struct run_words words = { .law = NULL };
    int status = parse_settings(settings, &words, argc, argv);
    if (status >= 0)
        return status;
    settings->view.json = settings->json;
    if (settings->plan_path && read_plan(settings, words.operands, &words.law))
        return 2;
    words.operands += settings->plan_path != NULL;
    if (words.operands == 1 && read_scene_def(&settings->scene))
        return 2;
    if (!settings->device && settings->scene.file)
        settings->device = settings->scene.file->device;
    if (words.operands != 1 || !settings->device)
        return complain("run", "a scene, SCENE.json, MESH.dpa or ARM.dpa, and --device NAME are needed (see --help)");
    if (words.jaw && read_jaw(&settings->scene.jaw, words.jaw))
        return 2;
    if (read_tip_shapes(&settings->scene.tips, "run", &words.tips))
        return 2;
    if (words.at && read_origin(&settings->scene, words.at))
        return 2;
    status = complete_scene_def(&settings->scene, words.law);
    settings->scene.force.stiffness = isnan(settings->coupling.stiffness) ? 0.0 : settings->coupling.stiffness;
    if (status == 0)
        status = force_options_check("run", &settings->scene.force);
    if (status)
        return status;
    if (settings->record && check_record(settings))
        return 2;
    if (settings->embeds && (!settings->record || run_is_traced(settings)))
        return complain("run", "--embed needs --record F.dpr");
    if (run_view_check("run", &settings->view))
        return 2;
    if (check_feel(settings) || check_loop(settings))
        return 2;
    if (settings->ticks == RUN_NO_NUMBER)
        settings->ticks = 0;
    return -1;
}
