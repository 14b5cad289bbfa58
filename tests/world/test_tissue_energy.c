/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What tool and tissue exchange where they are solved together makes no energy but what missing gaps need. A tick is seen in
 * two parts: the device moves while the spring's end stays where it was, then the spring's end moves to where the new wrench
 * says that it is. Ways are from the proxy, straight as the problem's rows are. With the device at d, the end at e0 and
 * then at e1, and pairs that push with p,
 *
 *     the spring gives      K/2 |d - e0|^2 - K/2 |d - e1|^2,
 *     in which is lost      K/2 |e1 - e0|^2,
 *     the tissue receives   what is given - what is lost + the sum of p (b - g).
 *
 * g is a pair's gap, beyond the clearance, at e0 and with the surface before the step: with EULER where it goes in this
 * step, as loads decide where it goes in the next one. b is the gap that is asked for: 0, or 4/5 g where g is negative. So
 * where g >= 0 the sum takes energy away; where a gap is missing, a fifth of that is made good, and p times it is all that
 * the tissue may receive beyond what is given.
 *
 * e0 is where the last step left the tool, after it gave way to the surface as that is then. That motion stretches the
 * spring, or slackens it, between two ticks: it is no part of what tissue receives for it, and is summed by itself.
 *
 *     test_tissue_energy [PER CENT = 100, of a million ticks]
 */
#include "world/tissue_rig.h"
#include "world/tissue_triangle.h"

enum { TICKS = 400, GAMES = 2500, ROOM = 3 * 4096 };

/* The share of a missing gap that is made good in a substep. */
#define RECOVERED 0.2

/* J: what a tick may be off by. */
#define ROUNDING 1e-9

/* The axis of a tool as its two ends: the middle, and half of it. */
struct axis {
    double middle[3], half[3];
};

static struct axis axis_at(const struct tissue_tool *tool, const dpt_pose *pose)
{
    struct axis axis;
    double ends[6];
    pose_ends(pose, &tool->segment, ends);
    for (int k = 0; k < 3; k++) {
        axis.middle[k] = 0.5 * (ends[k] + ends[3 + k]);
        axis.half[k] = 0.5 * (ends[3 + k] - ends[k]);
    }
    return axis;
}

/* The rotation vector of the least turn between two axes. */
static void turn_between(const struct axis *from, const struct axis *to, double turn[3])
{
    cross3(from->half, to->half, turn);
    const double sine = length3(turn), angle = atan2(sine, dot3(from->half, to->half));
    for (int k = 0; k < 3 && sine > 0.0; k++)
        turn[k] *= angle / sine;
}

/* From a tool's proxy to another place of its axis: the shift, and the turn times rho. */
static void way_between(const struct tissue_tool *tool, const struct axis *proxy, const struct axis *to, double way[6])
{
    turn_between(proxy, to, way + 3);
    for (int k = 0; k < 3; k++) {
        way[k] = to->middle[k] - proxy->middle[k];
        way[3 + k] *= tool->rho;
    }
}

static struct axis axis_moved(const struct tissue_tool *tool, const struct axis *proxy, const double way[6])
{
    struct axis axis = *proxy;
    const double size = length3(way + 3), angle = size > 0.0 ? size / tool->rho : 0.0;
    double turn[4] = { cos(0.5 * angle), 0.0, 0.0, 0.0 };
    for (int k = 0; k < 3; k++) {
        axis.middle[k] += way[k];
        turn[1 + k] = size > 0.0 ? sin(0.5 * angle) * way[3 + k] / size : 0.0;
    }
    turn3(turn, proxy->half, axis.half);
    return axis;
}

/* J: of the spring between two ways' ends. */
static double energy_between(const struct tissue_tool *tool, const double a[6], const double b[6])
{
    const double shift = apart(a, b), turn = apart(a + 3, b + 3);
    return 0.5 * tool->stiffness * (shift * shift + turn * turn);
}

