/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What tool and tissue exchange where they are solved together makes no energy. A tick is seen in two parts: the device moves
 * while the spring's end stays where it was, then the spring's end moves to where the new wrench says that it is. What the
 * spring gives in the second part is at least what the tissue receives: the loads that are told, times the motion of their
 * nodes. The sums are the test's own.
 *
 *     test_tissue_energy [PER CENT = 100, of a million ticks]
 */
#include <float.h>

#include "world/tissue_rig.h"

enum { TICKS = 400, GAMES = 2500, ROOM = 3 * 4096 };

/* J: what a tick may be off by. */
#define ROUNDING 1e-9

/* Turns of a finite size are no straight motions: by this share of what is lost, in few ticks by more. */
#define TURNED      1e-3
#define TURNED_MOST 5e-2

/* The axis of a tool as its two ends: the middle, and half of it. */
struct axis {
    double middle[3], half[3];
};

static struct axis axis_of(const double ends[6])
{
    struct axis axis;
    for (int k = 0; k < 3; k++) {
        axis.middle[k] = 0.5 * (ends[k] + ends[3 + k]);
        axis.half[k] = 0.5 * (ends[3 + k] - ends[k]);
    }
    return axis;
}

static struct axis axis_at(const struct tissue_tool *tool, const dpt_pose *pose)
{
    double ends[6];
    pose_ends(pose, &tool->segment, ends);
    return axis_of(ends);
}

/* The rotation vector of the least turn between two axes. */
static void turn_between(const struct axis *from, const struct axis *to, double turn[3])
{
    cross3(from->half, to->half, turn);
    const double sine = length3(turn), angle = atan2(sine, dot3(from->half, to->half));
    for (int k = 0; k < 3 && sine > 0.0; k++)
        turn[k] *= angle / sine;
}

/* J: of the spring from a device to its end. */
static double energy_between(const struct tissue_tool *tool, const struct axis *device, const struct axis *end)
{
    double turn[3];
    const double shift = apart(device->middle, end->middle);
    turn_between(device, end, turn);
    return 0.5 * tool->stiffness * (shift * shift + tool->rho * tool->rho * dot3(turn, turn));
}

/* What is known of a tool after a tick. */
struct state {
    struct axis device, proxy, end;
    double energy;
};

/* Where the spring ends that gives the wrench; levers are about the proxy, as the pairs' are. */
static void find_end(const struct tissue_tool *tool, struct state *state)
{
    const dpt_wrench *wrench = &tool->force.wrench;
    double arm[3], torque[3], turn[4] = { 1.0, 0.0, 0.0, 0.0 };
    for (int k = 0; k < 3; k++) {
        arm[k] = tool->device.position[k] - state->proxy.middle[k];
        state->end.middle[k] = state->device.middle[k] + wrench->force[k] / tool->stiffness;
    }
    cross3(arm, wrench->force, torque);
    for (int k = 0; k < 3; k++)
        torque[k] += wrench->torque[k];
    const double size = length3(torque),
                 angle = tool->rho > 0.0 ? size / (tool->stiffness * tool->rho * tool->rho) : 0.0;
    for (int k = 0; k < 3 && angle > 0.0; k++)
        turn[1 + k] = sin(0.5 * angle) * torque[k] / size;
    turn[0] = cos(0.5 * angle);
    turn3(turn, state->device.half, state->end.half);
    state->energy = energy_between(tool, &state->device, &state->end);
}

static void read_nodes(const struct tissue_body *body, double *at)
{
    for (uint32_t i = 0; i < dpt_springs_get_count(body->springs); i++)
        tissue_node(body, i, at + 3 * i);
}

