/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Force error against time a tick of a needle that a hand pushes into a box, holds still with a tremor, and draws out:
 * dynpoint's, with budgets, beside two small peers that are written here from what is usually done.
 *
 *   penalty needle   nodes along the shaft. Each asks in each tick whether it is inside; those that are rub, and are pulled
 *                    to the line that was the needle's when it punctured
 *   sticking ray     a ray from the rear end to the tip. Where it first goes in, its entry sticks; the depth is from there
 *                    to the tip, and the needle is pulled sideways to the entry
 *
 * Both are at the device, and rub by the direction of its velocity, smoothed below 1 mm/s, as friction without a state is.
 * The truth is the stated law (docs/algorithms/insertion.md) along the line, integrated here by 200 substeps a tick, and K
 * times the device's way off the line across it. A CSV: method, setting, median and 99 % of a tick's ns, root mean square
 * and largest of the error, N, and the root mean square while the needle goes in. Times are the least of three passes.
 *
 *     needle_peers [TRIANGLES=19200]
 */
#define _GNU_SOURCE
#include <math.h>
#include <stdio.h>

#include "dynpoint/insertion.h"
#include "dynpoint/query.h"
#include "lib/solid.h"
#include "timing.h"

enum { TICKS = 7000, SUBSTEPS = 200, PASSES = 3, NODES_MAX = 128, GOING_FROM = 800, GOING_TO = 2400 };

#define DT        1e-3
#define STIFFNESS 500.0
#define LENGTH    0.1
#define RADIUS    0.0005
#define TOP       0.04
#define PUNCTURE  1.0
#define CUTTING   0.5
#define FRICTION  40.0
#define BRISTLES  (FRICTION / 1e-5)
#define SMOOTH    1e-3

/* The device's tip: how deep beneath the top, and beside the line along x, m. */
static double depth_of[TICKS], beside_of[TICKS];
static const double line[2] = { 0.011, 0.007 };

static void make_motion(void)
{
    uint64_t seed = 5;
    for (int i = 0; i < TICKS; i++) {
        const double t = i * DT;
        const double ramp = t < 2.5 ? 0.02 * t - 0.005 : t < 4.0 ? 0.045 : 0.045 - 0.02 * (t - 4.0);
        depth_of[i] = fmax(-0.005, ramp) + 2e-5 * sin(6.283185307179586 * 9.0 * t) + random_in(&seed, -2e-6, 2e-6);
        beside_of[i] = depth_of[i] > 0.006 ? 3e-4 * sin(6.283185307179586 * 1.5 * t) : 0.0;
    }
}

struct force {
    double along, across; /* N: against going in; along x */
};

static struct force truth[TICKS];

/* K (d - x) = bristles' friction over what is inside + cutting: the place x by bisection, in small steps. */
static void find_truth(void)
{
    double x = 0, anchor = 0, deepest = 0, was = depth_of[0];
    int is_in = 0;
    for (int i = 0; i < TICKS; i++) {
        double pull = 0;
        for (int k = 1; k <= SUBSTEPS; k++) {
            const double device = was + (depth_of[i] - was) * k / SUBSTEPS;
            if (!is_in) {
                pull = device > 0 ? STIFFNESS * device : 0;
                if (pull >= PUNCTURE)
                    is_in = 1, x = anchor = deepest = 0;
                continue;
            }
            double low = -0.01, high = 0.1;
            for (int n = 0; n < 50; n++) {
                const double middle = 0.5 * (low + high), inside = fmax(0, anchor);
                const double most = fmin(FRICTION / BRISTLES, 0.5 * inside);
                const double stretch = fmin(most, fmax(-most, middle - anchor));
                const double resists = inside * BRISTLES * stretch + (middle > deepest ? CUTTING : 0);
                *(STIFFNESS * (device - middle) > resists ? &low : &high) = middle;
            }
            x = low;
            const double most = fmin(FRICTION / BRISTLES, 0.5 * fmax(0, anchor));
            anchor = fmin(x + most, fmax(x - most, anchor));
            deepest = fmax(deepest, x);
            pull = STIFFNESS * (device - x);
            if (x <= 0) {
                x = anchor = 0;
                pull = device > 0 ? pull : 0;
            }
        }
        was = depth_of[i];
        truth[i] = (struct force){ pull, is_in && x > 0 ? -STIFFNESS * beside_of[i] : 0 };
    }
}

