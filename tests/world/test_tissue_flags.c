/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What is told beside the wrench where tool and tissue are solved together: that the proxy and what is felt are apart, that
 * there were more touches than are counted; and that a body whose step fails is held alone.
 */
#include "world/tissue_rig.h"

enum { NODES = 4096 };

/* m: how far the proxy's axis and another one are apart, as the coupling counts it: a turn with rho. */
static double apart_of(const struct tissue_tool *tool, const double a[6], const double b[6])
{
    double u[3], v[3], turn[3], middle[3];
    for (int k = 0; k < 3; k++) {
        u[k] = a[3 + k] - a[k];
        v[k] = b[3 + k] - b[k];
        middle[k] = 0.5 * (a[k] + a[3 + k] - b[k] - b[3 + k]);
    }
    cross3(u, v, turn);
    const double angle = atan2(length3(turn), dot3(u, v));
    return sqrt(dot3(middle, middle) + tool->rho * tool->rho * angle * angle);
}

/* Pressed in, wiped, torn out at 1 m/s: the flag is there where 5 % and 5 mN say so, and nowhere else. */
static void it_says_where_the_proxy_is_apart(void)
{
    const double axis[3] = { 0.0, 1.0, 0.0 };
    uint64_t set = 0, clear = 0;
    for (int i = 0; i < (int)part_of(16); i++) {
        struct tissue_rig tissue;
        uint64_t seed = 3 + (uint64_t)i;
        struct tissue_def def = i & 1 ? tissue_sheet() : tissue_ball();
        def.integrator = i & 2 ? DPT_INTEGRATOR_EULER : DPT_INTEGRATOR_SYMPLECTIC;
        tissue_rig_open(&tissue);
        if (tissue_rig_add_soft(&tissue, &def)) {
            struct tissue_tool *tool = tissue_rig_add_tool(&tissue, &tissue_upright, random_in(&seed, 200.0, 2000.0));
            const double top = tissue.body[0].top + 0.006;
            double down = 0.0;
            pose_orient(&tool->device, axis, random_in(&seed, 0.0, 1.0));
            tool->device.position[2] = top;
            tissue_rig_place(&tissue);
            for (int t = 0; t < 800; t++) {
                double device[6], proxy_ends[6], end[6];
                dpt_pose proxy;
                down = t % 200 < 150 ? down + 5e-5 : fmax(down - 1e-3, 0.0);
                tool->device.position[0] += random_in(&seed, -5e-5, 5e-5);
                tool->device.position[2] = top - down;
                tissue_rig_step_world(&tissue);
                dpt_tool_get_proxy(tissue.rig.world, tool->id, &proxy);
                tissue_rig_step_springs(&tissue);
                CHECK(tissue.result == DPT_OK, "%s", dpt_result_name(tissue.result));
                pose_ends(&tool->device, &tool->segment, device);
                pose_ends(&proxy, &tool->segment, proxy_ends);
                tissue_tool_end(tool, end);
                const double off = tool->stiffness * apart_of(tool, proxy_ends, end);
                const double allowed = 0.05 * tool->stiffness * apart_of(tool, device, end) + 5e-3;
                const int is_set = (tool->force.flags & DPT_FORCE_FLAG_APART) != 0;
                CHECK(!(tool->force.flags & DPT_FORCE_FLAG_CROWDED), "tick %d: crowded", t);
                if (off > 1.01 * allowed)
                    CHECK(is_set, "case %d, tick %d: %g N apart, of %g N, is not told", i, t, off, allowed);
                if (off < 0.99 * allowed)
                    CHECK(!is_set, "case %d, tick %d: %g N apart, of %g N, is told", i, t, off, allowed);
                set += (uint64_t)is_set;
                clear += !is_set && tool->force.reason == DPT_FORCE_ACTS;
            }
        }
        tissue_rig_close(&tissue);
    }
    CHECK(set > least_seen(100) && clear > least_seen(1000), "told in %g ticks, not in %g", (double)set, (double)clear);
}

