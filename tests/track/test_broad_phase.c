/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Many bodies: the exact method, which asks those that may be near, against the tree, which asks
 * every one. Up to a thousand bodies in clouds, grids and piles, near by and 1e5 m away; tools that
 * fly, rest, jump and are teleported; bodies that move, come near suddenly, leave, and come back in
 * a slot that another had; with budgets too. What must not be paid for is what is far: work with
 * and without a thousand far bodies.
 *
 *     test_broad_phase [TICKS]   of each scene; the default is what make check runs
 */
#include <math.h>
#include <time.h>

#include "lib/fixture.h"
#include "lib/rig.h"

#if defined(__SANITIZE_ADDRESS__)
static uint32_t ticks = 16, slide_ticks = 200;
#else
static uint32_t ticks = 120, slide_ticks = 2000;
#endif

enum { BODIES_MAX = 1001, SEGMENTS_MAX = 6, MESHES = 4 };
enum layout { CLOUD, GRID, PILE, FAR, LAYOUTS };
static const char *const layouts[LAYOUTS] = { "cloud", "grid", "pile", "far" };
static const uint32_t counts[] = { 1, 2, 3, 4, 5, 6, 17, 100, 1000 };
enum { COUNTS = sizeof counts / sizeof *counts };

static struct fixture meshes[MESHES]; /* each about 0.2 m */

static double one(uint64_t *random)
{
    return random_in(random, -1.0, 1.0);
}

static uint32_t below(uint64_t *random, uint32_t end)
{
    return (uint32_t)(random_bits(random) % end);
}

static void turn_any_way(uint64_t *random, dpt_pose *pose)
{
    double size = 0.0, *q = pose->orientation;
    for (int k = 0; k < 4; k++) {
        q[k] = one(random);
        size += q[k] * q[k];
    }
    for (int k = 0; k < 4; k++)
        q[k] = size > 1e-3 ? q[k] / sqrt(size) : k == 0;
}

/* One of the two worlds: exact, perhaps with a budget, and the tree. */
struct side {
    struct rig rig;
    dpt_tool tools[2];
    dpt_body body[BODIES_MAX];
};

/* A rope, after a tool of one segment that comes and goes. */
struct run {
    struct side sides[2];
    uint64_t random;
    uint32_t count, segments, budget, tick;
    int layout;
    double spread; /* how far bodies are from the origin */
    dpt_pose pose[BODIES_MAX];
    uint32_t mesh[BODIES_MAX];
    char there[BODIES_MAX];
    int has_first;
    dpt_segment first, rope[SEGMENTS_MAX];
    double way[3];
    char what[80];
};

static struct tally {
    uint64_t asked, bounded, far, crossing;
} all;

static void place_body(struct run *run, uint32_t b)
{
    dpt_pose *pose = &run->pose[b];
    uint32_t row = b % 10, column = b / 10 % 10, floor = b / 100;
    const double cell[3] = { row, column, floor };
    turn_any_way(&run->random, pose);
    for (int k = 0; k < 3; k++)
        switch (run->layout) {
        case GRID: /* each touches its neighbours */
            pose->position[k] = 0.16 * cell[k] - 0.7;
            break;
        case PILE:
            pose->position[k] = 0.01 * one(&run->random);
            break;
        case FAR: /* but for a few */
            pose->position[k] = (b % 50 ? 1e5 : 0.5) * one(&run->random);
            break;
        default:
            pose->position[k] = run->spread * one(&run->random);
        }
}

static void add_body(struct run *run, uint32_t b)
{
    run->mesh[b] = below(&run->random, MESHES);
    run->there[b] = 1;
    for (int i = 0; i < 2; i++)
        run->sides[i].body[b] = rig_add_body(&run->sides[i].rig, meshes[run->mesh[b]].mesh, &run->pose[b]);
}

static void remove_body(struct run *run, uint32_t b)
{
    run->there[b] = 0;
    for (int i = 0; i < 2; i++)
        CHECK(dpt_body_remove(run->sides[i].rig.world, run->sides[i].body[b]) == DPT_OK, "remove");
}