static void ends_of(int i, double ends[6])
{
    const double tip = TOP - depth_of[i], x = line[0] + beside_of[i];
    const double made[6] = { x, line[1], tip + LENGTH, x, line[1], tip };
    memcpy(ends, made, sizeof made);
}

/* ---- a peer's state, and a tick ---- */

struct peer {
    const dpt_mesh *mesh;
    int nodes, is_in;
    double entry[3], deepest, was;
};

static double direction_of(const struct peer *peer, double depth)
{
    return tanh((depth - peer->was) / DT / SMOOTH);
}

static struct force at_wall(struct peer *peer, int is_inside, double depth)
{
    const double push = is_inside ? STIFFNESS * fmax(0, depth) : 0;
    peer->is_in = push >= PUNCTURE;
    peer->deepest = 0;
    return (struct force){ push, 0 };
}

static double cutting_of(struct peer *peer, double depth)
{
    const double cuts = depth > peer->deepest ? CUTTING : 0;
    peer->deepest = fmax(peer->deepest, depth);
    return cuts;
}

static struct force penalty_needle(struct peer *peer, int i)
{
    double ends[6], nodes[6 * NODES_MAX];
    dpt_hit hits[NODES_MAX];
    int inside = 0;
    ends_of(i, ends);
    for (int n = 0; n < peer->nodes; n++) {
        hits[n] = (dpt_hit)DPT_HIT_INIT;
        for (int k = 0; k < 6; k++)
            nodes[6 * n + k] = ends[3 + k % 3] + (ends[k % 3] - ends[3 + k % 3]) * n / peer->nodes;
    }
    dpt_query_segments(peer->mesh, NULL, nodes, NULL, (size_t)peer->nodes, hits, NULL);
    for (int n = 0; n < peer->nodes; n++)
        inside += hits[n].contact == DPT_CONTACT_PENETRATING;
    const double depth = depth_of[i];
    if (!peer->is_in)
        return at_wall(peer, inside > 0, depth);
    const double rubs = FRICTION * LENGTH / peer->nodes * inside * direction_of(peer, depth);
    const struct force force = { rubs + (inside ? cutting_of(peer, depth) : 0),
                                 inside ? -STIFFNESS * (ends[3] - line[0]) : 0 };
    peer->is_in = inside > 0;
    return force;
}

static struct force sticking_ray(struct peer *peer, int i)
{
    double ends[6];
    dpt_hit hit = DPT_HIT_INIT;
    ends_of(i, ends);
    dpt_query_segments(peer->mesh, NULL, ends, NULL, 1, &hit, NULL);
    const int meets = hit.distance == 0.0;
    if (!peer->is_in) {
        if (meets)
            memcpy(peer->entry, hit.q, sizeof peer->entry);
        return at_wall(peer, meets, depth_of[i]);
    }
    const double depth = sqrt((ends[3] - peer->entry[0]) * (ends[3] - peer->entry[0]) +
                              (ends[4] - peer->entry[1]) * (ends[4] - peer->entry[1]) +
                              (ends[5] - peer->entry[2]) * (ends[5] - peer->entry[2]));
    peer->is_in = meets;
    if (!meets)
        return (struct force){ 0, 0 };
    return (struct force){ FRICTION * depth * direction_of(peer, depth_of[i]) + cutting_of(peer, depth),
                           -STIFFNESS * (ends[3] - peer->entry[0]) };
}

/* ---- what is measured ---- */

static double least_ns[TICKS], error_of[TICKS];

