/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * dynpoint make trace: a hand slides a tool over a mesh. A point wanders over the surface. The tool is roughly tangent
 * and follows the point with some part of its length, a little above or below the surface. The tool moves in every row.
 * Only arithmetic is used, so a seed gives the same bytes on every machine.
 */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/sincos.h"
#include "base/vec3.h"
#include "command_options.h"
#include "commands.h"

static const char help[] =
    "usage: dynpoint make trace --mesh FILE.dpa -o TRACE.csv [--seed S] [--ticks N]\n"
    "                           [--length L] [--band B] [--speed V]\n"
    "\n"
    "A tool sliding over the mesh, 1 ms a tick, for dynpoint replay.\n"
    "\n"
    "  --seed S    default 1\n"
    "  --ticks N   default 20000\n"
    "  --length L  of the tool, m; default 0.3 for a mesh with a diagonal of 0.35 m, scaled with "
    "it\n"
    "  --band B    how far above and below the surface it is held, m; default 0.005, scaled\n"
    "  --speed V   mean speed over the surface, m/s; default 0.3, scaled\n";

struct trace_hand {
    const dpt_mesh *mesh;
    uint64_t random;
    double length, band, speed;
    vec3 at, normal; /* the point on the surface, in the mesh's frame, and the smoothed normal */
    vec3 heading;    /* direction in which the point wanders */
    vec3 axis;       /* direction of the tool */
    double phase[4]; /* of the slow changes, in turns */
};

static double random01(struct trace_hand *hand)
{
    hand->random = hand->random * 6364136223846793005u + 1442695040888963407u;
    return (double)(hand->random >> 11) * 0x1p-53;
}

static double wave(double turns)
{
    double sine, cosine;
    turn_sincos(turns, &sine, &cosine);
    return sine;
}

static vec3 unit_or(vec3 v, vec3 otherwise)
{
    double size = length(v);
    return size > 1e-12 ? scaled(v, 1.0 / size) : otherwise;
}

static vec3 flattened(vec3 v, vec3 normal, double share)
{
    return along(v, -share * dot(v, normal), normal);
}

/* The nearest point of the mesh, and its triangle's normal. */
static vec3 drop_on_mesh(const struct trace_hand *hand, vec3 x, vec3 *normal)
{
    dpt_hit hit = DPT_HIT_INIT;
    double corners[9] = { 0 };
    const double ends[6] = { x.x, x.y, x.z, x.x, x.y, x.z };
    dpt_query_segments(hand->mesh, NULL, ends, NULL, 1, &hit, NULL);
    dpt_mesh_get_triangle(hand->mesh, hit.triangle, corners);
    vec3 a = vec3_of(corners);
    vec3 n = cross(sub(vec3_of(corners + 3), a), sub(vec3_of(corners + 6), a));
    *normal = unit_or(n, (vec3){ 0.0, 0.0, 1.0 });
    return vec3_of(hit.q);
}

static void hand_begin(struct trace_hand *hand, const dpt_mesh_info *info)
{
    vec3 low = vec3_of(info->box_min), high = vec3_of(info->box_max);
    vec3 middle = scaled(add(low, high), 0.5), half = scaled(sub(high, low), 0.5);
    vec3 outside = { middle.x + half.x * (2.0 * random01(hand) - 1.0),
                     middle.y + half.y * (2.0 * random01(hand) - 1.0), high.z };
    for (int i = 0; i < 4; i++)
        hand->phase[i] = random01(hand);
    hand->at = drop_on_mesh(hand, outside, &hand->normal);
    vec3 any = { random01(hand) - 0.5, random01(hand) - 0.5, random01(hand) - 0.5 };
    hand->heading = unit_or(flattened(any, hand->normal, 1.0), (vec3){ 1.0, 0.0, 0.0 });
    hand->axis = unit_or(cross(hand->heading, hand->normal), (vec3){ 0.0, 1.0, 0.0 });
}

