/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint view: a mesh, a scene or a recording in a browser. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/arm_file.h"
#include "cli/command_options.h"
#include "cli/commands.h"
#include "cli/compile_options.h"
#include "cli/complete.h"
#include "cli/open_device.h"
#include "dynpoint/compile.h"
#include "record/recording_file.h"
#include "scene/host_file.h"
#include "scene/scene_list.h"
#include "view/view_recording.h"
#include "view/view_scene.h"
#include "view/view_serve.h"
#include "view/view_stream.h"

static const char help[] =
    "usage: dynpoint view MESH [-o PAGE.html] [options]\n"
    "       dynpoint view RECORDING.dpr [--mesh FILE] [--tool ARM.dpa] [-o PAGE.html] [options]\n"
    "       dynpoint view SCENE [-o PAGE.html] [options of dynpoint run]\n"
    "\n"
    "Shows it in a browser. Prints the address of a page on this machine, and serves that until an\n"
    "interrupt. A MESH is compiled (.dpa) or in a format that dynpoint compile reads. A SCENE, which\n"
    "is a scene by name, a scene file or an arm's scene, is felt by a simulated hand that presses\n"
    "and lets go, or by --device; it is dynpoint run SCENE --view. With -o that hand feels it for\n"
    "--for or --ticks, by default 5 seconds of its own time, and the page shows what was recorded.\n"
    "\n"
    "  -o PAGE.html     write a page that plays by itself, opened by a double click, and serve none\n"
    "  --mesh FILE      where the scene of the recording is now, if that is no scene by name, the\n"
    "                   recording does not carry it, and it is not where it was\n"
    "  --tool ARM.dpa   likewise the arm whose tool moved\n"
    "  --open           open a browser\n"
    "  --port N         of the page; default a free one\n"
    "  --address A      serve it on this address instead, to other machines, unencrypted\n"
    "  --for S          serve it so many seconds\n"
    "  --control        of a scene: the hand stands still until the page moves it\n"
    "  --json           the address as a JSON object\n";

struct view_settings {
    const char *path, *out;
    struct view_recording_files files;
    struct run_view_options serve;
    double seconds;
};

/* What is served lies in the stream: nothing follows. */
static int serve(const struct view_settings *settings, const struct view_stream *stream)
{
    const struct view_source source = { .first = stream->message, .first_count = stream->count };
    struct view_serving *serving;
    const int status = view_serve("view", &settings->serve, &source, &serving);
    if (status)
        return status;
    stop_watch(NULL, settings->seconds);
    while (!stop_requested())
        sleep_seconds(0.1);
    view_serve_end(serving, "The viewer was ended.");
    return 0;
}

static int write_page(const struct view_settings *settings, const struct view_stream *stream)
{
    const struct view_page page = view_page_bytes();
    struct output output;
    if (!page.html)
        return complain("view", "this build has no viewer's page, which needs node and three.js: "
                                "make deps view, then make");
    int status = output_open(&output, "view", settings->out);
    if (status)
        return status;
    if (!view_stream_write_page(stream, &page, output.file)) {
        fclose(output.file);
        output_drop(&output);
        return complain("view", "the viewer's page has no place for data");
    }
    return output_close(&output, "view");
}

static int show(const struct view_settings *settings, const struct view_stream *stream)
{
    return settings->out ? write_page(settings, stream) : serve(settings, stream);
}

static int show_recording(const struct view_settings *settings)
{
    struct view_stream stream = { .count = 0 };
    int is_wrong = 0, status = view_recording(&stream, &settings->files, &is_wrong);
    if (status == 0)
        status = show(settings, &stream);
    view_stream_free(&stream);
    return status == 0 && is_wrong ? 2 : status;
}

static const char *name_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash && slash[1] ? slash + 1 : path;
}

static int show_mesh(const struct view_settings *settings, const dpt_mesh *mesh)
{
    const struct view_scene_body body = {
        .name = name_of(settings->path), .mesh = mesh, .id = 1, .pose = DPT_POSE_IDENTITY
    };
    const struct view_scene scene = { .title = body.name, .mode = "mesh", .up = "y", .bodies = &body, .body_count = 1 };
    struct view_stream stream = { .count = 0 };
    size_t size = 0;
    void *message = view_scene_message(&scene, &size);
    int status = view_stream_add(&stream, message, size) ? 0 : complain("view", "memory ran out");
    if (status == 0)
        status = show(settings, &stream);
    view_stream_free(&stream);
    return status;
}

