/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Open sheets and thin bodies, through the world's calls: tools that go through at any speed, in any way, are told,
 * kept to their side and pushed back to it; those that do not go through are left alone.
 *
 * Usage: test_sheets [crossings = 100000] [seed = 1].
 */
#include "track/sheet_flight.h"

static unsigned long crossing_count = 100000;

/* A sweep of the flat square, which met something at `meeting` if it crosses, at `speed` along z. */
static void check_flat_sweep(struct ride *ride, const struct state *from, const struct state *to,
                             const dpt_sweep *sweep, int crosses, double meeting, double speed, double *late)
{
    const double side = ride->side;
    if (!crosses) {
        CHECK(sweep->status == DPT_SWEEP_FREE && sweep->time == 1.0, "invented: %u at %.17g%s", sweep->status,
              sweep->time, motion_text(from, to));
    } else {
        double early = 1.0001e-6 * ride->scene->sheet->diagonal / speed;
        ride->sums->met++;
        const int hit = sweep->status == DPT_SWEEP_HIT;
        CHECK(hit && sweep->time <= meeting + 1e-9 && sweep->time >= meeting - early - 1e-9,
              "met at %.17g: sweep %u at %.17g%s", meeting, sweep->status, sweep->time, motion_text(from, to));
        CHECK(!hit || side * sweep->normal[2] > 0.999999, "normal %g%s", sweep->normal[2], motion_text(from, to));
        *late = fmax(*late, sweep->time - meeting);
    }
}

/*
 * The flat square once more, a tick each, with its truth in closed form: an end that comes to z = 0, or to the radius,
 * over the square, while no other point can have met anything.
 */
static void flat_crossing(struct ride *ride, double *late)
{
    struct scene *scene = ride->scene;
    const struct sheet *sheet = scene->sheet;
    const double normal[3] = { 0.0, 0.0, 1.0 };
    double way[3], u[3],
        x[3] = { random_in(&sheet_random, -0.099, 0.099), random_in(&sheet_random, -0.099, 0.099), 0.0 };
    double length = one_in(8) ? 0.0 : power_in(-3.0, -0.30103), side = one_in(2) ? 1.0 : -1.0;
    double radius = one_in(2) ? 0.0 : power_in(-4.0, -2.0), meeting = random_in(&sheet_random, 1e-3, 1.0);
    double pace = 0.02 * power_in(-3.3, 0.0), bend[3];
    struct state from = { .free = 1, .tool = DPT_POSE_IDENTITY, .body = DPT_POSE_IDENTITY }, to;
    any_unit(way);
    way[2] *= one_in(3) ? power_in(-3.0, 0.0) : 1.0;
    unit_or_z(way);
    any_direction(u, normal, way);
    /* It begins free: what is nearer than rounding touches already. */
    way[2] = -side * fmax(fabs(way[2]) * pace, 1e-10 / meeting);
    way[0] *= pace;
    way[1] *= pace;
    u[2] = side * fabs(u[2]);
    int crosses = !one_in(4), e = one_in(2);
    x[2] = side * radius; /* where the lower end's axis is at the meeting */
    if (!crosses)
        x[2] += side * (fabs(way[2]) * (1.0 - meeting) + 2e-6 * sheet->diagonal);
    from.radius = radius;
    add_scaled(from.end[e], x, -meeting, way);
    add_scaled(from.end[!e], from.end[e], length, u);
    to = from;
    add_scaled(to.end[e], from.end[e], 1.0, way);
    add_scaled(to.end[!e], from.end[!e], 1.0, way);
    if (one_in(2)) { /* the other end turns away */
        any_unit(bend);
        bend[2] = side * fabs(bend[2]);
        add_scaled(to.end[!e], to.end[!e], pace, bend);
    }
    struct tick_answer answer;
    scene_place(scene, &from, 1);
    scene_tick(scene, &answer);
    CHECK(answer.sweep.status == DPT_SWEEP_NONE && answer.hit.contact == DPT_CONTACT_SEPARATED,
          "a first tick: sweep %u, contact %u%s", answer.sweep.status, answer.hit.contact, motion_text(&from, &from));
    scene_place(scene, &to, 0);
    scene_tick(scene, &answer);
    ride->previous = from;
    ride->previous_distance = 1.0;
    ride->side = (int)side;
    ride->knowledge = crosses && to.end[e][2] * side < 0.0 ? CROSSED : UNCROSSED;
    ride->sums->ticks++;
    struct close close = { .distance = answer.hit.distance };
    double slow = fabs(to.end[e][2] - from.end[e][2]);
    struct ends3 at = ends_between(&from, &to, fmin(1.0, meeting + radius / slow));
    check_flat_sweep(ride, &from, &to, &answer.sweep, crosses, meeting, fabs(way[2]), late);
    /* Where the axis comes through at the border it tells no side. */
    struct ends3 early = ends_between(&from, &to, answer.sweep.time);
    if (ride->knowledge == UNCROSSED ||
        fmin(border_distance(sheet, &at), border_distance(sheet, &early)) > 3e-6 * sheet->diagonal)
        check_contact(ride, &to, &answer, &close);
}