/*
 * Where the spring ends that gives the wrench, whose levers are about the proxy, as the pairs' are. About its own axis the
 * tool does not turn: what pushes do about it, beside a surface that moves across, stretches no spring.
 */
static void find_end(const struct tissue_tool *tool, const struct axis *proxy, const double device[6], double end[6])
{
    const dpt_wrench *wrench = &tool->force.wrench;
    const double square = dot3(proxy->half, proxy->half);
    double arm[3], torque[3];
    for (int k = 0; k < 3; k++)
        arm[k] = tool->device.position[k] - proxy->middle[k];
    cross3(arm, wrench->force, torque);
    for (int k = 0; k < 3; k++)
        torque[k] += wrench->torque[k];
    const double spin = square > 0.0 ? dot3(torque, proxy->half) / square : 0.0;
    for (int k = 0; k < 3; k++) {
        end[k] = device[k] + wrench->force[k] / tool->stiffness;
        end[3 + k] = device[3 + k];
        if (tool->rho > 0.0)
            end[3 + k] += (torque[k] - spin * proxy->half[k]) / (tool->stiffness * tool->rho);
    }
}

/* The surface before a step, how far it is foreseen to move, and its nodes before and after it. */
struct surface {
    float vertex[ROOM];
    double ahead[ROOM], from[ROOM], to[ROOM];
};

/*
 * J: the loads that are told, times how far their nodes went; with EULER how far they go in the step after, which is what
 * these loads decide.
 */
static double received_by(const struct tissue_rig *tissue, const struct surface *surface)
{
    static dpt_load loads[4 * TISSUE_LOADS];
    static float positions[ROOM], speeds[ROOM];
    const struct tissue_body *body = &tissue->body[0];
    const uint32_t *nodes;
    const float *weights;
    uint32_t count = 0, nodes_count = dpt_springs_get_count(body->springs), embedded;
    double sum = 0.0;
    dpt_mesh_get_embedding(body->mesh.mesh, &nodes, &weights, &embedded);
    const dpt_result result =
        nodes ? dpt_body_get_node_loads(tissue->rig.world, body->id, loads, 4 * TISSUE_LOADS, &count)
              : dpt_body_get_loads(tissue->rig.world, body->id, loads, 4 * TISSUE_LOADS, &count);
    CHECK(result == DPT_OK, "loads: %s", dpt_result_name(result));
    dpt_springs_get_nodes(body->springs, nodes_count, positions, speeds);
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t at = 3 * loads[i].vertex + k;
            sum += loads[i].force[k] * (body->integrator == DPT_INTEGRATOR_EULER ? tissue->rig.dt * (double)speeds[at]
                                                                                 : surface->to[at] - surface->from[at]);
        }
    return sum;
}

/* A point of a triangle, by its source number: how far it is foreseen to move, and how it went in the step. */
static void point_motion(const struct tissue_body *body, const struct surface *surface, uint32_t number,
                         const double q[3], double ahead[3], double motion[3])
{
    const uint32_t *corners, *numbers, *nodes;
    const float *weights;
    uint32_t count, embedded, t = 0;
    double v[3][3], weight[3];
    dpt_mesh_get_triangles(body->mesh.mesh, &corners, &numbers, &count);
    dpt_mesh_get_embedding(body->mesh.mesh, &nodes, &weights, &embedded);
    while (t + 1 < count && numbers[t] != number)
        t++;
    for (int k = 0; k < 9; k++)
        v[k / 3][k % 3] = (double)surface->vertex[3 * corners[3 * t + (uint32_t)k / 3] + (uint32_t)k % 3];
    for (int k = 0; k < 3; k++)
        ahead[k] = motion[k] = 0.0;
    weights_at(q, v, weight);
    for (uint32_t i = 0; i < 3; i++) {
        const uint32_t vertex = corners[3 * t + i];
        for (uint32_t k = 0; k < 3; k++)
            ahead[k] += weight[i] * surface->ahead[3 * vertex + k];
        for (uint32_t m = 0; m < (nodes ? 4u : 1u); m++) {
            const uint32_t node = nodes ? nodes[4 * vertex + m] : vertex;
            const double share = weight[i] * (nodes ? (double)weights[4 * vertex + m] : 1.0);
            for (uint32_t k = 0; k < 3; k++)
                motion[k] += share * (surface->to[3 * node + k] - surface->from[3 * node + k]);
        }
    }
}