static void note(int pass, int i, double ns, struct force force)
{
    least_ns[i] = pass == 0 ? ns : fmin(least_ns[i], ns);
    error_of[i] = hypot(force.along - truth[i].along, force.across - truth[i].across);
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void print_row(const char *method, int setting)
{
    double sum = 0, going = 0, most = 0;
    for (int i = 0; i < TICKS; i++) {
        sum += error_of[i] * error_of[i];
        going += i >= GOING_FROM && i < GOING_TO ? error_of[i] * error_of[i] : 0;
        most = fmax(most, error_of[i]);
    }
    qsort(least_ns, TICKS, sizeof *least_ns, by_value);
    printf("%s,%d,%.0f,%.0f,%.6f,%.6f,%.6f\n", method, setting, least_ns[TICKS / 2], least_ns[TICKS * 99 / 100],
           sqrt(sum / TICKS), sqrt(going / (GOING_TO - GOING_FROM)), most);
}

static void run_peer(const dpt_mesh *mesh, const char *name, struct force (*tick)(struct peer *peer, int i), int nodes)
{
    for (int pass = 0; pass < PASSES; pass++) {
        struct peer peer = { .mesh = mesh, .nodes = nodes, .was = depth_of[0] };
        for (int i = 0; i < TICKS; i++) {
            const double begin = now();
            const struct force force = tick(&peer, i);
            peer.was = depth_of[i];
            note(pass, i, now() - begin, force);
        }
    }
    print_row(name, nodes);
}

static void run_dynpoint(const dpt_mesh *mesh, uint32_t budget)
{
    static const dpt_segment shaft = { { 0, 0, 0 }, { 0, 0, LENGTH }, RADIUS };
    const dpt_body_settings gel = {
        .size = sizeof gel, .puncture_force = PUNCTURE, .cutting_force = CUTTING, .shaft_friction = FRICTION
    };
    dpt_tool_settings sharp = { .size = sizeof sharp };
    dpt_world_def def;
    dpt_world *world;
    dpt_body body;
    dpt_tool tool;
    dpt_world_def_init(&def);
    def.max_channels = 4;
    def.budget = budget;
    void *block = malloc(dpt_world_bytes(&def));
    if (!block || dpt_world_create(block, dpt_world_bytes(&def), &def, &world) ||
        dpt_body_add(world, mesh, NULL, &body) || dpt_tool_add(world, &shaft, 1, &tool) ||
        dpt_body_set_settings(world, body, &gel) || dpt_tool_get_settings(world, tool, &sharp))
        exit(2);
    sharp.piercing = DPT_PIERCING_B;
    sharp.stiffness = STIFFNESS;
    if (dpt_tool_set_settings(world, tool, &sharp))
        exit(2);
    for (int pass = 0; pass < PASSES; pass++) {
        dpt_world_reset(world);
        for (int i = 0; i < TICKS; i++) {
            double ends[6];
            dpt_wrench wrench = { { 0 }, { 0 } };
            ends_of(i, ends);
            const dpt_pose pose = { { ends[0], ends[1], ends[2] }, { 0, 1, 0, 0 } };
            const double begin = now();
            dpt_tool_set_pose(world, tool, &pose);
            dpt_world_step(world, DT, NULL);
            dpt_tool_get_wrench(world, tool, &wrench);
            note(pass, i, now() - begin, (struct force){ wrench.force[2], wrench.force[0] });
        }
    }
    print_row("dynpoint", (int)budget);
    free(block);
}

int main(int argc, char **argv)
{
    static const int nodes[] = { 8, 32, 128 };
    static const uint32_t budgets[] = { 0, 100, 20 };
    struct solid box;
    if (!solid_from_shape(&box, "box", argc > 1 ? strtoull(argv[1], NULL, 10) : 19200))
        return 2;
    make_motion();
    find_truth();
    puts("method,setting,ns,ns_99,rms,rms_going,max");
    for (int i = 0; i < 3; i++)
        run_dynpoint(box.mesh, budgets[i]);
    for (int i = 0; i < 3; i++)
        run_peer(box.mesh, "penalty", penalty_needle, nodes[i]);
    run_peer(box.mesh, "ray", sticking_ray, 1);
    solid_close(&box);
    return 0;
}