/* A mesh that is not compiled: compile it in memory. */
static int show_source(const struct view_settings *settings)
{
    dpt_compiled compiled = { NULL, 0 };
    dpt_diag diag = { .size = sizeof diag };
    const dpt_mesh *mesh = NULL;
    if (dpt_compile_file(settings->path, NULL, &compiled, &diag) != DPT_OK)
        return complain_of_file("view", settings->path, &diag);
    int status = dpt_mesh_open(compiled.bytes, compiled.size, &mesh) == DPT_OK
                     ? show_mesh(settings, mesh)
                     : complain("view", "%s: cannot be opened", settings->path);
    dpt_compiled_free(&compiled);
    return status;
}

static int has_ending(const char *path, const char *ending)
{
    const size_t length = strlen(path), size = strlen(ending);
    return length > size && !strcmp(path + length - size, ending);
}

/* 1 if it is to be felt: a scene by name, a scene file, an arm's scene. -1 after a message. */
static int is_scene(const char *path)
{
    if (scene_listed(path) || has_ending(path, ".json"))
        return 1;
    if (!has_ending(path, ".dpa"))
        return 0;
    size_t size;
    void *bytes = load_file("view", path, &size);
    const int is_one = bytes ? host_file_is_arm(bytes, size) : -1;
    free(bytes);
    return is_one;
}

static int show_file(const struct view_settings *settings)
{
    FILE *file = fopen(settings->path, "rb");
    if (file)
        fclose(file);
    else if (errno == ENOENT && scene_listed_is_meant(settings->path)) {
        char told[256];
        scene_listed_tell(settings->path, told, sizeof told);
        return complain("view", "%s: there is no scene of this name, and no such file: %s", settings->path, told);
    }
    if (is_recording(settings->path))
        return show_recording(settings);
    if (settings->files.mesh || settings->files.tool)
        return complain("view", "--mesh and --tool are of a recording");
    if (!has_ending(settings->path, ".dpa"))
        return show_source(settings);
    size_t size;
    void *bytes = load_file("view", settings->path, &size);
    const dpt_mesh *mesh = bytes ? open_mesh("view", settings->path, bytes, size) : NULL;
    const int status = mesh ? show_mesh(settings, mesh) : 2;
    free(bytes);
    return status;
}

/* Whether an argument is the option, alone or with its value behind an equals sign. */
static int is_option(const char *argument, const char *option)
{
    const size_t length = strlen(option);
    return !strncmp(argument, option, length) && (!argument[length] || argument[length] == '=');
}

/* `dynpoint run SCENE --record`, with a simulated hand if no device is named, and a page of that. */
static int write_scene(int argc, char **argv, const char *out)
{
    static char command[] = "view", record[] = "--record", device[] = "--device", press[] = "sim:?hand=press",
                span[] = "--for", seconds[] = "5";
    static const char *const served[] = { "--view", "--open", "--port", "--address", "--control", "--record", NULL };
    const struct view_settings settings = { .path = argv[1], .out = out };
    int count = 0, has_device = 0, has_end = 0, status = 0;
    if (!strcmp(out, "-"))
        return complain("view", "-o: the page of a scene is a file: how it went is on standard output");
    if (!view_page_bytes().html)
        return write_page(&settings, NULL);
    if (output_check_name("view", out, ".html .htm", "a page"))
        return 2;
    char **words = calloc((size_t)argc + 7, sizeof *words), *recorded = malloc(strlen(out) + sizeof ".dpr");
    if (words && recorded)
        strcat(strcpy(recorded, out), ".dpr");
    else
        status = complain("view", "memory ran out");
    for (int i = 0; status == 0 && i < argc; i++) {
        for (const char *const *option = served; i && *option; option++)
            if (is_option(argv[i], *option))
                status = complain("view", "-o writes a page of a scene, and does not go with %s", *option);
        if (!strcmp(argv[i], "-o"))
            i++;
        else if (!is_option(argv[i], "-o"))
            words[count++] = i ? argv[i] : command;
        has_device |= is_option(argv[i], device);
        has_end |= is_option(argv[i], span) || is_option(argv[i], "--ticks");
    }
    FILE *there = status == 0 ? fopen(recorded, "rb") : NULL;
    if (there) {
        fclose(there);
        status = complain("view", "%s is in the way: the scene is recorded there first", recorded);
    } else if (status == 0) {
        words[count++] = record;
        words[count++] = recorded;
        if (!has_device) {
            words[count++] = device;
            words[count++] = press;
        }
        if (!has_end) {
            words[count++] = span;
            words[count++] = seconds;
        }
        status = command_run(count, words);
        struct view_settings page = { .path = recorded, .out = out, .files.recording = recorded };
        if (status == 0)
            status = show_recording(&page);
        remove(recorded);
    }
    free(words);
    free(recorded);
    return status;
}

