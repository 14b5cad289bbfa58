/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Contact solved with the tissue's step, against tissue_brute.h: a tool across two soft bodies, soft beside rigid, two tools
 * on one body and on a sheet, all of it at once, a tool that does not turn, a polyhedral tip; the conditions of the problem by
 * what is told; where a step leaves the tools; another order of tools and bodies.
 *
 *     test_tissue_solve [PER CENT = 100]
 */
#include "world/tissue_room.h"
#include "world/tissue_unfelt.h"

enum { TICKS = 240, EACH = 5 };

/* m: pairs of a soft body that are as near to the proxy as that are the library's, too. */
#define SURELY 9e-5

/* m: the library's answer may miss a condition by GAP. */
#define GAP 1e-9

/* m: and a tool may end so far from where it should. */
#define END 1e-9

/*
 * N and m: how far the two answers are apart as a rule. Where pairs nearly depend on each other they may be farther: two
 * answers that miss their gaps by e differ by no more than K |du|^2 <= 2 e times the sum of the pushes, in each substep.
 */
#define FORCE_OFF 5e-7
#define NODE_OFF  5e-9
#define RESIDUAL  1e-10

/* What was seen. */
struct worst {
    double force, node; /* of what is allowed: the largest share */
    double gap, product, pull, peak;
    double end;          /* m: how far a tool is from where the step should leave it */
    uint32_t gave_way;   /* tools that the surfaces moved from where their pushes had put them, by more than END */
    uint32_t crowded;    /* tools for whose touches there was no room */
    uint32_t ticks, off; /* compared, and of these farther apart than as a rule */
    uint32_t touched[TISSUE_BODIES][TISSUE_TOOLS];
    uint32_t most; /* pairs that push */
};

/* Whether a tool is solved for: only those are that reach a soft body. */
static int is_on_soft(const struct brute *brute, uint32_t t)
{
    for (uint32_t i = 0; i < brute->count; i++)
        if (brute->pair[i].tool == t && brute->pair[i].gap < SURELY && brute->tissue->body[brute->pair[i].body].springs)
            return 1;
    return 0;
}

/* Whether a body is stepped together with a tool: another one has substeps of its own, and no viscosity of touch. */
static int is_reached(const struct brute *brute, uint32_t body)
{
    for (uint32_t i = 0; i < brute->count; i++)
        if (brute->pair[i].body == body && brute->pair[i].gap < SURELY)
            return 1;
    return 0;
}

static void compare(const struct brute *brute, uint32_t substeps, struct worst *worst)
{
    const struct tissue_rig *tissue = brute->tissue;
    uint32_t pushing = 0;
    double sum = 0.0, node = 0.0;
    int is_off = 0;
    for (uint32_t i = 0; i < brute->count; i++) {
        const struct brute_pair *pair = &brute->pair[i];
        const int pushes = pair->push > 0.0 && is_on_soft(brute, pair->tool);
        worst->touched[pair->body][pair->tool] += (uint32_t)pushes;
        pushing += (uint32_t)pushes;
        sum += pair->push;
    }
    for (uint32_t t = 0; t < tissue->tool_count; t++) {
        const dpt_wrench *theirs = &tissue->tool[t].force.wrench, *mine = &brute->wrench[t];
        const double force = fmax(apart(theirs->force, mine->force), apart(theirs->torque, mine->torque) / 0.1);
        if (!is_on_soft(brute, t))
            continue;
        worst->force =
            fmax(worst->force, force / (FORCE_OFF + substeps * sqrt(2.0 * RESIDUAL * tissue->tool[t].stiffness * sum)));
        worst->peak = fmax(worst->peak, length3(mine->force));
        is_off |= force > FORCE_OFF;
        worst->crowded += (tissue->tool[t].force.flags & DPT_FORCE_FLAG_CROWDED) != 0;
    }
    brute_read_nodes(tissue, brute->end);
    for (uint32_t b = 0; b < TISSUE_BODIES; b++)
        for (size_t i = (size_t)BRUTE_ROOM * b; is_reached(brute, b) && i < (size_t)BRUTE_ROOM * (b + 1); i++)
            node = fmax(node, fabs(brute->end[i] - brute->mine[i]));
    worst->node = fmax(worst->node, node / (NODE_OFF + substeps * sqrt(2.0 * RESIDUAL * sum * brute->loosest)));
    worst->off += is_off || node > NODE_OFF;
    worst->most = pushing > worst->most ? pushing : worst->most;
    worst->ticks++;
}