/* Edges of the surface that a segment of the proxy passes within 0.09 mm of its own radius: each is a touch. */
static uint32_t edges_near(const struct tissue_rig *tissue, const dpt_pose *proxy, const dpt_segment *segments,
                           uint32_t count, double reach)
{
    uint32_t vertices = 0, triangles, near = 0;
    const float *position = tissue_vertices(tissue, &tissue->body[0], &vertices);
    const uint32_t *corners = tissue_corners(&tissue->body[0], &triangles);
    for (uint32_t s = 0; s < count; s++) {
        double ends[6], u[3];
        pose_ends(proxy, &segments[s], ends);
        for (int k = 0; k < 3; k++)
            u[k] = ends[3 + k] - ends[k];
        for (uint32_t i = 0; i < 3 * triangles; i++) {
            const float *a = position + 3 * corners[i], *b = position + 3 * corners[i % 3 < 2 ? i + 1 : i - 2];
            double v[3], w[3], off[3];
            if (corners[i] > corners[i % 3 < 2 ? i + 1 : i - 2])
                continue;
            for (int k = 0; k < 3; k++) {
                v[k] = (double)b[k] - (double)a[k];
                w[k] = ends[k] - (double)a[k];
            }
            const double uu = dot3(u, u), uv = dot3(u, v), vv = dot3(v, v), uw = dot3(u, w), vw = dot3(v, w);
            const double across = uu * vv - uv * uv;
            if (across < 1e-9 * uu * vv)
                continue;
            const double p = (uv * vw - vv * uw) / across, q = (uu * vw - uv * uw) / across;
            for (int k = 0; k < 3; k++)
                off[k] = w[k] + p * u[k] - q * v[k];
            near += p > 0.0 && p < 1.0 && q > 0.0 && q < 1.0 && length3(off) - segments[s].radius < reach;
        }
    }
    return near;
}

enum { TEETH = 12 };

/* A comb of lying segments above a fine sheet. Returns NULL after a failed check. */
static struct tissue_tool *open_comb(struct tissue_rig *tissue, dpt_segment segments[TEETH], uint32_t count)
{
    struct tissue_def def = tissue_sheet();
    def.triangles = 7200;
    def.stiffness = 0.1;
    def.viscosity = 2e-4;
    for (uint32_t s = 0; s < count; s++)
        segments[s] = (dpt_segment){ { -0.03, 0.002 * s, 0.0 }, { 0.03, 0.002 * s, 0.0 }, 0.004 };
    tissue_rig_open(tissue);
    if (!tissue_rig_add_soft(tissue, &def))
        return NULL;
    struct tissue_tool *tool = &tissue->tool[tissue->tool_count++];
    *tool = (struct tissue_tool){ .device = DPT_POSE_IDENTITY, .force = { .size = sizeof tool->force } };
    tool->id = rig_add_tool(&tissue->rig, segments, count);
    rig_set_law(&tissue->rig, tool->id, DPT_LAW_PROXY, 500.0);
    tool->device.position[2] = 0.0045;
    return tool;
}

/* It has more touches than there is room for, one of its teeth has not. */
static void it_says_where_there_are_too_many_touches(void)
{
    for (int i = 0; i < 2; i++) {
        dpt_segment segments[TEETH];
        const uint32_t count = i ? 1 : TEETH;
        uint32_t most = 0, ticks = 0;
        struct tissue_rig tissue;
        struct tissue_tool *tool = open_comb(&tissue, segments, count);
        if (tool) {
            tissue_rig_place(&tissue);
            for (int t = 0; t < 120; t++) {
                dpt_pose proxy;
                tool->device.position[2] -= 2e-5;
                tissue_rig_step_world(&tissue);
                dpt_tool_get_proxy(tissue.rig.world, tool->id, &proxy);
                const uint32_t edges = edges_near(&tissue, &proxy, segments, count, 9e-5);
                tissue_rig_step_springs(&tissue);
                CHECK(tissue.result == DPT_OK, "%s", dpt_result_name(tissue.result));
                most = edges > most ? edges : most;
                if (edges > 256)
                    CHECK(tool->force.flags & DPT_FORCE_FLAG_CROWDED, "tick %d: %u edges are not told", t, edges);
                if (i)
                    CHECK(!(tool->force.flags & DPT_FORCE_FLAG_CROWDED), "tick %d: one segment is crowded", t);
                ticks += tool->force.reason == DPT_FORCE_ACTS;
            }
            CHECK(ticks > 20 && (i ? most > 8 && most < 100 : most > 256), "%u edges, felt in %u ticks", most, ticks);
        }
        tissue_rig_close(&tissue);
    }
}