static void move_body(struct run *run, uint32_t b)
{
    for (int i = 0; i < 2 && run->there[b]; i++)
        dpt_body_set_pose(run->sides[i].rig.world, run->sides[i].body[b], &run->pose[b]);
}

static void move_tool(struct run *run, const double by[3])
{
    for (int k = 0; k < 3; k++) {
        for (uint32_t i = 0; i < run->segments; i++) {
            run->rope[i].a[k] += by[k];
            run->rope[i].b[k] += by[k];
        }
        run->first.a[k] -= by[k];
    }
}

/* The first tool leaves, so that the rope's segments move up, or comes back behind them. */
static void toggle_first_tool(struct run *run)
{
    run->has_first ^= 1;
    for (int i = 0; i < 2; i++) {
        struct side *side = &run->sides[i];
        if (run->has_first)
            side->tools[0] = rig_add_tool(&side->rig, &run->first, 1);
        else
            CHECK(dpt_tool_remove(side->rig.world, side->tools[0]) == DPT_OK, "tool");
    }
}

static void open_run(struct run *run)
{
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    def.max_bodies = run->count + 1;
    def.until = DPT_UNTIL_TRACK;
    def.certificate_bytes = 1 << 16;
    run->tick = 0;
    run->has_first = 0;
    for (int i = 0; i < 2; i++) {
        struct side *side = &run->sides[i];
        def.method = i ? DPT_METHOD_TREE : DPT_METHOD_EXACT;
        def.budget = i ? 0 : run->budget;
        rig_open(&side->rig, &def, NULL, NULL, 0);
    }
    run->spread = 0.25 * cbrt(run->count);
    for (uint32_t b = 0; b < run->count; b++) {
        place_body(run, b);
        add_body(run, b);
    }
    toggle_first_tool(run);
    for (uint32_t i = 0; i < run->segments; i++)
        for (int k = 0; k < 3; k++) {
            run->rope[i].a[k] = i ? run->rope[i - 1].b[k] : 0.3 * one(&run->random);
            run->rope[i].b[k] = run->rope[i].a[k] + 0.1 * one(&run->random);
            run->rope[i].radius = 0.0;
            run->first.a[k] = run->spread * one(&run->random);
            run->first.b[k] = run->first.a[k] + 0.1;
        }
    for (int i = 0; i < 2; i++)
        run->sides[i].tools[1] = rig_add_tool(&run->sides[i].rig, run->rope, run->segments);
}

static void close_run(struct run *run)
{
    rig_close(&run->sides[0].rig);
    rig_close(&run->sides[1].rig);
}

static void agree(const struct run *run, const dpt_hit *found, const dpt_hit *truth)
{
    double tiny = truth->error_bound, above = found->distance - truth->distance;
    CHECK(found->status == DPT_STATUS_EXACT ||
              (run->budget && found->status == DPT_STATUS_BOUNDED && found->contact == 0),
          "%s, tick %u: status %u", run->what, run->tick, found->status);
    CHECK(above >= -2.0 * tiny && above <= found->error_bound + tiny,
          "%s, tick %u, segment %u: %.17g, the truth is %.17g", run->what, run->tick, found->segment, found->distance,
          truth->distance);
    /* What is far counts with its coordinates. */
    CHECK(found->status != DPT_STATUS_EXACT || found->error_bound <= 4e-8, "%s: exact within %g", run->what,
          found->error_bound);
    CHECK(found->lower_bound >= 0.0 && found->lower_bound <= truth->distance + tiny,
          "%s, tick %u: lower bound %.17g, the truth is %.17g", run->what, run->tick, found->lower_bound,
          truth->distance);
    all.asked++;
    all.bounded += found->status == DPT_STATUS_BOUNDED;
    all.far += truth->distance > 1.0;
    all.crossing += truth->distance == 0.0;
}