/* From a tool's proxy to where its spring ends that gives the wrench. */
static void find_way(const struct brute *brute, uint32_t t, double way[6])
{
    const struct tissue_tool *tool = &brute->tissue->tool[t];
    double ends[6], arm[3], torque[3];
    brute_way_to(brute, t, &tool->device, way);
    pose_ends(&brute->proxy[t], &tool->segment, ends);
    for (int k = 0; k < 3; k++)
        arm[k] = tool->device.position[k] - 0.5 * (ends[k] + ends[3 + k]);
    cross3(arm, tool->force.wrench.force, torque);
    for (int k = 0; k < 3; k++) {
        way[k] += tool->force.wrench.force[k] / tool->stiffness;
        torque[k] += tool->force.wrench.torque[k];
    }
    brute_without_spin(brute, t, torque);
    for (int k = 0; k < 3 && tool->rho > 0.0; k++)
        way[3 + k] += torque[k] / (tool->stiffness * tool->rho);
}

/*
 * The conditions of the problem, of the library's own answer: its gaps at the brute solve's pairs, beyond what is asked for,
 * from the wrench and the nodes after the step, and the pushes that are told. Where a tick has one substep.
 */
static void judge_conditions(struct brute *brute, struct worst *worst)
{
    const struct tissue_rig *tissue = brute->tissue;
    brute_read_nodes(tissue, brute->end);
    brute_add_speeds(tissue, tissue->rig.dt, brute->end);
    for (uint32_t t = 0; t < tissue->tool_count; t++) {
        const struct tissue_tool *tool = &tissue->tool[t];
        dpt_tool_load loads[128];
        double way[6];
        uint32_t count = 0;
        if (!is_on_soft(brute, t))
            continue;
        loads[0].size = sizeof *loads;
        dpt_tool_get_loads(tissue->rig.world, tool->id, loads, 128, &count);
        find_way(brute, t, way);
        for (uint32_t i = 0; i < brute->count; i++) {
            struct brute_pair *pair = &brute->pair[i];
            if (pair->tool != t)
                continue;
            const double gap = pair->gap + brute_product(pair->row, way) -
                               brute_surface_motion(pair, brute->begin, brute->end) - pair->least;
            worst->gap = fmax(worst->gap, -gap);
            for (uint32_t k = 0; k < count && k < 128; k++)
                if (apart(loads[k].point, pair->q) < 1e-8 &&
                    dot3(loads[k].force, pair->n) > (1.0 - 1e-9) * length3(loads[k].force))
                    worst->product = fmax(worst->product, gap);
        }
        for (uint32_t k = 0; k < count && k < 128; k++) {
            double best = -1.0;
            for (uint32_t i = 0; i < brute->count; i++)
                if (brute->pair[i].tool == t && apart(loads[k].point, brute->pair[i].q) < 1e-8)
                    best = fmax(best, dot3(loads[k].force, brute->pair[i].n) / length3(loads[k].force));
            worst->pull = fmax(worst->pull, 1.0 - best);
        }
    }
}

/* Where the step has left the tools that are pushed. The brute's pairs are lost. */
static void judge_ends(struct brute *brute, struct worst *worst)
{
    const struct tissue_rig *tissue = brute->tissue;
    double way[TISSUE_TOOLS][6];
    int is_pushed[TISSUE_TOOLS];
    for (uint32_t t = 0; t < tissue->tool_count; t++) {
        is_pushed[t] = is_on_soft(brute, t) && length3(tissue->tool[t].force.wrench.force) > 0.0;
        find_way(brute, t, way[t]);
    }
    for (uint32_t t = 0; t < tissue->tool_count; t++) {
        double motion, off[6];
        if (!is_pushed[t])
            continue;
        const dpt_pose end = tissue_tool_last_end(tissue, &tissue->tool[t]);
        brute->proxy[t] = room_of_end(brute, t, way[t], &motion);
        brute_way_to(brute, t, &end, off);
        worst->end = fmax(worst->end, sqrt(brute_product(off, off)));
        worst->gave_way += motion > END;
    }
}