/* Where one tool takes all room, touches of another one take places of its own: both are felt. */
static void another_tool_finds_room(void)
{
    static const dpt_segment rod = { { -0.03, 0.0, 0.0 }, { 0.03, 0.0, 0.0 }, 0.004 };
    dpt_segment segments[TEETH];
    struct tissue_rig tissue;
    const struct tissue_tool *comb = open_comb(&tissue, segments, TEETH);
    uint32_t crowded = 0, both = 0;
    if (comb) {
        struct tissue_tool *other = tissue_rig_add_tool(&tissue, &rod, 500.0);
        other->device.position[1] = -0.01;
        other->device.position[2] = 0.0045;
        tissue_rig_place(&tissue);
        for (int t = 0; t < 120; t++) {
            for (uint32_t k = 0; k < 2; k++)
                tissue.tool[k].device.position[2] -= 2e-5;
            const double force = tissue_rig_tick(&tissue), others = length3(other->force.wrench.force);
            CHECK(force < 5.0 && others < 5.0, "tick %d: %g and %g N", t, force, others);
            crowded += (comb->force.flags & DPT_FORCE_FLAG_CROWDED) != 0;
            both += comb->force.flags & DPT_FORCE_FLAG_CROWDED && force > 0.0 && others > 0.0;
        }
        CHECK(crowded > 20 && both > 20, "crowded in %u ticks, %u of them with both", crowded, both);
    }
    tissue_rig_close(&tissue);
}

struct kept {
    float positions[3 * NODES], speeds[3 * NODES], vertices[3 * NODES];
    uint32_t nodes, vertex_count;
};

static void keep(const struct tissue_rig *tissue, const struct tissue_body *body, struct kept *kept)
{
    const float *vertices = tissue_vertices(tissue, body, &kept->vertex_count);
    memset(kept->positions, 0, sizeof kept->positions);
    kept->nodes = dpt_springs_get_count(body->springs);
    CHECK(kept->nodes <= NODES && kept->vertex_count <= NODES, "no room");
    dpt_springs_get_nodes(body->springs, kept->nodes, kept->positions, kept->speeds);
    memcpy(kept->vertices, vertices, 3 * kept->vertex_count * sizeof *vertices);
}

static int is_kept(const struct tissue_rig *tissue, const struct tissue_body *body, const struct kept *kept)
{
    static struct kept now;
    keep(tissue, body, &now);
    return !memcmp(now.positions, kept->positions, 3 * kept->nodes * sizeof(float)) &&
           !memcmp(now.speeds, kept->speeds, 3 * kept->nodes * sizeof(float)) &&
           !memcmp(now.vertices, kept->vertices, 3 * kept->vertex_count * sizeof(float));
}

static const dpt_segment lying = { { -0.03, 0.0, 0.0 }, { 0.03, 0.0, 0.0 }, 0.004 };

/* A tool that is pressed across two bodies by about a newton. Returns NULL after a failed check. */
static struct tissue_tool *press_across(struct tissue_rig *tissue, uint32_t integrator)
{
    struct tissue_def def = tissue_ball();
    def.integrator = integrator;
    tissue_rig_open(tissue);
    def.place[0] = -0.025;
    if (!tissue_rig_add_soft(tissue, &def))
        return NULL;
    def.place[0] = 0.025;
    if (!tissue_rig_add_soft(tissue, &def))
        return NULL;
    struct tissue_tool *tool = tissue_rig_add_tool(tissue, &lying, 500.0);
    tool->device.position[2] = tissue->body[0].top + 0.005;
    tissue_rig_place(tissue);
    for (int t = 0; t < 200; t++) {
        tool->device.position[2] -= 2e-5;
        tissue_rig_tick(tissue);
    }
    CHECK(length3(tool->force.wrench.force) > 0.5, "%g N", length3(tool->force.wrench.force));
    return tool;
}