/* `dynpoint run SCENE --view`, with a simulated hand if no device is named. */
static int run_scene(int argc, char **argv)
{
    complain_as("run", "view");
    for (int i = 2; i < argc; i++)
        if (is_option(argv[i], "-o")) {
            const char *out = argv[i][2] ? argv[i] + 3 : i + 1 < argc ? argv[i + 1] : NULL;
            return out ? write_scene(argc, argv, out) : complain("view", "-o needs a value");
        }
    static char command[] = "view", view[] = "--view", device[] = "--device", press[] = "sim:?hand=press&live=1",
                hold[] = "sim:?hand=hold&live=1";
    char **words = calloc((size_t)argc + 4, sizeof *words);
    int count = 0, has_device = 0, has_control = 0;
    if (!words)
        return complain("view", "memory ran out");
    words[count++] = command;
    for (int i = 1; i < argc; i++) {
        has_device |= is_option(argv[i], device);
        has_control |= !strcmp(argv[i], "--control");
        words[count++] = argv[i];
    }
    words[count++] = view;
    if (!has_device) {
        words[count++] = device;
        words[count++] = has_control ? hold : press;
    }
    const int status = command_run(count, words);
    free(words);
    return status;
}

static int check_out(const struct view_settings *settings)
{
    const char *const inputs[] = { settings->path, settings->files.mesh ? settings->files.mesh : "",
                                   settings->files.tool ? settings->files.tool : "", NULL };
    if (!settings->out)
        return 0;
    if (settings->serve.open || settings->serve.port || settings->serve.address || settings->serve.json)
        return complain("view", "-o writes a page, and --open, --port, --address and --json serve one");
    return output_check("view", settings->out, inputs) ||
                   output_check_name("view", settings->out, ".html .htm", "a page")
               ? 2
               : 0;
}

int command_view(int argc, char **argv)
{
    struct view_settings settings = { .serve.is_on = 1, .seconds = HUGE_VAL };
    size_t operands = 0;
    const int completes = argc > 3 && !strcmp(argv[1], COMPLETE_ARGUMENT);
    if (completes && (scene_listed(argv[2]) || has_ending(argv[2], ".json")))
        return command_run(argc, argv);
    int is_control = 0; /* of a scene, which run_scene shows */
    const int scene = argc > 1 && argv[1][0] != '-' ? is_scene(argv[1]) : 0;
    if (scene)
        return scene < 0 ? 2 : run_scene(argc, argv);
    const struct option_def options[] = {
        { .name = "-o", .text = &settings.out, .kind = VALUE_FILE },
        { .name = "--mesh", .text = &settings.files.mesh, .kind = VALUE_FILE },
        { .name = "--tool", .text = &settings.files.tool, .kind = VALUE_FILE },
        { .name = "--open", .flag = &settings.serve.open },
        { .name = "--port", .count = &settings.serve.port },
        { .name = "--address", .text = &settings.serve.address },
        { .name = "--for", .number = &settings.seconds },
        { .name = "--control", .flag = &is_control },
        { .name = "--json", .flag = &settings.serve.json },
    };
    static const struct operand_def taken[] = { { .kind = VALUE_SCENE } };
    int status = parse_options(argc, argv, COMMAND_SYNTAX(options, help, taken), &settings.path, 1, &operands);
    if (status >= 0)
        return status;
    settings.files.recording = settings.path;
    if (operands != 1)
        return complain("view", "a MESH, a RECORDING.dpr or a SCENE is needed (see --help)");
    if (is_control)
        return complain("view", "--control is of a scene, which comes first");
    if (!(settings.seconds > 0.0))
        return complain("view", "--for must be positive");
    if (run_view_check("view", &settings.serve) || check_out(&settings))
        return 2;
    return show_file(&settings);
}
