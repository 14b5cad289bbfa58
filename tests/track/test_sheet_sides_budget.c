/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * From which side a tool came through a sheet, with budgets that leave sweeps and contacts undecided for some ticks,
 * and whatever may happen meanwhile: another crossing, the way back, a sheet that moves, comes or goes, a step that
 * fails. A side may be unknown, or lost where the way was; it may never be the wrong one. The truth is the path that
 * was taken.
 *
 * Usage: test_sheet_sides_budget [worlds = 250] [seed = 1].
 */
#include "lib/fixture.h"
#include "track/sheet_truth.h"

static uint64_t random_state = 1;
static unsigned long world_count = 250;
static struct fixture sheet; /* 0.2 m square, z = 0 */

enum { MOST = 3000, ALWAYS = 2 };

static double any(double low, double high)
{
    return random_in(&random_state, low, high);
}

static uint32_t below(uint32_t n)
{
    return (uint32_t)(random_bits(&random_state) % n);
}

struct scene {
    struct rig rig;
    dpt_sweep sweep;
    uint32_t met, lost; /* sweeps that told of something, and ways that were given up */
};

static int scene_begin(struct scene *scene, uint32_t budget, double radius)
{
    const dpt_segment lying = { { -0.02, 0.0, 0.0 }, { 0.02, 0.005, 0.0 }, radius };
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    def.budget = budget;
    def.certificate_bytes = 1 << 16;
    def.fade = 0.0; /* the force is of this tick alone */
    *scene = (struct scene){ .met = 0 };
    return rig_open(&scene->rig, &def, NULL, &lying, 1);
}

static dpt_pose at(double x, double z)
{
    dpt_pose pose = DPT_POSE_IDENTITY;
    pose.position[0] = x;
    pose.position[2] = z;
    return pose;
}

static dpt_body add_sheet(struct scene *scene, double x, double z)
{
    const dpt_pose pose = at(x, z);
    return rig_add_body(&scene->rig, sheet.mesh, &pose);
}

static void tick(struct scene *scene)
{
    rig_tick(&scene->rig);
    scene->sweep = (dpt_sweep){ .size = sizeof scene->sweep };
    dpt_tool_get_sweep(scene->rig.world, scene->rig.tool, 0, &scene->sweep);
    scene->met += scene->sweep.status == DPT_SWEEP_HIT;
    scene->lost += scene->sweep.status == DPT_SWEEP_NONE && !scene->met;
    CHECK(scene->rig.hit.contact != DPT_CONTACT_UNKNOWN || scene->rig.force.wrench.force[2] == 0.0, "force %g",
          scene->rig.force.wrench.force[2]);
}

static void go_to(struct scene *scene, double x, double z)
{
    const dpt_pose pose = at(x, z);
    dpt_tool_set_pose(scene->rig.world, scene->rig.tool, &pose);
    tick(scene);
}

/* Until all is known, or nothing more will be. */
static void rest(struct scene *scene)
{
    for (int i = 0; i < MOST; i++) {
        tick(scene);
        if (scene->rig.hit.status == DPT_STATUS_EXACT && scene->rig.hit.contact != DPT_CONTACT_UNKNOWN &&
            scene->sweep.status != DPT_SWEEP_UNFINISHED && i > 2)
            break;
    }
}

static void begin_at(struct scene *scene, double x, double z)
{
    const dpt_pose pose = at(x, z);
    dpt_tool_teleport(scene->rig.world, scene->rig.tool, &pose);
    rest(scene);
    scene->met = scene->lost = 0;
}

/*
 * What happens, and to which side it must not push: down (+1), up (-1). Where a way was given up it may, but for what
 * says so ALWAYS.
 */
static int through_by_radius_then_axis(struct scene *scene, uint32_t budget)
{
    (void)budget;
    add_sheet(scene, 0.0, 0.0);
    begin_at(scene, 0.0, 0.006);
    go_to(scene, 0.0, 0.001);
    go_to(scene, 0.0, -0.001);
    rest(scene);
    return 1;
}