static void a_flat_sheet_is_crossed_in_one_tick(void)
{
    struct sheet sheet;
    struct sums sums = { .worst_off = -HUGE_VAL };
    struct scene scene = { NULL };
    double late = -HUGE_VAL;
    if (!sheet_from_shape(&sheet, "membrane", 512, 0.1))
        return;
    for (unsigned long i = 0; sums.met < crossing_count; i++) {
        struct ride ride = { .scene = &scene, .sums = &sums };
        if (i % 1000 == 0) {
            rig_close(&scene.rig);
            if (!scene_begin(&scene, &sheet, 0, NULL))
                return;
        }
        flat_crossing(&ride, &late);
    }
    rig_close(&scene.rig);
    printf("    %lu ticks, %lu crossings, %.1e late at most; behind %lu, did not cross %lu\n", sums.ticks, sums.met,
           late, sums.behind, sums.clean);
    sheet_free(&sheet);
}

static void generated_sheets_are_crossed(void)
{
    struct sheet sheet;
    if (sheet_from_shape(&sheet, "membrane", 512, 0.1))
        fly_through(&sheet, crossing_count * 5 / 100);
    sheet_free(&sheet);
    if (sheet_from_shape(&sheet, "cloth", 800, 0.0))
        fly_through(&sheet, crossing_count / 100);
    sheet_free(&sheet);
    if (sheet_from_grid(&sheet, "bowl", 1.0, 0))
        fly_through(&sheet, crossing_count * 2 / 100);
    sheet_free(&sheet);
    if (sheet_from_grid(&sheet, "hole", 0.0, 1))
        fly_through(&sheet, crossing_count / 100);
    sheet_free(&sheet);
}

/*
 * A body that turns past a moving tool: seen from it, the way bends to one side and back, so that it is on its chord at
 * the ends and in the middle. The sheet is where it is not.
 */
static void ways_that_bend_twice_are_swept(void)
{
    struct sums sums = { .worst_off = -HUGE_VAL };
    for (unsigned long i = 0; i < 20 + crossing_count / 500; i++) {
        double turn = power_in(-1.0, 0.477), v = power_in(-3.0, -1.7), half = 0.5 * turn;
        double c = -0.5 * v * sin(half) / (1.0 - cos(half));
        double end = -0.5 * v * sin(half) + c * cos(half), quarter = 0.25 * turn;
        double off = -0.25 * v * sin(quarter) + c * cos(quarter) - end, wide = 0.6 * v + 1.1 * fabs(c * sin(half));
        double z = end + random_in(&sheet_random, 0.3, 0.9) * off;
        const double corners[12] = { -wide, -0.025, z, wide, -0.025, z, wide, 0.025, z, -wide, 0.025, z };
        const uint32_t two[6] = { 0, 1, 2, 0, 2, 3 };
        struct sheet sheet;
        struct scene scene = { NULL };
        memset(&sheet, 0, sizeof sheet);
        if (!fixture_from_arrays(&sheet.fixture, corners, 4, two, 2) || !sheet_of(&sheet, "turned") ||
            !scene_begin(&scene, &sheet, 0, NULL))
            return;
        struct flight flight = { .free = 1, .tool = DPT_POSE_IDENTITY, .body = DPT_POSE_IDENTITY };
        flight.meeting = 0.5;
        flight.body_axis[1] = 1.0;
        flight.body_turn = -turn;
        double y = random_in(&sheet_random, -0.01, 0.01), length = one_in(2) ? 0.0 : 0.01;
        for (int e = 0; e < 2; e++) {
            const double at[3] = { 0.0, y + e * length, c }, rate[3] = { v, 0.0, 0.0 };
            memcpy(flight.end[e], at, sizeof at);
            memcpy(flight.rate[e], rate, sizeof rate);
        }
        struct ride ride = { .scene = &scene, .sums = &sums };
        struct state from = flight_at(&flight, 0.0), to = flight_at(&flight, 1.0);
        ride_tick(&ride, &from, 1, -1.0);
        ride_tick(&ride, &to, 0, 0.25); /* there it is on the other side */
        rig_close(&scene.rig);
        sheet_free(&sheet);
    }
    printf("    %lu ticks, met %lu, near %lu, undecided %lu, clear %lu\n", sums.swept, sums.met, sums.near,
           sums.undecided, sums.clear);
    CHECK(sums.planned > 10, "%lu met", sums.planned);
}

