/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint make: writes a test mesh, or (make trace) a motion over one. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command_options.h"
#include "cli/commands.h"
#include "cli/complete.h"
#include "cli/json_text.h"
#include "scene/shape.h"
#include "shape/insert_hand.h"
#include "shape/mesh_file.h"
#include "shape/trace_hand.h"
#include "text/parse_number.h"

static const char laparoscopic[] = "laparoscopic";

static const char *const counts_text[] = { [SHAPE_ANY] = "any",
                                           [SHAPE_EVEN] = "even",
                                           [SHAPE_TWO_SQUARES] = "2 k^2",
                                           [SHAPE_TWELVE_SQUARES] = "12 k^2",
                                           [SHAPE_RINGS] = "64 k" };

static void print_help(void)
{
    printf("usage: dynpoint make SHAPE [N] -o FILE [--seed S] [--json]\n"
           "       dynpoint make trace --help\n"
           "\n"
           "Writes a test mesh of exactly N triangles, in metres. All machines write the same bytes.\n"
           "\n"
           "  -o FILE   its ending says the format: .obj, .stl, .ply or .off\n"
           "  --seed S  moves bumps, folds and spikes; default 0\n"
           "  --json    the files and how large they are, as one JSON object on standard output\n"
           "\n"
           "  %-12s  %-6s  %5s  %7s\n",
           "SHAPE", "N", "least", "default");
    for (const struct shape_kind *kind = shape_kinds; kind < shape_kinds + shape_kind_count; kind++) {
        char default_count[12] = "-";
        if (kind->default_count)
            snprintf(default_count, sizeof default_count, "%" PRIu32, kind->default_count);
        printf("  %-12s  %-6s  %5" PRIu32 "  %7s  %s\n", kind->name, counts_text[kind->counts], kind->count_min,
               default_count, kind->help);
    }
    printf("  %-12s  %-6s  %5d  %7d  %s\n", laparoscopic, "any", LAPAROSCOPIC_MIN, LAPAROSCOPIC_TRIANGLES,
           "three files: FILE-liver, FILE-stomach, FILE-spleen");
}

/* Write a shape. The caller keeps or drops the output. */
static int write_shape(struct output *output, const char *path, const struct shape *shape)
{
    if (output_open(output, "make", path))
        return 2;
    mesh_file_writer(path)(output->file, shape);
    return output_complete(output, "make");
}

/* What was written, as JSON. */
static void print_json(const char *const paths[], const struct shape shapes[], int count)
{
    fputs("{\"files\":[", stdout);
    for (int i = 0; i < count; i++) {
        fputs(i ? ",{\"path\":" : "{\"path\":", stdout);
        json_write_text(stdout, paths[i]);
        printf(",\"triangles\":%zu,\"vertices\":%zu}", shapes[i].triangle_count, shapes[i].vertex_count);
    }
    puts("]}");
}

static int make_one(const char *name, uint64_t count, uint64_t seed, const char *path, int json)
{
    struct shape shape;
    shape_reason reason;
    if (shape_make(name, count, seed, &shape, reason))
        return complain("make", "%s", reason);
    struct output output;
    int status = write_shape(&output, path, &shape);
    if (status == 0 && json)
        print_json(&path, &shape, 1);
    if (status == 0)
        status = output_keep(&output, "make");
    shape_free(&shape);
    return status;
}

/* "dir/scene.obj" and "liver" give "dir/scene-liver.obj"; NULL when memory runs out. */
static char *body_path(const char *path, const char *body)
{
    const char *ending = strrchr(path, '.');
    size_t size = strlen(path) + strlen(body) + 2;
    char *name = malloc(size);
    if (name)
        snprintf(name, size, "%.*s-%s%s", (int)(ending - path), path, body, ending);
    return name;
}

/* Write all bodies or none. */
static int write_bodies(char *const paths[], const struct shape bodies[], int json)
{
    for (int i = 0; i < LAPAROSCOPIC_BODIES; i++) {
        if (!paths[i])
            return complain("make", "memory ran out");
    }
    struct output outputs[LAPAROSCOPIC_BODIES];
    int written = 0, kept = 0;
    while (written < LAPAROSCOPIC_BODIES && write_shape(&outputs[written], paths[written], &bodies[written]) == 0)
        written++;
    if (written == LAPAROSCOPIC_BODIES) {
        for (int i = 0; i < LAPAROSCOPIC_BODIES && !json; i++)
            printf("%s %zu\n", paths[i], bodies[i].triangle_count);
        if (json)
            print_json((const char *const *)paths, bodies, LAPAROSCOPIC_BODIES);
        while (kept < LAPAROSCOPIC_BODIES && output_keep(&outputs[kept], "make") == 0)
            kept++;
    }
    for (int i = kept; i < written; i++)
        output_drop(&outputs[i]);
    return kept == LAPAROSCOPIC_BODIES ? 0 : 2;
}