/* The pose in which a step leaves a tool: by the getter and by a snapshot, until the world goes on. */
static void it_says_where_a_step_ended(void)
{
    static uint64_t block[8192];
    struct tissue_rig tissue;
    struct tissue_tool *tool = press_across(&tissue, DPT_INTEGRATOR_SYMPLECTIC);
    for (int t = 0; t < 20 && tool; t++) {
        dpt_snapshot_tool told = { .size = sizeof told };
        dpt_pose end, proxy, last;
        double ends[6], by_wrench[6];
        size_t bytes = 0;
        tool->device.position[2] += 1e-4;
        tissue_rig_step_world(&tissue);
        dpt_tool_get_proxy(tissue.rig.world, tool->id, &proxy);
        CHECK(dpt_tool_get_end(tissue.rig.world, tool->id, &end) == DPT_OK && !memcmp(&end, &proxy, sizeof end),
              "before the tissue's step it is not the proxy's pose");
        tissue_rig_step_springs(&tissue);
        CHECK(dpt_tool_get_end(tissue.rig.world, tool->id, &end) == DPT_OK && memcmp(&end, &proxy, sizeof end),
              "after it it is the proxy's pose");
        pose_ends(&end, &tool->segment, ends);
        tissue_tool_end(tool, by_wrench);
        CHECK(apart_of(tool, ends, by_wrench) < 1e-5, "%g m from the spring's end", apart_of(tool, ends, by_wrench));
        const dpt_result result = dpt_world_take_snapshot(tissue.rig.world, NULL, block, sizeof block, &bytes);
        CHECK(result == DPT_OK && dpt_snapshot_get_tool(block, bytes, 0, &told) == DPT_OK, "no snapshot");
        CHECK(!memcmp(&told.end, &end, sizeof end) && !memcmp(&told.proxy, &proxy, sizeof proxy), "it tells others");
        dpt_world_step(tissue.rig.world, tissue.rig.dt, NULL);
        dpt_tool_get_proxy(tissue.rig.world, tool->id, &proxy);
        dpt_tool_get_end(tissue.rig.world, tool->id, &last);
        CHECK(!memcmp(&last, &proxy, sizeof last), "it is told when the world has gone on");
    }
    tissue_rig_close(&tissue);
}

/* A rough body whose loads are spread, under a tool that lies. */
static int open_rough(struct tissue_rig *tissue, uint32_t budget)
{
    struct tissue_def def = tissue_ball();
    def.triangles = 5120;
    def.load_radius = 0.03;
    def.sleeps = 1;
    tissue_rig_open_within(tissue, budget);
    if (!tissue_rig_add_soft(tissue, &def))
        return 0;
    tissue_body_roughen(tissue, &tissue->body[0], 0.5, 0.4);
    tissue_rig_add_tool(tissue, &lying, 500.0)->device.position[2] = tissue->body[0].top + 0.005;
    tissue_rig_place(tissue);
    return 1;
}

/* It comes down, leaps, is drawn along and held. */
static void lead_rough(struct tissue_rig *tissue, int t)
{
    double *position = tissue->tool[0].device.position;
    position[2] -= t < 60 ? 2e-5 : t == 80 ? 1e-3 : 0.0;
    position[0] += t >= 80 && t < 120 ? 1e-4 : 0.0;
    tissue_rig_tick(tissue);
}

/*
 * Patches of more vertices than there is room for in all: a flag says so, what is nearest is spread, and all the rest holds the
 * tool by its corners.
 */