/* One tick of both. Returns whether all is exact. */
static int step_run(struct run *run, dpt_hit *near)
{
    const struct rig *found = &run->sides[0].rig;
    for (int i = 0; i < 2; i++) {
        struct side *side = &run->sides[i];
        dpt_tool_set_segments(side->rig.world, side->tools[1], run->rope, run->segments);
        if (run->has_first)
            dpt_tool_set_segments(side->rig.world, side->tools[0], &run->first, 1);
        rig_tick(&side->rig);
    }
    for (uint32_t i = 0; i < run->segments + (run->has_first != 0); i++) {
        dpt_hit hit[2] = { DPT_HIT_INIT, DPT_HIT_INIT };
        for (int k = 0; k < 2; k++)
            dpt_tool_get_segment_hit(run->sides[k].rig.world, run->sides[k].tools[i < run->segments],
                                     i < run->segments ? i : 0, &hit[k]);
        agree(run, &hit[0], &hit[1]);
        if (i == 0)
            *near = hit[1];
    }
    CHECK(!run->budget || found->step.work <= run->budget, "%s: work %u", run->what, found->step.work);
    run->tick++;
    return found->step.status == DPT_STATUS_EXACT;
}

/* The tool flies, jumps or rests, and bodies do what they can do. */
static void next_tick(struct run *run, const dpt_hit *near)
{
    uint64_t *random = &run->random;
    uint32_t b = below(random, run->count), event = below(random, 16), doing = run->tick / 16 % 4;
    const dpt_pose *pose = &run->pose[b];
    double by[3];
    for (int k = 0; k < 3; k++) {
        if (run->tick % 16 == 0)
            run->way[k] = 4e-3 * one(random); /* 4 m/s */
        by[k] = run->way[k] + (near->distance > 0.1 ? 0.02 * (near->q[k] - near->p[k]) : 0.0);
        if (doing == 1)
            by[k] = run->tick % 4 ? 0.0 : pose->position[k] - run->rope[0].a[k] + 0.2 * one(random);
        if (doing == 2)
            by[k] *= 0.01;
    }
    if (doing < 3 && (doing != 1 || (fabs(by[0]) < 1e5 && run->tick % 4 == 0)))
        move_tool(run, by);
    if (event == 0 && run->there[b] && b) { /* one stays: without any there is no answer */
        remove_body(run, b);
    } else if (event <= 1 && !run->there[b]) {
        place_body(run, b);
        add_body(run, b);
    } else if (event == 2) { /* comes near suddenly */
        for (int k = 0; k < 3; k++)
            run->pose[b].position[k] = run->rope[0].a[k] + 0.3 * one(random);
        move_body(run, b);
    } else if (event == 3) { /* leaves */
        for (int k = 0; k < 3; k++)
            run->pose[b].position[k] = 1e5 * one(random);
        move_body(run, b);
    } else if (event == 4) {
        place_body(run, b);
        move_body(run, b);
    } else if (event == 5 && run->tick % 2) {
        const dpt_pose identity = DPT_POSE_IDENTITY;
        for (int i = 0; i < 2; i++)
            dpt_tool_teleport(run->sides[i].rig.world, run->sides[i].tools[1], &identity);
    } else if (event == 6) {
        toggle_first_tool(run);
    } else if (event >= 12) { /* some drift */
        for (uint32_t i = b; i < run->count && i < b + 40; i++) {
            for (int k = 0; k < 3; k++)
                run->pose[i].position[k] += 5e-3 * one(random);
            move_body(run, i);
        }
    }
}

static void follow(struct run *run)
{
    dpt_hit near = { 0 };
    open_run(run);
    for (uint32_t tick = 0; tick < ticks; tick++) {
        step_run(run, &near);
        next_tick(run, &near);
    }
    /* Enough for any search of these meshes by each segment, with the budget. */
    int exact = 0;
    for (uint32_t tick = 0; tick < 20000 && !exact; tick++)
        exact = step_run(run, &near);
    CHECK(exact, "%s: never exact at rest", run->what);
    close_run(run);
}