/* One motion through a thin body, from outside. `passed` counts those that are outside at both ends. */
static void pass_thin_body(struct scene *scene, struct sums *sums, int is_bead, unsigned long *passed)
{
    const struct sheet *sheet = scene->sheet;
    double target[3], normal[3], way[3], u[3], pace = power_in(-2.5, -1.7);
    struct ride ride = { .scene = scene, .sums = sums };
    struct state from = { .free = 1, .tool = DPT_POSE_IDENTITY, .body = DPT_POSE_IDENTITY };
    struct state to;
    any_target(sheet, target, normal);
    any_unit(way);
    if (!is_bead)
        way[2] += way[2] < 0.0 ? -0.3 : 0.3;
    unit_or_z(way);
    any_across(u, way); /* sideways, in its own line, or a point */
    if (one_in(3))
        memcpy(u, way, sizeof u);
    double length = one_in(4) ? 0.0 : power_in(-3.0, -1.7), meeting = random_in(&sheet_random, 0.1, 0.9);
    from.radius = one_in(2) ? 0.0 : power_in(-5.0, -3.5);
    double share = dot3(u, way) > 0.5 ? 1.0 : random_in(&sheet_random, 0.0, 1.0);
    for (int e = 0; e < 2; e++) {
        add_scaled(from.end[e], target, (e - share) * length, u);
        add_scaled(from.end[e], from.end[e], -meeting * pace, way);
    }
    to = from;
    for (int e = 0; e < 2; e++)
        add_scaled(to.end[e], from.end[e], pace, way);
    struct ends3 at = ends_between(&from, &from, 0.0), then = ends_between(&to, &to, 0.0);
    struct close close = closest_of_all(sheet, &at);
    if (close.distance <= fmax(1.001 * from.radius, 1e-9))
        return;
    *passed += closest_of_all(sheet, &then).distance > from.radius;
    if (height_of(sheet, at.end[0], normal, &(int){ 0 }) < 0.0)
        return; /* inside */
    ride_tick(&ride, &from, 1, -1.0);
    struct truth truth = truth_of(sheet, &from, &to, from.radius);
    ride.knowledge = SIDE_UNKNOWN;
    ride_tick(&ride, &to, 0, truth.met == TRUTH_MET ? truth.by : -1.0);
}

/* Thin closed bodies, passed completely in one tick. */
static void thin_bodies_are_not_missed(void)
{
    static const double slab[24] = { -0.1, -0.1, 0,    0.1, -0.1, 0,    0.1, 0.1, 0,    -0.1, 0.1, 0,
                                     -0.1, -0.1, 1e-4, 0.1, -0.1, 1e-4, 0.1, 0.1, 1e-4, -0.1, 0.1, 1e-4 };
    static const uint32_t sides[36] = { 0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                        1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7 };
    struct sheet sheet;
    struct sums sums = { .worst_off = -HUGE_VAL };
    unsigned long passed = 0;
    for (int body = 0; body < 2; body++) {
        memset(&sheet, 0, sizeof sheet);
        struct shape shape;
        shape_reason reason;
        if (body == 1 && shape_make("sphere", 320, 0, &shape, reason) == 0) {
            for (size_t i = 0; i < 3 * shape.vertex_count; i++)
                shape.vertices[i] *= 0.01; /* a bead of 1 mm */
            fixture_from_arrays(&sheet.fixture, shape.vertices, shape.vertex_count, shape.corners,
                                shape.triangle_count);
            shape_free(&shape);
        } else {
            fixture_from_arrays(&sheet.fixture, slab, 8, sides, 12);
        }
        struct scene scene = { NULL };
        if (!sheet.fixture.mesh || !sheet_of(&sheet, body ? "bead" : "slab") || !scene_begin(&scene, &sheet, 0, NULL))
            return;
        for (unsigned long i = 0; i < crossing_count / 20; i++) {
            pass_thin_body(&scene, &sums, body, &passed);
        }
        rig_close(&scene.rig);
        sheet_free(&sheet);
    }
    printf("    %lu ticks, met %lu, free at both ends %lu, undecided %lu; worst touch %.3f of the tolerance\n",
           sums.swept, sums.met, passed, sums.undecided, sums.worst_off);
    CHECK(passed > crossing_count / 100, "%lu passed", passed);
}