/* J: pushes times how far gaps were from what is asked for, and times what is made good of those that were deep. */
struct begun {
    double all, regained;
};

/* m: from a point on the surface to the tool's axis along a pair's normal: to its nearest point there, or to an end. */
static double distance_along(const struct axis *axis, const double q[3], const double normal[3])
{
    const double square = dot3(axis->half, axis->half);
    double from[3], distance = 0.0, best = -1.0;
    for (int k = 0; k < 3; k++)
        from[k] = axis->middle[k] - q[k];
    const double s[3] = { square > 0.0 ? fmin(fmax(-dot3(from, axis->half) / square, -1.0), 1.0) : 0.0, -1.0, 1.0 };
    for (int i = 0; i < 3; i++) {
        double to[3];
        for (int k = 0; k < 3; k++)
            to[k] = from[k] + s[i] * axis->half[k];
        if (dot3(to, normal) > best * length3(to)) {
            distance = length3(to);
            best = dot3(to, normal) / distance;
        }
    }
    return distance;
}

/* How each pair that pushes began: its gap with the tool at the end of `last`, a way from the proxy, by the pair's own row. */
static struct begun begun_of(const struct tissue_rig *tissue, const double last[6], const struct axis *proxy,
                             const struct surface *surface)
{
    const struct tissue_tool *tool = &tissue->tool[0];
    const double kept = tool->segment.radius + tissue_clearance(tissue);
    dpt_tool_load loads[64];
    uint32_t count = 0;
    struct begun begun = { 0.0, 0.0 };
    loads[0].size = sizeof *loads;
    dpt_tool_get_loads(tissue->rig.world, tool->id, loads, 64, &count);
    CHECK(count <= 64, "%u loads", count);
    for (uint32_t i = 0; i < count && i < 64; i++) {
        const double push = length3(loads[i].force), *q = loads[i].point;
        double arm[3], swing[3], normal[3], ahead[3], motion[3], foreseen[3];
        for (int k = 0; k < 3; k++) {
            arm[k] = q[k] - proxy->middle[k];
            normal[k] = loads[i].force[k] / push;
        }
        cross3(last + 3, arm, swing);
        point_motion(&tissue->body[0], surface, loads[i].triangle, q, ahead, motion);
        for (int k = 0; k < 3; k++)
            foreseen[k] = q[k] + ahead[k];
        double gap = distance_along(proxy, foreseen, normal) - kept + dot3(normal, ahead) + dot3(normal, last);
        if (tissue->body[0].integrator == DPT_INTEGRATOR_EULER)
            gap -= dot3(normal, motion);
        if (tool->rho > 0.0)
            gap += dot3(normal, swing) / tool->rho;
        begun.all += push * (gap - (1.0 - RECOVERED) * fmin(gap, 0.0));
        begun.regained += push * RECOVERED * fmax(-gap, 0.0);
    }
    return begun;
}

struct seen {
    uint64_t ticks, touched;
    uint32_t substeps;                         /* the most */
    double worst;                              /* J: what the tissue received beyond what it may */
    double off;                                /* J: what the balance of a tick is off by */
    double apart;                              /* J: between the spring's energy as it is told, and by the wrench */
    double received, given, regained, settled; /* J: sums */
};