static void too_many_weights_are_told(void)
{
    static dpt_load loads[16384];
    struct tissue_def def = tissue_sheet();
    def.triangles = 8192;
    def.drag = 50.0; /* without it the sheet swings, and the last force tells nothing */
    def.integrator = DPT_INTEGRATOR_IMPLICIT;
    for (int is_spread = 2 - few_of(2); is_spread < 2; is_spread++) {
        struct tissue_rig tissue;
        uint32_t crowded = 0;
        tissue_rig_open(&tissue);
        def.load_radius = 0.03 * is_spread;
        if (!tissue_rig_add_soft(&tissue, &def))
            return;
        struct tissue_tool *tool = tissue_rig_add_tool(&tissue, &lying, 500.0);
        tool->device.position[2] = tissue.body[0].top + 0.005;
        tissue_rig_place(&tissue);
        for (int t = 0; t < 400; t++) {
            dpt_wrench told = { { 0.0 }, { 0.0 } };
            uint32_t count = 0;
            tool->device.position[2] -= t < 250 ? 4e-5 : 0.0;
            tissue_rig_tick(&tissue);
            crowded += (tool->force.flags & DPT_FORCE_FLAG_CROWDED) != 0;
            dpt_body_get_loads(tissue.rig.world, tissue.body[0].id, loads, 16384, &count);
            for (uint32_t i = 0; i < count; i++)
                for (int k = 0; k < 3; k++)
                    told.force[k] += loads[i].force[k];
            for (int k = 0; k < 3; k++)
                told.force[k] += tool->force.wrench.force[k];
            CHECK(length3(told.force) <= 1e-12, "tick %d: loads are %g N off", t, length3(told.force));
        }
        const double force = length3(tool->force.wrench.force);
        CHECK(is_spread ? crowded > 50 : !crowded, "case %d: crowded in %u ticks", is_spread, crowded);
        CHECK(force > 0.05 && force < 0.07, "case %d: %g N", is_spread, force);
        tissue_rig_close(&tissue);
    }
}

/* With a budget that is ample the bits are the same; with a small one the force is still right, and a flag says that it was. */
static void a_budget_bounds_the_solve(void)
{
    enum { TICKS = 140, AMPLE = 2000, SMALL = 300 };
    struct tissue_rig all, ample, small;
    const int is_there = open_rough(&all, 0) + open_rough(&ample, AMPLE) + open_rough(&small, SMALL);
    uint32_t crowded = 0, most = 0, most_small = 0;
    for (int t = 0; t < TICKS && is_there == 3; t++) {
        lead_rough(&all, t);
        lead_rough(&ample, t);
        lead_rough(&small, t);
        const dpt_force_info *expected = &all.tool[0].force, *found = &small.tool[0].force;
        const double force = length3(expected->wrench.force);
        CHECK(!memcmp(&ample.tool[0].force, expected, sizeof *expected) && ample.info[0].work == all.info[0].work,
              "tick %d: others with an ample budget", t);
        CHECK(apart(found->wrench.force, expected->wrench.force) <= 0.01 * force, "tick %d: %g N off of %g", t,
              apart(found->wrench.force, expected->wrench.force), force);
        CHECK(!(expected->flags & DPT_FORCE_FLAG_CROWDED), "tick %d: crowded without a budget", t);
        CHECK(all.info[0].work || !(force > 0.0), "tick %d: it is told to be free", t);
        crowded += (found->flags & DPT_FORCE_FLAG_CROWDED) != 0;
        most = all.info[0].work > most ? all.info[0].work : most;
        most_small = small.info[0].work > most_small ? small.info[0].work : most_small;
    }
    CHECK(crowded > 2 && most > SMALL && most < AMPLE, "crowded in %u ticks, %u units", crowded, most);
    printf("    %u units without a budget, %u of %u\n", most, most_small, SMALL);
    tissue_rig_close(&all);
    tissue_rig_close(&ample);
    tissue_rig_close(&small);
}

/*
 * A device that leaps across the whole body, as the first sample or one after a gap in the line may be: the tick looks at a
 * part of the surface alone, and the tool comes to rest where one that came slowly does.
 */