static int a_sheet_a_tick(struct scene *scene, uint32_t budget)
{
    add_sheet(scene, 0.0, 0.0);
    add_sheet(scene, 0.0, -0.02);
    begin_at(scene, 0.0, 0.005);
    go_to(scene, 0.0, 0.003);
    go_to(scene, 0.0, -0.01);
    go_to(scene, 0.0, -0.021);
    rest(scene);
    CHECK(scene->met >= 2 || (budget && budget < 40), "budget %u: %u met", budget, scene->met);
    return 1;
}

static int two_sheets_in_a_tick(struct scene *scene, uint32_t budget)
{
    (void)budget;
    add_sheet(scene, 0.0, -0.02);
    add_sheet(scene, 0.0, 0.0);
    begin_at(scene, 0.0, 0.006);
    go_to(scene, 0.0, -0.021);
    rest(scene);
    return 1;
}

static int there_and_back(struct scene *scene, uint32_t budget)
{
    add_sheet(scene, 0.0, 0.0);
    begin_at(scene, 0.0, 0.005);
    go_to(scene, 0.01, -0.003);
    for (int i = 0; i < MOST && !scene->met; i++)
        tick(scene);
    go_to(scene, 0.0, 0.0025);
    rest(scene);
    go_to(scene, 0.0, 0.02);
    rest(scene);
    CHECK(scene->rig.hit.contact == DPT_CONTACT_SEPARATED || (budget && budget < 10), "budget %u: contact %u far away",
          budget, scene->rig.hit.contact);
    return 1;
}

static int a_step_that_fails(struct scene *scene, uint32_t budget)
{
    (void)budget;
    add_sheet(scene, 0.0, 0.0);
    begin_at(scene, 0.0, 0.005);
    go_to(scene, 0.01, -0.003);
    for (int i = 0; i < MOST && !scene->met; i++)
        tick(scene);
    CHECK(dpt_world_step(scene->rig.world, 0.0, NULL) == DPT_E_ARGUMENT, "dt 0");
    rest(scene);
    CHECK(scene->rig.hit.contact != DPT_CONTACT_SEPARATED, "budget %u: free on the far side", budget);
    return 1;
}

/* Round the border, close to the sheet, while the sweep lags; slowly, so that it is given up with little. */
static int round_the_border(struct scene *scene, uint32_t budget)
{
    enum { STEPS = 5 };
    static const double way[][2] = { { 0.07, 0.003 },  { 0.09, 0.003 },  { 0.13, 0.003 }, { 0.13, -0.003 },
                                     { 0.09, -0.003 }, { 0.07, -0.003 }, { 0.05, -0.003 } };
    int steps = budget % 2 ? 1 : STEPS;
    add_sheet(scene, 0.0, 0.0);
    begin_at(scene, way[0][0], way[0][1]);
    for (size_t k = 1; k < COUNT(way); k++)
        for (int i = 1; i <= steps; i++) {
            double t = (double)i / steps;
            go_to(scene, way[k - 1][0] + t * (way[k][0] - way[k - 1][0]),
                  way[k - 1][1] + t * (way[k][1] - way[k - 1][1]));
        }
    rest(scene);
    CHECK(!scene->met, "budget %u: %u met on a free way", budget, scene->met);
    go_to(scene, 0.05, -0.0015);
    rest(scene);
    return -ALWAYS;
}

/* The sheet comes down, beside the tool, while the way on which that left waits. */
static int a_sheet_that_follows(struct scene *scene, uint32_t budget)
{
    dpt_body body = add_sheet(scene, 0.0, 0.0);
    const dpt_pose lower = at(0.0, -0.02);
    begin_at(scene, 0.0, -0.003);
    go_to(scene, 0.2, -0.0085);
    dpt_body_set_pose(scene->rig.world, body, &lower);
    go_to(scene, 0.2, -0.0082);
    rest(scene);
    CHECK(!scene->met, "budget %u: met without a touch", budget);
    return -1;
}