static void play(struct tissue_rig *tissue, uint64_t *seed, int ticks, struct seen *seen)
{
    static struct surface surface;
    uint32_t count = 0;
    struct tissue_tool *tool = &tissue->tool[0];
    const double height = tool->device.position[2], depth = random_in(seed, 0.001, 0.008),
                 rate = random_in(seed, 3.0, 25.0);
    double way[3] = { 0.0, 0.0, 0.0 };
    tissue_rig_place(tissue);
    struct axis told = axis_at(tool, &tool->device);
    for (int i = 0; i < ticks; i++) {
        dpt_pose pose;
        double at_device[6], at_told[6], at_last[6], at_end[6];
        const double tilt = random_bits(seed) % 2 ? 1e-3 : 0.0;
        const double turn[4] = { 1.0, random_in(seed, -tilt, tilt), random_in(seed, -tilt, tilt),
                                 random_in(seed, -tilt, tilt) };
        const double most = random_bits(seed) % 64 ? 2.5e-5 : 5e-4;
        for (int k = 0; k < 3; k++)
            way[k] = 0.8 * way[k] + random_in(seed, -most, most);
        for (int k = 0; k < 2; k++)
            tool->device.position[k] = fmin(fmax(tool->device.position[k] + way[k], -0.03), 0.03);
        tool->device.position[2] = height + 0.001 - (depth + 0.002) * fabs(sin(rate * (i + 1) / TICKS)) + way[2];
        pose_turn_by(&tool->device, turn);
        tissue_nodes(&tissue->body[0], surface.from);
        tissue_rig_step_world(tissue);
        const dpt_pose left = tissue_tool_last_end(tissue, tool);
        const struct axis device = axis_at(tool, &tool->device), last = axis_at(tool, &left);
        const float *vertices = tissue_vertices(tissue, &tissue->body[0], &count);
        memcpy(surface.vertex, vertices, 3 * count * sizeof *vertices);
        tissue_foresee(tissue, &tissue->body[0], 1, tool->segment.radius, surface.ahead);
        dpt_tool_get_proxy(tissue->rig.world, tool->id, &pose);
        tissue_rig_step_springs(tissue);
        if (tissue->result != DPT_OK)
            return;
        seen->substeps = tissue->info[0].substeps > seen->substeps ? tissue->info[0].substeps : seen->substeps;
        tissue_nodes(&tissue->body[0], surface.to);
        const struct axis proxy = axis_at(tool, &pose);
        way_between(tool, &proxy, &device, at_device);
        way_between(tool, &proxy, &told, at_told);
        way_between(tool, &proxy, &last, at_last);
        find_end(tool, &proxy, at_device, at_end);
        told = axis_moved(tool, &proxy, at_end);
        const double before = energy_between(tool, at_device, at_last),
                     energy = energy_between(tool, at_device, at_end);
        const double given = before - energy, lost = energy_between(tool, at_last, at_end);
        const double received = received_by(tissue, &surface);
        const struct begun begun = begun_of(tissue, at_last, &proxy, &surface);
        seen->off = fmax(seen->off, fabs(received + lost + begun.all - given));
        seen->worst = fmax(seen->worst, received - given - begun.regained);
        seen->apart = fmax(seen->apart, fabs(tool->force.energy - energy));
        seen->settled += before - energy_between(tool, at_device, at_told);
        seen->received += received;
        seen->given += given;
        seen->regained += begun.regained;
        seen->touched += tool->force.reason == DPT_FORCE_ACTS;
        seen->ticks++;
    }
}

static const dpt_segment tools[] = { { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 }, 0.006 },
                                     { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.06 }, 0.004 },
                                     { { -0.03, 0.0, 0.0 }, { 0.03, 0.0, 0.0 }, 0.004 } };

static int add_all(struct tissue_rig *tissue, const struct tissue_def *def, uint64_t *seed)
{
    const double axis[3] = { 0.0, 1.0, 0.0 };
    const uint64_t which = random_bits(seed) % 3;
    if (!tissue_rig_add_soft(tissue, def))
        return 0;
    struct tissue_tool *tool = tissue_rig_add_tool(tissue, &tools[which], random_in(seed, 200.0, 2000.0));
    tool->device.position[2] = tissue->body[0].top + tool->segment.radius + 0.001;
    pose_orient(&tool->device, axis, which == 1 ? random_in(seed, 0.0, 1.2) : 0.0);
    return 1;
}