static void a_leap_is_answered_in_time(void)
{
    enum { FEATURES = 15, TRIANGLES = 8192 };
    struct tissue_def def = tissue_sheet();
    double held = 0.0;
    def.triangles = TRIANGLES;
    def.drag = 50.0;
    def.integrator = DPT_INTEGRATOR_IMPLICIT;
    for (int kind = 0; kind < 3; kind++) { /* slowly, out of the air, from where it touches */
        struct tissue_rig tissue;
        uint32_t most = 0;
        tissue_rig_open(&tissue);
        if (!tissue_rig_add_soft(&tissue, &def))
            return;
        struct tissue_tool *tool = tissue_rig_add_tool(&tissue, &lying, 500.0);
        double *position = tool->device.position;
        const double low = tissue.body[0].top - 0.005;
        position[2] = tissue.body[0].top + (kind == 1 ? 0.25 : 0.005);
        tissue_rig_place(&tissue);
        for (int t = 0; t < 2000; t++) {
            if (kind == 1)
                position[2] = t ? low : position[2];
            else
                position[2] = fmax(low, position[2] - 4e-5);
            if (kind == 2)
                position[0] = t == 300 ? 0.4 : 0.0;
            tissue_rig_tick(&tissue);
            most = tissue.info[0].work > most ? tissue.info[0].work : most;
        }
        const double force = tool->force.wrench.force[2];
        if (kind)
            CHECK(most < FEATURES * TRIANGLES, "case %d: %u units in a tick", kind, most);
        else
            held = force;
        CHECK(held > 0.02 && fabs(force - held) <= 0.02 * held, "case %d: %g N, slowly %g", kind, force, held);
        tissue_rig_close(&tissue);
    }
}

/* A node that carries the body's outermost vertex along y, away from the tool. */
static uint32_t node_at_side(const struct tissue_body *body)
{
    const uint32_t *nodes;
    const float *weights, *at;
    uint32_t node_count, count, side = 0;
    dpt_mesh_get_vertices(body->mesh.mesh, &at, &count);
    dpt_mesh_get_embedding(body->mesh.mesh, &nodes, &weights, &node_count);
    for (uint32_t i = 1; i < count; i++)
        side = at[3 * i + 1] > at[3 * side + 1] ? i : side;
    uint32_t most = 4 * side;
    for (uint32_t k = most + 1; k < 4 * side + 4; k++)
        most = weights[k] > weights[most] ? k : most;
    return nodes[most];
}

/* Put that node at x, with a speed along x. */
static void put_node(const struct tissue_body *body, float x, float speed, const struct kept *kept)
{
    const uint32_t node = node_at_side(body);
    const float at[3] = { x, kept->positions[3 * node + 1], kept->positions[3 * node + 2] };
    const float fast[3] = { speed, 0.0f, 0.0f };
    const dpt_result result = dpt_springs_set_nodes(body->springs, node, 1, at, fast);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
}

/* N: by how much the tool's force and its loads differ, or the bodies' loads and its opposite. */
static double left_over(const struct tissue_rig *tissue, const struct tissue_tool *tool, int of_bodies)
{
    static dpt_load loads[TISSUE_LOADS];
    dpt_tool_load points[32];
    double sum[3];
    uint32_t count = 0;
    memcpy(sum, tool->force.wrench.force, sizeof sum);
    points[0].size = sizeof *points;
    dpt_tool_get_loads(tissue->rig.world, tool->id, points, 32, &count);
    for (uint32_t i = 0; i < count && !of_bodies; i++)
        for (int k = 0; k < 3; k++)
            sum[k] -= points[i].force[k];
    for (int b = 0; b < 2 && of_bodies; b++) {
        dpt_body_get_loads(tissue->rig.world, tissue->body[b].id, loads, TISSUE_LOADS, &count);
        for (uint32_t i = 0; i < count; i++)
            for (int k = 0; k < 3; k++)
                sum[k] += loads[i].force[k];
    }
    return length3(sum);
}

/*
 * A node of one body would leave the finite range: nothing of that body moves. The other one goes on, and the tool feels
 * both: one as tissue, the other as if it were rigid. Once the node is back, all goes on.
 */