static void near_bodies_are_all_bodies(void)
{
    static struct run run;
    uint32_t whole = ticks;
    for (uint32_t c = 0; c < COUNTS; c++)
        for (run.layout = 0; run.layout < LAYOUTS; run.layout++)
            for (uint32_t segments = 1; segments <= SEGMENTS_MAX; segments += 5) {
                run.count = counts[c];
                run.segments = segments;
                run.random = 100 * c + segments;
                ticks = run.count < 1000 ? whole : whole / (segments > 1 ? 3 : 1);
                snprintf(run.what, sizeof run.what, "%s of %u, %u segments", layouts[run.layout], run.count, segments);
                follow(&run);
            }
    ticks = whole;
    printf("    %llu answers, %llu crossing, %llu of what is over a metre away\n", (unsigned long long)all.asked,
           (unsigned long long)all.crossing, (unsigned long long)all.far);
    CHECK(all.crossing > 100 && all.far > 100 && all.asked > 2 * (all.crossing + all.far), "one-sided");
}

/* Bounded answers are true, whichever bodies the budget did not reach. */
static void budgets_among_many_bodies(void)
{
    static struct run run;
    static const uint32_t budgets[] = { 1, 2, 7, 30, 200 };
    uint32_t whole = ticks;
    all = (struct tally){ 0 };
    for (uint32_t b = 0; b < sizeof budgets / sizeof *budgets; b++)
        for (uint32_t c = 1; c < COUNTS; c += c == 3 ? 3 : 2) {
            run.layout = (int)((b + c) % LAYOUTS);
            run.count = counts[c];
            run.budget = budgets[b];
            run.segments = 1 + (b + c) % 2 * 5;
            run.random = 10 * c + b;
            ticks = run.count < 1000 ? whole : whole / 2;
            snprintf(run.what, sizeof run.what, "%s of %u, %u segments, budget %u", layouts[run.layout], run.count,
                     run.segments, run.budget);
            follow(&run);
        }
    ticks = whole;
    printf("    %llu answers, %llu bounded\n", (unsigned long long)all.asked, (unsigned long long)all.bounded);
    CHECK(all.bounded * 10 > all.asked && all.bounded * 10 < 9 * all.asked, "one-sided");
}

/* A dozen small bodies at once, in both worlds; all but the last two are out of the way. */
static void open_row(struct run *run, double between)
{
    *run = (struct run){ .random = 1, .count = 12, .segments = 1, .layout = CLOUD };
    open_run(run);
    toggle_first_tool(run);
    for (uint32_t b = 0; b < run->count; b++) {
        run->pose[b] = (dpt_pose)DPT_POSE_IDENTITY;
        run->pose[b].position[b < 10] = b < 10 ? 5.0 : (b - 10) * between;
        move_body(run, b);
    }
}

/*
 * From one body to the next, at every distance between them: whichever room was given around the
 * tool, at some distance the second one is just outside of it when it becomes the nearest.
 */
static void next_body_is_just_outside(void)
{
    static struct run run;
    const double step[3] = { 5e-4, 0.0, 0.0 };
    dpt_hit near;
    for (double between = 0.5; between < 0.8; between += 0.07 / ticks) {
        open_row(&run, between);
        snprintf(run.what, sizeof run.what, "%g m between", between);
        run.rope[0] = (dpt_segment){ { 0.25, 0.0, 0.0 }, { 0.25, 0.01, 0.0 }, 0.0 };
        for (uint32_t tick = 0; tick < 400; tick++) {
            step_run(&run, &near);
            move_tool(&run, step);
        }
        close_run(&run);
    }
}