/* It touches in front, goes round, and the way is given up: it is not known to be behind. */
static int a_side_that_is_given_up(struct scene *scene, uint32_t budget)
{
    dpt_body body = add_sheet(scene, 0.0, 0.0);
    const dpt_pose beside = at(0.0001, 0.0);
    (void)budget;
    begin_at(scene, 0.05, 0.0025);
    go_to(scene, 0.14, 0.0025);
    go_to(scene, 0.14, -0.02);
    go_to(scene, 0.05, -0.02);
    dpt_body_set_pose(scene->rig.world, body, &beside);
    tick(scene);
    rest(scene);
    return -ALWAYS;
}

static int both_go_down(struct scene *scene, uint32_t budget)
{
    dpt_body body = add_sheet(scene, 0.0, 0.0);
    const dpt_pose lower = at(0.0, -0.002);
    begin_at(scene, 0.0, -0.003);
    dpt_body_set_pose(scene->rig.world, body, &lower);
    go_to(scene, 0.02, -0.005);
    go_to(scene, 0.02, -0.0051);
    rest(scene);
    CHECK(!scene->met, "budget %u: met without a touch", budget);
    return -1;
}

/* What was proven of a sheet where it was does not hold where it is. */
static int a_sheet_that_came(struct scene *scene, uint32_t budget)
{
    dpt_body body = add_sheet(scene, 0.0, 0.0);
    const dpt_pose near = at(0.03, 0.049);
    begin_at(scene, 0.0, 0.052);
    dpt_body_set_pose(scene->rig.world, body, &near);
    tick(scene);
    go_to(scene, 0.0, 0.0475);
    rest(scene);
    CHECK(scene->met || budget, "not met without a budget");
    return 1;
}

static int a_sheet_that_is_new(struct scene *scene, uint32_t budget)
{
    add_sheet(scene, 0.0, -0.3);
    begin_at(scene, 0.0, 0.006);
    add_sheet(scene, 0.0, 0.0);
    go_to(scene, 0.0, -0.0005);
    rest(scene);
    CHECK(scene->met || budget, "not met without a budget");
    return 1;
}

/* The one that was met goes before the sweep has ended. */
static int a_sheet_that_goes(struct scene *scene, uint32_t budget)
{
    dpt_body first = add_sheet(scene, 0.0, 0.0);
    add_sheet(scene, 0.0, -0.004);
    begin_at(scene, 0.0, 0.006);
    go_to(scene, 0.0, -0.006);
    for (uint32_t i = 0; i < budget % 17 && !scene->met; i++)
        tick(scene);
    uint32_t met = scene->met;
    dpt_body_remove(scene->rig.world, first);
    rest(scene);
    CHECK(met || scene->sweep.status != DPT_SWEEP_HIT || scene->sweep.body != first,
          "budget %u: a body that is gone was met", budget);
    return 1;
}

static void no_push_to_the_wrong_side(void)
{
    static const struct {
        const char *name;
        int (*happens)(struct scene *scene, uint32_t budget);
        uint32_t lost; /* with so many budgets at most */
    } c[] = { { "surface, then axis", through_by_radius_then_axis, 0 },
              { "a sheet a tick", a_sheet_a_tick, 0 },
              { "two sheets in a tick", two_sheets_in_a_tick, 0 },
              { "there and back", there_and_back, 0 },
              { "a step that fails", a_step_that_fails, 0 },
              { "round the border", round_the_border, 20 },
              { "a sheet that follows", a_sheet_that_follows, 45 },
              { "a side given up", a_side_that_is_given_up, 45 },
              { "both go down", both_go_down, 30 },
              { "a sheet that came", a_sheet_that_came, 30 },
              { "a sheet that is new", a_sheet_that_is_new, 45 },
              { "a sheet that goes", a_sheet_that_goes, 0 } };
    for (size_t i = 0; i < COUNT(c); i++) {
        uint32_t pushed = 0, unknown = 0, lost = 0;
        for (uint32_t budget = 0; budget <= 200; budget += budget < 40 ? 1 : 10) {
            struct scene scene;
            if (!scene_begin(&scene, budget, 0.002))
                return;
            int side = c[i].happens(&scene, budget);
            tick(&scene);
            CHECK((scene.lost && abs(side) != ALWAYS) || side * scene.rig.force.wrench.force[2] >= 0.0,
                  "%s, budget %u: gap %g, force %g", c[i].name, budget, scene.rig.hit.gap,
                  scene.rig.force.wrench.force[2]);
            CHECK(scene.rig.step.work <= budget || !budget, "%u units of %u", scene.rig.step.work, budget);
            pushed += scene.rig.force.wrench.force[2] != 0.0;
            unknown += scene.rig.hit.contact == DPT_CONTACT_UNKNOWN;
            lost += scene.lost > 0;
            rig_close(&scene.rig);
        }
        printf("    %-22s pushed with %2u of 57 budgets, unknown with %2u, given up with %2u\n", c[i].name, pushed,
               unknown, lost);
        CHECK(lost <= c[i].lost, "%s: %u given up", c[i].name, lost);
    }
}