/* Nodes of 1e-6 to 1 kg, steps of 0.1 to 10 ms, springs as stiff as these allow in so many substeps. */
static int make_game(struct tissue_rig *tissue, uint64_t *seed, double substeps, double load_radius)
{
    const int is_sheet = (int)(random_bits(seed) & 1);
    const double dt = pow(10.0, random_in(seed, -4.0, -2.0));
    struct tissue_def def = is_sheet ? tissue_sheet() : tissue_ball();
    def.integrator = random_bits(seed) % 3 ? DPT_INTEGRATOR_SYMPLECTIC : DPT_INTEGRATOR_EULER;
    def.triangles = is_sheet ? 200 : 320;
    def.spacing = 0.025;
    def.density = 1000.0 * pow(10.0, random_in(seed, -3.0, 3.0));
    def.drag = random_bits(seed) & 1 ? 0.0 : pow(10.0, random_in(seed, -1.0, 1.5));
    def.step = dt / substeps;
    def.load_radius = load_radius;
    def.viscosity = def.integrator == DPT_INTEGRATOR_EULER ? 1.5 * def.step
                    : random_bits(seed) & 1                ? 0.0
                                                           : 0.2 * def.step;
    tissue->rig.dt = dt;
    return add_all(tissue, &def, seed);
}

/* Tissue that is damped, and that may sleep, and over which loads may be spread. */
static int make_round(struct tissue_rig *tissue, uint64_t game, uint64_t *seed)
{
    struct tissue_def def = game & 1 ? tissue_sheet() : tissue_ball();
    def.integrator = game & 2 ? DPT_INTEGRATOR_EULER : DPT_INTEGRATOR_SYMPLECTIC;
    def.sleeps = (int)(game & 4);
    def.load_radius = game & 8 ? random_in(seed, 0.01, 0.05) : 0.0;
    return add_all(tissue, &def, seed);
}

static void the_tissue_receives_no_more_than_is_given(void)
{
    struct seen seen = { 0 };
    for (uint64_t game = 0; game < part_of(GAMES); game++) {
        struct tissue_rig tissue;
        uint64_t seed = 100 + game;
        tissue_rig_open(&tissue);
        if (make_game(&tissue, &seed, 1.0, 0.0))
            play(&tissue, &seed, TICKS, &seen);
        tissue_rig_close(&tissue);
    }
    CHECK(seen.substeps == 1, "%u substeps", seen.substeps);
    CHECK(seen.worst <= ROUNDING, "a tick made %g J", seen.worst);
    CHECK(seen.apart <= ROUNDING, "the energy that is told is off by %g J", seen.apart);
    CHECK(seen.off <= ROUNDING, "the balance of a tick is off by %g J", seen.off);
    CHECK(seen.touched > seen.ticks / 4, "touched in %g ticks of %g", (double)seen.touched, (double)seen.ticks);
    printf("    %g ticks, %g with a force: received %.3g J of %.3g J, %.3g J for gaps, %.3g J of room, off by %.2g J\n",
           (double)seen.ticks, (double)seen.touched, seen.received, seen.given, seen.regained, seen.settled, seen.off);
}

/*
 * Where a tick has substeps the mean of their loads is told, which balances no single tick. Over many it does. With EULER it
 * is not told how far the loads of each substep lead.
 */
static void with_substeps_it_receives_no_more_in_all(void)
{
    uint32_t substeps = 0;
    for (uint64_t game = 0; game < part_of(400); game++) {
        struct tissue_rig tissue;
        struct seen seen = { 0 };
        uint64_t seed = 70000 + game;
        tissue_rig_open(&tissue);
        if (make_game(&tissue, &seed, random_in(&seed, 1.5, 6.0), 0.0) &&
            tissue.body[0].integrator == DPT_INTEGRATOR_SYMPLECTIC)
            play(&tissue, &seed, TICKS, &seen);
        tissue_rig_close(&tissue);
        CHECK(seen.received <= seen.given - seen.settled + ROUNDING, "game %g: received %g J of %g J", (double)game,
              seen.received, seen.given - seen.settled);
        substeps = seen.substeps > substeps ? seen.substeps : substeps;
    }
    CHECK(substeps > 2, "at most %u substeps", substeps);
}

