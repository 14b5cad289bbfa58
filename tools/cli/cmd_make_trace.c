/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint make trace: a hand slides a tool over a mesh (trace_hand.h). */
#include <inttypes.h>
#include <stdlib.h>

#include "cli/command_options.h"
#include "cli/commands.h"
#include "shape/trace_hand.h"

static const char help[] =
    "usage: dynpoint make trace --mesh FILE.dpa -o TRACE.csv [--seed S] [--ticks N]\n"
    "                           [--length L] [--band B] [--speed V]\n"
    "\n"
    "A tool sliding over the mesh, 1 ms a tick, for dynpoint replay.\n"
    "\n"
    "  --seed S    default 1\n"
    "  --ticks N   default 20000\n"
    "  --length L  of the tool, m; default 0.3 for a mesh with a diagonal of 0.35 m, scaled with it\n"
    "  --band B    how far above and below the surface it is held, m; default 0.005, scaled\n"
    "  --speed V   mean speed over the surface, m/s; default 0.3, scaled\n";

static int write_trace(struct trace_hand *hand, uint64_t ticks, const char *out)
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
        trace_hand_move(hand, ends);
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
    double length = 0.0, band = 0.0, speed = 0.0;
    uint64_t ticks = 20000, seed = 1;
    size_t operands;
    static char whole_name[] = "make trace";
    argv[0] = whole_name;
    const struct option_def options[] = {
        { .name = "--mesh", .text = &mesh_path },  { .name = "-o", .text = &out },
        { .name = "--seed", .count = &seed },      { .name = "--ticks", .count = &ticks },
        { .name = "--length", .number = &length }, { .name = "--band", .number = &band },
        { .name = "--speed", .number = &speed },
    };
    int status = parse_options(argc, argv, options, sizeof options / sizeof *options, help, &operand, 1, &operands);
    if (status >= 0)
        return status;
    if (!mesh_path || !out || operands)
        return complain("make trace", "--mesh FILE.dpa and -o TRACE.csv are needed (see --help)");
    if (output_check("make trace", out, (const char *const[]){ mesh_path, NULL }))
        return 2;
    const double limit = DPT_COORDINATE_MAX;
    if (!ticks)
        return complain("make trace", "--ticks must be 1 or more");
    if (!(length >= 0.0 && length <= limit) || !(band >= 0.0 && band <= limit) || !(speed >= 0.0 && speed <= limit))
        return complain("make trace", "--length, --band and --speed must be 0 to 1e6");

    void *bytes;
    const dpt_mesh *mesh = load_mesh("make trace", mesh_path, &bytes);
    if (!mesh)
        return 2;
    trace_hand_begin(&hand, mesh, seed, length, band, speed);
    status = write_trace(&hand, ticks, out);
    free(bytes);
    return status;
}