static void a_body_that_fails_is_held_alone(void)
{
    static struct kept kept[2];
    for (int i = 0; i < 4; i++) {
        struct tissue_rig tissue;
        struct tissue_tool *tool = press_across(&tissue, i & 1 ? DPT_INTEGRATOR_EULER : DPT_INTEGRATOR_SYMPLECTIC);
        if (tool) {
            const struct tissue_body *body = &tissue.body[i / 2];
            const uint32_t side = node_at_side(body);
            const double before = length3(tool->force.wrench.force);
            keep(&tissue, body, &kept[0]);
            const float home = kept[0].positions[3 * side];
            put_node(body, 9.9e5f, 1e9f, &kept[0]);
            tissue_rig_step_world(&tissue);
            tool->device.position[2] -= 1e-5;
            for (int b = 0; b < 2; b++)
                keep(&tissue, &tissue.body[b], &kept[b]);
            tissue_rig_step_springs(&tissue);
            CHECK(tissue.result == DPT_E_FINITE, "case %d: %s", i, dpt_result_name(tissue.result));
            for (int b = 0; b < 2; b++) {
                const int is_held = b == i / 2;
                CHECK(is_kept(&tissue, &tissue.body[b], &kept[b]) == is_held, "case %d: body %d is %s", i, b,
                      is_held ? "not held" : "held too");
                CHECK(tissue.info[b].result == (is_held ? DPT_E_FINITE : DPT_OK), "case %d, body %d: %s", i, b,
                      dpt_result_name(tissue.info[b].result));
            }
            const double now = length3(tool->force.wrench.force);
            CHECK(now > 0.5 * before && now < 2.0 * before, "case %d: %g N, then %g N", i, before, now);
            CHECK(tool->force.reason == DPT_FORCE_ACTS, "case %d: reason %u", i, tool->force.reason);
            CHECK(left_over(&tissue, tool, 0) <= 1e-12 * now && left_over(&tissue, tool, 1) <= 1e-12 * now,
                  "case %d: loads are off by %g N and %g N", i, left_over(&tissue, tool, 0),
                  left_over(&tissue, tool, 1));
            tissue_rig_step_world(&tissue);
            CHECK(tissue.rig.step.flags & DPT_STEP_FLAG_BODY_HELD, "case %d: it is not told", i);
            put_node(body, home, 0.0f, &kept[i / 2]);
            tissue_rig_step_springs(&tissue);
            tissue_rig_tick(&tissue);
            CHECK(!(tissue.rig.step.flags & DPT_STEP_FLAG_BODY_HELD), "case %d: it is told for ever", i);
            const double after = length3(tool->force.wrench.force);
            CHECK(fabs(after - before) < 0.05 * before, "case %d: %g N, then %g N", i, before, after);
        }
        tissue_rig_close(&tissue);
    }
}

/* A vertex would leave the box of its body: nothing of that body moves, nor do its springs. The other body moves. */
static void a_vertex_stays_in_its_box(void)
{
    static struct kept kept[2], now;
    struct tissue_rig tissue;
    struct tissue_tool *tool = press_across(&tissue, DPT_INTEGRATOR_SYMPLECTIC);
    if (tool) {
        const struct tissue_body *body = &tissue.body[0];
        const uint32_t side = node_at_side(body);
        keep(&tissue, body, &kept[0]);
        put_node(body, kept[0].positions[3 * side], 2e3f, &kept[0]);
        tool->device.position[2] -= 1e-4;
        tissue_rig_step_world(&tissue);
        for (int b = 0; b < 2; b++)
            keep(&tissue, &tissue.body[b], &kept[b]);
        tissue_rig_step_springs(&tissue);
        CHECK(tissue.result == DPT_E_FINITE, "%s", dpt_result_name(tissue.result));
        for (int b = 0; b < 2; b++) {
            keep(&tissue, &tissue.body[b], &now);
            const int has_gone_on = memcmp(now.positions, kept[b].positions, sizeof now.positions) != 0;
            CHECK(has_gone_on == b, "springs %d %s", b, has_gone_on ? "have gone on" : "stand still");
            const int has_moved = memcmp(now.vertices, kept[b].vertices, 3 * now.vertex_count * sizeof(float)) != 0;
            CHECK(has_moved == b, "body %d: vertices %s", b, has_moved ? "have moved" : "stand still");
        }
    }
    tissue_rig_close(&tissue);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(it_says_where_the_proxy_is_apart);
    TEST(it_says_where_there_are_too_many_touches);
    TEST(another_tool_finds_room);
    TEST(it_says_where_a_step_ended);
    TEST(too_many_weights_are_told);
    TEST(a_budget_bounds_the_solve);
    TEST(a_leap_is_answered_in_time);
    TEST(a_body_that_fails_is_held_alone);
    TEST(a_vertex_stays_in_its_box);
    return check_report();
}