/* Where loads are spread, no single tick is balanced, as the touched point rises unfelt. Over many it is. */
static void spread_loads_make_no_energy(void)
{
    for (uint64_t game = 0; game < part_of(400); game++) {
        struct tissue_rig tissue;
        struct seen seen = { 0 };
        uint64_t seed = 140000 + game;
        tissue_rig_open(&tissue);
        if (make_game(&tissue, &seed, 1.0, random_in(&seed, 0.01, 0.05)))
            play(&tissue, &seed, TICKS, &seen);
        tissue_rig_close(&tissue);
        CHECK(seen.received <= seen.given - seen.settled + ROUNDING, "game %g: received %g J of %g J", (double)game,
              seen.received, seen.given - seen.settled);
        CHECK(seen.touched > 0, "game %g: it is not touched", (double)game);
    }
}

/* Press in, wipe, out: what the spring gave the device in all, and the most that it stored, J. */
static void go_round(struct tissue_rig *tissue, uint64_t *seed, double *emitted, double *peak)
{
    enum { DOWN = 300, ACROSS = 500, UP = 360 };
    struct tissue_tool *tool = &tissue->tool[0];
    const double top = tool->device.position[2], depth = random_in(seed, 0.002, 0.005),
                 angle = random_in(seed, 0.0, 6.28);
    dpt_wrench last = { { 0.0 }, { 0.0 } };
    double from[3];
    memcpy(from, tool->device.position, sizeof from);
    tissue_rig_place(tissue);
    *emitted = *peak = 0.0;
    for (int i = 0; i < DOWN + ACROSS + UP; i++) {
        const double down = i < DOWN            ? (double)i / DOWN
                            : i < DOWN + ACROSS ? 1.0
                                                : (double)(DOWN + ACROSS + UP - i) / UP;
        const double across = 0.008 * fmin(fmax((double)(i - DOWN) / ACROSS, 0.0), 1.0);
        double at_device[6], at_end[6];
        dpt_pose pose;
        tool->device.position[0] = across * cos(angle);
        tool->device.position[1] = across * sin(angle);
        tool->device.position[2] = top - (depth + 0.001) * down;
        tissue_rig_step_world(tissue);
        dpt_tool_get_proxy(tissue->rig.world, tool->id, &pose);
        tissue_rig_step_springs(tissue);
        CHECK(tissue->result == DPT_OK, "%s", dpt_result_name(tissue->result));
        for (int k = 0; k < 3; k++) {
            *emitted += 0.5 * (last.force[k] + tool->force.wrench.force[k]) * (tool->device.position[k] - from[k]);
            from[k] = tool->device.position[k];
        }
        last = tool->force.wrench;
        const struct axis proxy = axis_at(tool, &pose), device = axis_at(tool, &tool->device);
        way_between(tool, &proxy, &device, at_device);
        find_end(tool, &proxy, at_device, at_end);
        *peak = fmax(*peak, energy_between(tool, at_device, at_end));
    }
    CHECK(!(length3(last.force) > 0.0), "%g N at the end", length3(last.force));
}

/* The largest share of what the spring stored that a closed path emits, of rounds of a kind. */
static double emitted_by(uint64_t games, int (*make)(struct tissue_rig *tissue, uint64_t game, uint64_t *seed),
                         double allowed)
{
    double worst = -HUGE_VAL;
    for (uint64_t game = 0; game < games; game++) {
        struct tissue_rig tissue;
        uint64_t seed = 7 + game;
        double emitted, peak;
        tissue_rig_open(&tissue);
        if (make(&tissue, game, &seed)) {
            go_round(&tissue, &seed, &emitted, &peak);
            CHECK(peak > 1e-9, "round %g: it stores %g J", (double)game, peak);
            CHECK(emitted <= allowed * peak, "round %g: emits %g J of %g J", (double)game, emitted, peak);
            worst = fmax(worst, emitted / peak);
        }
        tissue_rig_close(&tissue);
    }
    return worst;
}