static int make_laparoscopic(uint64_t count, uint64_t seed, const char *path, int json)
{
    struct shape bodies[LAPAROSCOPIC_BODIES];
    char *paths[LAPAROSCOPIC_BODIES];
    shape_reason reason;
    if (shape_make_laparoscopic(count ? count : LAPAROSCOPIC_TRIANGLES, seed, bodies, reason))
        return complain("make", "%s", reason);
    for (int i = 0; i < LAPAROSCOPIC_BODIES; i++)
        paths[i] = body_path(path, laparoscopic_names[i]);
    int status = write_bodies(paths, bodies, json);
    for (int i = 0; i < LAPAROSCOPIC_BODIES; i++) {
        shape_free(&bodies[i]);
        free(paths[i]);
    }
    return status;
}

static int asks_for_help(int argc, char **argv)
{
    for (int i = 1; i < argc; i++)
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0)
            return 1;
    return 0;
}

enum { MADE_MAX = 64 };

/* All that can be made, ended by NULL. */
static void list_names(const char *names[MADE_MAX])
{
    size_t count = 0;
    for (const struct shape_kind *kind = shape_kinds; kind < shape_kinds + shape_kind_count; kind++)
        if (count < MADE_MAX - 3)
            names[count++] = kind->name;
    names[count++] = laparoscopic;
    names[count++] = "trace";
    names[count] = NULL;
}

int command_make(int argc, char **argv)
{
    const char *path = NULL, *words[2] = { NULL, NULL };
    int json = 0;
    uint64_t seed = 0;
    int64_t count = 0;
    size_t word_count;
    const struct option_def options[] = { { .name = "-o", .text = &path, .kind = VALUE_FILE },
                                          { .name = "--seed", .count = &seed },
                                          { .name = "--json", .flag = &json } };
    if (argc > 1 && strcmp(argv[1], "trace") == 0)
        return command_make_trace(argc - 1, argv + 1);
    if (argc > 3 && strcmp(argv[1], COMPLETE_ARGUMENT) == 0 && strcmp(argv[2], "trace") == 0) {
        argv[2] = argv[1];
        return command_make_trace(argc - 1, argv + 1);
    }
    if (asks_for_help(argc, argv)) {
        print_help();
        return 0;
    }
    const char *names[MADE_MAX];
    list_names(names);
    const struct operand_def taken[] = { { .words = names }, { .kind = VALUE_ANY } };
    int status = parse_options(argc, argv, COMMAND_SYNTAX(options, "", taken), words, 2, &word_count);
    if (status >= 0)
        return status;
    if (word_count == 0)
        return complain("make", "a shape is needed (see --help)");
    if (word_index(words[0], names) < 0)
        return complain_of_word("make", "shape", words[0], names);
    const char *end = word_count == 2 ? words[1] + strlen(words[1]) : NULL;
    if (end && (parse_int(words[1], end, &count) != end || count <= 0))
        return complain("make", "'%s' is not a number of triangles", words[1]);
    if (!path)
        return complain("make", "-o FILE is needed");
    if (!mesh_file_writer(path))
        return complain("make", "%s: the ending is none of .obj, .stl, .ply, .off", path);
    if (strcmp(words[0], laparoscopic) == 0)
        return make_laparoscopic((uint64_t)count, seed, path, json);
    return make_one(words[0], (uint64_t)count, seed, path, json);
}

/* dynpoint make trace: a hand slides a tool over a mesh (trace_hand.h), or inserts a needle (insert_hand.h). */

static const char help[] =
    "usage: dynpoint make trace --mesh FILE.dpa -o TRACE.csv [--seed S] [--ticks N]\n"
    "                           [--length L] [--band B] [--speed V]\n"
    "       dynpoint make trace --insert --mesh FILE.dpa -o TRACE.csv [--seed S] [--ticks N]\n"
    "                           [--length L] [--depth D] [--speed V]\n"
    "\n"
    "A tool sliding over the mesh, 1 ms a tick, for dynpoint replay. Or with --insert a needle, its tip\n"
    "end a, for run --device replay:TRACE.csv: it goes in against the surface's normal, pauses for 0.5 s,\n"
    "is drawn out on the same line, and goes in again.\n"
    "\n"
    "  --insert    a needle that goes in\n"
    "  --seed S    default 1\n"
    "  --ticks N   default 20000; with --insert those of two insertions\n"
    "  --length L  of the tool, m; default 0.3, of a needle 0.1, for a mesh with a diagonal of 0.35 m,\n"
    "              scaled with it\n"
    "  --band B    how far above and below the surface it is held, m; default 0.005, scaled\n"
    "  --depth D   of a needle's tip beneath the surface where it pauses, m; default 0.03, scaled\n"
    "  --speed V   mean speed over the surface, m/s; default 0.3, scaled. Of a needle on its way; default\n"
    "              0.02, scaled\n";