/* Where tools are led: down by `depth` and up again, to and fro, turning. In scenes whose order is reversed, as well. */
struct course {
    uint64_t seed[TISSUE_TOOLS];
    double depth, from[TISSUE_TOOLS];
    int ticks, is_reversed;
};

static void begin_course(struct tissue_rig *tissue, struct course *course, uint64_t seed, double depth)
{
    *course = (struct course){ .depth = depth, .ticks = TICKS, .is_reversed = tissue->is_reversed };
    for (uint32_t t = 0; t < tissue->tool_count; t++) {
        course->seed[t] = seed + 1000 * (course->is_reversed ? tissue->tool_count - 1 - t : t);
        course->from[t] = tissue->tool[t].device.position[2];
    }
    tissue_rig_place(tissue);
}

static void lead(struct tissue_rig *tissue, struct course *course, int i)
{
    for (uint32_t t = 0; t < tissue->tool_count; t++) {
        uint64_t *seed = &course->seed[t];
        dpt_pose *device = &tissue->tool[t].device;
        const double turn[4] = { 1.0, random_in(seed, -2e-3, 2e-3), random_in(seed, -2e-3, 2e-3), 0.0 };
        device->position[2] = course->from[t] - (course->depth + 0.001) * sin(3.0 * i / course->ticks);
        device->position[0] += random_in(seed, -4e-5, 4e-5);
        device->position[1] += random_in(seed, -4e-5, 4e-5);
        pose_turn_by(device, turn);
    }
    tissue_rig_step_world(tissue);
}

/* A tool whose proxy was put at the device, as it was too far away, is not solved for until it has been outside. */
static int all_are_outside(const struct tissue_rig *tissue)
{
    for (uint32_t t = 0; t < tissue->tool_count; t++) {
        dpt_force_info info = { .size = sizeof info };
        dpt_tool_get_force_info(tissue->rig.world, tissue->tool[t].id, &info);
        if (info.reason == DPT_FORCE_INSIDE || info.flags & DPT_FORCE_FLAG_REPLACED)
            return 0;
    }
    return 1;
}

static double most_unfelt(const struct tissue_rig *tissue)
{
    double most = 0.0;
    for (uint32_t b = 0; b < tissue->body_count; b++)
        most = fmax(most, tissue_unfelt(tissue->rig.world, tissue->body[b].id));
    return most;
}

static void press(struct brute *brute, uint64_t seed, double depth, int each, int yields, struct worst *worst)
{
    struct tissue_rig *tissue = brute->tissue;
    struct course course;
    begin_course(tissue, &course, seed, depth);
    for (int i = 0; i < course.ticks; i++) {
        const uint32_t substeps = tissue->info[0].substeps;
        const int is_touched = brute_is_touched(tissue);
        lead(tissue, &course, i);
        const int is_due = i && i % each == 0 && all_are_outside(tissue);
        if (is_due)
            brute_solve_tick(brute, substeps);
        tissue_rig_step_springs(tissue);
        CHECK(tissue->result == DPT_OK, "%s", dpt_result_name(tissue->result));
        /* Where touch begins or ends, the tick has other substeps and another viscosity than the one before. */
        if (most_unfelt(tissue) > 0.0 || brute_is_touched(tissue) != is_touched)
            continue;
        if (is_due)
            compare(brute, substeps, worst);
        if (is_due && substeps == 1 && !yields)
            judge_conditions(brute, worst);
        if (is_due && substeps == 1)
            judge_ends(brute, worst);
    }
}

static const dpt_segment lying = { { 0.0, 0.0, -0.03 }, { 0.0, 0.0, 0.03 }, 0.004 };
static const dpt_segment upright = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.06 }, 0.004 };
static const dpt_segment ball = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 }, 0.006 };