/* The surface before a step, and its nodes before and after it. */
struct surface {
    float vertex[ROOM];
    double from[ROOM], to[ROOM];
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

/* How a point of a triangle, by its source number, went in the step. */
static void point_motion(const struct tissue_body *body, const struct surface *surface, uint32_t number,
                         const double q[3], double motion[3])
{
    const uint32_t *corners, *numbers, *nodes;
    const float *weights;
    uint32_t count, embedded, t = 0;
    double v[3][3], e[3], f[3], normal[3];
    dpt_mesh_get_triangles(body->mesh.mesh, &corners, &numbers, &count);
    dpt_mesh_get_embedding(body->mesh.mesh, &nodes, &weights, &embedded);
    while (t + 1 < count && numbers[t] != number)
        t++;
    for (int k = 0; k < 9; k++)
        v[k / 3][k % 3] = (double)surface->vertex[3 * corners[3 * t + (uint32_t)k / 3] + (uint32_t)k % 3];
    for (int k = 0; k < 3; k++) {
        e[k] = v[1][k] - v[0][k];
        f[k] = v[2][k] - v[0][k];
        motion[k] = 0.0;
    }
    cross3(e, f, normal);
    for (uint32_t i = 0; i < 3; i++) {
        const uint32_t vertex = corners[3 * t + i];
        double part[3];
        for (int k = 0; k < 3; k++) {
            e[k] = v[(i + 1) % 3][k] - q[k];
            f[k] = v[(i + 2) % 3][k] - q[k];
        }
        cross3(e, f, part);
        const double weight = dot3(part, normal) / dot3(normal, normal);
        for (uint32_t m = 0; m < (nodes ? 4u : 1u); m++) {
            const uint32_t node = nodes ? nodes[4 * vertex + m] : vertex;
            const double share = weight * (nodes ? (double)weights[4 * vertex + m] : 1.0);
            for (uint32_t k = 0; k < 3; k++)
                motion[k] += share * (surface->to[3 * node + k] - surface->from[3 * node + k]);
        }
    }
}

/* J: pushes times gaps. */
struct begun {
    double all, deep; /* of all pairs that push, and of those that were deep */
};

/*
 * How each pair that pushes began, with the tool at the old end of its spring and the surface where it was then: by the
 * pair's own row, which is straight about the proxy. A pair that is new may have begun deep; one whose normal has turned
 * has by so much as its row is off. With EULER the old end was where the surface goes in this step.
 */
static struct begun begun_of(const struct tissue_rig *tissue, const struct state *old, const struct axis *proxy,
                             const struct surface *surface)
{
    const struct tissue_tool *tool = &tissue->tool[0];
    dpt_tool_load loads[64];
    uint32_t count = 0;
    double turn[3];
    struct begun begun = { 0.0, 0.0 };
    loads[0].size = sizeof *loads;
    dpt_tool_get_loads(tissue->rig.world, tool->id, loads, 64, &count);
    CHECK(count <= 64, "%u loads", count);
    turn_between(proxy, &old->end, turn);
    for (uint32_t i = 0; i < count && i < 64; i++) {
        const double push = length3(loads[i].force), *q = loads[i].point;
        double arm[3], to[3], swing[3], motion[3] = { 0.0, 0.0, 0.0 }, s = 0.0, gap = -tool->segment.radius;
        for (int k = 0; k < 3; k++)
            to[k] = q[k] - proxy->middle[k];
        if (dot3(proxy->half, proxy->half) > 0.0)
            s = fmin(fmax(dot3(to, proxy->half) / dot3(proxy->half, proxy->half), -1.0), 1.0);
        for (int k = 0; k < 3; k++)
            arm[k] = s * proxy->half[k];
        cross3(turn, arm, swing);
        if (tissue->body[0].integrator == DPT_INTEGRATOR_EULER)
            point_motion(&tissue->body[0], surface, loads[i].triangle, q, motion);
        for (int k = 0; k < 3; k++)
            gap += loads[i].force[k] / push * (old->end.middle[k] + arm[k] + swing[k] - q[k] - motion[k]);
        begun.all += push * gap;
        begun.deep += push * fmax(-gap, 0.0);
    }
    return begun;
}

struct seen {
    uint64_t ticks, touched, turned;
    uint32_t substeps;            /* the most */
    double worst;                 /* J: what the tissue received beyond what it may */
    double off;                   /* what the balance of a tick is off by, as a share of what is lost in it */
    double received, given, deep; /* J: sums */
};

static void play(struct tissue_rig *tissue, uint64_t *seed, int ticks, struct seen *seen)
{
    static struct surface surface;
    uint32_t count = 0;
    struct tissue_tool *tool = &tissue->tool[0];
    const double height = tool->device.position[2], depth = random_in(seed, 0.001, 0.008),
                 rate = random_in(seed, 3.0, 25.0);
    double way[3] = { 0.0, 0.0, 0.0 };
    struct state old;
    tissue_rig_place(tissue);
    old.device = old.proxy = old.end = axis_at(tool, &tool->device);
    for (int i = 0; i < ticks; i++) {
        struct state now;
        dpt_pose proxy;
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
        read_nodes(&tissue->body[0], surface.from);
        tissue_rig_step_world(tissue);
        const float *vertices = tissue_vertices(tissue, &tissue->body[0], &count);
        memcpy(surface.vertex, vertices, 3 * count * sizeof *vertices);
        dpt_tool_get_proxy(tissue->rig.world, tool->id, &proxy);
        tissue_rig_step_springs(tissue);
        if (tissue->result != DPT_OK)
            return;
        seen->substeps = tissue->info[0].substeps > seen->substeps ? tissue->info[0].substeps : seen->substeps;
        read_nodes(&tissue->body[0], surface.to);
        now.device = axis_at(tool, &tool->device);
        now.proxy = axis_at(tool, &proxy);
        find_end(tool, &now);
        const double given = energy_between(tool, &now.device, &old.end) - now.energy;
        const double lost = energy_between(tool, &old.end, &now.end);
        const double received = received_by(tissue, &surface);
        const struct begun begun = begun_of(tissue, &old, &now.proxy, &surface);
        const double off = fabs(received + lost + begun.all - given);
        seen->off = fmax(seen->off, (off - ROUNDING) / (lost + fabs(begun.all) + DBL_MIN));
        seen->turned += off > ROUNDING + TURNED * (lost + fabs(begun.all));
        seen->worst = fmax(seen->worst, received - given - begun.deep);
        seen->received += received;
        seen->given += given;
        seen->deep += begun.deep;
        seen->touched += tool->force.reason == DPT_FORCE_ACTS;
        seen->ticks++;
        old = now;
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
static int make_game(struct tissue_rig *tissue, uint64_t *seed, double substeps)
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
    def.viscosity = def.integrator == DPT_INTEGRATOR_EULER ? 1.5 * def.step
                    : random_bits(seed) & 1                ? 0.0
                                                           : 0.2 * def.step;
    tissue->rig.dt = dt;
    return add_all(tissue, &def, seed);
}

/* Tissue that is damped, and that may sleep. */
static int make_round(struct tissue_rig *tissue, uint64_t game, uint64_t *seed)
{
    struct tissue_def def = game & 1 ? tissue_sheet() : tissue_ball();
    def.integrator = game & 2 ? DPT_INTEGRATOR_EULER : DPT_INTEGRATOR_SYMPLECTIC;
    def.sleeps = (int)(game & 4);
    return add_all(tissue, &def, seed);
}

static void the_tissue_receives_no_more_than_is_given(void)
{
    struct seen seen = { 0 };
    for (uint64_t game = 0; game < part_of(GAMES); game++) {
        struct tissue_rig tissue;
        uint64_t seed = 100 + game;
        tissue_rig_open(&tissue);
        if (make_game(&tissue, &seed, 1.0))
            play(&tissue, &seed, TICKS, &seen);
        tissue_rig_close(&tissue);
    }
    CHECK(seen.substeps == 1, "%u substeps", seen.substeps);
    CHECK(seen.worst <= ROUNDING, "a tick made %g J", seen.worst);
    CHECK(seen.off <= TURNED_MOST, "the balance of a tick is off by %g of what is lost in it", seen.off);
    CHECK(seen.turned <= seen.ticks / 200, "it is off in %g ticks of %g", (double)seen.turned, (double)seen.ticks);
    CHECK(seen.touched > seen.ticks / 4, "touched in %g ticks of %g", (double)seen.touched, (double)seen.ticks);
    printf("    %g ticks, %g with a force: received %.3g J of %.3g J, %.3g J of pairs that began deep\n",
           (double)seen.ticks, (double)seen.touched, seen.received, seen.given, seen.deep);
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
        if (make_game(&tissue, &seed, random_in(&seed, 1.5, 6.0)) &&
            tissue.body[0].integrator == DPT_INTEGRATOR_SYMPLECTIC)
            play(&tissue, &seed, TICKS, &seen);
        tissue_rig_close(&tissue);
        CHECK(seen.received <= seen.given + ROUNDING, "game %g: received %g J of %g J", (double)game, seen.received,
              seen.given);
        substeps = seen.substeps > substeps ? seen.substeps : substeps;
    }
    CHECK(substeps > 2, "at most %u substeps", substeps);
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
        struct state now;
        dpt_pose proxy;
        tool->device.position[0] = across * cos(angle);
        tool->device.position[1] = across * sin(angle);
        tool->device.position[2] = top - (depth + 0.001) * down;
        tissue_rig_step_world(tissue);
        dpt_tool_get_proxy(tissue->rig.world, tool->id, &proxy);
        tissue_rig_step_springs(tissue);
        CHECK(tissue->result == DPT_OK, "%s", dpt_result_name(tissue->result));
        for (int k = 0; k < 3; k++) {
            *emitted += 0.5 * (last.force[k] + tool->force.wrench.force[k]) * (tool->device.position[k] - from[k]);
            from[k] = tool->device.position[k];
        }
        last = tool->force.wrench;
        now.device = axis_at(tool, &tool->device);
        now.proxy = axis_at(tool, &proxy);
        find_end(tool, &now);
        *peak = fmax(*peak, now.energy);
    }
    CHECK(!(length3(last.force) > 0.0), "%g N at the end", length3(last.force));
}

static void closed_paths_emit_nothing(void)
{
    double worst = -HUGE_VAL;
    for (uint64_t game = 0; game < part_of(64); game++) {
        struct tissue_rig tissue;
        uint64_t seed = 7 + game;
        double emitted, peak;
        tissue_rig_open(&tissue);
        if (make_round(&tissue, game, &seed)) {
            go_round(&tissue, &seed, &emitted, &peak);
            CHECK(peak > 1e-9, "round %g: it stores %g J", (double)game, peak);
            CHECK(emitted <= 1e-3 * peak, "round %g: emits %g J of %g J", (double)game, emitted, peak);
            worst = fmax(worst, emitted / peak);
        }
        tissue_rig_close(&tissue);
    }
    printf("    at most %.3g of the peak is emitted\n", worst);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(the_tissue_receives_no_more_than_is_given);
    TEST(with_substeps_it_receives_no_more_in_all);
    TEST(closed_paths_emit_nothing);
    return check_report();
}