#define TICKS_UNSET UINT64_MAX

/* One of them moves the tool. */
struct trace_mover {
    struct trace_hand *hand;
    struct insert_hand *needle;
};

static void move_tool(const struct trace_mover *mover, double ends[6])
{
    if (mover->needle)
        insert_hand_move(mover->needle, ends);
    else
        trace_hand_move(mover->hand, ends);
}

static int write_trace(const struct trace_mover *mover, uint64_t ticks, const char *out)
{
    struct output output;
    struct meter meter = { .began = 0 };
    int status = output_open(&output, "make trace", out);
    if (status)
        return status;
    fputs("tick,ax,ay,az,bx,by,bz\n", output.file);
    for (uint64_t tick = 0; tick < ticks; tick++) {
        double ends[6];
        if (tick % 1024 == 0)
            meter_show(&meter, "make trace", (double)tick / (double)ticks);
        move_tool(mover, ends);
        fprintf(output.file, "%" PRIu64 ",%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", tick, ends[0], ends[1], ends[2],
                ends[3], ends[4], ends[5]);
    }
    meter_show(&meter, "", 1.0);
    return output_close(&output, "make trace");
}

int command_make_trace(int argc, char **argv)
{
    const char *mesh_path = NULL, *out = NULL, *operand;
    struct trace_hand hand;
    struct insert_hand needle;
    double length = 0.0, band = 0.0, depth = 0.0, speed = 0.0;
    uint64_t ticks = TICKS_UNSET, seed = 1;
    int is_needle = 0;
    size_t operands;
    static char whole_name[] = "make trace";
    argv[0] = whole_name;
    const struct option_def options[] = {
        { .name = "--mesh", .text = &mesh_path, .kind = VALUE_FILE },
        { .name = "-o", .text = &out, .kind = VALUE_FILE },
        { .name = "--seed", .count = &seed },
        { .name = "--ticks", .count = &ticks },
        { .name = "--insert", .flag = &is_needle },
        { .name = "--length", .number = &length },
        { .name = "--depth", .number = &depth },
        { .name = "--band", .number = &band },
        { .name = "--speed", .number = &speed },
    };
    int status = parse_options(
        argc, argv,
        &(struct command_syntax){ .options = options, .option_count = sizeof options / sizeof *options, .help = help },
        &operand, 1, &operands);
    if (status >= 0)
        return status;
    if (!mesh_path || !out || operands)
        return complain("make trace", "--mesh FILE.dpa and -o TRACE.csv are needed (see --help)");
    if (output_check("make trace", out, (const char *const[]){ mesh_path, NULL }) ||
        output_check_name("make trace", out, ".csv .txt", "a table of comma-separated values"))
        return 2;
    const double limit = DPT_COORDINATE_MAX;
    if (!ticks)
        return complain("make trace", "--ticks must be 1 or more");
    if (!(length >= 0.0 && length <= limit) || !(band >= 0.0 && band <= limit) || !(speed >= 0.0 && speed <= limit) ||
        !(depth >= 0.0 && depth <= limit))
        return complain("make trace", "--length, --band, --depth and --speed must be 0 to 1e6");
    if (is_needle ? band > 0.0 : depth > 0.0)
        return complain("make trace", is_needle ? "--band is for a tool that slides" : "--depth is for --insert");

    void *bytes;
    const dpt_mesh *mesh = load_mesh("make trace", mesh_path, &bytes);
    if (!mesh)
        return 2;
    trace_hand_begin(&hand, mesh, seed, is_needle ? 0.0 : length, band, is_needle ? 0.0 : speed);
    insert_hand_begin(&needle, &hand, length, depth, speed);
    if (ticks == TICKS_UNSET)
        ticks = is_needle ? 2 * insert_hand_ticks(&needle) : 20000;
    if (is_needle && insert_hand_ticks(&needle) == INSERT_TICKS_MAX)
        status = complain("make trace", "--speed: at %g m/s an insertion takes more than 1e9 ticks", needle.speed);
    else
        status = write_trace(&(struct trace_mover){ &hand, is_needle ? &needle : NULL }, ticks, out);
    free(bytes);
    return status;
}