/* What lies there: soft bodies at places along x, a rigid one, tools. */
struct scene {
    const char *name;
    double load_radius;
    double yields; /* N/m: of the bodies' own surfaces; 0: they are hard */
    int soft, rigid, sheet, tools;
    int touched;   /* pairs of a tool and a body that push, at least */
    int is_locked; /* its tools do not turn */
    const dpt_segment *segment[TISSUE_TOOLS];
    double x[TISSUE_TOOLS], lean[TISSUE_TOOLS];
};

static const struct scene scenes[] = {
    { "across two soft bodies", 0.0, 0.0, 2, 0, 0, 1, 2, 0, { &lying }, { 0.0 }, { 1.5708 } },
    { "soft beside rigid", 0.0, 0.0, 1, 1, 0, 1, 2, 0, { &lying }, { 0.0 }, { 1.5708 } },
    { "two tools on one body", 0.0, 0.0, 1, 0, 0, 2, 2, 0, { &upright, &ball }, { -0.005, 0.008 }, { 0.4, 0.0 } },
    { "two tools on a sheet", 0.0, 0.0, 1, 0, 1, 2, 2, 0, { &lying, &upright }, { -0.012, 0.03 }, { 1.5, 0.3 } },
    { "two tools on two soft bodies and a rigid one",
      0.0,
      0.0,
      2,
      1,
      0,
      2,
      3,
      0,
      { &lying, &lying },
      { 0.0, 0.002 },
      { 1.5708, 1.5 } },
    { "locked, across two soft bodies", 0.0, 0.0, 2, 0, 0, 1, 2, 1, { &lying }, { 0.0 }, { 1.5708 } },
    { "spread, across two soft bodies", 0.025, 0.0, 2, 0, 0, 1, 2, 0, { &lying }, { 0.0 }, { 1.5708 } },
    { "spread, two tools on one body",
      0.03,
      0.0,
      1,
      0,
      0,
      2,
      2,
      0,
      { &upright, &ball },
      { -0.005, 0.008 },
      { 0.4, 0.0 } },
    { "yielding, soft beside rigid", 0.0, 2e4, 1, 1, 0, 1, 2, 0, { &lying }, { 0.0 }, { 1.5708 } },
    { "yielding, two tools on one body",
      0.0,
      900.0,
      1,
      0,
      0,
      2,
      2,
      0,
      { &upright, &ball },
      { -0.005, 0.008 },
      { 0.4, 0.0 } },
};

/* With tissue->is_reversed the last tool and the last body are added first. Returns 0 after a failed check. */
static int make_scene(struct tissue_rig *tissue, const struct scene *scene, uint64_t seed)
{
    static const double x[TISSUE_BODIES] = { -0.025, 0.025, 0.0 };
    const double y_axis[3] = { 0.0, 1.0, 0.0 };
    struct tissue_def def = scene->sheet ? tissue_sheet() : tissue_ball();
    const int count = scene->soft + scene->rigid, is_euler = random_bits(&seed) & 1;
    double stiffness[TISSUE_TOOLS], top = 0.0;
    def.integrator = is_euler ? DPT_INTEGRATOR_EULER : DPT_INTEGRATOR_SYMPLECTIC;
    tissue->rig.dt = random_bits(&seed) & 1 ? 1e-3 : 4e-3;
    def.drag = random_in(&seed, 1.0, 20.0);
    def.viscosity = 1e-3;
    def.stiffness = scene->sheet ? 0.05 : 1.0;
    def.load_radius = scene->load_radius;
    if (!scene->sheet)
        def.density = 1000.0 * pow(10.0, random_in(&seed, -0.5, 0.5));
    for (int t = 0; t < TISSUE_TOOLS; t++)
        stiffness[t] = random_in(&seed, 200.0, 2000.0);
    const uint64_t turns = random_bits(&seed);
    for (int i = 0; i < count; i++) {
        const int b = tissue->is_reversed ? count - 1 - i : i;
        def.place[0] = count > 1 ? x[b] : 0.0;
        const struct tissue_body *body =
            b < scene->soft ? tissue_rig_add_soft(tissue, &def) : tissue_rig_add_rigid(tissue, &def);
        if (!body)
            return 0;
        tissue_body_soften(tissue, body, scene->yields);
        top = body->top;
    }
    for (int i = 0; i < scene->tools; i++) {
        const int t = tissue->is_reversed ? scene->tools - 1 - i : i;
        struct tissue_tool *tool = tissue_rig_add_tool(tissue, scene->segment[t], stiffness[t]);
        if (scene->is_locked)
            tissue_tool_lock(tissue, tool);
        else if (tool->rho > 0.0 && turns % 2)
            tissue_tool_turns(tissue, tool, tool->stiffness * 1e-4);
        pose_orient(&tool->device, y_axis, scene->lean[t]);
        tool->device.position[0] = scene->x[t];
        tool->device.position[1] = 0.015 * t;
        tool->device.position[2] = top + tool->segment.radius + 0.001;
        tool->device.position[2] -= fmin(tool->segment.a[2] * cos(scene->lean[t]), 0.0);
    }
    return 1;
}