/* Without regions a world keeps no sides: through a sheet it knows nothing, and does not call that a lack of room. */
static void no_regions_no_sides(void)
{
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    struct rig rig;
    def.max_contacts = 0;
    rig_open(&rig, &def, sheet.mesh, &rig_point, 1);
    for (int t = 0; t < 4; t++) {
        const double ends[6] = { 0.0, 0.0, t ? -0.001 * t : 0.01, 0.0, 0.0, 0.03 };
        const dpt_hit hit = rig_step_ends(&rig, ends, 0.0);
        CHECK(!rig.step.flags && hit.contact == (t ? DPT_CONTACT_UNKNOWN : DPT_CONTACT_SEPARATED),
              "tick %d: flags %u, contact %u", t, rig.step.flags, hit.contact);
    }
    rig_close(&rig);
}

/*
 * A free tool, and the side of the sheet that its segment is on by the path it took; 0 where the library may have lost
 * it.
 */
struct subject {
    dpt_segment segment;
    dpt_tool tool[2];
    int side;
};

static struct sums {
    unsigned long ticks, unfinished, given_up, checked, behind;
} sums;

static void move_segment(dpt_segment *segment, double pace)
{
    for (int k = 0; k < 3; k++) {
        const double most = k == 2 ? 0.02 : 0.05, by = any(-pace, pace);
        segment->a[k] += by + any(-0.2, 0.2) * pace;
        segment->b[k] += by + any(-0.2, 0.2) * pace;
        segment->a[k] *= fabs(segment->a[k]) > most ? 0.8 : 1.0;
        segment->b[k] *= fabs(segment->b[k]) > most ? 0.8 : 1.0;
    }
}

/* What is told of it, against the side that it has. */
static void check_subject(dpt_world *const world[2], struct subject *subject, double height, unsigned long number)
{
    dpt_hit hit = DPT_HIT_INIT;
    dpt_sweep sweep = { .size = sizeof sweep }, ample = sweep;
    dpt_wrench wrench;
    dpt_tool_get_hit(world[0], subject->tool[0], &hit);
    dpt_tool_get_sweep(world[0], subject->tool[0], 0, &sweep);
    dpt_tool_get_sweep(world[1], subject->tool[1], 0, &ample);
    dpt_tool_get_wrench(world[0], subject->tool[0], &wrench);
    const double a = subject->segment.a[2] - height, b = subject->segment.b[2] - height;
    const int here = a > 0.0 && b > 0.0 ? 1 : a < 0.0 && b < 0.0 ? -1 : 0;
    const double distance = here ? fmin(fabs(a), fabs(b)) : 0.0, gap = hit.gap;
    sums.ticks++;
    sums.unfinished += sweep.status == DPT_SWEEP_UNFINISHED;
    sums.given_up += sweep.status == DPT_SWEEP_NONE && ample.status != DPT_SWEEP_NONE;
    if (sweep.status == DPT_SWEEP_NONE || ample.status == DPT_SWEEP_NONE)
        subject->side = 0;
    if (hit.contact == DPT_CONTACT_UNKNOWN)
        return;
    if (subject->side)
        CHECK(wrench.force[2] * subject->side >= 0.0, "world %lu: force %g, from side %d", number, wrench.force[2],
              subject->side);
    if (!here || distance < 1e-5)
        return;
    int taken = fabs(gap - (distance - subject->segment.radius)) < 1e-6 ? here : -here;
    if (subject->side) {
        sums.checked++;
        sums.behind += taken != here;
        CHECK(taken == subject->side, "world %lu: gap %g at %d %g, from side %d", number, gap, here, distance,
              subject->side);
    }
    subject->side = taken;
}