static void hand_move(struct trace_hand *hand, double time)
{
    vec3 face;
    double pace = hand->speed * (1.0 + 0.67 * wave(0.31 * time + hand->phase[0]));
    hand->at = drop_on_mesh(hand, along(hand->at, 1e-3 * pace, hand->heading), &face);
    hand->normal = unit_or(along(scaled(hand->normal, 0.97), 0.03, face), face);
    vec3 left = cross(hand->normal, hand->heading);
    double bend = 0.02 * (random01(hand) - 0.5) + 0.002 * wave(0.17 * time + hand->phase[1]);
    hand->heading = unit_or(flattened(along(hand->heading, bend, left), hand->normal, 1.0), left);
    vec3 drift = cross(hand->normal, hand->axis);
    double turn = 0.002 * wave(0.23 * time + hand->phase[2]);
    double tilt = 0.04 * wave(0.19 * time + hand->phase[3]);
    vec3 lifted = along(along(hand->axis, turn, drift), 0.02 * tilt, hand->normal);
    hand->axis = unit_or(flattened(lifted, hand->normal, 0.02), drift);
}

static void hand_ends(const struct trace_hand *hand, double time, double ends[6])
{
    double height = hand->band * (0.35 + 0.65 * wave(0.71 * time + hand->phase[3]));
    double share = 0.5 + 0.45 * wave(0.13 * time + hand->phase[1]);
    vec3 touching = along(hand->at, height, hand->normal);
    vec3_store(along(touching, -share * hand->length, hand->axis), ends);
    vec3_store(along(touching, (1.0 - share) * hand->length, hand->axis), ends + 3);
}

static int write_trace(struct trace_hand *hand, uint64_t ticks, const char *out)
{
    struct output output;
    struct meter meter = { .began = 0 };
    int status = output_open(&output, "make trace", out);
    if (status)
        return status;
    fputs("tick,ax,ay,az,bx,by,bz\n", output.file);
    for (uint64_t tick = 0; tick < ticks; tick++) {
        double ends[6], time = 1e-3 * (double)tick;
        if (tick % 1024 == 0)
            meter_show(&meter, "make trace", (double)tick / (double)ticks);
        hand_move(hand, time);
        hand_ends(hand, time, ends);
        fprintf(output.file, "%" PRIu64 ",%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", tick, ends[0],
                ends[1], ends[2], ends[3], ends[4], ends[5]);
    }
    meter_show(&meter, "", 1.0);
    return output_close(&output, "make trace");
}

int command_make_trace(int argc, char **argv)
{
    const char *mesh_path = NULL, *out = NULL, *operand;
    struct trace_hand hand = { .length = 0.0 };
    uint64_t ticks = 20000, seed = 1;
    size_t operands;
    static char whole_name[] = "make trace";
    argv[0] = whole_name;
    const struct option_def options[] = {
        { .name = "--mesh", .text = &mesh_path },       { .name = "-o", .text = &out },
        { .name = "--seed", .count = &seed },           { .name = "--ticks", .count = &ticks },
        { .name = "--length", .number = &hand.length }, { .name = "--band", .number = &hand.band },
        { .name = "--speed", .number = &hand.speed },
    };
    int status = parse_options(argc, argv, options, sizeof options / sizeof *options, help,
                               &operand, 1, &operands);
    if (status >= 0)
        return status;
    if (!mesh_path || !out || operands)
        return complain("make trace", "--mesh FILE.dpa and -o TRACE.csv are needed (see --help)");
    if (output_check("make trace", out, (const char *const[]){ mesh_path, NULL }))
        return 2;
    const double limit = DPT_COORDINATE_MAX;
    if (!ticks)
        return complain("make trace", "--ticks must be 1 or more");
    if (!(hand.length >= 0.0 && hand.length <= limit) ||
        !(hand.band >= 0.0 && hand.band <= limit) || !(hand.speed >= 0.0 && hand.speed <= limit))
        return complain("make trace", "--length, --band and --speed must be 0 to 1e6");

    void *bytes;
    dpt_mesh_info info = { .size = sizeof info };
    hand.mesh = load_mesh("make trace", mesh_path, &bytes);
    if (!hand.mesh)
        return 2;
    dpt_mesh_get_info(hand.mesh, &info);
    double scale = length(sub(vec3_of(info.box_max), vec3_of(info.box_min))) / 0.35;
    hand.length = hand.length > 0.0 ? hand.length : 0.3 * scale;
    hand.band = hand.band > 0.0 ? hand.band : 0.005 * scale;
    hand.speed = hand.speed > 0.0 ? hand.speed : 0.3 * scale;
    hand.random = seed * 0x9e3779b97f4a7c15u + 1;
    hand_begin(&hand, &info);
    status = write_trace(&hand, ticks, out);
    free(bytes);
    return status;
}