/* A tool leaves, and the segments of those behind it move up, with what is known of them. */
static void what_is_known_moves_up(void)
{
    static struct run run;
    const double step[3] = { 2e-3, 0.0, 0.0 };
    dpt_hit near;
    for (uint32_t tick = 0; tick < 60; tick += 3) {
        open_row(&run, 0.5);
        snprintf(run.what, sizeof run.what, "a tool leaves after %u ticks", tick);
        /* It must come before the rope does. */
        for (int i = 0; i < 2; i++) {
            struct side *side = &run.sides[i];
            run.first = (dpt_segment){ { 3.0, 5.0, 0.0 }, { 3.1, 5.0, 0.0 }, 0.0 };
            CHECK(dpt_tool_remove(side->rig.world, side->tools[1]) == DPT_OK, "remove");
            side->tools[0] = rig_add_tool(&side->rig, &run.first, 1);
            side->tools[1] = rig_add_tool(&side->rig, run.rope, 1);
        }
        run.has_first = 1;
        run.rope[0] = (dpt_segment){ { 0.15, 0.0, 0.0 }, { 0.15, 0.01, 0.0 }, 0.0 };
        for (uint32_t at = 0; at < 120; at++) {
            if (at == tick)
                toggle_first_tool(&run);
            step_run(&run, &near);
            move_tool(&run, step);
        }
        close_run(&run);
    }
}

struct cost {
    uint64_t work, first;
    double time; /* s, poses included */
};

static double seconds(void)
{
    return (double)clock() / CLOCKS_PER_SEC;
}

/* A slide along one body, beside `far` others that are beyond 10 of its diagonals. */
static struct cost slide_beside(uint32_t far, int they_move, uint32_t segments)
{
    enum { FAR_MAX = 1000 };
    static dpt_body body[FAR_MAX];
    static dpt_pose pose[FAR_MAX];
    struct cost cost = { 0 };
    dpt_segment rope[SEGMENTS_MAX];
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    struct rig rig;
    uint64_t random = 3;
    def.max_bodies = FAR_MAX + 1;
    rig_open(&rig, &def, meshes[0].mesh, NULL, 0);
    for (uint32_t b = 0; b < far; b++) {
        const double limits[2] = { 4.5, 40.0 }; /* the diagonal is 0.41 m */
        for (int k = 0; k < 3; k++)
            pose[b].position[k] =
                (k == (int)(b % 3) ? (b % 2 ? -1.0 : 1.0) : one(&random)) * random_in(&random, limits[0], limits[1]);
        turn_any_way(&random, &pose[b]);
        body[b] = rig_add_body(&rig, meshes[b % MESHES].mesh, &pose[b]);
    }
    double begun = seconds();
    for (uint32_t tick = 0; tick < slide_ticks; tick++) {
        for (uint32_t i = 0; i < segments; i++) { /* around the torus, some mm above it */
            double turn = 1e-3 * tick + 0.5 * i;
            rope[i] = (dpt_segment){ { 0.1 * cos(turn), 0.1 * sin(turn), 0.045 },
                                     { 0.1 * cos(turn + 0.5), 0.1 * sin(turn + 0.5), 0.05 },
                                     0.0 };
        }
        for (uint32_t b = 0; b < far && they_move; b++) {
            pose[b].position[tick % 3] += 1e-3 * one(&random);
            dpt_body_set_pose(rig.world, body[b], &pose[b]);
        }
        if (tick == 0)
            rig_add_tool(&rig, rope, segments);
        dpt_tool_set_segments(rig.world, rig.tool, rope, segments);
        rig_tick(&rig);
        cost.work += rig.step.work;
        cost.first += tick ? 0 : rig.step.work;
    }
    cost.time = seconds() - begun;
    rig_close(&rig);
    return cost;
}