static void one_world(unsigned long number)
{
    enum { SUBJECTS = 3, TICKS = 250 };
    const uint32_t budget = 1 + below(below(2) ? 300 : 60), count = 1 + below(SUBJECTS);
    const double pace = any(0.0005, 0.01), calm = any(0.1, 0.9);
    const int far_first = below(2) != 0;
    struct subject subject[SUBJECTS];
    struct scene scene[2];
    dpt_body body[2];
    double height = 0.0;
    for (int w = 0; w < 2; w++) {
        if (!scene_begin(&scene[w], w ? 0 : budget, 0.0))
            return;
        dpt_tool_remove(scene[w].rig.world, scene[w].rig.tool);
        if (far_first)
            add_sheet(&scene[w], 0.0, 0.08);
        body[w] = add_sheet(&scene[w], 0.0, 0.0);
    }
    dpt_world *const world[2] = { scene[0].rig.world, scene[1].rig.world };
    for (uint32_t i = 0; i < count; i++) {
        subject[i] = (struct subject){ .side = 0 };
        subject[i].segment.radius = below(3) ? 0.0 : any(0.0, 0.004);
        move_segment(&subject[i].segment, 0.02);
        for (int w = 0; w < 2; w++)
            subject[i].tool[w] = rig_add_tool(&scene[w].rig, &subject[i].segment, 1);
    }
    for (int t = 0; t < TICKS; t++) {
        uint32_t one = below(count), what = t < 60 ? 99 : below(100);
        if (what == 0 || (what > 90 && what < 95)) {
            height = any(-0.006, 0.006);
            const dpt_pose pose = at(any(-0.01, 0.01), height);
            for (int w = 0; w < 2; w++)
                dpt_body_set_pose(world[w], body[w], &pose);
        }
        for (uint32_t i = 0; i < count; i++) {
            if (t >= 60 && any(0.0, 1.0) > calm)
                move_segment(&subject[i].segment, pace);
            for (int w = 0; w < 2 && i == one && what == 1; w++) { /* those behind it move up */
                dpt_tool_remove(world[w], subject[i].tool[w]);
                subject[i].tool[w] = rig_add_tool(&scene[w].rig, &subject[i].segment, 1);
                subject[i].side = 0;
            }
            for (int w = 0; w < 2; w++)
                dpt_tool_set_segments(world[w], subject[i].tool[w], &subject[i].segment, 1);
        }
        for (int w = 0; w < 2; w++) {
            dpt_step step = { .size = sizeof step };
            dpt_world_step(world[w], what == 2 ? 0.0 : 0.001, &step);
            CHECK(w || step.work <= budget, "%u units of %u", step.work, budget);
        }
        for (uint32_t i = 0; i < count && what != 2; i++)
            check_subject(world, &subject[i], height, number);
    }
    rig_close(&scene[0].rig);
    rig_close(&scene[1].rig);
}

static void sides_are_of_the_way_that_was_taken(void)
{
    for (unsigned long i = 0; i < world_count; i++)
        one_world(i);
    printf("    %lu ticks, %lu unfinished, %lu given up; %lu sides, %lu of them behind\n", sums.ticks, sums.unfinished,
           sums.given_up, sums.checked, sums.behind);
    CHECK(sums.checked > 100 * world_count && sums.behind > 2 * world_count && sums.unfinished > 10 * world_count,
          "too few");
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &world_count, &random_state);
    if (!fixture_from_shape(&sheet, "membrane", 512))
        return check_report();
    TEST(no_push_to_the_wrong_side);
    TEST(no_regions_no_sides);
    TEST(sides_are_of_the_way_that_was_taken);
    fixture_free(&sheet);
    return check_report();
}