static void closed_paths_emit_nothing(void)
{
    printf("    at most %.3g of the peak is emitted\n", emitted_by(part_of(64), make_round, 1e-3));
}

/* A ball without any damping, one as stiff as a substep allows, and one of IMPLICIT. */
static int make_free(struct tissue_rig *tissue, uint64_t game, uint64_t *seed)
{
    struct tissue_def def = tissue_ball();
    def.viscosity = def.drag = 0.0;
    def.step = game % 3 == 1 ? tissue->rig.dt : 0.0;
    def.integrator = game % 3 == 2 ? DPT_INTEGRATOR_IMPLICIT : DPT_INTEGRATOR_SYMPLECTIC;
    return add_all(tissue, &def, seed);
}

/*
 * A push acts on springs as they were at the beginning of a substep, and on the tool as the surface is at its end. Against
 * that tissue has a viscosity of its own while a tool touches it.
 */
static void closed_paths_on_undamped_tissue_emit_nothing(void)
{
    printf("    at most %.3g of the peak is emitted\n", emitted_by(9 * part_of(8), make_free, 1e-3));
}

/* J: of the springs and their nodes. */
static double energy_of(const struct tissue_rig *tissue)
{
    double elastic = 0.0, kinetic = 0.0;
    dpt_springs_get_energy(tissue->body[0].springs, &elastic, &kinetic);
    return elastic + kinetic;
}

/* J: how much of what a ball without drag stores is left, where a tool has pressed it and is gone, after a second. */
static double swing_left(double viscosity, double *begun)
{
    enum { PRESSED = 500, FREE = 1000 };
    const dpt_segment ball = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 }, 0.02 };
    struct tissue_def def = tissue_ball();
    struct tissue_rig tissue;
    double left = *begun = 0.0;
    def.viscosity = viscosity;
    def.drag = 0.0;
    tissue_rig_open(&tissue);
    if (tissue_rig_add_soft(&tissue, &def)) {
        struct tissue_tool *tool = tissue_rig_add_tool(&tissue, &ball, 500.0);
        const double top = tissue.body[0].top + ball.radius;
        tool->device.position[2] = top + 0.001;
        tissue_rig_place(&tissue);
        for (int i = 0; i < PRESSED; i++) {
            tool->device.position[2] = top - 2e-5 * i;
            tissue_rig_tick(&tissue);
        }
        *begun = energy_of(&tissue);
        tool->device.position[2] = top + 0.1;
        tissue_rig_place(&tissue);
        for (int i = 0; i < FREE; i++)
            CHECK(!(tissue_rig_tick(&tissue) > 0.0), "it is touched in tick %d", i);
        left = energy_of(&tissue);
    }
    tissue_rig_close(&tissue);
    return left;
}

static void what_is_let_go_swings_on(void)
{
    double begun;
    const double damped = swing_left(7.5e-4, &begun), left = swing_left(0.0, &begun);
    printf("    of %.3g J there are %.3g after a second, %.3g with 0.75 ms\n", begun, left, damped);
    CHECK(left > 0.5 * begun, "of %g J there are %g", begun, left);
    CHECK(damped < 0.1 * begun, "of %g J there are %g with viscosity", begun, damped);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(the_tissue_receives_no_more_than_is_given);
    TEST(with_substeps_it_receives_no_more_in_all);
    TEST(spread_loads_make_no_energy);
    TEST(closed_paths_emit_nothing);
    TEST(closed_paths_on_undamped_tissue_emit_nothing);
    TEST(what_is_let_go_swings_on);
    return check_report();
}