static void far_bodies_cost_nothing(void)
{
    for (uint32_t segments = 1; segments <= SEGMENTS_MAX; segments += 5) {
        struct cost alone = slide_beside(0, 0, segments);
        for (int they_move = 0; they_move < 2; they_move++) {
            struct cost beside = slide_beside(1000, they_move, segments);
            double ratio = (double)beside.work / (double)alone.work;
            printf("    %u segments beside 1000 far bodies%s: %.3f of the work, %.2f of the time%s\n", segments,
                   they_move ? " that move" : "", ratio, beside.time / alone.time, they_move ? ", poses included" : "");
            /* Looking at the boxes of 16 bodies is a unit, docs/algorithms/budget.md. */
            CHECK(beside.first >= alone.first + 1000 / 16, "%llu units, alone %llu", (unsigned long long)beside.first,
                  (unsigned long long)alone.first);
            CHECK(ratio <= 1.2, "%llu units, alone %llu", (unsigned long long)beside.work,
                  (unsigned long long)alone.work);
        }
    }
}

/*
 * A line that crosses a body all the way has no need of a list; into a second body, of a margin of 0, it slides out of
 * the list that it once had. The gap is the least over both.
 */
static void a_line_without_a_margin_meets_them_all(void)
{
    enum { OTHERS = 5, STEPS = 400 };
    struct fixture ball;
    struct rig rig[2];
    int both = 0;
    if (!fixture_from_shape(&ball, "sphere", 1280))
        return;
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(ball.mesh, &info);
    const double radius = 0.5 * (info.box_max[0] - info.box_min[0]);
    for (int side = 0; side < 2; side++) {
        const dpt_segment line = { { 0.9 * radius, 0, 0 }, { 1.1 * radius, 0, 0 }, 0.0 };
        dpt_world_def def = rig_def(DPT_LAW_POINT);
        def.margin = 0.0;
        def.method = side ? DPT_METHOD_TREE : DPT_METHOD_EXACT;
        rig_open(&rig[side], &def, NULL, &line, 1);
        for (int i = 0; i <= OTHERS; i++) {
            dpt_pose pose = DPT_POSE_IDENTITY;
            pose.position[0] = i == 1 ? -1.5 * radius : -30.0 * i * radius;
            rig_add_body(&rig[side], ball.mesh, &pose);
        }
    }
    for (int i = 0; i < STEPS; i++) {
        /* From outside into the first ball, then about its middle to where the second one is. */
        const double in = i < 30 ? 0.105 * radius * (1.0 - i / 29.0) : 0.0;
        const double turn = i < 30 ? 0.0 : 3.14159 * (i - 30) / (STEPS - 31);
        const dpt_pose pose = { { in, 0, 0 }, { cos(0.5 * turn), 0, 0, sin(0.5 * turn) } };
        for (int side = 0; side < 2; side++)
            rig_step_to(&rig[side], &pose);
        const dpt_hit hit[2] = { rig[0].hit, rig[1].hit };
        CHECK(hit[0].status == DPT_STATUS_EXACT && hit[0].contact == hit[1].contact &&
                  fabs(hit[0].gap - hit[1].gap) <= 1e-4 * radius,
              "step %d: contact %u, gap %g, not %u, %g", i, hit[0].contact, hit[0].gap, hit[1].contact, hit[1].gap);
        both += hit[1].gap < -0.2 * radius;
    }
    CHECK(both > 10, "%d steps in both", both);
    for (int side = 0; side < 2; side++)
        rig_close(&rig[side]);
    fixture_free(&ball);
}

int main(int argc, char **argv)
{
    static const char *const names[MESHES] = { "torus", "box", "membrane", "sphere" };
    static const uint64_t triangles[MESHES] = { 600, 12, 32, 200 };
    if (argc > 1)
        ticks = (uint32_t)strtoul(argv[1], NULL, 10);
    for (int m = 0; m < MESHES; m++)
        if (!fixture_from_shape(&meshes[m], names[m], triangles[m]))
            return 2;
    TEST(near_bodies_are_all_bodies);
    TEST(budgets_among_many_bodies);
    TEST(next_body_is_just_outside);
    TEST(what_is_known_moves_up);
    TEST(far_bodies_cost_nothing);
    TEST(a_line_without_a_margin_meets_them_all);
    for (int m = 0; m < MESHES; m++)
        fixture_free(&meshes[m]);
    return check_report();
}