static void judge(const struct worst *worst, const char *name, int turn)
{
    CHECK(worst->force <= 1.0, "%s, %d: the wrench is off by %g times what it may be", name, turn, worst->force);
    CHECK(worst->node <= 1.0, "%s, %d: nodes are off by %g times what they may be", name, turn, worst->node);
    CHECK(worst->off <= 0.05 * worst->ticks, "%s, %d: off in %u ticks of %u", name, turn, worst->off, worst->ticks);
    CHECK(worst->gap < GAP, "%s, %d: %g m deep", name, turn, worst->gap);
    CHECK(worst->product < GAP, "%s, %d: pushed over a gap of %g m", name, turn, worst->product);
    CHECK(worst->end < END, "%s, %d: a tool ends %g m from where it should", name, turn, worst->end);
    CHECK(!worst->crowded, "%s, %d: crowded in %u ticks", name, turn, worst->crowded);
    CHECK(worst->pull < 1e-6, "%s, %d: a load is not along its pair: %g", name, turn, worst->pull);
    CHECK(worst->peak > 0.002 && worst->ticks > 30, "%s, %d: %g N in %u ticks", name, turn, worst->peak, worst->ticks);
}

static void it_is_what_a_brute_solve_finds(void)
{
    static struct brute brute;
    static struct tissue_rig tissue;
    uint32_t gave_way = 0;
    for (size_t s = 0; s < sizeof scenes / sizeof *scenes; s++)
        for (int turn = 0; turn < (int)part_of(8); turn++) {
            const struct scene *scene = &scenes[s];
            struct worst worst = { 0 };
            int touched = 0;
            if (brute_open(&brute, &tissue) && make_scene(&tissue, scene, (uint64_t)(turn + 1) * 77 + s)) {
                /* Few ticks count where a load is spread, as something has risen unfelt, and of a sheet that flies. */
                const int each = scene->load_radius > 0.0 || scene->sheet ? 1 : EACH;
                press(&brute, (uint64_t)turn, 0.006, each, scene->yields > 0.0, &worst);
                judge(&worst, scene->name, turn);
                gave_way += worst.gave_way;
                for (int i = 0; i < TISSUE_BODIES * TISSUE_TOOLS; i++)
                    touched += worst.touched[i / TISSUE_TOOLS][i % TISSUE_TOOLS] > 0;
                CHECK(touched >= scene->touched, "%s, %d: %d tools on bodies", scene->name, turn, touched);
            }
            brute_close(&brute);
        }
    CHECK(gave_way || part_of(8) < 2, "no tool gave way");
}