enum { FIRST = 400 }; /* ticks for the search, which comes before the sweep */

/* One motion in a world with a budget, and in an ample one. Returns the ticks in which the sweep was unfinished. */
static uint32_t sweep_with_budget(struct scene *scene, struct scene *ample, struct sums *sums)
{
    struct sheet *sheet = scene->sheet;
    struct flight flight;
    struct tick_answer answer;
    any_flight(sheet, &flight);
    flight.body_turn = 0.0;
    memset(flight.body_pace, 0, sizeof flight.body_pace);
    flight.meeting = random_in(&sheet_random, 0.001, 0.999);
    struct state from = flight_at(&flight, 0.0), to = flight_at(&flight, 1.0);
    struct ends3 at = ends_between(&from, &from, 0.0);
    struct close close = closest_of_all(sheet, &at);
    if (close.distance <= fmax(1.001 * from.radius, 1e-9))
        return 0;
    scene_place(ample, &from, 1);
    scene_tick(ample, &answer);
    scene_place(ample, &to, 0);
    scene_tick(ample, &answer);
    uint32_t ticks = 0, most = FIRST + answer.step.work / scene->def.budget;
    scene_place(scene, &from, 1);
    for (scene_tick(scene, &answer); answer.hit.status != DPT_STATUS_EXACT && ticks < most; ticks++)
        scene_tick(scene, &answer);
    CHECK(ticks < most, "%s: budget %u, not exact%s", sheet->name, scene->def.budget, motion_text(&from, &from));
    struct ride ride = { .scene = scene, .sums = sums, .previous = from, .started = 1 };
    ride.previous_distance = close.distance;
    ride.previous_error = answer.hit.error_bound;
    ticks = 0;
    scene_place(scene, &to, 0);
    for (scene_tick(scene, &answer); answer.sweep.status == DPT_SWEEP_UNFINISHED && ticks < most; ticks++)
        scene_tick(scene, &answer);
    CHECK(ticks < most, "%s: budget %u, unfinished%s", sheet->name, scene->def.budget, motion_text(&from, &to));
    check_sweep(&ride, &to, &answer.sweep, -1.0);
    return ticks;
}

/*
 * A small budget may leave the sweep unfinished: then nothing is felt. At rest it is finished, and truly, with any
 * budget: each tick goes on where the last one ended.
 */
static void a_small_budget_only_delays(void)
{
    struct sheet sheet;
    struct sums sums = { .worst_off = -HUGE_VAL };
    unsigned long unfinished = 0, flights = crossing_count / 25;
    uint32_t longest = 0;
    for (int mesh = 0; mesh < 2; mesh++) {
        if (!sheet_from_shape(&sheet, mesh ? "cloth" : "membrane", mesh ? 3200 : 512, mesh ? 0.0 : 0.1))
            return;
        struct scene scene = { NULL };
        struct scene ample = { NULL };
        for (unsigned long i = 0; i < flights / 2; i++) {
            if (i % 20 == 0) {
                rig_close(&scene.rig);
                rig_close(&ample.rig);
                uint32_t most = i % 40 ? 16 : 200;
                if (!scene_begin(&scene, &sheet, 1 + (uint32_t)(random_bits(&sheet_random) % most), NULL) ||
                    !scene_begin(&ample, &sheet, 0, &scene))
                    return;
            }
            const uint32_t ticks = sweep_with_budget(&scene, &ample, &sums);
            unfinished += ticks;
            longest = ticks > longest ? ticks : longest;
        }
        rig_close(&scene.rig);
        rig_close(&ample.rig);
        sheet_free(&sheet);
    }
    printf("    %lu sweeps, %lu ticks unfinished, at most %u before an end; met %lu, undecided %lu\n", sums.swept,
           unfinished, longest, sums.met, sums.undecided);
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &crossing_count, &sheet_random);
    TEST(a_flat_sheet_is_crossed_in_one_tick);
    TEST(generated_sheets_are_crossed);
    TEST(ways_that_bend_twice_are_swept);
    TEST(thin_bodies_are_not_missed);
    TEST(a_small_budget_only_delays);
    return check_report();
}