/* A box, round at its edges, that is pressed into a ball and turned. */
static void a_tip_is_what_a_brute_solve_finds(void)
{
    static struct brute brute;
    static struct tissue_rig tissue;
    static struct oracle_hull as;
    static uint64_t block[2048];
    for (int turn = 0; turn < (int)part_of(8); turn++) {
        const dpt_segment inside = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 }, 0.0 };
        double axis[3] = { 0.3, 1.0, 0.2 };
        double corners[3 * DPT_HULL_CORNERS_MAX];
        const dpt_hull_shape shape = { .size = sizeof shape, .extent = { 0.024, 0.012, 0.008 } };
        dpt_hull_def def = { .size = sizeof def, .corners = corners, .radius = 0.001 };
        dpt_hull_info info = { .size = sizeof info };
        dpt_tip tip = { .size = sizeof tip };
        struct tissue_def ball_def = tissue_ball();
        struct worst worst = { 0 };
        uint64_t seed = 5 + (uint64_t)turn;
        dpt_hull_shape_corners(&shape, corners, DPT_HULL_CORNERS_MAX, &def.corner_count);
        CHECK(dpt_hull_create(block, sizeof block, &def, &tip.hull) == DPT_OK && !oracle_hull_read(tip.hull, &as),
              "no hull");
        dpt_hull_get_info(tip.hull, &info);
        ball_def.integrator = turn & 1 ? DPT_INTEGRATOR_EULER : DPT_INTEGRATOR_SYMPLECTIC;
        if (brute_open(&brute, &tissue) && tissue_rig_add_soft(&tissue, &ball_def)) {
            struct tissue_tool *tool = tissue_rig_add_tool(&tissue, &inside, random_in(&seed, 200.0, 2000.0));
            CHECK(dpt_tool_set_tips(tissue.rig.world, tool->id, &tip, 1) == DPT_OK, "no tip");
            /* What counts for its centre and its turns. */
            for (int k = 0; k < 3; k++) {
                tool->segment.a[k] = info.axis[0][k];
                tool->segment.b[k] = info.axis[1][k];
            }
            tool->rho = apart(tool->segment.a, tool->segment.b) / sqrt(12.0);
            brute.hull = &as;
            brute.hull_radius = def.radius;
            unit3(axis);
            pose_orient(&tool->device, axis, 0.1 * turn);
            tool->device.position[2] = tissue.body[0].top + 0.018;
            press(&brute, seed, 0.016, EACH, 0, &worst);
            judge(&worst, "tip", turn);
        }
        brute_close(&brute);
    }
}

/* Tools and bodies added in another order, and springs handed over in another one: the same but for what a residual allows. */
static void the_order_is_of_no_account(void)
{
    static dpt_wrench felt[2][TICKS][TISSUE_TOOLS];
    const size_t each = few_of(2) < 2 ? 3 : 1;
    for (size_t s = 0; s < sizeof scenes / sizeof *scenes; s += each)
        for (int turn = 0; turn < (int)part_of(4); turn++) {
            double off = 0.0, peak = 0.0;
            for (int order = 0; order < 2; order++) {
                struct tissue_rig tissue;
                struct course course;
                tissue_rig_open(&tissue);
                tissue.is_reversed = order;
                if (make_scene(&tissue, &scenes[s], (uint64_t)(turn + 1) * 77 + s)) {
                    begin_course(&tissue, &course, (uint64_t)turn, 0.006);
                    for (int i = 0; i < TICKS; i++) {
                        lead(&tissue, &course, i);
                        tissue_rig_step_springs(&tissue);
                        for (uint32_t t = 0; t < tissue.tool_count; t++)
                            felt[order][i][order ? tissue.tool_count - 1 - t : t] = tissue.tool[t].force.wrench;
                    }
                }
                tissue_rig_close(&tissue);
            }
            for (int i = 0; i < TICKS; i++)
                for (int t = 0; t < scenes[s].tools; t++) {
                    peak = fmax(peak, length3(felt[0][i][t].force));
                    off = fmax(off, apart(felt[0][i][t].force, felt[1][i][t].force));
                    off = fmax(off, apart(felt[0][i][t].torque, felt[1][i][t].torque) / 0.1);
                }
            CHECK(peak > 0.002 && off <= 1e-4 * fmax(1.0, peak), "%s, %d: %g N apart, of %g N", scenes[s].name, turn,
                  off, peak);
        }
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(it_is_what_a_brute_solve_finds);
    TEST(the_order_is_of_no_account);
    TEST(a_tip_is_what_a_brute_solve_finds);
    return check_report();
}
